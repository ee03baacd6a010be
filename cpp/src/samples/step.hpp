// The step of quantised radii.
#pragma once

#include <algorithm>
#include <cmath>
#include <span>
#include <vector>

namespace helibore {

// Returns the step of which all differences of radii are multiples, to 1 %, metres; 0 if there is none.
inline double step_of(std::span<const double> radius) {
    constexpr double rounding = 1e-9;  // metres; a smaller difference is a rounding error
    std::vector<double> sorted(radius.begin(), radius.end()), gaps;
    std::ranges::sort(sorted);
    for (std::size_t i = 1; i < sorted.size(); ++i)
        if (sorted[i] - sorted[i - 1] > rounding) gaps.push_back(sorted[i] - sorted[i - 1]);
    const double least = gaps.empty() ? 0.0 : std::ranges::min(gaps);
    const auto multiple = [&](double gap) { return std::abs(std::remainder(gap, least)) <= 0.01 * least; };
    return std::ranges::all_of(gaps, multiple) ? least : 0.0;
}

}  // namespace helibore
