// A number of at most 15 digits, of which at most 15 stand behind the point, is a whole number divided by a power of
// ten. A double holds both exactly, so the quotient is the double next to the text (Clinger, 1990). Other numbers, such
// as 1.5e-3, are left to std::from_chars, which takes three times as long.
#include "helibore/number_rows.hpp"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstdint>
#include <system_error>

#include "base/arithmetic.hpp"

namespace helibore {

namespace {

constexpr double power_of_ten[] = {1e0, 1e1, 1e2,  1e3,  1e4,  1e5,  1e6,  1e7,
                                   1e8, 1e9, 1e10, 1e11, 1e12, 1e13, 1e14, 1e15};
constexpr int most_digits = 15;
constexpr double first_inexact = 9007199254740992.0;  // 2^53

bool is_blank(char byte) {
    return byte == ' ' || byte == '\t';
}

bool is_digit(char byte) {
    return byte >= '0' && byte <= '9';
}

// Reads a number at `first`; returns where it ends, or nullptr if there is none.
const char* read_number(const char* first, const char* last, double& value) {
    const char* at = first + (*first == '-' || *first == '+');
    const char* digits = at;
    std::uint64_t whole = 0;
    for (; at != last && is_digit(*at); ++at) whole = 10 * whole + static_cast<std::uint64_t>(*at - '0');
    std::ptrdiff_t count = at - digits;
    std::ptrdiff_t behind = 0;
    if (at != last && *at == '.') {
        const char* point = at++;
        for (; at != last && is_digit(*at); ++at) whole = 10 * whole + static_cast<std::uint64_t>(*at - '0');
        behind = at - point - 1;
        count += behind;
    }
    if (count == 0) return nullptr;
    if (count <= most_digits && (at == last || is_blank(*at) || *at == '\n')) {
        value = static_cast<double>(whole) / power_of_ten[behind];
        if (*first == '-') value = -value;
        return at;
    }
    const auto [end, error] = std::from_chars(*first == '+' ? digits : first, last, value);
    return error == std::errc() && std::abs(value) < first_inexact ? end : nullptr;
}

}  // namespace

std::vector<double> read_number_rows(std::string_view text, std::size_t columns, bool comments) {
    if (columns == 0 || text.empty()) return {};
    const StandardArithmetic standard;
    const std::size_t lines = static_cast<std::size_t>(std::count(text.begin(), text.end(), '\n')) + 1;
    const std::size_t most = std::min(lines, (text.size() + 1) / 2 / columns);  // a number takes two bytes at least
    std::vector<double> values(columns * most);
    std::size_t row = 0;
    const char* const last = text.data() + text.size();
    for (const char* at = text.data(); at != last; at += at != last) {
        std::size_t column = 0;
        for (;;) {
            while (at != last && is_blank(*at)) ++at;
            if (at == last || *at == '\n') break;
            if (column == 0 && comments && *at == '#') {
                at = std::find(at, last, '\n');
                break;
            }
            if (column == columns || row == most) return {};
            at = read_number(at, last, values[column * most + row]);
            if (at == nullptr || (at != last && *at != '\n' && !is_blank(*at))) return {};
            ++column;
        }
        if (column != 0 && column != columns) return {};
        row += column != 0;
    }
    for (std::size_t column = 1; row != most && column < columns; ++column)
        std::copy_n(values.data() + column * most, row, values.data() + column * row);
    values.resize(columns * row);
    return values;
}

}  // namespace helibore
