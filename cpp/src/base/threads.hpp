// Divides work among threads, which are joined before the call returns, or gives it to the host's runner. An exception
// in one of these threads is rethrown in the caller's thread.
//
//     thread 0   |-- part 0 --|-- part 1 --|-- part 2 --|-- part 5 --|
//     thread 1   |-- part 3 --------|-- part 4 ---------|
//
// Each thread first does consecutive parts, because neighbouring parts share data, and then takes parts from the other
// threads.
//
// Starting a thread takes as long as searching some five hundred vertices, so small work stays on the caller's thread.
// The caller of large work only waits: Linux often starts a thread on the core of a busy caller that has just woken up,
// where it gets no time until the work is done.
#pragma once

#include <algorithm>
#include <atomic>
#include <cstdint>
#include <exception>
#include <string>
#include <system_error>
#include <thread>
#include <vector>

#include "base/arithmetic.hpp"
#include "base/locks.hpp"
#include "base/messages.hpp"
#include "helibore/runner.hpp"
#include "helibore/types.hpp"

namespace helibore {

inline void require_threads(int threads) {
    require(threads >= 1 && threads <= most_threads, "threads", Index{threads},
            "must lie in 1 to " + std::to_string(most_threads));
}

// Returns how many threads, at most `threads`, to use for `work` units of work, if each must have at least `least`
// units.
inline int threads_for(Index work, Index least, int threads) {
    return static_cast<int>(std::clamp<Index>(work / least, 1, std::max(threads, 1)));
}

// Calls job(worker, part) once for every part in [0, parts). `worker` is below `threads`, and one worker does one part
// at a time. The first exception is rethrown when all threads have ended; parts not begun by then are left out.
template <class Job>
void for_each_part(int threads, Index parts, const Job& job) {
    const int workers = static_cast<int>(std::min<Index>(threads, parts));
    if (workers <= 1) {
        for (Index part = 0; part < parts; ++part) job(0, part);
        return;
    }
    struct alignas(128) Stretch {
        std::atomic<Index> next;
        Index stop;
    };
    std::vector<Stretch> stretches(static_cast<std::size_t>(workers));
    for (Index w = 0; w < workers; ++w) {
        stretches[static_cast<std::size_t>(w)].next = parts * w / workers;
        stretches[static_cast<std::size_t>(w)].stop = parts * (w + 1) / workers;
    }
    std::atomic<bool> failed{false};
    std::mutex lock;
    std::exception_ptr failure;
    const auto work = [&](int worker) {
        try {
            for (int s = 0; s < workers; ++s) {
                Stretch& stretch = stretches[static_cast<std::size_t>((worker + s) % workers)];
                for (Index part; !failed && (part = stretch.next++) < stretch.stop;) job(worker, part);
            }
        } catch (...) {
            failed = true;
            const std::lock_guard held(lock);
            if (!failure) failure = std::current_exception();
        }
    };
    if (const Runner runner = runner_of_this_thread(); runner.run) {
        struct Work {
            const decltype(work)& of_worker;
            std::vector<std::atomic<bool>> begun;
        } all{work, std::vector<std::atomic<bool>>(static_cast<std::size_t>(workers))};
        const auto once = [](void* context, std::int32_t worker) {
            auto& [of_worker, begun] = *static_cast<Work*>(context);
            if (worker < 0 || worker >= std::ssize(begun) || begun[static_cast<std::size_t>(worker)].exchange(true))
                return;
            const StandardArithmetic standard;
            of_worker(worker);
        };
        runner.run(runner.host, workers, once, &all);
        for (int worker = 0; worker < workers; ++worker) once(&all, worker);
    } else {
        std::vector<std::jthread> started;
        started.reserve(static_cast<std::size_t>(workers));
        try {
            for (int worker = 0; worker < workers; ++worker)
                started.emplace_back([&work, worker] {
                    const StandardArithmetic standard;
                    work(worker);
                });
        } catch (const std::system_error&) {  // the system grants no more threads: the threads that run do the work
            if (started.empty()) work(0);
        }
    }
    if (failure) std::rethrow_exception(failure);
}

// Calls job(worker, range) for ranges of at most `length` that make up [0, count).
template <class Job>
void for_each_range(int threads, Index count, Index length, const Job& job) {
    for_each_part(threads, (count + length - 1) / length, [&](int worker, Index part) {
        job(worker, Range{part * length, std::min(count, (part + 1) * length)});
    });
}

}  // namespace helibore
