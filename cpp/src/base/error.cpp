// The text of an input error: "place = value: rule", or "place: rule" without a value.
#include "helibore/error.hpp"

#include <utility>

namespace helibore {

namespace {

std::string text_of(const std::string& place, const std::string& rule, const std::optional<std::string>& value) {
    std::string text = place;
    if (value) text.append(" = ").append(*value);
    return text.append(": ").append(rule);
}

}  // namespace

InputError::InputError(std::string where, std::string broken, std::optional<std::string> given)
    : std::invalid_argument(text_of(where, broken, given)),
      place(std::move(where)),
      rule(std::move(broken)),
      value(std::move(given)) {}

}  // namespace helibore
