// Sine and cosine of degrees, exact at every multiple of 90: a level hole has a cosine of 0, not 6e-17.
#pragma once

#include <cmath>
#include <numbers>

#include "base/trigonometry.hpp"

namespace helibore {

inline constexpr double degree = std::numbers::pi / 180.0;  // radians

inline SineCosine sine_cosine(double degrees) {
    const double within = std::remainder(degrees, 90.0);                                      // exact, in [-45, 45]
    const double quarters = nearest_whole((std::remainder(degrees, 360.0) - within) / 90.0);  // -2 to 2
    return turned(sine_cosine_within(within * degree), static_cast<int>(quarters));
}

// Returns a difference of two angles, in degrees, wrapped to [-180, 180).
inline double wrap_difference(double degrees) {
    const double wrapped = std::remainder(degrees, 360.0);
    return wrapped == 180.0 ? -180.0 : wrapped;
}

}  // namespace helibore
