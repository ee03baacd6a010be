// Large pages by mmap and madvise on Linux, plain aligned memory elsewhere.
#include "base/large_pages.hpp"

#include <cstdint>
#include <new>

#ifdef __linux__
#include <sys/mman.h>
#endif

namespace helibore {

#ifdef __linux__
std::shared_ptr<double[]> large_page() {
    // Twice the size is mapped and trimmed, so that the page begins at a multiple of its size.
    constexpr std::size_t size = large_page_size;
    void* mapped = mmap(nullptr, 2 * size, PROT_READ | PROT_WRITE, MAP_PRIVATE | MAP_ANONYMOUS, -1, 0);
    if (mapped == MAP_FAILED) throw std::bad_alloc();
    auto* first = static_cast<std::byte*>(mapped);
    const std::size_t before = (size - reinterpret_cast<std::uintptr_t>(mapped) % size) % size;
    if (before > 0) munmap(first, before);
    munmap(first + before + size, size - before);
    madvise(first + before, size, MADV_HUGEPAGE);  // the system may ignore it
    return {reinterpret_cast<double*>(first + before), [](double* page) { munmap(page, large_page_size); }};
}
#else
std::shared_ptr<double[]> large_page() {
    constexpr std::align_val_t line{64};
    return {static_cast<double*>(::operator new(large_page_size, line)),
            [](double* page) { ::operator delete(page, line); }};
}
#endif

}  // namespace helibore
