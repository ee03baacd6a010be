// The least and the greatest of many values.
#pragma once

#include <algorithm>
#include <cstddef>
#include <limits>

namespace helibore {

// The least and the greatest of many values. Lane i keeps the least and the greatest of the values i, i + 8, ..., so
// that the compiler can use vector instructions. NaN is ignored.
class alignas(64) Extremes {
  public:
    Extremes() {
        std::fill_n(least_, 8, std::numeric_limits<double>::infinity());
        std::fill_n(greatest_, 8, -std::numeric_limits<double>::infinity());
    }

    void take(const double* values, const double* end) {
        Extremes now = *this;  // a copy that `values` cannot overlap
        for (std::size_t i = 0; values + i < end; ++i) now.take(i % 8, values[i], values[i]);
        *this = now;
    }
    void take(const Extremes& others) {
        for (std::size_t i = 0; i < 8; ++i) take(i, others.least_[i], others.greatest_[i]);
    }

    double least() const { return *std::min_element(least_, least_ + 8); }
    double greatest() const { return *std::max_element(greatest_, greatest_ + 8); }

  private:
    void take(std::size_t i, double low, double high) {
        least_[i] = low < least_[i] ? low : least_[i];
        greatest_[i] = high > greatest_[i] ? high : greatest_[i];
    }

    double least_[8], greatest_[8];
};

}  // namespace helibore
