// Estimates at points from the nearest samples that are not left out. For each point, the search looks at the samples
// above and below it, a few at a time, until no other sample can be nearer than those found.
//
// The method is that of the wall, except that an estimate which alternates between two radii is not replaced by their
// mean.
#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>

#include "base/arithmetic.hpp"
#include "base/host_memory.hpp"
#include "base/messages.hpp"
#include "base/threads.hpp"
#include "helibore/error.hpp"
#include "helibore/estimates.hpp"
#include "samples/helix.hpp"
#include "search/kernel/instruction_set.hpp"
#include "search/search.hpp"

namespace helibore {
namespace {

constexpr std::size_t lanes = kernel::lanes;
// The search looks at this many samples above the point, then at this many below it: the processor cannot predict
// which side is nearer.
constexpr std::size_t at_once = 8;
constexpr Index groups_a_part = 4, groups_a_thread = 16;

struct Neighbour {
    double square;  // of the distance in the metric of angular_scale
    std::size_t sample;
};

void wrap(std::vector<double>& toolface) {
    std::ranges::transform(toolface, toolface.begin(), wrap_toolface);
}

struct CheckedPoints {
    explicit CheckedPoints(const PointColumns& points)
        : depth(copied(points.depth)),
          toolface(copied(points.toolface)),
          columns{depth, toolface, points.trial, points.box_depth, points.box_turn} {
        for (const auto& column : {points.toolface, points.trial, points.box_depth, points.box_turn})
            if (column.size() != depth.size()) throw InputError("points", "columns must have equal lengths");
        require_finite("points.depth", depth);
        require_finite("points.toolface", toolface);
        wrap(toolface);
    }
    std::vector<double> depth, toolface;
    PointColumns columns;
};

// Estimates groups of eight points. The toolfaces of its samples and points must lie in [0, 360).
class PointEstimator {
  public:
    PointEstimator(const SampleColumns& samples, const PointColumns& points, const Settings& settings,
                   std::span<const double> nuggets)
        : samples_(samples),
          points_(points),
          settings_(settings),
          nuggets_(nuggets),
          rules_(rules_of(settings)),
          functions_(kernel::functions_for(settings.instruction_set)) {
        rules_.sums = true;
    }
    void group(std::size_t first, kernel::Room& room, PointEstimates& out) const;
    void find(std::size_t point, double trial, std::vector<Neighbour>& found) const;

  private:
    double turn(std::size_t sample, std::size_t point) const {
        const double away = std::abs(samples_.toolface[sample] - points_.toolface[point]);
        return std::min(away, 360.0 - away);
    }

    const SampleColumns samples_;
    const PointColumns& points_;
    const Settings& settings_;
    std::span<const double> nuggets_;
    kernel::Rules rules_;
    const kernel::Functions& functions_;
};

// Finds the nearest samples, in canonical order. The distances have the same bits as in the kernel, which gives no
// weight to a neighbour beyond max_distance.
void PointEstimator::find(std::size_t point, double trial, std::vector<Neighbour>& found) const {
    const auto wanted = static_cast<std::size_t>(settings_.neighbors);
    const double scale = trial * rules_.scale, depth = points_.depth[point], limit = rules_.max_square;
    const auto nearer = [](const Neighbour& a, const Neighbour& b) {
        return a.square < b.square || (a.square == b.square && a.sample < b.sample);
    };
    found.clear();
    const auto take = [&](std::size_t sample) {
        const double along = std::abs(depth - samples_.depth[sample]), away = turn(sample, point);
        const double across = scale * away;
        const Neighbour next{across * across + along * along, sample};
        if (found.size() == wanted && !nearer(next, found.front())) return;  // true for most samples
        if (along <= points_.box_depth[point] && away <= points_.box_turn[point]) return;
        if (across * across * rules_.unscale + along * along > limit) return;
        if (found.size() == wanted) {
            std::pop_heap(found.begin(), found.end(), nearer);
            found.back() = next;
        } else {
            found.push_back(next);
        }
        std::push_heap(found.begin(), found.end(), nearer);
    };
    const auto near = [&](double along) {
        return along * along <= limit && (found.size() < wanted || along * along <= found.front().square);
    };
    const std::size_t count = samples_.depth.size();
    std::size_t below = static_cast<std::size_t>(std::lower_bound(samples_.depth.begin(), samples_.depth.end(), depth) -
                                                 samples_.depth.begin());
    std::size_t above = below;  // the next samples to look at are above - 1 and below
    for (bool some = true; some;) {
        some = false;
        if (above > 0 && near(depth - samples_.depth[above - 1])) {
            const std::size_t stop = above - std::min(above, at_once);
            while (above > stop) take(--above);
            some = true;
        }
        if (below < count && near(samples_.depth[below] - depth)) {
            const std::size_t stop = below + std::min(count - below, at_once);
            while (below < stop) take(below++);
            some = true;
        }
    }
    std::sort(found.begin(), found.end(), [](const auto& a, const auto& b) { return a.sample < b.sample; });
}

// Estimates points [first, first + lanes).
void PointEstimator::group(std::size_t first, kernel::Room& room, PointEstimates& out) const {
    const auto wanted = static_cast<std::size_t>(settings_.neighbors);
    const std::size_t used = std::min(lanes, points_.depth.size() - first), none = lanes * wanted;
    std::vector<Neighbour> found[lanes];
    std::vector<kernel::Candidate> rows(none + 1, {kernel::none_depth, 0.0, 0.0, 0});
    std::vector<std::int32_t> at(none, static_cast<std::int32_t>(none));
    std::unique_ptr<kernel::KrigingRoom> kriging;
    if (rules_.range > 0.0) kriging = std::make_unique_for_overwrite<kernel::KrigingRoom>();
    const kernel::CandidateList list{rows.data(), nullptr, nullptr, nullptr, nullptr, 0, &room, kriging.get()};
    kernel::Group g{};
    for (std::size_t lane = 0; lane < used; ++lane) {
        g.depth[lane] = points_.depth[first + lane];
        g.toolface[lane] = points_.toolface[first + lane];
        g.trial[lane] = points_.trial[first + lane];
        g.active[lane] = std::isfinite(g.trial[lane]) ? 1.0 : 0.0;
    }
    kernel::Rules simple = rules_;
    simple.range = 0.0;
    simple.sums = false;
    for (int i = 0; i < settings_.max_iterations; ++i) {
        if (i > 0)
            for (std::size_t lane = 0; lane < used; ++lane) {
                if (!(std::abs(g.radius[lane] - g.trial[lane]) > settings_.tolerance)) g.active[lane] = 0.0;
                if (g.active[lane] > 0.0) g.trial[lane] = g.radius[lane];
            }
        for (std::size_t lane = 0; lane < used; ++lane) {
            if (g.active[lane] == 0.0) continue;
            find(first + lane, g.trial[lane], found[lane]);
            if (found[lane].empty()) g.active[lane] = 0.0;
            for (std::size_t n = 0; n < wanted; ++n) {
                at[n * lanes + lane] = static_cast<std::int32_t>(n < found[lane].size() ? lane * wanted + n : none);
                if (n >= found[lane].size()) continue;
                const std::size_t sample = found[lane][n].sample;
                rows[lane * wanted + n] = {samples_.depth[sample], samples_.toolface[sample], samples_.radius[sample],
                                           0};
            }
        }
        functions_.estimate_from(g, list, simple, at.data());
    }
    constexpr double nan = std::numeric_limits<double>::quiet_NaN();
    const auto put = [&](const double* values, std::vector<double>& into) {
        for (std::size_t lane = 0; lane < used; ++lane) into[first + lane] = found[lane].empty() ? nan : values[lane];
    };
    simple.range = rules_.range;
    for (std::size_t k = 0; k < nuggets_.size(); ++k) {
        simple.nugget = nuggets_[k];
        functions_.estimate_from(g, list, simple, at.data());
        put(g.radius, out.by_nugget[k]);
    }
    functions_.estimate_from(g, list, rules_, at.data());
    put(g.radius, out.radius);
    put(g.sums.square_weights, out.square_weights);
    put(g.sums.scatter, out.scatter);
    put(g.sums.along, out.along);
    put(g.sums.across, out.across);
    for (std::size_t lane = 0; lane < used; ++lane) {
        const auto [least, greatest] = std::minmax_element(
            found[lane].begin(), found[lane].end(), [](const auto& a, const auto& b) { return a.square < b.square; });
        out.nearest[first + lane] = found[lane].empty() ? nan : std::sqrt(least->square);
        out.farthest[first + lane] = found[lane].empty() ? nan : std::sqrt(greatest->square);
    }
}

}  // namespace

PointSamples::PointSamples(const SampleColumns& samples, int threads)
    : columns_{copied(samples.depth), copied(samples.toolface), copied(samples.radius)} {
    columns().validate(threads);
    require_order("depth", columns_[0]);
    wrap(columns_[1]);
}

PointEstimates estimate_at(const SampleColumns& samples, const PointColumns& points, const Settings& settings,
                           std::span<const double> nuggets) {
    settings.validate();
    return estimate_at(PointSamples(samples, settings.threads), points, settings, nuggets);
}

PointEstimates estimate_at(const PointSamples& samples, const PointColumns& points, const Settings& settings,
                           std::span<const double> nuggets) {
    settings.validate();
    if (settings.estimator == Estimator::near_and_far)
        throw InputError("estimator", "must be inverse distance or kriging at points", "near and far");
    const StandardArithmetic standard;
    for (std::size_t i = 0; i < nuggets.size(); ++i)
        require(std::isfinite(nuggets[i]) && nuggets[i] >= 1e-6, entry_name("nuggets", static_cast<Index>(i)),
                nuggets[i], "must be finite and at least 1e-6");
    const CheckedPoints at(points);
    const std::size_t n = points.depth.size();
    PointEstimates out;
    for (auto* column :
         {&out.radius, &out.nearest, &out.farthest, &out.square_weights, &out.scatter, &out.along, &out.across})
        column->resize(n);
    out.by_nugget.assign(nuggets.size(), std::vector<double>(n, std::numeric_limits<double>::quiet_NaN()));
    const PointEstimator estimator(samples.columns(), at.columns, settings, nuggets);
    const auto groups = static_cast<Index>((n + lanes - 1) / lanes);
    const int workers = threads_for(groups, groups_a_thread, settings.threads);
    const auto rooms = std::make_unique_for_overwrite<kernel::Room[]>(static_cast<std::size_t>(workers));
    for_each_range(workers, groups, groups_a_part, [&](int worker, const Range& part) {
        for (Index g = part.start; g < part.stop; ++g)
            estimator.group(static_cast<std::size_t>(g) * lanes, rooms[static_cast<std::size_t>(worker)], out);
    });
    return out;
}

std::vector<Index> nearest_to(const PointSamples& samples, const PointColumns& points, const Settings& given,
                              double stretch) {
    given.validate();
    require(std::isfinite(stretch) && stretch > 0.0, "stretch", stretch, "must be finite and above 0");
    Settings settings = given;
    settings.angular_scale = stretch;
    const StandardArithmetic standard;
    const CheckedPoints at(points);
    const PointEstimator estimator(samples.columns(), at.columns, settings, {});
    const auto wanted = static_cast<std::size_t>(settings.neighbors);
    const auto n = static_cast<Index>(points.depth.size());
    std::vector<Index> rows(points.depth.size() * wanted, -1);
    const int workers = threads_for(n, groups_a_thread * static_cast<Index>(lanes), settings.threads);
    for_each_range(workers, n, groups_a_part, [&](int, const Range& part) {
        std::vector<Neighbour> found;
        for (auto i = static_cast<std::size_t>(part.start); i < static_cast<std::size_t>(part.stop); ++i) {
            estimator.find(i, points.trial[i], found);
            std::ranges::transform(found, rows.begin() + static_cast<std::ptrdiff_t>(i * wanted),
                                   [](const Neighbour& of) { return static_cast<Index>(of.sample); });
        }
    });
    return rows;
}

std::vector<double> sigma_of(const std::array<std::span<const double>, 4>& sums, const SigmaRule& rule) {
    const std::size_t n = sums[0].size(), whole = n / lanes * lanes;
    for (const auto& sum : sums)
        if (sum.size() != n) throw InputError("sums", "columns must have equal lengths");
    const StandardArithmetic standard;
    const kernel::Functions& functions = kernel::functions_for(InstructionSet::automatic);
    std::vector<double> out(n);
    const double* from[] = {sums[0].data(), sums[1].data(), sums[2].data(), sums[3].data()};
    functions.sigma(from, static_cast<std::int64_t>(whole), rule, out.data());
    double rest[5][lanes] = {};  // the last sums, fewer than `lanes`, and their results
    for (std::size_t s = 0; s < sums.size(); ++s) std::copy_n(sums[s].data() + whole, n - whole, rest[s]);
    const double* last[] = {rest[0], rest[1], rest[2], rest[3]};
    functions.sigma(last, lanes, rule, rest[4]);
    std::copy_n(rest[4], n - whole, out.data() + whole);
    return out;
}

}  // namespace helibore
