// The values of vertices, in blocks, so that a growing hole never copies them.
#pragma once

#include <algorithm>
#include <array>
#include <memory>
#include <vector>

#include "search/search.hpp"

namespace helibore {

class Vertices {
  public:
    static constexpr Index block_size = 4096;
    static constexpr Index groups_per_block = block_size / kernel::lanes;

    struct Block {
        std::array<double, block_size> radius;
        std::array<double, block_size> nearest;
        std::array<std::uint16_t, block_size> support;
        std::array<std::uint8_t, block_size> iterations;
        std::array<double, block_size> reach_square;
        std::array<double, groups_per_block> shallow, deep, near_deep, least_trial;  // as in GroupResult
    };
    // kernel::Sums of the vertices of a block; kept only if Settings::sigma is set.
    using Sums = std::array<std::array<double, block_size>, kernel::sum_count>;

    explicit Vertices(bool with_sums) : with_sums_(with_sums) {}

    // Makes room for vertices [0, count); those below `kept` keep their values.
    void grow(Index count, Index kept) {
        const auto needed = static_cast<std::size_t>(blocks_of(count));
        if (needed > blocks_.capacity()) blocks_.reserve(std::max(needed, 2 * blocks_.capacity()));
        while (blocks_.size() < needed) blocks_.push_back(std::make_unique_for_overwrite<Block>());
        while (with_sums_ && sums_.size() < needed) sums_.push_back(std::make_unique_for_overwrite<Sums>());
        hulls_.resize(static_cast<std::size_t>(blocks_of(kept)));  // drops hulls that a failed append measured
        hulls_.resize(needed);
    }

    static Index blocks_of(Index vertices) { return (vertices + block_size - 1) / block_size; }

    Block& block(Index b) { return *blocks_[static_cast<std::size_t>(b)]; }
    const Block& block(Index b) const { return *blocks_[static_cast<std::size_t>(b)]; }

    void put(Index group, Index vertex_count, const GroupResult& result) {
        Block& to = block(group / groups_per_block);
        const Index g = group % groups_per_block, first = g * kernel::lanes;
        const Index n = std::min<Index>(kernel::lanes, vertex_count - group * kernel::lanes);
        std::copy_n(result.radius, n, to.radius.begin() + first);
        std::copy_n(result.nearest, n, to.nearest.begin() + first);
        std::copy_n(result.support, n, to.support.begin() + first);
        std::copy_n(result.iterations, n, to.iterations.begin() + first);
        std::copy_n(result.reach_square, n, to.reach_square.begin() + first);
        if (with_sums_) {
            const double* from[] = {result.sums.square_weights, result.sums.scatter, result.sums.along,
                                    result.sums.across};
            for (std::size_t s = 0; s < kernel::sum_count; ++s)
                std::copy_n(from[s], n,
                            (*sums_[static_cast<std::size_t>(group / groups_per_block)])[s].begin() + first);
        }
        to.shallow[static_cast<std::size_t>(g)] = result.shallow;
        to.deep[static_cast<std::size_t>(g)] = result.deep;
        to.near_deep[static_cast<std::size_t>(g)] = result.near_deep;
        to.least_trial[static_cast<std::size_t>(g)] = result.least_trial;
    }

    // The depths between which a new sample can change a block; all depths while the block is not measured.
    struct Hull {
        double shallow = -no_limit, deep = no_limit;
    };
    const Hull& hull(Index b) const { return hulls_[static_cast<std::size_t>(b)]; }
    // Measures the hull of a full block.
    void measure_hull(Index b) {
        const Block& of = block(b);
        Hull several[8];  // eight hulls at a time, which the compiler turns into vectors
        std::fill_n(several, 8, Hull{no_limit, -no_limit});
        for (std::size_t g = 0; g < of.deep.size(); ++g) {
            Hull& hull = several[g % 8];
            hull.shallow = of.shallow[g] < hull.shallow ? of.shallow[g] : hull.shallow;
            hull.deep = of.deep[g] > hull.deep ? of.deep[g] : hull.deep;
        }
        Hull all = several[0];
        for (const Hull& hull : several) all = {std::min(all.shallow, hull.shallow), std::max(all.deep, hull.deep)};
        hulls_[static_cast<std::size_t>(b)] = all;
    }

    // Returns one member of the blocks for a range of vertices.
    template <class Out, class T, std::size_t n>
    std::vector<Out> column(std::array<T, n> Block::* member, Range range) const {
        std::vector<Out> out;
        out.reserve(static_cast<std::size_t>(range.stop - range.start));
        for (Index k = range.start; k < range.stop;) {
            const Index first = k % block_size, length = std::min(range.stop - k, block_size - first);
            const auto from = (block(k / block_size).*member).begin() + first;
            out.insert(out.end(), from, from + length);
            k += length;
        }
        return out;
    }

    // Writes one member of the blocks for a range of vertices.
    template <class T, std::size_t n>
    void copy(std::array<T, n> Block::* member, Range range, double* into) const {
        for (Index k = range.start; k < range.stop;) {
            const Index first = k % block_size, length = std::min(range.stop - k, block_size - first);
            into = std::copy_n((block(k / block_size).*member).begin() + first, length, into);
            k += length;
        }
    }

    // Returns one of the kernel's sums (`which`), with a value for each vertex of a block.
    std::span<const double> sum(std::size_t which, Index block) const {
        return (*sums_[static_cast<std::size_t>(block)])[which];
    }

  private:
    bool with_sums_;
    std::vector<std::unique_ptr<Block>> blocks_;
    std::vector<std::unique_ptr<Sums>> sums_;
    std::vector<Hull> hulls_;
};

}  // namespace helibore
