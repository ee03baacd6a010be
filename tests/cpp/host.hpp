// The host's floating-point state, set for a while: rounding, and exceptions that trap.
#pragma once

#include <cfenv>

class HostState {
  public:
    HostState(int rounding, bool traps) {
        std::fegetenv(&before_);
        std::fesetround(rounding);
#ifdef __GLIBC__
        std::feclearexcept(FE_ALL_EXCEPT);
        if (traps) feenableexcept(FE_DIVBYZERO | FE_INVALID | FE_OVERFLOW);
#else
        static_cast<void>(traps);
#endif
    }
    ~HostState() { std::fesetenv(&before_); }
    HostState(const HostState&) = delete;
    HostState& operator=(const HostState&) = delete;

  private:
    std::fenv_t before_;
};
