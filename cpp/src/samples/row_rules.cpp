// The rules of row_rules.hpp: quickly for all rows at once, and slowly for the text of the error.
#include "samples/row_rules.hpp"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <limits>
#include <string>

#include "base/number_text.hpp"
#include "base/threads.hpp"
#include "helibore/error.hpp"
#include "search/kernel/instruction_set.hpp"

namespace helibore {
namespace {

constexpr double largest_radius = 2.0;  // metres; a diameter or a value in inches is refused, not guessed
constexpr double largest = std::numeric_limits<double>::max();
constexpr double least_radius = std::numeric_limits<double>::denorm_min();
constexpr Index rows_a_thread = 32768;  // at least; fewer are not worth its start
constexpr Index rows_a_part = 4096;     // that a thread takes at a time

[[noreturn]] void refuse(const char* column, Index row, double value, const char* rule) {
    throw InputError(std::string(column) + "[" + std::to_string(row) + "] = " + number_text(value) + ": " + rule);
}

// The first row that breaks the rule of a column, or none.
template <class Good>
void check(const char* name, std::span<const double> values, const char* rule, const Good& good) {
    const auto bad = std::find_if_not(values.begin(), values.end(), good);
    if (bad != values.end()) refuse(name, bad - values.begin(), *bad, rule);
}

bool finite(double x) {
    return std::isfinite(x);
}
bool good_radius(double x) {
    return x > 0.0 && x <= largest_radius;
}

}  // namespace

void check_lengths(const SampleColumns& c) {
    const auto same = [&](const char* name, std::size_t n) {
        if (n != c.depth.size())
            throw InputError(std::string(name) + " has " + std::to_string(n) + " values, depth has " +
                             std::to_string(c.depth.size()) + ": must be equal");
    };
    same("toolface", c.toolface.size());
    same("radius", c.radius.size());
    if (!c.time.empty()) same("time", c.time.size());
}

void check_rows(const SampleColumns& c) {
    check("depth", c.depth, "must be finite", finite);
    check("toolface", c.toolface, "must be finite", finite);
    check("radius", c.radius, "must be finite", finite);
    check("radius", c.radius, "must be above 0 and at most 2 m", good_radius);
    check("time", c.time, "must be finite", finite);
}

bool rows_valid(const SampleColumns& c, Range rows, const kernel::Functions& f) {
    const Index n = rows.stop - rows.start;
    return f.all_within(c.depth.data() + rows.start, n, -largest, largest) &&
           f.all_within(c.toolface.data() + rows.start, n, -largest, largest) &&
           f.all_within(c.radius.data() + rows.start, n, least_radius, largest_radius) &&
           (c.time.empty() || f.all_within(c.time.data() + rows.start, n, -largest, largest));
}

void SampleColumns::validate(int threads) const {
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
