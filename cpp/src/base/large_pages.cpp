// Large pages by mmap and madvise on Linux, plain aligned memory elsewhere.
#include "base/large_pages.hpp"

#include <array>
#include <atomic>
#include <cstdint>
#include <new>

#ifdef __linux__
#include <sys/mman.h>
#endif

namespace helibore {

#ifdef __linux__
namespace {

// Pages of deleted walls, kept for the next wall: the system clears each page that it hands out, and two threads that
// request pages at the same time wait for each other. There is no lock, so a forked process may use these pages.
struct SparePages {
    std::array<std::atomic<std::byte*>, 32> pages{};

    std::byte* take() {
        for (auto& page : pages)
            if (page.load(std::memory_order_relaxed))
                if (std::byte* taken = page.exchange(nullptr)) return taken;
        return nullptr;
    }
    void give(std::byte* given) {
        for (auto& page : pages)
            if (std::byte* none = nullptr; page.compare_exchange_strong(none, given)) return;
        munmap(given, large_page_size);
    }
    ~SparePages() {
        while (std::byte* page = take()) munmap(page, large_page_size);
    }
};
constinit SparePages spare;

std::byte* map_page() {
    // Twice the size is mapped and trimmed, so that the page begins at a multiple of its size.
    constexpr std::size_t size = large_page_size;
    void* mapped = mmap(nullptr, 2 * size, PROT_READ | PROT_WRITE, MAP_PRIVATE | MAP_ANONYMOUS, -1, 0);
    if (mapped == MAP_FAILED) throw std::bad_alloc();
    auto* first = static_cast<std::byte*>(mapped);
    const std::size_t before = (size - reinterpret_cast<std::uintptr_t>(mapped) % size) % size;
    if (before > 0) munmap(first, before);
    munmap(first + before + size, size - before);
    madvise(first + before, size, MADV_HUGEPAGE);  // the system may ignore it
    return first + before;
}

}  // namespace

std::shared_ptr<double[]> large_page() {
    std::byte* page = spare.take();
    if (!page) page = map_page();
    return {reinterpret_cast<double*>(page), [](double* p) { spare.give(reinterpret_cast<std::byte*>(p)); }};
}
#else
std::shared_ptr<double[]> large_page() {
    constexpr std::align_val_t line{64};
    return {static_cast<double*>(::operator new(large_page_size, line)),
            [](double* page) { ::operator delete(page, line); }};
}
#endif

}  // namespace helibore
