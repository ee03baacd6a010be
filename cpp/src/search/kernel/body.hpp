// The innermost loops, written once over a Pack of doubles (pack_*.hpp) and compiled for each instruction set.
//
// Lanes are vertices: every instruction works on the eight vertices of a group at once, one candidate after the other,
// so that no lane waits for another and nothing branches on data. The code uses only add, multiply, divide, square
// root, minimum and maximum, in a fixed order, so that all instruction sets give the same bits.
//
// select.hpp finds the neighbours, estimate.hpp weighs them. This file holds the loops over samples, and the loops for
// the circles of a section; there a lane is a point of the section.
#pragma once

#include "search/kernel/estimate.hpp"
#include "search/kernel/near_far.hpp"

namespace helibore::kernel {
namespace {

// Adds the samples that pass the filter to the list, block by block: one loop finds where they are, the next copies
// their rows. Returns how many samples were tested.
template <class P, bool wraps>
std::int64_t gather_from(CandidateList& list, const Group& g, const double* depth, const double* toolface,
                         const double* radius, std::int64_t n, std::int64_t rank, double half_width) {
    const auto test = [&](std::int64_t i) {
        P turn = P::abs(P::load(toolface + i) - P(g.center));
        if constexpr (wraps) turn = P::min(turn, P(360.0) - turn);
        return P::bits(P::less_equal(turn, P(half_width)));
    };
    constexpr std::int64_t block = 512;
    std::int32_t passed[block + 16];
    std::int64_t i = 0, count = list.count;
    while (i < n && count < list_capacity) {
        const std::int64_t room = list_capacity - count < block ? list_capacity - count : block;
        const std::int64_t some = n - i < room ? n - i : room;
        std::int64_t hits = 0, j = 0;
        for (; j + 16 <= some; j += 16)
            hits += P::store_indices(test(i + j) | test(i + j + 8) << 8, static_cast<std::int32_t>(j), passed + hits);
        for (; j < some; ++j) {
            double turn = __builtin_fabs(toolface[i + j] - g.center);
            if (wraps && 360.0 - turn < turn) turn = 360.0 - turn;
            passed[hits] = static_cast<std::int32_t>(j);
            hits += turn <= half_width;
        }
        for (std::int64_t h = 0; h < hits; ++h) {
            const std::int64_t at = i + passed[h];
            list.rows[count + h] = {depth[at], toolface[at], radius[at], rank + at};
        }
        count += hits;
        i += some;
    }
    list.count = count;
    return i;
}

template <class P>
std::int64_t gather(CandidateList& list, const Group& g, const double* depth, const double* toolface,
                    const double* radius, std::int64_t n, std::int64_t rank, const Filter& filter) {
    return filter.wraps ? gather_from<P, true>(list, g, depth, toolface, radius, n, rank, filter.half_width)
                        : gather_from<P, false>(list, g, depth, toolface, radius, n, rank, filter.half_width);
}

template <class P>
bool all_within(const double* values, std::int64_t n, double low, double high) {
    constexpr std::int64_t ahead = 256;  // 2 kB: hardware prefetch stops at the end of a 4 kB page, and is slow
    std::int64_t i = 0;
    for (; i + 4 * lanes <= n; i += 4 * lanes) {  // one branch for every four vectors
        auto good = P::less_equal(P(low), P::load(values + i));
        for (int j = 0; j < 4; ++j) {
            __builtin_prefetch(values + i + j * lanes + ahead);
            const P x = P::load(values + i + j * lanes);
            good = P::both(good, P::both(P::less_equal(P(low), x), P::less_equal(x, P(high))));
        }
        if (P::bits(good) != every_lane) return false;
    }
    for (; i < n; ++i)
        if (!(low <= values[i] && values[i] <= high)) return false;
    return true;
}

template <class P>
Order order(const double* values, std::int64_t n) {
    bool level = false;
    std::int64_t i = 1;
    for (; i + lanes <= n; i += lanes) {
        const P before = P::load(values + i - 1), x = P::load(values + i);
        if (P::bits(P::less(before, x)) != every_lane) {
            if (P::bits(P::less_equal(before, x)) != every_lane) return Order::falls;
            level = true;
        }
    }
    for (; i < n; ++i) {
        if (!(values[i - 1] <= values[i])) return Order::falls;
        level = level || values[i - 1] == values[i];
    }
    return level ? Order::level : Order::rises;
}

template <class P, bool least>
Found extreme(const double* xs, const double* ys, std::size_t n, double x, double y) {
    const auto squares = [&](std::size_t i) {
        const P dx = P::load(xs + i) - P(x), dy = P::load(ys + i) - P(y);
        return dx * dx + dy * dy;
    };
    P of_lanes = squares(0);
    for (std::size_t i = lanes; i < n; i += lanes)
        of_lanes = least ? P::min(of_lanes, squares(i)) : P::max(of_lanes, squares(i));
    double best[lanes];
    of_lanes.store(best);
    double square = best[0];
    for (const double one : best)
        if (least ? one < square : one > square) square = one;
    for (std::size_t i = 0; i < n; i += lanes) {
        const auto as_good = least ? P::less_equal(squares(i), P(square)) : P::less_equal(P(square), squares(i));
        if (const unsigned bits = P::bits(as_good)) return {i + static_cast<std::size_t>(__builtin_ctz(bits)), square};
    }
    return {0, square};  // the squares are not numbers
}

template <class P>
constexpr Functions functions_of(const char* name) {
    return {name,         &all_within<P>, &order<P>,         &extreme<P, true>, &extreme<P, false>, &gather<P>,
            &estimate<P>, &nominate<P>,   &estimate_from<P>, &krige_shared<P>,  &sigma<P>};
}

}  // namespace
}  // namespace helibore::kernel
