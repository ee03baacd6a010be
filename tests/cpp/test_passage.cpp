// What passes: a round hole with a narrow turn, a turn with a missing radius, threads, and refused strings.
#include <cmath>
#include <limits>
#include <vector>

#include "check.hpp"
#include "helibore/error.hpp"
#include "helibore/passage.hpp"
#include "host.hpp"

using namespace helibore;

namespace {

constexpr int K = 32;

// A round hole of 0.1 m radius, 5 mm narrower in turn 20.
std::vector<double> narrow() {
    std::vector<double> radius(40 * K, 0.1);
    for (std::size_t k = 20 * K; k < 21 * K; ++k) radius[k] = 0.095;
    return radius;
}

HelixRadii on_helix(const std::vector<double>& radius) {
    return {.start_depth = 100.0, .sectors = K, .radius = radius};
}

void drift() {
    const std::vector<double> radius = narrow();
    const RigidBody body[] = {{-0.25, 0.25, 0.0}};
    const Passage found = passage(on_helix(radius), Path(), body);
    CHECK(found.clearance.size() == 40);
    CHECK(std::isnan(found.clearance[0]) && std::isnan(found.clearance[39]));
    CHECK(std::abs(found.clearance[10] - 0.2) < 1e-9);
    CHECK(found.clearance[20] > 0.19 - 1e-9 && found.clearance[20] < 0.1905);
    CHECK(std::isnan(found.low[20]) && found.contact_body[20 * most_contacts] == 0);
    CHECK(std::abs(found.contact_depth[20 * most_contacts] - 102.05) < 0.1);
}

void unknown() {
    std::vector<double> radius = narrow();
    radius[10 * K] = std::numeric_limits<double>::quiet_NaN();
    const RigidBody string[] = {{0.1, 0.25, 0.05}, {-0.25, 0.1, 0.1}};
    const Passage found = passage(on_helix(radius), Path(), string);
    CHECK(std::isnan(found.clearance[9]) && std::isnan(found.clearance[11]));
    CHECK(std::abs(found.clearance[14] - 0.1) < 1e-9);
    CHECK(found.contact_body[14 * most_contacts] == 1);
}

void same_on_threads() {
    const std::vector<double> radius = narrow(), sigma(radius.size(), 3e-4);
    const RigidBody body[] = {{-0.25, 0.25, 0.0}};
    const Passage one = passage(on_helix(radius), Path(), body, {}, sigma);
    const Passage three = passage(on_helix(radius), Path(), body, {}, sigma, 3);
    for (std::size_t turn = 5; turn < 35; ++turn) {
        CHECK(one.clearance[turn] == three.clearance[turn]);
        CHECK(one.low[turn] == three.low[turn] && one.low[turn] < one.high[turn]);
    }
}

void unknown_sigma() {
    const std::vector<double> radius = narrow();
    const RigidBody body[] = {{-0.25, 0.25, 0.0}};
    std::vector<double> sigma(radius.size(), 3e-4);
    const Passage sure = passage(on_helix(radius), Path(), body, {}, sigma);
    sigma[15 * K + 5] = std::numeric_limits<double>::quiet_NaN();
    const Passage found = passage(on_helix(radius), Path(), body, {}, sigma);
    for (std::size_t turn = 5; turn < 35; ++turn) {
        CHECK(found.clearance[turn] == sure.clearance[turn]);
        const bool beside = turn >= 13 && turn <= 17, away = turn < 12 || turn > 18;
        if (beside) CHECK(std::isnan(found.low[turn]) && std::isnan(found.high[turn]));
        if (away) CHECK(found.low[turn] < found.high[turn]);
    }
}

void refused() {
    const std::vector<double> radius = narrow(), few(3, 1.0);
    const RigidBody body[] = {{-0.25, 0.25, 0.0}}, flat[] = {{0.0, 0.0, 0.0}}, wide[] = {{0.0, 1.0, -1.0}};
    CHECK_THROWS(InputError, "string: must have a body", passage(on_helix(radius), Path(), {}));
    CHECK_THROWS(InputError, "string[0].stop = 0: must be at least 0.001 m below start",
                 passage(on_helix(radius), Path(), flat));
    CHECK_THROWS(InputError, "string[0].diameter = -1: must lie in 0 to 10000 m",
                 passage(on_helix(radius), Path(), wide));
    CHECK_THROWS(InputError, "counts has 3 values, radius has 1280: must be equal",
                 passage(on_helix(radius), Path(), body, few));
}

}  // namespace

int main() {
    drift();
    unknown();
    same_on_threads();
    unknown_sigma();
    refused();
    return 0;
}
