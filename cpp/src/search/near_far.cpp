// The near neighbours are found by the exact search, in two metrics; the far ones from the thinned rows of each chunk.
// Groups count from vertex 0 of the whole helix, so a stretch of it, whose own groups may lie across these, has equal
// bits.
#include "search/near_far.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>

namespace helibore {
namespace {

constexpr Index lanes = kernel::lanes;
constexpr double nan = std::numeric_limits<double>::quiet_NaN();
constexpr int rank_bits = 9;    // a hash table of 512 ranks is large enough for all neighbours of a group
constexpr double share = 0.35;  // of the lengths of the long term: the size of a cell

// Settings under which the search finds the nearest samples by one term of the covariance.
Settings metric_of(const Settings& settings, std::size_t term, int neighbors) {
    Settings metric = settings;
    metric.estimator = Estimator::inverse_distance;
    metric.covariance.clear();
    metric.neighbors = neighbors;
    metric.bit_diameter = 2.0 * settings.covariance[0];
    metric.max_iterations = 1;
    metric.power = 1.0;
    metric.sigma = false;
    metric.angular_scale = settings.covariance[3 * term + 4] / settings.covariance[3 * term + 3];
    return metric;
}

std::size_t long_term(const Settings& settings) {
    return settings.covariance.size() > 6 ? 1 : 0;
}

struct Far {
    double square;
    std::size_t row;
};

}  // namespace

struct NearFar::Scratch {
    Search::Scratch by_short, by_long;
    std::vector<kernel::Candidate> near_short, near_long, thinned, rows;  // thinned: the samples of the cells around
    std::vector<unsigned char> seen;                                      // cells of one row of cells
    std::vector<Far> far;
    std::vector<kernel::Candidate> found;                          // `rows` as they are found
    std::vector<std::uint64_t> order;                              // of `rows`: rank and position in `found`
    std::array<std::uint64_t, std::size_t{1} << rank_bits> ranks;  // 1 + rank of each of `found`, by hash
    double shallow = 0.0, deep = 0.0;                              // the depths that `thinned` covers
    double reach = 0.0;  // how far along the hole the previous group looked for far neighbours
    kernel::SharedRoom room;
};

NearFar::NearFar(const Settings& settings)
    : rule_{},
      near_((3 * settings.neighbors + 7) / 8),
      wanted_(settings.neighbors),
      short_(metric_of(settings, 0, near_)),
      long_(metric_of(settings, long_term(settings), near_)),
      max_distance_(settings.max_distance),
      max_square_(max_distance_ * max_distance_ * (1.0 - 1e-9)) {  // all of these samples are neighbours for the search

    const std::vector<double>& values = settings.covariance;
    rule_.radius = values[0];
    rule_.noise = values[1];
    rule_.terms = static_cast<int>(values.size() - 2) / 3;
    rule_.turn = values.size() % 3 == 0 ? values.back() : 0.0;
    for (int t = 0; t < rule_.terms; ++t) {
        const double* term = values.data() + 2 + 3 * t;
        rule_.variance[t] = term[0];
        rule_.around[t] = 12.0 * (values[0] / term[1]) * (values[0] / term[1]);
        rule_.along[t] = 3.0 / (term[2] * term[2]);
    }
    const double* term = values.data() + 2 + 3 * long_term(settings);
    stretch_ = term[2] / term[1];
    cells_.turn = rule_.turn;
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
    scratch.thinned.clear();
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
            unsigned char& seen =
                scratch.seen[static_cast<std::size_t>(cells_.column(chunk.depth()[at], chunk.toolface()[at]))];
            if (seen) continue;
            seen = 1;
            scratch.thinned.push_back({chunk.depth()[at], chunk.toolface()[at], chunk.radius()[at], rank + at});
        }
    }
    scratch.shallow = first * cells_.height;
    scratch.deep = (last + 1.0) * cells_.height;
}

double NearFar::find_far(const Samples& samples, const kernel::Group& g, double half_width, Scratch& scratch) const {
    const auto wanted = static_cast<std::size_t>(wanted_);
    const double degree = rule_.radius * kernel::metres_a_degree, half_height = 0.5 * std::abs(g.depth[7] - g.depth[0]);
    const auto nearer = [](const Far& a, const Far& b) {
        return a.square < b.square || (a.square == b.square && a.row < b.row);
    };
    std::vector<Far>& found = scratch.far;
    if (scratch.reach == 0.0) scratch.reach = 2.0 * cells_.height;
    for (double reach = scratch.reach;; reach *= 1.5) {
        reach = std::min(reach, max_distance_);
        gather_cells(samples, g.middle - half_height - reach, g.middle + half_height + reach, scratch);
        const bool all =
            reach >= max_distance_ || (scratch.shallow <= samples.first_depth() && scratch.deep > samples.last_depth());
        found.clear();
        for (std::size_t i = 0; i < scratch.thinned.size(); ++i) {
            const kernel::Candidate& c = scratch.thinned[i];
            const double along = std::max(std::abs(c.depth - g.middle) - half_height, 0.0);
            const double turned = c.toolface - g.center - rule_.turn * (c.depth - g.middle);
            const double turn = std::abs(std::remainder(turned, 360.0));
            const double across = degree * std::max(turn - half_width, 0.0);
            if (across * across + along * along > max_square_) continue;
            found.push_back({stretch_ * across * (stretch_ * across) + along * along, i});
        }
        double farthest = max_distance_;
        if (found.size() >= wanted) {
            std::nth_element(found.begin(), found.begin() + wanted_ - 1, found.end(), nearer);
            found.resize(wanted);
            farthest = std::min(std::sqrt(found.back().square), max_distance_);
        }
        if (all || farthest < reach) {
            scratch.reach = std::max(std::min(1.05 * farthest, reach), 0.5 * cells_.height);
            return half_height + farthest;
        }
    }
}

kernel::Group NearFar::find(const Samples& samples, const Helix& helix, Index group, Scratch& scratch, double& shallow,
                            double& deep) const {
    const auto room = static_cast<std::size_t>(near_ * lanes);
    scratch.near_short.resize(room);
    scratch.near_long.resize(room);
    GroupResult by_short, by_long;
    const Index all = (group + 1) * lanes;
    kernel::Group g =
        short_.neighbours(samples, helix, group, all, scratch.by_short, scratch.near_short.data(), by_short);
    long_.neighbours(samples, helix, group, all, scratch.by_long, scratch.near_long.data(), by_long);
    const double half_width = std::min(180.0, 1260.0 / static_cast<double>(helix.sectors));  // 3.5 sectors
    const double far = find_far(samples, g, half_width, scratch) * (1.0 + 1e-6);
    shallow = std::min({by_short.shallow, by_long.shallow, cells_.row(g.middle - far) * cells_.height});
    deep = std::max({by_short.deep, by_long.deep, (cells_.row(g.middle + far) + 1.0) * cells_.height});

    const double degree = rule_.radius * kernel::metres_a_degree;
    scratch.found.clear();
    scratch.order.clear();
    scratch.ranks.fill(0);
    const auto put = [&](const kernel::Candidate& c, auto near_enough) {  // the first time that it is near enough
        const std::uint64_t key = static_cast<std::uint64_t>(c.rank) + 1;
        std::size_t at = key * 0x9e3779b97f4a7c15 >> (64 - rank_bits);
        while (scratch.ranks[at] != 0 && scratch.ranks[at] != key) at = (at + 1) % scratch.ranks.size();
        if (scratch.ranks[at] == key || !near_enough()) return;
        scratch.ranks[at] = key;
        scratch.order.push_back(static_cast<std::uint64_t>(c.rank) << rank_bits | scratch.found.size());
        scratch.found.push_back(c);
    };
    for (const std::vector<kernel::Candidate>* near : {&scratch.near_short, &scratch.near_long})
        for (std::size_t i = 0; i < room; ++i) {
            const kernel::Candidate& c = (*near)[i];
            if (c.depth == kernel::none_depth) continue;
            put(c, [&] {
                const std::size_t lane = i % lanes;
                const double along = c.depth - g.depth[lane], turn = std::abs(c.toolface - g.toolface[lane]);
                const double across = degree * std::min(turn, 360.0 - turn);
                return across * across + along * along <= max_square_;
            });
        }
    for (const Far& each : scratch.far) put(scratch.thinned[each.row], [] { return true; });
    std::sort(scratch.order.begin(), scratch.order.end());
    scratch.rows.clear();
    for (const std::uint64_t key : scratch.order) scratch.rows.push_back(scratch.found[key % scratch.ranks.size()]);
    return g;
}

// Kriges from the rows in `scratch`. A vertex has a radius if one of them is within max_distance of it.
void NearFar::krige(kernel::Group& g, Scratch& scratch) const {
    const int n = static_cast<int>(scratch.rows.size());
    if (n > 0) short_.functions().krige_shared(g, scratch.rows.data(), n, rule_, scratch.room);
    for (Index lane = 0; lane < lanes; ++lane) {
        const bool reached = n > 0 && g.nearest[lane] * g.nearest[lane] <= max_square_;
        g.support[lane] = reached ? n : 0;
        if (!reached) g.radius[lane] = g.nearest[lane] = g.sums.square_weights[lane] = nan;
    }
}

template <class Use>
void NearFar::each_part(const Helix& helix, Index group, Use use) const {
    Helix whole = helix;
    const Index before = helix.first % lanes;
    whole.first -= before;
    use(whole, group, before, lanes - before, 0);
    if (before > 0) use(whole, group + 1, 0, before, lanes - before);
}

void NearFar::run(const Samples& samples, const Helix& helix, Index group, Search::Scratch& scratch,
                  GroupResult& result) const {
    Scratch& own = scratch_of(scratch);
    result.shallow = no_limit;
    result.deep = -no_limit;
    result.least_trial = rule_.radius;
    each_part(helix, group, [&](const Helix& whole, Index number, Index first, Index count, Index to) {
        double shallow = 0.0, deep = 0.0;
        kernel::Group g = find(samples, whole, number, own, shallow, deep);
        krige(g, own);
        result.shallow = std::min(result.shallow, shallow);
        result.deep = std::max(result.deep, deep);
        for (Index from = first; from < first + count; ++from, ++to) {
            result.radius[to] = g.radius[from];
            result.nearest[to] = g.nearest[from];
            result.support[to] = static_cast<std::uint16_t>(g.support[from]);
            result.iterations[to] = 1;
            result.reach_square[to] = kernel::boundless_square;
            result.sums.square_weights[to] = g.sums.square_weights[from];
            const double zero = g.support[from] > 0.0 ? 0.0 : nan;
            result.sums.scatter[to] = result.sums.along[to] = result.sums.across[to] = zero;
        }
    });
}

void NearFar::interpolate(const Samples& samples, const Helix& helix, Index group, Index vertex_count,
                          Search::Scratch& scratch, std::span<const std::span<const double>> channels,
                          std::span<double* const> out) const {
    Scratch& own = scratch_of(scratch);
    each_part(helix, group, [&](const Helix& whole, Index number, Index first, Index count, Index to) {
        double shallow = 0.0, deep = 0.0;
        const kernel::Group found = find(samples, whole, number, own, shallow, deep);
        const std::vector<kernel::Candidate> rows = own.rows;
        const Index used = std::min(count, vertex_count - group * lanes - to);
        for (std::size_t c = 0; c < channels.size(); ++c) {
            own.rows = rows;
            for (kernel::Candidate& row : own.rows) row.radius = channels[c][static_cast<std::size_t>(row.rank)];
            std::erase_if(own.rows, [](const kernel::Candidate& row) { return std::isnan(row.radius); });
            kernel::Group g = found;
            krige(g, own);
            for (Index i = 0; i < used; ++i) out[c][to + i] = g.radius[first + i];
        }
    });
}

}  // namespace helibore
