// helibore._core: the steps of the preparation.
#include "helibore/preparation.hpp"

#include "arrays.hpp"
#include "gil.hpp"
#include "register.hpp"

namespace helibore::bindings {

namespace {

py::tuple observed(const Column& depth, const Column& toolface, const std::vector<Column>& radii,
                   const std::optional<Column>& time, const std::vector<double>& offsets,
                   const std::vector<double>& mountings) {
    ToolRows rows{span_of(depth), span_of(toolface), {}, {}};
    for (const Column& radius : radii) rows.radii.push_back(span_of(radius));
    if (time) rows.time = span_of(*time);
    std::vector<SensorPlace> sensors;
    for (std::size_t s = 0; s < offsets.size(); ++s) sensors.push_back({offsets[s], mountings.at(s)});
    ToolSamples found;
    {
        const WithoutGil released;
        found = observe_by_depth(rows, sensors);
    }
    const auto counts = py::make_tuple(found.no_depth, found.no_toolface, found.no_radius, found.no_time);
    const py::object times = time ? py::object(array_of(std::move(found.time))) : py::object(py::none());
    return py::make_tuple(array_of(std::move(found.depth)), array_of(std::move(found.toolface)),
                          array_of(std::move(found.radius)), times, array_of(std::move(found.sensor)),
                          array_of(std::move(found.row)), counts);
}

py::array_t<std::int64_t> odd(const Column& radius, double threshold, double floor) {
    std::vector<std::int64_t> found;
    {
        const WithoutGil released;
        found = odd_readings(span_of(radius), threshold, floor);
    }
    return array_of(std::move(found));
}

double repeats(const Column& depth, const Column& toolface, const Column& radius, Index most) {
    const WithoutGil released;
    return share_of_repeats(span_of(depth), span_of(toolface), span_of(radius), most);
}

py::array_t<std::int64_t> passes(const Column& depth, double reversal) {
    std::vector<std::int64_t> found;
    {
        const WithoutGil released;
        found = number_passes(span_of(depth), reversal);
    }
    return array_of(std::move(found));
}

}  // namespace

void register_preparation(py::module_& m) {
    m.def("observe_by_depth", &observed, py::arg("depth"), py::arg("toolface"), py::arg("radii"), py::arg("time"),
          py::arg("offsets"), py::arg("mountings"));
    m.def("odd_readings", &odd, py::arg("radius"), py::arg("threshold"), py::arg("floor"));
    m.def("share_of_repeats", &repeats, py::arg("depth"), py::arg("toolface"), py::arg("radius"), py::arg("most"));
    m.def("number_passes", &passes, py::arg("depth"), py::arg("reversal"));
}

}  // namespace helibore::bindings
