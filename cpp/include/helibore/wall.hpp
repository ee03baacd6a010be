// The wall of a hole: settings and samples in, the radius at every vertex of the helix out, and what each append
// changed.
//
//     helibore::Wall wall({.bit_diameter = 0.216});
//     const helibore::Change change = wall.append({depth, toolface, radius});
//     const std::vector<double> radius = wall.radius();
//
// Batch is live with one append. A Wall may be used from several threads; it never lends its memory.
#pragma once

#include <memory>
#include <span>
#include <string_view>
#include <vector>

#include "helibore/settings.hpp"
#include "helibore/types.hpp"

namespace helibore {

// Columns of equal length, borrowed for the call: metres, degrees clockwise looking downhole, metres from the axis of
// the hole, and seconds or any other clock. Either all samples of a wall carry a time or none does.
struct SampleColumns {
    std::span<const double> depth;
    std::span<const double> toolface;
    std::span<const double> radius;
    std::span<const double> time = {};

    // Throws InputError that names the first row that breaks a rule of its column: "toolface[17] = nan: must be
    // finite".
    void validate(int threads = 1) const;
};

// One value a vertex: metres and degrees.
struct VertexColumns {
    std::vector<double> depth, toolface;
    std::vector<double> radius;            // NaN where no sample is in reach
    std::vector<double> nearest;           // to the nearest sample used; NaN where there is none
    std::vector<std::int32_t> support;     // samples used
    std::vector<std::int32_t> iterations;  // estimates made

    // 1: the radius is that of a sample in the vertex's cell, until the vertex is settled. With Settings::direct only.
    std::vector<std::uint8_t> provisional;
};

struct Change {
    std::vector<Range> ranges;  // vertices that are new or have other bits than before; sorted, never touching
    Index settled = 0;          // vertices below this no longer change while the hole only gets deeper
    Index accepted = 0;         // samples taken
    Index redundant = 0;        // samples equal to one already there in depth, time, toolface and radius: dropped
};

class Wall {
  public:
    // Throws InputError on bad settings.
    explicit Wall(const Settings& settings);
    ~Wall();
    Wall(Wall&&) noexcept;
    Wall& operator=(Wall&&) noexcept;

    const Settings& settings() const;

    // Takes samples anywhere in the hole and recomputes the vertices they can change. Throws InputError
    // ("toolface[17] = nan: must be finite") or std::bad_alloc, and then leaves every bit as it was.
    Change append(const SampleColumns& samples);

    Index size() const;          // vertices
    Index sample_count() const;  // samples kept
    Index settled() const;
    double start_depth() const;  // depth of vertex 0; NaN while there is none

    // Owned copies: of a range of vertices, as those of a Change, or of all. All columns are of one moment. Throws
    // InputError where the range reaches beyond the wall.
    VertexColumns vertices(Range range) const;
    VertexColumns vertices() const;

    // The radii of all vertices into memory of the host's own, which need not be cleared before; shared out to threads.
    // Returns size(), and writes nothing where `into` is of another length: the wall may have grown since it was asked.
    [[nodiscard]] Index read_radius(std::span<double> into) const;

    // One column of all vertices.
    std::vector<double> depth() const;
    std::vector<double> toolface() const;
    std::vector<double> radius() const;
    std::vector<double> nearest() const;
    std::vector<std::int32_t> support() const;
    std::vector<std::int32_t> iterations() const;
    std::vector<std::uint8_t> provisional() const;

    // Scattered attributes: values measured with the samples, one channel after another, each with a value a sample in
    // canonical order (samples()), NaN for none. One value a vertex comes back, by the neighbours and weights of its
    // radius; NaN where none of them has one. Throws InputError where a channel has another length.
    std::vector<std::vector<double>> carry(std::span<const std::span<const double>> channels, int threads = 1) const;

    // The samples kept, in canonical order: depth, toolface, radius, and time where they carry one.
    std::vector<std::vector<double>> samples() const;

  private:
    struct State;
    std::unique_ptr<State> state_;
};

// The name of the instruction set that `automatic` stands for on this machine: "plain", "avx2" or "avx512".
std::string_view instruction_set_in_use();

}  // namespace helibore
