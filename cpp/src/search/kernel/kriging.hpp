// Ordinary kriging of a vertex from its neighbours, once the iteration by inverse distance has settled its trial
// radius.
//
//     covariance(h) = (1 - q)^4 (1 + 4 q), q = h / range < 1, else 0    (Wendland C2); the nugget on the diagonal
//     radius = m + c' A^-1 (r - m 1),  m = 1' A^-1 r / 1' A^-1 1        A: of the neighbours, c: to the vertex
//
// h is the distance of the search, in the metric of angular_scale. The range is at most half a turn of the wall in this
// metric, which keeps A positive definite around the hole. So in exact arithmetic every pivot is at least the nugget:
// equal and collinear positions have a solution. The radius may leave the interval of the radii used by at most half
// of its length.
#pragma once

#include "search/kernel/select.hpp"

namespace helibore::kernel {
namespace {

// The matrix of the neighbours in canonical order, without what lies below the diagonal, and three columns more: 1, the
// radii less the trial radius, and the covariances with the vertex.
template <class P>
struct KrigingSystem {
    P row[max_kriged][max_kriged + 3];
    P low, high;  // least and greatest of the radii used
};

// Fills the matrix and the three columns. A neighbour beyond max_distance gets covariance 0 with all others, 0 instead
// of 1, and 0 for its radius. So it does not change the bits of any sum, as in inverse_distance().
template <class P>
inline void fill_system(const Group& g, const CandidateList& list, const Rules& rules, const std::int32_t* at, P trial,
                        KrigingSystem<P>& system) {
    const int n = rules.neighbors;
    const P scale = trial * P(rules.scale), range = P::min(P(rules.range), scale * P(180.0));
    const P per_metre = P(1.0) / range, per_degree = scale / range;
    const P depth = P::load(g.depth), toolface = P::load(g.toolface);
    const auto wrapped = [](P turn) { return P::min(P::abs(turn), P(360.0) - P::abs(turn)); };
    const auto covariance = [&](P turn, P along) {
        const P across = wrapped(turn) * per_degree, q = P::sqrt(across * across + along * along);
        const P rest = P::max(P(1.0) - q, P(0.0)), square = rest * rest;
        return square * square * (P(1.0) + P(4.0) * q);
    };
    P turn[max_kriged], along[max_kriged];  // degrees, ranges
    system.low = P(missing_square);
    system.high = P(-missing_square);
    for (int i = 0; i < n; ++i) {
        P at_depth, at_toolface, radius;
        P::read([&](int lane) -> const Candidate& { return list.rows[at[i * lanes + lane]]; }, at_depth, at_toolface,
                radius);
        const P away = at_depth - depth;
        turn[i] = at_toolface - toolface;
        const auto used = P::less_equal(on_wall(scale * wrapped(turn[i]), away * away, rules), P(rules.max_square));
        along[i] = P::blend(used, away * per_metre, P(1e100 * (i + 1)));  // far from the vertex and from each other
        system.low = P::blend(used, P::min(system.low, radius), system.low);
        system.high = P::blend(used, P::max(system.high, radius), system.high);
        system.row[i][n] = P::blend(used, P(1.0), P(0.0));
        system.row[i][n + 1] = P::blend(used, radius - trial, P(0.0));
        system.row[i][n + 2] = covariance(turn[i], along[i]);
    }
    for (int i = 0; i < n; ++i) {
        system.row[i][i] = P(1.0 + rules.nugget);
        for (int j = i + 1; j < n; ++j) system.row[i][j] = covariance(turn[i] - turn[j], along[i] - along[j]);
    }
}

// The radius, the sum of the squared weights (0 unless `with_squares`), and the kriging variance less that of the
// shape.
template <class P>
struct Kriged {
    P radius, squares, excess;
};

// Eliminates row by row; the sums of products of the last three columns are then 1' A^-1 1, 1' A^-1 r and so on.
template <class P>
inline Kriged<P> solve_system(KrigingSystem<P>& system, int n, double nugget, P trial, bool with_squares) {
    P ones(0.0), mean(0.0), toward(0.0), radius(0.0), explained(0.0);
    for (int k = 0; k < n; ++k) {
        const P* pivot = system.row[k];
        const P inverse = P(1.0) / P::max(pivot[k], P(nugget));
        for (int i = k + 1; i < n; ++i) {
            const P factor = pivot[i] * inverse;
            P* row = system.row[i];
            for (int j = i; j < n + 3; ++j) row[j] = row[j] - factor * pivot[j];
        }
        const P one = pivot[n] * inverse, covariance = pivot[n + 2] * inverse;
        ones = ones + one * pivot[n];
        mean = mean + one * pivot[n + 1];
        toward = toward + one * pivot[n + 2];
        radius = radius + covariance * pivot[n + 1];
        explained = explained + covariance * pivot[n + 2];
    }
    mean = mean / ones;
    radius = trial + (mean + (radius - mean * toward));
    const P half = P(0.5) * (system.high - system.low);
    radius = P::max(P::min(radius, system.high + half), system.low - half);
    P squares(0.0), weight[max_kriged];
    if (with_squares) {  // the weights are A^-1 (c + 1 (1 - 1' A^-1 c) / 1' A^-1 1)
        const P lagrange = (P(1.0) - toward) / ones;
        for (int k = n - 1; k >= 0; --k) {
            const P* pivot = system.row[k];
            P rest = pivot[n + 2] + lagrange * pivot[n];
            for (int j = k + 1; j < n; ++j) rest = rest - pivot[j] * weight[j];
            weight[k] = rest / P::max(pivot[k], P(nugget));
            squares = squares + weight[k] * weight[k];
        }
    }
    const P open = P(1.0) - toward;
    return {radius, squares, open * open / ones - explained};
}

// Returns the kriged radius of each vertex. `at`: the positions of its neighbours at the trial radius. The result of a
// vertex without a sample within max_distance has no meaning.
template <class P>
__attribute__((noinline)) Kriged<P> krige(const Group& g, const CandidateList& list, const Rules& rules,
                                          const std::int32_t* at, P trial, bool with_squares) {
    static_assert(sizeof(KrigingSystem<P>) == sizeof(KrigingRoom) && alignof(KrigingSystem<P>) <= alignof(KrigingRoom));
    auto& system = *static_cast<KrigingSystem<P>*>(static_cast<void*>(list.kriging));
    fill_system(g, list, rules, at, trial, system);
    return rules.neighbors == 16 ? solve_system(system, 16, rules.nugget, trial, with_squares)
                                 : solve_system(system, rules.neighbors, rules.nugget, trial, with_squares);
}

}  // namespace
}  // namespace helibore::kernel
