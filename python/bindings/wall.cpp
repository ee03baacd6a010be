// helibore._core.Wall, and the functions that check samples and estimate radii and their sigma. arrays.hpp converts
// arrays. The GIL is released before the wall's lock is taken.
#include "helibore/wall.hpp"

#include <pybind11/stl.h>

#include <limits>

#include "arrays.hpp"
#include "base/locks.hpp"
#include "gil.hpp"
#include "helibore/covariance.hpp"
#include "helibore/error.hpp"
#include "helibore/estimates.hpp"
#include "register.hpp"

namespace helibore::bindings {
namespace {

InstructionSet instruction_set_named(const std::string& name) {
    if (name == "automatic") return InstructionSet::automatic;
    if (name == "plain") return InstructionSet::plain;
    if (name == "avx2") return InstructionSet::avx2;
    if (name == "avx512") return InstructionSet::avx512;
    throw InputError("instruction_set", "must be automatic, plain, avx2 or avx512", "'" + name + "'");
}

Estimator estimator_named(const std::string& name) {
    if (name == "inverse-distance") return Estimator::inverse_distance;
    if (name == "kriging") return Estimator::kriging;
    if (name == "near-and-far") return Estimator::near_and_far;
    throw InputError("estimator", "must be inverse-distance, kriging or near-and-far", "'" + name + "'");
}

// Settings have the same names in Python and C++; None means no value, or no limit.
Settings settings_of(const py::dict& given, int threads, const std::string& instruction_set) {
    Settings s;
    const auto take = [&](const char* name, auto& member) {
        member = given[name].cast<std::remove_reference_t<decltype(member)>>();
    };
    std::optional<double> max_distance;
    take("bit_diameter", s.bit_diameter);
    take("sectors", s.sectors);
    take("pitch", s.pitch);
    take("start_depth", s.start_depth);
    take("stop_depth", s.stop_depth);
    take("start_toolface", s.start_toolface);
    take("first_vertex", s.first_vertex);
    take("stop_vertex", s.stop_vertex);
    take("neighbors", s.neighbors);
    take("window", s.window);
    take("power", s.power);
    take("max_distance", max_distance);
    take("max_iterations", s.max_iterations);
    take("tolerance", s.tolerance);
    take("angular_scale", s.angular_scale);
    if (!given["estimator"].is_none()) s.estimator = estimator_named(given["estimator"].cast<std::string>());
    std::optional<double> kriging_range;
    take("kriging_range", kriging_range);
    take("nugget", s.nugget);
    std::optional<std::vector<double>> covariance, other_turns, stretches;
    take("covariance", covariance);
    take("other_turns", other_turns);
    take("stretches", stretches);
    s.covariance = covariance.value_or(std::vector<double>{});
    s.other_turns = other_turns.value_or(std::vector<double>{});
    s.stretches = stretches.value_or(std::vector<double>{});
    take("robust", s.robust);
    take("sigma", s.sigma);
    take("direct", s.direct);
    take("most_vertices", s.most_vertices);
    s.max_distance = max_distance.value_or(std::numeric_limits<double>::infinity());
    s.kriging_range = kriging_range.value_or(0.0);
    s.threads = threads;
    s.instruction_set = instruction_set_named(instruction_set);
    return s;
}

SampleColumns columns_of(const Column& depth, const Column& toolface, const Column& radius,
                         const std::optional<Column>& time) {
    SampleColumns columns{span_of(depth), span_of(toolface), span_of(radius)};
    if (time) columns.time = span_of(*time);
    return columns;
}

// Returns whether the core can read all of these arrays in place.
bool are_columns(py::handle depth, py::handle toolface, py::handle radius, py::handle time) {
    const auto is_one = [](py::handle values) {
        return is_column(values) && py::reinterpret_borrow<py::array>(values).ndim() == 1;
    };
    return is_one(depth) && is_one(toolface) && is_one(radius) && (time.is_none() || is_one(time));
}

// Calls a reader of the wall without the GIL: while it waits for an append, other Python threads continue.
template <class T>
T read_of(const Wall& wall, T (Wall::*read)() const) {
    const WithoutGil released;
    return (wall.*read)();
}

template <class T>
auto number(T (Wall::*read)() const) {
    return [read](const Wall& wall) { return read_of(wall, read); };
}

// Reads the radii into an array on all threads of the wall. If the wall has grown since the array was made, returns
// the result of `Wall::radius` instead.
py::array_t<double> radius_of(const Wall& wall) {
    py::array_t<double> radius(read_of(wall, &Wall::size));
    const std::span<double> into(radius.mutable_data(), static_cast<std::size_t>(radius.size()));
    {
        const WithoutGil released;
        if (wall.read_radius(into) == static_cast<Index>(into.size())) return radius;
    }
    return array_of(read_of(wall, &Wall::radius));
}

// Reads columns into NumPy arrays, which lie in large pages. Returns () if the wall has grown in the meantime, or if
// the number of its columns is not `kinds`.
py::tuple read_into_arrays(const Wall& wall, Index count, std::size_t kinds,
                           bool (Wall::*read)(std::span<const std::span<double>>) const) {
    py::list arrays;
    std::vector<std::span<double>> into;
    for (std::size_t i = 0; i < kinds; ++i) {
        py::array_t<double> column(count);
        into.emplace_back(column.mutable_data(), static_cast<std::size_t>(count));
        arrays.append(std::move(column));
    }
    bool fits = false;
    {
        const WithoutGil released;
        fits = (wall.*read)(into);
    }
    return fits ? py::tuple(arrays) : py::tuple();
}

template <class Columns>
py::tuple arrays_of(Columns&& columns) {
    py::list arrays;
    for (auto& column : columns) arrays.append(array_of(std::move(column)));
    return py::tuple(arrays);
}

py::tuple samples_of(const Wall& wall) {
    const Index count = read_of(wall, &Wall::sample_count);
    for (const std::size_t kinds : {std::size_t{3}, std::size_t{4}})
        if (auto columns = read_into_arrays(wall, count, kinds, &Wall::read_samples); !columns.empty()) return columns;
    return arrays_of(read_of(wall, &Wall::samples));
}

py::tuple sums_of(const Wall& wall) {
    auto columns = read_into_arrays(wall, read_of(wall, &Wall::size), 4, &Wall::read_sums);
    return columns.empty() ? arrays_of(read_of(wall, &Wall::sums)) : columns;
}

template <class T>
auto reader(std::vector<T> (Wall::*read)() const) {
    return [read](const Wall& wall) { return array_of(read_of(wall, read)); };
}

// Returns bytes of 0 and 1 as an array of bool.
py::array flags_of(std::vector<std::uint8_t> values) {
    return array_of(std::move(values)).view("?");
}

py::array_t<Index> ranges_of(const Change& change) {
    py::array_t<Index> out({static_cast<py::ssize_t>(change.ranges.size()), py::ssize_t{2}});
    static_assert(sizeof(Range) == 2 * sizeof(Index));
    if (!change.ranges.empty())
        std::memcpy(out.mutable_data(), change.ranges.data(), change.ranges.size() * sizeof(Range));
    return out;
}

}  // namespace

void register_wall(py::module_& m) {
    // The lock of a wall in Python, which does more than the core in one call. It is one of the core, since a lock of
    // Python waits for ever for its own thread (a signal or a finalizer calls again), in a forked process, and in a
    // finalizer that runs when the program ends, for a thread that has stopped.
    py::class_<CallLock>(m, "WallLock")
        .def(py::init([] { return std::make_unique<CallLock>("wall"); }))
        .def("__enter__",
             [](CallLock& lock) {
                 if (lock.try_lock()) return;
                 if (interpreter_ends())
                     throw InputError("this wall", "is in use by a thread that ended with the program");
                 const WithoutGil released;
                 lock.lock();
             })
        .def("__exit__", [](CallLock& lock, const py::args&) { lock.unlock(); });
    py::class_<Wall>(m, "Wall")
        .def(py::init([](const py::dict& settings, int threads, const std::string& instruction_set) {
                 return std::make_unique<Wall>(settings_of(settings, threads, instruction_set));
             }),
             py::arg("settings"), py::arg("threads"), py::arg("instruction_set"))
        .def(
            "append",
            [](Wall& wall, const Column& depth, const Column& toolface, const Column& radius,
               const std::optional<Column>& time) {
                const SampleColumns columns = columns_of(depth, toolface, radius, time);
                Change change;
                {
                    const WithoutGil released;
                    change = wall.append(columns);
                }
                return py::make_tuple(ranges_of(change), change.settled, change.accepted, change.redundant);
            },
            py::arg("depth"), py::arg("toolface"), py::arg("radius"), py::arg("time") = py::none())
        .def("__len__", number(&Wall::size))
        .def_property_readonly("sample_count", number(&Wall::sample_count))
        .def_property_readonly("settled", number(&Wall::settled))
        .def_property_readonly("start_depth", number(&Wall::start_depth))
        .def("depth", reader(&Wall::depth))
        .def("toolface", reader(&Wall::toolface))
        .def("radius", &radius_of)
        .def("nearest", reader(&Wall::nearest))
        .def("support", reader(&Wall::support))
        .def("iterations", reader(&Wall::iterations))
        .def("provisional", [](const Wall& wall) { return flags_of(read_of(wall, &Wall::provisional)); })
        .def(
            "vertices",
            [](const Wall& wall, Index start, Index stop) {
                VertexColumns of;
                {
                    const WithoutGil released;
                    of = wall.vertices({start, stop});
                }
                return py::make_tuple(array_of(std::move(of.depth)), array_of(std::move(of.toolface)),
                                      array_of(std::move(of.radius)), array_of(std::move(of.nearest)),
                                      array_of(std::move(of.support)), array_of(std::move(of.iterations)),
                                      flags_of(std::move(of.provisional)));
            },
            py::arg("start"), py::arg("stop"))
        .def(
            "reach",
            [](const Wall& wall, Index start, Index stop) {
                const WithoutGil released;
                const Depths depths = wall.reach({start, stop});
                return std::pair{depths.shallow, depths.deep};
            },
            py::arg("start"), py::arg("stop"))
        .def(
            "interpolate_samples",
            [](const Wall& wall, const std::vector<Column>& channels, int threads) {
                std::vector<std::span<const double>> spans;
                for (const Column& channel : channels) spans.push_back(span_of(channel));
                std::vector<std::vector<double>> values;
                {
                    const WithoutGil released;
                    values = wall.interpolate_samples(spans, threads);
                }
                py::list arrays;
                for (auto& channel : values) arrays.append(array_of(std::move(channel)));
                return arrays;
            },
            py::arg("channels"), py::arg("threads"))
        .def("sums", &sums_of)
        .def("samples", &samples_of);
    m.def("are_columns", &are_columns, py::arg("depth"), py::arg("toolface"), py::arg("radius"), py::arg("time"));
    m.def(
        "check_samples",
        [](const Column& depth, const Column& toolface, const Column& radius, const std::optional<Column>& time,
           int threads) {
            const SampleColumns columns = columns_of(depth, toolface, radius, time);
            const WithoutGil released;
            columns.validate(threads);
        },
        py::arg("depth"), py::arg("toolface"), py::arg("radius"), py::arg("time"), py::arg("threads"));
    py::class_<PointSamples>(m, "PointSamples")
        .def(py::init([](const Column& depth, const Column& toolface, const Column& radius, int threads) {
                 const SampleColumns columns = columns_of(depth, toolface, radius, std::nullopt);
                 const WithoutGil released;
                 return std::make_unique<PointSamples>(columns, threads);
             }),
             py::arg("depth"), py::arg("toolface"), py::arg("radius"), py::arg("threads"));
    m.def(
        "estimate_at",
        [](const PointSamples& samples, const std::array<Column, 5>& points, const py::dict& settings, int threads,
           const std::vector<double>& nuggets) {
            const PointColumns at{span_of(points[0]), span_of(points[1]), span_of(points[2]), span_of(points[3]),
                                  span_of(points[4])};
            const Settings with = settings_of(settings, threads, "automatic");
            PointEstimates of;
            {
                const WithoutGil released;
                of = estimate_at(samples, at, with, nuggets);
            }
            py::list by_nugget;
            for (auto& column : of.by_nugget) by_nugget.append(array_of(std::move(column)));
            return py::make_tuple(array_of(std::move(of.radius)), array_of(std::move(of.nearest)),
                                  array_of(std::move(of.farthest)), array_of(std::move(of.square_weights)),
                                  array_of(std::move(of.scatter)), array_of(std::move(of.along)),
                                  array_of(std::move(of.across)), by_nugget);
        },
        py::arg("samples"), py::arg("points"), py::arg("settings"), py::arg("threads"), py::arg("nuggets"));
    m.def(
        "nearest_to",
        [](const PointSamples& samples, const std::array<Column, 5>& points, const py::dict& settings, double stretch,
           int threads) {
            const PointColumns at{span_of(points[0]), span_of(points[1]), span_of(points[2]), span_of(points[3]),
                                  span_of(points[4])};
            const Settings with = settings_of(settings, threads, "automatic");
            std::vector<Index> rows;
            {
                const WithoutGil released;
                rows = nearest_to(samples, at, with, stretch);
            }
            return array_of(std::move(rows), {static_cast<py::ssize_t>(at.depth.size()), with.neighbors});
        },
        py::arg("samples"), py::arg("points"), py::arg("settings"), py::arg("stretch"), py::arg("threads"));
    m.def(
        "fit_covariance",
        [](const std::array<Column, 3>& samples, Index block_size, double radius, double spacing, double least_turn,
           int threads, const std::string& instruction_set) {
            const SampleColumns columns = columns_of(samples[0], samples[1], samples[2], std::nullopt);
            const InstructionSet level = instruction_set_named(instruction_set);
            std::vector<LikelyCovariance> found;
            {
                const WithoutGil released;
                found = fit_covariance(columns, block_size, radius, spacing, least_turn, threads, level);
            }
            py::list all;
            for (const LikelyCovariance& of : found) all.append(py::make_tuple(of.values, of.share));
            return all;
        },
        py::arg("samples"), py::arg("block_size"), py::arg("radius"), py::arg("spacing"), py::arg("least_turn"),
        py::arg("threads"), py::arg("instruction_set") = "automatic");
    m.def(
        "covariances_near",
        [](const std::array<Column, 3>& samples, Index block_size, Index blocks,
           const std::vector<std::vector<double>>& starts, double spacing, int threads) {
            const SampleColumns columns = columns_of(samples[0], samples[1], samples[2], std::nullopt);
            const WithoutGil released;
            return covariances_near(columns, block_size, blocks, starts, spacing, threads);
        },
        py::arg("samples"), py::arg("block_size"), py::arg("blocks"), py::arg("starts"), py::arg("spacing"),
        py::arg("threads"));
    m.def(
        "covariance_likelihoods",
        [](const std::array<Column, 3>& samples, Index block_size, Index blocks,
           const std::vector<std::vector<double>>& covariances, int threads) {
            const SampleColumns columns = columns_of(samples[0], samples[1], samples[2], std::nullopt);
            std::vector<double> found;
            {
                const WithoutGil released;
                found = covariance_likelihoods(columns, block_size, blocks, covariances, threads);
            }
            const auto each = static_cast<py::ssize_t>(covariances.size()), parts = std::ssize(found) / each;
            return array_of(std::move(found), {parts, each});
        },
        py::arg("samples"), py::arg("block_size"), py::arg("blocks"), py::arg("covariances"), py::arg("threads"));
    m.def(
        "calibrate",
        [](const std::array<Column, 3>& samples, const py::array_t<Index>& rows, const std::array<Column, 2>& boxes,
           const py::dict& settings, int threads) {
            const SampleColumns columns = columns_of(samples[0], samples[1], samples[2], std::nullopt);
            const LeftOut left_out{
                {rows.data(), static_cast<std::size_t>(rows.size())}, span_of(boxes[0]), span_of(boxes[1])};
            const Settings with = settings_of(settings, threads, "automatic");
            std::optional<Calibration> found;
            {
                const WithoutGil released;
                found = calibrate(columns, left_out, with);
            }
            if (!found) return py::object(py::none());
            return py::object(py::make_tuple(found->noise, found->between, found->scatter_power, found->distance_power,
                                             found->stretch, found->quantile, found->reach));
        },
        py::arg("samples"), py::arg("rows"), py::arg("boxes"), py::arg("settings"), py::arg("threads"));
    m.def(
        "sigma_of",
        [](const std::array<Column, 4>& sums, const std::array<double, 6>& rule) {
            const auto [noise, between, scatter_power, distance_power, stretch, reach] = rule;
            return array_of(sigma_of({span_of(sums[0]), span_of(sums[1]), span_of(sums[2]), span_of(sums[3])},
                                     {noise, between, scatter_power, distance_power, stretch, reach}));
        },
        py::arg("sums"), py::arg("rule"));
    m.def("instruction_set_in_use", [] { return std::string(instruction_set_in_use()); });
}

}  // namespace helibore::bindings
