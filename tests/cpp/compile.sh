#!/bin/sh
# Compiles the core and its C++ tests in build/cpp, with warnings as errors, and shows the progress; quick if nothing
# changed. `./develop test` does this before pytest starts, because no test has a time limit that compiling fits into;
# tests/python/house/test_cpp.py runs it as well, for who starts pytest alone.
set -eu
cd "$(dirname "$0")/../.."
cmake -S . -B build/cpp -G Ninja -DHELIBORE_TESTS=ON -DHELIBORE_FUZZ=OFF -DHELIBORE_WARNINGS_AS_ERRORS=ON \
    -DCMAKE_BUILD_TYPE=Release >/dev/null
cmake --build build/cpp -j "$(nproc)"
