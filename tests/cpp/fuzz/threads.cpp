// Programs of threads: two to four threads append to one wall and read it, some through a runner that calls the wall
// again, while another thread writes into the arrays. Each call returns or throws InputError, and the wall's samples
// keep their rules. The writes are data races on purpose, so the thread sanitizer gets programs without them.
#include <thread>

#include "helibore/runner.hpp"
#include "walls.hpp"

#ifdef __unix__
#include <unistd.h>
#endif

using helibore::Index;
using helibore::Range;
using helibore::Wall;

namespace {

enum class Step { append, size, radius, column, samples, interpolate, reach, write };

struct Shared {
    Wall& wall;
    Hole& hole;
    bool timed;
};

void do_step(const Shared& shared, Step step, std::size_t number) {
    const auto& [wall, hole, timed] = shared;
    const std::size_t n = hole.depth.size(), first = number % n, some = std::min<std::size_t>(n - first, 1 + number);
    switch (step) {
        case Step::append: {
            helibore::SampleColumns rows = hole.rows(first, some);
            if (!timed) rows.time = {};
            wall.append(rows);
            return;
        }
        case Step::size:
            static_cast<void>(wall.size() + wall.sample_count() + wall.settled());
            return;
        case Step::radius: {
            std::vector<double> into(static_cast<std::size_t>(wall.size()));
            static_cast<void>(wall.read_radius(into));
            return;
        }
        case Step::column: {
            std::vector<double> into(number % 16);
            wall.read(static_cast<helibore::Column>(number % 7), {0, static_cast<Index>(into.size())}, into);
            return;
        }
        case Step::samples:
            static_cast<void>(wall.samples());
            return;
        case Step::interpolate: {
            const auto samples = wall.samples();
            const std::span<const double> depth(samples[0]);
            static_cast<void>(wall.interpolate_samples({&depth, 1}, 1 + static_cast<int>(number % 3)));
            return;
        }
        case Step::reach:
            static_cast<void>(wall.reach({0, static_cast<Index>(number % 40)}));
            return;
        case Step::write:
#ifndef __SANITIZE_THREAD__
            for (auto* column : {&hole.depth, &hole.toolface, &hole.radius})
                for (std::size_t i = 1; i < n; ++i) std::swap((*column)[i], (*column)[number % i]);
#endif
            return;
    }
}

// Does a step of the program while a call waits for its workers.
struct Pool {
    Shared shared;
    Step step;
    std::size_t number;
    int depth = 0;

    static void run(void* host, std::int32_t workers, helibore::Runner::Job job, void* context) {
        auto& pool = *static_cast<Pool*>(host);
        if (pool.depth++ == 0) refused([&] { do_step(pool.shared, pool.step, pool.number); });
        --pool.depth;
        for (std::int32_t w = 0; w < workers; ++w) job(context, w);
    }
};

}  // namespace

void fuzz(Input input) {
#ifdef __unix__
    alarm(120);  // a call that never returns ends the program
#endif
    WallInput made = wall_input(input);
    auto wall = wall_of(made.settings);
    if (!wall) return;
    double clock = 0.0;
    Hole hole = samples_input(input, made, clock);
    if (input.one_in(16))
        for (const Hole once = hole; hole.depth.size() < 70'000;) add_rows(hole, once);
    const Shared shared{*wall, hole, made.timed};
    struct Work {
        Step step;
        std::size_t number;
    };
    std::vector<std::vector<Work>> programs(static_cast<std::size_t>(input.between(2, 4)));
    std::vector<Work> within;
    for (auto& program : programs) {
        for (int i = input.between(1, 10); i > 0; --i)
            program.push_back({static_cast<Step>(input.below(8)), input.below(65536)});
        within.push_back({static_cast<Step>(input.below(8)), input.below(65536)});
    }
    std::vector<std::jthread> threads;
    for (std::size_t t = 0; t < programs.size(); ++t)
        threads.emplace_back([&, t] {
            Pool pool{shared, within[t].step, within[t].number};
            std::optional<helibore::UseRunner> use;
            if (t % 2 == 1) use.emplace(helibore::Runner{Pool::run, &pool});
            for (const Work& work : programs[t]) refused([&] { do_step(shared, work.step, work.number); });
        });
    threads.clear();
    const auto samples = wall->samples();
    require_rule(std::ranges::is_sorted(samples[0]), "samples lie in the order of depth");
    for (std::size_t i = 0; i < samples[0].size(); ++i)
        require_rule(std::abs(samples[0][i]) <= 1e7 && samples[1][i] >= 0.0 && samples[1][i] < 360.0 &&
                         samples[2][i] > 0.0 && samples[2][i] <= 2.0,
                     "samples keep their rules");
}
