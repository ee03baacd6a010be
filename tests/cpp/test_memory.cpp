// However samples arrive, a wall uses at most 48 bytes for each sample and 24 for each vertex, as glibc's allocator
// counts them (others do not count).
#include <algorithm>
#include <cstdlib>
#include <string>

#include "check.hpp"
#include "hole.hpp"

#if defined(__GLIBC__) && !defined(__SANITIZE_ADDRESS__) && !defined(__SANITIZE_THREAD__)
#include <malloc.h>

namespace {

using helibore::Wall;

std::size_t in_use() {
    const auto now = mallinfo2();
    return now.uordblks + now.hblkhd;
}

// Appends a hole, its first rows at once and the others part by part, and says where it takes more than its share.
void keep_small(const std::string& name, const Hole& hole, std::size_t a_part, double pitch = 5.0,
                std::size_t first_rows = 0) {
    const std::size_t before = in_use();
    std::size_t used = 0;
    double allowed = 2e6;  // lists of candidates and a block of vertices
    {
        Wall wall({.bit_diameter = 0.216, .sectors = 3, .pitch = pitch, .max_iterations = 1});
        if (first_rows > 0) wall.append(hole.rows(0, first_rows));
        for (std::size_t first = first_rows; first < hole.depth.size(); first += a_part)
            wall.append(hole.rows(first, std::min(a_part, hole.depth.size() - first)));
        used = in_use() - before;
        allowed += 48.0 * static_cast<double>(wall.sample_count()) + 24.0 * static_cast<double>(wall.size());
    }
    if (static_cast<double>(used) > allowed)
        fail(__FILE__, __LINE__, name + ": " + std::to_string(static_cast<double>(used) / allowed) + " of the share");
}

Hole in_order(Hole hole, bool down) {
    std::sort(hole.depth.begin(), hole.depth.end());
    if (!down) std::reverse(hole.depth.begin(), hole.depth.end());
    return hole;
}

// Every row twice, one after the other.
Hole doubled(const Hole& hole) {
    Hole twice;
    for (std::size_t i = 0; i < hole.depth.size(); ++i)
        for (int j = 0; j < 2; ++j) {
            twice.depth.push_back(hole.depth[i]);
            twice.toolface.push_back(hole.toolface[i]);
            twice.radius.push_back(hole.radius[i]);
            twice.time.push_back(hole.time[i]);
        }
    return twice;
}

}  // namespace

int main() {
    const Hole scattered = oval_hole(100'000, 10.0, 100.0);
    for (const std::size_t a_part : {10u, 1000u, 2049u, 4097u, 36'865u}) {
        const std::string rows = std::to_string(a_part) + " rows at a time, ";
        keep_small(rows + "downwards", in_order(scattered, true), a_part);
        keep_small(rows + "upwards", in_order(scattered, false), a_part, -5.0);
        keep_small(rows + "each twice", doubled(in_order(scattered, true)), a_part);
        if (a_part >= 1000) keep_small(rows + "anywhere", scattered, a_part);
    }
    Hole late = in_order(oval_hole(24'000, 10.0, 100.0), true);
    for (int i = 0; i < 4000; ++i) {
        late.depth.push_back(50.0 + i % 7);
        late.toolface.push_back(i % 360);
        late.radius.push_back(0.11);
        late.time.push_back(1e6 + i);
    }
    keep_small("late rows, one at a time", late, 1, 5.0, 24'000);
    return failures();
}
#else
int main() {
    return 0;
}
#endif
