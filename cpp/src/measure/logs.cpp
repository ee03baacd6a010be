// Turns are measured in blocks of fixed size, so the result does not depend on threads.
#include "helibore/logs.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>

#include "base/arithmetic.hpp"
#include "base/degrees.hpp"
#include "base/extremes.hpp"
#include "base/host_memory.hpp"
#include "base/messages.hpp"
#include "base/threads.hpp"
#include "measure/circles.hpp"
#include "search/kernel/instruction_set.hpp"

namespace helibore {
namespace {

constexpr Index block = 256;                                   // turns
constexpr double least_radius = 1e-50, largest_radius = 1e50;  // metres; products of five radii stay finite and not 0
constexpr double missing = std::numeric_limits<double>::quiet_NaN();

// A toolface between two vertices of a turn.
struct Between {
    std::size_t vertex;
    double share;  // of the way to the next vertex
};

// Values that are the same for all turns.
struct Round {
    std::size_t sectors;
    double start_toolface;
    std::vector<Point> directions;  // cosine and sine of each vertex's toolface
    std::array<Between, 4> quarters;
};

Between place_of(double toolface, const Turns& turns) {
    const double turned = (toolface - turns.start_toolface) / 360.0;
    const double at = (turned - std::floor(turned)) * turns.sectors;
    const double vertex = std::floor(at);
    if (vertex >= turns.sectors) return {0, 0.0};  // a tiny negative share, rounded up to a whole turn
    return {static_cast<std::size_t>(vertex), at - vertex};
}

Round round_of(const Turns& turns) {
    Round round{.sectors = static_cast<std::size_t>(turns.sectors),
                .start_toolface = turns.start_toolface,
                .directions = {},
                .quarters = {}};
    for (int k = 0; k < turns.sectors; ++k) {
        const auto [sine, cosine] = sine_cosine(turns.start_toolface + k * 360.0 / turns.sectors);
        round.directions.push_back({cosine, sine});
    }
    for (std::size_t q = 0; q < 4; ++q) round.quarters[q] = place_of(90.0 * static_cast<double>(q), turns);
    return round;
}

// Memory for one turn. Radii and diameters are stored twice in a row, so that no index wraps.
struct Scratch {
    std::vector<double> radius, diameter;
    Points points;
    explicit Scratch(std::size_t sectors)
        : radius(2 * sectors + 2),
          diameter(2 * sectors),
          points(sectors, kernel::functions_for(InstructionSet::automatic)) {}
};

void measure_diameters(const Round& round, Scratch& scratch, std::size_t turn, TurnLogs& logs) {
    const std::size_t K = round.sectors;
    const std::vector<double>& r = scratch.radius;
    std::vector<double>& across = scratch.diameter;
    const std::size_t near = K / 2, far = (K + 1) / 2;  // with an odd K the far side lies between two vertices
    for (std::size_t k = 0; k < K; ++k) across[k] = across[k + K] = r[k] + 0.5 * (r[k + near] + r[k + far]);
    std::size_t greatest = 0;
    double least = across[0];
    for (std::size_t k = 1; k < K; ++k) {
        if (across[k] > across[greatest]) greatest = k;
        least = std::min(least, across[k]);
    }
    const std::size_t quarter = greatest + K / 4;
    const double share = static_cast<double>(K % 4) / 4.0;
    logs.c1[turn] = across[greatest];
    logs.c2[turn] = across[quarter] + share * (across[quarter + (share > 0.0 ? 1 : 0)] - across[quarter]);
    const double toolface = round.start_toolface + static_cast<double>(greatest) * 360.0 / static_cast<double>(K);
    const double within = std::fmod(toolface, 180.0), axis = within < 0.0 ? within + 180.0 : within + 0.0;
    logs.c1_toolface[turn] = axis < 180.0 ? axis : 0.0;  // a tiny negative toolface rounds up to 180
    logs.least_diameter[turn] = least;
    std::array<double, 4> at{};
    for (std::size_t q = 0; q < 4; ++q) {
        const auto [vertex, part] = round.quarters[q];
        at[q] = r[vertex] + part * (r[vertex + 1] - r[vertex]);
    }
    logs.diameter_0[turn] = at[0] + at[2];
    logs.diameter_90[turn] = at[1] + at[3];
}

void measure_whole(const Round& round, Scratch& scratch, std::size_t turn, TurnLogs& logs) {
    const std::size_t K = round.sectors;
    const std::vector<double>& r = scratch.radius;
    double sum = 0.0, squares = 0.0, cubes_0 = 0.0, cubes_90 = 0.0;
    for (std::size_t k = 0; k < K; ++k) {
        const double square = r[k] * r[k], x = r[k] * round.directions[k].x, y = r[k] * round.directions[k].y;
        scratch.points.put(k, {x, y});
        sum += r[k];
        squares += square;
        cubes_0 += square * x;
        cubes_90 += square * y;
    }
    scratch.points.fill_packs();
    logs.mean[turn] = sum / static_cast<double>(K);
    logs.mean_square[turn] = squares / static_cast<double>(K);
    const Point centre{cubes_0 / squares * (2.0 / 3.0), cubes_90 / squares * (2.0 / 3.0)};
    logs.centre_0[turn] = centre.x;
    logs.centre_90[turn] = centre.y;
    measure_diameters(round, scratch, turn, logs);
    const Circle inside = inscribed_circle(scratch.points, centre);
    logs.inscribed_diameter[turn] = 2.0 * inside.radius;
    logs.inscribed_0[turn] = inside.centre.x;
    logs.inscribed_90[turn] = inside.centre.y;
    logs.enclosing_diameter[turn] = 2.0 * enclosing_circle(scratch.points, centre).radius;
}

void measure(const Turns& turns, const Round& round, Scratch& scratch, std::size_t turn, TurnLogs& logs) {
    const std::size_t K = round.sectors;
    const std::span<const double> radius = turns.radius.subspan(turn * K, K);
    std::size_t there = 0;
    for (const double r : radius) there += r == r ? 1 : 0;
    logs.coverage[turn] = static_cast<double>(there) / static_cast<double>(K);
    if (there > 0) {
        Extremes extremes;
        extremes.take(radius.data(), radius.data() + K);
        logs.smallest[turn] = extremes.least();
        logs.largest[turn] = extremes.greatest();
    }
    if (there < K) return;
    std::copy(radius.begin(), radius.end(), scratch.radius.begin());
    std::copy(radius.begin(), radius.end(), scratch.radius.begin() + static_cast<std::ptrdiff_t>(K));
    std::copy_n(radius.begin(), 2, scratch.radius.begin() + static_cast<std::ptrdiff_t>(2 * K));
    measure_whole(round, scratch, turn, logs);
}

// Sums, over a window of turns x = -half .. half along the hole, of radii minus a reference that keeps the sums small:
//
//     residual = sum r^2 - sum over sectors of ((sum r)^2 / W + (sum x r)^2 / sum x^2),  W = 2 half + 1
class Window {
  public:
    Window(const Turns& turns, double reference)
        : radius_(turns.radius),
          sectors_(static_cast<std::size_t>(turns.sectors)),
          half_((turns.window - 1) / 2),
          reference_(reference),
          sum_(sectors_),
          moment_(sectors_) {}

    // Fills the window around turn `centre`.
    void fill(Index centre) {
        std::ranges::fill(sum_, 0.0);
        std::ranges::fill(moment_, 0.0);
        squares_ = 0.0;
        broken_ = 0;
        for (Index x = -half_; x <= half_; ++x) {
            double squares = 0.0;
            bool whole = true;
            for (std::size_t s = 0; s < sectors_; ++s) {
                const double r = at(centre + x, s, whole);
                sum_[s] += r;
                moment_[s] += static_cast<double>(x) * r;
                squares += r * r;
            }
            squares_ += squares;
            broken_ += whole ? 0 : 1;
        }
    }

    // Moves the window from around turn `centre` to around the next turn.
    void advance(Index centre) {
        const auto half = static_cast<double>(half_);
        bool left_whole = true, joined_whole = true;
        double left_squares = 0.0, joined_squares = 0.0;
        for (std::size_t s = 0; s < sectors_; ++s) {
            const double left = at(centre - half_, s, left_whole), joined = at(centre + half_ + 1, s, joined_whole);
            moment_[s] += half * left - (sum_[s] - left) + half * joined;
            sum_[s] += joined - left;
            left_squares += left * left;
            joined_squares += joined * joined;
        }
        squares_ += joined_squares - left_squares;
        broken_ += (joined_whole ? 0 : 1) - (left_whole ? 0 : 1);
    }

    double rugosity() const {
        if (broken_ > 0) return missing;
        const auto size = static_cast<double>(2 * half_ + 1);
        double levels = 0.0, slopes = 0.0;
        for (std::size_t s = 0; s < sectors_; ++s) {
            levels += sum_[s] * sum_[s];
            slopes += moment_[s] * moment_[s];
        }
        const double residual = squares_ - levels / size - slopes / (size * (size * size - 1.0) / 12.0);
        return std::sqrt(std::max(residual, 0.0) / (static_cast<double>(sectors_) * (size - 2.0)));
    }

  private:
    double at(Index turn, std::size_t sector, bool& whole) const {
        const double r = radius_[static_cast<std::size_t>(turn) * sectors_ + sector];
        whole &= r == r;
        return r == r ? r - reference_ : 0.0;
    }

    std::span<const double> radius_;
    std::size_t sectors_;
    Index half_;
    double reference_;
    std::vector<double> sum_, moment_;
    double squares_ = 0.0;
    Index broken_ = 0;
};

void measure_rugosity(const Turns& turns, double reference, Range range, Index count, TurnLogs& logs) {
    const Index half = (turns.window - 1) / 2;
    const Index start = std::max(range.start, half), stop = std::min(range.stop, count - half);
    if (start >= stop) return;
    Window window(turns, reference);
    window.fill(start);
    for (Index turn = start;; ++turn) {
        logs.rugosity[static_cast<std::size_t>(turn)] = window.rugosity();
        if (turn + 1 == stop) return;
        window.advance(turn);
    }
}

TurnLogs sized(std::size_t count) {
    TurnLogs logs;
    for (std::vector<double>* column :
         {&logs.coverage, &logs.mean, &logs.mean_square, &logs.smallest, &logs.largest, &logs.c1, &logs.c1_toolface,
          &logs.c2, &logs.least_diameter, &logs.diameter_0, &logs.diameter_90, &logs.centre_0, &logs.centre_90,
          &logs.inscribed_diameter, &logs.inscribed_0, &logs.inscribed_90, &logs.enclosing_diameter, &logs.rugosity}) {
        column->assign(count, missing);
    }
    return logs;
}

}  // namespace

TurnLogs turn_logs(const Turns& given, int threads) {
    const StandardArithmetic standard;
    const std::vector<double> radius = copied(given.radius);
    Turns turns = given;
    turns.radius = radius;
    require_sectors(turns.sectors);
    require(turns.window >= 3 && turns.window % 2 == 1, "window", turns.window, "must be odd and 3 or more");
    require(std::isfinite(turns.start_toolface), "start_toolface", turns.start_toolface, "must be finite");
    require(turns.first >= 0, "first", turns.first, "must not be negative");
    require_threads(threads);
    for (std::size_t i = 0; i < turns.radius.size(); ++i) {
        const double r = turns.radius[i];
        if (std::isnan(r) || (r >= least_radius && r <= largest_radius)) continue;
        throw InputError(entry_name("radius", static_cast<Index>(i)), "must lie in 1e-50 to 1e50 m, or be nan",
                         number_text(r));
    }
    const Index count = static_cast<Index>(turns.radius.size()) / turns.sectors;
    TurnLogs logs = sized(static_cast<std::size_t>(count));
    const Round round = round_of(turns);
    const auto first = std::ranges::find_if(turns.radius, [](double r) { return r == r; });
    const double reference = !std::isnan(turns.reference)  ? turns.reference
                             : first == turns.radius.end() ? 0.0
                                                           : *first;
    const Index before = turns.first % block;  // blocks begin at the same turns in every part of a wall
    for_each_range(threads, before + count, block, [&](int, const Range& whole) {
        const Range range{std::max<Index>(whole.start - before, 0), whole.stop - before};
        Scratch scratch(round.sectors);
        for (Index turn = range.start; turn < range.stop; ++turn) {
            measure(turns, round, scratch, static_cast<std::size_t>(turn), logs);
        }
        measure_rugosity(turns, reference, range, count, logs);
    });
    return logs;
}

}  // namespace helibore
