// Computes the volumes of hexahedra, and checks that none is turned inside out.
//
//        7 ---- 6        the outer quad over the inner one; edges run straight, faces are the bilinear
//       /|     /|        patches between them, which neighbours share: volumes add up without gaps
//      4 ---- 5 |
//      | 3 ---| 2        V = integral of det J over the unit cube, in three determinants (Grandy 1997,
//      |/     |/         UCRL-ID-128886, eq. 14, there with corners in the order 0 1 3 2 4 5 7 6)
//      0 ---- 1
#include <algorithm>
#include <atomic>
#include <limits>

#include "base/arithmetic.hpp"
#include "base/host_memory.hpp"
#include "base/messages.hpp"
#include "base/threads.hpp"
#include "helibore/error.hpp"
#include "helibore/surface.hpp"
#include "samples/helix.hpp"
#include "surface/layout_rules.hpp"

namespace helibore {
namespace {

constexpr Index cells_a_part = 4096;
constexpr Index none = std::numeric_limits<Index>::max();

Vector3 operator-(const Vector3& a, const Vector3& b) {
    return {a[0] - b[0], a[1] - b[1], a[2] - b[2]};
}
Vector3 operator+(const Vector3& a, const Vector3& b) {
    return {a[0] + b[0], a[1] + b[1], a[2] + b[2]};
}
double determinant(const Vector3& a, const Vector3& b, const Vector3& c) {
    return a[0] * (b[1] * c[2] - b[2] * c[1]) + a[1] * (b[2] * c[0] - b[0] * c[2]) + a[2] * (b[0] * c[1] - b[1] * c[0]);
}

struct Corners {
    Vector3 of[8];
    // A corner that is no row is replaced by row 0; require_corners() has refused it, unless the host has written it
    // since then.
    Corners(std::span<const Vector3> vertices, const Hexahedron& hexahedron) {
        for (std::size_t i = 0; i < 8; ++i) {
            const auto row = static_cast<std::size_t>(read_once(hexahedron[i]));
            of[i] = vertices[row < vertices.size() ? row : 0];
        }
    }
};

double volume_of(const Corners& c) {
    const Vector3 &x0 = c.of[0], &x1 = c.of[1], &x3 = c.of[2], &x2 = c.of[3];
    const Vector3 &x4 = c.of[4], &x5 = c.of[5], &x7 = c.of[6], &x6 = c.of[7];
    const Vector3 a = x6 - x0, b = x7 - x1, d = x7 - x2, e = x3 - x0, f = x5 - x0, g = x7 - x4;
    return (determinant(b + a, d, e) + determinant(a, d + f, g) + determinant(b, f, g + e)) / 12.0;
}

// Returns whether the three edges at every corner form a right-handed system.
bool upright(const Corners& c) {
    constexpr std::size_t edges[8][3] = {{1, 3, 4}, {2, 0, 5}, {3, 1, 6}, {0, 2, 7},
                                         {7, 5, 0}, {4, 6, 1}, {5, 7, 2}, {6, 4, 3}};
    bool all = true;
    for (std::size_t i = 0; i < 8; ++i) {
        const Vector3& at = c.of[i];
        all &= determinant(c.of[edges[i][0]] - at, c.of[edges[i][1]] - at, c.of[edges[i][2]] - at) > 0.0;
    }
    return all;
}

// Returns the first row below `count` that is not `good`, or `none`. It searches on several threads.
template <class Good>
Index first_bad(Index count, int threads, const Good& good) {
    std::atomic<Index> first{none};
    for_each_range(threads, count, cells_a_part, [&](int, const Range& rows) {
        for (Index row = rows.start; row < rows.stop; ++row) {
            if (good(static_cast<std::size_t>(row))) continue;
            for (Index least = first; row < least && !first.compare_exchange_weak(least, row);) {
            }
            return;
        }
    });
    return first;
}

void require_corners(std::span<const Vector3> vertices, std::span<const Hexahedron> hexahedra, int threads) {
    require_threads(threads);
    const auto rows = static_cast<Index>(vertices.size());
    const auto is_row = [&](Index corner) { return corner >= 0 && corner < rows; };
    const Index bad = first_bad(static_cast<Index>(hexahedra.size()), threads,
                                [&](std::size_t row) { return std::ranges::all_of(hexahedra[row], is_row); });
    if (bad == none) return;
    const Hexahedron& of = hexahedra[static_cast<std::size_t>(bad)];
    const auto corner = std::ranges::find_if_not(of, is_row);
    require(false, entry_name(entry_name("hexahedra", bad), corner - of.begin()), *corner,
            "must be a row of the " + std::to_string(rows) + " vertices");
}

// Returns the place of the outer side of the hexahedron in this row: "shells[1] at vertex 7, depth 12.5".
std::string place_of(const HelixRadii& radii, const VolumeLayout& layout, Index row) {
    const Helix helix{radii.start_depth, radii.start_toolface, radii.pitch, radii.sectors};
    for (std::size_t layer = 0; layer < layout.layers.size(); ++layer) {
        for (const HexahedronRun& run : layout.layers[layer]) {
            const Index k = row - run.inner.shift;
            if (k < run.inner.k.start || k >= run.inner.k.stop) continue;
            return "shells[" + std::to_string(layer) + "] at vertex " + std::to_string(k) + ", depth " +
                   number_text(helix.depth(k));
        }
    }
    throw InputError("layers", "must place a hexahedron in every row: none in row " + std::to_string(row));
}

}  // namespace

void require_upright(const HelixRadii& radii, const VolumeLayout& layout, std::span<const Vector3> vertices,
                     std::span<const Hexahedron> hexahedra, int threads) {
    const StandardArithmetic standard;
    require_helix(radii);
    const auto count = static_cast<Index>(hexahedra.size());
    require(count == layout.hexahedron_count, "hexahedra", count,
            "must be as many as the layout has: " + std::to_string(layout.hexahedron_count));
    require_layers(radii, layout, hexahedra.size());
    require_corners(vertices, hexahedra, threads);
    const Index first =
        first_bad(count, threads, [&](std::size_t row) { return upright(Corners(vertices, hexahedra[row])); });
    if (first == none) return;
    throw InputError(
        place_of(radii, layout, first),
        "folds over itself; the path bends there with a radius below that of the shell, or its frame turns too fast");
}

std::vector<double> volumes(std::span<const Vector3> vertices, std::span<const Hexahedron> hexahedra, int threads) {
    const StandardArithmetic standard;
    require_corners(vertices, hexahedra, threads);
    std::vector<double> out(hexahedra.size());
    for_each_range(threads, static_cast<Index>(hexahedra.size()), cells_a_part, [&](int, const Range& rows) {
        for (auto at = static_cast<std::size_t>(rows.start); at < static_cast<std::size_t>(rows.stop); ++at)
            out[at] = volume_of(Corners(vertices, hexahedra[at]));
    });
    return out;
}

}  // namespace helibore
