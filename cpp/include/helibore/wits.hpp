// Turns WITS level 0 text into rows of numbers: which item, what value, where the text stood in the stream.
//
//   &&            a frame begins            only a line that is exactly "&&", "!!" or "!!&&" is a delimiter, because
//   01083650.40   record 01, item 08        text items may contain "&&" and "!!" ("2210Watch out!! kick")
//   !!            the frame ends
//
// The parser returns a frame when it has read the "!!" of the frame, never before, so the frames do not depend on how
// the stream is cut into chunks. Work is linear in the bytes fed. Between two calls the parser holds at most one frame
// and one line (Limits). The parser knows no units, no meaning of items, no level 1 and above (binary), and no sockets.
#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "helibore/types.hpp"

namespace helibore::wits {

// The largest number of bytes in a line (without its line end), of bytes in a frame (after its "&&" line), and of lines
// in a frame. A longer line or frame is dropped, counted and reported as an Event; reading continues at the next line,
// or for a frame at the next "&&".
// `helibore live` has the same limits as settings of a source, with their bounds:
// python/helibore/live/rules/sources.py.
struct Limits {
    Index line = 1024;
    Index frame = 65536;
    Index items = 512;
};

enum class Rule : std::uint16_t {
    stray_text,   // text between frames; one event for a run of lines
    stray_end,    // "!!" without "&&"
    unclosed,     // "&&" before the "!!" of the previous frame: that frame is lost
    not_an_item,  // a line that does not begin with record and item, 01 to 99 each: only the line is lost
    long_line,    // a line over Limits::line: only the line is lost
    long_frame,   // a frame over Limits::frame: lost
    many_items,   // a frame over Limits::items: lost
    cut_off,      // the stream ended within a frame, which is lost
};
inline constexpr std::size_t rule_count = 8;

// Why an item's value is NaN.
inline constexpr std::uint16_t null_value = 1;    // empty, or equal to one of the source's null numbers
inline constexpr std::uint16_t not_a_number = 2;  // neither empty nor a number by the grammar below

// A value is a number if its text is [+-] digits [e [+-] digits], where one point may stand before, between or after
// the first digits ("5.", ".5"), and if a double can hold the number. Spaces around the text do not count. Not numbers
// are: nan, inf, 1_2, 1,5, 1e400, 1e-400, 0x1p3.
struct Item {
    Index frame = 0;   // number of the item's frame: how many frames this parser returned before that frame
    Index offset = 0;  // of the value's text in the stream
    double value = 0;  // NaN when a flag is set
    std::int32_t length = 0;
    std::uint16_t code = 0;  // record * 100 + item, 101 to 9999
    std::uint16_t flags = 0;
};

struct Frame {
    Index start = 0;  // stream offset of "&&"
    Index stop = 0;   // stream offset after the end of the "!!" line
    Index first = 0;  // the items of the frame are batch.items[first, first + items)
    Index items = 0;
    Index line = 0;  // number of the "&&" line in the stream, from 1
};

struct Event {
    Index offset = 0;  // of the line; for unclosed, long_frame, many_items and cut_off: of the "&&" of the frame
    Index line = 0;    // number of the line at `offset` in the stream, from 1
    std::int32_t length = 0;
    Rule rule = Rule::stray_text;
    std::uint16_t unused = 0;
};

struct Batch {
    Index base = 0;    // stream offset of text[0]
    std::string text;  // the next bytes of the stream, from the first that no earlier batch returned
    std::vector<Item> items;
    std::vector<Frame> frames;
    std::vector<Event> events;
};

struct Counts {
    Index bytes = 0;
    Index lines = 0;
    Index frames = 0;
    Index items = 0;
    Index nulls = 0;
    Index not_numbers = 0;
    Index stray_lines = 0;
    Index events[rule_count] = {};
};

// Reads one stream (one connection). Several threads may call; calls at the same time wait for each other.
class Parser {
  public:
    explicit Parser(std::vector<double> nulls = {-9999.0, -8888.0, -999.25, -9999.25, -999.0, -99999.0},
                    Limits limits = {});
    ~Parser();
    // A parser that was moved from may only be destroyed or assigned to.
    Parser(Parser&&) noexcept;
    Parser& operator=(Parser&&) noexcept;

    // Returns the frames that these bytes complete. If it throws std::bad_alloc, the parser has taken no byte.
    Batch feed(std::string_view bytes);

    // Ends the stream, and returns what this completes: a last "!!" without a line end still closes its frame. The
    // parser is then ready for a new stream.
    Batch finish();

    Counts counts() const;

    // state() returns the complete state of the parser between two calls, in the byte order of this machine. If a
    // parser with the same nulls and limits restores this state, it continues exactly where the first parser was.
    // restore() throws InputError for bytes that are not such a state.
    std::string state() const;
    void restore(std::string_view state);

  private:
    struct State;
    std::unique_ptr<State> state_;
};

}  // namespace helibore::wits
