// The rules for settings.
#include "helibore/settings.hpp"

#include <cmath>
#include <string>
#include <type_traits>

#include "base/messages.hpp"
#include "helibore/error.hpp"
#include "search/kernel/kernel.hpp"

namespace helibore {
namespace {

template <class T>
void require(bool good, const char* name, T value, const char* rule) {
    if (good) return;
    std::string text;
    if constexpr (std::is_floating_point_v<T>)
        text = number_text(value);
    else
        text = std::to_string(value);
    throw InputError(name, rule, text);
}

}  // namespace

void Settings::validate() const {
    const auto positive = [](const char* name, double value) {
        require(std::isfinite(value) && value > 0.0, name, value, "must be finite and above 0");
    };
    positive("bit_diameter", bit_diameter);
    require(bit_diameter <= 4.0, "bit_diameter", bit_diameter, "must be at most 4 m");
    require(sectors >= 3 && sectors <= 1000000, "sectors", sectors, "must lie in 3 to 1000000");
    require(std::isfinite(pitch) && pitch != 0.0, "pitch", pitch, "must be finite and not 0");
    if (start_depth) require(std::isfinite(*start_depth), "start_depth", *start_depth, "must be finite");
    if (stop_depth) require(std::isfinite(*stop_depth), "stop_depth", *stop_depth, "must be finite");
    require(std::isfinite(start_toolface), "start_toolface", start_toolface, "must be finite");
    require(neighbors >= 1 && neighbors <= kernel::max_neighbors, "neighbors", neighbors, "must lie in 1 to 256");
    if (window) require(*window >= 1, "window", *window, "must be at least 1");
    positive("power", power);
    require(max_distance > 0.0, "max_distance", max_distance, "must be above 0");
    require(max_iterations >= 1 && max_iterations <= 255, "max_iterations", max_iterations, "must lie in 1 to 255");
    require(tolerance >= 0.0, "tolerance", tolerance, "must be 0 or above");
    positive("angular_scale", angular_scale);
    require(threads >= 1 && threads <= 1024, "threads", threads, "must lie in 1 to 1024");
}

}  // namespace helibore
