// Two checks, and a count of failures.
//
//     CHECK(wall.size() == 9);
//     CHECK_THROWS(InputError, "pitch = 0: must be finite and not 0", Wall({.bit_diameter = 1, .pitch = 0}));
//     return failures();
#pragma once

#include <cstddef>
#include <iostream>
#include <string>

// Sanitizers make a program 5 to 30 times slower. Tests divide their sizes and repetitions by this.
#ifdef HELIBORE_SMALL_TESTS
inline constexpr std::size_t reduced = 10;
#else
inline constexpr std::size_t reduced = 1;
#endif

inline int& failures() {
    static int count = 0;
    return count;
}

inline void fail(const char* file, int line, const std::string& what) {
    std::cerr << file << ":" << line << ": " << what << "\n";
    ++failures();
}

#define CHECK(condition) ((condition) ? void() : fail(__FILE__, __LINE__, #condition))

#define CHECK_THROWS(exception, text, ...)                                                                   \
    do {                                                                                                     \
        try {                                                                                                \
            static_cast<void>(__VA_ARGS__);                                                                  \
            fail(__FILE__, __LINE__, "did not throw: " #__VA_ARGS__);                                        \
        } catch (const exception& e) {                                                                       \
            if (std::string(e.what()) != (text)) fail(__FILE__, __LINE__, std::string("said: ") + e.what()); \
        }                                                                                                    \
    } while (false)
