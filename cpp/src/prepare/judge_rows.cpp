// Judges the rows of a log before they become samples: where columns disagree, where arms are closed, fully open or
// stuck, and which of their readings are spikes.
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <set>
#include <utility>

#include "base/arithmetic.hpp"
#include "base/host_memory.hpp"
#include "base/messages.hpp"
#include "helibore/preparation.hpp"
#include "prepare/columns.hpp"
#include "samples/helix.hpp"

namespace helibore {

namespace {

constexpr double apart = 0.0025;  // metres by which two columns that look in the same direction disagree
constexpr std::size_t rows_apart = 10;
constexpr double inside_bit = 0.01;  // metres: closed arms lie as far inside the bit, and below the median radius
constexpr double closed_within = 0.002, closed_length = 2.0, standing = 0.01;   // metres
constexpr double closed_at_end = 0.5;                                           // metres: length at an end of the log
constexpr std::size_t closed_rows = 20;                                         // in which closed arms may stand
constexpr double limit_within = 1e-9, limit_below = 0.002, limit_length = 0.5;  // metres
constexpr std::size_t limit_rows = 5, limit_share = 5;
constexpr Index stuck_rows = 100;
constexpr double moving_share = 0.5;
constexpr double fast = 30.0;        // degrees from row to row
constexpr double odd_floor = 0.001;  // metres: least deviation of an arm
constexpr std::size_t longest_burst = 5;
constexpr std::size_t surroundings = 3;                   // rows before and after a run
constexpr std::size_t judged_together = 100;              // rows that share a deviation
constexpr double burst_length = 1.0, jump_length = 0.05;  // metres
constexpr double elsewhere = 2.0, near_angle = 15.0;      // metres, degrees: readings no farther off support a burst
constexpr std::size_t image_directions = 8;
constexpr double none = std::numeric_limits<double>::quiet_NaN();

using Columns = std::vector<std::vector<double>>;

Range range(std::size_t first, std::size_t stop) {
    return {static_cast<Index>(first), static_cast<Index>(stop)};
}

// Calls found(first, stop) for each run of rows for which holds(row).
template <class Holds, class Found>
void each_run(std::size_t count, const Holds& holds, const Found& found) {
    for (std::size_t i = 0; i < count; ++i) {
        if (!holds(i)) continue;
        const std::size_t first = i;
        while (i < count && holds(i)) ++i;
        found(first, i);
    }
}

// Returns the median of the values that are not NaN; NaN if there are none.
double median(std::vector<double> values) {
    values.erase(std::remove_if(values.begin(), values.end(), [](double v) { return std::isnan(v); }), values.end());
    if (values.empty()) return none;
    const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
    std::nth_element(values.begin(), middle, values.end());
    return values.size() % 2 ? *middle : (*std::max_element(values.begin(), middle) + *middle) / 2.0;
}

// Returns the median of a few values, which it sorts.
double median_of_few(std::span<double> values) {
    std::size_t count = 0;
    for (const double value : values) {
        if (std::isnan(value)) continue;
        std::size_t place = count++;
        for (; place > 0 && values[place - 1] > value; --place) values[place] = values[place - 1];
        values[place] = value;
    }
    if (count == 0) return none;
    return count % 2 ? values[count / 2] : (values[count / 2 - 1] + values[count / 2]) / 2.0;
}

// Returns the remainder with the sign of the divisor.
double remainder_of(double value, double divisor) {
    const double rest = std::fmod(value, divisor);
    return rest < 0.0 ? rest + divisor : rest;
}

void blank(Columns& radii, const SuspectRows& suspect) {
    for (std::size_t c = 0; c < radii.size(); ++c)
        if (suspect.column < 0 || suspect.column == static_cast<Index>(c))
            std::fill(radii[c].begin() + suspect.rows.start, radii[c].begin() + suspect.rows.stop, none);
}

void find_disagreements(const Columns& radii, std::span<const ToolSensor> sensors, std::vector<SuspectRows>& found) {
    std::set<std::pair<Index, Index>> pairs;
    for (std::size_t one = 0; one < sensors.size(); ++one)
        for (std::size_t other = 0; other < one; ++other) {
            const ToolSensor &a = sensors[one], &b = sensors[other];
            if (a.column == b.column || a.mounting != b.mounting || a.offset != b.offset) continue;
            if (!pairs.insert({b.column, a.column}).second) continue;
            const std::vector<double>&x = radii[static_cast<std::size_t>(a.column)],
                  &y = radii[static_cast<std::size_t>(b.column)];
            std::vector<double> off(x.size());
            std::transform(x.begin(), x.end(), y.begin(), off.begin(),
                           [](double p, double q) { return std::abs(p - q); });
            std::vector<double> finite;
            std::copy_if(off.begin(), off.end(), std::back_inserter(finite), [](double d) { return std::isfinite(d); });
            const double half = median(std::move(finite));
            const auto add = [&](std::size_t first, std::size_t stop) {
                if (stop - first >= rows_apart || half > apart)
                    found.push_back({Cause::disagreement, b.column, range(first, stop), false, half, a.column});
            };
            each_run(off.size(), [&](std::size_t i) { return off[i] > apart; }, add);
        }
}

// Each row counts by its largest radius. A tool opens where its log begins, or closes where it ends, so that a shorter
// stretch is enough there.
void find_closed(const Columns& radii, std::span<const double> depth, const PreparationSettings& settings,
                 std::vector<SuspectRows>& found) {
    const std::size_t count = depth.size();
    constexpr double most = std::numeric_limits<double>::max();
    std::vector<double> largest(count, none);
    for (std::size_t i = 0; i < count; ++i) {
        bool known = false;
        double radius = -most;
        for (const std::vector<double>& column : radii) {
            known |= std::isfinite(column[i]);
            if (column[i] > radius) radius = std::min(column[i], most);
        }
        if (known) largest[i] = radius;
    }
    double least = none;
    for (const double radius : largest)
        if (!(radius >= least)) least = std::isnan(radius) ? least : radius;
    if (std::isnan(least) || median(largest) < least + inside_bit) return;
    if (settings.bit_diameter && least + inside_bit > 0.5 * *settings.bit_diameter) return;  // a casing, or the hole
    const bool dropped = settings.bit_diameter && settings.drop_closed;
    const auto is_known = [](double radius) { return !std::isnan(radius); };
    const auto before =
        static_cast<std::size_t>(std::find_if(largest.begin(), largest.end(), is_known) - largest.begin());
    const auto beyond =
        static_cast<std::size_t>(std::find_if(largest.rbegin(), largest.rend(), is_known).base() - largest.begin());
    const auto add = [&](Cause cause, std::size_t first, std::size_t stop) {
        if (first < stop) found.push_back({cause, -1, range(first, stop), dropped, least});
    };
    each_run(
        count, [&](std::size_t i) { return largest[i] <= least + closed_within; },
        [&](std::size_t first, std::size_t stop) {
            if (stop - first < 3) return;
            double top = most, bottom = -most;
            for (std::size_t i = first; i < stop; ++i)
                if (std::isfinite(depth[i])) top = std::min(top, depth[i]), bottom = std::max(bottom, depth[i]);
            const double length = bottom >= top ? bottom - top : 0.0;
            const double enough = first == before || stop == beyond ? closed_at_end : closed_length;
            if (length < enough && !(stop - first >= closed_rows && length <= standing)) return;
            std::size_t begin = first, end = stop;
            while (end < count && largest[end] > largest[end - 1]) ++end;
            while (begin > 0 && largest[begin - 1] > largest[begin]) --begin;
            add(Cause::ramp, begin, first);
            add(Cause::closed, first, stop);
            add(Cause::ramp, stop, end);
        });
}

// The largest reading is a limit of the arm if readings accumulate there: at least five times as many as in the 2 mm
// below, and some of them in one run. If more than half of the readings are there, it is no limit, because in a pipe
// most readings are equal. All readings at a limit are dropped, single ones too.
void find_saturated(const Columns& radii, std::span<const double> depth, bool dropped,
                    std::vector<SuspectRows>& found) {
    for (std::size_t c = 0; c < radii.size(); ++c) {
        const std::vector<double>& radius = radii[c];
        double limit = -std::numeric_limits<double>::infinity();
        for (const double value : radius)
            if (std::isfinite(value) && value > limit) limit = value;
        const auto is_top = [&](std::size_t i) {
            return std::isfinite(radius[i]) && radius[i] >= limit - limit_within;
        };
        std::size_t known = 0, top = 0, below = 0;
        for (std::size_t i = 0; i < radius.size(); ++i) {
            if (!std::isfinite(radius[i])) continue;
            ++known;
            if (is_top(i))
                ++top;
            else if (radius[i] > limit - limit_below)
                ++below;
        }
        if (2 * top > known || top < limit_share * below) continue;
        bool stays = false;
        each_run(radius.size(), is_top, [&](std::size_t first, std::size_t stop) {
            stays |= stop - first >= limit_rows && std::abs(depth[stop - 1] - depth[first]) >= limit_length;
        });
        if (!stays) continue;
        each_run(radius.size(), is_top, [&](std::size_t first, std::size_t stop) {
            found.push_back({Cause::saturated, static_cast<Index>(c), range(first, stop), dropped, limit});
        });
    }
}

bool turns_fast(std::span<const double> toolface) {
    std::vector<double> turned;
    for (std::size_t i = 1; i < toolface.size(); ++i)
        if (const double off = toolface[i] - toolface[i - 1]; std::isfinite(off))
            turned.push_back(std::abs(wrap_toolface(off + 180.0) - 180.0));
    return median(std::move(turned)) > fast;
}

double middle_of(const double* three) {
    const auto [low, high] = std::minmax(three[0], three[1]);
    return std::max(low, std::min(high, three[2]));
}

// By how much an arm leaves its surroundings in each row of a run, less what the other arms do.
class Alone {
  public:
    explicit Alone(const Columns& radii) : radii_(radii), off_(radii.size()), others_(radii.size()) {}

    void look(std::size_t first, std::size_t length) {
        length_ = length;
        for (std::size_t arm = 0; arm < radii_.size(); ++arm) {
            const double* radius = radii_[arm].data() + first;
            const double before = middle_of(radius - surroundings);
            const double slope = (middle_of(radius + length) - before) / static_cast<double>(length + surroundings);
            for (std::size_t k = 0; k < length; ++k)
                off_[arm][k] = radius[k] - before - slope * static_cast<double>(k + 2);
        }
    }

    std::span<const double> of(std::size_t arm) {
        for (std::size_t k = 0; k < length_; ++k) {
            for (std::size_t other = 0; other < radii_.size(); ++other)
                others_[other] = other == arm ? none : off_[other][k];
            alone_[k] = off_[arm][k] - median_of_few(others_);
        }
        return {alone_.data(), length_};
    }

    double median_of(std::size_t arm) {
        of(arm);
        std::array<double, longest_burst> sorted = alone_;
        return median_of_few({sorted.data(), length_});
    }

  private:
    const Columns& radii_;
    std::vector<std::array<double, longest_burst>> off_;
    std::vector<double> others_;
    std::array<double, longest_burst> alone_{};
    std::size_t length_ = 0;
};

// Finds the spikes of few arms. An odd reading is one of a burst if few of its arm follow each other, no other arm is
// odd in the same way beside it, and no reading elsewhere, near in depth and toolface, is as far off. It is one of a
// jump if most arms are odd in the same way.
// Where the hole is rough, few readings are odd. So a row is a jump as well if its arms leave together the rows beside
// it, which agree, and a run of one arm is a burst if it leaves its surroundings by more than the other arms do.
class Spikes {
  public:
    Spikes(const Columns& radii, std::span<const double> depth, std::span<const double> toolface,
           std::span<const ToolSensor> sensors, const PreparationSettings& settings)
        : radii_(radii),
          toolface_(toolface),
          mounting_(radii.size()),
          ways_(radii.size()),
          threshold_(settings.spikes),
          dropped_(settings.drop_spikes) {
        std::vector<std::size_t> seen(radii.size());
        for (const ToolSensor& sensor : sensors) {
            const auto c = static_cast<std::size_t>(sensor.column);
            if (seen[c]++ == 0) mounting_[c] = sensor.mounting;
            ways_[c] = seen[c] > 1 ? 180.0 : 360.0;  // a diameter looks both ways
        }
        for (const std::vector<double>& radius : radii)
            odd_.push_back(odd_readings(radius, settings.spikes, odd_floor));
        along_.resize(depth.size());
        double along = 0.0;
        for (std::size_t i = 0; i < depth.size(); ++i) {
            const double moved = i > 0 ? std::abs(depth[i] - depth[i - 1]) : 0.0;
            along_[i] = along += std::isnan(moved) ? 0.0 : std::min(moved, std::numeric_limits<double>::max());
        }
    }

    void find(std::vector<SuspectRows>& found) {
        const std::size_t count = along_.size();
        std::vector<char> jump(count);
        for (const int sign : {-1, 1})
            each_run(
                count, [&](std::size_t i) { return most_are(sign, i); },
                [&](std::size_t first, std::size_t stop) {
                    if (stop - first == 1 || along_[stop - 1] - along_[first] <= jump_length)
                        std::fill(jump.begin() + static_cast<std::ptrdiff_t>(first),
                                  jump.begin() + static_cast<std::ptrdiff_t>(stop), 1);
                });
        mark_lone_rows(jump);
        for (std::size_t arm = 0; arm < radii_.size(); ++arm)
            for (const int sign : {-1, 1})
                each_run(
                    count, [&](std::size_t i) { return odd_[arm][i] == sign && !jump[i]; },
                    [&](std::size_t first, std::size_t stop) {
                        if (is_burst(arm, sign, first, stop))
                            found.push_back(
                                {Cause::burst, static_cast<Index>(arm), range(first, stop), dropped_, none});
                    });
        each_run(
            count, [&](std::size_t i) { return jump[i] != 0; },
            [&](std::size_t first, std::size_t stop) {
                found.push_back({Cause::jump, -1, range(first, stop), dropped_, none});
            });
        find_runs(found);
    }

  private:
    // Returns for each row the threshold times the robust deviation of the values in its block of rows, or times the
    // least deviation.
    std::vector<double> limits(const std::vector<double>& values) const {
        std::vector<double> limit(values.size());
        const std::size_t blocks = std::max<std::size_t>(1, values.size() / judged_together);
        for (std::size_t block = 0; block < blocks; ++block) {
            const std::size_t first = block * values.size() / blocks, stop = (block + 1) * values.size() / blocks;
            std::vector<double> far(values.begin() + static_cast<std::ptrdiff_t>(first),
                                    values.begin() + static_cast<std::ptrdiff_t>(stop));
            for (double& value : far) value = std::abs(value);
            const double deviation = 1.4826 * median(std::move(far));
            std::fill(limit.begin() + static_cast<std::ptrdiff_t>(first),
                      limit.begin() + static_cast<std::ptrdiff_t>(stop),
                      threshold_ * (deviation > odd_floor ? deviation : odd_floor));
        }
        return limit;
    }

    void mark_lone_rows(std::vector<char>& jump) const {
        const std::size_t count = along_.size();
        std::vector<double> left(count, none), beside(count, none), off(radii_.size()), sorted(radii_.size());
        for (std::size_t i = 1; i + 1 < count; ++i) {
            double known = 0.0, with = 0.0;
            for (std::size_t arm = 0; arm < radii_.size(); ++arm) {
                const std::vector<double>& radius = radii_[arm];
                sorted[arm] = off[arm] = radius[i] - 0.5 * (radius[i - 1] + radius[i + 1]);
                known += std::isfinite(off[arm]);
            }
            left[i] = median_of_few(sorted);
            for (const double value : off) with += value * left[i] > 0.5 * left[i] * left[i];
            if (with < 2.0 || with < 0.75 * known) continue;
            for (std::size_t arm = 0; arm < radii_.size(); ++arm)
                sorted[arm] = std::abs(radii_[arm][i - 1] - radii_[arm][i + 1]);
            beside[i] = median_of_few(sorted);
        }
        const std::vector<double> limit = limits(left);
        for (std::size_t i = 0; i < count; ++i)
            if (std::abs(left[i]) > limit[i] && beside[i] < 0.5 * std::abs(left[i])) jump[i] = 1;
    }

    // Finds runs of one arm that step away and back by more than the other arms do in the same rows. What is found
    // is left out, and the rest is looked at once more.
    void find_runs(std::vector<SuspectRows>& found) const {
        const std::size_t count = along_.size();
        Columns left = radii_;
        for (const SuspectRows& each : found)
            if (each.cause == Cause::burst || each.cause == Cause::jump) blank(left, each);
        for (int round = 0; round < 2; ++round) {
            Columns filled = left;
            for (std::vector<double>& radius : filled) fill_in(radius);
            Alone alone(filled);
            const std::size_t before = found.size();
            for (std::size_t length = std::min(longest_burst, count); length > 0; --length) {
                if (count <= length + 2 * surroundings) continue;
                Columns off(radii_.size(), std::vector<double>(count, none));
                for (std::size_t first = surroundings; first + length + surroundings <= count; ++first) {
                    alone.look(first, length);
                    for (std::size_t arm = 0; arm < off.size(); ++arm) off[arm][first] = alone.median_of(arm);
                }
                for (std::size_t arm = 0; arm < off.size(); ++arm) {
                    const std::vector<double> limit = limits(off[arm]);
                    for (std::size_t first = surroundings; first + length + surroundings <= count; ++first) {
                        if (!(std::abs(off[arm][first]) > limit[first])) continue;
                        const SuspectRows run{Cause::burst, static_cast<Index>(arm), range(first, first + length),
                                              dropped_, none};
                        if (!is_run(left[arm], filled[arm], alone, off, run, limit[first])) continue;
                        found.push_back(run);
                        blank(left, run);
                    }
                }
            }
            if (found.size() == before) break;
        }
    }

    // Fills missing readings in, linearly by row.
    static void fill_in(std::vector<double>& radius) {
        const std::vector<double> given = radius;
        each_run(
            given.size(), [&](std::size_t i) { return std::isnan(given[i]); },
            [&](std::size_t first, std::size_t stop) {
                const double before = first > 0 ? given[first - 1] : stop < given.size() ? given[stop] : none;
                const double after = stop < given.size() ? given[stop] : before;
                for (std::size_t i = first; i < stop; ++i)
                    radius[i] = before + (after - before) * static_cast<double>(i + 1 - first) /
                                             static_cast<double>(stop + 1 - first);
            });
    }

    // Returns whether a run leaves its surroundings at once and comes back at once, alone, and is not seen elsewhere.
    bool is_run(const std::vector<double>& left, const std::vector<double>& radius, Alone& alone, const Columns& off,
                const SuspectRows& run, double limit) const {
        const auto arm = static_cast<std::size_t>(run.column), first = static_cast<std::size_t>(run.rows.start),
                   stop = static_cast<std::size_t>(run.rows.stop);
        if (along_[stop - 1] - along_[first] > burst_length) return false;
        for (std::size_t i = first; i < stop; ++i)
            if (std::isnan(left[i])) return false;
        const double height = off[arm][first], sign = height > 0.0 ? 1.0 : -1.0;
        alone.look(first, stop - first);
        for (const double value : alone.of(arm))
            if (!(sign * value > limit)) return false;
        if (!(sign * (radius[first] - radius[first - 1]) > 0.5 * std::abs(height)) ||
            !(sign * (radius[stop - 1] - radius[stop]) > 0.5 * std::abs(height)))
            return false;
        for (std::size_t other = 0; other < off.size(); ++other)
            if (other != arm && sign * off[other][first] > 0.5 * std::abs(height)) return false;
        return !seen_elsewhere(arm, first, stop);
    }

    bool most_are(int sign, std::size_t i) const {
        std::size_t with = 0, known = 0;
        for (std::size_t arm = 0; arm < radii_.size(); ++arm) {
            with += odd_[arm][i] == sign;
            known += std::isfinite(radii_[arm][i]);
        }
        return with >= 2 && static_cast<double>(with) >= 0.75 * static_cast<double>(known);
    }

    bool is_burst(std::size_t arm, int sign, std::size_t first, std::size_t stop) const {
        if (stop - first > longest_burst || along_[stop - 1] - along_[first] > burst_length) return false;
        for (std::size_t other = 0; other < radii_.size(); ++other)
            for (std::size_t i = first > 0 ? first - 1 : 0; other != arm && i < std::min(stop + 1, along_.size()); ++i)
                if (odd_[other][i] == sign) return false;
        return !seen_elsewhere(arm, first, stop);
    }

    // Returns whether a reading outside the burst differs from its middle by less than a quarter of the burst's height
    // over the readings before and after.
    bool seen_elsewhere(std::size_t arm, std::size_t first, std::size_t stop) const {
        const std::vector<double>& radius = radii_[arm];
        const auto at = [&](std::size_t i) { return radius.begin() + static_cast<std::ptrdiff_t>(i); };
        const double middle = median({at(first), at(stop)});
        std::vector<double> beside(at(first > 3 ? first - 3 : 0), at(first));
        beside.insert(beside.end(), at(stop), at(std::min(stop + 3, radius.size())));
        const double height = std::abs(middle - median(std::move(beside)));
        if (std::isnan(height)) return false;
        const double angle = toolface_[(first + stop) / 2] + mounting_[arm];
        const auto row = [&](auto place) { return static_cast<std::size_t>(place - along_.begin()); };
        const std::size_t begin = row(std::lower_bound(along_.begin(), along_.end(), along_[first] - elsewhere));
        const std::size_t end = row(std::upper_bound(along_.begin(), along_.end(), along_[stop - 1] + elsewhere));
        for (std::size_t other = 0; other < radii_.size(); ++other) {
            const double half = 0.5 * std::min(ways_[other], ways_[arm]);
            for (std::size_t i = begin; i < end; ++i) {
                if (!(std::abs(radii_[other][i] - middle) < 0.25 * height) || lone(other, i)) continue;
                if (other == arm && i >= first && i < stop) continue;
                const double turned = toolface_[i] + mounting_[other] - angle + half;
                if (std::abs(remainder_of(turned, 2.0 * half) - half) <= near_angle) return true;
            }
        }
        return false;
    }

    // Returns whether a reading is odd in a row of its own, which supports no other.
    bool lone(std::size_t arm, std::size_t i) const {
        const std::vector<std::int64_t>& odd = odd_[arm];
        return odd[i] != 0 && (i == 0 || odd[i - 1] != odd[i]) && (i + 1 == odd.size() || odd[i + 1] != odd[i]);
    }

    const Columns& radii_;
    std::span<const double> toolface_;
    std::vector<double> mounting_, ways_;  // degrees; after how many degrees a column looks the same way
    std::vector<std::vector<std::int64_t>> odd_;
    std::vector<double> along_;  // metres that the tool has moved
    double threshold_;
    bool dropped_;
};

}  // namespace

bool is_image(std::span<const ToolSensor> sensors) {
    std::set<std::pair<double, double>> looks;
    for (const ToolSensor& sensor : sensors)
        looks.insert({sensor.offset, std::fmod(std::round(remainder_of(sensor.mounting, 360.0) * 1e3) / 1e3, 360.0)});
    std::size_t directions = 0;
    double offset = none;
    for (const auto& look : looks) {
        directions = look.first == offset ? directions + 1 : 1;
        offset = look.first;
        if (directions >= image_directions) return true;
    }
    return false;
}

std::vector<SuspectRows> stuck_arms(std::span<const std::span<const double>> given, Index rows, double moving) {
    const std::size_t width = given.size(), count = width ? given[0].size() : 0;
    std::vector<std::vector<Index>> moves(width, std::vector<Index>(count + 1));
    std::vector<Index> total(count + 1);
    Columns radii;
    for (std::size_t arm = 0; arm < width; ++arm) {
        require_length(entry_name("arms", static_cast<Index>(arm)), given[arm].size(), count, "arms[0]");
        const std::vector<double>& radius = radii.emplace_back(copied(given[arm]));
        for (std::size_t i = 0; i < count; ++i) {
            const bool same =
                i > 0 && (radius[i] == radius[i - 1] || (std::isnan(radius[i]) && std::isnan(radius[i - 1])));
            moves[arm][i + 1] = moves[arm][i] + !same;
            total[i + 1] += moves[arm][i + 1];
        }
    }
    std::vector<SuspectRows> found;
    for (std::size_t arm = 0; arm < width; ++arm) {
        const auto others = [&](std::size_t i) { return total[i] - moves[arm][i]; };
        for (std::size_t first = 0, stop; first < count; first = stop) {
            for (stop = first + 1; stop < count && moves[arm][stop + 1] == moves[arm][stop];) ++stop;
            if (static_cast<Index>(stop - first) < rows) continue;
            const auto steps = static_cast<double>(std::max<std::size_t>(stop - first - 1, 1) * (width - 1));
            const auto moved = static_cast<double>(others(stop) - others(std::min(first + 1, stop)));
            if (moved / steps >= moving)
                found.push_back({Cause::stuck, static_cast<Index>(arm), range(first, stop), false, radii[arm][first]});
        }
    }
    return found;
}

std::vector<SuspectRows> judge_rows(const ToolRows& rows, std::span<const ToolSensor> sensors,
                                    const PreparationSettings& settings) {
    const StandardArithmetic standard;
    require_columns(rows, sensors);
    require(settings.spikes > 0.0, "spikes", settings.spikes, "must be above 0");
    std::vector<SuspectRows> found;
    if (is_image(sensors)) return found;
    const std::vector<double> depth = copied(rows.depth);
    Columns radii;
    for (const std::span<const double> radius : rows.radii) radii.push_back(copied(radius));
    std::size_t judged = 0;
    const auto drop = [&] {
        for (; judged < found.size(); ++judged)
            if (found[judged].dropped) blank(radii, found[judged]);
    };
    find_disagreements(radii, sensors, found);
    find_closed(radii, depth, settings, found);
    drop();
    find_saturated(radii, depth, settings.drop_saturated, found);
    drop();
    if (radii.size() < 2) return found;
    const std::vector<std::span<const double>> arms(radii.begin(), radii.end());
    const std::vector<SuspectRows> stuck = stuck_arms(arms, stuck_rows, moving_share);
    found.insert(found.end(), stuck.begin(), stuck.end());
    const std::vector<double> toolface = copied(rows.toolface);
    if (!turns_fast(toolface)) Spikes(radii, depth, toolface, sensors, settings).find(found);
    return found;
}

namespace {

void leave_out(ToolSamples& samples, const std::vector<Index>& spikes) {
    const auto from = [&](auto& column) {
        if (column.empty()) return;
        std::size_t kept = 0, next = 0;
        for (std::size_t i = 0; i < column.size(); ++i) {
            if (next < spikes.size() && spikes[next] == static_cast<Index>(i))
                ++next;
            else
                column[kept++] = column[i];
        }
        column.resize(kept);
    };
    from(samples.depth), from(samples.toolface), from(samples.radius), from(samples.time);
    from(samples.sensor), from(samples.row);
}

}  // namespace

Prepared prepare(const ToolRows& given, std::span<const ToolSensor> sensors, const PreparationSettings& settings) {
    Prepared found;
    found.suspects = judge_rows(given, sensors, settings);
    Columns radii;
    for (const std::span<const double> radius : given.radii) radii.push_back(copied(radius));
    for (const SuspectRows& suspect : found.suspects) {
        if (suspect.cause == Cause::disagreement && suspect.radius > apart)
            throw InputError(entry_name("radii", suspect.column) + " and " + entry_name("radii", suspect.other),
                             "look in the same direction and differ by " + short_text(1e3 * suspect.radius) +
                                 " mm of radius in half of the rows: name the column to use");
        if (suspect.dropped) blank(radii, suspect);
    }
    ToolRows rows = given;
    rows.radii.assign(radii.begin(), radii.end());
    found.samples = observe_by_depth(rows, sensors);
    const ToolSamples& samples = found.samples;
    const auto turn =
        is_image(sensors) ? std::optional(samples.row) : turns_by_rotation(given.toolface, samples.row, samples.depth);
    const auto of_arms = settings.drop_spikes ? std::optional(settings.spikes) : std::nullopt;
    if (const auto threshold = turn ? settings.turn_spikes : of_arms) {
        const std::vector<Index> spikes =
            find_spikes(samples.toolface, samples.radius, turn.value_or(samples.row), samples.depth, *threshold)
                .samples;
        found.spikes = std::ssize(spikes);
        leave_out(found.samples, spikes);
    }
    if (!rows.time) found.repeats = share_of_repeats(samples.depth, samples.toolface, samples.radius, Index{1} << 15);
    return found;
}

}  // namespace helibore
