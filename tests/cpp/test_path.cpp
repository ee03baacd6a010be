// Paths against published positions and closed forms; stations one by one against the survey as a whole.
#include "helibore/path.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "base/trigonometry.hpp"
#include "check.hpp"
#include "helibore/error.hpp"
#include "host.hpp"

using namespace helibore;

namespace {

constexpr double nan = std::numeric_limits<double>::quiet_NaN();

bool near(double a, double b, double within = 1e-9) {
    return std::abs(a - b) <= within;
}

// 100 ft from (15, 20) to (25, 45): the example of the textbooks (Bourgoyne, Applied Drilling Engineering).
void published_vector() {
    const double depth[] = {0.0, 100.0}, inclination[] = {15.0, 25.0}, azimuth[] = {20.0, 45.0}, bottom[] = {100.0};
    const Survey survey(depth, inclination, azimuth);
    CHECK(near(survey.dogleg()[0], 12.951651, 1e-6));
    const Vector3 arc = Path(survey).position(bottom)[0];
    CHECK(near(arc[0], 27.21833, 1e-5) && near(arc[1], 19.45077, 1e-5) && near(arc[2], 94.01234, 1e-5));
    const Vector3 curve = Path(survey, {.method = Method::radius_of_curvature}).position(bottom)[0];
    CHECK(near(curve[0], 28.5811, 1e-4) && near(curve[1], 18.2082, 1e-4) && near(curve[2], 93.8500, 1e-4));
}

// Against the library's functions of long double, in halves of a unit in the last place.
void sines_and_arc_tangents() {
    const auto within = [](double found, long double exact, double units) {
        return std::abs(static_cast<double>(static_cast<long double>(found) - exact)) <=
               units * 0x1p-53 * std::max(std::abs(found), 1e-300);
    };
    for (int i = -4000; i <= 4000; ++i) {
        const double x = i * 0.0015703125;  // to 2 pi, also beside multiples of pi / 2
        const SineCosine of = sine_cosine_of_radians(x);
        CHECK(within(of.sine, std::sin(static_cast<long double>(x)), 2.0));
        CHECK(within(of.cosine, std::cos(static_cast<long double>(x)), 2.0));
        const double y = i % 3 == 0 ? std::ldexp(x, -40) : x, z = 1.0 - 0.25 * x;
        CHECK(within(arc_tangent(y, z), std::atan2(static_cast<long double>(y), z), 3.0));
    }
    CHECK(arc_tangent(0.0, 0.0) == 0.0 && arc_tangent(1.0, 0.0) == 0.5 * std::numbers::pi);
    CHECK(arc_tangent(0.0, -1.0) == std::numbers::pi && arc_tangent(-1.0, 0.0) == -0.5 * std::numbers::pi);
    const SineCosine half = sine_cosine_of_radians(0.5 * std::numbers::pi);
    CHECK(half.sine == 1.0 && near(half.cosine, 6.123233995736766e-17, 1e-25));
}

// From straight down to level north: a quarter of a circle of radius R, by both methods.
void quarter_of_a_circle() {
    const double R = 200.0 / std::numbers::pi, depth[] = {0.0, 100.0}, inclination[] = {0.0, 90.0};
    const double azimuth[] = {0.0, 0.0};
    for (const Method method : {Method::minimum_curvature, Method::radius_of_curvature}) {
        const Path path(Survey(depth, inclination, azimuth), {.method = method, .head = {10, 20, 30}, .extend = 5.0});
        for (double at = 0.0; at <= 100.0; at += 12.5) {
            const double turned = at / R, here[] = {at};
            const Vector3 p = path.position(here)[0], t = path.tangent(here)[0];
            CHECK(near(p[0], 10.0 + R * (1.0 - std::cos(turned))) && near(p[1], 20.0));
            CHECK(near(p[2], 30.0 + R * std::sin(turned)));
            CHECK(near(t[0], std::sin(turned)) && near(t[2], std::cos(turned)));
        }
        const double beyond[] = {105.0};
        CHECK(near(path.position(beyond)[0][0], 10.0 + R + 5.0) && path.stop_depth() == 105.0);
        CHECK(path.start_depth() == 0.0 && path.survey_depth() == 100.0);
    }
}

// Frames are right-handed and at right angles. High side and north differ by atan2(-sin A, cos I cos A).
void frames() {
    const double depth[] = {0.0, 300.0, 900.0}, inclination[] = {20.0, 48.0, 80.0}, azimuth[] = {200.0, 248.0, 300.0};
    const double at[] = {0.0, 150.0, 300.0, 700.0, 900.0};
    const Survey survey(depth, inclination, azimuth);
    for (const Method method : {Method::minimum_curvature, Method::radius_of_curvature}) {
        const Path high(survey, {.method = method}), north(survey, {.method = method, .reference = Reference::north});
        const Path moved(survey, {.method = method, .reference = Reference::parallel_transport});
        CHECK(moved.reference() == Reference::parallel_transport);
        const auto turn = high.north_to_high_side(at);
        const double i = 48.0 * std::numbers::pi / 180.0, a = 248.0 * std::numbers::pi / 180.0;
        CHECK(near(std::remainder(
                       turn[2] - std::atan2(-std::sin(a), std::cos(i) * std::cos(a)) * 180.0 / std::numbers::pi, 360.0),
                   0.0));
        const auto h = high.frame(at), n = north.frame(at), p = moved.frame(at);
        for (std::size_t k = 0; k < 5; ++k) {
            for (const Frame& f : {h[k], n[k], p[k]}) {
                for (std::size_t x = 0; x < 3; ++x) {
                    const std::size_t y = (x + 1) % 3, z = (x + 2) % 3;
                    CHECK(near(f[1][x], f[2][y] * f[0][z] - f[2][z] * f[0][y]));  // right = t x zero
                }
                CHECK(near(f[0][0] * f[0][0] + f[0][1] * f[0][1] + f[0][2] * f[0][2], 1.0));
                CHECK(near(f[0][0] * f[2][0] + f[0][1] * f[2][1] + f[0][2] * f[2][2], 0.0));
            }
            const double c = std::cos(turn[k] * std::numbers::pi / 180.0),
                         s = std::sin(turn[k] * std::numbers::pi / 180.0);
            for (std::size_t x = 0; x < 3; ++x) CHECK(near(n[k][0][x], c * h[k][0][x] + s * h[k][1][x]));
            CHECK(h[k][0][2] < 0.0 && near(h[k][1][2], 0.0));
        }
        for (std::size_t x = 0; x < 3; ++x) CHECK(near(p[0][0][x], n[0][0][x]));
    }
}

void bad_surveys_and_depths() {
    const double two[] = {0.0, 100.0}, zero[] = {0.0, 0.0}, one[] = {5.0};
    const auto survey = [&](double a, double b, double i, double z) {
        const double depth[] = {a, b}, inclination[] = {0.0, i}, azimuth[] = {0.0, z};
        return Survey(depth, inclination, azimuth);
    };
    CHECK_THROWS(InputError, "survey has 1 station: must have two or more", Survey(one, one, one));
    CHECK_THROWS(InputError, "survey has 0 stations: must have two or more", Survey({}, {}, {}));
    CHECK_THROWS(InputError, "inclination has 1 values, depth has 2: must be equal", Survey(two, one, two));
    CHECK_THROWS(InputError, "azimuth has 1 values, depth has 2: must be equal", Survey(two, two, one));
    CHECK_THROWS(InputError, "depth[1] = nan: must be finite", survey(0, nan, 0, 0));
    CHECK_THROWS(InputError, "depth[1] = 1e+155: must lie in -10000000 to 10000000 m", survey(0, 1e155, 0, 0));
    CHECK_THROWS(InputError, "depth[1] = 5: must be greater than depth[0] = 5", survey(5, 5, 0, 0));
    CHECK_THROWS(InputError, "depth[1] = 1e-300: must be 1e-6 m or more below depth[0] = 0", survey(0, 1e-300, 90, 0));
    CHECK_THROWS(InputError, "inclination[1] = 190: must lie in 0 to 180 degrees", survey(0, 9, 190, 0));
    CHECK_THROWS(InputError, "inclination[1] = nan: must be finite", survey(0, 9, nan, 0));
    CHECK_THROWS(InputError, "azimuth[1] = -361: must lie in -360 to 360 degrees", survey(0, 9, 0, -361));
    const std::string turned =
        "depth[1] = 100: the hole turns by 180 deg since depth[0] = 0, so the arc between them is not known: "
        "must be less than 180";
    CHECK_THROWS(InputError, turned, Path(survey(0, 100, 180, 0)));
    CHECK_THROWS(InputError, "extend = -1: must be finite and not negative",
                 Path(survey(0, 9, 0, 0), {.extend = -1.0}));
    CHECK_THROWS(InputError, "head[2] = nan: must be finite", Path(survey(0, 9, 0, 0), {.head = {0, 0, nan}}));
    CHECK_THROWS(InputError, "head[0] = -2e+09: must lie in -1e9 to 1e9 m",
                 Path(survey(0, 9, 0, 0), {.head = {-2e9, 0, 0}}));
    CHECK_THROWS(InputError, "extend = 1e+08: must be at most 10000000 m", Path(survey(0, 9, 0, 0), {.extend = 1e8}));
    CHECK_THROWS(InputError, "method = \"x\": must be \"minimum-curvature\" or \"radius-of-curvature\"",
                 method_of("x"));
    CHECK_THROWS(InputError, "reference = \"x\": must be \"high-side\", \"north\" or \"parallel-transport\"",
                 reference_of("x"));
    CHECK(method_of("minimum-curvature") == Method::minimum_curvature && reference_of("north") == Reference::north);
    CHECK(method_of("radius-of-curvature") == Method::radius_of_curvature);
    CHECK(reference_of("high-side") == Reference::high_side);
    CHECK(reference_of("parallel-transport") == Reference::parallel_transport);
    const Path down(Survey(two, zero, zero), {.extend = 2.0});
    const double above[] = {-1.0}, below[] = {103.0}, no[] = {nan};
    CHECK_THROWS(InputError, "depth[0] = -1: must not lie above the first station of the survey, at 0 m",
                 down.position(above));
    CHECK_THROWS(InputError,
                 "depth[0] = 103: must not lie below the last station of the survey, at 100 m, plus extend = 2 m",
                 down.tangent(below));
    CHECK_THROWS(InputError, "depth[0] = nan: must be finite", Path().position(no));
    const std::string vertical =
        "depth[0] = 5: the high side is undefined where the hole is vertical; use the reference north";
    CHECK_THROWS(InputError, vertical, down.frame(one));
    CHECK_THROWS(InputError, vertical, down.north_to_high_side(one));
    const double level[] = {90.0, 90.0};
    const std::string level_hole =
        "depth[0] = 5: north is undefined where the hole runs level north or south; use the reference high-side";
    CHECK_THROWS(InputError, level_hole, Path(Survey(two, level, zero), {.reference = Reference::north}).frame(one));
    CHECK_THROWS(InputError, level_hole, Path(Survey(two, level, zero)).north_to_high_side(one));
    const Path level_north(Survey(two, level, zero), {.reference = Reference::parallel_transport});
    CHECK(near(level_north.frame(one)[0][0][2], -1.0));  // starts from the high side
    try {
        survey(0, nan, 0, 0);
    } catch (const InputError& error) {
        CHECK(error.place == "depth[1]" && error.value == "nan" && error.rule == "must be finite");
    }
    try {
        Survey(one, one, one);
    } catch (const InputError& error) {
        CHECK(error.place == "survey has 1 station" && !error.value && error.rule == "must have two or more");
    }
}

// Any order, replaced and bad stations among them: the same bits as the survey as a whole.
void stations() {
    for (const Method method : {Method::minimum_curvature, Method::radius_of_curvature}) {
        const PathSettings settings{
            .method = method, .reference = Reference::parallel_transport, .head = {1, 2, 3}, .extend = 30.0};
        Stations taken(settings);
        std::vector<double> depth, inclination, azimuth, every;
        for (int i = 0; i < 60; ++i) {
            depth.push_back(30.0 * i);
            inclination.push_back(std::min(1.5 * i, 80.0));
            azimuth.push_back(7.0 * i - 200.0);
        }
        for (double at = 0.0; at <= depth.back() + 30.0; at += 7.0) every.push_back(at);
        CHECK(!taken.path() && !taken.survey());
        for (std::size_t i = 0; i < 60; ++i) {
            const std::size_t k = i * 23 % 60;
            const double wrong[] = {inclination[k] + 9.0}, bad[] = {200.0};
            const std::span<const double> d(&depth[k], 1), z(&azimuth[k], 1);
            CHECK(taken.take(d, bad, z).refused.size() == 1);
            taken.take(d, wrong, z);
            if (i % 3 == 0) taken.path();  // builds at different lengths
            CHECK(taken.take(d, {&inclination[k], 1}, z).path_from);
            CHECK(!taken.take(d, {&inclination[k], 1}, z).path_from);
        }
        const Path whole(Survey(depth, inclination, azimuth), settings);
        CHECK(taken.path()->position(every) == whole.position(every));
        CHECK(taken.path()->frame(every) == whole.frame(every));
        CHECK(taken.survey()->dogleg() == Survey(depth, inclination, azimuth).dogleg());
        CHECK(std::ranges::equal(taken.depth(), depth) && std::ranges::equal(taken.inclination(), inclination));
        CHECK(std::ranges::equal(taken.azimuth(), azimuth));
    }
    // -0 and 0 are one station, whichever came first: equal bits, not only equal numbers (compared by std::signbit).
    const double depths[] = {0.0, 10.0}, zero[] = {0.0, 0.0}, minus[] = {-0.0, -0.0};
    const std::vector<Vector3> tangent = Path(Survey(depths, minus, minus)).tangent(depths);
    CHECK(!std::signbit(tangent[0][0]) && !std::signbit(tangent[0][1]));
    CHECK(tangent == Path(Survey(depths, zero, zero)).tangent(depths));
    Stations few;
    const double depth[] = {nan, 2e7, 10.0, 10.0, 20.0, 10.0 + 1e-9, 15.0}, inclination[] = {1, 1, 190, 0, 180, 0, 190};
    const double azimuth[] = {0, 0, 0, 0, 0, 0, 0};
    const Stations::Taken found = few.take(depth, inclination, azimuth);
    CHECK(found.path_from == 10.0 && few.depth().size() == 1);
    CHECK(found.refused ==
          (std::vector<std::string>{
              "station at nan m: depth must be finite", "station at 2e+07 m: depth must lie in -10000000 to 10000000 m",
              "station at 10 m: inclination 190, azimuth 0: must lie in 0 to 180 and -360 to 360 degrees",
              "station at 20 m: depth[1] = 20: the hole turns by 180 deg since depth[0] = 10, so the arc between "
              "them is not known: must be less than 180",
              "station at 10 m: depth[1] = 10.000000001: must be 1e-6 m or more below depth[0] = 10",
              "station at 15 m: inclination[1] = 190: must lie in 0 to 180 degrees"}));
    CHECK_THROWS(InputError, "azimuth has 6 values, depth has 7: must be equal",
                 few.take(depth, inclination, std::span(azimuth).first(6)));
    CHECK_THROWS(InputError, "extend = inf: must be finite and not negative",
                 Stations({.extend = std::numeric_limits<double>::infinity()}));
}

}  // namespace

int main() {
    sines_and_arc_tangents();
    published_vector();
    quarter_of_a_circle();
    frames();
    in_every_host_state(bad_surveys_and_depths);
    stations();
    return failures();
}
