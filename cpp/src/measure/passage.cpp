// Each turn is solved alone and from the start, so that its result depends on the wall beside the string only.
#include "helibore/passage.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <string>

#include "base/arithmetic.hpp"
#include "base/host_memory.hpp"
#include "base/messages.hpp"
#include "base/threads.hpp"
#include "samples/helix.hpp"

namespace helibore {
namespace {

constexpr double missing = std::numeric_limits<double>::quiet_NaN();
constexpr std::size_t block = 64;                // points of which one, the worst, joins the programme at a time
constexpr double tolerance = 1e-7;               // metres; a smaller violation or gain does not count
constexpr int most_axes = 40, most_rounds = 60;  // a bound on the work for walls that no one has seen
constexpr double near_wall = 2e-3;               // metres
constexpr int draws = 32;
constexpr double draws_apart = 1.0 / 8.0;  // of the string's length
constexpr double normal_95 = 1.959964;
constexpr double share_of_mean = 0.85;  // bench/accuracy/passage.py tries it on smooth and on rough holes

double dot(const Vector3& a, const Vector3& b) {
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}
Vector3 cross(const Vector3& a, const Vector3& b) {
    return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
}

// An axis across the hole, c0 + tau c1, and the radial clearance.
struct Axis {
    std::array<double, 4> c{};  // c0 and c1
    double clearance = -std::numeric_limits<double>::infinity();
};

// The greatest clearance such that b - a.c >= clearance for each row, by the dual simplex method: the rows of the basis
// hold with equality, and the row that is violated most enters it.
class Programme {
  public:
    struct Row {
        std::array<double, 4> a{};
        double b = 0.0;
        std::size_t point = 0;
    };

    // Starts without rows. The artificial rows bound the axis far outside the hole, `far` metres.
    void clear(double far) {
        rows_.clear();
        for (std::size_t i = 0; i < 4; ++i) {
            Row row{.b = far};
            row.a[i] = 1.0;
            rows_.push_back(row);
        }
        rows_.push_back({{-1.0, -1.0, -1.0, -1.0}, far});
        basis_ = {0, 1, 2, 3, 4};
    }

    void add(const Row& row) { rows_.push_back(row); }

    Axis solve() {
        for (int round = 0;; ++round) {
            invert();
            Axis axis{{}, 0.0};
            for (std::size_t j = 0; j < 5; ++j) {
                const double b = rows_[basis_[j]].b;
                for (std::size_t i = 0; i < 4; ++i) axis.c[i] += inverse_[i][j] * b;
                axis.clearance += inverse_[4][j] * b;
                shares_[j] = inverse_[4][j];
                for (std::size_t i = 0; i < 4; ++i) shares_[j] += slight[i] * inverse_[i][j];
            }
            std::size_t enters = 0;
            double least = -1e-2 * tolerance;
            for (std::size_t k = 0; k < rows_.size(); ++k) {
                const Row& row = rows_[k];
                const double slack = row.b - row.a[0] * axis.c[0] - row.a[1] * axis.c[1] - row.a[2] * axis.c[2] -
                                     row.a[3] * axis.c[3] - axis.clearance;
                if (slack < least) least = slack, enters = k + 1;
            }
            if (enters == 0 || round == 50 * most_rounds) return axis;
            const Row& row = rows_[enters - 1];
            std::size_t leaves = 0;
            double step = std::numeric_limits<double>::infinity();
            for (std::size_t j = 0; j < 5; ++j) {
                double y = inverse_[4][j];
                for (std::size_t i = 0; i < 4; ++i) y += row.a[i] * inverse_[i][j];
                const double ratio = std::max(shares_[j], 0.0) / y;
                if (y > 1e-12 && ratio < step) step = ratio, leaves = j;
            }
            basis_[leaves] = enters - 1;
        }
    }

    struct Contact {
        double share;
        std::size_t point;
    };
    // The rows that hold the axis, the one that holds it most first.
    std::vector<Contact> contacts() const {
        std::vector<Contact> found;
        for (std::size_t j = 0; j < 5; ++j) {
            if (basis_[j] >= 5 && shares_[j] > least_share) found.push_back({shares_[j], rows_[basis_[j]].point});
        }
        std::ranges::stable_sort(found, std::ranges::greater{}, &Contact::share);
        return found;
    }
    // Whether the wall holds the axis on all sides.
    bool bounded() const {
        for (std::size_t j = 0; j < 5; ++j) {
            if (basis_[j] < 5 && shares_[j] > least_share) return false;
        }
        return true;
    }

  private:
    // A slight preference for one direction, so that no share in the basis is exactly 0 and no exchange repeats.
    static constexpr std::array<double, 4> slight{3.7e-8, 6.1e-8, -5.3e-8, 2.9e-8};
    static constexpr double least_share = 1e-4;

    void invert() {  // Gauss and Jordan, rows exchanged
        std::array<std::array<double, 10>, 5> m{};
        for (std::size_t j = 0; j < 5; ++j) {
            const Row& row = rows_[basis_[j]];
            m[j] = {row.a[0], row.a[1], row.a[2], row.a[3], 1.0};
            m[j][5 + j] = 1.0;
        }
        for (std::size_t i = 0; i < 5; ++i) {
            std::size_t pivot = i;
            for (std::size_t j = i + 1; j < 5; ++j) pivot = std::abs(m[j][i]) > std::abs(m[pivot][i]) ? j : pivot;
            std::swap(m[i], m[pivot]);
            const double scale = 1.0 / (m[i][i] != 0.0 ? m[i][i] : 1e-300);
            for (double& value : m[i]) value *= scale;
            for (std::size_t j = 0; j < 5; ++j) {
                if (j == i) continue;
                const double factor = m[j][i];
                for (std::size_t k = i; k < 10; ++k) m[j][k] -= factor * m[i][k];
            }
        }
        for (std::size_t i = 0; i < 5; ++i) std::copy(m[i].begin() + 5, m[i].end(), inverse_[i].begin());
    }

    std::vector<Row> rows_;
    std::array<std::size_t, 5> basis_{};
    std::array<double, 5> shares_{};
    std::array<std::array<double, 5>, 5> inverse_{};
};

// The wall in space, turn by turn from the top; a turn that is not known has no radius here.
struct Hole {
    Index turns, sectors, first;  // `first`: number of the first vertex on the whole helix
    bool upwards;                 // the helix grows upwards
    std::vector<Vector3> centre, outwards;
    std::vector<double> radius;
    std::span<const double> sigma;
    std::vector<char> known;

    Index turn_at(Index from_top) const { return upwards ? turns - 1 - from_top : from_top; }
};

// The points of the wall beside the bodies, seen from the middle of the string along its axis.
struct Points {
    std::vector<double> x, y, out_x, out_y, tau, body_radius, other_share;
    std::vector<Index> vertex, other;  // a point between turns lies between two vertices
    std::vector<Index> body;

    std::size_t size() const { return x.size(); }
    void clear() {
        for (auto* of : {&x, &y, &out_x, &out_y, &tau, &body_radius, &other_share}) of->clear();
        for (auto* of : {&vertex, &other, &body}) of->clear();
    }
};

// One turn of the wall, seen from the middle of the string.
struct SeenTurn {
    std::vector<double> x, y, z, out_x, out_y;
    double least = 0.0, most = 0.0;  // z
    Index first = 0;                 // vertex
    bool known = false;
};

struct View {
    Vector3 middle, across, aside, along;
};

struct Work {
    Points points;
    SeenTurn before, turn;
    Programme programme;
    std::vector<double> slack, normal_x, normal_y, distance, white, smooth, shift;
    std::vector<std::size_t> worst, near;  // points; `near` those with which the next programme begins
};

void see(const Hole& hole, const View& view, Index from_top, SeenTurn& turn) {
    const auto K = static_cast<std::size_t>(hole.sectors);
    const Index at = hole.turn_at(from_top);
    turn.first = at * hole.sectors;
    turn.known = hole.known[static_cast<std::size_t>(at)] != 0;
    for (auto* of : {&turn.x, &turn.y, &turn.z, &turn.out_x, &turn.out_y}) of->resize(K);
    turn.least = std::numeric_limits<double>::infinity(), turn.most = -turn.least;
    for (std::size_t j = 0; j < K; ++j) {
        const std::size_t k = static_cast<std::size_t>(turn.first) + j;
        const Vector3 to{hole.centre[k][0] - view.middle[0], hole.centre[k][1] - view.middle[1],
                         hole.centre[k][2] - view.middle[2]};
        const double radius = hole.radius[k];
        turn.out_x[j] = dot(hole.outwards[k], view.across);
        turn.out_y[j] = dot(hole.outwards[k], view.aside);
        turn.x[j] = dot(to, view.across) + radius * turn.out_x[j];
        turn.y[j] = dot(to, view.aside) + radius * turn.out_y[j];
        turn.z[j] = dot(to, view.along) + radius * dot(hole.outwards[k], view.along);
        turn.least = std::min(turn.least, turn.z[j]);
        turn.most = std::max(turn.most, turn.z[j]);
    }
}

// Collects the points beside the bodies. Returns false if one of them is not known or lies beyond the wall.
bool collect(const Hole& hole, const View& view, std::span<const RigidBody> string, Index middle, double height,
             double half, Work& work) {
    Points& points = work.points;
    points.clear();
    double top = 0.0, bottom = 0.0;
    for (const RigidBody& body : string) top = std::min(top, body.start), bottom = std::max(bottom, body.stop);
    Index i = std::min(middle, std::max<Index>(middle - static_cast<Index>(-top / height) - 1, 0));
    for (;; --i) {
        see(hole, view, i, work.turn);
        if (work.turn.most <= top) break;
        if (i == 0) return false;
    }
    const auto put = [&](const SeenTurn& turn, std::size_t j, std::size_t body) {
        points.x.push_back(turn.x[j]), points.y.push_back(turn.y[j]), points.tau.push_back(turn.z[j] / half);
        points.out_x.push_back(turn.out_x[j]), points.out_y.push_back(turn.out_y[j]);
        points.vertex.push_back(turn.first + static_cast<Index>(j)), points.other.push_back(points.vertex.back());
        points.other_share.push_back(0.0);
        points.body_radius.push_back(0.5 * string[body].diameter), points.body.push_back(static_cast<Index>(body));
    };
    const auto put_all = [&](const SeenTurn& turn, std::size_t body) {
        const std::size_t K = turn.x.size(), old = points.size(), size = old + K;
        const auto append = [](std::vector<double>& to, const std::vector<double>& from) {
            to.insert(to.end(), from.begin(), from.end());
        };
        append(points.x, turn.x), append(points.y, turn.y);
        append(points.out_x, turn.out_x), append(points.out_y, turn.out_y);
        points.tau.resize(size), points.vertex.resize(size);
        for (std::size_t j = 0; j < K; ++j) {
            points.tau[old + j] = turn.z[j] / half;
            points.vertex[old + j] = turn.first + static_cast<Index>(j);
        }
        points.other.insert(points.other.end(), points.vertex.end() - static_cast<std::ptrdiff_t>(K),
                            points.vertex.end());
        points.other_share.resize(size, 0.0);
        points.body_radius.resize(size, 0.5 * string[body].diameter);
        points.body.resize(size, static_cast<Index>(body));
    };
    const auto put_between = [&](const SeenTurn& a, const SeenTurn& b, std::size_t j, double end, std::size_t body) {
        const double w = (end - a.z[j]) / (b.z[j] - a.z[j]), v = 1.0 - w;
        points.x.push_back(v * a.x[j] + w * b.x[j]), points.y.push_back(v * a.y[j] + w * b.y[j]);
        points.out_x.push_back(v * a.out_x[j] + w * b.out_x[j]);
        points.out_y.push_back(v * a.out_y[j] + w * b.out_y[j]);
        points.tau.push_back(end / half);
        points.vertex.push_back(a.first + static_cast<Index>(j)),
            points.other.push_back(b.first + static_cast<Index>(j));
        points.other_share.push_back(w);
        points.body_radius.push_back(0.5 * string[body].diameter), points.body.push_back(static_cast<Index>(body));
    };
    while (work.turn.least <= bottom) {
        if (++i == hole.turns) return false;
        std::swap(work.before, work.turn);
        see(hole, view, i, work.turn);
        const SeenTurn &before = work.before, &turn = work.turn;
        for (std::size_t b = 0; b < string.size(); ++b) {
            const RigidBody& body = string[b];
            const bool within = turn.least >= body.start && turn.most <= body.stop;
            std::size_t beside = 0, between = 0;
            if (within) {
                put_all(turn, b), beside = turn.z.size();
            } else if (turn.most >= body.start && turn.least <= body.stop) {
                for (std::size_t j = 0; j < turn.z.size(); ++j) {
                    if (turn.z[j] >= body.start && turn.z[j] <= body.stop) put(turn, j, b), ++beside;
                }
            }
            for (const double end : {body.start, body.stop}) {
                if (std::min(before.least, turn.least) >= end || std::max(before.most, turn.most) < end) continue;
                for (std::size_t j = 0; j < turn.z.size(); ++j) {
                    if ((before.z[j] < end) != (turn.z[j] < end)) put_between(before, turn, j, end, b), ++between;
                }
            }
            if ((beside > 0 && !turn.known) || (between > 0 && !(turn.known && before.known))) return false;
        }
    }
    return points.size() > 0;
}

// Finds, of each block of points, the one that violates the clearance most. Returns whether there is one.
bool find_worst(const std::vector<double>& slack, double clearance, std::vector<std::size_t>& worst) {
    worst.clear();
    for (std::size_t start = 0; start < slack.size(); start += block) {
        const auto from = slack.begin() + static_cast<std::ptrdiff_t>(start);
        const auto to = slack.begin() + static_cast<std::ptrdiff_t>(std::min(start + block, slack.size()));
        double least = *from;
        for (auto at = from; at != to; ++at) least = std::min(least, *at);
        if (least < clearance - tolerance)
            worst.push_back(start + static_cast<std::size_t>(std::find(from, to, least) - from));
    }
    return !worst.empty();
}

// Solves the programme of all points for a move of the axis: the component of each point's distance along its direction
// in work.normal_*, work.distance without the move. Of the points it takes only those that matter.
Axis best_move(Work& work, double far) {
    const std::vector<double>& tau = work.points.tau;
    const std::size_t n = tau.size();
    work.slack = work.distance;
    work.programme.clear(far);
    if (work.near.empty()) {
        find_worst(work.slack, std::numeric_limits<double>::infinity(), work.worst);
    } else {
        work.worst = work.near;
    }
    work.near.clear();
    Axis move;
    for (int round = 0; round < most_rounds; ++round) {
        work.near.insert(work.near.end(), work.worst.begin(), work.worst.end());
        for (const std::size_t k : work.worst) {
            const double x = work.normal_x[k], y = work.normal_y[k];
            work.programme.add({{x, y, tau[k] * x, tau[k] * y}, work.distance[k], k});
        }
        move = work.programme.solve();
        const auto [x, y, lean_x, lean_y] = move.c;
        for (std::size_t k = 0; k < n; ++k) {
            work.slack[k] =
                work.distance[k] - work.normal_x[k] * (x + tau[k] * lean_x) - work.normal_y[k] * (y + tau[k] * lean_y);
        }
        if (!find_worst(work.slack, move.clearance, work.worst)) break;
    }
    // The points left out violate the clearance by less than the tolerance: it is that of all points.
    move.clearance = *std::ranges::min_element(work.slack);
    std::erase_if(work.near, [&](std::size_t k) { return work.slack[k] > move.clearance + near_wall; });
    return move;
}

// Sets the directions from an axis to the points, and the distances.
void look_from(const Axis& axis, Work& work) {
    const Points& points = work.points;
    for (std::size_t k = 0; k < points.size(); ++k) {
        const double x = points.x[k] - axis.c[0] - points.tau[k] * axis.c[2];
        const double y = points.y[k] - axis.c[1] - points.tau[k] * axis.c[3];
        const double away = std::sqrt(x * x + y * y), scale = away > 0.0 ? 1.0 / away : 0.0;
        work.normal_x[k] = x * scale, work.normal_y[k] = y * scale;
        work.distance[k] = away - points.body_radius[k];
    }
}

// Returns the axis with the greatest clearance, and leaves its programme in `work`; NaN if the wall does not hold it.
Axis widest(Work& work, double far) {
    const Points& points = work.points;
    // The first directions point away from the path, which is outwards also where the path at the middle of the string
    // lies outside the hole beside its ends.
    work.near.clear();
    work.normal_x = points.out_x, work.normal_y = points.out_y;
    work.distance.resize(points.size());
    for (std::size_t k = 0; k < points.size(); ++k) {
        work.distance[k] = points.out_x[k] * points.x[k] + points.out_y[k] * points.y[k] - points.body_radius[k];
    }
    Axis axis = best_move(work, far);
    if (!work.programme.bounded()) return {{}, missing};
    const double thinnest = *std::ranges::min_element(points.body_radius);
    if (axis.clearance + thinnest <= 0.0) return axis;  // the axis itself does not lie within the hole
    for (int step = 0; step < most_axes; ++step) {
        look_from(axis, work);
        const Axis move = best_move(work, far);
        const double gain = move.clearance - axis.clearance;
        if (!(gain > 0.0)) break;
        for (std::size_t i = 0; i < 4; ++i) axis.c[i] += move.c[i];
        axis.clearance = move.clearance;
        if (gain < tolerance) break;
    }
    return axis;
}

// Returns a number with mean 0 and variance 1, nearly normal, that depends on the draw and the vertex alone.
double white(std::uint64_t draw, Index vertex) {
    std::uint64_t bits = static_cast<std::uint64_t>(vertex) * 0x9e3779b97f4a7c15U + (draw + 1) * 0xd1b54a32d192ed03U;
    bits = (bits ^ (bits >> 30)) * 0xbf58476d1ce4e5b9U;  // splitmix64
    bits = (bits ^ (bits >> 27)) * 0x94d049bb133111ebU;
    bits ^= bits >> 31;
    const std::uint64_t sum = (bits & 0xffff) + ((bits >> 16) & 0xffff) + ((bits >> 32) & 0xffff) + (bits >> 48);
    constexpr double middle = 2.0 * 65535.0, spread = 37837.2;  // of four uniform numbers to 65535
    return (static_cast<double>(sum) - middle) / spread;
}

// Errors of a wall are alike over one turn and two sectors. Fills work.shift with one draw of them for each point.
void draw_errors(const Hole& hole, std::uint64_t draw, Work& work) {
    const Points& points = work.points;
    const Index K = hole.sectors;
    const auto [least, most] = std::ranges::minmax(points.vertex);
    const auto [other_least, other_most] = std::ranges::minmax(points.other);
    const Index start = std::min(least, other_least), stop = std::max(most, other_most) + 1;
    const auto count = static_cast<std::size_t>(stop - start), width = count + 4;
    const auto turn = static_cast<std::size_t>(K);
    work.white.resize(width + 2 * turn);
    for (std::size_t i = 0; i < work.white.size(); ++i)
        work.white[i] = white(draw, hole.first + start + static_cast<Index>(i) - K - 2);
    work.smooth.resize(width);
    const double* of = work.white.data();
    for (std::size_t i = 0; i < width; ++i) work.smooth[i] = of[i] + 2.0 * of[i + turn] + of[i + 2 * turn];
    constexpr double scale = 0.09365858115816939;  // 1 / sqrt(6 x 19)
    const double* s = work.smooth.data();
    const auto error = [&](Index vertex) {
        const auto i = static_cast<std::size_t>(vertex - start);
        const double sum = s[i] + s[i + 4] + 2.0 * (s[i + 1] + s[i + 3]) + 3.0 * s[i + 2];
        return scale * sum * hole.sigma[static_cast<std::size_t>(vertex)];
    };
    work.shift.resize(points.size());
    for (std::size_t k = 0; k < points.size(); ++k) {
        const double w = points.other_share[k];
        work.shift[k] = error(points.vertex[k]);
        if (w > 0.0) work.shift[k] = (1.0 - w) * work.shift[k] + w * error(points.other[k]);
    }
}

bool has_sigma(const Points& points, std::span<const double> sigma) {
    const auto has = [&](Index vertex) { return !std::isnan(sigma[static_cast<std::size_t>(vertex)]); };
    return std::ranges::all_of(points.vertex, has) && std::ranges::all_of(points.other, has);
}

// How the clearance differs from that of the wall as it is, if the wall has errors: mean and standard deviation.
struct Change {
    double mean = missing, deviation = missing;
};

Change change_of(const Hole& hole, const Axis& axis, double far, Work& work) {
    look_from(axis, work);
    const std::vector<double> distance = work.distance;
    double sum = 0.0, squares = 0.0;
    for (int draw = 0; draw < draws; ++draw) {
        draw_errors(hole, static_cast<std::uint64_t>(draw), work);
        for (std::size_t k = 0; k < distance.size(); ++k) work.distance[k] = distance[k] + work.shift[k];
        const double change = best_move(work, far).clearance - axis.clearance;
        sum += change, squares += change * change;
    }
    const double mean = sum / draws;
    return {mean, std::sqrt(std::max(squares - draws * mean * mean, 0.0) / (draws - 1))};
}

// Places the wall in space; a turn with a vertex that is missing or does not count is not known.
Hole hole_of(const HelixRadii& radii, const Path& path, std::span<const double> counts, std::span<const double> sigma,
             int threads) {
    const Index K = radii.sectors, turns = std::ssize(radii.radius) / K;
    const auto n = static_cast<std::size_t>(turns * K);
    Hole hole{turns, K,     radii.first, radii.pitch < 0.0, std::vector<Vector3>(n), std::vector<Vector3>(n),
              {},    sigma, {}};
    hole.radius.assign(radii.radius.begin(), radii.radius.begin() + static_cast<std::ptrdiff_t>(n));
    hole.known.assign(static_cast<std::size_t>(turns), 1);
    for (std::size_t k = 0; k < n; ++k) {
        const double r = hole.radius[k];
        const bool there = r == r;
        require(!there || (r >= 0.0 && r <= 1e4), entry_name("radius", static_cast<Index>(k)), r,
                "must lie in 0 to 10000 m");
        if (there && (counts.empty() || counts[k] != 0.0)) continue;
        hole.radius[k] = 0.0;
        hole.known[k / static_cast<std::size_t>(K)] = 0;
    }
    if (n == 0) return hole;
    const VertexRun run{{radii.first, radii.first + turns * K}, -radii.first};
    HelixRadii unit = radii;
    const std::vector<double> zero(n, 0.0), one(n, 1.0);
    unit.radius = zero;
    place(unit, path, {&run, 1}, hole.centre, threads);
    unit.radius = one;
    place(unit, path, {&run, 1}, hole.outwards, threads);
    for (std::size_t k = 0; k < n; ++k) {
        for (std::size_t i = 0; i < 3; ++i) hole.outwards[k][i] -= hole.centre[k][i];
    }
    return hole;
}

View view_of(const Hole& hole, const Path& path, double depth, Index turn) {
    const Vector3 along = path.tangent({&depth, 1})[0];
    const Vector3& near = hole.outwards[static_cast<std::size_t>(turn * hole.sectors)];
    const double lean = dot(near, along);
    Vector3 across{near[0] - lean * along[0], near[1] - lean * along[1], near[2] - lean * along[2]};
    const double length = std::sqrt(dot(across, across));
    for (double& of : across) of /= length;
    return {path.position({&depth, 1})[0], across, cross(along, across), along};
}

}  // namespace

Passage passage(const HelixRadii& radii, const Path& path, std::span<const RigidBody> string,
                std::span<const double> given_counts, std::span<const double> given_sigma, int threads,
                Index only_turn) {
    const StandardArithmetic standard;
    require_threads(threads);
    require_sectors(radii.sectors);
    require_pitch(radii.pitch);
    const std::vector<double> radius = copied(radii.radius), counts = copied(given_counts), sigma = copied(given_sigma);
    if (!counts.empty()) require_length("counts", counts.size(), radius.size(), "radius");
    if (!sigma.empty()) require_length("sigma", sigma.size(), radius.size(), "radius");
    if (string.empty()) throw InputError("string", "must have a body");
    const std::vector<RigidBody> bodies(string.begin(), string.end());
    double half = 0.0, top = 0.0, bottom = 0.0;
    for (std::size_t b = 0; b < bodies.size(); ++b) {
        const std::string name = entry_name("string", static_cast<Index>(b));
        const auto [start, stop, diameter] = bodies[b];
        require(std::abs(start) <= largest_depth, name + ".start", start, depth_rule);
        require(std::abs(stop) <= largest_depth, name + ".stop", stop, depth_rule);
        require(stop - start >= 1e-3, name + ".stop", stop, "must be at least 0.001 m below start");
        require(diameter >= 0.0 && diameter <= 1e4, name + ".diameter", diameter, "must lie in 0 to 10000 m");
        half = std::max({half, std::abs(start), std::abs(stop)});
        top = std::min(top, start), bottom = std::max(bottom, stop);
    }
    HelixRadii own = radii;
    own.radius = radius;
    const Hole hole = hole_of(own, path, counts, sigma, threads);
    const Helix helix{radii.start_depth, radii.start_toolface, radii.pitch, radii.sectors, radii.first};
    const auto turns = static_cast<std::size_t>(hole.turns);
    Passage found;
    for (auto* of : {&found.clearance, &found.low, &found.high}) of->assign(turns, missing);
    found.contact_depth.assign(turns * most_contacts, missing);
    found.contact_toolface = found.contact_depth;
    found.contact_body.assign(turns * most_contacts, -1);
    if (turns == 0) return found;
    const double height = std::abs(radii.pitch);
    const double far = 1e3 * (half + 1.0 + *std::ranges::max_element(hole.radius));
    const Index first_turn = radii.first / radii.sectors;
    const auto apart = std::max<Index>(static_cast<Index>(draws_apart * (bottom - top) / height), 1);
    std::vector<Change> changes(turns);
    std::vector<char> sure(turns, 0);  // every vertex beside the string has a sigma
    std::vector<Work> works(static_cast<std::size_t>(threads));

    const auto solve_turn = [&](Index turn, Work& work, bool draw) {
        if (only_turn >= 0 && turn != only_turn) return;
        const auto at = static_cast<std::size_t>(turn);
        const double depth = helix.start_depth + (static_cast<double>((first_turn + turn) * hole.sectors) +
                                                  0.5 * static_cast<double>(hole.sectors - 1)) *
                                                     (helix.pitch / static_cast<double>(hole.sectors));
        const Index from_top = hole.upwards ? hole.turns - 1 - turn : turn;
        const View view = view_of(hole, path, depth, turn);
        if (!collect(hole, view, bodies, from_top, height, half, work)) return;
        const Axis axis = widest(work, far);
        found.clearance[at] = 2.0 * axis.clearance;
        if (std::isnan(axis.clearance)) return;
        std::size_t i = at * most_contacts;
        for (const auto& [share, k] : work.programme.contacts()) {
            const double w = work.points.other_share[k];
            const Index vertex = work.points.vertex[k], other = work.points.other[k];
            found.contact_depth[i] = (1.0 - w) * helix.depth(vertex) + w * helix.depth(other);
            found.contact_toolface[i] = helix.toolface(vertex % hole.sectors);
            found.contact_body[i++] = work.points.body[k];
        }
        if (sigma.empty() || !has_sigma(work.points, sigma)) return;
        sure[at] = 1;
        if (draw) changes[at] = change_of(hole, axis, far, work);
    };
    const auto drawn = [&](Index turn) { return (first_turn + turn) % apart == 0; };
    for_each_range(threads, hole.turns, 16, [&](int worker, const Range& range) {
        for (Index turn = range.start; turn < range.stop; ++turn)
            solve_turn(turn, works[static_cast<std::size_t>(worker)], drawn(turn));
    });
    if (sigma.empty()) return found;
    // Between the turns with draws, the change runs straight; where neither of two neighbours is known, draw here.
    const auto before = [&](Index turn) { return turn - (first_turn + turn) % apart; };
    const auto known = [&](Index turn) {
        return turn >= 0 && turn < hole.turns && !std::isnan(changes[static_cast<std::size_t>(turn)].mean);
    };
    std::vector<Change> between(turns);
    for_each_range(threads, hole.turns, 16, [&](int worker, const Range& range) {
        for (Index turn = range.start; turn < range.stop; ++turn) {
            const auto at = static_cast<std::size_t>(turn);
            if (sure[at] == 0 || drawn(turn)) continue;
            const Index a = before(turn), b = a + apart;
            if (known(a) && known(b)) {
                const Change &from = changes[static_cast<std::size_t>(a)], &to = changes[static_cast<std::size_t>(b)];
                const double w = static_cast<double>(turn - a) / static_cast<double>(apart);
                between[at] = {(1.0 - w) * from.mean + w * to.mean, (1.0 - w) * from.deviation + w * to.deviation};
            } else if (known(a) || known(b)) {
                between[at] = changes[static_cast<std::size_t>(known(a) ? a : b)];
            } else {
                solve_turn(turn, works[static_cast<std::size_t>(worker)], true);
                between[at] = changes[at];
            }
        }
    });
    for (std::size_t at = 0; at < turns; ++at) {
        if (sure[at] == 0) continue;
        const Change& change = drawn(static_cast<Index>(at)) ? changes[at] : between[at];
        // Errors of a wall stand in the way of the string where the hole is smooth, and hide what stands in its way
        // where the hole is rougher than the wall. The change does not show which share is which, so its mean
        // counts at both ends.
        const double spread =
            std::sqrt(change.deviation * change.deviation + share_of_mean * share_of_mean * change.mean * change.mean);
        const double middle = found.clearance[at], reach = 2.0 * normal_95 * spread;
        found.low[at] = middle - reach, found.high[at] = middle + reach;
    }
    return found;
}

}  // namespace helibore
