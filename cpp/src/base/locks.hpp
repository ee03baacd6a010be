// Locks of objects that several threads of a host may use.
#pragma once

#include <atomic>
#include <mutex>

#ifdef __unix__
#include <sched.h>
#include <unistd.h>
#endif

#include "helibore/error.hpp"
#include "helibore/runner.hpp"

namespace helibore {

Runner& runner_of_this_thread();  // each thread has its own

// The lock of an object whose calls share out work to a runner of the host. A call waits for the calls of other
// threads. Where it would wait for ever, it throws: in a call that the runner makes on the thread whose call it serves,
// and in a forked process, if another thread was in a call when the process was forked.
class CallLock {
  public:
    // `object` is the name of the object in errors, such as "wall".
    explicit CallLock(const char* object) : object_(object) {}

    // The holder says its process before its thread. In a process that was never forked, all holders have its number.
    // In a forked one, a holder that has said nothing yet is most likely of this process, and about to say it.
    void lock() {
        for (int tries = 0; !mutex_.try_lock(); ++tries) {
            const void* holder = thread_;
            if (holder == this_thread())
                throw InputError(std::string("this ") + object_, "is being appended to or read in this thread");
            if (process_ == this_process()) {
                mutex_.lock();
                break;
            }
            if (holder || tries == most_tries)
                throw InputError(std::string("this ") + object_,
                                 "was in use by another thread when this process was forked");
            let_others_run();
        }
        hold();
    }
    bool try_lock() {
        const bool locked = mutex_.try_lock();
        if (locked) hold();
        return locked;
    }
    void unlock() {
        thread_ = nullptr;
        mutex_.unlock();
    }

  private:
    static constexpr int most_tries = 100'000;
    void hold() {
        process_ = this_process();
        thread_ = this_thread();
    }
    static const void* this_thread() { return &runner_of_this_thread(); }
    static int this_process() {
#ifdef __unix__
        return static_cast<int>(getpid());
#else
        return 0;
#endif
    }

    static void let_others_run() {
#ifdef __unix__
        sched_yield();
#endif
    }

    std::mutex mutex_;
    std::atomic<const void*> thread_{nullptr};
    std::atomic<int> process_{this_process()};
    const char* object_;
};

}  // namespace helibore
