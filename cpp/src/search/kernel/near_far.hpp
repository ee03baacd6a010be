// Ordinary kriging of a group of vertices from neighbours that they share, by Settings::covariance.
//
//     covariance = sum over terms of  v (1 + a) exp(-a),   a^2 = 3 ((2 R sin(turn / 2) / around)^2 + (depth / along)^2)
//
// If the second term repeats after half a turn, it has R sin(turn) instead of 2 R sin(turn / 2). If the first is
// smooth, it is v exp(-a^2 / 6).
//
// A position is the depth, and the sine s and cosine c of half the toolface, both relative to the middle of the group;
// the toolface also less what the shape turns from there. The sine of half the difference of two toolfaces is then
// s1 c2 - c1 s2. The solution is that of kriging.hpp, with one
// matrix for all vertices: a pack holds eight columns of it, or the covariances of a neighbour with the eight vertices.
//
// The scatter of a group is how far its neighbours are off: the mean square of what each differs from the estimate of
// those before it, over the variance of that. It is about 1 where the covariance describes the hole, and above where
// radii change more. Neighbours count as near_square / (near_square + distance^2), and `usual_count` more have 1.
#pragma once

#include <algorithm>

#include "search/kernel/kernel.hpp"
#include "search/kernel/neighbor_weight.hpp"

namespace helibore::kernel {
namespace {

constexpr double usual_count = 3.0, near_square = 0.09;  // m^2

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

// Returns exp(-x) for x >= 0, to 5e-11 of its value; 2^-200 for large x. The polynomial is that of degree 7 whose
// greatest relative error as 2^f, |f| <= 1/2, is least (by Remez); pairs of its terms shorten the chain of operations.
template <class P>
inline P decay(P x) {
    const P y = P::max(x * P(-1.4426950408889634), P(-200.0));
    const P round(0x1.8p52), whole = (y + round) - round, f = y - whole, square = f * f;
    const P low = (P(0.999999999961682) + P(0.6931471807284466) * f) +
                  (P(0.24022651198157902) + P(0.055504103534480244) * f) * square;
    const P high = (P(0.009618027253640325) + P(0.0013333922563934296) * f) +
                   (P(0.00015469291148681688) + P(1.5201921461382409e-05) * f) * square;
    return (low + high * (square * square)) * P::power_of_two(whole);
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

// Returns the square of the chord over (2 R)^2 in term t, from that of the sine of half the difference of two
// toolfaces.
template <class P>
inline P square_of_chord(int t, P square, const CovarianceRule& rule) {
    if (t != 1) return square;
    return P::max(square - P(rule.half_turns ? 1.0 : 0.0) * (square * square), P(0.0));  // rounding: below 0
}

// The exponential of term t at a distance, which becomes the one that it is multiplied by, plus 1.
template <class P>
inline P decay_of(int t, P& a, const CovarianceRule& rule) {
    if (t != 0) return decay(a);
    const P square = a * a * P(rule.smooth ? 1.0 / 6.0 : 0.0);
    a = a * P(rule.smooth ? 0.0 : 1.0);
    return decay(a + square);
}

// The distances of eight pairs, in each term: what the square roots above give.
template <class P, int terms>
struct Distances {
    P of_term[static_cast<std::size_t>(terms)];
};

template <class P, int terms>
inline Distances<P, terms> distances(P sine, P along, const CovarianceRule& rule) {
    const P around_square = sine * sine, along_square = along * along;
    Distances<P, terms> found;
#pragma GCC unroll 3
    for (int t = 0; t < terms; ++t) {
        const P chord_square = square_of_chord(t, around_square, rule);
        found.of_term[t] = P::sqrt(chord_square * P(rule.around[t]) + along_square * P(rule.along[t]));
    }
    return found;
}

template <class P, int terms>
inline P covariance_at(const Distances<P, terms>& at, const CovarianceRule& rule) {
    P sum(0.0);
#pragma GCC unroll 3
    for (int t = 0; t < terms; ++t) {
        P a = at.of_term[t];
        const P e = decay_of(t, a, rule);
        sum = sum + P(rule.variance[t]) * ((P(1.0) + a) * e);
    }
    return sum;
}

// The columns of the equations: the matrix, the covariances with the vertices from `size` on, and 1 and the radius less
// R at `last`: behind the matrix in its last pack, if that has room.
struct SharedColumns {
    int size, last, count;
    explicit SharedColumns(int n)
        : size((n + lanes - 1) / lanes * lanes),
          last(n + 2 <= size ? n : size + lanes),
          count(last < size ? size + lanes : size + 2 * lanes) {}
};

// Fills the rows of the n neighbours, without what lies left of the diagonal pack. Rows and columns from n to `size`
// are those of the unit matrix and 0. A square root takes long, so the covariances of a pack are computed from it while
// the root for the next pack is taken.
template <class P, int terms>
__attribute__((noinline)) void fill_covariances(const Group& g, const SharedNeighbor* rows, int n,
                                                const SharedColumns& columns, const CovarianceRule& rule,
                                                SharedRoom& room) {
    const int size = columns.size;
    double sine[max_shared + lanes], cosine[max_shared + lanes], along[max_shared + lanes];
    const P center(g.center), middle(g.middle);
    const auto place = [&](P depth, P toolface, int at) {
        const P z = depth - middle;
        const P turn = toolface - center - P(rule.turn) * z, round(0x1.8p52);
        const P whole = (turn * P(1.0 / 360.0) + round) - round;
        P s, c;
        sine_cosine((turn - P(360.0) * whole) * P(0.5 * metres_a_degree), s, c);
        s.store(sine + at);
        c.store(cosine + at);
        z.store(along + at);
    };
    for (int i = 0; i < size; i += lanes) {
        P depth, toolface, radius;
        P::read([&](int lane) -> const SharedNeighbor& { return rows[i + lane < n ? i + lane : n - 1]; }, depth,
                toolface, radius);
        place(depth, toolface, i);
    }
    place(P::load(g.depth), P::load(g.toolface), size);
    double total = 0.0;
    for (int t = 0; t < terms; ++t) total += rule.variance[t];
    double nothing[lanes], *to = nothing;
    Distances<P, terms> before{};
    for (int i = 0; i < size; ++i) {
        double* row = room.row[i];
        if (i >= n) {
            std::fill_n(row + n, columns.count - n, 0.0);
            row[i] = 1.0;
            continue;
        }
        const P s(sine[i]), c(cosine[i]), z(along[i]);
        for (int j = i / lanes * lanes; j <= size; j += lanes) {
            const P between = s * P::load(cosine + j) - c * P::load(sine + j);
            const auto found = distances<P, terms>(between, z - P::load(along + j), rule);
            covariance_at(before, rule).store(to);
            before = found;
            to = row + j;
        }
        std::fill_n(row + n, size - n, 0.0);
        if (columns.last > size) P(0.0).store(row + size + lanes);
        row[i] = total + rule.noise / rows[i].count;
        row[columns.last] = 1.0;
        row[columns.last + 1] = rows[i].radius - rule.radius;
    }
    covariance_at(before, rule).store(to);
}

// Eliminates eight rows at a time: of each pack of columns, first what the rows above take from it, then what the eight
// rows take from each other. Sums run in the order of the rows. A row has `columns` columns, of which the first `size`
// are the matrix. `factors` has room for 8 * size: what the rows above take of each of the eight.
template <class P>
__attribute__((noinline)) void eliminate(int size, int columns, double least_pivot, double* rows, int row_length,
                                         double* factors, double* inverse) {
    for (int top = 0; top < size; top += lanes) {
        P tile[lanes];
        double inner[lanes][lanes];
        double* const first = rows + static_cast<std::ptrdiff_t>(top) * row_length;
        const double* left = rows + top;
        for (int k = 0; k < top; ++k, left += row_length) (P::load(left) * P(inverse[k])).store(factors + k * lanes);
        const auto load = [&](int column) {
#pragma GCC unroll 8
            for (int r = 0; r < lanes; ++r) tile[r] = P::load(first + r * row_length + column);
            const double *above = rows + column, *by = factors;
            for (int k = 0; k < top; ++k, above += row_length, by += lanes) {
                const P of_row = P::load(above);
#pragma GCC unroll 8
                for (int r = 0; r < lanes; ++r) tile[r] = tile[r] - P(by[r]) * of_row;
            }
        };
        load(top);
#pragma GCC unroll 8
        for (int k = 0; k < lanes; ++k) {
            double* row = first + k * row_length + top;
            tile[k].store(row);
            inverse[top + k] = 1.0 / std::max(row[k], least_pivot);
#pragma GCC unroll 8
            for (int r = k + 1; r < lanes; ++r) {
                inner[k][r] = row[r] * inverse[top + k];
                tile[r] = tile[r] - P(inner[k][r]) * tile[k];
            }
        }
        for (int column = top + lanes; column < columns; column += lanes) {
            load(column);
#pragma GCC unroll 8
            for (int k = 0; k < lanes; ++k) {
                tile[k].store(first + k * row_length + column);
#pragma GCC unroll 8
                for (int r = k + 1; r < lanes; ++r) tile[r] = tile[r] - P(inner[k][r]) * tile[k];
            }
        }
    }
}

template <class P>
void krige_shared(Group& g, const SharedNeighbor* rows, int n, const CovarianceRule& rule, SharedRoom& room) {
    const SharedColumns columns(n);
    const auto fill = rule.terms == 2 ? fill_covariances<P, 2> : fill_covariances<P, 3>;
    fill(g, rows, n, columns, rule, room);
    double inverse[max_shared];
    eliminate<P>(columns.size, columns.count, rule.noise / most_averaged, room.row[0], max_shared + 2 * lanes,
                 room.factors, inverse);

    const P depth = P::load(g.depth), toolface = P::load(g.toolface), degree(rule.radius * metres_a_degree);
    double ones = 0.0, mean = 0.0, low = missing_square, high = -missing_square;
    P toward(0.0), radius(0.0), explained(0.0), least(missing_square);
    for (int k = 0; k < n; ++k) {
        const double *row = room.row[k], *last = row + columns.last;
        const double one = last[0] * inverse[k], value = last[1];
        ones += one * last[0];
        mean += one * value;
        const P covariance = P::load(row + columns.size), part = covariance * P(inverse[k]);
        toward = toward + P(one) * covariance;
        radius = radius + part * P(value);
        explained = explained + part * covariance;
        low = std::min(low, rows[k].radius);
        high = std::max(high, rows[k].radius);
        if (rows[k].count > 1.0) continue;
        const P turn = P::abs(P(rows[k].toolface) - toolface), along = P(rows[k].depth) - depth;
        const P across = degree * P::min(turn, P(360.0) - turn);
        least = P::min(least, across * across + along * along);
    }
    mean /= ones;
    radius = P(rule.radius) + (P(mean) + (radius - P(mean) * toward));
    const double half = 0.5 * (high - low);
    P::max(P::min(radius, P(high + half)), P(low - half)).store(g.radius);
    P::sqrt(least).store(g.nearest);
    double shape = 0.0;
    for (int t = 0; t < rule.terms; ++t) shape += rule.variance[t];
    const P open = P(1.0) - toward;
    P::max(P(shape) + (open * open * P(1.0 / ones) - explained), P(0.0)).store(g.sums.square_weights);
    double squares = usual_count, count = usual_count;
    for (int k = 0; k < n; ++k) {
        const double* last = room.row[k] + columns.last;
        const double off = last[1] - mean * last[0], along = rows[k].depth - g.depth[lanes / 2];
        const double turn = std::abs(rows[k].toolface - g.toolface[lanes / 2]);
        const double across = rule.radius * metres_a_degree * std::min(turn, 360.0 - turn);
        const double share = near_square / (near_square + across * across + along * along);
        squares += share * off * off * inverse[k];
        count += share;
    }
    P(squares / count).store(g.sums.scatter);
}

}  // namespace
}  // namespace helibore::kernel
