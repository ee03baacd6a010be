// Direct connection (Energies 2021, 14, 291, Eq. 6): while drilling, a vertex that is not settled shows the latest
// sample in its cell, provisionally. When it is settled, it is interpolated like any other.
//
//         |<- 360/K ->|
//     ----+-----------+----   pitch/2 above
//         |           |
//         |     k     |       if the cell holds several samples, the last in canonical order counts,
//         |           |       which while drilling is the newest
//     ----+-----------+----   pitch/2 below
#pragma once

#include <algorithm>
#include <cmath>
#include <vector>

#include "samples/helix.hpp"
#include "samples/samples.hpp"

namespace helibore {

// The radii of samples shown at the vertices [start, start + radii.size()); NaN: none.
struct DirectRadii {
    Index start = 0;
    std::vector<double> radii;

    bool stands_for(Index k) const {
        return start <= k && k - start < static_cast<Index>(radii.size()) &&
               !std::isnan(radii[static_cast<std::size_t>(k - start)]);
    }
    // Returns the radius that a vertex shows if its estimate is `radius`.
    double shown(Index k, double radius) const {
        return stands_for(k) ? radii[static_cast<std::size_t>(k - start)] : radius;
    }
    // Returns the part of a range in which vertices may show samples; it is usually short or empty.
    Range among(Range range) const {
        const Index first = std::max(range.start, start);
        return {first, std::max(first, std::min(range.stop, start + static_cast<Index>(radii.size())))};
    }
    // Replaces the estimates of a range by the radii shown.
    void show(Range range, double* radius) const {
        const Range some = among(range);
        for (Index k = some.start; k < some.stop; ++k) radius[k - range.start] = shown(k, radius[k - range.start]);
    }
};

DirectRadii direct_radii(const Samples& samples, const Helix& helix, Range vertices);

// Returns the vertices of [0, count) that show different samples in `before` and in `after`.
std::vector<Range> direct_changes(const DirectRadii& before, const DirectRadii& after, Index count);

}  // namespace helibore
