// Circles of a section: the largest that fits inside its points, and the smallest around them.
//
// Both rest on two or three points. A circle through such points is tried against all; the worst offender joins, one of
// the others leaves, and the radius goes strictly one way, so that it ends. The inscribed circle grows from the centre
// it is given to the nearest one that no small move makes larger; the enclosing one is unique.
#pragma once

#include <span>

namespace helibore {

struct Point {
    double x = 0.0, y = 0.0;
};
struct Circle {
    Point centre;
    double radius = 0.0;
};

// Points around the origin in the order of their angle, three or more.
Circle inscribed_circle(std::span<const Point> points, Point start);
Circle enclosing_circle(std::span<const Point> points, Point start);

}  // namespace helibore
