// A pack of four doubles in AVX2.
#pragma once

#include <immintrin.h>

#include "kernel.hpp"

namespace helibore::kernel {
namespace {

// For each 4-bit mask, the 32-bit lanes that bring its doubles to the front.
alignas(32) constexpr int compress_lanes[16][8] = {
    {0, 1, 2, 3, 4, 5, 6, 7}, {0, 1, 2, 3, 4, 5, 6, 7}, {2, 3, 0, 1, 4, 5, 6, 7}, {0, 1, 2, 3, 4, 5, 6, 7},
    {4, 5, 0, 1, 2, 3, 6, 7}, {0, 1, 4, 5, 2, 3, 6, 7}, {2, 3, 4, 5, 0, 1, 6, 7}, {0, 1, 2, 3, 4, 5, 6, 7},
    {6, 7, 0, 1, 2, 3, 4, 5}, {0, 1, 6, 7, 2, 3, 4, 5}, {2, 3, 6, 7, 0, 1, 4, 5}, {0, 1, 2, 3, 6, 7, 4, 5},
    {4, 5, 6, 7, 0, 1, 2, 3}, {0, 1, 4, 5, 6, 7, 2, 3}, {2, 3, 4, 5, 6, 7, 0, 1}, {0, 1, 2, 3, 4, 5, 6, 7}};

struct Avx2Pack {
    static constexpr int width = 4;
    using Mask = __m256d;
    __m256d v;

    Avx2Pack() = default;
    Avx2Pack(__m256d x) : v(x) {}
    explicit Avx2Pack(double x) : v(_mm256_set1_pd(x)) {}

    static Avx2Pack load(const double* p) { return _mm256_loadu_pd(p); }
    void store(double* p) const { _mm256_storeu_pd(p, v); }
    friend Avx2Pack operator+(Avx2Pack a, Avx2Pack b) { return _mm256_add_pd(a.v, b.v); }
    friend Avx2Pack operator-(Avx2Pack a, Avx2Pack b) { return _mm256_sub_pd(a.v, b.v); }
    friend Avx2Pack operator*(Avx2Pack a, Avx2Pack b) { return _mm256_mul_pd(a.v, b.v); }
    friend Avx2Pack operator/(Avx2Pack a, Avx2Pack b) { return _mm256_div_pd(a.v, b.v); }
    static Avx2Pack min(Avx2Pack a, Avx2Pack b) { return _mm256_min_pd(a.v, b.v); }
    static Avx2Pack max(Avx2Pack a, Avx2Pack b) { return _mm256_max_pd(a.v, b.v); }
    static Avx2Pack abs(Avx2Pack a) { return _mm256_andnot_pd(_mm256_set1_pd(-0.0), a.v); }
    static Avx2Pack sqrt(Avx2Pack a) { return _mm256_sqrt_pd(a.v); }
    static Mask less(Avx2Pack a, Avx2Pack b) { return _mm256_cmp_pd(a.v, b.v, _CMP_LT_OQ); }
    static Mask less_equal(Avx2Pack a, Avx2Pack b) { return _mm256_cmp_pd(a.v, b.v, _CMP_LE_OQ); }
    static Mask both(Mask a, Mask b) { return _mm256_and_pd(a, b); }
    static bool all(Mask a) { return _mm256_movemask_pd(a) == 15; }
    static bool any(Mask a) { return _mm256_movemask_pd(a) != 0; }
    static Avx2Pack blend(Mask m, Avx2Pack yes, Avx2Pack no) { return _mm256_blendv_pd(no.v, yes.v, m); }

    static __m256d low() { return _mm256_castsi256_pd(_mm256_set1_epi64x((1LL << position_bits) - 1)); }
    static Avx2Pack tag(Avx2Pack square, double position) {
        return _mm256_or_pd(_mm256_andnot_pd(low(), square.v), _mm256_set1_pd(position));
    }
    static Avx2Pack position_key(Avx2Pack key) {
        return _mm256_or_pd(_mm256_and_pd(key.v, low()), _mm256_set1_pd(1.0));
    }
    void store_positions(std::int64_t* at) const {
        _mm256_storeu_pd(reinterpret_cast<double*>(at), _mm256_and_pd(v, low()));
    }
    // Four loads: the gather instruction is many times slower where processors are patched against Downfall.
    static Avx2Pack pick(const double* base, const std::int64_t* at) {
        return _mm256_setr_pd(base[at[0]], base[at[1]], base[at[2]], base[at[3]]);
    }
    static std::int64_t compress(Mask m, Avx2Pack a, double* out) {
        const int bits = _mm256_movemask_pd(m);
        const __m256i order = _mm256_load_si256(reinterpret_cast<const __m256i*>(compress_lanes[bits]));
        _mm256_storeu_pd(out, _mm256_castsi256_pd(_mm256_permutevar8x32_epi32(_mm256_castpd_si256(a.v), order)));
        return __builtin_popcount(static_cast<unsigned>(bits));
    }
};

}  // namespace
}  // namespace helibore::kernel
