// The border between the search (ordinary C++) and its innermost loops, which are compiled once for each instruction
// set (kernel_plain.cpp, kernel_avx2.cpp, kernel_avx512.cpp) from one text (kernel_body.hpp). Only plain old structs
// cross it, and nothing here includes the standard containers: a wide translation unit must not leak inline functions.
//
// Eight consecutive vertices of the helix form a group. They share one list of candidates:
//
//     toolface ->                          h = half height of the list beyond the group
//     +------------------------------+     w = half width of the list beyond the group, degrees
//     |   .   :    .      .   .      |
//     |  .  1  2  3  4  5  6  7  8  .|     every sample outside the box is at least min(h, c w) away from
//     |    .     .    :     .     .  |     every vertex of the group, c = metres a degree at its radius
//     +------------------------------+
//
// A vertex is done when its farthest neighbour is nearer than that; otherwise the box grows.
#pragma once

#include <cstdint>

namespace helibore::kernel {

inline constexpr int lanes = 8;

// A candidate's position in the list rides in the low 12 bits of its squared distance: one number is both the sorting
// key and the payload. Squared distances that agree to 2^-40 are ties, decided by position, that is canonical order.
inline constexpr int position_bits = 12;
inline constexpr std::int64_t list_capacity = (std::int64_t{1} << position_bits) - 1;  // the last position is "none"
inline constexpr int max_neighbors = 256;

// Squares up to this are distances of 0 (1e-20 m): products of eight larger ones stay in the range of a double.
inline constexpr double zero_square = 1e-40;

// Squares larger than any real squared distance: no such candidate, no such limit.
inline constexpr double missing_square = 1e300;
inline constexpr double boundless_square = 1e301;

inline constexpr double none_depth = 1e150;  // squared: missing_square

// Columns of list_capacity + 1 values and `lanes` more of slack for whole-vector stores.
// Positions from count on, up to the next multiple of 8 and at list_capacity itself, hold "none": depth none_depth,
// toolface and radius 0.
struct CandidateList {
    double* depth;
    double* toolface;
    double* radius;
    double* rank;            // canonical rank less an offset the caller knows; read in window mode only
    const double* position;  // the bits of the integers 0, 1, 2, ...
    std::int64_t count;
};

struct Rules {
    int neighbors;
    int max_iterations;
    double tolerance;
    double power;
    double max_square;  // max_distance squared, at most boundless_square
    double scale;       // metres a degree at one metre of radius: angular_scale pi / 180
    bool windowed;
};

struct Group {
    double depth[lanes];
    double toolface[lanes];
    double window_first[lanes];  // ranks less first_rank, window mode only: candidates in [first, last) count
    double window_last[lanes];
    double trial[lanes];      // the radius the next estimate starts from
    double discarded[lanes];  // least squared distance, at `trial`, among candidates the list no longer holds
    double radius[lanes];
    double nearest[lanes];
    double support[lanes];
    double iterations[lanes];
    double reach_square[lanes];  // largest squared distance at which one more sample would have changed an estimate
    double active[lanes];        // 1 while the lane is not done, else 0
};

struct Box {
    double height;  // h, metres; infinity when all depths are in the list
    double width;   // w, degrees; infinity when all toolfaces are in the list
    bool wraps;     // may a candidate lie across 0/360 from a vertex of the group?
};

enum class Verdict : int {
    done,     // all lanes converged
    widen,    // some lane's neighbours may lie outside the box
    refetch,  // the radius moved so far that discarded candidates may count again
};

enum class Order : int { falls, level, rises };  // some value below the one before; some equal; all above

struct Functions {
    const char* name;
    // Do all values lie in [low, high]? NaN does not.
    bool (*all_within)(const double* values, std::int64_t n, double low, double high);
    Order (*order)(const double* values, std::int64_t n);
    // Appends the samples whose toolface lies within half_width of center (any, if that is 180 or more), and returns
    // how many of the n were read: fewer than n only if the list is full.
    std::int64_t (*gather)(CandidateList& list, const double* depth, const double* toolface, const double* radius,
                           std::int64_t n, double center, double half_width, bool wraps);
    // Iterates every active lane until it converges, or until the list cannot decide.
    Verdict (*estimate)(Group& group, const CandidateList& list, const Rules& rules, const Box& box);
    // Marks in keep[position] the candidates that are among some lane's nearest, and lowers group.discarded to the
    // nearest of the others.
    void (*nominate)(Group& group, const CandidateList& list, const Rules& rules, unsigned char* keep);
};

const Functions& plain();
const Functions& avx2();    // the plain functions where the compiler does not target x86-64
const Functions& avx512();  // likewise

}  // namespace helibore::kernel
