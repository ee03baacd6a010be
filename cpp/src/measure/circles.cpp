// Finds the inscribed and the enclosing circle by exchanging the points that the circle touches. If this fails for the
// inscribed circle, climb() finds it.
#include "measure/circles.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <initializer_list>
#include <optional>
#include <utility>

namespace helibore {
namespace {

constexpr double slack = 1e-13;  // relative, of squared distances: rounding of a circle through three points
constexpr int most_exchanges = 200;

double square_distance(Point a, Point b) {
    return (a.x - b.x) * (a.x - b.x) + (a.y - b.y) * (a.y - b.y);
}

struct Trial {
    Point centre;
    double square;  // of the radius
};

// Returns the circle through three points if its centre lies in their triangle: only such a circle is fixed by all
// three.
std::optional<Trial> through(Point a, Point b, Point c) {
    const double bx = b.x - a.x, by = b.y - a.y, cx = c.x - a.x, cy = c.y - a.y;
    const double twice = 2.0 * (bx * cy - by * cx);
    const double ab = bx * bx + by * by, ac = cx * cx + cy * cy, bc = square_distance(b, c);
    if (twice == 0.0 || ab + ac < bc || ab + bc < ac || ac + bc < ab) return std::nullopt;
    const double x = (cy * ab - by * ac) / twice, y = (bx * ac - cx * ab) / twice;
    return Trial{{a.x + x, a.y + y}, x * x + y * y};
}

Trial across(Point a, Point b) {
    const Point centre{0.5 * (a.x + b.x), 0.5 * (a.y + b.y)};
    return {centre, square_distance(a, centre)};
}

// The point that stops a moving centre, and how far along its direction the centre has moved by then.
struct Stop {
    std::size_t index;
    double along;
};
// Moves a centre in a direction in which it stays equally far from all points in `rests`. Returns the first other point
// that is as near as these, or none if no point ever is.
std::optional<Stop> first_met(const Points& points, Point centre, Point direction,
                              std::initializer_list<std::size_t> rests) {
    const Point held = points[*rests.begin()];
    const double square = square_distance(held, centre);
    std::optional<Stop> stop;
    for (std::size_t i = 0; i < points.size(); ++i) {
        if (std::ranges::find(rests, i) != rests.end()) continue;
        const double towards = direction.x * (points[i].x - held.x) + direction.y * (points[i].y - held.y);
        if (towards <= 0.0) continue;
        const double along = std::max(square_distance(points[i], centre) - square, 0.0) / (2.0 * towards);
        if (!stop || along < stop->along) stop = Stop{i, along};
    }
    return stop;
}

// Moves a centre so that its circle grows: away from the nearest point until a second is as near, then between these
// two until a third is as near, then between the two of these three that are farthest apart, and so on until the centre
// lies in the triangle of the three points it touches.
Circle climb(const Points& points, Point centre) {
    const auto reached = [&] { return Circle{centre, std::sqrt(points.nearest(centre).square)}; };
    const auto go = [&](Point direction, double along) {
        centre = {centre.x + along * direction.x, centre.y + along * direction.y};
    };
    std::size_t a = points.nearest(centre).index;
    const double away = std::sqrt(square_distance(points[a], centre));
    if (away == 0.0) return reached();
    const Point outwards{(centre.x - points[a].x) / away, (centre.y - points[a].y) / away};
    const auto second = first_met(points, centre, outwards, {a});
    if (!second) return reached();
    go(outwards, second->along);
    std::size_t b = second->index;
    for (std::size_t i = 0; i < 4 * points.size(); ++i) {
        const Point A = points[a], B = points[b];
        const double apart = std::sqrt(square_distance(A, B));
        Point between{(A.y - B.y) / apart, (B.x - A.x) / apart};
        if (between.x * (2.0 * centre.x - A.x - B.x) + between.y * (2.0 * centre.y - A.y - B.y) < 0.0) {
            between = {-between.x, -between.y};
        }
        const auto third = first_met(points, centre, between, {a, b});
        if (!third) break;
        go(between, third->along);
        const Point C = points[third->index];
        const double ab = square_distance(A, B), ac = square_distance(A, C), bc = square_distance(B, C);
        if (ab + ac >= bc && ab + bc >= ac && ac + bc >= ab) break;
        if (ab + ac < bc) {
            a = third->index;
        } else if (ab + bc < ac) {
            b = third->index;
        }  // else the third point lies between A and B: the climb goes on with A and B
        if (a == b) break;
    }
    return reached();
}

using Triple = std::array<std::size_t, 3>;

// Returns, of four points, the three that touch the largest circle without the fourth point inside; `joined` is among
// them.
std::optional<std::pair<Triple, Trial>> exchange(const Points& points, const Triple& held, std::size_t joined) {
    std::optional<std::pair<Triple, Trial>> best;
    for (std::size_t leaves = 0; leaves < 3; ++leaves) {
        Triple next = held;
        next[leaves] = joined;
        const auto trial = through(points[next[0]], points[next[1]], points[next[2]]);
        if (!trial || square_distance(points[held[leaves]], trial->centre) < trial->square * (1.0 - slack)) continue;
        if (!best || trial->square > best->second.square) best = {next, *trial};
    }
    return best;
}

}  // namespace

Circle inscribed_circle(const Points& points, Point start) {
    const std::size_t n = points.size(), first = points.nearest(start).index;
    Triple held{first, (first + n / 3) % n, (first + 2 * n / 3) % n};
    auto circle = through(points[held[0]], points[held[1]], points[held[2]]);
    for (int i = 0; circle && i < most_exchanges; ++i) {
        const kernel::Found inside = points.nearest(circle->centre);
        if (inside.square >= circle->square * (1.0 - slack)) return {circle->centre, std::sqrt(inside.square)};
        const auto next = exchange(points, held, inside.index);
        if (!next || !(next->second.square < circle->square)) break;
        held = next->first;
        circle = next->second;
    }
    return climb(points, start);
}

Circle enclosing_circle(const Points& points, Point start) {
    std::array<std::size_t, 4> held{points.farthest(start).index};
    held[1] = points.farthest(points[held[0]]).index;
    std::size_t count = 2;
    Trial circle = across(points[held[0]], points[held[1]]);
    for (int i = 0; i < most_exchanges; ++i) {
        const kernel::Found outside = points.farthest(circle.centre);
        if (outside.square <= circle.square * (1.0 + slack)) break;
        // The new circle touches the violating point and one or two of the held points: the smallest that encloses all
        // of them.
        const Point offender = points[outside.index];
        const auto holds = [&](const Trial& trial) {
            return std::all_of(held.begin(), held.begin() + count, [&](std::size_t at) {
                return square_distance(points[at], trial.centre) <= trial.square * (1.0 + slack);
            });
        };
        std::optional<Trial> best;
        std::array<std::size_t, 4> rests{};
        std::size_t size = 0;
        for (std::size_t a = 0; a < count; ++a) {
            const Trial trial = across(points[held[a]], offender);
            if (holds(trial) && (!best || trial.square < best->square)) {
                best = trial, rests = {held[a], outside.index}, size = 2;
            }
            for (std::size_t b = a + 1; b < count; ++b) {
                const auto triple = through(points[held[a]], points[held[b]], offender);
                if (triple && holds(*triple) && (!best || triple->square < best->square)) {
                    best = triple, rests = {held[a], held[b], outside.index}, size = 3;
                }
            }
        }
        if (!best || !(best->square > circle.square)) break;
        circle = *best, held = rests, count = size;
    }
    return {circle.centre, std::sqrt(std::max(circle.square, points.farthest(circle.centre).square))};
}

}  // namespace helibore
