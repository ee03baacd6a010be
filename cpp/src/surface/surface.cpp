// Topology: which vertices are kept, and the quads and hexahedra between them. It is integer arithmetic on runs, which
// are counted first and then filled. place.cpp computes positions.
#include "helibore/surface.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "base/arithmetic.hpp"
#include "base/messages.hpp"
#include "base/threads.hpp"
#include "helibore/error.hpp"
#include "samples/helix.hpp"
#include "surface/layout_rules.hpp"

namespace helibore {
namespace {

constexpr Index cells_a_part = 16384;  // cells that a thread takes at a time

bool is_there(double radius) {
    return radius > 0.0 && radius <= std::numeric_limits<double>::max();
}

// Returns how many consecutive values from `start` on are present (or, with there = false, missing).
Index run_length(std::span<const double> radius, std::size_t start, bool there) {
    std::size_t i = start;
    constexpr std::size_t stride = 64;  // number of values that are checked without a branch
    for (int all = 1; i + stride <= radius.size(); i += stride) {
        for (std::size_t j = i; j < i + stride; ++j) all &= static_cast<int>(is_there(radius[j]) == there);
        if (all == 0) break;
    }
    while (i < radius.size() && is_there(radius[i]) == there) ++i;
    return static_cast<Index>(i - start);
}

// Returns the runs of vertices that have a radius. Their rows begin at `row`, which is advanced past the last row.
std::vector<VertexRun> vertex_runs(std::span<const double> radius, Index first, const char* name, Index& row) {
    std::vector<VertexRun> runs;
    for (std::size_t i = 0; i < radius.size();) {
        const Index length = run_length(radius, i, true);
        const Index k = first + static_cast<Index>(i);
        if (length > 0) runs.push_back({{k, k + length}, row - k});
        row += length;
        i += static_cast<std::size_t>(length);
        for (const std::size_t stop = i + static_cast<std::size_t>(run_length(radius, i, false)); i < stop; ++i) {
            if (!std::isnan(radius[i])) {
                throw InputError(entry_name(name, static_cast<Index>(i)), "must be finite and above 0, or nan",
                                 number_text(radius[i]));
            }
        }
    }
    return runs;
}

// Returns the runs of quads: those k whose upper corners k, k+1 lie in one vertex run and whose lower corners k+K,
// k+K+1 lie in one run. These are the overlaps of the runs with the same runs moved up by a turn.
std::vector<QuadRun> quad_runs(const std::vector<VertexRun>& vertices, Index sectors) {
    std::vector<QuadRun> runs;
    for (std::size_t upper = 0, lower = 0; upper < vertices.size() && lower < vertices.size();) {
        const VertexRun &u = vertices[upper], &l = vertices[lower];
        const Index start = std::max(u.k.start, l.k.start - sectors);
        const Index stop = std::min(u.k.stop, l.k.stop - sectors) - 1;  // corner k+1 must lie in the run, too
        if (start < stop) runs.push_back({{start, stop}, 0, u.shift, l.shift + sectors});
        u.k.stop < l.k.stop - sectors ? ++upper : ++lower;
    }
    return runs;
}

std::vector<HexahedronRun> hexahedron_runs(const std::vector<QuadRun>& inner, const std::vector<QuadRun>& outer,
                                           Index& row) {
    std::vector<HexahedronRun> runs;
    for (std::size_t i = 0, o = 0; i < inner.size() && o < outer.size();) {
        const Range common = {std::max(inner[i].k.start, outer[o].k.start), std::min(inner[i].k.stop, outer[o].k.stop)};
        if (common.start < common.stop) {
            const Index shift = row - common.start;
            runs.push_back(
                {{common, shift, inner[i].upper, inner[i].lower}, {common, shift, outer[o].upper, outer[o].lower}});
            row += common.stop - common.start;
        }
        inner[i].k.stop < outer[o].k.stop ? ++i : ++o;
    }
    return runs;
}

// Returns the name of a shell in errors: "radius" for the wall, then "shells[0]" and so on.
std::string name_of_shell(std::size_t s) {
    return s == 0 ? "radius" : "shells[" + std::to_string(s - 1) + "]";
}

void require_nested(const HelixRadii& radii, std::span<const std::span<const double>> shells) {
    const Helix helix{radii.start_depth, radii.start_toolface, radii.pitch, radii.sectors};
    for (std::size_t s = 1; s < shells.size(); ++s) {
        for (std::size_t i = 0; i < shells[s].size(); ++i) {
            if (!(shells[s][i] <= shells[s - 1][i])) continue;
            const Index k = radii.first + static_cast<Index>(i);
            throw InputError(entry_name(name_of_shell(s), k),
                             "must lie beyond " + entry_text(name_of_shell(s - 1), k, shells[s - 1][i]),
                             number_text(shells[s][i]) + " at depth " + number_text(helix.depth(k)));
        }
    }
}

// Returns the part of a run that lies in `within`.
Range overlap(const Range& run, const Range& within) {
    return {std::max(run.start, within.start), std::min(run.stop, within.stop)};
}

// Calls fill(run, range of k) for parts of all runs, on several threads.
template <class Run, class RangeOf, class Fill>
void fill_runs(std::span<const Run> runs, const RangeOf& range_of, int threads, const Fill& fill) {
    if (runs.empty()) return;
    const Index first = range_of(runs.front()).start, length = range_of(runs.back()).stop - first;
    for_each_range(threads, length, cells_a_part, [&](int, const Range& part) {
        const Range within = {first + part.start, first + part.stop};
        auto run = std::partition_point(runs.begin(), runs.end(),
                                        [&](const Run& r) { return range_of(r).stop <= within.start; });
        for (; run != runs.end() && range_of(*run).start < within.stop; ++run) {
            fill(*run, overlap(range_of(*run), within));
        }
    });
}

// Corners in outward order: (a0, a1, b1, b0), or (a0, b0, b1, a1) on a helix that grows upwards.
struct Corners {
    Index offset[4];
    Corners(const QuadRun& run, bool downwards)
        : offset{run.upper, downwards ? run.upper + 1 : run.lower, run.lower + 1,
                 downwards ? run.lower : run.upper + 1} {}
};

}  // namespace

SurfaceLayout surface_layout(const HelixRadii& radii) {
    const StandardArithmetic standard;
    require_helix(radii);
    SurfaceLayout layout;
    layout.vertices = vertex_runs(radii.radius, radii.first, "radius", layout.vertex_count);
    layout.quads = quad_runs(layout.vertices, radii.sectors);
    for (QuadRun& run : layout.quads) {
        run.shift = layout.quad_count - run.k.start;
        layout.quad_count += run.k.stop - run.k.start;
    }
    return layout;
}

VolumeLayout volume_layout(const HelixRadii& radii, std::span<const std::span<const double>> shells) {
    const StandardArithmetic standard;
    require_helix(radii);
    if (shells.size() < 2) throw InputError("shells", "a volume needs one or more beyond the wall");
    VolumeLayout layout;
    std::vector<QuadRun> inner;
    for (std::size_t s = 0; s < shells.size(); ++s) {
        const std::string name = name_of_shell(s);
        require_length(name, shells[s].size(), radii.radius.size(), "radius");
        layout.shells.push_back(vertex_runs(shells[s], radii.first, name.c_str(), layout.vertex_count));
        std::vector<QuadRun> outer = quad_runs(layout.shells.back(), radii.sectors);
        if (s > 0) layout.layers.push_back(hexahedron_runs(inner, outer, layout.hexahedron_count));
        inner = std::move(outer);
    }
    require_nested(radii, shells);
    return layout;
}

void join(const HelixRadii& radii, const SurfaceLayout& layout, std::span<Quad> quads, int threads) {
    const StandardArithmetic standard;
    require_helix(radii);
    require_threads(threads);
    const std::span<const QuadRun> runs(layout.quads);
    require_runs(radii, "quads", runs, quads.size(), "quads");
    for (std::size_t i = 0; i < runs.size(); ++i) require_corners("quads", static_cast<Index>(i), runs[i]);
    const bool downwards = radii.pitch > 0.0;
    const auto range_of = [](const QuadRun& run) { return run.k; };
    fill_runs(runs, range_of, threads, [&](const QuadRun& run, const Range& within) {
        const Corners c(run, downwards);
        Quad* out = quads.data() + (within.start + run.shift);
        for (Index k = within.start; k < within.stop; ++k, ++out) {
            *out = {k + c.offset[0], k + c.offset[1], k + c.offset[2], k + c.offset[3]};
        }
    });
}

void join(const HelixRadii& radii, const VolumeLayout& layout, std::span<Hexahedron> hexahedra, int threads) {
    const StandardArithmetic standard;
    require_helix(radii);
    require_threads(threads);
    require_layers(radii, layout, hexahedra.size());
    const bool downwards = radii.pitch > 0.0;
    const auto range_of = [](const HexahedronRun& run) { return run.inner.k; };
    for (const auto& layer : layout.layers) {
        const auto fill = [&](const HexahedronRun& run, const Range& within) {
            const Corners i(run.inner, downwards), o(run.outer, downwards);
            Hexahedron* out = hexahedra.data() + (within.start + run.inner.shift);
            for (Index k = within.start; k < within.stop; ++k, ++out) {
                *out = {k + i.offset[0], k + i.offset[1], k + i.offset[2], k + i.offset[3],
                        k + o.offset[0], k + o.offset[1], k + o.offset[2], k + o.offset[3]};
            }
        };
        fill_runs(std::span<const HexahedronRun>(layer), range_of, threads, fill);
    }
}

Surface surface_of(const HelixRadii& radii, const Path& path, int threads) {
    const StandardArithmetic standard;
    require_threads(threads);
    const SurfaceLayout layout = surface_layout(radii);
    Surface surface;
    surface.vertices.resize(static_cast<std::size_t>(layout.vertex_count));
    surface.quads.resize(static_cast<std::size_t>(layout.quad_count));
    place(radii, path, layout.vertices, surface.vertices, threads);
    join(radii, layout, surface.quads, threads);
    for (const VertexRun& run : layout.vertices) {
        for (Index k = run.k.start; k < run.k.stop; ++k) surface.vertex_index.push_back(k);
    }
    for (const QuadRun& run : layout.quads) {
        for (Index k = run.k.start; k < run.k.stop; ++k) surface.quad_index.push_back(k);
    }
    return surface;
}

}  // namespace helibore
