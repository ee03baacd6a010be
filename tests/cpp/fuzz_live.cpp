// Fuzzes the readers of bytes from outside: the WITS parser (any chunking gives the same frames, bounded memory) and
// the journal scan (the records it returns are intact and in order).
//
//   clang++ -std=c++20 -O1 -g -fsanitize=fuzzer,address,undefined -Icpp/include -Icpp/src tests/cpp/fuzz_live.cpp
//           cpp/src/acquire/{wits,journal}.cpp cpp/src/base/error.cpp -o fuzz_live && ./fuzz_live -max_total_time=600
//   g++ -DSEEDED=200000 (the same without fuzzer) ... && ./fuzz_live          random inputs from a grammar, no clang
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <random>
#include <string>
#include <vector>

#include "helibore/journal.hpp"
#include "helibore/wits.hpp"

namespace wits = helibore::wits;
namespace journal = helibore::journal;

namespace {

void check(bool held, const char* rule) {
    if (!held) {
        std::fprintf(stderr, "broken: %s\n", rule);
        std::abort();
    }
}

struct Read {
    std::vector<wits::Item> items;
    std::vector<wits::Frame> frames;
    std::vector<wits::Event> events;
};

void add(Read& all, wits::Batch&& batch) {
    for (wits::Frame frame : batch.frames) {
        frame.first += static_cast<helibore::Index>(all.items.size());
        all.frames.push_back(frame);
    }
    all.items.insert(all.items.end(), batch.items.begin(), batch.items.end());
    all.events.insert(all.events.end(), batch.events.begin(), batch.events.end());
}

// Feeds the text in chunks of 1 to `longest` bytes.
Read read(std::string_view text, std::size_t longest, const wits::Limits& limits) {
    wits::Parser parser({-9999.0, -999.25}, limits);
    std::minstd_rand draw(7);
    Read all;
    for (std::size_t at = 0; at < text.size();) {
        const std::size_t size = longest == 0 ? text.size() : 1 + draw() % longest;
        wits::Batch batch = parser.feed(text.substr(at, size));
        at = std::min(at + size, text.size());
        const auto held =
            static_cast<helibore::Index>(at - batch.base) - static_cast<helibore::Index>(batch.text.size());
        check(held <= limits.frame + limits.line + 16, "the parser holds one frame and one line at most");
        check(text.substr(static_cast<std::size_t>(batch.base), batch.text.size()) == batch.text, "text is the stream");
        add(all, std::move(batch));
    }
    add(all, parser.finish());
    return all;
}

template <class T>
bool same(const std::vector<T>& a, const std::vector<T>& b) {
    return a.size() == b.size() && (a.empty() || std::memcmp(a.data(), b.data(), a.size() * sizeof(T)) == 0);
}

void fuzz_wits(std::string_view text) {
    for (const wits::Limits limits : {wits::Limits{}, wits::Limits{16, 64, 3}}) {
        const Read whole = read(text, 0, limits);
        for (const std::size_t longest : {std::size_t{1}, std::size_t{9}}) {
            const Read cut = read(text, longest, limits);
            check(same(whole.items, cut.items), "items do not depend on the chunks");
            check(same(whole.frames, cut.frames), "frames do not depend on the chunks");
            check(same(whole.events, cut.events), "events do not depend on the chunks");
        }
        for (const wits::Item& item : whole.items)
            check((item.value == item.value) == (item.flags == 0), "a value is a number or has a flag");
    }
}

// The input as a segment, and as a payload between two good records.
void fuzz_journal(std::string_view text) {
    journal::scan(text, 0, 1);
    std::string segment;
    std::uint64_t sequence = 0;
    for (const std::string_view payload :
         {std::string_view("before"), text.substr(0, 1 << 16), std::string_view("after")}) {
        journal::Record record;
        record.sequence = sequence++;
        const auto header = journal::seal(record, payload, 99);
        segment.append(header.data(), header.size()).append(payload);
    }
    check(journal::scan(segment, 0, 99).records.size() == 3, "good records are found");
    segment[60] = static_cast<char>(segment[60] ^ 1);  // in the header of the second
    const journal::Scan scan = journal::scan(segment, 0, 99);
    check(scan.records.size() == 2 && scan.records[1].sequence == 2, "a payload never passes as a record");
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* bytes, std::size_t size) {
    const std::string_view text(reinterpret_cast<const char*>(bytes), size);
    fuzz_wits(text);
    fuzz_journal(text);
    return 0;
}

#ifdef SEEDED
int main() {
    const std::vector<std::string> words = {"&&",
                                            "!!",
                                            "\n",
                                            "\r\n",
                                            "\r\n",
                                            "\r",
                                            "0108",
                                            "9999",
                                            "0000",
                                            "1.5",
                                            "-9999",
                                            "nan",
                                            "1e400",
                                            "&",
                                            "!",
                                            " ",
                                            std::string(1, '\0'),
                                            "\xff",
                                            "HLBJ",
                                            std::string(70, '7'),
                                            "&&\r\n01081\r\n!!\r\n",
                                            "!!&&\n",
                                            "+",
                                            "e",
                                            "."};
    std::mt19937 draw(1);
    for (long i = 0; i < SEEDED; ++i) {
        std::string text;
        for (unsigned n = draw() % 60; n > 0; --n) text += words[draw() % words.size()];
        LLVMFuzzerTestOneInput(reinterpret_cast<const std::uint8_t*>(text.data()), text.size());
    }
    std::printf("%ld inputs\n", static_cast<long>(SEEDED));
}
#endif
