// Sector images on quads, against a slow search of all rows for each quad.
#include "helibore/image.hpp"

#include <algorithm>
#include <cmath>

#include "input.hpp"

using helibore::Index;

namespace {

constexpr double missing = std::numeric_limits<double>::quiet_NaN();

double between(double start, double stop, double share) {
    return share == 0.0 ? start : start + share * (stop - start);
}

}  // namespace

void fuzz(Input input) {
    helibore::ImageRows image;
    image.sectors = input.one_in(32) ? input.one_of({0, -1, 1000001}) : input.between(1, 9);
    std::vector<double> depth, low, high, values, sector;
    double at = input.mostly_of({100.0, 0.0});
    const bool rising = !input.one_in(16);
    for (std::size_t n = input.below(24); n > 0; --n) {
        depth.push_back(at);
        low.push_back(at - 0.04);
        high.push_back(at + input.one_of({0.04, 0.0, 0.06}));
        for (int s = 0; s < image.sectors && s < 9; ++s) values.push_back(input.one_in(8) ? missing : input.byte());
        at += rising ? input.one_of({0.1, 0.25, 2.0}) : input.hostile();
    }
    for (std::size_t n = input.below(12); n > 0; --n)
        sector.push_back(input.mostly(input.one_of({1.0, 0.25, 0.77}) * input.between(-20, 40)));
    if (input.one_in(32)) values.push_back(1.0);
    image.depth = depth;
    image.values = values;
    const helibore::QuadCentres quads{.start_depth = input.mostly_of({100.0, 99.0, 101.0}),
                                      .pitch = input.mostly_of({0.1, -0.07, 1.0}),
                                      .count = input.one_in(32) ? -1 : static_cast<Index>(input.below(400)),
                                      .sector = sector};
    const double reach = input.mostly_of({0.2, 0.0, 10.0});
    std::vector<double> cells, linear;
    if (refused([&] {
            cells = cell_values(image, low, high, quads, 1);
            linear = linear_values(image, reach, quads, 1);
        }))
        return;
    require_rule(same_bits(cells, cell_values(image, low, high, quads, 3)), "cells on three threads");
    require_rule(same_bits(linear, linear_values(image, reach, quads, 3)), "linear values on three threads");
    if (!rising) return;
    const auto K = static_cast<Index>(sector.size());
    for (Index k = 0; k < quads.count; ++k) {
        const double centre = quads.start_depth + (static_cast<double>(k) + static_cast<double>(K + 1) / 2.0) *
                                                      (quads.pitch / static_cast<double>(K));
        const double across = sector[static_cast<std::size_t>(k % K)], left = std::floor(across);
        const auto column = static_cast<std::size_t>(left - std::floor(left / image.sectors) * image.sectors);
        const std::size_t width = static_cast<std::size_t>(image.sectors), right = (column + 1) % width;
        const auto cell = [&](std::size_t row, std::size_t s) { return values[row * width + s]; };
        double in_cell = missing, on_line = missing;
        for (std::size_t row = 0; row < depth.size(); ++row) {
            if (low[row] <= centre && centre < high[row]) in_cell = cell(row, column);
            const auto level = [&](std::size_t r) { return between(cell(r, column), cell(r, right), across - left); };
            if (centre == depth[row]) on_line = level(row);
            if (row + 1 < depth.size() && depth[row] < centre && centre < depth[row + 1] &&
                !(depth[row + 1] - depth[row] > 2.0 * reach))
                on_line = between(level(row), level(row + 1), (centre - depth[row]) / (depth[row + 1] - depth[row]));
        }
        const auto i = static_cast<std::size_t>(k);
        const auto equal = [](double a, double b) { return a == b || (std::isnan(a) && std::isnan(b)); };
        require_rule(equal(cells[i], in_cell), "the cell that holds the centre");
        require_rule(equal(linear[i], on_line), "the linear value");
    }
}
