// Finds the samples that are shown at vertices that are not settled.
#include "wall/direct.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>

#include "base/ranges.hpp"

namespace helibore {
namespace {

constexpr double none = std::numeric_limits<double>::quiet_NaN();

// Returns the number of the vertex in whose cell a sample lies.
double vertex_of(const Helix& helix, double depth, double toolface) {
    const auto sectors = static_cast<double>(helix.sectors);
    double sector = std::floor(wrap_toolface(toolface - helix.start_toolface) / 360.0 * sectors + 0.5);
    if (sector == sectors) sector = 0.0;
    const double first = helix.start_depth + sector * helix.pitch / sectors;
    return std::floor((depth - first) / helix.pitch + 0.5) * sectors + sector - static_cast<double>(helix.first);
}

}  // namespace

DirectRadii direct_radii(const Samples& samples, const Helix& helix, Range vertices) {
    DirectRadii direct{vertices.start, {}};
    if (vertices.stop <= vertices.start) return direct;
    direct.radii.assign(static_cast<std::size_t>(vertices.stop - vertices.start), none);
    const auto [shallow, deep] = std::minmax({helix.depth(vertices.start), helix.depth(vertices.stop - 1)});
    const double half = 0.5 * std::abs(helix.pitch) * (1.0 + 1e-9);
    for (Samples::Place at = samples.step_to(shallow - half, {}, 1); at.chunk < samples.chunks().size();
         ++at.chunk, at.offset = 0) {
        const Chunk& chunk = *samples.chunks()[at.chunk];
        for (Index i = at.offset; i < chunk.count; ++i) {
            if (chunk.depth()[i] > deep + half) return direct;
            const double k = vertex_of(helix, chunk.depth()[i], chunk.toolface()[i]);
            if (k < static_cast<double>(vertices.start) || k >= static_cast<double>(vertices.stop)) continue;
            direct.radii[static_cast<std::size_t>(static_cast<Index>(k) - vertices.start)] = chunk.radius()[i];
        }
    }
    return direct;
}

std::vector<Range> direct_changes(const DirectRadii& before, const DirectRadii& after, Index count) {
    const auto bits = [](const DirectRadii& radii, Index k) {
        return std::bit_cast<std::uint64_t>(radii.shown(k, none));
    };
    std::vector<Range> ranges;
    for (Index k = std::min(before.start, after.start); k < count; ++k)
        if (bits(before, k) != bits(after, k)) add_range(ranges, {k, k + 1});
    return ranges;
}

}  // namespace helibore
