// Memory for many samples at once, in large pages where the system has them: faulting in small pages one by one takes
// longer than filling them.
#pragma once

#include <cstddef>
#include <memory>

namespace helibore {

inline constexpr std::size_t large_page = std::size_t{2} << 20;

// `bytes` of memory aligned to a large page, not zeroed by us; throws std::bad_alloc. Given back when the last owner
// goes.
std::shared_ptr<double[]> allocate_pages(std::size_t bytes);

}  // namespace helibore
