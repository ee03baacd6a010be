// The innermost loops in plain C++.
#include <cstddef>

#include "search/kernel/body.hpp"
#include "search/kernel/likelihood.hpp"
#include "search/kernel/pack_plain.hpp"

namespace helibore::kernel {

const Functions& plain() {
    static constexpr Functions functions = functions_of<PlainPack>("plain");
    return functions;
}

BlockLikelihood plain_likelihood() {
    return &block_likelihood<PlainPack>;
}

}  // namespace helibore::kernel
