// Checks the arguments of place() and join(): the helix, and the runs of a layout, which must fit the helix
// and the memory.
#pragma once

#include <cmath>
#include <span>
#include <string>

#include "base/messages.hpp"
#include "helibore/error.hpp"
#include "helibore/surface.hpp"

namespace helibore {

inline constexpr Index largest_index = Index{1} << 52;  // of a vertex: exact as a double, and sums do not overflow

inline void require_helix(const HelixRadii& radii) {
    require_sectors(radii.sectors);
    require_pitch(radii.pitch);
    if (radii.radius.empty()) return;  // an empty wall has no start
    require_depth("start_depth", radii.start_depth);
    require(std::isfinite(radii.start_toolface), "start_toolface", radii.start_toolface, "must be finite");
    require(radii.first >= -largest_index && radii.first <= largest_index, "first", radii.first,
            "must lie in -2^52 to 2^52");
}

inline Range vertices_of(const HelixRadii& radii) {
    return {radii.first, radii.first + static_cast<Index>(radii.radius.size())};
}

inline const QuadRun& placed(const QuadRun& run) {
    return run;
}
inline const QuadRun& placed(const HexahedronRun& run) {
    return run.inner;
}
inline const VertexRun& placed(const VertexRun& run) {
    return run;
}

// Throws InputError unless the runs of a layout are in order, do not overlap, take only vertices that `radii` has, and
// fill only the `size` rows of the memory. In the error, `name` is the name of the runs and `memory` that of the rows.
template <class Run>
void require_runs(const HelixRadii& radii, const std::string& name, std::span<const Run> runs, std::size_t size,
                  const char* memory) {
    const auto rows = static_cast<Index>(size);
    const Range there = vertices_of(radii);
    for (std::size_t i = 0; i < runs.size(); ++i) {
        const auto& run = placed(runs[i]);
        const auto refuse = [&](const std::string& rule) {
            throw InputError(entry_name(name, static_cast<Index>(i)), rule, range_text(run.k));
        };
        if (run.k.start >= run.k.stop) refuse("must not be empty");
        if (run.k.start < there.start || run.k.stop > there.stop)
            refuse("must lie within the vertices " + range_text(there) + " of radius");
        if (run.shift < -run.k.start || run.shift > rows - run.k.stop)
            refuse("must be placed within the " + std::to_string(rows) + " rows of " + memory);
        if (i == 0) continue;
        const auto& before = placed(runs[i - 1]);
        if (run.k.start < before.k.stop || run.shift + run.k.start < before.shift + before.k.stop)
            refuse("must follow " + range_text(before.k));
    }
}

// Throws InputError unless the corners of the quads of run `i` are numbers that a layout can have.
inline void require_corners(const std::string& name, Index i, const QuadRun& run) {
    for (const Index corner : {run.upper, run.lower})
        if (corner < -2 * largest_index || corner > 2 * largest_index)
            throw InputError(entry_name(name, i), "must have corners within 2^53 rows of k", range_text(run.k));
}

inline void require_layers(const HelixRadii& radii, const VolumeLayout& layout, std::size_t hexahedra) {
    for (std::size_t i = 0; i < layout.layers.size(); ++i) {
        const std::string name = entry_name("layers", static_cast<Index>(i));
        const std::span<const HexahedronRun> runs(layout.layers[i]);
        require_runs(radii, name, runs, hexahedra, "hexahedra");
        for (std::size_t run = 0; run < runs.size(); ++run) {
            require_corners(name, static_cast<Index>(run), runs[run].inner);
            require_corners(name, static_cast<Index>(run), runs[run].outer);
        }
    }
}

}  // namespace helibore
