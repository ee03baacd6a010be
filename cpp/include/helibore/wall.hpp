// The wall of a hole takes settings and samples; it gives the radius at every vertex of the helix, and what each append
// changed.
//
//     helibore::Wall wall({.bit_diameter = 0.216});
//     const helibore::Change change = wall.append({depth, toolface, radius});
//     const std::vector<double> radius = wall.radius();
//
// Batch use is one append, live use is many appends. Several threads may use one Wall, because it returns copies only.
#pragma once

#include <array>
#include <memory>
#include <span>
#include <string_view>
#include <vector>

#include "helibore/settings.hpp"
#include "helibore/types.hpp"

namespace helibore {

// Columns of equal length, borrowed for the call: metres, degrees clockwise looking downhole, metres from the axis of
// the hole, and seconds or any other clock. Either all samples of a wall have a time or none has.
struct SampleColumns {
    std::span<const double> depth;
    std::span<const double> toolface;
    std::span<const double> radius;
    std::span<const double> time = {};

    // Throws InputError if a row breaks a rule of its column. The error names the first such row: "toolface[17] = nan:
    // must be finite".
    void validate(int threads = 1) const;
};

// The columns of VertexColumns, in their order.
enum class Column { depth, toolface, radius, nearest, support, iterations, provisional };

// One value for each vertex: metres and degrees.
struct VertexColumns {
    std::vector<double> depth, toolface;
    std::vector<double> radius;            // NaN where no sample is within max_distance
    std::vector<double> nearest;           // distance to the nearest sample used; NaN where there is none
    std::vector<std::int32_t> support;     // samples used
    std::vector<std::int32_t> iterations;  // estimates made

    // 1: the vertex is not settled and shows the radius of a sample in its cell. With Settings::direct only.
    std::vector<std::uint8_t> provisional;
};

struct Change {
    std::vector<Range> ranges;  // vertices that are new or whose values changed; sorted, with gaps between them
    Index settled = 0;          // vertices with a lower number no longer change while the hole only gets deeper
    Index accepted = 0;         // number of samples taken
    Index redundant = 0;        // number of samples dropped: equal to another in depth, time, toolface and radius
};

// The ends of an interval, metres.
struct Depths {
    double shallow, deep;
};

class Wall {
  public:
    // Throws InputError on bad settings.
    explicit Wall(const Settings& settings);
    ~Wall();
    // A wall that was moved from may only be destroyed or assigned to.
    Wall(Wall&&) noexcept;
    Wall& operator=(Wall&&) noexcept;

    const Settings& settings() const;

    // Adds samples anywhere in the hole and recomputes the vertices that these samples can change. If it throws
    // InputError ("toolface[17] = nan: must be finite") or std::bad_alloc, the wall is unchanged.
    Change append(const SampleColumns& samples);

    // Vertex numbers, here and in a Change, count from vertex 0 of the helix; the numbers in a part of a wall start
    // at first_vertex.

    Index size() const;          // number of vertices
    Index sample_count() const;  // number of samples kept
    Index settled() const;       // vertices with a lower number no longer change while the hole only gets deeper
    double start_depth() const;  // depth of the first vertex; NaN while neither the settings nor a sample give it

    // Return copies of a range of vertices, or of all vertices; no append runs while the copies are made. Throw
    // InputError if the range reaches beyond the wall.
    VertexColumns vertices(Range range) const;
    VertexColumns vertices() const;

    // Returns the depths between which samples decide the values of a range of vertices. Any wall with the same samples
    // between these depths has the same bits at these vertices, whatever samples lie beyond. A depth is infinite if a
    // vertex found too few samples and max_distance sets no limit, or if its window is cut short by the end of the
    // samples. For an empty range, shallow is infinity and deep is -infinity.
    Depths reach(Range range) const;

    // Writes one column of a range of vertices into the host's own memory. Throws InputError if the range reaches
    // beyond the wall, or if `into` has another length.
    void read(Column column, Range range, std::span<double> into) const;

    // Writes the radii of all vertices into the host's own memory and returns size(). If `into` has another length, it
    // writes nothing: the wall may have grown since the host asked for its size.
    [[nodiscard]] Index read_radius(std::span<double> into) const;

    // Return one column of all vertices.
    std::vector<double> depth() const;
    std::vector<double> toolface() const;
    std::vector<double> radius() const;
    std::vector<double> nearest() const;
    std::vector<std::int32_t> support() const;
    std::vector<std::int32_t> iterations() const;
    std::vector<std::uint8_t> provisional() const;

    // Returns the sums W, S, A and C of SigmaRule, from which the uncertainties of all radii are computed; NaN where
    // the radius is NaN. With near and far neighbours: the kriging variance, how far the neighbours are off (about 1;
    // kernel/near_far.hpp), 0 and 0. Throws InputError if Settings::sigma is false.
    std::array<std::vector<double>, 4> sums() const;
    // Writes the sums that sums() returns into columns of the caller. Returns false, and writes nothing, if there are
    // not four columns of size() values. Throws like sums().
    [[nodiscard]] bool read_sums(std::span<const std::span<double>> into) const;

    // Interpolates channels, values measured with the samples, at the vertices, with the neighbours and weights of the
    // radius. Each channel holds one value for each sample, in the order of samples(), NaN for none. The result holds
    // one value for each vertex, NaN where no neighbour has a value. Throws InputError if a channel has another length.
    std::vector<std::vector<double>> interpolate_samples(std::span<const std::span<const double>> channels,
                                                         int threads = 1) const;

    // Returns the samples kept, in canonical order, as columns: depth, toolface, radius, and time if they have one.
    std::vector<std::vector<double>> samples() const;
    // Writes the samples that samples() returns into the caller's columns: three, or four with time. Returns false, and
    // writes nothing, if the number or a length of the columns is wrong.
    [[nodiscard]] bool read_samples(std::span<const std::span<double>> into) const;

  private:
    struct State;
    std::unique_ptr<State> state_;
};

// Returns the name of the instruction set that `automatic` stands for on this machine: "plain", "avx2" or "avx512".
std::string_view instruction_set_in_use();

}  // namespace helibore
