// Least squares of distances: Gauss and Newton's steps of the radius r and of the place b across, which all turns
// share, and of the place a along the direction, which each turn has alone and which is eliminated.
//
//     e = |p - (a, b)| - r
#include "measure/slots.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace helibore {

namespace {

constexpr double scaled_bit = 0.2159;                             // metres, 8.5 in
constexpr double first_radius = 0.25, least = 0.1, most = 0.501;  // of the circle, shares of the bit diameter
constexpr double most_step = 0.05;                                // share of the bit diameter
constexpr double still = 1e-8;                                    // share of the bit diameter
constexpr int steps = 60;
constexpr double usual_noise = 1e-3, usual_count = 4.0;  // metres: what is thought of the noise before a point is seen
constexpr double least_known = 2e-3;                     // metres; greatest standard deviation of a diameter
constexpr double ridge = 1e-6;                           // keeps turns with one point solvable

// Sums over the points of a turn: a with itself, with b, with r and with e.
struct OfTurn {
    double aa = ridge, ab = 0.0, ar = 0.0, ae = 0.0;
};

}  // namespace

double pipe_diameter(const std::vector<SlotPoint>& points, double bit_diameter) {
    constexpr double missing = std::numeric_limits<double>::quiet_NaN();
    const double scale = bit_diameter / scaled_bit;
    std::vector<std::size_t> places;  // of the turn of each point in `along`
    std::vector<double> along;        // a of each turn
    double radius = first_radius * bit_diameter, across = 0.0;
    for (std::size_t i = 0; i < points.size(); ++i) {
        if (i == 0 || points[i].turn != points[i - 1].turn) along.push_back(points[i].along - radius);
        along.back() = std::max(along.back(), points[i].along - radius);
        places.push_back(along.size() - 1);
    }
    if (points.size() < along.size() + 3) return missing;
    double spread = missing;
    for (int step = 0; step < steps; ++step) {
        std::vector<OfTurn> turns(along.size());
        double bb = ridge, br = 0.0, rr = ridge, be = 0.0, re = 0.0, ee = 0.0;
        for (std::size_t i = 0; i < points.size(); ++i) {
            const double x = points[i].along - along[places[i]], y = points[i].across - across;
            const double away = std::max(std::sqrt(x * x + y * y), still * bit_diameter), e = away - radius;
            const double a = -x / away, b = -y / away;  // the derivative by r is -1
            OfTurn& of = turns[places[i]];
            of.aa += a * a, of.ab += a * b, of.ar -= a, of.ae += a * e;
            bb += b * b, br -= b, rr += 1.0, be += b * e, re -= e, ee += e * e;
        }
        for (const OfTurn& of : turns) {
            bb -= of.ab * of.ab / of.aa, br -= of.ab * of.ar / of.aa, rr -= of.ar * of.ar / of.aa;
            be -= of.ab * of.ae / of.aa, re -= of.ar * of.ae / of.aa;
        }
        const double determinant = bb * rr - br * br;
        if (!(determinant > 0.0)) return missing;
        const double limit = most_step * bit_diameter;
        const double db = std::clamp((br * re - rr * be) / determinant, -limit, limit);
        const double dr = std::clamp((br * be - bb * re) / determinant, -limit, limit);
        for (std::size_t turn = 0; turn < along.size(); ++turn)
            along[turn] -= (turns[turn].ae + turns[turn].ab * db + turns[turn].ar * dr) / turns[turn].aa;
        across += db;
        radius = std::clamp(radius + dr, least * bit_diameter, most * bit_diameter);
        const double free = static_cast<double>(points.size() - along.size() - 2);
        const double usual = usual_noise * scale, variance = (ee + usual_count * usual * usual) / (free + usual_count);
        spread = 2.0 * std::sqrt(variance * bb / determinant);
        if (std::max(std::abs(db), std::abs(dr)) < still * bit_diameter) break;
    }
    return spread <= least_known * scale && 2.0 * radius < bit_diameter ? 2.0 * radius : missing;
}

}  // namespace helibore
