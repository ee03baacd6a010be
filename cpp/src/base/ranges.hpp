// Sorted lists of half-open ranges that are not empty and do not touch each other.
#pragma once

#include <algorithm>
#include <vector>

#include "helibore/types.hpp"

namespace helibore {

// Adds a range to the end of a list, and merges it with the last range if they touch. It must not start before the last
// range starts.
inline void add_range(std::vector<Range>& ranges, Range range) {
    if (range.start >= range.stop) return;
    if (!ranges.empty() && range.start <= ranges.back().stop)
        ranges.back().stop = std::max(ranges.back().stop, range.stop);
    else
        ranges.push_back(range);
}

// Returns the union of ranges, which may be in any order.
inline std::vector<Range> union_of(std::vector<Range> ranges) {
    std::sort(ranges.begin(), ranges.end(), [](const Range& a, const Range& b) { return a.start < b.start; });
    std::vector<Range> found;
    for (const Range& range : ranges) add_range(found, range);
    return found;
}

// Returns `ranges` followed by `more`, unsorted.
inline std::vector<Range> concatenated(std::vector<Range> ranges, const std::vector<Range>& more) {
    ranges.insert(ranges.end(), more.begin(), more.end());
    return ranges;
}

}  // namespace helibore
