// Zones by hand: sections of turns, kinds, runs and gaps, numbers of threads, and what is refused. Python's tests
// compare walls of tools with a slow reference.
#include "helibore/zones.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "check.hpp"
#include "helibore/error.hpp"

using namespace helibore;

namespace {

constexpr double bit = 0.2, nan = std::numeric_limits<double>::quiet_NaN();
constexpr int sectors = 32;
constexpr std::size_t K = sectors;

// Turns of 0.1 m, each round about the axis, with a given radius; all of it is measured.
struct RoundTurns {
    std::vector<double> radius, depth, size, mean, zero, one, missing, sections, uneven;

    explicit RoundTurns(const std::vector<double>& radii) {
        for (std::size_t turn = 0; turn < radii.size(); ++turn) {
            radius.insert(radius.end(), K, radii[turn]);
            sections.insert(sections.end(), section_parts, radii[turn]);
            depth.push_back(100.05 + 0.1 * static_cast<double>(turn));
            size.push_back(2.0 * radii[turn]);
        }
        mean = size, zero.assign(radii.size(), 0.0), one.assign(radii.size(), 1.0), missing.assign(radii.size(), nan);
    }
    MeasuredTurns turns() const {
        const MeasuredTurns::Lobe none{missing, missing, missing};
        return {depth, one, one, mean, size, zero, size, size, size, zero, zero, {{none, none}}, sections, uneven, {}};
    }
    TurnVertices vertices() const { return {radius, sectors, 0.0, 0.1}; }
};

Zones zones_of(const RoundTurns& of, const ZoneCriteria& criteria = {}, int threads = 1) {
    return find_zones(of.turns(), of.vertices(), bit, criteria, {}, {bit, criteria.limits()}, threads);
}

void finds_a_washout_with_its_gap_and_a_tight_hole() {
    std::vector<double> radii(10, 0.1);
    radii.insert(radii.end(), {0.12, 0.12, 0.125, 0.1, 0.12});  // a washout with a gap
    radii.insert(radii.end(), 20, 0.1);
    radii.insert(radii.end(), 5, 0.095);
    radii.insert(radii.end(), {0.1, nan, 0.12, 0.12});  // too short
    const RoundTurns of(radii);
    const Zones found = zones_of(of), on_three = zones_of(of, {}, 3);
    CHECK(found.kinds == on_three.kinds && found.zones.size() == 2 && on_three.zones.size() == 2);
    if (found.zones.size() != 2) return;
    const Zone &washout = found.zones[0], &tight = found.zones[1];
    CHECK(washout.kind == HoleKind::washout && tight.kind == HoleKind::undergauge);
    CHECK(std::abs(washout.start - 101.0) < 1e-9 && std::abs(washout.stop - 101.5) < 1e-9);
    CHECK(washout.measure == 2 * 0.125 - bit && washout.median == 2 * 0.12 - bit && washout.peak == of.depth[12]);
    CHECK(washout.severity == washout.measure / 0.0127 && washout.coverage == 1.0 && washout.confidence > 0.5);
    CHECK(std::isnan(washout.toolface) && std::isnan(washout.lobes[0].height) && std::isnan(washout.pipe_diameter));
    CHECK(tight.enlargement == 2 * 0.095 - bit && tight.measure == tight.enlargement);
    CHECK(on_three.zones[0].confidence == washout.confidence);
    CHECK(found.kinds[9] == HoleKind::gauge && found.kinds[10] == HoleKind::washout);
    CHECK(found.kinds[13] == HoleKind::gauge);  // the gap
    CHECK(found.kinds[41] == HoleKind::none && found.kinds[42] == HoleKind::gauge);
    ZoneCriteria apart;
    apart.join = 0.05, apart.least_length = 0.1;
    CHECK(zones_of(of, apart).zones.size() == 4);
    apart.washout = 0.0;
    const Zones whole = zones_of(RoundTurns(std::vector<double>(9, 0.12)), apart);
    CHECK(whole.zones.size() == 1 && std::isinf(whole.zones[0].severity));
}

void sections_of_samples_and_vertices() {
    const HelixVertices helix{.start_depth = 10.0, .pitch = -0.5, .sectors = 8, .count = 20};  // two turns, upwards
    const double depth[] = {9.1, 9.2, 9.6, 9.9, 9.9, 10.1, 8.9}, toolface[] = {0, 359, 11.25, 180, 180, 0, 0},
                 radius[] = {1, 3, 5, 7, nan, 9, 9};
    const std::vector<double> found = turn_sections(helix, {depth, toolface}, radius);
    CHECK(found.size() == 2 * section_parts);
    CHECK(found[section_parts] == 2.0 && found[1] == 5.0 && found[16] == 7.0);
    CHECK(std::ranges::count_if(found, [](double of) { return !std::isnan(of); }) == 3);
    std::vector<double> of_vertices(20, 2.0);
    of_vertices[9] = nan;
    const std::vector<double> whole = turn_sections(helix, of_vertices);
    CHECK(whole[0] == 2.0 && std::isnan(whole[1]) && whole[4] == 2.0 && std::isnan(whole[section_parts + 4]));
    CHECK(turn_sections({}, {}, {}).empty());

    std::vector<double> sections(10 * section_parts, 0.1);
    for (const std::size_t turn : {1U, 5U, 6U, 7U})
        std::fill_n(sections.begin() + static_cast<std::ptrdiff_t>(turn * section_parts), 17, nan);
    CHECK(sparse_turns(sections, 0.1) == std::vector<double>({0, 0, 0, 0, 0, 1, 1, 1, 0, 0}));
    CHECK(sparse_turns(std::span(sections).subspan(section_parts, section_parts), 0.1) == std::vector<double>{1});
    CHECK(sparse_turns({}, 0.1).empty());
}

void libraries_are_shared() {
    const KindCriteria limits = ZoneCriteria{}.limits();
    const SectionLibraries one(bit, limits), other = one;
    CHECK(one.of(true).sections.data() == other.of(true).sections.data());
    CHECK(one.of(false).counts == section_library(bit, limits, false).counts);
    CHECK_THROWS(InputError, "bit_diameter = 0: must be finite and above 0", SectionLibraries(0.0, limits).of(false));
}

void refused() {
    RoundTurns of(std::vector<double>(5, 0.1));
    ZoneCriteria criteria;
    criteria.washout = -1.0;
    CHECK_THROWS(InputError, "washout = -1: must be finite and not negative", zones_of(of, criteria));
    criteria = {}, criteria.opening_level = 1.0;
    CHECK_THROWS(InputError, "opening_level = 1: must be in (0, 1)", zones_of(of, criteria));
    of.mean.pop_back();
    CHECK_THROWS(InputError, "mean has 4 values, depth has 5: must be equal", zones_of(of));
    of.mean.push_back(0.1), of.radius.pop_back();
    CHECK_THROWS(InputError, "turns = 5: must be at most the 4 turns of the radii", zones_of(of));
    of.radius.push_back(0.1), of.sections.pop_back();
    CHECK_THROWS(InputError, "sections has 159 values, 32 times depth has 160: must be equal", zones_of(of));
    CHECK_THROWS(InputError, "height = 0: must be finite and above 0", sparse_turns({}, 0.0));
    CHECK_THROWS(InputError, "sections = 31: must be 32 lengths for each turn",
                 sparse_turns(std::vector<double>(31), 0.1));
    const double depth[] = {1.0};
    CHECK_THROWS(InputError, "toolface has 0 values, depth has 1: must be equal",
                 turn_sections({.count = 64}, {depth, {}}, depth));
    CHECK_THROWS(InputError, "radius has 1 values, count has 64: must be equal", turn_sections({.count = 64}, depth));
    CHECK_THROWS(InputError, "pitch = nan: must be finite and not 0", turn_sections({.pitch = nan, .count = 1}, depth));
    CHECK_THROWS(InputError, "sectors = 2: must be 3 or more", wall_zones({.sectors = 2, .count = 1}, depth, {}, bit));
}

}  // namespace

int main() {
    finds_a_washout_with_its_gap_and_a_tight_hole();
    sections_of_samples_and_vertices();
    libraries_are_shared();
    refused();
    return failures();
}
