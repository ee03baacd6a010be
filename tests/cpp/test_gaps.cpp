// Angular gaps: against a loop over all samples for each vertex, and what is refused.
#include <algorithm>
#include <cmath>
#include <limits>

#include "check.hpp"
#include "helibore/error.hpp"
#include "helibore/logs.hpp"
#include "hole.hpp"
#include "host.hpp"

using namespace helibore;

namespace {

double gap_of(const HelixVertices& helix, Index k, const std::vector<std::vector<double>>& samples, double reach) {
    const auto K = static_cast<double>(helix.sectors);
    const double depth = helix.start_depth + static_cast<double>(k) * helix.pitch / K;
    const double own = helix.start_toolface + static_cast<double>(k % helix.sectors) * 360.0 / K;
    double ahead = 360.0, behind = 360.0;
    for (std::size_t i = 0; i < samples[0].size(); ++i) {
        if (std::abs(samples[0][i] - depth) > reach) continue;
        const double turn = samples[1][i] - own, clockwise = turn - 360.0 * std::floor(turn / 360.0);
        ahead = std::min(ahead, clockwise);
        behind = std::min(behind, 360.0 - clockwise);
    }
    return ahead == 0.0 ? 0.0 : std::min(ahead + behind, 360.0);
}

void agree(const HelixVertices& helix, const std::vector<std::vector<double>>& samples, double reach) {
    const std::vector<double> found = angular_gaps(helix, {samples[0], samples[1]}, reach);
    CHECK(found.size() == static_cast<std::size_t>(helix.count));
    CHECK(found == angular_gaps(helix, {samples[0], samples[1]}, reach, 3));
    for (Index k = 0; k < helix.count; ++k)
        CHECK(std::abs(found[static_cast<std::size_t>(k)] - gap_of(helix, k, samples, reach)) < 1e-9);
}

// The same samples, near each vertex in both directions.
void near_ones(const HelixVertices& helix, const std::vector<std::vector<double>>& samples, double reach) {
    for (const double angle : {0.0, 7.0, 15.0, 120.0, 180.0}) {
        const MeasuredRule rule{reach, angle, 0.0, 360.0};
        const std::vector<std::uint8_t> found = measured(helix, {samples[0], samples[1]}, rule);
        CHECK(found == measured(helix, {samples[0], samples[1]}, rule, 3));
        for (Index k = 0; k < helix.count; ++k) {
            const auto K = static_cast<double>(helix.sectors);
            const double depth = helix.start_depth + static_cast<double>(k) * helix.pitch / K;
            const double own = helix.start_toolface + static_cast<double>(k % helix.sectors) * 360.0 / K;
            bool near = false;
            for (std::size_t i = 0; i < samples[0].size(); ++i) {
                near = near || (std::abs(samples[0][i] - depth) <= reach &&
                                std::abs(std::remainder(samples[1][i] - own, 360.0)) <= angle);
            }
            CHECK((found[static_cast<std::size_t>(k)] != 0) == near);
        }
    }
}

// Those whose gap is small enough.
void closed_ones(const HelixVertices& helix, const std::vector<std::vector<double>>& samples, double reach) {
    const std::vector<double> gaps = angular_gaps(helix, {samples[0], samples[1]}, reach);
    for (const double largest : {0.0, 0.5, 7.5, 15.0, 100.0, 359.0, 360.0}) {
        const std::vector<std::uint8_t> found = measured(helix, {samples[0], samples[1]}, {1e6, 180.0, reach, largest});
        for (std::size_t k = 0; k < found.size(); ++k)
            CHECK((found[k] != 0) == (!samples[0].empty() && gaps[k] <= largest));
    }
}

void loops() {
    for (const double pitch : {0.1, -0.1})
        for (const Index sectors : {1, 3, 48})
            for (const std::size_t n : {0u, 1u, 40u, 900u}) {
                const Hole hole = oval_hole(n, 9.0, 2.0);
                Wall wall({.bit_diameter = 0.216});  // sorts the samples
                wall.append(hole.all());
                for (const double reach : {0.02, 0.3, 9.0}) {
                    const HelixVertices helix{
                        .start_depth = 10.0, .start_toolface = 350.0, .pitch = pitch, .sectors = sectors, .count = 200};
                    agree(helix, wall.samples(), reach);
                    near_ones(helix, wall.samples(), reach);
                    closed_ones(helix, wall.samples(), reach);
                }
            }
}

void by_hand() {
    const std::vector<double> depth = {10.0, 10.0, 10.0}, toolface = {90.0, 200.0, -10.0};
    const HelixVertices helix{.start_depth = 10.0, .pitch = 1e-6, .sectors = 4, .count = 4};
    CHECK(angular_gaps(helix, {depth, toolface}, 0.1) == (std::vector<double>{100.0, 0.0, 110.0, 150.0}));
    CHECK(angular_gaps(helix, {std::span(depth).first(1), std::span(toolface).first(1)}, 0.1) ==
          (std::vector<double>{360.0, 0.0, 360.0, 360.0}));
    CHECK(angular_gaps(helix, {}, 0.1) == std::vector<double>(4, 360.0));
}

// A sample at the toolface of a vertex, whatever the rounding of that toolface.
void at_vertices() {
    for (const double start : {0.0, 33.3, 0.1, -77.7, 359.999}) {
        Wall wall({.bit_diameter = 0.216, .start_depth = 10.0, .start_toolface = start});
        const std::vector<double> ends = {10.0, 10.2}, toolface(2), radius(2, 0.11);
        wall.append({ends, toolface, radius});
        const std::vector<double> of_vertices = wall.toolface(), depth = {10.05};
        const HelixVertices helix{.start_depth = 10.0, .start_toolface = start, .count = 64};
        for (std::size_t k = 0; k < 64; ++k) {
            std::vector<double> expected(64, 360.0);
            expected[k] = 0.0;
            CHECK(angular_gaps(helix, {depth, std::span(of_vertices).subspan(k, 1)}, 1.0) == expected);
        }
    }
}

// Two samples 0.1 m and 0.05 m from the only vertex, 2 mm and 4 mm farther out: the mean, with weights of 1 and 2, is
// 10/3 mm; half the rms times the distance, a third, is sqrt(10)/6 mm.
void changes() {
    const std::vector<double> depth = {10.0, 10.15}, toolface = {30.0, 30.0}, radius = {0.102, 0.104}, wall = {0.1};
    const HelixVertices vertex{10.1, 30.0, 0.1, 64, 1, 0};
    const double change = 1e-3 * std::sqrt(100.0 / 9.0 + 10.0 / 36.0);
    for (const double share : {0.999, 1.001}) {
        const MeasuredRule rule{0.15, 15.0, 0.5, 360.0, share * change};
        CHECK(measured(vertex, {depth, toolface}, rule, 1, {radius, wall})[0] == (share > 1.0 ? 1 : 2));
    }
}

void refusals() {
    constexpr double infinity = std::numeric_limits<double>::infinity();
    const std::vector<double> two = {1.0, 2.0}, bad = {1.0, infinity};
    const SamplePlaces good{two, two};
    CHECK_THROWS(InputError, "sectors = 0: must be 1 or more", angular_gaps({.sectors = 0}, good, 1.0));
    CHECK_THROWS(InputError, "sectors = 1000001: must be at most 1000000",
                 angular_gaps({.sectors = 1000001}, good, 1.0));
    CHECK_THROWS(InputError, "count = -1: must not be negative", angular_gaps({.count = -1}, good, 1.0));
    CHECK_THROWS(InputError, "first = -64: must lie in 0 to 1099511627776", angular_gaps({.first = -64}, good, 1.0));
    CHECK_THROWS(InputError, "first = 9223372036854775807: must lie in 0 to 1099511627776",
                 angular_gaps({.first = std::numeric_limits<Index>::max()}, good, 1.0));
    CHECK_THROWS(InputError, "first = 65: must be a multiple of sectors", angular_gaps({.first = 65}, good, 1.0));
    CHECK_THROWS(InputError, "start_toolface = inf: must be finite",
                 angular_gaps({.start_toolface = infinity}, good, 1.0));
    CHECK_THROWS(InputError, "count = 1099511627776: must be at most 2147483647",
                 angular_gaps({.count = Index{1} << 40}, good, 1.0));
    CHECK_THROWS(InputError, "start_depth = inf: must be finite",
                 angular_gaps({.start_depth = infinity, .count = 1}, good, 1.0));
    CHECK_THROWS(InputError, "pitch = 0: must be finite and not 0",
                 angular_gaps({.pitch = 0.0, .count = 1}, good, 1.0));
    CHECK_THROWS(InputError, "reach = -1: must be 0 or above", angular_gaps({}, good, -1.0));
    CHECK_THROWS(InputError, "depth[1] = inf: must be finite", angular_gaps({}, {bad, two}, 1.0));
    const std::vector<double> falling = {2.0, 1.0};
    CHECK_THROWS(InputError, "depth[1] = 1: must not be less than depth[0] = 2", angular_gaps({}, {falling, two}, 1.0));
    CHECK_THROWS(InputError, "threads = 0: must lie in 1 to 1024", angular_gaps({}, good, 1.0, 0));
    CHECK_THROWS(InputError, "toolface has 1 values, depth has 2: must be equal",
                 angular_gaps({}, {two, std::span(two).first(1)}, 1.0));
    CHECK_THROWS(InputError, "near_depth = -1: must be 0 or above", measured({}, good, {-1.0, 15.0, 1.0, 90.0}));
    CHECK_THROWS(InputError, "near_toolface = 181: must lie in 0 to 180", measured({}, good, {1.0, 181.0, 1.0, 90.0}));
    CHECK_THROWS(InputError, "gap_reach = -1: must be 0 or above", measured({}, good, {1.0, 15.0, -1.0, 90.0}));
    CHECK_THROWS(InputError, "largest_gap = 361: must lie in 0 to 360", measured({}, good, {1.0, 15.0, 1.0, 361.0}));
    CHECK_THROWS(InputError, "largest_change = -1: must be 0 or above",
                 measured({}, good, {1.0, 15.0, 1.0, 90.0, -1.0}));
    CHECK_THROWS(InputError, "near_depth = 0: must be above 0", measured({}, good, {0.0, 15.0, 1.0, 90.0, 1.0}));
    CHECK_THROWS(InputError, "radii.samples has 0 values, depth has 2: must be equal",
                 measured({}, good, {1.0, 15.0, 1.0, 90.0, 1.0}));
    CHECK_THROWS(InputError, "toolface[1] = inf: must be finite", angular_gaps({}, {two, bad}, 1.0));
}

}  // namespace

int main() {
    loops();
    by_hand();
    at_vertices();
    changes();
    in_every_host_state(refusals);
    return failures();
}
