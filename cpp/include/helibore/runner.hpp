// Lets the library use the host's threads instead of its own.
//
//     const helibore::UseRunner use({run_on_my_pool, &pool});   // for the calls of this thread, as long as `use` lives
//     wall.append(samples);
#pragma once

#include <cstdint>

namespace helibore {

inline constexpr int most_threads = 1024;  // of one call

// `run` calls job(context, worker) once for each worker in [0, workers), on any threads, and returns when all these
// calls have returned. The calls may run at the same time or one after the other: the result is the same. `run` must
// not throw. If `run` omits the call of a worker, the caller's thread does the work. A worker needs 64 KB of stack at
// most.
//
// `run` may call the library, also where a thread of the host helps with other work while it waits. But a call on the
// object whose call `run` serves, in the thread of that call, throws InputError: "this wall: is being appended to or
// read in this thread". A call in another thread waits until the object is free, so `run` must not wait for it.
struct Runner {
    using Job = void (*)(void* context, std::int32_t worker);
    using Run = void (*)(void* host, std::int32_t workers, Job job, void* context);

    Run run = nullptr;  // null: the library starts threads for a call and joins them
    void* host = nullptr;
};

// Sets the runner of this thread; the destructor restores the previous one. Settings::threads still sets the number of
// workers.
class UseRunner {
  public:
    explicit UseRunner(const Runner& runner);
    ~UseRunner();
    UseRunner(const UseRunner&) = delete;
    UseRunner& operator=(const UseRunner&) = delete;

  private:
    Runner before_;
};

}  // namespace helibore
