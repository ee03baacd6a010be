// helibore._core: compress and decompress.
#include "helibore/compression.hpp"

#include "arrays.hpp"
#include "gil.hpp"
#include "register.hpp"

namespace helibore::bindings {

namespace {

using Words = py::array_t<std::uint64_t, py::array::c_style>;
using Bytes = py::array_t<std::uint8_t, py::array::c_style>;

Bytes compressed(const Words& words) {
    std::vector<std::uint8_t> bytes;
    const std::span<const std::uint64_t> all(words.data(), static_cast<std::size_t>(words.size()));
    {
        const WithoutGil released;
        bytes = compress(all);
    }
    return array_of(std::move(bytes));
}

void decompressed(const Bytes& bytes, Words& into) {
    const std::span<const std::uint8_t> all(bytes.data(), static_cast<std::size_t>(bytes.size()));
    const std::span<std::uint64_t> words(into.mutable_data(), static_cast<std::size_t>(into.size()));
    const WithoutGil released;
    decompress(all, words);
}

std::uint64_t sum_of(const std::vector<Column>& columns) {
    std::vector<std::span<const double>> spans;
    for (const Column& column : columns) spans.push_back(span_of(column));
    const WithoutGil released;
    return sum_of_rows(spans);
}

}  // namespace

void register_compression(py::module_& m) {
    m.def("compress", &compressed, py::arg("words").noconvert());
    m.def("decompress", &decompressed, py::arg("bytes").noconvert(), py::arg("into").noconvert());
    m.def("sum_of_rows", &sum_of, py::arg("columns"));
}

}  // namespace helibore::bindings
