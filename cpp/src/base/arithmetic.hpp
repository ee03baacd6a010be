// The floating-point state that results are defined in.
#pragma once

#include <cfenv>

namespace helibore {

// Sets rounding to nearest, no traps and subnormals kept, whatever the host has set (Delphi and Pascal hosts unmask
// exceptions, audio and game hosts flush subnormals). Restores the host's state at its end.
class StandardArithmetic {
  public:
    StandardArithmetic() {
        std::feholdexcept(&host_);
        std::fesetenv(FE_DFL_ENV);
    }
    ~StandardArithmetic() { std::fesetenv(&host_); }
    StandardArithmetic(const StandardArithmetic&) = delete;
    StandardArithmetic& operator=(const StandardArithmetic&) = delete;

  private:
    std::fenv_t host_;
};

}  // namespace helibore
