// Exponential and natural logarithm in plain arithmetic, within one unit in the last place: a library's functions
// differ in their last bits between machines.
//
// The polynomials are those of fdlibm (e_exp.c, e_log.c; Sun Microsystems, 1993, free to use with this notice).
#pragma once

#include <cmath>
#include <numbers>

#include "base/trigonometry.hpp"

namespace helibore {

inline constexpr double ln2_high = 6.93147180369123816490e-01, ln2_low = 1.90821492927058770002e-10;

// Returns e^x for x in [-700, 700], and 0 below.
inline double exponential(double x) {
    if (x < -700.0) return 0.0;
    const double n = nearest_whole(x / std::numbers::ln2), high = x - n * ln2_high, low = n * ln2_low, r = high - low;
    const double z = r * r;
    const double c = r - z * (1.66666666666666019037e-01 +
                              z * (-2.77777777770155933842e-03 +
                                   z * (6.61375632143793436117e-05 +
                                        z * (-1.65339022054652515390e-06 + z * 4.13813679705723846039e-08))));
    return std::ldexp(1.0 - ((low - (r * c) / (2.0 - c)) - high), static_cast<int>(n));
}

// Returns the natural logarithm of a normal number above 0.
inline double logarithm(double x) {
    int power = 0;
    double m = 2.0 * std::frexp(x, &power);  // in [1, 2)
    --power;
    if (m > std::numbers::sqrt2) m *= 0.5, ++power;
    const double f = m - 1.0, s = f / (2.0 + f), z = s * s, half = 0.5 * f * f;
    const double series = z * (6.666666666666735130e-01 +
                               z * (3.999999999940941908e-01 +
                                    z * (2.857142874366239149e-01 +
                                         z * (2.222219843214978396e-01 +
                                              z * (1.818357216161805012e-01 +
                                                   z * (1.531383769920937332e-01 + z * 1.479819860511658591e-01))))));
    return power * ln2_high - ((half - (s * (half + series) + power * ln2_low)) - f);
}

}  // namespace helibore
