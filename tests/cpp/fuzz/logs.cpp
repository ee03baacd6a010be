// Logs of turns against their definitions, computed slowly; angular gaps against a loop over all samples.
#include "helibore/logs.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "helibore/zones.hpp"

#include "input.hpp"

using helibore::Index;

namespace {

constexpr double nan = std::numeric_limits<double>::quiet_NaN();

bool near(double a, double b, double size) {
    return std::abs(a - b) <= 1e-7 * size || (std::isnan(a) && std::isnan(b));
}

void require_turn(const helibore::Turns& turns, const helibore::TurnLogs& logs, std::size_t turn) {
    const auto K = static_cast<std::size_t>(turns.sectors);
    const std::span<const double> r = turns.radius.subspan(turn * K, K);
    double sum = 0.0, squares = 0.0, least = std::numeric_limits<double>::infinity(), most = 0.0;
    std::size_t count = 0;
    for (const double radius : r) {
        if (std::isnan(radius)) continue;
        ++count, sum += radius, squares += radius * radius;
        least = std::min(least, radius), most = std::max(most, radius);
    }
    require_rule(logs.coverage[turn] == static_cast<double>(count) / static_cast<double>(K), "coverage");
    if (count > 0) require_rule(logs.smallest[turn] == least && logs.largest[turn] == most, "extremes");
    if (count < K) {
        require_rule(std::isnan(logs.mean[turn]) && std::isnan(logs.enclosing_diameter[turn]), "a turn with a gap");
        return;
    }
    require_rule(near(logs.mean[turn], sum / static_cast<double>(K), most), "mean");
    require_rule(near(std::sqrt(logs.mean_square[turn]), std::sqrt(squares / static_cast<double>(K)), most),
                 "mean square");
    require_rule(logs.least_diameter[turn] <= logs.c1[turn], "diameters");
    const double inside = 0.5 * logs.inscribed_diameter[turn];
    double nearest = std::numeric_limits<double>::infinity();
    for (std::size_t k = 0; k < K; ++k) {
        const double angle =
            (turns.start_toolface + 360.0 * static_cast<double>(k) / static_cast<double>(K)) * std::numbers::pi / 180.0;
        nearest = std::min(nearest, std::hypot(r[k] * std::cos(angle) - logs.inscribed_0[turn],
                                               r[k] * std::sin(angle) - logs.inscribed_90[turn]));
    }
    require_rule(near(nearest, inside, most), "the inscribed circle touches the nearest vertex");
    const double centred = std::hypot(logs.centre_0[turn], logs.centre_90[turn]);
    require_rule(inside >= least - centred - 1e-7 * most || inside >= 0.0, "an inscribed circle");
    require_rule(0.5 * logs.enclosing_diameter[turn] >= 0.5 * most - 1e-7 * most &&
                     0.5 * logs.enclosing_diameter[turn] <= most * (1.0 + 1e-7) + centred,
                 "an enclosing circle");
}

void fuzz_turns(Input& input) {
    helibore::Turns turns{.start_toolface = input.mostly_of({0.0, 33.0, -1e-20, 1e5}),
                          .sectors = input.one_in(64) ? input.one_of({2, 1000001}) : input.between(3, 20),
                          .radius = {},
                          .window = input.one_of<Index>({3, 5, 11, 4, 1, 101})};
    std::vector<double> radius;
    const double scale = input.one_of({0.1, 1e-50, 1e40, 1.0});
    for (std::size_t n = input.below(400); n > 0; --n)
        radius.push_back(input.one_in(40) ? nan : scale * (1.0 + input.one_of({0.0, 1.0, 0.5, 1e-9}) * input.share()));
    if (!radius.empty() && input.one_in(16)) radius[input.below(65536) % radius.size()] = input.hostile();
    turns.radius = radius;
    helibore::TurnLogs logs, on_three;
    if (refused([&] { logs = turn_logs(turns, 1); })) return;
    on_three = turn_logs(turns, 3);
    require_rule(same_bits(logs.rugosity, on_three.rugosity) && same_bits(logs.inscribed_0, on_three.inscribed_0) &&
                     same_bits(logs.enclosing_diameter, on_three.enclosing_diameter),
                 "logs on three threads");
    for (const double toolface : logs.c1_toolface)
        require_rule(std::isnan(toolface) || (toolface >= 0.0 && toolface < 180.0), "the toolface of c1");
    if (std::abs(turns.start_toolface) > 1e6) return;
    for (std::size_t turn = 0; turn < logs.mean.size(); ++turn) require_turn(turns, logs, turn);
}

void fuzz_gaps(Input& input) {
    const helibore::HelixVertices helix{.start_depth = input.one_of({10.0, 0.0}),
                                        .start_toolface = input.one_of({0.0, 10.0, 359.0}),
                                        .pitch = input.one_of({0.1, -0.1, 1.0}),
                                        .sectors = input.one_of<Index>({8, 1, 3, 64}),
                                        .count = static_cast<Index>(input.below(200))};
    std::vector<double> depth, toolface;
    for (std::size_t n = input.below(60); n > 0; --n) {
        depth.push_back(helix.start_depth + 0.02 * input.between(-100, 100));
        toolface.push_back(5.625 * input.between(-70, 70));
    }
    std::ranges::sort(depth);
    const double reach = input.one_of({0.05, 0.5, 0.0, 1e9});
    std::vector<double> gaps;
    if (refused([&] { gaps = angular_gaps(helix, {depth, toolface}, reach, 1); })) return;
    require_rule(same_bits(gaps, angular_gaps(helix, {depth, toolface}, reach, 3)), "gaps on three threads");
    for (Index k = 0; k < helix.count; ++k) {
        const auto K = static_cast<double>(helix.sectors);
        const double at = helix.start_depth + static_cast<double>(k) * helix.pitch / K;
        const double own = static_cast<double>(k % helix.sectors) * 360.0 / K;
        double ahead = 360.0, behind = 360.0;
        for (std::size_t i = 0; i < depth.size(); ++i) {
            if (depth[i] < at - reach || depth[i] > at + reach) continue;
            const double around = toolface[i] - helix.start_toolface - own;
            const double clockwise = around - 360.0 * std::floor(around / 360.0);
            ahead = std::min(ahead, clockwise);
            behind = std::min(behind, clockwise == 0.0 ? 0.0 : 360.0 - clockwise);
        }
        const double wanted = ahead == 0.0 ? 0.0 : std::min(ahead + behind, 360.0);
        require_rule(std::abs(gaps[static_cast<std::size_t>(k)] - wanted) < 1e-9, "the gap of a loop over all samples");
    }
}

// Columns of any numbers, which no wall has: they give zones within the hole, the same on three threads, or an error.
void fuzz_zones(Input& input) {
    const std::size_t turns = input.below(40);
    const int sectors = input.between(3, 12);
    const auto filled = [&](std::size_t size, double usual, double spread) {
        std::vector<double> out;
        for (; size > 0; --size)
            out.push_back(input.one_in(60) ? input.hostile() : usual + spread * (input.share() - 0.5));
        return out;
    };
    std::vector<double> depth;
    for (std::size_t turn = 0; turn < turns; ++turn) depth.push_back(0.1 * static_cast<double>(turn));
    const auto size = filled(turns, 0.24, 0.1), least = filled(turns, 0.2, 0.05), across = filled(turns, 0.21, 0.05),
               toolface = filled(turns, 180.0, 360.0), share = filled(turns, 0.8, 0.4),
               height = filled(turns, 0.01, 0.02), width = filled(turns, 90.0, 180.0),
               sections = filled(turns * helibore::section_parts, 0.11, 0.05),
               radius = filled(turns * static_cast<std::size_t>(sectors), 0.11, 0.05),
               uneven = filled(input.one_in(2) ? 0 : turns, 0.0, 0.02),
               kinds = filled(input.one_in(2) ? 0 : turns * helibore::hole_kinds, 0.3, 0.5);
    const std::size_t samples = input.one_in(2) ? 0 : input.below(200);
    auto depths = filled(samples, 2.0, 4.0);
    std::ranges::sort(depths);
    const auto toolfaces = filled(samples, 180.0, 360.0), radii = filled(samples, 0.11, 0.05);
    const std::vector<Index> seen(kinds.size() / helibore::hole_kinds, 9);
    const helibore::MeasuredTurns::Lobe first{toolface, width, height}, second{width, width, share};
    const helibore::MeasuredTurns measures{depth,    share,    share,
                                           size,     size,     toolface,
                                           across,   least,    size,
                                           width,    toolface, {{first, second}},
                                           sections, uneven,   {{depths, toolfaces}, radii}};
    helibore::ZoneCriteria criteria;
    criteria.least_length = input.one_of({0.3, 0.0, 0.1}), criteria.join = input.one_of({1.0, 0.0, 0.2});
    const double bit = input.mostly_of({0.216, 0.1});
    static const helibore::SectionLibraries libraries(0.216, helibore::ZoneCriteria{}.limits());
    const helibore::TurnVertices vertices{radius, sectors, input.mostly_of({0.0, -33.0, 1e5}),
                                          input.mostly_of({0.1, -0.1, 0.2})};
    helibore::Zones found, on_three;
    if (refused([&] { found = find_zones(measures, vertices, bit, criteria, {kinds, seen}, libraries, 1); })) return;
    on_three = find_zones(measures, vertices, bit, criteria, {kinds, seen}, libraries, 3);
    require_rule(found.kinds == on_three.kinds && found.zones.size() == on_three.zones.size(),
                 "zones on three threads");
    for (const helibore::Zone& zone : found.zones) {
        require_rule(zone.start <= zone.stop, "ends of a zone");
        require_rule(!(zone.pipe_diameter <= 0.0) && !(zone.pipe_diameter >= bit), "pipe of a zone");
        require_rule(!(zone.toolface < 0.0) && !(zone.toolface >= 360.0), "toolface of a zone");
    }
}

}  // namespace

void fuzz(Input input) {
    if (input.one_in(8)) return fuzz_zones(input);
    input.one_in(2) ? fuzz_gaps(input) : fuzz_turns(input);
}
