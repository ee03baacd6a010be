// From the readings of a tool to samples for a wall: the default preparation, in one call.
//
//     rows --judge_rows--> suspect rows, of which some are left out --observe_by_depth--> samples
//     samples --turns_by_rotation, find_spikes--> samples without spikes
//     samples --share_of_repeats--> how many count again
//
// `prepare` takes these steps. Each step can also be taken alone; a step changes nothing that it is given.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "helibore/types.hpp"

namespace helibore {

// A sensor: metres up the string from the point whose depth is recorded, degrees clockwise from the tool's toolface
// reference, and the column with its readings. The two ends of a diameter are two sensors with one column.
struct ToolSensor {
    double offset = 0, mounting = 0;
    Index column = 0;
};

// The rows of a tool's log: columns of equal length, NaN where a value is missing. A diameter counts as its half.
struct ToolRows {
    std::span<const double> depth;                // metres
    std::span<const double> toolface;             // degrees, of the tool's reference
    std::vector<std::span<const double>> radii;   // metres, each column from an arm, a diameter or a sector of an image
    std::optional<std::span<const double>> time;  // seconds
};

// Why rows stand out.
enum class Cause {
    disagreement,  // two columns that look in the same direction differ by more than 2.5 mm in ten rows or more
    closed,        // all columns stay within 2 mm of their least radius, 10 mm or more below their median and the bit,
                   // over 2 m, or half a metre at an end of the rows
    ramp,          // the arms close before, or open after, a closed stretch
    saturated,     // an arm reads the largest radius to which it opens, once in five rows or more over half a metre
    stuck,         // an arm does not move in a hundred rows or more while the others do
    burst,         // a spike: up to five rows of one arm that no row and no other arm confirms
    jump,          // a spike of all arms at once, over at most 5 cm
};

struct SuspectRows {
    Cause cause = Cause::closed;
    Index column = -1;     // of `radii`; -1: all columns
    Range rows;            // half-open
    bool dropped = false;  // its readings do not become samples
    double radius = 0;     // closed, ramp, saturated, stuck: at which the arms stay (stuck: NaN if it has no reading);
                           // disagreement: median difference of the two columns; else NaN
    Index other = -1;      // disagreement: the other column
};

// Which of the suspect rows are left out.
struct PreparationSettings {
    std::optional<double> bit_diameter;  // metres; arms count as closed only 10 mm or more inside the bit
    bool drop_closed = true;             // needs the bit's diameter
    bool drop_saturated = true;
    bool drop_spikes = false;
    double spikes = 6.0;  // deviations from which a reading of a tool with few arms is odd
    // The threshold of find_spikes, for a tool that turns or shows the hole all around; none: its spikes stay.
    std::optional<double> turn_spikes = 6.0;
};

// Samples in the order of rows, then of sensors, and how many were left out because a value is missing: each is counted
// at the first of depth, toolface, radius and time that it lacks.
struct ToolSamples {
    std::vector<double> depth, toolface, radius;  // metres, degrees in [0, 360), metres
    std::vector<double> time;                     // seconds; empty if rows have none
    std::vector<std::int64_t> sensor, row;
    Index no_depth = 0, no_toolface = 0, no_radius = 0, no_time = 0;
};

struct Prepared {
    ToolSamples samples;
    std::vector<SuspectRows> suspects;  // as of judge_rows
    Index spikes = 0;                   // samples that find_spikes found, and that were left out
    double repeats = 0;  // share of samples that equal an earlier one and count again; 0 if rows have times
};

// Prepares a log without other settings than these. Throws InputError as judge_rows and observe_by_depth do, and for
// two columns that look in the same direction and differ by more than 2.5 mm in half of the rows.
Prepared prepare(const ToolRows& rows, std::span<const ToolSensor> sensors, const PreparationSettings& settings);

// Returns whether a row shows the hole all around: sensors at one place on the string look in eight directions or more.
bool is_image(std::span<const ToolSensor> sensors);

// Judges the rows of a tool with arms, in the order of the causes; the readings that a cause drops are missing for the
// next. Returns the suspect rows in this order. The rows of an image have none. Spikes are not judged where the tool
// turns by more than 30 degrees from row to row, since its rows then show different places of the wall. Throws
// InputError for columns of different lengths, and for a sensor without a column.
std::vector<SuspectRows> judge_rows(const ToolRows& rows, std::span<const ToolSensor> sensors,
                                    const PreparationSettings& settings);

// Returns where a column keeps one value, or has none, in `rows` rows or more while the values of the other columns
// change in a share `moving` of the rows.
std::vector<SuspectRows> stuck_arms(std::span<const std::span<const double>> radii, Index rows, double moving);

// Brings the sensors of a tool into one frame. Throws InputError for columns of different lengths, for a sensor without
// a column, and for an infinite depth, toolface or radius.
ToolSamples observe_by_depth(const ToolRows& rows, std::span<const ToolSensor> sensors);

// Returns for each reading of an arm 1 or -1 if it is above or below its running median (eight readings on either side)
// by more than `threshold` deviations, else 0; NaN is a missing reading. The deviation is the 85th percentile of the
// distances from the running median, over 1.44, in each hundred readings, and at least `floor`. Fewer than 17 readings:
// all 0.
std::vector<std::int64_t> odd_readings(std::span<const double> radius, double threshold, double floor);

// Returns the turn of each sample, from the toolfaces of a rotating tool's rows in order of time and the row of each
// sample. From row to row the tool turns the short way round. Returns nothing for a tool that moves more than a metre
// in a rotation: its turns do not see the same wall. Throws InputError for columns of different lengths, and for a row
// that is not there.
std::optional<std::vector<Index>> turns_by_rotation(std::span<const double> toolface, std::span<const Index> row,
                                                    std::span<const double> depth);

// Samples that are spikes, in rising order, and the number of samples that no turn beside theirs agrees with, and that
// have fewer than four neighbours to be judged by.
struct SpikedSamples {
    std::vector<Index> samples;
    Index unjudged = 0;
};

// Finds samples that disagree with the turns beside theirs and, where `depth` is given, with samples farther away at
// their toolface. Samples with one number in `turn` are one turn, in any order; samples without a radius (NaN) do not
// count. The neighbours of a sample are the six nearest in toolface of the two next to its toolface in each of the
// three turns before and after; none is farther than 20 degrees (a tool of few samples a turn: 0.75 of the angle
// between two, at most 45 degrees). A sample is a spike if
// - it lies beyond the second largest or second smallest neighbour by more than the tolerance and a tenth of the
//   difference of these two,
// - no sample next to its toolface in the turn before or after is within half the tolerance of it,
// - it is one of at most five samples side by side, and of a third of the turn, for which this holds, and the samples
//   beside these differ from them by more than half the tolerance, or lie beyond their own neighbours; or all samples
//   of a turn of at most five are such,
// - no sample confirms it: of those in its 10 degrees, more than three turns but at most 2 m away, the two nearest
//   before and the two after it, by depth, differ by more than half the tolerance (few samples a turn: the four
//   nearest, by more than the tolerance),
// - its turn is at most a metre long: in a longer one the tool slides, and its samples are not of one place.
// The tolerance is `threshold` deviations. The deviation of a hundred turns is 1.4826 times the median, over every
// fourth turn, of the median distance of a turn's samples from the medians of their neighbours, and at least `floor`,
// metres. Throws InputError for columns of different lengths, and for a threshold or floor that is not above 0.
SpikedSamples find_spikes(std::span<const double> toolface, std::span<const double> radius,
                          std::span<const std::int64_t> turn, std::optional<std::span<const double>> depth,
                          double threshold = 6.0, double floor = 0.0005);

// Returns the share of rows that equal an earlier row in all three columns. Of many rows, only about `most` are judged:
// hashes of depth and toolface choose them, so that all equal rows are among them, or none.
double share_of_repeats(std::span<const double> depth, std::span<const double> toolface, std::span<const double> radius,
                        Index most);

// Numbers the passes from 0, by the depth of the rows in the order of time. A pass begins where the tool turns back and
// then moves back by more than `reversal` metres. The row at the turning point, the last if several have its depth,
// ends its pass. Throws InputError for a depth that is not finite and a reversal that is not above 0.
std::vector<std::int64_t> number_passes(std::span<const double> depth, double reversal);

}  // namespace helibore
