// Each turn is fitted alone, from four starts; the best fit counts. All lengths are those of a hole of 8.5 in, scaled
// to the bit.
#include "helibore/unworn.hpp"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>
#include <optional>

#include "base/arithmetic.hpp"
#include "base/degrees.hpp"
#include "base/host_memory.hpp"
#include "base/messages.hpp"
#include "base/threads.hpp"
#include "base/trigonometry.hpp"
#include "samples/helix.hpp"
#include "search/kernel/instruction_set.hpp"
#include "search/kernel/kernel.hpp"

namespace helibore {
namespace {

constexpr Index block = 64;  // turns
constexpr double missing = std::numeric_limits<double>::quiet_NaN();
constexpr double scaled_bit = 0.2159;                                     // metres, 8.5 in
constexpr std::array<double, 5> spreads{8e-3, 5e-3, 3e-3, 2e-3, 1.2e-3};  // metres
constexpr int steps = 2;  // at each spread, and `last_steps` at the last
constexpr int last_steps = 6;
constexpr double inside_spread = 2.5;  // times the spread outside: noise and cuttings reach inside, wear does not
constexpr double centre_guess = 15e-3, radius_guess = 20e-3;  // metres; standard deviations from the axis and the bit
constexpr double judged_spread = 1.5e-3, far_inside = 3e-3;   // metres
constexpr double least_lobe = 3e-3;                           // metres; a lobe is higher
constexpr double width_level = 0.25, pipe_level = 0.35;
constexpr double least_share = 0.25;  // of the vertices must count

struct Fit {
    double x, y, radius;
};

struct Directions {
    std::vector<double> x, y;
};

// Falls from 1 to 0 as exp(-u^2 / 2) does; a library's exp differs in its last bits between machines.
double falling(double square) {
    const double of = 1.0 / (1.0 + square * (1.0 / 6.0));
    return of * of * of;
}

// The vertices of one turn, metres.
struct Turn {
    std::vector<double> x, y, height;
    std::vector<bool> counts;
    std::vector<double> counted_x, counted_y;  // of the vertices that count
    double scale, bit_radius;
    std::size_t size() const { return x.size(); }
};

double excess(const Turn& turn, std::size_t i, const Fit& fit) {
    const double dx = turn.x[i] - fit.x, dy = turn.y[i] - fit.y;
    return std::sqrt(dx * dx + dy * dy) - fit.radius;
}

// The fits from all starts, side by side. Vectors of four, as GCC and Clang have them, are made of what the machine
// has.
constexpr std::size_t starts = 4;
using Four = double __attribute__((vector_size(starts * sizeof(double))));
using Lanes = std::array<double, starts>;
struct Fits {
    Lanes x, y, radius;
};

#if defined(__GNUC__) && defined(__x86_64__)
#define HELIBORE_INTO_CALLER [[gnu::always_inline]] inline
#else
#define HELIBORE_INTO_CALLER inline
#endif

// One step of iterated least squares for each fit: the circle moves to the weighted mean of the excess, with a pull to
// the guess.
HELIBORE_INTO_CALLER void improve_step(const Turn& turn, Fits& fits, double spread) {
    std::array<Lanes, 6> a;  // upper half of the normal matrix: xx, xy, xr, yy, yr, rr
    std::array<Lanes, 3> b;
    {
        Four x, y, radius, xx{}, xy{}, xr{}, yy{}, yr{}, rr{}, xe{}, ye{}, re{};
        std::memcpy(&x, fits.x.data(), sizeof x);
        std::memcpy(&y, fits.y.data(), sizeof y);
        std::memcpy(&radius, fits.radius.data(), sizeof radius);
        const Four zero{}, one = zero + 1.0, outside = zero + 1.0 / spread,
                           inside = zero + 1.0 / (inside_spread * spread);
        for (std::size_t i = 0; i < turn.counted_x.size(); ++i) {
            const Four dx = turn.counted_x[i] - x, dy = turn.counted_y[i] - y, square = dx * dx + dy * dy;
            Four away = zero;
            for (std::size_t s = 0; s < starts; ++s) away[s] = std::sqrt(square[s]);
            const Four of_away = one / (away == zero ? one : away);
            const Four e = away - radius, nx = dx * of_away, ny = dy * of_away;
            const Four u = e * (e > zero ? outside : inside);
            const Four of = one / (one + u * u * (1.0 / 6.0));  // falling(u * u)
            const Four w = away == zero ? zero : of * of * of, wx = w * nx, wy = w * ny;
            xx += wx * nx, xy += wx * ny, xr += wx, yy += wy * ny, yr += wy, rr += w;
            xe += wx * e, ye += wy * e, re += w * e;
        }
        const Four* sums[] = {&xx, &xy, &xr, &yy, &yr, &rr, &xe, &ye, &re};
        for (std::size_t k = 0; k < 9; ++k) std::memcpy(k < 6 ? a[k].data() : b[k - 6].data(), sums[k], sizeof xx);
    }
    // Weights are those of spread^2, so the pull is as well.
    const double of_centre = spread * spread / (turn.scale * turn.scale * centre_guess * centre_guess);
    const double of_radius = spread * spread / (turn.scale * turn.scale * radius_guess * radius_guess);
    for (std::size_t s = 0; s < starts; ++s) {
        const double xx = a[0][s] + of_centre, yy = a[3][s] + of_centre, rr = a[5][s] + of_radius;
        const double bx = b[0][s] - of_centre * fits.x[s], by = b[1][s] - of_centre * fits.y[s];
        const double br = b[2][s] - of_radius * (fits.radius[s] - turn.bit_radius);
        // Cholesky; the pull makes the matrix positive definite.
        const double l0 = std::sqrt(xx), l1 = a[1][s] / l0, l2 = a[2][s] / l0;
        const double l3 = std::sqrt(yy - l1 * l1), l4 = (a[4][s] - l1 * l2) / l3;
        const double l5 = std::sqrt(rr - l2 * l2 - l4 * l4);
        const double u = bx / l0, v = (by - l1 * u) / l3, w = (br - l2 * u - l4 * v) / l5;
        const double dr = w / l5, dy = (v - l4 * dr) / l3, dx = (u - l1 * dy - l2 * dr) / l0;
        fits.x[s] += dx, fits.y[s] += dy;
        fits.radius[s] = std::max(fits.radius[s] + dr, 0.1 * turn.bit_radius);
    }
}

using Improve = void (*)(const Turn&, Fits&, double);

void improve(const Turn& turn, Fits& fits, double spread) {
    improve_step(turn, fits, spread);
}

#if defined(__GNUC__) && defined(__x86_64__)
// The same arithmetic, and so the same bits, with the four fits in one vector: half the time.
[[gnu::target("avx2")]] void improve_avx2(const Turn& turn, Fits& fits, double spread) {
    improve_step(turn, fits, spread);
}
#else
constexpr Improve improve_avx2 = improve;
#endif

// How well a circle fits; higher is better. Rock far inside it, and a size far from the bit, speak against it.
double merit(const Turn& turn, const Fit& fit) {
    double sum = 0.0, inside = 0.0, count = 0.0;
    for (std::size_t i = 0; i < turn.size(); ++i) {
        if (!turn.counts[i]) continue;
        const double e = excess(turn, i, fit) / turn.scale, u = e / judged_spread;
        sum += falling(u * u);
        inside += e < -far_inside ? 1.0 : 0.0;
        count += 1.0;
    }
    const double off = (fit.radius - turn.bit_radius) / (turn.scale * radius_guess);
    return (sum - inside) / count - 0.05 * off * off;
}

Fit fitted(const Turn& turn, Improve improved, std::vector<double>& radii) {
    double x = 0.0, y = 0.0;
    radii.clear();
    for (std::size_t i = 0; i < turn.counted_x.size(); ++i) {
        const double to_x = turn.counted_x[i], to_y = turn.counted_y[i];
        x += to_x, y += to_y;
        radii.push_back(std::sqrt(to_x * to_x + to_y * to_y));
    }
    x /= static_cast<double>(radii.size()), y /= static_cast<double>(radii.size());
    const auto quarter = radii.begin() + static_cast<std::ptrdiff_t>(radii.size() / 4);
    std::nth_element(radii.begin(), quarter, radii.end());
    Fits fits{{0.0, 0.0, x, -x}, {0.0, 0.0, y, -y}, {turn.bit_radius, *quarter, *quarter, *quarter}};
    for (const double spread : spreads)
        for (int step = 0; step < (spread == spreads.back() ? last_steps : steps); ++step)
            improved(turn, fits, spread * turn.scale);
    Fit best{};
    double most = -std::numeric_limits<double>::infinity();
    for (std::size_t s = 0; s < starts; ++s) {
        const Fit fit{fits.x[s], fits.y[s], fits.radius[s]};
        const double of = merit(turn, fit);
        if (of > most) most = of, best = fit;
    }
    return best;
}

// Returns the diameter of the circle that fits the vertices [first, stop) above a height, by least squares of squared
// distances (Kasa); NaN for fewer than three vertices, or vertices in a line.
double pipe_of(const Turn& turn, std::size_t first, std::size_t stop, double level) {
    const std::size_t K = turn.size();
    double n = 0.0, x = 0.0, y = 0.0;
    for (std::size_t i = first; i < stop; ++i) {
        if (turn.height[i % K] < level) continue;
        n += 1.0, x += turn.x[i % K], y += turn.y[i % K];
    }
    if (n < 3.0) return missing;
    x /= n, y /= n;
    double xx = 0.0, xy = 0.0, yy = 0.0, xs = 0.0, ys = 0.0, s = 0.0;
    for (std::size_t i = first; i < stop; ++i) {
        if (turn.height[i % K] < level) continue;
        const double dx = turn.x[i % K] - x, dy = turn.y[i % K] - y, square = dx * dx + dy * dy;
        xx += dx * dx, xy += dx * dy, yy += dy * dy, xs += dx * square, ys += dy * square, s += square;
    }
    const double determinant = xx * yy - xy * xy;
    if (!(determinant > 1e-12 * s * s)) return missing;
    const double cx = 0.5 * (xs * yy - ys * xy) / determinant, cy = 0.5 * (ys * xx - xs * xy) / determinant;
    return 2.0 * std::sqrt(cx * cx + cy * cy + s / n);
}

struct Lobe {
    double toolface, width, height, pipe;
};

// Returns the lobe of the run of vertices [first, stop), whose numbers may pass the end of the turn; none if none of
// its vertices counts.
std::optional<Lobe> lobe_of(const Turn& turn, const Fit& fit, std::size_t first, std::size_t stop) {
    const std::size_t K = turn.size();
    Lobe lobe{0.0, 0.0, 0.0, missing};
    double x = 0.0, y = 0.0;
    for (std::size_t i = first; i < stop; ++i) {
        const std::size_t k = i % K;
        const double dx = turn.x[k] - fit.x, dy = turn.y[k] - fit.y, away = std::sqrt(dx * dx + dy * dy);
        if (turn.counts[k]) lobe.height = std::max(lobe.height, turn.height[k]);
        if (away > 0.0) x += turn.height[k] * dx / away, y += turn.height[k] * dy / away;
    }
    if (!(lobe.height > 0.0)) return std::nullopt;
    lobe.toolface = wrap_toolface(arc_tangent(y, x) / degree);
    double wide = 0.0;
    for (std::size_t i = first; i < stop; ++i) wide += turn.height[i % K] >= width_level * lobe.height ? 1.0 : 0.0;
    lobe.width = wide * 360.0 / static_cast<double>(K);
    lobe.pipe = pipe_of(turn, first, stop, pipe_level * lobe.height);
    return lobe;
}

void put(const std::optional<Lobe>& lobe, std::size_t at, TurnLobes& lobes) {
    if (!lobe) return;
    lobes.toolface[at] = lobe->toolface;
    lobes.width[at] = lobe->width;
    lobes.height[at] = lobe->height;
    lobes.pipe[at] = lobe->pipe;
}

void find_lobes(Turn& turn, const Fit& fit, std::size_t at, UnwornTurns& found) {
    const std::size_t K = turn.size();
    const double limit = least_lobe * turn.scale;
    std::size_t low = K;  // a vertex that is in no lobe
    for (std::size_t k = 0; k < K; ++k) {
        turn.height[k] = excess(turn, k, fit);
        if (!(turn.height[k] > limit)) low = k;
    }
    std::optional<Lobe> highest, next;
    const auto take = [&](std::size_t first, std::size_t stop) {
        const auto lobe = lobe_of(turn, fit, first, stop);
        if (!lobe) return;
        if (!highest || lobe->height > highest->height) {
            next = highest, highest = lobe;
        } else if (!next || lobe->height > next->height) {
            next = lobe;
        }
    };
    if (low == K) {
        take(0, K);
    } else {
        for (std::size_t i = low + 1; i < low + K; ++i) {
            if (!(turn.height[i % K] > limit)) continue;
            std::size_t stop = i;
            while (turn.height[stop % K] > limit) ++stop;  // ends at `low`
            take(i, stop);
            i = stop;
        }
    }
    put(highest, at, found.lobes[0]);
    put(next, at, found.lobes[1]);
}

}  // namespace

UnwornTurns unworn_turns(const Turns& turns, double bit_diameter, std::span<const double> given, int threads) {
    const StandardArithmetic standard;
    const std::vector<double> radius = copied(turns.radius);
    const std::vector<double> counts = copied(given);
    require_sectors(turns.sectors);
    require(std::isfinite(turns.start_toolface), "start_toolface", turns.start_toolface, "must be finite");
    require(bit_diameter >= 1e-50 && bit_diameter <= 1e50, "bit_diameter", bit_diameter, "must lie in 1e-50 to 1e50 m");
    require_threads(threads);
    if (!counts.empty()) require_length("counts", counts.size(), radius.size(), "radius");
    const auto K = static_cast<std::size_t>(turns.sectors);
    const Index count = static_cast<Index>(radius.size() / K);
    const bool is_plain = &kernel::functions_for(InstructionSet::automatic) == &kernel::plain();
    const Improve improved = is_plain ? improve : improve_avx2;
    UnwornTurns found;
    for (std::vector<double>* column : {&found.diameter, &found.centre_0, &found.centre_90}) {
        column->assign(static_cast<std::size_t>(count), missing);
    }
    for (TurnLobes& lobes : found.lobes) {
        for (std::vector<double>* column : {&lobes.toolface, &lobes.width, &lobes.height, &lobes.pipe}) {
            column->assign(static_cast<std::size_t>(count), missing);
        }
    }
    Directions directions;
    for (std::size_t k = 0; k < K; ++k) {
        const auto [sine, cosine] =
            sine_cosine(turns.start_toolface + static_cast<double>(k) * 360.0 / static_cast<double>(K));
        directions.x.push_back(cosine), directions.y.push_back(sine);
    }
    for_each_range(threads, count, block, [&](int, const Range& range) {
        Turn turn;
        for (std::vector<double>* column : {&turn.x, &turn.y, &turn.height}) column->resize(K);
        turn.counts.resize(K);
        turn.scale = bit_diameter / scaled_bit;
        turn.bit_radius = 0.5 * bit_diameter;
        std::vector<double> radii;
        for (Index at = range.start; at < range.stop; ++at) {
            const auto i = static_cast<std::size_t>(at);
            std::size_t there = 0;
            turn.counted_x.clear(), turn.counted_y.clear();
            for (std::size_t k = 0; k < K; ++k) {
                const double r = radius[i * K + k];
                there += r == r ? 1U : 0U;
                turn.x[k] = r * directions.x[k], turn.y[k] = r * directions.y[k];
                turn.counts[k] = counts.empty() || counts[i * K + k] != 0.0 ? 1 : 0;
                if (turn.counts[k]) turn.counted_x.push_back(turn.x[k]), turn.counted_y.push_back(turn.y[k]);
            }
            const std::size_t known = turn.counted_x.size();
            if (there < K || known < 3 || static_cast<double>(known) < least_share * static_cast<double>(K)) continue;
            const Fit fit = fitted(turn, improved, radii);
            found.diameter[i] = 2.0 * fit.radius;
            found.centre_0[i] = fit.x;
            found.centre_90[i] = fit.y;
            find_lobes(turn, fit, i, found);
        }
    });
    return found;
}

}  // namespace helibore
