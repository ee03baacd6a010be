// The near neighbours are found by the exact search, in two metrics; the far ones from the cells of each chunk.
// Groups count from vertex 0 of the whole helix, so a stretch of it, whose own groups may lie across these, has equal
// bits.
#include "search/near_far.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <tuple>
#include <utility>

#include "base/trigonometry.hpp"

namespace helibore {
namespace {

constexpr Index lanes = kernel::lanes;
constexpr double nan = std::numeric_limits<double>::quiet_NaN();
constexpr int number_bits = 9;                      // enough for the neighbours of a group
constexpr double large_noise = 0.25;                // of the variance of the long term
constexpr std::size_t beside = 8;                   // neighbours with which one is compared
constexpr Index burst = 8;                          // samples before and after one that may be wrong with it
constexpr double most_off = 2.5;                    // deviations of the noise
constexpr double beside_border = 0.2;               // metres: samples of another stretch count so far from it
constexpr double share = 0.35, small_share = 0.25;  // of the lengths of the long term: the size of a cell

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
    metric.angular_scale = settings.covariance[3 * term + 4] / std::abs(settings.covariance[3 * term + 3]);
    return metric;
}

std::size_t long_term(const Settings& settings) {
    return settings.covariance.size() > 6 ? 1 : 0;
}

// Settings whose vertices lie half a turn from those of others.
Settings turned_by_half(Settings settings) {
    settings.start_toolface = wrap_toolface(settings.start_toolface + 180.0);
    return settings;
}

bool repeats_after_half_a_turn(const Settings& settings) {
    return long_term(settings) == 1 && settings.covariance[6] < 0.0;
}

// A cell, from its first sample on.
struct Cell : CellStart {
    std::size_t chunk;
};

// Returns the first cell of a chunk that lies at this row or below it.
std::vector<CellStart>::const_iterator starts_from(const std::vector<CellStart>& starts, double row) {
    return std::ranges::partition_point(starts, [&](const CellStart& start) { return start.row < row; });
}

// A cell, from its first sample that is not a near neighbour.
struct Far {
    double square;
    Samples::Place first;
};

// The ranks of near neighbours.
class RankSet {
  public:
    void clear() { keys_.fill(0); }
    bool contains(Index rank) const { return keys_[place(rank)] != 0; }
    // Returns whether the rank was not there before.
    bool insert(Index rank) {
        std::uint64_t& key = keys_[place(rank)];
        return std::exchange(key, key_of(rank)) == 0;
    }

  private:
    static std::uint64_t key_of(Index rank) { return static_cast<std::uint64_t>(rank) + 1; }
    // Returns where the rank is, or where it would be.
    std::size_t place(Index rank) const {
        const std::uint64_t key = key_of(rank);
        std::size_t at = key * 0x9e3779b97f4a7c15 >> (64 - bits);
        while (keys_[at] != 0 && keys_[at] != key) at = (at + 1) % keys_.size();
        return at;
    }

    static constexpr int bits = 9;  // large enough for all near neighbours of a group
    std::array<std::uint64_t, std::size_t{1} << bits> keys_;
};

}  // namespace

struct NearFar::Scratch {
    Search::Scratch by_short, by_long, by_opposite;
    std::vector<kernel::Candidate> near_short, near_long, near_opposite;
    RankSet near;
    std::vector<Cell> cells;
    std::vector<std::uint32_t> last_of_column;  // of `cells`
    double shallow = 0.0, deep = 0.0;           // the depths that `cells` covers
    std::vector<Far> far;
    std::vector<kernel::Candidate> members;  // the samples of one neighbour after the other
    std::vector<std::uint32_t> starts;       // of each neighbour in `members`; last, the end
    std::vector<std::uint64_t> order;        // rank of the first member and number of the neighbour, sorted
    std::vector<double> added;               // square metres, for each neighbour: its noise is greater by this
    std::vector<kernel::SharedNeighbor> rows;
    double reach = 0.0;  // how far along the hole the previous group looked for far neighbours
    kernel::SharedRoom room;
};

NearFar::NearFar(const Settings& settings, std::size_t number, std::vector<Excess> excess)
    : rule_{},
      near_((3 * settings.neighbors + 7) / 8),
      near_long_(repeats_after_half_a_turn(settings) ? (near_ + 1) / 2 : near_),
      short_(metric_of(settings, 0, near_)),
      long_(metric_of(settings, long_term(settings), near_long_)),
      opposite_(metric_of(turned_by_half(settings), long_term(settings), near_long_)),
      max_distance_(settings.max_distance),
      max_square_(max_distance_ * max_distance_ * (1.0 - 1e-9)),  // all of these samples are neighbours for the search
      short_stretch_(settings.covariance[4] / std::abs(settings.covariance[3])),
      robust_(settings.robust),
      number_(number),
      excess_(std::move(excess)) {
    const std::vector<double>& values = settings.covariance;
    rule_.radius = values[0];
    rule_.noise = values[1];
    const int terms = static_cast<int>(values.size() - 2) / 3;
    rule_.terms = std::max(terms, 2);  // the second has variance 0 if there is none
    rule_.turn = values.size() % 3 == 0 ? values.back() : 0.0;
    rule_.half_turns = repeats_after_half_a_turn(settings);
    rule_.smooth = values[3] < 0.0;
    for (int t = 0; t < terms; ++t) {
        const double* term = values.data() + 2 + 3 * t;
        rule_.variance[t] = term[0];
        rule_.around[t] = 12.0 * (values[0] / term[1]) * (values[0] / term[1]);
        rule_.along[t] = 3.0 / (term[2] * term[2]);
    }
    const double* term = values.data() + 2 + 3 * long_term(settings);
    const bool noisy = rule_.noise > large_noise * term[0];
    wanted_ = noisy ? (3 * settings.neighbors + 1) / 2 : settings.neighbors;
    averaged_ = noisy ? kernel::most_averaged : 1;
    const double size = noisy ? small_share : share;
    const double around = std::abs(term[1]);
    stretch_ = term[2] / around;
    cells_.turn = rule_.turn;
    cells_.height = size * term[2];
    cells_.around =
        static_cast<Index>(std::clamp(std::ceil(2.0 * std::numbers::pi * values[0] / (size * around)), 1.0, 4096.0));
}

NearFar::Scratch& NearFar::scratch_of(Search::Scratch& scratch) const {
    if (scratch.near_far.size() <= number_) scratch.near_far.resize(number_ + 1);
    std::shared_ptr<void>& own = scratch.near_far[number_];
    if (!own) own = std::make_shared<Scratch>();
    return *static_cast<Scratch*>(own.get());
}

// Lists the cells from the row of cells that holds the depth `low` to the one that holds `high`.
void NearFar::gather_cells(const Samples& samples, double low, double high, Scratch& scratch) const {
    std::vector<Cell>& cells = scratch.cells;
    cells.clear();
    scratch.last_of_column.resize(static_cast<std::size_t>(cells_.around));
    const double first = cells_.row(low), last = cells_.row(high);
    const auto& chunks = samples.chunks();
    const auto from = std::ranges::partition_point(
        chunks, [&](const auto& chunk) { return cells_.row(chunk->last_depth()) < first; });
    for (auto chunk = from; chunk != chunks.end() && cells_.row((*chunk)->first_depth()) <= last; ++chunk) {
        const std::vector<CellStart>& starts = (*chunk)->rows_of(cells_).starts;
        for (auto start = starts_from(starts, first); start != starts.end() && start->row <= last; ++start) {
            std::uint32_t& at = scratch.last_of_column[start->column];  // may be of an earlier call
            if (at < cells.size() && cells[at].column == start->column && cells[at].row == start->row) continue;
            at = static_cast<std::uint32_t>(cells.size());
            cells.push_back({*start, static_cast<std::size_t>(chunk - chunks.begin())});
        }
    }
    scratch.shallow = first * cells_.height;
    scratch.deep = (last + 1.0) * cells_.height;
}

// Calls use(position, sample) for the samples of a cell from one of them on, in order, without near neighbours, until
// it returns false.
template <class Use>
void NearFar::each_member(const Samples& samples, const Scratch& scratch, Samples::Place at, Use use) const {
    const Samples::Place start = at;
    for (;;) {
        const Chunk& chunk = *samples.chunks()[at.chunk];
        const Index rank = samples.rank({at.chunk, 0});
        const RowsOfCells& rows = chunk.rows_of(cells_);
        do {
            const auto i = static_cast<std::size_t>(at.offset);
            if (!scratch.near.contains(rank + at.offset) &&
                !use(at, kernel::Candidate{chunk.depth()[i], chunk.toolface()[i], chunk.radius()[i], rank + at.offset}))
                return;
            at.offset = rows.next[i];
        } while (at.offset != 0);
        const Chunk& of = *samples.chunks()[start.chunk];
        const double depth = of.depth()[start.offset], row = cells_.row(depth);
        const Index column = cells_.column(depth, of.toolface()[start.offset]);
        do {  // few cells lie in more than one chunk
            if (++at.chunk == samples.chunks().size()) return;
            const std::vector<CellStart>& starts = samples.chunks()[at.chunk]->rows_of(cells_).starts;
            if (starts.front().row > row) return;
            const auto same = std::find_if(starts_from(starts, row), starts.end(), [&](const CellStart& other) {
                return other.row > row || other.column == column;
            });
            at.offset = same == starts.end() || same->row > row ? -1 : same->offset;
        } while (at.offset < 0);
    }
}

double NearFar::find_far(const Samples& samples, const kernel::Group& g, double half_width, Scratch& scratch) const {
    const auto wanted = static_cast<std::size_t>(wanted_);
    const double degree = rule_.radius * kernel::metres_a_degree, half_height = 0.5 * std::abs(g.depth[7] - g.depth[0]);
    const auto nearer = [](const Far& a, const Far& b) {
        return std::tie(a.square, a.first.chunk, a.first.offset) < std::tie(b.square, b.first.chunk, b.first.offset);
    };
    std::vector<Far>& found = scratch.far;
    if (scratch.reach == 0.0) scratch.reach = 2.0 * cells_.height;
    for (double reach = scratch.reach;; reach *= 1.5) {
        reach = std::min(reach, max_distance_);
        gather_cells(samples, g.middle - half_height - reach, g.middle + half_height + reach, scratch);
        const bool all =
            reach >= max_distance_ || (scratch.shallow <= samples.first_depth() && scratch.deep > samples.last_depth());
        found.clear();
        const auto judge = [&](Samples::Place at, const kernel::Candidate& c) {
            const double along = std::max(std::abs(c.depth - g.middle) - half_height, 0.0);
            const double turned = c.toolface - g.center - rule_.turn * (c.depth - g.middle);
            const double turn = std::abs(turned - 360.0 * nearest_whole(turned * (1.0 / 360.0)));
            double across = degree * std::max(turn - half_width, 0.0);
            if (across * across + along * along > max_square_) return false;
            if (rule_.half_turns) across = degree * std::max(std::min(turn, 180.0 - turn) - half_width, 0.0);
            found.push_back({stretch_ * across * (stretch_ * across) + along * along, at});
            return false;
        };
        for (const Cell& cell : scratch.cells) each_member(samples, scratch, {cell.chunk, cell.offset}, judge);
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

// A new sample that is no near neighbour changes a far one if it is the first of its cell, or one of those in the mean.
// Below all others it is neither if as many of its cell lie before it, none of them a near neighbour.
double NearFar::far_depth(const Samples& samples, Index count) const {
    double least = no_limit;
    for (Index rank = samples.size() - count; rank < samples.size(); ++rank) {
        Samples::Place at = samples.place(rank);
        const double depth = samples.depth(rank), row = cells_.row(depth);
        const Index column = cells_.column(depth, samples.chunks()[at.chunk]->toolface()[at.offset]);
        for (std::size_t found = 0; found < averaged_;) {
            if (at.offset == 0) {
                if (at.chunk == 0) return -no_limit;
                at.offset = samples.chunks()[--at.chunk]->count;
            }
            const Chunk& chunk = *samples.chunks()[at.chunk];
            const double before = chunk.depth()[--at.offset];
            if (cells_.row(before) < row) return -no_limit;
            if (cells_.column(before, chunk.toolface()[at.offset]) != column) continue;
            if (++found == averaged_) least = std::min(least, before);
        }
    }
    return least;
}

kernel::Group NearFar::find(const Samples& samples, const Helix& helix, Index group, Scratch& scratch,
                            Bounds& bounds) const {
    scratch.near_short.resize(static_cast<std::size_t>(near_ * lanes));
    scratch.near_long.resize(static_cast<std::size_t>(near_long_ * lanes));
    GroupResult by_short, by_long;
    const Index all = (group + 1) * lanes;
    kernel::Group g =
        short_.neighbours(samples, helix, group, all, scratch.by_short, scratch.near_short.data(), by_short);
    long_.neighbours(samples, helix, group, all, scratch.by_long, scratch.near_long.data(), by_long);
    GroupResult by_opposite;
    by_opposite.shallow = no_limit;
    by_opposite.deep = -no_limit;
    scratch.near_opposite.resize(rule_.half_turns ? scratch.near_long.size() : 0);
    if (rule_.half_turns)
        opposite_.neighbours(samples, helix, group, all, scratch.by_opposite, scratch.near_opposite.data(),
                             by_opposite);
    const double degree = rule_.radius * kernel::metres_a_degree;
    scratch.members.clear();
    scratch.starts.clear();
    scratch.order.clear();
    scratch.near.clear();
    const auto begin = [&](Index rank) {  // of a neighbour
        scratch.order.push_back(static_cast<std::uint64_t>(rank) << number_bits | scratch.starts.size());
        scratch.starts.push_back(static_cast<std::uint32_t>(scratch.members.size()));
    };
    for (const std::vector<kernel::Candidate>* near : {&scratch.near_short, &scratch.near_long, &scratch.near_opposite})
        for (std::size_t i = 0; i < near->size(); ++i) {
            const kernel::Candidate& c = (*near)[i];
            if (c.depth == kernel::none_depth) continue;
            const std::size_t lane = i % lanes;
            const double along = c.depth - g.depth[lane], turn = std::abs(c.toolface - g.toolface[lane]);
            const double across = degree * std::min(turn, 360.0 - turn);
            if (across * across + along * along > max_square_ || !scratch.near.insert(c.rank)) continue;
            begin(c.rank);
            scratch.members.push_back(c);
        }
    const double half_width = std::min(180.0, 1260.0 / static_cast<double>(helix.sectors));  // 3.5 sectors
    const double far = find_far(samples, g, half_width, scratch) * (1.0 + 1e-6);
    for (const Far& each : scratch.far) {
        const std::size_t first = scratch.members.size();
        double border = no_limit;  // a mean of unlike stretches is like neither
        each_member(samples, scratch, each.first, [&](Samples::Place, const kernel::Candidate& c) {
            if (scratch.members.size() == first) {
                begin(c.rank);
                const auto next = std::ranges::upper_bound(excess_, c.depth, {}, &Excess::start);
                if (next != excess_.end()) border = next->start;
            }
            if (c.depth >= border) return false;
            scratch.members.push_back(c);
            return scratch.members.size() < first + averaged_;
        });
    }
    scratch.starts.push_back(static_cast<std::uint32_t>(scratch.members.size()));
    judge(scratch);
    std::ranges::sort(scratch.order);
    bounds.shallow =
        std::min({by_short.shallow, by_long.shallow, by_opposite.shallow, cells_.row(g.middle - far) * cells_.height});
    bounds.near_deep = std::max({by_short.deep, by_long.deep, by_opposite.deep});
    bounds.deep = std::max(bounds.near_deep, (cells_.row(g.middle + far) + 1.0) * cells_.height);
    return g;
}

void NearFar::judge(Scratch& scratch) const {
    const std::vector<std::uint32_t>& starts = scratch.starts;
    const std::size_t count = starts.size() - 1;
    scratch.added.assign(count, 0.0);
    const double start = number_ < excess_.size() ? excess_[number_].start : -no_limit;
    const double stop = number_ + 1 < excess_.size() ? excess_[number_ + 1].start : no_limit;
    if (excess_.size() > 1)
        for (std::size_t k = 0; k < count; ++k) {
            const double depth = scratch.members[starts[k]].depth;
            const Excess& of = *std::prev(std::ranges::upper_bound(excess_, depth, {}, &Excess::start));
            const double away = std::max({start - depth, depth - stop, 0.0});
            scratch.added[k] = of.noise + of.by_square * away * away;
        }
    if (!robust_) return;
    const auto single = [&](std::size_t k) { return starts[k + 1] == starts[k] + 1; };
    const double degree = rule_.radius * kernel::metres_a_degree, tolerance = most_off * std::sqrt(rule_.noise);
    for (std::size_t k = 0; k < count; ++k) {
        if (!single(k)) continue;
        const kernel::Candidate& own = scratch.members[starts[k]];
        struct Beside {
            double square;
            const kernel::Candidate* sample;
        } near[beside];  // the nearest so far, in order
        std::size_t found = 0;
        for (std::size_t other = 0; other < count; ++other) {
            if (!single(other)) continue;
            const kernel::Candidate& of = scratch.members[starts[other]];
            if (std::abs(of.rank - own.rank) <= burst) continue;
            const double along = of.depth - own.depth;
            const double turned = of.toolface - own.toolface - rule_.turn * along;
            const double across = short_stretch_ * degree * (turned - 360.0 * nearest_whole(turned * (1.0 / 360.0)));
            const double square = across * across + along * along;
            std::size_t at = found;
            while (at > 0 && (square < near[at - 1].square ||
                              (square == near[at - 1].square && of.rank < near[at - 1].sample->rank)))
                --at;
            if (at == beside) continue;
            if (found < beside) ++found;
            for (std::size_t i = found - 1; i > at; --i) near[i] = near[i - 1];
            near[at] = {square, &of};
        }
        if (found < beside) continue;
        double least = no_limit, low = no_limit, high = -no_limit, greatest = -no_limit;  // low, high: the second ones
        for (const Beside& of : near) {
            const double radius = of.sample->radius;
            low = std::min(low, std::max(least, radius));
            least = std::min(least, radius);
            high = std::max(high, std::min(greatest, radius));
            greatest = std::max(greatest, radius);
        }
        if (std::max(own.radius - high, low - own.radius) <= tolerance) continue;
        const double off = own.radius - 0.5 * (low + high);
        scratch.added[k] += off * off;
    }
}

// Returns the mean of samples of a cell; `value` gives that of a sample, or NaN: the sample then does not count.
template <class Value>
kernel::SharedNeighbor NearFar::mean_of(std::span<const kernel::Candidate> members, const Value& value) const {
    const kernel::Candidate& start = members.front();
    if (members.size() == 1 && !std::isnan(value(start)))
        return {{start.depth, start.toolface, value(start), start.rank}, 1.0};
    double base = 0.0;
    kernel::SharedNeighbor mean{{0.0, 0.0, 0.0, start.rank}, 0.0};
    for (const kernel::Candidate& c : members) {
        const double of = value(c);
        if (std::isnan(of)) continue;
        if (mean.count == 0.0) base = of;
        mean.count += 1.0;
        const double along = c.depth - start.depth, turned = c.toolface - start.toolface - rule_.turn * along;
        const double turn = turned - 360.0 * std::floor(turned * (1.0 / 360.0) + 0.5);
        mean.depth += along;
        mean.toolface += turn;
        mean.radius += of - base;
    }
    for (double* sum : {&mean.depth, &mean.toolface, &mean.radius}) *sum /= mean.count;
    mean.toolface = wrap_toolface(start.toolface + mean.toolface + rule_.turn * mean.depth);
    mean.depth += start.depth;
    mean.radius += base;
    return mean;
}

// Kriges the values of the neighbours in `scratch`; NaN values do not count. A vertex has a radius if a sample is
// within max_distance of it.
template <class Value>
void NearFar::krige(kernel::Group& g, Scratch& scratch, const Value& value) const {
    scratch.rows.clear();
    for (const std::uint64_t key : scratch.order) {
        const std::size_t number = key % (std::uint64_t{1} << number_bits);
        const std::uint32_t* start = &scratch.starts[number];
        auto mean = mean_of(std::span(scratch.members).subspan(start[0], start[1] - start[0]), value);
        mean.count /= 1.0 + mean.count * scratch.added[number] / rule_.noise;  // exact where nothing is added
        if (mean.count > 0.0) scratch.rows.push_back(mean);
    }
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
    result.deep = result.near_deep = -no_limit;
    result.least_trial = rule_.radius;
    each_part(helix, group, [&](const Helix& whole, Index number, Index first, Index count, Index to) {
        Bounds bounds{};
        kernel::Group g = find(samples, whole, number, own, bounds);
        krige(g, own, [](const kernel::Candidate& c) { return c.radius; });
        result.shallow = std::min(result.shallow, bounds.shallow);
        result.deep = std::max(result.deep, bounds.deep);
        result.near_deep = std::max(result.near_deep, bounds.near_deep);
        for (Index from = first; from < first + count; ++from, ++to) {
            result.radius[to] = g.radius[from];
            result.nearest[to] = g.nearest[from];
            result.support[to] = static_cast<std::uint16_t>(g.support[from]);
            result.iterations[to] = 1;
            result.reach_square[to] = kernel::boundless_square;
            result.sums.square_weights[to] = g.sums.square_weights[from];
            result.sums.scatter[to] = g.support[from] > 0.0 ? g.sums.scatter[from] : nan;
            result.sums.along[to] = result.sums.across[to] = g.support[from] > 0.0 ? 0.0 : nan;
        }
    });
}

void NearFar::interpolate(const Samples& samples, const Helix& helix, Index group, Index vertex_count,
                          Search::Scratch& scratch, std::span<const std::span<const double>> channels,
                          std::span<double* const> out) const {
    Scratch& own = scratch_of(scratch);
    each_part(helix, group, [&](const Helix& whole, Index number, Index first, Index count, Index to) {
        Bounds bounds{};
        const kernel::Group found = find(samples, whole, number, own, bounds);
        const Index used = std::min(count, vertex_count - group * lanes - to);
        for (std::size_t c = 0; c < channels.size(); ++c) {
            kernel::Group g = found;
            krige(g, own, [&](const kernel::Candidate& of) { return channels[c][static_cast<std::size_t>(of.rank)]; });
            for (Index i = 0; i < used; ++i) out[c][to + i] = g.radius[first + i];
        }
    });
}

LikelyNearFar::LikelyNearFar(const Settings& settings) {
    struct Stretch {
        double start;
        std::vector<double> covariance;
    };
    std::vector<Stretch> all{{-no_limit, settings.covariance}};
    for (std::size_t at = 0; at < settings.stretches.size(); at += Settings::of_stretch) {
        const double* values = &settings.stretches[at + 1];
        all.push_back({values[-1], {values, values + (values[8] > 0.0 ? 11 : 8)}});
        if (values[11] != 0.0) all.back().covariance.push_back(values[11]);
    }
    // Returns the variance of a sample.
    const auto variance = [](const std::vector<double>& covariance) {
        double sum = covariance[1];
        for (std::size_t term = 2; term + 3 <= covariance.size(); term += 3) sum += covariance[term];
        return sum;
    };
    Settings of = settings;
    for (std::size_t k = 0; k < all.size(); ++k) {
        std::vector<NearFar::Excess> excess;
        for (const Stretch& other : all) {
            const double off = other.covariance[0] - all[k].covariance[0];
            const double own = variance(all[k].covariance), greater = std::max(own, variance(other.covariance));
            excess.push_back({other.start, greater - own + off * off, greater / (beside_border * beside_border)});
        }
        of.covariance = all[k].covariance;
        const double stop = k + 1 < all.size() ? all[k + 1].start : no_limit;
        each_.push_back({1.0, all[k].start, stop, NearFar(of, k, std::move(excess))});
    }
    for (auto other = settings.other_turns.begin(); other != settings.other_turns.end(); other += Settings::of_turn) {
        of.covariance.assign(other + 1, other + Settings::of_turn);
        each_.push_back({*other, -no_limit, no_limit, NearFar(of, each_.size(), {{-no_limit, 0.0, 0.0}})});
        each_[0].share -= *other;
    }
}

template <class Use>
void LikelyNearFar::each_of(const Helix& helix, Index group, Use use) const {
    const double first = helix.depth(group * lanes), last = helix.depth(group * lanes + lanes - 1);
    for (const One& one : each_)
        if (one.start <= std::max(first, last) && std::min(first, last) < one.stop) use(one);
}

void LikelyNearFar::run(const Samples& samples, const Helix& helix, Index group, Search::Scratch& scratch,
                        GroupResult& result) const {
    std::vector<const One*> used;
    each_of(helix, group, [&](const One& one) { used.push_back(&one); });
    const std::size_t count = used.size();
    used[0]->by.run(samples, helix, group, scratch, result);
    if (count == 1) return;
    std::vector<GroupResult> found(count, result);
    for (std::size_t k = 1; k < count; ++k) {
        used[k]->by.run(samples, helix, group, scratch, found[k]);
        result.shallow = std::min(result.shallow, found[k].shallow);
        result.deep = std::max(result.deep, found[k].deep);
        result.near_deep = std::max(result.near_deep, found[k].near_deep);
        result.least_trial = std::min(result.least_trial, found[k].least_trial);
    }
    for (Index i = 0; i < lanes; ++i) {
        const double depth = helix.depth(group * lanes + i);
        double radius = 0.0, square = 0.0, scatter = 0.0;
        const auto first = static_cast<std::size_t>(
            std::ranges::find_if(used, [&](const One* one) { return one->holds(depth); }) - used.begin());
        result.nearest[i] = found[first].nearest[i];
        result.support[i] = found[first].support[i];
        for (std::size_t k = first; k < count; ++k)
            if (used[k]->holds(depth)) radius += used[k]->share * found[k].radius[i];
        for (std::size_t k = first; k < count; ++k) {
            if (!used[k]->holds(depth)) continue;
            const double off = found[k].radius[i] - radius;
            square += used[k]->share * (found[k].sums.square_weights[i] + off * off);
            scatter += used[k]->share * found[k].sums.scatter[i];
        }
        result.radius[i] = radius;
        result.sums.square_weights[i] = square;
        result.sums.scatter[i] = scatter;
        result.sums.along[i] = found[first].sums.along[i];
        result.sums.across[i] = found[first].sums.across[i];
    }
}

std::vector<Search::FarChange> LikelyNearFar::far_changes(const Samples& samples, Index count) const {
    std::vector<Search::FarChange> changes;
    for (const One& one : each_) changes.push_back({one.start, one.stop, one.by.far_depth(samples, count)});
    return changes;
}

void LikelyNearFar::interpolate(const Samples& samples, const Helix& helix, Index group, Index vertex_count,
                                Search::Scratch& scratch, std::span<const std::span<const double>> channels,
                                std::span<double* const> out) const {
    const Index used = std::min(lanes, vertex_count - group * lanes);
    std::vector<double> values(channels.size() * static_cast<std::size_t>(lanes));
    std::vector<double*> columns;
    for (std::size_t c = 0; c < channels.size(); ++c) {
        columns.push_back(values.data() + c * static_cast<std::size_t>(lanes));
        std::fill_n(out[c], used, 0.0);
    }
    each_of(helix, group, [&](const One& one) {
        one.by.interpolate(samples, helix, group, vertex_count, scratch, channels, columns);
        for (Index i = 0; i < used; ++i)
            if (one.holds(helix.depth(group * lanes + i)))
                for (std::size_t c = 0; c < channels.size(); ++c) out[c][i] += one.share * columns[c][i];
    });
}

}  // namespace helibore
