// The innermost loops for AVX-512; cpp/CMakeLists.txt compiles this file with -mavx512f and related options.
#include <cstddef>

#include "search/kernel/kernel.hpp"

#ifdef __AVX512F__
#include "search/kernel/pack_avx512.hpp"
// body.hpp must be included after the pack that it is compiled for.
#include "search/kernel/body.hpp"
#include "search/kernel/likelihood.hpp"

namespace helibore::kernel {

const Functions& avx512() {
    static constexpr Functions functions = functions_of<Avx512Pack>("avx512");
    return functions;
}

BlockLikelihood avx512_likelihood() {
    return &block_likelihood<Avx512Pack>;
}

}  // namespace helibore::kernel
#else
namespace helibore::kernel {
const Functions& avx512() {
    return plain();
}
BlockLikelihood avx512_likelihood() {
    return plain_likelihood();
}
}  // namespace helibore::kernel
#endif
