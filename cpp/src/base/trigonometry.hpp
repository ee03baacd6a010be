// Sine, cosine and arc tangent in plain arithmetic, within one unit in the last place. A library's functions differ in
// their last bits between machines: with and without fused multiplication, on Windows, on ARM.
//
// The polynomials are those of fdlibm (k_sin.c, k_cos.c, s_atan.c; Sun Microsystems, 1993, free to use with this
// notice).
#pragma once

#include <cmath>
#include <numbers>

namespace helibore {

// Returns the whole number nearest to x, for |x| < 2^51; of two equally near, the even one. std::nearbyint is not used,
// because MinGW's version rounds as the host has set the x87, which StandardArithmetic does not set.
inline double nearest_whole(double x) {
    return (x + 0x1.8p52) - 0x1.8p52;
}

struct SineCosine {
    double sine, cosine;
};

// Returns the sine and cosine of x + rest, radians in [-pi/4, pi/4]; `rest` holds the digits that x has no room for.
inline SineCosine sine_cosine_within(double x, double rest = 0.0) {
    const double z = x * x, w = z * z, v = z * x;
    const double s =
        8.33333333332248946124e-03 +
        z * (-1.98412698298579493134e-04 +
             z * (2.75573137070700676789e-06 + z * (-2.50507602534068634195e-08 + z * 1.58969099521155010221e-10)));
    const double sine = x - ((z * (0.5 * rest - v * s) - rest) - v * -1.66666666666666324348e-01);
    const double c =
        z * (4.16666666666666019037e-02 + z * (-1.38888888888741095749e-03 + z * 2.48015872894767294178e-05)) +
        w * w * (-2.75573143513906633035e-07 + z * (2.08757232129817482790e-09 + z * -1.13596475577881948265e-11));
    const double half = 0.5 * z, most = 1.0 - half;
    return {sine, most + (((1.0 - most) - half) + (z * c - x * rest))};
}

// Returns the sine and cosine of an angle plus a number of quarter turns; `of` holds the sine and cosine of the angle.
inline SineCosine turned(const SineCosine& of, int quarters) {
    switch (quarters & 3) {
        case 1:
            return {of.cosine, -of.sine};
        case 2:
            return {-of.sine, -of.cosine};
        case 3:
            return {-of.cosine, of.sine};
        default:
            return of;
    }
}

// Returns the sine and cosine of x, radians in [-2 pi, 2 pi].
inline SineCosine sine_cosine_of_radians(double x) {
    const double quarters = nearest_whole(x * (2.0 / std::numbers::pi));
    const double first = x - quarters * 1.57079632673412561417e+00;  // pi/2 to 33 bits: the product is exact
    const double rest = quarters * 6.07710050650619224932e-11;       // pi/2 beyond these bits
    const double within = first - rest;
    return turned(sine_cosine_within(within, (first - within) - rest), static_cast<int>(quarters));
}

// Returns the arc tangent of x >= 0, radians in [0, pi/2].
inline double arc_tangent(double x) {
    static constexpr double high[] = {0.0, 4.63647609000806093515e-01, 7.85398163397448278999e-01,
                                      9.82793723247329054082e-01, 1.57079632679489655800e+00};
    static constexpr double low[] = {0.0, 2.26987774529616870924e-17, 3.06161699786838301793e-17,
                                     1.39033110312309984516e-17, 6.12323399573676603587e-17};
    const int part = x < 0.4375 ? 0 : x < 0.6875 ? 1 : x < 1.1875 ? 2 : x < 2.4375 ? 3 : 4;
    const double t = part == 0   ? x
                     : part == 1 ? (2.0 * x - 1.0) / (2.0 + x)
                     : part == 2 ? (x - 1.0) / (x + 1.0)
                     : part == 3 ? (x - 1.5) / (1.0 + 1.5 * x)
                                 : -1.0 / x;
    static constexpr double terms[] = {
        3.33333333333329318027e-01,  -1.99999999998764832476e-01, 1.42857142725034663711e-01,
        -1.11111104054623557880e-01, 9.09088713343650656196e-02,  -7.69187620504482999495e-02,
        6.66107313738753120669e-02,  -5.83357013379057348645e-02, 4.97687799461593236017e-02,
        -3.65315727442169155270e-02, 1.62858201153657823623e-02};
    const double z = t * t;
    double series = 0.0;
    for (int i = 10; i >= 0; --i) series = series * z + terms[i];
    return high[part] - ((t * (z * series) - low[part]) - t);
}

// Returns the angle of the vector (x, y), radians in [-pi, pi]; 0 for (0, 0).
inline double arc_tangent(double y, double x) {
    if (x == 0.0 && y == 0.0) return 0.0;
    const double sharp = arc_tangent(std::abs(y) / std::abs(x));
    return std::copysign(x < 0.0 ? std::numbers::pi - (sharp - 1.2246467991473531772e-16) : sharp, y);
}

}  // namespace helibore
