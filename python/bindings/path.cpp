// helibore._core: the classes Survey, Path and Stations, which take and return arrays.
#include "helibore/path.hpp"

#include "arrays.hpp"
#include "register.hpp"

namespace helibore::bindings {

namespace {

PathSettings settings_of(const std::string& method, const std::string& reference, const Vector3& head, double extend) {
    return {.method = method_of(method), .reference = reference_of(reference), .head = head, .extend = extend};
}

}  // namespace

void register_path(py::module_& m) {
    py::class_<Survey>(m, "Survey")
        .def(py::init([](const Column& depth, const Column& inclination, const Column& azimuth) {
                 return Survey(span_of(depth), span_of(inclination), span_of(azimuth));
             }),
             py::arg("depth"), py::arg("inclination"), py::arg("azimuth"))
        .def("dogleg", [](const Survey& survey) { return array_of(survey.dogleg()); });

    py::class_<Path>(m, "Path")
        .def(py::init<>())
        .def(py::init([](const Survey& survey, const std::string& method, const std::string& reference,
                         const Vector3& head,
                         double extend) { return Path(survey, settings_of(method, reference, head, extend)); }),
             py::arg("survey"), py::arg("method"), py::arg("reference"), py::arg("head"), py::arg("extend"))
        .def("position", [](const Path& path, const Column& depth) { return rows_of(path.position(span_of(depth))); })
        .def("tangent", [](const Path& path, const Column& depth) { return rows_of(path.tangent(span_of(depth))); })
        .def("frame", [](const Path& path, const Column& depth) { return rows_of(path.frame(span_of(depth))); })
        .def("north_to_high_side",
             [](const Path& path, const Column& depth) { return array_of(path.north_to_high_side(span_of(depth))); })
        .def_property_readonly("start_depth", &Path::start_depth)
        .def_property_readonly("survey_depth", &Path::survey_depth)
        .def_property_readonly("stop_depth", &Path::stop_depth);

    py::class_<Stations>(m, "Stations")
        .def(py::init([](const std::string& method, const std::string& reference, const Vector3& head, double extend) {
                 return std::make_unique<Stations>(settings_of(method, reference, head, extend));
             }),
             py::arg("method"), py::arg("reference"), py::arg("head"), py::arg("extend"))
        .def("take",
             [](Stations& stations, const Column& depth, const Column& inclination, const Column& azimuth) {
                 Stations::Taken taken = stations.take(span_of(depth), span_of(inclination), span_of(azimuth));
                 return py::make_tuple(taken.path_from, std::move(taken.refused));
             })
        .def("columns",
             [](const Stations& stations) {
                 const auto copied = [](std::span<const double> of) {
                     return array_of(std::vector<double>(of.begin(), of.end()));
                 };
                 return py::make_tuple(copied(stations.depth()), copied(stations.inclination()),
                                       copied(stations.azimuth()));
             })
        .def("path", &Stations::path)
        .def("__len__", [](const Stations& stations) { return stations.depth().size(); });
}

}  // namespace helibore::bindings
