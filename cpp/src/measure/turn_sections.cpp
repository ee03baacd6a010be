// The section of each turn, as its samples show it, and the turns that have few samples.
#include <cmath>
#include <limits>

#include "base/arithmetic.hpp"
#include "base/host_memory.hpp"
#include "base/messages.hpp"
#include "base/trigonometry.hpp"
#include "helibore/zones.hpp"
#include "samples/helix.hpp"

namespace helibore {

namespace {

constexpr double sparse_length = 0.3;  // metres
constexpr double rounding = 1e-9;      // metres

// Means of radii by part of the turn.
class Means {
  public:
    explicit Means(std::size_t turns) : sum_(turns * section_parts), count_(turns * section_parts) {}

    void add(std::size_t turn, double toolface, double radius) {
        const double part = nearest_whole(wrap_toolface(toolface) * (static_cast<double>(section_parts) / 360.0));
        const std::size_t place = turn * section_parts + static_cast<std::size_t>(part) % section_parts;
        sum_[place] += radius, count_[place] += 1.0;
    }

    std::vector<double> take() {
        for (std::size_t place = 0; place < sum_.size(); ++place)
            sum_[place] = count_[place] > 0.0 ? sum_[place] / count_[place] : std::numeric_limits<double>::quiet_NaN();
        return std::move(sum_);
    }

  private:
    std::vector<double> sum_, count_;
};

void require_helix(const HelixVertices& vertices) {
    require(std::isfinite(vertices.start_depth), "start_depth", vertices.start_depth, "must be finite");
    require(std::isfinite(vertices.start_toolface), "start_toolface", vertices.start_toolface, "must be finite");
    require_pitch(vertices.pitch);
    require(vertices.sectors >= 3, "sectors", vertices.sectors, "must be 3 or more");
    require_vertex_count(vertices.count);
    require_first("first", vertices.first, vertices.sectors);
}

}  // namespace

std::vector<double> turn_sections(const HelixVertices& vertices, const SamplePlaces& samples,
                                  std::span<const double> radius) {
    const StandardArithmetic standard;
    if (vertices.count == 0) return {};  // a wall without samples has no start depth yet
    require_helix(vertices);
    require_length("toolface", samples.toolface.size(), samples.depth.size());
    require_length("radius", radius.size(), samples.depth.size());
    const Index turns = vertices.count / vertices.sectors, before = vertices.first / vertices.sectors;
    Means means(static_cast<std::size_t>(turns));
    for (std::size_t i = 0; i < radius.size(); ++i) {
        const double turn =
            std::floor((samples.depth[i] - vertices.start_depth) / vertices.pitch) - static_cast<double>(before);
        const double of = read_once(radius[i]);
        if (turn >= 0.0 && turn < static_cast<double>(turns) && std::isfinite(of))
            means.add(static_cast<std::size_t>(turn), read_once(samples.toolface[i]), of);
    }
    return means.take();
}

std::vector<double> turn_sections(const HelixVertices& vertices, std::span<const double> radius) {
    const StandardArithmetic standard;
    require_helix(vertices);
    require_length("radius", radius.size(), static_cast<std::size_t>(vertices.count), "count");
    const auto sectors = static_cast<std::size_t>(vertices.sectors), turns = radius.size() / sectors;
    const Helix helix{vertices.start_depth, vertices.start_toolface, vertices.pitch, vertices.sectors, 0};
    Means means(turns);
    for (std::size_t i = 0; i < turns * sectors; ++i)
        if (const double of = read_once(radius[i]); std::isfinite(of))
            means.add(i / sectors, helix.toolface(static_cast<Index>(i % sectors)), of);
    return means.take();
}

std::vector<double> sparse_turns(std::span<const double> sections, double height) {
    const StandardArithmetic standard;
    const std::size_t turns = sections.size() / section_parts;
    require(sections.size() == turns * section_parts, "sections", static_cast<Index>(sections.size()),
            "must be 32 lengths for each turn");
    require(std::isfinite(height) && height > 0.0, "height", height, "must be finite and above 0");
    std::vector<double> sparse(turns);
    for (std::size_t turn = 0; turn < turns; ++turn) {
        std::size_t seen = 0;
        for (std::size_t part = 0; part < section_parts; ++part)
            seen += std::isfinite(sections[turn * section_parts + part]) ? 1U : 0U;
        sparse[turn] = 2 * seen < section_parts ? 1.0 : 0.0;
    }
    for (std::size_t first = 0, stop = 0; first < turns; first = std::max(stop, first + 1)) {
        for (stop = first; stop < turns && sparse[stop] != 0.0;) ++stop;
        const std::size_t length = stop - first;
        if (static_cast<double>(length) * height < sparse_length - rounding && length < turns)
            std::fill_n(sparse.begin() + static_cast<std::ptrdiff_t>(first), length, 0.0);
    }
    return sparse;
}

}  // namespace helibore
