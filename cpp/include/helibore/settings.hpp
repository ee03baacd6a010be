// The settings of a wall. Every vertex is a pure function of these settings and the samples.
#pragma once

#include <limits>
#include <optional>
#include <vector>

#include "helibore/types.hpp"

namespace helibore {

// The instructions that a search uses. All give the same results, equal in every bit; tests and benchmarks choose one.
enum class InstructionSet { automatic, plain, avx2, avx512 };

// The method that computes a radius from its neighbours. Kriging uses the neighbours of the last estimate by inverse
// distance. near_and_far is kriging by Settings::covariance, with near and far neighbours (search/near_far.hpp).
enum class Estimator { inverse_distance, kriging, near_and_far };

inline constexpr double no_limit = std::numeric_limits<double>::infinity();

struct Settings {
    double bit_diameter = 0.0;               // metres, 0.001 to 4; half of it is the first trial radius. Required.
    int sectors = 64;                        // K: vertices per turn of the helix, 3 or more
    double pitch = 0.1;                      // metres per turn along the hole; negative for a well logged upwards
    std::optional<double> start_depth = {};  // depth of vertex 0, within 1e7 m of 0; none: the first sample
    std::optional<double> stop_depth = {};   // the wall ends here; none: at the last sample along the helix
    double start_toolface = 0.0;             // toolface of vertex 0, degrees
    int neighbors = 8;                       // V: how many nearest samples give a radius, 1 to 256; kriging: 1 to 64;
                                             // near_and_far: search/near_far.hpp, 1 to 21
    std::optional<Index> window = {};        // U: search only this many consecutive samples; none: all samples
    double power = 1.0;                      // weight = distance^-power; above 0, at most 100
    double max_distance = 1.0;               // metres, 1e-9 or more; samples farther away are not used; may be no_limit
    int max_iterations = 4;                  // at most this many estimates per vertex, 1 to 255
    double tolerance = 1e-6;                 // metres; stop when the radius changes by no more than this
    double angular_scale = 1.0;  // 0.001 to 1000. 1: true arc length; 2: as published (Energies 2021, 14, 291)
    Estimator estimator = Estimator::inverse_distance;
    double kriging_range = 0.0;  // metres in the metric of angular_scale; kriging: must be set
    double nugget = 0.1;         // kriging: noise variance divided by the variance of the shape, at least 1e-6
    // near_and_far: R, the noise variance of a sample, and one to three terms, each with its variance, length around
    // and length along the hole; metres and square metres. Then, if the shape turns along the hole, by how many degrees
    // a metre. The covariance of two radii is the sum over the terms of variance M(h), with M(h) = (1 + sqrt3 h)
    // exp(-sqrt3 h), h = hypot(chord / around, depth difference / along) and chord = 2 R sin(turned / 2), where turned
    // = toolface difference - turn * depth difference. If the length around of the second term is below 0, the term
    // repeats after half a turn, as breakouts do: chord = R sin(turned). If that of the first term is below 0, the term
    // is smooth: M(h) = exp(-h^2 / 2).
    std::vector<double> covariance = {};
    // near_and_far: other covariances that the samples leave about as likely: for each its share of the probability,
    // and nine values as above, of two terms, with the turn and the same R. The share of `covariance` is the rest. A
    // radius is then the mean by all of them, and its variance the expected square about this.
    std::vector<double> other_turns = {};
    // near_and_far, for a hole that changes along it: for each stretch the depth at which it begins, and twelve values
    // as above, of three terms, of which the variance of the third may be 0, and the turn. A vertex has the covariance
    // of its stretch, and `covariance` above the first.
    std::vector<double> stretches = {};
    static constexpr std::size_t of_turn = 10, of_stretch = 13;  // values of each other turn, of each stretch
    bool robust = false;                // near_and_far: samples that differ from all beside them hardly count
    bool sigma = false;                 // the wall keeps Wall::sums for uncertainties; radii do not depend on it
    bool direct = false;                // a vertex that is not settled shows its latest sample, provisionally
    Index most_vertices = 100'000'000;  // an append that would exceed this is refused, because a depth must be wrong
    int threads = 1;                    // 1 to most_threads; the result does not depend on it
    InstructionSet instruction_set = InstructionSet::automatic;

    // The wall has the vertices [first_vertex, stop_vertex) of the helix. first_vertex is a multiple of `sectors`; if
    // it is not 0, start_depth must be set. stop_vertex replaces stop_depth.
    Index first_vertex = 0;
    std::optional<Index> stop_vertex = {};  // none: up to stop_depth, or to the last sample along the helix

    // Throws InputError if a setting breaks its rule. The error names the first such setting.
    void validate() const;
};

}  // namespace helibore
