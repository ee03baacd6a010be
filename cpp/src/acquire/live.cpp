// Passes samples to the wall, stations to the path and rows to the images, and collects what changed between two polls.
#include "helibore/live.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <new>
#include <numeric>
#include <utility>

#include "base/arithmetic.hpp"
#include "base/locks.hpp"
#include "base/messages.hpp"
#include "base/ranges.hpp"

namespace helibore {

namespace {

constexpr std::size_t most_events = 100;

// Returns Update::most_ranges ranges that contain the given ranges. It closes the narrowest gaps; of equal gaps, the
// last.
std::vector<Range> widened(const std::vector<Range>& ranges) {
    std::vector<std::size_t> gaps(ranges.size() - 1);  // gap i lies before range i + 1
    std::iota(gaps.begin(), gaps.end(), std::size_t{0});
    const auto wider = [&](std::size_t a, std::size_t b) {
        return ranges[a + 1].start - ranges[a].stop > ranges[b + 1].start - ranges[b].stop;
    };
    std::stable_sort(gaps.begin(), gaps.end(), wider);
    gaps.resize(Update::most_ranges - 1);
    std::sort(gaps.begin(), gaps.end());
    std::vector<Range> found;
    Index start = ranges.front().start;
    for (const std::size_t gap : gaps) {
        found.push_back({start, ranges[gap].stop});
        start = ranges[gap + 1].start;
    }
    found.push_back({start, ranges.back().stop});
    return found;
}

// Returns the union of ranges, widened so that there are Update::most_ranges ranges at most.
std::vector<Range> bounded_union(std::vector<Range> ranges) {
    std::vector<Range> found = union_of(std::move(ranges));
    return found.size() <= Update::most_ranges ? found : widened(found);
}

void join(Update& all, const Update& more) {
    if (more.change && all.change) {
        all.change =
            Change{bounded_union(concatenated(all.change->ranges, more.change->ranges)), more.change->settled,
                   all.change->accepted + more.change->accepted, all.change->redundant + more.change->redundant};
    } else if (more.change) {
        all.change = more.change;
    }
    if (more.path_from) all.path_from = std::min(*more.path_from, all.path_from.value_or(*more.path_from));
    for (const auto& [name, rows] : more.images) {
        const auto [place, is_new] = all.images.try_emplace(name, rows);
        if (!is_new) place->second.stop = rows.stop;
    }
    for (const std::string& text : more.events)
        if (all.events.size() < most_events) all.events.push_back(text);
}

Settings with_a_start(const Settings& settings) {
    if (!settings.start_depth)
        throw InputError("start_depth", "must be set: the vertices of a live wall keep their numbers");
    return settings;
}

}  // namespace

struct Live::State {
    CallLock lock{"live well"};
    Wall wall;
    Stations stations;                          // builds the path only when path() is called
    std::map<std::string, ImageArrays> images;  // rows in order of arrival
    Update pending;                             // what changed since the last poll

    explicit State(const LiveSettings& settings) : wall(with_a_start(settings.wall)), stations(settings.path) {}

    const ImageArrays& arrived(const std::string& name) const {
        const auto place = images.find(name);
        if (place == images.end()) throw InputError("image '" + name + "'", "is not there");
        return place->second;
    }
};

std::vector<Range> Update::quads(int sectors) const {
    require_sectors(sectors);
    if (!change) return {};
    std::vector<Range> ranges = change->ranges;
    for (Range& range : ranges) range.start = std::max<Index>(range.start - sectors - 1, 0);
    return bounded_union(std::move(ranges));
}

Live::Live(const LiveSettings& settings) : state_(std::make_unique<State>(settings)) {}
Live::~Live() = default;
Live::Live(Live&&) noexcept = default;
Live& Live::operator=(Live&&) noexcept = default;

const Wall& Live::wall() const {
    return state_->wall;
}

Update Live::append_samples(const SampleColumns& samples) {
    const std::lock_guard held(state_->lock);
    std::vector<Range> all(1);  // used if memory runs out while the ranges of several appends are listed
    Update update;
    update.change = state_->wall.append(samples);
    try {
        join(state_->pending, update);
    } catch (const std::bad_alloc&) {
        all[0] = {0, state_->wall.size()};
        Change& pending = state_->pending.change ? *state_->pending.change : state_->pending.change.emplace();
        pending.ranges = std::move(all);
        pending.settled = update.change->settled;
        pending.accepted += update.change->accepted;
        pending.redundant += update.change->redundant;
    }
    return update;
}

Update Live::append_stations(std::span<const double> depth, std::span<const double> inclination,
                             std::span<const double> azimuth) {
    const std::lock_guard held(state_->lock);
    Stations::Taken taken = state_->stations.take(depth, inclination, azimuth);
    Update update;
    update.path_from = taken.path_from;
    update.events = std::move(taken.refused);
    try {
        join(state_->pending, update);
    } catch (const std::bad_alloc&) {  // join() has stored path_from before, so only events are lost
    }
    return update;
}

Update Live::append_image(const std::string& name, std::span<const double> depth, std::span<const double> values,
                          const std::string& unit) {
    const StandardArithmetic standard;
    if (depth.empty() ? !values.empty() : values.empty() || values.size() % depth.size() != 0)
        throw InputError(
            "values has " + std::to_string(values.size()) + " values, depth has " + std::to_string(depth.size()),
            "each depth must have equally many values");
    if (depth.empty()) return {};
    const std::size_t width = values.size() / depth.size();
    require(width <= 1000000, "sectors", static_cast<Index>(width), "must be at most 1000000");
    const int sectors = static_cast<int>(width);
    const std::lock_guard held(state_->lock);
    const auto [place, is_new] = state_->images.try_emplace(name, ImageArrays{{}, {}, sectors, unit});
    ImageArrays& rows = place->second;
    if (rows.sectors != sectors)
        throw InputError("values has " + std::to_string(sectors) + " sectors",
                         "image '" + name + "' has " + std::to_string(rows.sectors));
    const std::size_t had = rows.depth.size(), had_values = rows.values.size();
    const auto start = static_cast<Index>(had);
    try {
        rows.values.insert(rows.values.end(), values.begin(), values.end());
        rows.depth.insert(rows.depth.end(), depth.begin(), depth.end());
        require_depths(std::span(rows.depth).subspan(had));
        Update update;
        update.images[name] = {start, static_cast<Index>(rows.depth.size())};
        join(state_->pending, update);
        return update;
    } catch (...) {
        rows.values.resize(had_values);
        rows.depth.resize(had);
        if (is_new) state_->images.erase(place);
        throw;
    }
}

Update Live::poll() {
    const std::lock_guard held(state_->lock);
    return std::exchange(state_->pending, {});
}

std::optional<Survey> Live::survey() const {
    const std::lock_guard held(state_->lock);
    return state_->stations.survey();
}

std::optional<Path> Live::path() const {
    const std::lock_guard held(state_->lock);
    return state_->stations.path();
}

std::vector<std::string> Live::images() const {
    const std::lock_guard held(state_->lock);
    std::vector<std::string> names;
    for (const auto& [name, rows] : state_->images) names.push_back(name);
    return names;
}

ImageArrays Live::rows(const std::string& name, Range some) const {
    const std::lock_guard held(state_->lock);
    const ImageArrays& rows = state_->arrived(name);
    const auto count = static_cast<Index>(rows.depth.size());
    if (some.start < 0 || some.start > some.stop || some.stop > count)
        throw InputError("rows", "must lie within the " + std::to_string(count) + " rows of image '" + name + "'",
                         range_text(some));
    const auto depth = rows.depth.begin(), values = rows.values.begin();
    return {{depth + some.start, depth + some.stop},
            {values + some.start * rows.sectors, values + some.stop * rows.sectors},
            rows.sectors,
            rows.unit};
}

ImageArrays Live::image(const std::string& name) const {
    const StandardArithmetic standard;
    const std::lock_guard held(state_->lock);
    const ImageArrays& rows = state_->arrived(name);
    std::vector<std::size_t> order(rows.depth.size());
    std::iota(order.begin(), order.end(), std::size_t{0});
    std::stable_sort(order.begin(), order.end(),
                     [&](std::size_t a, std::size_t b) { return rows.depth[a] < rows.depth[b]; });
    ImageArrays image{{}, {}, rows.sectors, rows.unit};
    for (std::size_t i = 0; i < order.size(); ++i) {
        if (i + 1 < order.size() && !(rows.depth[order[i]] < rows.depth[order[i + 1]]))
            continue;  // a later row at the same depth follows
        image.depth.push_back(rows.depth[order[i]]);
        const auto first = rows.values.begin() + static_cast<Index>(order[i]) * rows.sectors;
        image.values.insert(image.values.end(), first, first + rows.sectors);
    }
    return image;
}

}  // namespace helibore
