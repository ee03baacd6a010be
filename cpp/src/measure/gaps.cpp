// Angular gaps. Samples are put into the sectors of the helix, sorted by depth in each sector. For every vertex, the
// sectors on its two sides are searched outwards until one holds a sample within reach. If the tool measures all around
// the hole, this is the first or second sector.
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numeric>
#include <optional>

#include "base/arithmetic.hpp"
#include "base/host_memory.hpp"
#include "base/messages.hpp"
#include "base/threads.hpp"
#include "helibore/logs.hpp"
#include "samples/helix.hpp"

namespace helibore {

namespace {

constexpr double whole_turn = 360.0;
constexpr double rounding = 1e-9;  // degrees

// Samples of sector s are [starts[s], starts[s + 1]), in the order of depth; toolfaces count from that of vertex 0.
struct Sectors {
    std::vector<std::size_t> starts;
    std::vector<double> depth, toolface, radius;  // no radius: not needed
};

double border(Index sector, Index sectors) {
    return static_cast<double>(sector) * whole_turn / static_cast<double>(sectors);
}

// Sorts samples into sectors. Toolfaces are counted from that of vertex 0. A sample that differs from the toolface of a
// vertex by rounding only is moved to it; otherwise the gap of the vertex would be 360 instead of 0. Each toolface is
// read once, and wrap_toolface makes any number an angle, so memory of the host that changes decides no place.
Sectors sorted(const SamplePlaces& samples, std::span<const double> radius, double start_toolface, Index sectors) {
    const std::size_t count = samples.depth.size();
    std::vector<double> borders;
    for (Index s = 0; s <= sectors; ++s) borders.push_back(border(s, sectors));
    const double in_a_degree = static_cast<double>(sectors) / whole_turn;
    std::vector<double> toolface(count);
    std::vector<std::uint32_t> sector(count);
    Sectors out{std::vector<std::size_t>(static_cast<std::size_t>(sectors) + 1), std::vector<double>(count),
                std::vector<double>(count), std::vector<double>(radius.size())};
    for (std::size_t i = 0; i < count; ++i) {
        const double turned = wrap_toolface(read_once(samples.toolface[i]) - start_toolface);
        auto s = static_cast<std::size_t>(turned * in_a_degree);
        s = std::min(s, static_cast<std::size_t>(sectors) - 1);
        while (borders[s] > turned) --s;
        while (s + 1 < borders.size() - 1 && borders[s + 1] <= turned) ++s;
        toolface[i] = turned;
        if (borders[s + 1] - turned <= rounding)
            s = (s + 1) % static_cast<std::size_t>(sectors), toolface[i] = borders[s];
        if (toolface[i] - borders[s] <= rounding) toolface[i] = borders[s];
        sector[i] = static_cast<std::uint32_t>(s);
        ++out.starts[s + 1];
    }
    for (std::size_t s = 1; s < out.starts.size(); ++s) out.starts[s] += out.starts[s - 1];
    std::vector<std::size_t> next = out.starts;
    for (std::size_t i = 0; i < count; ++i) {
        const std::size_t place = next[sector[i]]++;
        out.depth[place] = samples.depth[i];
        out.toolface[place] = toolface[i];
        if (!radius.empty()) out.radius[place] = radius[i];
    }
    return out;
}

// The vertices of one toolface, from the top of the hole down, and the state of the search on one side of them. Their
// toolface is the border before sector `number`.
struct Line {
    Index number;
    std::vector<double> depth, side;
    std::vector<std::size_t> open;    // vertices for which no sample is found yet
    std::vector<std::size_t> window;  // samples of the window, in the order of their angle from the line
};

// Looks for samples of sector `s`, which lie `off(toolface)` degrees from the vertices of the line.
template <class Off>
void look_into(const Sectors& in, std::size_t s, double reach, const Off& off, Line& line) {
    std::size_t next = in.starts[s], first = 0, left = 0;
    line.window.clear();
    for (const std::size_t row : line.open) {
        while (first < line.window.size() && in.depth[line.window[first]] < line.depth[row] - reach) ++first;
        if (first == line.window.size()) {  // skips the samples between rows far apart
            const auto at = [&](std::size_t i) { return in.depth.begin() + static_cast<std::ptrdiff_t>(i); };
            const auto found = std::lower_bound(at(next), at(in.starts[s + 1]), line.depth[row] - reach);
            next = static_cast<std::size_t>(found - in.depth.begin());
        }
        for (; next < in.starts[s + 1] && in.depth[next] <= line.depth[row] + reach; ++next) {
            while (line.window.size() > first && off(in.toolface[line.window.back()]) >= off(in.toolface[next])) {
                line.window.pop_back();
            }
            line.window.push_back(next);
        }
        if (first < line.window.size()) {
            line.side[row] = off(in.toolface[line.window[first]]);
        } else {
            line.open[left++] = row;
        }
    }
    line.open.resize(left);
}

// Calls look(s) for the sectors on one side of the line, one after the other, until no vertex of the line is open, or
// `most` sectors have been searched. Sectors without samples are passed over.
template <class Look>
void for_sectors_beside(const Sectors& in, const Line& line, bool clockwise, Index most, const Look& look) {
    const auto sectors = static_cast<Index>(in.starts.size()) - 1;
    for (Index step = 0; step < most && !line.open.empty(); ++step) {
        const auto s = static_cast<std::size_t>((line.number + (clockwise ? step : 2 * sectors - 1 - step)) % sectors);
        if (in.starts[s] < in.starts[s + 1]) look(s, step);
    }
}

// Sets line.side of the vertices `open`: degrees from the vertex to the nearest sample within reach, clockwise or
// counter-clockwise; 360: none in the nearest `most` sectors.
void look_around(const Sectors& in, double reach, bool clockwise, Index most, const std::vector<std::size_t>& open,
                 Line& line) {
    const auto sectors = static_cast<Index>(in.starts.size()) - 1;
    const double own = border(line.number, sectors);
    line.side.assign(line.depth.size(), whole_turn);
    line.open = open;
    const auto off = [&](double toolface) {
        const double degrees = clockwise ? toolface - own : own - toolface;
        return degrees < 0.0 ? degrees + whole_turn : degrees;
    };
    for_sectors_beside(in, line, clockwise, most, [&](std::size_t s, Index) { look_into(in, s, reach, off, line); });
}

// Returns for each vertex of the line how many sectors come before the first that has a sample within reach; `most`:
// none of the first `most` has one. `closer`: the same for a reach that is not larger; empty: not known.
std::vector<Index> empty_sectors(const Sectors& in, double reach, bool clockwise, Index most, Line& line,
                                 const std::vector<Index>& closer) {
    std::vector<Index> empty(line.depth.size(), most);
    line.open.clear();
    for (std::size_t row = 0; row < empty.size(); ++row) {
        if (!closer.empty() && closer[row] == 0)
            empty[row] = 0;
        else
            line.open.push_back(row);
    }
    for_sectors_beside(in, line, clockwise, most, [&](std::size_t s, Index step) {
        std::size_t next = in.starts[s], left = 0;
        const std::size_t stop = in.starts[s + 1];
        for (const std::size_t row : line.open) {
            while (next < stop && in.depth[next] < line.depth[row] - reach) ++next;
            if (next < stop && in.depth[next] <= line.depth[row] + reach)
                empty[row] = step;
            else
                line.open[left++] = row;
        }
        line.open.resize(left);
    });
    return empty;
}

// Calls job(in, line, vertex) for the vertices of each toolface; vertex(row) is the number of a vertex of the line.
template <class Job>
void for_each_line(const HelixVertices& vertices, const SamplePlaces& samples, std::span<const double> radius,
                   int threads, const Job& job) {
    require(vertices.sectors >= 1, "sectors", vertices.sectors, "must be 1 or more");
    require(vertices.sectors <= 1000000, "sectors", vertices.sectors, "must be at most 1000000");
    require_first("first", vertices.first, vertices.sectors);
    if (vertices.count > 0) {  // an empty wall has no start
        require_depth("start_depth", vertices.start_depth);
        require_pitch(vertices.pitch);
    }
    require(std::isfinite(vertices.start_toolface), "start_toolface", vertices.start_toolface, "must be finite");
    require_threads(threads);
    require_length("toolface", samples.toolface.size(), samples.depth.size());
    require_depths(samples.depth);
    require_order("depth", samples.depth);
    require_finite("toolface", samples.toolface);
    const Index sectors = vertices.sectors;
    const Helix helix{vertices.start_depth, vertices.start_toolface, vertices.pitch, sectors, vertices.first};
    const Sectors in = sorted(samples, radius, vertices.start_toolface, sectors);
    for_each_part(threads, std::min(sectors, vertices.count), [&](int, Index number) {
        const Index turns = (vertices.count - number + sectors - 1) / sectors;
        const auto vertex = [&](std::size_t row) {
            const auto at = static_cast<Index>(row);
            return static_cast<std::size_t>(number + sectors * (vertices.pitch > 0.0 ? at : turns - 1 - at));
        };
        Line line;
        line.number = number;
        line.depth.resize(static_cast<std::size_t>(turns));
        for (std::size_t row = 0; row < line.depth.size(); ++row)
            line.depth[row] = helix.depth(static_cast<Index>(vertex(row)));
        job(in, line, vertex);
    });
}

// Calls take(row, ahead, behind) for the vertices `rows` of a line, with what `look_around` finds on their two sides.
template <class Take>
void for_sides(const Sectors& in, double reach, Index most, const std::vector<std::size_t>& rows, Line& line,
               const Take& take) {
    look_around(in, reach, true, most, rows, line);
    const std::vector<double> ahead = line.side;
    look_around(in, reach, false, most, rows, line);
    for (const std::size_t row : rows) take(row, ahead[row], line.side[row]);
}

double gap_between(double ahead, double behind) {
    return ahead == 0.0 ? 0.0 : std::min(ahead + behind, whole_turn);
}

// The nearest samples of a vertex, the nearest first.
struct Nearest {
    static constexpr std::size_t most = 4;
    static constexpr double none = std::numeric_limits<double>::infinity();
    std::array<double, most> square{none, none, none, none};  // of the distance
    std::array<double, most> difference{};                    // radius of the sample less that of the vertex
    std::size_t count = 0;

    // Without branches, which a processor could not foresee: which sample moves to place `at` is a choice of values.
    void add(double distance, double off) {
        for (std::size_t at = most - 1; at > 0; --at) {
            const bool is_before = distance < square[at - 1], is_here = distance < square[at];
            difference[at] = is_before ? difference[at - 1] : is_here ? off : difference[at];
            square[at] = is_before ? square[at - 1] : is_here ? distance : square[at];
        }
        const bool is_first = distance < square[0];
        difference[0] = is_first ? off : difference[0];
        square[0] = is_first ? distance : square[0];
        count += count < most ? 1 : 0;
    }
    // A sample at this distance or farther is not among the nearest.
    double limit() const { return square[most - 1]; }
    // The change of the wall between vertex and samples, squared; 0 without a sample.
    double change() const {
        constexpr double least = 0.02;  // a sample nearer than this share has no more weight
        constexpr double beside = 0.3;  // nearer than this share, the mean is more and more the noise of the samples
        double weights = 0.0, weighted = 0.0, squares = 0.0;
        for (std::size_t i = 0; i < count; ++i) {
            const double weight = 1.0 / std::max(std::sqrt(square[i]), least);
            weights += weight, weighted += weight * difference[i];
            squares += difference[i] * difference[i];
        }
        if (count == 0) return 0.0;
        const double mean = weighted / weights * std::min(1.0, square[0] / (beside * beside));
        return mean * mean + 0.25 * squares / static_cast<double>(count) * square[0];
    }
};

// Marks the vertices of a line between which and their nearest samples the wall changes more than the rule allows. The
// sectors on the two sides are searched outwards, and in each the samples above and below, as far as they may be among
// the nearest.
template <class Vertex>
void mark_changing(const Sectors& in, std::span<const double> radius, const MeasuredRule& rule, const Line& line,
                   const Vertex& vertex, std::vector<std::uint8_t>& found) {
    constexpr double farthest = 2.0;
    const auto sectors = static_cast<Index>(in.starts.size()) - 1;
    const double most = rule.largest_change * rule.largest_change, a_metre = 1.0 / rule.near_depth,
                 a_degree = 1.0 / rule.near_toolface, own = border(line.number, sectors);
    struct Beside {
        std::size_t sector;
        double square;  // of the distance to its nearer border
    };
    std::vector<Beside> beside;
    for (Index step = 0; step < sectors; ++step) {  // 0: clockwise, 1: counter-clockwise, 2: clockwise, ...
        const double around = border(step / 2, sectors) * a_degree;
        if (around > farthest) break;
        const Index s = (line.number + (step % 2 == 0 ? step / 2 : sectors - 1 - step / 2)) % sectors;
        beside.push_back({static_cast<std::size_t>(s), around * around});
    }
    std::vector<std::size_t> next(in.starts.begin(), in.starts.end() - 1);  // of each sector, the sample below the row
    for (std::size_t row = 0; row < line.depth.size(); ++row) {
        const std::size_t number = vertex(row);
        if (found[number] == 0) continue;
        Nearest nearest;
        // Returns whether samples farther along the hole may be among the nearest.
        const auto look = [&](std::size_t i) {
            const double along = (in.depth[i] - line.depth[row]) * a_metre, square = along * along;
            if (!(std::abs(along) <= farthest) || square >= nearest.limit()) return false;
            const double off = std::abs(in.toolface[i] - own);
            const double around = std::min(off, whole_turn - off) * a_degree;
            if (around <= farthest && square + around * around < nearest.limit())
                nearest.add(square + around * around, in.radius[i] - radius[number]);
            return true;
        };
        for (const auto& [s, around] : beside) {
            if (around >= nearest.limit()) break;
            while (next[s] < in.starts[s + 1] && in.depth[next[s]] < line.depth[row]) ++next[s];
            for (std::size_t i = next[s]; i < in.starts[s + 1] && look(i);) ++i;
            for (std::size_t i = next[s]; i > in.starts[s] && look(i - 1);) --i;
        }
        if (nearest.change() > most) found[number] = 2;
    }
}

}  // namespace

std::vector<double> angular_gaps(const HelixVertices& vertices, const SamplePlaces& samples, double reach,
                                 int threads) {
    const StandardArithmetic standard;
    require_vertex_count(vertices.count);
    require(reach >= 0.0, "reach", reach, "must be 0 or above");
    std::vector<double> gaps(static_cast<std::size_t>(vertices.count));
    for_each_line(vertices, samples, {}, threads, [&](const Sectors& in, Line& line, const auto& vertex) {
        std::vector<std::size_t> rows(line.depth.size());
        std::iota(rows.begin(), rows.end(), std::size_t{0});
        for_sides(in, reach, vertices.sectors, rows, line, [&](std::size_t row, double ahead, double behind) {
            gaps[vertex(row)] = gap_between(ahead, behind);
        });
    });
    return gaps;
}

// Most vertices have a sample in a sector beside them. Then the number of empty sectors between vertex and sample
// decides. The angles of samples are looked at only where this number leaves the answer open.
std::vector<std::uint8_t> measured(const HelixVertices& vertices, const SamplePlaces& samples, const MeasuredRule& rule,
                                   int threads, const Radii& radii) {
    const StandardArithmetic standard;
    require_vertex_count(vertices.count);
    const bool is_change_limited = rule.largest_change < std::numeric_limits<double>::infinity();
    require(rule.largest_change >= 0.0, "largest_change", rule.largest_change, "must be 0 or above");
    if (is_change_limited) {
        require(rule.near_depth > 0.0, "near_depth", rule.near_depth, "must be above 0");
        require(rule.near_toolface > 0.0, "near_toolface", rule.near_toolface, "must be above 0");
        require_length("radii.samples", radii.samples.size(), samples.depth.size());
        require_length("radii.vertices", radii.vertices.size(), static_cast<std::size_t>(vertices.count));
    }
    require(rule.near_depth >= 0.0, "near_depth", rule.near_depth, "must be 0 or above");
    require(rule.near_toolface >= 0.0 && rule.near_toolface <= 180.0, "near_toolface", rule.near_toolface,
            "must lie in 0 to 180");
    require(rule.gap_reach >= 0.0, "gap_reach", rule.gap_reach, "must be 0 or above");
    require(rule.largest_gap >= 0.0 && rule.largest_gap <= whole_turn, "largest_gap", rule.largest_gap,
            "must lie in 0 to 360");
    std::vector<std::uint8_t> found(static_cast<std::size_t>(vertices.count));
    const auto of_samples = is_change_limited ? radii.samples : std::span<const double>();
    const std::vector<double> of_vertices = copied(radii.vertices);
    for_each_line(vertices, samples, of_samples, threads, [&](const Sectors& in, Line& line, const auto& vertex) {
        const double wide = whole_turn / static_cast<double>(vertices.sectors);
        const auto within = [&](double degrees) {  // the sectors that a sample so far away may lie in
            return std::min(static_cast<Index>(degrees / wide) + 2, vertices.sectors);
        };
        // Whether an angle between these two is at most the limit; nothing if it may be more or less.
        const auto at_most = [](double limit, double least, double most) -> std::optional<bool> {
            constexpr double margin = 1e-6;  // degrees, for the rounding of borders
            if (most <= limit - margin) return true;
            if (least > limit + margin) return false;
            return std::nullopt;
        };
        const auto least = [wide](Index empty) { return static_cast<double>(empty) * wide; };
        const Index most_near = within(rule.near_toolface), most_gap = within(rule.largest_gap);
        std::vector<Index> near[2], gap[2];  // clockwise, counter-clockwise
        for (const std::size_t side : {0U, 1U}) {
            const auto find_near = [&] {
                near[side] = empty_sectors(in, rule.near_depth, side == 0, most_near, line, gap[side]);
            };
            const auto find_gap = [&] {
                gap[side] = empty_sectors(in, rule.gap_reach, side == 0, most_gap, line, near[side]);
            };
            if (rule.near_depth <= rule.gap_reach)
                find_near(), find_gap();
            else
                find_gap(), find_near();
        }
        std::vector<std::size_t> near_open, gap_open;
        for (std::size_t row = 0; row < line.depth.size(); ++row) {
            const double beside = least(std::min(near[0][row], near[1][row])),
                         around = least(gap[0][row]) + least(gap[1][row]);
            const auto is_near = at_most(rule.near_toolface, beside, beside + wide);
            auto is_closed =
                rule.largest_gap == whole_turn ? true : at_most(rule.largest_gap, around, around + 2.0 * wide);
            if (gap[0][row] == 0 && is_closed == false) is_closed.reset();  // the gap at a sample is 0
            found[vertex(row)] = is_near.value_or(true) && is_closed.value_or(true) ? 1 : 0;
            if (found[vertex(row)] == 0) continue;
            if (!is_near) near_open.push_back(row);
            if (!is_closed) gap_open.push_back(row);
        }
        for_sides(in, rule.near_depth, most_near, near_open, line, [&](std::size_t row, double ahead, double behind) {
            if (std::min(ahead, behind) > rule.near_toolface + rounding) found[vertex(row)] = 0;
        });
        for_sides(in, rule.gap_reach, most_gap, gap_open, line, [&](std::size_t row, double ahead, double behind) {
            if (gap_between(ahead, behind) > rule.largest_gap) found[vertex(row)] = 0;
        });
        if (is_change_limited) mark_changing(in, of_vertices, rule, line, vertex, found);
    });
    return found;
}

}  // namespace helibore
