// Copies of what a wall holds: its vertices, its samples, and values interpolated at its vertices.
#include <algorithm>
#include <string>

#include "base/arithmetic.hpp"
#include "base/messages.hpp"
#include "base/threads.hpp"
#include "helibore/error.hpp"
#include "wall/state.hpp"

namespace helibore {

namespace {

constexpr Index chunks_a_thread = 16;
constexpr Index depths_a_part = Index{1} << 20;
constexpr Index blocks_a_thread = 64;  // least number of blocks; copying fewer is not worth the start of a thread

std::size_t length_of(Range range) {
    return static_cast<std::size_t>(range.stop - range.start);
}

// Calls read(state) while no append changes the state.
template <class State, class Read>
auto locked(const State& state, const Read& read) {
    const StandardArithmetic standard;
    const std::lock_guard held(state.lock);
    return read(state);
}

bool have_length(std::span<const std::span<double>> columns, std::size_t kinds, std::size_t count) {
    return columns.size() == kinds &&
           std::ranges::all_of(columns, [&](const auto& column) { return column.size() == count; });
}

void require_sums(const Settings& settings) {
    if (!settings.sigma) throw InputError("sigma", "must be set for the sums of the vertices");
}

void copy_sums(const Vertices& vertices, Index count, int threads, const std::vector<std::span<double>>& into) {
    const Index blocks = Vertices::blocks_of(count);
    for_each_part(threads_for(blocks, blocks_a_thread, threads), blocks, [&](int, Index b) {
        const Index first = b * Vertices::block_size, n = std::min(Vertices::block_size, count - first);
        for (std::size_t i = 0; i < into.size(); ++i)
            std::copy_n(vertices.sum(i, b).begin(), n, into[i].begin() + first);
    });
}

// Copies depth, toolface, radius and, if there is one, time of all samples. It uses several threads, because the first
// use of new memory takes longer than the copy.
void copy_samples(const Samples& samples, int threads, const std::vector<std::span<double>>& into) {
    const Chunks& chunks = samples.chunks();
    const auto count = static_cast<Index>(chunks.size());
    for_each_part(threads_for(count, chunks_a_thread, threads), count, [&](int, Index c) {
        const auto at = static_cast<std::size_t>(c);
        const Chunk& chunk = *chunks[at];
        const Index first = samples.rank({at, 0});
        const double* from[4] = {chunk.depth(), chunk.toolface(), chunk.radius(),
                                 into.size() > 3 ? chunk.time() : nullptr};
        for (std::size_t i = 0; i < into.size(); ++i) std::copy_n(from[i], chunk.count, into[i].begin() + first);
    });
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

std::vector<double> Wall::State::nearest(Range range) const {
    return vertices.column<double>(&Vertices::Block::nearest, range);
}

std::vector<std::int32_t> Wall::State::support(Range range) const {
    return vertices.column<std::int32_t>(&Vertices::Block::support, range);
}

std::vector<std::int32_t> Wall::State::iterations(Range range) const {
    return vertices.column<std::int32_t>(&Vertices::Block::iterations, range);
}

std::vector<std::uint8_t> Wall::State::provisional(Range range) const {
    std::vector<std::uint8_t> out(length_of(range));
    const Range some = direct.among(range);
    for (Index k = some.start; k < some.stop; ++k)
        out[static_cast<std::size_t>(k - range.start)] = direct.stands_for(k);
    return out;
}

Range Wall::State::local(Range range) const {
    const Index first = settings.first_vertex;
    if (range.start >= first && range.stop >= range.start && range.stop <= first + count)
        return {range.start - first, range.stop - first};
    const std::string all =
        first == 0 ? std::to_string(count) + " vertices" : "vertices " + range_text({first, first + count});
    throw InputError("range", "must lie within the wall's " + all, range_text(range));
}

VertexColumns Wall::State::read(Range range) const {
    return {depth(range),   toolface(range),   radius(range),     nearest(range),
            support(range), iterations(range), provisional(range)};
}

void Wall::State::read(Column column, Range range, double* into) const {
    const Index n = range.stop - range.start;
    switch (column) {
        case Column::depth:
            // Processors convert several whole numbers of 32 bits at once, but not of 64.
            for (Index begin = 0; begin < n; begin += depths_a_part) {
                const auto first = static_cast<double>(helix.first + range.start + begin);
                const auto length = static_cast<std::int32_t>(std::min(depths_a_part, n - begin));
                for (std::int32_t i = 0; i < length; ++i) into[begin + i] = helix.depth_of(first + i);
            }
            return;
        case Column::toolface: {  // those of one turn, again and again
            const Index turn = std::min<Index>(n, helix.sectors);
            for (Index i = 0; i < turn; ++i) into[i] = helix.toolface(range.start + i);
            for (Index i = turn; i < n; i += turn) std::copy_n(into + i - turn, std::min(turn, n - i), into + i);
            return;
        }
        case Column::radius:
            vertices.copy(&Vertices::Block::radius, range, into);
            direct.show(range, into);
            return;
        case Column::nearest:
            return vertices.copy(&Vertices::Block::nearest, range, into);
        case Column::support:
            return vertices.copy(&Vertices::Block::support, range, into);
        case Column::iterations:
            return vertices.copy(&Vertices::Block::iterations, range, into);
        case Column::provisional: {
            std::fill_n(into, n, 0.0);
            const Range some = direct.among(range);
            for (Index k = some.start; k < some.stop; ++k) into[k - range.start] = direct.stands_for(k) ? 1.0 : 0.0;
        }
    }
}

void Wall::read(Column column, Range range, std::span<double> into) const {
    locked(*state_, [&](const State& s) {
        const Range own = s.local(range);
        require_length("into", into.size(), length_of(own), "the range");
        s.read(column, own, into.data());
    });
}

Index Wall::size() const {
    return locked(*state_, [](const State& s) { return s.count; });
}

Index Wall::sample_count() const {
    return locked(*state_, [](const State& s) { return s.samples.size(); });
}

Index Wall::settled() const {
    return locked(*state_, [](const State& s) { return s.settings.first_vertex + s.settled; });
}

double Wall::start_depth() const {
    return locked(*state_, [](const State& s) { return s.helix.depth(0); });
}

VertexColumns Wall::vertices(Range range) const {
    return locked(*state_, [&](const State& s) { return s.read(s.local(range)); });
}

Depths Wall::reach(Range range) const {
    return locked(*state_, [&](const State& s) {
        const Range own = s.local(range);
        Depths depths{no_limit, -no_limit};
        for (Index g = own.start / lanes; g < groups_of(own.stop); ++g) {
            const Vertices::Block& block = s.vertices.block(g / Vertices::groups_per_block);
            const auto i = static_cast<std::size_t>(g % Vertices::groups_per_block);
            depths = {std::min(depths.shallow, block.shallow[i]), std::max(depths.deep, block.deep[i])};
        }
        return depths;
    });
}

VertexColumns Wall::vertices() const {
    return locked(*state_, [](const State& s) { return s.read(s.all()); });
}

// Each of these functions copies one column only, which moves less memory than vertices() does.
std::vector<double> Wall::depth() const {
    return locked(*state_, [](const State& s) { return s.depth(s.all()); });
}

std::vector<double> Wall::toolface() const {
    return locked(*state_, [](const State& s) { return s.toolface(s.all()); });
}

std::vector<double> Wall::radius() const {
    return locked(*state_, [](const State& s) { return s.radius(s.all()); });
}

std::vector<double> Wall::nearest() const {
    return locked(*state_, [](const State& s) { return s.nearest(s.all()); });
}

std::vector<std::int32_t> Wall::support() const {
    return locked(*state_, [](const State& s) { return s.support(s.all()); });
}

std::vector<std::int32_t> Wall::iterations() const {
    return locked(*state_, [](const State& s) { return s.iterations(s.all()); });
}

std::vector<std::uint8_t> Wall::provisional() const {
    return locked(*state_, [](const State& s) { return s.provisional(s.all()); });
}

Index Wall::read_radius(std::span<double> into) const {
    return locked(*state_, [&](const State& s) {
        if (static_cast<Index>(into.size()) != s.count) return s.count;
        const Index blocks = Vertices::blocks_of(s.count);
        for_each_part(threads_for(blocks, blocks_a_thread, s.settings.threads), blocks, [&](int, Index b) {
            const Index first = b * Vertices::block_size, n = std::min(Vertices::block_size, s.count - first);
            std::copy_n(s.vertices.block(b).radius.begin(), n, into.begin() + first);
        });
        s.direct.show(s.all(), into.data());
        return s.count;
    });
}

std::array<std::vector<double>, 4> Wall::sums() const {
    return locked(*state_, [](const State& s) {
        require_sums(s.settings);
        std::array<std::vector<double>, 4> out;
        out.fill(std::vector<double>(length_of(s.all())));
        copy_sums(s.vertices, s.count, s.settings.threads, {out.begin(), out.end()});
        return out;
    });
}

bool Wall::read_sums(std::span<const std::span<double>> into) const {
    return locked(*state_, [&](const State& s) {
        require_sums(s.settings);
        const bool fits = have_length(into, 4, length_of(s.all()));
        if (fits) copy_sums(s.vertices, s.count, s.settings.threads, {into.begin(), into.end()});
        return fits;
    });
}

std::vector<std::vector<double>> Wall::interpolate_samples(std::span<const std::span<const double>> channels,
                                                           int threads) const {
    require_threads(threads);
    return locked(*state_, [&](const State& s) {
        for (std::size_t c = 0; c < channels.size(); ++c)
            if (channels[c].size() != static_cast<std::size_t>(s.samples.size()))
                throw InputError("channel " + std::to_string(c) + " has " + std::to_string(channels[c].size()) +
                                     " values, the wall " + std::to_string(s.samples.size()) + " samples",
                                 "must be equal");
        std::vector<std::vector<double>> values(channels.size(), std::vector<double>(length_of(s.all())));
        std::vector<Search::Scratch> scratches(static_cast<std::size_t>(threads));
        for_each_range(threads, groups_of(s.count), groups_a_part, [&](int worker, const Range& part) {
            Search::Scratch& scratch = scratches[static_cast<std::size_t>(worker)];
            std::vector<double*> out(channels.size());
            for (Index g = part.start; g < part.stop; ++g) {
                for (std::size_t c = 0; c < channels.size(); ++c) out[c] = values[c].data() + g * lanes;
                s.search.interpolate(s.samples, s.helix, g, s.count, scratch, channels, out);
            }
        });
        return values;
    });
}

std::vector<std::vector<double>> Wall::samples() const {
    return locked(*state_, [](const State& s) {
        const auto count = static_cast<std::size_t>(s.samples.size());
        std::vector<std::vector<double>> columns(s.samples.timed() ? 4 : 3, std::vector<double>(count));
        copy_samples(s.samples, s.settings.threads, {columns.begin(), columns.end()});
        return columns;
    });
}

bool Wall::read_samples(std::span<const std::span<double>> into) const {
    return locked(*state_, [&](const State& s) {
        const auto count = static_cast<std::size_t>(s.samples.size());
        const bool fits = have_length(into, s.samples.timed() ? 4 : 3, count);
        if (fits) copy_samples(s.samples, s.settings.threads, {into.begin(), into.end()});
        return fits;
    });
}

}  // namespace helibore
