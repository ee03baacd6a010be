// The texts of input errors, "place = value: rule", and the rules that many columns share.
#pragma once

#include <charconv>
#include <cmath>
#include <span>
#include <string>

#include "helibore/error.hpp"
#include "helibore/types.hpp"

namespace helibore {

// The shortest text that reads back as the same number. The host's locale and the sign of a NaN do not show.
inline std::string number_text(double value) {
    if (std::isnan(value)) return "nan";
    char text[32];
    return {text, std::to_chars(text, text + sizeof text, value).ptr};
}

// "toolface[17] = nan"
inline std::string entry_text(const std::string& column, Index index, double value) {
    return column + "[" + std::to_string(index) + "] = " + number_text(value);
}

// "[3, 7)"
inline std::string range_text(const Range& range) {
    std::string text = "[";
    return text.append(std::to_string(range.start)).append(", ").append(std::to_string(range.stop)).append(")");
}

// The error of one value of a column.
inline InputError entry_error(const std::string& column, Index index, double value, const std::string& rule) {
    return {column + "[" + std::to_string(index) + "]", rule, number_text(value)};
}

inline void require_finite(const char* name, std::span<const double> values) {
    for (std::size_t i = 0; i < values.size(); ++i)
        if (!std::isfinite(values[i])) throw entry_error(name, static_cast<Index>(i), values[i], "must be finite");
}

// "toolface has 2 values, depth has 3: must be equal"
inline void require_length(const std::string& name, std::size_t size, std::size_t wanted, const char* other = "depth") {
    if (size == wanted) return;
    throw InputError(name + " has " + std::to_string(size) + " values, " + other + " has " + std::to_string(wanted),
                     "must be equal");
}

}  // namespace helibore
