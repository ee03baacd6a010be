// A sector image on the quads of a helix: the value of the cell that holds a quad's centre, or a value linear in depth
// and periodically linear in toolface.
//
//     row i    --- s --------- s+1 ---      value = top + down (bottom - top)
//                    x                      top = left + across (right - left), and so below
//     row i+1  --- s --------- s+1 ---
//
// Linear values: where a cell with a say is missing, between rows too far apart, above the first row and below the last
// there is none: NaN. A quad on a row, or at the centre of a sector, hears that one alone. What the sectors' angles
// mean is the caller's business.
#pragma once

#include <span>
#include <vector>

#include "helibore/types.hpp"

namespace helibore {

// Borrowed: one row a depth, rising, `sectors` values a row.
struct ImageRows {
    std::span<const double> depth;  // metres
    std::span<const double> values;
    int sectors = 2;
};

// Quads of the vertices 0 .. count-1 of a helix: the centre of quad k lies (k + (K + 1)/2) pitch/K below its start.
struct QuadCentres {
    double start_depth = 0.0;
    double pitch = 0.1;
    Index count = 0;
    std::span<const double> sector;  // of the K quads of a turn, in sectors, any real number: from the start of sector
                                     // 1 for cells, from its centre for linear values
};

// One value a quad; the bits do not depend on `threads`. Both throw InputError unless there is a value for every cell
// of the rows, and a sector.
//
// low, high: the depths [low, high) that each row covers, rising and without overlap; NaN between them.
std::vector<double> cell_values(const ImageRows& image, std::span<const double> low, std::span<const double> high,
                                const QuadCentres& quads, int threads = 1);
// reach: rows more than twice that apart, metres, have nothing between them.
std::vector<double> linear_values(const ImageRows& image, double reach, const QuadCentres& quads, int threads = 1);

}  // namespace helibore
