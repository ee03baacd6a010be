// Surfaces and volumes of radii with gaps: the quads and hexahedra that a slow loop over the helix finds, vertices
// where the formula of the wall point puts them. Layouts that do not fit the memory are refused.
#include "helibore/surface.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>

#include "input.hpp"

using helibore::Hexahedron;
using helibore::Index;
using helibore::Quad;

namespace {

bool there(const std::vector<double>& radius, Index i) {
    return i >= 0 && i < static_cast<Index>(radius.size()) && !std::isnan(radius[static_cast<std::size_t>(i)]);
}

// The row of each vertex that has a radius.
std::map<Index, Index> rows_of(const std::vector<double>& radius, Index first, Index row) {
    std::map<Index, Index> rows;
    for (Index i = 0; i < static_cast<Index>(radius.size()); ++i)
        if (there(radius, i)) rows[first + i] = row++;
    return rows;
}

std::map<Index, Quad> quads_of(const std::map<Index, Index>& rows, Index sectors, bool down) {
    std::map<Index, Quad> quads;
    for (const auto& [k, row] : rows) {
        const auto a1 = rows.find(k + 1), b0 = rows.find(k + sectors), b1 = rows.find(k + sectors + 1);
        if (a1 == rows.end() || b0 == rows.end() || b1 == rows.end()) continue;
        quads[k] = down ? Quad{row, a1->second, b1->second, b0->second} : Quad{row, b0->second, b1->second, a1->second};
    }
    return quads;
}

}  // namespace

void fuzz(Input input) {
    const int sectors = input.one_in(64) ? input.one_of({2, -1, 1000001}) : input.between(3, 12);
    helibore::HelixRadii helix{.start_depth = input.mostly_of({0.0, 1000.0, -9e6}),
                               .start_toolface = input.mostly_of({0.0, 33.0, -400.0}),
                               .pitch = input.mostly_of({0.1, -0.2, 3.0}),
                               .sectors = sectors,
                               .first = input.one_of<Index>({0, 5, -70, Index{1} << 40, Index{1} << 53}),
                               .radius = {}};
    std::vector<std::vector<double>> shells(1 + input.below(3));
    const std::size_t size = input.below(160);
    constexpr double nan = std::numeric_limits<double>::quiet_NaN();
    for (std::size_t s = 0; s < shells.size(); ++s)
        for (std::size_t i = 0; i < size; ++i)
            shells[s].push_back(input.one_in(12) ? nan
                                                 : 0.1 * static_cast<double>(s + 1) + 0.05 * input.byte() / 256.0);
    if (size > 0 && input.one_in(16)) shells[0][input.below(65536) % size] = input.hostile();
    helix.radius = shells[0];
    helibore::SurfaceLayout layout;
    if (refused([&] { layout = surface_layout(helix); })) return;
    const auto rows = rows_of(shells[0], helix.first, 0);
    const auto quads = quads_of(rows, sectors, helix.pitch > 0.0);
    require_rule(
        layout.vertex_count == static_cast<Index>(rows.size()) && layout.quad_count == static_cast<Index>(quads.size()),
        "a layout counts vertices and quads");
    const double inclination[] = {10.0, input.one_of({10.0, 40.0})}, azimuth[] = {20.0, input.one_of({20.0, 60.0})};
    const double stations[] = {-1e7, 1e7}, bend[] = {helix.start_depth - 60.0, helix.start_depth + 60.0};
    std::optional<helibore::Path> path;
    const bool bent = input.one_in(2);
    if (refused([&] { path.emplace(helibore::Survey(bent ? bend : stations, inclination, azimuth)); })) return;
    helibore::Surface surface;
    const bool was_refused = refused([&] { surface = surface_of(helix, *path, 1); });
    if (!was_refused) {
        const helibore::Surface on_three = surface_of(helix, *path, 3);
        require_rule(same_bits(surface.vertices, on_three.vertices) && same_bits(surface.quads, on_three.quads),
                     "a surface on three threads");
        std::size_t row = 0;
        for (const auto& [k, at] : rows) require_rule(surface.vertex_index[row++] == k, "the vertex of each row");
        row = 0;
        for (const auto& [k, quad] : quads) {
            require_rule(surface.quad_index[row] == k && surface.quads[row] == quad, "the quads of a slow loop");
            ++row;
        }
        for (std::size_t i = 0; i < surface.vertices.size() && std::abs(helix.start_toolface) < 1e6; ++i) {
            const Index k = surface.vertex_index[i];
            const double K = sectors, depth[] = {helix.start_depth + static_cast<double>(k) * helix.pitch / K};
            const double toolface =
                (helix.start_toolface + static_cast<double>(k % sectors) * 360.0 / K) * std::numbers::pi / 180.0;
            const double radius = shells[0][static_cast<std::size_t>(k - helix.first)];
            if (radius > 1e100) continue;  // may overflow
            const helibore::Vector3 axis = path->position(depth)[0];
            const helibore::Frame frame = path->frame(depth)[0];
            for (std::size_t x = 0; x < 3; ++x) {
                const double wanted =
                    axis[x] + radius * (std::cos(toolface) * frame[0][x] + std::sin(toolface) * frame[1][x]);
                require_rule(std::abs(surface.vertices[i][x] - wanted) < 1e-6 * std::max(1.0, radius),
                             "C + R (cos h + sin right)");
            }
        }
    }
    std::vector<helibore::Vector3> memory(rows.size());
    if (!memory.empty())
        require_rule(refused([&] { place(helix, *path, layout.vertices, std::span(memory).first(memory.size() - 1)); }),
                     "short memory is refused");
    for (helibore::QuadRun& run : layout.quads)
        if (input.one_in(8)) run.shift += input.between(-3, 3), run.k.stop += input.between(-3, 3);
    std::vector<Quad> filled(static_cast<std::size_t>(layout.quad_count));
    refused([&] { join(helix, layout, filled, 2); });  // whatever the runs: within the memory

    std::vector<std::span<const double>> spans(shells.begin(), shells.end());
    helibore::VolumeLayout volume;
    if (refused([&] { volume = volume_layout(helix, spans); })) return;
    std::vector<Hexahedron> cells(static_cast<std::size_t>(volume.hexahedron_count)), wanted;
    join(helix, volume, cells, 2);
    Index row = static_cast<Index>(rows.size());
    auto inner = quads;
    for (std::size_t s = 1; s < shells.size(); ++s) {
        const auto outer_rows = rows_of(shells[s], helix.first, row);
        row += static_cast<Index>(outer_rows.size());
        const auto outer = quads_of(outer_rows, sectors, helix.pitch > 0.0);
        for (const auto& [k, i] : inner)
            if (const auto o = outer.find(k); o != outer.end())
                wanted.push_back({i[0], i[1], i[2], i[3], o->second[0], o->second[1], o->second[2], o->second[3]});
        inner = outer;
    }
    require_rule(row == volume.vertex_count && cells == wanted, "the hexahedra of a slow loop");
    if (was_refused || path->stop_depth() < 1e6) return;
    std::vector<helibore::Vector3> corners(static_cast<std::size_t>(volume.vertex_count));
    for (std::size_t s = 0; s < shells.size(); ++s) {
        helibore::HelixRadii shell = helix;
        shell.radius = shells[s];
        if (refused([&] { place(shell, *path, volume.shells[s], corners, 2); })) return;
    }
    const std::vector<double> found = helibore::volumes(corners, cells, 1);
    require_rule(same_bits(found, helibore::volumes(corners, cells, 3)), "volumes on three threads");
    for (std::size_t n = input.below(4); n > 0 && !cells.empty(); --n)
        cells[input.below(65536) % cells.size()][input.below(8)] = input.one_of<Index>({-1, 1 << 20, 0, 3});
    refused([&] { require_upright(helix, volume, corners, cells, 2); });
    refused([&] { static_cast<void>(helibore::volumes(corners, cells, 2)); });
}
