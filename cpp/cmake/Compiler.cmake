# The flags with which every target of helibore is built. Results must be the same bits on every compiler and
# instruction set, so there is no fused contraction and no fast-math. -fno-math-errno and -fno-trapping-math change no
# result; they only let the compiler inline sqrt and vectorise comparisons.
add_library(helibore_compiler INTERFACE)
target_compile_features(helibore_compiler INTERFACE cxx_std_20)
target_compile_options(helibore_compiler INTERFACE
  -Wall -Wextra -Wpedantic -Wshadow -Wconversion -Wsign-conversion -Wdouble-promotion -Wold-style-cast
  -ffp-contract=off -fno-math-errno -fno-trapping-math)
if(HELIBORE_WARNINGS_AS_ERRORS)
  target_compile_options(helibore_compiler INTERFACE -Werror)
endif()
if(HELIBORE_SANITIZE)
  target_compile_definitions(helibore_compiler INTERFACE HELIBORE_SMALL_TESTS)  # check.hpp
  target_compile_options(helibore_compiler INTERFACE -fsanitize=${HELIBORE_SANITIZE} -fno-omit-frame-pointer
                         -fno-sanitize-recover=all)
  target_link_options(helibore_compiler INTERFACE -fsanitize=${HELIBORE_SANITIZE})
endif()
