// Which candidates are a vertex's nearest.
//
// Selection of the 8 smallest keys: candidates come in batches of 8; a batch is sorted by a network of 19 comparators,
// its lower half with the best so far is one step of a bitonic merge, which leaves the 8 smallest:
//
//     best    b0 <= b1 <= ... <= b7          min(b0,a7) min(b1,a6) ... min(b7,a0)   the 8 smallest of the 16, bitonic
//     batch   a0 <= a1 <= ... <= a7    ->    max(...)                               the others: only their least counts
//
// A key is a squared distance tagged with a position, in doubles (exact) or in floats (narrow, at half the cost).
#pragma once

#include "search/kernel/kernel.hpp"

namespace helibore::kernel {
namespace {

constexpr float narrow_none_square = 2.0f * narrow_none * narrow_none;

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

// Leaves in best the 8 smallest of two sorted eights, bitonic, and returns the smallest of the others.
template <class P>
inline P merge_eight(P* best, const P* batch) {
    P least = P::max(best[0], batch[7]);
    for (int j = 1; j < 8; ++j) least = P::min(least, P::max(best[j], batch[7 - j]));
    for (int j = 0; j < 8; ++j) best[j] = P::min(best[j], batch[7 - j]);
    return least;
}

template <class P>
inline void sort_bitonic(P* v) {
#pragma GCC unroll 3
    for (int half = 4; half > 0; half /= 2)
#pragma GCC unroll 8
        for (int j = 0; j < 8; ++j)
            if ((j & half) == 0) compare_exchange(v[j], v[j + half]);
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
template <class P, bool windowed>
struct Eye {
    using Pack = P;
    static constexpr int candidates = 1;
    P depth, toolface, scale, window_first, window_last;
    const CandidateList& list;

    Eye(const Group& g, P metres_a_degree, const CandidateList& of)
        : depth(P::load(g.depth)),
          toolface(P::load(g.toolface)),
          scale(metres_a_degree),
          window_first(P::load(g.window_first)),
          window_last(P::load(g.window_last)),
          list(of) {}

    P key(std::int64_t i) const {
        const Candidate& c = list.rows[i];
        const P turn = P::abs(P(c.toolface) - toolface);
        const P across = scale * P::min(turn, P(360.0) - turn);
        const P along = P(c.depth) - depth;
        const P key = P::tag(across * across + along * along, list.position[i]);
        if constexpr (!windowed) return key;
        const P rank(static_cast<double>(c.rank));
        return P::blend(P::both(P::less_equal(window_first, rank), P::less(rank, window_last)), key, none());
    }

    // The key of no candidate, greater than that of any.
    P none() const { return P::tag(P(missing_square), list.position[list_capacity]); }
    P boundless() const { return P(boundless_square); }
};

// Toolface less center, in [-180, 180].
template <class P>
inline P turn_from(P center, P toolface) {
    const P turn = toolface - center;
    const P back = P::blend(P::less(P(180.0), turn), turn - P(360.0), turn);
    return P::blend(P::less(turn, P(-180.0)), turn + P(360.0), back);
}

// Fills the narrow columns of a padded list, up to the next multiple of sixteen: so many are looked at in one go.
template <class P>
void fill_narrow_columns(const CandidateList& list, const Group& g) {
    for (std::int64_t i = 0; i < (list.count + 15) / 16 * 16; i += lanes) {
        P depth, toolface, radius;
        P::read([&](int j) -> const Candidate& { return list.rows[i + j]; }, depth, toolface, radius);
        turn_from(P(g.center), toolface).narrow().store(list.across + i);
        P::min(depth - P(g.middle), P(static_cast<double>(narrow_none))).narrow().store(list.along + i);
    }
}

// The same in floats, of a list that spans no more than half a turn, one or two candidates at a time.
template <class P>
struct NarrowEye {
    using Pack = typename P::Narrow;
    static constexpr int candidates = Pack::candidates;
    Pack across, along, scale;
    const CandidateList& list;

    NarrowEye(const Group& g, P metres_a_degree, const CandidateList& of)
        : along(Pack::each_vertex((P::load(g.depth) - P(g.middle)).narrow())),
          scale(Pack::each_vertex(metres_a_degree.narrow())),
          list(of) {
        across = Pack::each_vertex(turn_from(P(g.center), P::load(g.toolface)).narrow());
    }

    Pack key(std::int64_t i) const {
        const Pack x = scale * (Pack::each_candidate(list.across + i) - across);
        const Pack y = Pack::each_candidate(list.along + i) - along;
        return Pack::tag(x * x + y * y, Pack::each_candidate(list.narrow_position + i));
    }
    Pack none() const { return Pack(narrow_none_square); }
    Pack boundless() const { return none(); }
};

// The 8 smallest keys of the list into best, sorted, and the smallest of the others.
template <class Eye, class P = typename Eye::Pack>
inline P select_eight(const Eye& eye, P* best) {
    for (int i = 0; i < 8; ++i) best[i] = eye.none();
    P rejected = eye.boundless();
    for (std::int64_t i = 0; i < eye.list.count; i += 8 * Eye::candidates) {
        P batch[8];
        for (int j = 0; j < 8; ++j) batch[j] = eye.key(i + j * Eye::candidates);
        sort_eight(batch);
        rejected = P::min(rejected, merge_eight(best, batch));
        sort_bitonic(best);
    }
    return rejected;
}

// The V smallest keys, sorted, and "none" behind them.
template <class P>
inline P keep_first(P* best, int neighbors, P rejected, P none) {
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
        if (P::bits(P::less(key, best[neighbors - 1])) != 0)
            for (int j = 0; j < neighbors; ++j) compare_exchange(best[j], key);
        rejected = P::min(rejected, key);
    }
    return rejected;
}

template <class P, class Eye>
inline P select(const Eye& eye, int neighbors, P* best) {
    if (neighbors > 8) return select_many<P>(eye, neighbors, best);
    const P rejected = select_eight(eye, best);
    return keep_first(best, neighbors, rejected, eye.none());
}

}  // namespace
}  // namespace helibore::kernel
