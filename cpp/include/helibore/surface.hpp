// The wall in space: vertices along the path, joined into quads (a surface) or hexahedra (a volume).
//
//     const helibore::Settings& settings = wall.settings();
//     const std::vector<double> radius = wall.radius();
//     const helibore::HelixRadii radii{.start_depth = wall.start_depth(), .start_toolface = settings.start_toolface,
//                                      .pitch = settings.pitch, .sectors = settings.sectors, .radius = radius};
//     const helibore::Surface surface = helibore::surface_of(radii, path);
//
// The helix of the radii must be that of the wall: take all four numbers from the wall, because the defaults fit only a
// wall with default settings.
//
// The quad of vertex k, seen from the formation; depth downwards, toolface to the right for a positive pitch:
//
//      k (a0) ---- k+1 (a1)        Order (a0, a1, b1, b0): counter-clockwise seen from the formation, so that the
//        |            |            normal points away from the axis. With a negative pitch b lies above a, and the
//     k+K (b0) -- k+1+K (b1)       order is (a0, b0, b1, a1), with the same outward normal.
//
// A vertex whose radius is NaN is left out, with every quad and hexahedron that touches it. The remaining vertices form
// runs: consecutive vertices k that are also consecutive in the output. A layout holds the runs, so that a caller can
// reserve exactly the memory needed and have it filled once, by several threads. This header has no attributes and no
// files.
#pragma once

#include <array>
#include <span>
#include <vector>

#include "helibore/path.hpp"
#include "helibore/types.hpp"

namespace helibore {

// Radii at consecutive vertices of the helix of their wall. Borrowed: the radii must outlive the call.
struct HelixRadii {
    double start_depth = 0.0;        // metres, of vertex 0
    double start_toolface = 0.0;     // degrees, of vertex 0
    double pitch = 0.1;              // metres per turn; negative for a well logged upwards
    int sectors = 64;                // K: vertices per turn
    Index first = 0;                 // the vertex that radius[0] belongs to
    std::span<const double> radius;  // metres; NaN: the vertex is left out
};

using Quad = std::array<Index, 4>;
using Hexahedron = std::array<Index, 8>;  // inner quad, then the outer quad over it: VTK's order, positive volume

struct VertexRun {
    Range k;      // vertices of the helix
    Index shift;  // vertex k is row k + shift of the output
};
struct QuadRun {
    Range k;             // the quads of these vertices
    Index shift;         // the quad of vertex k is row k + shift of the output
    Index upper, lower;  // the quad's corners: rows k + upper, k + 1 + upper, k + 1 + K + lower, k + K + lower
};
struct HexahedronRun {
    QuadRun inner, outer;  // both have the same k and shift
};

struct SurfaceLayout {
    std::vector<VertexRun> vertices;
    std::vector<QuadRun> quads;
    Index vertex_count = 0, quad_count = 0;
};

// Lists, from the wall outwards, the vertices of every shell, and the hexahedra between each shell and the next.
struct VolumeLayout {
    std::vector<std::vector<VertexRun>> shells;
    std::vector<std::vector<HexahedronRun>> layers;
    Index vertex_count = 0, hexahedron_count = 0;
};

// Returns the layout of the surface. Throws InputError on sectors < 3, on a pitch of 0, on another number of the helix
// that is not finite or is too large, and on a radius that is neither NaN nor finite and above 0.
SurfaceLayout surface_layout(const HelixRadii& radii);

// Returns the layout of a volume between shells. `shells`: two or more, each with the radii of the same vertices as
// radii.radius; the first shell is radii.radius itself. Throws InputError unless every shell lies beyond the shell
// before it, wherever both have a radius ("shells[0][17] = 0.1 at depth 12.5: must lie beyond radius[17] = 0.11").
VolumeLayout volume_layout(const HelixRadii& radii, std::span<const std::span<const double>> shells);

// place fills `vertices`; join fills `quads` or `hexahedra`. The caller provides the memory, with as many rows as the
// layout counts (vertex_count, quad_count, hexahedron_count). The result does not depend on `threads`. Both functions
// throw InputError if a run lies outside the radii or the memory. place also throws it if the path does not reach a
// vertex, or if the path's reference is undefined at a vertex ("vertex 7 at depth 12: ...").
void place(const HelixRadii& radii, const Path& path, std::span<const VertexRun> runs, std::span<Vector3> vertices,
           int threads = 1);
void join(const HelixRadii& radii, const SurfaceLayout& layout, std::span<Quad> quads, int threads = 1);
void join(const HelixRadii& radii, const VolumeLayout& layout, std::span<Hexahedron> hexahedra, int threads = 1);

// Throws InputError if a corner of a hexahedron is turned inside out. The error names the first such hexahedron
// ("shells[1] at vertex 7, depth 12.5: ..."). If the radii are nested, this happens only where the path bends with a
// radius smaller than that of a shell, or where the frame of the path turns fast, as the high-side frame does where the
// hole is nearly vertical.
void require_upright(const HelixRadii& radii, const VolumeLayout& layout, std::span<const Vector3> vertices,
                     std::span<const Hexahedron> hexahedra, int threads = 1);

// Returns the volume of each hexahedron in cubic metres. Its faces are bilinear patches, which neighbours share.
std::vector<double> volumes(std::span<const Vector3> vertices, std::span<const Hexahedron> hexahedra, int threads = 1);

struct Surface {
    std::vector<Vector3> vertices;
    std::vector<Quad> quads;
    std::vector<Index> vertex_index;  // for each row of `vertices`, the number of the vertex on the helix
    std::vector<Index> quad_index;    // for each quad, the vertex k that it belongs to
};
Surface surface_of(const HelixRadii& radii, const Path& path = {}, int threads = 1);

}  // namespace helibore
