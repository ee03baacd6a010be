// Numbers as error messages show them: the shortest text that reads back as the same number.
#pragma once

#include <charconv>
#include <string>

namespace helibore {

inline std::string number_text(double value) {
    char text[32];
    const auto end = std::to_chars(text, text + sizeof text, value).ptr;
    return {text, end};
}

}  // namespace helibore
