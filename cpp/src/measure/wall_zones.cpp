// From the vertices and samples of a wall to its zones: logs, measured vertices, unworn circles and sections of the
// turns.
#include <algorithm>
#include <cmath>
#include <numeric>

#include "base/arithmetic.hpp"
#include "base/host_memory.hpp"
#include "base/messages.hpp"
#include "helibore/unworn.hpp"
#include "helibore/zones.hpp"

namespace helibore {

namespace {

struct Marks {
    std::vector<double> counts;             // of each vertex: 1 if samples lie near
    std::vector<double> coverage, sampled;  // of each turn
};

Marks marks_of(std::span<const std::uint8_t> measured, std::span<const double> radius, std::size_t sectors) {
    const std::size_t turns = radius.size() / sectors;
    Marks out{std::vector<double>(radius.size()), std::vector<double>(turns), std::vector<double>(turns)};
    for (std::size_t i = 0; i < radius.size(); ++i)
        out.counts[i] = measured[i] != 0 && std::isfinite(radius[i]) ? 1.0 : 0.0;
    for (std::size_t i = 0; i < turns * sectors; ++i) {
        out.sampled[i / sectors] += out.counts[i];
        out.coverage[i / sectors] += measured[i] == 1 ? out.counts[i] : 0.0;
    }
    for (std::size_t turn = 0; turn < turns; ++turn) {
        out.sampled[turn] /= static_cast<double>(sectors);
        out.coverage[turn] /= static_cast<double>(sectors);
    }
    return out;
}

std::vector<double> depths_of(const HelixVertices& vertices, std::size_t turns) {
    const auto sectors = static_cast<double>(vertices.sectors);
    const double before = static_cast<double>(vertices.first / vertices.sectors);
    std::vector<double> out(turns);
    for (std::size_t turn = 0; turn < turns; ++turn)
        out[turn] = vertices.start_depth + ((before + static_cast<double>(turn)) * sectors + (sectors - 1.0) / 2.0) *
                                               (vertices.pitch / sectors);
    return out;
}

}  // namespace

WallZones wall_zones(const HelixVertices& vertices, std::span<const double> given, const ZoneSamples& all,
                     double bit_diameter, const ZoneCriteria& criteria, const MeasuredRule& rule, int threads) {
    const StandardArithmetic standard;
    const std::vector<double> radius = copied(given);
    const SectionLibraries libraries(bit_diameter, criteria.limits());
    const int sectors = static_cast<int>(std::clamp<Index>(vertices.sectors, 0, 1000001));
    const TurnVertices of_turns{radius, sectors, vertices.start_toolface, vertices.pitch};
    WallZones out;
    Zones& found = out;
    if (radius.empty()) {
        found = find_zones({}, of_turns, bit_diameter, criteria, {}, libraries, threads);
        return out;
    }
    ZoneSamples samples = all;  // that show the shape; a spike measures its place all the same
    std::vector<double> kept;
    if (all.noise > 0.0) samples.radius = kept = kept_radii(vertices, radius, all.places, all.radius, all.noise);
    const std::vector<double> sections = turn_sections(vertices, samples.places, samples.radius);
    require_sectors(sectors);
    const Marks marks = marks_of(measured(vertices, all.places, rule, threads, {all.radius, radius}), radius,
                                 static_cast<std::size_t>(sectors));
    const Turns turns{.start_toolface = vertices.start_toolface, .sectors = sectors, .radius = radius};
    const TurnLogs logs = turn_logs(turns, threads);
    out.unworn = unworn_turns(turns, bit_diameter, marks.counts, threads);
    const std::vector<double> depth = depths_of(vertices, logs.mean.size());
    const double height = std::abs(vertices.pitch);
    const double seen = std::accumulate(marks.sampled.begin(), marks.sampled.end(), 0.0);
    if (seen < sees_all_around * static_cast<double>(depth.size()))
        out.arms = arm_diameters(samples.arms, depth, height);
    const bool by_arms = out.arms.arms > 0;
    const bool even = by_arms && std::ranges::none_of(out.arms.c1_uneven, [](double of) { return of > 0.0; });
    out.sparse = sparse_turns(sections, height);
    if (std::ranges::find(out.sparse, 1.0) != out.sparse.end()) {
        std::vector<double> beyond(sections);
        for (double& of : beyond) of -= bit_diameter / 2.0;
        out.along = kinds_along(beyond, height, out.sparse, libraries.of(even), {}, threads);
    }
    const auto lobe = [](const TurnLobes& of) { return MeasuredTurns::Lobe{of.toolface, of.width, of.height}; };
    const MeasuredTurns measures{.depth = depth,
                                 .coverage = marks.coverage,
                                 .sampled = marks.sampled,
                                 .mean = logs.mean,
                                 .c1 = by_arms ? out.arms.c1 : logs.c1,
                                 .c1_toolface = by_arms ? out.arms.c1_toolface : logs.c1_toolface,
                                 .c2 = by_arms ? out.arms.c2 : logs.c2,
                                 .least_diameter = by_arms ? out.arms.least_diameter : logs.least_diameter,
                                 .unworn_diameter = out.unworn.diameter,
                                 .unworn_0 = out.unworn.centre_0,
                                 .unworn_90 = out.unworn.centre_90,
                                 .lobes{{lobe(out.unworn.lobes[0]), lobe(out.unworn.lobes[1])}},
                                 .sections = sections,
                                 .uneven = out.arms.c1_uneven,
                                 .samples = samples};
    found =
        find_zones(measures, of_turns, bit_diameter, criteria, {out.along.kinds, out.along.seen}, libraries, threads);
    return out;
}

}  // namespace helibore
