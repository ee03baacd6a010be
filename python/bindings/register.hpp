// One function for each part of the core that the extension exposes.
#pragma once

#include <pybind11/pybind11.h>

namespace helibore::bindings {

void register_compression(pybind11::module_& m);
void register_image(pybind11::module_& m);
void register_journal(pybind11::module_& m);
void register_logs(pybind11::module_& m);
void register_number_rows(pybind11::module_& m);
void register_path(pybind11::module_& m);
void register_preparation(pybind11::module_& m);
void register_surface(pybind11::module_& m);
void register_wall(pybind11::module_& m);
void register_wits(pybind11::module_& m);

}  // namespace helibore::bindings
