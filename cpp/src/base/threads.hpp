// Work shared out to threads, which are joined before the call returns. No exception crosses a thread.
//
//     caller   |-- part 0 --|-- part 2 --|-- part 3 --|    Each takes the next part when it has finished one, so a slow
//     thread 1   |-- part 1 ----------|-- part 4 --|       core does not hold up the others.
//
// Starting a thread takes as long as searching some five hundred vertices, so small work stays on the caller's thread.
#pragma once

#include <algorithm>
#include <atomic>
#include <exception>
#include <mutex>
#include <system_error>
#include <thread>
#include <vector>

#include "base/arithmetic.hpp"
#include "helibore/types.hpp"

namespace helibore {

// How many of `threads` to use for `work`, if each must have at least `least` of it.
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
    std::atomic<Index> next{0};
    std::mutex lock;
    std::exception_ptr failure;
    const auto work = [&](int worker) {
        try {
            for (Index part = next++; part < parts; part = next++) job(worker, part);
        } catch (...) {
            next = parts;
            const std::scoped_lock held(lock);
            if (!failure) failure = std::current_exception();
        }
    };
    {
        std::vector<std::jthread> helpers;  // joined where this block ends
        helpers.reserve(static_cast<std::size_t>(workers - 1));
        try {
            for (int worker = 1; worker < workers; ++worker)
                helpers.emplace_back([&work, worker] {
                    const StandardArithmetic standard;
                    work(worker);
                });
        } catch (const std::system_error&) {  // the system grants no more threads: the others do the work
        }
        work(0);
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
