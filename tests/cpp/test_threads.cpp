// Everything that starts threads, or that several threads may use, with enough work for several: the same bits as on
// one thread. This is the test for ThreadSanitizer (`./develop sanitize`).
#include <algorithm>
#include <atomic>
#include <cstring>
#include <thread>

#include "check.hpp"
#include "helibore/error.hpp"
#include "helibore/image.hpp"
#include "helibore/logs.hpp"
#include "helibore/surface.hpp"
#include "helibore/wits.hpp"
#include "hole.hpp"

using helibore::Index;

namespace {

constexpr int many_threads = 4;
constexpr int sectors = 32;

helibore::Wall wall_of(const Hole& hole, int threads) {
    helibore::Wall wall({.bit_diameter = 0.216, .sectors = sectors, .start_depth = 1000.0, .threads = threads});
    wall.append(hole.all());
    return wall;
}

template <class T>
bool same(const std::vector<T>& a, const std::vector<T>& b) {
    return a.size() == b.size() && std::memcmp(a.data(), b.data(), a.size() * sizeof(T)) == 0;
}

void a_whole_wall() {
    const Hole hole = oval_hole(60'000, 1000.0, 60.0);
    const helibore::Wall one = wall_of(hole, 1), many = wall_of(hole, many_threads);
    CHECK(bits(one) == bits(many));
    const std::vector<double> channel = one.samples()[2];
    const std::span<const double> channels[] = {channel};
    CHECK(same(one.interpolate_samples(channels, 1)[0], one.interpolate_samples(channels, many_threads)[0]));
    CHECK_THROWS(helibore::InputError, "threads = 0: must lie in 1 to 1024", one.interpolate_samples(channels, 0));
}

void what_follows_from_it() {
    const std::vector<double> radius = wall_of(oval_hole(60'000, 1000.0, 60.0), many_threads).radius();
    const helibore::HelixRadii helix{.start_depth = 1000.0, .sectors = sectors, .radius = radius};
    const helibore::Surface one = surface_of(helix, {}, 1), many = surface_of(helix, {}, many_threads);
    CHECK(same(one.vertices, many.vertices) && same(one.quads, many.quads));
    CHECK(same(helibore::turn_logs({.sectors = sectors, .radius = radius}, 1).rugosity,
               helibore::turn_logs({.sectors = sectors, .radius = radius}, many_threads).rugosity));

    std::vector<double> depth, values, low, high, sector;
    for (int row = 0; row < 600; ++row) {
        depth.push_back(1000.05 + 0.1 * row);
        low.push_back(1000.0 + 0.1 * row);
        high.push_back(1000.1 + 0.1 * row);
        for (int s = 0; s < 8; ++s) values.push_back(row * 8 + s);
    }
    for (int k = 0; k < sectors; ++k) sector.push_back(0.25 * k);
    const helibore::QuadCentres quads{.start_depth = 1000.0, .count = one.quad_index.back(), .sector = sector};
    CHECK(same(cell_values({depth, values, 8}, low, high, quads, 1),
               cell_values({depth, values, 8}, low, high, quads, many_threads)));
    CHECK(same(linear_values({depth, values, 8}, 1.0, quads, 1),
               linear_values({depth, values, 8}, 1.0, quads, many_threads)));

    std::vector<double> outer = radius;
    for (double& r : outer) r += 0.05;
    const std::span<const double> shells[] = {radius, outer};
    const helibore::VolumeLayout layout = volume_layout(helix, shells);
    std::vector<helibore::Hexahedron> first(static_cast<std::size_t>(layout.hexahedron_count)), second(first);
    join(helix, layout, first, 1);
    join(helix, layout, second, many_threads);
    CHECK(same(first, second));
}

// Two threads append, two read; one of these reads the range that an append reported.
void appends_beside_reads() {
    const Hole hole = oval_hole(20'000, 1000.0, 20.0);
    helibore::Wall wall({.bit_diameter = 0.216, .sectors = sectors, .start_depth = 1000.0, .threads = 2});
    std::atomic<int> over = 0;
    std::atomic<Index> reached = 0;
    {
        std::vector<std::jthread> threads;
        for (std::size_t half = 0; half < 2; ++half)
            threads.emplace_back([&, half] {
                for (std::size_t at = half * 2000; at < 20'000; at += 4000) {
                    const helibore::Change change = wall.append(hole.rows(at, 2000));
                    if (!change.ranges.empty()) reached = change.ranges.back().stop;
                }
                ++over;
            });
        threads.emplace_back([&] {
            while (over < 2) CHECK(static_cast<Index>(wall.vertices({0, reached}).radius.size()) <= wall.size());
        });
        threads.emplace_back([&] {
            while (over < 2) CHECK(wall.settled() <= wall.size() && wall.samples().size() >= 3);
        });
    }
    CHECK(bits(wall) == bits(wall_of(hole, 1)));
}

// Walls of one host one after another and at once; the radii into the host's own memory.
void walls_at_once() {
    const Hole hole = oval_hole(60'000, 1000.0, 60.0);
    const std::vector<std::uint64_t> expected = bits(wall_of(hole, 1));
    std::vector<std::jthread> hosts;
    for (int h = 0; h < 3; ++h)
        hosts.emplace_back([&, h] {
            for (int i = 0; i < 6; ++i) {
                hole.all().validate(2);
                helibore::Wall wall(
                    {.bit_diameter = 0.216, .sectors = sectors, .start_depth = 1000.0, .threads = 1 + (h + i) % 4});
                wall.append(hole.all());
                std::vector<double> radius(static_cast<std::size_t>(wall.size()));
                CHECK(wall.read_radius(radius) == wall.size());
                CHECK(same(radius, wall.radius()));
                CHECK(bits(wall) == expected);
            }
        });
    for (std::jthread& host : hosts) host.join();

    const helibore::Wall wall = wall_of(hole, 2);
    std::vector<double> other(static_cast<std::size_t>(wall.size()) + 1, 7.0);
    CHECK(wall.read_radius(other) == wall.size());
    CHECK(std::count(other.begin(), other.end(), 7.0) == static_cast<std::ptrdiff_t>(other.size()));
    CHECK(helibore::Wall({.bit_diameter = 0.216}).read_radius({}) == 0);

    // The samples are copied into memory of the host.
    const auto samples = wall.samples();
    std::vector<std::vector<double>> mine(samples.size(), std::vector<double>(samples[0].size(), 7.0));
    std::vector<std::span<double>> into(mine.begin(), mine.end());
    CHECK(!wall.read_samples(std::span(into).first(2)));
    into[2] = into[2].first(1);
    CHECK(!wall.read_samples(into) && mine[0][0] == 7.0);
    into[2] = mine[2];
    CHECK(wall.read_samples(into));
    for (std::size_t i = 0; i < into.size(); ++i) CHECK(same(mine[i], samples[i]));

    // Vertices that are not settled show the radii of samples.
    helibore::Wall live({.bit_diameter = 0.216, .sectors = sectors, .start_depth = 1000.0, .direct = true});
    live.append(hole.all());
    std::vector<double> shown(static_cast<std::size_t>(live.size()));
    CHECK(live.read_radius(shown) == live.size());
    const std::vector<std::uint8_t> provisional = live.provisional();
    CHECK(std::count(provisional.begin(), provisional.end(), 1) > 0);
    CHECK(same(shown, live.radius()));
}

// A batch of 120,000 timed samples lies in large pages, appends of 5,000 do not.
void a_batch_in_large_pages() {
    const Hole hole = oval_hole(120'000, 1000.0, 20.0);
    helibore::Wall streamed({.bit_diameter = 0.216, .sectors = sectors, .start_depth = 1000.0});
    for (std::size_t first = 0; first < 120'000; first += 5000) streamed.append(hole.rows(first, 5000));
    CHECK(bits(wall_of(hole, many_threads)) == bits(streamed));
}

void one_parser() {
    helibore::wits::Parser parser;
    std::atomic<Index> found = 0;
    {
        std::vector<std::jthread> threads;
        for (int i = 0; i < many_threads; ++i)
            threads.emplace_back([&] {
                for (int n = 0; n < 500; ++n)
                    found += static_cast<Index>(parser.feed("&&\r\n01081.5\r\n0110x\r\n!!\r\n").frames.size());
            });
    }
    CHECK(found == 500 * many_threads && parser.counts().not_numbers == 500 * many_threads);
}

}  // namespace

int main() {
    a_whole_wall();
    what_follows_from_it();
    appends_beside_reads();
    walls_at_once();
    a_batch_in_large_pages();
    one_parser();
    return failures();
}
