// Computes the value of a sector image at the centre of each quad of a helix: the value of the cell that holds the
// centre (cell_values), or a value that is linear in depth and in toolface, also across 360 degrees (linear_values).
//
//     row i    --- s --------- s+1 ---      value = top + down (bottom - top)
//                    x                      top = left + across (right - left), bottom likewise in row i+1
//     row i+1  --- s --------- s+1 ---
//
// x is the centre of the quad. left and right are the values of a row at the sectors s and s+1; across and down are the
// shares of the way from s to s+1 and from row i to row i+1.
//
// A linear value is NaN where a cell that it needs is missing, between rows that are too far apart, above the first row
// and below the last. A quad exactly on a row, or at the centre of a sector, uses that row or sector alone. The caller
// says at which angles the sectors lie.
#pragma once

#include <span>
#include <vector>

#include "helibore/types.hpp"

namespace helibore {

// The rows of an image: one row for each depth, in rising order, with `sectors` values each. Borrowed: the arrays must
// outlive the call.
struct ImageRows {
    std::span<const double> depth;  // metres
    std::span<const double> values;
    int sectors = 2;
};

// Quads of the vertices 0 .. count-1 of a helix: the centre of quad k lies (k + (K + 1)/2) pitch/K below vertex 0.
struct QuadCentres {
    double start_depth = 0.0;
    double pitch = 0.1;
    Index count = 0;
    // The position of each of the K quads of a turn, measured in sectors, any real number: counted from the start of
    // sector 1 for cell_values, from the centre of sector 1 for linear_values.
    std::span<const double> sector;
};

// The two functions below return one value for each quad; the result does not depend on `threads`. They throw
// InputError if `values` does not hold `sectors` values for each depth (a missing value is NaN), if depths fall, if
// `sector` is empty, or if a number breaks its rule.
//
// low, high: row i covers the depths [low[i], high[i]). Rows must not overlap; quads between two rows get NaN.
std::vector<double> cell_values(const ImageRows& image, std::span<const double> low, std::span<const double> high,
                                const QuadCentres& quads, int threads = 1);
// reach: metres. Quads between two rows that are more than 2 * reach apart get NaN.
std::vector<double> linear_values(const ImageRows& image, double reach, const QuadCentres& quads, int threads = 1);

}  // namespace helibore
