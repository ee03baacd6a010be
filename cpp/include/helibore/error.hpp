// The two kinds of failure: the caller's input breaks a rule, or helibore has a bug.
#pragma once

#include <stdexcept>
#include <string>

namespace helibore {

// Bad input. The text names the place, the value and the rule: "toolface[17] = nan: must be finite".
class InputError : public std::invalid_argument {
  public:
    using std::invalid_argument::invalid_argument;
};

// A bug in helibore. The text ends "this is a bug in helibore".
class InternalError : public std::logic_error {
  public:
    explicit InternalError(const std::string& what) : std::logic_error(what + "; this is a bug in helibore") {}
};

}  // namespace helibore
