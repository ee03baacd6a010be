// The class Wall: it keeps samples and vertices, takes new samples, and returns which vertices changed.
//
// An append sorts the batch, inserts it, finds the groups of vertices that it can change (GroupResult::shallow and deep
// bound the samples that each depends on), searches those again, compares the results with the old values, and only
// then writes them. All steps that can throw come before the writing; if one throws, the insertion is undone.
#include "helibore/wall.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <numbers>
#include <utility>

#include "base/arithmetic.hpp"
#include "base/messages.hpp"
#include "base/ranges.hpp"
#include "base/threads.hpp"
#include "helibore/error.hpp"
#include "wall/state.hpp"

namespace helibore {
namespace {

// The least number of groups for a thread; fewer are not worth the start of a thread.
constexpr Index groups_a_thread = 256;

// The most samples of a batch whose cells are looked at.
constexpr Index most_looked_at = 1024;

// Returns the index of the first of values[from, to) that is `good`, or `to`. Every append looks through the last
// block, so the function takes sixteen values at a time, which the compiler compares as vectors.
template <class Good>
Index first_that(const double* values, Index from, Index to, const Good& good) {
    for (; from + 16 <= to; from += 16) {
        bool any = false;
        for (Index i = 0; i < 16; ++i) any |= good(values[from + i]);
        if (any) break;
    }
    while (from < to && !good(values[from])) ++from;
    return from;
}

// Returns the number of the last block. Every append looks through it, so its hull is not measured while it grows.
Index growing_block(Index vertex_count) {
    return Vertices::blocks_of(vertex_count) - 1;
}

}  // namespace

Change Wall::State::append(const SampleColumns& columns) {
    const std::lock_guard held(lock);
    const StandardArithmetic standard;
    SortedBatch batch = sort_batch(columns, samples, settings.threads, search.functions());
    if (batch.count > 0 && samples.size() > 0 && batch.timed != samples.timed())
        throw InputError("time", batch.timed ? "earlier samples have none; give it for all or none"
                                             : "missing, but earlier samples have one; give it for all or none");
    Samples::Undo undo = samples.insert(batch);
    try {
        return update(batch);
    } catch (...) {
        samples.undo(std::move(undo));
        throw;
    }
}

// Returns the helix for the present samples. It starts at start_depth, or at the first sample along the helix; at 0 if
// this depth is -0.
Helix Wall::State::helix_now() const {
    const bool down = settings.pitch > 0.0;
    const double start = settings.start_depth.value_or(down ? samples.first_depth() : samples.last_depth());
    return {start + 0.0, settings.start_toolface, settings.pitch, settings.sectors, settings.first_vertex};
}

Index Wall::State::count_now(const Helix& next) const {
    const bool down = settings.pitch > 0.0;
    const double stop = settings.stop_depth.value_or(down ? samples.last_depth() : samples.first_depth());
    const double vertices_needed =
        settings.stop_vertex ? static_cast<double>(*settings.stop_vertex - next.first) : next.count(stop);
    if (vertices_needed <= static_cast<double>(settings.most_vertices)) return static_cast<Index>(vertices_needed);
    // The error names the end of the wall that comes from a sample, not from a setting. If both ends come from samples,
    // it names the end farther from the median sample, because that depth is more likely wrong.
    const double median = samples.depth(samples.size() / 2), start = next.start_depth;
    const bool at_start =
        !settings.start_depth && (settings.stop_depth || std::abs(start - median) > std::abs(stop - median));
    throw InputError(settings.start_depth && settings.stop_depth ? "stop_depth" : "depth",
                     "the wall from " + number_text(start) + " m to " + number_text(stop) + " m would have " +
                         number_text(vertices_needed) +
                         " vertices; must be at most most_vertices = " + std::to_string(settings.most_vertices),
                     number_text(at_start ? start : stop));
}

// Recomputes what the inserted batch can change, and stores it; returns the change. A wall has no vertices before its
// first sample.
Change Wall::State::update(const SortedBatch& batch) {
    if (samples.size() == 0) return {};
    if (!settings.window) samples.prepare_levels(settings.neighbors);
    const Helix next = helix_now();
    const Index new_count = count_now(next);
    const bool moved = count > 0 && next.start_depth != helix.start_depth;
    const Index kept = moved ? 0 : count;                                // vertices that may keep their values
    const Index open = !moved && advances(batch) ? settled / lanes : 0;  // the first group that can change

    Vertices moved_vertices(settings.sigma);
    Vertices& into = moved ? moved_vertices : vertices;
    into.grow(new_count, kept);
    std::vector<Index> old = moved ? std::vector<Index>{} : touched_groups(batch, open);
    if (kept % lanes != 0 && new_count > kept && (old.empty() || old.back() != kept / lanes))
        old.push_back(kept / lanes);  // the last group gains vertices
    const Range fresh{groups_of(kept), groups_of(new_count)};
    std::vector<GroupResult> staged(old.size());
    search_groups(next, old, fresh, new_count, into, staged);
    for (Index b = Vertices::blocks_of(kept); b < growing_block(new_count); ++b) into.measure_hull(b);

    Change change;
    change.accepted = batch.count;
    change.redundant = batch.redundant;
    change.settled = settled_after(next, into, open, new_count, old, staged);
    DirectRadii next_direct;
    if (settings.direct) next_direct = direct_radii(samples, next, {change.settled, new_count});
    change.ranges = compare(old, staged, new_count, next_direct);
    if (settings.direct)
        change.ranges = union_of(concatenated(change.ranges, direct_changes(direct, next_direct, kept)));
    change.ranges.reserve(change.ranges.size() + 1);
    add_range(change.ranges, {kept, std::max(kept, new_count)});

    // Nothing below throws.
    if (moved) std::swap(vertices, moved_vertices);
    for (std::size_t i = 0; i < old.size(); ++i) vertices.put(old[i], new_count, staged[i]);
    helix = next;
    count = new_count;
    settled = change.settled;
    far_end = next.pitch > 0.0 ? samples.last_depth() : samples.first_depth();
    std::swap(direct, next_direct);
    measure_hulls(old, kept);
    return change;
}

// Measures the hulls of old blocks that have new values, or have become full.
void Wall::State::measure_hulls(const std::vector<Index>& old, Index kept) {
    Index measured = -1;
    const auto measure = [&](Index b) {
        if (b < growing_block(count) && b != std::exchange(measured, b)) vertices.measure_hull(b);
    };
    for (const Index group : old) measure(group / Vertices::groups_per_block);
    if (kept > 0) measure(growing_block(kept));
}

// Returns whether the batch lies at the far end of the hole or beyond it. If so, settled vertices do not change and are
// not looked at, so an append takes no longer in a long hole.
bool Wall::State::advances(const SortedBatch& batch) const {
    return batch.count == 0 || (settings.pitch > 0.0 ? batch.first_depth() >= far_end : batch.last_depth() <= far_end);
}

// Returns whether a sample of the batch is near enough to a vertex of the group to change it. While the tool turns at
// one depth, a sample changes no vertex if enough earlier samples have the same toolface.
bool Wall::State::reaches(const SortedBatch& batch, Index group) const {
    const Vertices::Block& block = vertices.block(group / Vertices::groups_per_block);
    const auto g = static_cast<std::size_t>(group % Vertices::groups_per_block);
    const double scale = settings.angular_scale * std::numbers::pi / 180.0 * block.least_trial[g];
    double depth[lanes], toolface[lanes], reach_square[lanes];
    for (Index lane = 0; lane < lanes; ++lane) {
        const Index k = group * lanes + lane;
        depth[lane] = helix.depth(k);
        toolface[lane] = helix.toolface(k);
        reach_square[lane] = k < count ? block.reach_square[static_cast<std::size_t>(k % Vertices::block_size)] : -1.0;
    }
    const double level = batch.before > 0 && !settings.window ? samples.depth(batch.before - 1) : no_limit;
    return batch.any_within(block.shallow[g], block.deep[g], [&](double at_depth, double at_toolface) {
        bool any = false;
        for (Index lane = 0; lane < lanes; ++lane) {
            const double turn = std::abs(at_toolface - toolface[lane]), along = at_depth - depth[lane];
            const double across = scale * std::min(turn, 360.0 - turn);
            any |= across * across + along * along <= reach_square[lane];
        }
        return any && !(at_depth == level && samples.repeats(at_depth, at_toolface, settings.neighbors, batch.before));
    });
}

// Returns, in order, the groups from `open` on whose values some sample of the batch can change.
std::vector<Index> Wall::State::touched_groups(const SortedBatch& batch, Index open) const {
    std::vector<Index> touched;
    if (batch.count == 0) return touched;
    const Index groups = groups_of(count);
    const bool beyond = settings.pitch > 0.0 && batch.count <= most_looked_at && batch.first_depth() > far_end;
    const auto from_afar = beyond ? search.far_changes(samples, batch.count) : std::vector<Search::FarChange>{};
    const auto too_far = [&](Index group, double near_deep) {
        if (!beyond || near_deep >= batch.first_depth()) return false;
        const double top = helix.depth(group * lanes), bottom = helix.depth(group * lanes + lanes - 1);
        return std::ranges::none_of(from_afar, [&](const Search::FarChange& change) {
            return near_deep >= change.depth && change.start <= bottom && top < change.stop;
        });
    };
    for (Index b = open / Vertices::groups_per_block; b * Vertices::groups_per_block < groups; ++b) {
        const Vertices::Hull& hull = vertices.hull(b);
        if (hull.deep < batch.first_depth() || hull.shallow > batch.last_depth()) continue;
        const Vertices::Block& block = vertices.block(b);
        const Index first = b * Vertices::groups_per_block;
        const Index n = std::min(Vertices::groups_per_block, groups - first);
        const auto deep_enough = [top = batch.first_depth()](double deep) { return deep >= top; };
        for (Index g = std::max<Index>(open - first, 0); (g = first_that(block.deep.data(), g, n, deep_enough)) < n;
             ++g) {
            const auto i = static_cast<std::size_t>(g);
            if (block.shallow[i] <= batch.last_depth() && !too_far(first + g, block.near_deep[i]) &&
                reaches(batch, first + g))
                touched.push_back(first + g);
        }
    }
    return touched;
}

// Writes the results of old groups to `staged`, and those of new groups to their place, which is not read before
// `count` includes it.
void Wall::State::search_groups(const Helix& on, const std::vector<Index>& old, Range fresh, Index vertex_count,
                                Vertices& into, std::vector<GroupResult>& staged) {
    const auto old_count = static_cast<Index>(old.size());
    const Index total = old_count + fresh.stop - fresh.start;
    const int threads = threads_for(total, groups_a_thread, settings.threads);
    for_each_range(threads, total, groups_a_part, [&](int worker, const Range& part) {
        Search::Scratch& scratch = scratches[static_cast<std::size_t>(worker)];
        GroupResult result;
        for (Index i = part.start; i < part.stop; ++i) {
            const auto at = static_cast<std::size_t>(i);
            if (i < old_count) {
                search.run(samples, on, old[at], vertex_count, scratch, staged[at]);
            } else {
                const Index group = fresh.start + i - old_count;
                search.run(samples, on, group, vertex_count, scratch, result);
                into.put(group, vertex_count, result);
            }
        }
    });
}

// Returns the vertices of searched groups whose new values differ in any bit from their present values.
std::vector<Range> Wall::State::compare(const std::vector<Index>& groups, const std::vector<GroupResult>& staged,
                                        Index new_count, const DirectRadii& next_direct) const {
    const auto bits = [](double x) { return std::bit_cast<std::uint64_t>(x); };
    std::vector<Range> ranges;
    for (std::size_t i = 0; i < groups.size(); ++i) {
        const Vertices::Block& block = vertices.block(groups[i] / Vertices::groups_per_block);
        const GroupResult& now = staged[i];
        for (Index lane = 0; lane < lanes && groups[i] * lanes + lane < std::min(count, new_count); ++lane) {
            const Index k = groups[i] * lanes + lane;
            const auto at = static_cast<std::size_t>(k % Vertices::block_size);
            const double shown = direct.shown(k, block.radius[at]), next = next_direct.shown(k, now.radius[lane]);
            const bool same = bits(next) == bits(shown) && bits(now.nearest[lane]) == bits(block.nearest[at]) &&
                              now.support[lane] == block.support[at] && now.iterations[lane] == block.iterations[at];
            if (!same) add_range(ranges, {k, k + 1});
        }
    }
    return ranges;
}

// Returns the first vertex, from group `from` on, that a sample at the far end of the hole or beyond could still
// change. For the groups of `old`, the bounds in `staged` count.
Index Wall::State::settled_after(const Helix& on, const Vertices& of, Index from, Index vertex_count,
                                 const std::vector<Index>& old, const std::vector<GroupResult>& staged) const {
    const bool down = on.pitch > 0.0;
    const double end = down ? samples.last_depth() : samples.first_depth();
    const auto open = [&](double bound) { return down ? bound >= end : bound <= end; };
    const auto bound = [&](const auto& depths) { return down ? depths.deep : depths.shallow; };
    const Index groups = groups_of(vertex_count);
    std::size_t next = 0;  // index of the next staged group
    for (Index b = from / Vertices::groups_per_block; b * Vertices::groups_per_block < groups; ++b) {
        const Index first = b * Vertices::groups_per_block, last = std::min(groups, first + Vertices::groups_per_block);
        const bool as_measured = next == old.size() || old[next] >= last;
        if (as_measured && !open(bound(of.hull(b)))) continue;
        const double* bounds = down ? of.block(b).deep.data() : of.block(b).shallow.data();
        for (Index g = std::max(first, from); g < last; ++g) {
            const Index stop = next < old.size() ? std::min(old[next], last) : last;
            g = first + first_that(bounds, g - first, stop - first, open);
            if (g < stop) return g * lanes;
            if (g < last && open(bound(staged[next++]))) return g * lanes;
        }
    }
    // An incomplete last group may gain vertices and then depend on more samples, unless the wall ends there.
    return settings.stop_depth || settings.stop_vertex ? vertex_count : vertex_count / lanes * lanes;
}

Wall::Wall(const Settings& settings)
    : state_([&] {
          const StandardArithmetic standard;
          return std::make_unique<State>(settings);
      }()) {}
Wall::~Wall() = default;
Wall::Wall(Wall&&) noexcept = default;
Wall& Wall::operator=(Wall&&) noexcept = default;

const Settings& Wall::settings() const {
    return state_->settings;
}
Change Wall::append(const SampleColumns& samples) {
    Change change = state_->append(samples);
    const Index first = settings().first_vertex;
    for (Range& range : change.ranges) range = {range.start + first, range.stop + first};
    change.settled += first;
    return change;
}

}  // namespace helibore
