// helibore._core: the steps of the preparation.
#include "helibore/preparation.hpp"

#include "arrays.hpp"
#include "gil.hpp"
#include "register.hpp"

namespace helibore::bindings {

namespace {

using Sensors = std::vector<std::tuple<double, double, Index>>;  // offset, mounting, column

std::vector<ToolSensor> sensors_of(const Sensors& given) {
    std::vector<ToolSensor> sensors;
    for (const auto& [offset, mounting, column] : given) sensors.push_back({offset, mounting, column});
    return sensors;
}

std::vector<std::span<const double>> spans_of(const std::vector<Column>& columns) {
    std::vector<std::span<const double>> spans;
    for (const Column& column : columns) spans.push_back(span_of(column));
    return spans;
}

py::list list_of(const std::vector<SuspectRows>& stretches) {
    constexpr std::array names{"disagreement", "closed", "ramp", "saturated", "stuck", "burst", "jump"};
    py::list list;
    for (const SuspectRows& s : stretches)
        list.append(py::make_tuple(names.at(static_cast<std::size_t>(s.cause)), s.column, s.rows.start, s.rows.stop,
                                   s.dropped, s.radius, s.other));
    return list;
}

py::list judged(const Column& depth, const Column& toolface, const std::vector<Column>& radii, const Sensors& sensors,
                std::optional<double> bit_diameter, bool drop_closed, bool drop_saturated, bool drop_spikes,
                double spikes) {
    std::vector<SuspectRows> found;
    {
        const WithoutGil released;
        found = judge_rows({span_of(depth), span_of(toolface), spans_of(radii), {}}, sensors_of(sensors),
                           {bit_diameter, drop_closed, drop_saturated, drop_spikes, spikes});
    }
    return list_of(found);
}

py::list stuck(const std::vector<Column>& radii, Index rows, double moving) {
    std::vector<SuspectRows> found;
    {
        const WithoutGil released;
        found = stuck_arms(spans_of(radii), rows, moving);
    }
    return list_of(found);
}

py::tuple observed(const Column& depth, const Column& toolface, const std::vector<Column>& radii,
                   const std::optional<Column>& time, const Sensors& sensors) {
    ToolRows rows{span_of(depth), span_of(toolface), spans_of(radii), {}};
    if (time) rows.time = span_of(*time);
    ToolSamples found;
    {
        const WithoutGil released;
        found = observe_by_depth(rows, sensors_of(sensors));
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

using Numbers = py::array_t<Index, py::array::c_style>;

std::span<const Index> span_of(const Numbers& numbers) {
    return {numbers.data(), static_cast<std::size_t>(numbers.size())};
}

std::optional<py::array_t<Index>> rotations(const Column& toolface, const Numbers& row, const Column& depth) {
    const std::span<const Index> rows = span_of(row);
    std::optional<std::vector<Index>> found;
    {
        const WithoutGil released;
        found = turns_by_rotation(span_of(toolface), rows, span_of(depth));
    }
    if (!found) return std::nullopt;
    return array_of(std::move(*found));
}

py::tuple spiked(const Column& toolface, const Column& radius, const Numbers& turn, const std::optional<Column>& depth,
                 double threshold, double floor) {
    const std::span<const Index> turns = span_of(turn);
    SpikedSamples found;
    {
        const WithoutGil released;
        const auto depths = depth ? std::optional(span_of(*depth)) : std::nullopt;
        found = find_spikes(span_of(toolface), span_of(radius), turns, depths, threshold, floor);
    }
    return py::make_tuple(array_of(std::move(found.samples)), found.unjudged);
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
          py::arg("sensors"));
    m.def("judge_rows", &judged, py::arg("depth"), py::arg("toolface"), py::arg("radii"), py::arg("sensors"),
          py::arg("bit_diameter"), py::arg("drop_closed"), py::arg("drop_saturated"), py::arg("drop_spikes"),
          py::arg("spikes"));
    m.def("stuck_arms", &stuck, py::arg("radii"), py::arg("rows"), py::arg("moving"));
    m.def("is_image", [](const Sensors& sensors) { return is_image(sensors_of(sensors)); }, py::arg("sensors"));
    m.def("odd_readings", &odd, py::arg("radius"), py::arg("threshold"), py::arg("floor"));
    m.def("turns_by_rotation", &rotations, py::arg("toolface"), py::arg("row"), py::arg("depth"));
    m.def("find_spikes", &spiked, py::arg("toolface"), py::arg("radius"), py::arg("turn"), py::arg("depth"),
          py::arg("threshold"), py::arg("floor"));
    m.def("share_of_repeats", &repeats, py::arg("depth"), py::arg("toolface"), py::arg("radius"), py::arg("most"));
    m.def("number_passes", &passes, py::arg("depth"), py::arg("reversal"));
}

}  // namespace helibore::bindings
