// The interface between the search (ordinary C++) and its innermost loops, which are compiled once for each instruction
// set (plain.cpp, avx2.cpp, avx512.cpp) from one text (body.hpp). It has only plain structs and includes no standard
// containers: inline functions compiled for a wide instruction set must not be linked into other code.
//
// Eight consecutive vertices of the helix form a group. They share one list of candidates:
//
//     toolface ->                          h = half height of the list beyond the group
//     +------------------------------+     w = half width of the list beyond the group, degrees
//     |   .   :    .      .   .      |     1 to 8: the vertices; . and : samples
//     |  .  1  2  3  4  5  6  7  8  .|     every sample outside the box is at least min(h, c w) away from
//     |    .     .    :     .     .  |     every vertex of the group, c = metres a degree at the radius of the vertex
//     +------------------------------+
//
// A vertex is done when its farthest neighbour is nearer than this distance; otherwise the box grows. If no sample lies
// within the angle `least_turn` of a vertex, samples above and below the box are at least hypot(h, c least_turn) away.
#pragma once

#include <cstdint>

#include "helibore/uncertainty.hpp"

namespace helibore::kernel {

inline constexpr int lanes = 8;

// The low 12 bits of a candidate's squared distance hold its position in the list: one number is both the sorting key
// and the payload. Squared distances that agree to 2^-40 are ties, decided by position, that is by canonical order.
inline constexpr int position_bits = 12;
inline constexpr std::int64_t list_capacity = (std::int64_t{1} << position_bits) - 1;  // the last position is "none"
inline constexpr int max_neighbors = 256;
inline constexpr int max_kriged = 64;  // neighbours of an estimate by kriging

// Few neighbours in short lists are found with floats first, at half the cost, with the position in the low 8 bits.
// Doubles decide what floats cannot tell apart, so the result does not depend on which of the two found the neighbours.
inline constexpr int most_narrow = 16;  // neighbours
inline constexpr int narrow_position_bits = 8;
inline constexpr std::int64_t narrow_capacity = (std::int64_t{1} << narrow_position_bits) - 16;

// Squares up to this are distances of 0 (1e-20 m): products of eight larger ones stay in the range of a double.
inline constexpr double zero_square = 1e-40;

// Squares larger than any real squared distance; they stand for a missing candidate and for no limit.
inline constexpr double missing_square = 1e300;
inline constexpr double boundless_square = 1e301;

// Squares of distances and of differences of radii below this are rounding errors (1e-9 m).
inline constexpr double rounding_square = 1e-18;

inline constexpr double metres_a_degree = 0.017453292519943295;  // on a circle of 1 m radius

inline constexpr double none_depth = 1e150;  // squared: missing_square
inline constexpr float narrow_none = 1e18f;  // squared: more than any real squared distance, and finite

struct alignas(32) Candidate {
    double depth, toolface, radius;
    std::int64_t rank;  // in canonical order
};

// Memory in which an estimate stores its neighbours and candidates; it is too large for the stack of a thread.
struct alignas(64) Room {
    double neighbours[5 * max_neighbors * lanes];  // struct Neighbours
    float keys[list_capacity + 17];
    double exact[list_capacity + lanes + 1];
    std::int32_t passed[list_capacity + 32];
};

// The equations of an estimate by kriging, for eight vertices.
struct alignas(64) KrigingRoom {
    double values[lanes * (max_kriged * (max_kriged + 3) + 2)];
};

// The equations of a group that shares its neighbours, and the factors of eight rows of the elimination.
inline constexpr int most_shared = 21;    // of Settings::neighbors
inline constexpr int max_shared = 160;    // neighbours: 2 * lanes * 8 + 32 at most; a multiple of `lanes`
inline constexpr int most_averaged = 32;  // samples of a neighbour

// A neighbour that the vertices of a group share: the mean of so many samples.
struct alignas(64) SharedNeighbor : Candidate {
    double count;
};

struct alignas(64) SharedRoom {
    double row[max_shared][max_shared + 2 * lanes];
    double factors[max_shared * lanes];
};

// Settings::covariance, as the kernel reads it: squares of distances times these factors are 3 h^2.
inline constexpr int max_terms = 3;
struct CovarianceRule {
    int terms;  // 2 or 3
    double variance[max_terms];
    double around[max_terms];  // 3 (2 R / around)^2: of the squared sine of half the toolface difference
    double along[max_terms];   // 3 / along^2
    double noise, radius;      // radius: R
    double turn;               // degrees a metre: the shape turns so much along the hole
    bool half_turns;           // the second term repeats after half a turn
    bool smooth;               // the first term is v exp(-h^2 / 2)
};

// Columns of list_capacity + 1 values; `across` and `along` have 16 more, which may be read. Positions from count on,
// up to the next multiple of 16, and list_capacity itself hold "none": depth none_depth, toolface and radius 0; in the
// narrow columns 0 and narrow_none.
struct CandidateList {
    Candidate* rows;
    float* across;                 // toolface less the group's center, in [-180, 180]
    float* along;                  // depth less the group's middle
    const double* position;        // doubles with the bits of the integers 0, 1, 2, ...
    const float* narrow_position;  // floats with these bits
    std::int64_t count;
    Room* room;
    KrigingRoom* kriging;        // null unless Rules::range is above 0
    Candidate* found = nullptr;  // if set, receives the neighbours: found[i * lanes + lane], in canonical order
};

// Writes first + i to `out` for each bit i that is set in a mask of 16 bits. Returns how many bits are set; `out` has
// room for 16 numbers.
static inline int store_set_bits(unsigned bits, std::int32_t first, std::int32_t* out) {
    int count = 0;
    for (; bits != 0; bits &= bits - 1) out[count++] = first + __builtin_ctz(bits);
    return count;
}

struct Rules {
    int neighbors;
    int max_iterations;
    double tolerance;
    double power;
    double range, nugget;  // of kriging; range 0: inverse distance
    bool sums;             // whether to compute Group::sums
    // max_square: max_distance squared, on the wall. reach_square: the greatest squared distance in the search's metric
    // of a sample within max_distance. sure_square: no sample beyond max_distance has a smaller squared distance. The
    // three differ only if angular_scale is not 1.
    double max_square, reach_square, sure_square;
    double scale;    // metres a degree on a circle of 1 m radius: angular_scale pi / 180
    double unscale;  // 1 / angular_scale^2
    bool windowed;
};

// The uncertainty of the radius of each vertex is computed from these sums: the sum of the squared weights, and the
// mean squares over the neighbours of their radius minus the estimate, of their distance along the hole, and of their
// distance around the hole, on the wall. NaN without neighbours.
inline constexpr int sum_count = 4;
struct Sums {
    double square_weights[lanes], scatter[lanes], along[lanes], across[lanes];
};

struct Group {
    double center, middle;  // toolface and depth half way between the first vertex and the last
    double depth[lanes];
    double toolface[lanes];
    double window_first[lanes];  // with a window only: the vertex uses positions [first, last) of the list
    double window_last[lanes];
    double trial[lanes];      // the radius the next estimate starts from
    double before[lanes];     // the previous trial; when done, equal to `trial` unless the radius is the mean of both
    double discarded[lanes];  // least squared distance, at `trial`, of the candidates removed from the list
    double radius[lanes];
    double nearest[lanes];
    double support[lanes];
    double iterations[lanes];
    double reach_square[lanes];   // largest squared distance at which one more sample would have changed an estimate
    double least_trial[lanes];    // the smallest radius that an estimate started from
    double least_turn[lanes];     // degrees: a lower bound of the angle to any sample within Box::far
    double height_square[lanes];  // largest squared height h that an estimate needed
    double active[lanes];         // 1 while the lane is not done, else 0
    Sums sums;                    // of lanes that are done and have neighbours
};

struct Box {
    double height;  // h, metres; infinity when all depths are in the list
    double width;   // w, degrees; infinity when all toolfaces are in the list
    double far;     // metres above and below the group where least_turn holds
    // Half the extent of the list around the group's center and middle, for the error of the narrow columns. `narrow`:
    // whether the narrow columns may be used.
    double across, along;
    bool narrow;
    bool wraps;  // whether the shorter way from a vertex to a candidate may lead over center + 180 degrees
};

// Only samples within half_width degrees of the group's center go into the list; all samples, if it is 180 or more.
struct Filter {
    double half_width;
    bool wraps;  // whether 0/360 degrees may lie between such a sample and the center
};

enum class Verdict : int {
    done,     // all lanes converged
    widen,    // some lane's neighbours may lie outside the box
    refetch,  // the radius moved so far that discarded candidates may count again
};

// falls: some value is less than the value before it. level: no value falls, but some are equal. rises: every value is
// greater than the value before it.
enum class Order : int { falls, level, rises };

struct Found {
    std::size_t index;
    double square;
};

struct Functions {
    const char* name;
    // Returns whether all values lie in [low, high]; false if one of the values is NaN.
    bool (*all_within)(const double* values, std::int64_t n, double low, double high);
    Order (*order)(const double* values, std::int64_t n);
    // Return the least (or the greatest) squared distance of n points from (x, y), and the index of the first point at
    // this distance. n is a multiple of `lanes`.
    Found (*nearest)(const double* xs, const double* ys, std::size_t n, double x, double y);
    Found (*farthest)(const double* xs, const double* ys, std::size_t n, double x, double y);
    // Appends to the list those of n samples that pass the filter; `rank` is the rank of the first sample. Returns how
    // many samples were read: fewer than n only if the list is full.
    std::int64_t (*gather)(CandidateList& list, const Group& group, const double* depth, const double* toolface,
                           const double* radius, std::int64_t n, std::int64_t rank, const Filter& filter);
    // Iterates every active lane until it converges, or until a sample outside the list could be a neighbour.
    Verdict (*estimate)(Group& group, const CandidateList& list, const Rules& rules, const Box& box);
    // Sets keep[position] to 1 for the candidates that are among some lane's nearest, and lowers group.discarded to a
    // bound of the squared distances of the other candidates.
    void (*nominate)(Group& group, const CandidateList& list, const Rules& rules, const Box& box, unsigned char* keep);
    // Estimates the group once, at its trial radii, from the candidates at[0], at[lanes], ...: radii and sums.
    void (*estimate_from)(Group& group, const CandidateList& list, const Rules& rules, const std::int32_t* at);
    // Kriges the group by a covariance from n samples that all its vertices share. Sets g.radius, g.nearest (metres on
    // a wall of radius R), and g.sums.square_weights to the kriging variance.
    void (*krige_shared)(Group& group, const SharedNeighbor* rows, int n, const CovarianceRule& rule, SharedRoom& room);
    // Writes the standard uncertainties of n vertices to `sigma`, computed from their sums. n is a multiple of `lanes`.
    void (*sigma)(const double* const sums[sum_count], std::int64_t n, const SigmaRule& rule, double* sigma);
};

const Functions& plain();
const Functions& avx2();    // the plain functions if the compiler does not target x86-64
const Functions& avx512();  // the plain functions if the compiler does not target x86-64

// Samples of one block: sines and cosines of half the toolfaces, depths, radii less their mean. There are `size` of
// each, the next multiple of `lanes`; those from n on are 0.
struct Block {
    int n, size;
    const double *sine, *cosine, *along, *radius;
};

// What the likelihood of a block is made of, with the covariance matrix K, the radii r and
// P = K^-1 - K^-1 1 1' K^-1 / 1' K^-1 1. `parts` are the derivatives of K by the logarithms of the parameters: three of
// each term (variance, around, along) and, last, the noise.
inline constexpr int max_parts = 3 * max_terms + 1;
struct BlockTerms {
    double ones, rest;                     // 1' K^-1 1 and r' P r
    double trace[max_parts];               // of P times the part
    double square[max_parts];              // r' P part P r
    double product[max_parts][max_parts];  // trace of P part P part; only the lower half is set
};

// Memory for blocks of up to `size` samples.
struct BlockRoom {
    double* rows;                  // size rows of 2 size + lanes
    double* factors;               // size rows of size
    double* inverses;              // size: 1 / pivots of K; the determinant is their product
    double* vectors;               // 2 size
    double* parts[max_parts + 1];  // size rows of size, each
};

// Computes the terms of one block, without those of the derivatives unless `slopes`. Returns whether K is positive
// definite.
using BlockLikelihood = bool (*)(const Block& block, const CovarianceRule& rule, bool slopes, const BlockRoom& room,
                                 BlockTerms& terms);
BlockLikelihood plain_likelihood();
BlockLikelihood avx2_likelihood();
BlockLikelihood avx512_likelihood();

}  // namespace helibore::kernel
