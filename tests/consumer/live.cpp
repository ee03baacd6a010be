// A host with its own transport: it pushes what it reads from its input, and prints what changed.
//
//     samples 2                       depth toolface radius time, one row each
//     stations 1                      depth inclination azimuth
//     image GR gAPI 8 3               three rows of depth and eight values
//
// After each push it prints the changed vertices, image rows and the depth below which the path moved; at the end every
// vertex, the image GR and the path, all numbers with all digits.
#include <helibore/error.hpp>
#include <helibore/live.hpp>
#include <iostream>
#include <limits>

namespace {

using Columns = std::vector<std::vector<double>>;

Columns read_rows(std::size_t columns, std::size_t rows) {
    Columns values(columns, std::vector<double>(rows));
    for (std::size_t row = 0; row < rows; ++row)
        for (auto& column : values) std::cin >> column[row];
    return values;
}

void push(helibore::Live& live, const std::string& kind) {
    std::size_t rows = 0;
    if (kind == "image") {
        std::string name, unit;
        std::size_t sectors = 0;
        std::cin >> name >> unit >> sectors >> rows;
        std::vector<double> depth(rows), values(rows * sectors);
        for (std::size_t row = 0; row < rows; ++row) {
            std::cin >> depth[row];
            for (std::size_t s = 0; s < sectors; ++s) std::cin >> values[row * sectors + s];
        }
        live.append_image(name, depth, values, unit);
        return;
    }
    std::cin >> rows;
    const Columns c = read_rows(kind == "samples" ? 4 : 3, rows);
    if (kind == "samples")
        live.append_samples({c[0], c[1], c[2], c[3]});
    else
        live.append_stations(c[0], c[1], c[2]);
}

void show(const helibore::Update& update) {
    std::cout << "changed";
    if (update.change)
        for (const helibore::Range range : update.change->ranges) std::cout << " " << range.start << " " << range.stop;
    std::cout << "\nquads";
    for (const helibore::Range range : update.quads(16)) std::cout << " " << range.start << " " << range.stop;
    std::cout << "\nimages";
    for (const auto& [name, range] : update.images) std::cout << " " << name << " " << range.start << " " << range.stop;
    std::cout << "\npath";
    if (update.path_from) std::cout << " " << *update.path_from;
    for (const std::string& event : update.events) std::cout << "\nevent " << event;
    std::cout << "\n";
}

void show(const char* name, const std::vector<double>& values) {
    std::cout << name;
    for (const double value : values) std::cout << " " << value;
    std::cout << "\n";
}

}  // namespace

int main() {
    std::cout.precision(std::numeric_limits<double>::max_digits10);
    helibore::Live live({.wall = {.bit_diameter = 0.216, .sectors = 16, .start_depth = 100.0, .direct = true}});
    for (std::string kind; std::cin >> kind;) {
        push(live, kind);
        show(live.poll());
    }
    const helibore::VertexColumns vertices = live.wall().vertices();
    show("depth", vertices.depth);
    show("radius", vertices.radius);
    show("nearest", vertices.nearest);
    show("image_depth", live.image("GR").depth);
    show("image_values", live.image("GR").values);
    for (const helibore::Vector3& place : live.path()->position(vertices.depth))
        show("position", {place.begin(), place.end()});
}
