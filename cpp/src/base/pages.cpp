// Large pages by mmap and madvise on Linux, plain aligned memory elsewhere.
#include "helibore/pages.hpp"

#include <cstdint>
#include <new>
#include <utility>

#ifdef __linux__
#include <sys/mman.h>
#endif

namespace helibore {
namespace {

#ifdef __linux__
double* map_page() {
    // Mapped with room to align, then trimmed.
    void* mapped = mmap(nullptr, 2 * page_size, PROT_READ | PROT_WRITE, MAP_PRIVATE | MAP_ANONYMOUS, -1, 0);
    if (mapped == MAP_FAILED) throw std::bad_alloc();
    auto* first = static_cast<std::byte*>(mapped);
    const std::size_t before = (page_size - reinterpret_cast<std::uintptr_t>(mapped) % page_size) % page_size;
    if (before > 0) munmap(first, before);
    munmap(first + before + page_size, page_size - before);
    madvise(first + before, page_size, MADV_HUGEPAGE);  // only a wish
    return reinterpret_cast<double*>(first + before);
}
void unmap_page(double* page) {
    munmap(page, page_size);
}
#else
double* map_page() {
    return static_cast<double*>(::operator new(page_size, std::align_val_t(64)));
}
void unmap_page(double* page) {
    ::operator delete(page, std::align_val_t(64));
}
#endif

}  // namespace

Pages::~Pages() {
    for (double* page : kept_) unmap_page(page);
}

std::shared_ptr<double[]> Pages::take() {
    auto pages = shared_from_this();
    double* page = kept_page();
    if (!page) page = map_page();
    return {page, [pages = std::move(pages)](double* p) {
                if (!pages->keep(p)) unmap_page(p);
            }};
}

// Nobody waits for the lock: the system has pages, too. And in a forked process it may be held for ever.
double* Pages::kept_page() {
    const std::unique_lock held(lock_, std::try_to_lock);
    if (!held || kept_.empty()) return nullptr;
    double* page = kept_.back();
    kept_.pop_back();
    return page;
}

bool Pages::keep(double* page) {
    const std::unique_lock held(lock_, std::try_to_lock);
    if (!held || (kept_.size() + 1) * page_size > most_kept_) return false;
    try {
        kept_.push_back(page);
    } catch (const std::bad_alloc&) {
        return false;
    }
    return true;
}

std::size_t Pages::kept() const {
    const std::scoped_lock held(lock_);
    return kept_.size() * page_size;
}

void Pages::release() {
    const std::scoped_lock held(lock_);
    for (double* page : kept_) unmap_page(page);
    kept_.clear();
}

}  // namespace helibore
