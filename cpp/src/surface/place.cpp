// Computes the positions of millions of vertices: P = C(depth) + R (cos(toolface) h + sin(toolface) right), where C is
// the path, h points to toolface 0, and `right` points to toolface 90.
//
// Vertices are placed in chunks, each on one segment of the path. A chunk is plain loops without a library call or
// branch: the segment's series give position and tangent, the tangent gives the frame, and a table holds the sines and
// cosines of all K toolfaces. The result for a vertex depends on its k alone, not on where chunks, runs or threads
// begin.
#include <algorithm>
#include <atomic>
#include <cmath>
#include <limits>

#include "base/arithmetic.hpp"
#include "base/degrees.hpp"
#include "base/messages.hpp"
#include "base/threads.hpp"
#include "helibore/error.hpp"
#include "helibore/surface.hpp"
#include "samples/helix.hpp"
#include "surface/layout_rules.hpp"
#include "surface/segments.hpp"

namespace helibore {
namespace {

constexpr int chunk_size = 256;
constexpr Index vertices_a_part = 4096;  // vertices that a thread takes at a time
constexpr Index none = std::numeric_limits<Index>::max();

// Entry k % K has the cosine and sine of the toolface of vertex k. The table continues for one chunk, so that a chunk
// reads it in sequence.
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
    const Segments& path;
    Toolfaces toolfaces;
};

// Places vertices k .. k + count - 1, all on `segment`. Returns how many of them have no frame.
template <Reference reference, class Segment>
int place_chunk(const Task& task, const Segment& segment, Index k, int count, Vector3* out) {
    const Index sectors = task.helix.sectors, phase = ((k % sectors) + sectors) % sectors;
    const double* cosine = task.toolfaces.cosine.data() + phase;
    const double* sine = task.toolfaces.sine.data() + phase;
    const double* radius = task.radius + (k - task.first);
    const double first = static_cast<double>(k), turn = static_cast<double>(sectors);
    const double start = task.helix.start_depth, pitch = task.helix.pitch;
    double north[chunk_size], east[chunk_size], down[chunk_size], square[chunk_size];
    for (int j = 0; j < count; ++j) {
        const double depth = start + (first + static_cast<double>(j)) * pitch / turn;  // the same bits as Helix::depth
        const PathPoint p = segment.at(depth - segment.depth);
        const Axes a = axes_of<reference>(segment, p);
        const double scale = radius[j] / std::sqrt(a.square), c = cosine[j] * scale, s = sine[j] * scale;
        north[j] = p.north + (c * a.zero_n + s * a.right_n);
        east[j] = p.east + (c * a.zero_e + s * a.right_e);
        down[j] = p.down + (c * a.zero_d + s * a.right_d);
        square[j] = a.square;
    }
    for (int j = 0; j < count; ++j) out[j] = {north[j], east[j], down[j]};
    int without = 0;  // counted in a separate loop: in the loop above the count would prevent vectorisation
    for (int j = 0; j < count; ++j) without += square[j] < least_reference_angle * least_reference_angle ? 1 : 0;
    return without;
}

// Returns how many of the `count` vertices from k on lie on `segment`. Vertex k must lie on it.
template <class Segment>
int count_on(const std::vector<Segment>& segments, const Segment& segment, const Helix& helix, Index k, int count) {
    const double upper = &segment == segments.data() ? -no_limit : segment.depth;
    const double lower = &segment == &segments.back() ? no_limit : (&segment + 1)->depth;
    const auto on_segment = [&](int j) {
        const double depth = helix.depth(k + j);
        return depth >= upper && depth < lower;
    };
    if (on_segment(count - 1)) return count;
    int on = 1, off = count - 1;  // vertex k + on - 1 lies on the segment, k + off does not
    while (on < off) {
        const int middle = on + (off - on) / 2;
        on_segment(middle) ? on = middle + 1 : off = middle;
    }
    return on;
}

// Places vertices [k.start, k.stop) from row `out` on. Returns the start of the first chunk with a vertex that has no
// frame, or `none`.
template <Reference reference, class Segment>
Index place_range(const Task& task, const std::vector<Segment>& segments, Range k, Vector3* out) {
    Index refused = none;
    while (k.start < k.stop) {
        const Segment& segment = segment_at(segments, task.helix.depth(k.start));
        const int most = static_cast<int>(std::min<Index>(chunk_size, k.stop - k.start));
        const int count = count_on(segments, segment, task.helix, k.start, most);
        if (place_chunk<reference>(task, segment, k.start, count, out) > 0 && refused == none) refused = k.start;
        k.start += count;
        out += count;
    }
    return refused;
}

Index place_range(const Task& task, const Range& k, Vector3* out) {
    return with_reference(task.path.reference, [&](auto reference) {
        return task.path.curves.empty() ? place_range<reference>(task, task.path.arcs, k, out)
                                        : place_range<reference>(task, task.path.curves, k, out);
    });
}

void require_reach(const Task& task, std::span<const VertexRun> runs) {
    for (const VertexRun& run : runs) {
        for (const Index k : {run.k.start, run.k.stop - 1}) {
            task.path.require_reach(task.helix.depth(k), {k, true});
        }
    }
}

// Throws the error of the first vertex from k on that has no frame. The caller has found that there is such a vertex.
// The reference is not parallel transport, which has a frame everywhere.
[[noreturn]] void refuse(const Task& task, Index k) {
    for (;; ++k) {
        const double depth = task.helix.depth(k);
        const auto defined = [&](const auto& segment) {
            const PathPoint p = segment.at(depth - segment.depth);
            return with_reference(task.path.reference,
                                  [&](auto reference) { return axes_of<reference>(segment, p).defined(); });
        };
        if (!(task.path.curves.empty() ? defined(segment_at(task.path.arcs, depth))
                                       : defined(segment_at(task.path.curves, depth))))
            refuse_frame(task.path.reference, depth, {k, true});
    }
}

}  // namespace

void place(const HelixRadii& radii, const Path& path, std::span<const VertexRun> runs, std::span<Vector3> vertices,
           int threads) {
    const StandardArithmetic standard;
    require_helix(radii);
    require_threads(threads);
    require_runs(radii, "runs", runs, vertices.size(), "vertices");
    if (runs.empty()) return;
    const Helix helix{radii.start_depth, radii.start_toolface, radii.pitch, radii.sectors};
    const Task task{helix, radii.first, radii.radius.data(), path.segments(), Toolfaces(helix)};
    require_reach(task, runs);
    const Index first = runs.front().k.start, length = runs.back().k.stop - first;
    std::vector<Index> refused(static_cast<std::size_t>(threads), none);
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
    if (lowest != none) refuse(task, lowest);
}

}  // namespace helibore
