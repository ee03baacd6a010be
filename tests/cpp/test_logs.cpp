// Logs through the C++ interface: a circle off the axis, a gap, threads, and what is refused.
#include <cmath>
#include <limits>
#include <vector>

#include "check.hpp"
#include "helibore/error.hpp"
#include "helibore/logs.hpp"
#include "host.hpp"

namespace {

using helibore::turn_logs;

// Turns of a circle of radius R whose centre lies e from the axis, towards toolface 0.
std::vector<double> circle(double R, double e, int sectors, int turns) {
    std::vector<double> radius;
    for (int k = 0; k < sectors * turns; ++k) {
        const double psi = 2.0 * 3.14159265358979323846 * k / sectors;
        radius.push_back(e * std::cos(psi) + std::sqrt(R * R - e * e * std::sin(psi) * std::sin(psi)));
    }
    return radius;
}

bool near(double a, double b) {
    return std::abs(a - b) < 1e-9;
}

void refusals() {
    std::vector<double> radius(64 * 150, 0.12);
    CHECK(turn_logs({.sectors = 3, .radius = {}}).mean.empty());
    CHECK_THROWS(helibore::InputError, "sectors = 2: must be 3 or more", turn_logs({.sectors = 2, .radius = radius}));
    CHECK_THROWS(helibore::InputError, "window = 4: must be odd and 3 or more",
                 turn_logs({.radius = radius, .window = 4}));
    CHECK_THROWS(helibore::InputError, "threads = 2147483647: must lie in 1 to 1024",
                 turn_logs({.radius = radius}, 2147483647));
    CHECK_THROWS(helibore::InputError, "sectors = 2000000000: must be at most 1000000",
                 turn_logs({.sectors = 2000000000, .radius = radius}));
    CHECK_THROWS(helibore::InputError, "start_toolface = inf: must be finite",
                 turn_logs({.start_toolface = std::numeric_limits<double>::infinity(), .radius = radius}));
    CHECK(turn_logs({.radius = radius, .window = std::numeric_limits<helibore::Index>::max()}).mean.size() == 150);
    CHECK_THROWS(helibore::InputError, "first = -3: must not be negative", turn_logs({.radius = radius, .first = -3}));
    radius[3] = 1e155;
    CHECK_THROWS(helibore::InputError, "radius[3] = 1e+155: must lie in 1e-50 to 1e50 m, or be nan",
                 turn_logs({.radius = radius}));
}

}  // namespace

int main() {
    std::vector<double> radius = circle(0.12, 0.01, 32, 300);
    radius[5 * 32 + 7] = std::numeric_limits<double>::quiet_NaN();
    radius.push_back(0.12);  // fills no turn
    const helibore::TurnLogs logs = turn_logs({.sectors = 32, .radius = radius, .window = 5});
    CHECK(logs.mean.size() == 300);
    CHECK(near(2.0 * std::sqrt(logs.mean_square[0]), 0.24));
    CHECK(near(logs.centre_0[0], 0.01) && near(logs.centre_90[0], 0.0));
    CHECK(near(logs.inscribed_diameter[9], 0.24) && near(logs.inscribed_0[9], 0.01));
    CHECK(near(logs.enclosing_diameter[9], 0.24));
    CHECK(near(logs.c1[0], 0.24) && near(logs.c1_toolface[0], 0.0) && near(logs.c2[0], logs.diameter_90[0]));
    CHECK(std::isnan(logs.mean[5]) && near(logs.largest[5], 0.13) && near(logs.coverage[5], 31.0 / 32.0));
    CHECK(std::isnan(logs.rugosity[7]) && logs.rugosity[8] < 1e-9 && std::isnan(logs.rugosity[1]));

    const helibore::TurnLogs seven = turn_logs({.sectors = 32, .radius = radius, .window = 5}, 7);
    CHECK(seven.inscribed_diameter[299] == logs.inscribed_diameter[299] && seven.rugosity[297] == logs.rugosity[297]);
    for (const double start : {1e300, -1e17, -1e-20, 360.0}) {
        const double toolface = turn_logs({.start_toolface = start, .sectors = 32, .radius = radius}).c1_toolface[0];
        CHECK(toolface >= 0.0 && toolface < 180.0);
    }
    in_every_host_state(refusals);
    return failures();
}
