// What a wall is built with. Every vertex is a pure function of these settings and the samples.
#pragma once

#include <limits>
#include <optional>

#include "helibore/types.hpp"

namespace helibore {

// The code a search runs on. All levels give the same bits; forcing one is for tests and benchmarks.
enum class InstructionSet { automatic, plain, avx2, avx512 };

inline constexpr double no_limit = std::numeric_limits<double>::infinity();

struct Settings {
    double bit_diameter = 0.0;               // metres; the first trial radius is half of it. Must be set.
    int sectors = 64;                        // K: vertices a turn of the helix, 3 or more
    double pitch = 0.1;                      // metres a turn along the hole; negative for a well logged upwards
    std::optional<double> start_depth = {};  // depth of vertex 0; none: the first sample met along the helix
    std::optional<double> stop_depth = {};   // the wall ends here; none: the last sample met along the helix
    double start_toolface = 0.0;             // toolface of vertex 0, degrees
    int neighbors = 8;                       // V: nearest samples a vertex is estimated from, 1 to 256
    std::optional<Index> window = {};        // U: search only this many consecutive samples; none: all, exactly
    double power = 1.0;                      // weight = distance^-power
    double max_distance = 1.0;               // metres; a sample farther away has no say. no_limit: none
    int max_iterations = 4;                  // estimates at the most
    double tolerance = 1e-6;                 // metres; stop when the radius moves by no more
    double angular_scale = 1.0;              // 1: true arc length; 2: as published (Energies 2021, 14, 291, Eq. 4)
    bool direct = false;                     // show samples of vertices that are not settled as they are, provisionally
    int threads = 1;                         // 1 or more; the result does not depend on it
    InstructionSet instruction_set = InstructionSet::automatic;

    // Throws InputError that names the first setting that breaks its rule.
    void validate() const;
};

}  // namespace helibore
