// Chooses the compiled kernel at run time.
#include "search/kernel/instruction_set.hpp"

#ifdef __x86_64__
#include <cpuid.h>
#endif

#include <array>
#include <bit>

#include "helibore/error.hpp"
#include "helibore/wall.hpp"

namespace helibore {
namespace kernel {
namespace {

#ifdef __x86_64__
// Returns whether the processor has the features (bits of EBX of leaf 7) and the system saves the registers (bits of
// XCR0). __builtin_cpu_supports is not used, because it returns 0 in libraries that Zig links.
bool has(unsigned features, unsigned registers) {
    unsigned a, b, c, d;
    if (!__get_cpuid(1, &a, &b, &c, &d) || !(c & bit_OSXSAVE)) return false;
    unsigned saved, high;
    __asm__("xgetbv" : "=a"(saved), "=d"(high) : "c"(0));
    if ((saved & registers) != registers || !__get_cpuid_count(7, 0, &a, &b, &c, &d)) return false;
    return (b & features) == features;
}

bool has_avx2() {
    return has(bit_AVX2, 0x6);
}

bool has_avx512() {
    return has(bit_AVX512F | bit_AVX512DQ | bit_AVX512BW | bit_AVX512VL, 0xe6);
}
#else
bool has_avx2() {
    return false;
}

bool has_avx512() {
    return false;
}
#endif

// Returns what one of three functions returns: the one that a setting demands, or the best one.
template <class F>
auto chosen(InstructionSet level, F plain, F avx2, F avx512) -> decltype(plain()) {
    const auto demand = [](bool present, F function, const char* name) {
        if (!present) throw InputError("instruction_set", "this processor does not have it", name);
        return function;
    };
    switch (level) {
        case InstructionSet::plain:
            return plain();
        case InstructionSet::avx2:
            return demand(has_avx2(), avx2, "avx2")();
        case InstructionSet::avx512:
            return demand(has_avx512(), avx512, "avx512")();
        case InstructionSet::automatic:
            break;
    }
    return has_avx512() ? avx512() : has_avx2() ? avx2() : plain();
}

}  // namespace

const Functions& functions_for(InstructionSet level) {
    return chosen(level, plain, avx2, avx512);
}

BlockLikelihood likelihood_for(InstructionSet level) {
    return chosen(level, plain_likelihood, avx2_likelihood, avx512_likelihood);
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
