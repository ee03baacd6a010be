// A hash of the numbers of a row, added one after the other to 0.
#pragma once

#include <bit>
#include <cstdint>

namespace helibore {

inline constexpr std::uint64_t hash_factor = 0x9E3779B97F4A7C15;

inline std::uint64_t with_number(std::uint64_t hash, double value) {
    hash = (hash ^ std::bit_cast<std::uint64_t>(value)) * hash_factor;
    return hash ^ hash >> 29;
}

}  // namespace helibore
