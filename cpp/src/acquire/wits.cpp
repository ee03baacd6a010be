// The states of the parser: outside -> "&&" -> inside -> "!!" -> outside; after a frame that exceeds a limit, the state
// is `dropped` until the next delimiter. A line is examined when its end is read, or as soon as it is too long. Both
// give the same result, so frames and events do not depend on how the stream is cut into chunks. `Limits`, in wits.hpp,
// has the numbers.
#include "helibore/wits.hpp"

#include <algorithm>
#include <bit>
#include <charconv>
#include <cmath>
#include <cstring>
#include <limits>
#include <span>
#include <utility>

#include "base/arithmetic.hpp"
#include "base/locks.hpp"
#include "helibore/error.hpp"

namespace helibore::wits {

namespace {

constexpr std::size_t longest_delimiter = 5;     // "!!&&" and a carriage return
constexpr Index code_length = 4;                 // RRII
constexpr Index largest_count = Index{1} << 62;  // of bytes: sums do not overflow

Index as_index(std::size_t n) {
    return static_cast<Index>(n);
}

// Returns whether a byte at the start or the end of a line means nothing: a blank, a carriage return, NUL, or
// the STX and ETX of a serial line.
bool is_padding(char byte) {
    return byte == ' ' || byte == '\r' || (byte >= '\0' && byte <= '\3' && byte != '\1');
}

// Returns the code RRII at the start of a line as 100 RR + II, or 0 if the line does not start with a code.
std::uint16_t code_of(std::string_view line) {
    if (line.size() < 4) return 0;
    unsigned digit[4];
    for (std::size_t i = 0; i < 4; ++i) {
        digit[i] = static_cast<unsigned>(static_cast<unsigned char>(line[i])) - '0';
        if (digit[i] > 9) return 0;
    }
    const unsigned record = 10 * digit[0] + digit[1];
    const unsigned item = 10 * digit[2] + digit[3];
    return record == 0 || item == 0 ? std::uint16_t{0} : static_cast<std::uint16_t>(100 * record + item);
}

constexpr double nan = std::numeric_limits<double>::quiet_NaN();
constexpr double power_of_ten[] = {1e0, 1e1, 1e2,  1e3,  1e4,  1e5,  1e6,  1e7,
                                   1e8, 1e9, 1e10, 1e11, 1e12, 1e13, 1e14, 1e15};

// Returns the number that eight digits make, or -1 if a byte is no digit. Each byte of `word` is a digit, the first
// digit in the lowest byte. The digits are joined to pairs, then to fours, then to eight.
std::int64_t eight_digits(std::uint64_t word) {
    if (((word & 0xF0F0F0F0F0F0F0F0) | (((word + 0x0606060606060606) & 0xF0F0F0F0F0F0F0F0) >> 4)) != 0x3333333333333333)
        return -1;
    word = (word & 0x0F0F0F0F0F0F0F0F) * 2561 >> 8;
    word = (word & 0x00FF00FF00FF00FF) * 6553601 >> 16;
    return static_cast<std::int64_t>((word & 0x0000FFFF0000FFFF) * 42949672960001 >> 32);
}

// Returns the number that a text of 1 to 8 bytes makes if it consists of digits and at most one point; NaN for any
// other text. All bytes are read at once, in a word. The eight bytes before `last` must be readable. Within a frame
// they are: "&&", a line end and an item code come before every value.
//
//     |x|x|1|2|3|.|4|5|   ->   |0|0|0|1|2|3|4|5|   and two decimals; x: any byte
double word_number(const char* first, const char* last) {
    std::uint64_t word;
    std::memcpy(&word, last - 8, 8);
    const std::uint64_t absent = ~std::uint64_t{0} >> (8 * (last - first) - 1) >> 1;  // the bytes before `first`
    word = (word & ~absent) | (0x3030303030303030 & absent);
    const std::uint64_t unequal = word ^ 0x2E2E2E2E2E2E2E2E;
    const std::uint64_t points = (unequal - 0x0101010101010101) & ~unequal & 0x8080808080808080;
    if (points == 0) {
        const std::int64_t whole = eight_digits(word);
        return whole < 0 ? nan : static_cast<double>(whole);
    }
    const int below = std::countr_zero(points) - 7;  // bits before the first point
    const std::uint64_t before = (std::uint64_t{1} << below) - 1;
    const std::uint64_t after = ~before << 7 << 1;
    const std::int64_t numerator = eight_digits((word & after) | ((word & before) << 8) | '0');
    if (numerator < 0 || last - first == 1) return nan;
    return static_cast<double>(numerator) / power_of_ten[7 - below / 8];
}

// Returns the decimal number that a text makes; NaN for other texts. It reads what std::from_chars reads, but also a
// leading '+', and not "inf" and "nan".
double strict_number(const char* first, const char* last) {
    const bool negative = *first == '-';
    const std::ptrdiff_t length = last - first - negative;
    if (length >= 1 && length <= 8 && std::endian::native == std::endian::little) {
        const double quick = word_number(first + negative, last);
        if (!std::isnan(quick)) return negative ? -quick : quick;
    }
    const char* digits = first + (*first == '+' || *first == '-');
    if (digits == last || ((*digits < '0' || *digits > '9') && *digits != '.')) return nan;
    double value = 0;
    const auto [end, error] = std::from_chars(*first == '+' ? digits : first, last, value);
    return error == std::errc() && end == last ? value : nan;
}

// Sets the value and the flags of an item from its text.
void read_value(std::string_view text, std::span<const double> nulls, Item& item) {
    const char* first = text.data();
    const char* last = first + text.size();
    while (first != last && *first == ' ') ++first;
    while (first != last && last[-1] == ' ') --last;
    const double value = first == last ? nan : strict_number(first, last);
    bool null = first == last;
    for (const double one : nulls) null |= value == one;
    item.flags = null ? null_value : std::isnan(value) ? not_a_number : std::uint16_t{0};
    item.value = item.flags == 0 ? value : nan;
}

enum class Place { outside, inside, dropped };

// The state of the parser, except bytes and items.
struct Position {
    Counts counts;
    Index held_base = 0;         // stream offset of held[0]
    std::size_t line_start = 0;  // position in `held`
    std::size_t searched = 0;    // position in `held`; no line end lies between line_start and here
    bool skipping_line = false;  // the start of the line being read was dropped
    bool in_stray_run = false;   // this run of stray text was reported
    Place place = Place::outside;
    std::size_t frame_start = 0;  // position of "&&" in `held`
    std::size_t body_start = 0;   // position in `held` after the "&&" line
    Index frame_line = 0;
    Index frame_lines = 0;
    std::size_t frame_first = 0;  // its first item in the batch being made
    bool frame_is_open = false;   // the frame began before this call: open_items are its first items
};

}  // namespace

struct Parser::State {
    std::vector<double> nulls;
    Limits limits;
    std::mutex lock;
    std::string held;              // the stream from at.held_base on: an open frame, or the line being read
    std::vector<Item> open_items;  // of the open frame, read by earlier calls
    Position at;

    template <class Read>
    Batch whole_or_nothing(const Read& read);
    void take(std::string_view bytes, Batch& batch);
    void end(Batch& batch);
    std::pair<std::size_t, std::size_t> without_padding(std::size_t start, std::size_t stop) const;
    void take_line(std::size_t start, std::size_t stop, std::size_t next, Batch& batch);
    void take_item(std::string_view line, Index offset, Batch& batch);
    void begin_frame(std::size_t start, std::size_t next, Batch& batch);
    void end_frame(std::size_t next, Batch& batch);
    void drop_frame(Rule rule, Batch& batch);
    void take_unended_line(Batch& batch);
    void release(Batch& batch);
    void report(Rule rule, Index offset, Index line, std::size_t length, Batch& batch);
    void stray(std::size_t start, std::size_t length, Index line, Batch& batch);
};

Parser::Parser(std::vector<double> nulls, Limits limits)
    : state_(
          new State{.nulls = std::move(nulls), .limits = limits, .lock = {}, .held = {}, .open_items = {}, .at = {}}) {
    const StandardArithmetic standard;
    const std::vector<double>& given = state_->nulls;
    for (std::size_t i = 0; i < given.size(); ++i)
        if (!std::isfinite(given[i]))
            throw InputError("nulls[" + std::to_string(i) + "]", "must be finite",
                             std::isnan(given[i]) ? "nan" : "inf");
    const auto check = [](const char* name, Index value, Index least) {
        if (value < least || value > (Index{1} << 30))
            throw InputError(name, "must be from " + std::to_string(least) + " to 1073741824", std::to_string(value));
    };
    check("line_limit", limits.line, 16);
    check("frame_limit", limits.frame, 16);
    check("item_limit", limits.items, 1);
}
Parser::~Parser() = default;
Parser::Parser(Parser&&) noexcept = default;
Parser& Parser::operator=(Parser&&) noexcept = default;

Batch Parser::feed(std::string_view bytes) {
    const StandardArithmetic standard;
    const std::lock_guard guard(state_->lock);
    return state_->whole_or_nothing([&](Batch& batch) { state_->take(bytes, batch); });
}

Batch Parser::finish() {
    const std::lock_guard guard(state_->lock);
    Batch batch = state_->whole_or_nothing([&](Batch& made) { state_->end(made); });
    state_->at.skipping_line = state_->at.in_stray_run = false;
    return batch;
}

// If memory runs out, the parser returns to its state before the call: until `release`, held only grows and open_items
// does not change.
template <class Read>
Batch Parser::State::whole_or_nothing(const Read& read) {
    const Position before = at;
    const std::size_t had = held.size();
    try {
        Batch batch;
        at.frame_first = 0;
        at.frame_is_open = at.place == Place::inside;
        read(batch);
        release(batch);
        return batch;
    } catch (...) {
        held.resize(had);
        at = before;
        throw;
    }
}

void Parser::State::take(std::string_view bytes, Batch& batch) {
    held.append(bytes);
    at.counts.bytes += as_index(bytes.size());
    batch.items.reserve(std::min<std::size_t>(bytes.size() / 12, 65536));
    for (;;) {
        const std::size_t end = held.find('\n', at.searched);
        if (end == std::string::npos) break;
        ++at.counts.lines;
        if (!at.skipping_line) {
            const auto [start, stop] = without_padding(at.line_start, end);
            take_line(start, stop, end + 1, batch);
        }
        at.skipping_line = false;
        at.line_start = at.searched = end + 1;
    }
    at.searched = held.size();
    take_unended_line(batch);
}

// Returns the ends of the text in [start, stop) of `held` without the padding that senders put around a line. A line
// that is too long keeps its padding: its start is dropped before its end is known.
std::pair<std::size_t, std::size_t> Parser::State::without_padding(std::size_t start, std::size_t stop) const {
    if (as_index(stop - start) > limits.line + 1) return {start, stop};
    while (start < stop && is_padding(held[start])) ++start;
    while (start < stop && is_padding(held[stop - 1])) --stop;
    return {start, stop};
}

void Parser::State::end(Batch& batch) {
    const auto [start, stop] = without_padding(at.line_start, held.size());
    const std::string_view last = std::string_view(held).substr(start, stop - start);
    at.counts.lines += !last.empty();
    if (at.place == Place::inside && last == "!!")
        end_frame(held.size(), batch);
    else if (at.place == Place::inside)
        drop_frame(Rule::cut_off, batch);
    else if (at.place == Place::outside && !last.empty())
        stray(start, last.size(), at.counts.lines, batch);
    at.place = Place::outside;
    at.line_start = at.searched = held.size();
}

Counts Parser::counts() const {
    const std::lock_guard guard(state_->lock);
    return state_->at.counts;
}

namespace {

// The start of what state() returns; the held text and the items of the open frame follow it. Between two calls, all
// other members are as in a new parser.
struct Saved {
    Counts counts;
    Index held_base, held, line_start, body_start, frame_line, frame_lines, items;
    std::int32_t place;
    std::int16_t skipping_line, in_stray_run;
};

}  // namespace

std::string Parser::state() const {
    const std::lock_guard guard(state_->lock);
    const auto& [nulls, limits, lock, held, open_items, at] = *state_;
    const Saved saved{at.counts,
                      at.held_base,
                      as_index(held.size()),
                      as_index(at.line_start),
                      as_index(at.body_start),
                      at.frame_line,
                      at.frame_lines,
                      as_index(open_items.size()),
                      static_cast<std::int32_t>(at.place),
                      at.skipping_line,
                      at.in_stray_run};
    std::string bytes(reinterpret_cast<const char*>(&saved), sizeof saved);
    bytes += held;
    bytes.append(reinterpret_cast<const char*>(open_items.data()), open_items.size() * sizeof(Item));
    return bytes;
}

void Parser::restore(std::string_view bytes) {
    const StandardArithmetic standard;
    Saved saved{};
    const auto require = [](bool good) {
        if (!good) throw InputError("state", "is not the state of a parser");
    };
    require(bytes.size() >= sizeof saved);
    std::memcpy(&saved, bytes.data(), sizeof saved);
    bytes.remove_prefix(sizeof saved);
    const Index size = as_index(bytes.size());
    const auto within = [](Index value, Index most) { return value >= 0 && value <= most; };
    const Counts& counts = saved.counts;
    require(within(saved.held, size) && within(saved.items, size / as_index(sizeof(Item))));
    require(size == saved.held + saved.items * as_index(sizeof(Item)));
    require(within(counts.bytes, largest_count) && saved.held_base == counts.bytes - saved.held);
    for (const Index count : {saved.held_base, counts.lines, counts.frames, counts.items, counts.nulls,
                              counts.not_numbers, counts.stray_lines, saved.frame_line, saved.frame_lines})
        require(within(count, counts.bytes));
    for (const Index count : counts.events) require(within(count, counts.bytes));
    require(within(saved.line_start, saved.held) && within(saved.body_start, saved.held));
    require(within(saved.place, static_cast<Index>(Place::dropped)));
    const std::string_view held = bytes.substr(0, static_cast<std::size_t>(saved.held));
    if (static_cast<Place>(saved.place) == Place::inside) {  // the text of the frame, whose line ends were read
        const std::size_t first = held.find('\n');
        require(held.starts_with("&&") && first != std::string_view::npos && saved.body_start == as_index(first) + 1);
        require(std::all_of(held.begin() + 2, held.begin() + as_index(first), is_padding));
        require(saved.line_start >= saved.body_start && held[static_cast<std::size_t>(saved.line_start) - 1] == '\n');
    } else {
        require(saved.items == 0);
    }
    std::vector<Item> items(static_cast<std::size_t>(saved.items));
    if (!items.empty()) std::memcpy(items.data(), bytes.data() + saved.held, items.size() * sizeof(Item));
    for (const Item& item : items) {
        const Index start = saved.held_base + saved.body_start + code_length, stop = saved.held_base + saved.line_start;
        require(item.offset >= start && item.offset <= stop && within(item.length, stop - item.offset));
        require(item.frame == counts.frames && item.code >= 101 && item.code <= 9999);
        require(item.flags == 0 ? std::isfinite(item.value) : item.flags <= not_a_number && std::isnan(item.value));
    }
    const std::lock_guard guard(state_->lock);
    state_->held.assign(held);
    state_->open_items = std::move(items);
    state_->at = {.counts = saved.counts,
                  .held_base = saved.held_base,
                  .line_start = static_cast<std::size_t>(saved.line_start),
                  .searched = held.size(),
                  .skipping_line = saved.skipping_line != 0,
                  .in_stray_run = saved.in_stray_run != 0,
                  .place = static_cast<Place>(saved.place),
                  .body_start = static_cast<std::size_t>(saved.body_start),
                  .frame_line = saved.frame_line,
                  .frame_lines = saved.frame_lines};
}

void Parser::State::take_line(std::size_t start, std::size_t stop, std::size_t next, Batch& batch) {
    const std::string_view line(held.data() + start, stop - start);
    if (!line.empty() && (line[0] == '&' || line[0] == '!')) {
        if (line == "&&") return begin_frame(start, next, batch);
        if (line == "!!") return end_frame(next, batch);
        if (line == "!!&&") {  // a sender that forgets the line end after a frame
            end_frame(start + 2, batch);
            return begin_frame(start + 2, next, batch);
        }
    }
    if (at.place == Place::dropped) return;
    if (at.place == Place::outside) return line.empty() ? void() : stray(start, line.size(), at.counts.lines, batch);
    if (as_index(next - 1 - at.body_start) > limits.frame) return drop_frame(Rule::long_frame, batch);
    if (++at.frame_lines > limits.items) return drop_frame(Rule::many_items, batch);
    const Index offset = at.held_base + as_index(start);
    if (as_index(line.size()) > limits.line)
        return report(Rule::long_line, offset, at.counts.lines, line.size(), batch);
    if (!line.empty()) take_item(line, offset, batch);
}

void Parser::State::take_item(std::string_view line, Index offset, Batch& batch) {
    const std::uint16_t code = code_of(line);
    if (code == 0) return report(Rule::not_an_item, offset, at.counts.lines, line.size(), batch);
    Item& item = batch.items.emplace_back();
    item.frame = at.counts.frames;
    item.offset = offset + 4;
    item.length = static_cast<std::int32_t>(line.size() - 4);
    item.code = code;
    read_value(line.substr(4), nulls, item);
}

void Parser::State::begin_frame(std::size_t start, std::size_t next, Batch& batch) {
    if (at.place == Place::inside) drop_frame(Rule::unclosed, batch);
    at.place = Place::inside;
    at.in_stray_run = false;
    at.frame_start = start;
    at.body_start = next;
    at.frame_line = at.counts.lines;
    at.frame_lines = 0;
    at.frame_first = batch.items.size();
    at.frame_is_open = false;
}

void Parser::State::end_frame(std::size_t next, Batch& batch) {
    if (at.place == Place::outside)
        return report(Rule::stray_end, at.held_base + as_index(at.line_start), at.counts.lines, 2, batch);
    if (at.place == Place::inside) {
        if (at.frame_is_open) batch.items.insert(batch.items.begin(), open_items.begin(), open_items.end());
        const std::span items = std::span(batch.items).subspan(at.frame_first);
        batch.frames.push_back({at.held_base + as_index(at.frame_start), at.held_base + as_index(next),
                                as_index(at.frame_first), as_index(items.size()), at.frame_line});
        for (const Item& item : items) {
            at.counts.nulls += (item.flags & null_value) != 0;
            at.counts.not_numbers += (item.flags & not_a_number) != 0;
        }
        at.counts.items += as_index(items.size());
        ++at.counts.frames;
    }
    at.place = Place::outside;
}

void Parser::State::drop_frame(Rule rule, Batch& batch) {
    report(rule, at.held_base + as_index(at.frame_start), at.frame_line, 2, batch);
    at.place = Place::dropped;
    batch.items.resize(at.frame_first);
}

// Checks a line whose end has not arrived. Within a frame its bytes are kept until the frame is too long; elsewhere
// they are dropped when the line is too long.
void Parser::State::take_unended_line(Batch& batch) {
    const std::size_t length = held.size() - at.line_start;
    if (at.skipping_line || length <= longest_delimiter) return;
    if (at.place == Place::inside) {
        if (as_index(held.size() - at.body_start) <= limits.frame) return;
        drop_frame(Rule::long_frame, batch);
    } else {
        if (as_index(length) <= limits.line + 1) return;
        if (at.place == Place::outside) stray(at.line_start, length, at.counts.lines + 1, batch);
    }
    at.skipping_line = true;
}

// Moves the text before the open frame, or before the line being read, into the batch, and the items of the open frame
// out of the batch. The steps that can fail come first.
void Parser::State::release(Batch& batch) {
    const std::size_t keep = at.place == Place::inside ? at.frame_start
                             : at.skipping_line        ? held.size()
                                                       : at.line_start;
    batch.base = at.held_base;
    std::string rest;
    if (keep > 0) rest = held.substr(keep);
    if (at.place == Place::inside) {
        const auto first = batch.items.begin() + as_index(at.frame_first);
        if (at.frame_is_open)
            open_items.insert(open_items.end(), first, batch.items.end());
        else
            open_items.assign(first, batch.items.end());
        batch.items.erase(first, batch.items.end());
    } else {
        open_items.clear();
    }
    if (keep == 0) return;
    held.resize(keep);
    batch.text = std::move(held);
    held = std::move(rest);
    at.held_base += as_index(keep);
    at.line_start -= std::min(keep, at.line_start);
    at.searched -= keep;
    at.frame_start -= std::min(keep, at.frame_start);
    at.body_start -= std::min(keep, at.body_start);
}

void Parser::State::stray(std::size_t start, std::size_t length, Index line, Batch& batch) {
    ++at.counts.stray_lines;
    if (at.in_stray_run) return;
    at.in_stray_run = true;
    report(Rule::stray_text, at.held_base + as_index(start), line,
           std::min(length, static_cast<std::size_t>(limits.line)), batch);
}

void Parser::State::report(Rule rule, Index offset, Index line, std::size_t length, Batch& batch) {
    ++at.counts.events[static_cast<std::size_t>(rule)];
    batch.events.push_back({offset, line, static_cast<std::int32_t>(length), rule, 0});
}

}  // namespace helibore::wits
