// Finds the nearest candidates of each vertex, in one of two ways.
//
// Short lists, up to 16 neighbours: lanes are vertices, keys are floats, and the best 8 or 16 so far are kept sorted.
// Candidates come in batches of 8; a batch is sorted by a network of 19 comparators, and one step of a bitonic merge
// leaves the smallest:
//
//     best    b0 <= b1 <= ... <= b7          min(b0,a7) min(b1,a6) ... min(b7,a0)   the 8 smallest of the 16, bitonic
//     batch   a0 <= a1 <= ... <= a7    ->    max(...)                               the others: only their least counts
//
// If the best 16 are kept, the batch is merged with the last 8 of them; the result and the first 8 are bitonic again.
//
// In all other cases lanes are the candidates of one vertex. Counting finds a threshold that the float keys of a few
// more than V candidates pass. The exact keys of these candidates are then computed, and a threshold is found that V of
// them pass.
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

// Merges the sorted `batch` into the sorted `best`, which then holds the smallest keys of the two, in bitonic order.
// Returns the smallest of the other keys.
template <int kept, int count, class P>
inline P merge(P* best, const P* batch) {
    P* const last = best + kept - count;
    P least = P::max(last[0], batch[count - 1]);
    for (int j = 1; j < count; ++j) least = P::min(least, P::max(last[j], batch[count - 1 - j]));
    for (int j = 0; j < count; ++j) last[j] = P::min(last[j], batch[count - 1 - j]);
    return least;
}

template <int count, class P>
inline void sort_bitonic(P* v) {
#pragma GCC unroll 4
    for (int half = count / 2; half > 0; half /= 2)
#pragma GCC unroll 16
        for (int j = 0; j < count; ++j)
            if ((j & half) == 0) compare_exchange(v[j], v[j + half]);
}

template <int count, class P>
inline void sort(P* v) {
    sort_eight(v);
    if constexpr (count == 16) {
        sort_eight(v + 8);
        for (int j = 0; j < 4; ++j) {
            const P one = v[8 + j];
            v[8 + j] = v[15 - j];
            v[15 - j] = one;
        }
        sort_bitonic<16>(v);
    }
}

// Returns the toolface less the center, in [-180, 180].
template <class P>
inline P turn_from(P center, P toolface) {
    const P turn = toolface - center;
    const P back = P::blend(P::less(P(180.0), turn), turn - P(360.0), turn);
    return P::blend(P::less(turn, P(-180.0)), turn + P(360.0), back);
}

// Fills the narrow columns of a padded list, up to the next multiple of sixteen, because the search reads sixteen at a
// time.
template <class P>
void fill_narrow_columns(const CandidateList& list, const Group& g) {
    for (std::int64_t i = 0; i < (list.count + 15) / 16 * 16; i += lanes) {
        P depth, toolface, radius;
        P::read([&](int j) -> const Candidate& { return list.rows[i + j]; }, depth, toolface, radius);
        turn_from(P(g.center), toolface).narrow().store(list.across + i);
        P::min(depth - P(g.middle), P(static_cast<double>(narrow_none))).narrow().store(list.along + i);
    }
}

struct Numbers {
    float of[narrow_capacity + 16] = {};
    constexpr Numbers() {
        for (int i = 0; i < narrow_capacity + 16; ++i) of[i] = static_cast<float>(i);
    }
};
inline constexpr Numbers numbers;

// Computes the keys of a list's candidates for the vertices of a group, one or two candidates at a time. A key is a
// float: the squared distance, whose lowest bits are replaced by the candidate's position in the list. `windowed`:
// candidates outside a vertex's window get keys larger than any real square. `wraps`: the list may span more than half
// a turn.
template <class P, bool windowed, bool wraps>
struct NarrowEye {
    using Pack = typename P::Narrow;
    static constexpr int candidates = Pack::candidates;
    Pack across, along, scale, window_middle, window_square;  // half the window's length squared
    const CandidateList& list;

    NarrowEye(const Group& g, P metres_a_degree, const CandidateList& of)
        : along(Pack::each_vertex((P::load(g.depth) - P(g.middle)).narrow())),
          scale(Pack::each_vertex(metres_a_degree.narrow())),
          list(of) {
        across = Pack::each_vertex(turn_from(P(g.center), P::load(g.toolface)).narrow());
        const P first = P::load(g.window_first), last = P::load(g.window_last), half = (last - first) * P(0.5);
        window_middle = Pack::each_vertex((first + half - P(0.5)).narrow());
        window_square = Pack::each_vertex((half * half).narrow());
    }

    Pack key(std::int64_t i) const {
        Pack turn = Pack::each_candidate(list.across + i) - across;
        if constexpr (wraps) {
            turn = Pack::max(turn, Pack(0.0f) - turn);
            turn = Pack::min(turn, Pack(360.0f) - turn);
        }
        const Pack x = scale * turn;
        const Pack y = Pack::each_candidate(list.along + i) - along;
        Pack square = x * x + y * y;
        if constexpr (windowed) {  // outside the window: more than any real square
            const Pack from_middle = Pack::each_candidate(numbers.of + i) - window_middle;
            square = Pack::max(square, (from_middle * from_middle - window_square) * Pack(1e32f));
        }
        return Pack::tag(square, Pack::each_candidate(list.narrow_position + i));
    }
    Pack none() const { return Pack(narrow_none_square); }
    Pack boundless() const { return none(); }
};

// Writes the smallest keys of the list to `best`, sorted; returns the smallest of the other keys.
template <int kept, class Eye, class P = typename Eye::Pack>
inline P select(const Eye& eye, P* best) {
    for (int i = 0; i < kept; ++i) best[i] = eye.none();
    P rejected = eye.boundless();
    for (std::int64_t i = 0; i < eye.list.count; i += 8 * Eye::candidates) {
        P batch[8];
        for (int j = 0; j < 8; ++j) batch[j] = eye.key(i + j * Eye::candidates);
        sort_eight(batch);
        rejected = P::min(rejected, merge<kept, 8>(best, batch));
        sort_bitonic<kept>(best);
    }
    return rejected;
}

// Keeps the V smallest of the sorted keys, and puts "none" behind them; returns the smallest of the other keys.
template <int kept, class P>
inline P keep_first(P* best, int neighbors, P rejected, P none) {
    for (int j = neighbors; j < kept; ++j) {
        rejected = P::min(rejected, best[j]);
        best[j] = none;
    }
    return rejected;
}

// Returns the number whose bits lie halfway between those of two numbers that are not negative.
template <class Bits, class Number>
inline Number halfway(Number low, Number high) {
    Bits a, b;
    __builtin_memcpy(&a, &low, sizeof a);
    __builtin_memcpy(&b, &high, sizeof b);
    a += (b - a) / 2;
    __builtin_memcpy(&low, &a, sizeof a);
    return low;
}

// Returns a threshold that at least `least` and, unless keys are equal, at most `most` keys pass. `passing` counts the
// keys up to a threshold. The first tries assume evenly spaced keys, later tries halve the interval. There are `all`
// keys, all between `low` and `high`.
template <class Bits, class Number, class Count>
inline Number threshold(Number guess, Number low, Number high, int all, int least, int most, const Count& passing) {
    const Number start = low;
    int below = 0, above = all;
    bool bounded = false;
    for (int tries = 0;; ++tries) {
        const int passed = passing(guess);
        if (passed < least) {
            low = guess;
            below = passed;
        } else if (passed > most) {
            high = guess;
            above = passed;
            bounded = true;
        } else {
            return guess;
        }
        const Number wanted = static_cast<Number>(least + most + 1) / 2;
        Number next =
            bounded ? low + (high - low) * (wanted - static_cast<Number>(below)) / static_cast<Number>(above - below)
                    : start + (guess - start) * wanted / static_cast<Number>(passed > 0 ? passed : 1);
        if (tries > 6 || !(low < next && next < high)) next = halfway<Bits>(low, high);
        if (next == low || next == high) return high;
        guess = next;
    }
}

// Returns the squared distance on the wall. `across` is stretched by angular_scale; the result is not.
template <class P>
inline P on_wall(P across, P along_square, const Rules& rules) {
    return across * across * P(rules.unscale) + along_square;
}

// Finds the neighbours of vertices, one vertex after the other, among the candidates of a list.
template <class P>
class Nearest {
  public:
    Nearest(const CandidateList& list, const Rules& rules, const Box& box)
        : list_(list),
          rules_(rules),
          box_(box),
          keys_(list.room->keys),
          exact_(list.room->exact),
          passed_(list.room->passed) {}

    // Calls find_one for the vertices whose bits are set; returns its bounds.
    P find(const Group& g, P trial, unsigned vertices, std::int32_t* at) {
        double trials[lanes], rejected[lanes] = {};
        trial.store(trials);
        for (; vertices != 0; vertices &= vertices - 1) {
            const int lane = __builtin_ctz(vertices);
            rejected[lane] = find_one(g, lane, trials[lane], at + lane);
        }
        return P::load(rejected);
    }

  private:
    // Writes the positions of the vertex's neighbours in canonical order to at[0], at[lanes], ... (list_capacity behind
    // them where there are fewer than V), and returns a bound below the squared distances of all other candidates.
    double find_one(const Group& g, int lane, double trial, std::int32_t* at) {
        const double scale = trial * rules_.scale;
        std::int64_t first = 0, last = list_.count;
        if (rules_.windowed) {
            first = static_cast<std::int64_t>(g.window_first[lane]);
            last = static_cast<std::int64_t>(g.window_last[lane]);
        }
        const int n = static_cast<int>(last - first), wanted = rules_.neighbors;
        const float nearest = fill_keys(g, lane, scale, first, n);
        const int least = wanted + 1 + wanted / 16, most = wanted + 6 + wanted / 8;
        const auto passing = [&](float at_most) { return Floats::count_at_most(keys_, n, at_most); };
        if (!(guess_ > 0.0f)) {  // the first guess assumes that the candidates are spread evenly in the box
            const double area = scale * (box_.across < 180.0 ? box_.across : 180.0) * box_.along * 4.0;
            const double square = area * most / (3.0 * static_cast<double>(list_.count + 1));
            guess_ = square < 1e30 ? static_cast<float>(square + 1e-30) : 1.0f;
        }
        float limit = narrow_most;
        if (n > most) {
            limit = threshold<std::int32_t>(nearest + guess_, nearest, narrow_most, n, least, most, passing);
            if (limit > nearest) guess_ = limit - nearest;
        }
        for (;;) {
            double farthest;
            const double rejected = choose(g, lane, scale, first, n, limit, farthest, at);
            // A distance in floats errs by less than `error` metres and by 8 u of itself, for the reasons given at
            // find_narrow; this holds across 180 degrees too.
            constexpr double u = 1.0 / (1 << 24);
            const double error = scale * 12.0 * u * box_.across + 4.0 * u * box_.along;
            const double needed = __builtin_sqrt(farthest) + error;
            const double unseen = __builtin_sqrt(static_cast<double>(limit)) * (1.0 - 8.0 * u) - error;
            if (limit == narrow_most) return rejected;
            if (needed * needed * (1.0 + 1e-6) < unseen * unseen && unseen > 0.0)
                return unseen * unseen < rejected ? unseen * unseen : rejected;
            const double more = needed + 2.0 * error;
            limit = more < 1e15 ? static_cast<float>(more * more * (1.0 + 1e-5)) : narrow_most;
        }
    }

    static constexpr float narrow_most = 3e38f;
    using Floats = typename P::Narrow;

    // Computes the float keys of the n candidates from `first` on, and returns the least key.
    float fill_keys(const Group& g, int lane, double scale, std::int64_t first, int n) {
        double turn[lanes], along[lanes];
        turn_from(P(g.center), P::load(g.toolface)).store(turn);
        (P::load(g.depth) - P(g.middle)).store(along);
        const Floats a(static_cast<float>(turn[lane])), z(static_cast<float>(along[lane]));
        const Floats metres(static_cast<float>(scale < 1e15 ? scale : 1e15)), zero(0.0f), circle(360.0f);
        Floats least(narrow_most);
        for (int i = 0; i < n; i += Floats::width) {
            const Floats one_way = Floats::load(list_.across + first + i) - a;
            const Floats turned = Floats::max(one_way, zero - one_way);
            const Floats x = metres * Floats::min(turned, circle - turned),
                         y = Floats::load(list_.along + first + i) - z;
            (x * x + y * y).store(keys_ + i);
        }
        for (int i = n; i < (n + 15) / 16 * 16; ++i) keys_[i] = __builtin_inff();
        for (int i = 0; i < n; i += Floats::width) least = Floats::min(least, Floats::load(keys_ + i));
        float leasts[16];
        least.store(leasts);
        for (int i = 1; i < Floats::width; ++i) leasts[0] = leasts[i] < leasts[0] ? leasts[i] : leasts[0];
        return leasts[0];
    }

    // Returns a bit for each of the sixteen keys from i on: 1 if the key is at most `at_most`.
    unsigned passed(int i, float at_most) const {
        unsigned bits = 0;
        for (int j = 0; j < 16; j += Floats::width) bits |= Floats::load(keys_ + i + j).at_most(at_most) << j;
        return bits;
    }

    // Chooses, by exact keys, the V nearest of the candidates whose float key is at most `limit`, and writes their
    // positions as find_one does. Sets `farthest` to a squared distance that none of them exceeds. Returns the least
    // key of the candidates that it did not choose.
    double choose(const Group& g, int lane, double scale, std::int64_t first, int n, float limit, double& farthest,
                  std::int32_t* at) {
        int m = 0, within = 0;
        for (int i = 0; i < n; i += 16)
            m += P::store_indices(passed(i, limit), static_cast<std::int32_t>(first) + i, passed_ + m);
        for (int i = m; i < m + lanes; ++i) passed_[i] = list_capacity;
        P rejected(boundless_square), least(boundless_square), greatest(0.0);
        for (int i = 0; i < m; i += lanes) {
            P depth, toolface, radius;
            P::read([&](int j) -> const Candidate& { return list_.rows[passed_[i + j]]; }, depth, toolface, radius);
            const P turn = P::abs(toolface - P(g.toolface[lane]));
            const P across = P(scale) * P::min(turn, P(360.0) - turn), along = depth - P(g.depth[lane]);
            const P key = P::tag(across * across + along * along, P::load(list_.position + i));
            const auto reached = P::less_equal(on_wall(across, along * along, rules_), P(rules_.max_square));
            P::blend(reached, key, P(boundless_square)).store(exact_ + i);
            least = P::min(least, key);
            greatest = P::max(greatest, P::blend(reached, key, P(0.0)));
            rejected = P::min(rejected, P::blend(reached, P(boundless_square), key));
            within += __builtin_popcount(P::bits(reached));
        }
        const int wanted = rules_.neighbors;
        const auto passing = [&](double at_most) { return P::count_at_most(exact_, m, at_most); };
        double cut = missing_square;
        if (within > wanted) {
            const double low = extreme(least, true) * (1.0 - 1e-15), high = extreme(greatest, false);
            cut = threshold<std::int64_t>(low + (high - low) * (wanted + 0.5) / within, low, high, within, wanted,
                                          wanted, passing);
        }
        farthest = within > wanted ? cut : rules_.reach_square;
        for (int i = 0; i < m; i += lanes) {
            const P key = P::load(exact_ + i);
            rejected = P::min(rejected, P::blend(P::less_equal(key, P(cut)), P(boundless_square), key));
        }
        int chosen = 0;
        for (int i = 0; i < m; ++i) {
            at[chosen * lanes] = passed_[i];
            chosen += exact_[i] <= cut;
        }
        for (; chosen < wanted; ++chosen) at[chosen * lanes] = list_capacity;
        return extreme(rejected, true);
    }

    static double extreme(P of_lanes, bool least) {
        double of[lanes];
        of_lanes.store(of);
        for (const double one : of)
            if (least ? one < of[0] : one > of[0]) of[0] = one;
        return of[0];
    }

    const CandidateList& list_;
    const Rules& rules_;
    const Box& box_;
    float guess_ = 0.0f;
    float* const keys_;
    double* const exact_;
    std::int32_t* const passed_;
};

}  // namespace
}  // namespace helibore::kernel
