// Interpolates values measured with the samples: the weighted mean over the neighbours that give the radius.
//
//     value(vertex) = sum(w v) / sum(w)   over the neighbours that have a value, w = distance^-power at the last trial
//                                         radius
//
// If the radius of a vertex is the mean of two estimates, its value is the mean of the two values that the weights of
// these estimates give. If only one of these two values exists, the vertex has that value.
//
// If the radius is kriged, the values are kriged too: each channel from the neighbours of a vertex that have a value.
//
// This is not part of the kernel, because it runs on demand, once for all channels, and not in every append.
#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>

#include "search/kernel/plain_weight.hpp"
#include "search/near_far.hpp"
#include "search/search.hpp"

namespace helibore {
namespace {

constexpr Index lanes = kernel::lanes;
constexpr std::uint64_t low_bits = (std::uint64_t{1} << kernel::position_bits) - 1;  // of a key: the position

}  // namespace

void Search::interpolate(const Samples& samples, const Helix& helix, Index group, Index vertex_count, Scratch& scratch,
                         std::span<const std::span<const double>> channels, std::span<double* const> out) const {
    if (near_far_) return near_far_->interpolate(samples, helix, group, vertex_count, scratch, channels, out);
    const kernel::Group solved = solve(samples, helix, group, vertex_count, scratch);
    const bool listed = scratch.first_list;
    const kernel::Group g = listed ? solved : list_at(samples, helix, group, vertex_count, solved.trial, scratch);
    const Index used = std::min(lanes, vertex_count - group * lanes);
    std::vector<Neighbour> neighbours;
    if (rules_.range > 0.0) {
        for (std::size_t c = 0; c < channels.size(); ++c) krige(g, used, channels[c], scratch.list, neighbours, out[c]);
        return;
    }
    const auto value_of = [&](std::span<const double> channel) {
        double weights = 0.0, weighted = 0.0;
        for (const Neighbour& n : neighbours) {
            const double value = channel[static_cast<std::size_t>(n.rank)];
            if (std::isnan(value)) continue;
            weights += n.weight;
            weighted += n.weight * value;
        }
        return weights > 0.0 ? weighted / weights : std::numeric_limits<double>::quiet_NaN();
    };
    bool means = false;  // whether any radius of the group is the mean of two estimates
    for (Index lane = 0; lane < used; ++lane) {
        weigh(g, lane, g.trial[lane], scratch.list, neighbours);
        for (std::size_t c = 0; c < channels.size(); ++c) out[c][lane] = value_of(channels[c]);
        means = means || solved.before[lane] != solved.trial[lane];
    }
    if (!means) return;
    const kernel::Group b = listed ? solved : list_at(samples, helix, group, vertex_count, solved.before, scratch);
    for (Index lane = 0; lane < used; ++lane) {
        if (solved.before[lane] == solved.trial[lane]) continue;
        weigh(b, lane, solved.before[lane], scratch.list, neighbours);
        for (std::size_t c = 0; c < channels.size(); ++c) {
            const double value = value_of(channels[c]);
            if (std::isnan(out[c][lane])) out[c][lane] = value;
            if (!std::isnan(value)) out[c][lane] = 0.5 * (out[c][lane] + value);
        }
    }
}

// Kriges the values of a channel in place of the radii.
void Search::krige(kernel::Group g, Index used, std::span<const double> channel, const kernel::CandidateList& list,
                   std::vector<Neighbour>& neighbours, double* out) const {
    const Index none = lanes * rules_.neighbors;
    std::vector<kernel::Candidate> rows(static_cast<std::size_t>(none + 1), {kernel::none_depth, 0.0, 0.0, 0});
    std::vector<std::int32_t> at(static_cast<std::size_t>(none), static_cast<std::int32_t>(none));
    bool known[lanes] = {};
    for (Index lane = 0; lane < used; ++lane) {
        choose(g, lane, g.trial[lane], list, neighbours);
        Index next = lane;
        for (const Neighbour& n : neighbours) {
            const double value = channel[static_cast<std::size_t>(n.rank)];
            if (std::isnan(value)) continue;
            kernel::Candidate& row = rows[static_cast<std::size_t>(next)] = list.rows[n.key & low_bits];
            row.radius = value;
            at[static_cast<std::size_t>(next)] = static_cast<std::int32_t>(next);
            known[lane] = true;
            next += lanes;
        }
    }
    kernel::Rules rules = rules_;
    rules.sums = false;
    functions_->estimate_from(g, {rows.data(), nullptr, nullptr, nullptr, nullptr, 0, list.room, list.kriging}, rules,
                              at.data());
    for (Index lane = 0; lane < used; ++lane)
        out[lane] = known[lane] ? g.radius[lane] : std::numeric_limits<double>::quiet_NaN();
}

// Lists the neighbours of one vertex in canonical order.
void Search::choose(const kernel::Group& g, Index lane, double trial, const kernel::CandidateList& list,
                    std::vector<Neighbour>& neighbours) const {
    neighbours.clear();
    const double scale = trial * rules_.scale;
    for (Index i = 0; i < list.count; ++i) {
        const kernel::Candidate& c = list.rows[i];
        const auto position = static_cast<double>(i);
        if (rules_.windowed && !(g.window_first[lane] <= position && position < g.window_last[lane])) continue;
        const double turn = std::abs(c.toolface - g.toolface[lane]);
        const double across = scale * std::min(turn, 360.0 - turn), along = c.depth - g.depth[lane];
        if (across * across * rules_.unscale + along * along > rules_.max_square) continue;
        const double square = across * across + along * along;
        const std::uint64_t key = std::bit_cast<std::uint64_t>(square) & ~low_bits;
        neighbours.push_back({key | static_cast<std::uint64_t>(i), square, 0.0, c.rank});
    }
    const auto nearer = [](const Neighbour& a, const Neighbour& b) { return a.key < b.key; };
    const auto wanted = static_cast<std::size_t>(rules_.neighbors);
    if (neighbours.size() > wanted) {
        std::nth_element(neighbours.begin(), neighbours.begin() + rules_.neighbors, neighbours.end(), nearer);
        neighbours.resize(wanted);
    }
    std::sort(neighbours.begin(), neighbours.end(),
              [](const Neighbour& a, const Neighbour& b) { return a.rank < b.rank; });
}

// Lists the neighbours of one vertex that have a weight. Weights are relative to that of the nearest neighbour.
void Search::weigh(const kernel::Group& g, Index lane, double trial, const kernel::CandidateList& list,
                   std::vector<Neighbour>& neighbours) const {
    choose(g, lane, trial, list, neighbours);
    if (neighbours.empty()) return;
    const double least = std::min_element(neighbours.begin(), neighbours.end(), [](const auto& a, const auto& b) {
                             return a.square < b.square;
                         })->square;
    const bool hit = least <= kernel::zero_square;
    for (Neighbour& n : neighbours) {
        if (hit)
            n.weight = n.square <= kernel::zero_square ? 1.0 : 0.0;
        else
            n.weight = kernel::relative_weight(least, n.square, rules_.power);
    }
    std::erase_if(neighbours, [](const Neighbour& n) { return n.weight == 0.0; });
}

}  // namespace helibore
