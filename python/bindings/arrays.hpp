// Where NumPy arrays become spans and vectors become owned NumPy arrays; nothing else in the bindings touches buffers.
#pragma once

#include <pybind11/numpy.h>
#include <pybind11/pybind11.h>

#include <cstring>
#include <span>
#include <vector>

namespace helibore::bindings {

namespace py = pybind11;

// The Python layer (arrays.py) has made these one-dimensional, C-contiguous and float64.
using Column = py::array_t<double, py::array::c_style>;

inline std::span<const double> span_of(const Column& column) {
    return {column.data(), static_cast<std::size_t>(column.size())};
}

// An owned array of exact size that takes over the vector's memory: no copy.
template <class T>
py::array_t<T> array_of(std::vector<T>&& values, std::vector<py::ssize_t> shape = {}) {
    if (shape.empty()) shape = {static_cast<py::ssize_t>(values.size())};
    auto owner = std::make_unique<std::vector<T>>(std::move(values));
    T* first = owner->data();
    py::capsule release(owner.release(), [](void* p) { delete static_cast<std::vector<T>*>(p); });
    return py::array_t<T>(shape, first, release);
}

}  // namespace helibore::bindings
