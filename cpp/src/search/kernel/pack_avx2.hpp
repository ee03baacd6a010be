// A pack of eight doubles in AVX2: two registers.
#pragma once

#include <immintrin.h>

#include "search/kernel/kernel.hpp"
#include "search/kernel/pack_x86_narrow.hpp"

namespace helibore::kernel {
namespace {

struct Avx2Pack {
    using Narrow = X86Narrow;
    struct Mask {
        __m256d a, b;
    };
    __m256d a, b;

    Avx2Pack() = default;
    Avx2Pack(__m256d low_half, __m256d high_half) : a(low_half), b(high_half) {}
    explicit Avx2Pack(double x) : a(_mm256_set1_pd(x)), b(a) {}
    explicit Avx2Pack(Narrow x)
        : a(_mm256_cvtps_pd(_mm256_castps256_ps128(x.v))), b(_mm256_cvtps_pd(_mm256_extractf128_ps(x.v, 1))) {}
    Narrow narrow() const { return _mm256_set_m128(_mm256_cvtpd_ps(b), _mm256_cvtpd_ps(a)); }

    static Avx2Pack load(const double* p) { return {_mm256_loadu_pd(p), _mm256_loadu_pd(p + 4)}; }
    void store(double* p) const {
        _mm256_storeu_pd(p, a);
        _mm256_storeu_pd(p + 4, b);
    }
    friend Avx2Pack operator+(Avx2Pack x, Avx2Pack y) { return {_mm256_add_pd(x.a, y.a), _mm256_add_pd(x.b, y.b)}; }
    friend Avx2Pack operator-(Avx2Pack x, Avx2Pack y) { return {_mm256_sub_pd(x.a, y.a), _mm256_sub_pd(x.b, y.b)}; }
    friend Avx2Pack operator*(Avx2Pack x, Avx2Pack y) { return {_mm256_mul_pd(x.a, y.a), _mm256_mul_pd(x.b, y.b)}; }
    friend Avx2Pack operator/(Avx2Pack x, Avx2Pack y) { return {_mm256_div_pd(x.a, y.a), _mm256_div_pd(x.b, y.b)}; }
    static Avx2Pack min(Avx2Pack x, Avx2Pack y) { return {_mm256_min_pd(x.a, y.a), _mm256_min_pd(x.b, y.b)}; }
    static Avx2Pack max(Avx2Pack x, Avx2Pack y) { return {_mm256_max_pd(x.a, y.a), _mm256_max_pd(x.b, y.b)}; }
    static Avx2Pack abs(Avx2Pack x) {
        const __m256d sign = _mm256_set1_pd(-0.0);
        return {_mm256_andnot_pd(sign, x.a), _mm256_andnot_pd(sign, x.b)};
    }
    static Avx2Pack sqrt(Avx2Pack x) { return {_mm256_sqrt_pd(x.a), _mm256_sqrt_pd(x.b)}; }
    static Mask less(Avx2Pack x, Avx2Pack y) {
        return {_mm256_cmp_pd(x.a, y.a, _CMP_LT_OQ), _mm256_cmp_pd(x.b, y.b, _CMP_LT_OQ)};
    }
    static Mask less_equal(Avx2Pack x, Avx2Pack y) {
        return {_mm256_cmp_pd(x.a, y.a, _CMP_LE_OQ), _mm256_cmp_pd(x.b, y.b, _CMP_LE_OQ)};
    }
    static Mask both(Mask x, Mask y) { return {_mm256_and_pd(x.a, y.a), _mm256_and_pd(x.b, y.b)}; }
    static int count_at_most(const double* keys, int n, double x) {
        int count = 0;
        for (int i = 0; i < n; i += 8) count += __builtin_popcount(bits(less_equal(load(keys + i), Avx2Pack(x))));
        return count;
    }
    static unsigned bits(Mask m) {
        return static_cast<unsigned>(_mm256_movemask_pd(m.a)) | static_cast<unsigned>(_mm256_movemask_pd(m.b)) << 4;
    }
    static Avx2Pack blend(Mask m, Avx2Pack yes, Avx2Pack no) {
        return {_mm256_blendv_pd(no.a, yes.a, m.a), _mm256_blendv_pd(no.b, yes.b, m.b)};
    }

    // Does the same as Avx512Pack::exponent. 2^52 + n has the integer n in its low bits.
    static Avx2Pack exponent(Avx2Pack x) {
        const auto shifted = [](__m256d y) {
            const __m256d n = _mm256_castsi256_pd(_mm256_srli_epi64(_mm256_castpd_si256(y), 52));
            return _mm256_sub_pd(_mm256_or_pd(n, _mm256_set1_pd(0x1p52)), _mm256_set1_pd(0x1p52 + 1023.0));
        };
        return {shifted(x.a), shifted(x.b)};
    }
    static Avx2Pack mantissa(Avx2Pack x) {
        const __m256d bits = _mm256_castsi256_pd(_mm256_set1_epi64x(0xfffffffffffff)), one = _mm256_set1_pd(1.0);
        return {_mm256_or_pd(_mm256_and_pd(x.a, bits), one), _mm256_or_pd(_mm256_and_pd(x.b, bits), one)};
    }
    static Avx2Pack power_of_two(Avx2Pack n) {
        const auto shifted = [](__m256d y) {
            const __m256d biased = _mm256_add_pd(y, _mm256_set1_pd(0x1p52 + 1023.0));
            return _mm256_castsi256_pd(_mm256_slli_epi64(_mm256_castpd_si256(biased), 52));
        };
        return {shifted(n.a), shifted(n.b)};
    }

    static __m256d low() { return _mm256_castsi256_pd(_mm256_set1_epi64x((1LL << position_bits) - 1)); }
    static Avx2Pack tag(Avx2Pack square, Avx2Pack position) {
        return {_mm256_or_pd(_mm256_andnot_pd(low(), square.a), position.a),
                _mm256_or_pd(_mm256_andnot_pd(low(), square.b), position.b)};
    }

    // Rows are loaded whole and transposed, because the gather instruction is many times slower on processors that
    // are patched against Downfall.
    template <class Row>
    static void read(const Row& row, Avx2Pack& depth, Avx2Pack& toolface, Avx2Pack& radius) {
        const auto four = [&](int i, __m256d& d, __m256d& t, __m256d& r) {
            const __m256d r0 = _mm256_load_pd(&row(i).depth), r1 = _mm256_load_pd(&row(i + 1).depth);
            const __m256d r2 = _mm256_load_pd(&row(i + 2).depth), r3 = _mm256_load_pd(&row(i + 3).depth);
            const __m256d low_01 = _mm256_unpacklo_pd(r0, r1), low_23 = _mm256_unpacklo_pd(r2, r3);
            d = _mm256_permute2f128_pd(low_01, low_23, 0x20);
            r = _mm256_permute2f128_pd(low_01, low_23, 0x31);
            t = _mm256_permute2f128_pd(_mm256_unpackhi_pd(r0, r1), _mm256_unpackhi_pd(r2, r3), 0x20);
        };
        four(0, depth.a, toolface.a, radius.a);
        four(4, depth.b, toolface.b, radius.b);
    }

    static int store_indices(unsigned bits, std::int32_t first, std::int32_t* out) {
        return store_set_bits(bits, first, out);
    }
};

}  // namespace
}  // namespace helibore::kernel
