// A runner of the host that calls the library again, and a process that is forked while a thread is in a call: each
// call returns, or says why it cannot.
#include <atomic>
#include <functional>
#include <thread>

#include "check.hpp"
#include "helibore/error.hpp"
#include "helibore/live.hpp"
#include "helibore/runner.hpp"
#include "hole.hpp"

#ifdef __unix__
#include <sys/wait.h>
#include <unistd.h>
#endif

using namespace helibore;

namespace {

// Calls `meanwhile` once, as a pool does that helps with other work while it waits.
struct Pool {
    std::function<void()> meanwhile;
    int calls = 0;

    static void run(void* host, std::int32_t workers, Runner::Job job, void* context) {
        auto& pool = *static_cast<Pool*>(host);
        job(context, 0);
        if (pool.calls++ == 0) pool.meanwhile();
        for (std::int32_t w = 1; w < workers; ++w) job(context, w);
    }
};

Settings two_threads() {
    Settings settings{.bit_diameter = 0.216, .start_depth = 100.0};
    settings.threads = 2;
    return settings;
}

template <class Call>
std::string error_of(const Call& call) {
    try {
        call();
    } catch (const InputError& error) {
        return error.what();
    }
    return "none";
}

void calls_of_the_same_thread(const Hole& hole) {
    Wall wall(two_threads()), other(two_threads()), expected(two_threads());
    const std::string said = "this wall: is being appended to or read in this thread";
    expected.append(hole.all());
    Pool pool{[&] {
        CHECK(error_of([&] { static_cast<void>(wall.size()); }) == said);
        CHECK(error_of([&] { static_cast<void>(wall.vertices()); }) == said);
        CHECK(error_of([&] { wall.append(hole.all()); }) == said);
        other.append(hole.all());  // another object
    }};
    const UseRunner use({Pool::run, &pool});
    wall.append(hole.all());
    CHECK(pool.calls > 1);
    CHECK(bits(wall) == bits(expected));
    CHECK(bits(other) == bits(expected));

    pool.calls = 0;
    pool.meanwhile = [&] { CHECK(error_of([&] { wall.append({}); }) == said); };
    std::vector<double> radius(static_cast<std::size_t>(wall.size()));
    CHECK(wall.read_radius(radius) == wall.size());  // a read that shares out its work
    static_cast<void>(wall.interpolate_samples({}, 2));
    CHECK(pool.calls > 0);
}

void a_live_well(const Hole& hole) {
    Live live({.wall = two_threads(), .path = {}});
    Pool pool{[&] {
        CHECK(error_of([&] { live.poll(); }) == "this live well: is being appended to or read in this thread");
        CHECK(error_of([&] { static_cast<void>(live.wall().size()); }) ==
              "this wall: is being appended to or read in this thread");
    }};
    const UseRunner use({Pool::run, &pool});
    live.append_samples(hole.all());
    CHECK(pool.calls > 1);
    CHECK(live.poll().change->accepted == static_cast<Index>(hole.depth.size()));
}

#if defined(__unix__) && !defined(__SANITIZE_THREAD__)
void a_fork_while_another_thread_appends(const Hole& hole) {
    Wall wall(two_threads());
    std::atomic<bool> inside{false}, forked{false};
    std::thread appends([&] {
        Pool pool{[&] {
            inside = true;
            while (!forked) std::this_thread::yield();
        }};
        const UseRunner use({Pool::run, &pool});
        wall.append(hole.all());
    });
    while (!inside) std::this_thread::yield();
    const pid_t child = fork();
    if (child == 0) {
        alarm(20);
        const bool refused = error_of([&] { static_cast<void>(wall.size()); }) ==
                             "this wall: was in use by another thread when this process was forked";
        Wall fresh(two_threads());
        fresh.append(hole.all());
        _exit(refused && fresh.size() > 0 ? 0 : 1);
    }
    int status = -1;
    CHECK(waitpid(child, &status, 0) == child && status == 0);
    forked = true;
    appends.join();
    CHECK(wall.sample_count() == static_cast<Index>(hole.depth.size()));
}
#endif

}  // namespace

int main() {
    const Hole hole = oval_hole(70'000, 100.0, 40.0);
    calls_of_the_same_thread(hole);
    a_live_well(hole);
#if defined(__unix__) && !defined(__SANITIZE_THREAD__)
    a_fork_while_another_thread_appends(hole);
#endif
    return failures();
}
