// A path cut into segments so short that two series give every sine and cosine on them. A vertex needs no library call,
// compilers vectorise the arithmetic, and path.cpp (one depth) and place.cpp (millions of vertices) give the same bits.
//
//     station i           station i+1
//        |-segment-|-segment-|-segment-|...      each bends by at most max_bend from its start
//
// Each segment starts from its own closed-form position, so errors do not add up along it, and a segment depends only
// on the stations above and below it: later stations cannot move it.
#pragma once

#include <algorithm>
#include <glm/geometric.hpp>
#include <glm/vec3.hpp>
#include <limits>
#include <string>
#include <type_traits>
#include <vector>

#include "helibore/error.hpp"
#include "helibore/path.hpp"

namespace helibore {

inline constexpr double max_bend = 1.0 / 32.0;  // radians; the series below are then exact to 3e-18

// sin(x)/x and (1 - cos(x))/x^2 for |x| <= max_bend. No division, and no special case at 0.
inline double sine_ratio(double x) {
    const double q = x * x;
    return 1.0 - q * (1.0 / 6.0) * (1.0 - q * (1.0 / 20.0) * (1.0 - q * (1.0 / 42.0)));
}
inline double versine_ratio(double x) {
    const double q = x * x;
    return 0.5 * (1.0 - q * (1.0 / 12.0) * (1.0 - q * (1.0 / 30.0) * (1.0 - q * (1.0 / 56.0))));
}

struct PathPoint {
    double north, east, down;    // position
    double tan_n, tan_e, tan_d;  // tangent
};

// A circular arc (or, with no curvature, a straight line) in the plane of tangent and normal.
struct Arc {
    double depth = 0.0;  // where the segment starts
    glm::dvec3 position{0.0}, tangent{0.0, 0.0, 1.0}, normal{0.0};
    double curvature = 0.0;          // radians a metre
    glm::dvec3 zero{1.0, 0.0, 0.0};  // toolface 0 by parallel transport, where the segment starts

    glm::dvec3 start_tangent() const { return tangent; }

    PathPoint at(double beyond) const {  // metres beyond `depth`
        const double x = curvature * beyond, s = sine_ratio(x), v = versine_ratio(x);
        const double along = beyond * s, aside = beyond * x * v;
        const double sine = x * s, cosine = 1.0 - x * x * v;
        return {position.x + along * tangent.x + aside * normal.x,
                position.y + along * tangent.y + aside * normal.y,
                position.z + along * tangent.z + aside * normal.z,
                cosine * tangent.x + sine * normal.x,
                cosine * tangent.y + sine * normal.y,
                cosine * tangent.z + sine * normal.z};
    }
};

// A curve on an upright cylinder: inclination grows with depth, azimuth grows with the horizontal distance.
struct CylinderCurve {
    double depth = 0.0;
    glm::dvec3 position{0.0};
    double sin_inclination = 0.0, cos_inclination = 1.0, sin_azimuth = 0.0, cos_azimuth = 1.0;
    double build = 0.0;              // radians a metre of depth
    double turn = 0.0;               // radians a metre of horizontal distance
    glm::dvec3 zero{1.0, 0.0, 0.0};  // toolface 0 by parallel transport, where the segment starts

    glm::dvec3 start_tangent() const {
        return {sin_inclination * cos_azimuth, sin_inclination * sin_azimuth, cos_inclination};
    }

    PathPoint at(double beyond) const {
        const double x = build * beyond, s = sine_ratio(x), v = versine_ratio(x);
        const double sine = x * s, cosine = 1.0 - x * x * v;
        const double across = beyond * (sin_inclination * s + cos_inclination * (x * v));  // integral of sin I
        const double down = beyond * (cos_inclination * s - sin_inclination * (x * v));    // integral of cos I
        const double sin_i = sin_inclination * cosine + cos_inclination * sine;
        const double cos_i = cos_inclination * cosine - sin_inclination * sine;
        const double y = turn * across, sy = sine_ratio(y), vy = versine_ratio(y);
        const double sine_y = y * sy, cosine_y = 1.0 - y * y * vy;
        const double cos_a = cos_azimuth * cosine_y - sin_azimuth * sine_y;
        const double sin_a = sin_azimuth * cosine_y + cos_azimuth * sine_y;
        return {position.x + across * (cos_azimuth * sy - sin_azimuth * (y * vy)),
                position.y + across * (sin_azimuth * sy + cos_azimuth * (y * vy)),
                position.z + down,
                sin_i * cos_a,
                sin_i * sin_a,
                cos_i};
    }
};

// A frame is undefined if its reference lies within this angle (radians, 0.00006 deg) of the tangent: at a smaller
// angle, rounding in the last digits of the survey would turn the frame.
inline constexpr double least_reference_angle = 1e-6;

// The axes towards toolface 0 and 90, not yet divided by `length`, the sine of the angle between reference and tangent.
//   high side: up, made normal to t    = (td tn, td te, -(tn^2 + te^2)) / length,  right = (-te, tn, 0) / length
//   north:     north, made normal to t = (te^2 + td^2, -tn te, -tn td) / length,   right = (0, td, -te) / length
//   parallel transport: the smallest rotation that takes s, the tangent where the segment starts, to t. z is toolface 0
//              there:  zero = z - (t z) / (1 + s t) (s + t),  right = t x zero
//              On arcs this is exactly the frame that never twists about t (Bishop 1975); on cylinder curves it
//              stays within 0.01 deg of that frame over a well.
struct Axes {
    double zero_n, zero_e, zero_d;
    double right_n, right_e, right_d;
    double square;  // length^2

    bool defined() const { return !(square < least_reference_angle * least_reference_angle); }
};
template <Reference reference, class Segment>
inline Axes axes_of(const Segment& segment, const PathPoint& p) {
    if constexpr (reference == Reference::high_side) {
        const double square = p.tan_n * p.tan_n + p.tan_e * p.tan_e;
        return {p.tan_d * p.tan_n, p.tan_d * p.tan_e, -square, -p.tan_e, p.tan_n, 0.0, square};
    } else if constexpr (reference == Reference::north) {
        const double square = p.tan_e * p.tan_e + p.tan_d * p.tan_d;
        return {square, -p.tan_n * p.tan_e, -p.tan_n * p.tan_d, 0.0, p.tan_d, -p.tan_e, square};
    } else {
        const glm::dvec3 s = segment.start_tangent(), &z = segment.zero;
        const double tz = p.tan_n * z.x + p.tan_e * z.y + p.tan_d * z.z;
        const double st = p.tan_n * s.x + p.tan_e * s.y + p.tan_d * s.z;
        const double share = tz / (1.0 + st);
        const double n = z.x - share * (s.x + p.tan_n), e = z.y - share * (s.y + p.tan_e);
        const double d = z.z - share * (s.z + p.tan_d);
        return {n,
                e,
                d,
                p.tan_e * d - p.tan_d * e,
                p.tan_d * n - p.tan_n * d,
                p.tan_n * e - p.tan_e * n,
                n * n + e * e + d * d};
    }
}

// Calls visit with the reference as a compile-time constant.
template <class Visit>
auto with_reference(Reference reference, const Visit& visit) {
    switch (reference) {
        case Reference::high_side:
            return visit(std::integral_constant<Reference, Reference::high_side>{});
        case Reference::north:
            return visit(std::integral_constant<Reference, Reference::north>{});
        case Reference::parallel_transport:
            break;
    }
    return visit(std::integral_constant<Reference, Reference::parallel_transport>{});
}

// How an error names a depth: as depth[index], or as the depth of vertex `index`.
struct DepthOf {
    Index index;
    bool vertex = false;
    InputError error(double depth, const std::string& rule) const;
};

struct Segments {
    // The path's method decides which of these two is filled. Sorted by depth.
    std::vector<Arc> arcs;
    std::vector<CylinderCurve> curves;
    Reference reference = Reference::north;
    double start_depth = -std::numeric_limits<double>::infinity();
    double survey_depth = std::numeric_limits<double>::infinity();
    double stop_depth = std::numeric_limits<double>::infinity();

    // Throws InputError unless the path reaches this depth.
    void require_reach(double depth, const DepthOf& of) const;
};

// Throws the InputError for a depth at which the reference is undefined.
[[noreturn]] void refuse_frame(Reference reference, double depth, const DepthOf& of);

// Returns the last segment that starts at or above `depth`, or the first segment if all start below `depth`.
template <class Segment>
inline const Segment& segment_at(const std::vector<Segment>& segments, double depth) {
    const auto below = std::upper_bound(segments.begin(), segments.end(), depth,
                                        [](double value, const Segment& segment) { return value < segment.depth; });
    return below == segments.begin() ? segments.front() : *(below - 1);
}

}  // namespace helibore
