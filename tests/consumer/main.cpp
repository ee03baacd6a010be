// A few lines that rebuild a hole, as in docs/developer.md.
#include <helibore/surface.hpp>
#include <helibore/wall.hpp>
#include <iostream>

int main() {
    std::vector<double> depth, toolface, radius;
    for (int i = 0; i < 5000; ++i) {
        depth.push_back(1000.0 + i * 0.001);
        toolface.push_back(i * 37 % 360);
        radius.push_back(0.11);
    }
    helibore::Wall wall({.bit_diameter = 0.216, .sectors = 32});
    wall.append({depth, toolface, radius});
    const helibore::Settings& settings = wall.settings();
    const std::vector<double> found = wall.radius();
    const helibore::HelixRadii radii{.start_depth = wall.start_depth(),
                                     .start_toolface = settings.start_toolface,
                                     .pitch = settings.pitch,
                                     .sectors = settings.sectors,
                                     .radius = found};
    const helibore::Surface surface = helibore::surface_of(radii);
    std::cout << surface.quads.size() << " quads, radius " << found.front() << " to " << found.back() << " m\n";
}
