// Writes the records of a journal, and finds intact records again in bytes that may be damaged or cut. All bytes are in
// memory; the caller reads and writes files.
//
//   0     4       8         16       24         32          36      38    40           44          48
//   | HLBJ | length | sequence | wall ns | monotonic ns | connection | source | kind | payload crc | header crc |
//   payload ...
//
// All numbers are little-endian. The two times, in ns, are those of the wall clock and of the monotonic clock. Both
// checksums are CRC-32C. The header's checksum is seeded with the segment's salt, a random number that no sender knows.
// So the bytes of a sender, which are the payload, cannot contain a valid header, and are not taken for a record when
// the search resumes after damage.
#pragma once

#include <array>
#include <cstdint>
#include <string_view>
#include <vector>

#include "helibore/types.hpp"

namespace helibore::journal {

inline constexpr std::size_t header_size = 48;
inline constexpr std::uint32_t longest_payload = 1u << 20;

struct Record {
    std::uint64_t sequence = 0;
    std::int64_t wall = 0;       // receive time, ns since 1970
    std::int64_t monotonic = 0;  // receive time, ns of a clock that only runs forward
    Index offset = 0;            // of the payload in the bytes scanned
    std::uint32_t length = 0;
    std::uint32_t connection = 0;
    std::uint16_t source = 0;
    std::uint16_t kind = 0;
    std::uint32_t unused = 0;
};

struct Scan {
    std::vector<Record> records;  // every intact record, in order
    std::vector<Range> damage;    // byte ranges without an intact record; the last may reach to the end of the bytes
};

// Returns the CRC-32C (Castagnoli) of the bytes, continuing from `crc` (0 to begin).
std::uint32_t crc32c(std::string_view bytes, std::uint32_t crc = 0);

// Returns the header that makes `payload` a record. Throws InputError if the payload is longer than longest_payload.
std::array<char, header_size> seal(const Record& record, std::string_view payload, std::uint32_t salt);

// Finds the intact records of bytes[from, end), whose sequence numbers must grow. The work is linear in the bytes.
Scan scan(std::string_view bytes, std::size_t from, std::uint32_t salt);

}  // namespace helibore::journal
