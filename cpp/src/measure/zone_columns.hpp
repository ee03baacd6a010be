// Zones as columns of numbers, for the C interface and the page.
#pragma once

#include <cstddef>
#include <vector>

#include "helibore/zones.hpp"

namespace helibore {

// Copies the zones column after column, in the order of zones.hpp: 20 numbers for each.
inline void fill_zones(const std::vector<Zone>& zones, double* into) {
    const auto put = [&](const auto& of) {
        for (const Zone& zone : zones) *into++ = static_cast<double>(of(zone));
    };
    put([](const Zone& zone) { return static_cast<int>(zone.kind); });
    for (double Zone::* const member : {&Zone::start, &Zone::stop, &Zone::measure, &Zone::median, &Zone::severity,
                                        &Zone::enlargement, &Zone::elongation, &Zone::peak, &Zone::coverage,
                                        &Zone::confidence, &Zone::pipe_diameter, &Zone::toolface, &Zone::deviation})
        put([member](const Zone& zone) { return zone.*member; });
    for (const std::size_t side : {0U, 1U})
        for (double ZoneLobe::* const member : {&ZoneLobe::toolface, &ZoneLobe::opening, &ZoneLobe::height})
            put([side, member](const Zone& zone) { return zone.lobes[side].*member; });
}

}  // namespace helibore
