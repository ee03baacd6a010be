#include "measure/lobes.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "base/degrees.hpp"
#include "base/exponential.hpp"
#include "helibore/zones.hpp"
#include "samples/helix.hpp"

namespace helibore {

namespace {

// Returns how many steps after the first value the values fall to `floor`, interpolated linearly: 0 if the first value
// is below it, all steps if none is. `at(i)` is value i of `count`.
template <class At>
double crossing(const At& at, std::size_t count, double floor) {
    std::size_t after = 0;
    while (after < count && !(at(after) < floor)) ++after;
    if (after == count) return static_cast<double>(count - 1);
    if (after == 0) return 0.0;
    const double above = at(after - 1), under = at(after);
    return static_cast<double>(after - 1) + (above - floor) / (above - under);
}

}  // namespace

Axis AxisSum::mean() const {
    const auto count = static_cast<double>(count_);
    const double R = std::min(std::sqrt(x_ * x_ + y_ * y_) / count, 1.0);
    double mean = arc_tangent(y_, x_) / degree / 2.0;
    if (mean < 0.0) mean += 180.0;
    const bool known = R >= std::numeric_limits<double>::min();
    const double deviation =
        known ? std::sqrt(std::abs(2.0 * logarithm(R))) / degree / 2.0 : std::numeric_limits<double>::infinity();
    return {mean < 180.0 ? mean : 0.0, count_ > 1 ? deviation : std::numeric_limits<double>::quiet_NaN()};
}

ZoneLobe lobe_of(std::span<const double> height, double toolface, double start, double level) {
    const auto size = static_cast<std::ptrdiff_t>(height.size());
    const double step = 360.0 / static_cast<double>(size);
    const auto first = static_cast<std::ptrdiff_t>(std::ceil((toolface - 90.0 - start) / step)),
               last = static_cast<std::ptrdiff_t>(std::floor((toolface + 90.0 - start) / step));
    std::vector<double> side;
    for (std::ptrdiff_t number = first; number <= last; ++number)
        side.push_back(height[static_cast<std::size_t>((number % size + size) % size)]);
    const auto top = static_cast<std::size_t>(std::ranges::max_element(side) - side.begin());
    const double floor = level * side[top];
    double weights = 0.0, angles = 0.0;
    for (std::size_t i = 0; i < side.size(); ++i) {
        const double weight = std::max(side[i] - floor, 0.0);
        weights += weight,
            angles += weight * (start + static_cast<double>(first + static_cast<std::ptrdiff_t>(i)) * step);
    }
    const double before = crossing([&](std::size_t i) { return side[top - i]; }, top + 1, floor),
                 after = crossing([&](std::size_t i) { return side[top + i]; }, side.size() - top, floor);
    return {wrap_toolface(weights > 0.0 ? angles / weights : toolface), (before + after) * step, side[top]};
}

}  // namespace helibore
