// Passes samples to the wall, stations to the path and rows to the images, and collects what changed between two polls.
#include "helibore/live.hpp"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <iterator>
#include <numeric>
#include <utility>

#include "base/messages.hpp"
#include "base/ranges.hpp"

namespace helibore {

namespace {

constexpr std::size_t most_events = 100;

// Closes the narrowest gaps between ranges, of equal gaps the deepest, so that most_ranges are left.
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

// The union of ranges, widened so that there are most_ranges at most.
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
    for (const auto& [name, rows] : more.images) {
        const auto [place, is_new] = all.images.try_emplace(name, rows);
        if (!is_new) place->second.stop = rows.stop;
    }
    if (more.path_from) all.path_from = std::min(*more.path_from, all.path_from.value_or(*more.path_from));
    for (const std::string& text : more.events)
        if (all.events.size() < most_events) all.events.push_back(text);
}

// Six digits, as with Python's :g. The host's locale and the sign of a NaN do not show.
std::string short_text(double value) {
    if (std::isnan(value)) return "nan";
    char text[32];
    return {text, std::to_chars(text, text + sizeof text, value, std::chars_format::general, 6).ptr};
}

Settings with_a_start(const Settings& settings) {
    if (!settings.start_depth)
        throw InputError("start_depth", "must be set: the vertices of a live wall keep their numbers");
    return settings;
}

}  // namespace

std::vector<Range> Update::quads(int sectors) const {
    if (!change) return {};
    std::vector<Range> ranges = change->ranges;
    for (Range& range : ranges) range.start = std::max<Index>(range.start - sectors - 1, 0);
    return bounded_union(std::move(ranges));
}

Live::Live(const LiveSettings& settings) : path_settings_(settings.path), wall_(with_a_start(settings.wall)) {
    const double two[] = {0.0, 1.0};
    const double straight[] = {0.0, 0.0};
    static_cast<void>(Path(Survey(two, straight, straight), path_settings_));  // throws on bad settings
}

Update Live::append_samples(const SampleColumns& samples) {
    const std::lock_guard guard(lock_);
    Update update;
    update.change = wall_.append(samples);
    return report(std::move(update));
}

Update Live::append_stations(std::span<const double> depth, std::span<const double> inclination,
                             std::span<const double> azimuth) {
    require_length("inclination", inclination.size(), depth.size());
    require_length("azimuth", azimuth.size(), depth.size());
    const std::lock_guard guard(lock_);
    Update update;
    // All at once; if that fails, one by one, so that each bad station is reported and the others are taken.
    try {
        take_stations(depth, inclination, azimuth, update);
    } catch (const InputError&) {
        for (std::size_t i = 0; i < depth.size(); ++i) {
            try {
                take_stations(depth.subspan(i, 1), inclination.subspan(i, 1), azimuth.subspan(i, 1), update);
            } catch (const InputError& error) {
                update.events.push_back("station at " + short_text(depth[i]) + " m: " + error.what());
            }
        }
    }
    return report(std::move(update));
}

// Takes stations if a survey and a path can be made with them; otherwise throws and changes nothing.
void Live::take_stations(std::span<const double> depth, std::span<const double> inclination,
                         std::span<const double> azimuth, Update& update) {
    auto stations = stations_;
    std::optional<double> first;  // the first depth with a new or different station
    for (std::size_t i = 0; i < depth.size(); ++i) {
        if (!std::isfinite(depth[i])) throw InputError("depth", "must be finite");
        const std::array<double, 2> row = {inclination[i], azimuth[i]};
        const auto [place, is_new] = stations.try_emplace(depth[i], row);
        if (!is_new && place->second == row) continue;
        place->second = row;
        first = std::min(depth[i], first.value_or(depth[i]));
    }
    if (!first) return;
    if (stations.size() > 1) {
        std::vector<double> columns[3];
        for (const auto& [at, angles] : stations) {
            columns[0].push_back(at);
            columns[1].push_back(angles[0]);
            columns[2].push_back(angles[1]);
        }
        Survey survey(columns[0], columns[1], columns[2]);
        Path path(survey, path_settings_);
        path_ = std::move(path);
        survey_ = std::move(survey);
    } else if (const auto [dip, way] = stations.begin()->second; !(dip >= 0 && dip <= 180 && std::abs(way) <= 360)) {
        throw InputError("inclination " + short_text(dip) + ", azimuth " + short_text(way),
                         "must be in [0, 180], [-360, 360]");
    }
    stations_ = std::move(stations);
    const auto at = stations_.find(*first);
    const double above = at == stations_.begin() ? *first : std::prev(at)->first;
    update.path_from = std::min(above, update.path_from.value_or(above));
}

Update Live::append_image(const std::string& name, std::span<const double> depth, std::span<const double> values,
                          const std::string& unit) {
    require_finite("depth", depth);
    if (depth.empty() ? !values.empty() : values.empty() || values.size() % depth.size() != 0)
        throw InputError(
            "values has " + std::to_string(values.size()) + " values, depth has " + std::to_string(depth.size()),
            "must be as many for each depth");
    if (depth.empty()) return {};
    const int sectors = static_cast<int>(values.size() / depth.size());
    const std::lock_guard guard(lock_);
    const auto [place, is_new] = images_.try_emplace(name, ArrivedRows{{}, {}, sectors, unit});
    ArrivedRows& rows = place->second;
    if (rows.sectors != sectors)
        throw InputError("values has " + std::to_string(sectors) + " sectors",
                         "image '" + name + "' has " + std::to_string(rows.sectors));
    const std::size_t had = rows.depth.size(), had_values = rows.values.size();
    const auto start = static_cast<Index>(had);
    try {
        rows.values.insert(rows.values.end(), values.begin(), values.end());
        rows.depth.insert(rows.depth.end(), depth.begin(), depth.end());
    } catch (...) {
        rows.values.resize(had_values);
        rows.depth.resize(had);
        if (is_new) images_.erase(place);
        throw;
    }
    Update update;
    update.images[name] = {start, static_cast<Index>(rows.depth.size())};
    return report(std::move(update));
}

Update Live::report(Update update) {
    join(pending_, update);
    return update;
}

Update Live::poll() {
    const std::lock_guard guard(lock_);
    return std::exchange(pending_, {});
}

std::optional<Survey> Live::survey() const {
    const std::lock_guard guard(lock_);
    return survey_;
}

std::optional<Path> Live::path() const {
    const std::lock_guard guard(lock_);
    return path_;
}

std::vector<std::string> Live::images() const {
    const std::lock_guard guard(lock_);
    std::vector<std::string> names;
    for (const auto& [name, rows] : images_) names.push_back(name);
    return names;
}

const Live::ArrivedRows& Live::arrived(const std::string& name) const {
    const auto place = images_.find(name);
    if (place == images_.end()) throw InputError("image '" + name + "'", "is not there");
    return place->second;
}

ImageArrays Live::rows(const std::string& name, Range some) const {
    const std::lock_guard guard(lock_);
    const ArrivedRows& rows = arrived(name);
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
    const std::lock_guard guard(lock_);
    const ArrivedRows& rows = arrived(name);
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
