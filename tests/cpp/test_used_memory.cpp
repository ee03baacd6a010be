// The earlier contents of memory do not change results: memory of zeros and memory full of other numbers give the same
// bits, on every instruction set of this processor.
#include <cstdlib>
#include <cstring>
#include <limits>
#include <new>

#include "check.hpp"
#include "every_allocation.hpp"
#include "helibore/error.hpp"
#include "hole.hpp"

namespace {

bool used = false;        // or fresh: all zeros
std::uint32_t state = 1;  // xorshift32, Marsaglia 2003

// Returns what fills used memory: NaN now and then, which a minimum of two numbers may return or drop, and otherwise a
// number larger than any distance of a sample, which does not make the search fall back to its slower and safer ways.
// Two such floats are also a double of this kind.
float left_behind() {
    state ^= state << 13;
    state ^= state >> 17;
    state ^= state << 5;
    return state >> 29 == 0 ? std::numeric_limits<float>::quiet_NaN() : 1e3f;
}

}  // namespace

void* allocate(std::size_t bytes, std::size_t alignment) {
    const std::size_t whole = (bytes + alignment - 1) / alignment * alignment + alignment;
    auto* memory = static_cast<char*>(std::aligned_alloc(alignment, whole));
    if (memory == nullptr) throw std::bad_alloc();
    std::memset(memory, 0, whole);
    for (std::size_t at = 0; used && at + sizeof(float) <= whole; at += sizeof(float)) {
        const float value = left_behind();
        std::memcpy(memory + at, &value, sizeof(float));
    }
    return memory;
}

void deallocate(void* memory) noexcept {
    std::free(memory);
}

namespace {

using helibore::Settings;
using helibore::Wall;

std::vector<std::uint64_t> rebuilt(const Settings& settings, const Hole& hole, bool in_used_memory) {
    used = in_used_memory;
    Wall wall(settings);
    wall.append(hole.all());
    used = false;
    return bits(wall);
}

// Is the instruction set there?
bool runs(helibore::InstructionSet set) {
    try {
        static_cast<void>(Wall({.bit_diameter = 0.216, .instruction_set = set}));
        return true;
    } catch (const helibore::InputError&) {
        return false;
    }
}

}  // namespace

int main() {
    using enum helibore::InstructionSet;
    for (const auto set : {plain, avx2, avx512}) {
        if (!runs(set)) continue;
        int different = 0;
        for (int i = 0; i < static_cast<int>(1000 / reduced); ++i) {
            Settings settings{.bit_diameter = 0.216, .sectors = 12 + i % 50, .pitch = 0.03 + 0.001 * (i % 90)};
            settings.instruction_set = set;
            if (i % 10 == 9) settings.window = 30;
            if (i % 10 == 8) settings.direct = true;
            const Hole hole = oval_hole(static_cast<std::size_t>(60 + 7 * (i % 100)), 10.0 + i, 0.5);
            different += rebuilt(settings, hole, true) != rebuilt(settings, hole, false);
        }
        CHECK(different == 0);
    }
    return failures();
}
