// Checks that the steps of the preparation share.
#pragma once

#include <string>

#include "base/messages.hpp"
#include "helibore/preparation.hpp"

namespace helibore {

// Throws InputError for columns of different lengths, and for a sensor whose column is not among them.
inline void require_columns(const ToolRows& rows, std::span<const ToolSensor> sensors) {
    require_length("toolface", rows.toolface.size(), rows.depth.size());
    for (std::size_t c = 0; c < rows.radii.size(); ++c)
        require_length(entry_name("radii", static_cast<Index>(c)), rows.radii[c].size(), rows.depth.size());
    if (rows.time) require_length("time", rows.time->size(), rows.depth.size());
    const auto columns = static_cast<Index>(rows.radii.size());
    for (std::size_t s = 0; s < sensors.size(); ++s)
        require(sensors[s].column >= 0 && sensors[s].column < columns,
                entry_name("sensors", static_cast<Index>(s)) + ".column", sensors[s].column,
                "must be one of the " + std::to_string(columns) + " columns of radii");
}

}  // namespace helibore
