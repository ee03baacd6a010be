// The bits of walls, paths, surfaces and logs are those of every machine: processors with every instruction set, with
// and without fused multiplication, on Linux and Windows (tests/slow/guest.py runs this on the others).
#include <iomanip>
#include <sstream>

#include "check.hpp"
#include "helibore/error.hpp"
#include "helibore/estimates.hpp"
#include "helibore/logs.hpp"
#include "helibore/surface.hpp"
#include "hole.hpp"

namespace {

using namespace helibore;

// FNV-1a over 64-bit words; every NaN counts as the same.
class Hash {
  public:
    void take(std::uint64_t word) {
        for (int byte = 0; byte < 64; byte += 8) state_ = (state_ ^ (word >> byte & 255)) * 1099511628211u;
    }
    void take(std::span<const double> values) {
        for (const double value : values) take(value == value ? std::bit_cast<std::uint64_t>(value) : 1);
    }
    std::string text() const {
        std::ostringstream out;
        out << std::hex << std::setw(16) << std::setfill('0') << state_;
        return out.str();
    }

  private:
    std::uint64_t state_ = 14695981039346656037u;
};

void expect(const char* what, const Hash& hash, const char* expected) {
    if (hash.text() != expected) fail(__FILE__, __LINE__, std::string(what) + " has the bits " + hash.text());
}

const Hole& hole() {
    static const Hole made = oval_hole(5000, 100.0, 15.0);
    return made;
}

std::vector<Settings> kinds() {
    const Settings base{.bit_diameter = 0.216, .sectors = 48, .pitch = 0.05};
    std::vector<Settings> all(8, base);
    all[1].power = 2.0;
    all[2].power = 0.7;
    all[3].neighbors = 1;
    all[4].neighbors = 32;
    all[5].window = 100;
    all[6].angular_scale = 2.0;
    all[7].estimator = Estimator::kriging;
    all[7].kriging_range = 0.5;
    return all;
}

void walls(InstructionSet level) {
    Hash hash, values;
    for (Settings settings : kinds()) {
        settings.instruction_set = level;
        Wall wall(settings);
        wall.append(hole().rows(0, 3000));
        wall.append(hole().rows(3000, 2000));
        for (const std::uint64_t word : bits(wall)) hash.take(word == 0x7ff8000000000000u ? 1 : word);
        const std::vector<std::vector<double>> samples = wall.samples();
        const std::span<const double> channel(samples[2]);
        values.take(wall.interpolate_samples({&channel, 1})[0]);
    }
    expect("walls", hash, "174dbbe2d148ddeb");
    expect("interpolated values", values, "3ea40a48b1f07755");
}

void estimates() {
    const Hole& h = hole();
    Wall wall({.bit_diameter = 0.216});
    wall.append(h.all());
    const auto s = wall.samples();
    const std::vector<double> trial(200, 0.108), box(200, 0.01);
    const auto some = [](const std::vector<double>& column) { return std::span(column).first(200); };
    const PointColumns points{some(s[0]), some(s[1]), trial, box, box};
    Hash hash;
    for (const Settings& settings : kinds()) {
        const PointEstimates found = estimate_at({s[0], s[1], s[2]}, points, settings);
        for (const auto* column :
             {&found.radius, &found.nearest, &found.square_weights, &found.scatter, &found.along, &found.across})
            hash.take(*column);
    }
    expect("estimates at points", hash, "237f0a2df755ffd5");
}

void paths_and_surfaces() {
    std::vector<double> station, inclination, azimuth, at;
    for (int i = 0; i <= 40; ++i) {
        station.push_back(30.0 * i);
        inclination.push_back(2.1 * i);
        azimuth.push_back(i * 37 % 360 - (i > 20 ? 360.0 : 0.0));
    }
    for (int i = 1; i < 1200; ++i) at.push_back(i + 0.0625 * (i % 16));
    Wall wall({.bit_diameter = 0.216, .sectors = 48, .pitch = 0.05});
    wall.append(hole().all());
    const std::vector<double> radius = wall.radius();
    const HelixRadii helix{.start_depth = wall.start_depth(), .pitch = 0.05, .sectors = 48, .radius = radius};
    const Survey survey(station, inclination, azimuth);
    Hash hash;
    hash.take(survey.dogleg());
    for (const Method method : {Method::minimum_curvature, Method::radius_of_curvature})
        for (const Reference reference : {Reference::high_side, Reference::north, Reference::parallel_transport}) {
            const Path path(survey, {method, reference});
            for (const Vector3& position : path.position(at)) hash.take(position);
            for (const Frame& frame : path.frame(at))
                for (const Vector3& axis : frame) hash.take(axis);
            hash.take(path.north_to_high_side(at));
            for (const Vector3& vertex : surface_of(helix, path).vertices) hash.take(vertex);
        }
    expect("paths and surfaces", hash, "265f70170ad3b97d");
    const TurnLogs logs = turn_logs({.sectors = 48, .radius = radius});
    Hash turns;
    for (const auto* column : {&logs.mean, &logs.mean_square, &logs.c1, &logs.c1_toolface, &logs.c2, &logs.centre_0,
                               &logs.inscribed_diameter, &logs.enclosing_diameter, &logs.rugosity})
        turns.take(*column);
    expect("logs", turns, "b6fb6c7ec7f1d7a0");
}

}  // namespace

int main() {
    for (const InstructionSet level : {InstructionSet::plain, InstructionSet::avx2, InstructionSet::avx512}) {
        try {
            walls(level);
        } catch (const InputError& error) {
            CHECK(error.place == "instruction_set");
        }
    }
    estimates();
    paths_and_surfaces();
    return failures();
}
