// helibore._core: turn_columns, which returns the logs of turns as a dictionary of columns, and angular_gaps.
#include "helibore/logs.hpp"
#include "helibore/arms.hpp"
#include "helibore/kinds.hpp"
#include "helibore/passage.hpp"
#include "helibore/unworn.hpp"
#include "helibore/zones.hpp"

#include <pybind11/stl.h>

#include <algorithm>
#include <array>
#include <functional>
#include <optional>
#include <string>

#include "arrays.hpp"
#include "gil.hpp"
#include "register.hpp"

namespace helibore::bindings {

namespace {

py::dict turn_columns(const Column& radius, int sectors, double start_toolface, Index window, int threads, Index first,
                      double reference) {
    const Turns turns{.start_toolface = start_toolface,
                      .sectors = sectors,
                      .radius = span_of(radius),
                      .window = window,
                      .first = first,
                      .reference = reference};
    TurnLogs logs;
    {
        const WithoutGil released;
        logs = turn_logs(turns, threads);
    }
    py::dict columns;
    const auto add = [&](const char* name, std::vector<double>& column) {
        columns[name] = array_of(std::move(column));
    };
    add("coverage", logs.coverage);
    add("mean", logs.mean);
    add("mean_square", logs.mean_square);
    add("smallest", logs.smallest);
    add("largest", logs.largest);
    add("c1", logs.c1);
    add("c1_toolface", logs.c1_toolface);
    add("c2", logs.c2);
    add("least_diameter", logs.least_diameter);
    add("diameter_0", logs.diameter_0);
    add("diameter_90", logs.diameter_90);
    add("centre_0", logs.centre_0);
    add("centre_90", logs.centre_90);
    add("inscribed_diameter", logs.inscribed_diameter);
    add("inscribed_0", logs.inscribed_0);
    add("inscribed_90", logs.inscribed_90);
    add("enclosing_diameter", logs.enclosing_diameter);
    add("rugosity", logs.rugosity);
    return columns;
}

py::dict unworn_columns(const Column& radius, int sectors, double start_toolface, double bit_diameter,
                        const Column& counts, int threads) {
    const Turns turns{.start_toolface = start_toolface, .sectors = sectors, .radius = span_of(radius)};
    UnwornTurns found;
    {
        const WithoutGil released;
        found = unworn_turns(turns, bit_diameter, span_of(counts), threads);
    }
    py::dict columns;
    columns["unworn_diameter"] = array_of(std::move(found.diameter));
    columns["unworn_0"] = array_of(std::move(found.centre_0));
    columns["unworn_90"] = array_of(std::move(found.centre_90));
    for (std::size_t number = 0; number < found.lobes.size(); ++number) {
        const std::string lobe = "lobe" + std::to_string(number + 1) + "_";
        TurnLobes& of = found.lobes[number];
        columns[py::str(lobe + "toolface")] = array_of(std::move(of.toolface));
        columns[py::str(lobe + "width")] = array_of(std::move(of.width));
        columns[py::str(lobe + "height")] = array_of(std::move(of.height));
        columns[py::str(lobe + "pipe")] = array_of(std::move(of.pipe));
    }
    return columns;
}

py::dict passage_columns(const std::tuple<double, double, double, int, Index>& helix, const Column& radius,
                         const Path& path, const std::vector<std::tuple<double, double, double>>& bodies,
                         const Column& counts, const Column& sigma, int threads, Index only_turn) {
    const auto& [start_depth, start_toolface, pitch, sectors, first] = helix;
    std::vector<RigidBody> string;
    for (const auto& [start, stop, diameter] : bodies) string.push_back({start, stop, diameter});
    Passage found;
    {
        const WithoutGil released;
        found = passage({start_depth, start_toolface, pitch, sectors, first, span_of(radius)}, path, string,
                        span_of(counts), span_of(sigma), threads, only_turn);
    }
    const std::vector<py::ssize_t> contacts{std::ssize(found.clearance), most_contacts};
    py::dict columns;
    columns["clearance"] = array_of(std::move(found.clearance));
    columns["low"] = array_of(std::move(found.low));
    columns["high"] = array_of(std::move(found.high));
    columns["contact_depth"] = array_of(std::move(found.contact_depth), contacts);
    columns["contact_toolface"] = array_of(std::move(found.contact_toolface), contacts);
    columns["contact_body"] = array_of(std::move(found.contact_body), contacts);
    return columns;
}

py::array_t<double> angular_gaps(const std::tuple<double, double, double, Index, Index>& helix, Index count,
                                 const Column& depth, const Column& toolface, double reach, int threads) {
    const auto& [start_depth, start_toolface, pitch, sectors, first] = helix;
    std::vector<double> gaps;
    {
        const WithoutGil released;
        gaps = helibore::angular_gaps({start_depth, start_toolface, pitch, sectors, count, first},
                                      {span_of(depth), span_of(toolface)}, reach, threads);
    }
    return array_of(std::move(gaps));
}

py::array_t<std::uint8_t> measured(const std::tuple<double, double, double, Index, Index>& helix, Index count,
                                   const Column& depth, const Column& toolface, const Column& of_samples,
                                   const Column& of_vertices, const std::array<double, 5>& rule, int threads) {
    const auto& [start_depth, start_toolface, pitch, sectors, first] = helix;
    std::vector<std::uint8_t> found;
    {
        const WithoutGil released;
        found = helibore::measured({start_depth, start_toolface, pitch, sectors, count, first},
                                   {span_of(depth), span_of(toolface)}, {rule[0], rule[1], rule[2], rule[3], rule[4]},
                                   threads, {span_of(of_samples), span_of(of_vertices)});
    }
    return py::array_t<std::uint8_t>(static_cast<py::ssize_t>(found.size()), found.data());
}

// The library as Python keeps it: sections, counts, size, weight, chance.
using GivenLibrary = std::tuple<Column, std::array<Index, hole_kinds>, Column, Column, Column>;
SectionLibrary library_of(const GivenLibrary& given) {
    const auto& [sections, counts, size, weight, chance] = given;
    return {span_of(sections), counts, span_of(size), span_of(weight), span_of(chance)};
}

py::tuple section_library(double bit_diameter, const std::array<double, 5>& criteria, bool even) {
    const auto& [elongation, washout, key_seat, undergauge, symmetry] = criteria;
    DrawnSections drawn =
        helibore::section_library(bit_diameter, {elongation, washout, key_seat, undergauge, symmetry}, even);
    return py::make_tuple(array_of(std::move(drawn.sections)), drawn.counts, array_of(std::move(drawn.size)),
                          array_of(std::move(drawn.weight)), array_of(std::move(drawn.chance)));
}

py::tuple chained_kinds(const Column& sections, double height, const Column& wanted,
                        const std::function<SectionLibrary()>& library, int threads) {
    KindsAlong found;
    {
        const WithoutGil released;
        found = helibore::kinds_along(span_of(sections), height, span_of(wanted), library(), {}, threads);
    }
    return py::make_tuple(array_of(std::move(found.kinds)), array_of(std::move(found.seen)),
                          array_of(std::move(found.size)), array_of(std::move(found.size_sigma)));
}

py::tuple kinds_along(const Column& sections, double height, const Column& wanted, const GivenLibrary& library,
                      int threads) {
    return chained_kinds(sections, height, wanted, [&] { return library_of(library); }, threads);
}

py::tuple kinds_of_libraries(const SectionLibraries& libraries, const Column& sections, double height,
                             const Column& wanted, bool even, int threads) {
    return chained_kinds(sections, height, wanted, [&] { return libraries.of(even); }, threads);
}

SectionLibraries libraries_of(double bit_diameter, const std::array<double, 5>& criteria) {
    const auto& [elongation, washout, key_seat, undergauge, symmetry] = criteria;
    return {bit_diameter, {elongation, washout, key_seat, undergauge, symmetry}};
}

py::array_t<double> turn_sections(const std::tuple<double, double, double, Index, Index>& helix, Index count,
                                  const Column& depth, const Column& toolface, const Column& radius) {
    const auto& [start_depth, start_toolface, pitch, sectors, first] = helix;
    std::vector<double> found;
    {
        const WithoutGil released;
        found = helibore::turn_sections({start_depth, start_toolface, pitch, sectors, count, first},
                                        {span_of(depth), span_of(toolface)}, span_of(radius));
    }
    return array_of(std::move(found));
}

py::array_t<double> vertex_sections(const std::tuple<double, double, double, Index, Index>& helix,
                                    const Column& radius) {
    const auto& [start_depth, start_toolface, pitch, sectors, first] = helix;
    std::vector<double> found;
    {
        const WithoutGil released;
        found = helibore::turn_sections({start_depth, start_toolface, pitch, sectors, radius.size(), first},
                                        span_of(radius));
    }
    return array_of(std::move(found));
}

py::array_t<double> kept_radii(const std::tuple<double, double, double, Index, Index>& helix, const Column& wall,
                               const Column& depth, const Column& toolface, const Column& radius, double noise) {
    const auto& [start_depth, start_toolface, pitch, sectors, first] = helix;
    std::vector<double> found;
    {
        const WithoutGil released;
        found = helibore::kept_radii({start_depth, start_toolface, pitch, sectors, wall.size(), first}, span_of(wall),
                                     {span_of(depth), span_of(toolface)}, span_of(radius), noise);
    }
    return array_of(std::move(found));
}

py::array_t<double> sparse_turns(const Column& sections, double height) {
    return array_of(helibore::sparse_turns(span_of(sections), height));
}

// Depth, toolface, radius, arm and time of samples.
using Arms = std::tuple<Column, Column, Column, py::array_t<Index>, Column>;

ArmSamples samples_of(const Arms& arms) {
    const auto& [depth, toolface, radius, arm, time] = arms;
    return {span_of(depth),
            span_of(toolface),
            span_of(radius),
            {arm.data(), static_cast<std::size_t>(arm.size())},
            span_of(time)};
}

// Returns the columns of arm_diameters, those of arms as one array for each arm; None if there are no arms.
py::object arm_diameters(const Arms& arms, const Column& depth, double height, double reach) {
    ArmSamples samples = samples_of(arms);
    samples.reach = reach;
    ArmDiameters found;
    {
        const WithoutGil released;
        found = helibore::arm_diameters(samples, span_of(depth), height);
    }
    if (found.arms == 0) return py::none();
    py::dict columns;
    columns["diameter"] = array_of(std::move(found.diameter));
    columns["c1"] = array_of(std::move(found.c1));
    columns["c1_toolface"] = array_of(std::move(found.c1_toolface));
    columns["uneven"] = array_of(std::move(found.c1_uneven));
    columns["c2"] = array_of(std::move(found.c2));
    columns["least_diameter"] = array_of(std::move(found.least_diameter));
    return columns;
}

// A zone as Python reads it: kind, the numbers in the order of the struct, and both lobes.
py::tuple row_of(const Zone& zone) {
    const auto lobe = [](const ZoneLobe& of) { return py::make_tuple(of.toolface, of.opening, of.height); };
    return py::make_tuple(static_cast<int>(zone.kind), zone.start, zone.stop, zone.measure, zone.median, zone.severity,
                          zone.enlargement, zone.elongation, zone.peak, zone.coverage, zone.pipe_diameter,
                          zone.toolface, zone.deviation, zone.confidence, lobe(zone.lobes[0]), lobe(zone.lobes[1]));
}

py::tuple find_zones(const std::vector<Column>& columns, const Column& sections, const Column& uneven,
                     const std::tuple<Column, int, double, double>& vertices, double bit_diameter,
                     const std::array<double, 8>& criteria,
                     const std::optional<std::tuple<Column, py::array_t<Index>>>& chained,
                     const std::array<Column, 3>& samples, const std::optional<Arms>& arms, bool diameters,
                     const SectionLibraries& libraries, int threads) {
    const auto& [radius, sectors, start_toolface, pitch] = vertices;
    const auto of = [&](std::size_t i) { return span_of(columns.at(i)); };
    const MeasuredTurns turns{.depth = of(0),
                              .coverage = of(1),
                              .sampled = of(2),
                              .mean = of(3),
                              .c1 = of(4),
                              .c1_toolface = of(5),
                              .c2 = of(6),
                              .least_diameter = of(7),
                              .unworn_diameter = of(8),
                              .unworn_0 = of(9),
                              .unworn_90 = of(10),
                              .lobes{{{of(11), of(12), of(13)}, {of(14), of(15), of(16)}}},
                              .sections = span_of(sections),
                              .uneven = span_of(uneven),
                              .samples = {{span_of(samples[0]), span_of(samples[1])},
                                          span_of(samples[2]),
                                          arms ? samples_of(*arms) : ArmSamples{},
                                          diameters}};
    const auto& [elongation, washout, key_seat, undergauge, symmetry, opening_level, least_length, join] = criteria;
    ChainedTurns along;
    if (chained) {
        const auto& [kinds, seen] = *chained;
        along = {span_of(kinds), {seen.data(), static_cast<std::size_t>(seen.size())}};
    }
    Zones found;
    {
        const WithoutGil released;
        found = helibore::find_zones(
            turns, {span_of(radius), sectors, start_toolface, pitch}, bit_diameter,
            {elongation, washout, key_seat, undergauge, symmetry, opening_level, least_length, join}, along, libraries,
            threads);
    }
    py::list zones;
    for (const Zone& zone : found.zones) zones.append(row_of(zone));
    py::array_t<std::int8_t> kinds(static_cast<py::ssize_t>(found.kinds.size()));
    std::ranges::transform(found.kinds, kinds.mutable_data(),
                           [](HoleKind kind) { return static_cast<std::int8_t>(kind); });
    return py::make_tuple(kinds, zones);
}

py::tuple likely_kind(const Column& sections, const GivenLibrary& library) {
    LikelyKind found;
    {
        const WithoutGil released;
        found = helibore::likely_kind(span_of(sections), library_of(library));
    }
    return py::make_tuple(found.kinds, found.sound);
}

}  // namespace

void register_logs(py::module_& m) {
    m.def("turn_columns", &turn_columns, py::arg("radius"), py::arg("sectors"), py::arg("start_toolface"),
          py::arg("window"), py::arg("threads"), py::arg("first"), py::arg("reference"));
    m.def("unworn_columns", &unworn_columns, py::arg("radius"), py::arg("sectors"), py::arg("start_toolface"),
          py::arg("bit_diameter"), py::arg("counts"), py::arg("threads"));
    m.def("passage_columns", &passage_columns, py::arg("helix"), py::arg("radius"), py::arg("path"), py::arg("bodies"),
          py::arg("counts"), py::arg("sigma"), py::arg("threads"), py::arg("only_turn") = -1);
    m.def("angular_gaps", &angular_gaps, py::arg("helix"), py::arg("count"), py::arg("depth"), py::arg("toolface"),
          py::arg("reach"), py::arg("threads"));
    m.def("section_library", &section_library, py::arg("bit_diameter"), py::arg("criteria"), py::arg("even"));
    m.def("kinds_along", &kinds_along, py::arg("sections"), py::arg("height"), py::arg("wanted"), py::arg("library"),
          py::arg("threads"));
    py::class_<SectionLibraries>(m, "SectionLibraries")
        .def(py::init(&libraries_of), py::arg("bit_diameter"), py::arg("criteria"))
        .def("kinds_along", &kinds_of_libraries, py::arg("sections"), py::arg("height"), py::arg("wanted"),
             py::arg("even"), py::arg("threads"));
    m.def("turn_sections", &turn_sections, py::arg("helix"), py::arg("count"), py::arg("depth"), py::arg("toolface"),
          py::arg("radius"));
    m.def("vertex_sections", &vertex_sections, py::arg("helix"), py::arg("radius"));
    m.def("kept_radii", &kept_radii, py::arg("helix"), py::arg("wall"), py::arg("depth"), py::arg("toolface"),
          py::arg("radius"), py::arg("noise"));
    m.def("sparse_turns", &sparse_turns, py::arg("sections"), py::arg("height"));
    m.def("arm_diameters", &arm_diameters, py::arg("samples"), py::arg("depth"), py::arg("height"), py::arg("reach"));
    m.def("find_zones", &find_zones, py::arg("columns"), py::arg("sections"), py::arg("uneven"), py::arg("vertices"),
          py::arg("bit_diameter"), py::arg("criteria"), py::arg("chained"), py::arg("samples"), py::arg("arms"),
          py::arg("diameters"), py::arg("libraries"), py::arg("threads"));
    m.def("likely_kind", &likely_kind, py::arg("sections"), py::arg("library"));
    m.def("measured", &measured, py::arg("helix"), py::arg("count"), py::arg("depth"), py::arg("toolface"),
          py::arg("of_samples"), py::arg("of_vertices"), py::arg("rule"), py::arg("threads"));
}

}  // namespace helibore::bindings
