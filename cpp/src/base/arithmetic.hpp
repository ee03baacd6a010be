// The floating-point state in which all results are computed.
#pragma once

#ifdef __SSE2__
#include <xmmintrin.h>
#else
#include <cfenv>
#endif

namespace helibore {

// Sets rounding to nearest, no traps and subnormals kept, whatever the host has set (Delphi and Pascal hosts unmask
// exceptions, audio and game hosts flush subnormals). Restores the host's state at its end.
class StandardArithmetic {
  public:
    StandardArithmetic(const StandardArithmetic&) = delete;
    StandardArithmetic& operator=(const StandardArithmetic&) = delete;

#ifdef __SSE2__  // MXCSR holds all that matters; fesetenv takes fourteen times as long, and MinGW's does not set MXCSR
    StandardArithmetic() : host_(_mm_getcsr()) { _mm_setcsr(0x1f80); }
    ~StandardArithmetic() { _mm_setcsr(host_); }

  private:
    unsigned host_;
#else
    StandardArithmetic() {
        std::feholdexcept(&host_);
        std::fesetenv(FE_DFL_ENV);
    }
    ~StandardArithmetic() { std::fesetenv(&host_); }

  private:
    std::fenv_t host_;
#endif
};

}  // namespace helibore
