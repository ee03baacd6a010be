// Walls for fuzz targets: settings and batches of samples of every awkward shape, and laws that each append obeys.
#pragma once

#include <algorithm>
#include <cmath>

#include "helibore/wall.hpp"
#include "hole.hpp"
#include "host.hpp"
#include "input.hpp"

struct WallInput {
    helibore::Settings settings;
    bool timed = false;
    double top = 0.0;  // about where samples lie
};

inline WallInput wall_input(Input& input) {
    WallInput made;
    made.timed = input.one_in(2);
    made.top = input.one_of({1000.0, 0.0, -30.0, 9.9e6});
    helibore::Settings& s = made.settings;
    s.bit_diameter = input.mostly_of({0.216, 0.1, 1.0, 0.001, 4.0});
    s.sectors = input.one_in(64) ? input.one_of({0, -1, 1000001, 1000}) : input.between(3, 40);
    s.pitch = input.mostly_of({0.1, -0.1, 0.5, -0.03, 7.0, 1e-3});
    if (input.one_in(2)) s.start_depth = input.mostly(made.top + input.one_of({0.0, 0.5, -0.3, 3.0}));
    if (input.one_in(4)) s.stop_depth = input.mostly(made.top + input.one_of({1.0, 0.0, 2.5, -1.0}));
    s.start_toolface = input.mostly_of({0.0, 33.0, 360.0, -1e-20, 1e6, 359.999});
    s.neighbors = input.one_in(8) ? input.one_of({16, 32, 64, 256, 257, 0}) : input.between(1, 12);
    if (input.one_in(4)) s.window = input.one_of<helibore::Index>({1, 2, 5, 20, 100, 1000, 0});
    s.power = input.mostly_of({1.0, 2.0, 0.5, 0.7, 3.3, 1e-3, 40.0});
    s.max_distance = input.mostly_of({1.0, helibore::no_limit, 0.05, 0.3, 1e-6, 100.0});
    s.max_iterations = input.one_in(64) ? input.one_of({0, 256, 255}) : input.between(1, 20);
    s.tolerance = input.mostly_of({1e-6, 0.0, 1e-3, 1.0});
    s.angular_scale = input.mostly_of({1.0, 2.0, 0.25, 32.0, 0.01});
    if (input.one_in(6)) {
        s.estimator = helibore::Estimator::kriging;
        s.kriging_range = input.mostly_of({0.5, 1e-3, 100.0});
        s.nugget = input.mostly_of({0.1, 1e-6, 1e6});
    }
    s.direct = input.one_in(4);
    s.most_vertices = input.one_of<helibore::Index>({400, 60, 3000, 1});
    s.threads = input.between(1, 3);
    return made;
}

// A batch; times are those of arrival, now and then the same or earlier.
inline Hole samples_input(Input& input, const WallInput& wall, double& clock) {
    constexpr std::size_t sizes[] = {1, 2, 9, 40, 150, 400, 1, 1500, 5000};
    const std::size_t n = sizes[input.one_in(24) ? input.below(9) : input.below(6)];
    const std::size_t shape = input.below(6);
    const double top = wall.top + input.one_of({0.0, 0.4, -0.7, 2.0}), length = input.one_of({1.0, 0.1, 4.0, 1e-6});
    const double arm = input.one_of({0.0, 45.0, 359.9, -720.0});
    const double grid = input.one_of({0.0, 1.0 / 64.0, 0.25});  // samples on a grid are equally far from vertices
    Uniform uniform(input.below(65536));
    Hole hole;
    for (std::size_t i = 0; i < n; ++i) {
        const double along = static_cast<double>(i) / static_cast<double>(n);
        double depth = top + length * uniform(), toolface = arm + 360.0 * uniform(), radius = 0.05 + 0.2 * uniform();
        if (shape == 1) depth = top;
        if (shape == 2) depth = top + length * along, toolface = arm + 90.0 * static_cast<double>(i % 4);
        if (shape == 3) depth = top + length * along, toolface = arm;
        if (shape == 4) depth = top + length * static_cast<double>(i % 5);
        if (shape == 5 && input.left() > 0) {
            depth = top + input.byte() / 32.0;
            toolface = input.byte() * 2.8125;
            radius = 0.05 + input.byte() / 1024.0;
        }
        if (grid > 0.0) {
            depth = std::round(depth / grid) * grid;
            toolface = std::round(toolface / (360.0 * grid)) * 360.0 * grid;
        }
        hole.depth.push_back(depth);
        hole.toolface.push_back(toolface);
        hole.radius.push_back(radius);
        hole.time.push_back(clock);
        if (uniform() < 0.8) clock += uniform() < 0.9 ? 1.0 : -20.0;
    }
    for (std::vector<double>* column : {&hole.depth, &hole.toolface, &hole.radius, &hole.time})
        if (input.one_in(32)) (*column)[input.below(65536) % n] = input.hostile();
    return hole;
}

inline helibore::SampleColumns columns_of(const Hole& hole, bool timed) {
    helibore::SampleColumns columns = hole.all();
    if (!timed) columns.time = {};
    return columns;
}

inline void add_rows(Hole& all, const Hole& more) {
    const auto add = [](std::vector<double>& to, const std::vector<double>& from) {
        to.insert(to.end(), from.begin(), from.end());
    };
    add(all.depth, more.depth);
    add(all.toolface, more.toolface);
    add(all.radius, more.radius);
    add(all.time, more.time);
}

// The wall, or none if the settings break a rule. An append may still refuse the start_depth or stop_depth.
inline std::optional<helibore::Wall> wall_of(const helibore::Settings& settings) {
    std::optional<helibore::Wall> wall;
    refused([&] { wall.emplace(settings); });
    return wall;
}

// The wall of the samples in one batch, on one thread, with plain instructions.
inline helibore::Wall plain_wall(helibore::Settings settings, const helibore::SampleColumns& columns) {
    settings.threads = 1;
    settings.instruction_set = helibore::InstructionSet::plain;
    helibore::Wall wall(settings);
    wall.append(columns);
    return wall;
}

inline HostState host_state(std::size_t which) {
    return {roundings[which % 4], which >= 4};
}

struct Vertex {
    std::uint64_t depth, toolface, radius, nearest;
    std::int32_t support, iterations, provisional;
    friend bool operator==(const Vertex&, const Vertex&) = default;
};

inline std::vector<Vertex> vertices_of(const helibore::Wall& wall) {
    const helibore::VertexColumns v = wall.vertices();
    std::vector<Vertex> all;
    for (std::size_t k = 0; k < v.radius.size(); ++k)
        all.push_back({bits_of(v.depth[k]), bits_of(v.toolface[k]), bits_of(v.radius[k]), bits_of(v.nearest[k]),
                       v.support[k], v.iterations[k], v.provisional[k]});
    return all;
}
