// The sigma of a radius from the weights, radii and distances of its neighbours.
#pragma once

namespace helibore {

// sigma^2 = noise W + between S^scatter_power D^distance_power,   D = A + stretch C
//
// W is the sum of the squared weights. S, A and C are mean squares over the neighbours: S of their radius minus the
// estimate, A of their distance along the hole, C of their distance around the hole, on the wall. S and D are at least
// 1e-18. If A + C is above reach^2, sigma is NaN.
struct SigmaRule {
    double noise, between;  // square metres; `between` has the unit that makes its term square metres
    double scatter_power, distance_power, stretch;
    double reach;  // metres
};

}  // namespace helibore
