// Finds the neighbours of groups of eight vertices and has the kernel estimate their radii.
//
// The samples lie in canonical order, so the box around a group (kernel/kernel.hpp) is a run of them, filtered by
// toolface. Its half height starts from that of the previous group and grows until the kernel finds that no sample
// outside can matter. The size of the box does not change the result.
#pragma once

#include <memory>
#include <span>
#include <vector>

#include "helibore/settings.hpp"
#include "samples/helix.hpp"
#include "samples/samples.hpp"
#include "search/kernel/kernel.hpp"

namespace helibore {

class LikelyNearFar;
class NearFar;

kernel::Rules rules_of(const Settings& settings);

// The result of the search of a group.
struct GroupResult {
    double radius[kernel::lanes];
    double nearest[kernel::lanes];
    std::uint16_t support[kernel::lanes];
    std::uint8_t iterations[kernel::lanes];
    // A new sample shallower than `shallow` or deeper than `deep` changes nothing in this group.
    double shallow, deep;
    // A new sample deeper than all others and deeper than `near_deep` does so only as a far neighbour.
    double near_deep;
    // A new sample also changes nothing if its squared distance from each vertex, at the radius `least_trial`, is above
    // the vertex's `reach_square`.
    double reach_square[kernel::lanes], least_trial;
    kernel::Sums sums;  // with Settings::sigma only
};

class Search {
  public:
    explicit Search(const Settings& settings);

    // The samples that a group may use: all samples, or those in the windows of its vertices.
    struct Windows {
        Index centered[kernel::lanes];  // rank at which the window of each vertex starts if the vertex is its middle
        Index first[kernel::lanes];     // the rank in `centered`, moved so that the window lies within the samples
        Index length;                   // samples in a window
        Range all;                      // ranks of all windows together
        double shallow, deep;           // depths of the first and last sample of `all`
        std::size_t chunk = 0;          // index of the chunk in which the last vertex lies
    };

    // Memory of one worker: the list of candidates and the place of the previous group. Every group writes to it, so it
    // is aligned to the two cache lines that processors fetch together: shared lines would cost each worker a tenth of
    // its time.
    class alignas(128) Scratch {
      public:
        Scratch();

      private:
        friend class Search;
        friend class NearFar;
        void pad();

        // Room for the longest list, which few groups need; not zeroed, so that unused memory costs nothing.
        std::unique_ptr<kernel::Candidate[]> rows;
        std::unique_ptr<float[]> across, along;
        std::unique_ptr<kernel::Room> room;
        std::unique_ptr<kernel::KrigingRoom> kriging;
        std::vector<std::shared_ptr<void>> near_far;  // NearFar::Scratch of each covariance, made when first needed
        kernel::CandidateList list;
        std::vector<unsigned char> keep;
        Samples::Place place;
        Windows windows;
        std::vector<double> turns;  // angles from each vertex to the V nearest samples listed at level_depth, sorted
        double level_depth = 0.0;
        double least_trial = 0.0;  // the least radius for which the levels in the list are valid
        double half_height = 0.0;  // of the first box of the next group; 0: not known yet
        double mean_square = 0.0;  // running mean of the squared reach of previous groups
        double mean_height = 0.0;  // mean squared height that previous groups needed; 0: turns are not looked at
        bool first_list = false;   // whether the list is the first of its group and was never shrunk
        Index even = 0;            // how many of the next groups skip the check for samples on few toolfaces
    };

    // Searches vertices [8 group, 8 group + 8) of the helix; those from vertex_count on are left out.
    void run(const Samples& samples, const Helix& helix, Index group, Index vertex_count, Scratch& scratch,
             GroupResult& result) const;

    // Computes values at the vertices of the group from the neighbours of each, with the weights of the radius. Each
    // channel has one value for each sample in canonical order, NaN for none; results go to out[channel][vertex - 8
    // group], NaN if no neighbour has a value.
    void interpolate(const Samples& samples, const Helix& helix, Index group, Index vertex_count, Scratch& scratch,
                     std::span<const std::span<const double>> channels, std::span<double* const> out) const;

    // What the last `count` samples, which lie deeper than all others, can change from afar: no group, some vertices of
    // which lie in [start, stop), if its `near_deep` is less than their depths and than `depth`.
    struct FarChange {
        double start, stop, depth;
    };
    std::vector<FarChange> far_changes(const Samples& samples, Index count) const;

    // Finds the neighbours of the group at its first trial radii: found[i * 8 + lane], in canonical order, rows of
    // depth kernel::none_depth where there are fewer. They may lie beyond max_distance. Of the result, only `shallow`
    // and `deep` are set.
    kernel::Group neighbours(const Samples& samples, const Helix& helix, Index group, Index vertex_count,
                             Scratch& scratch, kernel::Candidate* found, GroupResult& result) const;

    const kernel::Functions& functions() const { return *functions_; }

  private:
    struct Span;  // the depths and toolfaces of a group

    struct Neighbour {
        std::uint64_t key;  // the squared distance; its low bits are the position in the list, as in the kernel
        double square, weight;
        Index rank;
    };

    kernel::Group solve(const Samples& samples, const Helix& helix, Index group, Index vertex_count,
                        Scratch& scratch) const;
    kernel::Group list_at(const Samples& samples, const Helix& helix, Index group, Index vertex_count,
                          const double (&trial)[kernel::lanes], Scratch& scratch) const;
    void weigh(const kernel::Group& g, Index lane, double trial, const kernel::CandidateList& list,
               std::vector<Neighbour>& neighbours) const;
    void choose(const kernel::Group& g, Index lane, double trial, const kernel::CandidateList& list,
                std::vector<Neighbour>& neighbours) const;
    void krige(kernel::Group g, Index used, std::span<const double> channel, const kernel::CandidateList& list,
               std::vector<Neighbour>& neighbours, double* out) const;
    kernel::Group start(const Helix& helix, Index group, Index vertex_count) const;
    void search_box(const Samples& samples, const Span& span, const kernel::Rules& rules, kernel::Group& g,
                    Scratch& scratch) const;
    void fetch_box(const Samples& samples, double low, double high, const kernel::Filter& filter,
                   const kernel::Box& box, kernel::Group& g, Scratch& scratch) const;
    void gather(const Chunk& chunk, Index start, Index stop, Index rank, const kernel::Filter& filter,
                const kernel::Box& box, kernel::Group& g, Scratch& scratch) const;
    void gather_level(const Chunk& chunk, const Level& level, Index rank, const kernel::Box& box, kernel::Group& g,
                      Scratch& scratch) const;
    void shrink(const kernel::Box& box, kernel::Group& g, Scratch& scratch) const;
    void find_windows(const Samples& samples, const kernel::Group& g, Index used, Windows& windows) const;
    Index place_windows(const Windows& windows, const kernel::CandidateList& list, kernel::Group& g) const;
    void set_reach(const Span& span, double square, GroupResult& result) const;
    void window_reach(const Samples& samples, const Windows& windows, const Span& span, GroupResult& result) const;
    double mean_across(const kernel::Group& g, const kernel::CandidateList& list) const;
    void find_turns(const Samples& samples, double low, double high, kernel::Group& g) const;
    double first_guess(const Samples& samples) const;

    Settings settings_;
    std::vector<double> toolface_;  // of the vertices of a turn
    kernel::Rules rules_;
    const kernel::Functions* functions_;
    std::shared_ptr<const LikelyNearFar> near_far_;  // with Estimator::near_and_far only
};

}  // namespace helibore
