// The section of each turn, as its samples show it, and the turns that have few samples.
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "base/arithmetic.hpp"
#include "base/host_memory.hpp"
#include "base/messages.hpp"
#include "base/trigonometry.hpp"
#include "helibore/zones.hpp"
#include "samples/helix.hpp"

namespace helibore {

namespace {

constexpr double sparse_length = 0.3;  // metres
constexpr double rounding = 1e-9;      // metres
constexpr double most_off = 2.5;       // deviations of the noise, as beside other samples (near_far.cpp)

std::size_t part_of(double toolface) {
    const double part = nearest_whole(wrap_toolface(toolface) * (static_cast<double>(section_parts) / 360.0));
    return static_cast<std::size_t>(part) % section_parts;
}

double mean_of(double sum, double count) {
    return count > 0.0 ? sum / count : std::numeric_limits<double>::quiet_NaN();
}

void require_helix(const HelixVertices& vertices) {
    require(std::isfinite(vertices.start_depth), "start_depth", vertices.start_depth, "must be finite");
    require(std::isfinite(vertices.start_toolface), "start_toolface", vertices.start_toolface, "must be finite");
    require_pitch(vertices.pitch);
    require(vertices.sectors >= 3, "sectors", vertices.sectors, "must be 3 or more");
    require_vertex_count(vertices.count);
    require_first("first", vertices.first, vertices.sectors);
}

}  // namespace

std::vector<double> turn_sections(const HelixVertices& vertices, const SamplePlaces& samples,
                                  std::span<const double> radius) {
    const StandardArithmetic standard;
    if (vertices.count == 0) return {};  // a wall without samples has no start depth yet
    require_helix(vertices);
    require_length("toolface", samples.toolface.size(), samples.depth.size());
    require_length("radius", radius.size(), samples.depth.size());
    const Index turns = vertices.count / vertices.sectors, before = vertices.first / vertices.sectors;
    std::vector<double> sums(static_cast<std::size_t>(turns) * section_parts), counts(sums.size());
    for (std::size_t i = 0; i < radius.size(); ++i) {
        const double turn =
            std::floor((samples.depth[i] - vertices.start_depth) / vertices.pitch) - static_cast<double>(before);
        const double of = read_once(radius[i]);
        if (turn >= 0.0 && turn < static_cast<double>(turns) && std::isfinite(of)) {
            const auto place = static_cast<std::size_t>(turn) * section_parts + part_of(read_once(samples.toolface[i]));
            sums[place] += of, counts[place] += 1.0;
        }
    }
    for (std::size_t place = 0; place < sums.size(); ++place) sums[place] = mean_of(sums[place], counts[place]);
    return sums;
}

std::vector<double> turn_sections(const HelixVertices& vertices, std::span<const double> radius) {
    const StandardArithmetic standard;
    require_helix(vertices);
    require_length("radius", radius.size(), static_cast<std::size_t>(vertices.count), "count");
    const auto sectors = static_cast<std::size_t>(vertices.sectors), turns = radius.size() / sectors;
    const Helix helix{vertices.start_depth, vertices.start_toolface, vertices.pitch, vertices.sectors, 0};
    std::vector<std::size_t> parts;  // of the vertices of a turn
    for (std::size_t k = 0; k < sectors; ++k) parts.push_back(part_of(helix.toolface(static_cast<Index>(k))));
    std::vector<double> means;
    means.reserve(turns * section_parts);
    for (std::size_t turn = 0; turn < turns; ++turn) {
        std::array<double, section_parts> sums{}, counts{};
        for (std::size_t k = 0; k < sectors; ++k) {
            const double of = read_once(radius[turn * sectors + k]);
            if (std::isfinite(of)) sums[parts[k]] += of, counts[parts[k]] += 1.0;
        }
        for (std::size_t part = 0; part < section_parts; ++part) means.push_back(mean_of(sums[part], counts[part]));
    }
    return means;
}

std::vector<double> kept_radii(const HelixVertices& vertices, std::span<const double> wall, const SamplePlaces& samples,
                               std::span<const double> radius, double noise) {
    const StandardArithmetic standard;
    std::vector<double> kept = copied(radius);
    if (vertices.count == 0) return kept;
    require_helix(vertices);
    require_length("wall", wall.size(), static_cast<std::size_t>(vertices.count), "count");
    require_length("depth", samples.depth.size(), radius.size());
    require_length("toolface", samples.toolface.size(), radius.size());
    const Index sectors = vertices.sectors, turns = vertices.count / sectors, before = vertices.first / sectors;
    const double off = most_off * std::sqrt(noise), step = 360.0 / static_cast<double>(sectors);
    for (std::size_t i = 0; i < kept.size(); ++i) {
        const double of_turn =
            std::floor((samples.depth[i] - vertices.start_depth) / vertices.pitch) - static_cast<double>(before);
        const double around = wrap_toolface(read_once(samples.toolface[i]) - vertices.start_toolface) / step;
        if (!(of_turn >= 0.0 && of_turn < static_cast<double>(turns) && around >= 0.0)) continue;
        const auto turn = static_cast<Index>(of_turn), sector = static_cast<Index>(nearest_whole(around));
        double least = std::numeric_limits<double>::infinity(), greatest = -least;
        for (Index row = std::max(turn - 1, Index{0}); row <= std::min(turn + 1, turns - 1); ++row)
            for (const Index column : {sector + sectors - 1, sector, sector + 1}) {
                const double of = wall[static_cast<std::size_t>(row * sectors + column % sectors)];
                least = std::fmin(least, of), greatest = std::fmax(greatest, of);
            }
        if (least <= greatest && (kept[i] > greatest + off || kept[i] < least - off))
            kept[i] = std::numeric_limits<double>::quiet_NaN();
    }
    return kept;
}

std::vector<double> sparse_turns(std::span<const double> sections, double height) {
    const StandardArithmetic standard;
    const std::size_t turns = sections.size() / section_parts;
    require(sections.size() == turns * section_parts, "sections", static_cast<Index>(sections.size()),
            "must be 32 lengths for each turn");
    require(std::isfinite(height) && height > 0.0, "height", height, "must be finite and above 0");
    std::vector<double> sparse(turns);
    for (std::size_t turn = 0; turn < turns; ++turn) {
        std::size_t seen = 0;
        for (std::size_t part = 0; part < section_parts; ++part)
            seen += std::isfinite(sections[turn * section_parts + part]) ? 1U : 0U;
        sparse[turn] = 2 * seen < section_parts ? 1.0 : 0.0;
    }
    for (std::size_t first = 0, stop = 0; first < turns; first = std::max(stop, first + 1)) {
        for (stop = first; stop < turns && sparse[stop] != 0.0;) ++stop;
        const std::size_t length = stop - first;
        if (static_cast<double>(length) * height < sparse_length - rounding && length < turns)
            std::fill_n(sparse.begin() + static_cast<std::ptrdiff_t>(first), length, 0.0);
    }
    return sparse;
}

}  // namespace helibore
