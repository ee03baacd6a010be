// Large pages by mmap and madvise on Linux, plain aligned memory elsewhere.
#include "pages.hpp"

#include <cstdint>
#include <new>

#ifdef __linux__
#include <sys/mman.h>
#endif

namespace helibore {

#ifdef __linux__
std::shared_ptr<double[]> allocate_pages(std::size_t bytes) {
    // Mapped with room to align, then trimmed to what is asked for.
    const std::size_t whole = (bytes + large_page - 1) / large_page * large_page;
    void* mapped = mmap(nullptr, whole + large_page, PROT_READ | PROT_WRITE, MAP_PRIVATE | MAP_ANONYMOUS, -1, 0);
    if (mapped == MAP_FAILED) throw std::bad_alloc();
    auto* first = static_cast<std::byte*>(mapped);
    const std::size_t before = (large_page - reinterpret_cast<std::uintptr_t>(mapped) % large_page) % large_page;
    if (before > 0) munmap(first, before);
    if (before < large_page) munmap(first + before + whole, large_page - before);
    madvise(first + before, whole, MADV_HUGEPAGE);  // only a wish
    return {reinterpret_cast<double*>(first + before), [whole](double* p) { munmap(p, whole); }};
}
#else
std::shared_ptr<double[]> allocate_pages(std::size_t bytes) {
    void* memory = ::operator new(bytes, std::align_val_t(64));
    return {static_cast<double*>(memory), [](double* p) { ::operator delete(p, std::align_val_t(64)); }};
}
#endif

}  // namespace helibore
