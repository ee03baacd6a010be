// Estimates at points from the nearest samples that are not left out, by the method of the wall. Each point looks at
// the samples above and below it, the nearest in depth first, until none can be nearer than those it has.
#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "base/arithmetic.hpp"
#include "base/degrees.hpp"
#include "base/messages.hpp"
#include "base/threads.hpp"
#include "helibore/error.hpp"
#include "helibore/estimates.hpp"
#include "search/kernel/instruction_set.hpp"

namespace helibore {
namespace {

constexpr std::size_t lanes = kernel::lanes;
constexpr Index groups_a_part = 4, groups_a_thread = 16;

struct Neighbour {
    double square;  // of the distance in the metric of angular_scale
    std::size_t sample;
};

class PointEstimator {
  public:
    PointEstimator(const SampleColumns& samples, const PointColumns& points, const Settings& settings,
                   std::span<const double> nuggets)
        : samples_(samples), points_(points), settings_(settings), nuggets_(nuggets) {}
    void group(std::size_t first, PointEstimates& out) const;

  private:
    double turn(std::size_t sample, std::size_t point) const {
        const double away = std::abs(samples_.toolface[sample] - points_.toolface[point]);
        return std::min(away, 360.0 - away);
    }
    bool left_out(std::size_t sample, std::size_t point) const {
        return std::abs(samples_.depth[sample] - points_.depth[point]) <= points_.box_depth[point] &&
               turn(sample, point) <= points_.box_turn[point];
    }
    void find(std::size_t point, double trial, std::vector<Neighbour>& found) const;
    double weigh(const std::vector<Neighbour>& found, std::vector<double>& weight) const;

    const SampleColumns& samples_;
    const PointColumns& points_;
    const Settings& settings_;
    std::span<const double> nuggets_;
};

// The nearest samples, in canonical order.
void PointEstimator::find(std::size_t point, double trial, std::vector<Neighbour>& found) const {
    const auto wanted = static_cast<std::size_t>(settings_.neighbors);
    const double degree = trial * std::numbers::pi / 180.0, scale = degree * settings_.angular_scale;
    const double depth = points_.depth[point], limit = settings_.max_distance * settings_.max_distance;
    const auto nearer = [](const Neighbour& a, const Neighbour& b) {
        return a.square < b.square || (a.square == b.square && a.sample < b.sample);
    };
    found.clear();
    std::size_t below = static_cast<std::size_t>(std::lower_bound(samples_.depth.begin(), samples_.depth.end(), depth) -
                                                 samples_.depth.begin());
    std::size_t above = below;  // the next to look at: above - 1, and below
    for (;;) {
        const double up = above > 0 ? depth - samples_.depth[above - 1] : no_limit;
        const double down = below < samples_.depth.size() ? samples_.depth[below] - depth : no_limit;
        const double along = std::min(up, down);
        if (along == no_limit || along * along > limit) break;
        if (found.size() == wanted && along * along > found.front().square) break;
        const std::size_t sample = up < down ? --above : below++;
        if (left_out(sample, point)) continue;
        const double away = turn(sample, point), across = scale * away;
        if (degree * away * degree * away + along * along > limit) continue;
        const Neighbour next{across * across + along * along, sample};
        if (found.size() == wanted) {
            if (!nearer(next, found.front())) continue;
            std::pop_heap(found.begin(), found.end(), nearer);
            found.back() = next;
        } else {
            found.push_back(next);
        }
        std::push_heap(found.begin(), found.end(), nearer);
    }
    std::sort(found.begin(), found.end(), [](const auto& a, const auto& b) { return a.sample < b.sample; });
}

// Weights by inverse distance, which sum to 1, and the radius they give.
double PointEstimator::weigh(const std::vector<Neighbour>& found, std::vector<double>& weight) const {
    double least = no_limit, weights = 0.0, radius = 0.0;
    for (const Neighbour& n : found) least = std::min(least, n.square);
    weight.clear();
    for (const Neighbour& n : found) {
        const bool hit = least <= kernel::zero_square;
        weight.push_back(hit ? static_cast<double>(n.square <= kernel::zero_square)
                             : std::pow(std::sqrt(least / n.square), settings_.power));
        weights += weight.back();
    }
    for (std::size_t i = 0; i < found.size(); ++i) {
        weight[i] /= weights;
        radius += weight[i] * samples_.radius[found[i].sample];
    }
    return radius;
}

// Points [first, first + lanes).
void PointEstimator::group(std::size_t first, PointEstimates& out) const {
    const auto wanted = static_cast<std::size_t>(settings_.neighbors);
    const std::size_t used = std::min(lanes, points_.depth.size() - first);
    constexpr double nan = std::numeric_limits<double>::quiet_NaN();
    std::vector<Neighbour> found[lanes];
    std::vector<double> weight[lanes];
    kernel::Group g{};
    for (std::size_t lane = 0; lane < used; ++lane) {
        const std::size_t point = first + lane;
        double trial = points_.trial[point], radius = nan;
        for (int i = 0; i < settings_.max_iterations && std::isfinite(trial); ++i) {
            find(point, trial, found[lane]);
            g.trial[lane] = trial;
            if (found[lane].empty()) break;
            radius = weigh(found[lane], weight[lane]);
            if (std::abs(radius - trial) <= settings_.tolerance) break;
            trial = radius;
        }
        out.radius[point] = found[lane].empty() ? nan : radius;
        out.square_weights[point] = found[lane].empty() ? nan : 0.0;
        for (const double w : weight[lane]) out.square_weights[point] += w * w;
    }
    if (settings_.estimator == Estimator::kriging) {
        std::vector<kernel::Candidate> rows(lanes * wanted + 1, {kernel::none_depth, 0.0, 0.0, 0});
        std::vector<std::int32_t> at(lanes * wanted, static_cast<std::int32_t>(lanes * wanted));
        for (std::size_t lane = 0; lane < used; ++lane) {
            g.depth[lane] = points_.depth[first + lane];
            g.toolface[lane] = points_.toolface[first + lane];
            for (std::size_t i = 0; i < found[lane].size(); ++i) {
                const std::size_t sample = found[lane][i].sample, row = lane * wanted + i;
                rows[row] = {samples_.depth[sample], samples_.toolface[sample], samples_.radius[sample], 0};
                at[i * lanes + lane] = static_cast<std::int32_t>(row);
            }
        }
        kernel::Rules rules{};
        const double stretch = settings_.angular_scale * settings_.angular_scale;
        rules.neighbors = settings_.neighbors;
        rules.range = settings_.kriging_range;
        rules.nugget = settings_.nugget;
        rules.max_square = std::min(settings_.max_distance * settings_.max_distance, kernel::missing_square / 2);
        rules.scale = settings_.angular_scale * std::numbers::pi / 180.0;
        rules.unscale = 1.0 / stretch;
        const kernel::CandidateList list{rows.data(), nullptr, nullptr, nullptr, nullptr, 0};
        double radius[lanes], squares[lanes];
        kernel::functions_for(settings_.instruction_set).krige(g, list, rules, at.data(), radius, squares);
        for (std::size_t k = 0; k < nuggets_.size(); ++k) {
            kernel::Rules other = rules;
            other.nugget = nuggets_[k];
            double radii[lanes], ignored[lanes];
            kernel::functions_for(settings_.instruction_set).krige(g, list, other, at.data(), radii, ignored);
            for (std::size_t lane = 0; lane < used; ++lane)
                out.by_nugget[k][first + lane] = found[lane].empty() ? nan : radii[lane];
        }
        for (std::size_t lane = 0; lane < used; ++lane) {
            if (found[lane].empty()) continue;
            out.radius[first + lane] = radius[lane];
            out.square_weights[first + lane] = squares[lane];
        }
    }
    for (std::size_t lane = 0; lane < used; ++lane) {
        const std::size_t point = first + lane;
        const double degree = g.trial[lane] * std::numbers::pi / 180.0;
        double farthest = found[lane].empty() ? nan : 0.0;
        double nearest = found[lane].empty() ? nan : no_limit, scatter = found[lane].empty() ? nan : 0.0;
        std::array<double, 3> spread{};
        for (std::size_t i = 0; i < found[lane].size(); ++i) {
            const std::size_t sample = found[lane][i].sample;
            const double across = degree * turn(sample, point), along = samples_.depth[sample] - points_.depth[point];
            const double off = samples_.radius[sample] - out.radius[point];
            farthest = std::max(farthest, found[lane][i].square);
            nearest = std::min(nearest, std::sqrt(across * across + along * along));
            scatter += weight[lane][i] * off * off;
            for (std::size_t s = 0; s < spread.size(); ++s) {
                const double scaled = spread_scales[s] * across;
                spread[s] += weight[lane][i] * std::sqrt(scaled * scaled + along * along);
            }
        }
        out.nearest[point] = nearest;
        out.farthest[point] = std::sqrt(farthest);
        out.scatter[point] = scatter;
        for (std::size_t s = 0; s < spread.size(); ++s) out.spread[s][point] = found[lane].empty() ? nan : spread[s];
    }
}

}  // namespace

PointEstimates estimate_at(const SampleColumns& samples, const PointColumns& points, const Settings& settings,
                           std::span<const double> nuggets) {
    settings.validate();
    const StandardArithmetic standard;
    const std::size_t n = points.depth.size();
    const std::size_t lengths[] = {points.toolface.size(), points.trial.size(), points.box_depth.size(),
                                   points.box_turn.size()};
    for (const std::size_t length : lengths)
        if (length != n) throw InputError("points", "columns must have equal lengths");
    PointEstimates out;
    for (auto* column : {&out.radius, &out.nearest, &out.farthest, &out.square_weights, &out.scatter, &out.spread[0],
                         &out.spread[1], &out.spread[2]})
        column->resize(n);
    out.by_nugget.assign(nuggets.size(), std::vector<double>(n, std::numeric_limits<double>::quiet_NaN()));
    const PointEstimator estimator(samples, points, settings, nuggets);
    const auto groups = static_cast<Index>((n + lanes - 1) / lanes);
    for_each_range(threads_for(groups, groups_a_thread, settings.threads), groups, groups_a_part,
                   [&](int, const Range& part) {
                       for (Index g = part.start; g < part.stop; ++g)
                           estimator.group(static_cast<std::size_t>(g) * lanes, out);
                   });
    return out;
}

}  // namespace helibore
