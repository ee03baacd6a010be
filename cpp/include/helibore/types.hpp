// Types that all other headers use: indices, half-open ranges, three-vectors.
// All public functions take and return metres and degrees; README.md states the conventions.
#pragma once

#include <array>
#include <cstdint>

namespace helibore {

using Index = std::int64_t;

// Half-open [start, stop), of vertices unless said otherwise.
struct Range {
    Index start = 0;
    Index stop = 0;
    friend bool operator==(const Range&, const Range&) = default;
};

// (north, east, down) in metres, or a unit vector in that frame.
using Vector3 = std::array<double, 3>;

}  // namespace helibore
