// helibore._core.WitsParser takes bytes, and returns text and structured arrays of items, frames and events.
#include "helibore/wits.hpp"

#include <pybind11/stl.h>

#include <memory>
#include <utility>

#include "arrays.hpp"
#include "gil.hpp"
#include "helibore/error.hpp"
#include "register.hpp"

namespace helibore::bindings {

namespace {

std::string_view text_of(const py::buffer_info& bytes) {
    if (bytes.itemsize != 1 || bytes.ndim != 1 || (bytes.size > 1 && bytes.strides[0] != 1))
        throw InputError("bytes", "must be contiguous bytes");
    return {static_cast<const char*>(bytes.ptr), static_cast<std::size_t>(bytes.size)};
}

py::tuple arrays_of(wits::Batch&& batch) {
    return py::make_tuple(batch.base, py::bytes(batch.text), array_of(std::move(batch.items)),
                          array_of(std::move(batch.frames)), array_of(std::move(batch.events)));
}

py::tuple feed(wits::Parser& parser, const py::buffer& bytes) {
    const py::buffer_info view = bytes.request();
    const std::string_view text = text_of(view);
    wits::Batch batch;
    {
        const WithoutGil released;
        batch = parser.feed(text);
    }
    return arrays_of(std::move(batch));
}

py::dict counts(const wits::Parser& parser) {
    const wits::Counts counts = parser.counts();
    py::dict result;
    result["bytes"] = counts.bytes;
    result["lines"] = counts.lines;
    result["frames"] = counts.frames;
    result["items"] = counts.items;
    result["nulls"] = counts.nulls;
    result["not_numbers"] = counts.not_numbers;
    result["stray_lines"] = counts.stray_lines;
    constexpr const char* rules[wits::rule_count] = {"stray_text", "stray_end",  "unclosed",   "not_an_item",
                                                     "long_line",  "long_frame", "many_items", "cut_off"};
    for (std::size_t i = 0; i < wits::rule_count; ++i) result[rules[i]] = counts.events[i];
    return result;
}

}  // namespace

void register_wits(py::module_& m) {
    using wits::Event;
    using wits::Frame;
    using wits::Item;
    PYBIND11_NUMPY_DTYPE(Item, frame, offset, value, length, code, flags);
    PYBIND11_NUMPY_DTYPE(Frame, start, stop, first, items, line);
    PYBIND11_NUMPY_DTYPE(Event, offset, line, length, rule, unused);
    constexpr wits::Limits limits;
    m.attr("WITS_LIMITS") = py::make_tuple(limits.line, limits.frame, limits.items);
    py::class_<wits::Parser>(m, "WitsParser",
                             "Parse WITS level 0 text into rows of numbers. Each stream needs a parser of its own.")
        .def(py::init([](std::vector<double> nulls, Index line_limit, Index frame_limit, Index item_limit) {
                 return std::make_unique<wits::Parser>(std::move(nulls),
                                                       wits::Limits{line_limit, frame_limit, item_limit});
             }),
             py::arg("nulls"), py::arg("line_limit"), py::arg("frame_limit"), py::arg("item_limit"))
        .def("feed", &feed, py::arg("bytes"),
             "Return (base, text, items, frames, events) of the frames that these bytes complete. The text begins at "
             "the offset base of the stream.")
        .def(
            "finish", [](wits::Parser& parser) { return arrays_of(parser.finish()); },
            "Return, as feed does, the frames that the end of the stream completes.")
        .def("state", [](const wits::Parser& parser) { return py::bytes(parser.state()); })
        .def("restore", [](wits::Parser& parser, const std::string& state) { parser.restore(state); })
        .def("counts", &counts, "Return how many bytes, lines, frames, items and bad texts of each kind were read.");
}

}  // namespace helibore::bindings
