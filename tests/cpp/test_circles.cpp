// The nearest and the farthest of a section's points: on every instruction set it is the first one that a plain loop
// finds.
#include "measure/circles.hpp"

#include <cmath>
#include <random>

#include "check.hpp"
#include "helibore/error.hpp"
#include "search/kernel/instruction_set.hpp"

namespace {

using helibore::InstructionSet;
using helibore::Point;
namespace kernel = helibore::kernel;

const kernel::Functions* functions_of(InstructionSet level) {
    try {
        return &kernel::functions_for(level);
    } catch (const helibore::InputError&) {
        return nullptr;  // not this processor
    }
}

double square(Point a, Point b) {
    return (a.x - b.x) * (a.x - b.x) + (a.y - b.y) * (a.y - b.y);
}

bool same(kernel::Found found, std::size_t index, double of) {
    return found.index == index && found.square == of;
}

}  // namespace

int main() {
    std::mt19937 random(7);
    int tried = 0;
    for (const InstructionSet level : {InstructionSet::plain, InstructionSet::avx2, InstructionSet::avx512}) {
        const kernel::Functions* functions = functions_of(level);
        if (!functions) continue;
        for (std::size_t n = 3; n < 70; ++n) {
            for (const double grid : {4.0, 1e9}) {  // on a coarse one, many points are equally far
                helibore::Points points(n, *functions);
                const auto coordinate = [&] { return static_cast<double>(random() % 1000) * grid / 1000.0; };
                for (std::size_t i = 0; i < n; ++i)
                    points.put(i, {std::floor(coordinate()) / grid, std::floor(coordinate()) / grid});
                points.fill_packs();
                const Point from{std::floor(coordinate()) / grid, std::floor(coordinate()) / grid};
                std::size_t least = 0, most = 0;
                for (std::size_t i = 1; i < n; ++i) {
                    if (square(points[i], from) < square(points[least], from)) least = i;
                    if (square(points[i], from) > square(points[most], from)) most = i;
                }
                CHECK(same(points.nearest(from), least, square(points[least], from)));
                CHECK(same(points.farthest(from), most, square(points[most], from)));
                ++tried;
            }
        }
    }
    CHECK(tried >= 134);
    return failures();
}
