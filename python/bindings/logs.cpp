// helibore._core: turn_columns, which returns the logs of turns as a dictionary of columns, and angular_gaps.
#include "helibore/logs.hpp"
#include "helibore/kinds.hpp"
#include "helibore/passage.hpp"
#include "helibore/unworn.hpp"

#include <pybind11/stl.h>

#include <algorithm>
#include <array>
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
        const py::gil_scoped_release released;
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
                         const Column& counts, const Column& sigma, int threads) {
    const auto& [start_depth, start_toolface, pitch, sectors, first] = helix;
    std::vector<RigidBody> string;
    for (const auto& [start, stop, diameter] : bodies) string.push_back({start, stop, diameter});
    Passage found;
    {
        const py::gil_scoped_release released;
        found = passage({start_depth, start_toolface, pitch, sectors, first, span_of(radius)}, path, string,
                        span_of(counts), span_of(sigma), threads);
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

// The library as Python keeps it: sections, counts, size, weight.
using GivenLibrary = std::tuple<Column, std::array<Index, hole_kinds>, Column, Column>;
SectionLibrary library_of(const GivenLibrary& given) {
    const auto& [sections, counts, size, weight] = given;
    return {span_of(sections), counts, span_of(size), span_of(weight)};
}

py::tuple section_library(double bit_diameter, const std::array<double, 5>& criteria, bool even) {
    const auto& [elongation, washout, key_seat, undergauge, symmetry] = criteria;
    DrawnSections drawn =
        helibore::section_library(bit_diameter, {elongation, washout, key_seat, undergauge, symmetry}, even);
    return py::make_tuple(array_of(std::move(drawn.sections)), drawn.counts, array_of(std::move(drawn.size)),
                          array_of(std::move(drawn.weight)));
}

py::tuple kinds_along(const Column& sections, double height, const Column& wanted, const GivenLibrary& library,
                      int threads) {
    KindsAlong found;
    {
        const WithoutGil released;
        found = helibore::kinds_along(span_of(sections), height, span_of(wanted), library_of(library), {}, threads);
    }
    return py::make_tuple(array_of(std::move(found.kinds)), array_of(std::move(found.seen)),
                          array_of(std::move(found.size)), array_of(std::move(found.size_sigma)));
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
          py::arg("counts"), py::arg("sigma"), py::arg("threads"));
    m.def("angular_gaps", &angular_gaps, py::arg("helix"), py::arg("count"), py::arg("depth"), py::arg("toolface"),
          py::arg("reach"), py::arg("threads"));
    m.def("section_library", &section_library, py::arg("bit_diameter"), py::arg("criteria"), py::arg("even"));
    m.def("kinds_along", &kinds_along, py::arg("sections"), py::arg("height"), py::arg("wanted"), py::arg("library"),
          py::arg("threads"));
    m.def("likely_kind", &likely_kind, py::arg("sections"), py::arg("library"));
    m.def("measured", &measured, py::arg("helix"), py::arg("count"), py::arg("depth"), py::arg("toolface"),
          py::arg("of_samples"), py::arg("of_vertices"), py::arg("rule"), py::arg("threads"));
}

}  // namespace helibore::bindings
