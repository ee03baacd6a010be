// Finds the neighbours of groups of eight vertices and has the kernel estimate their radii.
//
// The samples lie in canonical order, so the box around a group (kernel/kernel.hpp) is a run of them filtered by
// toolface; the half height of the box is carried over from the group before, and grows until the kernel says that
// nothing outside can matter. How large the box was never shows in the result.
#pragma once

#include <memory>
#include <span>
#include <vector>

#include "helibore/settings.hpp"
#include "samples/helix.hpp"
#include "samples/samples.hpp"
#include "search/kernel/kernel.hpp"

namespace helibore {

// What the search knows of a group when it is done.
struct GroupResult {
    double radius[kernel::lanes];
    double nearest[kernel::lanes];
    std::uint16_t support[kernel::lanes];
    std::uint8_t iterations[kernel::lanes];
    // A new sample shallower than `shallow` or deeper than `deep` changes nothing in this group.
    double shallow, deep;
};

class Search {
  public:
    explicit Search(const Settings& settings);

    // Memory of one worker: the candidate list, and where the last group was. Every group writes it, so no other worker
    // has a part of its two lines (of which the processor fetches one with the other): that cost each a tenth.
    class alignas(128) Scratch {
      public:
        Scratch();

      private:
        friend class Search;
        void pad();

        // Room for the longest list, which few groups need: not zeroed, so that what is not used costs nothing.
        std::unique_ptr<kernel::Candidate[]> rows;
        std::unique_ptr<float[]> across, along;
        kernel::CandidateList list;
        std::vector<unsigned char> keep;
        Samples::Place place;
        double half_height = 0.0;  // of the next group's first box; 0: not known yet
        double mean_square = 0.0;  // of the reach of the groups before
    };

    // Vertices [8 group, 8 group + 8) of the helix, those from vertex_count on left out.
    void run(const Samples& samples, const Helix& helix, Index group, Index vertex_count, Scratch& scratch,
             GroupResult& result) const;

    // The means, by the weights of the radius, of values at the neighbours of each vertex of the group: channels of one
    // value a sample, in canonical order, NaN for none; into out[channel][vertex - 8 group], NaN where none has one.
    void carry(const Samples& samples, const Helix& helix, Index group, Index vertex_count, Scratch& scratch,
               std::span<const std::span<const double>> channels, std::span<double* const> out) const;

    const kernel::Functions& functions() const { return *functions_; }

  private:
    struct Span;  // the depths and toolfaces of a group

    struct Neighbour {
        std::uint64_t key;  // the squared distance, tagged as in the kernel
        double square, weight;
        Index rank;
    };

    kernel::Group solve(const Samples& samples, const Helix& helix, Index group, Index vertex_count,
                        Scratch& scratch) const;
    void weigh(const kernel::Group& g, Index lane, const kernel::CandidateList& list,
               std::vector<Neighbour>& neighbours) const;
    kernel::Group start(const Samples& samples, const Helix& helix, Index group, Index vertex_count) const;
    void search_box(const Samples& samples, const Span& span, kernel::Group& g, Scratch& scratch) const;
    void fetch_box(const Samples& samples, double low, double high, const kernel::Filter& filter, kernel::Group& g,
                   Scratch& scratch) const;
    void fetch_window(const Samples& samples, kernel::Group& g, Scratch& scratch) const;
    void gather(const Chunk& chunk, Index start, Index stop, Index rank, const kernel::Filter& filter, kernel::Group& g,
                Scratch& scratch) const;
    void shrink(kernel::Group& g, Scratch& scratch) const;
    void window_reach(const Samples& samples, const kernel::Group& g, Index used, GroupResult& result) const;
    double first_guess(const Samples& samples) const;

    Settings settings_;
    std::vector<double> toolface_;  // of the vertices of a turn
    kernel::Rules rules_;
    const kernel::Functions* functions_;
};

}  // namespace helibore
