// What passes through the hole: the clearance of a rigid, straight string of cylinders at each depth, in three
// dimensions along the path.
//
//        |    |  |    |       The axis of the string may lie anywhere across the hole and lean. The clearance is the
//        |    |  |   /        greatest that any position of the axis leaves between a body and the wall, as a diameter:
//        |   _|  |_ |         a cylinder of diameter 0 has the greatest diameter of a rigid body of its length (drift).
//         \ |      | \        A body that does not fit has a clearance below 0.
//          ||______|  \       .
//
// For an axis c0 + tau c1 (tau: -1 to 1 along the string) the distance to each point of the wall in a body's reach is
// to be at least the body's radius and the clearance. Each distance is replaced by its component along the direction
// from the axis to the point, which is never greater; so the best axis of this linear programme fits the wall, and is
// the next axis to start from, until the clearance grows no more. Between turns, the wall runs straight from each
// vertex to the one of the same toolface in the next turn; a body ends there too.
#pragma once

#include <span>
#include <vector>

#include "helibore/path.hpp"
#include "helibore/surface.hpp"
#include "helibore/types.hpp"

namespace helibore {

// A cylinder of the string. `start` and `stop` are metres down the axis from the middle of the string.
struct RigidBody {
    double start = -0.5, stop = 0.5;
    double diameter = 0.0;
};

inline constexpr int most_contacts = 5;

// One value for each full turn of the wall, whose mean depth is that of the string's middle. NaN: unknown, because a
// vertex beside a body is missing or does not count, or the string reaches beyond the wall.
struct Passage {
    std::vector<double> clearance;  // metres, of the wall as it is
    // With `sigma`: the ends of the interval that holds the clearance of the true hole with 95 % probability; NaN
    // otherwise, and where the sigma of a vertex beside a body is NaN. It counts that errors of the wall stand in the
    // way of the string, and that they hide what stands in its way.
    std::vector<double> low, high;
    // For each turn `most_contacts` places where the string touches if it is as thick as the clearance allows, the
    // place that holds it most first; NaN and -1 where there are fewer.
    std::vector<double> contact_depth, contact_toolface;
    std::vector<Index> contact_body;
};

// Computes the passage of a string. `counts` and `sigma` have one entry for each radius or none: a vertex with count 0
// does not count, and `sigma` is the standard uncertainty of each radius, metres. The result does not depend on
// `threads`. Throws InputError if the path does not reach the wall or has no frame there, as `place` does; if there is
// no body, a body is not longer than 1e-3 m, or has a diameter below 0; and if a length of columns differs. If
// `only_turn` is not below 0, this turn alone has a result.
Passage passage(const HelixRadii& radii, const Path& path, std::span<const RigidBody> string,
                std::span<const double> counts = {}, std::span<const double> sigma = {}, int threads = 1,
                Index only_turn = -1);

}  // namespace helibore
