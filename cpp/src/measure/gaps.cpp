// Angular gaps. Samples are put into the sectors of the helix, sorted by depth in each sector. For every vertex, the
// sectors on its two sides are searched outwards until one holds a sample within reach. If the tool measures all around
// the hole, this is the first or second sector.
#include <algorithm>
#include <cmath>
#include <numeric>

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
    std::vector<double> depth, toolface;
};

double border(Index sector, Index sectors) {
    return static_cast<double>(sector) * whole_turn / static_cast<double>(sectors);
}

Index sector_of(double toolface, Index sectors) {
    Index s = std::min(static_cast<Index>(toolface * static_cast<double>(sectors) / whole_turn), sectors - 1);
    while (border(s, sectors) > toolface) --s;
    while (s + 1 < sectors && border(s + 1, sectors) <= toolface) ++s;
    return s;
}

// Returns the toolface of a sample, counted from that of vertex 0. A sample that differs from the toolface of a vertex
// by rounding only is moved to it; otherwise the gap of the vertex would be 360 instead of 0.
double counted_from(double start_toolface, double toolface, Index sectors) {
    const double turned = wrap_toolface(toolface - start_toolface);
    const auto nearest = static_cast<Index>(std::round(turned * static_cast<double>(sectors) / whole_turn));
    if (std::abs(turned - border(nearest, sectors)) > rounding) return turned;
    return border(nearest % sectors, sectors);
}

Sectors sorted(const SamplePlaces& samples, double start_toolface, Index sectors) {
    const std::size_t count = samples.depth.size();
    std::vector<double> toolface(count);
    std::vector<Index> sector(count);
    Sectors out{std::vector<std::size_t>(static_cast<std::size_t>(sectors) + 1), std::vector<double>(count),
                std::vector<double>(count)};
    for (std::size_t i = 0; i < count; ++i) {
        toolface[i] = counted_from(start_toolface, samples.toolface[i], sectors);
        sector[i] = sector_of(toolface[i], sectors);
        ++out.starts[static_cast<std::size_t>(sector[i]) + 1];
    }
    for (std::size_t s = 1; s < out.starts.size(); ++s) out.starts[s] += out.starts[s - 1];
    std::vector<std::size_t> next = out.starts;
    for (std::size_t i = 0; i < count; ++i) {
        const std::size_t place = next[static_cast<std::size_t>(sector[i])]++;
        out.depth[place] = samples.depth[i];
        out.toolface[place] = toolface[i];
    }
    return out;
}

// The vertices of one toolface, from the top of the hole down, and the state of the search on one side of them.
struct Line {
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

// Sets line.side: for each vertex, degrees from its toolface to the nearest sample clockwise (counter-clockwise if
// `clockwise` is false), as far as the nearest `most` sectors have it. The toolface of these vertices is the border
// before sector `number`.
void look_around(const Sectors& in, Index number, Index sectors, double reach, bool clockwise, Index most, Line& line) {
    const double own = border(number, sectors);
    line.side.assign(line.depth.size(), whole_turn);
    line.open.resize(line.depth.size());
    std::iota(line.open.begin(), line.open.end(), std::size_t{0});
    const auto off = [&](double toolface) {
        const double degrees = clockwise ? toolface - own : own - toolface;
        return degrees < 0.0 ? degrees + whole_turn : degrees;
    };
    for (Index step = 0; step < most && !line.open.empty(); ++step) {
        const Index s = (number + (clockwise ? step : 2 * sectors - 1 - step)) % sectors;
        if (in.starts[static_cast<std::size_t>(s)] < in.starts[static_cast<std::size_t>(s) + 1]) {
            look_into(in, static_cast<std::size_t>(s), reach, off, line);
        }
    }
}

// Calls take(vertex, ahead, behind) for each vertex, with the degrees to the nearest samples on its two sides among the
// nearest `most` sectors; 360: none.
template <class Take>
void look_from_all(const HelixVertices& vertices, const SamplePlaces& samples, double reach, Index most, int threads,
                   const Take& take) {
    require(vertices.sectors >= 1, "sectors", vertices.sectors, "must be 1 or more");
    require(vertices.sectors <= 1000000, "sectors", vertices.sectors, "must be at most 1000000");
    require_first("first", vertices.first, vertices.sectors);
    require_vertex_count(vertices.count);
    if (vertices.count > 0) {  // an empty wall has no start
        require_depth("start_depth", vertices.start_depth);
        require_pitch(vertices.pitch);
    }
    require(std::isfinite(vertices.start_toolface), "start_toolface", vertices.start_toolface, "must be finite");
    require(reach >= 0.0, "reach", reach, "must be 0 or above");
    require_threads(threads);
    require_length("toolface", samples.toolface.size(), samples.depth.size());
    const std::vector<double> depth = copied(samples.depth), toolface = copied(samples.toolface);
    require_depths(depth);
    require_order("depth", depth);
    require_finite("toolface", toolface);
    const Index sectors = vertices.sectors;
    const Helix helix{vertices.start_depth, vertices.start_toolface, vertices.pitch, sectors, vertices.first};
    const Sectors in = sorted({depth, toolface}, vertices.start_toolface, sectors);
    for_each_part(threads, std::min(sectors, vertices.count), [&](int, Index number) {
        const Index turns = (vertices.count - number + sectors - 1) / sectors;
        const auto vertex = [&](Index row) {
            return number + sectors * (vertices.pitch > 0.0 ? row : turns - 1 - row);
        };
        Line line;
        line.depth.resize(static_cast<std::size_t>(turns));
        for (Index row = 0; row < turns; ++row) line.depth[static_cast<std::size_t>(row)] = helix.depth(vertex(row));
        look_around(in, number, sectors, reach, true, most, line);
        const std::vector<double> ahead = line.side;
        look_around(in, number, sectors, reach, false, most, line);
        for (Index row = 0; row < turns; ++row) {
            const auto i = static_cast<std::size_t>(row);
            take(static_cast<std::size_t>(vertex(row)), ahead[i], line.side[i]);
        }
    });
}

}  // namespace

std::vector<double> angular_gaps(const HelixVertices& vertices, const SamplePlaces& samples, double reach,
                                 int threads) {
    const StandardArithmetic standard;
    require_vertex_count(vertices.count);
    std::vector<double> gaps(static_cast<std::size_t>(vertices.count));
    look_from_all(vertices, samples, reach, vertices.sectors, threads,
                  [&](std::size_t vertex, double ahead, double behind) {
                      gaps[vertex] = ahead == 0.0 ? 0.0 : std::min(ahead + behind, whole_turn);
                  });
    return gaps;
}

std::vector<std::uint8_t> sampled(const HelixVertices& vertices, const SamplePlaces& samples, double reach,
                                  double angle, int threads) {
    const StandardArithmetic standard;
    require(angle >= 0.0 && angle <= 180.0, "angle", angle, "must lie in 0 to 180");
    // A sample at `angle` may lie in the sector that begins there.
    const auto far = static_cast<Index>(angle * static_cast<double>(vertices.sectors) / whole_turn) + 1;
    require_vertex_count(vertices.count);
    std::vector<std::uint8_t> found(static_cast<std::size_t>(vertices.count));
    look_from_all(vertices, samples, reach, std::min(far, vertices.sectors), threads,
                  [&](std::size_t vertex, double ahead, double behind) {
                      found[vertex] = std::min(ahead, behind) <= angle + rounding ? 1 : 0;
                  });
    return found;
}

}  // namespace helibore
