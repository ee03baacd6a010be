// Included before every file of the WebAssembly build, whose standard library has no threads: the names of <mutex> and
// <thread> that the core uses, for a program of one thread.
#pragma once

#include <mutex>
#include <thread>
#include <utility>

namespace std {

struct mutex {
    void lock() {}
    bool try_lock() { return true; }
    void unlock() {}
};

struct jthread {
    template <class Work>
    explicit jthread(Work&& work) {
        std::forward<Work>(work)();
    }
};

}  // namespace std
