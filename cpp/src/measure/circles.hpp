// Circles of a section: the largest that fits inside its points, and the smallest around them.
//
// Each circle touches two or three points. A trial circle through such points is compared with all points; the point
// that violates it most replaces one of the points that it touches. The radius only grows, or only shrinks, so the
// search ends. The inscribed circle is the one near the given centre that no small move makes larger; the enclosing
// circle is unique.
#pragma once

#include <cstddef>
#include <vector>

#include "search/kernel/kernel.hpp"

namespace helibore {

struct Point {
    double x = 0.0, y = 0.0;
};
struct Circle {
    Point centre;
    double radius = 0.0;
};

// Three or more points around the origin in the order of their angle. The first is repeated at the end to fill whole
// packs.
class Points {
  public:
    Points(std::size_t size, const kernel::Functions& functions)
        : size_(size), x_((size + kernel::lanes - 1) / kernel::lanes * kernel::lanes), y_(x_.size()), f_(functions) {}

    std::size_t size() const { return size_; }
    Point operator[](std::size_t i) const { return {x_[i], y_[i]}; }
    void put(std::size_t i, Point point) {
        x_[i] = point.x;
        y_[i] = point.y;
    }
    // Must be called after all points are put.
    void fill_packs() {
        for (std::size_t i = size_; i < x_.size(); ++i) put(i, (*this)[0]);
    }
    kernel::Found nearest(Point centre) const {
        return f_.nearest(x_.data(), y_.data(), x_.size(), centre.x, centre.y);
    }
    kernel::Found farthest(Point centre) const {
        return f_.farthest(x_.data(), y_.data(), x_.size(), centre.x, centre.y);
    }

  private:
    std::size_t size_;
    std::vector<double> x_, y_;
    const kernel::Functions& f_;
};

Circle inscribed_circle(const Points& points, Point start);
Circle enclosing_circle(const Points& points, Point start);

}  // namespace helibore
