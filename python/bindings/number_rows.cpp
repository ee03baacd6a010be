// helibore._core: read_number_rows.
#include "helibore/number_rows.hpp"

#include <algorithm>
#include <string_view>

#include "arrays.hpp"
#include "gil.hpp"
#include "register.hpp"

namespace helibore::bindings {

namespace {

py::array_t<double> number_rows(std::string_view text, std::size_t columns, bool comments) {
    std::vector<double> values;
    {
        const WithoutGil released;
        values = read_number_rows(text, columns, comments);
    }
    const auto width = static_cast<py::ssize_t>(columns);
    const auto rows = static_cast<py::ssize_t>(values.size() / std::max<std::size_t>(columns, 1));
    return array_of(std::move(values), {width, rows});
}

}  // namespace

void register_number_rows(py::module_& m) {
    m.def("read_number_rows", &number_rows, py::arg("text"), py::arg("columns"), py::arg("comments"));
}

}  // namespace helibore::bindings
