// Crew: each share of each job runs once, never two of one number at once; exceptions come out and leave it usable.
// Thousands of short jobs and calls, so that helpers start late, wake up late, linger, end and meet the next job; run
// it under TSan, too. And Crews: what one call leaves serves the next.
#include "base/threads.hpp"

#if defined(__unix__) || defined(__APPLE__)
#include <sys/wait.h>
#include <unistd.h>
#endif

#include <set>
#include <stdexcept>
#include <vector>

#include "check.hpp"

using namespace helibore;

namespace {

void runs_each_share_once() {
    for (int threads = 1; threads <= 5; ++threads) {
        Crew crew(threads);
        for (int job = 0; job < 2000; ++job) {
            const int shares = 1 + job % threads;
            std::vector<std::atomic<int>> runs(static_cast<std::size_t>(shares));
            crew.run(shares, [&](int share) { ++runs[static_cast<std::size_t>(share)]; });
            for (const auto& times : runs) CHECK(times == 1);
        }
    }
}

void runs_each_part_once() {
    for (const int threads : {1, 2, 7}) {
        Crew crew(threads);
        for (const Index parts : {0, 1, 2, 3, 100, 5000}) {
            std::vector<std::atomic<int>> runs(static_cast<std::size_t>(parts));
            std::vector<std::atomic<bool>> busy(static_cast<std::size_t>(threads));
            crew.for_each_part(threads, parts, [&](int worker, Index i) {
                CHECK(!busy[static_cast<std::size_t>(worker)].exchange(true));
                ++runs[static_cast<std::size_t>(i)];
                busy[static_cast<std::size_t>(worker)] = false;
            });
            for (const auto& times : runs) CHECK(times == 1);
        }
    }
}

void sleep_for(int microseconds) {
    std::this_thread::sleep_for(std::chrono::microseconds(microseconds));
}

// A call as a wall makes it: two jobs, something serial between them. Returns the threads that took part.
std::set<std::thread::id> call(Crews& crews, int shares) {
    const Shift shift(&crews, shares);
    Crew& crew = shift.crew();
    std::mutex lock;
    std::set<std::thread::id> threads;
    for (int job = 0; job < 2; ++job) {
        std::vector<std::atomic<int>> runs(40);
        crew.for_each_part(shares, 40, [&](int, Index i) {
            ++runs[static_cast<std::size_t>(i)];
            const std::scoped_lock held(lock);
            threads.insert(std::this_thread::get_id());
        });
        for (const auto& times : runs) CHECK(times == 1);
    }
    return threads;
}

// Pauses around those after which helpers end, so that calls meet them in every state; and a crew that goes in any.
void serves_calls_at_any_pace() {
    for (const int threads : {2, 3}) {
        for (int life = 0; life < 40; ++life) {
            Crews crews;
            for (int i = 0; i < 40; ++i) {
                call(crews, threads);
                if (i % 3 != 0) sleep_for((i * 7 + life) % 90);
            }
            if (life % 2 == 0) sleep_for(life);
        }
    }
}

// Of helpers that linger and of such that had to be started anew.
void passes_on_exceptions_in_any_call() {
    Crews crews;
    for (int i = 0; i < 300; ++i) {
        {
            const Shift shift(&crews, 3);
            const auto fails = [](int share) {
                if (share > 0) throw std::runtime_error("share");
            };
            CHECK_THROWS(std::runtime_error, "share", shift.crew().run(3, fails));
        }
        call(crews, 3);
        sleep_for(i % 4 * 30);
    }
}

void weighs_what_is_worth_a_thread() {
    Crews crews;
    {
        const Shift shift(&crews, 4);
        CHECK(shift.crew().shares_worth(11, 4, 1) == 2);  // started for it: 4 of 11 for each
        CHECK(shift.crew().shares_worth(3, 4, 1) == 1);
        CHECK(shift.crew().shares_worth(1000, 4, 1) == 4);
    }
    // Calls at once after each other are a stream from some on, a pair is not. On a busy machine it may take many.
    bool streamed = false;
    for (int i = 0; i < 1000000 && !streamed; ++i) {
        const Shift shift(&crews, 4);
        streamed = shift.crew().shares_worth(3, 4, 1) == 3;
        CHECK(i > 2 || shift.crew().shares_worth(3, 4, 1) == 1);
    }
    CHECK(streamed);
    sleep_for(1000);
    const Shift late(&crews, 4);
    CHECK(late.crew().shares_worth(3, 4, 1) == 1);
}

// A helper that is still there is worth less work than one that must be started, and only that one is.
void uses_who_is_there() {
    Crews crews;
    Index worth = 0;
    for (int i = 0; i < 2000 && worth < 2; ++i) {
        sleep_for(2000);
        {
            const Shift shift(&crews, 4);
            shift.crew().run(2, [](int) {});
        }
        const Shift shift(&crews, 4);
        worth = shift.crew().shares_worth(100, 1000, 1);
        CHECK(worth <= 2);
    }
    CHECK(worth == 2);
}

// One thread's wall between those of two: its calls leave the helpers alone.
void serves_calls_of_other_widths() {
    Crews crews;
    for (int i = 0; i < 2000; ++i) call(crews, 1 + i * 7 % 4);
}

// The longer calls take, the longer their helpers wait for the next.
void lingers_a_tenth_of_the_work() {
    Crews crews;
    const auto found_after = [&](int pause) {
        sleep_for(3000);
        {
            const Shift shift(&crews, 2);
            shift.crew().run(2, [](int) { sleep_for(8000); });
        }
        sleep_for(pause);
        const Shift shift(&crews, 2);
        return shift.crew().shares_worth(100, 1000, 1) == 2;
    };
    bool found = false;
    for (int i = 0; i < 200 && !found; ++i) found = found_after(200);  // 50 us alone would not do
    CHECK(found);
    CHECK(!found_after(2000));
}

// Threads that call at once have crews of their own, and each is served.
void serves_callers_at_once() {
    Crews crews;
    std::vector<std::thread> callers;
    for (int c = 0; c < 4; ++c)
        callers.emplace_back([&, c] {
            for (int i = 0; i < 300; ++i) call(crews, 1 + (i + c) % 3);
        });
    for (std::thread& caller : callers) caller.join();
}

// A forked process has the crews and none of their threads: it starts its own.
void forked() {
#if (defined(__unix__) || defined(__APPLE__)) && \
    !defined(__SANITIZE_THREAD__)  // which does not follow threads into a fork
    Crews crews;
    const auto both_take_part = [&] {
        const Shift shift(&crews, 2);
        std::atomic<int> here{0};
        const auto until = std::chrono::steady_clock::now() + std::chrono::seconds(20);
        shift.crew().run(2, [&](int) {
            ++here;
            sleep_for(10'000);  // so that the helper lingers a while
            while (here < 2 && std::chrono::steady_clock::now() < until) std::this_thread::yield();
        });
        return std::chrono::steady_clock::now() < until;
    };
    CHECK(both_take_part());
    const pid_t child = fork();  // while the helper lingers
    if (child == 0) _exit(both_take_part() && both_take_part() ? 0 : 1);
    int status = -1;
    CHECK(waitpid(child, &status, 0) == child);
    CHECK(WIFEXITED(status) && WEXITSTATUS(status) == 0);
    CHECK(both_take_part());
#endif
}

void passes_on_exceptions() {
    Crew crew(3);
    for (int job = 0; job < 300; ++job) {
        std::atomic<int> finished{0};
        const auto job_that_fails = [&](int share) {
            if (share == job % 3) throw std::runtime_error("share");
            ++finished;
        };
        CHECK_THROWS(std::runtime_error, "share", crew.run(3, job_that_fails));
        CHECK(finished == 2);
        crew.run(3, [&](int) { ++finished; });
        CHECK(finished == 5);
    }
}

}  // namespace

int main() {
    runs_each_share_once();
    runs_each_part_once();
    weighs_what_is_worth_a_thread();
    uses_who_is_there();
    serves_calls_of_other_widths();
    lingers_a_tenth_of_the_work();
    serves_callers_at_once();
    forked();
    serves_calls_at_any_pace();
    passes_on_exceptions_in_any_call();
    passes_on_exceptions();
    return failures();
}
