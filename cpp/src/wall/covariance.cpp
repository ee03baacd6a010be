// Finds the likeliest parameters by damped Fisher scoring between limits. The likelihood is composite: it counts a
// sample once for each block that holds it, so its curvature says nothing about certainty.
#include "helibore/covariance.hpp"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <functional>
#include <limits>
#include <numbers>
#include <span>
#include <utility>

#include "base/arithmetic.hpp"
#include "base/exponential.hpp"
#include "base/host_memory.hpp"
#include "base/messages.hpp"
#include "base/threads.hpp"
#include "samples/helix.hpp"
#include "samples/step.hpp"
#include "search/kernel/instruction_set.hpp"

namespace helibore {
namespace {

constexpr std::size_t lanes = kernel::lanes, most = kernel::max_parts;
constexpr std::size_t noise = 6, few = 7;  // index of the noise; number of parameters without a fine term
// Logarithms of parameters: variance, around and along of the short and of the long term, the noise, and again of a
// fine term.
using Parameters = std::array<double, most>;
using Matrix = std::array<Parameters, most>;

constexpr double starts[][few] = {{1e-6, 0.05, 0.06, 4e-6, 0.1, 0.6, 0.25e-6},
                                  {1e-6, 0.03, 0.03, 4e-6, 0.1, 8.0, 1e-6},
                                  {0.3e-6, 0.06, 0.3, 20e-6, 0.12, 40.0, 4e-6},
                                  {1e-6, 0.05, 2.0, 20e-6, 0.08, 100.0, 0.25e-6}};
constexpr double half_start[few] = {0.3e-6, 0.06, 0.1, 60e-6, 0.13, 25.0, 0.25e-6};  // with_half_turns()
constexpr double priors[few] = {0.0, 0.02, 0.02, 0.03, 0.6, 0.02, 0.0};  // nats a block for one unit, squared
constexpr double expected[few] = {1.0, 0.05, 0.06, 4e-6, 0.10, 0.6, 1.0};
constexpr double ratio_prior = 0.02;  // of variance of the short term to a quarter of the noise
constexpr double fine_shares[] = {0.3, 0.7}, fine_around[] = {0.006, 0.012, 0.025};
constexpr double fine_gain = 0.03;  // nats a block that a fine term must gain
// Nats a block that a long term must gain by repeating after half a turn: in small blocks, and in one of all samples.
constexpr double small_half_gain = 0.5, great_half_gain = 2.0;
// A turn is tried at each whole degree a metre up to `slow`, with each of these lengths along the hole, and, for spiral
// holes, in longer steps up to `fast`, with a wide shape; peaks of the likelihood are then climbed. Arms that do not
// cross leave several peaks, and a false one may be the highest: a spiral of 200 degrees a metre looks to four arms as
// a shape of seven waves that turns by -20. So the highest counts only if it is `small_gain` nats a block above no
// turn, and above turns that differ by `other_turn`; a fast one also above all slow ones. In one block of all samples,
// where chance may gain as much, it must be `great_gain`.
constexpr double slow = 30.0, fast = 1200.0, fast_step = 8.0, other_turn = 1.5, small_gain = 2.5, great_gain = 10.0;
constexpr double usual_turn = 6.0;       // degrees a metre: a shape that turns by so much more is 1 / e as likely
constexpr double evidence = 2.0;         // nats for one nat a block, where there are several: all samples show more
constexpr double smallest_share = 0.02;  // of the probability, of a place that counts

struct Turns {
    double from, to, step;          // degrees a metre
    std::span<const double> along;  // lengths along the hole that are tried
};

constexpr double slow_along[] = {5.0, 20.0, 100.0}, fast_along[] = {2.0};
constexpr Turns slowly{-slow, slow, 1.0, slow_along};
constexpr std::size_t most_peaks = 6;    // that are climbed
constexpr double likely_enough = 100.0;  // nats a block below the highest peak: a lower one is not climbed
constexpr std::size_t long_along = 5;    // index of the length along the hole of the long term
constexpr std::size_t odd_arms = 5;      // 1, 3, ... 9 arms
constexpr double same_arms = 0.7;        // mean cosine of samples that lie as those of arms
constexpr double least_alike = 0.5, farthest_alike = 15.0;  // metres along the hole
constexpr double least_share = 0.7;                         // of the spacing of samples: the long term along the hole
constexpr double enough = 0.003;                            // nats a block; a smaller gain ends the search
constexpr int most_useful_threads = 8, few_steps = 8, steps = 20;
constexpr double never = -std::numeric_limits<double>::infinity();

// Returns the number with five significant digits: last bits do not matter, and settings are easier to read.
double rounded(double value) {
    char text[32];
    const char* end = std::to_chars(text, text + sizeof text, value, std::chars_format::general, 5).ptr;
    double found = value;
    std::from_chars(text, end, found);
    return found;
}

struct Limits {
    Parameters low, high;
    Parameters clipped(Parameters at) const {
        for (std::size_t i = 0; i < most; ++i) at[i] = std::clamp(at[i], low[i], high[i]);
        return at;
    }
    Parameters from(const double (&values)[few]) const {
        Parameters at = low;
        for (std::size_t p = 0; p < few; ++p) at[p] = logarithm(values[p]);
        return clipped(at);
    }
};

struct Place {
    Parameters at;
    std::size_t count;     // of parameters: few or most
    double value = never;  // log-likelihood with the prior, nats a block
    double turn = 0.0;     // degrees a metre
    bool half_turns = false, smooth = false;
    double share = 1.0;  // of the probability
};

struct Slopes {
    Parameters slope;
    Matrix curvature;  // expected second derivatives with the other sign
};

// Memory of one worker for blocks of up to `size` samples.
struct Room {
    std::vector<double> sine, cosine, numbers;
    kernel::BlockRoom parts;
    explicit Room(std::size_t size) : sine(size), cosine(size) {
        const std::size_t square = size * size;
        numbers.resize((2 + 1 + most + 1) * square + (lanes + 3) * size);
        double* next = numbers.data();
        const auto take = [&](std::size_t count) { return std::exchange(next, next + count); };
        parts.rows = take(2 * square + lanes * size);
        parts.factors = take(square);
        parts.inverses = take(size);
        parts.vectors = take(2 * size);
        for (double*& part : parts.parts) part = take(square);
    }
};
using Rooms = std::span<Room>;  // one for each thread

class Fit {
  public:
    Fit(const SampleColumns& samples, std::size_t block_size, double radius, int threads, InstructionSet level);
    void limit(double spacing);
    // Returns the likeliest place; others follow if the samples leave them about as likely.
    std::vector<Place> likely(double least_turn);
    // Returns what is climbed to from a covariance.
    std::vector<double> near(std::span<const double> covariance);
    // Returns the log-likelihood of a covariance, nats a block.
    double likelihood(std::span<const double> covariance);

  private:
    Place place_of(std::span<const double> covariance) const;
    kernel::CovarianceRule rule_of(const Place& of) const;
    bool block_terms(std::size_t b, const Place& of, const kernel::CovarianceRule& rule, bool slopes, Room& room,
                     kernel::BlockTerms& terms) const;
    double evaluate(const Place& of, std::size_t nth, Rooms rooms, Slopes* slopes = nullptr) const;
    Place climb(Place from, std::size_t nth, int most_steps, Rooms rooms) const;
    template <class Job>
    void each_place(std::span<Place> places, const Job& job);
    Place likeliest_start(const Place& kind);
    Place near_turn(const Place& start, double step, std::size_t nth, Rooms rooms) const;
    Place at_turn(const Place& from, double turn, std::span<const double> along, std::size_t nth, Rooms rooms) const;
    std::vector<Place> peaks(const Place& from, Turns turns);
    std::vector<Place> peaks(const Place& one, Turns turns, const Place& other, Turns others);
    Place widened(Place from) const;
    Place with_turn(const Place& found, double least_turn, std::vector<Place>& others);
    bool sees_opposite(const Place& of) const;
    Place with_half_turns(const Place& found);
    Place with_smooth(const Place& found);
    std::vector<Place> shared(const Place& first, std::vector<Place> others);
    Place with_fine(const Place& found);
    double row_spacing() const;

    kernel::BlockLikelihood likelihood_;
    double radius_, least_noise_;
    std::size_t n_, size_, blocks_;
    std::vector<double> toolface_, along_, off_;  // off_: radii less the mean of their block
    Limits limits_{};
    std::vector<Room> rooms_;
};

Fit::Fit(const SampleColumns& samples, std::size_t block_size, double radius, int threads, InstructionSet level)
    : likelihood_(kernel::likelihood_for(level)),
      radius_(radius),
      least_noise_(std::clamp(std::pow(step_of(samples.radius), 2) / 48.0, 1e-12, 1e-3)),
      n_(block_size),
      size_((block_size + lanes - 1) / lanes * lanes),
      blocks_(samples.depth.size() / block_size) {
    for (std::vector<double>* column : {&toolface_, &along_, &off_}) column->resize(blocks_ * size_);
    for (std::size_t b = 0; b < blocks_; ++b) {
        double mean = 0.0;
        for (std::size_t i = 0; i < n_; ++i) mean += samples.radius[b * n_ + i];
        mean /= static_cast<double>(n_);
        for (std::size_t i = 0; i < n_; ++i) {
            const std::size_t from = b * n_ + i, to = b * size_ + i;
            toolface_[to] = samples.toolface[from];
            along_[to] = samples.depth[from];
            off_[to] = samples.radius[from] - mean;
        }
    }
    for (int t = 0; t < std::min(threads, most_useful_threads); ++t) rooms_.emplace_back(size_);
}

// Returns the number of the parameter of a part in the kernel, where the noise is the last one.
std::size_t parameter_of(std::size_t part, std::size_t count) {
    return part + 1 == count ? noise : part < noise ? part : part + 1;
}

kernel::CovarianceRule Fit::rule_of(const Place& of) const {
    kernel::CovarianceRule rule{};
    rule.radius = radius_;
    rule.noise = exponential(of.at[noise]);
    rule.terms = of.count > few ? 3 : 2;
    rule.half_turns = of.half_turns;
    rule.smooth = of.smooth;
    for (std::size_t t = 0; t < static_cast<std::size_t>(rule.terms); ++t) {
        const auto value = [&](std::size_t i) { return exponential(of.at[parameter_of(3 * t + i, of.count)]); };
        const double around = 2.0 * radius_ / value(1), along = value(2);
        rule.variance[t] = value(0);
        rule.around[t] = 3.0 * around * around;
        rule.along[t] = 3.0 / (along * along);
    }
    return rule;
}

// Sets the terms of a block. Returns whether its covariance is positive definite.
bool Fit::block_terms(std::size_t b, const Place& of, const kernel::CovarianceRule& rule, bool slopes, Room& room,
                      kernel::BlockTerms& terms) const {
    const std::size_t first = b * size_;
    for (std::size_t i = 0; i < n_; ++i) {
        const double turned = toolface_[first + i] - of.turn * (along_[first + i] - along_[first]);
        const auto half = sine_cosine_of_radians(wrap_toolface(turned) * (std::numbers::pi / 360.0));
        room.sine[i] = half.sine;
        room.cosine[i] = half.cosine;
    }
    const kernel::Block block{static_cast<int>(n_), static_cast<int>(size_), room.sine.data(),
                              room.cosine.data(),   along_.data() + first,   off_.data() + first};
    return likelihood_(block, rule, slopes, room.parts, terms);
}

// Returns the log-likelihood with the prior, of every nth block, which the threads share; with slopes, also sets these.
double Fit::evaluate(const Place& of, std::size_t nth, Rooms rooms, Slopes* slopes) const {
    struct Value {
        double value = never;
        kernel::BlockTerms terms;
    };
    const kernel::CovarianceRule rule = rule_of(of);
    std::vector<Value> each((blocks_ + nth - 1) / nth);
    for_each_part(static_cast<int>(rooms.size()), std::ssize(each), [&](int worker, Index part) {
        const auto number = static_cast<std::size_t>(part);
        Room& room = rooms[static_cast<std::size_t>(worker)];
        Value& to = each[number];
        if (!block_terms(number * nth, of, rule, slopes != nullptr, room, to.terms)) return;
        to.value = logarithm(to.terms.ones) + to.terms.rest;
        for (std::size_t k = 0; k < n_; ++k) to.value -= logarithm(room.parts.inverses[k]);
    });
    const std::size_t count = of.count;
    double sum = 0.0;
    if (slopes) *slopes = {};
    for (const Value& from : each) {
        if (from.value == never) return never;
        sum += from.value;
        if (!slopes) continue;
        for (std::size_t p = 0; p < count; ++p) {
            slopes->slope[parameter_of(p, count)] += from.terms.square[p] - from.terms.trace[p];
            for (std::size_t q = 0; q <= p; ++q)
                slopes->curvature[parameter_of(p, count)][parameter_of(q, count)] += from.terms.product[p][q];
        }
    }
    const auto blocks = static_cast<double>(each.size());
    double value = -0.5 * sum / blocks;
    const double ratio = of.at[0] + logarithm(4.0) - of.at[noise];
    value -= ratio_prior * ratio * ratio;
    double off[few];
    for (std::size_t p = 0; p < few; ++p) {
        off[p] = of.at[p] - logarithm(expected[p]);
        value -= priors[p] * off[p] * off[p];
    }
    if (!slopes) return value;
    auto& [slope, curvature] = *slopes;
    for (std::size_t p = 0; p < count; ++p) {
        slope[p] *= 0.5 / blocks;
        curvature[p][p] *= 0.5 / blocks;
        for (std::size_t q = 0; q < p; ++q) {
            const double both = curvature[p][q] + curvature[q][p];  // one of them is 0
            curvature[p][q] = curvature[q][p] = both * (0.5 / blocks);
        }
    }
    for (std::size_t p = 0; p < few; ++p) {
        slope[p] -= 2.0 * priors[p] * off[p];
        curvature[p][p] += 2.0 * priors[p];
    }
    for (const auto& [p, sign] : {std::pair{std::size_t{0}, 1.0}, std::pair{noise, -1.0}}) {
        slope[p] -= sign * 2.0 * ratio_prior * ratio;
        curvature[p][0] += sign * 2.0 * ratio_prior;
        curvature[p][noise] -= sign * 2.0 * ratio_prior;
    }
    return value;
}

// Solves the equations of a positive definite matrix for those of the parameters that are free; the others get 0.
Parameters solve(Matrix a, Parameters b, const std::array<bool, most>& free, std::size_t count) {
    for (std::size_t k = 0; k < count; ++k) {
        if (!free[k]) continue;
        for (std::size_t i = k + 1; i < count; ++i) {
            if (!free[i]) continue;
            const double factor = a[i][k] / a[k][k];
            for (std::size_t j = k; j < count; ++j) a[i][j] -= factor * a[k][j];
            b[i] -= factor * b[k];
        }
    }
    Parameters x{};
    for (std::size_t k = count; k-- > 0;) {
        if (!free[k]) continue;
        for (std::size_t j = k + 1; j < count; ++j)
            if (free[j]) b[k] -= a[k][j] * x[j];
        x[k] = b[k] / a[k][k];
    }
    return x;
}

Place Fit::climb(Place now, std::size_t nth, int most_steps, Rooms rooms) const {
    Slopes of;
    now.value = evaluate(now, nth, rooms, &of);
    if (now.value == never) return now;
    double damping = 1e-2;
    for (int step = 0; step < most_steps; ++step) {
        std::array<bool, most> free{};
        for (std::size_t p = 0; p < now.count; ++p)
            free[p] = !((now.at[p] <= limits_.low[p] && of.slope[p] < 0.0) ||
                        (now.at[p] >= limits_.high[p] && of.slope[p] > 0.0));
        Place found = now;
        found.value = never;
        for (int attempt = 0; attempt < 6 && !(found.value > now.value); ++attempt) {
            if (attempt > 0) damping *= 6.0;
            Matrix damped = of.curvature;
            for (std::size_t p = 0; p < now.count; ++p) damped[p][p] += damping * (damped[p][p] + 0.01);
            const Parameters by = solve(damped, of.slope, free, now.count);
            found.at = now.at;
            for (std::size_t p = 0; p < now.count; ++p) found.at[p] += std::clamp(by[p], -2.0, 2.0);
            found.at = limits_.clipped(found.at);
            found.value = evaluate(found, nth, rooms);
        }
        if (!(found.value > now.value)) break;
        const double gain = found.value - now.value;
        now = found;
        damping = std::max(damping / 5.0, 1e-4);
        if (gain < enough && (blocks_ > 1 || damping < 1e-2)) break;
        evaluate(now, nth, rooms, &of);
    }
    return now;
}

// Calls job(place, rooms) for each place; the threads share the places.
template <class Job>
void Fit::each_place(std::span<Place> places, const Job& job) {
    for_each_part(static_cast<int>(rooms_.size()), std::ssize(places), [&](int worker, Index part) {
        job(places[static_cast<std::size_t>(part)], Rooms(rooms_).subspan(static_cast<std::size_t>(worker), 1));
    });
}

// Returns the place with this turn, and with the likeliest of these lengths along the hole, by every nth block.
Place Fit::at_turn(const Place& from, double turn, std::span<const double> along, std::size_t nth, Rooms rooms) const {
    Place best = from, each = from;
    best.value = never;
    best.turn = each.turn = turn;
    for (const double length : along) {
        each.at[long_along] = logarithm(length);
        each.value = evaluate(each, nth, rooms);
        if (each.value > best.value) best = each;
    }
    return best;
}

// Returns the likeliest parameters and turn near a place, by every nth block; the turn within twice the step. The
// nearer the turn is, the longer is the shape along the hole.
Place Fit::near_turn(const Place& start, double step, std::size_t nth, Rooms rooms) const {
    Place now = climb(start, nth, few_steps, rooms);
    for (; step > 0.05; step *= 0.5) {
        const double along = exponential(now.at[long_along]), lengths[] = {along, 2.0 * along};
        const Place less = at_turn(now, now.turn - step, lengths, nth, rooms),
                    more = at_turn(now, now.turn + step, lengths, nth, rooms);
        const Place& nearer = less.value > more.value ? less : more;
        if (nearer.value > now.value) now = nearer;
    }
    now.at = limits_.clipped(now.at);
    now.turn = rounded(now.turn);
    return now;
}

// Returns the highest peaks of the likelihood at turns between two, climbed.
std::vector<Place> Fit::peaks(const Place& from, Turns turns) {
    std::vector<Place> tried, found;
    for (double turn = turns.from; turn <= turns.to; turn += turns.step) {
        tried.push_back(from);
        tried.back().turn = turn;
    }
    each_place(tried, [&](Place& each, Rooms rooms) { each = at_turn(each, each.turn, turns.along, 2, rooms); });
    for (std::size_t i = 0; i < tried.size(); ++i)
        if ((i == 0 || tried[i - 1].value < tried[i].value) &&
            (i + 1 == tried.size() || tried[i + 1].value <= tried[i].value))
            found.push_back(tried[i]);
    std::ranges::sort(found, std::greater{}, &Place::value);
    found.resize(std::min(found.size(), most_peaks));
    const double highest = found.empty() ? never : found.front().value;
    std::erase_if(found, [&](const Place& each) { return each.value < highest - likely_enough; });
    each_place(found, [&](Place& each, Rooms rooms) { each = near_turn(each, turns.step / 2.0, 2, rooms); });
    return found;
}

// Returns the distance of rows of samples along the hole: the least of the medians of the blocks.
double Fit::row_spacing() const {
    double least = std::numeric_limits<double>::infinity();
    std::vector<double> gaps;
    for (std::size_t b = 0; b < blocks_; ++b) {
        gaps.clear();
        for (std::size_t i = b * size_ + 1; i < b * size_ + n_; ++i)
            if (along_[i] > along_[i - 1]) gaps.push_back(along_[i] - along_[i - 1]);
        if (gaps.empty()) continue;
        const auto middle = gaps.begin() + static_cast<std::ptrdiff_t>(gaps.size() / 2);
        std::ranges::nth_element(gaps, middle);
        least = std::min(least, *middle);
    }
    return least;
}

// Returns the peaks of two ranges of turns together.
std::vector<Place> Fit::peaks(const Place& one, Turns turns, const Place& other, Turns others) {
    std::vector<Place> found = peaks(one, turns);
    for (const Place& each : peaks(other, others)) found.push_back(each);
    return found;
}

// Returns a wide shape, from which a turn is sought.
Place Fit::widened(Place from) const {
    if (from.at[0] > from.at[long_along - 2]) {  // what is called short is the shape
        std::swap_ranges(from.at.begin(), from.at.begin() + 3, from.at.begin() + 3);
        from.at = limits_.clipped(from.at);
    }
    from.at[long_along - 1] = logarithm(2.0 * radius_);
    from.at[noise] = std::max(from.at[noise], from.at[long_along - 2] + logarithm(0.02));
    return from;
}

// Returns the likeliest shape that turns; the one found, if the samples do not show that it turns, and whereto.
// `others` become the places with turns that are about as likely.
Place Fit::with_turn(const Place& found, double least_turn, std::vector<Place>& others) {
    const Place wide = widened(found);
    std::vector<Place> likely = peaks(found, slowly, wide, slowly);
    if (likely.empty()) return found;
    Place best = *std::ranges::max_element(likely, {}, &Place::value);
    // Rows of arms cannot tell an oval that turns by half a turn from one row to the next from one that does not turn.
    const double fastest = std::min(fast, 90.0 / row_spacing());
    const std::vector<Place> spirals =
        peaks(wide, {-fastest, -slow, fast_step, fast_along}, wide, {slow, fastest, fast_step, fast_along});
    const double gain = blocks_ > 1 ? small_gain : great_gain;
    const auto spiral = std::ranges::max_element(spirals, {}, &Place::value);
    if (spiral != spirals.end() && spiral->value > best.value + gain) {
        best = *spiral;
        likely.insert(likely.end(), spirals.begin(), spirals.end());
    }
    bool turns = std::abs(best.turn) >= least_turn && std::ranges::none_of(likely, [&](const Place& each) {
                     return std::abs(each.turn - best.turn) >= other_turn && each.value > best.value - gain;
                 });
    Place turned = best;
    if (turns) {
        turned.turn = near_turn(near_turn(best, 0.5, 1, rooms_), 0.2, 1, rooms_).turn;
        turned = climb(turned, 1, steps, rooms_);
        turns = turned.value > found.value + gain;
    }
    if (!turns) {
        const double least = std::max(evaluate(found, 2, rooms_), best.value) - gain;
        std::erase_if(likely, [&](const Place& each) { return each.value <= least; });
        if (std::ranges::any_of(likely, [](const Place& each) { return std::abs(each.turn) >= other_turn; }))
            others = std::move(likely);
        return found;
    }
    Place straight = turned;
    straight.turn = 0.0;
    straight = climb(straight, 1, steps, rooms_);  // the starts of `found` may have missed it
    if (turned.value <= straight.value + gain) return straight.value > found.value ? straight : found;
    const Place again = climb(likeliest_start(turned), 1, steps, rooms_);
    return again.value > turned.value ? again : turned;
}

// Returns whether samples of the same shape lie opposite each other. Those of an odd number of arms do not: five arms
// see three bulges around the hole as two. They do if the arms turn past the shape within its length along the hole.
bool Fit::sees_opposite(const Place& of) const {
    const double along = exponential(std::max(of.at[2], of.at[long_along]));
    const double reach = std::clamp(along, least_alike, farthest_alike);
    std::array<double, odd_arms> sums{};  // of cos(arms x angle): 1 arm, 3, ...
    double pairs = 0.0;
    std::vector<SineCosine> at(n_);
    for (std::size_t b = 0; b < blocks_; ++b) {
        const std::size_t first = b * size_;
        for (std::size_t i = 0; i < n_; ++i) {
            const double turned = toolface_[first + i] - of.turn * (along_[first + i] - along_[first]);
            at[i] = sine_cosine_of_radians(wrap_toolface(turned) * (std::numbers::pi / 180.0));
        }
        for (std::size_t i = 0; i < n_; ++i)
            for (std::size_t j = i + 1; j < n_ && std::abs(along_[first + j] - along_[first + i]) <= reach; ++j) {
                const double one = at[i].cosine * at[j].cosine + at[i].sine * at[j].sine, two = 2.0 * one * one - 1.0;
                double before = one, now = one;
                for (double& sum : sums) {
                    sum += now;
                    before = std::exchange(now, 2.0 * two * now - before);
                }
                pairs += 1.0;
            }
    }
    return *std::ranges::max_element(sums) <= same_arms * pairs;
}

// Returns the likeliest place with a long term that repeats after half a turn, which is tried by a quarter of the
// blocks; the one found, if it gains too little or no sample shows what lies opposite another.
Place Fit::with_half_turns(const Place& found) {
    if (!sees_opposite(found)) return found;
    const double gain = blocks_ > 1 ? small_half_gain : great_half_gain;
    Place tried[] = {found, found};
    tried[1].at = limits_.from(half_start);
    for (Place& each : tried) {
        each.half_turns = true;
        each = climb(each, 4, few_steps, rooms_);
    }
    Place half = tried[1].value > tried[0].value ? tried[1] : tried[0];
    if (half.value <= evaluate(found, 4, rooms_) + gain) return found;
    half = climb(half, 1, steps, rooms_);
    return half.value > found.value + gain ? half : found;
}

// Returns the likeliest place with a smooth short term; the one found, if that is likelier.
Place Fit::with_smooth(const Place& found) {
    Place smooth = found;
    smooth.smooth = true;
    smooth = climb(smooth, 1, steps, rooms_);
    return smooth.value > found.value ? smooth : found;
}

// Returns the likeliest place with a fine term; the one found, if none of the starts is about as likely.
Place Fit::with_fine(const Place& found) {
    Place start = found;
    start.value = never;
    for (const double share : fine_shares)
        for (const double around : fine_around) {
            Place each = found;
            each.count = most;
            each.at[noise] += logarithm(1.0 - share);
            each.at[few] = found.at[noise] + logarithm(share);
            each.at[few + 1] = logarithm(around);
            each.at[few + 2] = logarithm(2.5 * around);
            each.at = limits_.clipped(each.at);
            each.value = evaluate(each, 3, rooms_);
            if (each.value > start.value) start = each;
        }
    if (start.count == few || start.value < evaluate(found, 3, rooms_) - 0.5) return found;
    return climb(start, 1, 40, rooms_);
}

// Returns the place found and others with their shares of the probability, the likeliest first. Of the others, those
// that repeat after half a turn are sought here.
std::vector<Place> Fit::shared(const Place& first, std::vector<Place> others) {
    std::vector<Place> found{first};
    found[0].value = evaluate(first, 2, rooms_);
    Place half = first;
    half.half_turns = true;
    Place other = half;
    other.at = limits_.from(half_start);
    for (const Place& each : peaks(widened(half), slowly, other, slowly)) others.push_back(each);
    std::ranges::stable_sort(others, std::greater{}, &Place::value);
    for (const Place& each : others) {
        const auto near = std::ranges::find_if(found, [&](const Place& of) {
            return each.half_turns == of.half_turns && std::abs(each.turn - of.turn) < other_turn;
        });
        if (near == found.end())
            found.push_back(each);
        else
            near->value = std::max(near->value, each.value);
    }
    const double greatest = std::ranges::max_element(found, {}, &Place::value)->value;
    const double nats = blocks_ > 1 ? evidence : 1.0;
    double sum = 0.0;
    for (Place& each : found)
        sum += each.share = exponential(nats * (each.value - greatest) - std::abs(each.turn) / usual_turn);
    std::erase_if(found, [&](const Place& each) { return each.share < smallest_share * sum; });
    std::ranges::stable_sort(found, std::greater{}, &Place::share);
    sum = 0.0;
    for (const Place& each : found) sum += each.share;
    for (Place& each : found) each.share /= sum;
    found[0] = climb(found[0], 1, steps, rooms_);
    return found;
}

// Returns the likeliest of what is climbed to from the starts, by half of the blocks, with the turn and the kind of a
// place.
Place Fit::likeliest_start(const Place& kind) {
    std::vector<Place> found;
    for (const auto& values : starts) {
        found.push_back(kind);
        found.back().at = limits_.from(values);
    }
    each_place(found, [&](Place& each, Rooms rooms) { each = climb(each, 2, few_steps, rooms); });
    return *std::ranges::max_element(found, {}, &Place::value);
}

// Sets the limits of the parameters. What is shorter than the samples are apart is noise: as a term, the wall would
// follow it.
void Fit::limit(double spacing) {
    const double r = radius_;
    limits_ = {{1e-12, 0.004, 0.004, 1e-12, 0.35 * r, std::clamp(least_share * spacing, 0.02, 10.0), least_noise_,
                1e-12, std::clamp(spacing, 0.003, 0.04), std::clamp(spacing, 0.006, 0.2)},
               {1e-2, 40.0 * r, 60.0, 1e-2, 2.5 * r, 200.0, 1e-2, 1e-3, 0.04, 0.2}};
    for (std::size_t p = 0; p < most; ++p) {
        limits_.low[p] = logarithm(limits_.low[p]);
        limits_.high[p] = logarithm(limits_.high[p]);
    }
}

std::vector<Place> Fit::likely(double least_turn) {
    const Place unturned = climb(likeliest_start({limits_.high, few}), 1, steps, rooms_);
    if (least_turn == std::numeric_limits<double>::infinity()) return {unturned};
    std::vector<Place> others;
    std::vector<Place> found{with_half_turns(with_turn(unturned, least_turn, others))};
    if (!others.empty()) found = shared(found[0], others);
    found[0] = with_smooth(found[0]);
    Place& best = found[0];
    const Place three = with_fine(best);
    if (three.value > best.value + fine_gain) best = three;
    return found;
}

// Returns a covariance as Settings have it.
std::vector<double> values_of(const Place& of, double radius) {
    std::vector<double> values{rounded(radius), rounded(exponential(of.at[noise]))};
    for (std::size_t p = 0; p < of.count; ++p)
        if (p != noise)
            values.push_back(((p == 1 && of.smooth) || (p == long_along - 1 && of.half_turns) ? -1.0 : 1.0) *
                             rounded(exponential(of.at[p])));
    if (of.turn != 0.0) values.push_back(of.turn);
    return values;
}

Place Fit::place_of(std::span<const double> covariance) const {
    Place of{limits_.high, covariance.size() > 9 ? most : few};
    of.turn = covariance.size() % 3 == 0 ? covariance.back() : 0.0;
    of.smooth = covariance[3] < 0.0;
    of.half_turns = covariance[6] < 0.0;
    of.at[noise] = logarithm(covariance[1]);
    for (std::size_t p = 0; p < of.count - 1; ++p) {
        const bool around = p % 3 == 1;
        const double value = std::abs(covariance[2 + p]);
        of.at[p < noise ? p : p + 1] = logarithm(around ? value * radius_ / covariance[0] : value);
    }
    return of;
}

std::vector<double> Fit::near(std::span<const double> covariance) {
    Place from = place_of(covariance);
    from.at = limits_.clipped(from.at);
    Place found = climb(from, 1, steps, rooms_);
    if (from.count == most) {
        Place two = from;
        two.count = few;
        two.at[noise] = logarithm(exponential(from.at[noise]) + exponential(from.at[few]));
        two = climb(two, 1, steps, rooms_);
        if (found.value <= two.value + fine_gain) found = two;
    }
    return values_of(found, radius_);
}

double Fit::likelihood(std::span<const double> covariance) {
    return evaluate(place_of(covariance), 1, rooms_);
}

void require_block_size(Index block_size) {
    require(block_size > 1 && block_size <= 1000, "block_size", block_size, "must lie in 2 to 1000");
}

// Samples of parts of a hole: the same number of blocks of each.
struct Parts {
    Parts(const SampleColumns& samples, Index block_size, Index blocks,
          const std::vector<std::vector<double>>& covariances, int threads)
        : columns{copied(samples.depth), copied(samples.toolface), copied(samples.radius)} {
        require_block_size(block_size);
        require(blocks > 0, "blocks", blocks, "must be above 0");
        require_threads(threads);
        all().validate(1);
        const Index samples_in_all = std::ssize(columns[0]);
        of_part = static_cast<std::size_t>(block_size * blocks);
        count = samples_in_all / (block_size * blocks);
        require(count > 0 && samples_in_all % (block_size * blocks) == 0, "samples", samples_in_all,
                "must be whole parts");
        for (const std::vector<double>& each : covariances)
            require(each.size() >= 8 && each.size() <= 12 && each.size() != 10 && each[0] > 0.0, "covariances",
                    Index{std::ssize(each)}, "must have two or three terms, and a radius above 0");
    }
    SampleColumns all() const { return {columns[0], columns[1], columns[2]}; }
    // Calls job(part, samples) for each part; the threads share the parts.
    template <class Job>
    void each(int threads, const Job& job) const {
        for_each_part(threads, count, [&](int, Index number) {
            const auto part = static_cast<std::size_t>(number);
            const auto cut = [&](std::span<const double> column) { return column.subspan(part * of_part, of_part); };
            job(part, SampleColumns{cut(columns[0]), cut(columns[1]), cut(columns[2])});
        });
    }

    std::vector<double> columns[3];
    std::size_t of_part = 0;
    Index count = 0;
};

}  // namespace

std::vector<LikelyCovariance> fit_covariance(const SampleColumns& samples, Index block_size, double radius,
                                             double spacing, double least_turn, int threads,
                                             InstructionSet instruction_set) {
    const StandardArithmetic standard;
    require_block_size(block_size);
    require(radius > 0.0 && radius <= 1e3, "radius", radius, "must be above 0, at most 1000 m");
    require(spacing >= 0.0 && spacing <= 1e3, "spacing", spacing, "must lie in 0 to 1000 m");
    require_threads(threads);
    require(least_turn >= 0.0, "least_turn", least_turn, "must be 0 or above");
    const std::vector<double> columns[] = {copied(samples.depth), copied(samples.toolface), copied(samples.radius)};
    const SampleColumns from{columns[0], columns[1], columns[2]};
    from.validate(1);
    const auto count = static_cast<Index>(from.depth.size());
    require(count > 0 && count % block_size == 0, "samples", count, "must be whole blocks");
    Fit fit(from, static_cast<std::size_t>(block_size), radius, threads, instruction_set);
    fit.limit(spacing);
    std::vector<LikelyCovariance> found;
    for (const Place& of : fit.likely(least_turn)) found.push_back({values_of(of, radius), of.share});
    return found;
}

std::vector<std::vector<double>> covariances_near(const SampleColumns& samples, Index block_size, Index blocks,
                                                  const std::vector<std::vector<double>>& starts, double spacing,
                                                  int threads, InstructionSet instruction_set) {
    Parts parts(samples, block_size, blocks, starts, threads);
    require(spacing >= 0.0 && spacing <= 1e3, "spacing", spacing, "must lie in 0 to 1000 m");
    require(std::ssize(starts) == parts.count, "starts", Index{std::ssize(starts)}, "must be one for each part");
    std::vector<std::vector<double>> found(starts.size());
    parts.each(threads, [&](std::size_t part, const SampleColumns& own) {
        Fit fit(own, static_cast<std::size_t>(block_size), starts[part][0], 1, instruction_set);
        fit.limit(spacing);
        found[part] = fit.near(starts[part]);
    });
    return found;
}

std::vector<double> covariance_likelihoods(const SampleColumns& samples, Index block_size, Index blocks,
                                           const std::vector<std::vector<double>>& candidates, int threads,
                                           InstructionSet instruction_set) {
    Parts parts(samples, block_size, blocks, candidates, threads);
    std::vector<double> found(static_cast<std::size_t>(parts.count) * candidates.size());
    parts.each(threads, [&](std::size_t part, const SampleColumns& own) {
        Fit fit(own, static_cast<std::size_t>(block_size), candidates[0][0], 1, instruction_set);
        for (std::size_t c = 0; c < candidates.size(); ++c)
            found[part * candidates.size() + c] = fit.likelihood(candidates[c]);
    });
    return found;
}

}  // namespace helibore
