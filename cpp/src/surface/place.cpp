// Placing vertices: P = C(depth) + R (cos(toolface) h + sin(toolface) right), for millions of them.
//
// Vertices go in chunks that lie on one piece of the path. A chunk is plain loops without a library call or branch:
// the piece's series give position and tangent, the tangent gives the frame, and K sines and cosines are all the
// toolfaces there are. Each vertex's bits depend on its k alone, not on where chunks, runs or threads begin.
#include <algorithm>
#include <atomic>
#include <cmath>
#include <limits>

#include "base/degrees.hpp"
#include "base/number_text.hpp"
#include "base/threads.hpp"
#include "helibore/error.hpp"
#include "helibore/surface.hpp"
#include "samples/helix.hpp"
#include "surface/segments.hpp"

namespace helibore {
namespace {

constexpr int chunk_size = 256;
constexpr Index vertices_a_part = 4096;  // that a thread takes at a time
constexpr Index none = std::numeric_limits<Index>::max();

// Cosine and sine of the toolface of vertex k at k % K, and on for a chunk more, so that a chunk reads them in a row.
struct Toolfaces {
    std::vector<double> cosine, sine;
    explicit Toolfaces(const Helix& helix) {
        for (Index j = 0; j < helix.sectors + chunk_size; ++j) {
            const SineCosine of = sine_cosine(helix.toolface(j));
            cosine.push_back(of.cosine);
            sine.push_back(of.sine);
        }
    }
};

struct Task {
    Helix helix;
    Index first;  // the vertex of radius[0]
    const double* radius;
    const Pieces& path;
    Toolfaces toolfaces;
};

// Places vertices k .. k + count - 1, all on `piece`. Returns how many of them have no frame.
template <Reference reference, class Piece>
int place_chunk(const Task& task, const Piece& piece, Index k, int count, Vector3* out) {
    const Index sectors = task.helix.sectors, phase = ((k % sectors) + sectors) % sectors;
    const double* cosine = task.toolfaces.cosine.data() + phase;
    const double* sine = task.toolfaces.sine.data() + phase;
    const double* radius = task.radius + (k - task.first);
    const double first = static_cast<double>(k), turn = static_cast<double>(sectors);
    const double start = task.helix.start_depth, pitch = task.helix.pitch;
    double north[chunk_size], east[chunk_size], down[chunk_size], square[chunk_size];
    for (int j = 0; j < count; ++j) {
        const double depth = start + (first + static_cast<double>(j)) * pitch / turn;  // Helix::depth, bit for bit
        const Point p = piece.at(depth - piece.depth);
        const Axes a = axes_of<reference>(piece, p);
        const double scale = radius[j] / std::sqrt(a.square), c = cosine[j] * scale, s = sine[j] * scale;
        north[j] = p.north + (c * a.zero_n + s * a.right_n);
        east[j] = p.east + (c * a.zero_e + s * a.right_e);
        down[j] = p.down + (c * a.zero_d + s * a.right_d);
        square[j] = a.square;
    }
    for (int j = 0; j < count; ++j) out[j] = {north[j], east[j], down[j]};
    int without = 0;  // counted apart: in the loop above it would keep compilers from vectorising that loop
    for (int j = 0; j < count; ++j) without += square[j] < least_reference_angle * least_reference_angle ? 1 : 0;
    return without;
}

// How many of the `count` vertices from k on lie on the piece that k lies on.
template <class Piece>
int count_on(const std::vector<Piece>& pieces, const Piece& piece, const Helix& helix, Index k, int count) {
    const double upper = &piece == pieces.data() ? -no_limit : piece.depth;
    const double lower = &piece == &pieces.back() ? no_limit : (&piece + 1)->depth;
    const auto on_piece = [&](int j) {
        const double depth = helix.depth(k + j);
        return depth >= upper && depth < lower;
    };
    if (on_piece(count - 1)) return count;
    int on = 1, off = count - 1;  // vertex k + on - 1 lies on the piece, k + off does not
    while (on < off) {
        const int middle = on + (off - on) / 2;
        on_piece(middle) ? on = middle + 1 : off = middle;
    }
    return on;
}

// Places vertices [k.start, k.stop) from row `out` on. Returns the first that has no frame, or `none`.
template <Reference reference, class Piece>
Index place_range(const Task& task, const std::vector<Piece>& pieces, Range k, Vector3* out) {
    Index refused = none;
    while (k.start < k.stop) {
        const Piece& piece = piece_at(pieces, task.helix.depth(k.start));
        const int most = static_cast<int>(std::min<Index>(chunk_size, k.stop - k.start));
        const int count = count_on(pieces, piece, task.helix, k.start, most);
        if (place_chunk<reference>(task, piece, k.start, count, out) > 0 && refused == none) refused = k.start;
        k.start += count;
        out += count;
    }
    return refused;
}

Index place_range(const Task& task, const Range& k, Vector3* out) {
    const auto on = [&](const auto& pieces) {
        switch (task.path.reference) {
            case Reference::high_side:
                return place_range<Reference::high_side>(task, pieces, k, out);
            case Reference::north:
                return place_range<Reference::north>(task, pieces, k, out);
            case Reference::carried:
                return place_range<Reference::carried>(task, pieces, k, out);
        }
        throw InternalError("a path without a reference");
    };
    return task.path.curves.empty() ? on(task.path.arcs) : on(task.path.curves);
}

void require_reach(const Task& task, std::span<const VertexRun> runs) {
    for (const VertexRun& run : runs) {
        for (const Index k : {run.k.start, run.k.stop - 1}) {
            const double depth = task.helix.depth(k);
            if (depth >= task.path.start_depth && depth <= task.path.stop_depth) continue;
            task.path.require_reach(depth, "vertex " + std::to_string(k) + " at depth " + number_text(depth));
        }
    }
}

// The vertices of [k, k + chunk_size) hold one without a frame: says which. A carried reference has one everywhere.
[[noreturn]] void refuse(const Task& task, const Path& path, Index k) {
    for (;; ++k) {
        const double depth = task.helix.depth(k);
        const std::string where = "vertex " + std::to_string(k) + " at depth " + number_text(depth);
        const auto square = [&](const auto& piece) {
            const Point p = piece.at(depth - piece.depth);
            return task.path.reference == Reference::high_side ? axes_of<Reference::high_side>(piece, p).square
                                                               : axes_of<Reference::north>(piece, p).square;
        };
        const double of = task.path.curves.empty() ? square(piece_at(task.path.arcs, depth))
                                                   : square(piece_at(task.path.curves, depth));
        if (of < least_reference_angle * least_reference_angle) path.pieces().refuse_frame(where);
    }
}

}  // namespace

void place(const HelixRadii& radii, const Path& path, std::span<const VertexRun> runs, std::span<Vector3> vertices,
           int threads) {
    if (runs.empty()) return;
    const Helix helix{radii.start_depth, radii.start_toolface, radii.pitch, radii.sectors};
    const Task task{helix, radii.first, radii.radius.data(), path.pieces(), Toolfaces(helix)};
    require_reach(task, runs);
    const Index first = runs.front().k.start, length = runs.back().k.stop - first;
    std::vector<Index> refused(static_cast<std::size_t>(std::max(threads, 1)), none);
    for_each_range(threads, length, vertices_a_part, [&](int worker, const Range& part) {
        const Range within = {first + part.start, first + part.stop};
        auto run = std::partition_point(runs.begin(), runs.end(),
                                        [&](const VertexRun& r) { return r.k.stop <= within.start; });
        Index& without = refused[static_cast<std::size_t>(worker)];
        for (; run != runs.end() && run->k.start < within.stop; ++run) {
            const Range k = {std::max(run->k.start, within.start), std::min(run->k.stop, within.stop)};
            without = std::min(without, place_range(task, k, vertices.data() + (k.start + run->shift)));
        }
    });
    const Index lowest = *std::min_element(refused.begin(), refused.end());
    if (lowest != none) refuse(task, path, lowest);
}

}  // namespace helibore
