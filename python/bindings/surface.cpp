// Surfaces and volumes for Python: the layout counts their rows, which are then written into NumPy arrays.
#include "helibore/surface.hpp"

#include "arrays.hpp"
#include "gil.hpp"
#include "helibore/error.hpp"
#include "register.hpp"

namespace helibore::bindings {

namespace {

// Returns the rows of a new array, which are not yet written. NumPy's allocator uses huge pages, so the first write is
// cheap.
template <class Row, class Number>
std::span<Row> rows_in(py::array_t<Number>& array) {
    return {reinterpret_cast<Row*>(array.mutable_data()), static_cast<std::size_t>(array.shape(0))};
}

// Returns a (runs, 2) array: for each run, its first vertex k and the k after its last.
template <class Run, class RangeOf>
py::array_t<Index> ranges_of(const std::vector<Run>& runs, const RangeOf& range_of) {
    std::vector<Index> ranges;
    for (const Run& run : runs) ranges.insert(ranges.end(), {range_of(run).start, range_of(run).stop});
    return array_of(std::move(ranges), {static_cast<py::ssize_t>(runs.size()), 2});
}

HelixRadii radii_of(const py::tuple& helix, Index first, const Column& radius) {
    return {.start_depth = helix[0].cast<double>(),
            .start_toolface = helix[1].cast<double>(),
            .pitch = helix[2].cast<double>(),
            .sectors = helix[3].cast<int>(),
            .first = first,
            .radius = span_of(radius)};
}

py::tuple surface(const py::tuple& helix, Index first, const Column& radius, const Path& path, int threads) {
    const HelixRadii radii = radii_of(helix, first, radius);
    SurfaceLayout layout;
    {
        const WithoutGil released;
        layout = surface_layout(radii);
    }
    py::array_t<double> vertices({layout.vertex_count, Index{3}});
    py::array_t<Index> quads({layout.quad_count, Index{4}});
    const auto vertex_rows = rows_in<Vector3>(vertices);
    const auto quad_rows = rows_in<Quad>(quads);
    {
        const WithoutGil released;
        place(radii, path, layout.vertices, vertex_rows, threads);
        join(radii, layout, quad_rows, threads);
    }
    return py::make_tuple(vertices, quads, ranges_of(layout.vertices, [](const VertexRun& run) { return run.k; }),
                          ranges_of(layout.quads, [](const QuadRun& run) { return run.k; }));
}

py::tuple volume(const py::tuple& helix, Index first, const std::vector<Column>& shells, const Path& path,
                 int threads) {
    std::vector<std::span<const double>> spans;
    for (const Column& shell : shells) spans.push_back(span_of(shell));
    HelixRadii radii = radii_of(helix, first, shells.at(0));
    VolumeLayout layout;
    {
        const WithoutGil released;
        layout = volume_layout(radii, spans);
    }
    py::array_t<double> vertices({layout.vertex_count, Index{3}});
    py::array_t<Index> hexahedra({layout.hexahedron_count, Index{8}});
    const auto vertex_rows = rows_in<Vector3>(vertices);
    const auto hexahedron_rows = rows_in<Hexahedron>(hexahedra);
    {
        const WithoutGil released;
        for (std::size_t s = 0; s < spans.size(); ++s) {
            radii.radius = spans[s];
            place(radii, path, layout.shells[s], vertex_rows, threads);
        }
        join(radii, layout, hexahedron_rows, threads);
        require_upright(radii, layout, vertex_rows, hexahedron_rows, threads);
    }
    py::list shell_ranges, layer_ranges;
    for (const auto& runs : layout.shells) {
        shell_ranges.append(ranges_of(runs, [](const VertexRun& run) { return run.k; }));
    }
    for (const auto& runs : layout.layers) {
        layer_ranges.append(ranges_of(runs, [](const HexahedronRun& run) { return run.inner.k; }));
    }
    return py::make_tuple(vertices, hexahedra, shell_ranges, layer_ranges);
}

// Returns the rows of a two-dimensional array that is C-contiguous.
template <class Row, class Number>
std::span<const Row> rows_of_array(const py::array_t<Number, py::array::c_style>& array) {
    if (array.ndim() != 2 || array.shape(1) != static_cast<py::ssize_t>(std::tuple_size_v<Row>))
        throw InternalError("an array of rows has another shape");
    return {reinterpret_cast<const Row*>(array.data()), static_cast<std::size_t>(array.shape(0))};
}

py::array_t<double> hexahedron_volumes(const py::array_t<double, py::array::c_style>& vertices,
                                       const py::array_t<Index, py::array::c_style>& hexahedra, int threads) {
    const auto vertex_rows = rows_of_array<Vector3>(vertices);
    const auto hexahedron_rows = rows_of_array<Hexahedron>(hexahedra);
    std::vector<double> found;
    {
        const WithoutGil released;
        found = volumes(vertex_rows, hexahedron_rows, threads);
    }
    return array_of(std::move(found));
}

}  // namespace

void register_surface(py::module_& m) {
    m.def("surface", &surface, py::arg("helix"), py::arg("first"), py::arg("radius"), py::arg("path"),
          py::arg("threads"));
    m.def("volume", &volume, py::arg("helix"), py::arg("first"), py::arg("shells"), py::arg("path"),
          py::arg("threads"));
    m.def("hexahedron_volumes", &hexahedron_volumes, py::arg("vertices"), py::arg("hexahedra"), py::arg("threads"));
}

}  // namespace helibore::bindings
