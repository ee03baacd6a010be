// Which compiled kernel a setting or the processor asks for, and the floating-point state it needs.
#pragma once

#include <cfenv>

#include "helibore/settings.hpp"
#include "search/kernel/kernel.hpp"

namespace helibore::kernel {

// Throws InputError if the processor lacks a level that is forced.
const Functions& functions_for(InstructionSet level);

// list_capacity + 1 doubles that carry the bits of the integers 0, 1, 2, ...
const double* position_table();
const float* narrow_position_table();

}  // namespace helibore::kernel

namespace helibore {

// Rounding to nearest, no traps, subnormals kept: what the results are defined in, whatever the host has set (Delphi
// and Pascal hosts unmask exceptions, audio and game hosts flush subnormals). Restores the host's state.
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
