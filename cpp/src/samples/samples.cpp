// Insertion of sorted batches into the chunked samples of a hole, and look-ups by depth and rank.
#include "samples/samples.hpp"

#include <algorithm>
#include <iterator>
#include <limits>
#include <numeric>

#include "base/large_pages.hpp"

namespace helibore {
namespace {

// Reads chunks row after row.
class Reader {
  public:
    Reader(const Chunks& chunks, bool timed) : chunks_(chunks), timed_(timed) {}
    bool at_end() const { return chunk_ == chunks_.size(); }
    Row row() const { return chunks_[chunk_]->row(offset_, timed_); }
    void next() {
        if (++offset_ == chunks_[chunk_]->count) {
            offset_ = 0;
            ++chunk_;
        }
    }

  private:
    const Chunks& chunks_;
    std::size_t chunk_ = 0;
    Index offset_ = 0;
    bool timed_;
};

// Writes a number of rows into as few and as equal chunks as possible, without free room. If there is one row too many
// for a chunk, the result is two half chunks, not a full chunk and a nearly empty one.
class Writer {
  public:
    Writer(Index rows, bool timed) : timed_(timed), left_(rows), chunks_left_((rows + Chunk::full - 1) / Chunk::full) {}
    void put(const Row& row) {
        if (chunks.empty() || chunks.back()->free_room() == 0) {
            chunks.push_back(std::make_shared<Chunk>((left_ + chunks_left_ - 1) / chunks_left_, timed_));
            --chunks_left_;
        }
        --left_;
        chunks.back()->set_row(chunks.back()->count++, row, timed_);
    }

    Chunks chunks;

  private:
    bool timed_;
    Index left_, chunks_left_;
};

Index rows_of(const Chunks& chunks) {
    Index rows = 0;
    for (const auto& chunk : chunks) rows += chunk->count;
    return rows;
}

// Merges chunks with the batch. Rows without a time keep their order of arrival: old before new at equal depth. Rows
// with a time are compared as a whole, and equal rows are kept once.
Chunks merge(const Chunks& old, SortedBatch& batch) {
    Writer writer(rows_of(old) + batch.count, batch.timed);
    Reader a(old, batch.timed), b(batch.chunks, batch.timed);
    while (!a.at_end() || !b.at_end()) {
        if (b.at_end()) {
            writer.put(a.row());
            a.next();
        } else if (a.at_end()) {
            writer.put(b.row());
            b.next();
        } else {
            const Row x = a.row(), y = b.row();
            const bool old_first = batch.timed ? x <= y : x.depth <= y.depth;
            if (batch.timed && x == y) {
                ++batch.redundant;
                --batch.count;
                b.next();
            } else if (old_first) {
                writer.put(x);
                a.next();
            } else {
                writer.put(y);
                b.next();
            }
        }
    }
    return std::move(writer.chunks);
}

// Returns empty chunks for a large batch. Several chunks share a large page if they fill at least three quarters of it.
Chunks full_chunks(Index count, bool timed) {
    const Index size = Chunk::size(Chunk::full, timed), total = (count + Chunk::full - 1) / Chunk::full;
    const Index a_page = static_cast<Index>(large_page_size / sizeof(double)) / size;
    Chunks chunks;
    chunks.reserve(static_cast<std::size_t>(total));
    std::shared_ptr<double[]> page;
    for (Index i = 0; i < total; ++i) {
        if (i % a_page == 0) page = 4 * (count - i * Chunk::full) < 3 * a_page * Chunk::full ? nullptr : large_page();
        chunks.push_back(page ? std::make_shared<Chunk>(Chunk::full, Chunk::full,
                                                        std::shared_ptr<double[]>(page, page.get() + i % a_page * size))
                              : std::make_shared<Chunk>(Chunk::full, timed));
    }
    return chunks;
}

// Returns the level of rows [first, last), which lie at one depth. The rows are sorted by toolface: first into parts of
// the circle, then by comparison within each part.
Level level_of(const Chunk& chunk, Index first, Index last, int neighbors) {
    const auto n = static_cast<std::size_t>(last - first), parts = 2 * n;
    Level level{chunk.depth()[first], first, last, {}, {}, std::vector<std::uint16_t>(parts + 2)};
    std::vector<std::uint16_t> ends(parts + 2), rows(n);
    for (Index row = first; row < last; ++row) ++ends[level.part(chunk.toolface()[row]) + 1];
    std::partial_sum(ends.begin(), ends.end(), ends.begin());
    for (Index row = first; row < last; ++row)
        rows[ends[level.part(chunk.toolface()[row])]++] = static_cast<std::uint16_t>(row);
    const auto before = [of = chunk.toolface()](std::uint16_t a, std::uint16_t b) {
        return of[a] < of[b] || (of[a] == of[b] && a < b);
    };
    level.toolface.reserve(rows.size());
    level.row.reserve(rows.size());
    for (std::size_t part = 0, i = 0; part <= parts; ++part) {
        level.starts[part] = static_cast<std::uint16_t>(level.row.size());
        if (ends[part] > i + 1)
            std::sort(rows.begin() + static_cast<std::ptrdiff_t>(i), rows.begin() + ends[part], before);
        for (; i < ends[part]; ++i) {
            const double toolface = chunk.toolface()[rows[i]];
            const std::size_t kept = level.row.size(), most = static_cast<std::size_t>(neighbors);
            if (kept >= most && level.toolface[kept - most] == toolface) continue;
            level.toolface.push_back(toolface);
            level.row.push_back(rows[i]);
        }
    }
    level.starts[parts + 1] = static_cast<std::uint16_t>(level.row.size());
    return level;
}

}  // namespace

const RowsOfCells& Chunk::rows_of(const Cells& cells) const {
    const auto find = [&] {
        struct Last {
            double row = -std::numeric_limits<double>::infinity();
            std::uint16_t at = 0;
        };
        RowsOfCells rows;
        rows.next.resize(static_cast<std::size_t>(count));
        std::vector<Last> of_column(static_cast<std::size_t>(cells.around));
        for (Index i = 0; i < count; ++i) {
            const auto at = static_cast<std::uint16_t>(i);
            const Index column = cells.column(depth()[i], toolface()[i]);
            Last& last = of_column[static_cast<std::size_t>(column)];
            const double row = cells.row(depth()[i]);
            if (row == last.row)
                rows.next[last.at] = at;
            else
                rows.starts.push_back({row, static_cast<std::uint16_t>(column), at});
            last = {row, at};
        }
        rows.cells = cells;
        rows.others = std::make_unique<FoundOnce<RowsOfCells>>();
        return rows;
    };
    const RowsOfCells* rows = &rows_of_cells_.get(find);
    while (rows->cells != cells) rows = &rows->others->get(find);
    return *rows;
}

const Levels& Chunk::levels(int neighbors) const {
    return levels_.get([&] {
        Levels levels;
        for (Index first = 0, last = 0; first < count; first = last) {
            while (last < count && depth()[last] == depth()[first]) ++last;
            if (last - first >= Level::least) levels.push_back(level_of(*this, first, last, neighbors));
        }
        return levels;
    });
}

ChunkToolfaces::ChunkToolfaces(const double* toolface, Index n) {
    std::fill_n(next_, parts + 2, no_limit);
    std::fill_n(previous_, parts + 2, -no_limit);
    for (Index i = 0; i < n; ++i) {
        const std::size_t at = part(toolface[i]);
        next_[at] = std::min(next_[at], toolface[i]);
        previous_[at + 1] = std::max(previous_[at + 1], toolface[i]);
    }
    const double least = *std::min_element(next_, next_ + parts + 1);
    const double greatest = *std::max_element(previous_, previous_ + parts + 2);
    next_[parts + 1] = least + 360.0;
    for (std::size_t i = parts + 1; i-- > 0;) next_[i] = std::min(next_[i], next_[i + 1]);
    previous_[0] = greatest - 360.0;
    for (std::size_t i = 1; i < parts + 2; ++i) previous_[i] = std::max(previous_[i], previous_[i - 1]);
}

double ChunkToolfaces::least_turn(double toolface) const {
    const std::size_t at = part(toolface);
    const double next = next_[at] >= toolface ? next_[at] : next_[at + 1];
    const double previous = previous_[at + 1] <= toolface ? previous_[at + 1] : previous_[at];
    if (next_[at] < toolface && toolface < previous_[at + 1]) return 0.0;  // its part has toolfaces on both sides of it
    return std::max(0.0, std::min(next - toolface, toolface - previous));
}

// A small batch that does not fit into the last chunk begins a chunk with room for more batches of its size, so a
// streamed wall grows by whole chunks. A first batch gets no spare room.
Chunks Samples::room_for(Index count, bool timed) const {
    constexpr Index most_appends = 256;
    Chunks chunks;
    if (count >= Chunk::full)
        chunks = full_chunks(count, timed);
    else if (count_ == 0)
        chunks = {std::make_shared<Chunk>(count, timed)};
    else if (timed == timed_ && count <= chunks_.back()->free_room())
        chunks = {chunks_.back()->room()};
    else
        chunks = {std::make_shared<Chunk>(count * std::min(most_appends, Chunk::full / count), timed)};
    for (const auto& chunk : chunks) count -= chunk->count = std::min(Chunk::full, count);
    return chunks;
}

void Samples::prepare_levels(int neighbors) const {
    if (chunks_.size() < 2) return;
    const Chunk& chunk = *chunks_[chunks_.size() - 2];
    if (chunk.depth()[chunk.count / 2] == chunk.last_depth() && chunk.has_level(0, chunk.count))
        chunk.levels(neighbors);
}

Samples::Undo Samples::insert(SortedBatch& batch) {
    if (batch.count == 0) return {};
    if (count_ == 0) timed_ = batch.timed;
    const Row front = batch.chunks.front()->row(0, timed_);
    const bool appends = count_ == 0 || (timed_ ? chunks_.back()->row(chunks_.back()->count - 1, true) < front
                                                : last_depth() <= front.depth);
    Undo undo = appends ? append(batch) : merge_in(batch);
    undo.count = count_;
    count_ += batch.count;
    renumber(undo.first);
    return undo;
}

Samples::Undo Samples::append(SortedBatch& batch) {
    Undo undo;
    batch.before = count_;
    if (!chunks_.empty()) {
        undo.first = chunks_.size() - 1;
        undo.replaced = {chunks_.back()};
        undo.tail_count = chunks_.back()->count;
    }
    if (!chunks_.empty() && batch.chunks.front()->lies_behind(*chunks_.back())) {
        chunks_.back()->change_count(chunks_.back()->count + batch.count);
    } else {
        reserve(batch.chunks.size());
        chunks_.insert(chunks_.end(), batch.chunks.begin(), batch.chunks.end());
    }
    undo.inserted = chunks_.size() - undo.first;
    return undo;
}

Samples::Undo Samples::merge_in(SortedBatch& batch) {
    // Chunks all of whose rows come before or after the batch stay: many rows at one depth are not written again.
    const Chunk &front = *batch.chunks.front(), &back = *batch.chunks.back();
    const auto before = [this](const Chunk& x, const Chunk& y, bool also_equal) {
        if (timed_) return x.row(x.count - 1, true) < y.row(0, true);
        return also_equal ? x.last_depth() <= y.first_depth() : x.last_depth() < y.first_depth();
    };
    auto first =
        std::partition_point(chunks_.begin(), chunks_.end(), [&](const auto& c) { return before(*c, front, true); });
    auto last = std::partition_point(first, chunks_.end(), [&](const auto& c) { return !before(back, *c, false); });
    // A short neighbouring chunk is merged as well; otherwise many small batches would leave many short chunks.
    constexpr Index few = 512;
    if (last != chunks_.end() && (*last)->count < few)
        ++last;
    else if (first != chunks_.begin() && (*std::prev(first))->count < few)
        --first;
    Undo undo;
    undo.first = static_cast<std::size_t>(first - chunks_.begin());
    undo.replaced = Chunks(first, last);
    undo.tail_count = undo.replaced.empty() ? 0 : undo.replaced.back()->count;
    const Chunks merged = merge(undo.replaced, batch);
    undo.inserted = merged.size();
    reserve(merged.size());
    // Nothing below throws. The reservation may have moved the chunks, so the iterators are made again.
    const auto at = chunks_.begin() + static_cast<std::ptrdiff_t>(undo.first);
    const auto rest = chunks_.erase(at, at + static_cast<std::ptrdiff_t>(undo.replaced.size()));
    chunks_.insert(rest, merged.begin(), merged.end());
    return undo;
}

// Reserves room for further chunks, doubling so that appends stay cheap.
void Samples::reserve(std::size_t further) {
    const std::size_t needed = chunks_.size() + further;
    if (needed > chunks_.capacity()) chunks_.reserve(std::max(needed, 2 * chunks_.capacity()));
    if (needed > first_rank_.capacity()) first_rank_.reserve(chunks_.capacity());
}

void Samples::undo(Undo&& undo) noexcept {
    if (undo.inserted == 0) return;
    const auto at = chunks_.begin() + static_cast<std::ptrdiff_t>(undo.first);
    if (!undo.replaced.empty()) undo.replaced.back()->change_count(undo.tail_count);
    const auto rest = chunks_.erase(at, at + static_cast<std::ptrdiff_t>(undo.inserted));
    chunks_.insert(rest, undo.replaced.begin(), undo.replaced.end());  // fits: the capacity never shrank
    count_ = undo.count;
    renumber(undo.first);
}

void Samples::renumber(std::size_t from) {
    first_rank_.resize(chunks_.size());
    for (std::size_t i = from; i < chunks_.size(); ++i)
        first_rank_[i] = i == 0 ? 0 : first_rank_[i - 1] + chunks_[i - 1]->count;
}

Samples::Place Samples::place(Index rank) const {
    const auto after = std::upper_bound(first_rank_.begin(), first_rank_.end(), rank);
    const auto chunk = static_cast<std::size_t>(after - first_rank_.begin()) - 1;
    return {chunk, rank - first_rank_[chunk]};
}

Index Samples::count_to(double depth, std::size_t& near) const {
    const bool is_near =
        near < chunks_.size() && chunks_[near]->first_depth() <= depth && depth < chunks_[near]->last_depth();
    if (!is_near) {
        const auto chunk = std::partition_point(chunks_.begin(), chunks_.end(),
                                                [&](const auto& c) { return c->last_depth() <= depth; });
        near = static_cast<std::size_t>(chunk - chunks_.begin());
    }
    if (near == chunks_.size()) return count_;
    const double* first = chunks_[near]->depth();
    return first_rank_[near] + (std::upper_bound(first, first + chunks_[near]->count, depth) - first);
}

double Samples::depth(Index rank) const {
    const Place at = place(rank);
    return chunks_[at.chunk]->depth()[at.offset];
}

bool Samples::repeats(double depth, double toolface, int neighbors, Index before) const {
    constexpr std::size_t chunks_looked_at = 8;
    const auto at =
        std::partition_point(chunks_.begin(), chunks_.end(), [&](const auto& c) { return c->last_depth() < depth; });
    const auto first = static_cast<std::size_t>(at - chunks_.begin());
    int found = 0;
    for (std::size_t i = first; i < std::min(chunks_.size(), first + chunks_looked_at); ++i)
        for (const Level& level : chunks_[i]->levels(neighbors)) {
            if (level.depth != depth) continue;
            for (auto j = static_cast<std::size_t>(level.position(toolface));
                 j < level.row.size() && level.toolface[j] == toolface; ++j)
                if (rank({i, level.row[j]}) < before && ++found == neighbors) return true;
        }
    return false;
}

Samples::Place Samples::step_to(double low, Place hint, Index stride) const {
    const auto holds = [&](std::size_t i) {
        return i < chunks_.size() && low <= chunks_[i]->last_depth() && (i == 0 || chunks_[i - 1]->last_depth() < low);
    };
    Place at = hint;
    if (!holds(at.chunk)) {
        const auto chunk =
            std::partition_point(chunks_.begin(), chunks_.end(), [&](const auto& c) { return c->last_depth() < low; });
        at = {static_cast<std::size_t>(chunk - chunks_.begin()), 0};
        if (chunk == chunks_.end()) return at;
        const double* first = (*chunk)->depth();
        at.offset = (std::lower_bound(first, first + (*chunk)->count, low) - first) / stride * stride;
        return at;
    }
    const double* depth = chunks_[at.chunk]->depth();
    const Index count = chunks_[at.chunk]->count;
    at.offset = std::min(at.offset, count - 1) / stride * stride;
    while (at.offset > 0 && depth[at.offset] >= low) at.offset = std::max<Index>(at.offset - stride, 0);
    while (at.offset + stride < count && depth[at.offset + stride] < low) at.offset += stride;
    return at;
}

}  // namespace helibore
