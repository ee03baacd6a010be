// What the page needs and the C interface lacks. Each function returns 0, or 1 for an error; its arrays belong to the
// page.
#include <algorithm>
#include <span>

#include "helibore/compression.hpp"
#include "helibore/error.hpp"
#include "helibore/logs.hpp"

namespace {

using helibore::Index;

template <class Work>
int guarded(Work&& work) {
    try {
        work();
        return 0;
    } catch (const helibore::InputError&) {
        return 1;
    }
}

}  // namespace

#define PAGE_API extern "C" __attribute__((visibility("default")))

// Marks the measured vertices (logs.hpp). helix: start depth, start toolface, pitch. rule: the members of MeasuredRule.
// depth, toolface, radius: of n samples, in order of depth. wall, marks: radius and mark of each vertex.
PAGE_API int page_measured(const double* helix, int sectors, int count, const double* rule, int n, const double* depth,
                           const double* toolface, const double* radius, const double* wall, std::uint8_t* marks) {
    return guarded([&] {
        const auto samples = static_cast<std::size_t>(n), vertices = static_cast<std::size_t>(count);
        const auto found = helibore::measured(
            {helix[0], helix[1], helix[2], sectors, count, 0}, {{depth, samples}, {toolface, samples}},
            {rule[0], rule[1], rule[2], rule[3], rule[4]}, 1, {{radius, samples}, {wall, vertices}});
        std::ranges::copy(found, marks);
    });
}

// Measures the full turns of `count` radii, column after column, as hb_wall_logs does.
PAGE_API int page_logs(double start_toolface, int sectors, int count, const double* radius, int window,
                       double* values) {
    return guarded([&] {
        const helibore::TurnLogs logs =
            helibore::turn_logs({start_toolface, sectors, {radius, static_cast<std::size_t>(count)}, Index{window}});
        for (const auto* column : {&logs.coverage, &logs.mean, &logs.mean_square, &logs.smallest, &logs.largest,
                                   &logs.c1, &logs.c1_toolface, &logs.c2, &logs.least_diameter, &logs.diameter_0,
                                   &logs.diameter_90, &logs.centre_0, &logs.centre_90, &logs.inscribed_diameter,
                                   &logs.inscribed_0, &logs.inscribed_90, &logs.enclosing_diameter, &logs.rugosity})
            values = std::ranges::copy(*column, values).out;
    });
}

// Unpacks `count` words of an archive (compression.hpp).
PAGE_API int page_decompress(int size, const std::uint8_t* bytes, int count, std::uint64_t* words) {
    return guarded([&] {
        helibore::decompress({bytes, static_cast<std::size_t>(size)}, {words, static_cast<std::size_t>(count)});
    });
}
