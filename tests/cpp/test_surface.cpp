// Surfaces and volumes: volumes by the divergence theorem, orientation, gaps, and memory or runs that do not fit.
#include "helibore/surface.hpp"

#include <cmath>
#include <limits>
#include <numbers>

#include "check.hpp"
#include "helibore/error.hpp"
#include "host.hpp"

using namespace helibore;

namespace {

constexpr double nan = std::numeric_limits<double>::quiet_NaN();

struct Shells {
    std::vector<std::vector<double>> radii;
    HelixRadii helix;
    std::vector<std::span<const double>> spans;
    VolumeLayout layout;
    std::vector<Vector3> vertices;
    std::vector<Hexahedron> hexahedra;

    Shells(double pitch, const Path& path, int threads) {
        for (const double outwards : {0.0, 0.03, 0.1}) {
            std::vector<double> shell;
            for (int k = 0; k < 24 * 40; ++k) shell.push_back(0.1 + 0.01 * std::cos(0.3 * k) + outwards);
            radii.push_back(shell);
        }
        for (auto& shell : radii) shell[300] = nan;
        radii[2][700] = nan;
        spans.assign(radii.begin(), radii.end());
        helix = {.start_depth = 100.0, .start_toolface = 33.0, .pitch = pitch, .sectors = 24, .radius = spans[0]};
        layout = volume_layout(helix, spans);
        vertices.resize(static_cast<std::size_t>(layout.vertex_count));
        hexahedra.resize(static_cast<std::size_t>(layout.hexahedron_count));
        for (std::size_t s = 0; s < 3; ++s) {
            HelixRadii shell = helix;
            shell.radius = spans[s];
            place(shell, path, layout.shells[s], vertices, threads);
        }
        join(helix, layout, hexahedra, threads);
    }
};

// A third of the flux of the position through the six bilinear faces; two-point Gauss is exact for them.
double flux(const std::vector<Vector3>& vertices, const Hexahedron& cell) {
    constexpr int faces[6][4] = {{0, 3, 2, 1}, {4, 5, 6, 7}, {0, 1, 5, 4}, {1, 2, 6, 5}, {2, 3, 7, 6}, {3, 0, 4, 7}};
    double sum = 0.0;
    for (const auto& face : faces) {
        Vector3 c[4];
        for (int i = 0; i < 4; ++i) c[i] = vertices[static_cast<std::size_t>(cell[static_cast<std::size_t>(face[i])])];
        for (const double u : {0.5 - std::sqrt(1.0 / 12.0), 0.5 + std::sqrt(1.0 / 12.0)}) {
            for (const double v : {0.5 - std::sqrt(1.0 / 12.0), 0.5 + std::sqrt(1.0 / 12.0)}) {
                Vector3 p, a, b;
                for (std::size_t x = 0; x < 3; ++x) {
                    p[x] =
                        (1 - u) * (1 - v) * c[0][x] + u * (1 - v) * c[1][x] + u * v * c[2][x] + (1 - u) * v * c[3][x];
                    p[x] -= vertices[static_cast<std::size_t>(cell[0])][x];
                    a[x] = (1 - v) * (c[1][x] - c[0][x]) + v * (c[2][x] - c[3][x]);
                    b[x] = (1 - u) * (c[3][x] - c[0][x]) + u * (c[2][x] - c[1][x]);
                }
                sum += p[0] * (a[1] * b[2] - a[2] * b[1]) + p[1] * (a[2] * b[0] - a[0] * b[2]) +
                       p[2] * (a[0] * b[1] - a[1] * b[0]);
            }
        }
    }
    return sum / 12.0;
}

Path bent(double depth) {
    const double at[] = {depth - 60.0, depth + 60.0}, inclination[] = {10.0, 40.0}, azimuth[] = {30.0, 90.0};
    return Path(Survey(at, inclination, azimuth));
}

void volumes_and_orientation() {
    for (const double pitch : {0.1, -0.1}) {
        for (const Path& path : {Path(), bent(100.0)}) {
            const Shells one(pitch, path, 1), three(pitch, path, 3);
            CHECK(one.vertices == three.vertices && one.hexahedra == three.hexahedra);
            require_upright(one.helix, one.layout, one.vertices, one.hexahedra, 3);
            const std::vector<double> found = volumes(one.vertices, one.hexahedra, 3);
            CHECK(found == volumes(one.vertices, one.hexahedra) && found.size() > 1500);
            for (std::size_t i = 0; i < found.size(); ++i)
                CHECK(found[i] > 0.0 && std::abs(found[i] - flux(one.vertices, one.hexahedra[i])) < 1e-15);
        }
    }
}

void quads_around_a_gap() {
    std::vector<double> radius(200, 0.1);
    radius[100] = nan;
    const HelixRadii helix{.start_depth = 5.0, .pitch = 0.2, .sectors = 8, .radius = radius};
    const Surface surface = surface_of(helix, {}, 2);
    CHECK(surface.vertices.size() == 199 && surface.vertex_index[100] == 101);
    std::vector<Index> expected;
    for (Index k = 0; k + 9 < 200; ++k)
        if (k != 100 && k + 1 != 100 && k + 8 != 100 && k + 9 != 100) expected.push_back(k);
    CHECK(surface.quad_index == expected && surface.quads.size() == expected.size());
    for (std::size_t q = 0; q < surface.quads.size(); ++q) {
        const Index k = surface.quad_index[q], corners[] = {k, k + 1, k + 9, k + 8};
        for (std::size_t i = 0; i < 4; ++i)
            CHECK(surface.vertex_index[static_cast<std::size_t>(surface.quads[q][i])] == corners[i]);
    }
    const Vector3& p = surface.vertices[2];  // toolface 90, north reference: east
    CHECK(std::abs(p[0]) < 1e-15 && std::abs(p[1] - 0.1) < 1e-15 && p[2] == 5.0 + 2 * 0.2 / 8);
}

void refusals() {
    std::vector<double> radius(40, 0.1);
    const HelixRadii good{.start_depth = 5.0, .sectors = 8, .radius = radius};
    const auto with = [&](auto set) {
        HelixRadii changed = good;
        set(changed);
        return changed;
    };
    const auto layout_of = [&](auto set) { return surface_layout(with(set)); };
    CHECK_THROWS(InputError, "sectors = 0: must be 3 or more", layout_of([](HelixRadii& h) { h.sectors = 0; }));
    CHECK_THROWS(InputError, "sectors = 1000001: must be at most 1000000",
                 layout_of([](HelixRadii& h) { h.sectors = 1000001; }));
    CHECK_THROWS(InputError, "pitch = 0: must be finite and not 0", layout_of([](HelixRadii& h) { h.pitch = 0.0; }));
    CHECK_THROWS(InputError, "start_depth = nan: must be finite",
                 layout_of([](HelixRadii& h) { h.start_depth = nan; }));
    CHECK_THROWS(InputError, "start_depth = 1e+155: must lie in -10000000 to 10000000 m",
                 layout_of([](HelixRadii& h) { h.start_depth = 1e155; }));
    CHECK_THROWS(InputError, "start_toolface = nan: must be finite",
                 layout_of([](HelixRadii& h) { h.start_toolface = nan; }));
    CHECK_THROWS(InputError, "first = 9223372036854775807: must lie in -2^52 to 2^52",
                 layout_of([](HelixRadii& h) { h.first = std::numeric_limits<Index>::max(); }));
    radius[3] = -1.0;
    CHECK_THROWS(InputError, "radius[3] = -1: must be finite and above 0, or nan", surface_layout(good));
    radius[3] = 0.1;
    const SurfaceLayout layout = surface_layout(good);
    std::vector<Vector3> vertices(39);
    std::vector<Quad> quads(30);
    CHECK_THROWS(InputError, "runs[0] = [0, 40): must be placed within the 39 rows of vertices",
                 place(good, {}, layout.vertices, vertices));
    CHECK_THROWS(InputError, "quads[0] = [0, 31): must be placed within the 30 rows of quads",
                 join(good, layout, quads));
    vertices.resize(40);
    const auto place_runs = [&](std::vector<VertexRun> runs) { place(good, {}, runs, vertices); };
    CHECK_THROWS(InputError, "runs[0] = [30, 41): must lie within the vertices [0, 40) of radius",
                 place_runs({{{30, 41}, -30}}));
    CHECK_THROWS(InputError, "runs[0] = [0, 4): must be placed within the 40 rows of vertices",
                 place_runs({{{0, 4}, -1}}));
    CHECK_THROWS(InputError, "runs[1] = [3, 6): must follow [0, 4)", place_runs({{{0, 4}, 0}, {{3, 6}, 0}}));
    CHECK_THROWS(InputError, "runs[1] = [4, 8): must follow [0, 4)", place_runs({{{0, 4}, 0}, {{4, 8}, -4}}));
    CHECK_THROWS(InputError, "runs[0] = [4, 4): must not be empty", place_runs({{{4, 4}, 0}}));
    constexpr Index most = std::numeric_limits<Index>::max();
    const auto join_run = [&](QuadRun run) {
        SurfaceLayout other = layout;
        other.quads = {run};
        join(good, other, quads);
    };
    CHECK_THROWS(InputError, "quads[0] = [0, 41): must lie within the vertices [0, 40) of radius",
                 join_run({{0, 41}, 0, 0, 0}));
    CHECK_THROWS(InputError, "quads[0] = [0, 9223372036854775807): must lie within the vertices [0, 40) of radius",
                 join_run({{0, most}, -most, 0, 0}));
    CHECK_THROWS(InputError, "quads[0] = [0, 9): must have corners within 2^53 rows of k",
                 join_run({{0, 9}, 0, most, 0}));
    CHECK_THROWS(InputError, "quads[0] = [0, 9): must have corners within 2^53 rows of k",
                 join_run({{0, 9}, 0, 0, -most}));
    for (const int threads : {0, 2000000000}) {
        const std::string text = "threads = " + std::to_string(threads) + ": must lie in 1 to 1024";
        CHECK_THROWS(InputError, text, place(good, {}, layout.vertices, vertices, threads));
        CHECK_THROWS(InputError, text, join(good, layout, quads, threads));
        CHECK_THROWS(InputError, text, surface_of(good, {}, threads));
        CHECK_THROWS(InputError, text, volumes({}, {}, threads));
    }
    CHECK_THROWS(InputError, "vertex 0 at depth 5: must not lie above the first station of the survey, at 40 m",
                 surface_of(good, bent(100.0)));
    const double at[] = {0.0, 50.0, 200.0}, inclination[] = {30.0, 0.0, 0.0}, azimuth[] = {0.0, 0.0, 0.0};
    const HelixRadii straight = with([](HelixRadii& h) { h.start_depth = 49.95; });
    CHECK_THROWS(InputError,
                 "vertex 4 at depth 50: the high side is undefined where the hole is vertical; use the reference north",
                 surface_of(straight, Path(Survey(at, inclination, azimuth))));

    Shells shells(0.1, {}, 1);
    CHECK_THROWS(InputError, "shells: a volume needs one or more beyond the wall",
                 volume_layout(shells.helix, std::span(shells.spans).first(1)));
    const std::vector<std::span<const double>> uneven{radius, std::span(radius).first(9)};
    CHECK_THROWS(InputError, "shells[0] has 9 values, radius has 40: must be equal", volume_layout(good, uneven));
    const std::vector<std::span<const double>> equal{radius, radius};
    CHECK_THROWS(InputError, "shells[0][0] = 0.1 at depth 5: must lie beyond radius[0] = 0.1",
                 volume_layout(good, equal));
    std::vector<Hexahedron> cells = shells.hexahedra;
    const std::string last = std::to_string(cells.size() - 1), rows = std::to_string(shells.vertices.size());
    CHECK_THROWS(InputError,
                 "layers[1][4] = [" + std::to_string(shells.layout.layers[1].back().inner.k.start) + ", " +
                     std::to_string(shells.layout.layers[1].back().inner.k.stop) + "): must be placed within the " +
                     last + " rows of hexahedra",
                 join(shells.helix, shells.layout, std::span(cells).first(cells.size() - 1)));
    CHECK_THROWS(
        InputError, "hexahedra = " + last + ": must be as many as the layout has: " + std::to_string(cells.size()),
        require_upright(shells.helix, shells.layout, shells.vertices, std::span(cells).first(cells.size() - 1)));
    cells[5][2] = 99999999;
    cells[7][0] = -1;
    CHECK_THROWS(InputError, "hexahedra[5][2] = 99999999: must be a row of the " + rows + " vertices",
                 volumes(shells.vertices, cells, 2));
    CHECK_THROWS(InputError, "hexahedra[5][2] = 99999999: must be a row of the " + rows + " vertices",
                 require_upright(shells.helix, shells.layout, shells.vertices, cells));
    cells = shells.hexahedra;
    std::swap(cells[2][0], cells[2][1]);
    CHECK_THROWS(
        InputError,
        "shells[0] at vertex 2, depth 100.00833333333334: folds over itself; the path bends there with a radius "
        "below that of the shell, or its frame turns too fast",
        require_upright(shells.helix, shells.layout, shells.vertices, cells));
    VolumeLayout other = shells.layout;
    other.layers.clear();
    CHECK_THROWS(InputError, "layers: must place a hexahedron in every row: none in row 2",
                 require_upright(shells.helix, other, shells.vertices, cells));
    other.layers = {{{{{0, 1}, most, 0, 0}, {{0, 1}, most, 0, 0}}}};
    CHECK_THROWS(
        InputError,
        "layers[0][0] = [0, 1): must be placed within the " + std::to_string(cells.size()) + " rows of hexahedra",
        require_upright(shells.helix, other, shells.vertices, cells));
    other.layers = {{{{{0, 1}, 0, 0, 0}, {{0, 1}, 0, -most, 0}}}};
    CHECK_THROWS(InputError, "layers[0][0] = [0, 1): must have corners within 2^53 rows of k",
                 join(shells.helix, other, cells));
}

}  // namespace

int main() {
    volumes_and_orientation();
    quads_around_a_gap();
    in_every_host_state(refusals);
    return failures();
}
