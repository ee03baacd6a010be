// Whole lines of memory written past the cache, for results too large to stay in it: the processor then does not read
// from memory what is about to be overwritten.
#pragma once

#include <cstdint>
#include <cstring>

#if defined(__SSE2__) || defined(_M_X64)
#include <emmintrin.h>
#endif

namespace helibore {

// Eight doubles. Others see them after finish_streams() only.
inline void stream_line(double* to, const double* from) {
#if defined(__SSE2__) || defined(_M_X64)
    if (reinterpret_cast<std::uintptr_t>(to) % 16 == 0) {
        for (int i = 0; i < 8; i += 2) _mm_stream_pd(to + i, _mm_loadu_pd(from + i));
        return;
    }
#endif
    std::memcpy(to, from, 8 * sizeof(double));
}

inline void finish_streams() {
#if defined(__SSE2__) || defined(_M_X64)
    _mm_sfence();
#endif
}

}  // namespace helibore
