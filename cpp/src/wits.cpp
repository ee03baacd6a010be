// The frame machine: outside -> "&&" -> inside -> "!!" -> outside; a frame over a limit is `dropped` up to the next
// delimiter. A line is judged when its end is read, or when it is already too long to be anything good: both
// judgements are the same, which is what makes the frames and events independent of the chunks.
#include "helibore/wits.hpp"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <limits>

#include "helibore/error.hpp"

namespace helibore::wits {

namespace {

constexpr std::size_t longest_delimiter = 5;  // "!!&&" and a carriage return

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

// Digits with at most one point, 15 digits at most: numerator and power of ten are both exact doubles, so their
// quotient is the correctly rounded value, the same bits as from_chars gives. NaN for any other text.
double short_number(const char* first, const char* last) {
    const bool negative = *first == '-';
    const char* p = first + negative;
    if (last - p > 16) return nan;
    std::uint64_t numerator = 0;
    const char* point = nullptr;
    const char* begin = p;
    for (; p != last; ++p) {
        const unsigned digit = static_cast<unsigned>(static_cast<unsigned char>(*p)) - '0';
        if (digit <= 9)
            numerator = 10 * numerator + digit;
        else if (*p == '.' && point == nullptr)
            point = p;
        else
            return nan;
    }
    const std::ptrdiff_t digits = last - begin - (point != nullptr);
    if (digits < 1 || digits > 15) return nan;
    double value = static_cast<double>(numerator);
    if (point != nullptr) value /= power_of_ten[last - point - 1];
    return negative ? -value : value;
}

// Strict decimal number: from_chars without its "inf" and "nan", with an optional '+'. NaN when the text is not one.
double strict_number(const char* first, const char* last) {
    const double quick = short_number(first, last);
    if (!std::isnan(quick)) return quick;
    const char* digits = first + (*first == '+' || *first == '-');
    if (digits == last || ((*digits < '0' || *digits > '9') && *digits != '.')) return nan;
    double value = 0;
    const auto [end, error] = std::from_chars(*first == '+' ? digits : first, last, value);
    return error == std::errc() && end == last ? value : nan;
}

}  // namespace

Parser::Parser(std::vector<double> nulls, Limits limits) : nulls_(std::move(nulls)), limits_(limits) {
    for (std::size_t i = 0; i < nulls_.size(); ++i)
        if (!std::isfinite(nulls_[i]))
            throw InputError("nulls[" + std::to_string(i) + "] = " + (std::isnan(nulls_[i]) ? "nan" : "inf") +
                             ": must be finite");
    const auto check = [](const char* name, Index value, Index least) {
        if (value < least || value > (Index{1} << 30))
            throw InputError(std::string(name) + " = " + std::to_string(value) + ": must be from " +
                             std::to_string(least) + " to 1073741824");
    };
    check("line_limit", limits_.line, 16);
    check("frame_limit", limits_.frame, 16);
    check("item_limit", limits_.items, 1);
}

Batch Parser::feed(std::string_view bytes) {
    const std::lock_guard guard(lock_);
    Batch batch;
    held_.append(bytes);
    counts_.bytes += as_index(bytes.size());
    batch.items.reserve(std::min<std::size_t>(bytes.size() / 16, 65536));
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
    hand_over(batch);
    return batch;
}

Batch Parser::finish() {
    const std::lock_guard guard(lock_);
    Batch batch;
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
    hand_over(batch);
    skipping_line_ = in_stray_run_ = false;
    return batch;
}

Counts Parser::counts() const {
    const std::lock_guard guard(lock_);
    return counts_;
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
    if (as_index(line.size()) > limits_.line) return tell(Rule::long_line, offset, counts_.lines, line.size(), batch);
    if (!line.empty()) take_item(line, offset, batch);
}

void Parser::take_item(std::string_view line, Index offset, Batch& batch) {
    const std::uint16_t code = code_of(line);
    if (code == 0) return tell(Rule::not_an_item, offset, counts_.lines, line.size(), batch);
    Item item = number(line.substr(4));
    item.frame = counts_.frames;
    item.offset = offset + 4;
    item.length = static_cast<std::int32_t>(line.size() - 4);
    item.code = code;
    open_items_.push_back(item);
}

Item Parser::number(std::string_view text) const {
    Item item;
    const char* first = text.data();
    const char* last = first + text.size();
    while (first != last && *first == ' ') ++first;
    while (first != last && last[-1] == ' ') --last;
    item.value = nan;
    if (first == last) {
        item.flags = null_value;
        return item;
    }
    const double value = strict_number(first, last);
    if (std::isnan(value)) {
        item.flags = not_a_number;
        return item;
    }
    for (const double null : nulls_)
        if (value == null) {
            item.flags = null_value;
            return item;
        }
    item.value = value;
    return item;
}

void Parser::begin_frame(std::size_t start, std::size_t next, Batch& batch) {
    if (place_ == Place::inside) drop_frame(Rule::unclosed, batch);
    place_ = Place::inside;
    in_stray_run_ = false;
    frame_start_ = start;
    body_start_ = next;
    frame_line_ = counts_.lines;
    frame_lines_ = 0;
    open_items_.clear();
}

void Parser::end_frame(std::size_t next, Batch& batch) {
    if (place_ == Place::outside)
        return tell(Rule::stray_end, held_base_ + as_index(line_start_), counts_.lines, 2, batch);
    if (place_ == Place::inside) {
        batch.frames.push_back({held_base_ + as_index(frame_start_), held_base_ + as_index(next),
                                as_index(batch.items.size()), as_index(open_items_.size())});
        batch.items.insert(batch.items.end(), open_items_.begin(), open_items_.end());
        for (const Item& item : open_items_) {
            counts_.nulls += (item.flags & null_value) != 0;
            counts_.not_numbers += (item.flags & not_a_number) != 0;
        }
        counts_.items += as_index(open_items_.size());
        ++counts_.frames;
    }
    place_ = Place::outside;
}

void Parser::drop_frame(Rule rule, Batch& batch) {
    tell(rule, held_base_ + as_index(frame_start_), frame_line_, 2, batch);
    place_ = Place::dropped;
    open_items_.clear();
}

// The line whose end has not come: nothing to do unless it is already too long. Within a frame it stays until the
// frame is too long; elsewhere its bytes are let go.
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

// Everything before the open frame, or before the line being read, goes out with the batch.
void Parser::hand_over(Batch& batch) {
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
    tell(Rule::stray_text, held_base_ + as_index(start), line, std::min(length, static_cast<std::size_t>(limits_.line)),
         batch);
}

void Parser::tell(Rule rule, Index offset, Index line, std::size_t length, Batch& batch) {
    ++counts_.events[static_cast<std::size_t>(rule)];
    batch.events.push_back({offset, line, static_cast<std::int32_t>(length), rule, 0});
}

}  // namespace helibore::wits
