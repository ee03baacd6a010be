// Packs of eight doubles and eight floats for every machine, in vectors of 16 bytes: the vector types of GCC and Clang,
// which become SSE2, NEON or WebAssembly's simd128.
#pragma once

#ifdef __SSE2__
#include <emmintrin.h>
#elif defined(__aarch64__)
#include <arm_neon.h>
#elif defined(__wasm_simd128__)
#include <wasm_simd128.h>
#endif

#include "search/kernel/kernel.hpp"

namespace helibore::kernel {
namespace {

using Double2 = double __attribute__((vector_size(16)));
using Float4 = float __attribute__((vector_size(16)));
using Long2 = std::int64_t __attribute__((vector_size(16)));
using Int4 = std::int32_t __attribute__((vector_size(16)));

// Returns the vector that has the same bits.
template <class To, class From>
inline To bits_as(From x) {
    return reinterpret_cast<To>(x);
}

inline Double2 square_root(Double2 x) {
#ifdef __SSE2__
    return _mm_sqrt_pd(x);
#elif defined(__aarch64__)
    return vsqrtq_f64(x);
#elif defined(__wasm_simd128__)
    return bits_as<Double2>(wasm_f64x2_sqrt(bits_as<v128_t>(x)));
#else
    return Double2{__builtin_sqrt(x[0]), __builtin_sqrt(x[1])};
#endif
}

// The number at p and those behind it.
template <class Vector, class Number>
inline Vector vector_at(const Number* p) {
    Vector v;
    __builtin_memcpy(&v, p, sizeof v);
    return v;
}

struct PlainNarrow {
    static constexpr int width = 8, candidates = 1;
    using Single = PlainNarrow;
    Float4 v[2];

    PlainNarrow() = default;
    PlainNarrow(Float4 low_half, Float4 high_half) : v{low_half, high_half} {}
    explicit PlainNarrow(float x) : v{Float4{x, x, x, x}, Float4{x, x, x, x}} {}

    static PlainNarrow load(const float* p) { return {vector_at<Float4>(p), vector_at<Float4>(p + 4)}; }
    void store(float* p) const { __builtin_memcpy(p, v, sizeof v); }
    // Returns how many of the first n keys are at most x; keys may be read up to the next multiple of sixteen.
    static int count_at_most(const float* keys, int n, float x) {
        const Float4 most{x, x, x, x};
        Int4 count[4] = {};
        for (int i = 0; i < n; i += 16)
            for (int j = 0; j < 4; ++j) count[j] -= bits_as<Int4>(vector_at<Float4>(keys + i + 4 * j) <= most);
        const Int4 all = count[0] + count[1] + (count[2] + count[3]);
        return all[0] + all[1] + all[2] + all[3];
    }
    unsigned at_most(float x) const {
        const PlainNarrow most(x);
#ifdef __SSE2__
        const auto four = [&](int i) {
            return static_cast<unsigned>(_mm_movemask_ps(bits_as<Float4>(v[i] <= most.v[i])));
        };
        return four(0) | four(1) << 4;
#else
        const Int4 bits = (bits_as<Int4>(v[0] <= most.v[0]) & Int4{1, 2, 4, 8}) |
                          (bits_as<Int4>(v[1] <= most.v[1]) & Int4{16, 32, 64, 128});
        return static_cast<unsigned>(bits[0] | bits[1] | bits[2] | bits[3]);
#endif
    }
    static PlainNarrow each_vertex(PlainNarrow x) { return x; }
    static PlainNarrow each_candidate(const float* p) { return PlainNarrow(*p); }
    Single candidate(int) const { return *this; }

    friend PlainNarrow operator+(PlainNarrow x, PlainNarrow y) { return {x.v[0] + y.v[0], x.v[1] + y.v[1]}; }
    friend PlainNarrow operator-(PlainNarrow x, PlainNarrow y) { return {x.v[0] - y.v[0], x.v[1] - y.v[1]}; }
    friend PlainNarrow operator*(PlainNarrow x, PlainNarrow y) { return {x.v[0] * y.v[0], x.v[1] * y.v[1]}; }
    static PlainNarrow min(PlainNarrow x, PlainNarrow y) {
        return {x.v[0] < y.v[0] ? x.v[0] : y.v[0], x.v[1] < y.v[1] ? x.v[1] : y.v[1]};
    }
    static PlainNarrow max(PlainNarrow x, PlainNarrow y) {
        return {x.v[0] > y.v[0] ? x.v[0] : y.v[0], x.v[1] > y.v[1] ? x.v[1] : y.v[1]};
    }

    static constexpr std::int32_t low = (std::int32_t{1} << narrow_position_bits) - 1;
    template <class F>
    static PlainNarrow of_bits(F f) {
        return {bits_as<Float4>(f(0)), bits_as<Float4>(f(1))};
    }
    Int4 bits(int half) const { return bits_as<Int4>(v[half]); }
    static PlainNarrow tag(PlainNarrow square, PlainNarrow position) {
        return of_bits([&](int half) { return (square.bits(half) & ~low) | position.bits(half); });
    }
    // Returns 1 + position * 2^-23 for each key: normal floats, in the order of the positions.
    static PlainNarrow position_key(PlainNarrow key) {
        return of_bits([&](int half) { return (key.bits(half) & low) | PlainNarrow(1.0f).bits(half); });
    }
    void store_positions(std::int32_t* at) const {
        const Int4 positions[] = {bits(0) & low, bits(1) & low};
        __builtin_memcpy(at, positions, sizeof positions);
    }
};

struct PlainPack {
    static constexpr int width = 8;
    using Narrow = PlainNarrow;
    struct Mask {
        Long2 m[4];
    };
    Double2 v[4];

    PlainPack() = default;
    explicit PlainPack(double x) : v{Double2{x, x}, Double2{x, x}, Double2{x, x}, Double2{x, x}} {}
    explicit PlainPack(Narrow x) {
        for (int i = 0; i < 4; ++i)
            v[i] = Double2{static_cast<double>(x.v[i / 2][i % 2 * 2]), static_cast<double>(x.v[i / 2][i % 2 * 2 + 1])};
    }
    Narrow narrow() const {
        const auto four = [&](int i) {
            return Float4{static_cast<float>(v[i][0]), static_cast<float>(v[i][1]), static_cast<float>(v[i + 1][0]),
                          static_cast<float>(v[i + 1][1])};
        };
        return {four(0), four(2)};
    }
    template <class F>
    static PlainPack each(F f) {
        PlainPack r;
#pragma GCC unroll 4
        for (int i = 0; i < 4; ++i) r.v[i] = f(i);
        return r;
    }
    template <class F>
    static Mask test(F f) {
        Mask r;
#pragma GCC unroll 4
        for (int i = 0; i < 4; ++i) r.m[i] = bits_as<Long2>(f(i));
        return r;
    }

    static PlainPack load(const double* p) {
        return each([&](int i) { return vector_at<Double2>(p + 2 * i); });
    }
    void store(double* p) const { __builtin_memcpy(p, v, sizeof v); }
    friend PlainPack operator+(PlainPack x, PlainPack y) {
        return each([&](int i) { return x.v[i] + y.v[i]; });
    }
    friend PlainPack operator-(PlainPack x, PlainPack y) {
        return each([&](int i) { return x.v[i] - y.v[i]; });
    }
    friend PlainPack operator*(PlainPack x, PlainPack y) {
        return each([&](int i) { return x.v[i] * y.v[i]; });
    }
    friend PlainPack operator/(PlainPack x, PlainPack y) {
        return each([&](int i) { return x.v[i] / y.v[i]; });
    }
    // Like the x86 instructions, min (max) returns the second operand unless the first is less (greater), also for NaN.
    static PlainPack min(PlainPack x, PlainPack y) {
        return each([&](int i) { return x.v[i] < y.v[i] ? x.v[i] : y.v[i]; });
    }
    static PlainPack max(PlainPack x, PlainPack y) {
        return each([&](int i) { return x.v[i] > y.v[i] ? x.v[i] : y.v[i]; });
    }
    static PlainPack abs(PlainPack x) {
        return of_bits([&](int i) { return x.bits(i) & 0x7fffffffffffffff; });
    }
    static PlainPack sqrt(PlainPack x) {
        return each([&](int i) { return square_root(x.v[i]); });
    }
    static Mask less(PlainPack x, PlainPack y) {
        return test([&](int i) { return x.v[i] < y.v[i]; });
    }
    static Mask less_equal(PlainPack x, PlainPack y) {
        return test([&](int i) { return x.v[i] <= y.v[i]; });
    }
    static Mask both(Mask x, Mask y) {
        return test([&](int i) { return x.m[i] & y.m[i]; });
    }
    // As PlainNarrow::count_at_most; keys may be read up to the next multiple of eight.
    static int count_at_most(const double* keys, int n, double x) {
        const Double2 most{x, x};
        Long2 count[4] = {};
        for (int i = 0; i < n; i += 8)
            for (int j = 0; j < 4; ++j) count[j] -= bits_as<Long2>(vector_at<Double2>(keys + i + 2 * j) <= most);
        const Long2 all = count[0] + count[1] + (count[2] + count[3]);
        return static_cast<int>(all[0] + all[1]);
    }
    static unsigned bits(Mask x) {
#ifdef __SSE2__
        const auto two = [&](int i) { return static_cast<unsigned>(_mm_movemask_pd(bits_as<Double2>(x.m[i]))); };
        return two(0) | two(1) << 2 | two(2) << 4 | two(3) << 6;
#else
        const Long2 all =
            (x.m[0] & Long2{1, 2}) | (x.m[1] & Long2{4, 8}) | (x.m[2] & Long2{16, 32}) | (x.m[3] & Long2{64, 128});
        return static_cast<unsigned>(all[0] | all[1]);
#endif
    }
    static PlainPack blend(Mask m, PlainPack yes, PlainPack no) {
        return each([&](int i) { return m.m[i] ? yes.v[i] : no.v[i]; });
    }

    // Do the same as those of Avx512Pack. 2^52 + n has the integer n in its low bits.
    static PlainPack exponent(PlainPack x) {
        return of_bits([&](int i) { return (x.bits(i) >> 52 & 0xfff) | PlainPack(0x1p52).bits(i); }) -
               PlainPack(0x1p52 + 1023.0);
    }
    static PlainPack mantissa(PlainPack x) {
        return of_bits([&](int i) { return (x.bits(i) & 0xfffffffffffff) | PlainPack(1.0).bits(i); });
    }
    static PlainPack power_of_two(PlainPack n) {
        const PlainPack biased = n + PlainPack(0x1p52 + 1023.0);
        return of_bits([&](int i) { return biased.bits(i) << 52; });
    }

    static constexpr std::int64_t low = (std::int64_t{1} << position_bits) - 1;
    template <class F>
    static PlainPack of_bits(F f) {
        return each([&](int i) { return bits_as<Double2>(f(i)); });
    }
    Long2 bits(int part) const { return bits_as<Long2>(v[part]); }
    static PlainPack tag(PlainPack square, PlainPack position) {
        return of_bits([&](int i) { return (square.bits(i) & ~low) | position.bits(i); });
    }
    // Rows are loaded whole, two at a time, and transposed.
    template <class Row>
    static void read(const Row& row, PlainPack& depth, PlainPack& toolface, PlainPack& radius) {
#pragma GCC unroll 4
        for (int i = 0; i < 4; ++i) {
            const double *a = &row(2 * i).depth, *b = &row(2 * i + 1).depth;
            const Double2 left = vector_at<Double2>(a), right = vector_at<Double2>(b);
            depth.v[i] = Double2{left[0], right[0]};
            toolface.v[i] = Double2{left[1], right[1]};
            radius.v[i] = Double2{a[2], b[2]};
        }
    }

    static int store_indices(unsigned bits, std::int32_t first, std::int32_t* out) {
        return store_set_bits(bits, first, out);
    }
};

}  // namespace
}  // namespace helibore::kernel
