// The n-th allocation fails, for n = 1, 2, ... until an append succeeds: each failure is a std::bad_alloc in the
// caller's thread, leaves every bit as it was, and the append that succeeds gives what it always gives.
#include <new>

#include "check.hpp"
#include "failing_allocation.hpp"
#include "hole.hpp"

namespace {

using helibore::Settings;
using helibore::Wall;

// Fails the n-th allocation of an append; false if it has fewer.
bool append_failing(Wall& wall, const helibore::SampleColumns& added, long n) {
    bool failed = false;
    until_failure = n;
    try {
        wall.append(added);
    } catch (const std::bad_alloc&) {
        failed = true;
    }
    const bool reached = until_failure < 0;
    until_failure = -1;
    CHECK(failed == reached);
    return failed;
}

// Fails every allocation of one append in turn; returns how many there are.
long fail_each(const Settings& settings, const helibore::SampleColumns& before, const helibore::SampleColumns& added) {
    Wall expected(settings);
    expected.append(before);
    expected.append(added);
    for (long n = 0;; ++n) {
        Wall wall(settings);
        wall.append(before);
        const auto kept = bits(wall);
        const bool failed = append_failing(wall, added, n);
        if (failed) {
            CHECK(bits(wall) == kept);
            wall.append(added);
        }
        CHECK(bits(wall) == bits(expected));
        if (!failed) return n;
    }
}

// An append of close samples fails, then wide samples follow. If the wall kept the short distances that the failed
// append found, it would take later samples for too far away to matter.
void fail_and_go_another_way() {
    const Settings settings{.bit_diameter = 0.216, .sectors = 48, .pitch = 0.05, .start_depth = 10.0};
    const Hole close = oval_hole(9000, 10.0, 14.0), wide = oval_hole(120, 10.0, 6.0), late = oval_hole(20, 13.9, 0.2);
    Wall expected(settings);
    expected.append(wide.all());
    expected.append(late.all());
    for (long n = 0;; ++n) {
        Wall wall(settings);
        wall.append({});
        if (!append_failing(wall, close.all(), n)) {
            CHECK(n > 10);
            return;
        }
        wall.append(wide.all());
        wall.append(late.all());
        CHECK(bits(wall) == bits(expected));
    }
}

}  // namespace

int main() {
    const double length = 2.0 / reduced;
    const Hole hole = oval_hole(9000 / reduced, 10.0, length),
               deeper = oval_hole(6000 / reduced, 10.0 + length, 0.5 * length);
    for (const int threads : {1, 3}) {
        const Settings down{.bit_diameter = 0.216, .sectors = 48, .pitch = 0.05, .threads = threads};
        Settings fixed = down, up = down, direct = down;
        direct.direct = true;
        fixed.start_depth = 10.0 - 0.5 * length;
        fixed.window = 100;
        up.pitch = -0.05;
        CHECK(fail_each(down, {}, hole.all()) > 10);            // the first samples
        CHECK(fail_each(down, hole.all(), deeper.all()) > 10);  // below all
        CHECK(fail_each(direct, hole.all(), deeper.all()) > 10);
        CHECK(fail_each(down, deeper.all(), hole.all()) > 10);  // above all: the helix starts anew
        CHECK(fail_each(fixed, hole.all(), oval_hole(300, 10.0 + 0.25 * length, 0.1 * length).rows(0, 300)) >
              3);                                             // in between
        CHECK(fail_each(up, hole.all(), deeper.all()) > 10);  // logging up
        auto untimed = hole.all(), more = deeper.all();
        untimed.time = more.time = {};
        CHECK(fail_each(down, untimed, more) > 10);
    }
    const Settings shared{.bit_diameter = 0.216, .sectors = 48, .pitch = 0.02, .threads = 2};
    CHECK(fail_each(shared, {}, oval_hole(9000 / reduced, 10.0, 2.0).all()) > 10);  // 4,800 vertices on two threads
    fail_and_go_another_way();
    return failures();
}
