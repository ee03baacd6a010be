// Values of an image on quads. Neighbouring quads lie between the same rows, so the row of each is found in steps from
// that of the previous quad.
#include "helibore/image.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>

#include "base/arithmetic.hpp"
#include "base/host_memory.hpp"
#include "base/messages.hpp"
#include "base/threads.hpp"

namespace helibore {
namespace {

constexpr Index quads_a_part = 1 << 14;  // quads that a thread takes at a time
constexpr double missing = std::numeric_limits<double>::quiet_NaN();

// The position of a quad of a turn in a row: its sector `left`, the next sector, and the share of the way from `left`
// to the next.
struct Across {
    std::size_t left, right;
    double share;
};

// Returns the value at a share of the way from start to stop. At share 0 it is `start` even if `stop` is missing (NaN).
double between(double start, double stop, double share) {
    return share == 0.0 ? start : start + share * (stop - start);
}

std::vector<Across> across_of(const ImageRows& image, std::span<const double> sector) {
    std::vector<Across> across;
    for (std::size_t i = 0; i < sector.size(); ++i) {
        const double at = read_once(sector[i]);
        require(std::abs(at) <= 1e9, entry_name("sector", static_cast<Index>(i)), at, "must lie in -1e9 to 1e9");
        const double left = std::floor(at), turns = std::floor(left / image.sectors);
        const auto column = static_cast<std::size_t>(left - turns * image.sectors);
        across.push_back({column, (column + 1) % static_cast<std::size_t>(image.sectors), at - left});
    }
    return across;
}

// Finds the index of the last of the rising bounds that is not greater than a depth, or -1, in steps from that of the
// previous quad.
class Walk {
  public:
    Walk(std::span<const double> bounds, double depth)
        : bounds_(bounds.data()), count_(static_cast<Index>(bounds.size())) {
        row_ = std::upper_bound(bounds_, bounds_ + count_, depth) - bounds_ - 1;
    }
    Index to(double depth) {
        while (row_ + 1 < count_ && bounds_[row_ + 1] <= depth) ++row_;
        while (row_ >= 0 && bounds_[row_] > depth) --row_;
        return row_;
    }

  private:
    const double* bounds_;
    Index count_, row_;
};

// Fills values[k] with value_at(row, column, depth), where column is the quad's place in its turn; NaN above all rows.
template <class ValueAt>
std::vector<double> fill(std::span<const double> bounds, const QuadCentres& quads, int threads,
                         const ValueAt& value_at) {
    const auto K = static_cast<Index>(quads.sector.size());
    const double step = quads.pitch / static_cast<double>(K), first = static_cast<double>(K + 1) / 2.0;
    const auto depth_of = [&](Index k) { return quads.start_depth + (static_cast<double>(k) + first) * step; };
    std::vector<double> values(static_cast<std::size_t>(quads.count));
    for_each_range(threads, quads.count, quads_a_part, [&](int, const Range& range) {
        Walk walk(bounds, depth_of(range.start));
        for (Index k = range.start, column = k % K; k < range.stop; ++k) {
            const double depth = depth_of(k);
            const Index row = walk.to(depth);
            values[static_cast<std::size_t>(k)] = row < 0 ? missing : value_at(row, column, depth);
            if (++column == K) column = 0;
        }
    });
    return values;
}

void require_cells(const ImageRows& image, const QuadCentres& quads, int threads) {
    require(image.sectors >= 1 && image.sectors <= 1000000, "sectors", Index{image.sectors},
            "must lie in 1 to 1000000");
    if (image.values.size() != image.depth.size() * static_cast<std::size_t>(image.sectors)) {
        throw InputError("values has " + std::to_string(image.values.size()) + " values",
                         "must be " + std::to_string(image.depth.size()) + " rows of " + std::to_string(image.sectors));
    }
    require_depths(image.depth);
    require_order("depth", image.depth);
    if (quads.sector.empty()) throw InputError("sector", "must have at least one");
    require_vertex_count(quads.count);
    if (quads.count > 0) {  // an empty wall has no start
        require_depth("start_depth", quads.start_depth);
        require_pitch(quads.pitch);
    }
    require_threads(threads);
}

}  // namespace

std::vector<double> cell_values(const ImageRows& image, std::span<const double> low, std::span<const double> high,
                                const QuadCentres& quads, int threads) {
    const StandardArithmetic standard;
    require_cells(image, quads, threads);
    require_length("low", low.size(), image.depth.size());
    require_length("high", high.size(), image.depth.size());
    require_finite("low", low);
    require_order("low", low);
    require_finite("high", high);
    const std::vector<Across> across = across_of(image, quads.sector);
    return fill(low, quads, threads, [&](Index row, Index column, double depth) {
        if (depth >= high[static_cast<std::size_t>(row)]) return missing;
        const std::size_t at = across[static_cast<std::size_t>(column)].left;
        return image.values[static_cast<std::size_t>(row * image.sectors) + at];
    });
}

std::vector<double> linear_values(const ImageRows& image, double reach, const QuadCentres& quads, int threads) {
    const StandardArithmetic standard;
    require_cells(image, quads, threads);
    require(reach >= 0.0, "reach", reach, "must be 0 or above");
    const std::vector<Across> across = across_of(image, quads.sector);
    const double* const depths = image.depth.data();
    const auto last = static_cast<Index>(image.depth.size()) - 1;
    return fill(image.depth, quads, threads, [&](Index row, Index column, double depth) {
        const auto [left, right, share] = across[static_cast<std::size_t>(column)];
        const double* const upper = image.values.data() + row * image.sectors;
        const double top = between(upper[left], upper[right], share);
        if (depth == depths[row]) return top;
        if (row == last) return missing;
        const double spacing = depths[row + 1] - depths[row];
        if (spacing > 2.0 * reach) return missing;
        const double* const lower = upper + image.sectors;
        return between(top, between(lower[left], lower[right], share), (depth - depths[row]) / spacing);
    });
}

}  // namespace helibore
