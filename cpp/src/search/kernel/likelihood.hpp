// The restricted likelihood of a block of samples under a covariance, and its derivatives (wall/covariance.cpp).
//
// The covariance is that of near_far.hpp. A pack holds eight columns of a matrix; sums run in a fixed order.
#pragma once

#include "search/kernel/near_far.hpp"

namespace helibore::kernel {
namespace {

// Sets out = a' b for square matrices.
template <class P>
__attribute__((noinline)) void multiply(int size, const double* a, int a_length, const double* b, int b_length,
                                        double* out) {
    for (int top = 0; top < size; top += lanes)
        for (int column = 0; column < size; column += lanes) {
            P tile[lanes];
#pragma GCC unroll 8
            for (int r = 0; r < lanes; ++r) tile[r] = P(0.0);
            const double *left = a + top, *right = b + column;
            for (int k = 0; k < size; ++k, left += a_length, right += b_length) {
                const P of_row = P::load(right);
#pragma GCC unroll 8
                for (int r = 0; r < lanes; ++r) tile[r] = tile[r] + P(left[r]) * of_row;
            }
#pragma GCC unroll 8
            for (int r = 0; r < lanes; ++r) tile[r].store(out + (top + r) * size + column);
        }
}

// Returns the sum of the products of n numbers; n is a multiple of `lanes`.
template <class P>
inline double sum_of_products(const double* a, const double* b, int n) {
    P sum[4] = {P(0.0), P(0.0), P(0.0), P(0.0)};
    for (int i = 0; i < n; i += lanes) {
        P& part = sum[i / lanes % 4];
        part = part + P::load(a + i) * P::load(b + i);
    }
    double each[lanes], total = 0.0;
    ((sum[0] + sum[1]) + (sum[2] + sum[3])).store(each);
    for (const double one : each) total += one;
    return total;
}

// Sets out = sum over k of weight[k] times row k.
template <class P>
inline void sum_of_rows(int size, const double* weight, int step, const double* rows, int length, double* out) {
    for (int column = 0; column < size; column += lanes) {
        P sum(0.0);
        for (int k = 0; k < size; ++k) sum = sum + P(weight[k * step]) * P::load(rows + k * length + column);
        sum.store(out + column);
    }
}

// The squares of the distances of eight pairs, around and along the hole in one term, and the root of their sum.
template <class P>
struct PairDistances {
    P around, along, whole;
};

// Fills the matrix K, then 1 and the radii, then the unit matrix if there are slopes; and the derivatives of K. As in
// near_far.hpp, a pack is computed from its square roots while those of the next one are taken.
template <class P, int terms, bool slopes>
__attribute__((noinline)) void fill_block(const Block& block, const CovarianceRule& rule, const BlockRoom& room) {
    const int n = block.n, size = block.size, length = 2 * size + lanes;
    double total = rule.noise;
    for (int t = 0; t < terms; ++t) total += rule.variance[t];
    constexpr std::size_t most = max_terms;
    PairDistances<P> before[most] = {};
    int row_before = 0, column_before = 0;  // the first pack is written twice
    const auto finish = [&] {
        const int to = row_before * size + column_before;
        P sum(0.0);
#pragma GCC unroll 3
        for (int t = 0; t < terms; ++t) {
            P a = before[t].whole;
            const P e = P(rule.variance[t]) * decay_of(t, a, rule), part = e * (P(1.0) + a);
            sum = sum + part;
            if constexpr (slopes) {
                part.store(room.parts[3 * t] + to);
                const P slope = t == 0 ? e * P(rule.smooth ? 1.0 / 3.0 : 1.0) : e;
                (slope * before[t].around).store(room.parts[3 * t + 1] + to);
                (slope * before[t].along).store(room.parts[3 * t + 2] + to);
            }
        }
        sum.store(room.rows + row_before * length + column_before);
    };
    for (int i = 0; i < n; ++i) {
        const P s(block.sine[i]), c(block.cosine[i]), z(block.along[i]);
        for (int j = slopes ? 0 : i / lanes * lanes; j < n; j += lanes) {
            const P between = s * P::load(block.cosine + j) - c * P::load(block.sine + j);
            const P along = z - P::load(block.along + j);
            const P around_square = between * between, along_square = along * along;
            PairDistances<P> found[most];
#pragma GCC unroll 3
            for (int t = 0; t < terms; ++t) {
                found[t].around = square_of_chord(t, around_square, rule) * P(rule.around[t]);
                found[t].along = along_square * P(rule.along[t]);
                found[t].whole = P::sqrt(found[t].around + found[t].along);
            }
            finish();
#pragma GCC unroll 3
            for (int t = 0; t < terms; ++t) before[t] = found[t];
            row_before = i;
            column_before = j;
        }
    }
    finish();
    for (int i = 0; i < size; ++i) {
        double* row = room.rows + i * length;
        const int from = i < n ? n : 0;
        std::fill_n(row + from, length - from, 0.0);
        row[i] = i < n ? total : 1.0;
        row[size] = i < n ? 1.0 : 0.0;
        row[size + 1] = i < n ? block.radius[i] : 0.0;
        if (!slopes) continue;
        row[size + lanes + i] = 1.0;
        for (int p = 0; p < 3 * terms; ++p) std::fill_n(room.parts[p] + i * size + from, size - from, 0.0);
    }
}

// With K = U' D^-1 U, U the rows after the elimination and E what they make of the unit matrix: K^-1 = E' D^-1 E.
template <class P>
void block_slopes(const Block& block, const CovarianceRule& rule, double mean, const BlockRoom& room,
                  BlockTerms& terms) {
    const int size = block.size, length = 2 * size + lanes, square = size * size, parts = 3 * rule.terms + 1;
    const double* e = room.rows + size + lanes;
    double *one = room.vectors, *value = one + size, *inner = room.rows;  // P takes the place of the rows
    for (int k = 0; k < size; ++k)
        for (int j = 0; j < size; j += lanes)
            (P::load(e + k * length + j) * P(room.inverses[k])).store(room.factors + k * size + j);
    sum_of_rows<P>(size, room.rows + size, length, room.factors, size, one);
    sum_of_rows<P>(size, room.rows + size + 1, length, room.factors, size, value);
    double* const last = room.parts[parts - 1];
    multiply<P>(size, room.factors, size, e, length, last);
    for (int i = 0; i < size; ++i) {
        value[i] -= mean * one[i];
        for (int j = 0; j < size; j += lanes) {
            const P rest = P::load(last + i * size + j) - P(one[i] / terms.ones) * P::load(one + j);
            rest.store(inner + i * size + j);
            (P(rule.noise) * rest).store(last + i * size + j);
        }
        if (i >= block.n) last[i * size + i] = 0.0;
    }
    double* turned = room.factors;
    double* spare = room.parts[max_parts];
    double* products[max_parts];  // part P
    for (int p = 0; p < parts; ++p) {
        double* part = room.parts[p];
        if (p == parts - 1) {
            terms.square[p] = rule.noise * sum_of_products<P>(value, value, size);
            products[p] = part;
        } else {
            sum_of_rows<P>(size, value, 1, part, size, turned);
            terms.square[p] = sum_of_products<P>(turned, value, size);
            multiply<P>(size, part, size, inner, size, spare);
            products[p] = spare;
            spare = part;
        }
        terms.trace[p] = 0.0;
        for (int i = 0; i < size; ++i) terms.trace[p] += products[p][i * size + i];
        for (int i = 0; i < size; i += lanes)
            for (int j = 0; j < size; ++j)
#pragma GCC unroll 8
                for (int r = 0; r < lanes; ++r) turned[j * size + i + r] = products[p][(i + r) * size + j];
        for (int q = 0; q <= p; ++q) terms.product[p][q] = sum_of_products<P>(turned, products[q], square);
    }
}

template <class P>
bool block_likelihood(const Block& block, const CovarianceRule& rule, bool slopes, const BlockRoom& room,
                      BlockTerms& terms) {
    const int size = block.size, length = 2 * size + lanes;
    const auto fill = rule.terms == 2 ? slopes ? fill_block<P, 2, true> : fill_block<P, 2, false>
                      : slopes        ? fill_block<P, 3, true>
                                      : fill_block<P, 3, false>;
    fill(block, rule, room);
    eliminate<P>(size, slopes ? length : size + lanes, 1e-300, room.rows, length, room.factors, room.inverses);
    double square = 0.0, mean = 0.0;
    terms.ones = 0.0;
    for (int k = 0; k < block.n; ++k) {
        const double* row = room.rows + k * length;
        if (!(row[k] > 0.0)) return false;
        const double one = row[size] * room.inverses[k], value = row[size + 1];
        terms.ones += one * row[size];
        mean += one * value;
        square += value * room.inverses[k] * value;
    }
    mean /= terms.ones;
    terms.rest = square - mean * (mean * terms.ones);
    if (slopes) block_slopes<P>(block, rule, mean, room, terms);
    return true;
}

}  // namespace
}  // namespace helibore::kernel
