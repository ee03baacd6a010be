// Windows are compared in floats, eight sections at a time. Sections of one kind stand together, so that the sum over a
// kind is one over neighbours; each kind ends with sections that do not count, up to a whole number of eights.
#include "helibore/kinds.hpp"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>

#include "base/degrees.hpp"
#include "base/exponential.hpp"
#include "base/messages.hpp"
#include "base/threads.hpp"

namespace helibore {

namespace {

constexpr std::size_t at_once = 8;
constexpr Index batch = 16;  // windows that are compared with a section while it is in the cache

struct Scale {
    float log_prior, log_scale, half_inverse_square;
};
using Scales = std::array<Scale, 4>;

Scales scales_of(const LikenessRule& rule) {
    Scales out{};
    for (std::size_t i = 0; i < out.size(); ++i) {
        const auto [scale, prior] = rule.scales[i];
        out[i] = {static_cast<float>(logarithm(prior)), static_cast<float>(logarithm(scale)),
                  static_cast<float>(0.5 / (scale * scale))};
    }
    return out;
}

// Four numbers: vectors of GCC and Clang, which become SSE2, NEON or WebAssembly's simd128.
using Float4 = float __attribute__((vector_size(16)));
using Int4 = std::int32_t __attribute__((vector_size(16)));

inline Float4 four(float x) {
    return Float4{x, x, x, x};
}
inline Float4 four_at(const float* p) {
    Float4 x;
    std::memcpy(&x, p, sizeof x);
    return x;
}
inline void put(Float4 x, float* p) {
    std::memcpy(p, &x, sizeof x);
}
inline Float4 greater(Float4 x, Float4 y) {
    return x > y ? x : y;
}

// Returns e^x for x in [-60, 0], within 2e-7 of itself.
inline Float4 exponentials(Float4 x) {
    constexpr float whole = 0x1.8p23f;
    const Float4 n = (x * 1.44269504f + whole) - whole, r = (x - n * 0.693359375f) + n * 2.12194440e-4f;
    const Float4 high = 8.33345205e-3f + r * 1.39819994e-3f;
    const Float4 of = 1.0f + r * (1.0f + r * (0.5f + r * (1.66666657e-1f + r * (4.16657962e-2f + r * high))));
    return of * reinterpret_cast<Float4>((__builtin_convertvector(n, Int4) + 127) << 23);
}

// The library in the order of kinds. Sections of eight stand part by part: [eight][part][of eight].
struct Sections {
    std::vector<float> of, size, weight;  // weight: 0 for what fills up an eight; with the chance
    std::vector<float> without_chance;    // by what a probability is multiplied so that chances do not count
    std::array<std::size_t, hole_kinds + 1> starts{};  // of the kinds
    std::array<float, hole_kinds> each{};              // 1 / sum of the weights of the kind

    std::size_t count() const { return size.size(); }
};

// Checks the library, and returns the number of its sections.
std::size_t checked_count(const SectionLibrary& library) {
    Index count = 0;
    for (std::size_t kind = 0; kind < hole_kinds; ++kind) {
        require(library.counts[kind] >= 0, entry_name("counts", static_cast<Index>(kind)), library.counts[kind],
                "must be 0 or more");
        count += library.counts[kind];
    }
    require(count >= 1, "counts", count, "must be 1 or more in all");
    require_length("size", library.size.size(), static_cast<std::size_t>(count), "counts");
    require_length("sections", library.sections.size(), section_parts * library.size.size(), "32 times counts");
    require_finite("sections", library.sections);
    require_finite("size", library.size);
    const std::pair<const char*, std::span<const double>> optional[] = {{"weight", library.weight},
                                                                        {"chance", library.chance}};
    for (const auto& [name, values] : optional) {
        if (values.empty()) continue;
        require_length(name, values.size(), library.size.size(), "counts");
        for (std::size_t i = 0; i < values.size(); ++i)
            if (!(std::isfinite(values[i]) && values[i] > 0.0))
                throw entry_error(name, static_cast<Index>(i), values[i], "must be finite and above 0");
    }
    return library.size.size();
}

double weight_of(const SectionLibrary& library, std::size_t row) {
    return library.weight.empty() ? 1.0 : library.weight[row];
}

double chance_of(const SectionLibrary& library, std::size_t row) {
    return library.chance.empty() ? 1.0 : library.chance[row];
}

Sections arranged(const SectionLibrary& library) {
    checked_count(library);
    Sections out;
    std::size_t row = 0;
    for (std::size_t kind = 0; kind < hole_kinds; ++kind) {
        const auto number = static_cast<std::size_t>(library.counts[kind]);
        const std::size_t start = out.starts[kind], stop = start + (number + at_once - 1) / at_once * at_once;
        out.starts[kind + 1] = stop;
        out.size.resize(stop), out.weight.resize(stop), out.without_chance.resize(stop);
        out.of.resize(stop * section_parts);
        double all = 0.0, without = 0.0;
        for (std::size_t i = row; i < row + number; ++i)
            all += weight_of(library, i) * chance_of(library, i), without += weight_of(library, i);
        for (std::size_t place = start; place < start + number; ++place, ++row) {
            out.size[place] = static_cast<float>(library.size[row]);
            out.weight[place] = static_cast<float>(weight_of(library, row) * chance_of(library, row));
            out.without_chance[place] = static_cast<float>(all / without / chance_of(library, row));
            float* const eight = &out.of[place / at_once * at_once * section_parts];
            for (std::size_t part = 0; part < section_parts; ++part)
                eight[part * at_once + place % at_once] =
                    static_cast<float>(library.sections[row * section_parts + part]);
        }
        out.each[kind] = number > 0 ? static_cast<float>(1.0 / all) : 0.0f;
    }
    return out;
}

// A symmetric matrix of two rows: of the tool's centre, x along toolface 0.
struct Matrix {
    double xx = 0.0, xy = 0.0, yy = 0.0;
};

Matrix plus(const Matrix& a, const Matrix& b, double times = 1.0) {
    return {a.xx + times * b.xx, a.xy + times * b.xy, a.yy + times * b.yy};
}

Matrix round_matrix(double of) {
    return {of, 0.0, of};
}

Matrix inverse(const Matrix& of) {
    const double determinant = of.xx * of.yy - of.xy * of.xy;
    return {of.yy / determinant, -of.xy / determinant, of.xx / determinant};
}

struct Part {
    std::uint32_t number;
    double length;
    SineCosine of;
};

// The parts of a window that have samples, and what they see of the tool's centre:
//     A = w sum h h',  h = (cosine, sine) of a part
struct Window {
    int seen = 0;
    double weight = 0.0, independent = 0.0;
    Matrix centre;
    std::array<Part, section_parts> parts;
};

Window window_of(const double* section, const LikenessRule& rule) {
    Window out;
    for (std::size_t part = 0; part < section_parts; ++part) {
        if (std::isnan(section[part])) continue;
        const SineCosine of = sine_cosine(static_cast<double>(part) * 360.0 / section_parts);
        out.parts[static_cast<std::size_t>(out.seen++)] = {static_cast<std::uint32_t>(part),
                                                           std::clamp(section[part], -1e6, 1e6), of};
        out.centre = plus(out.centre, {of.cosine * of.cosine, of.cosine * of.sine, of.sine * of.sine});
    }
    if (out.seen == 0) return out;
    out.independent = std::min(static_cast<double>(out.seen), rule.effective);
    out.weight = out.independent / out.seen / (rule.rough * rule.rough);
    out.centre = plus({}, out.centre, out.weight);
    return out;
}

// Sums of a window and each section of a library, from t = the window's lengths less those of the section:
//     q = w sum t^2,  b = w sum h t
struct Sums {
    float *q, *x, *y;
};

// Writes the sums of a window and eight sections.
inline void compare(const Window& window, const float* eight, const Sums& sums) {
    Float4 q[2] = {}, x[2] = {}, y[2] = {};
    for (int i = 0; i < window.seen; ++i) {
        const Part& part = window.parts[static_cast<std::size_t>(i)];
        const auto length = static_cast<float>(part.length), cosine = static_cast<float>(part.of.cosine),
                   sine = static_cast<float>(part.of.sine);
        for (const std::size_t half : {0U, 1U}) {
            const Float4 off = length - four_at(eight + part.number * at_once + 4 * half);
            q[half] += off * off, x[half] += cosine * off, y[half] += sine * off;
        }
    }
    const auto weight = static_cast<float>(window.weight);
    for (const std::size_t half : {0U, 1U})
        put(weight * q[half], sums.q + 4 * half), put(weight * x[half], sums.x + 4 * half),
            put(weight * y[half], sums.y + 4 * half);
}

// Returns the sum of four sums, in an order of its own.
inline double all_of(Float4 sums) {
    return (static_cast<double>(sums[0]) + static_cast<double>(sums[1])) +
           (static_cast<double>(sums[2]) + static_cast<double>(sums[3]));
}

using OfKinds = std::array<double, hole_kinds>;

double sum_of(const OfKinds& kinds) {
    double all = 0.0;
    for (const double of : kinds) all += of;
    return all;
}

// From one window to the next: probability that the section stays, changes within its kind, or becomes any; and the
// share of the centre that stays.
struct Moves {
    double stays, changes, leaves, keeps;
};

Moves moves_over(double length, const ChainRule& rule) {
    const double stays = exponential(length * logarithm(rule.stays)), changes = (1.0 - stays) * rule.changes;
    return {stays, changes, 1.0 - stays - changes, exponential(-length / rule.centre_stays)};
}

struct Float4Matrix {
    Float4 xx, xy, yy;

    explicit Float4Matrix(const Matrix& of)
        : xx(four(static_cast<float>(of.xx))),
          xy(four(static_cast<float>(of.xy))),
          yy(four(static_cast<float>(of.yy))) {}
    Float4 times_x(Float4 x, Float4 y) const { return xx * x + xy * y; }
    Float4 times_y(Float4 x, Float4 y) const { return xy * x + yy * y; }
};

// What the windows on one side say: of each section, its probability and where the tool's centre then is.
struct Belief {
    std::vector<float> likely, x, y;
    Matrix spread;  // covariance of the centre, the same for all sections
};

// Goes along the windows, and takes the evidence of each. Given the section, the centre is normal.
class Chain {
  public:
    Chain(const Sections& library, const ChainRule& rule, const Moves& moves)
        : library_(library),
          moves_(moves),
          scales_(scales_of(rule.likeness)),
          variance_(rule.likeness.offset * rule.likeness.offset),
          temper_(static_cast<float>(rule.temper)),
          prior_(rule.prior),
          log_(library.count()) {
        const std::vector<float> zero(library.count());
        now_ = {zero, zero, zero, round_matrix(variance_)};
        for (std::size_t kind = 0; kind < hole_kinds; ++kind)
            for (std::size_t i = library.starts[kind]; i < library.starts[kind + 1]; ++i)
                now_.likely[i] = static_cast<float>(prior_[kind]) * library.each[kind] * library.weight[i];
        first_ = now_.likely;
    }

    const Belief& now() const { return now_; }

    void take(const Window& window, const Sums& sums) {
        if (window.seen == 0) return;
        now_.spread = inverse(plus(window.centre, inverse(now_.spread)));
        const Float4Matrix A(window.centre), G(now_.spread);
        const auto independent = static_cast<float>(window.independent);
        for (std::size_t i = 0; i < library_.count(); i += 4) {
            const Float4 x = four_at(&now_.x[i]), y = four_at(&now_.y[i]);
            const Float4 bx = four_at(sums.x + i), by = four_at(sums.y + i);
            const Float4 vx = bx - A.times_x(x, y), vy = by - A.times_y(x, y);
            const Float4 to_x = G.times_x(vx, vy), to_y = G.times_y(vx, vy);
            const Float4 square = four_at(sums.q + i) - x * (bx + vx) - y * (by + vy) - vx * to_x - vy * to_y;
            Float4 log = four(-std::numeric_limits<float>::max());
            for (const Scale& scale : scales_)
                log =
                    greater(scale.log_prior - independent * scale.log_scale - scale.half_inverse_square * square, log);
            put(log, &log_[i]), put(x + to_x, &now_.x[i]), put(y + to_y, &now_.y[i]);
        }
        multiply(now_.likely);
    }

    void move() {
        OfKinds sums{};
        double x = 0.0, y = 0.0;
        for (std::size_t kind = 0; kind < hole_kinds; ++kind) {
            Float4 sum = {}, of_x = {}, of_y = {};
            for (std::size_t i = library_.starts[kind]; i < library_.starts[kind + 1]; i += 4) {
                const Float4 likely = four_at(&now_.likely[i]);
                sum += likely, of_x += likely * four_at(&now_.x[i]), of_y += likely * four_at(&now_.y[i]);
            }
            sums[kind] = all_of(sum), x += all_of(of_x), y += all_of(of_y);
        }
        const double all = sum_of(sums);
        const auto stays = static_cast<float>(moves_.stays / all), keeps = static_cast<float>(moves_.keeps),
                   mean_x = static_cast<float>(x / all), mean_y = static_cast<float>(y / all);
        for (std::size_t kind = 0; kind < hole_kinds; ++kind) {
            const double moves = moves_.changes * sums[kind] / all + moves_.leaves * prior_[kind];
            const auto moved = static_cast<float>(moves * static_cast<double>(library_.each[kind]));
            for (std::size_t i = library_.starts[kind]; i < library_.starts[kind + 1]; i += 4) {
                const Float4 from = stays * four_at(&now_.likely[i]),
                             all_there = from + moved * four_at(&library_.weight[i]);
                const Float4 share = from / (all_there + least);
                put(all_there, &now_.likely[i]);
                put(keeps * (mean_x + share * (four_at(&now_.x[i]) - mean_x)), &now_.x[i]);
                put(keeps * (mean_y + share * (four_at(&now_.y[i]) - mean_y)), &now_.y[i]);
            }
        }
        const double kept = moves_.keeps * moves_.keeps;
        now_.spread = plus(round_matrix((1.0 - kept) * variance_), now_.spread, kept);
    }

    // Returns the probability of each section from what two chains say that come from both sides. Both count the prior
    // of section and centre.
    std::vector<float> both(const Belief& above, const Belief& below) {
        const Matrix a = inverse(above.spread), b = inverse(below.spread);
        const Float4Matrix A(a), B(b), G(inverse(plus(plus(a, b), round_matrix(1.0 / variance_), -1.0)));
        for (std::size_t i = 0; i < library_.count(); i += 4) {
            const Float4 x = four_at(&above.x[i]), y = four_at(&above.y[i]);
            const Float4 other_x = four_at(&below.x[i]), other_y = four_at(&below.y[i]);
            const Float4 ax = A.times_x(x, y), ay = A.times_y(x, y);
            const Float4 bx = B.times_x(other_x, other_y), by = B.times_y(other_x, other_y);
            const Float4 apart = x * ax + y * ay + other_x * bx + other_y * by -
                                 (ax + bx) * G.times_x(ax + bx, ay + by) - (ay + by) * G.times_y(ax + bx, ay + by);
            put(-0.5f * apart, &log_[i]);
        }
        std::vector<float> out(library_.count());
        for (std::size_t i = 0; i < library_.count(); i += 4)
            put(four_at(&above.likely[i]) * four_at(&below.likely[i]) / (four_at(&first_[i]) + least), &out[i]);
        multiply(out);
        return out;
    }

  private:
    static constexpr float least = 1e-30f;

    // Multiplies by the evidence whose log is log_: 1 for the section that fits best, to the power of the temper.
    void multiply(std::vector<float>& likely) {
        Float4 most = four(-std::numeric_limits<float>::max());
        for (std::size_t i = 0; i < library_.count(); i += 4)
            most = greater(four_at(&library_.weight[i]) > 0.0f ? four_at(&log_[i]) : most, most);
        const float greatest = std::max(std::max(most[0], most[1]), std::max(most[2], most[3]));
        for (std::size_t i = 0; i < library_.count(); i += 4) {
            const Float4 x = (four_at(&log_[i]) - greatest) * temper_;
            const Float4 within = x < 0.0f ? greater(x, four(-60.0f)) : four(0.0f);
            put(four_at(&likely[i]) * exponentials(within), &likely[i]);
        }
    }

    const Sections& library_;
    const Moves& moves_;
    Scales scales_;
    double variance_;
    float temper_;
    OfKinds prior_;
    std::vector<float> log_, first_;
    Belief now_;
};

void write_row(const std::vector<float>& likely, const Sections& library, std::size_t row, LikelyAlong& out) {
    OfKinds kinds{};
    double size = 0.0, square = 0.0, all_sized = 0.0;
    for (std::size_t kind = 0; kind < hole_kinds; ++kind) {
        Float4 of_kind = {}, of_all = {}, of_size = {}, of_square = {};
        for (std::size_t i = library.starts[kind]; i < library.starts[kind + 1]; i += 4) {
            const Float4 of = four_at(&likely[i]), without = of * four_at(&library.without_chance[i]),
                         sized = without * four_at(&library.size[i]);
            of_kind += of, of_all += without, of_size += sized, of_square += sized * four_at(&library.size[i]);
        }
        kinds[kind] = all_of(of_kind), all_sized += all_of(of_all);
        size += all_of(of_size), square += all_of(of_square);
    }
    const double all = sum_of(kinds);
    for (std::size_t kind = 0; kind < hole_kinds; ++kind) out.kinds[row * hole_kinds + kind] = kinds[kind] / all;
    out.size[row] = size / all_sized, out.size_square[row] = square / all_sized;
}

using Double2 = double __attribute__((vector_size(16)));

// Returns chi^2 of each window and each section, window by window; the centre of each window is its own. Eight sections
// are laid out part by part while all windows are compared with them, so that a vector holds two sections.
std::vector<double> compare_all(std::span<const Window> windows, std::span<const double> sections, std::size_t count,
                                double offset) {
    constexpr std::size_t pairs = at_once / 2;
    std::vector<double> squares(windows.size() * count);
    std::vector<Matrix> spreads;  // weight^2 times the covariance of the centre
    for (const Window& window : windows) {
        const Matrix spread = inverse(plus(window.centre, round_matrix(1.0 / (offset * offset))));
        spreads.push_back(plus({}, spread, window.weight * window.weight));
    }
    for (std::size_t first = 0; first < count; first += at_once) {
        Double2 eight[section_parts][pairs];
        const std::size_t some = std::min(at_once, count - first);
        for (std::size_t k = 0; k < at_once; ++k) {
            const double* section = &sections[(first + std::min(k, some - 1)) * section_parts];
            for (std::size_t part = 0; part < section_parts; ++part) eight[part][k / 2][k % 2] = section[part];
        }
        for (std::size_t row = 0; row < windows.size(); ++row) {
            const Window& window = windows[row];
            const Matrix& spread = spreads[row];
            Double2 square[pairs] = {}, x[pairs] = {}, y[pairs] = {};
            for (int i = 0; i < window.seen; ++i) {
                const Part& part = window.parts[static_cast<std::size_t>(i)];
                for (std::size_t k = 0; k < pairs; ++k) {
                    const Double2 off = part.length - eight[part.number][k];
                    square[k] += off * off, x[k] += part.of.cosine * off, y[k] += part.of.sine * off;
                }
            }
            for (std::size_t k = 0; k < some; ++k) {
                const Double2 explained = spread.xx * x[k / 2] * x[k / 2] + 2.0 * spread.xy * x[k / 2] * y[k / 2] +
                                          spread.yy * y[k / 2] * y[k / 2];
                const Double2 of = window.weight * square[k / 2] - explained;
                squares[row * count + first + k] = of[k % 2];
            }
        }
    }
    return squares;
}

// Adds the log of the mean evidence of each kind, of all scales, to within 1e-6. The greatest term is 1 at the best
// section.
void add_evidence(std::span<const double> squares, double best, double independent, const SectionLibrary& library,
                  const LikenessRule& rule, std::array<double, hole_kinds>& evidence) {
    constexpr double absent = -700.0, least = -690.0, negligible = -40.0;
    std::array<double, 4> terms{}, rates{};
    for (std::size_t i = 0; i < terms.size(); ++i) {
        const auto [scale, prior] = rule.scales[i];
        rates[i] = 0.5 / (scale * scale);
        terms[i] = logarithm(prior) - independent * logarithm(scale) - best * rates[i];
    }
    const double greatest = *std::ranges::max_element(terms);
    std::size_t start = 0;
    for (std::size_t kind = 0; kind < hole_kinds; ++kind) {
        const std::size_t stop = start + static_cast<std::size_t>(library.counts[kind]);
        const double nearest = start == stop ? 0.0 : *std::min_element(&squares[start], &squares[0] + stop);
        std::array<double, 4> at_nearest{};
        for (std::size_t i = 0; i < terms.size(); ++i)
            at_nearest[i] = terms[i] - greatest + (best - nearest) * rates[i];
        const double most = *std::ranges::max_element(at_nearest);
        double likely = 0.0, weights = 0.0;
        for (std::size_t row = start; row < stop; row += 4) {
            Float4 beyond{}, of{};
            for (std::size_t k = 0; k < 4; ++k)
                beyond[k] = static_cast<float>(squares[std::min(row + k, stop - 1)] - nearest);
            for (std::size_t i = 0; i < terms.size(); ++i) {
                if (at_nearest[i] - most < negligible) continue;
                const Float4 log = static_cast<float>(at_nearest[i] - most) - static_cast<float>(rates[i]) * beyond;
                const Float4 within = greater(log, four(-60.0f));
                of += log > static_cast<float>(negligible) ? exponentials(within) : four(0.0f);
            }
            for (std::size_t k = 0; k < std::min<std::size_t>(4, stop - row); ++k) {
                likely += weight_of(library, row + k) * static_cast<double>(of[k]);
                weights += weight_of(library, row + k);
            }
        }
        evidence[kind] += weights > 0.0 ? std::max(most + logarithm(likely / weights), least) : absent;
        start = stop;
    }
}

}  // namespace

LikelyAlong likely_along(std::span<const double> windows, double length, const SectionLibrary& library,
                         const ChainRule& rule, int threads) {
    const StandardArithmetic standard;
    require_threads(threads);
    const std::size_t rows = windows.size() / section_parts;
    require(windows.size() == rows * section_parts, "windows", static_cast<Index>(windows.size()),
            "must be 32 lengths for each window");
    require(std::isfinite(length) && length > 0.0, "length", length, "must be finite and above 0");
    require(rule.stays > 0.0 && rule.stays < 1.0, "stays", rule.stays, "must lie between 0 and 1");
    require(rule.changes >= 0.0 && rule.changes <= 1.0, "changes", rule.changes, "must lie in [0, 1]");
    require(rule.centre_stays > 0.0, "centre_stays", rule.centre_stays, "must be above 0");
    const Moves moves = moves_over(length, rule);
    const Sections sections = arranged(library);
    const std::size_t count = sections.count();
    std::vector<Window> seen;
    for (std::size_t row = 0; row < rows; ++row)
        seen.push_back(window_of(&windows[row * section_parts], rule.likeness));
    std::vector<float> numbers(rows * 3 * count);
    const auto sums = [&](std::size_t row) {
        float* const of = numbers.data() + row * 3 * count;
        return Sums{of, of + count, of + 2 * count};
    };
    for_each_range(threads, static_cast<Index>(rows), batch, [&](int, Range range) {
        for (std::size_t i = 0; i < count; i += at_once)
            for (auto row = static_cast<std::size_t>(range.start); row < static_cast<std::size_t>(range.stop); ++row) {
                const Sums of = sums(row);
                compare(seen[row], &sections.of[i * section_parts], {of.q + i, of.x + i, of.y + i});
            }
    });
    std::vector<Belief> above;
    Chain down(sections, rule, moves), up(sections, rule, moves);
    for (std::size_t row = 0; row < rows; ++row) {
        if (row > 0) down.move();
        down.take(seen[row], sums(row));
        above.push_back(down.now());
    }
    LikelyAlong out{std::vector<double>(rows * hole_kinds), std::vector<double>(rows), std::vector<double>(rows)};
    for (std::size_t row = rows; row-- > 0;) {
        write_row(down.both(above[row], up.now()), sections, row, out);
        up.take(seen[row], sums(row));
        up.move();
    }
    return out;
}

LikelyKind likely_kind(std::span<const double> sections, const SectionLibrary& library, const ZoneRule& rule) {
    const StandardArithmetic standard;
    const std::size_t rows = sections.size() / section_parts, count = checked_count(library);
    require(rows > 0 && sections.size() == rows * section_parts, "sections", static_cast<Index>(sections.size()),
            "must be 32 lengths for each of one or more sections");
    std::array<double, hole_kinds> evidence{};
    double of_gauge = 0.0, of_any = 0.0, own = 0.0;
    Index seen = 0;
    std::vector<Window> windows;
    for (std::size_t row = 0; row < rows; ++row)
        windows.push_back(window_of(&sections[row * section_parts], rule.likeness));
    const std::vector<double> all_squares = compare_all(windows, library.sections, count, rule.likeness.offset);
    for (std::size_t row = 0; row < rows; ++row) {
        const Window& window = windows[row];
        const std::span<const double> squares = std::span(all_squares).subspan(row * count, count);
        for (int i = 0; i < window.seen; ++i) {
            const double length = window.parts[static_cast<std::size_t>(i)].length;
            own += length * length;
        }
        seen += window.seen;
        const auto gauge = squares.begin() + library.counts[0];
        const double best = *std::ranges::min_element(squares), counted = std::max(window.independent, 1.0);
        of_any += best / counted / static_cast<double>(rows);
        of_gauge += gauge == squares.begin()
                        ? std::numeric_limits<double>::infinity()
                        : *std::min_element(squares.begin(), gauge) / counted / static_cast<double>(rows);
        add_evidence(squares, best, window.independent, library, rule.likeness, evidence);
    }
    std::array<double, hole_kinds> total{};
    for (std::size_t kind = 0; kind < hole_kinds; ++kind)
        total[kind] = logarithm(rule.prior[kind]) + evidence[kind] / static_cast<double>(rows);
    const double explained = rule.explained * rule.explained;
    if (of_gauge > explained) total[0] = -std::numeric_limits<double>::infinity();
    const double most = *std::ranges::max_element(total);
    LikelyKind out;
    for (std::size_t kind = 0; kind < hole_kinds; ++kind) out.kinds[kind] = exponential(total[kind] - most);
    const double all = sum_of(out.kinds);
    for (double& kind : out.kinds) kind /= all;
    own /= static_cast<double>(std::max(seen, Index{1})) * rule.likeness.rough * rule.likeness.rough;
    out.sound = of_any <= std::max(explained, rule.resembles * rule.resembles * own);
    return out;
}

}  // namespace helibore
