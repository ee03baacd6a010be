// The C interface: the numbers of the C++ interface; a status and an exact text for every kind of bad input, in any
// order of calls and from any thread; memory that ends at any point; the host's threads.
#include <array>
#include <atomic>
#include <cmath>
#include <cstring>
#include <functional>
#include <limits>
#include <new>
#include <thread>

#include "check.hpp"
#include "failing_allocation.hpp"
#include "helibore/estimates.hpp"
#include "helibore/helibore.h"
#include "helibore/live.hpp"
#include "helibore/logs.hpp"
#include "helibore/passage.hpp"
#include "helibore/preparation.hpp"
#include "helibore/surface.hpp"
#include "helibore/zones.hpp"
#include "hole.hpp"
#include "host.hpp"
#include "measure/zone_columns.hpp"

namespace {

constexpr double nan = std::numeric_limits<double>::quiet_NaN();
using Bits = std::vector<std::uint64_t>;

const double station_depth[] = {0.0, 60.0, 140.0}, inclination[] = {0.0, 12.0, 40.0}, azimuth[] = {30.0, 30.0, 75.0};

void add(Bits& bits, std::span<const double> values) {
    for (const double value : values) bits.push_back(std::isnan(value) ? 0 : std::bit_cast<std::uint64_t>(value));
}

template <class T>
T sized() {
    T made = {};
    made.size = sizeof made;
    return made;
}

hb_settings settings_of(double bit_diameter = 0.216) {
    auto settings = sized<hb_settings>();
    CHECK(hb_settings_init(&settings) == HB_OK);
    settings.bit_diameter = bit_diameter;
    settings.sectors = 48;
    settings.pitch = 0.05;
    settings.start_depth = 100.0;
    return settings;
}

hb_path_settings path_settings() {
    auto settings = sized<hb_path_settings>();
    CHECK(hb_path_settings_init(&settings) == HB_OK);
    settings.reference = HB_PARALLEL_TRANSPORT;
    return settings;
}

std::int64_t new_wall() {
    const hb_settings settings = settings_of();
    std::int64_t wall = 0;
    CHECK(hb_wall_create(&settings, &wall) == HB_OK);
    return wall;
}

std::int64_t new_path() {
    const hb_path_settings settings = path_settings();
    std::int64_t path = 0;
    CHECK(hb_path_create(&settings, 3, station_depth, inclination, azimuth, &path) == HB_OK);
    return path;
}

int32_t append(std::int64_t wall, const helibore::SampleColumns& rows, hb_change* change = nullptr) {
    return hb_wall_append(wall, std::ssize(rows.depth), rows.depth.data(), rows.toolface.data(), rows.radius.data(),
                          rows.time.data(), change);
}

// All that a wall's handle gives, bit for bit.
Bits read_c(std::int64_t wall, std::int64_t path) {
    auto state = sized<hb_wall_state>();
    CHECK(hb_wall_get(wall, &state) == HB_OK);
    Bits bits = {static_cast<std::uint64_t>(state.vertices), static_cast<std::uint64_t>(state.samples),
                 static_cast<std::uint64_t>(state.settled)};
    add(bits, {&state.start_depth, 1});
    std::vector<double> values(static_cast<std::size_t>(state.vertices));
    for (std::int32_t column = HB_DEPTH; column <= HB_PROVISIONAL; ++column) {
        CHECK(hb_wall_read(wall, column, 0, state.vertices, values.data()) == HB_OK);
        add(bits, values);
    }
    std::vector<double> samples(static_cast<std::size_t>(state.samples));
    for (const std::int32_t column : {HB_DEPTH, HB_TOOLFACE, HB_RADIUS, HB_TIME}) {
        std::int64_t count = state.samples;
        CHECK(hb_wall_samples(wall, column, &count, samples.data()) == HB_OK && count == state.samples);
        add(bits, samples);
    }
    std::int64_t count = state.vertices;
    CHECK(hb_wall_interpolate(wall, state.samples, samples.data(), &count, values.data()) == HB_OK);
    add(bits, values);
    std::int64_t turns = 0;
    CHECK(hb_wall_logs(wall, 5, &turns, nullptr) == HB_BUFFER_TOO_SMALL && turns == state.vertices / 48);
    std::vector<double> logs(static_cast<std::size_t>(turns * HB_LOG_COLUMNS));
    CHECK(hb_wall_logs(wall, 5, &turns, logs.data()) == HB_OK);
    add(bits, logs);
    const double start[] = {-0.2}, stop[] = {0.2}, diameter[] = {0.1};
    std::vector<double> passage(static_cast<std::size_t>(turns * HB_PASSAGE_COLUMNS));
    CHECK(hb_wall_passage(wall, path, 1, start, stop, diameter, 0, nullptr, nullptr, &turns, passage.data()) == HB_OK);
    add(bits, passage);
    std::int64_t rows = 0, quad_count = 0;
    CHECK(hb_wall_surface(wall, path, 10, state.vertices, &rows, nullptr, nullptr, &quad_count, nullptr) ==
          HB_BUFFER_TOO_SMALL);
    std::vector<double> vertices(static_cast<std::size_t>(3 * rows));
    std::vector<std::int64_t> index(static_cast<std::size_t>(rows)), quads(static_cast<std::size_t>(4 * quad_count));
    CHECK(hb_wall_surface(wall, path, 10, state.vertices, &rows, vertices.data(), index.data(), &quad_count,
                          quads.data()) == HB_OK);
    add(bits, vertices);
    bits.insert(bits.end(), index.begin(), index.end());
    bits.insert(bits.end(), quads.begin(), quads.end());
    return bits;
}

helibore::Path cpp_path() {
    return helibore::Path(helibore::Survey(station_depth, inclination, azimuth),
                          {.reference = helibore::Reference::parallel_transport});
}

// The same from C++.
Bits read_cpp(const helibore::Wall& wall) {
    const helibore::VertexColumns v = wall.vertices();
    Bits bits = {static_cast<std::uint64_t>(wall.size()), static_cast<std::uint64_t>(wall.sample_count()),
                 static_cast<std::uint64_t>(wall.settled())};
    const double start = wall.start_depth();
    add(bits, {&start, 1});
    for (const auto* column : {&v.depth, &v.toolface, &v.radius, &v.nearest}) add(bits, *column);
    for (const auto* column : {&v.support, &v.iterations})
        add(bits, {std::vector<double>(column->begin(), column->end())});
    add(bits, {std::vector<double>(v.provisional.begin(), v.provisional.end())});
    const auto samples = wall.samples();
    for (const auto& column : samples) add(bits, column);
    const std::span<const double> time(samples[3]);
    add(bits, wall.interpolate_samples({&time, 1})[0]);
    const helibore::TurnLogs logs = helibore::turn_logs({.sectors = 48, .radius = v.radius, .window = 5});
    for (const auto* column :
         {&logs.coverage, &logs.mean, &logs.mean_square, &logs.smallest, &logs.largest, &logs.c1, &logs.c1_toolface,
          &logs.c2, &logs.least_diameter, &logs.diameter_0, &logs.diameter_90, &logs.centre_0, &logs.centre_90,
          &logs.inscribed_diameter, &logs.inscribed_0, &logs.inscribed_90, &logs.enclosing_diameter, &logs.rugosity})
        add(bits, *column);
    const helibore::RigidBody body[] = {{-0.2, 0.2, 0.1}};
    const helibore::Passage passage =
        helibore::passage({.start_depth = start, .pitch = 0.05, .sectors = 48, .radius = v.radius}, cpp_path(), body);
    for (const auto* column : {&passage.clearance, &passage.low, &passage.high}) add(bits, *column);
    std::vector<double> depth, toolface, of_body;
    for (std::size_t i = 0; i < passage.contact_body.size(); i += helibore::most_contacts) {
        depth.push_back(passage.contact_depth[i]), toolface.push_back(passage.contact_toolface[i]);
        of_body.push_back(static_cast<double>(passage.contact_body[i]));
    }
    for (const auto* column : {&depth, &toolface, &of_body}) add(bits, *column);
    const helibore::Surface surface = helibore::surface_of(
        {.start_depth = start, .pitch = 0.05, .sectors = 48, .first = 10, .radius = std::span(v.radius).subspan(10)},
        cpp_path());
    for (const auto& vertex : surface.vertices) add(bits, vertex);
    bits.insert(bits.end(), surface.vertex_index.begin(), surface.vertex_index.end());
    for (const auto& quad : surface.quads) bits.insert(bits.end(), quad.begin(), quad.end());
    return bits;
}

const Hole hole = oval_hole(4000, 100.0, 12.0);

void same_numbers_as_cpp() {
    helibore::Wall expected({.bit_diameter = 0.216, .sectors = 48, .pitch = 0.05, .start_depth = 100.0});
    const std::int64_t wall = new_wall(), path = new_path();
    for (const std::size_t first : {0u, 2000u}) {
        const helibore::Change change = expected.append(hole.rows(first, 2000));
        auto same = sized<hb_change>();
        CHECK(append(wall, hole.rows(first, 2000), &same) == HB_OK);
        CHECK(same.settled == change.settled && same.accepted == 2000 && same.redundant == 0);
        std::vector<helibore::Range> ranges(static_cast<std::size_t>(same.ranges));
        std::int64_t count = same.ranges;
        CHECK(hb_ranges(wall, &count, &ranges.data()->start) == HB_OK && ranges == change.ranges);
    }
    const Bits bits = read_cpp(expected);
    CHECK(read_c(wall, path) == bits);
    const double at[] = {10.0, 77.0};
    double position[6], frame[18];
    CHECK(hb_path_read(path, 2, at, position, frame) == HB_OK);
    CHECK(std::memcmp(position, cpp_path().position(at).data(), sizeof position) == 0);
    CHECK(std::memcmp(frame, cpp_path().frame(at).data(), sizeof frame) == 0);
    {
        const HostState host(FE_UPWARD, true);
        CHECK(read_c(wall, path) == bits);
    }
    CHECK(hb_close(wall) == HB_OK && hb_close(path) == HB_OK);
}

// The zones of C++, of one wall and with one set of criteria.
void zones() {
    helibore::Wall expected({.bit_diameter = 0.216, .sectors = 48, .pitch = 0.05, .start_depth = 100.0});
    expected.append(hole.all());
    const std::int64_t wall = new_wall();
    CHECK(append(wall, hole.all()) == HB_OK);
    const helibore::VertexColumns v = expected.vertices();
    const auto samples = expected.samples();
    Bits of_c, of_cpp;
    auto criteria = sized<hb_zone_criteria>();
    CHECK(hb_zone_criteria_init(&criteria) == HB_OK);
    std::int64_t turns = 0, zone_count = 0;
    CHECK(hb_wall_zones(wall, &criteria, &turns, nullptr, &zone_count, nullptr) == HB_BUFFER_TOO_SMALL);
    CHECK(zone_count >= 1 && turns == std::ssize(v.radius) / 48);
    std::vector<std::int32_t> kinds(static_cast<std::size_t>(turns));
    std::vector<double> zones(static_cast<std::size_t>(zone_count * HB_ZONE_COLUMNS));
    CHECK(hb_wall_zones(wall, &criteria, &turns, kinds.data(), &zone_count, zones.data()) == HB_OK);
    add(of_c, {std::vector<double>(kinds.begin(), kinds.end())});
    add(of_c, zones);
    const helibore::Zones found =
        helibore::wall_zones({.start_depth = 100.0, .pitch = 0.05, .sectors = 48, .count = std::ssize(v.radius)},
                             v.radius, {{samples[0], samples[1]}, samples[2]}, 0.216);
    std::vector<double> kinds_of_cpp;
    for (const helibore::HoleKind kind : found.kinds) kinds_of_cpp.push_back(static_cast<double>(kind));
    add(of_cpp, kinds_of_cpp);
    const auto add_zones = [&](const auto& number) {
        for (const helibore::Zone& zone : found.zones) add(of_cpp, {{static_cast<double>(number(zone))}});
    };
    using helibore::Zone;
    add_zones([](const Zone& zone) { return static_cast<int>(zone.kind); });
    for (double Zone::* const member : {&Zone::start, &Zone::stop, &Zone::measure, &Zone::median, &Zone::severity,
                                        &Zone::enlargement, &Zone::elongation, &Zone::peak, &Zone::coverage,
                                        &Zone::confidence, &Zone::pipe_diameter, &Zone::toolface, &Zone::deviation})
        add_zones([&](const Zone& zone) { return zone.*member; });
    for (const std::size_t side : {0U, 1U}) {
        add_zones([&](const Zone& zone) { return zone.lobes[side].toolface; });
        add_zones([&](const Zone& zone) { return zone.lobes[side].opening; });
        add_zones([&](const Zone& zone) { return zone.lobes[side].height; });
    }
    CHECK(of_c == of_cpp);
    CHECK(hb_close(wall) == HB_OK);
}

// A breakout that two diameters at right angles measured: the arms give its C1 and C2, not the rounder wall.
void zones_of_arms() {
    std::vector<double> depth, toolface, radius;
    std::vector<std::int64_t> arm;
    for (int row = 0; row < 201; ++row)
        for (int end = 0; end < 4; ++end) {
            depth.push_back(100.0 + 0.05 * row), toolface.push_back(30.0 + 90.0 * end), arm.push_back(end % 2);
            radius.push_back(end % 2 == 0 && row >= 80 && row < 120 ? 0.128 : 0.108);
        }
    const std::int64_t wall = new_wall();
    CHECK(append(wall, {depth, toolface, radius}) == HB_OK);
    auto criteria = sized<hb_zone_criteria>();
    CHECK(hb_zone_criteria_init(&criteria) == HB_OK);
    const auto found = [&](std::int64_t n, Bits& bits) {
        std::int64_t turns = 0, count = 0;
        const auto call = [&](std::int32_t* kinds, double* values) {
            return hb_wall_arm_zones(wall, &criteria, n, depth.data(), toolface.data(), radius.data(), arm.data(),
                                     nullptr, &turns, kinds, &count, values);
        };
        CHECK(call(nullptr, nullptr) == HB_BUFFER_TOO_SMALL);
        std::vector<std::int32_t> kinds(static_cast<std::size_t>(turns));
        std::vector<double> zones(static_cast<std::size_t>(count * HB_ZONE_COLUMNS));
        CHECK(call(kinds.data(), zones.data()) == HB_OK);
        add(bits, std::vector<double>(kinds.begin(), kinds.end()));
        add(bits, zones);
    };
    const auto all = std::ssize(depth);
    Bits by_arms, by_wall, of_cpp;
    found(all, by_arms), found(0, by_wall);
    CHECK(by_arms != by_wall);
    helibore::Wall expected({.bit_diameter = 0.216, .sectors = 48, .pitch = 0.05, .start_depth = 100.0});
    expected.append({depth, toolface, radius});
    const helibore::VertexColumns v = expected.vertices();
    const auto samples = expected.samples();
    const helibore::Zones zones =
        helibore::wall_zones({.start_depth = 100.0, .pitch = 0.05, .sectors = 48, .count = std::ssize(v.radius)},
                             v.radius, {{samples[0], samples[1]}, samples[2], {depth, toolface, radius, arm}}, 0.216);
    for (const helibore::HoleKind kind : zones.kinds) add(of_cpp, {{static_cast<double>(kind)}});
    std::vector<double> columns(zones.zones.size() * HB_ZONE_COLUMNS);
    helibore::fill_zones(zones.zones, columns.data());
    add(of_cpp, columns);
    CHECK(by_arms == of_cpp);
    CHECK(hb_close(wall) == HB_OK);
}

// A hole of bit size with spikes at one toolface: no key seat, if the wall is robust.
void zones_of_a_robust_wall() {
    std::vector<double> depth, toolface, radius;
    for (int i = 0; i < 4000; ++i) {
        depth.push_back(100.0 + 0.003 * i), toolface.push_back(std::fmod(137.0 * i, 360.0));
        radius.push_back(i % 3 == 0 && std::abs(toolface.back() - 90.0) < 25.0 ? 0.138 : 0.108);
    }
    hb_settings settings = settings_of();
    settings.estimator = HB_NEAR_AND_FAR, settings.robust = 1, settings.covariance_count = 8;
    const double covariance[] = {0.108, 2.5e-7, 1e-7, 0.05, 0.06, 4e-6, 0.1, 0.6};
    std::copy(std::begin(covariance), std::end(covariance), settings.covariance);
    std::int64_t wall = 0, turns = 0, count = 0;
    CHECK(hb_wall_create(&settings, &wall) == HB_OK && append(wall, {depth, toolface, radius}) == HB_OK);
    auto criteria = sized<hb_zone_criteria>();
    CHECK(hb_zone_criteria_init(&criteria) == HB_OK);
    std::vector<std::int32_t> kinds(240);
    turns = std::ssize(kinds);
    CHECK(hb_wall_zones(wall, &criteria, &turns, kinds.data(), &count, nullptr) == HB_OK && count == 0);
    CHECK(hb_close(wall) == HB_OK);
}

// A spike shows no shape, but it measures its place: as large a share of a washout is measured with spikes as without.
void coverage_of_a_robust_wall() {
    std::vector<double> depth, toolface, radius, wall(240 * 48, 0.138);
    for (int i = 0; i < 4000; ++i) {
        depth.push_back(100.0 + 0.003 * i), toolface.push_back(std::fmod(137.0 * i, 360.0));
        radius.push_back(i % 3 == 0 ? 0.168 : 0.138);
    }
    const helibore::HelixVertices vertices{.start_depth = 100.0, .pitch = 0.05, .sectors = 48, .count = 240 * 48};
    const auto zones = [&](double noise) {
        return helibore::wall_zones(vertices, wall, {{depth, toolface}, radius, {}, false, noise}, 0.216).zones;
    };
    const auto robust = zones(1e-6), plain = zones(0.0);
    CHECK(robust.size() == 1 && plain.size() == 1 && robust[0].coverage == plain[0].coverage);
    CHECK(robust[0].coverage < 0.95);
}

std::int64_t new_live() {
    const hb_settings settings = settings_of();
    hb_path_settings path = path_settings();
    path.extend = 100.0;
    std::int64_t live = 0;
    CHECK(hb_live_create(&settings, &path, &live) == HB_OK);
    return live;
}

void live() {
    const std::int64_t live = new_live();
    const double bad_depth[] = {0.0, 60.0, 140.0, 150.0}, bad[] = {0.0, 12.0, 40.0, 190.0}, none[] = {30, 30, 75, 0};
    const double rows[] = {101.0, 100.5}, values[] = {1.0, 2.0, 3.0, 4.0};
    CHECK(hb_live_append_samples(live, 4000, hole.depth.data(), hole.toolface.data(), hole.radius.data(),
                                 hole.time.data()) == HB_OK);
    CHECK(hb_live_append_stations(live, 4, bad_depth, bad, none) == HB_OK);
    CHECK(hb_live_append_image(live, "GR", "gAPI", 2, 2, rows, values) == HB_OK);
    auto update = sized<hb_update>();
    CHECK(hb_live_poll(live, &update) == HB_OK);
    CHECK(update.change.accepted == 4000 && update.change.ranges == 1 && update.events == 1 && update.images == 1);
    CHECK(update.path_from == 0.0);
    std::int64_t range[2], count = 1;
    CHECK(hb_ranges(live, &count, range) == HB_OK && count == 1 && range[0] == 0);
    char text[99];
    count = sizeof text;
    CHECK(hb_live_event(live, 0, &count, text) == HB_OK);
    CHECK(std::string(text) == "station at 150 m: inclination[3] = 190: must lie in 0 to 180 degrees");
    CHECK(count == std::ssize(std::string(text)) + 1);
    double depth[2], found[4];
    std::int32_t sectors = 0;
    count = 2;
    CHECK(hb_live_image(live, "GR", &sectors, &count, depth, found) == HB_OK && sectors == 2 && count == 2);
    CHECK(depth[0] == 100.5 && found[0] == 3.0 && found[3] == 2.0);
    std::int64_t wall = 0, path = 0;
    CHECK(hb_live_wall(live, &wall) == HB_OK && hb_live_path(live, &path) == HB_OK);
    CHECK(hb_close(live) == HB_OK);  // the others stay
    helibore::Wall expected({.bit_diameter = 0.216, .sectors = 48, .pitch = 0.05, .start_depth = 100.0});
    expected.append(hole.all());
    CHECK(read_c(wall, path) == read_cpp(expected));
    CHECK(append(wall, hole.all()) == HB_INPUT);
    CHECK(hb_last_error() ==
          "wall = " + std::to_string(wall) + ": must not be the wall of a live well; use hb_live_append_samples");
    CHECK(hb_close(wall) == HB_OK && hb_close(path) == HB_OK);
}

void wits() {
    std::int64_t parser = 0, items = 0, events = 0;
    CHECK(hb_wits_create(&parser) == HB_OK);
    const std::string text = "&&\r\n01083650.40\r\n0109-9999\r\n!!\r\nstray\r\n";
    CHECK(hb_wits_feed(parser, 20, text.data(), &items, &events) == HB_OK && items == 0 && events == 0);
    CHECK(hb_wits_feed(parser, std::ssize(text) - 20, text.data() + 20, &items, &events) == HB_OK);
    CHECK(items == 2 && events == 1);
    std::int64_t frame[2], offset[2], count = 2;
    std::int32_t code[2], length[2];
    double value[2];
    CHECK(hb_wits_items(parser, &count, frame, code, value, offset, length) == HB_OK && count == 2);
    CHECK(code[0] == 108 && value[0] == 3650.4 && text.substr(std::size_t(offset[0]), 7) == "3650.40");
    CHECK(code[1] == 109 && std::isnan(value[1]) && frame[1] == 0 && length[1] == 5);
    CHECK(hb_wits_feed(parser, 0, nullptr, &items, &events) == HB_OK && items == 0);
    CHECK(hb_close(parser) == HB_OK);
}

void refused(int line, std::int32_t status, std::int32_t wanted, const std::string& text) {
    if (status != wanted || hb_last_error() != text)
        fail(__FILE__, line, std::to_string(status) + " " + hb_last_error() + "\n  instead of " + text);
}
#define REFUSED(call, text) refused(__LINE__, call, HB_INPUT, text)

void bad_input() {
    hb_settings settings = settings_of();
    std::int64_t wall = new_wall(), none = 0;
    const std::int64_t path = new_path(), live = new_live();
    const std::string number = std::to_string(wall), of_path = std::to_string(path);
    const double good[] = {101.0, 102.0}, bad[] = {0.0, nan}, one[] = {0.1, 0.1};
    const double beyond[] = {0.1, std::numeric_limits<double>::infinity()};
    double out[9] = {};
    std::int64_t count = 0;
    std::int32_t sectors = 0;

    auto how = path_settings();

    // null pointers, negative and wrong lengths
    REFUSED(hb_settings_init(nullptr), "settings: must not be null");
    REFUSED(hb_wall_create(nullptr, &none), "settings: must not be null");
    REFUSED(hb_wall_create(&settings, nullptr), "wall: must not be null");
    REFUSED(hb_wall_append(wall, 2, nullptr, good, one, nullptr, nullptr), "depth: must not be null");
    REFUSED(hb_wall_append(wall, -1, good, good, one, nullptr, nullptr), "n = -1: must be 0 or more");
    REFUSED(hb_wall_get(wall, nullptr), "state: must not be null");
    REFUSED(hb_wall_samples(wall, HB_DEPTH, nullptr, out), "count: must not be null");
    REFUSED(hb_path_create(nullptr, 0, nullptr, nullptr, nullptr, &none), "settings: must not be null");
    REFUSED(hb_path_read(path, 1, nullptr, out, nullptr), "depth: must not be null");
    REFUSED(hb_live_append_image(live, nullptr, "", 0, 1, nullptr, nullptr), "name: must not be null");
    REFUSED(hb_live_append_image(live, "a", "", 2, 0, good, good), "sectors = 0: must lie in 1 to 1000000");
    REFUSED(hb_live_append_image(live, "a", "", std::numeric_limits<std::int64_t>::max(), 9, good, good),
            "n = 9223372036854775807: must be at most 1024819115206086200");
    REFUSED(hb_live_image(live, "x", nullptr, &count, out, out), "sectors: must not be null");
    REFUSED(hb_wits_create(nullptr), "parser: must not be null");
    REFUSED(hb_path_settings_init(nullptr), "settings: must not be null");
    REFUSED(hb_wall_append(wall, 2, good, good, nullptr, nullptr, nullptr), "radius: must not be null");
    REFUSED(hb_wall_interpolate(wall, 1, nullptr, &count, out), "samples: must not be null");
    REFUSED(hb_wall_logs(wall, 5, nullptr, out), "count: must not be null");
    auto criteria = sized<hb_zone_criteria>();
    REFUSED(hb_zone_criteria_init(nullptr), "criteria: must not be null");
    REFUSED(hb_wall_zones(wall, nullptr, &count, nullptr, &count, out), "criteria: must not be null");
    CHECK(hb_zone_criteria_init(&criteria) == HB_OK);
    CHECK(criteria.elongation == 0.0254 && criteria.join == 1.0 && criteria.largest_gap == 60.0);
    REFUSED(hb_wall_zones(wall, &criteria, nullptr, nullptr, &count, out), "count: must not be null");
    CHECK(hb_wall_zones(wall, &criteria, &count, nullptr, &count, nullptr) == HB_OK && count == 0);  // an empty wall
    const std::int64_t arm[] = {0, 1};
    const auto arms = [&](std::int64_t n, const double* toolfaces, const std::int64_t* arm_of) {
        return hb_wall_arm_zones(wall, &criteria, n, good, toolfaces, good, arm_of, nullptr, &count, nullptr, &count,
                                 nullptr);
    };
    REFUSED(arms(2, good, nullptr), "arm: must not be null");
    REFUSED(arms(2, nullptr, arm), "toolface: must not be null");
    REFUSED(arms(-1, good, arm), "n = -1: must be 0 or more");
    REFUSED(arms(2, bad, arm), "toolface[1] = nan: must be finite");
    REFUSED(hb_wall_surface(wall, 0, 0, 0, nullptr, out, nullptr, &count, nullptr), "count: must not be null");
    REFUSED(hb_ranges(wall, nullptr, nullptr), "count: must not be null");
    REFUSED(hb_path_create(&how, 2, good, nullptr, one, &none), "inclination: must not be null");
    REFUSED(hb_path_read(path, -1, good, out, nullptr), "n = -1: must be 0 or more");
    REFUSED(hb_live_append_samples(live, 2, good, good, nullptr, nullptr), "radius: must not be null");
    REFUSED(hb_live_append_stations(live, 2, good, nullptr, one), "inclination: must not be null");
    REFUSED(hb_live_append_image(live, "a", nullptr, 0, 1, nullptr, nullptr), "unit: must not be null");
    REFUSED(hb_live_poll(live, nullptr), "update: must not be null");
    REFUSED(hb_live_wall(live, nullptr), "wall: must not be null");
    REFUSED(hb_live_path(live, nullptr), "path: must not be null");

    // structs of another version
    for (const std::uint32_t size : {std::uint32_t{12}, std::uint32_t{sizeof settings + 8}}) {
        settings.size = size;
        REFUSED(hb_wall_create(&settings, &none), "settings.size = " + std::to_string(size) + ": must lie in 136 to " +
                                                      std::to_string(sizeof settings) +
                                                      ", as in helibore.h of version " + hb_version());
    }
    settings = settings_of();
    hb_change change = {};
    REFUSED(hb_wall_append(wall, 0, nullptr, nullptr, nullptr, nullptr, &change),
            "change.size = 0: must be " + std::to_string(sizeof change) + ", as in helibore.h of version 0.1.0");
    auto older = path_settings();
    older.size -= 8;  // of a header without the last member
    REFUSED(hb_path_create(&older, 2, good, one, one, &none),
            "settings.size = 40: must be 48, as in helibore.h of version 0.1.0");
    REFUSED(hb_live_create(&settings, &older, &none),
            "settings.size = 40: must be 48, as in helibore.h of version 0.1.0");
    auto state = sized<hb_wall_state>();
    state.size -= 8;
    REFUSED(hb_wall_get(wall, &state), "state.size = 32: must be 40, as in helibore.h of version 0.1.0");
    auto update = sized<hb_update>();
    update.size += 8;  // of a header with one member more
    REFUSED(hb_live_poll(live, &update), "update.size = 80: must be 72, as in helibore.h of version 0.1.0");

    criteria.size -= 8;
    REFUSED(hb_wall_zones(wall, &criteria, &count, nullptr, &count, nullptr),
            "criteria.size = 80: must be 88, as in helibore.h of version 0.1.0");
    criteria.size += 8;

    // handles: none, of another kind, closed
    REFUSED(hb_close(0), "handle = 0: is not open");
    REFUSED(hb_wall_get(path, nullptr), "wall = " + of_path + ": must be the handle of a wall");
    REFUSED(hb_path_read(wall, 0, nullptr, nullptr, nullptr), "path = " + number + ": must be the handle of a path");
    REFUSED(hb_live_poll(wall, nullptr), "live = " + number + ": must be the handle of a live well");
    REFUSED(hb_wits_feed(wall, 0, nullptr, nullptr, nullptr),
            "parser = " + number + ": must be the handle of a WITS parser");
    REFUSED(hb_ranges(path, &count, nullptr), "wall_or_live = " + of_path + ": must be the handle of a wall");

    // values, also while exceptions trap
    const HostState host(FE_TONEAREST, true);
    settings.bit_diameter = nan;
    REFUSED(hb_wall_create(&settings, &none), "bit_diameter = nan: must be finite and above 0");
    settings = settings_of();
    settings.estimator = 7;
    REFUSED(hb_wall_create(&settings, &none), "estimator = 7: must lie in 0 to 2");
    settings = settings_of();
    settings.start_depth = nan;
    REFUSED(hb_live_create(&settings, &how, &none),
            "start_depth: must be set: the vertices of a live wall keep their numbers");
    how.extend = std::numeric_limits<double>::infinity();
    REFUSED(hb_path_create(&how, 2, good, one, one, &none), "extend = inf: must be finite and not negative");
    REFUSED(hb_wall_append(wall, 2, good, bad, one, nullptr, nullptr), "toolface[1] = nan: must be finite");
    REFUSED(hb_wall_append(wall, 2, beyond, good, one, nullptr, nullptr), "depth[1] = inf: must be finite");
    REFUSED(hb_live_append_samples(live, 2, good, good, one, beyond), "time[1] = inf: must be finite");
    settings.start_depth = beyond[1];
    REFUSED(hb_wall_create(&settings, &none), "start_depth = inf: must be finite");
    how = path_settings();
    REFUSED(hb_path_create(&how, 2, good, beyond, one, &none), "inclination[1] = inf: must be finite");
    REFUSED(hb_wall_read(wall, HB_RADIUS, 0, 1, out), "range = [0, 1): must lie within the wall's 0 vertices");
    REFUSED(hb_wall_read(wall, 7, 0, 0, out), "column = 7: must lie in 0 to 6");
    REFUSED(hb_wall_samples(wall, 3, &count, out), "column = 3: must be 0, 1, 2 or 7");
    REFUSED(hb_wall_logs(wall, 4, &count, out), "window = 4: must be odd and 3 or more");
    criteria.symmetry = 1.5;
    REFUSED(hb_wall_zones(wall, &criteria, &count, nullptr, &count, out), "symmetry = 1.5: must be in [0, 1]");
    criteria.symmetry = 0.5, criteria.gap_reach = nan;
    REFUSED(hb_wall_passage(wall, 0, 1, good, good, one, 0, nullptr, nullptr, &count, out),
            "string[0].stop = 101: must be at least 0.001 m below start");
    REFUSED(hb_wall_surface(wall, 99999, 0, 0, &count, out, nullptr, &count, nullptr), "handle = 99999: is not open");
    REFUSED(hb_path_read(path, 2, bad, out, nullptr), "depth[1] = nan: must be finite");
    REFUSED(hb_live_path(live, &none), "path: needs two stations");
    REFUSED(hb_live_image(live, "GR", &sectors, &count, out, out), "image 'GR': is not there");
    REFUSED(hb_live_append_image(live, "GR", "", 2, 1, bad, good), "depth[1] = nan: must be finite");
    REFUSED(hb_live_event(live, 0, &count, nullptr), "index = 0: must lie within the 0 events of the last poll");
    CHECK(hb_wall_append(wall, 2, good, one, one, nullptr, nullptr) == HB_OK && std::string(hb_last_error()).empty());
    REFUSED(hb_wall_zones(wall, &criteria, &count, nullptr, &count, out), "gap_reach = nan: must be 0 or above");
    count = 1;
    refused(__LINE__, hb_wall_samples(wall, HB_DEPTH, &count, out), HB_BUFFER_TOO_SMALL,
            "count = 1: must be at least 2");
    CHECK(count == 2);
    REFUSED(hb_wall_samples(wall, HB_TIME, &count, out), "column = 7: samples have no time");
    count = 9999;
    REFUSED(hb_wall_interpolate(wall, 1, one, &count, out),
            "channel 0 has 1 values, the wall 2 samples: must be equal");

    for (const std::int64_t handle : {wall, path, live}) CHECK(hb_close(handle) == HB_OK);
    for (const std::int64_t handle : {wall, path, live})
        REFUSED(hb_close(handle), "handle = " + std::to_string(handle) + ": is not open");
    REFUSED(hb_wall_append(wall, 2, good, one, one, nullptr, nullptr), "handle = " + number + ": is not open");
    CHECK(none == 0);
    CHECK(new_wall() > wall);  // no number comes again; this wall stays open, which is no leak either
}

// A text of more than 1023 bytes is cut, but not within a character: "\u6df1" takes three bytes.
// A host of the first header: its settings end before `sigma`.
void older_struct() {
    hb_settings settings = {}, newest = settings_of();
    std::memset(&settings, 0x5a, sizeof settings);
    settings.size = 136;
    CHECK(hb_settings_init(&settings) == HB_OK);
    CHECK(settings.size == 136 && settings.sectors == 64);
    CHECK(settings.sigma == 0x5a5a5a5a && settings.covariance_count == 0x5a5a5a5a);  // not its memory
    settings.bit_diameter = 0.216;
    std::int64_t wall = 0, count = 0;
    hb_sigma_rule rule = sized<hb_sigma_rule>();
    CHECK(hb_wall_create(&settings, &wall) == HB_OK);
    CHECK(hb_wall_sigma(wall, &rule, &count, nullptr) == HB_INPUT);  // the default
    newest.sigma = 1;
    CHECK(hb_wall_create(&newest, &wall) == HB_OK);
    CHECK(hb_wall_sigma(wall, &rule, &count, nullptr) == HB_OK);
}

// The numbers of C++ for what is measured on a wall.
void measures() {
    hb_settings settings = settings_of();
    settings.sigma = 1;
    std::int64_t wall = 0;
    CHECK(hb_wall_create(&settings, &wall) == HB_OK);
    CHECK(append(wall, hole.all()) == HB_OK);
    helibore::Settings same{.bit_diameter = 0.216, .sectors = 48, .pitch = 0.05, .start_depth = 100.0};
    same.sigma = true;
    helibore::Wall expected(same);
    expected.append(hole.all());
    const auto samples = expected.samples();
    const auto sums = expected.sums();
    std::int64_t count = expected.size();
    std::vector<double> found(static_cast<std::size_t>(count)), near(2);
    const auto equal = [](std::span<const double> a, std::span<const double> b) {
        Bits of_a, of_b;
        add(of_a, a);
        add(of_b, b);
        return of_a == of_b;
    };

    CHECK(hb_wall_angular_gaps(wall, 0.05, &count, found.data()) == HB_OK);
    CHECK(equal(found, helibore::angular_gaps({100.0, 0.0, 0.05, 48, count}, {samples[0], samples[1]}, 0.05)));
    const hb_sigma_rule rule{sizeof rule, 0, 1e-6, 2e-6, 0.5, 0.7, 1.5, 0.4};
    CHECK(hb_wall_sigma(wall, &rule, &count, found.data()) == HB_OK);
    CHECK(equal(found, helibore::sigma_of({sums[0], sums[1], sums[2], sums[3]}, {1e-6, 2e-6, 0.5, 0.7, 1.5, 0.4})));

    const double depth[] = {101.3, 190.0}, toolface[] = {77.0, 0.0}, nothing[] = {-1.0, -1.0}, trial[] = {0.108, 0.108};
    const auto at =
        helibore::estimate_at({samples[0], samples[1], samples[2]}, {depth, toolface, trial, nothing, nothing}, same);
    found.resize(2);
    CHECK(hb_wall_estimate(wall, 2, depth, toolface, found.data(), near.data()) == HB_OK);
    CHECK(equal(found, at.radius) && equal(near, at.nearest) && std::isnan(found[1]) && found[0] > 0.1);

    const double thickness[] = {0.05, 0.2};
    std::int64_t vertices = 0, cells = 0;
    CHECK(hb_wall_volume(wall, 0, 0, 200, 2, thickness, &vertices, nullptr, &cells, nullptr) == HB_BUFFER_TOO_SMALL);
    std::vector<helibore::Vector3> places(static_cast<std::size_t>(vertices));
    std::vector<helibore::Hexahedron> corners(static_cast<std::size_t>(cells));
    CHECK(vertices == 600 && cells == 2 * 151);
    CHECK(hb_wall_volume(wall, 0, 0, 200, 2, thickness, &vertices, places[0].data(), &cells, corners[0].data()) ==
          HB_OK);
    for (const double volume : helibore::volumes(places, corners)) CHECK(volume > 0.0);
    const double falling[] = {0.05, 0.01};
    REFUSED(hb_wall_volume(wall, 0, 0, 0, 0, thickness, &vertices, nullptr, &cells, nullptr),
            "shells = 0: must lie in 1 to 1000");
    CHECK(hb_wall_volume(wall, 0, 0, 200, 2, falling, &vertices, nullptr, &cells, nullptr) == HB_INPUT);
}

// The wall of C++ by near and far neighbours, and its sigma.
void near_and_far() {
    helibore::Settings same{.bit_diameter = 0.216, .sectors = 48, .pitch = 0.05, .start_depth = 100.0};
    same.estimator = helibore::Estimator::near_and_far;
    same.covariance = {0.11, 1e-7, 4e-7, 0.05, 0.06, 9e-6, 0.1, 1.5};
    same.other_turns = {0.4, 0.11, 1e-7, 4e-7, 0.05, 0.06, 9e-6, 0.1, 1.5, 9.0};
    same.robust = true;
    same.sigma = true;
    helibore::Wall expected(same);
    expected.append(hole.all());
    hb_settings settings = settings_of();
    settings.estimator = HB_NEAR_AND_FAR;
    settings.robust = 1;
    settings.sigma = 1;
    std::int64_t wall = 0, count = expected.size();
    REFUSED(hb_wall_create(&settings, &wall), "covariance = 0: must have 5, 8 or 11 values, or a turn as one more");
    settings.covariance_count = 13;
    REFUSED(hb_wall_create(&settings, &wall), "covariance_count = 13: must lie in 0 to 12");
    settings.covariance_count = static_cast<std::int32_t>(same.covariance.size());
    std::copy(same.covariance.begin(), same.covariance.end(), settings.covariance);
    settings.other_turns_count = -1;
    REFUSED(hb_wall_create(&settings, &wall), "other_turns_count = -1: must be 0 or more");
    settings.other_turns_count = static_cast<std::int64_t>(same.other_turns.size());
    REFUSED(hb_wall_create(&settings, &wall), "other_turns: must not be null");
    settings.other_turns = same.other_turns.data();
    CHECK(hb_wall_create(&settings, &wall) == HB_OK);
    CHECK(append(wall, hole.all()) == HB_OK);
    std::vector<double> found(static_cast<std::size_t>(count)), sigma(found.size());
    CHECK(hb_wall_read(wall, HB_RADIUS, 0, count, found.data()) == HB_OK);
    const hb_sigma_rule rule{sizeof rule, 0, 1.0, 0.0, 1.0, 1.0, 1.0, 1e9};
    CHECK(hb_wall_sigma(wall, &rule, &count, sigma.data()) == HB_OK);
    const std::vector<double> radius = expected.radius(), variance = expected.sums()[0];
    for (std::size_t i = 0; i < found.size(); ++i) {
        CHECK(found[i] == radius[i] || (std::isnan(found[i]) && std::isnan(radius[i])));
        CHECK(std::isnan(variance[i]) ? std::isnan(sigma[i])
                                      : std::abs(sigma[i] * sigma[i] - variance[i]) < 1e-12 * variance[i]);
    }
    const double at[] = {101.0};
    REFUSED(hb_wall_estimate(wall, 1, at, at, sigma.data(), nullptr),
            "estimator = near and far: must be inverse distance or kriging at points");
    CHECK(hb_close(wall) == HB_OK);
}

void long_texts() {
    const std::int64_t live = new_live();
    std::int64_t count = 0;
    std::int32_t sectors = 0;
    for (const std::size_t before : {0u, 1u, 2u}) {
        std::string name(before, 'x');
        for (int i = 0; i < 400; ++i) name += "\xe6\xb7\xb1";
        REFUSED(hb_live_image(live, name.c_str(), &sectors, &count, nullptr, nullptr),
                ("image '" + name).substr(0, 7 + before + (1023 - 7 - before) / 3 * 3));
    }
    CHECK(hb_close(live) == HB_OK);
}

// Several threads close one handle: one of them succeeds.
void closed_once() {
    for (int i = 0; i < 200; ++i) {
        const std::int64_t wall = new_wall();
        std::atomic<int> closed = 0;
        std::vector<std::jthread> threads;
        for (int thread = 0; thread < 2; ++thread) threads.emplace_back([&] { closed += hb_close(wall) == HB_OK; });
        threads.clear();
        CHECK(closed == 1);
    }
}

// Each function refuses a handle that was closed, 0 and a number that was never one.
// A tool of two diameters whose arms are closed at the end: the same samples, counts and suspect rows as in C++.
void preparation() {
    constexpr std::size_t n = 300;
    std::vector<double> depth, toolface, radii(2 * n), time;
    for (std::size_t i = 0; i < n; ++i) {
        const auto row = static_cast<double>(i);
        depth.push_back(100.0 + 0.1 * row), toolface.push_back(row), time.push_back(row);
        radii[i] = 0.11 + 1e-4 * static_cast<double>(i % 7), radii[n + i] = 0.112 + 1e-4 * static_cast<double>(i % 5);
        if (i >= 250) radii[i] = radii[n + i] = 0.05;
    }
    depth[3] = toolface[5] = radii[7] = nan;
    radii[n + 120] = 0.16;
    const double offset[] = {0.0, 0.0, 0.5, 0.5}, mounting[] = {0.0, 180.0, 90.0, 270.0};
    const std::int32_t column[] = {0, 0, 1, 1};
    auto settings = sized<hb_preparation>();
    CHECK(hb_preparation_init(&settings) == HB_OK && settings.drop_closed && !settings.drop_spikes);
    settings.bit_diameter = 0.216;
    const std::vector<helibore::ToolSensor> sensors{{0.0, 0.0, 0}, {0.0, 180.0, 0}, {0.5, 90.0, 1}, {0.5, 270.0, 1}};
    const std::span<const double> all(radii);
    for (const double* times : {static_cast<const double*>(nullptr), static_cast<const double*>(time.data())}) {
        std::int64_t prepared = 0, count = 1200;
        CHECK(hb_prepare(&settings, n, depth.data(), toolface.data(), times, 2, radii.data(), 4, offset, mounting,
                         column, &prepared) == HB_OK);
        helibore::ToolRows rows{depth, toolface, {all.first(n), all.last(n)}, {}};
        if (times) rows.time = time;
        const helibore::Prepared expected = helibore::prepare(rows, sensors, {.bit_diameter = 0.216});
        auto state = sized<hb_prepared_state>();
        CHECK(hb_prepared_get(prepared, &state) == HB_OK && state.samples == std::ssize(expected.samples.depth));
        CHECK(state.samples == 4 * 249 - 4 - 4 - 2 && state.repeats == 0.0);
        CHECK(state.no_depth == 4 && state.no_toolface == 4 && state.no_radius == 2 + 204 && state.no_time == 0);
        std::vector<double> values(1200);
        CHECK(hb_prepared_samples(prepared, HB_TOOLFACE, &count, values.data()) == HB_OK && count == state.samples);
        CHECK(std::equal(values.begin(), values.begin() + count, expected.samples.toolface.begin()));
        CHECK(hb_prepared_samples(prepared, HB_SENSOR, &count, values.data()) == HB_OK && values[1] == 1.0);
        CHECK(hb_prepared_samples(prepared, HB_ROW, &count, values.data()) == HB_OK && values[4 * 3] == 4.0);
        count = 1200;
        CHECK(hb_prepared_samples(prepared, HB_TIME, &count, values.data()) == HB_OK);
        CHECK(count == (times ? state.samples : 0));

        std::int32_t cause[9], of[9], other[9], dropped[9];
        std::int64_t rows_of[18];
        double radius[9];
        count = 9;
        CHECK(hb_prepared_suspects(prepared, &count, cause, of, other, rows_of, dropped, radius) == HB_OK);
        CHECK(count == state.suspects && count == 3);
        CHECK(cause[0] == HB_RAMP && rows_of[0] == 249 && rows_of[1] == 250 && dropped[0] == 1);
        CHECK(cause[1] == HB_CLOSED && of[1] == -1 && other[1] == -1 && dropped[1] == 1 && radius[1] == 0.05);
        CHECK(rows_of[2] == 250 && rows_of[3] == 300);
        CHECK(cause[2] == HB_BURST && of[2] == 1 && rows_of[4] == 120 && rows_of[5] == 121 && dropped[2] == 0);
        count = 1;
        CHECK(hb_prepared_suspects(prepared, &count, nullptr, nullptr, nullptr, nullptr, nullptr, nullptr) ==
              HB_BUFFER_TOO_SMALL);
        CHECK(count == 3);
        REFUSED(hb_prepared_samples(prepared, HB_SUPPORT, &count, values.data()),
                "column = 4: must be 0, 1, 2, 7, 8 or 9");
        REFUSED(hb_wall_get(prepared, nullptr),
                "wall = " + std::to_string(prepared) + ": must be the handle of a wall");
        CHECK(hb_close(prepared) == HB_OK);
        REFUSED(hb_prepared_get(prepared, &state), "handle = " + std::to_string(prepared) + ": is not open");
    }
    // A tool that turns: the spike of one sample is left out, unless it shall stay.
    std::vector<double> round(640, 0.11), along(640), around(640);
    for (int i = 0; i < 640; ++i)
        along[static_cast<std::size_t>(i)] = 5e-4 * i, around[static_cast<std::size_t>(i)] = 22.5 * i;
    round[333] = 0.15;
    for (const double threshold : {6.0, nan}) {
        const double straight = 0.0;
        const std::int32_t first = 0;
        auto turning = settings;
        turning.turn_spikes = threshold;
        std::int64_t prepared = 0;
        CHECK(hb_prepare(&turning, 640, along.data(), around.data(), nullptr, 1, round.data(), 1, &straight, &straight,
                         &first, &prepared) == HB_OK);
        auto state = sized<hb_prepared_state>();
        CHECK(hb_prepared_get(prepared, &state) == HB_OK);
        CHECK(state.spikes == (threshold > 0.0 ? 1 : 0) && state.samples == 640 - state.spikes);
        CHECK(hb_close(prepared) == HB_OK);
    }
    std::int64_t none = 0;
    const auto prepared = [&](int columns, const std::int32_t* places, const double* given) {
        return hb_prepare(&settings, n, depth.data(), toolface.data(), nullptr, columns, given, 4, offset, mounting,
                          places, &none);
    };
    REFUSED(prepared(-1, column, radii.data()), "columns = -1: must be 0 or more");
    REFUSED(prepared(1, column, radii.data()), "sensors[2].column = 1: must be one of the 1 columns of radii");
    REFUSED(prepared(2, column, nullptr), "radii: must not be null");
    REFUSED(prepared(2, nullptr, radii.data()), "column: must not be null");
    REFUSED(hb_prepare(nullptr, 0, nullptr, nullptr, nullptr, 0, nullptr, 0, nullptr, nullptr, nullptr, &none),
            "settings: must not be null");
    radii[9] = std::numeric_limits<double>::infinity();
    REFUSED(prepared(2, column, radii.data()), "radii[0][9] = inf: must be finite, or NaN where missing");
    const std::int32_t apart[] = {0, 0, 1, 1};
    const double same[] = {0.0, 0.0, 0.0, 0.0};
    for (std::size_t i = 0; i < n; ++i) radii[i] = 0.1, radii[n + i] = 0.105;
    REFUSED(
        hb_prepare(&settings, n, depth.data(), toolface.data(), nullptr, 2, radii.data(), 4, same, same, apart, &none),
        "radii[0] and radii[1]: look in the same direction and differ by 5 mm of radius in half of the rows: name "
        "the column to use");
}

void not_open() {
    const std::array<std::int64_t, 4> closed = {new_wall(), new_path(), new_live(), [] {
                                                    std::int64_t parser = 0;
                                                    CHECK(hb_wits_create(&parser) == HB_OK);
                                                    return parser;
                                                }()};
    for (const std::int64_t handle : closed) CHECK(hb_close(handle) == HB_OK);
    double out[9];
    std::int64_t n = 9, whole[9];
    std::int32_t sectors = 0;
    char text[9];
    auto state = sized<hb_wall_state>();
    auto update = sized<hb_update>();
    const auto criteria = sized<hb_zone_criteria>();
    for (const auto& [wall, path, live, parser] :
         {closed,
          {0, 0, 0, 0},
          {-1, -1, -1, -1},
          std::array<std::int64_t, 4>{1L << 62, 1L << 62, 1L << 62, 1L << 62}}) {
        const auto of = [](std::int64_t handle) { return "handle = " + std::to_string(handle) + ": is not open"; };
        REFUSED(hb_close(wall), of(wall));
        REFUSED(hb_wall_append(wall, 0, nullptr, nullptr, nullptr, nullptr, nullptr), of(wall));
        REFUSED(hb_ranges(wall, &n, whole), of(wall));
        REFUSED(hb_wall_get(wall, &state), of(wall));
        REFUSED(hb_wall_read(wall, HB_RADIUS, 0, 1, out), of(wall));
        REFUSED(hb_wall_samples(wall, HB_DEPTH, &n, out), of(wall));
        REFUSED(hb_wall_interpolate(wall, 0, nullptr, &n, out), of(wall));
        REFUSED(hb_wall_logs(wall, 5, &n, out), of(wall));
        REFUSED(hb_wall_zones(wall, &criteria, &n, nullptr, &n, out), of(wall));
        REFUSED(
            hb_wall_arm_zones(wall, &criteria, 0, nullptr, nullptr, nullptr, nullptr, nullptr, &n, nullptr, &n, out),
            of(wall));
        REFUSED(hb_wall_surface(wall, 0, 0, 0, &n, out, nullptr, &n, whole), of(wall));
        REFUSED(hb_path_read(path, 0, nullptr, nullptr, nullptr), of(path));
        REFUSED(hb_live_append_samples(live, 0, nullptr, nullptr, nullptr, nullptr), of(live));
        REFUSED(hb_live_append_stations(live, 0, nullptr, nullptr, nullptr), of(live));
        REFUSED(hb_live_append_image(live, "", "", 0, 1, nullptr, nullptr), of(live));
        REFUSED(hb_live_poll(live, &update), of(live));
        REFUSED(hb_live_event(live, 0, &n, text), of(live));
        REFUSED(hb_live_image(live, "", &sectors, &n, out, out), of(live));
        REFUSED(hb_live_wall(live, whole), of(live));
        REFUSED(hb_live_path(live, whole), of(live));
        REFUSED(hb_wits_feed(parser, 0, nullptr, &n, &n), of(parser));
        REFUSED(hb_wits_items(parser, &n, nullptr, nullptr, nullptr, nullptr, nullptr), of(parser));
    }
}

// A live well and a parser that three threads use at once, until one closes them: all samples and frames are there.
void one_live_well_and_one_parser() {
    const std::int64_t live = new_live();
    std::int64_t wall = 0, parser = 0;
    CHECK(hb_live_wall(live, &wall) == HB_OK && hb_wits_create(&parser) == HB_OK);
    std::atomic<std::int64_t> polled = 0, found = 0;
    const auto work = [&](std::size_t thread) {
        const std::string frame = "&&\r\n01083650.40\r\n!!\r\n";
        for (std::size_t i = thread * 10; i < thread * 10 + 10; ++i) {
            const helibore::SampleColumns rows = hole.rows(i * 20, 20);
            CHECK(hb_live_append_samples(live, 20, rows.depth.data(), rows.toolface.data(), rows.radius.data(),
                                         rows.time.data()) == HB_OK);
            auto update = sized<hb_update>();
            std::int64_t items = 0;
            CHECK(hb_live_poll(live, &update) == HB_OK);
            polled += update.change.accepted;
            CHECK(hb_wits_feed(parser, std::ssize(frame), frame.data(), &items, nullptr) == HB_OK);
            found += items;
        }
    };
    std::vector<std::jthread> threads;
    for (std::size_t thread = 0; thread < 3; ++thread) threads.emplace_back(work, thread);
    threads.clear();
    auto state = sized<hb_wall_state>();
    CHECK(hb_wall_get(wall, &state) == HB_OK && state.samples == 600 && polled == 600 && found == 30);
    for (const std::int64_t handle : {live, wall, parser}) CHECK(hb_close(handle) == HB_OK);
}

// One wall, appended to, read and closed at any moment by four threads; each has its own text.
void threads() {
    std::atomic<std::int64_t> wall = new_wall();
    const auto work = [&](std::size_t thread) {
        for (std::size_t i = 0; i < 40 / (reduced > 1 ? 4 : 1); ++i) {
            const std::int64_t now = wall;
            auto state = sized<hb_wall_state>();
            const auto open = [&](std::int32_t status) {
                CHECK(status == HB_OK || hb_last_error() == "handle = " + std::to_string(now) + ": is not open");
                return status == HB_OK;
            };
            if (!open(append(now, hole.rows(i * 100 + thread * 20, 20)))) continue;
            if (!open(hb_wall_get(now, &state))) continue;
            std::vector<double> radius(static_cast<std::size_t>(state.vertices));
            open(hb_wall_read(now, HB_RADIUS, 0, state.vertices, radius.data()));
            if (i % 8 == 7 && thread == 0) {
                wall = new_wall();
                CHECK(hb_close(now) == HB_OK);
            }
        }
    };
    std::vector<std::jthread> helpers;
    for (std::size_t thread = 0; thread < 4; ++thread) helpers.emplace_back(work, thread);
    helpers.clear();
    CHECK(hb_close(wall) == HB_OK);
}

// Fails each allocation of `call` in turn. After a failed call, `read` finds what it found before; after the call that
// succeeds, it finds what it finds without failures. A call that fails keeps no memory.
void fail_each(const char* name, const std::function<std::int64_t()>& prepare,
               const std::function<std::int32_t(std::int64_t)>& call, const std::function<Bits(std::int64_t)>& read) {
    const std::int64_t untouched = prepare();
    const Bits before = read(untouched);
    CHECK(call(untouched) == HB_OK);
    const Bits after = read(untouched);
    CHECK(hb_close(untouched) == HB_OK);
    for (long n = 0;; ++n) {
        const long kept = allocated;
        const std::int64_t handle = prepare();
        until_failure = n;
        const std::int32_t status = call(handle);
        until_failure = -1;
        if (status != HB_OK) {
            if (status != HB_NO_MEMORY || std::string(hb_last_error()) != "out of memory" || read(handle) != before)
                fail(__FILE__, __LINE__, std::string(name) + " at allocation " + std::to_string(n));
            CHECK(call(handle) == HB_OK);
        }
        if (read(handle) != after)
            fail(__FILE__, __LINE__, std::string(name) + " after allocation " + std::to_string(n));
        CHECK(hb_close(handle) == HB_OK);
        if (allocated != kept)
            fail(__FILE__, __LINE__, std::string(name) + " leaks at allocation " + std::to_string(n));
        if (status == HB_OK) return CHECK(n > 0);
    }
}

[[maybe_unused]] void memory_ends_anywhere() {
    const Hole small = oval_hole(300, 100.0, 0.6);
    const std::int64_t path = new_path();
    const auto filled = [&] {
        const std::int64_t wall = new_wall();
        CHECK(append(wall, small.rows(0, 200)) == HB_OK);
        return wall;
    };
    const auto filled_live = [&] {
        const std::int64_t live = new_live();
        const helibore::SampleColumns rows = small.rows(0, 200);
        CHECK(hb_live_append_samples(live, 200, rows.depth.data(), rows.toolface.data(), rows.radius.data(),
                                     rows.time.data()) == HB_OK);
        CHECK(hb_live_append_stations(live, 2, station_depth, inclination, azimuth) == HB_OK);
        auto update = sized<hb_update>();
        CHECK(hb_live_poll(live, &update) == HB_OK);
        return live;
    };
    const auto read = [&](std::int64_t wall) { return read_c(wall, path); };
    const auto read_live = [&](std::int64_t live) {
        std::int64_t wall = 0, along = 0, rows = 9;
        std::int32_t sectors = 0;
        double depth[9] = {}, values[9] = {};
        CHECK(hb_live_wall(live, &wall) == HB_OK && hb_live_path(live, &along) == HB_OK);
        Bits bits = read_c(wall, along);
        if (hb_live_image(live, "GR", &sectors, &rows, depth, values) == HB_OK) add(bits, values);
        CHECK(hb_close(wall) == HB_OK && hb_close(along) == HB_OK);
        return bits;
    };
    const auto create = [&](std::int64_t) {
        const hb_settings settings = settings_of();
        std::int64_t made = 0;
        const std::int32_t status = hb_wall_create(&settings, &made);
        if (status == HB_OK) CHECK(hb_close(made) == HB_OK);
        return status;
    };
    fail_each("create", filled, create, read);
    fail_each("append", filled, [&](std::int64_t wall) { return append(wall, small.rows(200, 100)); }, read);
    fail_each(
        "read", filled,
        [&](std::int64_t wall) {
            double values[20];
            return hb_wall_read(wall, HB_RADIUS, 0, 20, values);
        },
        read);
    fail_each(
        "logs", filled,
        [&](std::int64_t wall) {
            static double values[HB_LOG_COLUMNS * 99];
            std::int64_t turns = 99;
            return hb_wall_logs(wall, 5, &turns, values);
        },
        read);
    fail_each(
        "surface", filled,
        [&](std::int64_t wall) {
            static double vertices[3 * 3000];
            static std::int64_t quads[4 * 3000];
            std::int64_t rows = 3000, quad_count = 3000;
            return hb_wall_surface(wall, path, 0, 480, &rows, vertices, nullptr, &quad_count, quads);
        },
        read);
    fail_each(
        "values of samples", filled,
        [&](std::int64_t wall) {
            static double values[4000];
            std::int64_t count = 4000;
            return hb_wall_interpolate(wall, 200, small.radius.data(), &count, values);
        },
        read);
    fail_each(
        "samples of a wall", filled,
        [&](std::int64_t wall) {
            double values[200];
            std::int64_t count = 200;
            return hb_wall_samples(wall, HB_TIME, &count, values);
        },
        read);
    const auto read_path = [&](std::int64_t of) {
        double position[9] = {}, frame[27] = {};
        CHECK(hb_path_read(of, 3, station_depth, position, frame) == HB_OK);
        Bits bits;
        add(bits, position);
        add(bits, frame);
        return bits;
    };
    fail_each(
        "path", new_path,
        [&](std::int64_t of) {
            double position[9], frame[27];
            return hb_path_read(of, 3, station_depth, position, frame);
        },
        read_path);
    // What creates or returns an object: a failure makes none.
    const auto opens = [&](const std::function<std::int32_t(std::int64_t, std::int64_t*)>& call) {
        return [call](std::int64_t of) {
            std::int64_t made = 0;
            const std::int32_t status = call(of, &made);
            CHECK((status == HB_OK) == (made != 0));
            if (made != 0) CHECK(hb_close(made) == HB_OK);
            return status;
        };
    };
    fail_each("create a path", new_path, opens([&](std::int64_t, std::int64_t* made) {
                  const hb_path_settings settings = path_settings();
                  return hb_path_create(&settings, 3, station_depth, inclination, azimuth, made);
              }),
              read_path);
    fail_each("create a live well", filled, opens([&](std::int64_t, std::int64_t* made) {
                  const hb_settings settings = settings_of();
                  const hb_path_settings how = path_settings();
                  return hb_live_create(&settings, &how, made);
              }),
              read);
    fail_each("wall of a live well", filled_live, opens(hb_live_wall), read_live);
    fail_each("path of a live well", filled_live, opens(hb_live_path), read_live);
    fail_each(
        "samples", filled_live,
        [&](std::int64_t live) {
            const helibore::SampleColumns rows = small.rows(200, 100);
            return hb_live_append_samples(live, 100, rows.depth.data(), rows.toolface.data(), rows.radius.data(),
                                          rows.time.data());
        },
        read_live);
    fail_each(
        "stations", filled_live,
        [&](std::int64_t live) {
            return hb_live_append_stations(live, 1, station_depth + 2, inclination + 2, azimuth + 2);
        },
        read_live);
    fail_each(
        "image", filled_live,
        [&](std::int64_t live) {
            const double depth[] = {1.0}, values[] = {2.0, 3.0};
            return hb_live_append_image(live, "GR", "gAPI", 1, 2, depth, values);
        },
        read_live);

    // A poll needs no memory; what it returns is read like all else.
    const auto polled = [&] {
        const std::int64_t live = filled_live();
        const double depth[] = {1.0}, values[] = {2.0, 3.0}, bad[] = {190.0};
        CHECK(hb_live_append_image(live, "GR", "gAPI", 1, 2, depth, values) == HB_OK);
        CHECK(hb_live_append_stations(live, 1, station_depth + 2, bad, bad) == HB_OK);
        auto update = sized<hb_update>();
        until_failure = 0;
        CHECK(hb_live_poll(live, &update) == HB_OK && update.events == 1 && update.images == 1);
        until_failure = -1;
        return live;
    };
    fail_each(
        "image of a live well", polled,
        [](std::int64_t live) {
            double depth[1], values[2];
            std::int32_t sectors = 0;
            std::int64_t rows = 1;
            return hb_live_image(live, "GR", &sectors, &rows, depth, values);
        },
        read_live);

    // A parser within a frame: it has taken all of the bytes or none.
    const std::string text = "&&\r\n01083650.40\r\n0109-9999\r\n!!\r\nstray\r\n&&\r\n01081\r\n01092";
    const auto within_a_frame = [&] {
        std::int64_t parser = 0, items = 0, events = 0;
        CHECK(hb_wits_create(&parser) == HB_OK);
        CHECK(hb_wits_feed(parser, 24, text.data(), &items, &events) == HB_OK && items == 0);
        return parser;
    };
    const auto read_parser = [](std::int64_t parser) {
        std::int64_t count = 9, frame[9], offset[9];
        double value[9];
        CHECK(hb_wits_items(parser, &count, frame, nullptr, value, offset, nullptr) == HB_OK);
        Bits bits(frame, frame + count);
        bits.insert(bits.end(), offset, offset + count);
        add(bits, {value, static_cast<std::size_t>(count)});
        return bits;
    };
    fail_each(
        "parser", within_a_frame,
        [&](std::int64_t parser) {
            std::int64_t items = 0, events = 0;
            return hb_wits_feed(parser, std::ssize(text) - 24, text.data() + 24, &items, &events);
        },
        read_parser);
    fail_each("create a parser", within_a_frame,
              opens([](std::int64_t, std::int64_t* made) { return hb_wits_create(made); }), read_parser);
    CHECK(hb_close(path) == HB_OK);
}

// A host's runner that calls workers in any order, twice, with a wrong number or not at all: the work is done once.
struct Given {
    int calls = 0;
    std::vector<std::int32_t> order;  // of workers; empty: each, on a thread of its own
};

void give(void* host, std::int32_t workers, hb_job job, void* context) {
    auto& given = *static_cast<Given*>(host);
    ++given.calls;
    if (!given.order.empty()) {
        for (const std::int32_t worker : given.order) job(context, worker);
        return;
    }
    std::vector<std::jthread> threads;
    for (std::int32_t worker = 0; worker < workers; ++worker) threads.emplace_back(job, context, worker);
}

void threads_of_the_host() {
    const std::int64_t path = new_path();
    const auto rebuilt = [&](std::int32_t threads) {
        hb_settings settings = settings_of();
        settings.sectors = 96;
        settings.threads = threads;
        std::int64_t wall = 0;
        CHECK(hb_wall_create(&settings, &wall) == HB_OK && append(wall, hole.all()) == HB_OK);
        auto state = sized<hb_wall_state>();
        CHECK(hb_wall_get(wall, &state) == HB_OK);
        std::vector<double> radius(static_cast<std::size_t>(state.vertices));
        CHECK(hb_wall_read(wall, HB_RADIUS, 0, state.vertices, radius.data()) == HB_OK && hb_close(wall) == HB_OK);
        Bits bits;
        add(bits, radius);
        return bits;
    };
    const Bits expected = rebuilt(1);
    for (Given given : {Given{}, Given{0, {0, 1, 2}}, Given{0, {2, 2, 7, -1}}, Given{0, {-1}}}) {
        CHECK(hb_use_runner(give, &given) == HB_OK);
        CHECK(rebuilt(3) == expected && given.calls > 0);
        given.calls = 0;
        std::jthread([&] { CHECK(rebuilt(3) == expected); }).join();  // another thread has no runner
        CHECK(given.calls == 0);
    }
    CHECK(hb_use_runner(nullptr, nullptr) == HB_OK);
    CHECK(rebuilt(3) == expected && hb_close(path) == HB_OK);
}

}  // namespace

int main() {
    CHECK(std::string(hb_version()) == "0.1.0" && hb_instruction_set() == helibore::instruction_set_in_use());
    same_numbers_as_cpp();
    zones();
    zones_of_arms();
    zones_of_a_robust_wall();
    coverage_of_a_robust_wall();
    live();
    wits();
    older_struct();
    measures();
    near_and_far();
    bad_input();
    long_texts();
    preparation();
    not_open();
    closed_once();
    threads();
    one_live_well_and_one_parser();
    threads_of_the_host();
#ifndef __SANITIZE_THREAD__
    memory_ends_anywhere();
#endif
    return failures();
}
