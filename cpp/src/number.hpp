// Numbers as error texts show them: the shortest digits that read back as the same value, "nan", "inf".
#pragma once

#include <charconv>
#include <cmath>
#include <string>

#include "helibore/types.hpp"

namespace helibore {

inline std::string number(double value) {
    if (std::isnan(value)) return "nan";
    char text[32];
    return {text, std::to_chars(text, text + sizeof text, value).ptr};
}

// "toolface[17] = nan"
inline std::string entry(const std::string& column, Index index, double value) {
    return column + "[" + std::to_string(index) + "] = " + number(value);
}

}  // namespace helibore
