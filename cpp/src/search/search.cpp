// The search around the kernel: lists the samples that a group may need, and repeats this with a larger box until the
// list holds all samples that matter.
#include "search/search.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>
#include <numbers>
#include <utility>

#include "search/kernel/instruction_set.hpp"
#include "search/near_far.hpp"

namespace helibore {
namespace {

constexpr Index lanes = kernel::lanes;
constexpr Index stride = 16;  // a box may hold up to this many samples beyond each of its two depths; they do no harm

}  // namespace

// The depths and toolfaces a group covers.
struct Search::Span {
    double shallow, deep;
    double half_width;  // toolface, degrees

    Span(const kernel::Group& g, const Helix& helix)
        : shallow(std::min(g.depth[0], g.depth[lanes - 1])),
          deep(std::max(g.depth[0], g.depth[lanes - 1])),
          half_width(half_width_of(helix)) {}

    static double half_width_of(const Helix& helix) {
        return 0.5 * static_cast<double>(lanes - 1) * 360.0 / static_cast<double>(helix.sectors);
    }
};

Search::Scratch::Scratch()
    : rows(std::make_unique_for_overwrite<kernel::Candidate[]>(kernel::list_capacity + 1)),
      across(std::make_unique_for_overwrite<float[]>(kernel::list_capacity + 17)),
      along(std::make_unique_for_overwrite<float[]>(kernel::list_capacity + 17)),
      room(std::make_unique_for_overwrite<kernel::Room>()),
      list{rows.get(), across.get(), along.get(), kernel::position_table(), kernel::narrow_position_table(),
           0,          room.get(),   nullptr},
      keep(kernel::list_capacity + 1) {
    rows[kernel::list_capacity] = {kernel::none_depth, 0.0, 0.0, 0};
}

// Fills the list with "none" up to the next multiple of sixteen.
void Search::Scratch::pad() {
    for (std::int64_t i = list.count; i % 16 != 0; ++i) list.rows[i] = {kernel::none_depth, 0.0, 0.0, 0};
}

kernel::Rules rules_of(const Settings& settings) {
    kernel::Rules rules;
    rules.neighbors = settings.neighbors;
    rules.max_iterations = settings.max_iterations;
    rules.tolerance = settings.tolerance;
    rules.power = settings.power;
    rules.range = settings.estimator == Estimator::kriging ? settings.kriging_range : 0.0;
    rules.nugget = settings.nugget;
    rules.sums = settings.sigma;
    const double stretch = settings.angular_scale * settings.angular_scale;
    rules.max_square = std::min(settings.max_distance * settings.max_distance, kernel::missing_square / 2);
    rules.reach_square = std::min(rules.max_square * std::max(stretch, 1.0), kernel::missing_square / 2);
    rules.sure_square = rules.max_square * std::min(stretch, 1.0) * (stretch == 1.0 ? 1.0 : 1.0 - 1e-12);
    rules.unscale = 1.0 / stretch;
    rules.scale = settings.angular_scale * std::numbers::pi / 180.0;
    rules.windowed = settings.window.has_value();
    return rules;
}

Search::Search(const Settings& settings)
    : settings_(settings), rules_(rules_of(settings)), functions_(&kernel::functions_for(settings.instruction_set)) {
    const Helix helix{0.0, settings.start_toolface, settings.pitch, settings.sectors};
    toolface_.resize(static_cast<std::size_t>(settings.sectors));
    for (Index k = 0; k < settings.sectors; ++k) toolface_[static_cast<std::size_t>(k)] = helix.toolface(k);
    if (settings.estimator == Estimator::near_and_far) near_far_ = std::make_shared<const LikelyNearFar>(settings);
}

kernel::Group Search::start(const Helix& helix, Index group, Index vertex_count) const {
    kernel::Group g;  // results are set by the kernel
    g.middle = 0.5 * (helix.depth(group * lanes) + helix.depth(group * lanes + lanes - 1));
    Index sector = (helix.first + group * lanes) % helix.sectors;
    g.center = wrap_toolface(toolface_[static_cast<std::size_t>(sector)] + Span::half_width_of(helix));
    for (Index i = 0; i < lanes; ++i) {
        const Index k = group * lanes + i;
        g.depth[i] = helix.depth(k);
        g.toolface[i] = toolface_[static_cast<std::size_t>(sector)];
        if (++sector == helix.sectors) sector = 0;
        g.active[i] = k < vertex_count ? 1.0 : 0.0;
    }
    std::ranges::fill(g.trial, settings_.bit_diameter / 2.0);
    for (double* column : {g.before, g.least_trial}) std::fill_n(column, lanes, kernel::boundless_square);
    for (double* column : {g.iterations, g.reach_square, g.height_square, g.least_turn, g.window_first, g.window_last})
        std::fill_n(column, lanes, 0.0);
    if (rules_.sums)
        for (double* column : {g.sums.square_weights, g.sums.scatter, g.sums.along, g.sums.across})
            std::fill_n(column, lanes, std::numeric_limits<double>::quiet_NaN());
    return g;
}

// Estimates the group. If the list in `scratch` is then the first of its group and was never shrunk, it holds the
// neighbours of every vertex at each of its trial radii. A later list holds only the neighbours of vertices that were
// not done.
kernel::Group Search::solve(const Samples& samples, const Helix& helix, Index group, Index vertex_count,
                            Scratch& scratch) const {
    if (rules_.range > 0.0 && !scratch.kriging) {
        scratch.kriging = std::make_unique_for_overwrite<kernel::KrigingRoom>();
        scratch.list.kriging = scratch.kriging.get();
    }
    kernel::Group g = start(helix, group, vertex_count);
    Windows& windows = scratch.windows;
    if (rules_.windowed) {
        find_windows(samples, g, std::min(lanes, vertex_count - group * lanes), windows);
    } else {
        windows.all = {0, samples.size()};
        windows.shallow = samples.size() == 0 ? 0.0 : samples.first_depth();
        windows.deep = samples.size() == 0 ? 0.0 : samples.last_depth();
    }
    scratch.least_trial = settings_.bit_diameter / 16.0;
    for (;;) {
        search_box(samples, Span(g, helix), rules_, g, scratch);
        const double least = *std::min_element(g.least_trial, g.least_trial + lanes);
        if (least >= scratch.least_trial) return g;
        scratch.least_trial = least / 16.0;  // rare: the radius of the wall is much less than that of the bit
        g = start(helix, group, vertex_count);
    }
}

// Makes a list that holds the neighbours of every vertex at these trial radii; returns the group that belongs to the
// list.
kernel::Group Search::list_at(const Samples& samples, const Helix& helix, Index group, Index vertex_count,
                              const double (&trial)[lanes], Scratch& scratch) const {
    kernel::Group g = start(helix, group, vertex_count);
    for (Index lane = 0; lane < lanes; ++lane)
        if (g.active[lane] > 0.0) g.trial[lane] = trial[lane];
    kernel::Rules once = rules_;
    once.max_iterations = 1;
    once.range = 0.0;
    once.sums = false;
    search_box(samples, Span(g, helix), once, g, scratch);
    return g;
}

void Search::run(const Samples& samples, const Helix& helix, Index group, Index vertex_count, Scratch& scratch,
                 GroupResult& result) const {
    if (near_far_) return near_far_->run(samples, helix, group, scratch, result);
    const kernel::Group g = solve(samples, helix, group, vertex_count, scratch);
    const Index used = std::min(lanes, vertex_count - group * lanes);
    double reach = 0.0;
    result.least_trial = no_limit;
    for (Index i = 0; i < used; ++i) {
        result.radius[i] = g.radius[i];
        result.nearest[i] = g.nearest[i];
        result.support[i] = static_cast<std::uint16_t>(g.support[i]);
        result.iterations[i] = static_cast<std::uint8_t>(g.iterations[i]);
        result.reach_square[i] = rules_.windowed ? kernel::boundless_square : g.reach_square[i] * (1.0 + 1e-9);
        result.least_trial = std::min(result.least_trial, g.least_trial[i]);
        reach = std::max(reach, std::min(g.reach_square[i], rules_.max_square));
    }
    if (rules_.sums) result.sums = g.sums;
    const Span span(g, helix);
    if (rules_.windowed)
        window_reach(samples, scratch.windows, span, result);
    else
        set_reach(span, reach, result);
    result.near_deep = result.deep;
}

std::vector<Search::FarChange> Search::far_changes(const Samples& samples, Index count) const {
    return near_far_ ? near_far_->far_changes(samples, count) : std::vector<FarChange>{};
}

// Sets the depths between which a sample can change a group, from the greatest squared distance at which one would. The
// distance is rounded up. If max_distance sets no limit, any sample may change a vertex that has too few neighbours.
void Search::set_reach(const Span& span, double square, GroupResult& result) const {
    const double reach = square < kernel::missing_square / 2 ? std::sqrt(square) * (1.0 + 1e-6) : no_limit;
    result.shallow = span.shallow - reach;
    result.deep = span.deep + reach;
}

kernel::Group Search::neighbours(const Samples& samples, const Helix& helix, Index group, Index vertex_count,
                                 Scratch& scratch, kernel::Candidate* found, GroupResult& result) const {
    scratch.list.found = found;
    const Index used = std::min(lanes, vertex_count - group * lanes);
    std::fill_n(found, lanes * rules_.neighbors, kernel::Candidate{kernel::none_depth, 0.0, 0.0, 0});
    const kernel::Group g = solve(samples, helix, group, vertex_count, scratch);
    double reach = 0.0;
    for (Index i = 0; i < used; ++i) reach = std::max(reach, std::min(g.reach_square[i], rules_.max_square));
    set_reach(Span(g, helix), reach, result);
    return g;
}

// Finds the ranks of the samples in the windows of a group's vertices.
void Search::find_windows(const Samples& samples, const kernel::Group& g, Index used, Windows& windows) const {
    const Index n = samples.size();
    windows.length = std::min(*settings_.window, n);
    for (Index i = 0; i < lanes; ++i) {
        windows.centered[i] =
            i < used ? samples.count_to(g.depth[i], windows.chunk) - *settings_.window / 2 : windows.centered[used - 1];
        windows.first[i] = std::clamp<Index>(windows.centered[i], 0, n - windows.length);
    }
    const auto [first, last] = std::minmax(windows.first[0], windows.first[lanes - 1]);
    windows.all = {first, last + windows.length};
    windows.shallow = n == 0 ? 0.0 : samples.depth(windows.all.start);
    windows.deep = n == 0 ? 0.0 : samples.depth(windows.all.stop - 1);
}

// Finds where the windows lie in the list. Returns the least number of candidates that an active vertex has.
Index Search::place_windows(const Windows& windows, const kernel::CandidateList& list, kernel::Group& g) const {
    if (!rules_.windowed) return list.count;
    Index least = list.count, first = 0, last = 0;
    const auto walk = [&](Index& at, Index rank) {
        while (at > 0 && list.rows[at - 1].rank >= rank) --at;
        while (at < list.count && list.rows[at].rank < rank) ++at;
        return static_cast<double>(at);
    };
    for (Index i = 0; i < lanes; ++i) {
        g.window_first[i] = walk(first, windows.first[i]);
        g.window_last[i] = walk(last, windows.first[i] + windows.length);
        if (g.active[i] > 0.0) least = std::min(least, last - first);
    }
    return least;
}

// Sets the depths between which a new sample can change a group with windows. A window changes if a new sample lies in
// it, or between the window and its vertex, or on a side where the window is cut short by the end of the samples.
void Search::window_reach(const Samples& samples, const Windows& windows, const Span& span, GroupResult& result) const {
    const Index n = samples.size();
    const auto [least, greatest] = std::minmax(windows.centered[0], windows.centered[lanes - 1]);
    const bool all = n < *settings_.window;
    result.shallow = all || least < 0 ? -no_limit : std::min(windows.shallow, span.shallow);
    result.deep = all || greatest + *settings_.window > n ? no_limit : std::max(windows.deep, span.deep);
}

void Search::search_box(const Samples& samples, const Span& span, const kernel::Rules& rules, kernel::Group& g,
                        Scratch& scratch) const {
    if (scratch.half_height == 0.0) scratch.half_height = first_guess(samples);
    const bool by_turns = scratch.mean_height > 0.0;  // if so, the box is low and covers all toolfaces
    const double half_height = by_turns ? std::sqrt(4.0 * scratch.mean_height) : scratch.half_height;
    const Windows& windows = scratch.windows;
    double area = 0.0;
    bool first = true;
    for (double growth = 1.0;;) {
        double least_trial = no_limit;
        for (Index i = 0; i < lanes; ++i)
            if (g.active[i] > 0.0) least_trial = std::min(least_trial, g.trial[i]);
        const double degree = least_trial * rules_.scale, width = by_turns ? 180.0 : growth * half_height / degree;
        const double height = std::min(growth * half_height, 1.001 * settings_.max_distance);
        const double low = span.shallow - height, high = span.deep + height;
        const auto holds_all = [&](double above) {
            return samples.size() == 0 ||
                   (span.shallow - above <= windows.shallow && span.deep + above >= windows.deep);
        };
        // `across` is finite even if the trial radius is so small that `degree` is 0.
        const double across = std::min(span.half_width + width + 1e-9, 360.0);
        const kernel::Filter filter{across, g.center - across < 0.0 || g.center + across >= 360.0};
        kernel::Box box{holds_all(height) ? no_limit : height,
                        across < 180.0 ? width : no_limit,
                        no_limit,
                        across,
                        0.5 * (high - low),
                        false,
                        across + span.half_width >= 180.0};
        if (by_turns) {
            const double far = std::min(growth * 1.3 * 180.0 * degree + height, 1.001 * settings_.max_distance);
            if (!holds_all(far)) box.far = far;
            find_turns(samples, span.shallow - far, span.deep + far, g);
        }
        scratch.first_list = std::exchange(first, false);
        fetch_box(samples, low, high, filter, box, g, scratch);
        const Index fewest = place_windows(windows, scratch.list, g);
        box.narrow = rules_.neighbors <= std::min<Index>(fewest, kernel::most_narrow) &&
                     scratch.list.count <= kernel::narrow_capacity && !by_turns;
        area = 4.0 * box.along * std::min(across, 180.0) * degree;
        const kernel::Verdict verdict = functions_->estimate(g, scratch.list, rules, box);
        if (verdict == kernel::Verdict::done) break;
        if (verdict == kernel::Verdict::widen) growth *= 1.5;
    }
    // Sizes the first box of the next group: if samples are spread evenly, few vertices need 2.4 times the mean area.
    const auto mean_of = [&](const double (&squares)[lanes]) {
        double sum = 0.0;
        for (const double square : squares) sum += std::min(square, rules_.max_square);
        return sum / lanes;
    };
    const double mean = mean_of(g.reach_square);
    if (!(mean < kernel::missing_square)) return;
    scratch.mean_square = scratch.mean_square == 0.0 ? mean : 0.75 * scratch.mean_square + 0.25 * mean;
    scratch.half_height = std::sqrt(2.4 * scratch.mean_square);
    // The box holds many more candidates than an even spread would: the samples may lie on few toolfaces.
    const auto crowded = [&] {
        const double even = rules_.neighbors * area / (std::numbers::pi * mean);
        return static_cast<double>(scratch.list.count) > 3.0 * even;
    };
    if (by_turns) {
        const double mean_height = mean_of(g.height_square);
        scratch.mean_height = mean_height < 0.5 * mean ? 0.5 * (scratch.mean_height + mean_height) : 0.0;
    } else if (--scratch.even < 0 && !rules_.windowed && scratch.level_depth == no_limit && crowded()) {
        scratch.mean_height = mean_across(g, scratch.list) > 0.5 * mean ? mean : 0.0;
        scratch.even = 15;
    }
}

// Returns the mean, over the vertices, of the squared distance around the hole to the nearest toolface in the list.
double Search::mean_across(const kernel::Group& g, const kernel::CandidateList& list) const {
    double mean = 0.0;
    for (Index lane = 0; lane < lanes; ++lane) {
        double least = 180.0;
        for (Index i = 0; i < list.count; ++i) {
            const double turn = std::abs(list.rows[i].toolface - g.toolface[lane]);
            least = std::min({least, turn, 360.0 - turn});
        }
        const double across = rules_.scale * g.trial[lane] * least;
        mean += across * across / lanes;
    }
    return mean;
}

// Sets g.least_turn: a lower bound of the angle from each vertex to any sample between two depths, from whole chunks.
void Search::find_turns(const Samples& samples, double low, double high, kernel::Group& g) const {
    std::fill_n(g.least_turn, lanes, 180.0);
    for (std::size_t i = samples.step_to(low, {}, stride).chunk; i < samples.chunks().size(); ++i) {
        const Chunk& chunk = *samples.chunks()[i];
        if (chunk.first_depth() > high) break;
        for (Index lane = 0; lane < lanes; ++lane)
            g.least_turn[lane] = std::min(g.least_turn[lane], chunk.circle().least_turn(g.toolface[lane]));
    }
}

// Returns the distance within which a vertex would find its neighbours if the samples were spread evenly.
double Search::first_guess(const Samples& samples) const {
    const double n = static_cast<double>(std::max<Index>(samples.size(), 1));
    const double length = samples.size() == 0 ? 0.0 : samples.last_depth() - samples.first_depth();
    const double around = std::numbers::pi * settings_.bit_diameter * settings_.angular_scale;
    const double area_a_sample = std::max(length, settings_.bit_diameter) * around / n;
    const double guess = 1.2 * std::sqrt(settings_.neighbors * area_a_sample / std::numbers::pi);
    return std::min(guess, 1.001 * settings_.max_distance);
}

void Search::fetch_box(const Samples& samples, double low, double high, const kernel::Filter& filter,
                       const kernel::Box& box, kernel::Group& g, Scratch& scratch) const {
    scratch.list.count = 0;
    scratch.level_depth = no_limit;
    std::fill_n(g.discarded, lanes, kernel::boundless_square);
    const Windows& windows = scratch.windows;
    scratch.place = samples.step_to(low, scratch.place, stride);
    Samples::Place place = scratch.place;
    for (; place.chunk < samples.chunks().size(); ++place.chunk, place.offset = 0) {
        const Chunk& chunk = *samples.chunks()[place.chunk];
        Index stop = chunk.last_depth() <= high ? chunk.count : place.offset;
        while (stop < chunk.count && chunk.depth()[stop] <= high) stop += stride;
        stop = std::min(stop, chunk.count);
        const Index rank = samples.rank({place.chunk, 0});
        Index from = std::max(place.offset, windows.all.start - rank);
        if (!rules_.windowed && chunk.has_level(from, stop))
            for (const Level& level : chunk.levels(rules_.neighbors)) {
                if (level.first < from || level.last > stop) continue;
                gather(chunk, from, level.first, rank + from, filter, box, g, scratch);
                gather_level(chunk, level, rank, box, g, scratch);
                from = level.last;
            }
        gather(chunk, from, std::min(stop, windows.all.stop - rank), rank + from, filter, box, g, scratch);
        if (stop < chunk.count) break;
    }
    scratch.pad();
}

// Adds rows [start, stop) of a chunk to the list; `rank` is the rank of row `start`. When the list is full, all but the
// nearest so far are removed.
void Search::gather(const Chunk& chunk, Index start, Index stop, Index rank, const kernel::Filter& filter,
                    const kernel::Box& box, kernel::Group& g, Scratch& scratch) const {
    while (start < stop) {
        const Index read = functions_->gather(scratch.list, g, chunk.depth() + start, chunk.toolface() + start,
                                              chunk.radius() + start, stop - start, rank, filter);
        start += read;
        rank += read;
        if (start < stop) shrink(box, g, scratch);
    }
}

// Adds to the list the samples of a level that a vertex may need. Of the samples at one depth, a vertex needs only the
// V nearest in toolface, whatever its radius, because a larger angle gives a larger distance. Samples at angles so
// close that distances may tie are also listed if they lie in one chunk; in a tie, the sample of the later chunk loses.
void Search::gather_level(const Chunk& chunk, const Level& level, Index rank, const kernel::Box& box, kernel::Group& g,
                          Scratch& scratch) const {
    const auto wanted = static_cast<std::size_t>(rules_.neighbors);
    if (level.depth != scratch.level_depth) scratch.turns.assign(lanes * wanted, no_limit);
    scratch.level_depth = level.depth;
    const auto turns_of = [&](Index lane) { return scratch.turns.data() + static_cast<std::size_t>(lane) * wanted; };
    const auto limit_of = [&](Index lane) { return std::min(box.width, turns_of(lane)[wanted - 1] * (1.0 + 1e-9)); };
    unsigned concerned = 0;  // a bit for each vertex; in a loop of its own, so that its reads of memory overlap
    for (Index lane = 0; lane < lanes; ++lane)
        concerned |= unsigned{level.any_between(g.toolface[lane] - limit_of(lane), g.toolface[lane] + limit_of(lane))}
                     << lane;
    if (concerned == 0) return;
    std::uint64_t listed[Chunk::full / 64] = {};  // a bit for each row
    const auto n = static_cast<std::ptrdiff_t>(level.row.size());
    for (Index lane = 0; lane < lanes; ++lane) {
        if ((concerned >> lane & 1) == 0) continue;
        double* turns = turns_of(lane);
        double& farthest = turns[wanted - 1];
        const double before = farthest, toolface = g.toolface[lane], limit = limit_of(lane);
        const double along = (level.depth - g.depth[lane]) / (scratch.least_trial * rules_.scale);
        const double tied = 0x1p-38 * along * along;
        // Lists an entry that lies on the given side. Returns false if the entries behind it are not needed.
        const auto list = [&](std::ptrdiff_t i, bool growing) {
            const double difference = level.toolface[static_cast<std::size_t>(i)] - toolface;
            if ((difference < 0.0 ? difference <= -180.0 : difference < 180.0) != growing) return false;
            const double turn = std::min(std::abs(difference), 360.0 - std::abs(difference));
            if (turn > limit || turn * turn > farthest * farthest * (1.0 + 0x1p-38) + tied) return false;
            if (turn >= before) return true;
            const std::uint16_t row = level.row[static_cast<std::size_t>(i)];
            listed[row / 64] |= std::uint64_t{1} << row % 64;
            if (turn < farthest) {
                double* at = &farthest;
                for (; at > turns && at[-1] > turn; --at) *at = at[-1];
                *at = turn;
            }
            return true;
        };
        const std::ptrdiff_t start = level.position(toolface);
        for (std::ptrdiff_t i = 0; i < n && list(start + i < n ? start + i : start + i - n, true); ++i) {
        }
        for (std::ptrdiff_t i = 1; i <= n && list(start >= i ? start - i : start - i + n, false); ++i) {
        }
    }
    for (Index word = 0; word < Chunk::full / 64; ++word)
        for (std::uint64_t bits = listed[word]; bits != 0; bits &= bits - 1) {
            const Index row = 64 * word + std::countr_zero(bits);
            if (scratch.list.count == kernel::list_capacity) shrink(box, g, scratch);
            scratch.list.rows[scratch.list.count++] = {chunk.depth()[row], chunk.toolface()[row], chunk.radius()[row],
                                                       rank + row};
        }
}

void Search::shrink(const kernel::Box& box, kernel::Group& g, Scratch& scratch) const {
    scratch.first_list = false;
    scratch.pad();
    place_windows(scratch.windows, scratch.list, g);
    std::fill(scratch.keep.begin(), scratch.keep.end(), static_cast<unsigned char>(0));
    functions_->nominate(g, scratch.list, rules_, box, scratch.keep.data());
    kernel::CandidateList& list = scratch.list;
    std::int64_t kept = 0;
    for (std::int64_t i = 0; i < list.count; ++i) {
        if (!scratch.keep[static_cast<std::size_t>(i)]) continue;
        list.rows[kept++] = list.rows[i];
    }
    list.count = kept;
}

}  // namespace helibore
