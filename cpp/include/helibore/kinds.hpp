// The kind of hole along a well whose tool has few samples a turn: sections are compared with those of a library, and a
// chain carries the section along the hole, and the place of the tool's centre.
//
//     window 0      window 1      window 2         each window of turns sees some parts of the section
//      .---.         .---.         .---.
//      |      \      |     |     |     |     -->   stays (likely), changes within its kind, or becomes any section
//           --'       ---         ---'
//
// chi^2 of a window's section d and a section s = min over the tool's offset (x, y) of
// sum of w (d - s - x cos - y sin)^2 + (x^2 + y^2) / offset^2, over the parts that have samples. Along the hole the
// last term is that of the offset from where the windows before had it: few samples show the offset only together.
#pragma once

#include <array>
#include <cstddef>
#include <memory>
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
    std::span<const double> weight;          // how many sections each stands for, above 0; empty: 1
    std::span<const double> chance{};        // how likely one is along a hole beside others of its kind; empty: 1
};

// Limits by which a section is of a kind, as a turn is: metres, but for `symmetry`, a share.
struct KindCriteria {
    double elongation, washout, key_seat, undergauge, symmetry;
};

struct DrawnSections {
    std::vector<double> sections, size, weight, chance;  // size: mean squared radius, m2
    std::array<Index, hole_kinds> counts{};

    SectionLibrary library() const { return {sections, counts, size, weight, chance}; }
};

// Draws round, oval and lobed sections of many sizes, widths and directions, and slots of pipes, for a bit. Kinds:
// gauge, washout, breakout, key seat, undergauge. `even`: as a tool sees them that measures diameters, to which no
// section is a key seat. A section that equals itself turned by 180 degrees is there once for both. Chances: a gauge
// hole is lobed in one of fifteen cases, though most gauge sections are.
// Throws InputError if the bit has no size.
DrawnSections section_library(double bit_diameter, const KindCriteria& criteria, bool even);

// The libraries of a bit, each drawn when it is first asked for, and kept. Copies share them; any thread may ask.
class SectionLibraries {
  public:
    SectionLibraries(double bit_diameter, const KindCriteria& criteria);
    SectionLibrary of(bool even) const;  // valid as long as this object or a copy lives; throws as section_library

  private:
    struct Kept;
    std::shared_ptr<Kept> kept_;
};

struct LikenessRule {
    double rough = 1.6e-3, offset = 7e-3;  // standard deviation of a part of the wall, of the tool's centre, metres
    double effective = 24.0;               // most parts of a section that count as independent
    // The hole differs so many times `rough` from the library; the prior of this factor.
    std::array<std::array<double, 2>, 4> scales{{{1.0, 0.5}, {1.6, 0.3}, {2.6, 0.15}, {4.2, 0.05}}};
};

struct ChainRule {
    double stays = 0.8, changes = 0.1;  // probability that the section is the same a metre on; if not, that its kind is
    double centre_stays = 20.0;         // metres over which the offset falls to 1 / e, if nothing else shows it
    double temper = 0.7;                // power of a window's evidence, since windows differ from the library alike
    std::array<double, hole_kinds> prior{0.68, 0.1, 0.1, 0.06, 0.06};  // of each kind, without a sample
    LikenessRule likeness{};
};

// One row for each window.
struct LikelyAlong {
    std::vector<double> kinds;  // hole_kinds probabilities
    // Mean of the size and of its square among the likely sections. Chances do not count: where a lobe ends it is
    // small.
    std::vector<double> size, size_square;
};

// `windows`: section_parts for each window, NaN where no sample lies; `length`: of a window, metres. The result does
// not depend on `threads`, and its probabilities err by less than 1e-4. Throws InputError if lengths differ, a number
// of the library is not finite, or there are no sections.
LikelyAlong likely_along(std::span<const double> windows, double length, const SectionLibrary& library,
                         const ChainRule& rule = {}, int threads = 1);

// One row for each turn.
struct KindsAlong {
    std::vector<double> kinds;             // hole_kinds probabilities
    std::vector<double> size, size_sigma;  // mean and standard deviation of the size among the likely sections; NaN
                                           // where the mean radius is beyond all radii of the library
    std::vector<Index> seen;               // parts that samples see, or beside these, in the turn's window; at most
                                           // the mean of five windows
};

// Takes turns together in windows of 0.1 m, or up to 0.5 m where these see few parts, and chains the windows.
// `sections`: section_parts for each turn; `height`: of a turn, metres. Turns whose `wanted` is 0 have NaN, unless one
// in their window is wanted; windows up to 20 away decide as well. Throws InputError as likely_along does.
KindsAlong kinds_along(std::span<const double> sections, double height, std::span<const double> wanted,
                       const SectionLibrary& library, const ChainRule& rule = {}, int threads = 1);

struct ZoneRule {
    // The hole may be gauge if a gauge section lies within so many times `rough`, rms.
    double explained = 2.6;
    // No kind is sound if all sections differ by more than this share of the zone's own rms, and not in small.
    double resembles = 0.35;
    std::array<double, hole_kinds> prior{0.4, 0.15, 0.15, 0.15, 0.15};  // where turns meet a criterion; above 0
    LikenessRule likeness{};
};

struct LikelyKind {
    std::array<double, hole_kinds> kinds{};  // probabilities
    bool sound = false;                      // whether a section of the library resembles the zone
};

// The kind of a zone, from one or more sections of its turns; NaN where no sample lies. Throws InputError as
// likely_along does, and if there is no section.
LikelyKind likely_kind(std::span<const double> sections, const SectionLibrary& library, const ZoneRule& rule = {});

}  // namespace helibore
