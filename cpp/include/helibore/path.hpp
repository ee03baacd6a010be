// The path of the hole: computes positions and frames at any depth from survey stations.
//
//     const helibore::Survey survey({0, 100}, {15, 25}, {20, 45});   // metres, degrees, degrees
//     const helibore::Path path(survey, {.extend = 20});
//     path.position(depths); path.frame(depths);
//
// Between stations the path follows the curve that its method is named for, never a straight line:
//   minimum curvature    a circular arc from tangent to tangent
//   radius of curvature  a curve on an upright cylinder: inclination linear in depth, azimuth linear in the horizontal
//                        distance covered. Seen from above, and on the unrolled cylinder, it is a circular arc. It
//                        ends where the method's usual formulas place the next station; a curve with azimuth linear
//                        in depth would not.
// A path never changes. A longer survey gives a new path; down to the previous last station, both paths have the same
// bits.
// This header does not correct a survey (grid convergence, declination, sag) and computes no uncertainty.
#pragma once

#include <array>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "helibore/types.hpp"

namespace helibore {

// Stations: depth along the hole in metres, inclination (0 = straight down) and azimuth (0 = north, 90 = east) in
// degrees.
class Survey {
  public:
    // Throws InputError unless there are two stations or more, depths lie within 1e7 m of 0 and grow by 1e-6 m or more,
    // inclinations lie in 0 to 180 and azimuths in -360 to 360.
    Survey(std::span<const double> depth, std::span<const double> inclination, std::span<const double> azimuth);

    std::span<const double> depth() const { return depth_; }
    std::span<const double> inclination() const { return inclination_; }
    std::span<const double> azimuth() const { return azimuth_; }

    // Degrees between the tangents of each pair of neighbouring stations: one value fewer than stations.
    std::vector<double> dogleg() const;

  private:
    std::vector<double> depth_, inclination_, azimuth_;
};

enum class Method { minimum_curvature, radius_of_curvature };

// The direction in which toolface 0 points.
//   high side            up, at a right angle to the hole; undefined where the hole is vertical
//   north                north, at a right angle to the hole; undefined where the hole runs level north or south
//   parallel transport   north at the first station (the high side if that station lies within 45 deg of level north or
//                        south), moved down the hole from there without twisting about it. It is defined everywhere,
//                        so a well from vertical to horizontal has one continuous angle.
enum class Reference { high_side, north, parallel_transport };

// Return the value that has this name: "minimum-curvature", "radius-of-curvature"; "high-side", "north",
// "parallel-transport". Throw InputError for any other name.
Method method_of(std::string_view name);
Reference reference_of(std::string_view name);

struct PathSettings {
    Method method = Method::minimum_curvature;
    Reference reference = Reference::high_side;
    Vector3 head = {0.0, 0.0, 0.0};  // position of the first station
    double extend = 0.0;             // metres that the path continues straight below the last station, provisionally
};

// Three unit vectors at right angles: towards toolface 0 (as the path's Reference says), towards toolface 90 (right of
// toolface 0, looking downhole), and the tangent, downhole. A point of the wall lies at
// position + radius (cos(toolface) frame[0] + sin(toolface) frame[1]).
using Frame = std::array<Vector3, 3>;

struct Segments;  // private: src/surface/segments.hpp

class Path {
  public:
    // A straight vertical hole through (0, 0, 0), without ends, whose reference is north.
    Path();
    // Throws InputError if two neighbouring stations point in opposite directions (minimum curvature has no arc there),
    // and on settings that are not finite, a head beyond 1e9 m, extend < 0 or > 1e7 m.
    explicit Path(const Survey& survey, const PathSettings& settings = {});

    // Values at any depth from the first station to the last plus `extend`. Throws InputError ("depth[3] = 12: ...") at
    // other depths, and where a frame's reference is undefined.
    std::vector<Vector3> position(std::span<const double> depth) const;
    std::vector<Vector3> tangent(std::span<const double> depth) const;
    std::vector<Frame> frame(std::span<const double> depth) const;

    // Degrees in [0, 360) to add to a toolface measured from north to get it measured from the high side:
    // atan2(-sinA, cosI cosA). Throws InputError also where the high side or north is undefined.
    std::vector<double> north_to_high_side(std::span<const double> depth) const;

    Reference reference() const;
    double start_depth() const;   // the first station; -infinity for the straight vertical hole
    double survey_depth() const;  // the last station: the path below it is provisional
    double stop_depth() const;    // survey_depth + extend

    const Segments& segments() const { return *segments_; }

  private:
    friend class Stations;
    explicit Path(std::shared_ptr<const Segments> segments) : segments_(std::move(segments)) {}
    std::shared_ptr<const Segments> segments_;
};

// A survey that grows while the hole is drilled. Stations come in any order; a station at the depth of an earlier one
// replaces it. A course is the interval between two neighbouring stations; taking a station checks only the courses
// above and below that station. path() computes only what lies below the first station that changed since its last
// call, and returns the same bits as Path(survey(), settings).
class Stations {
  public:
    // Throws InputError on bad settings.
    explicit Stations(const PathSettings& settings = {});
    ~Stations();

    struct Taken {
        std::optional<double> path_from;   // metres; the path changed below this depth
        std::vector<std::string> refused;  // "station at 90 m: inclination[2] = 190: must lie in 0 to 180 degrees"
    };
    // Leaves out and reports each station that breaks a rule, and takes the others. Throws InputError on columns of
    // unequal length.
    Taken take(std::span<const double> depth, std::span<const double> inclination, std::span<const double> azimuth);

    std::span<const double> depth() const { return depth_; }  // growing
    std::span<const double> inclination() const { return inclination_; }
    std::span<const double> azimuth() const { return azimuth_; }
    std::optional<Survey> survey() const;  // none until there are two stations
    std::optional<Path> path();            // none until there are two stations

  private:
    std::optional<double> take_one(double depth, double inclination, double azimuth);

    PathSettings settings_;
    std::vector<double> depth_, inclination_, azimuth_;
    std::unique_ptr<Segments> segments_;
    std::size_t built_ = 0;  // segments_ holds the courses between the first built_ stations
    std::optional<Path> path_;
};

}  // namespace helibore
