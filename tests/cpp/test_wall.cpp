// The C++ interface of the wall: what the README shows, the error texts, moves, threads. The values themselves are
// compared with an independent reference in tests/python.
#include "helibore/wall.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <thread>

#include "check.hpp"
#include "helibore/error.hpp"
#include "helibore/surface.hpp"
#include "hole.hpp"
#include "host.hpp"

using namespace helibore;

namespace {

constexpr double nan = std::numeric_limits<double>::quiet_NaN();

void reconstructs() {
    const Hole hole = oval_hole(4000, 100.0, 5.0);
    Wall wall({.bit_diameter = 0.216, .sectors = 32, .pitch = 0.1});
    CHECK(wall.size() == 0);
    CHECK(std::isnan(wall.start_depth()));
    const Change change = wall.append(hole.all());
    CHECK(wall.size() > 1500 && wall.size() < 1602);
    CHECK(change.ranges == (std::vector<Range>{{0, wall.size()}}));
    CHECK(change.accepted == 4000 && change.redundant == 0);
    CHECK(change.settled == wall.settled() && change.settled > 1400);
    CHECK(wall.sample_count() == 4000);
    const std::vector<double> radius = wall.radius();
    CHECK(std::all_of(radius.begin(), radius.end(), [](double r) { return r >= 0.108 && r <= 0.178; }));
    CHECK(wall.depth()[32] == wall.start_depth() + 0.1);
    CHECK(wall.toolface()[8] == 90.0);
    CHECK(wall.settings().sectors == 32);

    const VertexColumns part = wall.vertices({5, 15}), all = wall.vertices();
    CHECK(std::equal(part.radius.begin(), part.radius.end(), radius.begin() + 5));
    CHECK(part.depth.size() == 10 && part.depth[0] == wall.depth()[5] && part.toolface[9] == wall.toolface()[14]);
    CHECK(all.nearest == wall.nearest() && all.support == wall.support() && all.iterations == wall.iterations());
    CHECK(all.provisional == std::vector<std::uint8_t>(all.radius.size(), 0));
    const Surface surface =
        surface_of({.start_depth = wall.start_depth(), .pitch = 0.1, .sectors = 32, .radius = radius});
    CHECK(static_cast<Index>(surface.vertices.size()) == wall.size());
    CHECK(static_cast<Index>(surface.quads.size()) == wall.size() - 33);
}

void splits_and_moves() {
    const Hole hole = oval_hole(3000, 0.0, 3.0);
    const Settings settings{.bit_diameter = 0.216, .sectors = 16, .pitch = -0.25, .threads = 2};
    Wall once(settings), split(settings);
    once.append(hole.all());
    split.append(hole.rows(2000, 1000));
    Wall moved(std::move(split));
    moved.append(hole.rows(0, 2000));
    CHECK(moved.append(hole.rows(10, 20)).redundant == 20);
    CHECK(bits(moved) == bits(once));
    split = std::move(moved);
    CHECK(bits(split) == bits(once));
    CHECK(split.append({}).ranges.empty());
}

// -0 is the depth 0, also where it becomes the depth that the wall starts at.
void starts_at_zero() {
    for (const double pitch : {-0.03, 0.03})
        for (const double first : {0.0, -0.0}) {
            Wall wall({.bit_diameter = 1.0, .sectors = 11, .pitch = pitch});
            for (const double depth : {first, -first}) {
                const std::vector<double> at{depth}, toolface{100.0 + 50.0 * std::signbit(depth)}, radius{0.2};
                wall.append({.depth = at, .toolface = toolface, .radius = radius});
                CHECK(wall.size() == 1 && wall.depth()[0] == 0.0 && !std::signbit(wall.depth()[0]));
                CHECK(!std::signbit(wall.start_depth()));
            }
        }
}

// A radius of the least positive number: as a trial radius, it brings all toolfaces together.
void takes_the_least_radius() {
    constexpr double least = std::numeric_limits<double>::denorm_min();
    const std::vector<double> depth = {1000.0, 1000.015625, 1000.03125, 1000.5}, toolface = {36.6, 135.0, 300.0, 10.0};
    const std::vector<double> radius = {0.17, least, 0.08, 0.1};
    for (const InstructionSet set : {InstructionSet::plain, InstructionSet::automatic}) {
        Wall wall({.bit_diameter = 0.216,
                   .sectors = 3,
                   .start_depth = 1000.0,
                   .neighbors = 1,
                   .max_iterations = 11,
                   .instruction_set = set});
        wall.append({depth, toolface, radius});
        CHECK(wall.radius()[1] == 0.04);  // its estimates alternate between the second sample and the third
        CHECK(wall.iterations()[1] == 3 && std::abs(wall.nearest()[1] - 0.0273) < 1e-3);
    }
}

void refuses_settings() {
    CHECK_THROWS(InputError, "bit_diameter = 0: must be finite and above 0", Wall(Settings{}));
    CHECK_THROWS(InputError, "pitch = 0: must be finite and not 0", Wall({.bit_diameter = 0.2, .pitch = 0.0}));
    CHECK_THROWS(InputError, "pitch = 1e+155: must lie in -10000000 to 10000000 m",
                 Wall({.bit_diameter = 0.2, .pitch = 1e155}));
    CHECK_THROWS(InputError, "sectors = 2: must lie in 3 to 1000000", Wall({.bit_diameter = 0.2, .sectors = 2}));
    CHECK_THROWS(InputError, "start_depth = nan: must be finite", Wall({.bit_diameter = 0.2, .start_depth = nan}));
    CHECK_THROWS(InputError, "neighbors = 257: must lie in 1 to 256", Wall({.bit_diameter = 0.2, .neighbors = 257}));
    CHECK_THROWS(InputError, "window = 0: must be at least 1", Wall({.bit_diameter = 0.2, .window = 0}));
    CHECK_THROWS(InputError, "threads = 0: must lie in 1 to 1024", Wall({.bit_diameter = 0.2, .threads = 0}));
    CHECK_THROWS(InputError, "bit_diameter = 1e-200: must be at least 0.001 m", Wall({.bit_diameter = 1e-200}));
    CHECK_THROWS(InputError, "stop_depth = 1e+155: must lie in -10000000 to 10000000 m",
                 Wall({.bit_diameter = 0.2, .stop_depth = 1e155}));
    for (const double power : {1e300, 101.0})
        CHECK_THROWS(InputError, "power = " + std::string(power == 101.0 ? "101" : "1e+300") + ": must be at most 100",
                     Wall({.bit_diameter = 0.2, .power = power}));
    CHECK_THROWS(InputError, "power = nan: must be finite and above 0", Wall({.bit_diameter = 0.2, .power = nan}));
    CHECK_THROWS(InputError, "max_distance = 1e-200: must be at least 1e-9 m",
                 Wall({.bit_diameter = 0.2, .max_distance = 1e-200}));
    CHECK_THROWS(InputError, "angular_scale = 1e-155: must lie in 0.001 to 1000",
                 Wall({.bit_diameter = 0.2, .angular_scale = 1e-155}));
    CHECK_THROWS(InputError, "angular_scale = 1001: must lie in 0.001 to 1000",
                 Wall({.bit_diameter = 0.2, .angular_scale = 1001.0}));
    CHECK_THROWS(InputError, "start_toolface = 1e+18: must lie in -1000000 to 1000000 degrees",
                 Wall({.bit_diameter = 0.2, .start_toolface = 1e18}));
    CHECK_THROWS(InputError, "most_vertices = 0: must lie in 1 to 2147483647",
                 Wall({.bit_diameter = 0.2, .most_vertices = 0}));
    CHECK_THROWS(InputError, "first_vertex = 65: must be a multiple of sectors",
                 Wall({.bit_diameter = 0.2, .start_depth = 0.0, .first_vertex = 65}));
    CHECK_THROWS(
        InputError, "stop_vertex = 229: must be at most first_vertex + most_vertices = 228",
        Wall({.bit_diameter = 0.2, .start_depth = 0.0, .most_vertices = 100, .first_vertex = 128, .stop_vertex = 229}));
}

// One wrong depth is named, and the wall stays as it was.
void refuses_too_many_vertices() {
    const Hole hole = oval_hole(100, 1000.0, 1.0);
    const Settings settings{.bit_diameter = 0.2, .most_vertices = 6400};
    const std::string rule = " m would have 64001 vertices; must be at most most_vertices = 6400";
    const std::vector<double> tops = {1000.0, 1001.0, 1002.0, 1100.0}, ends = {900.0, 998.0, 999.0, 1000.0};
    const std::vector<double> zero(4), radius(4, 0.1);
    CHECK_THROWS(InputError, "depth = 1100: the wall from 1000 m to 1100" + rule,
                 Wall(settings).append({tops, zero, radius}));
    CHECK_THROWS(InputError, "depth = 900: the wall from 900 m to 1000" + rule,
                 Wall(settings).append({ends, zero, radius}));
    Settings open = settings;
    open.start_depth = 1000.0;
    Wall wall(open);
    wall.append(hole.all());
    const auto before = bits(wall);
    const std::vector<double> far = {1100.0}, time = {1e6};
    CHECK_THROWS(InputError, "depth = 1100: the wall from 1000 m to 1100" + rule,
                 wall.append({far, std::span(zero).first(1), std::span(radius).first(1), time}));
    const std::vector<double> beyond = {1e155};
    CHECK_THROWS(InputError, "depth[0] = 1e+155: must lie in -10000000 to 10000000 m",
                 wall.append({beyond, std::span(zero).first(1), std::span(radius).first(1), time}));
    CHECK(bits(wall) == before);
    open.stop_depth = 1100.0;
    CHECK_THROWS(InputError, "stop_depth = 1100: the wall from 1000 m to 1100" + rule,
                 Wall(open).append({tops, zero, radius}));
}

void refuses_samples() {
    const Hole hole = oval_hole(100, 0.0, 1.0);
    Wall wall({.bit_diameter = 0.216, .start_depth = 0.0, .threads = 2});
    wall.append(hole.all());
    const auto before = bits(wall);
    const std::vector<double> one = {0.5}, two = {0.5, 0.5}, bad = {0.5, nan};
    CHECK_THROWS(InputError, "toolface[1] = nan: must be finite", wall.append({two, bad, two, two}));
    CHECK_THROWS(InputError, "depth[1] = nan: must be finite", wall.append({bad, bad, two, two}));
    CHECK_THROWS(InputError, "radius has 2 values, depth has 1: must be equal", wall.append({one, one, two, one}));
    CHECK_THROWS(InputError, "time: missing, but earlier samples have one; give it for all or none",
                 wall.append({one, one, one}));
    CHECK_THROWS(InputError, "range = [-1, 2): must lie within the wall's " + std::to_string(wall.size()) + " vertices",
                 wall.vertices({-1, 2}));
    CHECK_THROWS(InputError, "threads = 2000000000: must lie in 1 to 1024", wall.interpolate_samples({}, 2000000000));
    CHECK_THROWS(InputError, "threads = -1: must lie in 1 to 1024", hole.all().validate(-1));
    CHECK(bits(wall) == before);
}

// Appends and reads from several threads at once; with times, their order does not matter.
void shares() {
    const Hole hole = oval_hole(4000, 0.0, 4.0);
    const Settings settings{.bit_diameter = 0.216, .sectors = 16, .start_depth = 0.0, .stop_depth = 4.0, .threads = 2};
    Wall once(settings), shared(settings);
    once.append(hole.all());
    {
        std::vector<std::jthread> threads;
        for (std::size_t worker = 0; worker < 4; ++worker)
            threads.emplace_back([&, worker] {
                for (std::size_t i = worker; i < 40; i += 4) shared.append(hole.rows(100 * i, 100));
            });
        for (int i = 0; i < 20; ++i) CHECK(shared.sample_count() % 100 == 0 && shared.radius().size() % 641 == 0);
    }
    CHECK(bits(shared) == bits(once));
}

}  // namespace

int main() {
    reconstructs();
    splits_and_moves();
    starts_at_zero();
    takes_the_least_radius();
    in_every_host_state(refuses_settings);
    in_every_host_state(refuses_samples);
    in_every_host_state(refuses_too_many_vertices);
    shares();
    return failures();
}
