// Kriging with near and far neighbours, by the covariance of the hole (Settings::covariance).
//
// The neighbours of a vertex are V samples of each of three sets; a sample in several of them counts once:
//
//     near, short metric      the nearest samples by hypot(R turn / around, depth / along) of the first term
//     near, long metric       the same by the second term: along an arm, into the next turn
//     far                     the nearest in the long metric of a thinned set, so that they lie on all sides
//
// The thinned set holds the first sample, in canonical order, of each cell of the hole: `share` of the long term's
// lengths along and around. It depends on nothing else, so it belongs to the canonical order. Samples farther than
// max_distance, on a wall of radius R, are not used. Nothing iterates: R is a setting.
#pragma once

#include <memory>
#include <span>
#include <vector>

#include "search/search.hpp"

namespace helibore {

class NearFar {
  public:
    explicit NearFar(const Settings& settings);
    ~NearFar();

    // Memory of one worker.
    struct Scratch;

    // As the functions of Search.
    void run(const Samples& samples, const Helix& helix, Index group, Index vertex_count, Search::Scratch& scratch,
             GroupResult& result) const;
    void interpolate(const Samples& samples, const Helix& helix, Index group, Index vertex_count,
                     Search::Scratch& scratch, std::span<const std::span<const double>> channels,
                     std::span<double* const> out) const;

  private:
    // Lists the neighbours of the group's vertices in `scratch`. Returns the group; its support is the number of
    // neighbours. `shallow` and `deep` become the depths between which samples decide them.
    kernel::Group find(const Samples& samples, const Helix& helix, Index group, Index vertex_count, Scratch& scratch,
                       double& shallow, double& deep) const;
    // Returns the greatest distance along the hole at which one more sample of the thinned set would be used.
    double find_far(const Samples& samples, const kernel::Group& g, Index used, Scratch& scratch) const;
    void gather_cells(const Samples& samples, double low, double high, Scratch& scratch) const;
    int krige(kernel::Group& g, Scratch& scratch) const;
    Scratch& scratch_of(Search::Scratch& scratch) const;

    kernel::CovarianceRule rule_;
    Search short_, long_;
    Cells cells_;
    double max_distance_, max_square_, stretch_;  // stretch_: along / around of the long metric
    Index wanted_;
};

}  // namespace helibore
