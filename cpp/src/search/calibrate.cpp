// The uncertainty of a wall from the errors at samples that are left out: the likeliest noise and powers, by Student's
// t.
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numeric>

#include "base/arithmetic.hpp"
#include "base/exponential.hpp"
#include "base/messages.hpp"
#include "helibore/estimates.hpp"
#include "samples/step.hpp"

namespace helibore {
namespace {

constexpr double freedom = 5.0;
constexpr double median_square = 0.455;  // of a normal deviate with variance 1
constexpr double enough = 0.1;           // a smaller difference of the log-likelihood does not count
constexpr double smallest = 1e-18;       // square metres; smaller squares are rounding errors
constexpr double near_depth = 0.15;      // metres: as far as a measured vertex may be from its sample
constexpr std::array stretches{1.0, 16.0, 256.0};
// With powers beyond these, noise would count as shape in a near-round hole.
constexpr std::array<double, 2> least_powers{0.5, 1.0}, most_powers{1.0, 1.0};
constexpr int most_steps = 40;

constexpr std::size_t parameters = 4;  // logarithms of tau^2 and of c, about the mean of the changes; powers of S and D
using Four = std::array<double, parameters>;

double quantile_of(std::vector<double> values, double share) {
    std::ranges::sort(values);
    const double place = share * static_cast<double>(values.size() - 1);
    const auto below = static_cast<std::size_t>(place);
    const std::size_t above = std::min(below + 1, values.size() - 1);
    return values[below] + (place - static_cast<double>(below)) * (values[above] - values[below]);
}

double mean_of(const std::vector<double>& values) {
    return std::accumulate(values.begin(), values.end(), 0.0) / static_cast<double>(values.size());
}

// Solves a system whose matrix is symmetric and positive definite, by elimination.
Four solved(std::array<Four, parameters> matrix, Four right) {
    for (std::size_t pivot = 0; pivot < parameters; ++pivot)
        for (std::size_t row = pivot + 1; row < parameters; ++row) {
            const double share = matrix[row][pivot] / matrix[pivot][pivot];
            for (std::size_t column = pivot; column < parameters; ++column)
                matrix[row][column] -= share * matrix[pivot][column];
            right[row] -= share * right[pivot];
        }
    for (std::size_t row = parameters; row-- > 0;) {
        for (std::size_t column = row + 1; column < parameters; ++column)
            right[row] -= matrix[row][column] * right[column];
        right[row] /= matrix[row][row];
    }
    return right;
}

struct Found {
    double likelihood;
    double noise, between;  // tau^2, c
    std::array<double, 2> powers;
};

// The errors, squared, and what their variances depend on: W, and the logarithms of S and D.
class Errors {
  public:
    Errors(const std::vector<double>& squares, const std::vector<double>& weights,
           const std::array<std::vector<double>, 2>& changes, double least_noise)
        : squares_(squares),
          weights_(weights),
          changes_(changes),
          middle_{mean_of(changes[0]), mean_of(changes[1])},
          least_noise_(least_noise) {}

    // Finds the likeliest parameters by damped Fisher scoring. The search starts from `near`; without one, it starts
    // from each of three values of tau^2.
    Found fit(const std::optional<Found>& near) const {
        const double median = std::max(quantile_of(squares_, 0.5), smallest) / median_square;
        const double usual = logarithm(std::max(median, least_noise_));
        const double least = least_noise_ > 0.0 ? logarithm(least_noise_) : -std::numeric_limits<double>::infinity();
        const Four low{std::max(usual - 12.0, least), usual - 12.0, least_powers[0], least_powers[1]};
        const Four high{usual + 5.0, usual + 5.0, most_powers[0], most_powers[1]};
        std::vector<Four> starts;
        if (near)
            starts.push_back({logarithm(near->noise),
                              logarithm(near->between) + near->powers[0] * middle_[0] + near->powers[1] * middle_[1],
                              near->powers[0], near->powers[1]});
        else
            for (const double share : {0.1, 0.5, 0.9})
                starts.push_back({std::max(usual + logarithm(share), least), usual + logarithm(1.0 - share), 1.0, 1.0});
        double best = std::numeric_limits<double>::infinity();
        Four at = low;
        for (const Four& start : starts)
            if (const auto [cost, end] = climbed(start, low, high); cost < best) best = cost, at = end;
        return {
            -best, exponential(at[0]), exponential(at[1] - at[2] * middle_[0] - at[3] * middle_[1]), {at[2], at[3]}};
    }

  private:
    // Noise and variance of an error.
    std::array<double, 2> parts(const Four& of, std::size_t i) const {
        const double noise = exponential(of[0]) * (1.0 + weights_[i]);
        const double shape = of[1] + of[2] * (changes_[0][i] - middle_[0]) + of[3] * (changes_[1][i] - middle_[1]);
        return {noise, noise + exponential(std::clamp(shape, -100.0, 100.0))};
    }
    double cost(const Four& of) const {
        double sum = 0.0;
        for (std::size_t i = 0; i < squares_.size(); ++i) {
            const double variance = parts(of, i)[1];
            sum += (freedom + 1.0) * logarithm(1.0 + squares_[i] / (freedom * variance)) + logarithm(variance);
        }
        return 0.5 * sum;
    }
    std::pair<double, Four> climbed(Four at, const Four& low, const Four& high) const {
        double now = cost(at), damping = 1e-2;
        for (int steps = 0; steps < most_steps; ++steps) {
            std::array<Four, parameters> normal{};
            Four right{};
            for (std::size_t i = 0; i < squares_.size(); ++i) {
                const auto [noise, variance] = parts(at, i);
                const double slope = 0.5 - 0.5 * (freedom + 1.0) * squares_[i] / (freedom * variance + squares_[i]);
                const double share = noise / variance;
                const Four moves{share, 1.0 - share, (1.0 - share) * (changes_[0][i] - middle_[0]),
                                 (1.0 - share) * (changes_[1][i] - middle_[1])};
                for (std::size_t a = 0; a < parameters; ++a) {
                    right[a] += moves[a] * slope;
                    for (std::size_t b = 0; b < parameters; ++b) normal[a][b] += moves[a] * moves[b];
                }
            }
            for (Four& row : normal)
                for (double& of : row) of *= freedom / (2.0 * (freedom + 3.0));
            for (std::size_t a = 0; a < parameters; ++a) normal[a][a] += damping * (normal[a][a] + 1.0);
            const Four step = solved(normal, right);
            Four trial{};
            for (std::size_t a = 0; a < parameters; ++a) trial[a] = std::clamp(at[a] - step[a], low[a], high[a]);
            const double then = cost(trial);
            const bool done = std::abs(now - then) < enough;
            if (then < now)
                at = trial, now = then, damping /= 5.0;
            else
                damping *= 5.0;
            if (done) break;
        }
        return {now, at};
    }

    const std::vector<double>& squares_;
    const std::vector<double>& weights_;
    const std::array<std::vector<double>, 2>& changes_;
    std::array<double, 2> middle_;
    double least_noise_;
};

std::vector<double> logarithms(std::vector<double> values) {
    for (double& of : values) of = logarithm(std::max(of, smallest));
    return values;
}

}  // namespace

std::optional<Calibration> calibrate(const SampleColumns& samples, const LeftOut& left_out, const Settings& given) {
    const StandardArithmetic standard;
    Settings settings = given;
    settings.max_iterations = 1;
    std::array<std::vector<double>, 3> places;
    for (const Index row : left_out.rows) {
        require(row >= 0 && row < std::ssize(samples.depth), "rows", row, "must be one of the samples");
        const auto at = static_cast<std::size_t>(row);
        places[0].push_back(samples.depth[at]), places[1].push_back(samples.toolface[at]);
        places[2].push_back(samples.radius[at]);
    }
    const PointEstimates found =
        estimate_at(samples, {places[0], places[1], places[2], left_out.box_depth, left_out.box_turn}, settings);
    std::vector<double> squares, weights, scatter, along, across, reaches;
    for (std::size_t i = 0; i < found.radius.size(); ++i) {
        if (!std::isfinite(found.radius[i])) continue;
        const double error = found.radius[i] - places[2][i];
        squares.push_back(std::max(error * error, smallest));
        weights.push_back(found.square_weights[i]), scatter.push_back(found.scatter[i]);
        along.push_back(found.along[i]), across.push_back(found.across[i]);
        reaches.push_back(found.along[i] + found.across[i]);
    }
    if (squares.empty()) return {};
    std::array<std::vector<double>, 2> changes{logarithms(std::move(scatter)), {}};
    std::optional<Found> best, last;
    double stretch = 0.0;
    const double step = step_of(samples.radius), least_noise = step * step / 12.0;
    std::vector<double> ratios;
    for (const double of : stretches) {  // each fit starts from the result of the previous one
        std::vector<double> distance(along);
        for (std::size_t i = 0; i < distance.size(); ++i) distance[i] += of * across[i];
        changes[1] = logarithms(std::move(distance));
        last = Errors(squares, weights, changes, least_noise).fit(last);
        if (best && !(last->likelihood > best->likelihood)) continue;
        best = last, stretch = of;
        ratios.clear();
        for (std::size_t i = 0; i < squares.size(); ++i) {
            const double shape = exponential(best->powers[0] * changes[0][i] + best->powers[1] * changes[1][i]);
            ratios.push_back(squares[i] / (best->noise * (1.0 + weights[i]) + best->between * shape));
        }
    }
    const double reach = std::sqrt(quantile_of(std::move(reaches), 0.98));
    return Calibration{std::sqrt(best->noise), best->between, best->powers[0], best->powers[1], stretch,
                       std::sqrt(quantile_of(std::move(ratios), 0.95)),
                       // single vertices between random samples lie a little farther
                       std::max(reach, std::min(1.5 * reach, near_depth))};
}

}  // namespace helibore
