// The unworn circle: a round hole with one slot, a turn with a missing radius, and threads.
#include <cmath>
#include <limits>
#include <vector>

#include "check.hpp"
#include "helibore/error.hpp"
#include "helibore/unworn.hpp"
#include "host.hpp"

using namespace helibore;

namespace {

constexpr int K = 64;

// A round hole of 0.1 m radius, with a flat-bottomed slot of 0.02 m at vertices 10 to 15.
std::vector<double> slotted() {
    std::vector<double> radius(K, 0.1);
    for (std::size_t k = 10; k <= 15; ++k) radius[k] = 0.12;
    return radius;
}

void slot() {
    const std::vector<double> radius = slotted();
    const UnwornTurns found = unworn_turns({.sectors = K, .radius = radius}, 0.2);
    CHECK(found.diameter.size() == 1);
    CHECK(std::abs(found.diameter[0] - 0.2) < 1e-5);
    CHECK(std::hypot(found.centre_0[0], found.centre_90[0]) < 1e-5);
    CHECK(std::abs(found.lobes[0].height[0] - 0.02) < 1e-5);
    CHECK(std::abs(found.lobes[0].toolface[0] - 12.5 * 360.0 / K) < 0.01);
    CHECK(found.lobes[0].width[0] == 6.0 * 360.0 / K);
    CHECK(std::isnan(found.lobes[1].height[0]));
}

void turns() {
    std::vector<double> radius;
    for (int turn = 0; turn < 200; ++turn) {
        const std::vector<double> one = slotted();
        radius.insert(radius.end(), one.begin(), one.end());
    }
    radius[K] = std::numeric_limits<double>::quiet_NaN();
    const UnwornTurns one = unworn_turns({.sectors = K, .radius = radius}, 0.2);
    const UnwornTurns three = unworn_turns({.sectors = K, .radius = radius}, 0.2, {}, 3);
    CHECK(std::isnan(one.diameter[1]));
    for (std::size_t turn = 2; turn < 200; ++turn) {
        CHECK(one.diameter[turn] == one.diameter[0]);
        CHECK(three.lobes[0].pipe[turn] == one.lobes[0].pipe[0]);
    }
}

void refused() {
    const std::vector<double> radius = slotted(), few(3, 1.0);
    CHECK_THROWS(InputError, "bit_diameter = 0: must lie in 1e-50 to 1e50 m",
                 unworn_turns({.sectors = K, .radius = radius}, 0.0));
    CHECK_THROWS(InputError, "counts has 3 values, radius has 64: must be equal",
                 unworn_turns({.sectors = K, .radius = radius}, 0.2, few));
}

}  // namespace

int main() {
    slot();
    turns();
    refused();
    return 0;
}
