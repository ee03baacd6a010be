// Texts of the places and values that input errors name, and checks of the rules that many arguments share.
#pragma once

#include <charconv>
#include <cmath>
#include <span>
#include <string>

#include "helibore/error.hpp"
#include "helibore/types.hpp"

namespace helibore {

// Returns the shortest text that reads back as the same number, whatever the host's locale; "nan" for any NaN.
inline std::string number_text(double value) {
    if (std::isnan(value)) return "nan";
    char text[32];
    return {text, std::to_chars(text, text + sizeof text, value).ptr};
}

// Returns the number with six significant digits, like Python's :g.
inline std::string short_text(double value) {
    if (std::isnan(value)) return "nan";
    char text[32];
    return {text, std::to_chars(text, text + sizeof text, value, std::chars_format::general, 6).ptr};
}

// Returns a text such as "toolface[17]".
inline std::string entry_name(const std::string& column, Index index) {
    return column + "[" + std::to_string(index) + "]";
}

// Returns a text such as "toolface[17] = nan".
inline std::string entry_text(const std::string& column, Index index, double value) {
    return entry_name(column, index) + " = " + number_text(value);
}

// Returns a text such as "[3, 7)".
inline std::string range_text(const Range& range) {
    std::string text = "[";
    return text.append(std::to_string(range.start)).append(", ").append(std::to_string(range.stop)).append(")");
}

// Returns the error for one value of a column.
inline InputError entry_error(const std::string& column, Index index, double value, const std::string& rule) {
    return {entry_name(column, index), rule, number_text(value)};
}

// Depths must lie within this many metres of 0. No hole is that deep, doubles resolve such depths to 2 nanometres, and
// squares of distances stay finite.
inline constexpr double largest_depth = 1e7;
inline constexpr const char* depth_rule = "must lie in -10000000 to 10000000 m";

inline void require(bool good, const std::string& place, double value, const std::string& rule) {
    if (!good) throw InputError(place, rule, number_text(value));
}
inline void require(bool good, const std::string& place, Index value, const std::string& rule) {
    if (!good) throw InputError(place, rule, std::to_string(value));
}

inline void require_depth(const std::string& place, double depth) {
    require(std::isfinite(depth), place, depth, "must be finite");
    require(std::abs(depth) <= largest_depth, place, depth, depth_rule);
}

inline void require_sectors(int sectors) {
    require(sectors >= 3, "sectors", Index{sectors}, "must be 3 or more");
    require(sectors <= 1000000, "sectors", Index{sectors}, "must be at most 1000000");
}

inline void require_pitch(double pitch) {
    require(std::isfinite(pitch) && pitch != 0.0, "pitch", pitch, "must be finite and not 0");
    require(std::abs(pitch) <= largest_depth, "pitch", pitch, depth_rule);
}

// Checks `first`: the number, on the whole helix, of the first vertex of a part of a wall.
inline void require_first(const char* name, Index first, Index sectors) {
    require(first >= 0 && first <= Index{1} << 40, name, first, "must lie in 0 to 1099511627776");
    require(first % sectors == 0, name, first, "must be a multiple of sectors");
}

inline void require_finite(const char* name, std::span<const double> values) {
    for (std::size_t i = 0; i < values.size(); ++i)
        if (!std::isfinite(values[i])) throw entry_error(name, static_cast<Index>(i), values[i], "must be finite");
}

inline void require_depths(std::span<const double> depth) {
    require_finite("depth", depth);
    for (std::size_t i = 0; i < depth.size(); ++i)
        if (!(std::abs(depth[i]) <= largest_depth))
            throw entry_error("depth", static_cast<Index>(i), depth[i], depth_rule);
}

// Throws InputError unless the values never fall; a NaN between two values is also an error.
inline void require_order(const char* name, std::span<const double> values) {
    for (std::size_t i = 1; i < values.size(); ++i) {
        if (values[i] >= values[i - 1]) continue;
        const auto at = static_cast<Index>(i);
        throw entry_error(name, at, values[i], "must not be less than " + entry_text(name, at - 1, values[i - 1]));
    }
}

inline constexpr Index largest_count = (Index{1} << 31) - 1;  // of vertices or quads

inline void require_vertex_count(Index count) {
    require(count >= 0, "count", count, "must not be negative");
    require(count <= largest_count, "count", count, "must be at most 2147483647");
}

// Throws InputError if the lengths differ: "toolface has 2 values, depth has 3: must be equal".
inline void require_length(const std::string& name, std::size_t size, std::size_t wanted, const char* other = "depth") {
    if (size == wanted) return;
    throw InputError(name + " has " + std::to_string(size) + " values, " + other + " has " + std::to_string(wanted),
                     "must be equal");
}

}  // namespace helibore
