// The axis of two opposite lobes, or the direction of one, among the turns of a zone, and each lobe of their mean
// section.
//
// An axis at a is also an axis at a + 180, so angles are doubled. Mean and spread are those of Mardia:
//
//     mean = 1/2 atan2(sum sin 2a, sum cos 2a)     R = |sum exp(2 i a)| / n     deviation = 1/2 sqrt(-2 ln R)
#pragma once

#include <cstddef>
#include <span>
#include <vector>

namespace helibore {

struct ZoneLobe;

// Degrees.
struct Axis {
    double mean;       // in [0, 180)
    double deviation;  // NaN for fewer than two axes, infinite without a preferred direction
};

// A sum of unit vectors, each at twice the angle of an axis.
class AxisSum {
  public:
    void add(double x, double y) { x_ += x, y_ += y, ++count_; }
    Axis mean() const;

  private:
    double x_ = 0.0, y_ = 0.0;
    std::size_t count_ = 0;
};

// Returns the lobe of a section, searched within a quarter turn to either side of `toolface`. `height`: evenly spaced
// around the hole, the first at `start`, degrees in [0, 360). The opening is that above `level` times the top.
ZoneLobe lobe_of(std::span<const double> height, double toolface, double start, double level);

}  // namespace helibore
