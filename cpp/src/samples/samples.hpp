// The samples of a hole in canonical order (depth, time or arrival, toolface, radius), in chunks of up to a few
// thousand:
//
//     | chunk 0: depth.. toolface.. radius.. time.. | chunk 1 ... | last chunk: room to grow |
//
// A small batch is written into the free room of the last chunk, which is not read before the batch is inserted; a
// large batch is written into new chunks. If the batch lies deeper than all samples, it stays there when it is
// inserted. A batch in the middle (a re-scan, late data) rewrites the chunks that it falls into. An insertion can be
// undone.
#pragma once

#include <algorithm>
#include <atomic>
#include <cmath>
#include <compare>
#include <cstdint>
#include <memory>
#include <vector>

#include "helibore/types.hpp"
#include "helibore/wall.hpp"
#include "samples/helix.hpp"
#include "search/kernel/kernel.hpp"

namespace helibore {

// A sample. Comparison is the canonical order of timed samples.
struct Row {
    double depth, time, toolface, radius;
    friend auto operator<=>(const Row&, const Row&) = default;
};

// Many samples of a chunk at one depth, sorted by toolface. Samples with equal toolfaces are in canonical order; only
// the first V (Settings::neighbors) of them are listed, because for every vertex they come before the others.
struct Level {
    static constexpr Index least = 256;  // samples

    double depth;
    Index first, last;  // rows of the chunk
    std::vector<double> toolface;
    std::vector<std::uint16_t> row;
    // Where each part of the circle begins in the list; two parts for each row, one more part for rounding, then the
    // end of the list.
    std::vector<std::uint16_t> starts;

    std::size_t part(double of) const {
        return static_cast<std::size_t>(of * (static_cast<double>(starts.size() - 2) / 360.0));
    }
    // Returns false only if the level has no toolface from low to high; if it has none, it may still return true.
    // Usually one read of memory decides.
    bool any_between(double low, double high) const {
        return low < 0.0 || high >= 360.0 || starts[part(low)] < starts[part(high) + 1];
    }
    // Returns the place in the list of the first toolface that is not less than `of`.
    std::ptrdiff_t position(double of) const {
        const auto begin = toolface.begin();
        return std::lower_bound(begin + starts[part(of)], begin + starts[part(of) + 1], of) - begin;
    }
};
using Levels = std::vector<Level>;

// A value that is computed from a chunk when get() is first called; several threads may call get() at the same time.
template <class T>
class FoundOnce {
  public:
    FoundOnce() = default;
    ~FoundOnce() { forget(); }
    FoundOnce(const FoundOnce&) = delete;
    FoundOnce& operator=(const FoundOnce&) = delete;

    template <class Find>
    const T& get(const Find& find) const {
        if (const T* found = found_.load(std::memory_order_acquire)) return *found;
        auto mine = std::make_unique<const T>(find());
        const T* other = nullptr;
        if (found_.compare_exchange_strong(other, mine.get(), std::memory_order_acq_rel)) return *mine.release();
        return *other;
    }
    void forget() { delete found_.exchange(nullptr); }

  private:
    mutable std::atomic<const T*> found_ = nullptr;
};

// A division of the hole into cells (search/near_far.hpp).
struct Cells {
    double height;  // metres
    Index around;   // number of cells in a turn
    double turn;    // degrees a metre: the columns turn so much along the hole

    bool operator==(const Cells&) const = default;
    double row(double depth) const { return std::floor(depth / height); }
    Index column(double depth, double toolface) const {
        const double at = turn == 0.0 ? toolface : wrap_toolface(toolface - turn * depth);
        return std::min(static_cast<Index>(at * (static_cast<double>(around) / 360.0)), around - 1);
    }
};

// The first sample of a cell in a chunk: its offset, and where the cell is.
struct CellStart {
    double row;
    std::uint16_t column, offset;
};

// The rows of a chunk by cells: where each cell starts, in order, and of each row the next of its cell, 0 if there is
// none. A cell may have more rows in the chunks before and behind.
struct RowsOfCells {
    std::vector<CellStart> starts;
    std::vector<std::uint16_t> next;
    Cells cells;
    std::unique_ptr<FoundOnce<RowsOfCells>> others;  // by other cells
};

// The toolfaces of a chunk give a lower bound of the angle from any toolface to the nearest of them. The bound is above
// 0 only if an arm that does not turn leaves most of the circle empty.
class ChunkToolfaces {
  public:
    ChunkToolfaces(const double* toolface, Index n);
    // Returns a lower bound of the angle from `toolface` to the nearest toolface of the chunk, degrees.
    double least_turn(double toolface) const;

  private:
    static constexpr std::size_t parts = 256;
    static std::size_t part(double toolface) { return static_cast<std::size_t>(toolface * (parts / 360.0)); }

    // next_[p]: the least toolface in part p or a later part. previous_[p]: the greatest toolface in a part before p.
    // Beyond the ends of the circle, 360 degrees are added or subtracted.
    double next_[parts + 2], previous_[parts + 2];
};

class Chunk {
  public:
    static constexpr Index full = 4096;

    // Returns how many doubles the columns of a chunk take.
    static Index size(Index capacity, bool timed) { return capacity * (timed ? 4 : 3); }

    Chunk(Index capacity, bool timed)
        : Chunk(capacity, whole_lines(capacity), lines(size(whole_lines(capacity), timed))) {}
    // Makes a chunk in memory that other chunks may share; its columns lie `stride` doubles apart.
    Chunk(Index capacity, Index stride, std::shared_ptr<double[]> columns)
        : columns_(std::move(columns)), capacity_(capacity), stride_(stride) {}

    double* depth() { return columns_.get(); }
    double* toolface() { return columns_.get() + stride_; }
    double* radius() { return columns_.get() + 2 * stride_; }
    double* time() { return columns_.get() + 3 * stride_; }  // timed chunks only
    const double* depth() const { return columns_.get(); }
    const double* toolface() const { return columns_.get() + stride_; }
    const double* radius() const { return columns_.get() + 2 * stride_; }
    const double* time() const { return columns_.get() + 3 * stride_; }
    double first_depth() const { return depth()[0]; }
    double last_depth() const { return depth()[count - 1]; }
    Row row(Index i, bool timed) const { return {depth()[i], timed ? time()[i] : 0.0, toolface()[i], radius()[i]}; }
    void set_row(Index i, const Row& row, bool timed) {
        depth()[i] = row.depth;
        toolface()[i] = row.toolface;
        radius()[i] = row.radius;
        if (timed) time()[i] = row.time;
    }
    Index free_room() const { return capacity_ - count; }

    // Returns the free room as a separate chunk in the same memory.
    std::shared_ptr<Chunk> room() const {
        return std::make_shared<Chunk>(free_room(), stride_,
                                       std::shared_ptr<double[]>(columns_, columns_.get() + count));
    }
    // Returns whether this chunk begins where the free room of `other` begins.
    bool lies_behind(const Chunk& other) const { return depth() == other.depth() + other.count; }

    // Returns true if at least Level::least of the rows [start, stop) lie at one depth. It may also return true if only
    // half as many do.
    bool has_level(Index start, Index stop) const {
        constexpr Index step = Level::least / 2;
        for (; start + step < stop; start += step)
            if (depth()[start] == depth()[start + step]) return true;
        return false;
    }
    const Levels& levels(int neighbors) const;
    const RowsOfCells& rows_of(const Cells& cells) const;
    const ChunkToolfaces& circle() const {
        return circle_.get([this] { return ChunkToolfaces(toolface(), count); });
    }
    void change_count(Index to) {
        levels_.forget();
        circle_.forget();
        rows_of_cells_.forget();
        count = to;
    }

    Index count = 0;

  private:
    struct alignas(64) Line {
        double values[8];
    };
    static Index whole_lines(Index n) { return (n + 7) / 8 * 8; }
    static std::shared_ptr<double[]> lines(Index n) {
        const auto of_lines = std::make_shared_for_overwrite<Line[]>(static_cast<std::size_t>(n / 8));
        return {of_lines, reinterpret_cast<double*>(of_lines.get())};
    }

    std::shared_ptr<double[]> columns_;
    Index capacity_, stride_;
    FoundOnce<Levels> levels_;
    FoundOnce<ChunkToolfaces> circle_;
    FoundOnce<RowsOfCells> rows_of_cells_;
};

using Chunks = std::vector<std::shared_ptr<Chunk>>;

// A batch in canonical order, toolfaces in [0, 360).
struct SortedBatch {
    Chunks chunks;  // all full except the last
    Index count = 0;
    Index redundant = 0;
    Index before = 0;  // number of samples of the hole before the whole batch, if that is known
    bool timed = false;

    double first_depth() const { return chunks.front()->first_depth(); }
    double last_depth() const { return chunks.back()->last_depth(); }
    // Returns whether a sample with depth in [low, high] has a depth and toolface that pass the test.
    template <class Test>
    bool any_within(double low, double high, const Test& test) const {
        auto chunk =
            std::partition_point(chunks.begin(), chunks.end(), [&](const auto& c) { return c->last_depth() < low; });
        for (; chunk != chunks.end(); ++chunk) {
            const double *depth = (*chunk)->depth(), *toolface = (*chunk)->toolface();
            for (Index i = std::lower_bound(depth, depth + (*chunk)->count, low) - depth; i < (*chunk)->count; ++i) {
                if (depth[i] > high) return false;
                if (test(depth[i], toolface[i])) return true;
            }
        }
        return false;
    }
};

class Samples {
  public:
    // The place of a sample: its chunk, and its row in that chunk.
    struct Place {
        std::size_t chunk = 0;
        Index offset = 0;
    };
    // What an insertion replaced.
    struct Undo {
        std::size_t first = 0;     // index of the first inserted chunk
        std::size_t inserted = 0;  // how many chunks were inserted
        Chunks replaced;           // the chunks that were in their place
        Index tail_count = 0;      // samples of the last replaced chunk, before the insertion
        Index count = 0;           // all samples, before the insertion
    };

    Index size() const { return count_; }
    bool timed() const { return timed_ && count_ > 0; }
    const Chunks& chunks() const { return chunks_; }
    double first_depth() const { return chunks_.front()->first_depth(); }
    double last_depth() const { return chunks_.back()->last_depth(); }

    // Returns chunks for the `count` rows of a batch, all full except the last.
    Chunks room_for(Index count, bool timed) const;

    // Computes the levels of the chunk before the last if that chunk ends with a level. Every append calls this
    // function: while a tool turns at one depth, it fills chunk after chunk, and their levels are computed one by one.
    // Otherwise the first search that reaches these chunks would compute the levels of all of them at once.
    void prepare_levels(int neighbors) const;

    // Inserts the batch. Timed rows equal to an earlier one are dropped and counted in batch.redundant. If it throws
    // std::bad_alloc, nothing has changed.
    Undo insert(SortedBatch& batch);
    void undo(Undo&& undo) noexcept;

    // Convert the place of a sample to its rank, its number in canonical order, and back.
    Index rank(Place place) const { return first_rank_[place.chunk] + place.offset; }
    Place place(Index rank) const;
    // Returns the number of samples at `depth` or above it. `near` is the index of the chunk that is looked at first;
    // it is set to the index of the chunk where the depth lies.
    Index count_to(double depth, std::size_t& near) const;
    double depth(Index rank) const;
    // Returns whether `neighbors` samples have this depth and toolface among the first `before` samples of the hole. If
    // so, no vertex needs a further sample there. It looks into a few chunks only, so it may return false wrongly.
    bool repeats(double depth, double toolface, int neighbors, Index before) const;
    // Returns the place of the first sample with depth >= low, or of a sample less than `stride` before it in its
    // chunk. The search goes in steps from `hint` if `hint` lies in the same chunk, or else by bisection.
    Place step_to(double low, Place hint, Index stride) const;

  private:
    Undo append(SortedBatch& batch);
    Undo merge_in(SortedBatch& batch);
    void reserve(std::size_t further);
    void renumber(std::size_t from);

    Chunks chunks_;
    std::vector<Index> first_rank_;
    Index count_ = 0;
    bool timed_ = false;
};

// Checks and sorts a batch that `samples` can then insert. Throws InputError with the first bad row of the first bad
// column.
SortedBatch sort_batch(const SampleColumns& columns, const Samples& samples, int threads,
                       const kernel::Functions& functions);

}  // namespace helibore
