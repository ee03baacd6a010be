// Writes whole cache lines directly to memory, for results too large for the cache: the processor then does not first
// read the memory that is about to be overwritten.
#pragma once

#include <cstdint>
#include <cstring>

#if defined(__SSE2__) || defined(_M_X64)
#include <emmintrin.h>
#endif

namespace helibore {

// Writes eight doubles. Other threads see them only after finish_streams().
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
