// The two kinds of failure: the caller's input breaks a rule, or helibore has a bug.
#pragma once

#include <optional>
#include <stdexcept>
#include <string>

namespace helibore {

// Bad input: the place of the input, the rule that the input breaks, and its value if a single value is at fault. The
// text is "toolface[17] = nan: must be finite", or without a value "path: must not be empty".
class InputError : public std::invalid_argument {
  public:
    InputError(std::string where, std::string broken, std::optional<std::string> given = std::nullopt);

    std::string place, rule;
    std::optional<std::string> value;
};

// A bug in helibore. The text ends "this is a bug in helibore".
class InternalError : public std::logic_error {
  public:
    explicit InternalError(const std::string& what) : std::logic_error(what + "; this is a bug in helibore") {}
};

}  // namespace helibore
