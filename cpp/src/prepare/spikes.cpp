// Turns of a tool, and samples that disagree with the turns beside theirs: preparation.hpp has the rules.
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numeric>
#include <tuple>
#include <type_traits>
#include <utility>

#include "base/arithmetic.hpp"
#include "base/host_memory.hpp"
#include "base/messages.hpp"
#include "helibore/preparation.hpp"
#include "prepare/columns.hpp"

namespace helibore {

namespace {

constexpr std::size_t reach = 3, used = 6, least = 4;  // turns on either side; neighbours in them: compared, needed
constexpr double near_angle = 20.0, far_angle = 45.0, arm_share = 270.0;
constexpr std::size_t judged_together = 100, measured_together = 25;  // turns with one deviation, and of which it is
constexpr double of_median = 1.4826, spread_share = 0.1;
constexpr std::size_t longest_burst = 5;
constexpr double cell = 10.0, elsewhere = 2.0;  // degrees, metres: where other turns confirm a sample
constexpr std::size_t confirming = 2, confirming_few = 4;
constexpr double longest_turn = 1.0;  // metres
constexpr std::size_t nothing = std::numeric_limits<std::size_t>::max();
constexpr double none = std::numeric_limits<double>::quiet_NaN();

double in_turn(double degrees) {
    if (degrees >= 0.0 && degrees < 360.0) return degrees;  // most are; std::fmod is slow
    const double rest = std::fmod(degrees, 360.0);
    return rest < 0.0 ? rest + 360.0 : rest;
}

double angle_between(double a, double b) {
    const double off = std::abs(a - b);
    return std::min(off, 360.0 - off);
}

// Returns the order of samples by turn. Those of one turn are roughly in the order of their angles, or in their own.
std::vector<std::size_t> order_of(const std::vector<std::int64_t>& turn, const std::vector<double>& angle) {
    const auto [lowest, highest] = std::ranges::minmax(turn);
    const auto number = [first = static_cast<std::uint64_t>(lowest)](std::int64_t of) {
        return static_cast<std::uint64_t>(of) - first;
    };
    std::vector<std::size_t> order(turn.size());
    if (number(highest) < turn.size()) {  // mostly: turns are counted, so that each of their sectors has a bin
        const std::size_t turns = number(highest) + 1, sectors = (turn.size() - 1) / turns + 1;
        const double in_a_degree = static_cast<double>(sectors) / 360.0;
        const auto bin = [&](std::size_t i) {
            return number(turn[i]) * sectors + std::min(sectors - 1, static_cast<std::size_t>(angle[i] * in_a_degree));
        };
        std::vector<std::uint32_t> next(turns * sectors + 1);
        for (std::size_t i = 0; i < turn.size(); ++i) ++next[bin(i) + 1];
        std::partial_sum(next.begin(), next.end(), next.begin());
        for (std::size_t i = 0; i < turn.size(); ++i) order[next[bin(i)]++] = i;
    } else {
        std::iota(order.begin(), order.end(), std::size_t{0});
        std::stable_sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) { return turn[a] < turn[b]; });
    }
    return order;
}

// The samples with a radius, sorted by turn and toolface: those of a turn form a ring.
//
//     turn 7    |  *   *    *     *  |
//     turn 8    | *    *   *A   *    |     next to A in turn 7 and in turn 9 are the two samples on either side of it
//     turn 9    |   *    *    *   *  |
class Rings {
  public:
    std::vector<std::size_t> row, first;  // of each sample; of each ring the first sample, and the number of samples
    std::vector<double> angle, radius;    // degrees in [0, 360), metres
    std::vector<std::uint64_t> turn;      // of each ring; unsigned, so that differences are defined
    std::vector<std::uint32_t> ring;      // of each sample
    std::vector<std::array<std::size_t, 2 * reach>>
        beside;  // the rings 3 turns before to 3 after; `nothing` where none

    Rings(std::span<const double> toolface, std::span<const double> given, std::span<const std::int64_t> turns) {
        std::vector<std::int64_t> numbers;
        row.reserve(given.size()), angle.reserve(given.size()), radius.reserve(given.size());
        numbers.reserve(given.size());
        for (std::size_t i = 0; i < given.size(); ++i) {
            const double at = in_turn(read_once(toolface[i])), of = read_once(given[i]);
            if (!std::isfinite(of) || !std::isfinite(at)) continue;
            row.push_back(i), angle.push_back(at), radius.push_back(of), numbers.push_back(read_once(turns[i]));
        }
        const auto reorder = [](auto& values, const std::vector<std::size_t>& order) {
            std::remove_reference_t<decltype(values)> sorted;
            sorted.reserve(values.size());
            for (const std::size_t i : order) sorted.push_back(values[i]);
            values.swap(sorted);
        };
        if (!std::is_sorted(numbers.begin(), numbers.end())) {
            const std::vector<std::size_t> order = order_of(numbers, angle);
            reorder(numbers, order), reorder(row, order), reorder(angle, order), reorder(radius, order);
        }
        ring.reserve(row.size());
        for (std::size_t i = 0; i < row.size(); ++i) {
            if (!i || numbers[i] != numbers[i - 1])
                first.push_back(i), turn.push_back(static_cast<std::uint64_t>(numbers[i]));
            ring.push_back(static_cast<std::uint32_t>(turn.size() - 1));
        }
        first.push_back(row.size());
        std::vector<std::tuple<double, std::size_t, double>> sorted;
        for (std::size_t r = 0; r < turn.size(); ++r) {
            const std::size_t begin = first[r], end = first[r + 1];
            if (std::is_sorted(angle.data() + begin, angle.data() + end)) continue;
            sorted.clear();
            for (std::size_t i = begin; i < end; ++i) sorted.emplace_back(angle[i], row[i], radius[i]);
            std::sort(sorted.begin(), sorted.end());
            for (std::size_t i = begin; i < end; ++i) std::tie(angle[i], row[i], radius[i]) = sorted[i - begin];
        }
        beside.resize(turn.size());
        for (std::size_t r = 0; r < turn.size(); ++r) {
            beside[r].fill(nothing);
            for (std::size_t step = 1; step <= reach; ++step) {
                for (std::size_t back = 1; back <= std::min(step, r); ++back)
                    if (turn[r] - turn[r - back] == step) beside[r][reach - step] = r - back;
                for (std::size_t on = 1; on <= step && r + on < turn.size(); ++on)
                    if (turn[r + on] - turn[r] == step) beside[r][reach - 1 + step] = r + on;
            }
        }
    }

    std::size_t count(std::size_t of) const { return first[of + 1] - first[of]; }

    // The two samples of the ring `of` beside a toolface, given the first of its samples that is not before it.
    std::array<std::size_t, 2> pair(std::size_t of, std::size_t after) const {
        return {after == first[of] ? first[of + 1] - 1 : after - 1, after == first[of + 1] ? first[of] : after};
    }

    std::array<std::size_t, 2> next_to(std::size_t i, std::size_t of) const {
        const auto begin = angle.begin() + static_cast<std::ptrdiff_t>(first[of]);
        const auto end = angle.begin() + static_cast<std::ptrdiff_t>(first[of + 1]);
        return pair(of, static_cast<std::size_t>(std::lower_bound(begin, end, angle[i]) - angle.begin()));
    }

    // The limit of a tool with few arms is 0.75 of the angle between two arms: a sample beyond it is of another arm.
    double limit(std::size_t of) const {
        return std::clamp(arm_share / static_cast<double>(count(of)), near_angle, far_angle);
    }
};

// What the neighbours of a sample in other turns say: their number, at most six, and their median and second smallest
// and largest radius.
struct Neighbours {
    std::size_t number = 0;
    double median = none, low = none, high = none;
};

// Sorts six values without a branch.
void sort_six(std::array<double, used>& values) {
    constexpr std::array<std::pair<std::size_t, std::size_t>, 12> steps{
        {{0, 5}, {1, 3}, {2, 4}, {1, 2}, {3, 4}, {0, 3}, {2, 5}, {0, 1}, {2, 3}, {4, 5}, {1, 2}, {3, 4}}};
    for (const auto& [one, other] : steps) {
        const double low = std::min(values[one], values[other]), high = std::max(values[one], values[other]);
        values[one] = low, values[other] = high;
    }
}

Neighbours neighbours(const Rings& rings, std::size_t i) {
    constexpr double never = std::numeric_limits<double>::infinity();
    constexpr std::size_t most = 4 * reach;
    std::array<double, most> gap, radius;
    gap.fill(never), radius.fill(never);
    const std::size_t own = rings.ring[i];
    const double limit = rings.limit(own);
    std::size_t number = 0;
    for (std::size_t k = 0; k < 2 * reach; ++k) {
        const std::size_t of = rings.beside[own][k];
        if (of == nothing) continue;
        const std::array<std::size_t, 2> two = rings.next_to(i, of);
        for (std::size_t side = 0; side < 2; ++side) {
            const double away = angle_between(rings.angle[two[side]], rings.angle[i]);
            const bool counts = away <= limit && !(side && two[0] == two[1]);
            gap[2 * k + side] = counts ? away : never, radius[2 * k + side] = rings.radius[two[side]];
            number += counts;
        }
    }
    // The rank of each by its angle; of equal ones the earlier is before. All pairs are compared, since the order is
    // too random for a sort with branches.
    std::array<std::size_t, most> rank{};
    for (std::size_t late = 1; late < most; ++late)
        for (std::size_t early = 0; early < late; ++early) {
            const std::size_t before = gap[late] < gap[early];
            rank[early] += before, rank[late] += 1 - before;
        }
    number = std::min(number, used);
    if (!number) return {};
    std::array<double, most> ranked;
    for (std::size_t k = 0; k < most; ++k) ranked[rank[k]] = radius[k];
    std::array<double, used> sorted;
    for (std::size_t k = 0; k < used; ++k) sorted[k] = k < number ? ranked[k] : never;
    sort_six(sorted);
    const std::size_t last = number - 1;
    return {number, 0.5 * (sorted[last / 2] + sorted[(last + 1) / 2]), sorted[std::min<std::size_t>(1, last)],
            sorted[last ? last - 1 : 0]};
}

// Returns the value that would stand in the lower middle if the values were sorted.
double lower_median(std::vector<double>& values) {
    const auto middle = values.begin() + static_cast<std::ptrdiff_t>((values.size() - 1) / 2);
    std::nth_element(values.begin(), middle, values.end());
    return *middle;
}

class SpikeSearch {
  public:
    SpikeSearch(const Rings& rings, std::span<const double> depth, double threshold, double floor)
        : rings_(rings), depth_(depth), threshold_(threshold), floor_(floor) {}

    SpikedSamples find() {
        const std::size_t turns = rings_.turn.size();
        std::vector<std::size_t> found;
        for (std::size_t start = 0; start < turns; start += judged_together) {
            const std::size_t stop = std::min(start + judged_together, turns);
            // The least tolerance: what is no spike by it is none, whatever the noise. Most turns need no more.
            tolerance_ = threshold_ * floor_;
            begin_ = rings_.first[start];
            std::vector<std::size_t> suspect;
            for (std::size_t r = start; r < stop; ++r) screen(r, suspect);
            if (suspect.empty()) continue;
            tolerance_ = tolerance_of(start, stop);
            std::vector<bool> odd(rings_.first[stop] - begin_);
            for (const std::size_t i : suspect) odd[i - begin_] = beyond(i, neighbours(rings_, i)) && !supported(i);
            for (std::size_t r = start; r < stop; ++r) add_bursts(r, odd, found);
        }
        leave_out_confirmed(found);
        SpikedSamples spiked;
        spiked.unjudged = unjudged_;
        for (const std::size_t i : found) spiked.samples.push_back(static_cast<Index>(rings_.row[i]));
        std::sort(spiked.samples.begin(), spiked.samples.end());
        return spiked;
    }

  private:
    // Adds the samples of a ring that lie beyond their neighbours, and that no sample next to them, in the turn before
    // or after, agrees with; counts those with few neighbours.
    void screen(std::size_t r, std::vector<std::size_t>& suspect) {
        const std::size_t before = rings_.beside[r][reach - 1], after = rings_.beside[r][reach];
        std::array<std::size_t, 2> at{};
        if (before != nothing) at[0] = rings_.first[before];
        if (after != nothing) at[1] = rings_.first[after];
        for (std::size_t i = rings_.first[r]; i < rings_.first[r + 1]; ++i) {
            bool agrees = false;
            for (std::size_t side = 0; side < 2; ++side) {
                const std::size_t of = side ? after : before;
                if (of == nothing) continue;
                while (at[side] < rings_.first[of + 1] && rings_.angle[at[side]] < rings_.angle[i]) ++at[side];
                for (const std::size_t one : rings_.pair(of, at[side]))
                    agrees |= std::abs(rings_.radius[one] - rings_.radius[i]) <= 0.5 * tolerance_;
            }
            if (agrees) continue;
            const Neighbours of = neighbours(rings_, i);
            unjudged_ += of.number < least;
            if (beyond(i, of)) suspect.push_back(i);
        }
    }

    // Returns the tolerance of some turns. A turn through a breakout has a larger median distance, which is due to
    // shape and not to noise; so the median turn counts.
    double tolerance_of(std::size_t start, std::size_t stop) const {
        std::vector<double> turns, off;
        for (std::size_t r = start; r < stop; r += std::max<std::size_t>(1, (stop - start) / measured_together)) {
            off.clear();
            for (std::size_t i = rings_.first[r]; i < rings_.first[r + 1]; ++i) {
                const double distance = std::abs(rings_.radius[i] - neighbours(rings_, i).median);
                off.push_back(std::isnan(distance) ? std::numeric_limits<double>::infinity() : distance);
            }
            turns.push_back(lower_median(off));
        }
        const double deviation = of_median * lower_median(turns);
        return threshold_ * std::max(std::isfinite(deviation) ? deviation : 0.0, floor_);
    }

    bool beyond(std::size_t i, const Neighbours& of) const {
        const double slack = tolerance_ + spread_share * (of.high - of.low);
        return of.number >= least && (rings_.radius[i] > of.high + slack || rings_.radius[i] < of.low - slack);
    }

    bool supported(std::size_t i) const {
        for (const std::size_t of : {rings_.beside[rings_.ring[i]][reach - 1], rings_.beside[rings_.ring[i]][reach]}) {
            if (of == nothing) continue;
            for (const std::size_t one : rings_.next_to(i, of))
                if (std::abs(rings_.radius[one] - rings_.radius[i]) <= 0.5 * tolerance_) return true;
        }
        return false;
    }

    // Adds the odd samples of a ring that are few side by side and unlike those beside them.
    void add_bursts(std::size_t r, const std::vector<bool>& odd, std::vector<std::size_t>& found) {
        const std::size_t first = rings_.first[r], count = rings_.count(r);
        if (std::none_of(odd.begin() + static_cast<std::ptrdiff_t>(first - begin_),
                         odd.begin() + static_cast<std::ptrdiff_t>(first - begin_ + count),
                         [](bool is) { return is; }) ||
            slides(r))
            return;
        const auto place = [&](std::size_t k) { return first + k % count; };
        const auto is_odd = [&](std::size_t k) { return odd[place(k) - begin_]; };
        std::size_t start = 0;
        while (start < count && is_odd(start)) ++start;
        if (start == count) {  // the turn as a whole
            for (std::size_t k = 0; k < count && count <= longest_burst; ++k) found.push_back(first + k);
            tolerances_.resize(found.size(), tolerance_);
            return;
        }
        for (std::size_t k = start + 1, end; k < start + count; k = end + 1) {
            for (end = k; end < start + count && is_odd(end);) ++end;
            if (end == k || end - k > std::max<std::size_t>(1, std::min(longest_burst, count / 3))) continue;
            const auto differs = [&](std::size_t of, std::size_t beside) {
                return std::abs(rings_.radius[of] - rings_.radius[beside]) > 0.5 * tolerance_ ||
                       beyond(beside, neighbours(rings_, beside));
            };
            if (!differs(place(k), place(k - 1)) || !differs(place(end - 1), place(end))) continue;
            for (std::size_t one = k; one < end; ++one) found.push_back(place(one));
        }
        tolerances_.resize(found.size(), tolerance_);
    }

    // Returns whether the tool moved far while it turned once: its samples at one toolface are not of one place.
    bool slides(std::size_t r) const {
        if (depth_.empty()) return false;
        double low = std::numeric_limits<double>::infinity(), high = -low;
        for (std::size_t i = rings_.first[r]; i < rings_.first[r + 1]; ++i) {
            const double depth = read_once(depth_[rings_.row[i]]);
            low = std::min(low, depth), high = std::max(high, depth);
        }
        return high - low > longest_turn;
    }

    // Leaves out the samples that those of turns farther away confirm.
    void leave_out_confirmed(std::vector<std::size_t>& found) const {
        if (depth_.empty() || found.empty()) return;
        const auto cell_of = [&](std::size_t i) { return static_cast<std::size_t>(rings_.angle[i] / cell); };
        constexpr std::size_t cells = 37;  // 360 / 10, and the angle that rounds up to 360
        std::array<bool, cells> wanted{};
        for (const std::size_t i : found) wanted[cell_of(i)] = true;
        std::array<std::vector<std::pair<double, std::size_t>>, cells> of;
        for (std::size_t i = 0; i < rings_.angle.size(); ++i)
            if (const double depth = read_once(depth_[rings_.row[i]]); wanted[cell_of(i)] && !std::isnan(depth))
                of[cell_of(i)].push_back({depth, i});
        for (auto& samples : of) std::sort(samples.begin(), samples.end());
        std::vector<std::size_t> kept;
        for (std::size_t k = 0; k < found.size(); ++k)
            if (!confirmed(of[cell_of(found[k])], found[k], tolerances_[k])) kept.push_back(found[k]);
        found = std::move(kept);
    }

    bool confirmed(const std::vector<std::pair<double, std::size_t>>& samples, std::size_t i, double tolerance) const {
        const std::pair own{read_once(depth_[rings_.row[i]]), i};
        if (std::isnan(own.first)) return false;
        const auto at = std::lower_bound(samples.begin(), samples.end(), own);
        // A tool of few samples a turn sees a shape less exactly: its samples lie farther beside each other.
        const bool few = rings_.limit(rings_.ring[i]) > near_angle;
        const double limit = few ? tolerance : 0.5 * tolerance;
        const std::size_t most = few ? confirming_few : confirming;
        bool agree = false;
        // Takes the nearest samples in one direction; returns false where no more come.
        const auto take = [&](const std::pair<double, std::size_t>& one, std::size_t& taken) {
            if (std::abs(one.first - own.first) > elsewhere || taken == most) return false;
            const std::uint64_t a = rings_.turn[rings_.ring[one.second]], b = rings_.turn[rings_.ring[i]];
            if ((one.second > i ? a - b : b - a) <= reach) return true;
            const double radius = rings_.radius[one.second];
            agree |= std::abs(radius - rings_.radius[i]) <= limit, ++taken;
            return true;
        };
        std::size_t before = 0, after = 0;
        for (auto one = at; one != samples.begin() && take(*std::prev(one), before);) --one;
        for (auto one = at; one != samples.end() && take(*one, after);) ++one;
        return agree;
    }

    const Rings& rings_;
    std::span<const double> depth_;
    double threshold_, floor_;
    std::vector<double> tolerances_;  // of each sample found
    Index unjudged_ = 0;
    std::size_t begin_ = 0;  // the first sample of the turns that are searched
    double tolerance_ = 0.0;
};

}  // namespace

std::optional<std::vector<Index>> turns_by_rotation(std::span<const double> toolface, std::span<const Index> row,
                                                    std::span<const double> depth) {
    const StandardArithmetic standard;
    require_length("depth", depth.size(), row.size());
    std::vector<Index> rows(row.size()), turn_of(toolface.size());
    std::vector<bool> has_samples(toolface.size());
    for (std::size_t i = 0; i < row.size(); ++i) {
        rows[i] = read_once(row[i]);
        if (rows[i] < 0 || rows[i] >= std::ssize(toolface))
            require(false, entry_name("row", static_cast<Index>(i)), rows[i], "must be one of the rows of toolface");
        has_samples[static_cast<std::size_t>(rows[i])] = true;
    }
    double last = none;
    Index whole = 0, least_turn = std::numeric_limits<Index>::max(), most_turn = 0;
    for (std::size_t i = 0; i < toolface.size(); ++i) {
        if (!has_samples[i]) continue;
        const double angle = in_turn(read_once(toolface[i]));
        if (angle - last > 180.0) --whole;
        if (angle - last < -180.0) ++whole;
        last = angle;
        turn_of[i] = whole + (angle >= 360.0);
        least_turn = std::min(least_turn, turn_of[i]), most_turn = std::max(most_turn, turn_of[i]);
    }
    if (row.empty()) return rows;
    // The middle of each turn in depth, and the median step from one to the next.
    std::vector<double> total(static_cast<std::size_t>(most_turn - least_turn + 1)), count(total.size()), step;
    for (std::size_t i = 0; i < rows.size(); ++i) {
        const auto turn = static_cast<std::size_t>(turn_of[static_cast<std::size_t>(rows[i])] - least_turn);
        total[turn] += read_once(depth[i]), ++count[turn];
    }
    double before = none;
    for (std::size_t turn = 0; turn < total.size(); ++turn) {
        if (count[turn] == 0.0) continue;
        const double middle = total[turn] / count[turn], off = std::abs(middle - before);
        if (!std::isnan(off)) step.push_back(off);
        before = middle;
    }
    if (!step.empty() && lower_median(step) > longest_turn) return std::nullopt;
    for (Index& of : rows) of = turn_of[static_cast<std::size_t>(of)];
    return rows;
}

SpikedSamples find_spikes(std::span<const double> toolface, std::span<const double> radius,
                          std::span<const std::int64_t> turn, std::optional<std::span<const double>> depth,
                          double threshold, double floor) {
    const StandardArithmetic standard;
    require_length("radius", radius.size(), toolface.size());
    require_length("turn", turn.size(), toolface.size());
    if (depth) require_length("depth", depth->size(), toolface.size());
    require(threshold > 0.0, "threshold", threshold, "must be above 0");
    require(floor > 0.0, "floor", floor, "must be above 0");
    const Rings rings(toolface, radius, turn);
    return SpikeSearch(rings, depth.value_or(std::span<const double>{}), threshold, floor).find();
}

}  // namespace helibore
