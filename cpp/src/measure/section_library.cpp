// The library of sections. Lengths are those of a hole of 8.5 in, scaled to the bit.
#include <algorithm>
#include <array>
#include <atomic>
#include <cmath>
#include <initializer_list>
#include <memory>

#include "base/arithmetic.hpp"
#include "base/degrees.hpp"
#include "base/messages.hpp"
#include "helibore/kinds.hpp"

namespace helibore {

namespace {

constexpr std::size_t fine = 6 * section_parts;        // toolfaces at which a section is drawn
constexpr double inch = 25.4, usual_bit = 8.5 * inch;  // millimetres
constexpr double lobed_gauge = 0.01;                   // chance of a lobed section that is gauge; others have 1

using Drawn = std::array<double, fine>;  // radius less half the bit diameter

struct Shape {
    Drawn length;
    double lower, higher;  // heights of its lobes
    bool round;
};

double degrees_of(std::size_t i) {
    return static_cast<double>(i) * 360.0 / fine;
}

// Returns a section whose length at each toolface is length(degrees), millimetres.
template <class Length>
Shape drawn(double lower, double higher, const Length& length) {
    Shape out{{}, lower, higher, false};
    for (std::size_t i = 0; i < fine; ++i) out.length[i] = length(degrees_of(i));
    return out;
}

void add_waves(std::vector<Shape>& shapes) {
    const auto oval = [&](double size, double half) {
        shapes.push_back(
            drawn(0.0, 0.0, [=](double degrees) { return size + half * sine_cosine(2.0 * degrees).cosine; }));
    };
    for (const double size : {0.0, 2.0})
        for (const double half : {1.5, 3.0, 4.5}) oval(size, half);
    for (const double size : {-8.0, -5.0}) oval(size, 2.0);
    for (const double size : {9.0, 14.0, 21.0, 30.0})
        for (const double waves : {2.0, 3.0})
            for (const double share : {0.15, 0.3})
                shapes.push_back(drawn(0.0, 0.0, [=](double degrees) {
                    return size * (1.0 + share * sine_cosine(waves * degrees).cosine);
                }));
}

// Returns how high a lobe about toolface 0 is at an angle, as a share of its height.
double lobe(double degrees, double wide, bool smooth) {
    const double away = std::abs(wrap_difference(degrees));
    if (!smooth) return std::clamp(2.2 * (1.0 - away / wide), 0.0, 1.0);
    const double cosine = sine_cosine(std::min(90.0 * away / wide, 90.0)).cosine;
    return cosine * cosine;
}

void add_lobes(std::vector<Shape>& shapes) {
    for (const double wide : {30.0, 45.0, 65.0})
        for (const bool smooth : {true, false})
            for (const double base : {0.0, 1.5}) {
                const auto add = [&](double high, double share) {
                    shapes.push_back(drawn(share * high, high, [=](double degrees) {
                        return base +
                               high * (lobe(degrees, wide, smooth) + share * lobe(degrees + 180.0, wide, smooth));
                    }));
                };
                for (const double high : {5.0, 9.0, 14.0, 19.0, 26.0, 35.0})
                    for (const double share : {0.65, 1.0}) add(high, share);
                for (const double high : {3.5, 5.0, 8.0, 12.0, 18.0, 26.0, 36.0, 47.0, 58.0, 70.0}) add(high, 0.0);
            }
}

void add_slots(std::vector<Shape>& shapes) {
    constexpr double bit = 0.5 * usual_bit;
    for (const double pipe : {1.75 * inch, 2.5 * inch, 3.25 * inch})
        for (const double deep : {5.0, 9.0, 14.0, 20.0, 28.0, 38.0, 48.0, 58.0, 70.0})
            shapes.push_back(drawn(0.0, deep, [=](double degrees) {
                const SineCosine of = sine_cosine(degrees);
                const double centre = bit + deep - pipe, aside = centre * of.sine, left = pipe * pipe - aside * aside;
                if (left <= 0.0 || of.cosine <= 0.0) return 0.0;
                return std::max(centre * of.cosine + std::sqrt(left) - bit, 0.0);
            }));
}

std::vector<Shape> all_shapes(double scale) {
    std::vector<Shape> shapes;
    for (const double size :
         {-11.0, -8.0, -6.0, -4.5, -2.5, -1.2, 0.0, 1.2, 2.5, 4.0, 8.0, 11.0, 15.0, 20.0, 27.0, 36.0, 48.0}) {
        shapes.push_back(drawn(0.0, 0.0, [=](double) { return size; }));
        shapes.back().round = true;
    }
    add_waves(shapes), add_lobes(shapes), add_slots(shapes);
    for (Shape& shape : shapes) {
        for (double& of : shape.length) of *= scale;
        shape.lower *= scale, shape.higher *= scale;
    }
    return shapes;
}

// Returns the kind of a section, as the criteria decide the kind of a turn. `even`: both sides are as high, since a
// diameter does not show on which side a hole is wide.
std::size_t kind_of(const Shape& shape, double bit_diameter, const KindCriteria& criteria, bool even) {
    std::array<double, fine / 2> diameter{};
    for (std::size_t i = 0; i < diameter.size(); ++i)
        diameter[i] = bit_diameter + shape.length[i] + shape.length[i + fine / 2];
    const auto largest = static_cast<std::size_t>(std::ranges::max_element(diameter) - diameter.begin());
    const double c1 = diameter[largest], c2 = diameter[(largest + fine / 4) % (fine / 2)];
    if (*std::ranges::min_element(diameter) < bit_diameter - criteria.undergauge) return 4;
    if (c2 - bit_diameter >= criteria.washout) return 1;
    const double all = shape.lower + shape.higher, lower = even ? all / 2.0 : shape.lower;
    const bool both = lower > 0.0 && 2.0 * lower >= criteria.symmetry * all;
    if (!both && shape.higher >= criteria.key_seat) return 3;
    return both && c1 - c2 >= criteria.elongation ? 2 : 0;
}

using Parts = std::array<double, section_parts>;

// Returns the mean of a section in each part of the turn; `even`: of it and of its opposite.
Parts parts_of(const Drawn& length, bool even) {
    Parts mean{};
    for (std::size_t i = 0; i < fine; ++i)
        mean[(i * section_parts + fine / 2) / fine % section_parts] += length[i] * section_parts / fine;
    if (!even) return mean;
    Parts out{};
    for (std::size_t part = 0; part < section_parts; ++part)
        out[part] = (mean[part] + mean[(part + section_parts / 2) % section_parts]) / 2.0;
    return out;
}

}  // namespace

DrawnSections section_library(double bit_diameter, const KindCriteria& criteria, bool even) {
    const StandardArithmetic standard;
    require(std::isfinite(bit_diameter) && bit_diameter > 0.0, "bit_diameter", bit_diameter,
            "must be finite and above 0");
    const std::vector<Shape> shapes = all_shapes(1e-3 * bit_diameter / (1e-3 * usual_bit));
    DrawnSections out;
    for (std::size_t kind = 0; kind < hole_kinds; ++kind)
        for (const Shape& shape : shapes) {
            if (kind_of(shape, bit_diameter, criteria, even) != kind) continue;
            const Parts parts = parts_of(shape.length, even);
            double square = 0.0;
            for (const double of : shape.length) square += (bit_diameter / 2.0 + of) * (bit_diameter / 2.0 + of);
            const bool twice =
                std::equal(parts.begin(), parts.begin() + section_parts / 2, parts.begin() + section_parts / 2);
            const std::size_t directions = shape.round ? 1 : twice ? section_parts / 2 : section_parts;
            for (std::size_t turn = 0; turn < directions; ++turn) {
                for (std::size_t part = 0; part < section_parts; ++part)
                    out.sections.push_back(parts[(part + section_parts - turn) % section_parts]);
                out.size.push_back(square / fine);
                out.weight.push_back(twice && !shape.round ? 2.0 : 1.0);
                const double all_directions = shape.round ? static_cast<double>(section_parts) : 1.0;
                out.chance.push_back(kind == 0 && shape.higher > 0.0 ? lobed_gauge : all_directions);
            }
            out.counts[kind] += static_cast<Index>(directions);
        }
    return out;
}

// Without a lock, so that a process that is forked meanwhile finds none held. Two threads may draw the same library;
// the first one counts.
struct SectionLibraries::Kept {
    double bit_diameter;
    KindCriteria criteria;
    std::array<std::atomic<const DrawnSections*>, 2> drawn{};

    Kept(double bit, const KindCriteria& of) : bit_diameter(bit), criteria(of) {}
    Kept(const Kept&) = delete;
    Kept& operator=(const Kept&) = delete;
    ~Kept() {
        for (const auto& of : drawn) delete of.load();
    }
};

SectionLibraries::SectionLibraries(double bit_diameter, const KindCriteria& criteria)
    : kept_(std::make_shared<Kept>(bit_diameter, criteria)) {}

SectionLibrary SectionLibraries::of(bool even) const {
    std::atomic<const DrawnSections*>& place = kept_->drawn[even ? 1 : 0];
    const DrawnSections* found = place;
    if (!found) {
        auto own = std::make_unique<const DrawnSections>(section_library(kept_->bit_diameter, kept_->criteria, even));
        if (place.compare_exchange_strong(found, own.get())) found = own.release();
    }
    return found->library();
}

}  // namespace helibore
