// Turns surveys into segments of curves, and segments into positions and frames. The formulas, with t the tangent and L
// the course length:
//
//   dogleg b = 2 atan2(|t2 - t1|, |t2 + t1|)        no cancellation at tiny or huge b
//   minimum curvature     step = L/2 (t1 + t2) tan(b/2)/(b/2)
//   radius of curvature   step = (H cos(Am) sinc(dA/2), H sin(Am) sinc(dA/2), L cos(Im) sinc(dI/2)),
//                         H = L sin(Im) sinc(dI/2), dA wrapped to [-180, 180)
//
// Sources: Sawaryn and Thorogood, SPE 84246 (arcs); the classic radius-of-curvature quotients (cosI1 - cosI2)/(I2 - I1)
// written without their 0/0.
#include "helibore/path.hpp"

#include <cmath>

#include "base/degrees.hpp"
#include "base/messages.hpp"
#include "helibore/error.hpp"
#include "surface/segments.hpp"

namespace helibore {
namespace {

using glm::dvec3;

// Two tangents that are opposite to within this angle (radians) define no plane for an arc.
constexpr double least_from_opposite = 1e-8;
// A course that covers less horizontal distance than this share of its length is vertical: its azimuth cannot change.
constexpr double least_across = 1e-12;

void require_between(const char* name, std::span<const double> values, double low, double high) {
    require_finite(name, values);
    for (std::size_t i = 0; i < values.size(); ++i) {
        if (values[i] < low || values[i] > high) {
            throw entry_error(name, Index(i), values[i],
                              "must lie in " + number_text(low) + " to " + number_text(high) + " degrees");
        }
    }
}

void require_growing(std::span<const double> depth) {
    require_finite("depth", depth);
    for (std::size_t i = 1; i < depth.size(); ++i) {
        if (depth[i] <= depth[i - 1]) {
            throw entry_error("depth", Index(i), depth[i],
                              "must be greater than " + entry_text("depth", Index(i) - 1, depth[i - 1]));
        }
    }
}

double sinc(double x) {
    return std::abs(x) <= max_bend ? sine_ratio(x) : std::sin(x) / x;
}

struct Station {
    double depth, inclination, azimuth;  // metres, degrees
    SineCosine i, a;
    dvec3 tangent;
};

Station station(const Survey& survey, std::size_t index) {
    const double inclination = survey.inclination()[index], azimuth = survey.azimuth()[index];
    const SineCosine i = sine_cosine(inclination), a = sine_cosine(azimuth);
    return {survey.depth()[index], inclination, azimuth, i, a, {i.sine * a.cosine, i.sine * a.sine, i.cosine}};
}

// |t2 - t1| / 2 is written as the haversine, which is exact for doglegs far below a millionth of a degree.
double dogleg_between(const Station& above, const Station& below) {
    const double build = sine_cosine(0.5 * (below.inclination - above.inclination)).sine;
    const double turn = sine_cosine(0.5 * wrap_difference(below.azimuth - above.azimuth)).sine;
    const double half_chord = std::hypot(build, std::sqrt(above.i.sine * below.i.sine) * turn);
    return 2.0 * std::atan2(half_chord, 0.5 * glm::length(below.tangent + above.tangent));
}

int segments_for(double bend) {
    return std::max(1, static_cast<int>(std::ceil(bend / max_bend)));
}

// Appends the arcs of one course that starts at `head`; returns where it ends.
//
//         m = unit(t1 + t2)          The arc lies in the plane of m, its tangent half-way, and e, normal to m.
//     t1 \ | / t2                    t(x) = cos(x - b/2) m + sin(x - b/2) e,  x from 0 to b,
//         \|/                        and its normal is dt/dx.
//          +---> e = unit(t2 - t1)
dvec3 append_arcs(std::vector<Arc>& arcs, const Station& above, const Station& below, const dvec3& head) {
    const double length = below.depth - above.depth;
    const dvec3 sum = above.tangent + below.tangent, difference = below.tangent - above.tangent;
    const double bend = dogleg_between(above, below);
    if (glm::length(difference) == 0.0) {
        arcs.push_back({above.depth, head, above.tangent, dvec3(0.0), 0.0});
        return head + length * above.tangent;
    }
    const dvec3 m = sum / glm::length(sum), e = difference / glm::length(difference);
    const double curvature = bend / length;
    const int count = segments_for(bend);
    for (int j = 0; j < count; ++j) {
        const double beyond = length * j / count, x = curvature * beyond;
        const double half = 0.5 * bend, s = std::sin(x - half), c = std::cos(x - half);
        const dvec3 chord = std::cos(0.5 * x - half) * m + std::sin(0.5 * x - half) * e;
        const dvec3 position = head + beyond * sinc(0.5 * x) * chord;
        arcs.push_back({above.depth + beyond, j == 0 ? head : position, j == 0 ? above.tangent : c * m + s * e,
                        c * e - s * m, curvature});
    }
    return head + 0.5 * length * (std::tan(0.5 * bend) / (0.5 * bend)) * sum;
}

// Appends the cylinder curves of one course; returns where it ends.
dvec3 append_curves(std::vector<CylinderCurve>& curves, const Station& above, const Station& below, const dvec3& head) {
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
    // On a course the sine of the inclination is at most twice its mean, and so is the rate of the azimuth.
    const int count = segments_for(std::max(std::abs(build) * length, 2.0 * std::abs(azimuth_change)));
    for (int j = 0; j < count; ++j) {
        const double beyond = length * j / count;
        const SineCosine i = sine_cosine(above.inclination + build * beyond / degree);
        const SineCosine a = sine_cosine(above.azimuth + turn * across(beyond) / degree);
        curves.push_back({above.depth + beyond, position(beyond), i.sine, i.cosine, a.sine, a.cosine, build, turn});
    }
    return position(length);
}

void require_arc(const Survey& survey, std::size_t below) {
    const dvec3 sum = station(survey, below).tangent + station(survey, below - 1).tangent;
    if (glm::length(sum) >= least_from_opposite) return;
    throw entry_error("depth", Index(below), survey.depth()[below],
                      "the hole turns by 180 deg since " +
                          entry_text("depth", Index(below) - 1, survey.depth()[below - 1]) +
                          ", which no one arc does: must be less than 180");
}

void require_sane(const PathSettings& settings) {
    for (std::size_t i = 0; i < 3; ++i) {
        if (!std::isfinite(settings.head[i])) {
            throw entry_error("head", Index(i), settings.head[i], "must be finite");
        }
    }
    if (!(settings.extend >= 0.0 && std::isfinite(settings.extend))) {
        throw InputError("extend", "must be finite and not negative", number_text(settings.extend));
    }
}

// Moves toolface 0 from the first segment to the start of every other by parallel transport.
template <class Segment>
void transport_toolface(std::vector<Segment>& segments) {
    const Point top = segments.front().at(0.0);
    const Axes north = axes_of<Reference::north>(segments.front(), top);
    const Axes first = north.square >= 0.5 ? north : axes_of<Reference::high_side>(segments.front(), top);
    segments.front().zero = glm::normalize(dvec3(first.zero_n, first.zero_e, first.zero_d));
    for (std::size_t i = 1; i < segments.size(); ++i) {
        const dvec3 t = segments[i].start_tangent();
        const Axes a = axes_of<Reference::parallel_transport>(segments[i - 1], {0.0, 0.0, 0.0, t.x, t.y, t.z});
        const dvec3 zero(a.zero_n, a.zero_e, a.zero_d);
        segments[i].zero = glm::normalize(zero - glm::dot(zero, t) * t);  // so that rounding errors do not add up
    }
}

Segments segments_of(const Survey& survey, const PathSettings& settings) {
    require_sane(settings);
    Segments segments;
    segments.reference = settings.reference;
    segments.start_depth = survey.depth().front();
    segments.survey_depth = survey.depth().back();
    segments.stop_depth = segments.survey_depth + settings.extend;
    const bool arcs = settings.method == Method::minimum_curvature;
    const std::size_t last = survey.depth().size() - 1;
    dvec3 head(settings.head[0], settings.head[1], settings.head[2]);
    for (std::size_t i = 0; i < last; ++i) {
        if (arcs) require_arc(survey, i + 1);
        const Station above = station(survey, i), below = station(survey, i + 1);
        head =
            arcs ? append_arcs(segments.arcs, above, below, head) : append_curves(segments.curves, above, below, head);
    }
    // The last segment is straight. It starts at the last station, so that this station starts a segment, too, and
    // keeps its bits when the next course replaces the straight segment.
    const Station end = station(survey, last);
    if (arcs) {
        segments.arcs.push_back({end.depth, head, end.tangent, dvec3(0.0), 0.0});
        transport_toolface(segments.arcs);
    } else {
        segments.curves.push_back({end.depth, head, end.i.sine, end.i.cosine, end.a.sine, end.a.cosine, 0.0, 0.0});
        transport_toolface(segments.curves);
    }
    return segments;
}

// Calls visit(i, segment, point of depth[i]) for every depth.
template <class Visit>
void for_each_point(const Segments& segments, std::span<const double> depth, const Visit& visit) {
    for (std::size_t i = 0; i < depth.size(); ++i) {
        segments.require_reach(depth[i], entry_text("depth", Index(i), depth[i]));
        const auto point = [&](const auto& segment) { visit(i, segment, segment.at(depth[i] - segment.depth)); };
        segments.curves.empty() ? point(segment_at(segments.arcs, depth[i]))
                                : point(segment_at(segments.curves, depth[i]));
    }
}

template <Reference reference, class Segment>
Frame frame_at(const Segments& segments, const Segment& segment, const Point& p, Index i, double depth) {
    const Axes a = axes_of<reference>(segment, p);
    if (a.square < least_reference_angle * least_reference_angle) segments.refuse_frame(entry_text("depth", i, depth));
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
    require_length("inclination", inclination.size(), depth.size());
    require_length("azimuth", azimuth.size(), depth.size());
    if (depth.size() < 2) {
        throw InputError("survey has " + std::to_string(depth.size()) + (depth.size() == 1 ? " station" : " stations"),
                         "must have two or more");
    }
    require_growing(depth);
    require_between("inclination", inclination, 0.0, 180.0);
    require_between("azimuth", azimuth, -360.0, 360.0);
}

std::vector<double> Survey::dogleg() const {
    std::vector<double> degrees;
    degrees.reserve(depth_.size() - 1);
    for (std::size_t i = 1; i < depth_.size(); ++i) {
        degrees.push_back(dogleg_between(station(*this, i - 1), station(*this, i)) / degree);
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

void Segments::require_reach(double depth, const std::string& where) const {
    if (std::isnan(depth) || std::isinf(depth)) throw InputError(where, "must be finite");
    if (depth < start_depth) {
        throw InputError(where,
                         "must not lie above the first station of the survey, at " + number_text(start_depth) + " m");
    }
    if (depth > stop_depth) {
        throw InputError(where, "must not lie below the last station of the survey, at " + number_text(survey_depth) +
                                    " m, plus extend = " + number_text(stop_depth - survey_depth) + " m");
    }
}

void Segments::refuse_frame(const std::string& where) const {
    if (reference == Reference::high_side) {
        throw InputError(where, "the high side is undefined where the hole is vertical; use reference=\"north\"");
    }
    throw InputError(where, "north is undefined where the hole runs level north or south; use reference=\"high-side\"");
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
    for_each_point(*segments_, depth,
                   [&](std::size_t i, const auto&, const Point& p) { positions[i] = {p.north, p.east, p.down}; });
    return positions;
}

std::vector<Vector3> Path::tangent(std::span<const double> depth) const {
    std::vector<Vector3> tangents(depth.size());
    for_each_point(*segments_, depth,
                   [&](std::size_t i, const auto&, const Point& p) { tangents[i] = {p.tan_n, p.tan_e, p.tan_d}; });
    return tangents;
}

std::vector<Frame> Path::frame(std::span<const double> depth) const {
    std::vector<Frame> frames(depth.size());
    for_each_point(*segments_, depth, [&](std::size_t i, const auto& segment, const Point& p) {
        frames[i] = with_reference(segments_->reference, [&](auto reference) {
            return frame_at<reference>(*segments_, segment, p, Index(i), depth[i]);
        });
    });
    return frames;
}

std::vector<double> Path::north_to_high_side(std::span<const double> depth) const {
    Segments high_side;  // its rule and error, whatever the reference of the path
    high_side.reference = Reference::high_side;
    std::vector<double> degrees(depth.size());
    for_each_point(*segments_, depth, [&](std::size_t i, const auto& segment, const Point& p) {
        if (axes_of<Reference::high_side>(segment, p).square < least_reference_angle * least_reference_angle) {
            high_side.refuse_frame(entry_text("depth", Index(i), depth[i]));
        }
        const double angle = std::atan2(-p.tan_e, p.tan_d * p.tan_n) / degree;
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

}  // namespace helibore
