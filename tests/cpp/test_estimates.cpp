// Estimates at points: those at vertices are the wall's, a sample left out does not count, and kriging by several
// nuggets.
#include "helibore/estimates.hpp"

#include <cmath>
#include <limits>

#include "check.hpp"
#include "helibore/error.hpp"
#include "hole.hpp"

using namespace helibore;

namespace {

constexpr double nan = std::numeric_limits<double>::quiet_NaN();

struct Points {
    std::vector<double> depth, toolface, trial, box_depth, box_turn;
    operator PointColumns() const { return {depth, toolface, trial, box_depth, box_turn}; }
};

SampleColumns columns_of(const std::vector<std::vector<double>>& samples) {
    return {samples[0], samples[1], samples[2]};
}

bool near(double a, double b, double within = 1e-9) {
    return std::abs(a - b) <= within || (std::isnan(a) && std::isnan(b));
}

// At the vertices, without a box. Kriging too; `nuggets` searches once and gives what each alone gives.
void at_vertices() {
    const Hole hole = oval_hole(700, 100.0, 4.0);
    for (const Estimator estimator : {Estimator::inverse_distance, Estimator::kriging}) {
        Settings settings{.bit_diameter = 0.216, .sectors = 16, .pitch = 0.2, .neighbors = 6, .max_distance = 0.08};
        settings.max_iterations = 1;  // from the same trial radius
        settings.estimator = estimator;
        settings.kriging_range = estimator == Estimator::kriging ? 0.5 : 0.0;
        Wall wall(settings);
        wall.append(hole.all());
        const VertexColumns v = wall.vertices();
        const std::size_t n = v.radius.size();
        const Points points{v.depth, v.toolface, std::vector<double>(n, 0.108), std::vector<double>(n, -1.0),
                            std::vector<double>(n, -1.0)};
        const std::vector<double> nuggets = {0.1, 0.5};
        const auto samples = wall.samples();
        const PointEstimates found = estimate_at(columns_of(samples), points, settings, nuggets);
        std::size_t empty = 0;
        for (std::size_t k = 0; k < n; ++k) {
            empty += v.support[k] == 0;
            CHECK(near(found.radius[k], v.radius[k], 1e-12));
            CHECK((v.support[k] == 0) == std::isnan(found.nearest[k]));
        }
        CHECK(empty > 0 && empty < n);
        settings.threads = 3;
        const PointEstimates shared = estimate_at(columns_of(samples), points, settings, nuggets);
        for (std::size_t k = 0; k < n; ++k)
            CHECK(near(shared.radius[k], found.radius[k], 0.0) && near(shared.scatter[k], found.scatter[k], 0.0));
        if (estimator == Estimator::inverse_distance) continue;
        settings.nugget = 0.5;
        const PointEstimates other = estimate_at(columns_of(samples), points, settings);
        for (std::size_t k = 0; k < n; ++k) {
            CHECK(near(found.by_nugget[0][k], found.radius[k], 0.0));
            CHECK(near(found.by_nugget[1][k], other.radius[k], 0.0));
            CHECK(std::isnan(found.radius[k]) || (found.square_weights[k] > 0.1 && found.square_weights[k] < 2.0));
        }
    }
}

// Three samples in a line down the hole, by hand: weights 1/d.
void by_hand() {
    const std::vector<double> depth = {10.0, 10.1, 10.3}, toolface(3, 90.0), radius = {0.1, 0.12, 0.16};
    const SampleColumns samples{depth, toolface, radius};
    const Settings settings{.bit_diameter = 0.2, .neighbors = 2};
    const Points points{{10.1, 10.1, 10.1, 50.0},
                        {90.0, 90.0, 90.0, 0.0},
                        {0.1, 0.1, nan, 0.1},
                        {0.0, -1.0, 0.0, 0.0},
                        std::vector<double>(4, 0.0)};
    const PointEstimates found = estimate_at(samples, points, settings);
    CHECK(near(found.radius[0], (2.0 * 0.1 + 0.16) / 3.0));  // 0.1 and 0.2 m away, itself left out
    CHECK(near(found.nearest[0], 0.1) && near(found.farthest[0], 0.2) && near(found.square_weights[0], 5.0 / 9.0));
    CHECK(near(found.scatter[0], (2.0 * 0.02 * 0.02 + 0.04 * 0.04) / 3.0));
    for (const auto& spread : found.spread) CHECK(near(spread[0], (2.0 * 0.1 + 0.2) / 3.0));  // no turn to stretch
    CHECK(found.radius[1] == 0.12 && found.nearest[1] == 0.0 && found.square_weights[1] == 1.0);
    for (const std::size_t none : {2u, 3u})
        CHECK(std::isnan(found.radius[none]) && std::isnan(found.nearest[none]) && std::isnan(found.scatter[none]));
    Points uneven = points;
    uneven.trial.pop_back();
    CHECK_THROWS(InputError, "points: columns must have equal lengths", estimate_at(samples, uneven, settings));
    CHECK_THROWS(InputError, "bit_diameter = 0: must be finite and above 0", estimate_at(samples, points, {}));
}

}  // namespace

int main() {
    at_vertices();
    by_hand();
    return failures();
}
