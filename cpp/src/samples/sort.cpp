// Checks a batch of samples (row_rules.hpp) and brings it into canonical order.
//
// One pass copies the rows into chunks, and checks the copies and their order. Recorded data are mostly in order
// already. Otherwise
//
//     rows -> buckets by depth, which follow each other in the chunks -> each bucket is sorted
//
// Both steps are stable, so rows without a time stay in order of arrival, and the result does not depend on threads.
#include <algorithm>
#include <atomic>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <numeric>
#include <utility>

#ifdef __SSE2__
#include <emmintrin.h>
#endif

#include "base/extremes.hpp"
#include "base/threads.hpp"
#include "samples/helix.hpp"
#include "samples/row_rules.hpp"
#include "samples/samples.hpp"
#include "search/kernel/instruction_set.hpp"

namespace helibore {
namespace {

constexpr int slabs_a_thread = 8;  // so that all threads end at about the same time

// Returns the rows of a chunk as columns.
SampleColumns columns_of(const Chunk& chunk, bool timed) {
    const auto n = static_cast<std::size_t>(chunk.count);
    return {{chunk.depth(), n},
            {chunk.toolface(), n},
            {chunk.radius(), n},
            timed ? std::span<const double>(chunk.time(), n) : std::span<const double>()};
}

// Copies the rows from `start` on into a chunk. Nothing else reads the host's memory: it may change at any time.
void copy_rows(const SampleColumns& c, Index start, Chunk& chunk) {
    const std::size_t bytes = static_cast<std::size_t>(chunk.count) * sizeof(double);
    std::memcpy(chunk.depth(), c.depth.data() + start, bytes);
    std::memcpy(chunk.toolface(), c.toolface.data() + start, bytes);
    std::memcpy(chunk.radius(), c.radius.data() + start, bytes);
    if (!c.time.empty()) std::memcpy(chunk.time(), c.time.data() + start, bytes);
}

void wrap_toolfaces(Chunk& chunk, const kernel::Functions& f) {
    double* toolface = chunk.toolface();
    if (f.all_within(toolface, chunk.count, 0.0, std::nextafter(360.0, 0.0)))
        std::transform(toolface, toolface + chunk.count, toolface, [](double x) { return x + 0.0; });  // -0 is 0
    else
        std::transform(toolface, toolface + chunk.count, toolface, wrap_toolface);
}

// Returns whether `row` comes after `before`. Equal timed rows count as not in order, because one of them must be
// dropped.
bool follows(const Row& before, const Row& row, bool timed) {
    return timed ? before < row : before.depth <= row.depth;
}

bool rows_in_order(const Chunk& chunk, bool timed, const kernel::Functions& f) {
    const kernel::Order order = f.order(chunk.depth(), chunk.count);
    if (order != kernel::Order::level || !timed) return order != kernel::Order::falls;
    for (Index i = 1; i < chunk.count; ++i)
        if (!follows(chunk.row(i - 1, true), chunk.row(i, true), true)) return false;
    return true;
}

// Copies the rows into the chunks of the batch in order of arrival, checks the copies, and wraps their toolfaces.
// Returns whether they are in canonical order.
bool copy_checked(const SampleColumns& c, SortedBatch& batch, int threads, const kernel::Functions& f) {
    std::atomic<bool> in_order{true}, valid{true};
    for_each_part(threads, static_cast<Index>(batch.chunks.size()), [&](int, Index part) {
        Chunk& chunk = *batch.chunks[static_cast<std::size_t>(part)];
        copy_rows(c, part * Chunk::full, chunk);
        if (!rows_valid(columns_of(chunk, batch.timed), f)) {
            valid = false;
            return;
        }
        wrap_toolfaces(chunk, f);
        if (in_order && !rows_in_order(chunk, batch.timed, f)) in_order = false;
    });
    if (!valid) {
        std::vector<SampleColumns> parts;
        for (const auto& chunk : batch.chunks) parts.push_back(columns_of(*chunk, batch.timed));
        check_rows(parts);
    }
    for (std::size_t i = 1; i < batch.chunks.size() && in_order; ++i) {
        const Chunk& before = *batch.chunks[i - 1];
        in_order =
            follows(before.row(before.count - 1, batch.timed), batch.chunks[i]->row(0, batch.timed), batch.timed);
    }
    return in_order;
}

// Returns the least and the greatest depth.
std::pair<double, double> depth_extent(const Chunks& chunks, int threads) {
    std::vector<Extremes> extremes(static_cast<std::size_t>(threads));
    for_each_part(threads, static_cast<Index>(chunks.size()), [&](int w, Index part) {
        const Chunk& chunk = *chunks[static_cast<std::size_t>(part)];
        extremes[static_cast<std::size_t>(w)].take(chunk.depth(), chunk.depth() + chunk.count);
    });
    for (const Extremes& of_worker : extremes) extremes[0].take(of_worker);
    return {extremes[0].least(), extremes[0].greatest()};
}

// Finds the bucket of a depth. A greater depth never belongs to an earlier bucket.
struct Buckets {
    double least, scale = 0.0;
    Index count;

    Buckets(double low, double high, Index buckets) : least(low), count(buckets) {
        if (high > low) scale = static_cast<double>(buckets) / (high - low);
        if (!(scale < 1e300)) scale = 0.0;
    }
    Index of(double depth) const {
        return std::clamp(static_cast<Index>((depth - least) * scale), Index{0}, count - 1);
    }
    // Divides one bucket into n finer buckets.
    Buckets bins(Index bucket, Index n) const {
        if (scale == 0.0) return {least, least, n};
        return {least + static_cast<double>(bucket) / scale, least + static_cast<double>(bucket + 1) / scale, n};
    }
};

// Sorts the rows of one bucket, which are rows [start, stop) of the chunks.
template <bool timed>
class BucketSorter {
  public:
    void sort(SortedBatch& batch, Range rows, const Buckets& buckets, Index bucket) {
        const auto n = static_cast<std::size_t>(rows.stop - rows.start);
        if (n < 2) return;
        if (rows_.size() < n) rows_.resize(n);
        put_in_bins(batch, rows, buckets.bins(bucket, static_cast<Index>(n)));
        for (std::size_t i = 1; i < n; ++i)
            if (before(rows_[i], rows_[i - 1])) sift(i);
        store(batch, rows);
    }

  private:
    // Calls call(chunk, offset in the chunk, index in the rows, length) for each chunk that the rows lie in.
    template <class Call>
    static void for_each_chunk(const SortedBatch& batch, Range rows, const Call& call) {
        for (Index i = rows.start; i < rows.stop;) {
            const Index offset = i % Chunk::full, n = std::min(rows.stop - i, Chunk::full - offset);
            call(*batch.chunks[static_cast<std::size_t>(i / Chunk::full)], offset, i - rows.start, n);
            i += n;
        }
    }

    // Sorts the rows by a stable counting sort into about one bin for each row, then large bins by comparison.
    void put_in_bins(const SortedBatch& batch, Range rows, const Buckets& bins) {
        const auto n = static_cast<std::size_t>(rows.stop - rows.start);
        bin_.resize(std::max(bin_.size(), n));
        starts_.assign(n + 1, 0);
        std::uint32_t most = 0;
        for_each_chunk(batch, rows, [&](const Chunk& c, Index offset, Index at, Index length) {
            for (Index i = 0; i < length; ++i) {
                const auto bin = static_cast<std::uint32_t>(bins.of(c.depth()[offset + i]));
                bin_[static_cast<std::size_t>(at + i)] = bin;
                most = std::max(most, ++starts_[bin + 1]);
            }
        });
        std::partial_sum(starts_.begin(), starts_.end(), starts_.begin());
        for_each_chunk(batch, rows, [&](const Chunk& c, Index offset, Index at, Index length) {
            for (Index i = 0; i < length; ++i)
                rows_[starts_[bin_[static_cast<std::size_t>(at + i)]]++] = c.row(offset + i, timed);
        });
        if (most <= 32) return;
        // starts_[b] is now the end of bin b.
        for (std::size_t b = 0, start = 0; b < n; start = starts_[b++])
            if (starts_[b] - start > 32)
                std::stable_sort(rows_.begin() + static_cast<std::ptrdiff_t>(start), rows_.begin() + starts_[b],
                                 before);
    }

    static bool before(const Row& x, const Row& y) {
        if constexpr (timed) return x < y;
        return x.depth < y.depth;
    }

    void sift(std::size_t i) {
        const Row row = rows_[i];
        for (; i > 0 && before(row, rows_[i - 1]); --i) rows_[i] = rows_[i - 1];
        rows_[i] = row;
    }

    void store(SortedBatch& batch, Range rows) const {
        for_each_chunk(batch, rows, [&](Chunk& c, Index offset, Index at, Index length) {
            for (Index i = 0; i < length; ++i) c.set_row(offset + i, rows_[static_cast<std::size_t>(at + i)], timed);
        });
    }

    std::vector<Row> rows_;
    std::vector<std::uint32_t> bin_, starts_;
};

template <bool timed>
void sort_buckets(SortedBatch& batch, const Buckets& buckets, const std::vector<Index>& ends, int threads) {
    std::vector<BucketSorter<timed>> sorters(static_cast<std::size_t>(threads));
    const auto sort_bucket = [&](int w, Index b) {
        const auto i = static_cast<std::size_t>(b);
        sorters[static_cast<std::size_t>(w)].sort(batch, {i == 0 ? 0 : ends[i - 1], ends[i]}, buckets, b);
    };
    for_each_part(threads, buckets.count, sort_bucket);
}

// Writes eight doubles, a cache line, directly to memory: the processor then does not first read what is about to be
// overwritten. Other threads see them only after finish_streams().
void stream_line(double* to, const double* from) {
#ifdef __SSE2__
    if (reinterpret_cast<std::uintptr_t>(to) % 16 == 0) {
        for (int i = 0; i < 8; i += 2) _mm_stream_pd(to + i, _mm_loadu_pd(from + i));
        return;
    }
#endif
    std::memcpy(to, from, 8 * sizeof(double));
}

void finish_streams() {
#ifdef __SSE2__
    _mm_sfence();
#endif
}

// The rows that are collected for a bucket. Eight rows are written at once, one cache line for each column: with
// scattered single stores the processor would fetch and write back each line several times.
struct Collected {
    Index start, next;  // places in the chunks of the first row and of the next row
    alignas(64) double rows[4][8];

    // Writes the rows collected since the last place that is a multiple of 8.
    void write(SortedBatch& batch) const {
        const Index first = std::max(start, (next - 1) / 8 * 8), n = next - first;
        if (n <= 0) return;
        Chunk& chunk = *batch.chunks[static_cast<std::size_t>(first / Chunk::full)];
        double* columns[4] = {chunk.depth(), chunk.toolface(), chunk.radius(), batch.timed ? chunk.time() : nullptr};
        for (int c = 0; c < (batch.timed ? 4 : 3); ++c) {
            double* to = columns[c] + first % Chunk::full;
            if (n == 8)
                stream_line(to, rows[c]);
            else
                std::copy_n(rows[c] + first % 8, n, to);
        }
    }
};

// Returns the chunks of slab `which`, if `n` chunks are cut into `slabs` nearly equal slabs.
Range slab(Index n, int slabs, Index which) {
    return {n * which / slabs, n * (which + 1) / slabs};
}

// Moves each row of the chunks `from` into its bucket. The chunks are taken in slabs; a count for each slab and bucket
// gives the places.
void distribute(const Chunks& from, SortedBatch& batch, const Buckets& buckets, std::vector<Index>& ends, int threads) {
    const auto n = static_cast<Index>(from.size());
    const auto size = static_cast<std::size_t>(buckets.count);
    const int slabs = threads == 1 ? 1 : slabs_a_thread * threads;
    std::vector<std::vector<Index>> places(static_cast<std::size_t>(slabs));
    for_each_part(threads, slabs, [&](int, Index s) {
        std::vector<Index> counts(size, 0);
        const Buckets which = buckets;  // a copy on the stack: other threads write beside the original
        const Range chunks = slab(n, slabs, s);
        for (Index part = chunks.start; part < chunks.stop; ++part) {
            const Chunk& chunk = *from[static_cast<std::size_t>(part)];
            const double* depth = chunk.depth();
            for (Index i = 0; i < chunk.count; ++i) ++counts[static_cast<std::size_t>(which.of(depth[i]))];
        }
        places[static_cast<std::size_t>(s)] = std::move(counts);
    });
    Index total = 0;
    ends.resize(size);
    for (std::size_t b = 0; b < size; ++b) {
        for (auto& of_slab : places) total += std::exchange(of_slab[b], total);
        ends[b] = total;
    }
    std::vector<std::vector<Collected>> collected(static_cast<std::size_t>(threads));
    for_each_part(threads, slabs, [&](int w, Index s) {
        auto& mine = collected[static_cast<std::size_t>(w)];
        mine.resize(size);
        for (std::size_t b = 0; b < size; ++b) mine[b].start = mine[b].next = places[static_cast<std::size_t>(s)][b];
        const Range chunks = slab(n, slabs, s);
        for (Index part = chunks.start; part < chunks.stop; ++part) {
            const Chunk& chunk = *from[static_cast<std::size_t>(part)];
            const double *depth = chunk.depth(), *toolface = chunk.toolface(), *radius = chunk.radius();
            const double* time = batch.timed ? chunk.time() : nullptr;
            for (Index i = 0; i < chunk.count; ++i) {
                Collected& bucket = mine[static_cast<std::size_t>(buckets.of(depth[i]))];
                const Index slot = bucket.next++ % 8;
                bucket.rows[0][slot] = depth[i];
                bucket.rows[1][slot] = toolface[i];
                bucket.rows[2][slot] = radius[i];
                if (time) bucket.rows[3][slot] = time[i];
                if (slot == 7) bucket.write(batch);
            }
        }
        for (const Collected& bucket : mine)
            if (bucket.next % 8 != 0) bucket.write(batch);
        finish_streams();
    });
}

// Keeps one of the timed rows that are equal in all four columns, and moves the rows after it up. This is rare, so it
// is serial and simple.
void drop_redundant(SortedBatch& batch) {
    Index kept = 0;
    const auto kept_chunk = [&](Index i) -> Chunk& { return *batch.chunks[static_cast<std::size_t>(i / Chunk::full)]; };
    for (const auto& from : batch.chunks)
        for (Index i = 0; i < from->count; ++i) {
            if (kept > 0) {
                const Chunk& last = kept_chunk(kept - 1);
                const Index at = (kept - 1) % Chunk::full;
                if (last.depth()[at] == from->depth()[i] && last.row(at, true) == from->row(i, true)) {
                    ++batch.redundant;
                    continue;
                }
            }
            if (batch.redundant > 0) kept_chunk(kept).set_row(kept % Chunk::full, from->row(i, true), true);
            ++kept;
        }
    batch.count = kept;
    batch.chunks.resize(static_cast<std::size_t>((kept + Chunk::full - 1) / Chunk::full));
    batch.chunks.back()->count = kept - static_cast<Index>(batch.chunks.size() - 1) * Chunk::full;
}

}  // namespace

SortedBatch sort_batch(const SampleColumns& columns, const Samples& samples, int threads, const kernel::Functions& f) {
    check_lengths(columns);
    SortedBatch batch;
    batch.count = static_cast<Index>(columns.depth.size());
    batch.timed = !columns.time.empty();
    if (batch.count == 0) return batch;
    threads = threads_for(batch.count, rows_a_thread, threads);
    batch.chunks = samples.room_for(batch.count, batch.timed);
    if (copy_checked(columns, batch, threads, f)) return batch;
    const auto [least, greatest] = depth_extent(batch.chunks, threads);
    const Buckets buckets(least, greatest, std::clamp<Index>(batch.count / 4096, 1, 1024));
    std::vector<Index> ends{batch.count};
    if (buckets.count > 1) {
        const Chunks copied = std::exchange(batch.chunks, samples.room_for(batch.count, batch.timed));
        distribute(copied, batch, buckets, ends, threads);
    }
    batch.timed ? sort_buckets<true>(batch, buckets, ends, threads)
                : sort_buckets<false>(batch, buckets, ends, threads);
    if (batch.timed) drop_redundant(batch);
    return batch;
}

}  // namespace helibore
