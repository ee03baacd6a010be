// Samples of an oval hole with a washout, the same on every machine, and every bit of a wall to compare.
#pragma once

#include <bit>
#include <cmath>
#include <cstdint>
#include <span>
#include <utility>
#include <vector>

#include "helibore/wall.hpp"

struct Hole {
    std::vector<double> depth, toolface, radius, time;

    helibore::SampleColumns rows(std::size_t first, std::size_t count) const {
        const auto part = [&](const std::vector<double>& c) { return std::span(c).subspan(first, count); };
        return {part(depth), part(toolface), part(radius), part(time)};
    }
    helibore::SampleColumns all() const { return rows(0, depth.size()); }
};

inline Hole oval_hole(std::size_t n, double top, double length) {
    Hole hole;
    std::uint64_t state = 12345;
    const auto uniform = [&] {  // Knuth's MMIX generator
        state = state * 6364136223846793005u + 1442695040888963407u;
        return static_cast<double>(state >> 11) / 9007199254740992.0;
    };
    for (std::size_t i = 0; i < n; ++i) {
        const double along = uniform(), turn = 360.0 * uniform();
        hole.depth.push_back(top + length * along);
        hole.toolface.push_back(turn);
        hole.radius.push_back(0.108 + 0.02 * std::abs(turn - 180.0) / 180.0 + (along > 0.6 ? 0.05 : 0.0));
        hole.time.push_back(static_cast<double>(i));
    }
    return hole;
}

// Every bit a caller can read.
inline std::vector<std::uint64_t> bits(const helibore::Wall& wall) {
    std::vector<std::uint64_t> all = {static_cast<std::uint64_t>(wall.size()),
                                      static_cast<std::uint64_t>(wall.sample_count()),
                                      static_cast<std::uint64_t>(wall.settled())};
    const auto add_numbers = [&](const std::vector<double>& values) {
        for (const double value : values) all.push_back(std::bit_cast<std::uint64_t>(value));
    };
    const auto add_counts = [&](const std::vector<std::int32_t>& values) {
        for (const std::int32_t value : values) all.push_back(static_cast<std::uint64_t>(value));
    };
    for (const auto& values : {wall.depth(), wall.toolface(), wall.radius(), wall.nearest()}) add_numbers(values);
    for (const auto& values : {wall.support(), wall.iterations()}) add_counts(values);
    for (const auto& column : wall.samples()) add_numbers(column);
    return all;
}
