// Sine and cosine of degrees, exact at every multiple of 90: a level hole has a cosine of 0, not 6e-17.
#pragma once

#include <cmath>
#include <numbers>

namespace helibore {

inline constexpr double degree = std::numbers::pi / 180.0;  // radians

struct SineCosine {
    double sine, cosine;
};

inline SineCosine sine_cosine(double degrees) {
    const double within = std::remainder(degrees, 90.0);                                       // exact, in [-45, 45]
    const double quarters = std::nearbyint((std::remainder(degrees, 360.0) - within) / 90.0);  // -2 to 2
    const double s = std::sin(within * degree), c = std::cos(within * degree);
    if (quarters == 0.0) return {s, c};
    if (quarters == 1.0) return {c, -s};
    if (quarters == -1.0) return {-c, s};
    return {-s, -c};
}

// The signed difference of two angles, in [-180, 180).
inline double wrap_difference(double degrees) {
    const double wrapped = std::remainder(degrees, 360.0);
    return wrapped == 180.0 ? -180.0 : wrapped;
}

}  // namespace helibore
