// The rules for settings.
#include "helibore/settings.hpp"

#include <cmath>
#include <string>

#include "base/arithmetic.hpp"
#include "base/messages.hpp"
#include "search/kernel/kernel.hpp"

namespace helibore {
namespace {

void require_positive(const char* name, double value) {
    require(std::isfinite(value) && value > 0.0, name, value, "must be finite and above 0");
}

void require_within(const char* name, Index value, Index least, Index most) {
    require(value >= least && value <= most, name, value,
            "must lie in " + std::to_string(least) + " to " + std::to_string(most));
}

}  // namespace

void Settings::validate() const {
    const StandardArithmetic standard;
    require_positive("bit_diameter", bit_diameter);
    require(bit_diameter >= 0.001, "bit_diameter", bit_diameter, "must be at least 0.001 m");
    require(bit_diameter <= 4.0, "bit_diameter", bit_diameter, "must be at most 4 m");
    require_within("sectors", sectors, 3, 1000000);
    require_pitch(pitch);
    if (start_depth) require_depth("start_depth", *start_depth);
    if (stop_depth) require_depth("stop_depth", *stop_depth);
    require(std::isfinite(start_toolface), "start_toolface", start_toolface, "must be finite");
    require_within("neighbors", neighbors, 1,
                   estimator == Estimator::kriging ? kernel::max_kriged : kernel::max_neighbors);
    if (window) require(*window >= 1, "window", *window, "must be at least 1");
    require_positive("power", power);
    require(max_distance > 0.0, "max_distance", max_distance, "must be above 0");
    require_within("max_iterations", max_iterations, 1, 255);
    require(tolerance >= 0.0, "tolerance", tolerance, "must be 0 or above");
    require_positive("angular_scale", angular_scale);
    if (estimator == Estimator::kriging) require_positive("kriging_range", kriging_range);
    require(std::isfinite(nugget) && nugget >= 1e-6, "nugget", nugget, "must be finite and at least 1e-6");
    require_within("most_vertices", most_vertices, 1, (Index{1} << 31) - 1);
    require_threads(threads);
}

}  // namespace helibore
