// The functions of helibore.h: each checks its pointers, calls the core and copies the core's results.
#include <algorithm>
#include <bit>
#include <cmath>
#include <cstring>
#include <limits>
#include <utility>

#include "base/host_memory.hpp"
#include "base/threads.hpp"
#include "c/handles.hpp"
#include "helibore/estimates.hpp"
#include "helibore/logs.hpp"
#include "helibore/passage.hpp"
#include "helibore/preparation.hpp"
#include "helibore/surface.hpp"
#include "helibore/zones.hpp"
#include "measure/zone_columns.hpp"
#include "samples/row_rules.hpp"

namespace {

using namespace helibore;
using namespace helibore::c;

constexpr double no_value = std::numeric_limits<double>::quiet_NaN();

hb_settings to_c(const Settings& s) {
    hb_settings c{.size = sizeof(hb_settings),
                  .sectors = s.sectors,
                  .bit_diameter = s.bit_diameter,
                  .pitch = s.pitch,
                  .start_depth = s.start_depth.value_or(no_value),
                  .stop_depth = s.stop_depth.value_or(no_value),
                  .start_toolface = s.start_toolface,
                  .window = s.window.value_or(0),
                  .most_vertices = s.most_vertices,
                  .power = s.power,
                  .max_distance = s.max_distance,
                  .tolerance = s.tolerance,
                  .angular_scale = s.angular_scale,
                  .kriging_range = s.kriging_range,
                  .nugget = s.nugget,
                  .neighbors = s.neighbors,
                  .max_iterations = s.max_iterations,
                  .estimator = static_cast<std::int32_t>(s.estimator),
                  .direct = s.direct,
                  .threads = s.threads,
                  .instruction_set = static_cast<std::int32_t>(s.instruction_set),
                  .sigma = s.sigma,
                  .covariance_count = static_cast<std::int32_t>(s.covariance.size()),
                  .covariance = {},
                  .other_turns_count = 0,
                  .other_turns = nullptr,
                  .robust = s.robust,
                  .stretches_count = 0,
                  .stretches = nullptr};
    std::ranges::copy(s.covariance, c.covariance);
    return c;
}

template <class Enum>
Enum choice(const char* name, std::int32_t value, Enum last) {
    const auto most = static_cast<Index>(last);
    require(value >= 0 && value <= most, name, Index{value}, "must lie in 0 to " + std::to_string(most));
    return static_cast<Enum>(value);
}

Settings settings_of(const hb_settings* given) {
    const hb_settings s = taken("settings", given, to_c(Settings{}));
    require(s.covariance_count >= 0 && s.covariance_count <= std::ssize(s.covariance), "covariance_count",
            Index{s.covariance_count}, "must lie in 0 to 12");
    const auto set = [](double value) { return std::isnan(value) ? std::optional<double>() : value; };
    require(s.other_turns_count >= 0, "other_turns_count", Index{s.other_turns_count}, "must be 0 or more");
    const std::span<const double> turns = array("other_turns", s.other_turns, s.other_turns_count);
    require(s.stretches_count >= 0, "stretches_count", Index{s.stretches_count}, "must be 0 or more");
    const std::span<const double> stretches = array("stretches", s.stretches, s.stretches_count);
    return {.bit_diameter = s.bit_diameter,
            .sectors = s.sectors,
            .pitch = s.pitch,
            .start_depth = set(s.start_depth),
            .stop_depth = set(s.stop_depth),
            .start_toolface = s.start_toolface,
            .neighbors = s.neighbors,
            .window = s.window == 0 ? std::optional<Index>() : s.window,
            .power = s.power,
            .max_distance = s.max_distance,
            .max_iterations = s.max_iterations,
            .tolerance = s.tolerance,
            .angular_scale = s.angular_scale,
            .estimator = choice("estimator", s.estimator, Estimator::near_and_far),
            .kriging_range = s.kriging_range,
            .nugget = s.nugget,
            .covariance = {s.covariance, s.covariance + s.covariance_count},
            .other_turns = {turns.begin(), turns.end()},
            .stretches = {stretches.begin(), stretches.end()},
            .robust = s.robust != 0,
            .sigma = s.sigma != 0,
            .direct = s.direct != 0,
            .most_vertices = s.most_vertices,
            .threads = s.threads,
            .instruction_set = choice("instruction_set", s.instruction_set, InstructionSet::avx512)};
}

PathSettings settings_of(const hb_path_settings* given) {
    const hb_path_settings s = taken("settings", given, hb_path_settings{});
    return {.method = choice("method", s.method, Method::radius_of_curvature),
            .reference = choice("reference", s.reference, Reference::parallel_transport),
            .head = {s.head_north, s.head_east, s.head_down},
            .extend = s.extend};
}

hb_preparation to_c(const PreparationSettings& s) {
    return {.size = sizeof(hb_preparation),
            .drop_closed = s.drop_closed,
            .bit_diameter = s.bit_diameter.value_or(no_value),
            .spikes = s.spikes,
            .drop_saturated = s.drop_saturated,
            .drop_spikes = s.drop_spikes,
            .turn_spikes = s.turn_spikes.value_or(no_value)};
}

PreparationSettings settings_of(const hb_preparation* given) {
    const hb_preparation s = taken("settings", given, to_c(PreparationSettings{}));
    return {.bit_diameter = std::isnan(s.bit_diameter) ? std::optional<double>() : s.bit_diameter,
            .drop_closed = s.drop_closed != 0,
            .drop_saturated = s.drop_saturated != 0,
            .drop_spikes = s.drop_spikes != 0,
            .spikes = s.spikes,
            .turn_spikes = std::isnan(s.turn_spikes) ? std::optional<double>() : s.turn_spikes};
}

hb_zone_criteria to_c(const ZoneCriteria& of, const MeasuredRule& rule) {
    return {.size = sizeof(hb_zone_criteria),
            .reserved = 0,
            .elongation = of.elongation,
            .washout = of.washout,
            .key_seat = of.key_seat,
            .undergauge = of.undergauge,
            .symmetry = of.symmetry,
            .opening_level = of.opening_level,
            .least_length = of.least_length,
            .join = of.join,
            .gap_reach = rule.gap_reach,
            .largest_gap = rule.largest_gap};
}

hb_change to_c(const Change& change) {
    return {.size = sizeof(hb_change),
            .reserved = 0,
            .ranges = static_cast<Index>(change.ranges.size()),
            .settled = change.settled,
            .accepted = change.accepted,
            .redundant = change.redundant};
}

std::span<const double> column(const char* name, const double* values, std::int64_t n) {
    require_count(n);
    return array(name, values, n);
}

SampleColumns samples_of(std::int64_t n, const double* depth, const double* toolface, const double* radius,
                         const double* time) {
    return {column("depth", depth, n), column("toolface", toolface, n), column("radius", radius, n),
            time ? column("time", time, n) : std::span<const double>()};
}

template <class T, class Values>
void copy_to(T* into, const Values& values) {
    if (into) std::transform(values.begin(), values.end(), into, [](const auto& v) { return static_cast<T>(v); });
}

// Copies `values` to the host's array `into`, which has room for *count values; sets *count to their number.
template <class T, class Values>
void fill(std::int64_t* count, const char* name, T* into, const Values& values) {
    const auto needed = static_cast<Index>(values.size());
    require_room({count}, {needed});
    copy_to(array(name, into, needed).data(), values);
}

template <class T>
void open(std::int64_t* handle, std::shared_ptr<T> object) {
    *handle = handles().open(std::move(object));
}

// The radii of a range of vertices, and their helix, read from the same state of the wall.
struct WallRadii {
    Settings settings;
    std::vector<double> radius;
    HelixRadii helix;

    WallRadii(const Wall& wall, Range range) : settings(wall.settings()) {
        double start;
        do {  // a sample above all others moves the helix, unless the settings fix its start
            start = wall.start_depth();
            radius = wall.vertices(range).radius;
        } while (std::bit_cast<std::uint64_t>(start) != std::bit_cast<std::uint64_t>(wall.start_depth()));
        helix = {start, settings.start_toolface, settings.pitch, settings.sectors, range.start, radius};
    }

    HelixVertices vertices() const {
        return {helix.start_depth, helix.start_toolface, helix.pitch,
                settings.sectors,  std::ssize(radius),   helix.first};
    }
};

// Returns the numbers of the wall's vertices on the helix.
Range all_of(const Wall& wall) {
    const Index first = wall.settings().first_vertex;
    return {first, first + wall.size()};
}

// Returns the greatest noise variance of a sample of the wall's stretches, m^2.
double greatest_noise(const Settings& settings) {
    double noise = settings.covariance.size() > 1 ? settings.covariance[1] : 0.0;
    for (std::size_t at = 2; at < settings.stretches.size(); at += 13) noise = std::max(noise, settings.stretches[at]);
    return noise;
}

// The zones of a wall whose shape, if samples of arms are given, is that of the arms.
void find_wall_zones(int64_t wall, const hb_zone_criteria* criteria, const SampleColumns& of_arms,
                     const std::vector<Index>& arm, int64_t* turns, int32_t* kinds, int64_t* count, double* values) {
    const auto handle = find<WallHandle>("wall", wall);
    const hb_zone_criteria with = taken("criteria", criteria, to_c(ZoneCriteria{}, usual_measured_rule));
    const ZoneCriteria limits{with.elongation, with.washout,       with.key_seat,     with.undergauge,
                              with.symmetry,   with.opening_level, with.least_length, with.join};
    MeasuredRule rule = usual_measured_rule;
    rule.gap_reach = with.gap_reach, rule.largest_gap = with.largest_gap;
    const WallRadii of(*handle->read, all_of(*handle->read));
    const auto samples = handle->read->samples();
    const ArmSamples arms{of_arms.depth, of_arms.toolface, of_arms.radius, arm, of_arms.time, of.settings.max_distance};
    const double noise = of.settings.robust ? greatest_noise(of.settings) : 0.0;
    const Zones found = wall_zones(of.vertices(), of.radius, {{samples[0], samples[1]}, samples[2], arms, false, noise},
                                   of.settings.bit_diameter, limits, rule, of.settings.threads);
    require_room({turns, count}, {std::ssize(found.kinds), std::ssize(found.zones)});
    copy_to(kinds, found.kinds);
    fill_zones(found.zones, array("values", values, HB_ZONE_COLUMNS * *count).data());
}

}  // namespace

const char* hb_version(void) {
    return HELIBORE_VERSION;
}

const char* hb_instruction_set(void) {
    return instruction_set_in_use().data();
}

int32_t hb_close(int64_t handle) {
    return guarded([&] { handles().close(handle); });
}

int32_t hb_use_runner(hb_run run, void* host) {
    return guarded([&] { runner_of_this_thread() = {run, host}; });
}

int32_t hb_settings_init(hb_settings* settings) {
    return guarded([&] { give("settings", settings, to_c(Settings{})); });
}

int32_t hb_path_settings_init(hb_path_settings* settings) {
    return guarded([&] {
        give("settings", settings,
             hb_path_settings{sizeof *settings, HB_MINIMUM_CURVATURE, HB_HIGH_SIDE, 0, 0.0, 0.0, 0.0, 0.0});
    });
}

int32_t hb_wall_create(const hb_settings* settings, int64_t* wall) {
    return guarded([&] {
        require_pointer("wall", wall);
        const auto handle = std::make_shared<WallHandle>();
        handle->read = handle->append = std::make_shared<Wall>(settings_of(settings));
        open(wall, handle);
    });
}

int32_t hb_wall_append(int64_t wall, int64_t n, const double* depth, const double* toolface, const double* radius,
                       const double* time, hb_change* change) {
    return guarded([&] {
        const auto handle = find<WallHandle>("wall", wall);
        if (change) require_struct("change", change);
        if (!handle->append)
            throw InputError("wall", "must not be the wall of a live well; use hb_live_append_samples",
                             std::to_string(wall));
        Change done = handle->append->append(samples_of(n, depth, toolface, radius, time));
        if (change) give("change", change, to_c(done));
        const std::lock_guard held(handle->lock);
        handle->ranges = std::move(done.ranges);
    });
}

int32_t hb_ranges(int64_t wall_or_live, int64_t* count, int64_t* start_stop) {
    return guarded([&] {
        const auto copy = [&](const std::vector<Range>& ranges) {
            require_room({count}, {static_cast<Index>(ranges.size())});
            const std::span<int64_t> into = array("start_stop", start_stop, 2 * *count);
            if (!into.empty()) std::memcpy(into.data(), ranges.data(), into.size_bytes());
        };
        const Object object = handles().find(wall_or_live);
        if (const auto* live = std::get_if<std::shared_ptr<LiveHandle>>(&object)) {
            const std::lock_guard held((*live)->lock);
            copy((*live)->last.change ? (*live)->last.change->ranges : std::vector<Range>());
        } else {
            const auto wall = find<WallHandle>("wall_or_live", wall_or_live);
            const std::lock_guard held(wall->lock);
            copy(wall->ranges);
        }
    });
}

int32_t hb_wall_get(int64_t wall, hb_wall_state* state) {
    return guarded([&] {
        const auto handle = find<WallHandle>("wall", wall);
        require_struct("state", state);
        const Wall& w = *handle->read;
        const Index settled = w.settled();  // read first: an append between these calls only adds vertices
        give("state", state, hb_wall_state{sizeof *state, 0, w.size(), w.sample_count(), settled, w.start_depth()});
    });
}

int32_t hb_wall_read(int64_t wall, int32_t column, int64_t start, int64_t stop, double* values) {
    return guarded([&] {
        const auto handle = find<WallHandle>("wall", wall);
        require(column >= HB_DEPTH && column <= HB_PROVISIONAL, "column", Index{column}, "must lie in 0 to 6");
        const auto length = static_cast<std::uint64_t>(stop) - static_cast<std::uint64_t>(start);
        if (length > 0 && !values) handle->read->vertices({start, stop});  // an error of the range comes first
        if (length > 0) require_pointer("values", values);
        handle->read->read(static_cast<Column>(column), {start, stop}, {values, length});
    });
}

int32_t hb_wall_samples(int64_t wall, int32_t column, int64_t* count, double* values) {
    return guarded([&] {
        const auto handle = find<WallHandle>("wall", wall);
        require((column >= HB_DEPTH && column <= HB_RADIUS) || column == HB_TIME, "column", Index{column},
                "must be 0, 1, 2 or 7");
        const auto samples = handle->read->samples();
        const std::size_t at = column == HB_TIME ? 3 : static_cast<std::size_t>(column);
        if (at >= samples.size()) throw InputError("column", "samples have no time", "7");
        fill(count, "values", values, samples[at]);
    });
}

int32_t hb_wall_interpolate(int64_t wall, int64_t n, const double* samples, int64_t* count, double* values) {
    return guarded([&] {
        const auto handle = find<WallHandle>("wall", wall);
        const std::span<const double> channel = column("samples", samples, n);
        require_room({count}, {handle->read->size()});
        const auto found = handle->read->interpolate_samples(std::span(&channel, 1), handle->read->settings().threads);
        fill(count, "values", values, found[0]);
    });
}

int32_t hb_wall_logs(int64_t wall, int64_t window, int64_t* turns, double* values) {
    return guarded([&] {
        const auto handle = find<WallHandle>("wall", wall);
        const WallRadii of(*handle->read, {0, handle->read->size()});
        const TurnLogs logs =
            turn_logs({of.settings.start_toolface, of.settings.sectors, of.radius, window}, of.settings.threads);
        const std::vector<double>* const columns[] = {&logs.coverage,
                                                      &logs.mean,
                                                      &logs.mean_square,
                                                      &logs.smallest,
                                                      &logs.largest,
                                                      &logs.c1,
                                                      &logs.c1_toolface,
                                                      &logs.c2,
                                                      &logs.least_diameter,
                                                      &logs.diameter_0,
                                                      &logs.diameter_90,
                                                      &logs.centre_0,
                                                      &logs.centre_90,
                                                      &logs.inscribed_diameter,
                                                      &logs.inscribed_0,
                                                      &logs.inscribed_90,
                                                      &logs.enclosing_diameter,
                                                      &logs.rugosity};
        static_assert(std::size(columns) == HB_LOG_COLUMNS);
        require_room({turns}, {static_cast<Index>(logs.mean.size())});
        double* into = array("values", values, *turns).data();
        for (const auto* column : columns) into = std::copy(column->begin(), column->end(), into);
    });
}

int32_t hb_zone_criteria_init(hb_zone_criteria* criteria) {
    return guarded([&] { give("criteria", criteria, to_c(ZoneCriteria{}, usual_measured_rule)); });
}

int32_t hb_wall_zones(int64_t wall, const hb_zone_criteria* criteria, int64_t* turns, int32_t* kinds, int64_t* count,
                      double* values) {
    return guarded([&] { find_wall_zones(wall, criteria, {}, {}, turns, kinds, count, values); });
}

int32_t hb_wall_arm_zones(int64_t wall, const hb_zone_criteria* criteria, int64_t n, const double* depth,
                          const double* toolface, const double* radius, const int64_t* arm, const double* time,
                          int64_t* turns, int32_t* kinds, int64_t* count, double* values) {
    return guarded([&] {
        const SampleColumns given = samples_of(n, depth, toolface, radius, time);
        const std::span<const Index> arms = array("arm", arm, n);
        const std::vector<double> depths = copied(given.depth), toolfaces = copied(given.toolface),
                                  radii = copied(given.radius), times = copied(given.time);
        const SampleColumns samples{depths, toolfaces, radii, times};
        check_rows({&samples, 1});
        find_wall_zones(wall, criteria, samples, {arms.begin(), arms.end()}, turns, kinds, count, values);
    });
}

int32_t hb_wall_passage(int64_t wall, int64_t path, int64_t bodies, const double* start, const double* stop,
                        const double* diameter, int64_t vertices, const double* counts, const double* sigma,
                        int64_t* turns, double* values) {
    return guarded([&] {
        const auto handle = find<WallHandle>("wall", wall);
        const Path along = path == 0 ? Path() : find<PathHandle>("path", path)->path;
        const WallRadii of(*handle->read, all_of(*handle->read));
        const auto starts = column("start", start, bodies), stops = column("stop", stop, bodies),
                   diameters = column("diameter", diameter, bodies);
        std::vector<RigidBody> string;
        for (std::size_t b = 0; b < starts.size(); ++b) string.push_back({starts[b], stops[b], diameters[b]});
        const auto optional = [&](const char* name, const double* given) {
            return given ? column(name, given, vertices) : std::span<const double>();
        };
        require_room({turns}, {std::ssize(of.radius) / of.settings.sectors});
        const Passage found =
            passage(of.helix, along, string, optional("counts", counts), optional("sigma", sigma), of.settings.threads);
        double* into = array("values", values, HB_PASSAGE_COLUMNS * *turns).data();
        for (const auto* of_turn : {&found.clearance, &found.low, &found.high})
            into = std::copy(of_turn->begin(), of_turn->end(), into);
        const auto first_contact = [&](const auto& contacts) {
            for (std::size_t i = 0; i < contacts.size(); i += most_contacts) *into++ = static_cast<double>(contacts[i]);
        };
        first_contact(found.contact_depth);
        first_contact(found.contact_toolface);
        first_contact(found.contact_body);
    });
}

int32_t hb_wall_angular_gaps(int64_t wall, double reach, int64_t* count, double* values) {
    return guarded([&] {
        const auto handle = find<WallHandle>("wall", wall);
        require_room({count}, {handle->read->size()});
        const WallRadii of(*handle->read, all_of(*handle->read));
        const auto samples = handle->read->samples();
        fill(count, "values", values,
             angular_gaps(of.vertices(), {samples[0], samples[1]}, reach, of.settings.threads));
    });
}

int32_t hb_wall_sigma(int64_t wall, const hb_sigma_rule* rule, int64_t* count, double* values) {
    return guarded([&] {
        const auto handle = find<WallHandle>("wall", wall);
        const hb_sigma_rule with = taken("rule", rule, hb_sigma_rule{});
        const auto sums = handle->read->sums();
        fill(count, "values", values,
             sigma_of({sums[0], sums[1], sums[2], sums[3]},
                      {with.noise, with.between, with.scatter_power, with.distance_power, with.stretch, with.reach}));
    });
}

int32_t hb_wall_estimate(int64_t wall, int64_t n, const double* depth, const double* toolface, double* radius,
                         double* nearest) {
    return guarded([&] {
        const auto handle = find<WallHandle>("wall", wall);
        const std::span<const double> at = column("depth", depth, n), around = column("toolface", toolface, n);
        const auto samples = handle->read->samples();
        const Settings settings = handle->read->settings();
        const std::vector<double> trial(at.size(), 0.5 * settings.bit_diameter), none(at.size(), -1.0);
        const PointEstimates of =
            estimate_at({samples[0], samples[1], samples[2]}, {at, around, trial, none, none}, settings);
        copy_to(radius, of.radius);
        copy_to(nearest, of.nearest);
    });
}

int32_t hb_wall_volume(int64_t wall, int64_t path, int64_t start, int64_t stop, int64_t shells, const double* thickness,
                       int64_t* vertex_count, double* vertices, int64_t* hexahedron_count, int64_t* hexahedra) {
    return guarded([&] {
        const auto handle = find<WallHandle>("wall", wall);
        const Path along = path == 0 ? Path() : find<PathHandle>("path", path)->path;
        require(shells >= 1 && shells <= 1000, "shells", Index{shells}, "must lie in 1 to 1000");
        WallRadii of(*handle->read, {start, stop});
        std::vector<std::vector<double>> radii(1, of.radius);
        for (const double given : array("thickness", thickness, shells)) {
            const double thick = given;
            radii.push_back(of.radius);
            for (double& radius : radii.back()) radius += thick;
        }
        const std::vector<std::span<const double>> spans(radii.begin(), radii.end());
        const VolumeLayout layout = volume_layout(of.helix, spans);
        require_room({vertex_count, hexahedron_count}, {layout.vertex_count, layout.hexahedron_count});
        array("vertices", vertices, layout.vertex_count);
        array("hexahedra", hexahedra, layout.hexahedron_count);
        static_assert(sizeof(Hexahedron) == 8 * sizeof(std::int64_t));
        const std::span rows(reinterpret_cast<Vector3*>(vertices), static_cast<std::size_t>(layout.vertex_count));
        const std::span cells(reinterpret_cast<Hexahedron*>(hexahedra),
                              static_cast<std::size_t>(layout.hexahedron_count));
        for (std::size_t s = 0; s < spans.size(); ++s) {
            of.helix.radius = spans[s];
            place(of.helix, along, layout.shells[s], rows, of.settings.threads);
        }
        join(of.helix, layout, cells, of.settings.threads);
        require_upright(of.helix, layout, rows, cells, of.settings.threads);
    });
}

int32_t hb_wall_surface(int64_t wall, int64_t path, int64_t start, int64_t stop, int64_t* vertex_count,
                        double* vertices, int64_t* vertex_index, int64_t* quad_count, int64_t* quads) {
    return guarded([&] {
        const auto handle = find<WallHandle>("wall", wall);
        const Path along = path == 0 ? Path() : find<PathHandle>("path", path)->path;
        const WallRadii of(*handle->read, {start, stop});
        const SurfaceLayout layout = surface_layout(of.helix);
        require_room({vertex_count, quad_count}, {layout.vertex_count, layout.quad_count});
        array("vertices", vertices, layout.vertex_count);
        array("quads", quads, layout.quad_count);
        static_assert(sizeof(Vector3) == 3 * sizeof(double) && sizeof(Quad) == 4 * sizeof(std::int64_t));
        const auto rows = static_cast<std::size_t>(layout.vertex_count);
        place(of.helix, along, layout.vertices, {reinterpret_cast<Vector3*>(vertices), rows}, of.settings.threads);
        join(of.helix, layout, {reinterpret_cast<Quad*>(quads), static_cast<std::size_t>(layout.quad_count)},
             of.settings.threads);
        if (!vertex_index) return;
        for (const VertexRun& run : layout.vertices)
            for (Index k = run.k.start; k < run.k.stop; ++k) *vertex_index++ = k;
    });
}

int32_t hb_path_create(const hb_path_settings* settings, int64_t n, const double* depth, const double* inclination,
                       const double* azimuth, int64_t* path) {
    return guarded([&] {
        require_pointer("path", path);
        const PathSettings how = settings_of(settings);
        const Survey survey(column("depth", depth, n), column("inclination", inclination, n),
                            column("azimuth", azimuth, n));
        open(path, std::make_shared<PathHandle>(PathHandle{Path(survey, how)}));
    });
}

int32_t hb_path_read(int64_t path, int64_t n, const double* depth, double* position, double* frame) {
    return guarded([&] {
        const auto handle = find<PathHandle>("path", path);
        const std::span<const double> at = column("depth", depth, n);
        const std::vector<Vector3> positions = position ? handle->path.position(at) : std::vector<Vector3>();
        const std::vector<Frame> frames = frame ? handle->path.frame(at) : std::vector<Frame>();
        static_assert(sizeof(Frame) == 9 * sizeof(double));
        if (!positions.empty()) std::memcpy(position, positions.data(), positions.size() * sizeof(Vector3));
        if (!frames.empty()) std::memcpy(frame, frames.data(), frames.size() * sizeof(Frame));
    });
}

int32_t hb_preparation_init(hb_preparation* settings) {
    return guarded([&] { give("settings", settings, to_c(PreparationSettings{})); });
}

int32_t hb_prepare(const hb_preparation* settings, int64_t n, const double* depth, const double* toolface,
                   const double* time, int32_t columns, const double* radii, int32_t sensors, const double* offset,
                   const double* mounting, const int32_t* column_of, int64_t* prepared) {
    return guarded([&] {
        const PreparationSettings how = settings_of(settings);
        require_pointer("prepared", prepared);
        require(columns >= 0, "columns", Index{columns}, "must be 0 or more");
        require(sensors >= 0, "sensors", Index{sensors}, "must be 0 or more");
        ToolRows rows{column("depth", depth, n), column("toolface", toolface, n), {}, {}};
        if (time) rows.time = column("time", time, n);
        for (std::int64_t c = 0; c < columns; ++c) {
            require_pointer("radii", radii);
            rows.radii.push_back(array("radii", radii + c * n, n));
        }
        const std::span<const double> offsets = array("offset", offset, sensors),
                                      mountings = array("mounting", mounting, sensors);
        const std::span<const std::int32_t> places = array("column", column_of, sensors);
        std::vector<ToolSensor> tool;
        for (std::size_t s = 0; s < places.size(); ++s) tool.push_back({offsets[s], mountings[s], places[s]});
        open(prepared, std::make_shared<PreparedHandle>(PreparedHandle{prepare(rows, tool, how)}));
    });
}

int32_t hb_prepared_get(int64_t prepared, hb_prepared_state* state) {
    return guarded([&] {
        const auto handle = find<PreparedHandle>("prepared", prepared);
        const Prepared& of = handle->prepared;
        const ToolSamples& samples = of.samples;
        give("state", state,
             hb_prepared_state{.size = sizeof(hb_prepared_state),
                               .reserved = 0,
                               .samples = static_cast<Index>(samples.depth.size()),
                               .suspects = static_cast<Index>(of.suspects.size()),
                               .no_depth = samples.no_depth,
                               .no_toolface = samples.no_toolface,
                               .no_radius = samples.no_radius,
                               .no_time = samples.no_time,
                               .repeats = of.repeats,
                               .spikes = of.spikes});
    });
}

int32_t hb_prepared_samples(int64_t prepared, int32_t column, int64_t* count, double* values) {
    return guarded([&] {
        const auto handle = find<PreparedHandle>("prepared", prepared);
        const ToolSamples& samples = handle->prepared.samples;
        switch (column) {
            case HB_DEPTH:
                return fill(count, "values", values, samples.depth);
            case HB_TOOLFACE:
                return fill(count, "values", values, samples.toolface);
            case HB_RADIUS:
                return fill(count, "values", values, samples.radius);
            case HB_TIME:
                return fill(count, "values", values, samples.time);
            case HB_SENSOR:
                return fill(count, "values", values, samples.sensor);
            case HB_ROW:
                return fill(count, "values", values, samples.row);
            default:
                throw InputError("column", "must be 0, 1, 2, 7, 8 or 9", std::to_string(column));
        }
    });
}

int32_t hb_prepared_suspects(int64_t prepared, int64_t* count, int32_t* cause, int32_t* column, int32_t* other,
                             int64_t* start_stop, int32_t* dropped, double* radius) {
    return guarded([&] {
        const auto handle = find<PreparedHandle>("prepared", prepared);
        const std::vector<SuspectRows>& suspects = handle->prepared.suspects;
        require_room({count}, {static_cast<Index>(suspects.size())});
        for (std::size_t i = 0; i < suspects.size(); ++i) {
            if (cause) cause[i] = static_cast<std::int32_t>(suspects[i].cause);
            if (column) column[i] = static_cast<std::int32_t>(suspects[i].column);
            if (other) other[i] = static_cast<std::int32_t>(suspects[i].other);
            if (start_stop) start_stop[2 * i] = suspects[i].rows.start, start_stop[2 * i + 1] = suspects[i].rows.stop;
            if (dropped) dropped[i] = suspects[i].dropped;
            if (radius) radius[i] = suspects[i].radius;
        }
    });
}

int32_t hb_live_create(const hb_settings* settings, const hb_path_settings* path, int64_t* live) {
    return guarded([&] {
        require_pointer("live", live);
        open(live, std::make_shared<LiveHandle>(LiveSettings{settings_of(settings), settings_of(path)}));
    });
}

int32_t hb_live_append_samples(int64_t live, int64_t n, const double* depth, const double* toolface,
                               const double* radius, const double* time) {
    return guarded(
        [&] { find<LiveHandle>("live", live)->live.append_samples(samples_of(n, depth, toolface, radius, time)); });
}

int32_t hb_live_append_stations(int64_t live, int64_t n, const double* depth, const double* inclination,
                                const double* azimuth) {
    return guarded([&] {
        find<LiveHandle>("live", live)
            ->live.append_stations(column("depth", depth, n), column("inclination", inclination, n),
                                   column("azimuth", azimuth, n));
    });
}

int32_t hb_live_append_image(int64_t live, const char* name, const char* unit, int64_t n, int32_t sectors,
                             const double* depth, const double* values) {
    return guarded([&] {
        const auto handle = find<LiveHandle>("live", live);
        require_pointer("name", name);
        require_pointer("unit", unit);
        require(sectors >= 1 && sectors <= 1000000, "sectors", Index{sectors}, "must lie in 1 to 1000000");
        const auto depths = column("depth", depth, n);
        const Index most = std::numeric_limits<Index>::max() / sectors;
        require(n <= most, "n", Index{n}, "must be at most " + std::to_string(most));
        handle->live.append_image(name, depths, column("values", values, n * sectors), unit);
    });
}

int32_t hb_live_poll(int64_t live, hb_update* update) {
    return guarded([&] {
        const auto handle = find<LiveHandle>("live", live);
        require_struct("update", update);
        const std::lock_guard held(handle->lock);
        handle->last = handle->live.poll();
        const Update& last = handle->last;
        give("update", update,
             hb_update{.size = sizeof *update,
                       .reserved = 0,
                       .change = last.change ? to_c(*last.change) : to_c(Change{}),
                       .path_from = last.path_from.value_or(no_value),
                       .images = static_cast<Index>(last.images.size()),
                       .events = static_cast<Index>(last.events.size())});
    });
}

int32_t hb_live_event(int64_t live, int64_t index, int64_t* count, char* text) {
    return guarded([&] {
        const auto handle = find<LiveHandle>("live", live);
        const std::lock_guard held(handle->lock);
        const std::vector<std::string>& events = handle->last.events;
        require(index >= 0 && index < static_cast<Index>(events.size()), "index", Index{index},
                "must lie within the " + std::to_string(events.size()) + " events of the last poll");
        const std::string& event = events[static_cast<std::size_t>(index)];
        fill(count, "text", text, std::span(event.c_str(), event.size() + 1));
    });
}

int32_t hb_live_image(int64_t live, const char* name, int32_t* sectors, int64_t* rows, double* depth, double* values) {
    return guarded([&] {
        const auto handle = find<LiveHandle>("live", live);
        require_pointer("name", name);
        require_pointer("sectors", sectors);
        const ImageArrays image = handle->live.image(name);
        *sectors = image.sectors;
        require_room({rows}, {static_cast<Index>(image.depth.size())});
        copy_to(array("depth", depth, *rows).data(), image.depth);
        copy_to(array("values", values, *rows).data(), image.values);
    });
}

int32_t hb_live_wall(int64_t live, int64_t* wall) {
    return guarded([&] {
        const auto handle = find<LiveHandle>("live", live);
        require_pointer("wall", wall);
        const auto reader = std::make_shared<WallHandle>();
        reader->read = std::shared_ptr<const Wall>(handle, &handle->live.wall());
        open(wall, reader);
    });
}

int32_t hb_live_path(int64_t live, int64_t* path) {
    return guarded([&] {
        const auto handle = find<LiveHandle>("live", live);
        require_pointer("path", path);
        const std::optional<Path> found = handle->live.path();
        if (!found) throw InputError("path", "needs two stations");
        open(path, std::make_shared<PathHandle>(PathHandle{*found}));
    });
}

int32_t hb_wits_create(int64_t* parser) {
    return guarded([&] {
        require_pointer("parser", parser);
        open(parser, std::make_shared<ParserHandle>());
    });
}

int32_t hb_wits_feed(int64_t parser, int64_t n, const char* bytes, int64_t* items, int64_t* events) {
    return guarded([&] {
        const auto handle = find<ParserHandle>("parser", parser);
        require_count(n);
        const std::span<const char> text = array("bytes", bytes, n);
        const std::lock_guard held(handle->lock);
        handle->last = n == 0 ? handle->parser.finish() : handle->parser.feed({text.data(), text.size()});
        if (items) *items = static_cast<Index>(handle->last.items.size());
        if (events) *events = static_cast<Index>(handle->last.events.size());
    });
}

int32_t hb_wits_items(int64_t parser, int64_t* count, int64_t* frame, int32_t* code, double* value, int64_t* offset,
                      int32_t* length) {
    return guarded([&] {
        const auto handle = find<ParserHandle>("parser", parser);
        const std::lock_guard held(handle->lock);
        const std::vector<wits::Item>& items = handle->last.items;
        require_room({count}, {static_cast<Index>(items.size())});
        for (std::size_t i = 0; i < items.size(); ++i) {
            if (frame) frame[i] = items[i].frame;
            if (code) code[i] = items[i].code;
            if (value) value[i] = items[i].value;
            if (offset) offset[i] = items[i].offset;
            if (length) length[i] = items[i].length;
        }
    });
}
