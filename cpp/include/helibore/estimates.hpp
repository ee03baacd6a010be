// Estimates of the radius at points. Samples near a point can be left out of its estimate. The estimates are used for
// cross-validation, and for the sums from which the uncertainty of a radius is computed.
#pragma once

#include <array>
#include <span>
#include <vector>

#include "helibore/settings.hpp"
#include "helibore/uncertainty.hpp"
#include "helibore/wall.hpp"

namespace helibore {

// Columns of equal length. A point uses no sample that lies in its box: at most box_depth metres above or below it and
// at most box_turn degrees beside it. 0 and 0: only samples at the point itself; negative: no box.
struct PointColumns {
    std::span<const double> depth, toolface;
    std::span<const double> trial;  // the first trial radius, metres; NaN: no estimate
    std::span<const double> box_depth, box_turn;
};

// One value for each point; NaN where no sample is within max_distance.
struct PointEstimates {
    std::vector<double> radius;
    std::vector<std::vector<double>> by_nugget;  // radii, for each of the nuggets asked for
    std::vector<double> nearest, farthest;       // distances of samples used, in the metric of angular_scale, metres
    std::vector<double> square_weights, scatter, along, across;  // W, S, A and C of SigmaRule
};

// `samples` must be in canonical order. The helix, the window and `direct` of the settings have no effect. Throws
// InputError on a bad setting, and if columns differ in length. Kriging with several nuggets searches for neighbours
// once.
PointEstimates estimate_at(const SampleColumns& samples, const PointColumns& points, const Settings& settings,
                           std::span<const double> nuggets = {});

// The standard uncertainties of radii from their sums W, S, A and C: columns of equal length, NaN without neighbours.
std::vector<double> sigma_of(const std::array<std::span<const double>, 4>& sums, const SigmaRule& rule);

}  // namespace helibore
