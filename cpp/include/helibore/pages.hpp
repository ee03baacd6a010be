// Memory that walls hand on to each other.
//
//     const auto pages = std::make_shared<helibore::Pages>(std::size_t{64} << 20);
//     helibore::Wall first({.bit_diameter = 0.216}, pages);  // once it is gone ...
//     helibore::Wall second({.bit_diameter = 0.216}, pages); // ... its pages serve the next
//
// Large batches of samples live in pages of 2 MB, which the system clears before it hands them out: a tenth of the time
// a wall takes. A program that rebuilds one well after another saves that.
#pragma once

#include <cstddef>
#include <memory>
#include <mutex>
#include <vector>

namespace helibore {

inline constexpr std::size_t page_size = std::size_t{2} << 20;

// May be shared by walls of several threads, and outlived by them.
class Pages : public std::enable_shared_from_this<Pages> {
  public:
    // Keeps at most so many bytes of what comes back; the rest goes to the system.
    explicit Pages(std::size_t most_kept = 0) : most_kept_(most_kept) {}
    ~Pages();
    Pages(const Pages&) = delete;
    Pages& operator=(const Pages&) = delete;

    // A page, not zeroed, that comes back when its last owner goes; throws std::bad_alloc. Of pages that belong to a
    // std::shared_ptr; else throws std::bad_weak_ptr.
    std::shared_ptr<double[]> take();

    // Both wait for other threads, and so must not be called in a forked process.
    std::size_t kept() const;  // bytes
    void release();            // gives what is kept to the system

  private:
    double* kept_page();
    bool keep(double* page);

    const std::size_t most_kept_;
    mutable std::mutex lock_;
    std::vector<double*> kept_;
};

}  // namespace helibore
