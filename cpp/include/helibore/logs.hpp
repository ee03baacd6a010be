// Logs of a wall: what each full turn of its helix measures.
//
//     area = 1/2 int r^2 dphi = pi mean(r^2)       centre = int r^3 (cos, sin) dphi / (3 area)
//
//            0              0: toolface 0; x: the axis; inner line: the inscribed circle
//        .-'---`-.          c1: the largest diameter through the axis; c2: the one at right angles to it
//      /  .-----.  `.       inscribed: a circle with no vertex inside; no small move of its centre enlarges it
//     |  (   x   )    |     enclosing: the smallest circle with no vertex outside
//      `. `-----' __.'
//        `-----'
//
// The integrals are means over evenly spaced toolfaces (the periodic trapezoid rule). For a smooth hole they are exact
// to rounding; the area of a polygon of 16 vertices would be 2.5 % too small. A turn with a missing radius is NaN in
// all columns except `coverage`, `smallest` and `largest`; the last two are NaN only if all radii of the turn are
// missing. The caller computes volumes, ratios and depths from these columns.
#pragma once

#include <cstdint>
#include <limits>
#include <span>
#include <vector>

#include "helibore/types.hpp"

namespace helibore {

// Radii of consecutive vertices, starting with the first vertex of a turn; an incomplete last turn is left out.
// Borrowed: the radii must outlive the call.
struct Turns {
    double start_toolface = 0.0;     // degrees, of the first vertex
    int sectors = 64;                // K: vertices per turn, 3 or more
    std::span<const double> radius;  // metres; NaN: missing
    Index window = 11;               // turns (not metres) in the window of rugosity: odd, 3 or more

    // Python's wall.logs() takes a length in metres, 1 by default, and converts it to 2 * round((metres / pitch - 1) /
    // 2) + 1 turns, at least 3; halves are rounded to even. At a pitch of 0.1 m, 1 m is 9 turns.

    // For a part of a wall: the number of its first turn, and the reference radius that rugosity subtracts from all
    // radii, metres; NaN: the first radius that is not missing. From the first turn whose number is a multiple of 256
    // on, turns at least half a window inside the part have the same bits as in the whole wall.
    Index first = 0;
    double reference = std::numeric_limits<double>::quiet_NaN();
};

// One value for each turn. Lengths in metres; directions 0 and 90 are toolfaces. Diameters go through the axis.
struct TurnLogs {
    std::vector<double> coverage;                 // share of the vertices that have a radius
    std::vector<double> mean, mean_square;        // of the radius
    std::vector<double> smallest, largest;        // radius of the turn
    std::vector<double> c1, c1_toolface, c2;      // toolface in [0, 180)
    std::vector<double> least_diameter;           // the least diameter through the axis
    std::vector<double> diameter_0, diameter_90;  // across toolfaces 0 and 180, 90 and 270
    std::vector<double> centre_0, centre_90;      // of the area, from the axis towards toolfaces 0 and 90
    std::vector<double> inscribed_diameter, inscribed_0, inscribed_90;  // diameter; centre, as in centre_0 and _90
    std::vector<double> enclosing_diameter;
    // Root mean square of the radii in the window around the turn, minus a straight line along the hole in each sector;
    // each line takes two degrees of freedom. NaN if the window reaches beyond the first or last turn, or has a turn
    // with a missing radius.
    std::vector<double> rugosity;
};

// Returns the logs of each full turn; they do not depend on `threads`. Throws InputError on sectors < 3, on a window
// that is even or below 3, on a negative `first`, and on a radius that is neither NaN nor between 1e-50 and 1e50 m.
TurnLogs turn_logs(const Turns& turns, int threads = 1);

// The first `count` vertices of a helix, metres and degrees.
struct HelixVertices {
    double start_depth = 0.0;
    double start_toolface = 0.0;
    double pitch = 0.1;
    Index sectors = 64;
    Index count = 0;
    Index first = 0;  // number of vertex 0 on the whole helix, a multiple of `sectors`
};

// The depths and toolfaces of samples, in order of depth, as Wall::samples returns them. Borrowed: they must outlive
// the call.
struct SamplePlaces {
    std::span<const double> depth, toolface;
};

// Returns the angular gap of each vertex: degrees between the nearest samples on its two sides. Only samples within
// `reach` metres of the vertex's depth count. The gap is 0 at a sample's toolface, and 360 if no sample counts, or if
// the only sample that counts lies at another toolface. The result does not depend on `threads`.
std::vector<double> angular_gaps(const HelixVertices& vertices, const SamplePlaces& samples, double reach,
                                 int threads = 1);

// What makes a vertex measured: a sample near it, samples on its two sides, and little change of the wall between. Of
// the differences between the vertex and its four nearest samples, the change is hypot(m, s d / 2): m their mean,
// weighted by the inverse distance, s their rms, d the distance to the nearest. Distances are shares of `near_depth`
// and `near_toolface`. Where d is below 0.3, m is mostly the samples' noise, which the wall averages: it counts
// (d / 0.3)^2 times.
struct MeasuredRule {
    double near_depth, near_toolface;  // a sample lies within so many metres and so many degrees, at most 180
    double gap_reach, largest_gap;     // the angular gap of samples within this reach is at most so many degrees
    double largest_change = std::numeric_limits<double>::infinity();  // metres; needs `Radii`
};

// With these numbers 95 % of the errors of measured vertices are below 1.6 mm.
inline constexpr MeasuredRule usual_measured_rule{0.15, 15.0, 0.5, 60.0, 0.0011};

// The radii of the samples and of the vertices, metres. Borrowed, as `SamplePlaces`.
struct Radii {
    std::span<const double> samples, vertices;
};

// Returns 1 for each measured vertex, 2 where only the change of the wall is more than allowed, 0 for the others. The
// result does not depend on `threads`.
std::vector<std::uint8_t> measured(const HelixVertices& vertices, const SamplePlaces& samples, const MeasuredRule& rule,
                                   int threads = 1, const Radii& radii = {});

}  // namespace helibore
