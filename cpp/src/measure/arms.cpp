// From samples to pairs of opposite samples, and from these to the diameter of each arm in each turn.
#include "helibore/arms.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <numeric>

#include "base/arithmetic.hpp"
#include "base/degrees.hpp"
#include "base/messages.hpp"
#include "base/trigonometry.hpp"
#include "samples/helix.hpp"

namespace helibore {

namespace {

constexpr double missing = std::numeric_limits<double>::quiet_NaN();
constexpr double same_axis = 1e-3;           // degrees, to which toolfaces are rounded to compare them
constexpr std::int64_t half_turn = 180'000;  // in these steps
constexpr std::int64_t nearly_opposite = 2;  // steps
constexpr double alike = 1e-2;               // degrees by which axes must differ for one to be nearer
constexpr double rounding = 1e-9;            // metres
constexpr double wide = 1e-3;                // share of a turn that readings cover, below which they have no mean

struct Place {
    double depth, time;
    std::int64_t toolface;
    std::size_t row;

    std::int64_t axis() const { return toolface % half_turn; }
    bool together(const Place& other) const { return depth == other.depth && time == other.time; }
};

// Samples at one place, as from two calipers with the same direction: their mean.
struct Reading {
    Place place;
    double radius;
    Index arm;
};

// Both ends of a diameter.
struct Pair {
    Index arm;
    double depth, diameter, uneven;
    std::int64_t axis;
};

std::vector<Reading> readings_of(const ArmSamples& samples) {
    std::vector<Place> places(samples.depth.size());
    for (std::size_t row = 0; row < places.size(); ++row) {
        const double steps = nearest_whole(wrap_toolface(samples.toolface[row]) / same_axis);
        places[row] = {samples.depth[row], samples.time.empty() ? 0.0 : samples.time[row],
                       static_cast<std::int64_t>(steps) % (2 * half_turn), row};
    }
    const auto before = [](const Place& a, const Place& b) {
        if (a.depth != b.depth) return a.depth < b.depth;
        if (a.time != b.time) return a.time < b.time;
        if (a.axis() != b.axis()) return a.axis() < b.axis();
        if (a.toolface != b.toolface) return a.toolface < b.toolface;
        return a.row < b.row;
    };
    if (!std::ranges::is_sorted(places, before)) std::ranges::sort(places, before);
    std::vector<Reading> out;
    for (std::size_t i = 0; i < places.size();) {
        Reading reading{places[i], 0.0, samples.arm[places[i].row]};
        const std::size_t first = i;
        for (; i < places.size() && places[i].together(reading.place) && places[i].toolface == reading.place.toolface;
             ++i) {
            reading.radius += samples.radius[places[i].row];
            reading.arm = std::min(reading.arm, samples.arm[places[i].row]);
        }
        reading.radius /= static_cast<double>(i - first);
        out.push_back(reading);
    }
    return out;
}

template <class Values, class Of>
std::vector<Index> distinct(const Values& values, Of of) {
    std::vector<Index> out;
    for (const auto& value : values)
        if (const Index one = of(value); std::ranges::find(out, one) == out.end()) {
            out.push_back(one);
            if (out.size() > 64) break;  // more than any caliper has arms
        }
    std::ranges::sort(out);
    return out;
}

std::vector<Pair> pairs_of(const std::vector<Reading>& readings) {
    std::vector<Pair> out;
    for (std::size_t i = 1; i < readings.size(); ++i) {
        const Reading &a = readings[i - 1], &b = readings[i];
        const std::int64_t apart = std::abs(std::abs(b.place.toolface - a.place.toolface) - half_turn);
        if (!a.place.together(b.place) || apart > nearly_opposite) continue;
        out.push_back({std::min(a.arm, b.arm), a.place.depth, a.radius + b.radius, std::abs(a.radius - b.radius),
                       a.place.axis()});
    }
    const auto axis = [](const Pair& pair) { return Index{pair.axis}; };
    const auto arm = [](const Pair& pair) { return pair.arm; };
    if (distinct(out, axis).size() < distinct(out, arm).size())  // arms share an axis, and one is missing in places
        for (Pair& pair : out) pair.arm = pair.axis;
    return out;
}

// What is averaged of a pair: diameter, unevenness, and the axis as a direction of twice the angle.
constexpr std::size_t quantities = 4;
using Values = std::array<double, quantities>;

// The readings of one arm along the hole, linear between them.
class Line {
  public:
    Line(const std::vector<Pair>& pairs, Index arm) {
        std::size_t count = 0;
        for (const Pair& pair : pairs) {
            if (pair.arm != arm) continue;
            const SineCosine doubled = sine_cosine(2.0 * (static_cast<double>(pair.axis) * same_axis));
            const Values of{pair.diameter, pair.uneven, doubled.cosine, doubled.sine};
            if (depth_.empty() || depth_.back() != pair.depth) {
                finish(count);
                depth_.push_back(pair.depth), values_.push_back({}), count = 0;
            }
            for (std::size_t i = 0; i < quantities; ++i) values_.back()[i] += of[i];
            ++count;
        }
        finish(count);
        area_.resize(depth_.size());
        for (std::size_t at = 1; at < depth_.size(); ++at)
            for (std::size_t i = 0; i < quantities; ++i)
                area_[at][i] =
                    area_[at - 1][i] + (depth_[at] - depth_[at - 1]) * (values_[at][i] + values_[at - 1][i]) / 2.0;
    }

    Values mean(double depth, double height, double reach) const {
        if (const std::size_t after = std::min(first_from(depth), depth_.size() - 1);
            std::min(std::abs(depth_[after] - depth), std::abs(depth_[after > 0 ? after - 1 : 0] - depth)) > reach)
            return {missing, missing, missing, missing};
        const double low = std::clamp(depth - height / 2.0, depth_.front(), depth_.back());
        const double high = std::clamp(depth + height / 2.0, depth_.front(), depth_.back());
        if (!(high - low > wide * height)) return at(depth);
        const Values above = area(low), below = area(high);
        Values out{};
        for (std::size_t i = 0; i < quantities; ++i) out[i] = (below[i] - above[i]) / (high - low);
        return out;
    }

  private:
    void finish(std::size_t count) {
        if (count > 1)
            for (double& of : values_.back()) of /= static_cast<double>(count);
    }
    std::size_t first_from(double depth) const {
        return static_cast<std::size_t>(std::ranges::lower_bound(depth_, depth) - depth_.begin());
    }
    // Returns the last reading at or above a depth, the first one for depths above all.
    std::size_t row(double depth) const {
        const auto beyond = std::ranges::upper_bound(depth_, depth) - depth_.begin();
        return static_cast<std::size_t>(std::max<std::ptrdiff_t>(beyond - 1, 0));
    }
    Values at(double depth) const {
        const std::size_t from = row(depth);
        if (depth <= depth_[from] || from + 1 == depth_.size()) return values_[from];
        Values out{};
        for (std::size_t i = 0; i < quantities; ++i)
            out[i] =
                (values_[from + 1][i] - values_[from][i]) / (depth_[from + 1] - depth_[from]) * (depth - depth_[from]) +
                values_[from][i];
        return out;
    }
    Values area(double to) const {
        const std::size_t from = row(to);
        const Values there = at(to);
        Values out{};
        for (std::size_t i = 0; i < quantities; ++i)
            out[i] = area_[from][i] + (to - depth_[from]) * (values_[from][i] + there[i]) / 2.0;
        return out;
    }

    std::vector<double> depth_;
    std::vector<Values> values_, area_;  // area_: integral from the first reading
};

// Fills in the extremes of each turn.
void add_sizes(ArmDiameters& of, std::size_t turns) {
    for (auto* column : {&of.c1, &of.c1_toolface, &of.c1_uneven, &of.c2, &of.least_diameter})
        column->assign(turns, missing);
    for (std::size_t turn = 0; turn < turns; ++turn) {
        const auto entry = [&](const std::vector<double>& column, std::size_t arm) {
            return column[arm * turns + turn];
        };
        std::size_t largest = 0, second = 0;
        double least = entry(of.diameter, 0);
        bool whole = true;
        for (std::size_t arm = 0; arm < of.arms; ++arm) {
            const double diameter = entry(of.diameter, arm);
            whole = whole && !std::isnan(diameter);
            if (diameter > entry(of.diameter, largest)) largest = arm;
            least = std::min(least, diameter);
        }
        if (!whole) continue;
        const double axis = entry(of.toolface, largest);
        const auto across = [&](std::size_t arm) {
            return std::abs(std::remainder(entry(of.toolface, arm) - axis, 180.0));
        };
        for (std::size_t arm = 1; arm < of.arms; ++arm)
            if (across(arm) > across(second) + alike) second = arm;  // of two alike, the first
        of.c1[turn] = entry(of.diameter, largest), of.c1_toolface[turn] = axis;
        of.c1_uneven[turn] = entry(of.uneven, largest);
        of.c2[turn] = entry(of.diameter, second), of.least_diameter[turn] = least;
    }
}

void require_lengths(const ArmSamples& samples) {
    const std::size_t count = samples.depth.size();
    require_length("toolface", samples.toolface.size(), count);
    require_length("radius", samples.radius.size(), count);
    require_length("arm", samples.arm.size(), count);
    if (!samples.time.empty()) require_length("time", samples.time.size(), count);
}

// Returns the arms of the pairs; none if they are not those of a tool with few arms.
std::vector<Index> few_names(const std::vector<Pair>& pairs) {
    std::vector<Index> names = distinct(pairs, [](const Pair& pair) { return pair.arm; });
    if (names.size() < 2 || names.size() > few_arms) names.clear();
    return names;
}

}  // namespace

ArmDiameters arm_diameters(const ArmSamples& samples, std::span<const double> depth, double height) {
    const StandardArithmetic standard;
    require_lengths(samples);
    const std::vector<Pair> pairs = pairs_of(readings_of(samples));
    const std::vector<Index> names = few_names(pairs);
    ArmDiameters out;
    if (names.empty()) return out;
    out.arms = names.size();
    for (const Index name : names) {
        const Line line(pairs, name);
        for (const double at : depth) {
            const auto [diameter, uneven, cosine, sine] = line.mean(at, height, samples.reach);
            const double axis = arc_tangent(sine, cosine) / degree / 2.0;
            out.diameter.push_back(diameter), out.uneven.push_back(uneven);
            out.toolface.push_back(axis < 0.0 ? (axis + 180.0 < 180.0 ? axis + 180.0 : 0.0) : axis);
        }
    }
    add_sizes(out, depth.size());
    return out;
}

bool measures_diameters(const ArmSamples& samples) {
    const StandardArithmetic standard;
    require_lengths(samples);
    const std::vector<Pair> pairs = pairs_of(readings_of(samples));
    const std::vector<Index> names = few_names(pairs);
    return !names.empty() && std::ranges::all_of(names, [&](Index name) {
        const auto of_arm = [&](const Pair& pair) { return pair.arm == name; };
        const double apart = std::ranges::find_if(pairs, of_arm)->uneven;
        return std::ranges::all_of(
            pairs, [&](const Pair& pair) { return !of_arm(pair) || std::abs(pair.uneven - apart) <= rounding; });
    });
}

}  // namespace helibore
