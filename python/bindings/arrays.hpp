// Where NumPy arrays become spans and vectors become owned NumPy arrays; nothing else in the bindings touches buffers.
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

// The Python layer (arrays.py) has made these one-dimensional, C-contiguous and float64.
using Column = py::array_t<double, py::array::c_style>;

inline std::span<const double> span_of(const Column& column) {
    return {column.data(), static_cast<std::size_t>(column.size())};
}

// An owned array of exact size that takes over the vector's memory: no copy.
template <class T>
py::array_t<T> array_of(std::vector<T>&& values, std::vector<py::ssize_t> shape = {}) {
    if (shape.empty()) shape = {static_cast<py::ssize_t>(values.size())};
    auto owner = std::make_unique<std::vector<T>>(std::move(values));
    T* first = owner->data();
    py::capsule release(owner.release(), [](void* p) { delete static_cast<std::vector<T>*>(p); });
    return py::array_t<T>(shape, first, release);
}

// The shape below the first axis of one element: a vector is (3,), a frame (3, 3).
inline std::vector<py::ssize_t> shape_of(double) {
    return {};
}
template <class T, std::size_t n>
std::vector<py::ssize_t> shape_of(const std::array<T, n>&) {
    std::vector<py::ssize_t> shape = shape_of(T{});
    shape.insert(shape.begin(), static_cast<py::ssize_t>(n));
    return shape;
}

// An owned (n, 3) or (n, 3, 3) array that takes over the memory of n vectors or frames: no copy.
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
