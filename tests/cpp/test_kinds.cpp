// The chain of sections along a hole: probabilities, threads, and what is refused.
#include <cmath>
#include <limits>
#include <vector>

#include "base/exponential.hpp"
#include "check.hpp"
#include "helibore/error.hpp"
#include "helibore/kinds.hpp"

using namespace helibore;

namespace {

const ChainRule rule{.stays = 0.9, .changes = 0.1, .prior = {0.6, 0.1, 0.1, 0.1, 0.1}};

// A gauge section and a round one that is 20 mm wider.
struct Two {
    std::vector<double> sections = std::vector<double>(2 * section_parts), size{0.0, 0.02};
    Two() { std::fill(sections.begin() + section_parts, sections.end(), 0.02); }
    SectionLibrary library() const { return {sections, {1, 1, 0, 0, 0}, size, {}}; }
};

void finds_the_wide_hole() {
    const Two two;
    std::vector<double> windows(100 * section_parts, std::numeric_limits<double>::quiet_NaN());
    for (std::size_t row = 0; row < 100; ++row) windows[row * section_parts + row % 7] = row < 50 ? 0.0 : 0.02;
    const LikelyAlong one = likely_along(windows, 1.0, two.library(), rule),
                      three = likely_along(windows, 1.0, two.library(), rule, 3);
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
    const LikelyAlong found = likely_along(windows, 1.0, two.library(), rule);
    CHECK(std::isfinite(found.size[0]) && std::isfinite(found.kinds[1]));
    CHECK(likely_along({}, 1.0, two.library(), rule).size.empty());
}

void refused() {
    const Two two;
    const std::vector<double> part(section_parts - 1);
    CHECK_THROWS(InputError, "windows = 31: must be 32 lengths for each window",
                 likely_along(part, 1.0, two.library(), rule));
    SectionLibrary none = two.library();
    none.counts = {};
    CHECK_THROWS(InputError, "counts = 0: must be 1 or more in all", likely_along({}, 1.0, none, rule));
    none.counts = {-1, 3, 0, 0, 0};
    CHECK_THROWS(InputError, "counts[0] = -1: must be 0 or more", likely_along({}, 1.0, none, rule));
    ChainRule sure = rule;
    sure.stays = 1.0;
    CHECK_THROWS(InputError, "stays = 1: must lie between 0 and 1", likely_along({}, 1.0, two.library(), sure));
    sure = rule;
    sure.centre_stays = 0.0;
    CHECK_THROWS(InputError, "centre_stays = 0: must be above 0", likely_along({}, 1.0, two.library(), sure));
    CHECK_THROWS(InputError, "length = 0: must be finite and above 0", likely_along({}, 0.0, two.library()));
    CHECK_THROWS(InputError, "height = 0: must be finite and above 0", kinds_along({}, 0.0, {}, two.library()));
    CHECK_THROWS(InputError, "sections has 31 values, 32 times wanted has 32: must be equal",
                 kinds_along(part, 0.1, std::vector<double>(1), two.library()));
    const std::vector<double> weight{1.0, 0.0};
    SectionLibrary weighed = two.library();
    weighed.weight = weight;
    CHECK_THROWS(InputError, "weight[1] = 0: must be finite and above 0", likely_along({}, 1.0, weighed, rule));
    weighed.weight = {}, weighed.chance = weight;
    CHECK_THROWS(InputError, "chance[1] = 0: must be finite and above 0", likely_along({}, 1.0, weighed, rule));
    CHECK_THROWS(InputError, "sections = 0: must be 32 lengths for each of one or more sections",
                 likely_kind({}, two.library()));
    CHECK_THROWS(InputError, "bit_diameter = 0: must be finite and above 0", section_library(0.0, {}, false));
}

// A section that stands for two is as good as that section twice.
void a_weight_is_a_number_of_sections() {
    const Two two;
    std::vector<double> thrice = two.sections, size{0.0, 0.02, 0.02};
    thrice.insert(thrice.end(), two.sections.begin() + section_parts, two.sections.end());
    thrice.insert(thrice.end(), section_parts, 0.01);
    size.push_back(0.01);
    std::vector<double> twice = two.sections;
    twice.insert(twice.end(), section_parts, 0.01);
    const std::vector<double> twice_size{0.0, 0.02, 0.01}, weight{1.0, 2.0, 1.0};
    const SectionLibrary a{thrice, {1, 3, 0, 0, 0}, size, {}}, b{twice, {1, 2, 0, 0, 0}, twice_size, weight};
    std::vector<double> windows(20 * section_parts, std::numeric_limits<double>::quiet_NaN());
    for (std::size_t row = 0; row < 20; ++row) windows[row * section_parts + row % 7] = 0.012;
    const LikelyAlong all = likely_along(windows, 1.0, a, rule), few = likely_along(windows, 1.0, b, rule);
    for (std::size_t row = 0; row < 20; ++row) {
        CHECK(std::abs(all.kinds[row * hole_kinds] - few.kinds[row * hole_kinds]) < 1e-6);
        CHECK(std::abs(all.size[row] - few.size[row]) < 1e-6);
    }
    const LikelyKind of_all = likely_kind(windows, a), of_few = likely_kind(windows, b);
    for (std::size_t kind = 0; kind < hole_kinds; ++kind)
        CHECK(std::abs(of_all.kinds[kind] - of_few.kinds[kind]) < 1e-12);
    CHECK(of_all.sound == of_few.sound);
}

// Turns of 0.1 m that see every part are windows of their own; what is far from a wanted turn is not compared.
void only_wanted_turns_have_kinds() {
    const Two two;
    constexpr std::size_t turns = 1000;
    std::vector<double> sections(turns * section_parts, 0.02), wanted(turns, 0.0);
    wanted[0] = wanted[500] = wanted[999] = 1.0;
    const KindsAlong found = kinds_along(sections, 0.1, wanted, two.library(), rule, 2);
    for (std::size_t turn = 0; turn < turns; ++turn) {
        CHECK(found.seen[turn] == 32);
        CHECK(std::isnan(found.size[turn]) == (wanted[turn] == 0.0));
        CHECK(wanted[turn] == 0.0 || std::abs(found.size[turn] - 0.02) < 1e-6);
        CHECK(wanted[turn] == 0.0 || found.kinds[turn * hole_kinds + 1] > 0.99);
    }
    CHECK(kinds_along({}, 0.1, {}, two.library()).seen.empty());
    for (double& of : sections) of = 0.05;  // wider than both sections
    const KindsAlong beyond = kinds_along(sections, 0.1, wanted, two.library(), rule, 2);
    CHECK(std::isnan(beyond.size[500]) && std::isnan(beyond.size_sigma[500]));
    CHECK(beyond.kinds[500 * hole_kinds + 1] > 0.99);
}

void exponentials() {
    for (double x = -690.0; x < 690.0; x += 0.37) {
        CHECK(std::abs(exponential(x) / std::exp(x) - 1.0) < 4e-16);
        CHECK(std::abs(logarithm(std::exp(x)) - std::log(std::exp(x))) <= 2e-16 * std::abs(x));
    }
    CHECK(exponential(0.0) == 1.0 && logarithm(1.0) == 0.0);
    CHECK(exponential(-std::numeric_limits<double>::infinity()) == 0.0);
}

}  // namespace

int main() {
    finds_the_wide_hole();
    extremes();
    refused();
    a_weight_is_a_number_of_sections();
    only_wanted_turns_have_kinds();
    exponentials();
    return failures();
}
