// Turns surveys into segments of curves, and segments into positions and frames. In the formulas, t
// is the tangent, L the course length, I the inclination, A the azimuth; m: the mean, d: the change over the course.
//
//   dogleg b = 2 atan2(|t2 - t1|, |t2 + t1|)        no cancellation at tiny or huge b
//   minimum curvature     step = L/2 (t1 + t2) tan(b/2)/(b/2)
//   radius of curvature   step = (H cos(Am) sinc(dA/2), H sin(Am) sinc(dA/2), L cos(Im) sinc(dI/2)),
//                         H = L sin(Im) sinc(dI/2), dA wrapped to [-180, 180)
//
// Sources: Sawaryn and Thorogood, SPE 84246 (arcs); the classic radius-of-curvature quotients (cosI1 - cosI2)/(I2 - I1)
// rewritten so that no 0/0 occurs.
#include "helibore/path.hpp"

#include <algorithm>
#include <cmath>
#include <new>
#include <type_traits>
#include <utility>

#include "base/arithmetic.hpp"
#include "base/degrees.hpp"
#include "base/host_memory.hpp"
#include "base/messages.hpp"
#include "helibore/error.hpp"
#include "surface/segments.hpp"

namespace helibore {

struct StationColumns {
    std::span<const double> depth, inclination, azimuth;
};

namespace {

using glm::dvec3;

StationColumns columns_of(const Survey& survey) {
    return {survey.depth(), survey.inclination(), survey.azimuth()};
}

// Two tangents that are opposite to within this angle (radians) define no plane for an arc.
constexpr double least_from_opposite = 1e-8;
// A course that covers less horizontal distance than this share of its length is vertical: its azimuth cannot change.
constexpr double least_across = 1e-12;
constexpr double least_course = 1e-6;  // metres between two stations; the curvature stays finite

// Throws InputError unless all values lie in [low, high]. In the error, values[0] is entry `first` of its column.
void require_between(const char* name, std::span<const double> values, double low, double high, Index first) {
    for (std::size_t i = 0; i < values.size(); ++i) {
        if (values[i] >= low && values[i] <= high) continue;
        const char* unit = std::isfinite(values[i]) ? " degrees" : "";
        throw InputError(
            entry_name(name, Index(i) + first),
            *unit ? "must lie in " + number_text(low) + " to " + number_text(high) + unit : "must be finite",
            number_text(values[i]));
    }
}

void require_growing(std::span<const double> depth, Index first) {
    for (std::size_t i = 1; i < depth.size(); ++i) {
        if (depth[i] - depth[i - 1] >= least_course) continue;
        throw InputError(entry_name("depth", Index(i) + first),
                         (depth[i] <= depth[i - 1] ? "must be greater than " : "must be 1e-6 m or more below ") +
                             entry_text("depth", Index(i) - 1 + first, depth[i - 1]),
                         number_text(depth[i]));
    }
}

double sinc(double x) {
    return std::abs(x) <= max_bend ? sine_ratio(x) : sine_cosine_of_radians(x).sine / x;
}

struct Station {
    double depth, inclination, azimuth;  // metres, degrees
    SineCosine i, a;
    dvec3 tangent;
};

Station station(const StationColumns& columns, std::size_t index) {
    // Adding 0.0 turns -0 into 0, so that equal stations give the same bits.
    const double depth = columns.depth[index] + 0.0, inclination = columns.inclination[index] + 0.0;
    const double azimuth = columns.azimuth[index] + 0.0;
    const SineCosine i = sine_cosine(inclination), a = sine_cosine(azimuth);
    return {depth, inclination, azimuth, i, a, {i.sine * a.cosine, i.sine * a.sine, i.cosine}};
}

// Returns the dogleg in radians. |t2 - t1| / 2 is written as the haversine, which is exact for doglegs far below a
// millionth of a degree.
double dogleg_between(const Station& above, const Station& below) {
    const double build = sine_cosine(0.5 * (below.inclination - above.inclination)).sine;
    const double turn = sine_cosine(0.5 * wrap_difference(below.azimuth - above.azimuth)).sine;
    const double half_chord = std::sqrt(build * build + above.i.sine * below.i.sine * (turn * turn));
    return 2.0 * arc_tangent(half_chord, 0.5 * glm::length(below.tangent + above.tangent));
}

int segments_for(double bend) {
    return std::max(1, static_cast<int>(std::ceil(bend / max_bend)));
}

// Appends the arcs of one course that starts at `head`; returns the position of its end.
//
//         m = unit(t1 + t2)          The arc lies in the plane of m, its tangent half-way, and e, normal to m.
//     t1 \ | / t2                    t(x) = cos(x - b/2) m + sin(x - b/2) e,  x from 0 to b,
//         \|/                        and its normal is dt/dx.
//          +---> e = unit(t2 - t1)
dvec3 append_course(std::vector<Arc>& arcs, const Station& above, const Station& below, const dvec3& head) {
    const double length = below.depth - above.depth;
    const dvec3 sum = above.tangent + below.tangent, difference = below.tangent - above.tangent;
    const double bend = dogleg_between(above, below);
    if (bend == 0.0 || glm::length(difference) == 0.0) {
        arcs.push_back({above.depth, head, above.tangent, dvec3(0.0), 0.0});
        return head + length * above.tangent;
    }
    const dvec3 m = sum / glm::length(sum), e = difference / glm::length(difference);
    const double curvature = bend / length;
    const int count = segments_for(bend);
    for (int j = 0; j < count; ++j) {
        const double beyond = length * j / count, x = curvature * beyond;
        const auto [s, c] = sine_cosine_of_radians(x - 0.5 * bend);
        const SineCosine middle = sine_cosine_of_radians(0.5 * x - 0.5 * bend);
        const dvec3 chord = middle.cosine * m + middle.sine * e;
        const dvec3 position = head + beyond * sinc(0.5 * x) * chord;
        arcs.push_back({above.depth + beyond, j == 0 ? head : position, j == 0 ? above.tangent : c * m + s * e,
                        c * e - s * m, curvature});
    }
    const SineCosine half = sine_cosine_of_radians(0.5 * bend);
    return head + 0.5 * length * (half.sine / (half.cosine * (0.5 * bend))) * sum;
}

// Appends the cylinder curves of one course that starts at `head`; returns the position of its end.
dvec3 append_course(std::vector<CylinderCurve>& curves, const Station& above, const Station& below, const dvec3& head) {
    const double length = below.depth - above.depth;
    const double build = (below.inclination - above.inclination) * degree / length;
    const double azimuth_change = wrap_difference(below.azimuth - above.azimuth) * degree;
    const auto across = [&](double beyond) {
        const double half = 0.5 * build * beyond;
        return beyond * sine_cosine(above.inclination + half / degree).sine * sinc(half);
    };
    const double whole = across(length);
    const double turn = whole > least_across * length ? azimuth_change / whole : 0.0;
    const auto position = [&](double beyond) {
        const double half = 0.5 * build * beyond, far = across(beyond), half_turn = 0.5 * turn * far;
        const SineCosine a = sine_cosine(above.azimuth + half_turn / degree);
        const double level = far * sinc(half_turn);
        const double down = beyond * sine_cosine(above.inclination + half / degree).cosine * sinc(half);
        return head + dvec3(level * a.cosine, level * a.sine, down);
    };
    // On a course the sine of the inclination is at most twice its mean. So the azimuth changes at most at twice its
    // mean rate.
    const int count = segments_for(std::max(std::abs(build) * length, 2.0 * std::abs(azimuth_change)));
    for (int j = 0; j < count; ++j) {
        const double beyond = length * j / count;
        const SineCosine i = sine_cosine(above.inclination + build * beyond / degree);
        const SineCosine a = sine_cosine(above.azimuth + turn * across(beyond) / degree);
        curves.push_back({above.depth + beyond, position(beyond), i.sine, i.cosine, a.sine, a.cosine, build, turn});
    }
    return position(length);
}

void require_arc(const Station& above, const Station& below, Index index) {
    if (glm::length(above.tangent + below.tangent) >= least_from_opposite) return;
    throw InputError(entry_name("depth", index),
                     "the hole turns by 180 deg since " + entry_text("depth", index - 1, above.depth) +
                         ", so the arc between them is not known: must be less than 180",
                     number_text(below.depth));
}

void require_sane(const PathSettings& settings) {
    for (std::size_t i = 0; i < 3; ++i) {
        const std::string place = entry_name("head", Index(i));
        require(std::isfinite(settings.head[i]), place, settings.head[i], "must be finite");
        require(std::abs(settings.head[i]) <= 1e9, place, settings.head[i], "must lie in -1e9 to 1e9 m");
    }
    require(settings.extend >= 0.0 && std::isfinite(settings.extend), "extend", settings.extend,
            "must be finite and not negative");
    require(settings.extend <= largest_depth, "extend", settings.extend, "must be at most 10000000 m");
}

// Moves toolface 0 from the first segment to the starts of the others by parallel transport, from segment `from` on.
template <class Segment>
void transport_toolface(std::vector<Segment>& segments, std::size_t from) {
    if (from == 0) {
        const PathPoint top = segments.front().at(0.0);
        const Axes north = axes_of<Reference::north>(segments.front(), top);
        const Axes first = north.square >= 0.5 ? north : axes_of<Reference::high_side>(segments.front(), top);
        segments.front().zero = glm::normalize(dvec3(first.zero_n, first.zero_e, first.zero_d));
    }
    for (std::size_t i = std::max<std::size_t>(from, 1); i < segments.size(); ++i) {
        const dvec3 t = segments[i].start_tangent();
        const Axes a = axes_of<Reference::parallel_transport>(segments[i - 1], {0.0, 0.0, 0.0, t.x, t.y, t.z});
        const dvec3 zero(a.zero_n, a.zero_e, a.zero_d);
        segments[i].zero = glm::normalize(zero - glm::dot(zero, t) * t);  // so that rounding errors do not add up
    }
}

Arc straight(const Station& end, const dvec3& head, const Arc&) {
    return {end.depth, head, end.tangent, dvec3(0.0), 0.0};
}
CylinderCurve straight(const Station& end, const dvec3& head, const CylinderCurve&) {
    return {end.depth, head, end.i.sine, end.i.cosine, end.a.sine, end.a.cosine, 0.0, 0.0};
}

// Builds the segments from station `first` on; the segments above this station stay.
template <class Segment>
void build_from(std::vector<Segment>& segments, const StationColumns& columns, std::size_t first, dvec3 head) {
    auto at = segments.begin();
    if (first > 0) {
        at = std::lower_bound(segments.begin(), segments.end(), columns.depth[first],
                              [](const Segment& segment, double depth) { return segment.depth < depth; });
        head = at->position;
    }
    const auto from = static_cast<std::size_t>(at - segments.begin());
    segments.erase(at, segments.end());
    const std::size_t last = columns.depth.size() - 1;
    Station above = station(columns, first);
    for (std::size_t i = first; i < last; ++i) {
        const Station below = station(columns, i + 1);
        if constexpr (std::is_same_v<Segment, Arc>) require_arc(above, below, Index(i) + 1);
        head = append_course(segments, above, below, head);
        above = below;
    }
    // The last segment is straight. It starts at the last station, so that this station also starts a segment, and
    // keeps its bits when the next course replaces the straight segment.
    segments.push_back(straight(above, head, Segment{}));
    transport_toolface(segments, from);
}

void build_from(Segments& segments, const StationColumns& columns, std::size_t first, const PathSettings& settings) {
    const StandardArithmetic standard;
    segments.reference = settings.reference;
    segments.start_depth = columns.depth.front();
    segments.survey_depth = columns.depth.back();
    segments.stop_depth = segments.survey_depth + settings.extend;
    const dvec3 head(settings.head[0], settings.head[1], settings.head[2]);
    if (settings.method == Method::minimum_curvature)
        build_from(segments.arcs, columns, first, head);
    else
        build_from(segments.curves, columns, first, head);
}

Segments segments_of(const Survey& survey, const PathSettings& settings) {
    const StandardArithmetic standard;
    require_sane(settings);
    Segments segments;
    build_from(segments, columns_of(survey), 0, settings);
    return segments;
}

// Calls visit(i, segment, point of depth[i], depth[i]) for every depth.
template <class Visit>
void for_each_point(const Segments& segments, std::span<const double> depth, const Visit& visit) {
    const StandardArithmetic standard;
    for (std::size_t i = 0; i < depth.size(); ++i) {
        const double at = read_once(depth[i]);
        segments.require_reach(at, {Index(i)});
        const auto point = [&](const auto& segment) { visit(i, segment, segment.at(at - segment.depth), at); };
        segments.curves.empty() ? point(segment_at(segments.arcs, at)) : point(segment_at(segments.curves, at));
    }
}

template <Reference reference, class Segment>
Frame frame_at(const Segment& segment, const PathPoint& p, Index i, double depth) {
    const Axes a = axes_of<reference>(segment, p);
    if (!a.defined()) refuse_frame(reference, depth, {i});
    const double scale = 1.0 / std::sqrt(a.square);
    return {{{a.zero_n * scale, a.zero_e * scale, a.zero_d * scale},
             {a.right_n * scale, a.right_e * scale, a.right_d * scale},
             {p.tan_n, p.tan_e, p.tan_d}}};
}

}  // namespace

Survey::Survey(std::span<const double> depth, std::span<const double> inclination, std::span<const double> azimuth)
    : depth_(depth.begin(), depth.end()),
      inclination_(inclination.begin(), inclination.end()),
      azimuth_(azimuth.begin(), azimuth.end()) {
    const StandardArithmetic standard;
    require_length("inclination", inclination_.size(), depth_.size());
    require_length("azimuth", azimuth_.size(), depth_.size());
    if (depth.size() < 2) {
        throw InputError("survey has " + std::to_string(depth.size()) + (depth.size() == 1 ? " station" : " stations"),
                         "must have two or more");
    }
    require_depths(depth_);
    require_growing(depth_, 0);
    require_between("inclination", inclination_, 0.0, 180.0, 0);
    require_between("azimuth", azimuth_, -360.0, 360.0, 0);
}

std::vector<double> Survey::dogleg() const {
    const StandardArithmetic standard;
    std::vector<double> degrees;
    degrees.reserve(depth_.size() - 1);
    for (std::size_t i = 1; i < depth_.size(); ++i) {
        degrees.push_back(dogleg_between(station(columns_of(*this), i - 1), station(columns_of(*this), i)) / degree);
    }
    return degrees;
}

Method method_of(std::string_view name) {
    if (name == "minimum-curvature") return Method::minimum_curvature;
    if (name == "radius-of-curvature") return Method::radius_of_curvature;
    throw InputError("method", "must be \"minimum-curvature\" or \"radius-of-curvature\"",
                     "\"" + std::string(name) + "\"");
}

Reference reference_of(std::string_view name) {
    if (name == "high-side") return Reference::high_side;
    if (name == "north") return Reference::north;
    if (name == "parallel-transport") return Reference::parallel_transport;
    throw InputError("reference", "must be \"high-side\", \"north\" or \"parallel-transport\"",
                     "\"" + std::string(name) + "\"");
}

void Segments::require_reach(double depth, const DepthOf& of) const {
    if (depth >= start_depth && depth <= stop_depth && std::isfinite(depth)) return;
    if (!std::isfinite(depth)) throw of.error(depth, "must be finite");
    if (depth < start_depth) {
        throw of.error(depth,
                       "must not lie above the first station of the survey, at " + number_text(start_depth) + " m");
    }
    throw of.error(depth, "must not lie below the last station of the survey, at " + number_text(survey_depth) +
                              " m, plus extend = " + number_text(stop_depth - survey_depth) + " m");
}

void refuse_frame(Reference reference, double depth, const DepthOf& of) {
    if (reference == Reference::high_side)
        throw of.error(depth, "the high side is undefined where the hole is vertical; use the reference north");
    throw of.error(depth, "north is undefined where the hole runs level north or south; use the reference high-side");
}

// Returns an error that names "depth[3] = 12" or "vertex 7 at depth 12".
InputError DepthOf::error(double depth, const std::string& rule) const {
    if (!vertex) return {entry_name("depth", index), rule, number_text(depth)};
    return {"vertex " + std::to_string(index) + " at depth " + number_text(depth), rule};
}

Path::Path() {
    Segments segments;
    segments.arcs.push_back({});
    segments_ = std::make_shared<const Segments>(std::move(segments));
}

Path::Path(const Survey& survey, const PathSettings& settings)
    : segments_(std::make_shared<const Segments>(segments_of(survey, settings))) {}

std::vector<Vector3> Path::position(std::span<const double> depth) const {
    std::vector<Vector3> positions(depth.size());
    for_each_point(*segments_, depth, [&](std::size_t i, const auto&, const PathPoint& p, double) {
        positions[i] = {p.north, p.east, p.down};
    });
    return positions;
}

std::vector<Vector3> Path::tangent(std::span<const double> depth) const {
    std::vector<Vector3> tangents(depth.size());
    for_each_point(*segments_, depth, [&](std::size_t i, const auto&, const PathPoint& p, double) {
        tangents[i] = {p.tan_n, p.tan_e, p.tan_d};
    });
    return tangents;
}

std::vector<Frame> Path::frame(std::span<const double> depth) const {
    std::vector<Frame> frames(depth.size());
    for_each_point(*segments_, depth, [&](std::size_t i, const auto& segment, const PathPoint& p, double at) {
        frames[i] = with_reference(segments_->reference,
                                   [&](auto reference) { return frame_at<reference>(segment, p, Index(i), at); });
    });
    return frames;
}

std::vector<double> Path::north_to_high_side(std::span<const double> depth) const {
    std::vector<double> degrees(depth.size());
    for_each_point(*segments_, depth, [&](std::size_t i, const auto& segment, const PathPoint& p, double at) {
        if (!axes_of<Reference::high_side>(segment, p).defined()) refuse_frame(Reference::high_side, at, {Index(i)});
        if (!axes_of<Reference::north>(segment, p).defined()) refuse_frame(Reference::north, at, {Index(i)});
        const double angle = arc_tangent(-p.tan_e, p.tan_d * p.tan_n) / degree;
        const double positive = angle < 0.0 ? angle + 360.0 : angle + 0.0;  // + 0.0 turns -0 into 0
        degrees[i] = positive < 360.0 ? positive : 0.0;                     // -1e-20 + 360 rounds to 360
    });
    return degrees;
}

Reference Path::reference() const {
    return segments_->reference;
}
double Path::start_depth() const {
    return segments_->start_depth;
}
double Path::survey_depth() const {
    return segments_->survey_depth;
}
double Path::stop_depth() const {
    return segments_->stop_depth;
}

Stations::Stations(const PathSettings& settings) : settings_(settings), segments_(std::make_unique<Segments>()) {
    const StandardArithmetic standard;
    require_sane(settings);
}
Stations::~Stations() = default;

Stations::Taken Stations::take(std::span<const double> depth, std::span<const double> inclination,
                               std::span<const double> azimuth) {
    const StandardArithmetic standard;
    require_length("inclination", inclination.size(), depth.size());
    require_length("azimuth", azimuth.size(), depth.size());
    Taken taken;
    std::vector<double> before[] = {depth_, inclination_, azimuth_};
    try {
        for (std::size_t i = 0; i < depth.size(); ++i) {
            std::string bad;
            const double at = read_once(depth[i]);
            if (!(std::abs(at) <= largest_depth)) {
                bad = std::string("depth ") + (std::isfinite(at) ? depth_rule : "must be finite");
            } else {
                try {
                    const auto from = take_one(at, read_once(inclination[i]), read_once(azimuth[i]));
                    if (from) taken.path_from = std::min(*from, taken.path_from.value_or(*from));
                } catch (const InputError& error) {
                    bad = error.what();
                }
            }
            if (!bad.empty()) taken.refused.push_back("station at " + short_text(at) + " m: " + bad);
        }
    } catch (const std::bad_alloc&) {  // take all stations or none
        depth_.swap(before[0]);
        inclination_.swap(before[1]);
        azimuth_.swap(before[2]);
        built_ = 0;
        path_.reset();
        throw;
    }
    return taken;
}

// Checks a station with its neighbours, then takes it. Returns the depth below which the path changes.
std::optional<double> Stations::take_one(double depth, double inclination, double azimuth) {
    const auto place = std::lower_bound(depth_.begin(), depth_.end(), depth);
    const auto at = static_cast<std::size_t>(place - depth_.begin());
    const bool replaces = place != depth_.end() && *place == depth;
    if (replaces && inclination_[at] == inclination && azimuth_[at] == azimuth) return {};
    if (depth_.size() == (replaces ? 1 : 0)) {
        const bool good = inclination >= 0.0 && inclination <= 180.0 && std::abs(azimuth) <= 360.0;
        if (!good)
            throw InputError("inclination " + short_text(inclination) + ", azimuth " + short_text(azimuth),
                             "must lie in 0 to 180 and -360 to 360 degrees");
    } else {
        require_between("inclination", {&inclination, 1}, 0.0, 180.0, Index(at));
        require_between("azimuth", {&azimuth, 1}, -360.0, 360.0, Index(at));
        const Station here = station({{&depth, 1}, {&inclination, 1}, {&azimuth, 1}}, 0);
        const auto require_course = [&](const Station& above, const Station& below, std::size_t index) {
            const double ends[] = {above.depth, below.depth};
            require_growing(ends, Index(index) - 1);
            if (settings_.method == Method::minimum_curvature) require_arc(above, below, Index(index));
        };
        const std::size_t next = at + (replaces ? 1 : 0);
        const StationColumns all{depth_, inclination_, azimuth_};
        if (at > 0) require_course(station(all, at - 1), here, at);
        if (next < depth_.size()) require_course(here, station(all, next), at + 1);
    }
    if (replaces) {
        inclination_[at] = inclination;
        azimuth_[at] = azimuth;
    } else {
        for (std::vector<double>* column : {&depth_, &inclination_, &azimuth_})
            if (column->size() == column->capacity()) column->reserve(2 * column->size() + 16);
        const auto offset = static_cast<std::ptrdiff_t>(at);  // nothing below throws
        depth_.insert(depth_.begin() + offset, depth);
        inclination_.insert(inclination_.begin() + offset, inclination);
        azimuth_.insert(azimuth_.begin() + offset, azimuth);
    }
    built_ = std::min(built_, at);
    path_.reset();
    return at == 0 ? depth : depth_[at - 1];
}

std::optional<Survey> Stations::survey() const {
    if (depth_.size() < 2) return {};
    return Survey(depth_, inclination_, azimuth_);
}

std::optional<Path> Stations::path() {
    if (depth_.size() < 2) return {};
    if (!path_) {
        const std::size_t first = std::exchange(built_, 0);  // if memory runs out below, the next call builds all anew
        build_from(*segments_, {depth_, inclination_, azimuth_}, first > 0 ? first - 1 : 0, settings_);
        built_ = depth_.size();
        path_ = Path(std::make_shared<const Segments>(*segments_));
    }
    return path_;
}

}  // namespace helibore
