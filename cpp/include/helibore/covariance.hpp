// The covariance of a hole, fitted to its samples: Settings::covariance for near_and_far.
#pragma once

#include <vector>

#include "helibore/settings.hpp"
#include "helibore/wall.hpp"

namespace helibore {

struct LikelyCovariance {
    std::vector<double> values;  // Settings::covariance
    double share;                // how likely it is among all that are returned
};

// Returns Settings::covariance: radius, noise, and a short, a long and, if the samples show it, a fine term, and the
// turn of the shape along the hole, to five digits; the long term repeats after half a turn if that is much likelier,
// and the short term is smooth if that is likelier.
// `samples` are blocks of `block_size` samples each. The parameters maximise the mean over the blocks of the restricted
// likelihood, with weak priors. The noise variance of quantised radii is at least step^2 / 48. The long term is not
// much shorter along the hole than `spacing`, the typical distance between samples in metres, and the fine term not
// shorter: it would be noise. The first is the likeliest; if the samples do not show whether and whereto the shape
// turns, others follow, with two terms, and each has its share of the probability. None has a turn of its own that is
// slower than `least_turn`, degrees a metre: such turns are only some of several. With infinity none is sought, nor a
// fine term, nor half a turn.
//
// Throws InputError if the columns do not make whole blocks, or if a value breaks the rule of its column.
std::vector<LikelyCovariance> fit_covariance(const SampleColumns& samples, Index block_size, double radius,
                                             double spacing, double least_turn, int threads = 1,
                                             InstructionSet instruction_set = InstructionSet::automatic);

// Returns for each part of a hole the likeliest covariance, as above, that is climbed to from that of `starts`, whose
// kind and turn it keeps. `samples` are `blocks` blocks of `block_size` samples of each part.
std::vector<std::vector<double>> covariances_near(const SampleColumns& samples, Index block_size, Index blocks,
                                                  const std::vector<std::vector<double>>& starts, double spacing,
                                                  int threads = 1,
                                                  InstructionSet instruction_set = InstructionSet::automatic);

// Returns the log-likelihoods of each part of a hole by covariances: of part 0 by all, then of part 1, ...; nats a
// block, with the weak priors.
std::vector<double> covariance_likelihoods(const SampleColumns& samples, Index block_size, Index blocks,
                                           const std::vector<std::vector<double>>& covariances, int threads = 1,
                                           InstructionSet instruction_set = InstructionSet::automatic);

}  // namespace helibore
