// Paths: a survey is refused exactly if it breaks a rule; positions, tangents and frames agree with each other.
// Stations that come one by one, in any order, give the bits of the survey. A longer survey does not change the bits
// above.
#include "helibore/path.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "input.hpp"

using helibore::Path;
using helibore::Survey;
using helibore::Vector3;

namespace {

double dot(const Vector3& a, const Vector3& b) {
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

struct Columns {
    std::vector<double> depth, inclination, azimuth;
    std::optional<Survey> survey(std::size_t count) const {
        std::optional<Survey> made;
        refused([&] {
            made.emplace(std::span(depth).first(count), std::span(inclination).first(count),
                         std::span(azimuth).first(count));
        });
        return made;
    }
};

bool follows_rules(const Columns& c) {
    bool good = c.depth.size() >= 2;
    for (std::size_t i = 0; i < c.depth.size(); ++i)
        good = good && std::abs(c.depth[i]) <= 1e7 && c.inclination[i] >= 0.0 && c.inclination[i] <= 180.0 &&
               std::abs(c.azimuth[i]) <= 360.0 && (i == 0 || c.depth[i] - c.depth[i - 1] >= 1e-6);
    return good;
}

// Positions and tangents between two depths of a path: an arc is no shorter than its chord.
void require_geometry(const Path& path, const std::vector<double>& depth) {
    const std::vector<Vector3> position = path.position(depth), tangent = path.tangent(depth);
    for (std::size_t i = 0; i < depth.size(); ++i) {
        require_rule(std::abs(dot(tangent[i], tangent[i]) - 1.0) < 1e-9, "a tangent has length 1");
        if (i == 0) continue;
        const Vector3 &a = position[i - 1], &b = position[i];
        const double chord = std::hypot(b[0] - a[0], b[1] - a[1], b[2] - a[2]), along = depth[i] - depth[i - 1];
        const double rounding = 1e-15 * (std::abs(a[0]) + std::abs(a[1]) + std::abs(a[2]));  // of a head far away
        require_rule(chord <= along * (1.0 + 1e-9) + 1e-6 + rounding, "a chord is no longer than the path");
    }
    std::vector<helibore::Frame> frames;
    if (refused([&] { frames = path.frame(depth); })) {
        require_rule(path.reference() != helibore::Reference::parallel_transport, "parallel transport is everywhere");
        return;
    }
    for (const helibore::Frame& f : frames)
        for (std::size_t x = 0; x < 3; ++x)
            for (std::size_t y = 0; y < 3; ++y)
                require_rule(std::abs(dot(f[x], f[y]) - (x == y ? 1.0 : 0.0)) < 1e-8, "a frame has right angles");
}

}  // namespace

void fuzz(Input input) {
    helibore::PathSettings settings;
    settings.method = input.one_of({helibore::Method::minimum_curvature, helibore::Method::radius_of_curvature});
    settings.reference = input.one_of(
        {helibore::Reference::high_side, helibore::Reference::north, helibore::Reference::parallel_transport});
    settings.extend = input.mostly_of({0.0, 50.0});
    settings.head[0] = input.mostly_of({0.0, 1e6});
    Columns c;
    double depth = input.mostly_of({0.0, 1000.0, -1e7, 9.99e6});
    for (std::size_t n = input.below(14); n > 0; --n) {
        c.depth.push_back(depth);
        c.inclination.push_back(
            input.mostly(input.one_in(2) ? 180.0 * input.share() : input.one_of({0.0, 90.0, 180.0, 1e-9})));
        c.azimuth.push_back(input.mostly(input.one_in(2) ? 720.0 * input.share() - 360.0
                                                         : input.one_of({0.0, 180.0, 360.0, -90.0, 1e-12})));
        depth += input.mostly_of({30.0, 1.0, 1e-6, 1e-7, 500.0, 0.3});
    }
    const std::size_t count = c.depth.size();
    const std::optional<Survey> survey = c.survey(count);
    require_rule(survey.has_value() == follows_rules(c), "a survey is refused exactly if it breaks a rule");
    if (!survey) return;
    for (const double dogleg : survey->dogleg()) require_rule(dogleg >= 0.0 && dogleg <= 180.0 + 1e-9, "doglegs");
    std::optional<Path> path;
    if (refused([&] { path.emplace(*survey, settings); })) return;
    const std::vector<double> hostile = {input.hostile()};
    refused([&] { path->position(hostile), path->frame(hostile); });
    std::vector<double> at = c.depth;
    for (int i = 0; i < 20; ++i) at.push_back(c.depth[0] + input.share() * (c.depth[count - 1] - c.depth[0]));
    at.push_back(path->stop_depth());
    std::ranges::sort(at);
    require_geometry(*path, at);
    for (std::size_t i = 0; i < count; ++i) {
        const double d = std::numbers::pi / 180.0, I = c.inclination[i] * d, A = c.azimuth[i] * d;
        const Vector3 wanted{std::sin(I) * std::cos(A), std::sin(I) * std::sin(A), std::cos(I)};
        const double here[] = {c.depth[i]};
        require_rule(dot(path->tangent(here)[0], wanted) > 1.0 - 1e-9, "the tangent at a station is the station's");
    }

    const std::vector<Vector3> whole = path->position(at);
    const std::size_t part = 2 + input.below(count - 1);
    const Path shorter(*c.survey(part), settings);
    std::vector<double> above;
    for (const double d : at)
        if (d <= c.depth[part - 2]) above.push_back(d);
    std::vector<Vector3> first(whole.begin(), whole.begin() + static_cast<std::ptrdiff_t>(above.size()));
    require_rule(same_bits(shorter.position(above), first), "later stations move nothing above");

    helibore::Stations stations(settings);
    std::vector<std::size_t> order;
    for (std::size_t i = 0; i < count; ++i)
        order.insert(order.begin() + static_cast<std::ptrdiff_t>(input.below(i + 1)), i);
    std::vector<std::size_t> again;
    const auto take = [&](std::size_t i, double inclination) {
        const auto taken = stations.take({&c.depth[i], 1}, {&inclination, 1}, {&c.azimuth[i], 1});
        if (input.one_in(3)) stations.path();
        return taken.refused.empty();
    };
    for (const std::size_t i : order) {
        if (input.one_in(4)) take(i, 90.0 * input.share());  // replaced below
        if (!take(i, c.inclination[i])) again.push_back(i);  // neighbours may oppose it until more have come
    }
    for (const std::size_t i : again) take(i, c.inclination[i]);
    if (!std::ranges::equal(stations.depth(), c.depth) || !std::ranges::equal(stations.inclination(), c.inclination))
        return;
    require_rule(same_bits(stations.path()->position(at), whole), "stations one by one give the same path");
    require_rule(same_bits(stations.path()->tangent(at), path->tangent(at)), "and the same tangents");
}
