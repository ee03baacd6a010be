// The chain of sections along a hole: probabilities, threads, and what is refused.
#include <cmath>
#include <limits>
#include <vector>

#include "check.hpp"
#include "helibore/error.hpp"
#include "helibore/kinds.hpp"

using namespace helibore;

namespace {

const ChainRule rule{.stays = 0.9,
                     .changes = 0.01,
                     .prior = {0.6, 0.1, 0.1, 0.1, 0.1},
                     .rough = 1.6e-3,
                     .offset = 7e-3,
                     .effective = 24.0,
                     .temper = 0.7,
                     .scales = {{{1.0, 0.5}, {1.6, 0.3}, {2.6, 0.15}, {4.2, 0.05}}}};

// A gauge section and a round one that is 20 mm wider.
struct Two {
    std::vector<double> sections = std::vector<double>(2 * section_parts), size{0.0, 0.02};
    Two() { std::fill(sections.begin() + section_parts, sections.end(), 0.02); }
    SectionLibrary library() const { return {sections, {1, 1, 0, 0, 0}, size}; }
};

void finds_the_wide_hole() {
    const Two two;
    std::vector<double> windows(100 * section_parts, std::numeric_limits<double>::quiet_NaN());
    for (std::size_t row = 0; row < 100; ++row) windows[row * section_parts + row % 7] = row < 50 ? 0.0 : 0.02;
    const LikelyAlong one = likely_along(windows, two.library(), rule),
                      three = likely_along(windows, two.library(), rule, 3);
    for (std::size_t row = 0; row < 100; ++row) {
        double all = 0.0;
        for (std::size_t kind = 0; kind < hole_kinds; ++kind) {
            all += one.kinds[row * hole_kinds + kind];
            CHECK(one.kinds[row * hole_kinds + kind] == three.kinds[row * hole_kinds + kind]);
        }
        CHECK(std::abs(all - 1.0) < 1e-12);
        CHECK(std::abs(one.size[row] - 0.02 * one.kinds[row * hole_kinds + 1]) < 1e-8);
    }
    CHECK(one.kinds[25 * hole_kinds] > 0.99 && one.kinds[75 * hole_kinds + 1] > 0.99);
}

void extremes() {
    const Two two;
    std::vector<double> windows(2 * section_parts, 1e300);
    windows[0] = -1e300;
    const LikelyAlong found = likely_along(windows, two.library(), rule);
    CHECK(std::isfinite(found.size[0]) && std::isfinite(found.kinds[1]));
    CHECK(likely_along({}, two.library(), rule).size.empty());
}

void refused() {
    const Two two;
    const std::vector<double> part(section_parts - 1);
    CHECK_THROWS(InputError, "windows = 31: must be 32 lengths for each window",
                 likely_along(part, two.library(), rule));
    SectionLibrary none = two.library();
    none.counts = {};
    CHECK_THROWS(InputError, "counts = 0: must be 1 or more in all", likely_along({}, none, rule));
    none.counts = {-1, 3, 0, 0, 0};
    CHECK_THROWS(InputError, "counts[0] = -1: must be 0 or more", likely_along({}, none, rule));
    ChainRule sure = rule;
    sure.stays = 1.0;
    CHECK_THROWS(InputError, "stays + changes = 1.01: must be probabilities whose sum is below 1",
                 likely_along({}, two.library(), sure));
}

}  // namespace

int main() {
    finds_the_wide_hole();
    extremes();
    refused();
    return 0;
}
