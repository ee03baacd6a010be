// Sector images on quads: cells and linear values by hand, gaps, a helix that grows upwards, and what is refused.
#include "helibore/image.hpp"

#include <cmath>
#include <limits>

#include "check.hpp"
#include "helibore/error.hpp"
#include "host.hpp"

using namespace helibore;

namespace {

constexpr double nan = std::numeric_limits<double>::quiet_NaN();

bool equal(const std::vector<double>& a, const std::vector<double>& b) {
    bool all = a.size() == b.size();
    for (std::size_t i = 0; all && i < a.size(); ++i) all = a[i] == b[i] || (std::isnan(a[i]) && std::isnan(b[i]));
    return all;
}

const std::vector<double> depth = {10.0, 11.0, 15.0}, values = {1, 2, 3, 4, 5, 6, 7, 8, nan};
const ImageRows image{depth, values, 3};

// One quad a turn, with its centre at `at`: start + (k + (K + 1)/2) pitch/K, K = 1.
QuadCentres one_at(double at, const double& sector, double pitch = 0.5) {
    return {.start_depth = at - pitch, .pitch = pitch, .count = 1, .sector = {&sector, 1}};
}

double linear(double at, double sector, double reach = 1.0) {
    return linear_values(image, reach, one_at(at, sector))[0];
}

double cell(double at, double sector) {
    const std::vector<double> low = {9.5, 10.5, 14.5}, high = {10.5, 11.5, 15.5};
    return cell_values(image, low, high, one_at(at, sector))[0];
}

void cells() {
    CHECK(cell(9.5, 0.0) == 1 && cell(10.499, 1.9) == 2 && cell(10.5, 2.0) == 6);
    CHECK(cell(11.0, 3.0) == 4 && cell(11.0, -0.5) == 6 && cell(11.0, 7.2) == 5);  // sectors go round
    CHECK(std::isnan(cell(9.4, 0.0)) && std::isnan(cell(11.5, 0.0)) && std::isnan(cell(15.5, 0.0)));
    CHECK(std::isnan(cell(15.0, 2.0)) && cell(15.0, 1.0) == 8);
}

void lines() {
    CHECK(linear(10.0, 0.0) == 1 && linear(10.0, 0.25) == 1.25 && linear(10.0, 2.5) == 2.0);  // from 3 back to 1
    CHECK(linear(10.5, 0.0) == 2.5 && linear(10.25, 0.5) == 2.25);
    CHECK(std::isnan(linear(9.9, 0.0)) && std::isnan(linear(15.1, 0.0)));    // above the first row and below the last
    CHECK(std::isnan(linear(12.0, 0.0)) && linear(12.0, 0.0, 2.0) == 4.75);  // rows 4 m apart, reach 1 and 2 m
    CHECK(linear(15.0, 1.0) == 8 && std::isnan(linear(15.0, 1.5)) && std::isnan(linear(13.0, 2.0, 9.0)));
    CHECK(linear(11.0, 2.0, 9.0) == 6);  // exactly on a row: the missing value below does not count
}

// Quads in turns of three, downwards and upwards; the same on three threads.
void turns() {
    const std::vector<double> sector = {0.0, 1.0, 2.0};
    for (const double pitch : {0.75, -0.75}) {
        const QuadCentres quads{.start_depth = 11.0, .pitch = pitch, .count = 20000, .sector = sector};
        const std::vector<double> found = linear_values(image, 5.0, quads);
        CHECK(equal(found, linear_values(image, 5.0, quads, 3)) && found.size() == 20000);
        for (std::size_t k = 0; k < 9; ++k) {
            const double at = 11.0 + (static_cast<double>(k) + 2.0) * pitch / 3.0;
            CHECK(equal({found[k]}, {linear(at, sector[k % 3], 5.0)}));
        }
        CHECK(std::isnan(found.back()));
    }
    CHECK(linear_values({{}, {}, 1}, 1.0, one_at(1.0, sector[0])).size() == 1);
    CHECK(std::isnan(linear_values({{}, {}, 1}, 1.0, one_at(1.0, sector[0]))[0]));
}

void refusals() {
    const double sector[] = {0.0, nan};
    const QuadCentres good{.count = 1, .sector = std::span(sector).first(1)};
    const auto with = [&](const auto& change) {
        QuadCentres quads = good;
        change(quads);
        return quads;
    };
    CHECK_THROWS(InputError, "sectors = 0: must lie in 1 to 1000000", linear_values({depth, values, 0}, 1.0, good));
    CHECK_THROWS(InputError, "sectors = 1000001: must lie in 1 to 1000000",
                 linear_values({depth, values, 1000001}, 1.0, good));
    CHECK_THROWS(InputError, "values has 9 values: must be 3 rows of 2", linear_values({depth, values, 2}, 1.0, good));
    CHECK_THROWS(InputError, "sector: must have at least one",
                 linear_values(image, 1.0, with([](QuadCentres& q) { q.sector = {}; })));
    CHECK_THROWS(InputError, "sector[1] = nan: must lie in -1e9 to 1e9",
                 linear_values(image, 1.0, with([&](QuadCentres& q) { q.sector = sector; })));
    CHECK_THROWS(InputError, "count = -1: must not be negative",
                 linear_values(image, 1.0, with([](QuadCentres& q) { q.count = -1; })));
    CHECK_THROWS(InputError, "count = 1099511627776: must be at most 2147483647",
                 linear_values(image, 1.0, with([](QuadCentres& q) { q.count = Index{1} << 40; })));
    CHECK_THROWS(InputError, "reach = nan: must be 0 or above", linear_values(image, nan, good));
    const std::vector<double> falling = {10.0, 11.0, 9.0}, infinite = {10.0, 11.0, -nan};
    CHECK_THROWS(InputError, "depth[2] = 9: must not be less than depth[1] = 11",
                 linear_values({falling, values, 3}, 1.0, good));
    CHECK_THROWS(InputError, "depth[2] = nan: must be finite", linear_values({infinite, values, 3}, 1.0, good));
    CHECK_THROWS(InputError, "low[2] = 9: must not be less than low[1] = 11", cell_values(image, falling, depth, good));
    CHECK_THROWS(InputError, "high[2] = nan: must be finite", cell_values(image, depth, infinite, good));
    CHECK_THROWS(InputError, "threads = 0: must lie in 1 to 1024", linear_values(image, 1.0, good, 0));
    CHECK_THROWS(InputError, "start_depth = nan: must be finite",
                 linear_values(image, 1.0, with([](QuadCentres& q) { q.start_depth = nan; })));
    CHECK_THROWS(InputError, "pitch = 0: must be finite and not 0",
                 linear_values(image, 1.0, with([](QuadCentres& q) { q.pitch = 0.0; })));
    CHECK(linear_values(image, 1.0, with([](QuadCentres& q) { q.start_depth = nan, q.count = 0; })).empty());
    CHECK_THROWS(InputError, "low has 1 values, depth has 3: must be equal",
                 cell_values(image, std::span(depth).first(1), depth, good));
    CHECK_THROWS(InputError, "high has 2 values, depth has 3: must be equal",
                 cell_values(image, depth, std::span(depth).first(2), good));
}

}  // namespace

int main() {
    cells();
    lines();
    turns();
    in_every_host_state(refusals);
    return failures();
}
