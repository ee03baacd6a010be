// Work shared out to threads that end with the call, or shortly after; no exception crosses a thread.
#pragma once

#include <algorithm>
#include <atomic>
#include <chrono>
#include <cstdint>
#include <deque>
#include <exception>
#include <memory>
#include <mutex>
#include <system_error>
#include <thread>
#include <utility>
#include <vector>

#if defined(__SSE2__) || defined(_M_X64)
#include <emmintrin.h>
#endif

#include "helibore/crews.hpp"
#include "helibore/types.hpp"
#include "search/kernel/instruction_set.hpp"

namespace helibore {

// Part `which` of [0, n) cut into `parts` nearly equal ones.
inline Range part(Index n, int parts, int which) {
    return {n * which / parts, n * (which + 1) / parts};
}

// Workers, the caller of a method being one of them; one call at a time, a Shift each. Within it they take jobs one
// after another: to start a thread takes as long as to search some five hundred vertices, so it is done when first
// needed, and once.
//
//     caller   |-- job 1, share 1 --|-- serial --|-- job 2, share 1 --|-- share 0 --|     |-- next call
//     helper   .....|-- share 0 --|..............|  (late: the caller has taken share 0 itself)  |....
//              start                                                                      lingers, then ends
//
// A helper ends when it has lingered long enough after the call (crews.hpp says how long). Who calls again sooner finds
// it there, so that a hole streamed in small appends is shared out, too, and so are walls that follow each other; who
// does not is left with no thread. Helpers are not joined: a job is waited for, and what they look at besides is theirs
// as well.
class Crew {
  public:
    explicit Crew(int threads = 1) { set_threads(threads); }
    Crew(const Crew&) = delete;
    Crew& operator=(const Crew&) = delete;
    ~Crew() {
        board_->dismissed = true;
        board_->publish(0);
    }

    // Calls run(share) once for each of `shares`, at most as many as threads, whoever is free taking the next one: two
    // shares may run on one thread, never at once. The first exception is rethrown once all have stopped.
    template <class Run>
    void run(int shares, const Run& run) {
        if (shares <= 1) return run(0);
        const auto begun_at = Clock::now();
        start(shares - 1);
        board_->call = [](const void* job, int share) { (*static_cast<const Run*>(job))(share); };
        board_->job = &run;
        board_->unfinished = shares;
        board_->publish(static_cast<std::uint32_t>(shares));
        while (board_->take_share()) {
        }
        for (int left = board_->unfinished; left > 0; left = board_->unfinished) await(board_->unfinished, left);
        to_linger_ += (Clock::now() - begun_at) / of_work;
        if (board_->first_failure) std::rethrow_exception(std::exchange(board_->first_failure, nullptr));
    }

    // How many shares `work` is worth: `to_start` of it for a thread that must be started, `to_wake` for one that is
    // there, or will be for the calls that follow as fast as this one did.
    int shares_worth(Index work, Index to_start, Index to_wake) const {
        const Index worth = std::max(work / to_start, std::min<Index>(work / to_wake, at_hand()));
        return static_cast<int>(std::clamp<Index>(worth, 1, threads_));
    }

    // Calls job(worker, i) for every i in [0, parts); `worker` is below `shares`. Each begins with a stretch of its
    // own, mostly on the same thread in every job of a call, since what a thread has just written is near it, and then
    // helps the others.
    template <class Job>
    void for_each_part(int shares, Index parts, const Job& job) {
        const int n = static_cast<int>(std::clamp<Index>(parts, 1, shares));
        for (int s = 0; s < n; ++s) {
            const Range range = part(parts, n, s);
            stretches_[static_cast<std::size_t>(s)].next = range.start;
            stretches_[static_cast<std::size_t>(s)].stop = range.stop;
        }
        run(n, [&](int worker) {
            for (int s = 0; s < n; ++s) {
                Stretch& stretch = stretches_[static_cast<std::size_t>((worker + s) % n)];
                for (Index i = stretch.next++; i < stretch.stop; i = stretch.next++) job(worker, i);
            }
        });
    }

  private:
    friend class Shift;
    using Clock = std::chrono::steady_clock;
    static constexpr Clock::duration least_linger = std::chrono::microseconds(50);
    static constexpr Clock::duration most_linger = std::chrono::milliseconds(1);
    static constexpr int of_work = 10;  // that part of it is lingered at most, beside the least
    static constexpr int a_stream = 4;  // quick calls in a row

    // What helpers look at, shared with them. One that has ended leaves nothing behind, not even its stack, and in a
    // forked process, which has the crew but not its helpers, nobody waits for them.
    struct Board {
        // The lower half counts the shares of the current job that nobody has taken, the upper half the jobs.
        std::atomic<std::uint64_t> open{0};
        std::atomic<int> unfinished{0};
        std::atomic<bool> resting{false};    // between two calls
        std::atomic<bool> dismissed{false};  // for good
        std::atomic<Clock::duration> linger{least_linger};
        void (*call)(const void* job, int share) = nullptr;
        const void* job = nullptr;
        std::exception_ptr first_failure;
        std::mutex failure_lock;
        std::deque<std::atomic<bool>> present;  // is helper i there?

        void publish(std::uint32_t shares) {
            const std::uint64_t number = (open >> 32) + 1;
            open = number << 32 | shares;
            open.notify_all();
        }

        bool take_share() {
            std::uint64_t now = open;
            do {
                if ((now & 0xFFFFFFFF) == 0) return false;
            } while (!open.compare_exchange_weak(now, now - 1));
            try {
                call(job, static_cast<int>(now & 0xFFFFFFFF) - 1);
            } catch (...) {
                const std::scoped_lock lock(failure_lock);
                if (!first_failure) first_failure = std::current_exception();
            }
            if (--unfinished == 0) unfinished.notify_one();
            return true;
        }

        void work() {
            for (;;) {
                const std::uint64_t now = open;
                if (!take_share() && !next_job(now)) return;
            }
        }

        // Waits for the job after `now`; false where the helper should end. What comes next is mostly some microseconds
        // away, and to be woken takes ten times as long. Who waits longer leaves the core to whoever wants it.
        bool next_job(std::uint64_t now) const {
            const auto since = Clock::now();
            for (Clock::duration waited{}; waited < (resting ? linger.load() : least_linger);
                 waited = Clock::now() - since) {
                if (waited > least_linger) std::this_thread::yield();
                if (spins_until_changed(open, now)) return !dismissed;
            }
            if (resting || dismissed) return false;
            open.wait(now);
            return !dismissed;
        }
    };

    struct alignas(128) Stretch {
        std::atomic<Index> next{0};
        Index stop = 0;
    };

    // A helper that has ended since the last call is started anew. Where the system grants no more threads, the others
    // take the shares. A thread begins with the arithmetic of the one that starts it; the next call may be another's.
    void start(int helpers) {
        Board& board = *board_;
        try {
            while (static_cast<int>(board.present.size()) < helpers) board.present.emplace_back(false);
            for (auto i = board.present.begin(); i != board.present.begin() + helpers; ++i) {
                if (*i) continue;
                *i = true;
                try {
                    std::thread([board = board_, &present = *i] {
                        const StandardArithmetic standard;
                        board->work();
                        present = false;
                    }).detach();
                } catch (...) {
                    *i = false;
                    throw;
                }
            }
        } catch (const std::system_error&) {
        }
    }

    void set_threads(int threads) {
        threads_ = std::max(threads, 1);
        const auto n = static_cast<std::size_t>(threads_);
        if (stretches_.size() < n) stretches_ = std::vector<Stretch>(n);
    }

    // A call is quick that surely finds the helpers, who look a last time before they end.
    void begin(int threads) {
        set_threads(threads);
        if (threads_ == 1) return;
        const Clock::duration gap = Clock::now() - rested_at_;
        quick_ = gap < board_->linger.load() * 4 / 5 ? std::min(quick_ + 1, a_stream) : 0;
        to_linger_ = std::max(to_linger_ - gap, Clock::duration{});
        board_->resting = false;
        if (gap > least_linger * 4 / 5) board_->publish(0);  // who lingers waits anew
    }

    void rest() {
        if (threads_ == 1) return;
        rested_at_ = Clock::now();
        to_linger_ = std::min(to_linger_, most_linger);
        board_->linger = std::max(to_linger_, least_linger);
        board_->resting = true;
        board_->publish(0);
    }

    // The workers that need not be started for this call alone. One quick call may come by chance, so its helpers are
    // those that are there; several in a row are a stream, for which they are worth to be started.
    Index at_hand() const {
        if (quick_ == 0) return 1;
        return quick_ == a_stream ? threads_ : 1 + std::count(board_->present.begin(), board_->present.end(), true);
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

    int threads_ = 1;
    const std::shared_ptr<Board> board_ = std::make_shared<Board>();
    std::vector<Stretch> stretches_;
    int quick_ = 0;  // calls in a row, this one included, that came soon after the one before
    Clock::time_point rested_at_{};
    Clock::duration to_linger_{};  // what shared jobs have earned and pauses have not used
};

// A crew for one call, of those that are shared; without such, of its own.
class Shift {
  public:
    Shift(Crews* crews, int threads);
    Shift(const Shift&) = delete;
    Shift& operator=(const Shift&) = delete;
    ~Shift();

    Crew& crew() const { return *crew_; }

  private:
    Crews* crews_;
    std::unique_ptr<Crew> crew_;
};

// Work that needs a crew for one job only.
template <class Run>
void on_workers(int threads, const Run& run) {
    Crew(threads).run(threads, run);
}

template <class Run>
void for_each_part(Index parts, int threads, const Run& run) {
    Crew(threads).for_each_part(std::max(threads, 1), parts, run);
}

}  // namespace helibore
