// Turns NumPy arrays into spans, and vectors into NumPy arrays that own them.
#pragma once

#include <pybind11/numpy.h>
#include <pybind11/pybind11.h>
#include <pybind11/stl.h>

#include <array>
#include <cstring>
#include <memory>
#include <span>
#include <vector>

namespace helibore::bindings {

namespace py = pybind11;

// An array that the core reads in place: exactly numpy.ndarray, C-contiguous, aligned and native float64. The Python
// layer (base/arrays.py) converts other arrays. pybind11's array_t takes 200 ns more for each column of an append.
struct Column {
    py::object array;
    std::span<const double> values;

    py::ssize_t size() const { return static_cast<py::ssize_t>(values.size()); }
};

inline bool is_column(py::handle array) {
    constexpr int wanted = py::detail::npy_api::NPY_ARRAY_C_CONTIGUOUS_ | py::detail::npy_api::NPY_ARRAY_ALIGNED_;
    if (Py_TYPE(array.ptr()) != py::detail::npy_api::get().PyArray_Type_) return false;
    const auto* proxy = py::detail::array_proxy(array.ptr());
    const auto* dtype = py::detail::array_descriptor_proxy(proxy->descr);
    return (proxy->flags & wanted) == wanted && dtype->type_num == py::detail::npy_api::NPY_DOUBLE_ &&
           dtype->byteorder == '=';
}

inline std::span<const double> span_of(const Column& column) {
    return column.values;
}

// Returns an array that takes over the vector's memory without a copy.
template <class T>
py::array_t<T> array_of(std::vector<T>&& values, std::vector<py::ssize_t> shape = {}) {
    if (shape.empty()) shape = {static_cast<py::ssize_t>(values.size())};
    auto owner = std::make_unique<std::vector<T>>(std::move(values));
    T* first = owner->data();
    py::capsule release(owner.release(), [](void* p) { delete static_cast<std::vector<T>*>(p); });
    return py::array_t<T>(shape, first, release);
}

// Returns the shape of one element of an array of rows: (3,) for a vector, (3, 3) for a frame.
inline std::vector<py::ssize_t> shape_of(double) {
    return {};
}
template <class T, std::size_t n>
std::vector<py::ssize_t> shape_of(const std::array<T, n>&) {
    std::vector<py::ssize_t> shape = shape_of(T{});
    shape.insert(shape.begin(), static_cast<py::ssize_t>(n));
    return shape;
}

// Returns an (n, 3) or (n, 3, 3) array that takes over the memory of n vectors or frames without a copy.
template <class Row>
py::array_t<double> rows_of(std::vector<Row>&& rows) {
    auto shape = shape_of(Row{});
    shape.insert(shape.begin(), static_cast<py::ssize_t>(rows.size()));
    auto owner = std::make_unique<std::vector<Row>>(std::move(rows));
    const auto* first = reinterpret_cast<const double*>(owner->data());
    py::capsule release(owner.release(), [](void* p) { delete static_cast<std::vector<Row>*>(p); });
    return py::array_t<double>(shape, first, release);
}

}  // namespace helibore::bindings

namespace pybind11::detail {

template <>
struct type_caster<helibore::bindings::Column> {
    PYBIND11_TYPE_CASTER(helibore::bindings::Column, const_name("numpy.ndarray[numpy.float64]"));

    bool load(handle from, bool) {
        if (!helibore::bindings::is_column(from)) return false;
        const auto array = reinterpret_borrow<pybind11::array>(from);
        value = {array, {static_cast<const double*>(array.data()), static_cast<std::size_t>(array.size())}};
        return true;
    }
};

}  // namespace pybind11::detail
