#include "helibore/preparation.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <limits>

#include "base/arithmetic.hpp"
#include "base/host_memory.hpp"
#include "base/messages.hpp"
#include "base/row_hash.hpp"
#include "prepare/columns.hpp"
#include "samples/helix.hpp"

namespace helibore {

namespace {

constexpr std::size_t beside = 8;  // readings on either side of a reading, for its running median
constexpr std::size_t window = 2 * beside + 1;
constexpr std::size_t judged_together = 100;  // readings that share a deviation
constexpr double quantile = 0.85, of_deviation = 1.44;

// Throws InputError if a value is infinite.
void require_no_infinity(const std::string& name, std::span<const double> values) {
    const auto count = std::count_if(values.begin(), values.end(), [](double value) { return std::isinf(value); });
    if (count > 0) throw InputError(name + " is infinite in " + std::to_string(count) + " rows", "must be finite");
}

// Returns the differences of readings from the medians of the `window` readings around them. At an end, the readings
// are mirrored.
std::vector<double> off_median(std::span<const double> reading) {
    const auto last = static_cast<std::ptrdiff_t>(reading.size()) - 1;
    const auto at = [&](std::ptrdiff_t i) {
        return reading[static_cast<std::size_t>(i < 0 ? -i : i > last ? 2 * last - i : i)];
    };
    constexpr auto half = static_cast<std::ptrdiff_t>(beside);
    std::array<double, window> sorted;
    for (std::ptrdiff_t i = -half; i <= half; ++i) sorted[static_cast<std::size_t>(i + half)] = at(i);
    std::sort(sorted.begin(), sorted.end());
    std::vector<double> off(reading.size());
    for (std::ptrdiff_t i = 0;; ++i) {
        off[static_cast<std::size_t>(i)] = reading[static_cast<std::size_t>(i)] - sorted[beside];
        if (i == last) return off;
        const double gone = at(i - half), added = at(i + half + 1);
        std::size_t place = 0;
        while (sorted[place] != gone) ++place;
        for (; place + 1 < window && sorted[place + 1] < added; ++place) sorted[place] = sorted[place + 1];
        for (; place > 0 && sorted[place - 1] > added; --place) sorted[place] = sorted[place - 1];
        sorted[place] = added;
    }
}

// Returns the quantile of values, which are reordered: between the two nearest, as numpy.quantile does it.
double quantile_of(std::span<double> values) {
    const double place = static_cast<double>(values.size() - 1) * quantile;
    const auto below = static_cast<std::ptrdiff_t>(place);
    const double share = place - static_cast<double>(below);
    std::nth_element(values.begin(), values.begin() + below, values.end());
    const double low = values[static_cast<std::size_t>(below)];
    const double high = *std::min_element(values.begin() + below + 1, values.end());
    return share >= 0.5 ? high - (high - low) * (1.0 - share) : low + (high - low) * share;
}

// Where a pass that starts at a row ends, and the row that shows this end; the number of rows: no row shows it.
struct PassEnd {
    std::size_t end, noticed;
};

// The pass goes down (`sign` 1) or up (-1).
PassEnd pass_end(std::span<const double> depth, std::size_t start, double sign, double reversal) {
    double peak = -std::numeric_limits<double>::infinity();
    std::size_t end = start;
    for (std::size_t i = start; i < depth.size(); ++i) {
        const double ahead = sign * depth[i];
        if (ahead >= peak) {
            peak = ahead, end = i;
        } else if (peak - ahead > reversal) {
            return {end, i};
        }
    }
    return {depth.size() - 1, depth.size()};
}

}  // namespace

ToolSamples observe_by_depth(const ToolRows& rows, std::span<const ToolSensor> sensors) {
    const StandardArithmetic standard;
    const std::size_t count = rows.depth.size(), width = sensors.size();
    require_columns(rows, sensors);
    for (std::size_t c = 0; c < rows.radii.size(); ++c)
        for (std::size_t i = 0; i < count; ++i)
            if (const double radius = read_once(rows.radii[c][i]); std::isinf(radius))
                throw entry_error(entry_name("radii", static_cast<Index>(c)), static_cast<Index>(i), radius,
                                  "must be finite, or NaN where missing");
    require_no_infinity("depth", rows.depth);
    require_no_infinity("toolface", rows.toolface);
    std::vector<std::span<const double>> readings;
    for (const ToolSensor& sensor : sensors) readings.push_back(rows.radii[static_cast<std::size_t>(sensor.column)]);

    ToolSamples found;
    for (std::vector<double>* column : {&found.depth, &found.toolface, &found.radius}) column->resize(count * width);
    if (rows.time) found.time.resize(count * width);
    found.sensor.resize(count * width), found.row.resize(count * width);
    const bool mounted =
        std::any_of(sensors.begin(), sensors.end(), [](const ToolSensor& s) { return s.mounting != 0.0; });
    std::size_t kept = 0;
    bool turned = false;
    for (std::size_t i = 0; i < count; ++i) {
        const double depth = read_once(rows.depth[i]), toolface = read_once(rows.toolface[i]);
        const double time = rows.time ? read_once((*rows.time)[i]) : 0.0;
        for (std::size_t s = 0; s < width; ++s) {
            const double radius = read_once(readings[s][i]);
            if (std::isnan(depth) || std::isnan(toolface) || std::isnan(radius) || std::isnan(time)) {
                ++(std::isnan(depth)      ? found.no_depth
                   : std::isnan(toolface) ? found.no_toolface
                   : std::isnan(radius)   ? found.no_radius
                                          : found.no_time);
                continue;
            }
            double looking = mounted ? toolface + sensors[s].mounting : toolface;
            if (!(looking >= 0.0 && looking < 360.0)) looking = wrap_toolface(looking), turned = true;
            found.depth[kept] = depth - sensors[s].offset;
            found.toolface[kept] = looking;
            found.radius[kept] = radius;
            if (rows.time) found.time[kept] = time;
            found.sensor[kept] = static_cast<std::int64_t>(s);
            found.row[kept] = static_cast<std::int64_t>(i);
            ++kept;
        }
    }
    for (std::vector<double>* column : {&found.depth, &found.toolface, &found.radius}) column->resize(kept);
    if (turned)
        for (double& toolface : found.toolface)
            toolface += 0.0;  // -0 becomes 0; a column that is in range stays as it is
    if (rows.time) found.time.resize(kept);
    found.sensor.resize(kept), found.row.resize(kept);
    return found;
}

std::vector<std::int64_t> odd_readings(std::span<const double> radius, double threshold, double floor) {
    const StandardArithmetic standard;
    std::vector<std::int64_t> odd(radius.size());
    std::vector<double> reading;
    std::vector<std::size_t> row;
    for (std::size_t i = 0; i < radius.size(); ++i) {
        const double value = read_once(radius[i]);
        if (std::isfinite(value)) reading.push_back(value), row.push_back(i);
    }
    if (reading.size() < window) return odd;
    const std::vector<double> off = off_median(reading);
    const std::size_t blocks = std::max<std::size_t>(1, off.size() / judged_together);
    const double step = static_cast<double>(off.size()) / static_cast<double>(blocks);
    std::vector<double> far;
    for (std::size_t block = 0; block < blocks; ++block) {
        const auto first = static_cast<std::size_t>(static_cast<double>(block) * step);
        const auto stop =
            block + 1 == blocks ? off.size() : static_cast<std::size_t>(static_cast<double>(block + 1) * step);
        far.clear();
        for (std::size_t i = first; i < stop; ++i) far.push_back(std::abs(off[i]));
        const double limit = threshold * std::max(quantile_of(far) / of_deviation, floor);
        for (std::size_t i = first; i < stop; ++i)
            if (std::abs(off[i]) > limit) odd[row[i]] = off[i] > 0.0 ? 1 : -1;
    }
    return odd;
}

double share_of_repeats(std::span<const double> depth, std::span<const double> toolface, std::span<const double> radius,
                        Index most) {
    require_length("toolface", toolface.size(), depth.size());
    require_length("radius", radius.size(), depth.size());
    const double share =
        std::min(1.0, static_cast<double>(most) / static_cast<double>(std::max<std::size_t>(depth.size(), 1)));
    const auto limit = static_cast<std::uint64_t>(static_cast<double>(0xFFFFFFFF) * share);
    std::vector<std::uint64_t> judged;
    for (std::size_t i = 0; i < depth.size(); ++i) {
        const std::array row{read_once(depth[i]), read_once(toolface[i]), read_once(radius[i])};
        const auto of_depth = std::bit_cast<std::uint64_t>(row[0]), of_toolface = std::bit_cast<std::uint64_t>(row[1]);
        if ((of_depth ^ (of_toolface << 1)) * hash_factor >> 32 > limit) continue;
        std::uint64_t hash = 0;
        for (const double value : row) hash = with_number(hash, value);
        judged.push_back(hash);
    }
    if (judged.empty()) return 0.0;
    const auto count = static_cast<double>(judged.size());
    std::sort(judged.begin(), judged.end());
    const auto different = std::unique(judged.begin(), judged.end()) - judged.begin();
    return 1.0 - static_cast<double>(different) / count;
}

std::vector<std::int64_t> number_passes(std::span<const double> given, double reversal) {
    const StandardArithmetic standard;
    const std::vector<double> depth = copied(given);
    require_finite("depth", depth);
    require(reversal > 0.0, "reversal", reversal, "must be above 0");
    std::vector<std::int64_t> pass(depth.size());
    const PassEnd down = pass_end(depth, 0, 1.0, reversal), up = pass_end(depth, 0, -1.0, reversal);
    double sign = down.noticed > up.noticed ? 1.0 : -1.0;
    PassEnd found = sign > 0.0 ? down : up;
    std::size_t first = 0;
    for (std::int64_t number = 0; first < depth.size(); ++number) {
        for (; first <= found.end; ++first) pass[first] = number;
        if (first == depth.size()) break;
        sign = -sign;
        found = pass_end(depth, found.noticed, sign, reversal);
    }
    return pass;
}

}  // namespace helibore
