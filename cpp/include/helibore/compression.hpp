// Compresses columns of 64-bit words without loss: doubles as their bits, or whole numbers. Columns of measurements
// have few decimals, so they have few different values, or few different steps; columns of computed values at least
// share their first bits.
//
//     | form | shift | table: number of entries, entries | block 0 | block 1 | ...      form: 1 steps, 2 table, 3 both
//     block of up to 1,024 numbers:  | least | width | number - least, `width` bits each, to whole words |
//
// `form` 1: the numbers are the steps from each word to the next, the first from 0. `form` 2: the numbers are places in
// the table, which has a word or a step for each. Without a table, the numbers are shifted right by `shift`, because
// the last bits of all are 0. All is little-endian: `least`, table and its size have 8 bytes, the others 1. Sums and
// differences wrap around; `least` is the least number as a signed one. The form is taken that is the shortest for some
// of the blocks.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

namespace helibore {

std::vector<std::uint8_t> compress(std::span<const std::uint64_t> words);

// Sets all of `words` to what was compressed. Throws InputError if the bytes are not those of so many words.
void decompress(std::span<const std::uint8_t> bytes, std::span<std::uint64_t> words);

// Returns the sum of the hashes of all rows of columns of equal length: the same for the same rows in any order. Throws
// InputError for columns of different lengths.
std::uint64_t sum_of_rows(std::span<const std::span<const double>> columns);

}  // namespace helibore
