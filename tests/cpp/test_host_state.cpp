// The host's floating-point state changes no result and stays as the host set it: rounding upwards, flushing subnormals
// to zero, exceptions that trap (Delphi and Pascal hosts unmask them; without care a division by zero would end them).
#include <cfenv>

#include "check.hpp"
#include "hole.hpp"

#ifdef __SSE2__
#include <xmmintrin.h>
#endif

namespace {

using Result = std::vector<std::uint64_t>;

// Checks samples and makes a wall of them: appends in two steps with samples exactly on vertices (distance 0), and
// reads all, in the host's state.
Result work(int threads, const Hole& hole) {
    helibore::Wall wall({.bit_diameter = 0.216, .sectors = 48, .pitch = 0.05, .power = 0.7, .threads = threads});
    hole.all().validate(threads);
    wall.append(hole.rows(0, 1000));
    std::vector<double> radius(static_cast<std::size_t>(wall.size()));
    CHECK(wall.read_radius(radius) == wall.size());
    wall.append(hole.rows(1000, hole.depth.size() - 1000));
    return bits(wall);
}

#ifdef __SSE2__
constexpr unsigned status_flags = 0x3f;  // sticky: whether something was ever inexact is nobody's setting
unsigned host_state() {
    return _mm_getcsr() & ~status_flags;
}
#else
int host_state() {
    return std::fegetround();
}
#endif

template <class Set>
void under(const char* name, const Result& expected, const Hole& hole, const Set& set) {
    for (const int threads : {1, 3}) {
        std::fenv_t normal;
        std::fegetenv(&normal);
        set();
        const auto as_set = host_state();
        const Result result = work(threads, hole);
        const bool restored = host_state() == as_set;
        std::fesetenv(&normal);
        if (!restored) fail(__FILE__, __LINE__, std::string("state not given back: ") + name);
        if (result != expected) fail(__FILE__, __LINE__, std::string("other bits: ") + name);
    }
}

}  // namespace

int main() {
    Hole hole = oval_hole(100'000, 100.0, 30.0);  // enough for all to be shared out
    for (std::size_t i = 0; i < 50; ++i) {        // on vertices, and as near as it gets
        hole.depth[i] = 100.0;
        hole.toolface[i] = i % 2 == 0 ? 0.0 : 1e-300;
    }
    const Result expected = work(1, hole);
    under("as the system starts", expected, hole, [] {});
    under("rounding upwards", expected, hole, [] { std::fesetround(FE_UPWARD); });
    under("rounding towards zero", expected, hole, [] { std::fesetround(FE_TOWARDZERO); });
#ifdef __SSE2__
    under("subnormals flushed", expected, hole, [] { _mm_setcsr(_mm_getcsr() | 0x8040); });
#endif
#ifdef __GLIBC__
    under("exceptions that trap", expected, hole, [] {
        std::feclearexcept(FE_ALL_EXCEPT);
        feenableexcept(FE_DIVBYZERO | FE_INVALID | FE_OVERFLOW);
    });
#endif
    return failures();
}
