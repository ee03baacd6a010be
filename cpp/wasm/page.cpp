// What the page needs and the C interface lacks. Each function returns 0, or 1 for an error; its arrays belong to the
// page.
#include <algorithm>
#include <limits>
#include <span>

#include "c/handles.hpp"
#include "helibore/compression.hpp"
#include "helibore/error.hpp"
#include "helibore/estimates.hpp"
#include "helibore/logs.hpp"
#include "helibore/surface.hpp"
#include "helibore/zones.hpp"
#include "measure/zone_columns.hpp"

namespace {

using helibore::Index;

template <class Work>
int guarded(Work&& work) {
    try {
        work();
        return 0;
    } catch (const helibore::InputError&) {
        return 1;
    }
}

}  // namespace

#define PAGE_API extern "C" __attribute__((visibility("default")))

// Marks the measured vertices (logs.hpp). helix: start depth, start toolface, pitch. rule: the members of MeasuredRule.
// depth, toolface, radius: of n samples, in order of depth. wall, marks: radius and mark of each vertex.
PAGE_API int page_measured(const double* helix, int sectors, int count, const double* rule, int n, const double* depth,
                           const double* toolface, const double* radius, const double* wall, std::uint8_t* marks) {
    return guarded([&] {
        const auto samples = static_cast<std::size_t>(n), vertices = static_cast<std::size_t>(count);
        const auto found = helibore::measured(
            {helix[0], helix[1], helix[2], sectors, count, 0}, {{depth, samples}, {toolface, samples}},
            {rule[0], rule[1], rule[2], rule[3], rule[4]}, 1, {{radius, samples}, {wall, vertices}});
        std::ranges::copy(found, marks);
    });
}

// Measures the full turns of `count` radii, column after column, as hb_wall_logs does.
PAGE_API int page_logs(double start_toolface, int sectors, int count, const double* radius, int window,
                       double* values) {
    return guarded([&] {
        const helibore::TurnLogs logs =
            helibore::turn_logs({start_toolface, sectors, {radius, static_cast<std::size_t>(count)}, Index{window}});
        for (const auto* column : {&logs.coverage, &logs.mean, &logs.mean_square, &logs.smallest, &logs.largest,
                                   &logs.c1, &logs.c1_toolface, &logs.c2, &logs.least_diameter, &logs.diameter_0,
                                   &logs.diameter_90, &logs.centre_0, &logs.centre_90, &logs.inscribed_diameter,
                                   &logs.inscribed_0, &logs.inscribed_90, &logs.enclosing_diameter, &logs.rugosity})
            values = std::ranges::copy(*column, values).out;
    });
}

// Measures the turns of a wall and finds its zones (zones.hpp). helix, sectors, count, rule, n, depth, toolface, radius
// and wall: as of page_measured. arm_*: m samples with the number of the arm of each; arm_time may be null; m = 0: the
// arms are not known. Of each full turn: kinds, and column after column C1, its toolface, C2, least diameter and
// unevenness of the arms, unworn diameter, height of the highest lobe, the mean squared radius that is likely where
// samples are few, and its standard deviation; NaN where there is none. Then the diameters of each arm, of at most
// eight. zones: 20 columns, with room for as many rows as there are turns. found: how many arms and zones there are.
PAGE_API int page_zones(const double* helix, int sectors, int count, const double* rule, int n, const double* depth,
                        const double* toolface, const double* radius, const double* wall, double bit, int m,
                        const double* arm_depth, const double* arm_toolface, const double* arm_radius,
                        const std::int64_t* arm, const double* arm_time, double reach, std::int32_t* kinds,
                        double* columns, double* zones, std::int32_t* found) {
    return guarded([&] {
        const auto samples = static_cast<std::size_t>(n), of_arms = static_cast<std::size_t>(m);
        const helibore::ArmSamples arms{{arm_depth, of_arms},
                                        {arm_toolface, of_arms},
                                        {arm_radius, of_arms},
                                        {arm, of_arms},
                                        {arm_time, arm_time == nullptr ? 0 : of_arms},
                                        reach};
        const helibore::WallZones all = helibore::wall_zones(
            {helix[0], helix[1], helix[2], sectors, count, 0}, {wall, static_cast<std::size_t>(count)},
            {{{depth, samples}, {toolface, samples}}, {radius, samples}, arms}, bit, {},
            {rule[0], rule[1], rule[2], rule[3], rule[4]});
        std::ranges::transform(all.kinds, kinds, [](auto kind) { return static_cast<std::int32_t>(kind); });
        const std::size_t turns = all.kinds.size();
        const auto add = [&](const std::vector<double>& column, auto holds) {
            for (std::size_t turn = 0; turn < turns; ++turn)
                *columns++ = !column.empty() && holds(turn) ? column[turn] : std::numeric_limits<double>::quiet_NaN();
        };
        for (const auto* column : {&all.arms.c1, &all.arms.c1_toolface, &all.arms.c2, &all.arms.least_diameter,
                                   &all.arms.c1_uneven, &all.unworn.diameter, &all.unworn.lobes[0].height})
            add(*column, [](std::size_t) { return true; });
        for (const auto* column : {&all.along.size, &all.along.size_sigma})
            add(*column, [&](std::size_t turn) { return all.sparse[turn] == 1.0; });
        std::ranges::copy(all.arms.diameter, columns);
        helibore::fill_zones(all.zones, zones);
        found[0] = static_cast<std::int32_t>(all.arms.arms), found[1] = static_cast<std::int32_t>(all.zones.size());
    });
}

// Calibrates the uncertainty of a wall by `count` samples that are left out, with boxes around them (estimates.hpp).
// values: the seven numbers of a Calibration; NaN if no sample could be estimated.
PAGE_API int page_calibrate(std::int64_t wall, int count, const std::int64_t* rows, const double* box_depth,
                            const double* box_turn, double* values) {
    return guarded([&] {
        const auto handle = helibore::c::find<helibore::c::WallHandle>("wall", wall);
        const auto samples = handle->read->samples();
        const auto size = static_cast<std::size_t>(count);
        const auto found =
            helibore::calibrate({samples[0], samples[1], samples[2]},
                                {{rows, size}, {box_depth, size}, {box_turn, size}}, handle->read->settings());
        const double none = std::numeric_limits<double>::quiet_NaN();
        const auto of = found.value_or(helibore::Calibration{none, none, none, none, none, none, none});
        std::ranges::copy(std::initializer_list{of.noise, of.between, of.scatter_power, of.distance_power, of.stretch,
                                                of.quantile, of.reach},
                          values);
    });
}

// Places `count` radii, of the vertices from `first` on, along a path (its handle; 0: straight down) and joins them
// (surface.hpp). positions: three numbers for each vertex that has a radius; places: its number on the helix; quads:
// the rows of four corners. All have room for `count` rows. found: how many vertices and quads there are.
PAGE_API int page_surface(const double* helix, int sectors, int first, int count, const double* radius,
                          std::int64_t path, double* positions, std::int32_t* places, std::int32_t* quads,
                          std::int32_t* found) {
    return guarded([&] {
        const helibore::Path along =
            path == 0 ? helibore::Path() : helibore::c::find<helibore::c::PathHandle>("path", path)->path;
        const helibore::Surface surface = helibore::surface_of(
            {helix[0], helix[1], helix[2], sectors, first, {radius, static_cast<std::size_t>(count)}}, along);
        for (const auto& vertex : surface.vertices) positions = std::ranges::copy(vertex, positions).out;
        const auto whole = [](helibore::Index of) { return static_cast<std::int32_t>(of); };
        std::ranges::transform(surface.vertex_index, places, whole);
        for (const auto& quad : surface.quads) quads = std::ranges::transform(quad, quads, whole).out;
        found[0] = whole(std::ssize(surface.vertices)), found[1] = whole(std::ssize(surface.quads));
    });
}

// Unpacks `count` words of an archive (compression.hpp).
PAGE_API int page_decompress(int size, const std::uint8_t* bytes, int count, std::uint64_t* words) {
    return guarded([&] {
        helibore::decompress({bytes, static_cast<std::size_t>(size)}, {words, static_cast<std::size_t>(count)});
    });
}
