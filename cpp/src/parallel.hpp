// Work shared out to threads that live for one call; nothing is left behind, no exception crosses a thread.
#pragma once

#include <algorithm>
#include <atomic>
#include <exception>
#include <mutex>
#include <system_error>
#include <thread>
#include <vector>

#include "helibore/types.hpp"

namespace helibore {

// Calls run(worker) once on each of `threads` workers, the caller being worker 0. If the system grants fewer threads,
// the caller runs the missing workers' shares itself. The first exception is rethrown once all have stopped.
template <class Run>
void on_workers(int threads, const Run& run) {
    if (threads <= 1) return run(0);
    std::exception_ptr first_failure;
    std::mutex failure_lock;
    const auto guarded = [&](int worker) {
        try {
            run(worker);
        } catch (...) {
            const std::scoped_lock lock(failure_lock);
            if (!first_failure) first_failure = std::current_exception();
        }
    };
    {
        std::vector<std::jthread> crew;
        crew.reserve(static_cast<std::size_t>(threads - 1));
        int granted = 1;
        for (; granted < threads; ++granted) {
            try {
                crew.emplace_back(guarded, granted);
            } catch (const std::system_error&) {
                break;
            }
        }
        guarded(0);
        for (int worker = granted; worker < threads; ++worker) guarded(worker);
    }
    if (first_failure) std::rethrow_exception(first_failure);
}

// Part `which` of [0, n) cut into `parts` nearly equal ones.
inline Range part(Index n, int parts, int which) {
    return {n * which / parts, n * (which + 1) / parts};
}

// Calls run(worker, i) for every i in [0, parts), each worker taking the next one when it is free.
template <class Run>
void for_each_part(Index parts, int threads, const Run& run) {
    std::atomic<Index> next{0};
    on_workers(static_cast<int>(std::min<Index>(threads, parts)), [&](int worker) {
        for (Index i = next++; i < parts; i = next++) run(worker, i);
    });
}

}  // namespace helibore
