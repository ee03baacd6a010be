// The weight (neighbor_weight.hpp) of one neighbour, for code outside the kernel.
#pragma once

#include <cmath>

#include "search/kernel/neighbor_weight.hpp"
#include "search/kernel/pack_plain.hpp"

namespace helibore::kernel {

// Returns (d_min / d)^power, computed from the squared distances `least` and `square` in plain arithmetic.
inline double relative_weight(double least, double square, double power) {
    if (power == 1.0) return std::sqrt(least / square);
    const PlainPack squares(square);
    PlainPack weight;
    relative_weights(&squares, PlainPack(least), 1, power, &weight);
    double each[lanes];
    weight.store(each);
    return each[0];
}

}  // namespace helibore::kernel
