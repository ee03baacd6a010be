// An allocator for a test program that fails when it is told to, and counts. Include it in one file.
//
//     until_failure = 3;    // the fourth allocation from now on throws std::bad_alloc
#pragma once

#include <atomic>
#include <new>

#include "every_allocation.hpp"

std::atomic<long> until_failure{-1};  // allocations left before one fails; negative: none does
std::atomic<long> allocated{0};       // and not freed

void* allocate(std::size_t bytes, std::size_t alignment) {
    if (until_failure >= 0 && until_failure-- == 0) throw std::bad_alloc();
    const std::size_t whole = (bytes + alignment - 1) / alignment * alignment;
    void* memory = std::aligned_alloc(alignment, whole == 0 ? alignment : whole);
    if (memory == nullptr) throw std::bad_alloc();
    ++allocated;
    return memory;
}

void deallocate(void* memory) noexcept {
    allocated -= memory != nullptr;
    std::free(memory);
}
