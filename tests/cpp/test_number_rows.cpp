// Rows of numbers in a text: columns, blank lines and comments, and the texts that a slower reader must judge.
#include <limits>
#include <string_view>
#include <vector>

#include "check.hpp"
#include "helibore/number_rows.hpp"

int main() {
    using Numbers = std::vector<double>;
    const auto read = [](std::string_view text, std::size_t columns, bool comments = false) {
        return helibore::read_number_rows(text, columns, comments);
    };
    CHECK(read("1 2\n3\t-4e2\n\n  +5  6.25", 2) == (Numbers{1.0, 3.0, 5.0, 2.0, -400.0, 6.25}));
    CHECK(read("0.1", 1) == Numbers{0.1} && read("123420.000000000001", 1) == Numbers{123420.000000000001});
    CHECK(read("# depth\n1 2\n#3\n", 2, true) == (Numbers{1.0, 2.0}));
    for (const char* text : {"", "\n \n", "1 2\n3\n", "1 2\n3 4 5\n", "1 x\n", "1 nan\n", "1 inf\n", "1 2;3\n",
                             "# 1\n1 2\n", "1 9007199254740992\n", "1 1e400\n", "1 +-2\n", "1 2 #\n", "1,2\n"})
        CHECK(read(text, 2).empty());
    CHECK(read("1 9007199254740991", 2) == (Numbers{1.0, 9007199254740991.0}));
    return failures();
}
