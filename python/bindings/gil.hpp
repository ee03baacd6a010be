// Releases the GIL for the work of the core, as pybind11::gil_scoped_release does, but a program may end meanwhile.
//
// When the interpreter ends, CPython up to 3.13 ends each thread that requests the GIL by unwinding its stack. That
// would run destructors of Python objects without the GIL, and end the program in the first function that is noexcept
// or has caught an exception. So the thread waits here until the process ends, as it does in CPython 3.14.
#pragma once

#include <pybind11/pybind11.h>

#include <chrono>
#include <thread>

namespace helibore::bindings {

// Calls Python's `function`, which may request the GIL. The thread is held by a destructor, not by catch (...), which
// ends the program where another exception is being caught.
template <class Function>
auto with_gil_requested(const Function& function) {
    struct Hold {
        bool ends = true;
        ~Hold() {
            if (!ends) return;
            for (;;) std::this_thread::sleep_for(std::chrono::hours(1));
        }
    } hold;
    const auto result = function();
    hold.ends = false;
    return result;
}

class WithoutGil {
  public:
    WithoutGil() : thread_(PyEval_SaveThread()) {}
    ~WithoutGil() {
        with_gil_requested([this] {
            PyEval_RestoreThread(thread_);
            return true;
        });
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
