// Kriging with near and far neighbours, by the covariance of the hole (Settings::covariance).
//
// The vertices 8 g to 8 g + 7 of the helix share their neighbours, and so one system of equations with a right side for
// each (kernel/near_far.hpp). These are, each sample once:
//
//     near, short metric      for each vertex, the 3 V / 8 nearest by hypot(R turn / around, depth / along) of term 1
//     near, long metric       the same by term 2: along an arm, into the next turn; if the term repeats after half a
//                             turn, half of them near the vertex and half of them opposite
//     far                     the V cells that are nearest to the group in the long metric: on all sides
//
// A cell of the hole is 0.35 of the long term's lengths along and around. A far neighbour is the first sample of its
// cell, in canonical order, that is not a near neighbour; the cell lies where that sample does. If the noise is above a
// quarter of the variance of the long term, it is the mean of the first 32 such samples, at the mean of their
// positions, with a 32nd of the noise; cells are then 0.25 of the lengths, and 3 V / 2 of them are used. A sample
// counts once. Samples farther than max_distance from the vertex (far: cells, from the group), on a wall of radius R,
// are not used. Nothing iterates: R is a setting.
//
// With Settings::robust, a neighbour that lies beyond the second greatest or the second least radius of the eight
// others that are nearest to it in the short metric, by more than 2.5 deviations of the noise, has more noise: the
// square of its distance from their middle is added. So a spike hardly counts. The eight samples before and after it in
// canonical order are none of these: a tool often errs several times in a row. Means are not judged.
//
// With Settings::stretches, a vertex has the covariance of its stretch of the hole:
//
//     quiet          | washed out      | quiet       depth -->
//      a vertex here . . . . . these samples have more noise for it: by how much their stretch varies more, by the
//                      square of the difference of the two R, and by the greater variance times the square of their
//                      distance from the border over 0.2 m; so those beside the border count, and others hardly
#pragma once

#include <memory>
#include <span>
#include <vector>

#include "search/search.hpp"

namespace helibore {

class NearFar {
  public:
    // The extra noise of samples from a depth on: square metres, and more by the square of the distance from the
    // vertices' stretch.
    struct Excess {
        double start, noise, by_square;
    };
    // `number`: which of the covariances it is. `excess`: of each stretch of the hole, of which it is one.
    NearFar(const Settings& settings, std::size_t number, std::vector<Excess> excess);

    // Memory of one worker.
    struct Scratch;

    // As the functions of Search; run() also sets vertices from the vertex count on.
    void run(const Samples& samples, const Helix& helix, Index group, Search::Scratch& scratch,
             GroupResult& result) const;
    void interpolate(const Samples& samples, const Helix& helix, Index group, Index vertex_count,
                     Search::Scratch& scratch, std::span<const std::span<const double>> channels,
                     std::span<double* const> out) const;
    double far_depth(const Samples& samples, Index count) const;

  private:
    // The depths between which samples decide a group; below `near_deep`, only as far neighbours.
    struct Bounds {
        double shallow, deep, near_deep;
    };
    // Lists the neighbours of a group in `scratch`, in canonical order.
    kernel::Group find(const Samples& samples, const Helix& helix, Index group, Scratch& scratch, Bounds& bounds) const;
    // Lists the far neighbours. Returns the greatest distance along the hole, from the middle of the group, at which
    // one more cell would be used.
    double find_far(const Samples& samples, const kernel::Group& g, double half_width, Scratch& scratch) const;
    void gather_cells(const Samples& samples, double low, double high, Scratch& scratch) const;
    // Sets the noise that is added to each neighbour in `scratch`.
    void judge(Scratch& scratch) const;
    template <class Use>
    void each_member(const Samples& samples, const Scratch& scratch, Samples::Place at, Use use) const;
    template <class Value>
    kernel::SharedNeighbor mean_of(std::span<const kernel::Candidate> members, const Value& value) const;
    template <class Value>
    void krige(kernel::Group& g, Scratch& scratch, const Value& value) const;
    // Calls use(helix, group, first, count, to) for the one or two groups of the whole helix that a group of a stretch
    // consists of: the vertices [first, first + count) of a group are those from `to` on of the stretch's group.
    template <class Use>
    void each_part(const Helix& helix, Index group, Use use) const;
    Scratch& scratch_of(Search::Scratch& scratch) const;

    kernel::CovarianceRule rule_;
    int near_, near_long_;            // near neighbours of a vertex in each metric
    Search short_, long_, opposite_;  // opposite_: half a turn from each vertex, by the long metric
    Cells cells_;
    int wanted_;                                  // far neighbours of a group
    std::size_t averaged_;                        // greatest number of samples of one of them
    double max_distance_, max_square_, stretch_;  // stretch_: along / around of the long metric
    double short_stretch_;                        // the same of the short metric
    bool robust_;
    std::size_t number_;
    std::vector<Excess> excess_;
};

// Each vertex by the covariance of its stretch, or the mean by Settings::covariance and other_turns, weighted by their
// shares.
class LikelyNearFar {
  public:
    explicit LikelyNearFar(const Settings& settings);

    // As those of NearFar.
    void run(const Samples& samples, const Helix& helix, Index group, Search::Scratch& scratch,
             GroupResult& result) const;
    void interpolate(const Samples& samples, const Helix& helix, Index group, Index vertex_count,
                     Search::Scratch& scratch, std::span<const std::span<const double>> channels,
                     std::span<double* const> out) const;
    std::vector<Search::FarChange> far_changes(const Samples& samples, Index count) const;

  private:
    struct One {
        double share, start, stop;  // of the vertices from depth `start` to `stop`
        NearFar by;
        bool holds(double depth) const { return start <= depth && depth < stop; }
    };
    // Calls use(one) for each that holds one of the vertices of a group.
    template <class Use>
    void each_of(const Helix& helix, Index group, Use use) const;
    std::vector<One> each_;
};

}  // namespace helibore
