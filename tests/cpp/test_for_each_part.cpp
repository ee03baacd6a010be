// Shared out work: each part is done once, one worker does one part at a time, exceptions reach the caller, callers may
// come at once and from a forked process, and no thread is left behind. Run it under ThreadSanitizer, too.
#include <chrono>
#include <stdexcept>
#include <thread>
#include <vector>

#include "base/threads.hpp"
#include "check.hpp"

#if defined(__unix__) || defined(__APPLE__)
#include <sys/wait.h>
#include <unistd.h>
#endif
#ifdef __linux__
#include <filesystem>
#endif

using namespace helibore;

namespace {

// Returns how many workers took part.
int each_part_once(int threads, Index parts) {
    std::vector<std::atomic<int>> runs(static_cast<std::size_t>(parts));
    std::vector<std::atomic<bool>> busy(static_cast<std::size_t>(threads)), seen(static_cast<std::size_t>(threads));
    for_each_part(threads, parts, [&](int worker, Index part) {
        CHECK(!busy[static_cast<std::size_t>(worker)].exchange(true));
        seen[static_cast<std::size_t>(worker)] = true;
        ++runs[static_cast<std::size_t>(part)];
        busy[static_cast<std::size_t>(worker)] = false;
    });
    for (const auto& times : runs) CHECK(times == 1);
    int workers = 0;
    for (const auto& one : seen) workers += one;
    return workers;
}

void does_each_part_once() {
    for (const int threads : {1, 2, 7})
        for (const Index parts : {0, 1, 2, 3, 100, 5000})
            for (int again = 0; again < 20; ++again) CHECK(each_part_once(threads, parts) <= threads);
}

void ranges_make_up_the_whole() {
    for (const int threads : {1, 3})
        for (const Index count : {0, 1, 9, 10, 11, 1000}) {
            std::vector<std::atomic<int>> runs(static_cast<std::size_t>(count));
            for_each_range(threads, count, 10, [&](int, const Range& range) {
                CHECK(range.start < range.stop && range.stop - range.start <= 10);
                for (Index i = range.start; i < range.stop; ++i) ++runs[static_cast<std::size_t>(i)];
            });
            for (const auto& times : runs) CHECK(times == 1);
        }
}

void starts_threads_for_enough_work_only() {
    CHECK(threads_for(11, 4, 4) == 2);
    CHECK(threads_for(3, 4, 4) == 1);
    CHECK(threads_for(1000, 4, 4) == 4);
    CHECK(threads_for(1000, 4, 0) == 1);
}

// Two parts that wait for each other can only be done by two workers at once.
bool two_at_once() {
    std::atomic<int> here{0};
    const auto until = std::chrono::steady_clock::now() + std::chrono::seconds(20);
    for_each_part(2, 2, [&](int, Index) {
        ++here;
        while (here < 2 && std::chrono::steady_clock::now() < until) std::this_thread::yield();
    });
    return here == 2 && std::chrono::steady_clock::now() < until;
}

void passes_on_exceptions() {
    for (const int threads : {1, 3})
        for (Index failing = 0; failing < 300; ++failing) {
            std::atomic<int> finished{0};
            const auto job = [&](int, Index part) {
                if (part == failing) throw std::runtime_error("part");
                ++finished;
            };
            CHECK_THROWS(std::runtime_error, "part", for_each_part(threads, 300, job));
            CHECK(finished < 300);
        }
}

void serves_callers_at_once() {
    std::vector<std::jthread> callers;
    for (int caller = 0; caller < 4; ++caller)
        callers.emplace_back([caller] {
            for (int i = 0; i < 200; ++i) each_part_once(1 + (i + caller) % 3, 40);
        });
}

void leaves_no_thread() {
#ifdef __linux__
    const auto count = [] {
        const std::filesystem::directory_iterator tasks("/proc/self/task");
        return std::distance(begin(tasks), end(tasks));
    };
    const auto before = count();
    for (int i = 0; i < 100; ++i) each_part_once(5, 50);
    for (int i = 0; i < 100 && count() > before; ++i) std::this_thread::sleep_for(std::chrono::milliseconds(10));
    CHECK(count() == before);  // the system may list a joined thread a moment longer
#endif
}

void forked() {
#if (defined(__unix__) || defined(__APPLE__)) && \
    !defined(__SANITIZE_THREAD__)  // which does not follow threads into a fork
    CHECK(two_at_once());
    const pid_t child = fork();
    if (child == 0) _exit(two_at_once() && two_at_once() ? 0 : 1);
    int status = -1;
    CHECK(waitpid(child, &status, 0) == child);
    CHECK(WIFEXITED(status) && WEXITSTATUS(status) == 0);
    CHECK(two_at_once());
#endif
}

}  // namespace

int main() {
    does_each_part_once();
    ranges_make_up_the_whole();
    starts_threads_for_enough_work_only();
    passes_on_exceptions();
    serves_callers_at_once();
    leaves_no_thread();
    forked();
    return failures();
}
