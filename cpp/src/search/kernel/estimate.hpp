// Computes the radius of a vertex from its neighbours. It iterates until the radius converges, or until a sample that
// is not in the list could be a neighbour: then the caller must make a new list (Verdict::widen, Verdict::refetch).
//
// The sums run over the neighbours in canonical order, which is their position in the list. So the bits of a sum do not
// depend on how the neighbours were found.
#pragma once

#include "search/kernel/kriging.hpp"
#include "search/kernel/neighbor_weight.hpp"
#include "search/kernel/select.hpp"

namespace helibore::kernel {
namespace {

constexpr unsigned every_lane = (1u << lanes) - 1;

// Bounds must hold although squares, ratios and truncated keys are rounded; their rounding errors are below this slack.
constexpr double slack = 1.0 + 1e-9;

// The neighbours of one pack of vertices, in canonical order, as the estimate needs them.
template <class P>
struct Neighbours {
    P turn[max_neighbors];   // |toolface difference|, degrees
    P along[max_neighbors];  // depth difference squared
    P radius[max_neighbors];
    P square[max_neighbors], weight[max_neighbors];
};

template <class P>
inline Neighbours<P>& neighbours_of(const CandidateList& list) {
    static_assert(sizeof(Neighbours<P>) == sizeof(Room::neighbours) && alignof(Neighbours<P>) <= alignof(Room));
    return *static_cast<Neighbours<P>*>(static_cast<void*>(list.room->neighbours));
}

// Reads from the list the selected candidates, whose positions are at[0], at[lanes], ... for each vertex.
template <class P>
inline void read_neighbours(const Group& g, const CandidateList& list, int neighbors, const std::int32_t* at,
                            Neighbours<P>& found) {
    const P depth = P::load(g.depth), toolface = P::load(g.toolface);
    const Candidate* rows = list.rows;
    for (int i = 0; i < neighbors; ++i) {
        P at_depth, at_toolface;
        P::read([&](int lane) -> const Candidate& { return rows[at[i * lanes + lane]]; }, at_depth, at_toolface,
                found.radius[i]);
        const P turn = P::abs(at_toolface - toolface), along = at_depth - depth;
        found.turn[i] = P::min(turn, P(360.0) - turn);
        found.along[i] = along * along;
    }
}

// Finds the neighbours of each vertex with floats, at most `kept` (8 or 16) of them. Returns a lower bound of the
// squared distances of all other candidates, which allows for the rounding of floats. With u = 2^-24, each coordinate
// errs by u times the list's extent. The difference of two coordinates errs by as much again, and by 2 u more when it
// is scaled. A float square k, cut to 15 bits of fraction, stands for a square of at least
// (e: the error of a distance)
//
//     (sqrt(k (1 - 2^-14)) - e)^2  >=  k (1 - 2^-13) - 2^14 e^2      as  2 e sqrt(k) <= 2^-14 k + 2^14 e^2
template <class P, int kept, bool windowed, bool wraps>
inline P find_narrow(const Group& g, P scale, const CandidateList& list, const Box& box, int neighbors,
                     std::int32_t* at) {
    using Narrow = typename P::Narrow;
    using Single = typename Narrow::Single;
    Narrow found_best[std::size_t{kept}];
    const Narrow found_rejected = select<kept>(NarrowEye<P, windowed, wraps>(g, scale, list), found_best);
    Single best[std::size_t{kept}], rejected = found_rejected.candidate(0);
    for (int j = 0; j < kept; ++j) best[j] = found_best[j].candidate(0);
    if constexpr (Narrow::candidates == 2) {
        Single second[std::size_t{kept}];
        for (int j = 0; j < kept; ++j) second[j] = found_best[j].candidate(1);
        rejected = Single::min(Single::min(rejected, found_rejected.candidate(1)), merge<kept, kept>(best, second));
        if (neighbors < kept) sort_bitonic<kept>(best);
    }
    constexpr int last = (1 << narrow_position_bits) - 1;
    const Single none = Single::tag(Single(narrow_none_square), Single(list.narrow_position[last]));
    rejected = keep_first<kept>(best, neighbors, rejected, none);
    const P least(rejected);
    for (Single& key : best) key = Single::position_key(key);
    sort<kept>(best);
    for (int i = 0; i < neighbors; ++i) best[i].store_positions(at + i * lanes);
    constexpr double u = 1.0 / (1 << 24);
    const P error = scale * P((wraps ? 24.0 : 8.0) * u * box.across) + P(4.0 * u * box.along);
    return least * P(1.0 - 1.0 / (1 << 13)) - error * error * P(1 << 14);
}

template <class P, int kept>
auto narrow_search(bool windowed, bool wraps) {
    return windowed ? (wraps ? &find_narrow<P, kept, true, true> : &find_narrow<P, kept, true, false>)
                    : (wraps ? &find_narrow<P, kept, false, true> : &find_narrow<P, kept, false, false>);
}

template <class P>
struct Estimate {
    P radius, support, least, farthest;  // least, farthest: smallest and largest squared distance of the neighbours
};

// Returns sum(w r) / sum(w) over the neighbours at most max_distance away, or the mean radius at distance 0, if any
// are. A neighbour farther away adds 0, which does not change the bits of the sums. So it does not matter which samples
// beyond the limit were selected, although the search does not make sure that these samples are the nearest. The result
// is clamped to the least and greatest radius used, because rounding could exceed them by an ulp.
//
// `fixed` is the number of neighbours if it is known at compile time, else 0; with 0 the weights are left in `n`.
template <class P, int fixed>
inline Estimate<P> inverse_distance(Neighbours<P>& n, P scale, const Rules& rules) {
    const int neighbors = fixed > 0 ? fixed : rules.neighbors;
    constexpr auto few = static_cast<std::uint64_t>(fixed > 0 ? fixed : 1);
    P square_of_few[few], weight_of_few[few];
    P* const squares = fixed > 0 ? square_of_few : n.square;
    P* const weight = fixed > 0 ? weight_of_few : n.weight;
    P least(missing_square), farthest(0.0);
    for (int i = 0; i < neighbors; ++i) {
        const P across = scale * n.turn[i];
        squares[i] = across * across + n.along[i];
        least = P::min(least, squares[i]);
        farthest = P::max(farthest, squares[i]);
    }
    const auto hits = P::less_equal(least, P(zero_square));
    const bool any_hits = P::bits(hits) != 0;
    const bool all_used = !any_hits && P::bits(P::less_equal(farthest, P(rules.sure_square))) == every_lane;
    const auto used = [&](int i) {
        return P::less_equal(on_wall(scale * n.turn[i], n.along[i], rules), P(rules.max_square));
    };
    if (!all_used)  // a neighbour that is not used gets the square 1, which changes no product
        for (int i = 0; i < neighbors; ++i) squares[i] = P::blend(used(i), squares[i], P(1.0));
    weigh<P, fixed>(squares, least, neighbors, rules.power, weight);
    P weights(0.0), weighted(0.0), support(0.0), low(missing_square), high(-missing_square);
    if (all_used) {  // the usual case
        for (int i = neighbors - 1; i >= 0; --i) {
            weights = weights + weight[i];
            weighted = weighted + weight[i] * n.radius[i];
            low = P::min(low, n.radius[i]);
            high = P::max(high, n.radius[i]);
        }
        support = P(static_cast<double>(neighbors));
        return {P::max(P::min(weighted / weights, high), low), support, least, farthest};
    }
    for (int i = neighbors - 1; i >= 0; --i) {
        if (any_hits)
            weight[i] = P::blend(hits, P::blend(P::less_equal(squares[i], P(zero_square)), P(1.0), P(0.0)), weight[i]);
        weight[i] = P::blend(used(i), weight[i], P(0.0));
        weights = weights + weight[i];
        weighted = weighted + weight[i] * n.radius[i];
        support = support + P::blend(used(i), P(1.0), P(0.0));
        low = P::blend(used(i), P::min(low, n.radius[i]), low);
        high = P::blend(used(i), P::max(high, n.radius[i]), high);
    }
    return {P::max(P::min(weighted / weights, high), low), support, least, farthest};
}

// Does the last step for the vertices in `done`, once their neighbours are known and read. With kriging, it replaces
// the radius from the iteration. If rules.sums is set, it computes the sums for sigma. For a vertex without a sample in
// reach, the results have no meaning.
template <class P, class Mask>
__attribute__((noinline)) void complete(Group& g, const CandidateList& list, const Rules& rules, const std::int32_t* at,
                                        P trial, Mask done) {
    const auto put = [&](P value, double* into) { P::blend(done, value, P::load(into)).store(into); };
    P radius = P::load(g.radius), squares(0.0);
    if (rules.range > 0.0) {
        const Kriged<P> kriged = krige(g, list, rules, at, trial, rules.sums);
        radius = kriged.radius;
        squares = kriged.squares;
        put(radius, g.radius);
    }
    if (!rules.sums) return;
    Neighbours<P>& n = neighbours_of<P>(list);
    const P scale = trial * P(rules.scale);
    if (rules.range == 0.0) {
        P weights(0.0);
        inverse_distance<P, 0>(n, scale, rules);
        for (int i = 0; i < rules.neighbors; ++i) {
            weights = weights + n.weight[i];
            squares = squares + n.weight[i] * n.weight[i];
        }
        squares = squares / (weights * weights);
    }
    P count(0.0), scatter(0.0), along(0.0), across(0.0);
    for (int i = 0; i < rules.neighbors; ++i) {
        const auto used = P::less_equal(on_wall(scale * n.turn[i], n.along[i], rules), P(rules.max_square));
        const auto add = [&](P& sum, P value) { sum = P::blend(used, sum + value, sum); };
        const P off = n.radius[i] - radius;
        add(count, P(1.0));
        add(scatter, off * off);
        add(along, n.along[i]);
        add(across, n.turn[i] * n.turn[i]);
    }
    const P degree = trial * P(metres_a_degree), part = P(1.0) / count;
    put(squares, g.sums.square_weights);
    put(scatter * part, g.sums.scatter);
    put(along * part, g.sums.along);
    put(across * part * (degree * degree), g.sums.across);
}

template <class P>
void estimate_from(Group& g, const CandidateList& list, const Rules& rules, const std::int32_t* at) {
    const P trial = P::load(g.trial);
    Neighbours<P>& neighbours = neighbours_of<P>(list);
    read_neighbours(g, list, rules.neighbors, at, neighbours);
    inverse_distance<P, 0>(neighbours, trial * P(rules.scale), rules).radius.store(g.radius);
    if (rules.range > 0.0 || rules.sums) complete(g, list, rules, at, trial, P::less_equal(trial, trial));
}

template <class P>
void sigma(const double* const sums[sum_count], std::int64_t n, const SigmaRule& rule, double* sigma) {
    const auto log2 = [](P x) {
        P whole, rest;
        log2_parts(P::max(x, P(rounding_square)), whole, rest);  // if x is NaN, max() returns rounding_square
        return whole + rest;
    };
    for (std::int64_t i = 0; i < n; i += lanes) {
        const P along = P::load(sums[2] + i), across = P::load(sums[3] + i);
        const P power = P(rule.scatter_power) * log2(P::load(sums[1] + i)) +
                        P(rule.distance_power) * log2(along + P(rule.stretch) * across);
        const P squares = P(rule.noise) * P::load(sums[0] + i) + P(rule.between) * exp2_of(power);
        const auto near = P::less_equal(along + across, P(rule.reach * rule.reach));
        P::blend(near, P::sqrt(squares), P(__builtin_nan(""))).store(sigma + i);
    }
}

template <class P>
Verdict estimate(Group& g, const CandidateList& list, const Rules& rules, const Box& box) {
    auto active = P::less(P(0.0), P::load(g.active));
    const P scale(rules.scale), trial = P::load(g.trial), discarded = P::load(g.discarded);
    P current = trial, before = P::load(g.before), iterations = P::load(g.iterations);
    P selected_at = trial, rejected(boundless_square);
    P reach = P::load(g.reach_square), least_trial = P::load(g.least_trial);
    P height_square = P::load(g.height_square);
    const P least_turn = P::load(g.least_turn);
    Neighbours<P>& neighbours = neighbours_of<P>(list);
    std::int32_t at[(max_neighbors + 1) * lanes];
    for (int i = 0; i < rules.neighbors * lanes; ++i) at[i] = list_capacity;
    Nearest<P> nearest(list, rules, box);
    bool narrow = box.narrow;
    fill_narrow_columns<P>(list, g);

    const auto any = [](auto mask) { return P::bits(mask) != 0; };
    // Returns a lower bound, at the current radius, of a squared distance that was found at another radius.
    const auto at_least = [&](P square, P found_at) {
        const P ratio = current / found_at;
        return square * P::min(P(1.0), ratio * ratio);
    };
    const auto moved_since = [&](P then) { return P::both(active, P::less(P(0.0), P::abs(current - then))); };
    const auto stop = [&](Verdict verdict) {
        current.store(g.trial);
        before.store(g.before);
        iterations.store(g.iterations);
        reach.store(g.reach_square);
        least_trial.store(g.least_trial);
        height_square.store(g.height_square);
        if (list.found) {  // of the vertices that are done now
            const unsigned done = P::bits(P::less(P::blend(active, P(1.0), P(0.0)), P::load(g.active)));
            for (int lane = 0; lane < lanes; ++lane)
                if (done >> lane & 1)
                    for (int i = lane; i < rules.neighbors * lanes; i += lanes) list.found[i] = list.rows[at[i]];
        }
        if (rules.range > 0.0 || rules.sums) {  // completes the vertices that are done now and have neighbours
            const auto done = P::less(P(0.0), P::blend(active, P(0.0), P::min(P::load(g.active), P::load(g.support))));
            if (any(done)) complete(g, list, rules, at, current, done);
        }
        P::blend(active, P(1.0), P(0.0)).store(g.active);
        return verdict;
    };

    auto wanted = active;  // vertices whose neighbours are to be found
    for (;;) {
        if (any(wanted)) {
            if (narrow) {
                const auto find = rules.neighbors <= 8 ? narrow_search<P, 8>(rules.windowed, box.wraps)
                                                       : narrow_search<P, 16>(rules.windowed, box.wraps);
                rejected = find(g, current * scale, list, box, rules.neighbors, at);
                selected_at = current;
            } else {
                rejected = P::blend(wanted, nearest.find(g, current, P::bits(wanted), at), rejected);
                selected_at = P::blend(wanted, current, selected_at);
            }
            read_neighbours(g, list, rules.neighbors, at, neighbours);
        }
        Estimate<P> next = rules.neighbors == 8 ? inverse_distance<P, 8>(neighbours, current * scale, rules)
                                                : inverse_distance<P, 0>(neighbours, current * scale, rules);
        P others = at_least(rejected, selected_at);
        if (rules.unscale != 1.0) {  // a sample beyond max_distance may be nearer in this metric than one within it
            const auto few = P::less(next.support, P(static_cast<double>(rules.neighbors)));
            others = P::blend(few, P(0.0), others);
            next.farthest = P::blend(few, P(rules.reach_square), next.farthest);
        }
        const P needed = P::min(next.farthest, P(rules.reach_square)) * P(slack);
        const auto doubtful = P::both(active, P::less_equal(others, needed));
        wanted = P::both(doubtful, moved_since(selected_at));
        if (narrow && any(doubtful) && !any(wanted)) {
            narrow = false;
            wanted = doubtful;
        }
        if (any(wanted)) continue;
        if (any(P::both(moved_since(trial), P::less_equal(at_least(discarded, trial), needed))))
            return stop(Verdict::refetch);
        const P width = current * scale * P(box.width), height(box.height), far(box.far);
        const P deep = P::min(next.farthest, P(rules.max_square)) * P(slack);
        const P across = current * scale * least_turn, highest = needed - across * across;
        if (any(P::both(active, P::less_equal(width * width, needed))) ||
            any(P::both(active, P::less_equal(far * far, deep))) ||
            any(P::both(active,
                        P::both(P::less_equal(height * height, highest), P::less_equal(height * height, deep)))))
            return stop(Verdict::widen);
        height_square = P::blend(active, P::max(height_square, highest), height_square);

        iterations = P::blend(active, iterations + P(1.0), iterations);
        reach = P::blend(active, P::max(reach, P::min(next.farthest, P(rules.reach_square))), reach);
        least_trial = P::blend(active, P::min(least_trial, current), least_trial);
        const auto found = P::less(P(0.0), next.support);
        const P estimate = P::blend(found, next.radius, P(__builtin_nan("")));
        const P tolerance(rules.tolerance);
        // If an estimate equals the last but one, but not the last, the estimates would alternate for ever. Then the
        // radius is the mean of this and the last estimate.
        const auto moves = P::less(tolerance, P::abs(estimate - current));
        const auto apart = P::less(tolerance, P::abs(estimate - before));
        const P mean = P::blend(apart, estimate, P(0.5) * (estimate + current));
        const P radius = P::blend(moves, mean, estimate);
        P::blend(active, radius, P::load(g.radius)).store(g.radius);
        P::blend(active, P::blend(found, P::sqrt(next.least), P(__builtin_nan(""))), P::load(g.nearest))
            .store(g.nearest);
        P::blend(active, next.support, P::load(g.support)).store(g.support);
        before = P::blend(active, P::blend(moves, P::blend(apart, current, before), current), before);
        active = P::both(P::both(active, P::both(found, P::both(moves, apart))),
                         P::less(iterations, P(static_cast<double>(rules.max_iterations))));
        current = P::blend(active, radius, current);
        if (!any(active)) return stop(Verdict::done);
    }
}

template <class P>
void nominate(Group& g, const CandidateList& list, const Rules& rules, const Box& box, unsigned char* keep) {
    std::int32_t at[(max_neighbors + 1) * lanes];
    fill_narrow_columns<P>(list, g);
    const P rejected = Nearest<P>(list, rules, box).find(g, P::load(g.trial), every_lane, at);
    P::min(P::load(g.discarded), rejected).store(g.discarded);
    for (int i = 0; i < rules.neighbors * lanes; ++i) keep[at[i]] = 1;
}

}  // namespace
}  // namespace helibore::kernel
