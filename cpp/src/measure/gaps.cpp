// Angular gaps: samples are put into the sectors of the helix, by depth in each; every vertex then looks outwards,
// sector by sector, until one holds a sample within reach. Where a tool sees all around that is the first or second
// sector.
#include <algorithm>
#include <cmath>
#include <limits>

#include "base/messages.hpp"
#include "base/threads.hpp"
#include "helibore/logs.hpp"
#include "samples/helix.hpp"

namespace helibore {

namespace {

constexpr Index block = 4096;  // vertices
constexpr double whole_turn = 360.0;

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

Sectors sorted(const SamplePlaces& samples, double start_toolface, Index sectors) {
    const std::size_t count = samples.depth.size();
    std::vector<double> toolface(count);
    std::vector<Index> sector(count);
    Sectors out{std::vector<std::size_t>(static_cast<std::size_t>(sectors) + 1), std::vector<double>(count),
                std::vector<double>(count)};
    for (std::size_t i = 0; i < count; ++i) {
        toolface[i] = wrap_toolface(samples.toolface[i] - start_toolface);
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

// Degrees from `own`, the border before sector `line`, to the nearest sample clockwise (way = 1) or the other way (-1).
double side(const Sectors& in, Index line, Index sectors, double own, double low, double high, Index way) {
    for (Index step = 0; step < sectors; ++step) {
        const auto s = static_cast<std::size_t>((line + (way > 0 ? step : 2 * sectors - 1 - step)) % sectors);
        const auto first = in.depth.begin() + static_cast<std::ptrdiff_t>(in.starts[s]);
        const auto last = in.depth.begin() + static_cast<std::ptrdiff_t>(in.starts[s + 1]);
        double least = std::numeric_limits<double>::infinity();
        for (auto at = std::lower_bound(first, last, low); at != last && *at <= high; ++at) {
            const double off =
                static_cast<double>(way) * (in.toolface[static_cast<std::size_t>(at - in.depth.begin())] - own);
            least = std::min(least, off < 0.0 ? off + whole_turn : off);
        }
        if (least <= whole_turn) return least;
    }
    return whole_turn;
}

}  // namespace

std::vector<double> angular_gaps(const HelixVertices& vertices, const SamplePlaces& samples, double reach,
                                 int threads) {
    if (vertices.sectors < 1) throw InputError("sectors", "must be 1 or more", std::to_string(vertices.sectors));
    require_length("toolface", samples.toolface.size(), samples.depth.size());
    const Index sectors = vertices.sectors;
    const Helix helix{vertices.start_depth, vertices.start_toolface, vertices.pitch, sectors};
    const Sectors in = sorted(samples, vertices.start_toolface, sectors);
    std::vector<double> gaps(static_cast<std::size_t>(vertices.count));
    for_each_range(threads, vertices.count, block, [&](int, const Range& range) {
        for (Index k = range.start; k < range.stop; ++k) {
            const Index line = k % sectors;
            const double own = border(line, sectors), depth = helix.depth(k);
            const double ahead = side(in, line, sectors, own, depth - reach, depth + reach, 1);
            const double behind = ahead == 0.0 ? 0.0 : side(in, line, sectors, own, depth - reach, depth + reach, -1);
            gaps[static_cast<std::size_t>(k)] = std::min(ahead + behind, whole_turn);
        }
    });
    return gaps;
}

}  // namespace helibore
