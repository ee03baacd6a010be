// Chooses the compiled kernel at run time.
#include "search/kernel/instruction_set.hpp"

#include <array>
#include <bit>

#include "helibore/error.hpp"
#include "helibore/wall.hpp"

namespace helibore {
namespace kernel {
namespace {

bool has_avx2() {
#if defined(__x86_64__) && (defined(__GNUC__) || defined(__clang__))
    return __builtin_cpu_supports("avx2");
#else
    return false;
#endif
}

bool has_avx512() {
#if defined(__x86_64__) && (defined(__GNUC__) || defined(__clang__))
    return __builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512dq") &&
           __builtin_cpu_supports("avx512vl") && __builtin_cpu_supports("avx512bw");
#else
    return false;
#endif
}

const Functions& demand(bool present, const Functions& functions, const char* name) {
    if (!present) throw InputError("instruction_set", "this processor does not have it", name);
    return functions;
}

}  // namespace

const Functions& functions_for(InstructionSet level) {
    switch (level) {
        case InstructionSet::plain:
            return plain();
        case InstructionSet::avx2:
            return demand(has_avx2(), avx2(), "avx2");
        case InstructionSet::avx512:
            return demand(has_avx512(), avx512(), "avx512");
        case InstructionSet::automatic:
            break;
    }
    return has_avx512() ? avx512() : has_avx2() ? avx2() : plain();
}

const double* position_table() {
    static constexpr auto table = [] {
        std::array<double, list_capacity + 1> bits{};
        for (std::size_t i = 0; i < bits.size(); ++i) bits[i] = std::bit_cast<double>(static_cast<std::int64_t>(i));
        return bits;
    }();
    return table.data();
}

const float* narrow_position_table() {
    static constexpr auto table = [] {
        std::array<float, std::size_t{1} << narrow_position_bits> bits{};
        for (std::size_t i = 0; i < bits.size(); ++i) bits[i] = std::bit_cast<float>(static_cast<std::int32_t>(i));
        return bits;
    }();
    return table.data();
}

}  // namespace kernel

std::string_view instruction_set_in_use() {
    return kernel::functions_for(InstructionSet::automatic).name;
}

}  // namespace helibore
