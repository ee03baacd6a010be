// Estimates of the radius at points. Samples near a point can be left out of its estimate. The estimates are used for
// cross-validation, and for the sums from which the uncertainty of a radius is computed.
#pragma once

#include <array>
#include <optional>
#include <span>
#include <vector>

#include "helibore/settings.hpp"
#include "helibore/uncertainty.hpp"
#include "helibore/wall.hpp"

namespace helibore {

// Columns of equal length. The estimate of a point leaves out the samples in its box: those at most box_depth metres
// above or below the point and at most box_turn degrees beside it. If both are 0, it leaves out only samples at the
// point itself. If one of them is negative, it leaves out no sample.
struct PointColumns {
    std::span<const double> depth, toolface;
    std::span<const double> trial;  // the first trial radius, metres; NaN: no estimate
    std::span<const double> box_depth, box_turn;
};

// One value for each point. It is NaN if the trial radius is NaN, or if all samples within max_distance are
// inside the box that is left out.
struct PointEstimates {
    std::vector<double> radius;
    std::vector<std::vector<double>> by_nugget;  // one column of kriged radii for each of the given nuggets
    std::vector<double> nearest, farthest;       // distances of samples used, in the metric of angular_scale, metres
    std::vector<double> square_weights, scatter, along, across;  // W, S, A and C of SigmaRule
};

// Samples in canonical order, as Wall::samples returns them: copied and checked once, for many calls of estimate_at.
// Throws InputError if columns differ in length, if depths fall, or if a depth, toolface or radius breaks its rule.
class PointSamples {
  public:
    explicit PointSamples(const SampleColumns& samples, int threads = 1);
    SampleColumns columns() const { return {columns_[0], columns_[1], columns_[2]}; }  // toolfaces lie in [0, 360)

  private:
    std::array<std::vector<double>, 3> columns_;
};

// The helix, the window and `direct` of the settings have no effect. The neighbours of a point are searched for only
// once, also for several nuggets. Throws InputError on a bad setting, with near_and_far, if columns differ in length,
// or if a depth, toolface, radius or nugget breaks its rule.
PointEstimates estimate_at(const PointSamples& samples, const PointColumns& points, const Settings& settings,
                           std::span<const double> nuggets = {});
PointEstimates estimate_at(const SampleColumns& samples, const PointColumns& points, const Settings& settings,
                           std::span<const double> nuggets = {});

// Returns the rows of the `neighbors` nearest samples of each point, in canonical order; -1 where there are fewer. Arcs
// at the trial radius count `stretch` times, which may be above the limit of angular_scale. Samples in the box of the
// point and beyond max_distance do not count. Throws InputError as estimate_at, and unless `stretch` is above 0.
std::vector<Index> nearest_to(const PointSamples& samples, const PointColumns& points, const Settings& settings,
                              double stretch);

// Returns the standard uncertainty of each radius, computed from its sums W, S, A and C, which are four columns of
// equal length. It is NaN where the sums are NaN (no neighbours), and where A + C is above the square of `rule.reach`.
std::vector<double> sigma_of(const std::array<std::span<const double>, 4>& sums, const SigmaRule& rule);

// Samples that are left out one by one, each with the samples in a box around it, as PointColumns says.
struct LeftOut {
    std::span<const Index> rows;  // of the samples
    std::span<const double> box_depth, box_turn;
};

// The parameters of the uncertainty of a wall; python/helibore/wall/uncertainty.py explains them.
struct Calibration {
    double noise, between;  // tau, metres; c
    double scatter_power, distance_power, stretch;
    double quantile;  // 0.95 of the errors, each divided by its standard deviation
    double reach;     // metres: how far the rms distance to the samples used may be
};

// Calibrates the uncertainty of a wall of these samples and settings; none if no sample that is left out has another
// one outside its box. Throws InputError as estimate_at, and if a row is not one of the samples.
std::optional<Calibration> calibrate(const SampleColumns& samples, const LeftOut& left_out, const Settings& settings);

}  // namespace helibore
