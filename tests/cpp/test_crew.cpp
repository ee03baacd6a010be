// Crew: each share of each job runs once, never two of one number at once; exceptions come out and leave it usable.
// Thousands of short jobs, so that helpers start late, wake up late and meet the next job; run it under TSan, too.
#include "../../cpp/src/parallel.hpp"

#include <stdexcept>

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
            crew.for_each_part(parts, [&](int worker, Index i) {
                CHECK(!busy[static_cast<std::size_t>(worker)].exchange(true));
                ++runs[static_cast<std::size_t>(i)];
                busy[static_cast<std::size_t>(worker)] = false;
            });
            for (const auto& times : runs) CHECK(times == 1);
        }
    }
}

void starts_no_more_than_it_is_worth() {
    Crew crew(4);
    std::atomic<int> highest{0};
    crew.for_each_part(11, [&](int worker, Index) { highest = std::max(highest.load(), worker); }, 4);
    CHECK(highest <= 1);
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
    starts_no_more_than_it_is_worth();
    passes_on_exceptions();
    return failures();
}
