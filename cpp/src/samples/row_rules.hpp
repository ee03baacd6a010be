// The rules for every row of a batch: toolface and time finite, depth within 1e7 m of 0, radius in metres above 0 and
// at most 2.
#pragma once

#include "helibore/types.hpp"
#include "helibore/wall.hpp"
#include "search/kernel/kernel.hpp"

namespace helibore {

inline constexpr Index rows_a_thread = 32768;  // least number of rows; fewer are not worth the start of a thread

// Throws InputError unless all columns are as long as depth; time may be empty.
void check_lengths(const SampleColumns& columns);

// Throws an InputError that names the first bad row of the first bad column, if there is one.
void check_rows(const SampleColumns& columns);

// Returns whether all of these rows follow the rules.
bool rows_valid(const SampleColumns& columns, Range rows, const kernel::Functions& functions);

}  // namespace helibore
