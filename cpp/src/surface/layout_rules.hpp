// Checks of what a caller hands to the functions that fill a layout: the helix, and runs that fit the memory.
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
    require(std::isfinite(radii.start_depth), "start_depth", radii.start_depth, "must be finite");
    require(std::isfinite(radii.start_toolface), "start_toolface", radii.start_toolface, "must be finite");
    require(std::abs(radii.start_depth) <= largest_depth, "start_depth", radii.start_depth, depth_rule);
    require(radii.first >= -largest_index && radii.first <= largest_index, "first", radii.first,
            "must lie in -2^52 to 2^52");
}

struct Placed {
    Range k;
    Index shift;
};

// Throws InputError unless runs follow one another and their rows lie within the memory.
template <class Run, class PlacedOf>
void require_runs(const std::string& name, std::span<const Run> runs, const PlacedOf& placed_of, std::size_t size,
                  const char* memory) {
    const auto rows = static_cast<Index>(size);
    for (std::size_t i = 0; i < runs.size(); ++i) {
        const Placed run = placed_of(runs[i]);
        const auto refuse = [&](const std::string& rule, const Range& shown) {
            throw InputError(entry_name(name, static_cast<Index>(i)), rule, range_text(shown));
        };
        if (run.k.start < -2 * largest_index || run.k.stop > 2 * largest_index || run.k.start >= run.k.stop)
            refuse("must not be empty and lie in -2^53 to 2^53", run.k);
        if (i > 0 && run.k.start < placed_of(runs[i - 1]).k.stop)
            refuse("must follow " + range_text(placed_of(runs[i - 1]).k), run.k);
        if (run.shift < -run.k.start || run.shift > rows - run.k.stop)
            refuse("must be placed within the " + std::to_string(rows) + " rows of " + memory, run.k);
    }
}

}  // namespace helibore
