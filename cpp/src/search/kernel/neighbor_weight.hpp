// The weight of a neighbour in an estimate by inverse distance.
#pragma once

#include "search/kernel/kernel.hpp"

namespace helibore::kernel {
namespace {

// Computes log2(x) = whole + rest by the series of atanh. x must be a normal number above 0.
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

// Returns 2^y for y <= 0, by the series of exp.
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

// Computes weights for any power, relative to the nearest neighbour so that none overflows: (d_min / d)^power. Their
// relative error is about 1e-15. Only plain arithmetic is used, because a library's pow may differ between machines.
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

// Computes weights proportional to 1 / d without a division: each is the product of the other seven distances: that of
// the distances before it, times that of the distances behind it. A neighbour whose square is set to 1 does not change
// a bit of the other weights.
template <class P>
inline void products_of_others(const P* squares, P* weight) {
    P distance[8];
    for (int i = 0; i < 8; ++i) distance[i] = P::sqrt(squares[i]);
    weight[0] = P(1.0);
    for (int i = 1; i < 8; ++i) weight[i] = weight[i - 1] * distance[i - 1];
    P behind = distance[7];
    for (int i = 6; i >= 0; --i) {
        weight[i] = weight[i] * behind;
        behind = behind * distance[i];
    }
}

// Computes the weights of neighbours from their squared distances. `fixed` is their number if it is known at compile
// time, else 0.
template <class P, int fixed>
inline void weigh(const P* squares, P least, int neighbors, double power, P* weight) {
    if (fixed == 8 && power == 1.0)
        products_of_others(squares, weight);
    else if (power == 1.0)
        for (int i = 0; i < neighbors; ++i) weight[i] = P(1.0) / P::sqrt(squares[i]);
    else
        relative_weights(squares, least, neighbors, power, weight);
}

}  // namespace
}  // namespace helibore::kernel
