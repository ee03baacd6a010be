// Crowded and sparse samples and ties: arms that do not turn, a tool at one depth, a few depths, samples on a grid.
// Every instruction set, 1, 2 and 7 threads, every rounding of the host, traps, and any split give the bits of a batch
// with plain instructions, and these are the estimates of a slow search of all samples.
#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>

#include "check.hpp"
#include "helibore/error.hpp"
#include "hole.hpp"
#include "host.hpp"

using helibore::Index;
using helibore::InstructionSet;
using helibore::Settings;
using helibore::Wall;

namespace {

struct Shape {
    const char* name;
    Hole hole;
};

// Places samples i = 0, 1, ... of the 4 m below 100 m.
template <class Place>
Hole placed(std::size_t n, const Place& place) {
    Hole hole = oval_hole(n, 100.0, 4.0);
    for (std::size_t i = 0; i < n; ++i) place(i, static_cast<double>(i) / static_cast<double>(n), hole);
    return hole;
}

std::vector<Shape> shapes() {
    const std::size_t n = 1200 / reduced, crowd = 4500 / reduced;  // unreduced: more than a list of candidates holds
    return {{"four arms", placed(n,
                                 [](std::size_t i, double along, Hole& h) {
                                     h.depth[i] = 100.0 + 4.0 * along;
                                     h.toolface[i] = 17.0 + 90.0 * static_cast<double>(i % 4);
                                 })},
            {"one arm", placed(n,
                               [](std::size_t i, double along, Hole& h) {
                                   h.depth[i] = 100.0 + 4.0 * along;
                                   h.toolface[i] = 200.0;
                               })},
            {"one depth", placed(crowd, [](std::size_t i, double, Hole& h) { h.depth[i] = 102.0; })},
            {"few depths",
             placed(n, [](std::size_t i, double, Hole& h) { h.depth[i] = 100.0 + static_cast<double>(i % 5); })},
            {"all around", oval_hole(n / 4, 100.0, 4.0)},
            {"sparse", oval_hole(80, 100.0, 4.0)},  // max_distance decides
            {"ties", placed(n / 4, [](std::size_t i, double, Hole& h) {
                 h.depth[i] = 100.0 + std::floor(16.0 * (h.depth[i] - 100.0)) / 16.0;
                 h.toolface[i] = 22.5 * std::floor(h.toolface[i] / 22.5);
             })}};
}

std::vector<Settings> settings() {
    const Settings common{
        .bit_diameter = 0.216, .sectors = 16, .pitch = 0.11, .start_depth = 100.0, .stop_depth = 104.0};
    std::vector<Settings> all(9, common);
    all[1].neighbors = 32;
    all[2].window = 100;
    all[3].power = 0.7;
    all[4].angular_scale = 4.0;
    all[5].max_iterations = 20, all[5].tolerance = 0.0, all[5].neighbors = 1;
    all[6].max_distance = 0.05, all[6].pitch = -0.11, all[6].start_depth = 104.0, all[6].stop_depth = 100.0;
    all[7].angular_scale = 0.25, all[7].max_distance = 0.3, all[7].neighbors = 5, all[7].max_iterations = 15;
    all[8].estimator = helibore::Estimator::kriging, all[8].kriging_range = 0.5;
    return all;
}

struct Estimate {
    double radius = std::numeric_limits<double>::quiet_NaN(), nearest = radius;
    std::int32_t support = 0, iterations = 0;
};

// The method of the README in its plainest form, from samples in canonical order. Distances that agree to 2^-40 are
// ties, which canonical order decides.
Estimate slow_estimate(const Settings& s, const std::vector<std::vector<double>>& samples, double depth,
                       double toolface) {
    struct Near {
        std::uint64_t key;
        double square;
        std::size_t row;
    };
    std::size_t first = 0, last = samples[0].size();
    if (s.window) {
        const Index n = static_cast<Index>(last), length = std::min(*s.window, n);
        const auto below = std::ranges::upper_bound(samples[0], depth) - samples[0].begin();
        first = static_cast<std::size_t>(std::clamp<Index>(below - *s.window / 2, 0, n - length));
        last = first + static_cast<std::size_t>(length);
    }
    Estimate found;
    double trial = 0.5 * s.bit_diameter, before = trial;
    for (;;) {
        std::vector<Near> near;
        const double scale = trial * (s.angular_scale * std::numbers::pi / 180.0);
        for (std::size_t i = first; i < last; ++i) {
            const double turn = std::abs(samples[1][i] - toolface), along = samples[0][i] - depth;
            const double across = scale * std::min(turn, 360.0 - turn), square = across * across + along * along;
            if (across * across / (s.angular_scale * s.angular_scale) + along * along > s.max_distance * s.max_distance)
                continue;
            near.push_back({std::bit_cast<std::uint64_t>(square) >> 12, square, i});
        }
        const std::size_t count = std::min(near.size(), static_cast<std::size_t>(s.neighbors));
        std::ranges::stable_sort(near, {}, &Near::key);
        near.resize(count);
        ++found.iterations;
        found.support = static_cast<std::int32_t>(count);
        if (count == 0) return found;
        double weights = 0.0, weighted = 0.0, least = near[0].square, low = 2.0, high = 0.0;
        for (const Near& one : near) {
            least = std::min(least, one.square);
            low = std::min(low, samples[2][one.row]);
            high = std::max(high, samples[2][one.row]);
        }
        for (const Near& one : near) {
            const double weight =
                least <= 1e-40 ? (one.square <= 1e-40 ? 1.0 : 0.0) : std::pow(one.square, -0.5 * s.power);
            weights += weight;
            weighted += weight * samples[2][one.row];
        }
        const double estimate = std::clamp(weighted / weights, low, high);
        found.nearest = std::sqrt(least);
        found.radius = estimate;
        if (std::abs(estimate - trial) <= s.tolerance) return found;
        if (std::abs(estimate - before) <= s.tolerance) {
            found.radius = 0.5 * (estimate + trial);
            return found;
        }
        if (found.iterations == s.max_iterations) return found;
        before = trial;
        trial = estimate;
    }
}

void agrees_with_a_slow_search(const std::string& name, const Settings& s, const Wall& wall) {
    const std::vector<std::vector<double>> samples = wall.samples();
    const helibore::VertexColumns v = wall.vertices();
    int wrong = 0;
    for (std::size_t k = 0; k < v.radius.size(); k += 7) {
        const Estimate e = slow_estimate(s, samples, v.depth[k], v.toolface[k]);
        const bool same =
            e.support == v.support[k] && e.iterations == v.iterations[k] &&
            (e.support == 0 ? std::isnan(v.radius[k])
                            : std::abs(e.radius - v.radius[k]) < 1e-12 && std::abs(e.nearest - v.nearest[k]) < 1e-12);
        if (!same && ++wrong == 1)
            fail(__FILE__, __LINE__,
                 name + ", vertex " + std::to_string(k) + ": " + std::to_string(v.radius[k]) + " is not " +
                     std::to_string(e.radius));
    }
    CHECK(wrong == 0);
}

void every_way_gives_the_same(const std::string& name, const Settings& plain, const Hole& hole) {
    Wall expected(plain);
    expected.append(hole.all());
    const std::vector<std::uint64_t> wanted = bits(expected);
    const auto check_same = [&](const Wall& wall, const std::string& how) {
        if (bits(wall) != wanted) fail(__FILE__, __LINE__, name + ": other bits with " + how);
    };
    for (const InstructionSet set : {InstructionSet::plain, InstructionSet::avx2, InstructionSet::avx512}) {
        for (const int threads : {1, 2, 7}) {
            Settings other = plain;
            other.instruction_set = set;
            other.threads = threads;
            try {
                Wall wall(other);
                wall.append(hole.all());
                check_same(wall, "instruction set " + std::to_string(static_cast<int>(set)) + ", threads " +
                                     std::to_string(threads));
            } catch (const helibore::InputError&) {  // not this processor
            }
        }
    }
    Settings automatic = plain;
    automatic.instruction_set = InstructionSet::automatic;
    for (const int rounding : {FE_TONEAREST, FE_UPWARD, FE_DOWNWARD, FE_TOWARDZERO}) {
        Wall wall(automatic);
        {
            const HostState state(rounding, true);
            wall.append(hole.all());
        }
        check_same(wall, "rounding " + std::to_string(rounding));
    }
    Wall split(automatic);
    const std::size_t n = hole.depth.size(), third = n / 3;
    split.append(hole.rows(2 * third, n - 2 * third));
    split.append(hole.rows(0, third));
    for (std::size_t at = third; at < 2 * third; at += third / 4)
        split.append(hole.rows(at, std::min(third / 4, 2 * third - at)));
    check_same(split, "a split");
    if (plain.estimator == helibore::Estimator::inverse_distance) agrees_with_a_slow_search(name, plain, expected);
}

}  // namespace

int main() {
    for (const Shape& shape : shapes()) {
        int number = 0;
        for (Settings s : settings()) {
            s.instruction_set = InstructionSet::plain;
            every_way_gives_the_same(shape.name + std::string(", settings ") + std::to_string(number++), s, shape.hole);
        }
    }
    return failures();
}
