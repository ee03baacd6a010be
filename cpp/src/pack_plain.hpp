// A pack of four doubles in plain C++, for every machine; compilers turn the loops into what vectors there are.
#pragma once

#include "kernel.hpp"

namespace helibore::kernel {
namespace {

struct PlainPack {
    static constexpr int width = 4;
    struct Mask {
        bool m[width];
    };
    double v[width];

    PlainPack() = default;
    explicit PlainPack(double x) : v{x, x, x, x} {}

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
    // As the x86 instructions: the second operand where the first is not less (not greater), NaN included.
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
    static bool all(Mask a) { return a.m[0] && a.m[1] && a.m[2] && a.m[3]; }
    static bool any(Mask a) { return a.m[0] || a.m[1] || a.m[2] || a.m[3]; }
    static PlainPack blend(Mask m, PlainPack yes, PlainPack no) {
        return each([&](int i) { return m.m[i] ? yes.v[i] : no.v[i]; });
    }

    static std::int64_t bits(double x) {
        std::int64_t b;
        __builtin_memcpy(&b, &x, sizeof b);
        return b;
    }
    static double number(std::int64_t b) {
        double x;
        __builtin_memcpy(&x, &b, sizeof x);
        return x;
    }
    static constexpr std::int64_t low = (std::int64_t{1} << position_bits) - 1;
    static PlainPack tag(PlainPack square, double position) {
        return each([&](int i) { return number((bits(square.v[i]) & ~low) | bits(position)); });
    }
    // 1 + position 2^-52: ordinary numbers in the order of the positions.
    static PlainPack position_key(PlainPack key) {
        return each([&](int i) { return number((bits(key.v[i]) & low) | bits(1.0)); });
    }
    void store_positions(std::int64_t* at) const {
        for (int i = 0; i < width; ++i) at[i] = bits(v[i]) & low;
    }
    static PlainPack pick(const double* base, const std::int64_t* at) {
        return each([&](int i) { return base[at[i]]; });
    }
    static std::int64_t compress(Mask m, PlainPack a, double* out) {
        std::int64_t n = 0;
        for (int i = 0; i < width; ++i) {
            out[n] = a.v[i];
            n += m.m[i];
        }
        return n;
    }
};

}  // namespace
}  // namespace helibore::kernel
