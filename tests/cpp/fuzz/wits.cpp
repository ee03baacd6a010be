// The WITS parser: however a stream is cut, the same frames, items and events; memory for one frame and one line; and
// values as a slow reader of the grammar finds them.
#include "helibore/wits.hpp"

#include <algorithm>
#include <charconv>
#include <cmath>

#include "input.hpp"

namespace wits = helibore::wits;
using helibore::Index;

namespace {

struct Read {
    std::vector<wits::Item> items;
    std::vector<wits::Frame> frames;
    std::vector<wits::Event> events;
    std::string text;

    void add(wits::Batch&& batch) {
        for (wits::Frame frame : batch.frames) {
            frame.first += static_cast<Index>(items.size());
            frames.push_back(frame);
        }
        items.insert(items.end(), batch.items.begin(), batch.items.end());
        events.insert(events.end(), batch.events.begin(), batch.events.end());
        require_rule(batch.base == static_cast<Index>(text.size()), "text follows text");
        text += batch.text;
    }
};

constexpr double nulls[] = {-9999.0, -999.25};

// Feeds the text in chunks of 1 to `longest` bytes, or at once.
Read read(std::string_view text, std::size_t longest, const wits::Limits& limits) {
    wits::Parser parser({nulls[0], nulls[1]}, limits);
    Uniform uniform(7);
    Read all;
    for (std::size_t at = 0; at < text.size();) {
        const std::size_t chunk =
            longest == 0 ? text.size() : 1 + static_cast<std::size_t>(uniform() * static_cast<double>(longest));
        if (at % 5 == 4) {  // another parser goes on
            wits::Parser next({nulls[0], nulls[1]}, limits);
            next.restore(parser.state());
            all.add(next.feed(text.substr(at, chunk)));
            parser.restore(next.state());
        } else {
            all.add(parser.feed(text.substr(at, chunk)));
        }
        at = std::min(at + chunk, text.size());
        const auto held = static_cast<Index>(at) - static_cast<Index>(all.text.size());
        require_rule(held <= limits.frame + limits.line + 16, "the parser holds one frame and one line at most");
    }
    all.add(parser.finish());
    require_rule(text.substr(0, all.text.size()) == all.text, "text is the stream");
    const wits::Counts counts = parser.counts();
    require_rule(counts.bytes == static_cast<Index>(text.size()) &&
                     counts.frames == static_cast<Index>(all.frames.size()) &&
                     counts.items == static_cast<Index>(all.items.size()),
                 "counts");
    return all;
}

// The number of a trimmed text by the strict grammar, character by character.
double slow_number(std::string_view text) {
    std::size_t i = 0, digits = 0;
    const auto take_digits = [&] {
        for (; i < text.size() && text[i] >= '0' && text[i] <= '9'; ++i) ++digits;
    };
    if (i < text.size() && (text[i] == '+' || text[i] == '-')) ++i;
    take_digits();
    if (i < text.size() && text[i] == '.') ++i, take_digits();
    constexpr double none = std::numeric_limits<double>::quiet_NaN();
    if (digits == 0) return none;
    if (i < text.size() && (text[i] == 'e' || text[i] == 'E')) {
        ++i;
        if (i < text.size() && (text[i] == '+' || text[i] == '-')) ++i;
        digits = 0;
        take_digits();
        if (digits == 0) return none;
    }
    if (i < text.size()) return none;
    if (text[0] == '+') text.remove_prefix(1);
    double value = 0.0;
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
    return error == std::errc() && end == text.data() + text.size() ? value : none;
}

void require_values(const Read& all) {
    Index next = 0;
    for (const wits::Frame& frame : all.frames) {
        require_rule(frame.first == next && frame.start < frame.stop, "items belong to frames");
        next += frame.items;
    }
    require_rule(next == static_cast<Index>(all.items.size()), "all items belong to frames");
    for (const wits::Item& item : all.items) {
        std::string_view text(all.text);
        text = text.substr(static_cast<std::size_t>(item.offset), static_cast<std::size_t>(item.length));
        while (text.starts_with(' ')) text.remove_prefix(1);
        while (text.ends_with(' ')) text.remove_suffix(1);
        const double value = slow_number(text);
        const bool null = text.empty() || std::ranges::find(nulls, value) != std::end(nulls);
        require_rule((item.flags == wits::null_value) == null, "null values");
        require_rule((item.flags == wits::not_a_number) == (!null && std::isnan(value)), "texts");
        if (item.flags == 0)
            require_rule(bits_of(item.value) == bits_of(value), "a value is that of the strict grammar");
        else
            require_rule(std::isnan(item.value), "a flagged value is no number");
        require_rule(item.code >= 101 && item.code % 100 != 0, "codes are 0101 to 9999");
    }
}

std::string stream_of(Input& input) {
    static const std::string words[] = {"&&",
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
                                        "-999.25",
                                        "nan",
                                        "1e400",
                                        "&",
                                        "!",
                                        " ",
                                        std::string(1, '\0'),
                                        "\xff",
                                        std::string(70, '7'),
                                        "&&\r\n01081\r\n!!\r\n",
                                        "!!&&\n",
                                        "+",
                                        "-",
                                        "e",
                                        ".",
                                        "\r\n0110",
                                        "\r\n2345",
                                        "3",
                                        "07",
                                        "12345678",
                                        "0.000123"};
    std::string text;
    while (input.left() > 0 && text.size() < 4000) {
        const std::size_t which = input.below(40);
        text += which < std::size(words) ? words[which] : std::string(input.text(1 + input.below(6)));
    }
    return text;
}

// A damaged state is refused, or the parser goes on and returns items within the text.
void require_safe_state(Input& input, const std::string& text) {
    wits::Parser parser({nulls[0], nulls[1]});
    parser.feed(text);
    std::string state = parser.state();
    for (std::size_t n = 1 + input.below(3); n > 0; --n)
        state[input.below(65536) % state.size()] = input.one_of({'\0', '\x7f', '\xff', '1', '\n'});
    if (refused([&] { parser.restore(state); })) return;
    for (const wits::Batch& batch : {parser.feed("&&\n01081\n!!\n"), parser.finish()})
        for (const wits::Item& item : batch.items)
            require_rule(item.offset >= batch.base &&
                             item.offset + item.length <= batch.base + static_cast<Index>(batch.text.size()),
                         "an item lies within the text");
}

}  // namespace

void fuzz(Input input) {
    const bool raw = input.one_in(4);
    const std::string text = raw ? std::string(input.text(input.left())) : stream_of(input);
    for (const wits::Limits limits : {wits::Limits{}, wits::Limits{16, 64, 3}}) {
        const Read whole = read(text, 0, limits);
        for (const std::size_t longest : {std::size_t{1}, std::size_t{9}}) {
            const Read cut = read(text, longest, limits);
            require_rule(same_bits(whole.items, cut.items), "items do not depend on the chunks");
            require_rule(same_bits(whole.frames, cut.frames), "frames do not depend on the chunks");
            require_rule(same_bits(whole.events, cut.events), "events do not depend on the chunks");
        }
        require_values(whole);
    }
    require_safe_state(input, text);
}
