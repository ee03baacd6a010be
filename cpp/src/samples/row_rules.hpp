// The rules for every row of a batch: toolface and time finite, depth within 1e7 m of 0, radius in metres above 0 and
// at most 2.
//
// The host may write into its memory while it is read. So a batch is checked in the copy that is then used.
#pragma once

#include <span>

#include "helibore/types.hpp"
#include "helibore/wall.hpp"
#include "search/kernel/kernel.hpp"

namespace helibore {

inline constexpr Index rows_a_thread = 32768;  // least number of rows; fewer are not worth the start of a thread

// Throws InputError unless all columns are as long as depth; time may be empty.
void check_lengths(const SampleColumns& columns);

// Throws an InputError that names the first bad row of the first bad column, if there is one. The parts follow each
// other; they have equally many columns.
void check_rows(std::span<const SampleColumns> parts);

// Returns whether all rows follow the rules.
bool rows_valid(const SampleColumns& rows, const kernel::Functions& functions);

}  // namespace helibore
