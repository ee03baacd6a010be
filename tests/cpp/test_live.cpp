// The host API: pushes in parts and from two threads give the bits of the batch, and a poll reports all that changed.
#include <algorithm>
#include <cstring>
#include <limits>
#include <thread>

#include "check.hpp"
#include "helibore/error.hpp"
#include "helibore/image.hpp"
#include "helibore/live.hpp"
#include "hole.hpp"
#include "host.hpp"

using helibore::Index;
using helibore::InputError;
using helibore::Live;
using helibore::Range;
using helibore::Update;

namespace {

const helibore::LiveSettings settings{.wall = {.bit_diameter = 0.216, .sectors = 16, .start_depth = 1000.0}};
constexpr double nan = std::numeric_limits<double>::quiet_NaN();

bool within(const std::vector<Range>& ranges, Index k) {
    return std::any_of(ranges.begin(), ranges.end(), [k](Range r) { return r.start <= k && k < r.stop; });
}

// One thread pushes, another polls and updates a copy of the radii from the polls: in the end it equals the wall.
void parts_threads_and_polls() {
    const Hole hole = oval_hole(4000, 1000.0, 12.0);
    Live live(settings);
    std::vector<double> copy;
    Index reported = 0;
    const auto follow = [&] {
        const Update update = live.poll();
        if (!update.change) return;
        reported += update.change->accepted;
        for (const Range range : update.change->ranges) {
            if (static_cast<Index>(copy.size()) < range.stop) copy.resize(static_cast<std::size_t>(range.stop));
            const std::vector<double> radius = live.wall().vertices(range).radius;
            std::copy(radius.begin(), radius.end(), copy.begin() + range.start);
        }
    };
    std::thread pushes([&] {
        for (std::size_t at = 0; at < 4000; at += 50) live.append_samples(hole.rows(at, 50));
    });
    while (reported < 4000) follow();
    pushes.join();
    helibore::Wall batch(settings.wall);
    batch.append(hole.all());
    CHECK(bits(live.wall()) == bits(batch));
    CHECK(copy.size() == batch.radius().size());
    CHECK(std::memcmp(copy.data(), batch.radius().data(), copy.size() * sizeof(double)) == 0);
    CHECK(!live.poll().change);
}

void quads_of_a_change() {
    const Hole hole = oval_hole(2000, 1000.0, 5.0);
    Live live(settings);
    CHECK(live.append_samples(hole.all()).change->accepted == 2000);
    const double one[] = {1002.5}, angle[] = {33.0}, radius[] = {0.12}, time[] = {1e6};
    const Update update = live.append_samples({one, angle, radius, time});
    const std::vector<Range> quads = update.quads(16);
    for (Index k = 0; k + 17 < live.wall().size(); ++k) {
        bool changed = false;
        for (const Index corner : {k, k + 1, k + 16, k + 17})
            changed = changed || within(update.change->ranges, corner);
        if (changed) CHECK(within(quads, k));
    }
    CHECK(!within(quads, 0) && Update{}.quads(16).empty());
    const Update both = live.poll();
    CHECK(both.change->accepted == 2001 && both.change->ranges == (std::vector<Range>{{0, live.wall().size()}}));
}

// A host that never polls: samples 4 m apart, each with a reach of 1 m, all over the hole and in any order.
void an_update_is_bounded() {
    Live live({.wall = {.bit_diameter = 0.216, .sectors = 16, .start_depth = 1000.0}});
    std::vector<Range> every;
    const double deepest[] = {20000.0}, angle[] = {0.0}, radius[] = {0.11};
    live.append_samples({deepest, angle, radius});
    live.poll();
    for (int i = 0; i < 3000; ++i) {
        const double depth[] = {1000.0 + 4.0 * (i * 1237 % 3000) + 0.1 * (i % 7)};
        const Update update = live.append_samples({depth, angle, radius});
        every.insert(every.end(), update.change->ranges.begin(), update.change->ranges.end());
    }
    const Update update = live.poll();
    const std::vector<Range>& reported = update.change->ranges;
    CHECK(reported.size() == Update::most_ranges && update.change->accepted == 3000);
    for (std::size_t i = 1; i < reported.size(); ++i) CHECK(reported[i - 1].stop < reported[i].start);
    for (const Range range : every)
        CHECK(std::any_of(reported.begin(), reported.end(),
                          [range](Range one) { return one.start <= range.start && range.stop <= one.stop; }));
}

void stations() {
    Live live(settings);
    const double depth[] = {0.0, 50.0, 130.0}, inclination[] = {0.0, 5.0, 9.0}, azimuth[] = {0.0, 10.0, 20.0};
    CHECK(!live.path());
    CHECK(live.append_stations(depth, inclination, azimuth).path_from == 0.0);
    const double above[] = {20.0, 50.0}, below[] = {90.0};
    const auto there = live.path()->position(above);
    const auto then = live.path()->position(below);
    live.poll();
    const double late[] = {80.0}, low[] = {3.0}, south[] = {200.0};
    CHECK(live.append_stations(late, low, south).path_from == 50.0);
    CHECK(live.path()->position(above) == there && live.path()->position(below) != then);
    CHECK(!live.append_stations(late, low, south).path_from);
    const double bad[] = {90.0, nan}, over[] = {190.0, 1.0}, north[] = {0.0, 0.0};
    const Update refused = live.append_stations(bad, over, north);
    CHECK(!refused.path_from && refused.events.size() == 2 && live.survey()->depth().size() == 4);
    CHECK(refused.events[1] == "station at nan m: depth must be finite");
    const Update update = live.poll();
    CHECK(update.path_from == 50.0 && update.events == refused.events && !update.change);
    CHECK(live.path()->stop_depth() == 230.0);
    const double no_depth[] = {nan}, first_dip[] = {inclination[0]}, first_way[] = {azimuth[0]};
    CHECK(live.append_stations(no_depth, first_dip, first_way).events.size() == 1);  // like the first but for its depth
}

void image_rows() {
    Live live(settings);
    const double depth[] = {1002.0, 1001.0}, values[] = {1, 2, 3, 4, 5, 6};
    CHECK(live.append_image("GR", depth, values, "gAPI").images.at("GR") == (Range{0, 2}));
    const double again[] = {1002.0}, other[] = {7, 8, 9};
    CHECK(live.append_image("GR", again, other).images.at("GR") == (Range{2, 3}));
    CHECK(live.poll().images.at("GR") == (Range{0, 3}) && live.poll().images.empty());
    const helibore::ImageArrays image = live.image("GR");
    CHECK(image.depth == (std::vector<double>{1001.0, 1002.0}) && image.sectors == 3 && image.unit == "gAPI");
    CHECK(image.values == (std::vector<double>{4, 5, 6, 7, 8, 9}));
    CHECK(live.images() == std::vector<std::string>{"GR"});
    const helibore::ImageArrays came = live.rows("GR", {1, 3}), nothing = live.rows("GR", {3, 3});
    CHECK(came.depth == (std::vector<double>{1001.0, 1002.0}) && came.sectors == 3 && came.unit == "gAPI");
    CHECK(came.values == (std::vector<double>{4, 5, 6, 7, 8, 9}) && nothing.depth.empty() && nothing.values.empty());
    CHECK_THROWS(InputError, "rows = [2, 4): must lie within the 3 rows of image 'GR'", live.rows("GR", {2, 4}));
    CHECK_THROWS(InputError, "rows = [-1, 2): must lie within the 3 rows of image 'GR'", live.rows("GR", {-1, 2}));
    CHECK_THROWS(InputError, "image 'X': is not there", live.rows("X", {0, 0}));
    const double low[] = {1000.5, 1001.5}, high[] = {1001.5, 1002.5}, sector[] = {0.5, 1.5, 2.5};
    const auto quads = helibore::cell_values({image.depth, image.values, image.sectors}, low, high,
                                             {.start_depth = 1001.0, .pitch = 0.3, .count = 3, .sector = sector});
    CHECK(quads == (std::vector<double>{4, 5, 6}));
}

void refusals() {
    CHECK_THROWS(InputError, "start_depth: must be set: the vertices of a live wall keep their numbers",
                 Live({.wall = {.bit_diameter = 0.2}}));
    CHECK_THROWS(InputError, "extend = -1: must be finite and not negative",
                 Live({.wall = settings.wall, .path = {.extend = -1.0}}));
    Live live(settings);
    const double one[] = {1.0}, two[] = {1.0, 2.0}, none[] = {nan};
    CHECK_THROWS(InputError, "toolface[0] = nan: must be finite", live.append_samples({one, none, one}));
    CHECK_THROWS(InputError, "inclination has 1 values, depth has 2: must be equal",
                 live.append_stations(two, one, two));
    CHECK_THROWS(InputError, "depth[0] = nan: must be finite", live.append_image("GR", none, two));
    CHECK_THROWS(InputError, "values has 1 values, depth has 2: each depth must have equally many values",
                 live.append_image("GR", two, one));
    live.append_image("GR", one, two);
    CHECK_THROWS(InputError, "values has 1 sectors: image 'GR' has 2", live.append_image("GR", one, one));
    CHECK_THROWS(InputError, "image 'X': is not there", live.image("X"));
    CHECK_THROWS(InputError, "sectors = 2: must be 3 or more", Update{}.quads(2));
    CHECK(live.wall().sample_count() == 0 && live.image("GR").depth.size() == 1);
}

}  // namespace

int main() {
    parts_threads_and_polls();
    quads_of_a_change();
    an_update_is_bounded();
    stations();
    image_rows();
    in_every_host_state(refusals);
    return failures();
}
