// helibore._core: crc32c, journal_seal and journal_scan.
#include "helibore/journal.hpp"

#include <pybind11/stl.h>

#include <utility>

#include "arrays.hpp"
#include "gil.hpp"
#include "register.hpp"

namespace helibore::bindings {

namespace {

std::string_view view_of(const py::buffer_info& bytes) {
    return {static_cast<const char*>(bytes.ptr), static_cast<std::size_t>(bytes.size * bytes.itemsize)};
}

py::bytes seal(std::uint64_t sequence, std::int64_t wall, std::int64_t monotonic, std::uint32_t connection,
               std::uint16_t source, std::uint16_t kind, const py::buffer& payload, std::uint32_t salt) {
    journal::Record record;
    record.sequence = sequence;
    record.wall = wall;
    record.monotonic = monotonic;
    record.connection = connection;
    record.source = source;
    record.kind = kind;
    const auto header = journal::seal(record, view_of(payload.request()), salt);
    return {header.data(), header.size()};
}

py::tuple scan(const py::buffer& bytes, std::size_t from, std::uint32_t salt) {
    const py::buffer_info view = bytes.request();
    const std::string_view text = view_of(view);
    journal::Scan found;
    {
        const WithoutGil released;
        found = journal::scan(text, from, salt);
    }
    std::vector<std::pair<Index, Index>> damage;
    for (const Range& range : found.damage) damage.emplace_back(range.start, range.stop);
    return py::make_tuple(array_of(std::move(found.records)), damage);
}

}  // namespace

void register_journal(py::module_& m) {
    using journal::Record;
    PYBIND11_NUMPY_DTYPE(Record, sequence, wall, monotonic, offset, length, connection, source, kind, unused);
    m.def(
        "crc32c",
        [](const py::buffer& bytes, std::uint32_t crc) { return journal::crc32c(view_of(bytes.request()), crc); },
        py::arg("bytes"), py::arg("crc") = 0, "Return the CRC-32C of the bytes; crc is the CRC-32C of earlier bytes.");
    m.def("journal_seal", &seal, py::arg("sequence"), py::arg("wall"), py::arg("monotonic"), py::arg("connection"),
          py::arg("source"), py::arg("kind"), py::arg("payload"), py::arg("salt"),
          "Return the 48-byte header that stands before the payload in a record.");
    m.def("journal_scan", &scan, py::arg("bytes"), py::arg("start"), py::arg("salt"),
          "Return (records, damage): the intact records as a structured array, and the byte ranges without a record.");
}

}  // namespace helibore::bindings
