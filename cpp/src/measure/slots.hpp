// The pipe that wore a slot.
#pragma once

#include <cstddef>
#include <vector>

namespace helibore {

// A point of a slot, metres from the centre of the unworn circle of its turn: along the slot's direction, and across.
struct SlotPoint {
    std::size_t turn;
    double along, across;
};

// Returns the diameter of the circle that fits points of a slot, in order of turns; in each turn it may lie at another
// place along the direction. NaN if the points do not show it to within 2 mm (standard deviation, in a hole of 8.5 in),
// or if it is wider than the bit.
double pipe_diameter(const std::vector<SlotPoint>& points, double bit_diameter);

}  // namespace helibore
