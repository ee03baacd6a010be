// The sigma of a radius from the weights, radii and distances of its neighbours.
#pragma once

namespace helibore {

// sigma^2 = noise W + between S^scatter_power D^distance_power,   D = A + stretch C
//
// W: sum of the squared weights. S, A, C: means over the neighbours of squares: of their radius less the estimate, of
// their distance along the hole, and of that around it, on the wall; S and D at least 1e-18. Where A + C is above
// reach^2, sigma is NaN.
struct SigmaRule {
    double noise, between;  // square metres, and what makes the sum square metres
    double scatter_power, distance_power, stretch;
    double reach;  // metres
};

}  // namespace helibore
