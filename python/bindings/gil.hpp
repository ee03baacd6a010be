// Releases the GIL for the work of the core, as pybind11::gil_scoped_release does, but a program may end meanwhile.
//
// When the interpreter ends, CPython up to 3.13 ends each thread that requests the GIL by unwinding its stack. That
// would run destructors of Python objects without the GIL, and end the program in the first function that is noexcept.
// So the thread waits here until the process ends, as it does in CPython 3.14.
#pragma once

#include <pybind11/pybind11.h>

#include <chrono>
#include <thread>

namespace helibore::bindings {

class WithoutGil {
  public:
    WithoutGil() : thread_(PyEval_SaveThread()) {}
    ~WithoutGil() {
        try {
            PyEval_RestoreThread(thread_);
        } catch (...) {
            for (;;) std::this_thread::sleep_for(std::chrono::hours(1));
        }
    }
    WithoutGil(const WithoutGil&) = delete;
    WithoutGil& operator=(const WithoutGil&) = delete;

  private:
    PyThreadState* thread_;
};

// Returns whether the interpreter ends. Only its main thread still runs Python then.
inline bool interpreter_ends() {
#if PY_VERSION_HEX >= 0x030D0000
    return Py_IsFinalizing() != 0;
#else
    return _Py_IsFinalizing() != 0;
#endif
}

}  // namespace helibore::bindings
