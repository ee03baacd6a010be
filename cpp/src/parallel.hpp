// Work shared out to threads that end with the call, or shortly after; no exception crosses a thread.
#pragma once

#include <algorithm>
#include <atomic>
#include <chrono>
#include <cstdint>
#include <deque>
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

// Part `which` of [0, n) cut into `parts` nearly equal ones.
inline Range part(Index n, int parts, int which) {
    return {n * which / parts, n * (which + 1) / parts};
}

// The workers of one object, the caller of a method being one of them; one call at a time, a Shift each. Within it they
// take jobs one after another: to start a thread takes as long as to search some five hundred vertices, so it is done
// when first needed, and once.
//
//     caller   |-- job 1, share 1 --|-- serial --|-- job 2, share 1 --|-- share 0 --|     |-- next call
//     helper   .....|-- share 0 --|..............|  (late: the caller has taken share 0 itself)  |....
//              start                                                                      lingers, then ends
//
// A helper ends when `linger` has passed since the call. Who calls again sooner finds it there, so that a hole streamed
// in small appends is shared out, too; who does not is left with no thread.
class Crew {
  public:
    explicit Crew(int threads) : threads_(std::max(threads, 1)) {}
    Crew(const Crew&) = delete;
    Crew& operator=(const Crew&) = delete;
    ~Crew() {
        dismissed_ = true;
        publish(0);
    }

    // One call of the object that owns the crew.
    class Shift {
      public:
        explicit Shift(Crew& crew) : crew_(crew) { crew_.begin(); }
        Shift(const Shift&) = delete;
        Shift& operator=(const Shift&) = delete;
        ~Shift() { crew_.rest(); }

      private:
        Crew& crew_;
    };

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

    // How many shares `work` is worth: `to_start` of it for a thread that must be started, `to_wake` for one that is
    // there, or will be for the calls that follow as fast as this one did.
    int shares_worth(Index work, Index to_start, Index to_wake) const {
        return static_cast<int>(std::clamp<Index>(work / (hurried_ ? to_wake : to_start), 1, threads_));
    }

    // Calls job(worker, i) for every i in [0, parts); `worker` is below `shares`. Each begins with a stretch of its
    // own, the same in every job of a call, since what it has just written is near it, and then helps the others.
    template <class Job>
    void for_each_part(int shares, Index parts, const Job& job) {
        const int n = static_cast<int>(std::clamp<Index>(parts, 1, shares));
        std::vector<Stretch> stretches(static_cast<std::size_t>(n));
        for (int s = 0; s < n; ++s) {
            const Range range = part(parts, n, s);
            stretches[static_cast<std::size_t>(s)].next = range.start;
            stretches[static_cast<std::size_t>(s)].stop = range.stop;
        }
        run(n, [&](int worker) {
            for (int s = 0; s < n; ++s) {
                Stretch& stretch = stretches[static_cast<std::size_t>((worker + s) % n)];
                for (Index i = stretch.next++; i < stretch.stop; i = stretch.next++) job(worker, i);
            }
        });
    }

  private:
    using Clock = std::chrono::steady_clock;
    static constexpr auto linger = std::chrono::microseconds(50);

    struct Helper {
        std::atomic<bool> ended{true};
        std::jthread thread;
    };

    struct alignas(64) Stretch {
        std::atomic<Index> next{0};
        Index stop = 0;
    };

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
        for (;;) {
            const std::uint64_t open = open_;
            if (!take_share() && !next_job(open)) return;
        }
    }

    // Waits for the job after `open`; false where the helper should end. What comes next is mostly some microseconds
    // away, and to be woken takes ten times as long.
    bool next_job(std::uint64_t open) const {
        const auto until = Clock::now() + linger;
        do {
            if (spins_until_changed(open_, open)) return !dismissed_;
        } while (Clock::now() < until);
        if (resting_ || dismissed_) return false;
        open_.wait(open);
        return !dismissed_;
    }

    // A helper that has ended since the last call is started anew. Where the system grants no more threads, the others
    // take the shares.
    void start(int helpers) {
        try {
            while (static_cast<int>(helpers_.size()) < helpers) helpers_.emplace_back();
            for (int i = 0; i < helpers; ++i)
                if (Helper& helper = helpers_[static_cast<std::size_t>(i)]; helper.ended) start(helper);
        } catch (const std::system_error&) {
        }
    }

    void start(Helper& helper) {
        helper.thread = std::jthread();  // joins the one that has ended
        helper.ended = false;
        try {
            helper.thread = std::jthread([this, &helper] {
                work();
                helper.ended = true;
            });
        } catch (...) {
            helper.ended = true;
            throw;
        }
    }

    void begin() {
        resting_ = false;
        hurried_ = threads_ > 1 && Clock::now() - rested_at_ < linger / 2;
    }

    void rest() {
        if (threads_ == 1) return;
        resting_ = true;
        rested_at_ = Clock::now();
        publish(0);
    }

    // Some microseconds of looking whether `value` is no longer `old`.
    template <class T>
    static bool spins_until_changed(const std::atomic<T>& value, T old) {
        for (int i = 0; i < 64; ++i) {
            if (value.load(std::memory_order_relaxed) != old) return true;
            pause();
        }
        return false;
    }

    template <class T>
    static void await(const std::atomic<T>& value, T old) {
        for (int i = 0; i < 8; ++i)
            if (spins_until_changed(value, old)) return;
        value.wait(old);
    }

    static void pause() {
#if defined(__SSE2__) || defined(_M_X64)
        _mm_pause();
#endif
    }

    const int threads_;
    std::atomic<std::uint64_t> open_{0};
    std::atomic<int> unfinished_{0};
    std::atomic<bool> resting_{false};    // between two calls
    std::atomic<bool> dismissed_{false};  // for good
    bool hurried_ = false;                // this call came soon after the last
    Clock::time_point rested_at_{};
    void (*call_)(const void* job, int share) = nullptr;
    const void* job_ = nullptr;
    std::exception_ptr first_failure_;
    std::mutex failure_lock_;
    std::deque<Helper> helpers_;  // last: they end before what they use
};

// Work that needs a crew for one job only.
template <class Run>
void on_workers(int threads, const Run& run) {
    Crew(threads).run(threads, run);
}

template <class Run>
void for_each_part(Index parts, int threads, const Run& run) {
    Crew(threads).for_each_part(threads, parts, run);
}

}  // namespace helibore
