// The host's allocator in place of the system's: a program in any language links this file, and helibore, also as a
// shared library, takes its memory here. The blocks are counted.
#include <atomic>
#include <cstddef>
#include <cstdio>
#include <cstdlib>
#include <new>

static std::atomic<long> taken{0}, given_back{0};

void* operator new(std::size_t bytes, std::align_val_t alignment) {
    const auto line = static_cast<std::size_t>(alignment);
    void* block = std::aligned_alloc(line, (bytes + line) / line * line);
    if (!block) throw std::bad_alloc();  // the call of helibore returns HB_NO_MEMORY
    ++taken;
    return block;
}

void* operator new(std::size_t bytes) {
    return operator new(bytes, std::align_val_t{alignof(std::max_align_t)});
}

void operator delete(void* block) noexcept {
    given_back += block != nullptr;
    std::free(block);
}

void operator delete(void* block, std::align_val_t) noexcept {
    operator delete(block);
}

static const struct AtExit {
    ~AtExit() { std::printf("%s\n", taken > 100 && taken == given_back ? "all memory given back" : "memory kept"); }
} at_exit;
