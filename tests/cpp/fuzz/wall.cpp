// Wall: settings, and batches of every shape in any host state. Each append names exactly the vertices that it changed,
// keeps settled ones, and changes nothing if it is refused; in the end every bit is that of one batch, on one thread,
// with plain instructions.
#include "walls.hpp"

using helibore::Index;
using helibore::InstructionSet;

namespace {

bool has(InstructionSet set) {
    return !refused([set] { helibore::Wall({.bit_diameter = 0.2, .instruction_set = set}); });
}

bool within(const std::vector<helibore::Range>& ranges, Index k) {
    return std::ranges::any_of(ranges, [k](helibore::Range r) { return r.start <= k && k < r.stop; });
}

void require_order(const std::vector<helibore::Range>& ranges, Index size) {
    Index before = -1;
    for (const helibore::Range range : ranges) {
        require_rule(before < range.start && range.start < range.stop, "ranges are sorted and apart");
        before = range.stop;
    }
    require_rule(before <= size, "ranges lie within the wall");
}

}  // namespace

void fuzz(Input input) {
    WallInput made = wall_input(input);
    const InstructionSet set = input.one_of({InstructionSet::automatic, InstructionSet::plain, InstructionSet::avx2});
    if (has(set)) made.settings.instruction_set = set;
    std::optional<helibore::Wall> wall = wall_of(made.settings);
    if (!wall) return;
    Hole all;
    double clock = 0.0;
    Index kept = 0;
    for (std::size_t batch = 0; batch < 12 && (batch == 0 || input.left() > 0); ++batch) {
        const Hole hole = samples_input(input, made, clock);
        const std::size_t host = input.one_in(4) ? input.below(8) : 0;
        const std::vector<Vertex> before = vertices_of(*wall);
        const std::vector<std::uint64_t> before_bits = bits(*wall);
        const double start = wall->start_depth();
        const Index settled = wall->settled();
        helibore::Change change;
        const bool was_refused = refused([&] {
            const HostState state = host_state(host);
            change = wall->append(columns_of(hole, made.timed));
        });
        if (was_refused) {
            require_rule(bits(*wall) == before_bits, "a refused append changes nothing");
            continue;
        }
        const std::vector<Vertex> after = vertices_of(*wall);
        require_rule(change.accepted + change.redundant == static_cast<Index>(hole.depth.size()),
                     "each row is accepted or redundant");
        kept += change.accepted;
        require_rule(wall->sample_count() == kept, "accepted samples are kept");
        require_rule(change.settled == wall->settled(), "the change has the wall's settled");
        require_order(change.ranges, wall->size());
        const bool moved = bits_of(start) != bits_of(wall->start_depth());
        for (std::size_t k = 0; k < after.size(); ++k) {
            const bool differs = moved || k >= before.size() || before[k] != after[k];
            require_rule(differs == within(change.ranges, static_cast<Index>(k)), "a change names what differs");
        }
        if (!all.depth.empty() && !moved) {
            const bool down = made.settings.pitch > 0.0;
            const auto [least, most] = std::ranges::minmax(all.depth);
            const auto [shallow, deep] = std::ranges::minmax(hole.depth);
            if (down ? shallow >= most : deep <= least)
                require_rule(change.ranges.empty() || change.ranges[0].start >= settled, "settled vertices stay");
        }
        add_rows(all, hole);
    }
    const helibore::Wall plain = plain_wall(made.settings, columns_of(all, made.timed));
    require_rule(bits(*wall) == bits(plain), "the bits of one batch on one thread with plain instructions");
    if (all.depth.empty()) return;
    const auto [least, most] = std::ranges::minmax(all.radius);
    const helibore::VertexColumns vertices = wall->vertices();
    for (std::size_t k = 0; k < vertices.radius.size(); ++k) {
        const double radius = vertices.radius[k];
        // Kriging may leave the interval of the radii used by half of its length.
        const double beyond = made.settings.estimator == helibore::Estimator::kriging ? 0.5 * (most - least) : 0.0;
        if (std::isnan(radius))
            require_rule(vertices.support[k] == 0 && std::isnan(vertices.nearest[k]), "without a radius, no support");
        else
            require_rule(least - beyond <= radius && radius <= most + beyond,
                         "a radius lies between those of the samples");
    }
}
