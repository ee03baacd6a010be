// What a wall shows: its vertices, scattered attributes on them, the samples it keeps. Owned copies, each of one
// moment.
#include <algorithm>
#include <string>

#include "base/arithmetic.hpp"
#include "base/threads.hpp"
#include "helibore/error.hpp"
#include "wall/state.hpp"

namespace helibore {

namespace {

constexpr Index blocks_a_thread = 64;  // at least; to copy fewer is not worth its start

std::size_t length_of(Range range) {
    return static_cast<std::size_t>(range.stop - range.start);
}

}  // namespace

std::vector<double> Wall::State::depth(Range range) const {
    std::vector<double> out(length_of(range));
    for (Index k = range.start; k < range.stop; ++k) out[static_cast<std::size_t>(k - range.start)] = helix.depth(k);
    return out;
}

std::vector<double> Wall::State::toolface(Range range) const {
    std::vector<double> out(length_of(range));
    for (Index k = range.start; k < range.stop; ++k) out[static_cast<std::size_t>(k - range.start)] = helix.toolface(k);
    return out;
}

std::vector<double> Wall::State::radius(Range range) const {
    std::vector<double> out = vertices.column<double>(&Vertices::Block::radius, range);
    direct.show(range, out.data());
    return out;
}

std::vector<std::uint8_t> Wall::State::provisional(Range range) const {
    std::vector<std::uint8_t> out(length_of(range));
    const Range some = direct.among(range);
    for (Index k = some.start; k < some.stop; ++k)
        out[static_cast<std::size_t>(k - range.start)] = direct.stands_for(k);
    return out;
}

VertexColumns Wall::State::read(Range range) const {
    if (range.start < 0 || range.stop < range.start || range.stop > count)
        throw InputError("range = [" + std::to_string(range.start) + ", " + std::to_string(range.stop) +
                         "): must lie within the wall's " + std::to_string(count) + " vertices");
    VertexColumns of;
    of.depth = depth(range);
    of.toolface = toolface(range);
    of.radius = radius(range);
    of.nearest = vertices.column<double>(&Vertices::Block::nearest, range);
    of.support = vertices.column<std::int32_t>(&Vertices::Block::support, range);
    of.iterations = vertices.column<std::int32_t>(&Vertices::Block::iterations, range);
    of.provisional = provisional(range);
    return of;
}

Index Wall::size() const {
    const std::scoped_lock held(state_->lock);
    return state_->count;
}

Index Wall::sample_count() const {
    const std::scoped_lock held(state_->lock);
    return state_->samples.size();
}

Index Wall::settled() const {
    const std::scoped_lock held(state_->lock);
    return state_->settled;
}

double Wall::start_depth() const {
    const std::scoped_lock held(state_->lock);
    return state_->helix.start_depth;
}

VertexColumns Wall::vertices(Range range) const {
    const StandardArithmetic standard;
    const std::scoped_lock held(state_->lock);
    return state_->read(range);
}

VertexColumns Wall::vertices() const {
    const StandardArithmetic standard;
    const std::scoped_lock held(state_->lock);
    return state_->read({0, state_->count});
}

// One column alone moves less memory than all of them.
std::vector<double> Wall::depth() const {
    const StandardArithmetic standard;
    const std::scoped_lock held(state_->lock);
    return state_->depth({0, state_->count});
}

std::vector<double> Wall::toolface() const {
    const StandardArithmetic standard;
    const std::scoped_lock held(state_->lock);
    return state_->toolface({0, state_->count});
}

std::vector<double> Wall::radius() const {
    const std::scoped_lock held(state_->lock);
    return state_->radius({0, state_->count});
}

Index Wall::read_radius(std::span<double> into) const {
    const std::scoped_lock held(state_->lock);
    const State& s = *state_;
    if (static_cast<Index>(into.size()) != s.count) return s.count;
    const Index blocks = Vertices::blocks_of(s.count);
    for_each_part(threads_for(blocks, blocks_a_thread, s.settings.threads), blocks, [&](int, Index b) {
        const Index first = b * Vertices::block_size, n = std::min(Vertices::block_size, s.count - first);
        std::copy_n(s.vertices.block(b).radius.begin(), n, into.begin() + first);
    });
    s.direct.show({0, s.count}, into.data());
    return s.count;
}

std::vector<double> Wall::nearest() const {
    const std::scoped_lock held(state_->lock);
    return state_->vertices.column<double>(&Vertices::Block::nearest, {0, state_->count});
}

std::vector<std::int32_t> Wall::support() const {
    const std::scoped_lock held(state_->lock);
    return state_->vertices.column<std::int32_t>(&Vertices::Block::support, {0, state_->count});
}

std::vector<std::int32_t> Wall::iterations() const {
    const std::scoped_lock held(state_->lock);
    return state_->vertices.column<std::int32_t>(&Vertices::Block::iterations, {0, state_->count});
}

std::vector<std::uint8_t> Wall::provisional() const {
    const std::scoped_lock held(state_->lock);
    return state_->provisional({0, state_->count});
}

std::vector<std::vector<double>> Wall::carry(std::span<const std::span<const double>> channels, int threads) const {
    const StandardArithmetic standard;
    const std::scoped_lock held(state_->lock);
    const State& s = *state_;
    for (std::size_t c = 0; c < channels.size(); ++c)
        if (channels[c].size() != static_cast<std::size_t>(s.samples.size()))
            throw InputError("channel " + std::to_string(c) + " has " + std::to_string(channels[c].size()) +
                             " values, the wall " + std::to_string(s.samples.size()) + " samples: must be equal");
    std::vector<std::vector<double>> values(channels.size(), std::vector<double>(static_cast<std::size_t>(s.count)));
    std::vector<Search::Scratch> scratches(static_cast<std::size_t>(std::max(threads, 1)));
    for_each_range(threads, groups_of(s.count), groups_a_part, [&](int worker, const Range& part) {
        std::vector<double*> out(channels.size());
        for (Index g = part.start; g < part.stop; ++g) {
            for (std::size_t c = 0; c < channels.size(); ++c) out[c] = values[c].data() + g * lanes;
            s.search.carry(s.samples, s.helix, g, s.count, scratches[static_cast<std::size_t>(worker)], channels, out);
        }
    });
    return values;
}

std::vector<std::vector<double>> Wall::samples() const {
    const std::scoped_lock held(state_->lock);
    const bool timed = state_->samples.timed();
    std::vector<std::vector<double>> columns(timed ? 4 : 3);
    for (auto& column : columns) column.reserve(static_cast<std::size_t>(state_->samples.size()));
    for (const auto& chunk : state_->samples.chunks()) {
        const double* from[4] = {chunk->depth(), chunk->toolface(), chunk->radius(), timed ? chunk->time() : nullptr};
        for (std::size_t i = 0; i < columns.size(); ++i)
            columns[i].insert(columns[i].end(), from[i], from[i] + chunk->count);
    }
    return columns;
}

}  // namespace helibore
