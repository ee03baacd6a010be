// A fast check of many rows, and a slow check that finds the bad row for the error.
#include "samples/row_rules.hpp"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <limits>

#include "base/arithmetic.hpp"
#include "base/messages.hpp"
#include "base/threads.hpp"
#include "search/kernel/instruction_set.hpp"

namespace helibore {
namespace {

constexpr double largest_radius = 2.0;  // metres; a diameter or a value in inches is an error
constexpr double largest = std::numeric_limits<double>::max();
constexpr double least_radius = std::numeric_limits<double>::denorm_min();
constexpr Index rows_a_part = 4096;  // rows that a thread takes at a time

}  // namespace

void check_lengths(const SampleColumns& c) {
    require_length("toolface", c.toolface.size(), c.depth.size());
    require_length("radius", c.radius.size(), c.depth.size());
    if (!c.time.empty()) require_length("time", c.time.size(), c.depth.size());
}

void check_rows(std::span<const SampleColumns> parts) {
    const auto check = [&](const char* name, std::span<const double> SampleColumns::* column, const auto& good,
                           const char* rule) {
        Index row = 0;
        for (const SampleColumns& part : parts)
            for (const double value : part.*column) {
                if (!std::isfinite(value)) throw entry_error(name, row, value, "must be finite");
                if (!good(value)) throw entry_error(name, row, value, rule);
                ++row;
            }
    };
    const auto any = [](double) { return true; };
    check("depth", &SampleColumns::depth, [](double x) { return std::abs(x) <= largest_depth; }, depth_rule);
    check("toolface", &SampleColumns::toolface, any, "");
    check(
        "radius", &SampleColumns::radius, [](double x) { return x > 0.0 && x <= largest_radius; },
        "must be above 0 and at most 2 m");
    check("time", &SampleColumns::time, any, "");
}

bool rows_valid(const SampleColumns& c, const kernel::Functions& f) {
    const auto n = static_cast<Index>(c.depth.size());
    return f.all_within(c.depth.data(), n, -largest_depth, largest_depth) &&
           f.all_within(c.toolface.data(), n, -largest, largest) &&
           f.all_within(c.radius.data(), n, least_radius, largest_radius) &&
           (c.time.empty() || f.all_within(c.time.data(), n, -largest, largest));
}

void SampleColumns::validate(int threads) const {
    const StandardArithmetic standard;
    require_threads(threads);
    check_lengths(*this);
    const auto n = static_cast<Index>(depth.size());
    const kernel::Functions& f = kernel::functions_for(InstructionSet::automatic);
    std::atomic<bool> valid{true};
    for_each_range(threads_for(n, rows_a_thread, threads), n, rows_a_part, [&](int, const Range& rows) {
        const auto start = static_cast<std::size_t>(rows.start), size = static_cast<std::size_t>(rows.stop) - start;
        const SampleColumns some{depth.subspan(start, size), toolface.subspan(start, size), radius.subspan(start, size),
                                 time.empty() ? time : time.subspan(start, size)};
        if (!rows_valid(some, f)) valid = false;
    });
    if (!valid) check_rows({this, 1});
}

}  // namespace helibore
