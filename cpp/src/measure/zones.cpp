// Kinds of turns, runs of turns of one kind, and the zones that they make. Runs are judged side by side: none depends
// on whether another is a zone.
#include "helibore/zones.hpp"

#include <algorithm>
#include <cmath>
#include <string>

#include "base/arithmetic.hpp"
#include "base/degrees.hpp"
#include "base/messages.hpp"
#include "base/threads.hpp"
#include "base/trigonometry.hpp"
#include "helibore/unworn.hpp"
#include "measure/lobes.hpp"
#include "measure/slots.hpp"
#include "samples/helix.hpp"

namespace helibore {

namespace {

constexpr double missing = std::numeric_limits<double>::quiet_NaN();
constexpr double likely = 0.5;         // least confidence of a zone
constexpr double most_likely = 0.99;   // greatest one: no kind is certain, as no library has every section
constexpr double two_sided = 0.625;    // share of breakouts among them and key seats, which diameters show alike
constexpr double not_gauge = 0.05;     // probability of gauge below which a run is a zone, whatever its kind
constexpr double least_sampled = 0.5;  // a wall shows no kind where a smaller share of a turn has samples near
// Parts near samples in a turn that has a kind, unless arms measure it: three places show a hazard, but it takes more
// than four to show that there is none.
constexpr Index least_seen = 8, least_seen_of_gauge = 13;
constexpr double together = 0.25;          // metres above and below a turn with few samples that make its section
constexpr std::size_t compared = 6;        // most turns of a zone that are compared with the library
constexpr double opposite = 140.0;         // least degrees between opposite lobes
constexpr double widest_key_seat = 150.0;  // degrees
constexpr double one_axis = 1e-3;          // degrees; arms whose axes deviate less do not turn
constexpr double slot_height = 0.8, slot_bottom = 0.35;  // shares of the usual height of a key seat
constexpr double nearly = 0.65;      // of the median of a run: a zone goes on where the hole has as much
constexpr double long_share = 0.65;  // of a lobe's height, as a mean over the least length of a zone
constexpr double rounding = 1e-9;    // metres

struct Heights {
    std::vector<double> lower, higher;  // of the lobe opposite to the highest, 0 without one, and of the highest
};

struct Run {
    HoleKind kind;
    std::size_t first, stop;
    std::vector<std::size_t> inside;  // the turns that meet the criterion
};

double median(std::vector<double> values) {
    if (values.empty()) return missing;
    const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
    std::ranges::nth_element(values, middle);
    if (values.size() % 2 == 1) return *middle;
    return (*std::max_element(values.begin(), middle) + *middle) / 2.0;
}

class Finder {
  public:
    Finder(const MeasuredTurns& turns, const TurnVertices& vertices, double bit, const ZoneCriteria& criteria,
           const ChainedTurns& chained)
        : turns_(turns),
          vertices_(vertices),
          bit_(bit),
          criteria_(criteria),
          chained_(chained),
          count_(turns.depth.size()),
          sectors_(static_cast<std::size_t>(vertices.sectors)),
          height_(std::abs(vertices.pitch)),
          arms_(!turns.uneven.empty()),
          diameters_(turns.samples.diameters || measures_diameters(turns.samples.arms)),
          start_toolface_(wrap_toolface(vertices.start_toolface)) {
        if (!chained.kinds.empty()) sparse_ = sparse_turns(turns.sections, height_);
        for (std::size_t k = 0; k < sectors_; ++k)
            directions_.push_back(
                sine_cosine(start_toolface_ + static_cast<double>(k) * 360.0 / static_cast<double>(sectors_)));
    }

    Zones find(const SectionLibraries& libraries, int threads) {
        find_heights();
        const std::vector<HoleKind> kinds = kinds_of_turns();
        const std::vector<Run> runs = runs_of(kinds);
        std::vector<Zone> zones(runs.size());
        std::vector<std::uint8_t> found(runs.size());
        if (!runs.empty()) libraries.of(diameters_);  // drawn here, once, and not by each thread
        for_each_part(threads, static_cast<Index>(runs.size()), [&](int, Index part) {
            const auto i = static_cast<std::size_t>(part);
            double confidence = 0.0;
            if (!is_zone(runs[i], libraries, confidence)) return;
            zones[i] = zone_of(runs[i]), zones[i].confidence = confidence;
            found[i] = 1;
        });
        Zones out;
        for (std::size_t turn = 0; turn < count_; ++turn)
            out.kinds.push_back(kinds[turn] == HoleKind::none || !shows_gauge(turn) ? HoleKind::none : HoleKind::gauge);
        for (std::size_t i = 0; i < runs.size(); ++i) {
            if (found[i] == 0) continue;
            for (const std::size_t turn : runs[i].inside) out.kinds[turn] = runs[i].kind;
            out.zones.push_back(zones[i]);
        }
        std::ranges::stable_sort(out.zones, {}, &Zone::start);
        return out;
    }

  private:
    void find_heights() {
        heights_ = {std::vector<double>(count_), std::vector<double>(count_)};
        for (std::size_t turn = 0; turn < count_; ++turn) {
            double& lower = heights_.lower[turn];
            double& higher = heights_.higher[turn];
            if (arms_) {
                const double half = (turns_.c1[turn] - turns_.c2[turn]) / 2.0, off = turns_.uneven[turn] / 2.0;
                lower = half - off, higher = half + off;
                continue;
            }
            const auto& [first, second] = turns_.lobes;
            const double apart = std::abs(wrap_difference(first.toolface[turn] - second.toolface[turn]));
            lower = apart >= opposite && is_long(turn, second) ? second.height[turn] : 0.0;
            higher = is_long(turn, first) ? first.height[turn] : 0.0;
        }
    }

    // Whether the wall is about as high as in a lobe of a turn along the least length of a zone at the lobe's toolface.
    // An open fracture crosses the hole: there it is as high over its aperture only.
    bool is_long(std::size_t turn, const MeasuredTurns::Lobe& lobe) const {
        const double top = lobe.height[turn], far = turns_.unworn_diameter[turn] / 2.0 + top;
        if (std::isnan(far)) return false;
        const SineCosine towards = sine_cosine(lobe.toolface[turn]);  // as seen from the centre of the unworn circle
        const double x = turns_.unworn_0[turn] + far * towards.cosine, y = turns_.unworn_90[turn] + far * towards.sine;
        std::size_t k = 0;
        double most = -1.0;
        for (std::size_t i = 0; i < sectors_; ++i)
            if (const double along = x * directions_[i].cosine + y * directions_[i].sine; along > most)
                most = along, k = i;
        const auto length = static_cast<std::size_t>(
            nearest_whole(std::clamp(criteria_.least_length / height_, 1.0, static_cast<double>(count_))));
        const std::size_t low = turn + 1 - std::min(turn + 1, length), high = std::min(turn + length, count_);
        double sum = 0.0;  // over `length` turns that end with turn i
        for (std::size_t i = low; i < high; ++i) {
            sum += height_at(i, k, top);
            if (i + 1 < low + length) continue;
            if (sum >= long_share * top * static_cast<double>(length)) return true;
            sum -= height_at(i + 1 - length, k, top);
        }
        return false;
    }

    // Returns how high the wall is over the unworn circle, from 0 to `top`; 0 where it is missing.
    double height_at(std::size_t turn, std::size_t k, double top) const {
        const double r = vertices_.radius[turn * sectors_ + k];
        const double x = r * directions_[k].cosine - turns_.unworn_0[turn],
                     y = r * directions_[k].sine - turns_.unworn_90[turn];
        const double height = std::sqrt(x * x + y * y) - turns_.unworn_diameter[turn] / 2.0;
        return height > 0.0 ? std::min(height, top) : 0.0;
    }

    // Returns the kind of each turn without regard to its neighbours, but to the chain where turns have few samples.
    std::vector<HoleKind> kinds_of_turns() {
        std::vector<HoleKind> kinds(count_);
        for (std::size_t turn = 0; turn < count_; ++turn) kinds[turn] = kind_by_criteria(turn);
        if (sparse_.empty()) return kinds;
        for (std::size_t turn = 0; turn < count_; ++turn) {
            if (sparse_[turn] == 0.0) continue;
            kinds[turn] = likeliest(turn);
            if (const double height = turns_.lobes[0].height[turn]; std::isnan(height)) {
                heights_.higher[turn] = turns_.c1[turn] - bit_;
            } else if (!arms_) {
                heights_.higher[turn] = height;
            }
        }
        return kinds;
    }

    HoleKind kind_by_criteria(std::size_t turn) const {
        const double lower = heights_.lower[turn], higher = heights_.higher[turn];
        if (std::isnan(arms_ ? turns_.c1[turn] : turns_.mean[turn])) return HoleKind::none;
        if (!arms_ && turns_.sampled[turn] < least_sampled) return HoleKind::none;
        if (turns_.least_diameter[turn] < bit_ - criteria_.undergauge) return HoleKind::undergauge;
        if (turns_.c2[turn] - bit_ >= criteria_.washout) return HoleKind::washout;
        const bool both = lower > 0.0 && 2.0 * lower >= criteria_.symmetry * (lower + higher);
        if (both)
            return turns_.c1[turn] - turns_.c2[turn] >= criteria_.elongation ? HoleKind::breakout : HoleKind::gauge;
        const bool narrow = arms_ || turns_.lobes[0].width[turn] <= widest_key_seat;
        return higher >= criteria_.key_seat && narrow ? HoleKind::key_seat : HoleKind::gauge;
    }

    bool is_chained(std::size_t turn) const {
        return (arms_ || chained_.seen[turn] >= least_seen) && !std::isnan(chained_.kinds[turn * hole_kinds]);
    }

    bool shows_gauge(std::size_t turn) const {
        return arms_ || sparse_.empty() || sparse_[turn] == 0.0 || chained_.seen[turn] >= least_seen_of_gauge;
    }

    HoleKind likeliest(std::size_t turn) const {
        if (std::isnan(turns_.c1[turn]) || std::isnan(turns_.c2[turn]) || !is_chained(turn)) return HoleKind::none;
        const std::span<const double> of = chained_.kinds.subspan(turn * hole_kinds, hole_kinds);
        return static_cast<HoleKind>(std::ranges::max_element(of) - of.begin());
    }

    // Returns the runs of all kinds that are long enough. Washouts come first, so that two breakouts are not joined
    // over a washout between them.
    std::vector<Run> runs_of(const std::vector<HoleKind>& kinds) const {
        std::vector<std::uint8_t> is_free(count_);
        for (std::size_t turn = 0; turn < count_; ++turn) is_free[turn] = kinds[turn] == HoleKind::none ? 0 : 1;
        std::vector<Run> out;
        for (const HoleKind kind : {HoleKind::washout, HoleKind::undergauge, HoleKind::breakout, HoleKind::key_seat}) {
            const auto fits = [&](std::size_t turn) { return kinds[turn] == kind && is_free[turn] != 0; };
            std::vector<Run> joined;
            for (std::size_t first = 0, stop = 0; first < count_; first = std::max(stop, first + 1)) {
                for (stop = first; stop < count_ && fits(stop);) ++stop;
                if (stop == first) continue;
                const std::size_t before = joined.empty() ? 0 : joined.back().stop;
                Run run{kind, first, stop, {}};
                if (kind == HoleKind::breakout || kind == HoleKind::washout) go_on(run, before, kinds, is_free);
                if (!joined.empty() && run.first <= before + few() &&
                    std::all_of(is_free.begin() + static_cast<std::ptrdiff_t>(before),
                                is_free.begin() + static_cast<std::ptrdiff_t>(std::max(run.first, before)),
                                [](std::uint8_t free) { return free != 0; })) {
                    joined.back().stop = std::max(run.stop, before);
                } else {
                    joined.push_back(std::move(run));
                }
            }
            for (Run& run : joined) {
                for (std::size_t turn = run.first; turn < run.stop; ++turn)
                    if (kinds[turn] == kind) run.inside.push_back(turn);
                const auto length = static_cast<double>(run.inside.back() + 1 - run.inside.front());
                if (length * height_ >= criteria_.least_length - rounding) out.push_back(std::move(run));
            }
            for (const Run& run : out)
                for (std::size_t turn = run.first; turn < run.stop; ++turn) is_free[turn] = 0;
        }
        return out;
    }

    // Returns how many turns between two parts of a zone may be otherwise.
    std::size_t few() const {
        return static_cast<std::size_t>(std::min((criteria_.join + rounding) / height_, static_cast<double>(count_)));
    }

    // Lets a run go on, not above the turn `before`, where the hole is of no other kind and has nearly as much; few
    // turns may have less. Noise makes any turn nearly undergauge or a key seat, so they do not go on.
    void go_on(Run& run, std::size_t before, const std::vector<HoleKind>& kinds,
               const std::vector<std::uint8_t>& is_free) const {
        std::vector<double> measures;
        for (std::size_t turn = run.first; turn < run.stop; ++turn) measures.push_back(measure_of(run.kind, turn));
        const double least = nearly * median(std::move(measures));
        const auto has_as_much = [&](std::size_t turn) {
            return (kinds[turn] == run.kind || kinds[turn] == HoleKind::gauge) && measure_of(run.kind, turn) >= least;
        };
        for (std::size_t turn = run.first; turn > before && is_free[turn - 1] != 0 && run.first <= turn + few(); --turn)
            if (has_as_much(turn - 1)) run.first = turn - 1;
        run.stop = std::max(run.stop, before);
        for (std::size_t turn = run.stop; turn < count_ && is_free[turn] != 0 && turn <= run.stop + few(); ++turn)
            if (has_as_much(turn)) run.stop = turn + 1;
    }

    // Whether the kind of a run is likely enough, or certainly not gauge; writes its confidence.
    bool is_zone(const Run& run, const SectionLibraries& libraries, double& confidence) const {
        const LikelyKind found = likely_kind(sections_of(run.inside), libraries.of(diameters_));
        std::array<double, hole_kinds> kinds = found.kinds;
        if (!sparse_.empty()) take_chained(run.inside, kinds);
        const double own = kinds[static_cast<std::size_t>(run.kind)];
        const bool alike = diameters_ && run.kind == HoleKind::breakout;
        confidence = found.sound ? std::clamp(alike ? two_sided * own : own, likely, most_likely) : likely;
        return !(own < likely && kinds[0] > not_gauge);
    }

    // Takes the mean of the chained kinds if more than half of the turns are sparse.
    void take_chained(const std::vector<std::size_t>& inside, std::array<double, hole_kinds>& kinds) const {
        double count = 0.0, known = 0.0;
        std::array<double, hole_kinds> sum{};
        for (const std::size_t turn : inside) {
            count += sparse_[turn];
            if (!is_chained(turn)) continue;
            known += 1.0;
            for (std::size_t kind = 0; kind < hole_kinds; ++kind) sum[kind] += chained_.kinds[turn * hole_kinds + kind];
        }
        if (!(count / static_cast<double>(inside.size()) > 0.5)) return;
        for (std::size_t kind = 0; kind < hole_kinds; ++kind) kinds[kind] = sum[kind] / known;
    }

    // Returns the sections of a few of the turns, radius less half the bit diameter. A turn of which less than half has
    // samples is taken together with its neighbours.
    std::vector<double> sections_of(const std::vector<std::size_t>& inside) const {
        std::vector<double> out;
        const double last = static_cast<double>(inside.size() - 1), step = last / static_cast<double>(compared - 1);
        std::size_t before = inside.size();
        for (std::size_t i = 0; i < compared; ++i) {
            const auto place = static_cast<std::size_t>(i + 1 < compared ? static_cast<double>(i) * step : last);
            if (place != before) add_section(inside[place], out);
            before = place;
        }
        return out;
    }

    void add_section(std::size_t turn, std::vector<double>& out) const {
        const std::size_t at = out.size();
        const std::span<const double> own = turns_.sections.subspan(turn * section_parts, section_parts);
        for (const double radius : own) out.push_back(radius - bit_ / 2.0);
        if (2 * std::ranges::count_if(own, [](double radius) { return std::isfinite(radius); }) >=
            static_cast<std::ptrdiff_t>(section_parts))
            return;
        const double reach = nearest_whole(std::min(together / height_, static_cast<double>(count_)));
        const auto beside = static_cast<std::size_t>(reach);
        std::array<double, section_parts> sum{}, known{};
        for (std::size_t i = turn - std::min(turn, beside); i < std::min(turn + beside + 1, count_); ++i)
            for (std::size_t part = 0; part < section_parts; ++part)
                if (const double radius = turns_.sections[i * section_parts + part]; std::isfinite(radius))
                    sum[part] += radius, known[part] += 1.0;
        for (std::size_t part = 0; part < section_parts; ++part)
            if (known[part] > 0.0) out[at + part] = sum[part] / known[part] - bit_ / 2.0;
    }

    double limit_of(HoleKind kind) const {
        switch (kind) {
            case HoleKind::washout:
                return criteria_.washout;
            case HoleKind::breakout:
                return criteria_.elongation;
            case HoleKind::key_seat:
                return criteria_.key_seat;
            default:
                return -criteria_.undergauge;
        }
    }

    // Returns the length that the limit of a kind is for.
    double measure_of(HoleKind kind, std::size_t turn) const {
        switch (kind) {
            case HoleKind::washout:
                return turns_.c2[turn] - bit_;
            case HoleKind::breakout:
                return turns_.c1[turn] - turns_.c2[turn];
            case HoleKind::key_seat:
                return heights_.higher[turn];
            default:
                return turns_.least_diameter[turn] - bit_;
        }
    }

    Zone zone_of(const Run& run) const {
        const bool under = run.kind == HoleKind::undergauge;
        const auto is_beyond = [&](double a, double b) { return under ? a < b : a > b; };
        Zone out{.kind = run.kind,
                 .start = std::min(turns_.depth[run.first], turns_.depth[run.stop - 1]) - height_ / 2.0,
                 .stop = std::max(turns_.depth[run.first], turns_.depth[run.stop - 1]) + height_ / 2.0,
                 .measure = missing,
                 .median = missing,
                 .severity = missing,
                 .enlargement = missing,
                 .elongation = missing,
                 .peak = missing,
                 .coverage = 0.0,
                 .confidence = missing,
                 .pipe_diameter = missing,
                 .toolface = missing,
                 .deviation = missing,
                 .lobes{{{missing, missing, missing}, {missing, missing, missing}}}};
        std::vector<double> measures;
        for (const std::size_t turn : run.inside) {
            const double size = (under ? turns_.least_diameter[turn] : turns_.c1[turn]) - bit_;
            const double measure = measure_of(run.kind, turn), elongation = turns_.c1[turn] - turns_.c2[turn];
            const bool is_first = measures.empty();
            if (is_first || is_beyond(measure, out.measure)) out.measure = measure;
            if (is_first || elongation > out.elongation) out.elongation = elongation;
            if (is_first || is_beyond(size, out.enlargement)) out.enlargement = size, out.peak = turns_.depth[turn];
            measures.push_back(measure);
        }
        for (std::size_t turn = run.first; turn < run.stop; ++turn) out.coverage += turns_.coverage[turn];
        out.coverage /= static_cast<double>(run.stop - run.first);
        out.median = median(std::move(measures));
        const double limit = limit_of(run.kind);
        out.severity = limit != 0.0 ? out.measure / limit : std::numeric_limits<double>::infinity();
        if (run.kind == HoleKind::breakout || run.kind == HoleKind::key_seat)
            arms_ ? add_lobes_of_arms(run, out) : add_lobes(run, out);
        if (run.kind == HoleKind::key_seat && !arms_)
            out.pipe_diameter = pipe_diameter(slot_of(run, out.toolface), bit_);
        return out;
    }

    // height = distance from the centre of the unworn circle, less its radius. The axis of a turn is half the angle of
    // the sum of w exp(2 i toolface), where w is the height less `opening_level` times the greatest, and 0 below.
    // Angles of a key seat are not doubled: it has a direction, not an axis.
    void add_lobes(const Run& run, Zone& zone) const {
        const bool both = run.kind == HoleKind::breakout;
        std::vector<double> x(sectors_), y(sectors_), height(sectors_), total(sectors_);
        AxisSum axes;
        for (const std::size_t turn : run.inside) {
            const bool known = std::isfinite(turns_.unworn_diameter[turn]);
            const double radius = (known ? turns_.unworn_diameter[turn] : bit_) / 2.0;
            const double centre_0 = known ? turns_.unworn_0[turn] : 0.0,
                         centre_90 = known ? turns_.unworn_90[turn] : 0.0;
            for (std::size_t k = 0; k < sectors_; ++k) {
                const double r = vertices_.radius[turn * sectors_ + k];
                x[k] = r * directions_[k].cosine - centre_0, y[k] = r * directions_[k].sine - centre_90;
                height[k] = std::sqrt(x[k] * x[k] + y[k] * y[k]);
            }
            const double most = *std::ranges::max_element(height) - radius;
            double sum_x = 0.0, sum_y = 0.0;
            for (std::size_t k = 0; k < sectors_; ++k) {
                const double away = height[k];
                height[k] -= radius, total[k] += height[k];
                const double weight = height[k] - criteria_.opening_level * most;
                if (!(weight > 0.0) || away == 0.0) continue;
                const double cosine = x[k] / away, sine = y[k] / away;
                sum_x += weight * (both ? cosine * cosine - sine * sine : cosine);
                sum_y += weight * (both ? 2.0 * cosine * sine : sine);
            }
            const double length = std::sqrt(sum_x * sum_x + sum_y * sum_y);
            length > 0.0 ? axes.add(sum_x / length, sum_y / length) : axes.add(1.0, 0.0);
        }
        for (double& of : total) of /= static_cast<double>(run.inside.size());
        const Axis axis = axes.mean();
        zone.toolface = both ? axis.mean : 2.0 * axis.mean;
        zone.deviation = both ? axis.deviation : 2.0 * axis.deviation;
        for (std::size_t side = 0; side < (both ? 2U : 1U); ++side)
            zone.lobes[side] = lobe_of(total, zone.toolface + 180.0 * static_cast<double>(side), start_toolface_,
                                       criteria_.opening_level);
    }

    // Returns the samples in the bottom of a key seat, in those of its turns where it is nearly as high as in most.
    // Readings show a pipe that the wall, which smooths them, makes wider.
    std::vector<SlotPoint> slot_of(const Run& run, double toolface) const {
        std::vector<double> tops;
        for (const std::size_t turn : run.inside)
            if (const double top = turns_.lobes[0].height[turn]; std::isfinite(top)) tops.push_back(top);
        const double top = median(std::move(tops));
        std::vector<std::uint8_t> counts(run.stop - run.first);
        for (const std::size_t turn : run.inside)
            counts[turn - run.first] = turns_.lobes[0].height[turn] >= slot_height * top ? 1 : 0;
        const SineCosine direction = sine_cosine(toolface);
        std::vector<SlotPoint> points;
        const auto add = [&](std::size_t turn, double radius, const SineCosine& of) {
            if (turn < run.first || turn >= run.stop || counts[turn - run.first] == 0) return;
            const double x = radius * of.cosine - turns_.unworn_0[turn], y = radius * of.sine - turns_.unworn_90[turn];
            const double along = x * direction.cosine + y * direction.sine,
                         across = y * direction.cosine - x * direction.sine;
            const double height = std::sqrt(x * x + y * y) - turns_.unworn_diameter[turn] / 2.0;
            if (along > 0.0 && height >= slot_bottom * top) points.push_back({turn, along, across});
        };
        const auto& [depth, of_sample] = turns_.samples.places;
        if (depth.empty()) {
            for (std::size_t i = run.first * sectors_; i < run.stop * sectors_; ++i)
                add(i / sectors_, vertices_.radius[i], directions_[i % sectors_]);
            return points;
        }
        const double low = std::min(turns_.depth[run.first], turns_.depth[run.stop - 1]) - height_,
                     high = std::max(turns_.depth[run.first], turns_.depth[run.stop - 1]) + height_;
        const double start = turns_.depth[0] - vertices_.pitch * (1.0 - 1.0 / static_cast<double>(sectors_)) / 2.0;
        for (auto i = static_cast<std::size_t>(std::ranges::lower_bound(depth, low) - depth.begin());
             i < depth.size() && depth[i] <= high; ++i) {
            const double turn = std::floor((depth[i] - start) / vertices_.pitch), radius = turns_.samples.radius[i];
            if (turn >= 0.0 && turn < static_cast<double>(count_) && std::isfinite(radius))
                add(static_cast<std::size_t>(turn), radius, sine_cosine(of_sample[i]));
        }
        std::ranges::stable_sort(points, {}, &SlotPoint::turn);  // on a wall that grows upwards they are not in order
        return points;
    }

    // The radii of the wall decide which end of C1 is higher.
    void add_lobes_of_arms(const Run& run, Zone& zone) const {
        AxisSum axes;
        std::vector<double> lower, higher;
        for (const std::size_t turn : run.inside) {
            const SineCosine doubled = sine_cosine(2.0 * turns_.c1_toolface[turn]);
            axes.add(doubled.cosine, doubled.sine);
            const double half = (turns_.c1[turn] - turns_.c2[turn]) / 2.0, off = turns_.uneven[turn] / 2.0;
            lower.push_back(half - off), higher.push_back(half + off);
        }
        const Axis axis = axes.mean();
        double difference = 0.0;
        for (const std::size_t turn : run.inside) {
            const double toolface = turns_.c1_toolface[turn], of = difference_of_ends(turn, toolface);
            // The first end of an axis of 179 degrees lies near 180, on the other side than the mean of 179 and 1.
            if (!std::isnan(of)) difference += std::abs(toolface - axis.mean) > 90.0 ? -of : of;
        }
        const double low = median(std::move(lower)), high = median(std::move(higher));
        const double near = difference >= 0.0 ? high : low, far = difference >= 0.0 ? low : high;
        zone.toolface = axis.mean;
        zone.deviation = axis.deviation < one_axis ? missing : axis.deviation;
        const std::array<ZoneLobe, 2> sides{{{axis.mean, missing, near}, {axis.mean + 180.0, missing, far}}};
        if (run.kind == HoleKind::breakout) {
            zone.lobes = sides;
        } else {
            zone.lobes[0] = near >= far ? sides[0] : sides[1];
            zone.toolface = zone.lobes[0].toolface;
        }
    }

    // Returns the radius of the wall at a toolface, less that opposite to it.
    double difference_of_ends(std::size_t turn, double toolface) const {
        const auto sectors = static_cast<double>(sectors_);
        const double number = nearest_whole((toolface - vertices_.start_toolface) * (sectors / 360.0));
        const double within = number - sectors * std::floor(number / sectors);
        const std::size_t first = within >= 0.0 && within < sectors ? static_cast<std::size_t>(within) : 0;
        const std::span<const double> radius = vertices_.radius.subspan(turn * sectors_, sectors_);
        return radius[first] - radius[(first + sectors_ / 2) % sectors_];
    }

    const MeasuredTurns& turns_;
    const TurnVertices& vertices_;
    double bit_;
    const ZoneCriteria& criteria_;
    const ChainedTurns& chained_;
    std::size_t count_, sectors_;
    double height_;  // of a turn
    bool arms_, diameters_;
    double start_toolface_;
    std::vector<double> sparse_;  // empty: the chain does not count
    std::vector<SineCosine> directions_;
    Heights heights_;
};

void require_criteria(const ZoneCriteria& criteria) {
    const std::pair<const char*, double> all[] = {
        {"elongation", criteria.elongation},     {"washout", criteria.washout},
        {"key_seat", criteria.key_seat},         {"undergauge", criteria.undergauge},
        {"symmetry", criteria.symmetry},         {"opening_level", criteria.opening_level},
        {"least_length", criteria.least_length}, {"join", criteria.join}};
    for (const auto& [name, value] : all)
        require(std::isfinite(value) && value >= 0.0, name, value, "must be finite and not negative");
    require(criteria.symmetry <= 1.0, "symmetry", criteria.symmetry, "must be in [0, 1]");
    require(criteria.opening_level > 0.0 && criteria.opening_level < 1.0, "opening_level", criteria.opening_level,
            "must be in (0, 1)");
}

void require_lengths(const MeasuredTurns& turns, const TurnVertices& vertices, const ChainedTurns& chained) {
    const std::size_t count = turns.depth.size();
    const std::pair<const char*, std::span<const double>> columns[] = {
        {"coverage", turns.coverage},
        {"sampled", turns.sampled},
        {"mean", turns.mean},
        {"c1", turns.c1},
        {"c1_toolface", turns.c1_toolface},
        {"c2", turns.c2},
        {"least_diameter", turns.least_diameter},
        {"unworn_diameter", turns.unworn_diameter},
        {"unworn_0", turns.unworn_0},
        {"unworn_90", turns.unworn_90},
        {"lobe1_toolface", turns.lobes[0].toolface},
        {"lobe1_width", turns.lobes[0].width},
        {"lobe1_height", turns.lobes[0].height},
        {"lobe2_toolface", turns.lobes[1].toolface},
        {"lobe2_height", turns.lobes[1].height},
    };
    for (const auto& [name, column] : columns) require_length(name, column.size(), count);
    require_length("sections", turns.sections.size(), section_parts * count, "32 times depth");
    require_length("toolface", turns.samples.places.toolface.size(), turns.samples.places.depth.size());
    require_length("radius", turns.samples.radius.size(), turns.samples.places.depth.size());
    if (!turns.uneven.empty()) require_length("uneven", turns.uneven.size(), count);
    if (!chained.kinds.empty() || !chained.seen.empty()) {
        require_length("kinds", chained.kinds.size(), hole_kinds * count, "5 times depth");
        require_length("seen", chained.seen.size(), count);
    }
    const std::size_t turns_of_radii = vertices.radius.size() / static_cast<std::size_t>(vertices.sectors);
    require(count <= turns_of_radii, "turns", static_cast<Index>(count),
            "must be at most the " + std::to_string(turns_of_radii) + " turns of the radii");
}

}  // namespace

Zones find_zones(const MeasuredTurns& turns, const TurnVertices& vertices, double bit_diameter,
                 const ZoneCriteria& criteria, const ChainedTurns& chained, const SectionLibraries& libraries,
                 int threads) {
    const StandardArithmetic standard;
    require_threads(threads);
    require_sectors(vertices.sectors);
    require_pitch(vertices.pitch);
    require(std::isfinite(vertices.start_toolface), "start_toolface", vertices.start_toolface, "must be finite");
    require(std::isfinite(bit_diameter) && bit_diameter > 0.0, "bit_diameter", bit_diameter,
            "must be finite and above 0");
    require_criteria(criteria);
    require_lengths(turns, vertices, chained);
    return Finder(turns, vertices, bit_diameter, criteria, chained).find(libraries, threads);
}

}  // namespace helibore
