// Numbers as error messages show them: the shortest text that reads back as the same number.
#pragma once

#include <charconv>
#include <cmath>
#include <string>

#include "helibore/types.hpp"

namespace helibore {

inline std::string number_text(double value) {
    if (std::isnan(value)) return "nan";  // 0/0 is -nan on some machines
    char text[32];
    const auto end = std::to_chars(text, text + sizeof text, value).ptr;
    return {text, end};
}

// "toolface[17] = nan"
inline std::string entry_text(const std::string& column, Index index, double value) {
    return column + "[" + std::to_string(index) + "] = " + number_text(value);
}

}  // namespace helibore
