// The extension module helibore._core: one register_* function for each part of the core, each in a file of its own.
#include <pybind11/pybind11.h>
#include <pybind11/stl.h>

#include "gil.hpp"
#include "helibore/error.hpp"
#include "helibore/runner.hpp"
#include "register.hpp"

namespace py = pybind11;

PYBIND11_MODULE(main_interpreter, m) {
    m.doc() = "The compiled core of helibore.";
    m.attr("__version__") = HELIBORE_VERSION;
    m.attr("most_threads") = helibore::most_threads;
    py::register_exception_translator([](std::exception_ptr p) {
        try {
            if (p) std::rethrow_exception(p);
        } catch (const helibore::InputError& e) {
            const py::object type = py::module_::import("helibore.base.errors").attr("InputError");
            const py::tuple arguments = py::make_tuple(e.place, e.rule, e.value);
            const auto made = py::reinterpret_steal<py::object>(helibore::bindings::with_gil_requested(
                [&] { return PyObject_Call(type.ptr(), arguments.ptr(), nullptr); }));
            if (made) PyErr_SetObject(type.ptr(), made.ptr());
        } catch (const helibore::InternalError& e) {
            py::set_error(PyExc_RuntimeError, e.what());
        }
    });
    helibore::bindings::register_compression(m);
    helibore::bindings::register_image(m);
    helibore::bindings::register_journal(m);
    helibore::bindings::register_logs(m);
    helibore::bindings::register_number_rows(m);
    helibore::bindings::register_path(m);
    helibore::bindings::register_preparation(m);
    helibore::bindings::register_surface(m);
    helibore::bindings::register_wall(m);
    helibore::bindings::register_wits(m);
}

// The module is made once, in the main interpreter: NumPy and pybind11's objects belong to one interpreter.
extern "C" PYBIND11_EXPORT PyObject* PyInit__core() {
#ifdef Py_GIL_DISABLED
    PyErr_SetString(PyExc_ImportError, "helibore needs a build of Python with the GIL: this one is free-threaded");
    return nullptr;
#endif
    if (PyInterpreterState_Get() != PyInterpreterState_Main()) {
        PyErr_SetString(PyExc_ImportError, "helibore works in the main interpreter only: this is a subinterpreter");
        return nullptr;
    }
    return PyInit_main_interpreter();
}
