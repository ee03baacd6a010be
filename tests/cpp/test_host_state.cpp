// The host's floating-point state changes no result and stays as the host set it: rounding upwards, flushing subnormals
// to zero, exceptions that trap (Delphi and Pascal hosts unmask them; without care a division by zero would end them).
#include <cfenv>
#include <limits>

#include "check.hpp"
#include "helibore/estimates.hpp"
#include "helibore/image.hpp"
#include "helibore/live.hpp"
#include "helibore/logs.hpp"
#include "helibore/surface.hpp"
#include "helibore/wits.hpp"
#include "hole.hpp"
#include "host.hpp"

#ifdef __SSE2__
#include <xmmintrin.h>
#endif
#ifdef __unix__
#include <sys/wait.h>
#include <unistd.h>
#endif

namespace {

using Result = std::vector<std::uint64_t>;

// All that computes, in the host's state: a wall in two appends with samples exactly on vertices (distance 0) and a
// gap, values at its vertices, estimates at points, angular gaps, its surface, a volume, logs, an image, a path, a live
// well, and a parser.
Result work(int threads, const Hole& hole) {
    helibore::Wall wall({.bit_diameter = 0.216, .sectors = 48, .pitch = 0.05, .power = 0.7, .threads = threads});
    hole.all().validate(threads);
    wall.append(hole.rows(0, 1000));
    std::vector<double> radius(static_cast<std::size_t>(wall.size()));
    CHECK(wall.read_radius(radius) == wall.size());
    wall.append(hole.rows(1000, hole.depth.size() - 1000));
    Result all = bits(wall);
    const auto add = [&](std::span<const double> values) {
        for (const double value : values) all.push_back(value == value ? std::bit_cast<std::uint64_t>(value) : 0);
    };
    const std::vector<std::vector<double>> samples = wall.samples();
    const std::span<const double> channel(samples[2]);
    add(wall.interpolate_samples(std::span(&channel, 1), threads)[0]);

    const std::vector<double> depths = wall.depth(), toolfaces = wall.toolface();
    std::vector<double> trial = wall.radius();
    const std::vector<double> box(trial.size(), 0.02), nuggets = {0.5};
    trial[7] = std::numeric_limits<double>::quiet_NaN();
    const helibore::Settings kriging{
        .bit_diameter = 0.216, .estimator = helibore::Estimator::kriging, .kriging_range = 0.4, .threads = threads};
    const helibore::PointEstimates estimates = helibore::estimate_at(
        {samples[0], samples[1], samples[2]}, {depths, toolfaces, trial, box, box}, kriging, nuggets);
    for (const auto* column :
         {&estimates.radius, &estimates.by_nugget[0], &estimates.square_weights, &estimates.scatter, &estimates.along})
        add(*column);
    const helibore::HelixVertices vertices_of_wall{
        .start_depth = wall.start_depth(), .pitch = 0.05, .sectors = 48, .count = wall.size()};
    add(helibore::angular_gaps(vertices_of_wall, {samples[0], samples[1]}, 0.1, threads));
    helibore::Live live({.wall = {.bit_diameter = 0.216, .start_depth = 100.0, .direct = true, .threads = threads}});
    live.append_samples(hole.rows(0, 500));
    add(live.wall().radius());

    radius = wall.radius();
    radius[5000] = std::numeric_limits<double>::quiet_NaN();
    std::vector<double> beyond;
    for (const double r : radius) beyond.push_back(2.0 * r);  // exact however the host rounds
    helibore::HelixRadii helix{.start_depth = wall.start_depth(), .pitch = 0.05, .sectors = 48, .radius = radius};
    const double depth[] = {90.0, 110.0, 140.0}, inclination[] = {10.0, 30.0, 35.0}, azimuth[] = {20.0, 60.0, 61.0};
    const helibore::Survey survey(depth, inclination, azimuth);
    add(survey.dogleg());
    helibore::Stations stations({.method = helibore::Method::radius_of_curvature});
    CHECK(stations.take(depth, inclination, azimuth).refused.empty());
    CHECK(live.append_stations(depth, inclination, azimuth).events.empty());
    for (const auto& position : live.path()->position(depth)) add(position);
    for (const helibore::Path& path : {helibore::Path(survey), *stations.path()}) {
        const helibore::Surface surface = helibore::surface_of(helix, path, threads);
        for (const auto& vertex : surface.vertices) add(vertex);
        const auto frames = path.frame(depth);
        for (const auto& axis : frames[1]) add(axis);
        add(path.tangent(depth)[1]);
        add(path.north_to_high_side(depth));
    }
    const std::span<const double> shells[] = {radius, beyond};
    const helibore::VolumeLayout layout = helibore::volume_layout(helix, shells);
    std::vector<helibore::Vector3> vertices(static_cast<std::size_t>(layout.vertex_count));
    std::vector<helibore::Hexahedron> hexahedra(static_cast<std::size_t>(layout.hexahedron_count));
    helibore::join(helix, layout, hexahedra, threads);
    for (std::size_t s = 0; s < 2; ++s) {
        helix.radius = shells[s];
        helibore::place(helix, helibore::Path(survey), layout.shells[s], vertices, threads);
    }
    helibore::require_upright(helix, layout, vertices, hexahedra, threads);
    add(helibore::volumes(vertices, hexahedra, threads));

    const helibore::TurnLogs logs = helibore::turn_logs({.sectors = 48, .radius = radius}, threads);
    for (const auto* column : {&logs.mean, &logs.c1, &logs.centre_0, &logs.inscribed_diameter, &logs.enclosing_diameter,
                               &logs.rugosity, &logs.largest})
        add(*column);
    const double rows[] = {100.0, 110.0, 125.0}, low[] = {99.0, 105.0, 120.0}, high[] = {105.0, 120.0, 126.0};
    const double values[] = {1.1, 2.2, 3.3, 4.4, 5.5, 6.6}, sector[] = {0.3, 0.9, 1.7};
    const helibore::QuadCentres quads{.start_depth = 100.1, .pitch = 0.03, .count = 2900, .sector = sector};
    add(helibore::linear_values({rows, values, 2}, 10.0, quads, threads));
    add(helibore::cell_values({rows, values, 2}, low, high, quads, threads));
    helibore::wits::Parser parser;
    const auto batch = parser.feed("&&\r\n01080.1\r\n01091.7e-5\r\n011012345678.9\r\n0111x\r\n!!\r\n");
    for (const auto& item : batch.items) add(std::span(&item.value, 1));
    return all;
}

#ifdef __SSE2__
constexpr unsigned status_flags = 0x3f;  // sticky: whether something was ever inexact is nobody's setting
unsigned host_state() {
    return _mm_getcsr() & ~status_flags;
}
#else
int host_state() {
    return std::fegetround();
}
#endif

template <class Set>
void under(const std::string& name, const Result& expected, int threads, const Hole& hole, const Set& set) {
    std::fenv_t normal;
    std::fegetenv(&normal);
    set();
    const auto as_set = host_state();
    const Result result = work(threads, hole);
    const bool restored = host_state() == as_set;
    std::fesetenv(&normal);
    if (!restored) fail(__FILE__, __LINE__, "state not given back: " + name);
    if (result != expected) fail(__FILE__, __LINE__, "other bits: " + name);
}

// A process that forks between two calls: the child's wall goes on with the same bits.
#ifdef __unix__
void after_a_fork(const Hole& hole) {
    const helibore::Settings settings{.bit_diameter = 0.216, .threads = 2};
    helibore::Wall expected(settings), wall(settings);
    expected.append(hole.all());
    wall.append(hole.rows(0, 1000));
    const pid_t child = fork();
    if (child == 0) {
        wall.append(hole.rows(1000, hole.depth.size() - 1000));
        _exit(bits(wall) == bits(expected) ? 0 : 1);
    }
    int status = -1;
    CHECK(waitpid(child, &status, 0) == child && status == 0);
    wall.append(hole.rows(1000, hole.depth.size() - 1000));
    CHECK(bits(wall) == bits(expected));
}
#endif

}  // namespace

int main() {
    Hole hole = oval_hole(100'000 / reduced, 100.0, 30.0);  // enough for all to be shared out
    for (std::size_t i = 0; i < 50; ++i) {                  // on vertices, and as near as it gets
        hole.depth[i] = 100.0;
        hole.toolface[i] = i % 2 == 0 ? 0.0 : 1e-300;
    }
    const Result expected = work(1, hole);
    int threads = 1;
    for (const int rounding : roundings) {
        threads = threads == 7 ? 2 : 7;
        under("rounding " + std::to_string(rounding) + " with exceptions that trap", expected, threads, hole,
              [&] { set_host_state(rounding, true); });
    }
    under("rounding upwards", expected, 1, hole, [&] { set_host_state(FE_UPWARD, false); });
#ifdef __SSE2__
    under("subnormals flushed", expected, 3, hole, [] { _mm_setcsr(_mm_getcsr() | 0x8040); });
#endif
#ifdef __unix__
    after_a_fork(hole);
#endif
    return failures();
}
