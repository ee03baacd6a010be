// The samples of a hole in canonical order (depth, time or arrival, toolface, radius), in chunks of up to a few
// thousand:
//
//     | chunk 0: depth.. toolface.. radius.. time.. | chunk 1 ... | last chunk: room to grow |
//
// Rows are written once where they may stay: a small batch into the last chunk's free room, as far as nobody looks yet,
// others into chunks of their own. A batch that lies below everything is then there; one in the middle (a re-scan, late
// data) rewrites the chunks it falls into. An insertion can be undone until it is kept.
#pragma once

#include <memory>
#include <vector>

#include "helibore/types.hpp"
#include "helibore/wall.hpp"
#include "search/kernel/kernel.hpp"

namespace helibore {

class Chunk {
  public:
    static constexpr Index full = 4096;

    // Doubles that the columns of a chunk take.
    static Index size(Index capacity, bool timed) { return capacity * (timed ? 4 : 3); }

    Chunk(Index capacity, bool timed)
        : Chunk(capacity, whole_lines(capacity), lines(size(whole_lines(capacity), timed))) {}
    // In memory that may be shared with other chunks, the columns `stride` doubles apart.
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
    Index free_room() const { return capacity_ - count; }

    // The free room of this one as a chunk of its own, in the same memory.
    std::shared_ptr<Chunk> room() const {
        return std::make_shared<Chunk>(free_room(), stride_,
                                       std::shared_ptr<double[]>(columns_, columns_.get() + count));
    }
    // Does it begin where the free room of the other does?
    bool lies_behind(const Chunk& other) const { return depth() == other.depth() + other.count; }

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
};

using Chunks = std::vector<std::shared_ptr<Chunk>>;

// A batch in canonical order, toolfaces in [0, 360).
struct SortedBatch {
    Chunks chunks;  // all full but the last
    Index count = 0;
    Index redundant = 0;
    bool timed = false;

    double first_depth() const { return chunks.front()->first_depth(); }
    double last_depth() const { return chunks.back()->last_depth(); }
    // Is there a sample with depth in [low, high]?
    bool any_within(double low, double high) const;
};

class Samples {
  public:
    // Where a sample lies.
    struct Place {
        std::size_t chunk = 0;
        Index offset = 0;
    };
    // What an insertion replaced. Dropping it keeps the insertion.
    struct Undo {
        std::size_t first = 0;     // chunks from here on ...
        std::size_t inserted = 0;  // ... this many stand for ...
        Chunks replaced;           // ... these,
        Index tail_count = 0;      // whose last had this many samples
        Index count = 0;           // samples before
    };

    Index size() const { return count_; }
    bool timed() const { return timed_ && count_ > 0; }
    const Chunks& chunks() const { return chunks_; }
    double first_depth() const { return chunks_.front()->first_depth(); }
    double last_depth() const { return chunks_.back()->last_depth(); }

    // Where the rows of a batch may be written: chunks that hold `count`, all full but the last.
    Chunks room_for(Index count, bool timed) const;

    // Takes the batch; rows equal to one already there in all four are dropped and added to batch.redundant.
    // Throws std::bad_alloc and then has changed nothing.
    Undo insert(SortedBatch& batch);
    void undo(Undo&& undo) noexcept;

    // Rank of a place and place of a rank, in canonical order.
    Index rank(Place place) const { return first_rank_[place.chunk] + place.offset; }
    Place place(Index rank) const;
    // Samples with depth <= the given one.
    Index count_to(double depth) const;
    double depth(Index rank) const;
    // A place at or before the first sample with depth >= low, and by less than `stride` samples of its chunk. Found in
    // steps from a hint that is near, by bisection otherwise.
    Place step_to(double low, Place hint, Index stride) const;

  private:
    Undo append(const SortedBatch& batch);
    Undo merge_in(SortedBatch& batch);
    void reserve(std::size_t further);
    void renumber(std::size_t from);

    Chunks chunks_;
    std::vector<Index> first_rank_;
    Index count_ = 0;
    bool timed_ = false;
};

// Validates and sorts a batch for `samples`, which do not change. Throws InputError with the first offending row of the
// first offending column.
SortedBatch sort_batch(const SampleColumns& columns, const Samples& samples, int threads,
                       const kernel::Functions& functions);

}  // namespace helibore
