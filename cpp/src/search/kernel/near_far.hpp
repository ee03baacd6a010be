// Ordinary kriging of a vertex from near and far neighbours, by Settings::covariance.
//
//     covariance = sum over terms of  v (1 + a) exp(-a),   a^2 = 3 ((2 R sin(turn / 2) / around)^2 + (depth / along)^2)
//
// A position is the depth, and the sine s and cosine c of half the toolface, both relative to the vertex: the sine of
// half the difference of two toolfaces is then s1 c2 - c1 s2. The solution is that of kriging.hpp.
#pragma once

#include "search/kernel/kriging.hpp"
#include "search/kernel/neighbor_weight.hpp"

namespace helibore::kernel {
namespace {

// Returns 1 / 1, 1 / 1!, ... up to 1 / last!.
template <int last>
struct InverseFactorials {
    double of[static_cast<std::size_t>(last) + 1];
    constexpr InverseFactorials() : of{} {
        double factorial = 1.0;
        for (int i = 0; i <= last; ++i) {
            factorial *= i > 0 ? i : 1;
            of[i] = 1.0 / factorial;
        }
    }
};

// Returns exp(-x) for x >= 0, to 1e-11 of its value; 2^-200 for large x.
template <class P>
inline P decay(P x) {
    static constexpr InverseFactorials<9> inverse;
    const P y = P::max(x * P(-1.4426950408889634), P(-200.0));
    const P round(0x1.8p52), whole = (y + round) - round, f = (y - whole) * P(0.6931471805599453);
    P result(inverse.of[9]);
#pragma GCC unroll 9
    for (int i = 8; i >= 0; --i) result = result * f + P(inverse.of[i]);
    return result * P::power_of_two(whole);
}

// Computes the sine and cosine of x, radians in [-pi / 2, pi / 2], to 1e-13, by their series.
template <class P>
inline void sine_cosine(P x, P& sine, P& cosine) {
    static constexpr InverseFactorials<18> inverse;
    const P square = x * x;
    sine = P(inverse.of[17]);
    cosine = P(0.0) - P(inverse.of[18]);
    double sign = -1.0;
    for (int i = 15; i >= 1; i -= 2, sign = -sign) sine = sine * square + P(sign * inverse.of[i]);
    sign = 1.0;
    for (int i = 16; i >= 0; i -= 2, sign = -sign) cosine = cosine * square + P(sign * inverse.of[i]);
    sine = sine * x;
}

template <class P, int terms>
inline P covariance_of(P sine, P along, const CovarianceRule& rule) {
    const P around_square = sine * sine, along_square = along * along;
    P sum(0.0);
#pragma GCC unroll 3
    for (int t = 0; t < terms; ++t) {
        const P a = P::sqrt(around_square * P(rule.around[t]) + along_square * P(rule.along[t]));
        sum = sum + P(rule.variance[t]) * ((P(1.0) + a) * decay(a));
    }
    return sum;
}

// Fills the system. A missing neighbour has covariance 0 with all others, 0 instead of 1, and 0 for its radius.
template <class P, int terms>
__attribute__((noinline)) void fill_covariances(const Group& g, const Candidate* rows, int n,
                                                const CovarianceRule& rule, KrigingSystem<P>& system) {
    const P depth = P::load(g.depth), toolface = P::load(g.toolface), support = P::load(g.support);
    P sine[max_kriged], cosine[max_kriged], along[max_kriged], live[max_kriged];
    system.low = P(missing_square);
    system.high = P(-missing_square);
    for (int i = 0; i < n; ++i) {
        P at_depth, at_toolface, radius;
        P::read([&](int lane) -> const Candidate& { return rows[i * lanes + lane]; }, at_depth, at_toolface, radius);
        const auto used = P::less(P(static_cast<double>(i)), support);
        live[i] = P::blend(used, P(1.0), P(0.0));
        P turn = at_toolface - toolface;
        turn = P::blend(P::less(P(180.0), turn), turn - P(360.0), turn);
        turn = P::blend(P::less(turn, P(-180.0)), turn + P(360.0), turn);
        sine_cosine(turn * P(0.5 * metres_a_degree), sine[i], cosine[i]);
        along[i] = P::blend(used, at_depth - depth, P(0.0));
        system.low = P::blend(used, P::min(system.low, radius), system.low);
        system.high = P::blend(used, P::max(system.high, radius), system.high);
        system.row[i][n] = live[i];
        system.row[i][n + 1] = P::blend(used, radius - P(rule.radius), P(0.0));
        system.row[i][n + 2] = live[i] * covariance_of<P, terms>(sine[i], along[i], rule);
    }
    double total = rule.noise;
    for (int t = 0; t < terms; ++t) total += rule.variance[t];
    const bool all = P::bits(P::less(support, P(static_cast<double>(n)))) == 0;
    for (int i = 0; i < n; ++i) {
        system.row[i][i] = P(total);
        for (int j = i + 1; j < n; ++j) {
            const P between = sine[i] * cosine[j] - cosine[i] * sine[j];
            const P covariance = covariance_of<P, terms>(between, along[i] - along[j], rule);
            system.row[i][j] = all ? covariance : covariance * (live[i] * live[j]);
        }
    }
}

template <class P>
void krige_near_far(Group& g, const Candidate* rows, int n, const CovarianceRule& rule, KrigingRoom& room) {
    auto& system = *static_cast<KrigingSystem<P>*>(static_cast<void*>(&room));
    if (rule.terms == 1)
        fill_covariances<P, 1>(g, rows, n, rule, system);
    else if (rule.terms == 2)
        fill_covariances<P, 2>(g, rows, n, rule, system);
    else
        fill_covariances<P, 3>(g, rows, n, rule, system);
    const Kriged<P> kriged = solve_system(system, n, rule.noise, P(rule.radius), false);
    kriged.radius.store(g.radius);
    double shape = 0.0;
    for (int t = 0; t < rule.terms; ++t) shape += rule.variance[t];
    P::max(P(shape) + kriged.excess, P(0.0)).store(g.sums.square_weights);
}

}  // namespace
}  // namespace helibore::kernel
