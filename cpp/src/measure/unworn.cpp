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
constexpr double width_level = 0.25, pipe_level = 0.55;
constexpr double least_share = 0.25;  // of the vertices must count
constexpr double together = 1e-4;     // metres; fits nearer to each other are one
constexpr double still_way = 1e-7;    // metres; a step this short is the last at its spread

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

// Four fits side by side, or four vertices of one fit. Vectors of four, as GCC and Clang have them, are made of what
// the machine has.
constexpr std::size_t lanes = 4;
using Four = double __attribute__((vector_size(lanes * sizeof(double))));
using Fits = std::array<Fit, lanes>;

#if defined(__GNUC__) && defined(__x86_64__)
#define HELIBORE_INTO_CALLER [[gnu::always_inline]] inline
#else
#define HELIBORE_INTO_CALLER inline
#endif

// Sums of the normal equations: the upper half of the matrix, then the right side.
template <class Number>
struct Normal {
    Number xx{}, xy{}, xr{}, yy{}, yr{}, rr{}, xe{}, ye{}, re{};
};

// Adds vertices to the sums, which are `dx` and `dy` from the centre of a circle; one at the centre adds nothing.
HELIBORE_INTO_CALLER void add(Normal<Four>& to, const Four& dx, const Four& dy, const Four& radius, double spread) {
    const Four zero{}, one = zero + 1.0, outside = zero + 1.0 / spread, inside = zero + 1.0 / (inside_spread * spread);
    const Four square = dx * dx + dy * dy;
    Four away = zero;
    for (std::size_t s = 0; s < lanes; ++s) away[s] = std::sqrt(square[s]);
    const Four e = away - radius, u = e * (e > zero ? outside : inside), widened = one + u * u * (1.0 / 6.0);
    const Four both = one / (widened * (away == zero ? one : away));  // one division for two
    const Four of_away = both * widened, of = both * away, nx = dx * of_away, ny = dy * of_away;
    const Four w = of * of * of, wx = w * nx, wy = w * ny;  // falling(u * u); 0 at the centre
    to.xx += wx * nx, to.xy += wx * ny, to.xr += wx, to.yy += wy * ny, to.yr += wy, to.rr += w;
    to.xe += wx * e, to.ye += wy * e, to.re += w * e;
}

// Moves a circle to the weighted mean of the excess, with a pull to the guess: a step of iterated least squares.
// Returns the square of the way.
double move(const Turn& turn, const Normal<double>& sums, double spread, Fit& fit) {
    // Weights are those of spread^2, so the pull is as well.
    const double of_centre = spread * spread / (turn.scale * turn.scale * centre_guess * centre_guess);
    const double of_radius = spread * spread / (turn.scale * turn.scale * radius_guess * radius_guess);
    const double xx = sums.xx + of_centre, yy = sums.yy + of_centre, rr = sums.rr + of_radius;
    const double bx = sums.xe - of_centre * fit.x, by = sums.ye - of_centre * fit.y;
    const double br = sums.re - of_radius * (fit.radius - turn.bit_radius);
    // Cholesky; the pull makes the matrix positive definite.
    const double l0 = std::sqrt(xx), l1 = sums.xy / l0, l2 = sums.xr / l0;
    const double l3 = std::sqrt(yy - l1 * l1), l4 = (sums.yr - l1 * l2) / l3;
    const double l5 = std::sqrt(rr - l2 * l2 - l4 * l4);
    const double u = bx / l0, v = (by - l1 * u) / l3, w = (br - l2 * u - l4 * v) / l5;
    const double dr = w / l5, dy = (v - l4 * dr) / l3, dx = (u - l1 * dy - l2 * dr) / l0;
    fit.x += dx, fit.y += dy;
    fit.radius = std::max(fit.radius + dr, 0.1 * turn.bit_radius);
    return dx * dx + dy * dy + dr * dr;
}

HELIBORE_INTO_CALLER void all_sums(const Turn& turn, const Fits& fits, double spread,
                                   std::array<Normal<double>, lanes>& of_fits) {
    Four x{}, y{}, radius{};
    for (std::size_t s = 0; s < lanes; ++s) x[s] = fits[s].x, y[s] = fits[s].y, radius[s] = fits[s].radius;
    Normal<Four> sums;
    for (std::size_t i = 0; i < turn.counted_x.size(); ++i)
        add(sums, turn.counted_x[i] - x, turn.counted_y[i] - y, radius, spread);
    for (std::size_t s = 0; s < lanes; ++s)
        of_fits[s] = {sums.xx[s], sums.xy[s], sums.xr[s], sums.yy[s], sums.yr[s],
                      sums.rr[s], sums.xe[s], sums.ye[s], sums.re[s]};
}

HELIBORE_INTO_CALLER Normal<double> one_sum(const Turn& turn, const Fit& fit, double spread) {
    const std::size_t count = turn.counted_x.size(), whole = count / lanes * lanes;
    const Four zero{}, radius = zero + fit.radius;
    Normal<Four> sums;
    Four x, y;
    for (std::size_t i = 0; i < whole; i += lanes) {
        std::memcpy(&x, &turn.counted_x[i], sizeof x);
        std::memcpy(&y, &turn.counted_y[i], sizeof y);
        add(sums, x - fit.x, y - fit.y, radius, spread);
    }
    x = zero + fit.x, y = zero + fit.y;  // adds nothing
    for (std::size_t i = whole; i < count; ++i) x[i - whole] = turn.counted_x[i], y[i - whole] = turn.counted_y[i];
    if (whole < count) add(sums, x - fit.x, y - fit.y, radius, spread);
    const auto all = [](const Four& of) { return (of[0] + of[1]) + (of[2] + of[3]); };
    return {all(sums.xx), all(sums.xy), all(sums.xr), all(sums.yy), all(sums.yr),
            all(sums.rr), all(sums.xe), all(sums.ye), all(sums.re)};
}

struct SumFunctions {
    void (*all)(const Turn&, const Fits&, double, std::array<Normal<double>, lanes>&);
    Normal<double> (*one)(const Turn&, const Fit&, double);
};

void all_sums_plain(const Turn& turn, const Fits& fits, double spread, std::array<Normal<double>, lanes>& of_fits) {
    all_sums(turn, fits, spread, of_fits);
}

Normal<double> one_sum_plain(const Turn& turn, const Fit& fit, double spread) {
    return one_sum(turn, fit, spread);
}

constexpr SumFunctions plain_sums{all_sums_plain, one_sum_plain};

#if defined(__GNUC__) && defined(__x86_64__)
// The same arithmetic, and so the same bits, with four doubles in one vector: half the time.
[[gnu::target("avx2")]] void all_sums_avx2(const Turn& turn, const Fits& fits, double spread,
                                           std::array<Normal<double>, lanes>& of_fits) {
    all_sums(turn, fits, spread, of_fits);
}

[[gnu::target("avx2")]] Normal<double> one_sum_avx2(const Turn& turn, const Fit& fit, double spread) {
    return one_sum(turn, fit, spread);
}

constexpr SumFunctions avx2_sums{all_sums_avx2, one_sum_avx2};
#else
constexpr SumFunctions avx2_sums = plain_sums;
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

bool are_one(const Fits& fits, double limit) {
    return std::ranges::all_of(fits, [&](const Fit& fit) {
        const double x = fit.x - fits[0].x, y = fit.y - fits[0].y, radius = fit.radius - fits[0].radius;
        return x * x + y * y + radius * radius < limit * limit;
    });
}

Fit fitted(const Turn& turn, const SumFunctions& functions, std::vector<double>& radii) {
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
    Fits fits{{{0.0, 0.0, turn.bit_radius}, {0.0, 0.0, *quarter}, {x, y, *quarter}, {-x, -y, *quarter}}};
    std::array<Normal<double>, lanes> sums;
    bool alone = false;  // whether all starts have come to one circle, which goes on alone
    for (const double spread : spreads) {
        const double scaled = spread * turn.scale, still = still_way * turn.scale;
        for (int step = 0; step < (spread == spreads.back() ? last_steps : steps); ++step) {
            if (alone) {
                if (move(turn, functions.one(turn, fits[0], scaled), scaled, fits[0]) < still * still) break;
                continue;
            }
            functions.all(turn, fits, scaled, sums);
            for (std::size_t s = 0; s < lanes; ++s) move(turn, sums[s], scaled, fits[s]);
        }
        alone = alone || are_one(fits, together * turn.scale);
    }
    if (alone) return fits[0];
    Fit best{};
    double most = -std::numeric_limits<double>::infinity();
    for (const Fit& fit : fits) {
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
    const SumFunctions& functions = is_plain ? plain_sums : avx2_sums;
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
            const Fit fit = fitted(turn, functions, radii);
            found.diameter[i] = 2.0 * fit.radius;
            found.centre_0[i] = fit.x;
            found.centre_90[i] = fit.y;
            find_lobes(turn, fit, i, found);
        }
    });
    return found;
}

}  // namespace helibore
