// The uniform helix: vertex k lies at toolface (start + k 360/K) mod 360 and depth start + k pitch/K. A wall may be a
// stretch of the helix, from vertex `first` on. Inside the wall its vertices count from 0; they have the same bits as
// on the whole helix.
#pragma once

#include <algorithm>
#include <cmath>

#include "helibore/settings.hpp"

namespace helibore {

// Returns any finite angle wrapped to [0, 360) degrees.
inline double wrap_toolface(double degrees) {
    if (degrees >= 0.0 && degrees < 360.0) return degrees + 0.0;  // + 0.0 turns -0 into 0
    const double wrapped = std::fmod(degrees, 360.0);
    const double positive = wrapped < 0.0 ? wrapped + 360.0 : wrapped + 0.0;
    return positive < 360.0 ? positive : 0.0;  // -1e-20 + 360 rounds to 360
}

struct Helix {
    double start_depth = 0.0;
    double start_toolface = 0.0;
    double pitch = 0.1;
    Index sectors = 64;
    Index first = 0;  // number of vertex 0 on the whole helix, a multiple of `sectors`

    double depth(Index k) const { return depth_of(static_cast<double>(first + k)); }
    double depth_of(double number) const { return start_depth + number * pitch / static_cast<double>(sectors); }
    double toolface(Index k) const {
        return wrap_toolface(start_toolface + static_cast<double>(k % sectors) * 360.0 / static_cast<double>(sectors));
    }
    // Returns the number of vertices to `stop_depth`: floor(K (stop - start) / pitch) + 1 less `first`, or 0 if that is
    // negative. It is a double, because it may exceed an Index.
    double count(double stop_depth) const {
        const double turns = static_cast<double>(sectors) * (stop_depth - start_depth) / pitch;
        return std::max(0.0, std::floor(turns) + 1.0 - static_cast<double>(first));
    }
    // +1 where the helix grows downwards, -1 where it grows upwards.
    double direction() const { return pitch > 0.0 ? 1.0 : -1.0; }
};

}  // namespace helibore
