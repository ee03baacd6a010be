// Memory for large batches of samples in pages of 2 MB: the first use of pages of 4 kB takes as long as the search.
#pragma once

#include <cstddef>
#include <memory>

namespace helibore {

inline constexpr std::size_t large_page_size = std::size_t{2} << 20;  // bytes

// Returns one page, whose memory is not zeroed. Throws std::bad_alloc.
std::shared_ptr<double[]> large_page();

}  // namespace helibore
