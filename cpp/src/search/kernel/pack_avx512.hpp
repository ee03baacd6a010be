// A pack of eight doubles in AVX-512.
#pragma once

#include <immintrin.h>

#include "search/kernel/kernel.hpp"
#include "search/kernel/pack_x86_narrow.hpp"

namespace helibore::kernel {
namespace {

struct Avx512Pack {
    using Mask = __mmask8;
    using Narrow = X86NarrowPair;
    __m512d v;

    Avx512Pack() = default;
    Avx512Pack(__m512d x) : v(x) {}
    explicit Avx512Pack(double x) : v(_mm512_set1_pd(x)) {}
    explicit Avx512Pack(X86Narrow x) : v(_mm512_cvtps_pd(x.v)) {}
    X86Narrow narrow() const { return _mm512_cvtpd_ps(v); }

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
    static int count_at_most(const double* keys, int n, double x) {
        int count = 0;
        for (int i = 0; i < n; i += 8) count += __builtin_popcount(bits(less_equal(load(keys + i), Avx512Pack(x))));
        return count;
    }
    static unsigned bits(Mask a) { return a; }
    static Avx512Pack blend(Mask m, Avx512Pack yes, Avx512Pack no) { return _mm512_mask_blend_pd(m, no.v, yes.v); }

    // Return the exponent or the mantissa of a normal number x = mantissa * 2^exponent, the mantissa in [1, 2); or 2^n.
    static Avx512Pack exponent(Avx512Pack x) { return _mm512_getexp_pd(x.v); }
    static Avx512Pack mantissa(Avx512Pack x) { return _mm512_getmant_pd(x.v, _MM_MANT_NORM_1_2, _MM_MANT_SIGN_zero); }
    static Avx512Pack power_of_two(Avx512Pack n) { return _mm512_scalef_pd(_mm512_set1_pd(1.0), n.v); }

    static __m512i low() { return _mm512_set1_epi64((1LL << position_bits) - 1); }
    // Returns (square & ~low) | position, by one instruction; 0xBA is the truth table of this expression.
    static Avx512Pack tag(Avx512Pack square, Avx512Pack position) {
        const __m512i p = _mm512_castpd_si512(position.v);
        return _mm512_castsi512_pd(_mm512_ternarylogic_epi64(_mm512_castpd_si512(square.v), low(), p, 0xBA));
    }

    // Eight rows are loaded whole and transposed, because the gather instruction is many times slower on processors
    // that are patched against Downfall. d, t, r: depth, toolface, radius; a dot is not used:
    //
    //     d0 t0 r0 .  d4 t4 r4 .   \  lows   d0 d1 r0 r1  d4 d5 r4 r5   \  depth d0 d1 d2 d3 d4 ...
    //     d1 t1 r1 .  d5 t5 r5 .   /  highs  t0 t1  .  .  t4 t5  .  .   /  toolface and radius likewise
    //
    // Rows 2, 6 and 3, 7 are loaded like rows 0, 4 and 1, 5.
    template <class Row>
    static void read(const Row& row, Avx512Pack& depth, Avx512Pack& toolface, Avx512Pack& radius) {
        const auto two = [&](int i) {
            return _mm512_insertf64x4(_mm512_castpd256_pd512(_mm256_load_pd(&row(i).depth)),
                                      _mm256_load_pd(&row(i + 4).depth), 1);
        };
        const __m512d a = two(0), b = two(1), c = two(2), d = two(3);
        const __m512d low_ab = _mm512_unpacklo_pd(a, b), low_cd = _mm512_unpacklo_pd(c, d);
        const __m512d high_ab = _mm512_unpackhi_pd(a, b), high_cd = _mm512_unpackhi_pd(c, d);
        const __m512i first = _mm512_setr_epi64(0, 1, 8, 9, 4, 5, 12, 13);
        const __m512i second = _mm512_setr_epi64(2, 3, 10, 11, 6, 7, 14, 15);
        depth = _mm512_permutex2var_pd(low_ab, first, low_cd);
        toolface = _mm512_permutex2var_pd(high_ab, first, high_cd);
        radius = _mm512_permutex2var_pd(low_ab, second, low_cd);
    }

    // Does the same as store_set_bits.
    static int store_indices(unsigned bits, std::int32_t first, std::int32_t* out) {
        const __m512i lane = _mm512_setr_epi32(0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15);
        const __m512i number = _mm512_add_epi32(_mm512_set1_epi32(first), lane);
        _mm512_storeu_si512(out, _mm512_maskz_compress_epi32(static_cast<__mmask16>(bits), number));
        return __builtin_popcount(bits);
    }
};

}  // namespace
}  // namespace helibore::kernel
