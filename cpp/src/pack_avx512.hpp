// A pack of eight doubles in AVX-512.
#pragma once

#include <immintrin.h>

#include "kernel.hpp"

namespace helibore::kernel {
namespace {

struct Avx512Pack {
    static constexpr int width = 8;
    using Mask = __mmask8;
    __m512d v;

    Avx512Pack() = default;
    Avx512Pack(__m512d x) : v(x) {}
    explicit Avx512Pack(double x) : v(_mm512_set1_pd(x)) {}

    static Avx512Pack load(const double* p) { return _mm512_loadu_pd(p); }
    void store(double* p) const { _mm512_storeu_pd(p, v); }
    friend Avx512Pack operator+(Avx512Pack a, Avx512Pack b) { return _mm512_add_pd(a.v, b.v); }
    friend Avx512Pack operator-(Avx512Pack a, Avx512Pack b) { return _mm512_sub_pd(a.v, b.v); }
    friend Avx512Pack operator*(Avx512Pack a, Avx512Pack b) { return _mm512_mul_pd(a.v, b.v); }
    friend Avx512Pack operator/(Avx512Pack a, Avx512Pack b) { return _mm512_div_pd(a.v, b.v); }
    static Avx512Pack min(Avx512Pack a, Avx512Pack b) { return _mm512_min_pd(a.v, b.v); }
    static Avx512Pack max(Avx512Pack a, Avx512Pack b) { return _mm512_max_pd(a.v, b.v); }
    static Avx512Pack abs(Avx512Pack a) { return _mm512_abs_pd(a.v); }
    static Avx512Pack sqrt(Avx512Pack a) { return _mm512_sqrt_pd(a.v); }
    static Mask less(Avx512Pack a, Avx512Pack b) { return _mm512_cmp_pd_mask(a.v, b.v, _CMP_LT_OQ); }
    static Mask less_equal(Avx512Pack a, Avx512Pack b) { return _mm512_cmp_pd_mask(a.v, b.v, _CMP_LE_OQ); }
    static Mask both(Mask a, Mask b) { return static_cast<Mask>(a & b); }
    static bool all(Mask a) { return a == 0xff; }
    static bool any(Mask a) { return a != 0; }
    static Avx512Pack blend(Mask m, Avx512Pack yes, Avx512Pack no) { return _mm512_mask_blend_pd(m, no.v, yes.v); }

    static __m512i low() { return _mm512_set1_epi64((1LL << position_bits) - 1); }
    // (square & ~low) | position in one instruction; 0xBA is that truth table.
    static Avx512Pack tag(Avx512Pack square, double position) {
        const __m512i p = _mm512_castpd_si512(_mm512_set1_pd(position));
        return _mm512_castsi512_pd(_mm512_ternarylogic_epi64(_mm512_castpd_si512(square.v), low(), p, 0xBA));
    }
    static Avx512Pack position_key(Avx512Pack key) {
        return _mm512_or_pd(_mm512_and_pd(key.v, _mm512_castsi512_pd(low())), _mm512_set1_pd(1.0));
    }
    void store_positions(std::int64_t* at) const {
        _mm512_storeu_si512(at, _mm512_and_si512(_mm512_castpd_si512(v), low()));
    }
    // Eight loads: the gather instruction is many times slower where processors are patched against Downfall.
    static Avx512Pack pick(const double* base, const std::int64_t* at) {
        return _mm512_setr_pd(base[at[0]], base[at[1]], base[at[2]], base[at[3]], base[at[4]], base[at[5]], base[at[6]],
                              base[at[7]]);
    }
    static std::int64_t compress(Mask m, Avx512Pack a, double* out) {
        _mm512_storeu_pd(out, _mm512_maskz_compress_pd(m, a.v));
        return __builtin_popcount(static_cast<unsigned>(m));
    }
};

}  // namespace
}  // namespace helibore::kernel
