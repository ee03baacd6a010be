// A host that writes into its arrays during a call, each time that the call shares out work: the result has the bits of
// the values that the arrays had before the call, or is made of other numbers, and no bad memory is read.
#include <algorithm>
#include <limits>
#include <vector>

#include "check.hpp"
#include "helibore/estimates.hpp"
#include "helibore/image.hpp"
#include "helibore/logs.hpp"
#include "helibore/runner.hpp"
#include "helibore/surface.hpp"
#include "hole.hpp"

using namespace helibore;

namespace {

constexpr double nan = std::numeric_limits<double>::quiet_NaN();

// Arrays of a host, and the value that is written into each.
struct Writer {
    struct Array {
        std::vector<double>* values;
        double written;
    };
    std::vector<Array> arrays;
    int calls = 0;

    static void run(void* host, std::int32_t workers, Runner::Job job, void* context) {
        auto& [arrays, calls] = *static_cast<Writer*>(host);
        if (calls++ > 0)
            for (const auto& [values, written] : arrays) std::fill(values->begin(), values->end(), written);
        for (std::int32_t w = 0; w < workers; ++w) job(context, w);
    }
};

// The first of several calls of the runner reads the arrays.
void samples(bool in_order, bool timed) {
    Hole hole = oval_hole(70'000, 100.0, 20.0);
    if (in_order) std::sort(hole.depth.begin(), hole.depth.end());
    if (!timed) hole.time.clear();
    const auto columns = [&] { return SampleColumns{hole.depth, hole.toolface, hole.radius, hole.time}; };
    Settings settings{.bit_diameter = 0.216};
    settings.threads = 2;
    settings.start_depth = 100.0;
    Wall quiet(settings), written(settings);
    quiet.append(columns());
    Writer writer{{{&hole.depth, 119.0}, {&hole.toolface, nan}, {&hole.radius, -1.0}, {&hole.time, nan}}};
    const UseRunner use({Writer::run, &writer});
    written.append(columns());
    CHECK(writer.calls > 1);
    CHECK(bits(quiet) == bits(written));
}

// The caller's thread copies the arrays before any work is shared out.
void measures() {
    const Hole hole = oval_hole(20'000, 100.0, 40.0);
    Wall wall({.bit_diameter = 0.216});
    wall.append({hole.depth, hole.toolface, hole.radius});
    const std::vector<std::vector<double>> kept = wall.samples();
    const HelixVertices vertices{.start_depth = 100.0, .pitch = 0.1, .sectors = 64, .count = 2000};
    std::vector<double> depth = kept[0], toolface = kept[1], radius = wall.radius(), of_samples = kept[2];
    Writer writer{{{&depth, -1e300}, {&toolface, nan}, {&radius, 1e200}, {&of_samples, nan}}};
    writer.calls = 1;  // writes from the first call on
    const auto gaps = angular_gaps(vertices, {depth, toolface}, 0.05, 2);
    const auto logs = turn_logs({.radius = radius, .window = 5}, 2);
    const std::vector<double> some(8192, 102.0), zero(8192), trial(8192, 0.108);
    const auto estimate = [&] {
        Settings settings{.bit_diameter = 0.216};
        settings.threads = 2;
        return estimate_at({depth, toolface, of_samples}, {some, zero, trial, zero, zero}, settings).radius;
    };
    const auto estimates = estimate();
    const auto restored = [&] {
        depth = kept[0];
        toolface = kept[1];
        of_samples = kept[2];
    };
    const UseRunner use({Writer::run, &writer});
    CHECK(angular_gaps(vertices, {depth, toolface}, 0.05, 2) == gaps);
    restored();
    radius = wall.radius();
    const auto again = turn_logs({.radius = radius, .window = 5}, 2);
    CHECK(again.inscribed_diameter == logs.inscribed_diameter && again.mean == logs.mean);
    restored();
    CHECK(estimate() == estimates);
    CHECK(writer.calls >= 4);
}

// Corners of hexahedra that are checked, and then written over.
void corners() {
    std::vector<Vector3> vertices(8, Vector3{0.0, 0.0, 0.0});
    std::vector<Hexahedron> hexahedra(20'000, Hexahedron{0, 1, 2, 3, 4, 5, 6, 7});
    struct Host {
        std::vector<Hexahedron>& of;
        int calls;
    } host{hexahedra, 0};
    const auto run = [](void* given, std::int32_t workers, Runner::Job job, void* context) {
        Host& h = *static_cast<Host*>(given);
        if (h.calls++ > 0) std::fill(h.of.begin(), h.of.end(), Hexahedron{-9, Index{1} << 60, 8, 9, -1, 8, 8, 8});
        for (std::int32_t w = 0; w < workers; ++w) job(context, w);
    };
    const UseRunner use({run, &host});
    CHECK(volumes(vertices, hexahedra, 2) == std::vector<double>(hexahedra.size(), 0.0));
    CHECK(host.calls == 2);
}

}  // namespace

int main() {
    for (const bool in_order : {true, false})
        for (const bool timed : {true, false}) samples(in_order, timed);
    measures();
    corners();
    return failures();
}
