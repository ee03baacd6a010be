// The innermost loops for AVX2; cpp/CMakeLists.txt compiles this file with -mavx2.
#include <cstddef>

#include "search/kernel/kernel.hpp"

#ifdef __AVX2__
#include "search/kernel/pack_avx2.hpp"
// body.hpp must be included after the pack that it is compiled for.
#include "search/kernel/body.hpp"
#include "search/kernel/likelihood.hpp"

namespace helibore::kernel {

const Functions& avx2() {
    static constexpr Functions functions = functions_of<Avx2Pack>("avx2");
    return functions;
}

BlockLikelihood avx2_likelihood() {
    return &block_likelihood<Avx2Pack>;
}

}  // namespace helibore::kernel
#else
namespace helibore::kernel {
const Functions& avx2() {
    return plain();
}
BlockLikelihood avx2_likelihood() {
    return plain_likelihood();
}
}  // namespace helibore::kernel
#endif
