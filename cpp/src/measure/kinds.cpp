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
    std::vector<float> of, size, weight;               // weight: 0 for what fills up an eight
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
    if (library.weight.empty()) return library.size.size();
    require_length("weight", library.weight.size(), library.size.size(), "counts");
    for (std::size_t i = 0; i < library.weight.size(); ++i)
        if (!(std::isfinite(library.weight[i]) && library.weight[i] > 0.0))
            throw entry_error("weight", static_cast<Index>(i), library.weight[i], "must be finite and above 0");
    return library.size.size();
}

double weight_of(const SectionLibrary& library, std::size_t row) {
    return library.weight.empty() ? 1.0 : library.weight[row];
}

Sections arranged(const SectionLibrary& library) {
    checked_count(library);
    Sections out;
    std::size_t row = 0;
    for (std::size_t kind = 0; kind < hole_kinds; ++kind) {
        const auto number = static_cast<std::size_t>(library.counts[kind]);
        const std::size_t start = out.starts[kind], stop = start + (number + at_once - 1) / at_once * at_once;
        out.starts[kind + 1] = stop;
        out.size.resize(stop), out.weight.resize(stop), out.of.resize(stop * section_parts);
        double all = 0.0;
        for (std::size_t place = start; place < start + number; ++place, ++row) {
            out.size[place] = static_cast<float>(library.size[row]);
            out.weight[place] = static_cast<float>(weight_of(library, row));
            all += weight_of(library, row);
            float* const eight = &out.of[place / at_once * at_once * section_parts];
            for (std::size_t part = 0; part < section_parts; ++part)
                eight[part * at_once + place % at_once] =
                    static_cast<float>(library.sections[row * section_parts + part]);
        }
        out.each[kind] = number > 0 ? static_cast<float>(1.0 / all) : 0.0f;
    }
    return out;
}

// What a window sees: the parts with samples, and the three linear forms of their differences from a section,
//     chi^2 = w sum t^2 - (sum u t)^2 - (sum v t)^2
// The last two are what the tool's offset explains.
template <class Real>
struct WindowOf {
    int seen = 0;
    Real weight{}, independent{};
    struct Part {
        std::uint32_t number;
        Real length, u, v;
    } parts[section_parts];
};
using Window = WindowOf<float>;

template <class Real>
WindowOf<Real> window_of(const double* section, const LikenessRule& rule) {
    WindowOf<Real> out;
    for (std::size_t part = 0; part < section_parts; ++part) out.seen += std::isnan(section[part]) ? 0 : 1;
    if (out.seen == 0) return out;
    const double independent = std::min(static_cast<double>(out.seen), rule.effective);
    const double weight = independent / out.seen / (rule.rough * rule.rough);
    double xx = 1.0 / (rule.offset * rule.offset), yy = xx, xy = 0.0;
    int at = 0;
    for (std::size_t part = 0; part < section_parts; ++part) {
        if (std::isnan(section[part])) continue;
        const SineCosine of = sine_cosine(static_cast<double>(part) * 360.0 / section_parts);
        xx += weight * of.cosine * of.cosine, yy += weight * of.sine * of.sine, xy += weight * of.cosine * of.sine;
    }
    const double along = 1.0 / std::sqrt(xx), turned = xy / xx, across = 1.0 / std::sqrt(yy - xy * turned);
    for (std::size_t part = 0; part < section_parts; ++part) {
        if (std::isnan(section[part])) continue;
        const SineCosine of = sine_cosine(static_cast<double>(part) * 360.0 / section_parts);
        out.parts[at++] = {static_cast<std::uint32_t>(part), static_cast<Real>(std::clamp(section[part], -1e6, 1e6)),
                           static_cast<Real>(weight * of.cosine * along),
                           static_cast<Real>(weight * (of.sine - turned * of.cosine) * across)};
    }
    out.weight = static_cast<Real>(weight), out.independent = static_cast<Real>(independent);
    return out;
}

// Writes the log of the evidence that a window gives for eight sections: the greatest among the scales.
inline void compare(const Window& window, const Scales& scales, const float* eight, float* log_evidence) {
    Float4 square[2] = {}, u[2] = {}, v[2] = {};
    for (int i = 0; i < window.seen; ++i) {
        const Window::Part& part = window.parts[i];
        for (const std::size_t half : {0U, 1U}) {
            const Float4 off = part.length - four_at(eight + part.number * at_once + 4 * half);
            square[half] += off * off, u[half] += part.u * off, v[half] += part.v * off;
        }
    }
    for (const std::size_t half : {0U, 1U}) {
        const Float4 least = window.weight * square[half] - u[half] * u[half] - v[half] * v[half];
        Float4 greatest = four(-std::numeric_limits<float>::max());
        for (const Scale& scale : scales)
            greatest = greater(
                scale.log_prior - window.independent * scale.log_scale - scale.half_inverse_square * least, greatest);
        put(greatest, log_evidence + 4 * half);
    }
}

// Makes the logs of a row the evidence: 1 for the section that fits best, to the power `temper`.
void temper_row(float* row, const Sections& library, float temper) {
    Float4 most = four(-std::numeric_limits<float>::max());
    for (std::size_t i = 0; i < library.count(); i += 4)
        most = greater(four_at(&library.weight[i]) > 0.0f ? four_at(row + i) : most, most);
    const float greatest = std::max(std::max(most[0], most[1]), std::max(most[2], most[3]));
    for (std::size_t i = 0; i < library.count(); i += 4) {
        const Float4 x = (four_at(row + i) - greatest) * temper;
        const Float4 within = x < 0.0f ? greater(x, four(-60.0f)) : four(0.0f);
        put(four_at(&library.weight[i]) > 0.0f ? exponentials(within) : four(0.0f), row + i);
    }
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

// From one window to the next: probability that the section stays, changes within its kind, or becomes any.
struct Moves {
    double stays, changes, leaves;
    OfKinds prior;
};

Moves moves_over(double length, const ChainRule& rule) {
    const double stays = exponential(length * logarithm(rule.stays)), changes = (1.0 - stays) * rule.changes;
    return {stays, changes, 1.0 - stays - changes, rule.prior};
}

// Multiplies each row by the probability of its sections given the rows before: F = evidence (stays F' + what moves).
// The sum of a row is not 1: the next row divides by it.
void go_forward(std::vector<float>& forward, std::size_t rows, const Sections& library, const Moves& rule) {
    OfKinds sums{};
    for (std::size_t row = 0; row < rows; ++row) {
        float* const now = &forward[row * library.count()];
        const float* const before = now - library.count();
        const double all = sum_of(sums);
        const auto stays = static_cast<float>(row > 0 ? rule.stays / all : 0.0);
        for (std::size_t kind = 0; kind < hole_kinds; ++kind) {
            const double moves =
                row > 0 ? rule.changes * sums[kind] / all + rule.leaves * rule.prior[kind] : rule.prior[kind];
            const auto moved = static_cast<float>(moves * static_cast<double>(library.each[kind]));
            Float4 sum = {};
            for (std::size_t i = library.starts[kind]; i < library.starts[kind + 1]; i += 4) {
                const Float4 entering = moved * four_at(&library.weight[i]);
                const Float4 from = row > 0 ? stays * four_at(before + i) + entering : entering;
                const Float4 of = four_at(now + i) * from;
                put(of, now + i);
                sum += of;
            }
            sums[kind] = all_of(sum);
        }
    }
}

// Goes back from the last row, and writes what is likely in each.
void go_back(const std::vector<float>& evidence, const std::vector<float>& forward, std::size_t rows,
             const Sections& library, const Moves& rule, LikelyAlong& out) {
    std::vector<float> after(library.count(), 1.0f);
    for (std::size_t row = rows; row-- > 0;) {
        const float *const now = &forward[row * library.count()], *const given = &evidence[row * library.count()];
        OfKinds likely{}, beyond{};
        double size = 0.0, square = 0.0;
        for (std::size_t kind = 0; kind < hole_kinds; ++kind) {
            Float4 of_kind = {}, of_size = {}, of_square = {}, of_after = {};
            for (std::size_t i = library.starts[kind]; i < library.starts[kind + 1]; i += 4) {
                const Float4 later = four_at(&after[i]), both = four_at(now + i) * later;
                const Float4 sized = both * four_at(&library.size[i]), next = later * four_at(given + i);
                of_kind += both, of_size += sized, of_square += sized * four_at(&library.size[i]);
                of_after += next * four_at(&library.weight[i]);
                put(next, &after[i]);
            }
            likely[kind] = all_of(of_kind), beyond[kind] = all_of(of_after);
            size += all_of(of_size), square += all_of(of_square);
        }
        const double all = sum_of(likely);
        for (std::size_t kind = 0; kind < hole_kinds; ++kind) out.kinds[row * hole_kinds + kind] = likely[kind] / all;
        out.size[row] = size / all, out.size_square[row] = square / all;
        double from_any = 0.0;
        for (std::size_t kind = 0; kind < hole_kinds; ++kind)
            from_any += rule.prior[kind] * static_cast<double>(library.each[kind]) * beyond[kind];
        const double scale = sum_of(beyond);
        const auto stays = static_cast<float>(rule.stays / scale);
        for (std::size_t kind = 0; kind < hole_kinds; ++kind) {
            const double moves =
                rule.changes * static_cast<double>(library.each[kind]) * beyond[kind] + rule.leaves * from_any;
            const auto moved = static_cast<float>(moves / scale);
            for (std::size_t i = library.starts[kind]; i < library.starts[kind + 1]; i += 4)
                put(stays * four_at(&after[i]) + moved, &after[i]);
        }
    }
}

using Double2 = double __attribute__((vector_size(16)));

// Returns chi^2 of each window and each section, window by window. Eight sections are laid out part by part while all
// windows are compared with them, so that a vector holds two sections.
std::vector<double> compare_all(std::span<const WindowOf<double>> windows, std::span<const double> sections,
                                std::size_t count) {
    constexpr std::size_t pairs = at_once / 2;
    std::vector<double> squares(windows.size() * count);
    for (std::size_t first = 0; first < count; first += at_once) {
        Double2 eight[section_parts][pairs];
        const std::size_t some = std::min(at_once, count - first);
        for (std::size_t k = 0; k < at_once; ++k) {
            const double* section = &sections[(first + std::min(k, some - 1)) * section_parts];
            for (std::size_t part = 0; part < section_parts; ++part) eight[part][k / 2][k % 2] = section[part];
        }
        for (std::size_t row = 0; row < windows.size(); ++row) {
            const WindowOf<double>& window = windows[row];
            Double2 square[pairs] = {}, u[pairs] = {}, v[pairs] = {};
            for (int i = 0; i < window.seen; ++i) {
                const WindowOf<double>::Part& part = window.parts[i];
                for (std::size_t k = 0; k < pairs; ++k) {
                    const Double2 off = part.length - eight[part.number][k];
                    square[k] += off * off, u[k] += part.u * off, v[k] += part.v * off;
                }
            }
            for (std::size_t k = 0; k < some; ++k) {
                const Double2 of = window.weight * square[k / 2] - u[k / 2] * u[k / 2] - v[k / 2] * v[k / 2];
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
    const Moves moves = moves_over(length, rule);
    const Sections sections = arranged(library);
    const Scales scales = scales_of(rule.likeness);
    std::vector<float> evidence(rows * sections.count());
    const auto temper = static_cast<float>(rule.temper);
    for_each_range(threads, static_cast<Index>(rows), batch, [&](int, Range range) {
        std::vector<Window> some;
        for (Index row = range.start; row < range.stop; ++row)
            some.push_back(window_of<float>(&windows[static_cast<std::size_t>(row) * section_parts], rule.likeness));
        for (std::size_t i = 0; i < sections.count(); i += at_once)
            for (Index row = range.start; row < range.stop; ++row)
                compare(some[static_cast<std::size_t>(row - range.start)], scales, &sections.of[i * section_parts],
                        &evidence[static_cast<std::size_t>(row) * sections.count() + i]);
        for (Index row = range.start; row < range.stop; ++row)
            temper_row(&evidence[static_cast<std::size_t>(row) * sections.count()], sections, temper);
    });
    std::vector<float> forward = evidence;
    go_forward(forward, rows, sections, moves);
    LikelyAlong out{std::vector<double>(rows * hole_kinds), std::vector<double>(rows), std::vector<double>(rows)};
    go_back(evidence, forward, rows, sections, moves, out);
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
    std::vector<WindowOf<double>> windows;
    for (std::size_t row = 0; row < rows; ++row)
        windows.push_back(window_of<double>(&sections[row * section_parts], rule.likeness));
    const std::vector<double> all_squares = compare_all(windows, library.sections, count);
    for (std::size_t row = 0; row < rows; ++row) {
        const WindowOf<double>& window = windows[row];
        const std::span<const double> squares = std::span(all_squares).subspan(row * count, count);
        for (int i = 0; i < window.seen; ++i) own += window.parts[i].length * window.parts[i].length;
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
