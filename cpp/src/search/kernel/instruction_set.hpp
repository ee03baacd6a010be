// Which compiled kernel a setting or the processor asks for.
#pragma once

#include "helibore/settings.hpp"
#include "search/kernel/kernel.hpp"

namespace helibore::kernel {

// Throws InputError if the processor lacks a level that is forced.
const Functions& functions_for(InstructionSet level);

// list_capacity + 1 doubles with the bits of the integers 0, 1, 2, ...
const double* position_table();
const float* narrow_position_table();

}  // namespace helibore::kernel
