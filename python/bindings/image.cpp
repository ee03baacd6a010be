// helibore._core: cell_values and linear_values, which return one value of a sector image for each quad.
#include "helibore/image.hpp"

#include "arrays.hpp"
#include "gil.hpp"
#include "register.hpp"

namespace helibore::bindings {

namespace {

ImageRows rows_of(const Column& depth, const Column& values) {
    return {.depth = span_of(depth),
            .values = span_of(values),
            .sectors = depth.size() ? static_cast<int>(values.size() / depth.size()) : 0};
}

// Converts quads as Python passes them: the tuple (start depth, pitch, count), and the column of sectors.
QuadCentres quads_of(const py::tuple& quads, const Column& sector) {
    return {.start_depth = quads[0].cast<double>(),
            .pitch = quads[1].cast<double>(),
            .count = quads[2].cast<Index>(),
            .sector = span_of(sector)};
}

py::array_t<double> cells(const Column& depth, const Column& values, const Column& low, const Column& high,
                          const py::tuple& quads, const Column& sector, int threads) {
    const ImageRows image = rows_of(depth, values);
    const QuadCentres centres = quads_of(quads, sector);
    std::vector<double> found;
    {
        const WithoutGil released;
        found = cell_values(image, span_of(low), span_of(high), centres, threads);
    }
    return array_of(std::move(found));
}

py::array_t<double> linear(const Column& depth, const Column& values, double reach, const py::tuple& quads,
                           const Column& sector, int threads) {
    const ImageRows image = rows_of(depth, values);
    const QuadCentres centres = quads_of(quads, sector);
    std::vector<double> found;
    {
        const WithoutGil released;
        found = linear_values(image, reach, centres, threads);
    }
    return array_of(std::move(found));
}

}  // namespace

void register_image(py::module_& m) {
    m.def("cell_values", &cells, py::arg("depth"), py::arg("values"), py::arg("low"), py::arg("high"), py::arg("quads"),
          py::arg("sector"), py::arg("threads"));
    m.def("linear_values", &linear, py::arg("depth"), py::arg("values"), py::arg("reach"), py::arg("quads"),
          py::arg("sector"), py::arg("threads"));
}

}  // namespace helibore::bindings
