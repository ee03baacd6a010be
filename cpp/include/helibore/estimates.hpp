// Estimates at points, each from the samples nearest to it that are not left out: for cross-validation, and for what
// the uncertainty of a radius is computed from.
#pragma once

#include <array>
#include <span>
#include <vector>

#include "helibore/settings.hpp"
#include "helibore/wall.hpp"

namespace helibore {

// Columns of equal length. A point uses no sample that lies in its box: at most box_depth metres above or below it and
// at most box_turn degrees beside it. 0 and 0: only samples at the point itself; negative: no box.
struct PointColumns {
    std::span<const double> depth, toolface;
    std::span<const double> trial;  // the first trial radius, metres; NaN: no estimate
    std::span<const double> box_depth, box_turn;
};

inline constexpr std::array<double, 3> spread_scales = {1.0, 4.0, 16.0};

// One value for each point; NaN where no sample is within max_distance.
struct PointEstimates {
    std::vector<double> radius;
    std::vector<std::vector<double>> by_nugget;  // radii, for each of the nuggets asked for
    std::vector<double> nearest;                 // distance on the wall to the nearest sample used, metres
    std::vector<double> farthest;                // distance in the metric of angular_scale to the farthest, metres
    std::vector<double> square_weights;          // sum of the squared weights
    std::vector<double> scatter;  // mean square of the radii used about `radius`, by inverse distance, m^2
    std::array<std::vector<double>, 3> spread;  // mean distance to them, likewise, in metrics of `spread_scales`
};

// `samples` in canonical order. The helix, the window and `direct` of the settings do not count. Throws InputError on a
// bad setting, and if columns differ in length. Kriging with several nuggets searches once.
PointEstimates estimate_at(const SampleColumns& samples, const PointColumns& points, const Settings& settings,
                           std::span<const double> nuggets = {});

}  // namespace helibore
