// Reads rows of decimal numbers, such as the data section of a LAS file, in one pass.
#pragma once

#include <cstddef>
#include <string_view>
#include <vector>

namespace helibore {

// Returns the numbers of a text column by column, the whole first column first; there are size() / columns rows. A row
// is a line of `columns` numbers between blanks and tabs, as std::from_chars reads them; a '+' may stand before. Each
// number is the double next to the text. Lines of blanks are no rows, nor are lines whose first character is '#', if
// there are `comments`.
//
// Returns no number if any line is something else, if a number is NaN or infinite, or if 2^53 or more, which a double
// may not hold exactly. So a caller can try this reader first, and a slower one that says what is wrong.
std::vector<double> read_number_rows(std::string_view text, std::size_t columns, bool comments);

}  // namespace helibore
