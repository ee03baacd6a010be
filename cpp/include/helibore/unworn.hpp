// The unworn circle of each turn, which the bit left, and the lobes that wore beyond it.
//
//        .-""-.
//      .'      '-.      The circle passes through the rock that did not wear, wherever the tool lay. The area's centre
//     |    +   |  )     will not do: the lobe itself moves it. The height of a vertex is its distance outside the
//     circle.
//      '.      .-'      A lobe is a run of vertices higher than a limit; `pipe` is the circle that fits its bottom: the
//        '-..-'         pipe that wore it, if the lobe is a key seat.
#pragma once

#include <array>
#include <span>
#include <vector>

#include "helibore/logs.hpp"

namespace helibore {

// A lobe of each turn; NaN where there is none. Lengths in metres, angles in degrees as seen from the circle's centre.
struct TurnLobes {
    std::vector<double> toolface;  // in [0, 360), mean weighted by height
    std::vector<double> width;     // of the part above a quarter of the height
    std::vector<double> height;    // the greatest
    std::vector<double> pipe;      // diameter of the circle through the part above 0.35 of the height
};

// One value for each turn; NaN if a radius of the turn is missing, or if fewer than a quarter of its vertices count.
struct UnwornTurns {
    std::vector<double> diameter, centre_0, centre_90;  // of the circle; the centre from the axis
    std::array<TurnLobes, 2> lobes;                     // the highest and the next
};

// Fits the circle to each full turn by iterated weights that fall with the distance from the circle, faster outside it,
// where rock wore, than inside. `bit_diameter` is only a weak guess. `counts` has one entry for each radius; the
// vertices with 0 neither hold the circle nor top a lobe, all others count; empty: all count. The result does not
// depend on `threads`. Throws InputError as `turn_logs`, if `counts` has another length, and unless 1e-50 <=
// bit_diameter <= 1e50 m.
UnwornTurns unworn_turns(const Turns& turns, double bit_diameter, std::span<const double> counts = {}, int threads = 1);

}  // namespace helibore
