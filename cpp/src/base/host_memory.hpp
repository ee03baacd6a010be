// Reads memory that belongs to the host. Another thread of the host may write into it during the call. Then results may
// be wrong, but no bad memory is read: each value that is checked, or that decides a place in memory, is read once.
#pragma once

#include <span>
#include <vector>

namespace helibore {

template <class Number>
Number read_once(const Number& value) {
    return *static_cast<const volatile Number*>(&value);
}

inline std::vector<double> copied(std::span<const double> values) {
    return {values.begin(), values.end()};
}

}  // namespace helibore
