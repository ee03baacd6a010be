// Crowded and sparse samples and ties: arms that do not turn, a tool at one depth, a few depths, samples on a grid.
// Every instruction set, 1, 2 and 7 threads, every rounding of the host, traps, and any split give the bits of a batch
// with plain instructions, and these are the estimates of a slow search of all samples.
#include <algorithm>
#include <bit>
#include <cmath>
#include <numbers>
#include <numeric>
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
            {"fifty depths", placed(n, [](std::size_t i, double,
                                          Hole& h) { h.depth[i] = 100.0 + 0.08 * static_cast<double>(i % 50); })},
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
    std::vector<Settings> all(13, common);
    all[1].neighbors = 32;
    all[2].window = 100;
    all[3].power = 0.7;
    all[4].angular_scale = 4.0;
    all[5].max_iterations = 20, all[5].tolerance = 0.0, all[5].neighbors = 1;
    all[6].max_distance = 0.05, all[6].pitch = -0.11, all[6].start_depth = 104.0, all[6].stop_depth = 100.0;
    all[7].angular_scale = 0.25, all[7].max_distance = 0.3, all[7].neighbors = 5, all[7].max_iterations = 15;
    all[8].estimator = helibore::Estimator::kriging, all[8].kriging_range = 0.5;
    all[9].neighbors = 16, all[9].power = 0.5;
    all[10].neighbors = 256, all[10].power = 3.3;
    all[11].neighbors = 128, all[11].window = 1000;
    all[12].neighbors = 64, all[12].power = 2.0, all[12].max_iterations = 20;
    return all;
}

// Values that the rules for settings allow, but that nobody would choose.
std::vector<Settings> extreme_settings() {
    const Settings common{.bit_diameter = 0.216, .sectors = 5, .pitch = 0.5, .start_depth = 101.0, .stop_depth = 103.0};
    std::vector<Settings> all;
    const auto add = [&](const auto& set) {
        all.push_back(common);
        set(all.back());
    };
    constexpr double least = std::numeric_limits<double>::denorm_min(), most = std::numeric_limits<double>::max();
    for (const double value : {least, 1e-300, 1e-155, 1e155, most}) {
        add([&](Settings& s) { s.angular_scale = std::clamp(value, 0.001, 1000.0); });
        add([&](Settings& s) { s.power = std::min(value, 100.0); });
        add([&](Settings& s) { s.max_distance = std::max(value, 1e-9); });
        add([&](Settings& s) { s.tolerance = value; });
        add([&](Settings& s) {
            s.estimator = helibore::Estimator::kriging, s.kriging_range = value, s.nugget = std::max(value, 1e-6);
        });
        add([&](Settings& s) { s.power = std::min(value, 100.0), s.max_distance = 0.02, s.neighbors = 20; });
        add([&](Settings& s) { s.start_toolface = -std::min(value, 1e6); });
    }
    add([](Settings& s) { s.window = std::numeric_limits<Index>::max(); });
    add([](Settings& s) { s.bit_diameter = 0.001, s.neighbors = 1; });
    add([](Settings& s) { s.bit_diameter = 4.0, s.pitch = 1e7; });
    add([](Settings& s) { s.tolerance = helibore::no_limit, s.max_iterations = 255; });
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

// The radii of the samples, interpolated as values, are the radii of the wall.
void interpolates_its_own_radii(const std::string& name, const Wall& wall) {
    const std::vector<std::vector<double>> samples = wall.samples();
    const std::span<const double> radii(samples[2]);
    const std::vector<double> values = wall.interpolate_samples({&radii, 1})[0], radius = wall.radius();
    double most = 0.0;
    for (std::size_t k = 0; k < radius.size(); ++k)
        if (!std::isnan(radius[k])) most = std::max(most, std::abs(values[k] - radius[k]));
    if (most > 1e-9) fail(__FILE__, __LINE__, name + ": values differ by " + std::to_string(most));
}

// The samples by depth, as the bit meets them.
Hole drilled(const Hole& hole, bool down) {
    std::vector<std::size_t> order(hole.depth.size());
    std::iota(order.begin(), order.end(), std::size_t{0});
    std::ranges::stable_sort(order, [&](std::size_t a, std::size_t b) {
        return down ? hole.depth[a] < hole.depth[b] : hole.depth[a] > hole.depth[b];
    });
    Hole sorted;
    for (const std::size_t i : order) {
        sorted.depth.push_back(hole.depth[i]);
        sorted.toolface.push_back(hole.toolface[i]);
        sorted.radius.push_back(hole.radius[i]);
        sorted.time.push_back(hole.time[i]);
    }
    return sorted;
}

// A change names exactly the vertices that differ, and none that was settled.
void append_in_parts(Wall& wall, const Hole& hole) {
    const std::size_t part = hole.depth.size() / 6 + 1;
    for (std::size_t at = 0; at < hole.depth.size(); at += part) {
        const helibore::VertexColumns before = wall.vertices();
        const Index settled = wall.settled();
        const helibore::Change change = wall.append(hole.rows(at, std::min(part, hole.depth.size() - at)));
        const helibore::VertexColumns after = wall.vertices();
        const auto bits_of = [](double value) { return std::bit_cast<std::uint64_t>(value); };
        std::vector<helibore::Range> differing;
        for (std::size_t k = 0; k < after.radius.size(); ++k) {
            const bool same = k < before.radius.size() && bits_of(before.radius[k]) == bits_of(after.radius[k]) &&
                              bits_of(before.nearest[k]) == bits_of(after.nearest[k]) &&
                              before.support[k] == after.support[k] && before.iterations[k] == after.iterations[k];
            const auto here = static_cast<Index>(k);
            if (same) continue;
            if (differing.empty() || differing.back().stop != here) differing.push_back({here, here});
            differing.back().stop = here + 1;
        }
        CHECK(change.ranges == differing);
        CHECK(differing.empty() || differing[0].start >= settled);
    }
}

void every_way_gives_the_same(const std::string& name, const Settings& plain, const Hole& hole, bool usual) {
    Wall expected(plain);
    expected.append(hole.all());
    const std::vector<std::uint64_t> wanted = bits(expected);
    const auto check_same = [&](const Wall& wall, const std::string& how) {
        if (bits(wall) != wanted) fail(__FILE__, __LINE__, name + ": other bits with " + how);
    };
    for (const InstructionSet set : {InstructionSet::plain, InstructionSet::avx2, InstructionSet::avx512}) {
        Settings other = plain;
        other.instruction_set = set;
        try {
            Wall wall(other);
            wall.append(hole.all());
            check_same(wall, "instruction set " + std::to_string(static_cast<int>(set)));
        } catch (const helibore::InputError&) {  // not this processor
        }
    }
    Settings automatic = plain;
    automatic.instruction_set = InstructionSet::automatic;
    for (const int rounding : roundings) {
        Settings threaded = automatic;
        threaded.threads = rounding == FE_TONEAREST ? 7 : rounding == FE_UPWARD ? 2 : 1;
        Wall wall(threaded);
        {
            const HostState state(rounding, true);
            wall.append(hole.all());
        }
        check_same(wall, "rounding " + std::to_string(rounding) + ", threads " + std::to_string(threaded.threads));
    }
    Wall split(automatic);
    const std::size_t n = hole.depth.size(), third = n / 3;
    split.append(hole.rows(2 * third, n - 2 * third));
    split.append(hole.rows(0, third));
    for (std::size_t at = third; at < 2 * third; at += third / 4)
        split.append(hole.rows(at, std::min(third / 4, 2 * third - at)));
    check_same(split, "a split");
    if (!usual) return;
    Wall deeper(automatic);
    append_in_parts(deeper, drilled(hole, plain.pitch > 0.0));
    check_same(deeper, "appends down the hole");
    if (plain.estimator == helibore::Estimator::inverse_distance) {
        agrees_with_a_slow_search(name, plain, expected);
        interpolates_its_own_radii(name, expected);
    }
}

// Enough vertices that threads share them: each begins its search elsewhere.
void threads_share_the_work(const Shape& shape) {
    Settings many{.bit_diameter = 0.216, .sectors = 64, .pitch = 0.02, .start_depth = 100.0};
    many.stop_depth = reduced > 1 ? 101.3 : 104.0;
    for (const int neighbors : {8, 64}) {
        many.neighbors = neighbors;
        many.power = neighbors == 8 ? 1.0 : 0.5;
        std::vector<std::uint64_t> one;
        for (const int threads : {1, 2, 7}) {
            many.threads = threads;
            Wall wall(many);
            wall.append(shape.hole.all());
            if (threads == 1) one = bits(wall);
            if (bits(wall) != one)
                fail(__FILE__, __LINE__, shape.name + std::string(": other bits on ") + std::to_string(threads));
        }
    }
}

// Many estimates alternate between two radii. Few samples above the others make the boxes high, so that the lists are
// full and a later list holds the neighbours at one radius only.
void interpolates_means_of_two_radii() {
    for (const double pitch : {7.0, 3.0, 1.0}) {
        Hole hole = oval_hole(9000, 103.0, 8.0);
        for (std::size_t i = 0; i < 9000; ++i) {
            hole.radius[i] = 0.05 + 0.25 * std::fmod(hole.depth[i] * 7919.0, 1.0);
            if (i < 4) hole.depth[i] = 100.0 + static_cast<double>(i);
        }
        Wall wall({.bit_diameter = 0.1,
                   .sectors = 18,
                   .pitch = pitch,
                   .neighbors = 6,
                   .power = 0.5,
                   .max_distance = 100.0,
                   .max_iterations = 18,
                   .tolerance = 0.01,
                   .angular_scale = 2.0});
        wall.append(hole.all());
        interpolates_its_own_radii("pitch " + std::to_string(pitch), wall);
    }
}

}  // namespace

int main() {
    interpolates_means_of_two_radii();
    for (const Shape& shape : shapes()) {
        threads_share_the_work(shape);
        for (const bool usual : {true, false}) {
            if (!usual && shape.name != std::string("one depth") && shape.name != std::string("all around")) continue;
            int number = 0;
            for (Settings s : usual ? settings() : extreme_settings()) {
                s.instruction_set = InstructionSet::plain;
                const std::string name =
                    shape.name + std::string(usual ? ", settings " : ", extreme settings ") + std::to_string(number++);
                every_way_gives_the_same(name, s, shape.hole, usual);
            }
        }
    }
    return failures();
}
