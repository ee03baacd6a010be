// A host's plug-in that rebuilds a hole on four threads; test_unload.cpp loads, calls and unloads it.
#include "helibore/logs.hpp"
#include "helibore/surface.hpp"
#include "hole.hpp"

extern "C" __attribute__((visibility("default"))) long rebuild() {
    const Hole hole = oval_hole(6000, 100.0, 17.0);
    helibore::Wall wall({.bit_diameter = 0.216, .sectors = 64, .threads = 4});
    wall.append(hole.all());
    const std::vector<double> radius = wall.radius();
    const helibore::HelixRadii radii{.start_depth = wall.start_depth(), .radius = radius};
    helibore::turn_logs({.radius = radius}, 4);
    return static_cast<long>(helibore::surface_of(radii, {}, 4).quads.size());
}
