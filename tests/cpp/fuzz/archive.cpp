// What a wall gives out, which an archive of it holds: parts are those of the whole, the samples make the same wall
// again, and values interpolated with the samples follow the radius.
#include "walls.hpp"

using helibore::Index;

namespace {

template <class T>
bool is_part(const std::vector<T>& part, const std::vector<T>& whole, helibore::Range range) {
    return same_bits(part, std::vector<T>(whole.begin() + range.start, whole.begin() + range.stop));
}

}  // namespace

void fuzz(Input input) {
    const WallInput made = wall_input(input);
    std::optional<helibore::Wall> wall = wall_of(made.settings);
    if (!wall) return;
    double clock = 0.0;
    for (std::size_t batch = 0; batch < 3; ++batch) {
        const Hole hole = samples_input(input, made, clock);
        refused([&] { wall->append(columns_of(hole, made.timed)); });
    }
    const Index size = wall->size();
    const helibore::VertexColumns all = wall->vertices();
    const std::vector<double> columns[] = {wall->depth(), wall->toolface(), wall->radius(), wall->nearest()};
    require_rule(same_bits(all.depth, columns[0]) && same_bits(all.toolface, columns[1]) &&
                     same_bits(all.radius, columns[2]) && same_bits(all.nearest, columns[3]) &&
                     all.support == wall->support() && all.iterations == wall->iterations() &&
                     all.provisional == wall->provisional(),
                 "a column alone is that of all");
    for (int i = 0; i < 4; ++i) {
        const helibore::Range range{input.between(-2, 900), input.between(-2, 900)};
        helibore::VertexColumns part;
        const bool was_refused = refused([&] { part = wall->vertices(range); });
        require_rule(was_refused == (range.start < 0 || range.stop < range.start || range.stop > size),
                     "a range within the wall is read");
        if (was_refused) continue;
        require_rule(is_part(part.depth, all.depth, range) && is_part(part.toolface, all.toolface, range) &&
                         is_part(part.radius, all.radius, range) && is_part(part.nearest, all.nearest, range) &&
                         is_part(part.support, all.support, range) && is_part(part.iterations, all.iterations, range) &&
                         is_part(part.provisional, all.provisional, range),
                     "a part is that of the whole");
    }
    std::vector<double> into(static_cast<std::size_t>(size), 7.0), other(static_cast<std::size_t>(size) + 1, 7.0);
    require_rule(wall->read_radius(into) == size && same_bits(into, all.radius), "the radii in the host's memory");
    require_rule(wall->read_radius(other) == size && other == std::vector<double>(other.size(), 7.0),
                 "nothing is written into memory of another size");

    const std::vector<std::vector<double>> samples = wall->samples();
    if (samples[0].empty()) return;
    helibore::SampleColumns kept{samples[0], samples[1], samples[2]};
    if (samples.size() == 4) kept.time = samples[3];
    require_rule(bits(plain_wall(made.settings, kept)) == bits(*wall), "the samples of a wall make it again");

    std::vector<double> flat(samples[0].size(), 3.0), holes = samples[2];
    for (std::size_t i = 0; i < holes.size(); i += 2) holes[i] = std::numeric_limits<double>::quiet_NaN();
    const std::vector<double> none(samples[0].size(), std::numeric_limits<double>::quiet_NaN());
    const std::span<const double> channels[] = {samples[2], flat, holes, none};
    const auto values = wall->interpolate_samples(channels, 1), on_three = wall->interpolate_samples(channels, 3);
    for (std::size_t c = 0; c < 4; ++c) require_rule(same_bits(values[c], on_three[c]), "values on three threads");
    for (std::size_t k = 0; k < all.radius.size(); ++k) {
        require_rule(std::isnan(values[3][k]), "no value of a channel without values");
        if (all.support[k] == 0) {
            require_rule(std::isnan(values[0][k]) && std::isnan(values[1][k]), "no value without support");
            continue;
        }
        require_rule(std::abs(values[1][k] - 3.0) < 1e-9, "a constant stays");
        if (!all.provisional[k] && made.settings.estimator == helibore::Estimator::inverse_distance)
            require_rule(std::abs(values[0][k] - all.radius[k]) < 1e-9, "the samples' radii give the wall's");
    }
    const std::span<const double> short_one[] = {std::span(flat).first(flat.size() - 1)};
    require_rule(refused([&] { wall->interpolate_samples(short_one, 1); }), "a short channel is refused");
}
