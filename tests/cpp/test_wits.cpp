// The WITS parser: a frame item by item, the strict grammar of numbers, every rule with its place in the stream, and
// the same results however the stream is cut.
#include "helibore/wits.hpp"

#include <cmath>
#include <cstring>
#include <limits>

#include "check.hpp"
#include "helibore/error.hpp"
#include "host.hpp"

using namespace helibore;

namespace {

constexpr double nan = std::numeric_limits<double>::quiet_NaN();
const wits::Limits small{.line = 16, .frame = 64, .items = 3};

template <class T>
bool same(const std::vector<T>& a, const std::vector<T>& b) {
    return a.size() == b.size() && (a.empty() || std::memcmp(a.data(), b.data(), a.size() * sizeof(T)) == 0);
}

// The whole stream at once, checked against the same stream byte by byte.
wits::Batch read(std::string_view stream, const wits::Limits& limits = {}) {
    wits::Batch results[2];
    for (const std::size_t chunk : {stream.size() + 1, std::size_t{1}}) {
        wits::Batch& all = results[chunk == 1];
        wits::Parser parser({-9999.0, -999.25}, limits);
        const auto add = [&](const wits::Batch& batch) {
            for (wits::Frame frame : batch.frames) {
                frame.first += static_cast<Index>(all.items.size());
                all.frames.push_back(frame);
            }
            all.items.insert(all.items.end(), batch.items.begin(), batch.items.end());
            all.events.insert(all.events.end(), batch.events.begin(), batch.events.end());
            all.text += batch.text;
        };
        for (std::size_t at = 0; at < stream.size(); at += chunk) add(parser.feed(stream.substr(at, chunk)));
        add(parser.finish());
        CHECK(parser.counts().bytes == static_cast<Index>(stream.size()));
        CHECK(parser.counts().frames == static_cast<Index>(all.frames.size()));
        for (const wits::Event& event : all.events)
            CHECK(parser.counts().events[static_cast<std::size_t>(event.rule)] > 0);
    }
    CHECK(same(results[0].items, results[1].items) && same(results[0].frames, results[1].frames));
    CHECK(same(results[0].events, results[1].events) && stream.starts_with(results[0].text));
    return results[0];
}

void a_frame() {
    const std::string stream = "&&\r\n01083650.40\r\n0110-9999\n0111  \r\n2210Watch out!! kick\r\n\r\n!!\r\n";
    const wits::Batch batch = read(stream);
    CHECK(batch.text == stream && batch.events.empty() && batch.frames.size() == 1 && batch.items.size() == 4);
    const wits::Frame& frame = batch.frames[0];
    CHECK(frame.start == 0 && frame.stop == static_cast<Index>(stream.size()) && frame.items == 4 && frame.line == 1);
    const std::uint16_t codes[] = {108, 110, 111, 2210}, flags[] = {0, 1, 1, 2};
    const std::string texts[] = {"3650.40", "-9999", "", "Watch out!! kick"};  // blanks around a line are left out
    for (std::size_t i = 0; i < 4; ++i) {
        const wits::Item& item = batch.items[i];
        CHECK(item.code == codes[i] && item.flags == flags[i] && item.frame == 0);
        CHECK(stream.substr(static_cast<std::size_t>(item.offset), static_cast<std::size_t>(item.length)) == texts[i]);
        CHECK(i == 0 ? item.value == 3650.4 : std::isnan(item.value));
    }
    wits::Parser parser;
    parser.feed(stream);
    const wits::Counts counts = parser.counts();
    CHECK(counts.lines == 7 && counts.items == 4 && counts.nulls == 2 && counts.not_numbers == 1);
    CHECK(counts.stray_lines == 0);
}

void numbers() {
    const struct {
        const char* text;
        double value;
    } cases[] = {{"1.5", 1.5},
                 {"+2", 2.0},
                 {"-0.25", -0.25},
                 {"12345678", 12345678.0},
                 {".5", 0.5},
                 {"5.", 5.0},
                 {"1e3", 1000.0},
                 {"123456789.125", 123456789.125},
                 {" 7 ", 7.0},
                 {"1E-3", 1e-3},
                 {"-0", -0.0},
                 {"0.0001234", 0.0001234},
                 {"-1234567", -1234567.0},
                 {"99999999", 99999999.0},
                 {"+.5e+1", 5.0},
                 {"nan", nan},
                 {"inf", nan},
                 {"1_2", nan},
                 {"1,5", nan},
                 {"1e400", nan},
                 {"1e-400", nan},
                 {"0x1p3", nan},
                 {".", nan},
                 {"1.2.3", nan},
                 {"-", nan},
                 {"+", nan},
                 {"+-1", nan},
                 {"-+1", nan},
                 {"1 2", nan},
                 {"1e", nan},
                 {"12345678x", nan}};
    for (const auto& [text, value] : cases) {
        const wits::Batch batch = read(std::string("&&\n0108") + text + "\n!!\n");
        CHECK(batch.items.size() == 1);
        const double found = batch.items.at(0).value;
        if (!(std::isnan(value) ? std::isnan(found) : found == value && std::signbit(found) == std::signbit(value)))
            fail(__FILE__, __LINE__, text);
        CHECK(batch.items.at(0).flags == (std::isnan(value) ? wits::not_a_number : 0));
    }
}

// The one event of a stream, and how many frames it has.
void broken(const std::string& stream, wits::Rule rule, Index offset, Index line, int length, std::size_t frames,
            const wits::Limits& limits = {}) {
    const wits::Batch batch = read(stream, limits);
    CHECK(batch.frames.size() == frames);
    CHECK(batch.events.size() == 1);
    const wits::Event event = batch.events.at(0);
    if (event.rule != rule || event.offset != offset || event.line != line || event.length != length)
        fail(__FILE__, __LINE__,
             stream + ": rule " + std::to_string(static_cast<int>(event.rule)) + " at " + std::to_string(event.offset) +
                 ", line " + std::to_string(event.line) + ", length " + std::to_string(event.length));
}

void rules() {
    using enum wits::Rule;
    const std::string good = "&&\n01081\n!!\n";
    broken("hello\nagain\n" + good, stray_text, 0, 1, 5, 1);
    broken(good + "hello", stray_text, 12, 4, 5, 1);
    broken("!!\n" + good, stray_end, 0, 1, 2, 1);
    broken("&&\n01082\n" + good, unclosed, 0, 1, 2, 1);
    broken("&&\n0008x\n01081\n!!\n", not_an_item, 3, 2, 5, 1);
    broken("&&\n01x\n01081\n!!\n", not_an_item, 3, 2, 3, 1);
    broken("&&\n01a81\n01081\n!!\n", not_an_item, 3, 2, 5, 1);
    broken("&&\n0100\n!!\n", not_an_item, 3, 2, 4, 1);
    broken("&&\n0108" + std::string(20, '1') + "\n01081\n!!\n", long_line, 3, 2, 24, 1, small);
    const std::string item = "0108" + std::string(10, '1') + "\n";
    broken("&&\n" + item + item + item + item + "!!\n" + good, many_items, 0, 1, 2, 1,
           {.line = 16, .frame = 999, .items = 3});
    broken("&&\n" + item + item + item + item + item + "!!\n" + good, long_frame, 0, 1, 2, 1,
           {.line = 16, .frame = 64, .items = 9});
    broken("&&\n" + std::string(90, 'x') + "\n!!\n" + good, long_frame, 0, 1, 2, 1, small);
    broken(good + "&&\n01082\n", cut_off, 12, 4, 2, 1);
    broken(std::string(50, 'x') + "\n" + good, stray_text, 0, 1, 16, 1, small);  // reported up to the limit

    CHECK(read("&&\n01081\n!!&&\n01082\n!!").frames.size() == 2);  // a missing line end, and a missing last one
    const wits::Batch joined = read("&&\n01081\n!!&&\n01082\n!!\n");
    CHECK(joined.frames.size() == 2 && joined.frames[0].stop == 11 && joined.frames[1].start == 11);
    const wits::Batch both = read("!!&&\n01082\n!!\r");
    CHECK(both.frames.size() == 1 && both.events.size() == 1 && both.events[0].rule == stray_end);
    CHECK(read("\n\r\n\n").events.empty());
    CHECK(read("x\n&&\n!!\ny\n").events.size() == 2);  // one for each run of text
}

// A stream that ended does not reach into the next one.
void a_new_stream() {
    wits::Parser parser;
    parser.feed("&&\n01081\n0109");
    CHECK(parser.finish().events.size() == 1);
    const wits::Batch batch = parser.feed("&&\n01082\n!!\n");
    CHECK(batch.frames.size() == 1 && batch.items.size() == 1 && batch.items[0].value == 2.0 && batch.base == 13);
    CHECK(parser.finish().events.empty() && parser.counts().frames == 1);
}

// A parser that takes over the state of another at any byte goes on with the same frames.
void states() {
    const std::string stream = "stray\n&&\r\n01081.5\r\n0109x\r\n0110-9999\r\n!!\r\n" + std::string(40, 'x') +
                               "\n!!&&\n01082\n" + std::string(90, '1') + "\n!!\n&&\n01083\n0109";
    for (const wits::Limits& limits : {wits::Limits{}, small}) {
        wits::Parser one({}, limits);
        for (std::size_t at = 0; at < stream.size(); ++at) {
            one.feed(stream.substr(at, 1));
            wits::Parser same_state({}, limits), other({}, limits);
            other.feed(stream);  // whatever it held before
            other.restore(one.state());
            same_state.restore(one.state());
            CHECK(other.state() == one.state());
            const wits::Batch rest = other.feed(stream.substr(at + 1));
            CHECK(same(rest.items, same_state.feed(stream.substr(at + 1)).items));
            CHECK(other.counts().frames == (limits.items == 3 ? 1 : 2) && other.finish().events.size() == 1);
        }
    }
}

// Whatever bytes: refused, or a parser that can go on.
void broken_states() {
    wits::Parser parser;
    parser.feed("&&\n01081.5\n0109x\n011");
    const std::string good = parser.state();
    const char* text = "state: is not the state of a parser";
    CHECK_THROWS(InputError, text, parser.restore(""));
    CHECK_THROWS(InputError, text, parser.restore(std::string_view(good).substr(1)));
    CHECK_THROWS(InputError, text, parser.restore(good + "x"));
    int refused = 0;
    for (std::size_t at = 0; at < good.size(); ++at)
        for (const char flip : {'\x01', '\x40', '\x80', '\xff'}) {
            std::string bad = good;
            bad[at] = static_cast<char>(bad[at] ^ flip);
            wits::Parser other;
            try {
                other.restore(bad);
            } catch (const InputError&) {
                ++refused;
                continue;
            }
            const wits::Batch batch = other.feed("011\n!!\n&&\n01083\n!!\n");
            for (const wits::Item& item : batch.items)
                CHECK(item.offset >= batch.base &&
                      item.offset + item.length <= batch.base + static_cast<Index>(batch.text.size()));
            other.finish();
        }
    CHECK(refused > 500 && parser.state() == good);
}

void refusals() {
    const double infinity = std::numeric_limits<double>::infinity();
    CHECK_THROWS(InputError, "nulls[1] = nan: must be finite", wits::Parser({1.0, nan}));
    CHECK_THROWS(InputError, "nulls[0] = inf: must be finite", wits::Parser({infinity}));
    CHECK_THROWS(InputError, "line_limit = 15: must be from 16 to 1073741824", wits::Parser({}, {.line = 15}));
    CHECK_THROWS(InputError, "frame_limit = 1073741825: must be from 16 to 1073741824",
                 wits::Parser({}, {.frame = 1073741825}));
    CHECK_THROWS(InputError, "item_limit = 0: must be from 1 to 1073741824", wits::Parser({}, {.items = 0}));
}

}  // namespace

int main() {
    a_frame();
    numbers();
    rules();
    a_new_stream();
    states();
    broken_states();
    in_every_host_state(refusals);
    return failures();
}
