// The fit of a covariance: instruction sets, the parameters of known holes, and what is refused.
#include <algorithm>
#include <cmath>
#include <limits>
#include <random>

#include "check.hpp"
#include "helibore/covariance.hpp"
#include "helibore/error.hpp"

namespace {

using namespace helibore;

// `count` blocks of `size` samples of an oval hole, 1 m each; `fine`: with a roughness of a few millimetres' length.
struct Blocks {
    std::vector<double> depth, toolface, radius;
    Blocks(std::size_t count, std::size_t size, double noise, double fine = 0.0) {
        std::mt19937 random(7);
        const auto uniform = [&] { return static_cast<double>(random()) / 0x1p32; };
        for (std::size_t i = 0; i < count * size; ++i) {
            depth.push_back(static_cast<double>(i / size) + static_cast<double>(i % size) / static_cast<double>(size));
            toolface.push_back(360.0 * uniform());
            const double angle = toolface.back() * 0.017453292519943295;
            radius.push_back(0.11 + 3e-3 * std::cos(2.0 * angle - depth.back()) +
                             fine * std::sin(500.0 * depth.back()) * std::sin(20.0 * angle) +
                             noise * (uniform() + uniform() + uniform() - 1.5) * 2.0);
        }
    }
    SampleColumns columns() const { return {depth, toolface, radius}; }
};

void every_instruction_set_and_number_of_threads_finds_the_same() {
    for (const std::size_t size : {20U, 64U, 75U}) {
        const Blocks blocks(size == 75 ? 1 : 3, size, 3e-4);
        const auto fitted = [&](InstructionSet level) {
            return fit_covariance(blocks.columns(), static_cast<Index>(size), 0.11, 0.0, 0.0, 1, level)[0].values;
        };
        const std::vector<double> plain = fitted(InstructionSet::plain);
        CHECK(plain.size() >= 8 && plain.size() <= 12);
        CHECK(fitted(InstructionSet::automatic) == plain);
        CHECK(fit_covariance(blocks.columns(), static_cast<Index>(size), 0.11, 0.0, 0.0, 3)[0].values == plain);
        for (const InstructionSet level : {InstructionSet::avx2, InstructionSet::avx512}) try {
                CHECK(fitted(level) == plain);
            } catch (const InputError&) {  // this processor does not have it
            }
    }
}

void finds_the_noise() {
    for (const double noise : {1e-4, 3e-4, 1e-3}) {
        const Blocks blocks(4, 60, noise);
        const std::vector<double> found = fit_covariance(blocks.columns(), 60, 0.11, 0.0, 0.0)[0].values;
        CHECK(found[0] == 0.11);
        CHECK(std::abs(std::sqrt(found[1]) / noise - 1.0) < 0.3);
    }
    Blocks quantised(4, 60, 1e-4);
    constexpr double step = 2e-3;
    for (double& radius : quantised.radius) radius = std::round(radius / step) * step;
    CHECK(fit_covariance(quantised.columns(), 60, 0.11, 0.0, 0.0)[0].values[1] >= 0.9999 * step * step / 48.0);
}

void extremes() {
    Blocks equal(2, 20, 0.0), far(2, 20, 1e-3), rough(2, 120, 1e-6, 1e-3);
    std::ranges::fill(equal.toolface, 360.0);
    std::ranges::fill(equal.depth, 5.0);
    for (std::size_t i = 0; i < far.depth.size(); ++i) far.depth[i] = 1e7 * std::cos(static_cast<double>(i));
    for (const Blocks* blocks : {&equal, &far, &rough}) {
        const auto size = static_cast<Index>(blocks->depth.size() / 2);
        const auto likely = fit_covariance(blocks->columns(), size, 0.11, 0.0, 0.0);
        std::vector<double> values = likely[0].values;
        for (const std::size_t around : {3U, 6U}) values[around] = std::abs(values[around]);  // below 0: of other kinds
        if (values.size() % 3 == 0) values.pop_back();                                        // the turn
        for (const double value : values) CHECK(std::isfinite(value) && value > 0.0);
        double shares = 0.0;
        for (const LikelyCovariance& of : likely) shares += of.share;
        CHECK(std::abs(shares - 1.0) < 1e-12);
    }
}

void refused() {
    const Blocks blocks(3, 20, 1e-4);
    const auto fitted = [&](Index size, double radius, double spacing = 0.0, double least_turn = 0.0) {
        return fit_covariance(blocks.columns(), size, radius, spacing, least_turn);
    };
    CHECK_THROWS(InputError, "block_size = 1: must lie in 2 to 1000", fitted(1, 0.11));
    CHECK_THROWS(InputError, "samples = 60: must be whole blocks", fitted(7, 0.11));
    CHECK_THROWS(InputError, "radius = 0: must be above 0, at most 1000 m", fitted(20, 0.0));
    CHECK_THROWS(InputError, "spacing = -1: must lie in 0 to 1000 m", fitted(20, 0.11, -1.0));
    CHECK_THROWS(InputError, "least_turn = -1: must be 0 or above", fitted(20, 0.11, 0.0, -1.0));
    Blocks torn = blocks;
    torn.radius[17] = std::numeric_limits<double>::quiet_NaN();
    CHECK_THROWS(InputError, "radius[17] = nan: must be finite", fit_covariance(torn.columns(), 20, 0.11, 0.0, 0.0));
}

}  // namespace

int main() {
    every_instruction_set_and_number_of_threads_finds_the_same();
    finds_the_noise();
    extremes();
    refused();
    return failures();
}
