// CRC-32C against RFC 3720 (B.4) and a bitwise reference; records in damaged bytes.
#include "helibore/journal.hpp"

#include "check.hpp"
#include "helibore/error.hpp"

using namespace helibore;

namespace {

std::uint32_t bitwise(std::string_view bytes, std::uint32_t crc) {
    crc = ~crc;
    for (const char byte : bytes) {
        crc ^= static_cast<unsigned char>(byte);
        for (int bit = 0; bit < 8; ++bit) crc = (crc >> 1) ^ (0x82f63b78u & (0u - (crc & 1u)));
    }
    return ~crc;
}

std::string record(std::uint64_t sequence, const std::string& payload, std::uint32_t salt = 7) {
    journal::Record of;
    of.sequence = sequence;
    of.wall = -5;
    of.monotonic = 6;
    of.connection = 8;
    of.source = 9;
    of.kind = 10;
    const auto header = journal::seal(of, payload, salt);
    return std::string(header.begin(), header.end()) + payload;
}

}  // namespace

int main() {
    std::string rising, falling;
    for (int i = 0; i < 32; ++i) {
        rising += static_cast<char>(i);
        falling += static_cast<char>(31 - i);
    }
    CHECK(journal::crc32c(std::string(32, '\0')) == 0x8a9136aau);
    CHECK(journal::crc32c(std::string(32, '\xff')) == 0x62a8ab43u);
    CHECK(journal::crc32c(rising) == 0x46dd794eu && journal::crc32c(falling) == 0x113fdb5cu);
    CHECK(journal::crc32c("123456789") == 0xe3069283u && journal::crc32c("") == 0);
    for (std::size_t n = 0; n <= 32; ++n) {
        CHECK(journal::crc32c(rising.substr(0, n), 99) == bitwise(rising.substr(0, n), 99));
        CHECK(journal::crc32c(rising.substr(n), journal::crc32c(rising.substr(0, n))) == 0x46dd794eu);
    }

    const std::string a = record(0, "first"), b = record(1, ""), c = record(2, "HLBJ third");
    const std::string all = a + b + c;
    journal::Scan scan = journal::scan(all, 0, 7);
    CHECK(scan.records.size() == 3 && scan.damage.empty());
    const journal::Record& last = scan.records[2];
    CHECK(last.sequence == 2 && last.wall == -5 && last.monotonic == 6 && last.connection == 8 && last.source == 9);
    CHECK(last.kind == 10 && all.substr(static_cast<std::size_t>(last.offset), last.length) == "HLBJ third");
    CHECK(journal::scan(all, a.size(), 7).records.size() == 2 && journal::scan(all, all.size() + 9, 7).damage.empty());
    CHECK(journal::scan(all, 0, 8).records.empty());        // another segment's salt
    CHECK(journal::scan(b + a, 0, 7).records.size() == 1);  // sequence numbers grow
    CHECK(journal::scan(all.substr(0, all.size() - 1), 0, 7).records.size() == 2);
    const auto size = [](const std::string& text) { return static_cast<Index>(text.size()); };
    for (std::size_t at = 0; at < all.size(); ++at) {  // one flipped bit costs its record alone
        std::string damaged = all;
        damaged[at] = static_cast<char>(damaged[at] ^ 4);
        scan = journal::scan(damaged, 0, 7);
        const Index first = at < a.size() ? 0 : at < a.size() + b.size() ? size(a) : size(a + b);
        const Index stop = at < a.size() ? size(a) : at < a.size() + b.size() ? size(a + b) : size(all);
        CHECK(scan.records.size() == 2 && scan.damage == (std::vector<Range>{{first, stop}}));
    }
    CHECK_THROWS(InputError, "payload has 1048577 bytes: must be at most 1048576",
                 journal::seal({}, std::string(1048577, 'x'), 0));
    return failures();
}
