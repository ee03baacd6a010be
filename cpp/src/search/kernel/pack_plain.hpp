// Packs of eight doubles and eight floats in plain C++, for every machine; compilers turn the loops into the vector
// instructions of the machine.
#pragma once

#include "search/kernel/kernel.hpp"

namespace helibore::kernel {
namespace {

// Returns the bits of a number as an integer, or the number that has the bits of an integer.
template <class Bits, class Number>
inline Bits bits_of(Number x) {
    Bits b;
    __builtin_memcpy(&b, &x, sizeof b);
    return b;
}

struct PlainNarrow {
    static constexpr int width = 8;
    static constexpr int candidates = 1;
    using Single = PlainNarrow;
    float v[width];

    PlainNarrow() = default;
    explicit PlainNarrow(float x) : v{x, x, x, x, x, x, x, x} {}
    void store(float* p) const {
        for (int i = 0; i < width; ++i) p[i] = v[i];
    }
    static PlainNarrow load(const float* p) {
        return each([&](int i) { return p[i]; });
    }
    unsigned at_most(float x) const {
        unsigned all = 0;
        for (int i = 0; i < width; ++i) all |= static_cast<unsigned>(v[i] <= x) << i;
        return all;
    }
    static PlainNarrow each_vertex(PlainNarrow x) { return x; }
    static PlainNarrow each_candidate(const float* p) { return PlainNarrow(*p); }
    Single candidate(int) const { return *this; }
    template <class F>
    static PlainNarrow each(F f) {
        PlainNarrow r;
        for (int i = 0; i < width; ++i) r.v[i] = f(i);
        return r;
    }
    friend PlainNarrow operator+(PlainNarrow a, PlainNarrow b) {
        return each([&](int i) { return a.v[i] + b.v[i]; });
    }
    friend PlainNarrow operator-(PlainNarrow a, PlainNarrow b) {
        return each([&](int i) { return a.v[i] - b.v[i]; });
    }
    friend PlainNarrow operator*(PlainNarrow a, PlainNarrow b) {
        return each([&](int i) { return a.v[i] * b.v[i]; });
    }
    static PlainNarrow min(PlainNarrow a, PlainNarrow b) {
        return each([&](int i) { return a.v[i] < b.v[i] ? a.v[i] : b.v[i]; });
    }
    static PlainNarrow max(PlainNarrow a, PlainNarrow b) {
        return each([&](int i) { return a.v[i] > b.v[i] ? a.v[i] : b.v[i]; });
    }

    static constexpr std::int32_t low = (std::int32_t{1} << narrow_position_bits) - 1;
    static std::int32_t bits(float x) { return bits_of<std::int32_t>(x); }
    static PlainNarrow tag(PlainNarrow square, PlainNarrow position) {
        return each([&](int i) { return bits_of<float>((bits(square.v[i]) & ~low) | bits(position.v[i])); });
    }
    // Returns 1 + position * 2^-23 for each key: normal floats, in the order of the positions.
    static PlainNarrow position_key(PlainNarrow key) {
        return each([&](int i) { return bits_of<float>((bits(key.v[i]) & low) | bits(1.0f)); });
    }
    void store_positions(std::int32_t* at) const {
        for (int i = 0; i < width; ++i) at[i] = bits(v[i]) & low;
    }
};

struct PlainPack {
    static constexpr int width = 8;
    using Narrow = PlainNarrow;
    struct Mask {
        bool m[width];
    };
    double v[width];

    PlainPack() = default;
    explicit PlainPack(double x) : v{x, x, x, x, x, x, x, x} {}
    explicit PlainPack(Narrow x) {
        for (int i = 0; i < width; ++i) v[i] = static_cast<double>(x.v[i]);
    }
    Narrow narrow() const {
        return Narrow::each([&](int i) { return static_cast<float>(v[i]); });
    }

    static PlainPack load(const double* p) {
        PlainPack r;
        for (int i = 0; i < width; ++i) r.v[i] = p[i];
        return r;
    }
    void store(double* p) const {
        for (int i = 0; i < width; ++i) p[i] = v[i];
    }
    template <class F>
    static PlainPack each(F f) {
        PlainPack r;
        for (int i = 0; i < width; ++i) r.v[i] = f(i);
        return r;
    }
    template <class F>
    static Mask test(F f) {
        Mask r;
        for (int i = 0; i < width; ++i) r.m[i] = f(i);
        return r;
    }
    friend PlainPack operator+(PlainPack a, PlainPack b) {
        return each([&](int i) { return a.v[i] + b.v[i]; });
    }
    friend PlainPack operator-(PlainPack a, PlainPack b) {
        return each([&](int i) { return a.v[i] - b.v[i]; });
    }
    friend PlainPack operator*(PlainPack a, PlainPack b) {
        return each([&](int i) { return a.v[i] * b.v[i]; });
    }
    friend PlainPack operator/(PlainPack a, PlainPack b) {
        return each([&](int i) { return a.v[i] / b.v[i]; });
    }
    // Like the x86 instructions, min (max) returns the second operand unless the first is less (greater), also for NaN.
    static PlainPack min(PlainPack a, PlainPack b) {
        return each([&](int i) { return a.v[i] < b.v[i] ? a.v[i] : b.v[i]; });
    }
    static PlainPack max(PlainPack a, PlainPack b) {
        return each([&](int i) { return a.v[i] > b.v[i] ? a.v[i] : b.v[i]; });
    }
    static PlainPack abs(PlainPack a) {
        return each([&](int i) { return __builtin_fabs(a.v[i]); });
    }
    static PlainPack sqrt(PlainPack a) {
        return each([&](int i) { return __builtin_sqrt(a.v[i]); });
    }
    static Mask less(PlainPack a, PlainPack b) {
        return test([&](int i) { return a.v[i] < b.v[i]; });
    }
    static Mask less_equal(PlainPack a, PlainPack b) {
        return test([&](int i) { return a.v[i] <= b.v[i]; });
    }
    static Mask both(Mask a, Mask b) {
        return test([&](int i) { return a.m[i] && b.m[i]; });
    }
    static unsigned bits(Mask a) {
        unsigned all = 0;
        for (int i = 0; i < width; ++i) all |= static_cast<unsigned>(a.m[i]) << i;
        return all;
    }
    static PlainPack blend(Mask m, PlainPack yes, PlainPack no) {
        return each([&](int i) { return m.m[i] ? yes.v[i] : no.v[i]; });
    }

    // Does the same as Avx512Pack::exponent.
    static PlainPack exponent(PlainPack x) {
        return each([&](int i) { return static_cast<double>((bits(x.v[i]) >> 52) - 1023); });
    }
    static PlainPack mantissa(PlainPack x) {
        return each([&](int i) { return bits_of<double>((bits(x.v[i]) & 0xfffffffffffff) | bits(1.0)); });
    }
    static PlainPack power_of_two(PlainPack n) {
        return each([&](int i) { return bits_of<double>((static_cast<std::int64_t>(n.v[i]) + 1023) << 52); });
    }

    static constexpr std::int64_t low = (std::int64_t{1} << position_bits) - 1;
    static std::int64_t bits(double x) { return bits_of<std::int64_t>(x); }
    static PlainPack tag(PlainPack square, PlainPack position) {
        return each([&](int i) { return bits_of<double>((bits(square.v[i]) & ~low) | bits(position.v[i])); });
    }
    template <class Row>
    static void read(const Row& row, PlainPack& depth, PlainPack& toolface, PlainPack& radius) {
        for (int i = 0; i < width; ++i) {
            depth.v[i] = row(i).depth;
            toolface.v[i] = row(i).toolface;
            radius.v[i] = row(i).radius;
        }
    }

    static int store_indices(unsigned bits, std::int32_t first, std::int32_t* out) {
        return store_set_bits(bits, first, out);
    }
};

}  // namespace
}  // namespace helibore::kernel
