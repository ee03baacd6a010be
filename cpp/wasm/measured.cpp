// Which vertices of a wall are measured (logs.hpp), for the page: the C interface has no such call.
#include <algorithm>
#include <span>

#include "helibore/error.hpp"
#include "helibore/logs.hpp"

// helix: start depth, start toolface, pitch. rule: the members of MeasuredRule. depth, toolface, radius: of n samples,
// in order of depth. wall, found: radius and result of each vertex. Returns 0, or 1 for an error.
extern "C" __attribute__((visibility("default"))) int page_measured(const double* helix, int sectors, int count,
                                                                    const double* rule, int n, const double* depth,
                                                                    const double* toolface, const double* radius,
                                                                    const double* wall, std::uint8_t* found) {
    try {
        const auto samples = static_cast<std::size_t>(n), vertices = static_cast<std::size_t>(count);
        const auto marks = helibore::measured(
            {helix[0], helix[1], helix[2], sectors, count, 0}, {{depth, samples}, {toolface, samples}},
            {rule[0], rule[1], rule[2], rule[3], rule[4]}, 1, {{radius, samples}, {wall, vertices}});
        std::ranges::transform(marks, found, [](std::uint8_t mark) { return mark == 1; });
        return 0;
    } catch (const helibore::InputError&) {
        return 1;
    }
}
