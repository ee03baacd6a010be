// The diameters that the arms of a tool measured. Between few arms the wall is interpolated, and an oval hole becomes
// rounder than it is, since the neighbours of a vertex come from several arms. So the arms give the shape.
#pragma once

#include <cstddef>
#include <limits>
#include <span>
#include <vector>

#include "helibore/types.hpp"

namespace helibore {

inline constexpr std::size_t few_arms = 8;      // most diameters of a tool with few arms
inline constexpr double sees_all_around = 0.9;  // share of the turns with samples near, from which the wall shows them

// Samples with the number of the arm that measured each; the two ends of a diameter may have one number or two.
struct ArmSamples {
    std::span<const double> depth, toolface, radius;
    std::span<const Index> arm;
    std::span<const double> time{};                          // empty: unknown
    double reach = std::numeric_limits<double>::infinity();  // metres to the farthest reading that a turn takes
};

// Each value is the mean over a turn of the readings, linear between them, and of all passes; NaN where all readings of
// the arm are beyond reach. `diameter`, `toolface` (of the axis, in [0, 180)) and `uneven` (difference of the distances
// of both ends from the tool's axis) have one value for each turn, arm after arm; the others one for each turn, NaN if
// an arm has no diameter there: the largest diameter, its axis and unevenness, the diameter nearest to a right angle to
// it, the least.
struct ArmDiameters {
    std::size_t arms = 0;
    std::vector<double> diameter, toolface, uneven;
    std::vector<double> c1, c1_toolface, c1_uneven, c2, least_diameter;
};

// Returns the diameters at turns with these middles and this height, metres. None, with arms = 0, if the tool does not
// measure 2 to few_arms diameters, or has no two opposite samples at one depth. Throws InputError if columns differ in
// length.
ArmDiameters arm_diameters(const ArmSamples& samples, std::span<const double> depth, double height);

// Whether the tool measured diameters: the radii of two opposite samples are equal, or differ by the same amount all
// along the hole, where biases of the ends were subtracted. False if it measures fewer than 2 or more than few_arms.
bool measures_diameters(const ArmSamples& samples);

}  // namespace helibore
