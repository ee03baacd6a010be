// Turns are gathered into windows; the chain runs over blocks of them.
#include <algorithm>
#include <cmath>
#include <limits>

#include "base/arithmetic.hpp"
#include "base/messages.hpp"
#include "base/trigonometry.hpp"
#include "helibore/kinds.hpp"

namespace helibore {

namespace {

constexpr double lengths[] = {0.1, 0.3, 0.5};  // of windows, metres: the first whose windows see enough parts
constexpr std::size_t enough = 14;             // parts that a window sees, in the mean
constexpr std::size_t about = 2;               // windows on each side that count among those that samples see
constexpr double infinite = std::numeric_limits<double>::infinity();
constexpr std::size_t block = 200, beside = 20;  // windows at once, and how many beside them count

struct Windows {
    std::size_t turns = 1;         // of one window
    std::vector<double> sections;  // mean of each part; NaN where no sample lies
    std::vector<Index> seen;       // parts that samples see

    std::size_t count() const { return seen.size(); }
};

Windows windows_of(std::span<const double> sections, std::size_t turns, double length, double height) {
    const double most = static_cast<double>(std::max<std::size_t>(turns, 1));
    Windows out;
    out.turns = static_cast<std::size_t>(nearest_whole(std::clamp(length / height, 1.0, most)));
    const std::size_t count = (turns + out.turns - 1) / out.turns;
    out.sections.resize(count * section_parts), out.seen.resize(count);
    std::vector<double> samples(out.sections.size());
    for (std::size_t turn = 0; turn < turns; ++turn)
        for (std::size_t part = 0; part < section_parts; ++part) {
            const double of = sections[turn * section_parts + part];
            if (std::isnan(of)) continue;
            const std::size_t place = turn / out.turns * section_parts + part;
            out.sections[place] += of, samples[place] += 1.0;
        }
    for (std::size_t place = 0; place < samples.size(); ++place) {
        out.seen[place / section_parts] += samples[place] > 0.0 ? 1 : 0;
        out.sections[place] /= samples[place];  // 0 / 0 is NaN
    }
    return out;
}

// Returns how many parts of each window samples see, or lie beside one that they see; at most the mean of the windows
// about it, rounded down: a sensor that turns slowly sees two parts where it passes a border between them.
std::vector<Index> near_samples(const Windows& windows) {
    std::vector<Index> near(windows.count()), least(windows.count());
    for (std::size_t i = 0; i < near.size(); ++i) {
        const std::span<const double> of = std::span(windows.sections).subspan(i * section_parts, section_parts);
        const auto sees = [&](std::size_t part) { return !std::isnan(of[part % section_parts]); };
        for (std::size_t part = 0; part < section_parts; ++part)
            near[i] += sees(part) || sees(part + 1) || sees(part + section_parts - 1) ? 1 : 0;
    }
    for (std::size_t i = 0; i < near.size(); ++i) {
        const std::size_t low = i - std::min(i, about), high = std::min(i + about + 1, near.size());
        Index sum = 0;
        for (std::size_t other = low; other < high; ++other) sum += near[other];
        least[i] = std::min(near[i], sum / static_cast<Index>(high - low));
    }
    return least;
}

Windows gathered(std::span<const double> sections, std::size_t turns, double height) {
    Windows out;
    for (const double length : lengths) {
        out = windows_of(sections, turns, length, height);
        Index seen = 0;
        for (const Index of : out.seen) seen += of;
        if (seen >= static_cast<Index>(enough * out.count())) break;
    }
    return out;
}

// Returns which windows have a turn that is wanted within `reach` windows.
std::vector<bool> near_wanted(std::span<const double> wanted, const Windows& windows, std::size_t reach) {
    std::vector<bool> near(windows.count());
    for (std::size_t turn = 0; turn < wanted.size(); ++turn) {
        if (wanted[turn] == 0.0) continue;
        const std::size_t at = turn / windows.turns;
        for (std::size_t i = at - std::min(at, reach); i <= std::min(at + reach, near.size() - 1); ++i) near[i] = true;
    }
    return near;
}

// Returns which windows have a mean radius from the least to the greatest of the library, give or take `rough`. Beyond,
// the size of its sections says nothing of the hole. A window without samples is as the one before.
std::vector<bool> like_library(const Windows& windows, const SectionLibrary& library, double rough) {
    double least = infinite, greatest = -infinite;
    for (const double of : library.sections) least = std::min(least, of), greatest = std::max(greatest, of);
    std::vector<bool> like(windows.count());
    bool before = true;
    for (std::size_t i = 0; i < like.size(); ++i) {
        double sum = 0.0;
        for (const double of : std::span(windows.sections).subspan(i * section_parts, section_parts))
            sum += std::isnan(of) ? 0.0 : of;
        const auto parts = static_cast<double>(windows.seen[i]);
        if (parts > 0.0) before = (least - rough) * parts <= sum && sum <= (greatest + rough) * parts;
        like[i] = before;
    }
    return like;
}

double mean_of(std::span<const double> values) {
    double sum = 0.0;
    for (const double value : values) sum += value;
    return values.empty() ? 0.0 : sum / static_cast<double>(values.size());
}

}  // namespace

KindsAlong kinds_along(std::span<const double> sections, double height, std::span<const double> wanted,
                       const SectionLibrary& library, const ChainRule& rule, int threads) {
    const StandardArithmetic standard;
    const std::size_t turns = wanted.size();
    require_length("sections", sections.size(), section_parts * turns, "32 times wanted");
    require(std::isfinite(height) && height > 0.0, "height", height, "must be finite and above 0");
    const Windows windows = gathered(sections, turns, height);
    const double middle = mean_of(library.size);  // the chain has floats: those near 0 are finer
    std::vector<double> centred(library.size.begin(), library.size.end());
    for (double& size : centred) size -= middle;
    SectionLibrary compared = library;
    compared.size = centred;

    constexpr double none = std::numeric_limits<double>::quiet_NaN();
    KindsAlong out{std::vector<double>(turns * hole_kinds, none), std::vector<double>(turns, none),
                   std::vector<double>(turns, none), std::vector<Index>(turns)};
    const std::vector<Index> seen = near_samples(windows);
    for (std::size_t turn = 0; turn < turns; ++turn) out.seen[turn] = seen[turn / windows.turns];
    const std::vector<bool> like = like_library(windows, library, rule.likeness.rough);
    const std::vector<bool> needed = near_wanted(wanted, windows, 0), near = near_wanted(wanted, windows, beside);
    for (std::size_t start = 0, stop = 0; start < windows.count(); start = std::max(stop, start + 1)) {
        if (!near[start]) continue;
        for (stop = start; stop < windows.count() && near[stop] && stop < start + block;) ++stop;
        const std::size_t low = start - std::min(start, beside), high = std::min(stop + beside, windows.count());
        const std::span<const double> some =
            std::span(windows.sections).subspan(low * section_parts, (high - low) * section_parts);
        const LikelyAlong likely =
            likely_along(some, static_cast<double>(windows.turns) * height, compared, rule, threads);
        for (std::size_t turn = start * windows.turns; turn < std::min(stop * windows.turns, turns); ++turn) {
            if (!needed[turn / windows.turns]) continue;
            const std::size_t row = turn / windows.turns - low;
            std::copy_n(&likely.kinds[row * hole_kinds], hole_kinds, &out.kinds[turn * hole_kinds]);
            if (!like[turn / windows.turns]) continue;
            out.size[turn] = middle + likely.size[row];
            out.size_sigma[turn] =
                std::sqrt(std::max(likely.size_square[row] - likely.size[row] * likely.size[row], 0.0));
        }
    }
    return out;
}

}  // namespace helibore
