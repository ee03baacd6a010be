// A host that uses GLM of its own, by any version and macros, and prints the bits of a path and of its own vectors.
#include <cstdio>
#include <glm/glm.hpp>
#include <helibore/path.hpp>

int main() {
    const double stations[] = {0.0, 500.0, 1100.0}, inclination[] = {0.0, 10.0, 35.0}, azimuth[] = {40.0, 40.0, 55.0};
    const helibore::Path path{helibore::Survey(stations, inclination, azimuth)};
    const double at[] = {123.4, 777.7, 1099.0};
    for (const auto& p : path.position(at)) std::printf("%a %a %a\n", p[0], p[1], p[2]);
    for (const auto& frame : path.frame(std::span(at).subspan(1)))
        for (const auto& axis : frame) std::printf("%a %a %a\n", axis[0], axis[1], axis[2]);
    const glm::dvec3 across = glm::normalize(glm::cross(glm::dvec3(1.0, 2.0, 3.0), glm::dvec3(3.0, 1.0, 2.0)));
    std::printf("%.12f %.12f %.12f\n", across.x, across.y, across.z);
}
