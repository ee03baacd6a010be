// Chooses the compiled kernel that a setting demands, or the best one that the processor can run.
#pragma once

#include "helibore/settings.hpp"
#include "search/kernel/kernel.hpp"

namespace helibore::kernel {

// Throw InputError if a setting demands a level that the processor does not have.
const Functions& functions_for(InstructionSet level);
BlockLikelihood likelihood_for(InstructionSet level);

// Return the tables CandidateList::position (list_capacity + 1 doubles) and CandidateList::narrow_position (256
// floats), whose values have the bits of the integers 0, 1, 2, ...
const double* position_table();
const float* narrow_position_table();

}  // namespace helibore::kernel
