// The page has no covariance of a hole: near and far neighbours, which need one, are not a part of the module.
#include "search/near_far.hpp"

#include "helibore/error.hpp"

namespace helibore {

LikelyNearFar::LikelyNearFar(const Settings&) {
    throw InputError("estimator", "must not be near-and-far in a page", "near and far");
}

void LikelyNearFar::run(const Samples&, const Helix&, Index, Search::Scratch&, GroupResult&) const {}

void LikelyNearFar::interpolate(const Samples&, const Helix&, Index, Index, Search::Scratch&,
                                std::span<const std::span<const double>>, std::span<double* const>) const {}

std::vector<Search::FarChange> LikelyNearFar::far_changes(const Samples&, Index) const {
    return {};
}

}  // namespace helibore
