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

void check_rows(const SampleColumns& c) {
    require_depths(c.depth);
    require_finite("toolface", c.toolface);
    require_finite("radius", c.radius);
    for (std::size_t i = 0; i < c.radius.size(); ++i)
        if (!(c.radius[i] > 0.0 && c.radius[i] <= largest_radius))
            throw InputError(entry_name("radius", static_cast<Index>(i)), "must be above 0 and at most 2 m",
                             number_text(c.radius[i]));
    require_finite("time", c.time);
}

bool rows_valid(const SampleColumns& c, Range rows, const kernel::Functions& f) {
    const Index n = rows.stop - rows.start;
    return f.all_within(c.depth.data() + rows.start, n, -largest_depth, largest_depth) &&
           f.all_within(c.toolface.data() + rows.start, n, -largest, largest) &&
           f.all_within(c.radius.data() + rows.start, n, least_radius, largest_radius) &&
           (c.time.empty() || f.all_within(c.time.data() + rows.start, n, -largest, largest));
}

void SampleColumns::validate(int threads) const {
    const StandardArithmetic standard;
    require_threads(threads);
    check_lengths(*this);
    const auto n = static_cast<Index>(depth.size());
    const kernel::Functions& f = kernel::functions_for(InstructionSet::automatic);
    std::atomic<bool> valid{true};
    for_each_range(threads_for(n, rows_a_thread, threads), n, rows_a_part, [&](int, const Range& rows) {
        if (!rows_valid(*this, rows, f)) valid = false;
    });
    if (!valid) check_rows(*this);
}

}  // namespace helibore
