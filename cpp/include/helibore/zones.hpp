// Zones: intervals of hole of one kind, and what they measure.
//
//     turn    . . w w w . w w w w . . . b b b b .      kind of each turn by the criteria; .: gauge
//     zone        |-- washout --|       |break-|       runs of one kind are joined over short gaps
//
// A breakout or washout goes on, in gaps and at its ends, where the hole has nearly as much as in the middle.
//
// The kind of a turn is the first of these whose rule fits (bit: the bit diameter):
//
//     undergauge   least diameter < bit - limit
//     washout      C2 - bit >= limit                   enlarged all around
//     breakout     C1 - C2 >= limit, two high lobes    opposite: 140 degrees or more between them
//     key seat     one high lobe                       at most 150 degrees wide
//
// A lobe of a turn counts if the wall stays about as high at its toolface over the least length of a zone. An open
// fracture crosses the hole and is no zone: at one toolface it is as long as its aperture / cos(dip).
//
// The sections of a few turns of each run are then compared with a library of sections (kinds.hpp): a run whose kind is
// unlikely, and that may be gauge, is no zone. Where turns have few samples over 0.3 m or more, their kind is the one
// that the chain of kinds_along finds.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "helibore/arms.hpp"
#include "helibore/kinds.hpp"
#include "helibore/logs.hpp"
#include "helibore/types.hpp"
#include "helibore/unworn.hpp"

namespace helibore {

// The numbers of kinds in `Zone`, in `Zones::kinds` and in kinds.hpp.
enum class HoleKind : std::int8_t { none = -1, gauge, washout, breakout, key_seat, undergauge };

// Metres, but for the shares `symmetry` and `opening_level`.
struct ZoneCriteria {
    double elongation = 0.0254, washout = 0.0127, key_seat = 0.00635, undergauge = 0.00635;
    double symmetry = 0.5;        // twice the lower lobe of a breakout is at least this share of both
    double opening_level = 0.25;  // share of a lobe's height at which its opening is measured
    double least_length = 0.3;    // of a zone
    double join = 1.0;            // two zones of a kind are one if they are at most this far apart

    KindCriteria limits() const { return {elongation, washout, key_seat, undergauge, symmetry}; }
};

// Radii of the samples of each turn, in section_parts parts: the mean in each part, part p around the toolface
// p 360 / section_parts; NaN: no sample. Samples that lie on no turn of `vertices`, and radii of NaN, do not count.
std::vector<double> turn_sections(const HelixVertices& vertices, const SamplePlaces& samples,
                                  std::span<const double> radius);

// The same where each vertex counts as a sample.
std::vector<double> turn_sections(const HelixVertices& vertices, std::span<const double> radius);

// Returns the radii of the samples of a robust wall (Settings::robust), NaN for those that are spikes to it: they lie
// beyond the vertices on all sides of them by more than 2.5 deviations of the noise. A spike shows no shape: several of
// them along a hole of bit size would be a key seat. `wall`: radii of `vertices`; `noise`: variance, m^2.
std::vector<double> kept_radii(const HelixVertices& vertices, std::span<const double> wall, const SamplePlaces& samples,
                               std::span<const double> radius, double noise);

// Returns 1 for each turn of which less than half of the section has samples, over 0.3 m of hole or more, else 0.
// `height`: of a turn, metres.
std::vector<double> sparse_turns(std::span<const double> sections, double height);

// The samples of a wall, in order of depth, as Wall::samples returns them. Borrowed.
struct ZoneSamples {
    SamplePlaces places;
    std::span<const double> radius;
    ArmSamples arms{};       // the same samples in any order, with the arm of each; empty: the arms are not known
    bool diameters = false;  // each radius is half of a diameter, whose ends are not known; or the arms show it
    double noise = 0.0;      // of a robust wall, m^2: kept_radii() show the shape; 0: all radii do
};

// What the turns of a wall measure: one value for each turn, as in TurnLogs and UnwornTurns. Borrowed.
struct MeasuredTurns {
    std::span<const double> depth;              // of the middle, metres
    std::span<const double> coverage, sampled;  // share of the vertices that are measured, or have samples near
    std::span<const double> mean, c1, c1_toolface, c2, least_diameter;
    std::span<const double> unworn_diameter, unworn_0, unworn_90;
    struct Lobe {
        std::span<const double> toolface, width, height;
    };
    std::array<Lobe, 2> lobes;
    std::span<const double> sections;  // section_parts for each turn, as turn_sections returns them
    // Of a tool with few arms: c1, c2 and least_diameter are diameters that its arms measured, and this is the
    // difference of the radii at the two ends of c1, 0 if diameters were measured. Empty: all around the wall.
    std::span<const double> uneven;
    ZoneSamples samples{};  // that pipes are fitted to; without them, to the vertices
};

// The vertices of these turns. Borrowed.
struct TurnVertices {
    std::span<const double> radius;  // metres; an incomplete last turn does not count
    int sectors;
    double start_toolface;  // of the first vertex, degrees
    double pitch;           // metres
};

// The chain along the hole, as kinds_along returns it for the turns that are sparse. Borrowed; empty: no turn is.
struct ChainedTurns {
    std::span<const double> kinds;
    std::span<const Index> seen;
};

struct ZoneLobe {
    double toolface, opening, height;  // degrees, degrees, metres; opening is NaN for a tool with few arms
};

// Lengths in metres, angles in degrees; NaN where a kind has no such value. Sizes are those of the turns that meet the
// criterion, not of gaps.
struct Zone {
    HoleKind kind;
    double start, stop;              // depths, start above stop
    double measure, median;          // extreme and median of what the criterion limits
    double severity;                 // measure / limit
    double enlargement, elongation;  // extreme C1 - bit (undergauge: least diameter - bit), greatest C1 - C2
    double peak;                     // depth of the enlargement
    double coverage;                 // mean, also of the gaps
    double confidence;               // probability of the kind, 0.5 to 0.99
    double pipe_diameter;            // that fits the bottom of a key seat; NaN if few samples or a shallow slot show it
    double toolface, deviation;      // axis in [0, 180) of a breakout or direction of a key seat, and its spread
    std::array<ZoneLobe, 2> lobes;   // two of a breakout, one of a key seat
};

struct Zones {
    std::vector<HoleKind> kinds;  // of each turn: of the zone that it is in, if it meets the criterion
    std::vector<Zone> zones;      // in order of depth
};

// The result does not depend on `threads`. Throws InputError if columns have different lengths or more turns than the
// radii, and if a criterion is not finite or below 0. `libraries`: of the same bit and criteria.
Zones find_zones(const MeasuredTurns& turns, const TurnVertices& vertices, double bit_diameter,
                 const ZoneCriteria& criteria, const ChainedTurns& chained, const SectionLibraries& libraries,
                 int threads = 1);

// The zones of a wall, and the measures of its turns that they were found from.
struct WallZones : Zones {
    ArmDiameters arms;  // arms = 0: the wall gives the shape
    UnwornTurns unworn;
    std::vector<double> sparse;  // of each turn: 1 if its section has few samples (sparse_turns)
    KindsAlong along;            // of sparse turns; size is the mean squared radius, m2
};

// Measures a wall, from vertices and samples, and finds its zones. `radius`: of each of `vertices`; `bit_diameter`: as
// in unworn_turns. The diameters are those of the arms if arm_diameters finds them and less than sees_all_around of the
// turns have samples near; else those of the wall, which between few arms is rounder than the hole. Throws InputError
// as turn_logs, measured, arm_diameters and find_zones do.
WallZones wall_zones(const HelixVertices& vertices, std::span<const double> radius, const ZoneSamples& samples,
                     double bit_diameter, const ZoneCriteria& criteria = {},
                     const MeasuredRule& rule = usual_measured_rule, int threads = 1);

}  // namespace helibore
