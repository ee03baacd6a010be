// Packs of floats in which AVX2 and AVX-512 select the nearest candidates of eight vertices. X86Narrow holds one
// candidate of each vertex and is used by both instruction sets. X86NarrowPair holds two candidates of each vertex and
// needs AVX-512.
#pragma once

#include <immintrin.h>

#include "search/kernel/kernel.hpp"

namespace helibore::kernel {
namespace {

struct X86Narrow {
    static constexpr int width = 8, candidates = 1;
    using Single = X86Narrow;
    __m256 v;

    X86Narrow() = default;
    X86Narrow(__m256 x) : v(x) {}
    explicit X86Narrow(float x) : v(_mm256_set1_ps(x)) {}

    static X86Narrow load(const float* p) { return _mm256_loadu_ps(p); }
    void store(float* p) const { _mm256_storeu_ps(p, v); }
    static int count_at_most(const float* keys, int n, float x) {
        int count = 0;
        for (int i = 0; i < n; i += 16)
            count += __builtin_popcount(load(keys + i).at_most(x) | load(keys + i + 8).at_most(x) << 8);
        return count;
    }
    unsigned at_most(float x) const {
        return static_cast<unsigned>(_mm256_movemask_ps(_mm256_cmp_ps(v, _mm256_set1_ps(x), _CMP_LE_OQ)));
    }
    static X86Narrow each_vertex(X86Narrow x) { return x; }
    static X86Narrow each_candidate(const float* p) { return _mm256_broadcast_ss(p); }
    Single candidate(int) const { return v; }

    friend X86Narrow operator+(X86Narrow a, X86Narrow b) { return _mm256_add_ps(a.v, b.v); }
    friend X86Narrow operator-(X86Narrow a, X86Narrow b) { return _mm256_sub_ps(a.v, b.v); }
    friend X86Narrow operator*(X86Narrow a, X86Narrow b) { return _mm256_mul_ps(a.v, b.v); }
    static X86Narrow min(X86Narrow a, X86Narrow b) { return _mm256_min_ps(a.v, b.v); }
    static X86Narrow max(X86Narrow a, X86Narrow b) { return _mm256_max_ps(a.v, b.v); }

    static __m256 low() { return _mm256_castsi256_ps(_mm256_set1_epi32((1 << narrow_position_bits) - 1)); }
    static X86Narrow tag(X86Narrow square, X86Narrow position) {
        return _mm256_or_ps(_mm256_andnot_ps(low(), square.v), position.v);
    }
    static X86Narrow position_key(X86Narrow key) {
        return _mm256_or_ps(_mm256_and_ps(key.v, low()), _mm256_set1_ps(1.0f));
    }
    void store_positions(std::int32_t* at) const {
        _mm256_storeu_ps(reinterpret_cast<float*>(at), _mm256_and_ps(v, low()));
    }
};

#ifdef __AVX512F__
struct X86NarrowPair {
    static constexpr int width = 16, candidates = 2;
    using Single = X86Narrow;
    __m512 v;  // vertex i has lane 2 i for its first candidate and lane 2 i + 1 for its second

    X86NarrowPair() = default;
    X86NarrowPair(__m512 x) : v(x) {}
    explicit X86NarrowPair(float x) : v(_mm512_set1_ps(x)) {}

    static X86NarrowPair load(const float* p) { return _mm512_loadu_ps(p); }
    void store(float* p) const { _mm512_storeu_ps(p, v); }
    static int count_at_most(const float* keys, int n, float x) {
        int count = 0;
        for (int i = 0; i < n; i += 16) count += __builtin_popcount(load(keys + i).at_most(x));
        return count;
    }
    unsigned at_most(float x) const { return _mm512_cmp_ps_mask(v, _mm512_set1_ps(x), _CMP_LE_OQ); }
    static X86NarrowPair each_vertex(X86Narrow x) {
        const __m512i twice = _mm512_setr_epi32(0, 0, 1, 1, 2, 2, 3, 3, 4, 4, 5, 5, 6, 6, 7, 7);
        return _mm512_permutexvar_ps(twice, _mm512_castps256_ps512(x.v));
    }
    static X86NarrowPair each_candidate(const float* p) {
        double two;
        __builtin_memcpy(&two, p, sizeof two);
        return _mm512_castpd_ps(_mm512_set1_pd(two));
    }
    Single candidate(int which) const {
        const __m512i pairs = _mm512_castps_si512(v);
        return _mm256_castsi256_ps(_mm512_cvtepi64_epi32(which == 0 ? pairs : _mm512_srli_epi64(pairs, 32)));
    }

    friend X86NarrowPair operator+(X86NarrowPair a, X86NarrowPair b) { return _mm512_add_ps(a.v, b.v); }
    friend X86NarrowPair operator-(X86NarrowPair a, X86NarrowPair b) { return _mm512_sub_ps(a.v, b.v); }
    friend X86NarrowPair operator*(X86NarrowPair a, X86NarrowPair b) { return _mm512_mul_ps(a.v, b.v); }
    static X86NarrowPair min(X86NarrowPair a, X86NarrowPair b) { return _mm512_min_ps(a.v, b.v); }
    static X86NarrowPair max(X86NarrowPair a, X86NarrowPair b) { return _mm512_max_ps(a.v, b.v); }

    // Returns (square & ~low) | position, by one instruction; 0xBA is the truth table of this expression.
    static X86NarrowPair tag(X86NarrowPair square, X86NarrowPair position) {
        const __m512i low = _mm512_set1_epi32((1 << narrow_position_bits) - 1);
        return _mm512_castsi512_ps(
            _mm512_ternarylogic_epi32(_mm512_castps_si512(square.v), low, _mm512_castps_si512(position.v), 0xBA));
    }
};
#endif

}  // namespace
}  // namespace helibore::kernel
