// The rules for settings.
#include "helibore/settings.hpp"

#include <cmath>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "base/arithmetic.hpp"
#include "base/messages.hpp"
#include "base/threads.hpp"
#include "helibore/error.hpp"
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

// Requires the rules of a covariance, which is a part of a setting from one of its values on. With `open`, the variance
// of the third term may be 0.
void require_covariance(const char* name, std::span<const double> values, std::size_t first, bool open = false) {
    const std::size_t n = values.size();
    const bool turns = n % 3 == 0;  // the last value is then the turn
    const auto entry = [&](std::size_t i) { return entry_name(name, static_cast<Index>(first + i)); };
    if (turns)
        require(std::abs(values[n - 1]) <= 3600.0, entry(n - 1), values[n - 1],
                "must lie in -3600 to 3600 degrees a metre");
    for (std::size_t i = 0; i < n - turns; ++i) {
        const bool square = i == 1 || (i >= 2 && i % 3 == 2);
        const auto [least, most] = square ? std::pair{1e-14, 1e2} : std::pair{1e-4, 1e6};
        if (open && i == 8 && values[i] == 0.0) continue;
        const double value = i == 3 || i == 6 ? std::abs(values[i]) : values[i];  // below 0: Settings::covariance
        require(value >= least && value <= most, entry(i), values[i],
                square ? "must lie in 1e-14 to 100" : "must lie in 0.0001 to 1000000");
    }
}

void require_covariances(const Settings& settings) {
    const std::vector<double>& values = settings.covariance;
    const std::vector<double>& others = settings.other_turns;
    const std::vector<double>& stretches = settings.stretches;
    const std::size_t n = values.size(), of_other = Settings::of_turn, of_stretch = Settings::of_stretch;
    if (n < 5 || n > 12 || n % 3 == 1)
        throw InputError("covariance", "must have 5, 8 or 11 values, or a turn as one more", std::to_string(n));
    require_covariance("covariance", values, 0);
    if (others.size() % of_other != 0)
        throw InputError("other_turns", "must have ten numbers for each turn", std::to_string(others.size()));
    double rest = 1.0;
    for (std::size_t i = 0; i < others.size(); i += of_other) {
        const auto entry = [&](std::size_t at) { return entry_name("other_turns", static_cast<Index>(at)); };
        rest -= others[i];
        require(others[i] > 0.0 && rest > 0.0, entry(i), others[i], "must be above 0, and the sum of shares below 1");
        require(others[i + 1] == values[0], entry(i + 1), others[i + 1], "must be the radius of the covariance");
        require_covariance("other_turns", std::span(others).subspan(i + 1, of_other - 1), i + 1);
    }
    if (stretches.size() % of_stretch != 0)
        throw InputError("stretches", "must have thirteen numbers for each stretch", std::to_string(stretches.size()));
    if (!stretches.empty() && !others.empty())
        throw InputError("stretches", "must not be given with other_turns", std::to_string(stretches.size()));
    for (std::size_t i = 0; i < stretches.size(); i += of_stretch) {
        const std::string start = entry_name("stretches", static_cast<Index>(i));
        require_depth(start.c_str(), stretches[i]);
        require(i == 0 || stretches[i] > stretches[i - of_stretch], start, stretches[i],
                "must be below the stretch before");
        require_covariance("stretches", std::span(stretches).subspan(i + 1, of_stretch - 1), i + 1, true);
    }
    if (settings.window)
        throw InputError("window", "must not be given with near-and-far", std::to_string(*settings.window));
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
    require(std::abs(start_toolface) <= 1e6, "start_toolface", start_toolface,  // so that toolfaces of sectors differ
            "must lie in -1000000 to 1000000 degrees");
    require_first("first_vertex", first_vertex, sectors);
    require(first_vertex == 0 || start_depth, "first_vertex", first_vertex, "needs a start_depth");
    if (stop_vertex) require_within("stop_vertex", *stop_vertex, first_vertex + 1, Index{1} << 40);
    require(!stop_vertex || !stop_depth, "stop_vertex", stop_vertex.value_or(0), "must not be given with a stop_depth");
    require_within("neighbors", neighbors, 1,
                   estimator == Estimator::near_and_far ? kernel::most_shared
                   : estimator == Estimator::kriging    ? kernel::max_kriged
                                                        : kernel::max_neighbors);
    if (window) require(*window >= 1, "window", *window, "must be at least 1");
    require_positive("power", power);
    require(power <= 100.0, "power", power, "must be at most 100");  // so that no exponent of a weight overflows
    require(max_distance > 0.0, "max_distance", max_distance, "must be above 0");
    require(max_distance >= 1e-9, "max_distance", max_distance, "must be at least 1e-9 m");  // so its square is not 0
    require_within("max_iterations", max_iterations, 1, 255);
    require(tolerance >= 0.0, "tolerance", tolerance, "must be 0 or above");
    require_positive("angular_scale", angular_scale);
    require(angular_scale >= 0.001 && angular_scale <= 1000.0, "angular_scale", angular_scale,
            "must lie in 0.001 to 1000");
    if (estimator == Estimator::near_and_far) require_covariances(*this);
    if (estimator == Estimator::kriging) require_positive("kriging_range", kriging_range);
    require(std::isfinite(nugget) && nugget >= 1e-6, "nugget", nugget, "must be finite and at least 1e-6");
    require_within("most_vertices", most_vertices, 1, largest_count);
    if (stop_vertex)
        require(*stop_vertex - first_vertex <= most_vertices, "stop_vertex", *stop_vertex,
                "must be at most first_vertex + most_vertices = " + std::to_string(first_vertex + most_vertices));
    require_threads(threads);
}

}  // namespace helibore
