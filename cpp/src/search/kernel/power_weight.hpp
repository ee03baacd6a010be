// The weight of a neighbour in an estimate by inverse distance. Power 1 has none here: its weights are 1 / distance
// (estimate.hpp).
#pragma once

#include "search/kernel/kernel.hpp"

namespace helibore::kernel {
namespace {

// log2(x) = whole + rest, by the series of atanh, of ordinary numbers above 0.
template <class P>
inline void log2_parts(P x, P& whole, P& rest) {
    whole = P::exponent(x);
    P m = P::mantissa(x);
    const auto upper = P::less(P(1.4142135623730951), m);
    whole = P::blend(upper, whole + P(1.0), whole);
    m = P::blend(upper, m * P(0.5), m);
    const P s = (m - P(1.0)) / (m + P(1.0)), square = s * s;
    P series(0.0);
#pragma GCC unroll 10
    for (int odd = 19; odd >= 1; odd -= 2) series = series * square + P(2.885390081777927 / odd);  // 2 / ln 2
    rest = s * series;
}

// 2^y for y <= 0, by the series of exp.
template <class P>
inline P exp2_of(P y) {
    y = P::max(y, P(-1000.0));
    const P round(0x1.8p52), whole = (y + round) - round, f = (y - whole) * P(0.6931471805599453);
    constexpr double inverse_factorials[] = {
        1.0,        1.0,         1.0 / 2,      1.0 / 6,       1.0 / 24,       1.0 / 120,       1.0 / 720,
        1.0 / 5040, 1.0 / 40320, 1.0 / 362880, 1.0 / 3628800, 1.0 / 39916800, 1.0 / 479001600, 1.0 / 6227020800};
    P result(0.0);
#pragma GCC unroll 14
    for (int i = 13; i >= 0; --i) result = result * f + P(inverse_factorials[i]);
    return result * P::power_of_two(whole);
}

// Weights for any power, relative to the nearest neighbour so that none overflows: (d_min / d)^power. In plain
// arithmetic, to some 1e-15: a library's pow may differ between machines.
template <class P>
inline void relative_weights(const P* squares, P least, int neighbors, double power, P* weight) {
    P least_whole, least_rest, whole, rest;
    log2_parts(least, least_whole, least_rest);
    for (int i = 0; i < neighbors; ++i) {
        if (power == 2.0) {
            weight[i] = least / squares[i];
            continue;
        }
        log2_parts(squares[i], whole, rest);
        weight[i] = exp2_of(P(0.5 * power) * ((least_whole - whole) + (least_rest - rest)));
    }
}

}  // namespace
}  // namespace helibore::kernel
