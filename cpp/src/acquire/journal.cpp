// CRC-32C by slicing eight bytes at a time, and the search for intact records.
#include "helibore/journal.hpp"

#include <bit>
#include <cstring>
#include <optional>
#include <string>

#include "helibore/error.hpp"

namespace helibore::journal {

namespace {

static_assert(std::endian::native == std::endian::little, "the journal is written by copying little-endian numbers");

constexpr std::string_view magic = "HLBJ";
constexpr std::size_t payload_crc_at = 40;
constexpr std::size_t header_crc_at = 44;

using Table = std::array<std::array<std::uint32_t, 256>, 8>;

// Tables of CRC-32C, slicing by 8, reflected polynomial 0x82f63b78: table[j][b] is the CRC of byte b and j zero bytes.
constexpr Table make_table() {
    Table table{};
    for (std::uint32_t i = 0; i < 256; ++i) {
        std::uint32_t crc = i;
        for (int bit = 0; bit < 8; ++bit) crc = (crc >> 1) ^ ((crc & 1) != 0 ? 0x82f63b78u : 0u);
        table[0][i] = crc;
    }
    for (std::size_t j = 1; j < 8; ++j)
        for (std::size_t i = 0; i < 256; ++i) table[j][i] = (table[j - 1][i] >> 8) ^ table[0][table[j - 1][i] & 255];
    return table;
}
constexpr Table table = make_table();

template <class T>
void put(char* at, T value) {
    std::memcpy(at, &value, sizeof value);
}

template <class T>
T get(const char* at) {
    T value;
    std::memcpy(&value, at, sizeof value);
    return value;
}

// Returns the record whose header starts at `at`, or none if no intact header does. The payload is not checked. The
// header is copied first: a process may write into the file whose bytes these are.
std::optional<Record> header_at(std::string_view bytes, std::size_t at, std::uint32_t salt) {
    if (bytes.size() - at < header_size || bytes.substr(at, magic.size()) != magic) return std::nullopt;
    char p[header_size];
    std::memcpy(p, bytes.data() + at, header_size);
    if (crc32c({p, header_crc_at}, salt) != get<std::uint32_t>(p + header_crc_at)) return std::nullopt;
    Record record;
    record.length = get<std::uint32_t>(p + 4);
    record.sequence = get<std::uint64_t>(p + 8);
    record.wall = get<std::int64_t>(p + 16);
    record.monotonic = get<std::int64_t>(p + 24);
    record.connection = get<std::uint32_t>(p + 32);
    record.source = get<std::uint16_t>(p + 36);
    record.kind = get<std::uint16_t>(p + 38);
    record.offset = static_cast<Index>(at + header_size);
    return record;
}

}  // namespace

std::uint32_t crc32c(std::string_view bytes, std::uint32_t crc) {
    const char* p = bytes.data();
    std::size_t left = bytes.size();
    crc = ~crc;
    for (; left >= 8; left -= 8, p += 8) {
        const std::uint64_t word = get<std::uint64_t>(p) ^ crc;
        crc = 0;
        for (std::size_t j = 0; j < 8; ++j) crc ^= table[7 - j][(word >> (8 * j)) & 255];
    }
    for (; left > 0; --left, ++p) crc = (crc >> 8) ^ table[0][(crc ^ static_cast<unsigned char>(*p)) & 255];
    return ~crc;
}

std::array<char, header_size> seal(const Record& record, std::string_view payload, std::uint32_t salt) {
    if (payload.size() > longest_payload)
        throw InputError("payload has " + std::to_string(payload.size()) + " bytes",
                         "must be at most " + std::to_string(longest_payload));
    std::array<char, header_size> header{};
    char* p = header.data();
    std::memcpy(p, magic.data(), magic.size());
    put(p + 4, static_cast<std::uint32_t>(payload.size()));
    put(p + 8, record.sequence);
    put(p + 16, record.wall);
    put(p + 24, record.monotonic);
    put(p + 32, record.connection);
    put(p + 36, record.source);
    put(p + 38, record.kind);
    put(p + payload_crc_at, crc32c(payload));
    put(p + header_crc_at, crc32c({p, header_crc_at}, salt));
    return header;
}

Scan scan(std::string_view bytes, std::size_t from, std::uint32_t salt) {
    Scan scan;
    std::uint64_t next_sequence = 0;
    std::size_t at = from;
    std::size_t good = from;  // end of the last intact record
    while (at < bytes.size()) {
        const std::optional<Record> record = header_at(bytes, at, salt);
        const std::size_t start = at + header_size;
        if (!record || record->sequence < next_sequence || bytes.size() - start < record->length) {
            at = bytes.find(magic, at + 1);
            continue;
        }
        const std::string_view payload = bytes.substr(start, record->length);
        const std::size_t stop = start + payload.size();
        if (crc32c(payload) == get<std::uint32_t>(bytes.data() + at + payload_crc_at)) {
            if (good < at) scan.damage.push_back({static_cast<Index>(good), static_cast<Index>(at)});
            scan.records.push_back(*record);
            next_sequence = record->sequence + 1;
            good = stop;
        }
        at = stop;
    }
    if (good < bytes.size()) scan.damage.push_back({static_cast<Index>(good), static_cast<Index>(bytes.size())});
    return scan;
}

}  // namespace helibore::journal
