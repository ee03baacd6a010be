// The host's floating-point state, set for a while: rounding, and exceptions that trap.
#pragma once

#include <cfenv>

#include "check.hpp"

inline constexpr int trapped = FE_DIVBYZERO | FE_INVALID | FE_OVERFLOW;

inline void set_host_state(int rounding, bool traps) {
    std::fesetround(rounding);
#ifdef __GLIBC__
    std::feclearexcept(FE_ALL_EXCEPT);
    if (traps) feenableexcept(trapped);
#else
    static_cast<void>(traps);
#endif
}

class HostState {
  public:
    HostState(int rounding, bool traps) {
        std::fegetenv(&before_);
        set_host_state(rounding, traps);
    }
    ~HostState() { std::fesetenv(&before_); }
    HostState(const HostState&) = delete;
    HostState& operator=(const HostState&) = delete;

  private:
    std::fenv_t before_;
};

inline constexpr int roundings[] = {FE_TONEAREST, FE_UPWARD, FE_DOWNWARD, FE_TOWARDZERO};

// Runs a test in every rounding of the host, with exceptions that trap: a call that is refused must not trap, and must
// restore the host's state. The test itself must not divide by zero, nor compare NaN by < or >.
template <class Test>
void in_every_host_state(const Test& test) {
    for (const int rounding : roundings) {
        const HostState state(rounding, true);
#ifdef __GLIBC__
        const int traps = fegetexcept();  // none on most AArch64
#endif
        test();
        CHECK(std::fegetround() == rounding);
#ifdef __GLIBC__
        CHECK(fegetexcept() == traps);
#endif
    }
}
