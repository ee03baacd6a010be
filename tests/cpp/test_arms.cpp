// Diameters of arms by hand: which samples make a diameter, its mean over a turn, what is missing, and zones by arms.
#include "helibore/arms.hpp"

#include <cmath>

#include "check.hpp"
#include "helibore/error.hpp"
#include "helibore/zones.hpp"

using namespace helibore;

namespace {

constexpr double bit = 0.2, height = 0.1;

// Two diameters at right angles, every `step` metres from `top` on; the first may be wider within some depths.
struct TwoArms {
    std::vector<double> depth, toolface, radius;
    std::vector<Index> arm;

    TwoArms(double top, int rows, double step, double wide = 0.0, double from = 0.0, double to = 0.0) {
        for (int row = 0; row < rows; ++row) {
            const double at = top + step * row;
            for (int end = 0; end < 4; ++end) {
                depth.push_back(at), toolface.push_back(30.0 + 90.0 * end), arm.push_back(end % 2);
                radius.push_back(bit / 2.0 + (end % 2 == 0 && at >= from && at < to ? wide : 0.0));
            }
        }
    }
    ArmSamples samples() const { return {depth, toolface, radius, arm}; }
};

std::vector<double> middles(double top, int turns) {
    std::vector<double> out;
    for (int turn = 0; turn < turns; ++turn) out.push_back(top + height * (turn + 0.5));
    return out;
}

void means_are_those_of_the_readings_in_a_turn() {
    const TwoArms of(100.0, 21, 0.05, 0.01, 100.5, 200.0);
    const ArmDiameters found = arm_diameters(of.samples(), middles(100.0, 10), height);
    CHECK(found.arms == 2 && found.diameter.size() == 20 && found.c1.size() == 10);
    CHECK(std::abs(found.c1[2] - bit) < 1e-12 && std::abs(found.c1[7] - (bit + 0.02)) < 1e-12);
    CHECK(std::abs(found.c1[4] - (bit + 0.02 * 0.25)) < 1e-12);  // it rises over the last reading of this turn
    CHECK(std::abs(found.c1_toolface[7] - 30.0) < 1e-9 && found.c1_uneven[7] == 0.0);
    CHECK(std::abs(found.c2[7] - bit) < 1e-12 && std::abs(found.least_diameter[7] - bit) < 1e-12);
}

void what_no_reading_is_near_to_is_missing() {
    const TwoArms of(100.0, 3, 0.05);
    ArmSamples samples = of.samples();
    samples.reach = 0.3;
    const ArmDiameters found = arm_diameters(samples, middles(99.0, 30), height);
    CHECK(std::isnan(found.c1[0]) && std::isnan(found.diameter[0]) && std::isnan(found.c1[29]));
    CHECK(std::abs(found.c1[10] - bit) < 1e-12 && std::abs(found.c1[8] - bit) < 1e-12);
}

void a_tool_without_opposite_samples_has_no_diameters() {
    TwoArms of(100.0, 5, 0.05);
    for (double& toolface : of.toolface) toolface *= 0.7;
    CHECK(arm_diameters(of.samples(), middles(100.0, 2), height).arms == 0);
    CHECK(arm_diameters({}, middles(100.0, 2), height).arms == 0);
    const std::vector<double> one(1, 1.0), two(2, 1.0);
    const std::vector<Index> arm(1, 0);
    CHECK_THROWS(InputError, "toolface has 2 values, depth has 1: must be equal",
                 arm_diameters({one, two, one, arm}, one, height));
}

void passes_and_repeated_samples_are_averaged() {
    TwoArms of(100.0, 5, 0.05);
    const std::vector<double> first(of.depth.size(), 1.0);
    std::vector<double> time(first);
    for (std::size_t i = 0; i < first.size(); ++i) {  // a second pass, wider by 4 mm; its samples come twice
        for (int times = 0; times < 2; ++times) {
            of.depth.push_back(of.depth[i]), of.toolface.push_back(of.toolface[i] - 360.0);
            of.radius.push_back(of.radius[i] + 0.002), of.arm.push_back(of.arm[i]), time.push_back(2.0);
        }
    }
    ArmSamples samples = of.samples();
    samples.time = time;
    CHECK(std::abs(arm_diameters(samples, middles(100.0, 2), height).c1[0] - (bit + 0.002)) < 1e-12);
}

void zones_are_those_of_the_arms() {
    const TwoArms of(100.0, 201, 0.05, 0.02, 104.0, 106.0);
    const std::vector<double> radius(32 * 100, bit / 2.0);  // the wall shows nothing
    const ZoneSamples samples{{of.depth, of.toolface}, of.radius, of.samples()};
    const HelixVertices helix{100.0, 0.0, height, 32, std::ssize(radius), 0};
    const WallZones found = wall_zones(helix, radius, samples, bit);
    CHECK(found.arms.arms == 2 && found.zones.size() == 1 && found.sparse[50] == 1.0);
    CHECK(found.zones.size() == 1 && found.zones[0].kind == HoleKind::breakout);
    CHECK(found.zones.size() == 1 && std::abs(found.zones[0].toolface - 30.0) < 1e-6);
    CHECK(wall_zones(helix, radius, {{of.depth, of.toolface}, of.radius}, bit).arms.arms == 0);
}

}  // namespace

int main() {
    means_are_those_of_the_readings_in_a_turn();
    what_no_reading_is_near_to_is_missing();
    a_tool_without_opposite_samples_has_no_diameters();
    passes_and_repeated_samples_are_averaged();
    zones_are_those_of_the_arms();
    return failures();
}
