// The near neighbours are found by the exact search, in two metrics; the far ones from the thinned rows of each chunk.
#include "search/near_far.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

namespace helibore {
namespace {

constexpr Index lanes = kernel::lanes;
constexpr double nan = std::numeric_limits<double>::quiet_NaN();
constexpr double share = 0.35;  // of the lengths of the long term: the size of a cell

// Settings under which the search finds the nearest samples by one term of the covariance.
Settings metric_of(const Settings& settings, std::size_t term) {
    Settings metric = settings;
    metric.estimator = Estimator::inverse_distance;
    metric.covariance.clear();
    metric.bit_diameter = 2.0 * settings.covariance[0];
    metric.max_iterations = 1;
    metric.power = 1.0;
    metric.sigma = false;
    metric.angular_scale = settings.covariance[3 * term + 4] / settings.covariance[3 * term + 3];
    return metric;
}

std::size_t long_term(const Settings& settings) {
    return settings.covariance.size() > 5 ? 1 : 0;
}

struct Far {
    double square;
    std::size_t row;
};

}  // namespace

struct NearFar::Scratch {
    Search::Scratch by_short, by_long;
    std::vector<kernel::Candidate> near_short, near_long, far, rows;  // far: the thinned samples around the group
    std::vector<unsigned char> seen;                                  // cells of one row of cells
    std::vector<Far> nearest[lanes];
    double shallow = 0.0, deep = 0.0;  // the depths that `far` covers
    double reach = 0.0;                // how far along the hole the previous group looked for far neighbours
    kernel::KrigingRoom room;
};

NearFar::NearFar(const Settings& settings)
    : rule_{},
      short_(metric_of(settings, 0)),
      long_(metric_of(settings, long_term(settings))),
      max_distance_(settings.max_distance),
      max_square_(max_distance_ * max_distance_ * (1.0 - 1e-9)),  // all of these samples are neighbours for the search
      wanted_(settings.neighbors) {
    const std::vector<double>& values = settings.covariance;
    rule_.radius = values[0];
    rule_.noise = values[1];
    rule_.terms = static_cast<int>(values.size() - 2) / 3;
    for (int t = 0; t < rule_.terms; ++t) {
        const double* term = values.data() + 2 + 3 * t;
        rule_.variance[t] = term[0];
        rule_.around[t] = 12.0 * (values[0] / term[1]) * (values[0] / term[1]);
        rule_.along[t] = 3.0 / (term[2] * term[2]);
    }
    const double* term = values.data() + 2 + 3 * long_term(settings);
    stretch_ = term[2] / term[1];
    cells_.height = share * term[2];
    cells_.around =
        static_cast<Index>(std::clamp(std::ceil(2.0 * std::numbers::pi * values[0] / (share * term[1])), 1.0, 4096.0));
}

NearFar::~NearFar() = default;

NearFar::Scratch& NearFar::scratch_of(Search::Scratch& scratch) const {
    if (!scratch.near_far) scratch.near_far = std::make_shared<Scratch>();
    return *static_cast<Scratch*>(scratch.near_far.get());
}

// Lists the samples of the thinned set with depths from the row of cells that holds `low` to the one that holds `high`.
void NearFar::gather_cells(const Samples& samples, double low, double high, Scratch& scratch) const {
    scratch.far.clear();
    const double first = cells_.row(low), last = cells_.row(high);
    double row = first - 1.0;
    for (std::size_t i = samples.step_to(first * cells_.height - cells_.height, {}, 1).chunk;
         i < samples.chunks().size(); ++i) {
        const Chunk& chunk = *samples.chunks()[i];
        if (cells_.row(chunk.first_depth()) > last) break;
        const Index rank = samples.rank({i, 0});
        for (const std::uint16_t at : chunk.thinned(cells_)) {
            const double in_row = cells_.row(chunk.depth()[at]);
            if (in_row < first) continue;
            if (in_row > last) break;
            if (in_row != row) scratch.seen.assign(static_cast<std::size_t>(cells_.around), 0);
            row = in_row;
            unsigned char& seen = scratch.seen[static_cast<std::size_t>(cells_.column(chunk.toolface()[at]))];
            if (seen) continue;
            seen = 1;
            scratch.far.push_back({chunk.depth()[at], chunk.toolface()[at], chunk.radius()[at], rank + at});
        }
    }
    scratch.shallow = first * cells_.height;
    scratch.deep = (last + 1.0) * cells_.height;
}

double NearFar::find_far(const Samples& samples, const kernel::Group& g, Index used, Scratch& scratch) const {
    const auto wanted = static_cast<std::size_t>(wanted_);
    const double degree = rule_.radius * kernel::metres_a_degree;
    const auto [shallow, deep] = std::minmax(g.depth[0], g.depth[used - 1]);
    const auto nearer = [](const Far& a, const Far& b) {
        return a.square < b.square || (a.square == b.square && a.row < b.row);
    };
    if (scratch.reach == 0.0) scratch.reach = 2.0 * cells_.height;
    for (double reach = scratch.reach;; reach *= 1.5) {
        reach = std::min(reach, max_distance_);
        gather_cells(samples, shallow - reach, deep + reach, scratch);
        const bool all =
            reach >= max_distance_ || (scratch.shallow <= samples.first_depth() && scratch.deep > samples.last_depth());
        double farthest = 0.0;
        for (Index lane = 0; lane < used; ++lane) {
            std::vector<Far>& found = scratch.nearest[lane];
            found.clear();
            for (std::size_t i = 0; i < scratch.far.size(); ++i) {
                const kernel::Candidate& c = scratch.far[i];
                const double along = c.depth - g.depth[lane], turn = std::abs(c.toolface - g.toolface[lane]);
                const double across = degree * std::min(turn, 360.0 - turn);
                if (across * across + along * along > max_square_) continue;
                const Far next{stretch_ * across * (stretch_ * across) + along * along, i};
                if (found.size() == wanted) {
                    if (!nearer(next, found.front())) continue;
                    std::pop_heap(found.begin(), found.end(), nearer);
                    found.back() = next;
                } else {
                    found.push_back(next);
                }
                std::push_heap(found.begin(), found.end(), nearer);
            }
            farthest = std::max(farthest, found.size() < wanted ? max_distance_ : std::sqrt(found.front().square));
        }
        if (all || farthest < reach) {
            scratch.reach = std::max(std::min(1.05 * farthest, reach), 0.5 * cells_.height);
            return std::min(farthest, max_distance_);
        }
    }
}

kernel::Group NearFar::find(const Samples& samples, const Helix& helix, Index group, Index vertex_count,
                            Scratch& scratch, double& shallow, double& deep) const {
    const Index used = std::min(lanes, vertex_count - group * lanes);
    const auto room = static_cast<std::size_t>(wanted_ * lanes);
    scratch.near_short.resize(room);
    scratch.near_long.resize(room);
    scratch.rows.resize(3 * room);
    GroupResult by_short, by_long;
    const kernel::Group g =
        short_.neighbours(samples, helix, group, vertex_count, scratch.by_short, scratch.near_short.data(), by_short);
    long_.neighbours(samples, helix, group, vertex_count, scratch.by_long, scratch.near_long.data(), by_long);
    const double far = find_far(samples, g, used, scratch);
    const auto [first, last] = std::minmax(g.depth[0], g.depth[used - 1]);
    const double slack = 1.0 + 1e-6;
    shallow = std::min({by_short.shallow, by_long.shallow, cells_.row(first - far * slack) * cells_.height});
    deep = std::max({by_short.deep, by_long.deep, (cells_.row(last + far * slack) + 1.0) * cells_.height});

    kernel::Group all = g;
    const double degree = rule_.radius * kernel::metres_a_degree;
    for (Index lane = 0; lane < lanes; ++lane) {
        all.support[lane] = 0.0;
        all.nearest[lane] = nan;
        if (lane >= used) continue;
        double least = no_limit;
        Index count = 0;
        const auto take = [&](const kernel::Candidate& c) {
            const double along = c.depth - g.depth[lane], turn = std::abs(c.toolface - g.toolface[lane]);
            const double across = degree * std::min(turn, 360.0 - turn), square = across * across + along * along;
            if (!(square <= max_square_) || c.depth == kernel::none_depth) return;
            least = std::min(least, square);
            scratch.rows[static_cast<std::size_t>(count++ * lanes + lane)] = c;
        };
        std::vector<Far>& found = scratch.nearest[lane];
        std::sort(found.begin(), found.end(), [](const Far& a, const Far& b) { return a.row < b.row; });
        std::size_t i = static_cast<std::size_t>(lane), j = i, k = 0;
        constexpr Index none = std::numeric_limits<Index>::max();
        const auto rank_at = [&](const std::vector<kernel::Candidate>& rows, std::size_t at) {
            return at < room && rows[at].depth != kernel::none_depth ? rows[at].rank : none;
        };
        for (;;) {  // merges the three sets, which are in canonical order
            const Index a = rank_at(scratch.near_short, i), b = rank_at(scratch.near_long, j);
            const Index c = k < found.size() ? scratch.far[found[k].row].rank : none;
            const Index next = std::min({a, b, c});
            if (next == none) break;
            take(next == a ? scratch.near_short[i] : next == b ? scratch.near_long[j] : scratch.far[found[k].row]);
            if (a == next) i += lanes;
            if (b == next) j += lanes;
            if (c == next) ++k;
        }
        all.support[lane] = static_cast<double>(count);
        if (count > 0) all.nearest[lane] = std::sqrt(least);
    }
    return all;
}

// Kriges the rows in `scratch`; returns how many neighbours a vertex has at most.
int NearFar::krige(kernel::Group& g, Scratch& scratch) const {
    const int most = static_cast<int>(*std::max_element(g.support, g.support + lanes));
    if (most > 0) short_.functions().krige_near_far(g, scratch.rows.data(), most, rule_, scratch.room);
    for (Index lane = 0; lane < lanes; ++lane)
        if (g.support[lane] == 0.0) g.radius[lane] = g.sums.square_weights[lane] = nan;
    return most;
}

void NearFar::run(const Samples& samples, const Helix& helix, Index group, Index vertex_count, Search::Scratch& scratch,
                  GroupResult& result) const {
    Scratch& own = scratch_of(scratch);
    kernel::Group g = find(samples, helix, group, vertex_count, own, result.shallow, result.deep);
    krige(g, own);
    result.least_trial = rule_.radius;
    for (Index lane = 0; lane < lanes; ++lane) {
        result.radius[lane] = g.radius[lane];
        result.nearest[lane] = g.nearest[lane];
        result.support[lane] = static_cast<std::uint16_t>(g.support[lane]);
        result.iterations[lane] = 1;
        result.reach_square[lane] = kernel::boundless_square;
        result.sums.square_weights[lane] = g.sums.square_weights[lane];
        const double zero = g.support[lane] > 0.0 ? 0.0 : nan;
        result.sums.scatter[lane] = result.sums.along[lane] = result.sums.across[lane] = zero;
    }
}

void NearFar::interpolate(const Samples& samples, const Helix& helix, Index group, Index vertex_count,
                          Search::Scratch& scratch, std::span<const std::span<const double>> channels,
                          std::span<double* const> out) const {
    Scratch& own = scratch_of(scratch);
    double shallow = 0.0, deep = 0.0;
    const kernel::Group found = find(samples, helix, group, vertex_count, own, shallow, deep);
    const std::vector<kernel::Candidate> rows = own.rows;
    const Index used = std::min(lanes, vertex_count - group * lanes);
    for (std::size_t c = 0; c < channels.size(); ++c) {
        kernel::Group g = found;
        for (Index lane = 0; lane < lanes; ++lane) {
            Index count = 0;
            for (Index i = 0; i < static_cast<Index>(found.support[lane]); ++i) {
                kernel::Candidate row = rows[static_cast<std::size_t>(i * lanes + lane)];
                row.radius = channels[c][static_cast<std::size_t>(row.rank)];
                if (!std::isnan(row.radius)) own.rows[static_cast<std::size_t>(count++ * lanes + lane)] = row;
            }
            g.support[lane] = static_cast<double>(count);
        }
        krige(g, own);
        std::copy_n(g.radius, used, out[c]);
    }
}

}  // namespace helibore
