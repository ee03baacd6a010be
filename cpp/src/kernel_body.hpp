// The innermost loops, written once over a Pack of doubles (pack_*.hpp) and compiled for each instruction set.
//
// Lanes are vertices: every instruction works on P::width vertices of a group at once, one candidate after the other,
// so that no lane waits for another and nothing branches on data. Only add, multiply, divide, square root, minimum and
// maximum in a fixed order: all instruction sets give the same bits.
//
// Selection of the V smallest keys, V <= 8: candidates come in batches of 8; a batch is sorted by a network of 19
// comparators, its lower half with the best so far is one step of a bitonic merge, which leaves the 8 smallest:
//
//     best    b0 <= b1 <= ... <= b7          min(b0,a7) min(b1,a6) ... min(b7,a0)   the 8 smallest of the 16, bitonic
//     batch   a0 <= a1 <= ... <= a7    ->    max(...)                               the others: only their least counts
//
// Neighbours are then put in canonical order (their position in the list), in which the sums run: the order does not
// depend on how they were found.
#pragma once

#include "kernel.hpp"

namespace helibore::kernel {
namespace {

constexpr std::int64_t position_mask = (std::int64_t{1} << position_bits) - 1;

// A bound must hold although squares, ratios and truncated keys are rounded: they err by less than these.
constexpr double slack = 1.0 + 1e-9;

template <class P>
inline void compare_exchange(P& a, P& b) {
    const P low = P::min(a, b);
    b = P::max(a, b);
    a = low;
}

template <class P>
inline void sort_eight(P* v) {
    constexpr int pairs[19][2] = {{0, 2}, {1, 3}, {4, 6}, {5, 7}, {0, 4}, {1, 5}, {2, 6}, {3, 7}, {0, 1}, {2, 3},
                                  {4, 5}, {6, 7}, {2, 4}, {3, 5}, {1, 4}, {3, 6}, {1, 2}, {3, 4}, {5, 6}};
#pragma GCC unroll 19
    for (const auto& pair : pairs) compare_exchange(v[pair[0]], v[pair[1]]);
}

// Batcher's odd-even merge sort for any n (Knuth, The Art of Computer Programming 3, algorithm 5.2.2 M).
template <class P>
inline void sort_any(P* v, int n) {
    for (int p = 1; p < n; p *= 2)
        for (int k = p; k >= 1; k /= 2)
            for (int j = k % p; j + k < n; j += 2 * k)
                for (int i = j; i < j + k && i + k < n; ++i)
                    if (i / (2 * p) == (i + k) / (2 * p)) compare_exchange(v[i], v[i + k]);
}

// What a vertex sees of the list: its squared distance to a candidate, tagged with the candidate's position.
template <class P, bool windowed, bool wraps>
struct Eye {
    P depth, toolface, scale, window_first, window_last;
    const CandidateList& list;

    Eye(const Group& g, int lane, P metres_a_degree, const CandidateList& candidates)
        : depth(P::load(g.depth + lane)),
          toolface(P::load(g.toolface + lane)),
          scale(metres_a_degree),
          window_first(P::load(g.window_first + lane)),
          window_last(P::load(g.window_last + lane)),
          list(candidates) {}

    P key(std::int64_t i) const {
        P turn = P(list.toolface[i]) - toolface;
        if constexpr (wraps) turn = P::min(P::abs(turn), P(360.0) - P::abs(turn));
        const P across = scale * turn;  // its sign does not matter
        const P along = P(list.depth[i]) - depth;
        const P key = P::tag(across * across + along * along, list.position[i]);
        if constexpr (!windowed) return key;
        const P rank(list.rank[i]);
        return P::blend(P::both(P::less_equal(window_first, rank), P::less(rank, window_last)), key, none());
    }

    // The key of no candidate, greater than that of any.
    P none() const { return P::tag(P(missing_square), list.position[list_capacity]); }
};

// The V smallest keys of the list into best[0, V), sorted, and the smallest of the others.
template <class P, class Eye>
inline P select_up_to_eight(const Eye& eye, int neighbors, P* best) {
    const P none = eye.none();
    for (int i = 0; i < 8; ++i) best[i] = none;
    P rejected(boundless_square);
    for (std::int64_t i = 0; i < eye.list.count; i += 8) {
        P batch[8];
        for (int j = 0; j < 8; ++j) batch[j] = eye.key(i + j);
        sort_eight(batch);
        for (int j = 0; j < 8; ++j) {
            rejected = P::min(rejected, P::max(best[j], batch[7 - j]));
            best[j] = P::min(best[j], batch[7 - j]);
        }
#pragma GCC unroll 3
        for (int half = 4; half > 0; half /= 2)
#pragma GCC unroll 8
            for (int j = 0; j < 8; ++j)
                if ((j & half) == 0) compare_exchange(best[j], best[j + half]);
    }
    for (int j = neighbors; j < 8; ++j) {
        rejected = P::min(rejected, best[j]);
        best[j] = none;
    }
    return rejected;
}

template <class P, class Eye>
inline P select_many(const Eye& eye, int neighbors, P* best) {
    const P none = eye.none();
    for (int i = 0; i < neighbors; ++i) best[i] = none;
    P rejected(boundless_square);
    for (std::int64_t i = 0; i < eye.list.count; ++i) {
        P key = eye.key(i);
        if (P::any(P::less(key, best[neighbors - 1])))
            for (int j = 0; j < neighbors; ++j) compare_exchange(best[j], key);
        rejected = P::min(rejected, key);
    }
    return rejected;
}

template <class P, class Eye>
inline P select(const Eye& eye, int neighbors, P* best) {
    return neighbors <= 8 ? select_up_to_eight<P>(eye, neighbors, best) : select_many<P>(eye, neighbors, best);
}

// x^exponent for 0 < x <= 1, by the series of atanh and exp, in plain arithmetic (relative error below 1e-14 for
// results that matter): the library's pow may differ between machines.
inline double fractional_power(double x, double exponent) {
    std::int64_t bits;
    __builtin_memcpy(&bits, &x, sizeof bits);
    std::int64_t two = ((bits >> 52) & 0x7ff) - 1023;
    bits = (bits & 0x000fffffffffffff) | 0x3ff0000000000000;
    double m;
    __builtin_memcpy(&m, &bits, sizeof m);
    if (m > 1.4142135623730951) {
        m *= 0.5;
        ++two;
    }
    const double s = (m - 1.0) / (m + 1.0);
    double series = 0.0;
    for (int odd = 23; odd >= 1; odd -= 2) series = series * (s * s) + 1.0 / odd;
    constexpr double log2_e = 1.4426950408889634, ln_2 = 0.6931471805599453;
    const double y = exponent * (static_cast<double>(two) + 2.0 * s * series * log2_e);
    if (y < -1000.0) return 0.0;
    const std::int64_t whole = static_cast<std::int64_t>(y - 0.5);  // y <= 0: rounds to the nearest
    const double f = (y - static_cast<double>(whole)) * ln_2;
    double result = 1.0;
    for (int i = 16; i >= 1; --i) result = result * f / i + 1.0;
    const std::int64_t scale_bits = (whole + 1023) << 52;
    double scale;
    __builtin_memcpy(&scale, &scale_bits, sizeof scale);
    return result * scale;
}

// Weights for any power, relative to the nearest neighbour so that none overflows: (d_min / d)^power.
template <class P>
inline P relative_weight(P square, P least, double power) {
    const P ratio = least / square;
    if (power == 2.0) return ratio;
    double x[lanes];
    ratio.store(x);
    for (int i = 0; i < P::width; ++i) x[i] = x[i] > 1e-300 ? fractional_power(x[i], 0.5 * power) : 0.0;
    return P::load(x);
}

// The neighbours of one pack of vertices, in canonical order, as the estimate needs them.
template <class P>
struct Neighbours {
    P turn[max_neighbors];   // |toolface difference|, degrees
    P along[max_neighbors];  // depth difference squared
    P radius[max_neighbors];
};

template <class P, class Eye>
inline P find_neighbours(const Eye& eye, int neighbors, Neighbours<P>& found) {
    P best[max_neighbors];
    const P rejected = select<P>(eye, neighbors, best);
    for (int i = 0; i < (neighbors <= 8 ? 8 : neighbors); ++i) best[i] = P::position_key(best[i]);
    if (neighbors <= 8)
        sort_eight(best);
    else
        sort_any(best, neighbors);
    for (int i = 0; i < neighbors; ++i) {
        std::int64_t at[lanes];
        best[i].store_positions(at);
        const P turn = P::abs(P::pick(eye.list.toolface, at) - eye.toolface);
        const P along = P::pick(eye.list.depth, at) - eye.depth;
        found.turn[i] = P::min(turn, P(360.0) - turn);
        found.along[i] = along * along;
        found.radius[i] = P::pick(eye.list.radius, at);
    }
    return rejected;
}

template <class P>
struct Estimate {
    P radius, support, least, farthest;  // least and farthest: squared distances, used and selected
};

// Weights proportional to 1 / d without a division: the product of the other seven distances, each the product of those
// before it and those behind it. A neighbour that is not used stands as 1 and changes no bit of the others.
template <class P>
inline void products_of_others(const P* squares, P limit, P* weight) {
    P distance[8];
    for (int i = 0; i < 8; ++i) distance[i] = P::blend(P::less_equal(squares[i], limit), P::sqrt(squares[i]), P(1.0));
    weight[0] = P(1.0);
    for (int i = 1; i < 8; ++i) weight[i] = weight[i - 1] * distance[i - 1];
    P behind = distance[7];
    for (int i = 6; i >= 0; --i) {
        weight[i] = weight[i] * behind;
        behind = behind * distance[i];
    }
}

// sum(w r) / sum(w) over the neighbours at most max_distance away; the mean of those at distance 0 if there are any.
// A neighbour too far away adds 0 and so leaves the bits of the sums alone: which ones were selected beyond the limit,
// where no box has been certified, cannot show. The result is held within the least and greatest radius used, which
// rounding could leave by an ulp.
template <class P, int fixed>  // fixed: the number of neighbours where it is known to the compiler, else 0
inline Estimate<P> inverse_distance(const Neighbours<P>& n, P scale, const Rules& rules) {
    const int neighbors = fixed > 0 ? fixed : rules.neighbors;
    constexpr auto room = static_cast<std::uint64_t>(fixed > 0 ? fixed : max_neighbors);
    P least(missing_square), farthest(0.0), squares[room];
    for (int i = 0; i < neighbors; ++i) {
        const P across = scale * n.turn[i];
        squares[i] = across * across + n.along[i];
        least = P::min(least, squares[i]);
        farthest = P::max(farthest, squares[i]);
    }
    P weights(0.0), weighted(0.0), support(0.0), low(missing_square), high(-missing_square);
    const P limit(rules.max_square < missing_square ? rules.max_square : missing_square / 2);
    const auto hits = P::less_equal(least, P(zero_square));
    const bool any_hits = P::any(hits);
    P weight[room];
    if (fixed == 8 && rules.power == 1.0)
        products_of_others(squares, limit, weight);
    else
        for (int i = 0; i < neighbors; ++i)
            weight[i] =
                rules.power == 1.0 ? P(1.0) / P::sqrt(squares[i]) : relative_weight(squares[i], least, rules.power);
    if (!any_hits && P::all(P::less_equal(farthest, limit))) {  // mostly: every neighbour is used
        for (int i = 0; i < neighbors; ++i) {
            weights = weights + weight[i];
            weighted = weighted + weight[i] * n.radius[i];
            low = P::min(low, n.radius[i]);
            high = P::max(high, n.radius[i]);
        }
        support = P(static_cast<double>(neighbors));
        return {P::max(P::min(weighted / weights, high), low), support, least, farthest};
    }
    for (int i = 0; i < neighbors; ++i) {
        if (any_hits)
            weight[i] = P::blend(hits, P::blend(P::less_equal(squares[i], P(zero_square)), P(1.0), P(0.0)), weight[i]);
        const auto used = P::less_equal(squares[i], limit);
        weight[i] = P::blend(used, weight[i], P(0.0));
        weights = weights + weight[i];
        weighted = weighted + weight[i] * n.radius[i];
        support = support + P::blend(used, P(1.0), P(0.0));
        low = P::blend(used, P::min(low, n.radius[i]), low);
        high = P::blend(used, P::max(high, n.radius[i]), high);
    }
    return {P::max(P::min(weighted / weights, high), low), support, least, farthest};
}

template <class P, bool windowed, bool wraps>
Verdict estimate_pack(Group& g, int lane, const CandidateList& list, const Rules& rules, const Box& box) {
    auto active = P::less(P(0.0), P::load(g.active + lane));
    if (!P::any(active)) return Verdict::done;
    const P scale(rules.scale), max_square(rules.max_square), trial = P::load(g.trial + lane);
    const P discarded = P::load(g.discarded + lane);
    P current = trial, selected_at = trial, iterations = P::load(g.iterations + lane), rejected(0.0);
    P reach = P::load(g.reach_square + lane);
    Neighbours<P> neighbours;
    bool selected = false;

    // A squared distance found at one radius is at another at least this.
    const auto at_least = [&](P square, P found_at) {
        const P ratio = current / found_at;
        return square * P::min(P(1.0), ratio * ratio);
    };
    const auto moved_since = [&](P then) { return P::both(active, P::less(P(0.0), P::abs(current - then))); };
    const auto stop = [&](Verdict verdict) {
        current.store(g.trial + lane);
        iterations.store(g.iterations + lane);
        reach.store(g.reach_square + lane);
        P::blend(active, P(1.0), P(0.0)).store(g.active + lane);
        return verdict;
    };

    for (;;) {
        if (!selected) {
            rejected = find_neighbours<P>(Eye<P, windowed, wraps>(g, lane, current * scale, list), rules.neighbors,
                                          neighbours);
            selected_at = current;
            selected = true;
        }
        const Estimate<P> next = rules.neighbors == 8 ? inverse_distance<P, 8>(neighbours, current * scale, rules)
                                                      : inverse_distance<P, 0>(neighbours, current * scale, rules);
        const P needed = P::min(next.farthest, max_square) * P(slack);
        if (P::any(P::both(moved_since(selected_at), P::less_equal(at_least(rejected, selected_at), needed)))) {
            selected = false;
            continue;
        }
        if (P::any(P::both(moved_since(trial), P::less_equal(at_least(discarded, trial), needed))))
            return stop(Verdict::refetch);
        const P width = current * scale * P(box.width), height(box.height);
        if (P::any(P::both(active, P::less_equal(P::min(width * width, height * height), needed))))
            return stop(Verdict::widen);

        iterations = P::blend(active, iterations + P(1.0), iterations);
        reach = P::blend(active, P::max(reach, P::min(next.farthest, max_square)), reach);
        const auto found = P::less(P(0.0), next.support);
        const P radius = P::blend(found, next.radius, P(__builtin_nan("")));
        P::blend(active, radius, P::load(g.radius + lane)).store(g.radius + lane);
        P::blend(active, P::blend(found, P::sqrt(next.least), P(__builtin_nan(""))), P::load(g.nearest + lane))
            .store(g.nearest + lane);
        P::blend(active, next.support, P::load(g.support + lane)).store(g.support + lane);
        const auto goes_on =
            P::both(P::both(active, found), P::both(P::less(P(rules.tolerance), P::abs(radius - current)),
                                                    P::less(iterations, P(static_cast<double>(rules.max_iterations)))));
        current = P::blend(goes_on, radius, current);
        active = goes_on;
        if (!P::any(active)) return stop(Verdict::done);
    }
}

template <class P>
Verdict estimate(Group& group, const CandidateList& list, const Rules& rules, const Box& box) {
    for (int lane = 0; lane < lanes; lane += P::width) {
        const Verdict verdict = rules.windowed ? estimate_pack<P, true, true>(group, lane, list, rules, box)
                                : box.wraps    ? estimate_pack<P, false, true>(group, lane, list, rules, box)
                                               : estimate_pack<P, false, false>(group, lane, list, rules, box);
        if (verdict != Verdict::done) return verdict;
    }
    return Verdict::done;
}

template <class P, bool windowed>
void nominate_pack(Group& g, int lane, const CandidateList& list, const Rules& rules, unsigned char* keep) {
    const P scale = P::load(g.trial + lane) * P(rules.scale);
    P best[max_neighbors];
    const P rejected = select<P>(Eye<P, windowed, true>(g, lane, scale, list), rules.neighbors, best);
    P::min(P::load(g.discarded + lane), rejected).store(g.discarded + lane);
    for (int i = 0; i < rules.neighbors; ++i) {
        double keys[lanes];
        best[i].store(keys);
        for (int j = 0; j < P::width; ++j) {
            std::int64_t bits;
            __builtin_memcpy(&bits, &keys[j], sizeof bits);
            keep[bits & position_mask] = 1;
        }
    }
}

template <class P>
void nominate(Group& group, const CandidateList& list, const Rules& rules, unsigned char* keep) {
    for (int lane = 0; lane < lanes; lane += P::width)
        rules.windowed ? nominate_pack<P, true>(group, lane, list, rules, keep)
                       : nominate_pack<P, false>(group, lane, list, rules, keep);
}

template <class P, bool wraps>
std::int64_t gather_from(CandidateList& list, const double* depth, const double* toolface, const double* radius,
                         std::int64_t n, double center, double half_width) {
    std::int64_t i = 0, count = list.count;
    for (; i + P::width <= n && count + P::width <= list_capacity; i += P::width) {
        const P t = P::load(toolface + i);
        P turn = P::abs(t - P(center));
        if constexpr (wraps) turn = P::min(turn, P(360.0) - turn);
        const auto inside = P::less_equal(turn, P(half_width));
        P::compress(inside, t, list.toolface + count);
        P::compress(inside, P::load(depth + i), list.depth + count);
        count += P::compress(inside, P::load(radius + i), list.radius + count);
    }
    for (; i < n && count < list_capacity; ++i) {
        const double turn = __builtin_fabs(toolface[i] - center);
        list.toolface[count] = toolface[i];
        list.depth[count] = depth[i];
        list.radius[count] = radius[i];
        count += (turn < 360.0 - turn ? turn : 360.0 - turn) <= half_width;
    }
    list.count = count;
    return i;
}

template <class P>
std::int64_t gather(CandidateList& list, const double* depth, const double* toolface, const double* radius,
                    std::int64_t n, double center, double half_width, bool wraps) {
    return wraps ? gather_from<P, true>(list, depth, toolface, radius, n, center, half_width)
                 : gather_from<P, false>(list, depth, toolface, radius, n, center, half_width);
}

template <class P>
bool all_within(const double* values, std::int64_t n, double low, double high) {
    std::int64_t i = 0;
    for (; i + 4 * P::width <= n; i += 4 * P::width) {  // a branch for every few vectors
        auto good = P::less_equal(P(low), P::load(values + i));
        for (int j = 0; j < 4; ++j) {
            const P x = P::load(values + i + j * P::width);
            good = P::both(good, P::both(P::less_equal(P(low), x), P::less_equal(x, P(high))));
        }
        if (!P::all(good)) return false;
    }
    for (; i < n; ++i)
        if (!(low <= values[i] && values[i] <= high)) return false;
    return true;
}

template <class P>
Order order(const double* values, std::int64_t n) {
    bool level = false;
    std::int64_t i = 1;
    for (; i + P::width <= n; i += P::width) {
        const P before = P::load(values + i - 1), x = P::load(values + i);
        if (!P::all(P::less(before, x))) {
            if (!P::all(P::less_equal(before, x))) return Order::falls;
            level = true;
        }
    }
    for (; i < n; ++i) {
        if (!(values[i - 1] <= values[i])) return Order::falls;
        level = level || values[i - 1] == values[i];
    }
    return level ? Order::level : Order::rises;
}

template <class P>
constexpr Functions functions_of(const char* name) {
    return {name, &all_within<P>, &order<P>, &gather<P>, &estimate<P>, &nominate<P>};
}

}  // namespace
}  // namespace helibore::kernel
