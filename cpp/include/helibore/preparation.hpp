// The costly steps from the readings of a tool to samples for a wall. The caller joins them and reports what they find.
//
//     rows of p sensors --odd_readings--> which may be spikes
//                       --observe_by_depth--> samples --share_of_repeats--> are rows repeated?
//     depths of the rows --number_passes--> runs down and up the hole
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "helibore/types.hpp"

namespace helibore {

// Where a sensor sits on the string: metres up from the point whose depth is recorded, and degrees clockwise from the
// tool's toolface reference.
struct SensorPlace {
    double offset = 0, mounting = 0;
};

// The rows of a tool's log: columns of equal length, NaN where a value is missing.
struct ToolRows {
    std::span<const double> depth;                // metres
    std::span<const double> toolface;             // degrees, of the tool's reference
    std::vector<std::span<const double>> radii;   // metres, a column for each sensor
    std::optional<std::span<const double>> time;  // seconds
};

// Samples in the order of rows, then of sensors, and how many were left out because a value is missing: each is counted
// at the first of depth, toolface, radius and time that it lacks.
struct ToolSamples {
    std::vector<double> depth, toolface, radius,
        time;  // metres, degrees in [0, 360), metres, seconds (if rows have it)
    std::vector<std::int64_t> sensor, row;
    Index no_depth = 0, no_toolface = 0, no_radius = 0, no_time = 0;
};

// Brings the sensors of a tool into one frame. Throws InputError for columns of different lengths and for an infinite
// depth, toolface or radius.
ToolSamples observe_by_depth(const ToolRows& rows, std::span<const SensorPlace> sensors);

// Returns for each reading of an arm 1 or -1 if it is above or below its running median (eight readings on either side)
// by more than `threshold` deviations, else 0; NaN is a missing reading. The deviation is the 85th percentile of the
// distances from the running median, over 1.44, in each hundred readings, and at least `floor`. Fewer than 17 readings:
// all 0.
std::vector<std::int64_t> odd_readings(std::span<const double> radius, double threshold, double floor);

// Returns the share of rows that equal an earlier row in all three columns. Of many rows, only about `most` are judged:
// hashes of depth and toolface choose them, so that all equal rows are among them, or none.
double share_of_repeats(std::span<const double> depth, std::span<const double> toolface, std::span<const double> radius,
                        Index most);

// Numbers the passes from 0, by the depth of the rows in the order of time. A pass begins where the tool turns back and
// then moves back by more than `reversal` metres. The row at the turning point, the last if several have its depth,
// ends its pass. Throws InputError for a depth that is not finite and a reversal that is not above 0.
std::vector<std::int64_t> number_passes(std::span<const double> depth, double reversal);

}  // namespace helibore
