// The parts of a wall. wall.cpp changes them, read.cpp reads them; both hold the lock.
#pragma once

#include <array>
#include <cstdint>
#include <limits>
#include <memory>
#include <utility>
#include <vector>

#include "base/locks.hpp"
#include "helibore/wall.hpp"
#include "samples/samples.hpp"
#include "search/search.hpp"
#include "wall/direct.hpp"
#include "wall/vertices.hpp"

namespace helibore {

inline constexpr Index lanes = kernel::lanes;
inline constexpr Index groups_a_part = 16;  // groups that a thread takes at a time

inline Index groups_of(Index vertices) {
    return (vertices + lanes - 1) / lanes;
}

struct Wall::State {
    explicit State(const Settings& s) : settings(s), search((s.validate(), s)), vertices(s.sigma) {
        if (s.start_depth) helix.start_depth = *s.start_depth;
        scratches.resize(static_cast<std::size_t>(s.threads));
    }

    Change append(const SampleColumns& columns);
    Change update(const SortedBatch& batch);
    Helix helix_now() const;
    Index count_now(const Helix& next) const;
    void measure_hulls(const std::vector<Index>& old, Index kept);
    bool advances(const SortedBatch& batch) const;
    bool reaches(const SortedBatch& batch, Index group) const;
    std::vector<Index> touched_groups(const SortedBatch& batch, Index open) const;
    void search_groups(const Helix& on, const std::vector<Index>& old, Range fresh, Index vertex_count, Vertices& into,
                       std::vector<GroupResult>& staged);
    std::vector<Range> compare(const std::vector<Index>& groups, const std::vector<GroupResult>& staged,
                               Index new_count, const DirectRadii& next_direct) const;
    Index settled_after(const Helix& on, const Vertices& of, Index from, Index vertex_count,
                        const std::vector<Index>& old, const std::vector<GroupResult>& staged) const;

    // These functions read a range of vertices, or return a range; most are defined in read.cpp.
    Range all() const { return {0, count}; }
    Range local(Range range) const;  // converts numbers on the whole helix to numbers in this wall
    VertexColumns read(Range range) const;
    void read(Column column, Range range, double* into) const;
    std::vector<double> depth(Range range) const;
    std::vector<double> toolface(Range range) const;
    std::vector<double> radius(Range range) const;
    std::vector<double> nearest(Range range) const;
    std::vector<std::int32_t> support(Range range) const;
    std::vector<std::int32_t> iterations(Range range) const;
    std::vector<std::uint8_t> provisional(Range range) const;

    mutable CallLock lock{"wall"};
    Settings settings;
    Search search;
    Samples samples;
    Helix helix{.start_depth = std::numeric_limits<double>::quiet_NaN()};
    Vertices vertices;
    Index count = 0;
    Index settled = 0;
    double far_end = std::numeric_limits<double>::quiet_NaN();  // depth of the last sample when `settled` was computed
    DirectRadii direct;
    std::vector<Search::Scratch> scratches;
};

}  // namespace helibore
