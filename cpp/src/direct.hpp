// Direct connection (Energies 2021, 14, 291, Eq. 6): while drilling, a sample that falls in the cell of a vertex that
// is not settled yet stands for that vertex at once, provisionally; once settled the vertex is interpolated like any
// other.
//
//         |<- 360/K ->|
//     ----+-----------+----   pitch/2 above
//         |           |
//         |     k     |       of the samples in it the last in canonical order counts: while drilling, the newest
//         |           |
//     ----+-----------+----   pitch/2 below
#pragma once

#include <vector>

#include "helix.hpp"
#include "samples.hpp"

namespace helibore {

// The radii of the samples in the cells of a range of vertices; NaN where there is none.
std::vector<double> direct_radii(const Samples& samples, const Helix& helix, Range vertices);

// The vertices of [0, count) where two such lists, one from vertex `before_start` on, the other from `after_start` on,
// differ in any bit; a list that does not reach a vertex has NaN there. Sorted, never touching.
std::vector<Range> direct_changes(const std::vector<double>& before, Index before_start,
                                  const std::vector<double>& after, Index after_start, Index count);

}  // namespace helibore
