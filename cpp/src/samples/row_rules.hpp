// What every row of a batch must be: depth, toolface and time finite, radius above 0 and at most 2 m.
#pragma once

#include "helibore/types.hpp"
#include "helibore/wall.hpp"
#include "search/kernel/kernel.hpp"

namespace helibore {

// Throws InputError unless all columns are as long as depth; time may be empty.
void check_lengths(const SampleColumns& columns);

// Throws InputError with the first offending row of the first offending column.
void check_rows(const SampleColumns& columns);

// Do all of these rows keep the rules?
bool rows_valid(const SampleColumns& columns, Range rows, const kernel::Functions& functions);

}  // namespace helibore
