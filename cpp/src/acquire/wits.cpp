// The states of the parser: outside -> "&&" -> inside -> "!!" -> outside; after a frame over a limit, `dropped` until
// the next delimiter. A line is examined when its end is read, or as soon as it is too long. Both give the same result,
// so frames and events do not depend on how the stream is cut into chunks.
#include "helibore/wits.hpp"

#include <algorithm>
#include <bit>
#include <charconv>
#include <cmath>
#include <cstring>
#include <limits>
#include <span>

#include "base/arithmetic.hpp"
#include "helibore/error.hpp"

namespace helibore::wits {

namespace {

constexpr std::size_t longest_delimiter = 5;     // "!!&&" and a carriage return
constexpr Index code_length = 4;                 // RRII
constexpr Index largest_count = Index{1} << 62;  // of bytes: sums do not overflow

Index as_index(std::size_t n) {
    return static_cast<Index>(n);
}

// RRII as 100 RR + II, or 0.
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

// Eight bytes, one digit each, the first in the lowest byte: pairs, then fours, then all. -1 where one is no digit.
std::int64_t eight_digits(std::uint64_t word) {
    if (((word & 0xF0F0F0F0F0F0F0F0) | (((word + 0x0606060606060606) & 0xF0F0F0F0F0F0F0F0) >> 4)) != 0x3333333333333333)
        return -1;
    word = (word & 0x0F0F0F0F0F0F0F0F) * 2561 >> 8;
    word = (word & 0x00FF00FF00FF00FF) * 6553601 >> 16;
    return static_cast<std::int64_t>((word & 0x0000FFFF0000FFFF) * 42949672960001 >> 32);
}

// 1 to 8 digits with at most one point, all at once, in a word; NaN for any other text. The eight bytes before `last`
// must be readable, as they are within a frame: "&&", a line end and an item code come before every value.
//
//     |x|x|1|2|3|.|4|5|   ->   |0|0|0|1|2|3|4|5|   and two decimals
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

// Strict decimal number: from_chars without its "inf" and "nan", with an optional '+'. NaN when the text is not one.
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

// The value and flags of an item's text.
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

}  // namespace

Parser::Parser(std::vector<double> nulls, Limits limits) : nulls_(std::move(nulls)), limits_(limits) {
    const StandardArithmetic standard;
    for (std::size_t i = 0; i < nulls_.size(); ++i)
        if (!std::isfinite(nulls_[i]))
            throw InputError("nulls[" + std::to_string(i) + "]", "must be finite",
                             std::isnan(nulls_[i]) ? "nan" : "inf");
    const auto check = [](const char* name, Index value, Index least) {
        if (value < least || value > (Index{1} << 30))
            throw InputError(name, "must be from " + std::to_string(least) + " to 1073741824", std::to_string(value));
    };
    check("line_limit", limits_.line, 16);
    check("frame_limit", limits_.frame, 16);
    check("item_limit", limits_.items, 1);
}

Batch Parser::feed(std::string_view bytes) {
    const StandardArithmetic standard;
    const std::lock_guard guard(lock_);
    try {
        return take(bytes);
    } catch (...) {  // no memory
        lose_frame();
        throw;
    }
}

// Drops the open frame and the rest of its line: parsing continues at the next "&&".
void Parser::lose_frame() {
    if (place_ == Place::inside) place_ = Place::dropped;
    open_items_.clear();
    frame_first_ = 0;
    line_start_ = searched_ = held_.size();
    skipping_line_ = true;
}

Batch Parser::take(std::string_view bytes) {
    Batch batch;
    held_.append(bytes);
    counts_.bytes += as_index(bytes.size());
    batch.items = std::move(open_items_);
    if (batch.items.empty()) batch.items.reserve(std::min<std::size_t>(bytes.size() / 12, 65536));
    for (;;) {
        const std::size_t end = held_.find('\n', searched_);
        if (end == std::string::npos) break;
        const std::size_t stop = end > line_start_ && held_[end - 1] == '\r' ? end - 1 : end;
        ++counts_.lines;
        if (!skipping_line_) take_line(line_start_, stop, end + 1, batch);
        skipping_line_ = false;
        line_start_ = searched_ = end + 1;
    }
    searched_ = held_.size();
    take_unended_line(batch);
    release_text(batch);
    return batch;
}

Batch Parser::finish() {
    const std::lock_guard guard(lock_);
    Batch batch;
    batch.items = std::move(open_items_);
    std::string_view last = std::string_view(held_).substr(line_start_);
    if (last.ends_with('\r')) last.remove_suffix(1);
    counts_.lines += !last.empty();
    if (place_ == Place::inside && last == "!!")
        end_frame(held_.size(), batch);
    else if (place_ == Place::inside)
        drop_frame(Rule::cut_off, batch);
    else if (place_ == Place::outside && !last.empty())
        stray(line_start_, last.size(), counts_.lines, batch);
    place_ = Place::outside;
    line_start_ = searched_ = held_.size();
    release_text(batch);
    skipping_line_ = in_stray_run_ = false;
    return batch;
}

Counts Parser::counts() const {
    const std::lock_guard guard(lock_);
    return counts_;
}

// Followed by the held text and the items of the open frame. Between two calls nothing else differs from a new parser.
struct Parser::State {
    Counts counts;
    Index held_base, held, line_start, body_start, frame_line, frame_lines, items;
    std::int32_t place;
    std::int16_t skipping_line, in_stray_run;
};

std::string Parser::state() const {
    const std::lock_guard guard(lock_);
    const State state{counts_,
                      held_base_,
                      as_index(held_.size()),
                      as_index(line_start_),
                      as_index(body_start_),
                      frame_line_,
                      frame_lines_,
                      as_index(open_items_.size()),
                      static_cast<std::int32_t>(place_),
                      skipping_line_,
                      in_stray_run_};
    std::string bytes(reinterpret_cast<const char*>(&state), sizeof state);
    bytes += held_;
    bytes.append(reinterpret_cast<const char*>(open_items_.data()), open_items_.size() * sizeof(Item));
    return bytes;
}

void Parser::restore(std::string_view bytes) {
    const StandardArithmetic standard;
    State state{};
    const auto require = [](bool good) {
        if (!good) throw InputError("state", "is not the state of a parser");
    };
    require(bytes.size() >= sizeof state);
    std::memcpy(&state, bytes.data(), sizeof state);
    bytes.remove_prefix(sizeof state);
    const Index size = as_index(bytes.size());
    const auto within = [](Index value, Index most) { return value >= 0 && value <= most; };
    const Counts& counts = state.counts;
    require(within(state.held, size) && within(state.items, size / as_index(sizeof(Item))));
    require(size == state.held + state.items * as_index(sizeof(Item)));
    require(within(counts.bytes, largest_count) && state.held_base == counts.bytes - state.held);
    for (const Index count : {state.held_base, counts.lines, counts.frames, counts.items, counts.nulls,
                              counts.not_numbers, counts.stray_lines, state.frame_line, state.frame_lines})
        require(within(count, counts.bytes));
    for (const Index count : counts.events) require(within(count, counts.bytes));
    require(within(state.line_start, state.held) && within(state.body_start, state.held));
    require(within(state.place, static_cast<Index>(Place::dropped)));
    const std::string_view held = bytes.substr(0, static_cast<std::size_t>(state.held));
    if (static_cast<Place>(state.place) == Place::inside) {  // the text of the frame, whose line ends were read
        require(held.starts_with("&&\n") ? state.body_start == 3 : held.starts_with("&&\r\n") && state.body_start == 4);
        require(state.line_start >= state.body_start && held[static_cast<std::size_t>(state.line_start) - 1] == '\n');
    } else {
        require(state.items == 0);
    }
    std::vector<Item> items(static_cast<std::size_t>(state.items));
    if (!items.empty()) std::memcpy(items.data(), bytes.data() + state.held, items.size() * sizeof(Item));
    for (const Item& item : items) {
        const Index start = state.held_base + state.body_start + code_length, stop = state.held_base + state.line_start;
        require(item.offset >= start && item.offset <= stop && within(item.length, stop - item.offset));
        require(item.frame == counts.frames && item.code >= 101 && item.code <= 9999);
        require(item.flags == 0 ? std::isfinite(item.value) : item.flags <= not_a_number && std::isnan(item.value));
    }
    const std::lock_guard guard(lock_);
    held_.assign(held);
    open_items_ = std::move(items);
    counts_ = state.counts;
    held_base_ = state.held_base;
    line_start_ = static_cast<std::size_t>(state.line_start);
    body_start_ = static_cast<std::size_t>(state.body_start);
    searched_ = held_.size();
    frame_start_ = frame_first_ = 0;
    frame_line_ = state.frame_line;
    frame_lines_ = state.frame_lines;
    place_ = static_cast<Place>(state.place);
    skipping_line_ = state.skipping_line != 0;
    in_stray_run_ = state.in_stray_run != 0;
}

void Parser::take_line(std::size_t start, std::size_t stop, std::size_t next, Batch& batch) {
    const std::string_view line(held_.data() + start, stop - start);
    if (!line.empty() && (line[0] == '&' || line[0] == '!')) {
        if (line == "&&") return begin_frame(start, next, batch);
        if (line == "!!") return end_frame(next, batch);
        if (line == "!!&&") {  // a sender that forgets the line end after a frame
            end_frame(start + 2, batch);
            return begin_frame(start + 2, next, batch);
        }
    }
    if (place_ == Place::dropped) return;
    if (place_ == Place::outside) return line.empty() ? void() : stray(start, line.size(), counts_.lines, batch);
    if (as_index(next - 1 - body_start_) > limits_.frame) return drop_frame(Rule::long_frame, batch);
    if (++frame_lines_ > limits_.items) return drop_frame(Rule::many_items, batch);
    const Index offset = held_base_ + as_index(start);
    if (as_index(line.size()) > limits_.line) return report(Rule::long_line, offset, counts_.lines, line.size(), batch);
    if (!line.empty()) take_item(line, offset, batch);
}

void Parser::take_item(std::string_view line, Index offset, Batch& batch) {
    const std::uint16_t code = code_of(line);
    if (code == 0) return report(Rule::not_an_item, offset, counts_.lines, line.size(), batch);
    Item& item = batch.items.emplace_back();
    item.frame = counts_.frames;
    item.offset = offset + 4;
    item.length = static_cast<std::int32_t>(line.size() - 4);
    item.code = code;
    read_value(line.substr(4), nulls_, item);
}

void Parser::begin_frame(std::size_t start, std::size_t next, Batch& batch) {
    if (place_ == Place::inside) drop_frame(Rule::unclosed, batch);
    place_ = Place::inside;
    in_stray_run_ = false;
    frame_start_ = start;
    body_start_ = next;
    frame_line_ = counts_.lines;
    frame_lines_ = 0;
    frame_first_ = batch.items.size();
}

void Parser::end_frame(std::size_t next, Batch& batch) {
    if (place_ == Place::outside)
        return report(Rule::stray_end, held_base_ + as_index(line_start_), counts_.lines, 2, batch);
    if (place_ == Place::inside) {
        const std::span items = std::span(batch.items).subspan(frame_first_);
        batch.frames.push_back({held_base_ + as_index(frame_start_), held_base_ + as_index(next),
                                as_index(frame_first_), as_index(items.size()), frame_line_});
        for (const Item& item : items) {
            counts_.nulls += (item.flags & null_value) != 0;
            counts_.not_numbers += (item.flags & not_a_number) != 0;
        }
        counts_.items += as_index(items.size());
        ++counts_.frames;
    }
    place_ = Place::outside;
}

void Parser::drop_frame(Rule rule, Batch& batch) {
    report(rule, held_base_ + as_index(frame_start_), frame_line_, 2, batch);
    place_ = Place::dropped;
    batch.items.resize(frame_first_);
}

// Checks a line whose end has not arrived. Within a frame its bytes are kept until the frame is too long; elsewhere
// they are dropped when the line is too long.
void Parser::take_unended_line(Batch& batch) {
    const std::size_t length = held_.size() - line_start_;
    if (skipping_line_ || length <= longest_delimiter) return;
    if (place_ == Place::inside) {
        if (as_index(held_.size() - body_start_) <= limits_.frame) return;
        drop_frame(Rule::long_frame, batch);
    } else {
        if (as_index(length) <= limits_.line + 1) return;
        if (place_ == Place::outside) stray(line_start_, length, counts_.lines + 1, batch);
    }
    skipping_line_ = true;
}

// Moves the text before the open frame, or before the line being read, into the batch. If there is only an open frame,
// its memory is kept, so that work stays linear in one-byte chunks.
void Parser::release_text(Batch& batch) {
    open_items_.clear();
    if (place_ == Place::inside && frame_first_ == 0) {
        open_items_.swap(batch.items);
    } else if (place_ == Place::inside) {
        open_items_.assign(batch.items.begin() + as_index(frame_first_), batch.items.end());
        batch.items.resize(frame_first_);
    }
    frame_first_ = 0;
    const std::size_t keep = place_ == Place::inside ? frame_start_ : skipping_line_ ? held_.size() : line_start_;
    batch.base = held_base_;
    if (keep == 0) return;
    std::string rest = held_.substr(keep);
    held_.resize(keep);
    batch.text = std::move(held_);
    held_ = std::move(rest);
    held_base_ += as_index(keep);
    line_start_ -= std::min(keep, line_start_);
    searched_ -= keep;
    frame_start_ -= std::min(keep, frame_start_);
    body_start_ -= std::min(keep, body_start_);
}

void Parser::stray(std::size_t start, std::size_t length, Index line, Batch& batch) {
    ++counts_.stray_lines;
    if (in_stray_run_) return;
    in_stray_run_ = true;
    report(Rule::stray_text, held_base_ + as_index(start), line,
           std::min(length, static_cast<std::size_t>(limits_.line)), batch);
}

void Parser::report(Rule rule, Index offset, Index line, std::size_t length, Batch& batch) {
    ++counts_.events[static_cast<std::size_t>(rule)];
    batch.events.push_back({offset, line, static_cast<std::int32_t>(length), rule, 0});
}

}  // namespace helibore::wits
