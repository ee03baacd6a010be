// The kind of hole along a well whose tool has few samples a turn: sections are compared with those of a library, and a
// chain carries the section along the hole.
//
//     window 0      window 1      window 2         each window of turns sees some parts of the section
//      .---.         .---.         .---.
//      |      \      |     |     |     |     -->   stays (likely), changes within its kind, or becomes any section
//           --'       ---         ---'
//
// chi^2 of a window's section d and a section s = min over the tool's offset (x, y) of
// sum of w (d - s - x cos - y sin)^2 + (x^2 + y^2) / offset^2, over the parts that have samples.
#pragma once

#include <array>
#include <cstddef>
#include <span>
#include <vector>

#include "helibore/types.hpp"

namespace helibore {

inline constexpr std::size_t section_parts = 32, hole_kinds = 5;

// A section has section_parts lengths, metres: the radius less half the bit diameter, around toolfaces 0, 11.25, ...
struct SectionLibrary {
    std::span<const double> sections;        // section_parts for each, in the order of kinds
    std::array<Index, hole_kinds> counts{};  // of sections of each kind
    std::span<const double> size;            // of each section: a number whose mean is wanted
};

struct ChainRule {
    double stays, changes;                 // probability that the section stays the same, that it changes in its kind
    std::array<double, hole_kinds> prior;  // probability of each kind without a sample
    double rough, offset;                  // standard deviation of a part of the wall, of the tool's centre, metres
    double effective, temper;              // most parts of a window that count; power of its evidence
    std::array<std::array<double, 2>, 4> scales;  // the hole differs so many times `rough` from the library; its prior
};

// One row for each window.
struct LikelyAlong {
    std::vector<double> kinds;              // hole_kinds probabilities
    std::vector<double> size, size_square;  // mean of the size and of its square among the likely sections
};

// `windows`: section_parts for each window, NaN where no sample lies. The result does not depend on `threads`, and its
// probabilities err by less than 1e-4. Throws InputError if lengths differ, a number of the library is not finite, or
// there are no sections.
LikelyAlong likely_along(std::span<const double> windows, const SectionLibrary& library, const ChainRule& rule,
                         int threads = 1);

}  // namespace helibore
