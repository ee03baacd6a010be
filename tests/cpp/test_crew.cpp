// Crew: each share of each job runs once, never two of one number at once; exceptions come out and leave it usable.
// Thousands of short jobs and calls, so that helpers start late, wake up late, linger, end and meet the next job; run
// it under TSan, too.
#include "../../cpp/src/parallel.hpp"

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
std::set<std::thread::id> call(Crew& crew, int shares) {
    const Crew::Shift shift(crew);
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
            Crew crew(threads);
            for (int i = 0; i < 40; ++i) {
                call(crew, threads);
                if (i % 3 != 0) sleep_for((i * 7 + life) % 90);
            }
            if (life % 2 == 0) sleep_for(life);
        }
    }
}

// Of helpers that linger and of such that had to be started anew.
void passes_on_exceptions_in_any_call() {
    Crew crew(3);
    for (int i = 0; i < 300; ++i) {
        {
            const Crew::Shift shift(crew);
            const auto fails = [](int share) {
                if (share > 0) throw std::runtime_error("share");
            };
            CHECK_THROWS(std::runtime_error, "share", crew.run(3, fails));
        }
        call(crew, 3);
        sleep_for(i % 4 * 30);
    }
}

void weighs_what_is_worth_a_thread() {
    Crew crew(4);
    {
        const Crew::Shift shift(crew);
        CHECK(crew.shares_worth(11, 4, 1) == 2);  // started for it: 4 of 11 for each
        CHECK(crew.shares_worth(3, 4, 1) == 1);
        CHECK(crew.shares_worth(1000, 4, 1) == 4);
    }
    // Calls at once after each other are a stream from some on, a pair is not. On a busy machine it may take many.
    bool streamed = false;
    for (int i = 0; i < 1000000 && !streamed; ++i) {
        const Crew::Shift shift(crew);
        streamed = crew.shares_worth(3, 4, 1) == 3;
        CHECK(i > 2 || crew.shares_worth(3, 4, 1) == 1);
    }
    CHECK(streamed);
    sleep_for(1000);
    const Crew::Shift late(crew);
    CHECK(crew.shares_worth(3, 4, 1) == 1);
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
    serves_calls_at_any_pace();
    passes_on_exceptions_in_any_call();
    passes_on_exceptions();
    return failures();
}
