// Estimates at points: those at vertices are the wall's, a sample left out does not count, and kriging by several
// nuggets.
#include "helibore/estimates.hpp"

#include <cmath>
#include <cstdint>
#include <cstring>
#include <limits>

#include "check.hpp"
#include "helibore/error.hpp"
#include "hole.hpp"
#include "host.hpp"

using namespace helibore;

namespace {

constexpr double nan = std::numeric_limits<double>::quiet_NaN();

struct Points {
    std::vector<double> depth, toolface, trial, box_depth, box_turn;
    operator PointColumns() const { return {depth, toolface, trial, box_depth, box_turn}; }
};

SampleColumns columns_of(const std::vector<std::vector<double>>& samples) {
    return {samples[0], samples[1], samples[2]};
}

bool near(double a, double b, double within = 1e-9) {
    return std::abs(a - b) <= within || (std::isnan(a) && std::isnan(b));
}

// At the vertices, without a box. Kriging too; `nuggets` searches once and gives what each alone gives.
void at_vertices() {
    const Hole hole = oval_hole(700, 100.0, 4.0);
    for (const Estimator estimator : {Estimator::inverse_distance, Estimator::kriging}) {
        Settings settings{.bit_diameter = 0.216, .sectors = 16, .pitch = 0.2, .neighbors = 6, .max_distance = 0.08};
        settings.max_iterations = 1;  // from the same trial radius
        settings.estimator = estimator;
        settings.kriging_range = estimator == Estimator::kriging ? 0.5 : 0.0;
        Wall wall(settings);
        wall.append(hole.all());
        const VertexColumns v = wall.vertices();
        const std::size_t n = v.radius.size();
        const Points points{v.depth, v.toolface, std::vector<double>(n, 0.108), std::vector<double>(n, -1.0),
                            std::vector<double>(n, -1.0)};
        const std::vector<double> nuggets = {0.1, 0.5};
        const auto samples = wall.samples();
        const PointEstimates found = estimate_at(columns_of(samples), points, settings, nuggets);
        std::size_t empty = 0;
        for (std::size_t k = 0; k < n; ++k) {
            empty += v.support[k] == 0;
            CHECK(near(found.radius[k], v.radius[k], 1e-12));
            CHECK((v.support[k] == 0) == std::isnan(found.nearest[k]));
        }
        CHECK(empty > 0 && empty < n);
        settings.threads = 3;
        const PointEstimates shared = estimate_at(columns_of(samples), points, settings, nuggets);
        for (std::size_t k = 0; k < n; ++k)
            CHECK(near(shared.radius[k], found.radius[k], 0.0) && near(shared.scatter[k], found.scatter[k], 0.0));
        if (estimator == Estimator::inverse_distance) continue;
        settings.nugget = 0.5;
        const PointEstimates other = estimate_at(columns_of(samples), points, settings);
        for (std::size_t k = 0; k < n; ++k) {
            CHECK(near(found.by_nugget[0][k], found.radius[k], 0.0));
            CHECK(near(found.by_nugget[1][k], other.radius[k], 0.0));
            CHECK(std::isnan(found.radius[k]) || (found.square_weights[k] > 0.1 && found.square_weights[k] < 2.0));
        }
    }
}

// Three samples in a line down the hole, by hand: weights 1/d.
void by_hand() {
    const std::vector<double> depth = {10.0, 10.1, 10.3}, toolface(3, 90.0), radius = {0.1, 0.12, 0.16};
    const SampleColumns samples{depth, toolface, radius};
    const Settings settings{.bit_diameter = 0.2, .neighbors = 2};
    const Points points{{10.1, 10.1, 10.1, 50.0},
                        {90.0, 90.0, 90.0, 0.0},
                        {0.1, 0.1, nan, 0.1},
                        {0.0, -1.0, 0.0, 0.0},
                        std::vector<double>(4, 0.0)};
    const PointEstimates found = estimate_at(samples, points, settings);
    CHECK(near(found.radius[0], (2.0 * 0.1 + 0.16) / 3.0));  // 0.1 and 0.2 m away, itself left out
    CHECK(near(found.nearest[0], 0.1) && near(found.farthest[0], 0.2) && near(found.square_weights[0], 5.0 / 9.0));
    CHECK(near(found.scatter[0], (std::pow(0.1 - 0.12, 2) + std::pow(0.16 - 0.12, 2)) / 2.0));
    CHECK(near(found.along[0], (0.1 * 0.1 + 0.2 * 0.2) / 2.0) && found.across[0] == 0.0);
    CHECK(found.radius[1] == 0.12 && found.nearest[1] == 0.0 && found.square_weights[1] == 1.0);
    for (const std::size_t none : {2u, 3u})
        CHECK(std::isnan(found.radius[none]) && std::isnan(found.nearest[none]) && std::isnan(found.scatter[none]));
}

// Toolfaces may be any finite angle, of points and of samples.
void any_toolface() {
    const std::vector<double> depth(3, 10.0), toolface = {5.0, 180.0, 300.0}, radius = {0.1, 0.12, 0.14};
    std::vector<double> turned;
    for (const double angle : toolface) turned.push_back(angle - 720.0);
    const Settings settings{.bit_diameter = 0.2, .max_iterations = 1};
    const auto found = [&](double at, const std::vector<double>& of_samples) {
        return estimate_at({depth, of_samples, radius}, Points{{10.0}, {at}, {0.1}, {0.0}, {0.0}}, settings);
    };
    for (const double at : {5.0, 77.0, 350.0})
        for (const double turns : {-1080.0, -360.0, 360.0, 720.0})
            for (const std::vector<double>& of_samples : {toolface, turned}) {
                const PointEstimates same = found(at, toolface), other = found(at + turns, of_samples);
                CHECK(near(other.radius[0], same.radius[0]) && near(other.nearest[0], same.nearest[0]));
            }
    // The sample at 5 degrees is left out; the next lies 65 degrees away.
    CHECK(near(found(365.0, toolface).nearest[0], 65.0 * 0.1 * std::acos(-1.0) / 180.0));
}

// A sample exactly max_distance away is used or not; it never leaves an estimate without meaning.
void at_the_greatest_distance() {
    const std::vector<double> depth = {10.0}, radius = {0.1};
    const double trial = 0.108;
    for (int i = 1; i < 2000; ++i) {
        const std::vector<double> toolface = {0.09 * i};
        const double away = trial * std::acos(-1.0) / 180.0 * toolface[0];
        for (const double limit : {std::nextafter(away, 0.0), away, std::nextafter(away, 1.0)}) {
            const Settings settings{.bit_diameter = 0.2, .max_distance = limit, .max_iterations = 1};
            const PointEstimates found =
                estimate_at({depth, toolface, radius}, Points{{10.0}, {0.0}, {trial}, {-1.0}, {-1.0}}, settings);
            CHECK(std::isnan(found.nearest[0]) ? std::isnan(found.radius[0]) : found.radius[0] == 0.1);
        }
    }
}

void refusals() {
    const std::vector<double> two = {1.0, 2.0}, good_radius = {0.1, 0.1}, falling = {2.0, 1.0}, gap = {1.0, nan};
    const std::vector<double> nuggets = {0.1, 0.0};
    const std::span<const double> one = std::span(two).first(1);
    const SampleColumns samples{two, two, good_radius};
    const Settings settings{.bit_diameter = 0.2, .estimator = Estimator::kriging, .kriging_range = 0.5};
    const Points points{{1.0}, {0.0}, {0.1}, {0.0}, {0.0}};
    Points uneven = points, deep = points, turned = points;
    uneven.trial.pop_back();
    deep.depth[0] = nan;
    turned.toolface[0] = -nan;
    CHECK_THROWS(InputError, "points: columns must have equal lengths", estimate_at(samples, uneven, settings));
    CHECK_THROWS(InputError, "points.depth[0] = nan: must be finite", estimate_at(samples, deep, settings));
    CHECK_THROWS(InputError, "points.toolface[0] = nan: must be finite", estimate_at(samples, turned, settings));
    CHECK_THROWS(InputError, "bit_diameter = 0: must be finite and above 0", estimate_at(samples, points, {}));
    CHECK_THROWS(InputError, "nuggets[1] = 0: must be finite and at least 1e-6",
                 estimate_at(samples, points, settings, nuggets));
    const auto of = [&](const SampleColumns& columns) { return estimate_at(columns, points, settings); };
    CHECK_THROWS(InputError, "toolface has 1 values, depth has 2: must be equal", of({two, one, good_radius}));
    CHECK_THROWS(InputError, "radius has 1 values, depth has 2: must be equal", of({two, two, one}));
    CHECK_THROWS(InputError, "toolface[1] = nan: must be finite", of({two, gap, good_radius}));
    CHECK_THROWS(InputError, "depth[1] = 1: must not be less than depth[0] = 2", of({falling, two, good_radius}));
}

// What a wall keeps with its vertices is what estimates at these points from the same trial radii give; on every
// instruction set and in any split of the samples, to the last bit.
void kept_sums() {
    const Hole hole = oval_hole(700, 100.0, 4.0);
    for (const Estimator estimator : {Estimator::inverse_distance, Estimator::kriging}) {
        Settings settings{.bit_diameter = 0.216, .sectors = 16, .pitch = 0.2, .neighbors = 6, .max_distance = 0.08};
        settings.max_iterations = 1;
        settings.angular_scale = 2.0;
        settings.estimator = estimator;
        settings.kriging_range = estimator == Estimator::kriging ? 0.5 : 0.0;
        settings.start_depth = 100.0;
        settings.sigma = true;
        Wall wall(settings);
        wall.append(hole.all());
        const VertexColumns v = wall.vertices();
        const std::size_t n = v.radius.size();
        const std::vector<double> none(n, -1.0);
        const Points points{v.depth, v.toolface, std::vector<double>(n, 0.108), none, none};
        const auto samples = wall.samples();
        const PointEstimates found = estimate_at(columns_of(samples), points, settings);
        const auto sums = wall.sums();
        std::vector<std::vector<double>> mine(4, std::vector<double>(sums[0].size(), 7.0));
        const std::vector<std::span<double>> into(mine.begin(), mine.end());
        CHECK(!wall.read_sums(std::span(into).first(3)) && mine[0][0] == 7.0);
        CHECK(wall.read_sums(into));
        for (std::size_t i = 0; i < into.size(); ++i)
            CHECK(std::memcmp(mine[i].data(), sums[i].data(), n * sizeof(double)) == 0);
        for (std::size_t k = 0; k < n; ++k) {
            if (v.support[k] == 0) continue;
            const double kept[] = {sums[0][k], sums[1][k], sums[2][k], sums[3][k]};
            const double again[] = {found.square_weights[k], found.scatter[k], found.along[k], found.across[k]};
            for (int i = 0; i < 4; ++i) CHECK(near(kept[i], again[i], 1e-12));
        }
        for (const InstructionSet set : {InstructionSet::plain, InstructionSet::avx2, InstructionSet::avx512}) {
            Settings other = settings;
            other.instruction_set = set;
            other.threads = 3;
            try {
                Wall split(other);
                const std::size_t third = hole.depth.size() / 3;
                split.append(hole.rows(2 * third, hole.depth.size() - 2 * third));
                split.append(hole.rows(0, third));
                split.append(hole.rows(third, third));
                const auto same = split.sums();
                for (std::size_t k = 0; k < n; ++k)
                    for (std::size_t i = 0; i < 4; ++i) CHECK(v.support[k] == 0 || near(same[i][k], sums[i][k], 0.0));
            } catch (const helibore::InputError& error) {  // not this processor
                CHECK(error.place == "instruction_set");
            }
        }
    }
}

// sigma^2 = noise W + between S^a (A + stretch C)^b, for lengths that do and do not fill the last pack.
void sigma_by_hand() {
    for (const std::size_t n : {1u, 8u, 13u}) {
        std::vector<double> columns[4];
        for (std::size_t i = 0; i < n; ++i) {
            const auto x = static_cast<double>(i + 1);
            const double values[] = {0.3 / x, 1e-7 * x * x, i % 5 == 4 ? 0.05 : 1e-4 * x, 3e-5 / x};
            for (int c = 0; c < 4; ++c) columns[c].push_back(i % 7 == 6 ? nan : values[c]);
        }
        const SigmaRule rule{2e-7, 5e-5, 0.7, 1.3, 16.0, 0.2};
        const auto found = sigma_of({columns[0], columns[1], columns[2], columns[3]}, rule);
        CHECK(found.size() == n);
        for (std::size_t i = 0; i < n; ++i) {
            const double between = std::pow(columns[1][i], 0.7) * std::pow(columns[2][i] + 16.0 * columns[3][i], 1.3);
            const double sigma = std::sqrt(2e-7 * columns[0][i] + 5e-5 * between);
            CHECK(i % 5 == 4 || i % 7 == 6 ? std::isnan(found[i]) : near(found[i] / sigma, 1.0, 1e-13));
        }
        columns[3].push_back(0.0);
        CHECK_THROWS(InputError, "sums: columns must have equal lengths",
                     sigma_of({columns[0], columns[1], columns[2], columns[3]}, rule));
    }
    Wall plain({.bit_diameter = 0.2});
    CHECK_THROWS(InputError, "sigma: must be set for the sums of the vertices", plain.sums());
}

// Noise of a round hole is found as noise, and what the samples cannot show is none.
void calibrates_the_noise_of_samples() {
    constexpr double tau = 1e-3;
    constexpr std::size_t size = 3000 / reduced;
    std::vector<double> depth, toolface, radius, box;
    std::vector<Index> rows;
    std::uint64_t state = 1;
    const auto draw = [&] {
        state = state * 6364136223846793005U + 1442695040888963407U;
        return static_cast<double>(state >> 11) * 0x1p-53;
    };
    for (std::size_t i = 0; i < size; ++i) {
        double sum = 0.0;
        for (int k = 0; k < 12; ++k) sum += draw();  // near enough to normal
        depth.push_back(100.0 + 0.003 * static_cast<double>(i)), toolface.push_back(360.0 * draw());
        radius.push_back(0.1 + tau * (sum - 6.0));
        if (i % 3 == 1) rows.push_back(std::ssize(depth) - 1), box.push_back(0.0);
    }
    const SampleColumns samples{depth, toolface, radius};
    const auto found = calibrate(samples, {rows, box, box}, {.bit_diameter = 0.2});
    CHECK(found && found->noise > 0.5 * tau && found->noise < 1.1 * tau);  // the rest counts as shape
    CHECK(found && found->quantile > 1.8 && found->quantile < 2.6);
    CHECK(found && found->reach > 0.0 && found->reach < 0.15);
    const std::vector<double> all(rows.size(), 1e4);  // boxes around everything
    CHECK(!calibrate(samples, {rows, all, all}, {.bit_diameter = 0.2}));
    CHECK_THROWS(InputError, "rows = -1: must be one of the samples",
                 calibrate(samples, {std::vector<Index>{-1}, {box.data(), 1}, {box.data(), 1}}, {.bit_diameter = 0.2}));
}

}  // namespace

int main() {
    calibrates_the_noise_of_samples();
    at_vertices();
    kept_sums();
    sigma_by_hand();
    by_hand();
    any_toolface();
    at_the_greatest_distance();
    in_every_host_state(refusals);
    return failures();
}
