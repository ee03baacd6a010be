// Work shared out to threads that live for one call; nothing is left behind, no exception crosses a thread.
#pragma once

#include <algorithm>
#include <atomic>
#include <cstdint>
#include <exception>
#include <mutex>
#include <system_error>
#include <thread>
#include <utility>
#include <vector>

#if defined(__SSE2__) || defined(_M_X64)
#include <emmintrin.h>
#endif

#include "helibore/types.hpp"

namespace helibore {

// Workers for the length of one call of the library, the caller being one of them. They take jobs one after another:
// to start a thread takes as long as to search some five hundred vertices, so it is done once, when first needed.
//
//     caller   |-- job 1, share 1 --|-- serial --|-- job 2, share 1 --|-- share 0 --|
//     worker   .....|-- share 0 --|..............|  (late: the caller has taken share 0 itself)
//              start
class Crew {
  public:
    explicit Crew(int threads) : threads_(std::max(threads, 1)) {}
    Crew(const Crew&) = delete;
    Crew& operator=(const Crew&) = delete;
    ~Crew() {
        ended_ = true;
        publish(0);
    }

    int threads() const { return threads_; }

    // Calls run(share) once for each of `shares`, at most threads(), whoever is free taking the next one: two shares
    // may run on one thread, never at once. The first exception is rethrown once all have stopped.
    template <class Run>
    void run(int shares, const Run& run) {
        if (shares <= 1) return run(0);
        start(shares - 1);
        call_ = [](const void* job, int share) { (*static_cast<const Run*>(job))(share); };
        job_ = &run;
        unfinished_ = shares;
        publish(static_cast<std::uint32_t>(shares));
        while (take_share()) {
        }
        for (int left = unfinished_; left > 0; left = unfinished_) await(unfinished_, left);
        if (first_failure_) std::rethrow_exception(std::exchange(first_failure_, nullptr));
    }

    // Calls job(worker, i) for every i in [0, parts), whoever is free taking the next one; `worker` is below threads().
    // Fewer parts than `least` a worker are not worth another one.
    template <class Job>
    void for_each_part(Index parts, const Job& job, Index least = 1) {
        std::atomic<Index> next{0};
        run(static_cast<int>(std::clamp<Index>(parts / least, 1, threads_)), [&](int worker) {
            for (Index i = next++; i < parts; i = next++) job(worker, i);
        });
    }

  private:
    // The lower half of open_ counts the shares of the current job that nobody has taken, the upper half the jobs.
    void publish(std::uint32_t shares) {
        const std::uint64_t job = (open_ >> 32) + 1;
        open_ = job << 32 | shares;
        open_.notify_all();
    }

    bool take_share() {
        std::uint64_t open = open_;
        do {
            if ((open & 0xFFFFFFFF) == 0) return false;
        } while (!open_.compare_exchange_weak(open, open - 1));
        try {
            call_(job_, static_cast<int>(open & 0xFFFFFFFF) - 1);
        } catch (...) {
            const std::scoped_lock lock(failure_lock_);
            if (!first_failure_) first_failure_ = std::current_exception();
        }
        if (--unfinished_ == 0) unfinished_.notify_one();
        return true;
    }

    void work() {
        while (!ended_) {
            const std::uint64_t open = open_;
            if (!take_share() && !ended_) await(open_, open);
        }
    }

    // Where the system grants no more threads, the others take the shares.
    void start(int helpers) {
        try {
            while (static_cast<int>(helpers_.size()) < helpers) helpers_.emplace_back([this] { work(); });
        } catch (const std::system_error&) {
        }
    }

    // Waits until `value` is no longer `old`. What comes next is mostly some microseconds away, and to be woken takes
    // ten times as long.
    template <class T>
    static void await(const std::atomic<T>& value, T old) {
        for (int i = 0; i < spins; ++i) {
            if (value.load(std::memory_order_relaxed) != old) return;
            pause();
        }
        value.wait(old);
    }

    static void pause() {
#if defined(__SSE2__) || defined(_M_X64)
        _mm_pause();
#endif
    }

    static constexpr int spins = 400;  // some 20 microseconds

    const int threads_;
    std::atomic<std::uint64_t> open_{0};
    std::atomic<int> unfinished_{0};
    std::atomic<bool> ended_{false};
    void (*call_)(const void* job, int share) = nullptr;
    const void* job_ = nullptr;
    std::exception_ptr first_failure_;
    std::mutex failure_lock_;
    std::vector<std::jthread> helpers_;  // last: they end before what they use
};

// Part `which` of [0, n) cut into `parts` nearly equal ones.
inline Range part(Index n, int parts, int which) {
    return {n * which / parts, n * (which + 1) / parts};
}

// Work that needs a crew for one job only.
template <class Run>
void on_workers(int threads, const Run& run) {
    Crew(threads).run(threads, run);
}

template <class Run>
void for_each_part(Index parts, int threads, const Run& run) {
    Crew(threads).for_each_part(parts, run);
}

}  // namespace helibore
