// Live: samples, stations and image rows in any order, with polls between. The wall is that of one batch, the path that
// of the survey, an image that of its rows; a poll reports all since the one before.
#include "helibore/live.hpp"

#include <map>

#include "walls.hpp"

using helibore::Index;
using helibore::Live;
using helibore::Range;
using helibore::Update;

namespace {

struct Rows {
    std::vector<double> depth, values;
    std::size_t sectors = 0;
};

bool covers(const std::vector<Range>& ranges, Range one) {
    return std::ranges::any_of(ranges, [one](Range r) { return r.start <= one.start && one.stop <= r.stop; });
}

// Collects updates as a host would, to compare with a poll.
struct Expected {
    Index accepted = 0, redundant = 0;
    bool change = false;
    std::vector<Range> ranges;
    std::map<std::string, Range> images;
    std::optional<double> path_from;
    std::vector<std::string> events;

    void add(const Update& update) {
        if (update.change) {
            change = true;
            accepted += update.change->accepted;
            redundant += update.change->redundant;
            ranges.insert(ranges.end(), update.change->ranges.begin(), update.change->ranges.end());
        }
        for (const auto& [name, rows] : update.images) {
            const auto [place, is_new] = images.try_emplace(name, rows);
            if (!is_new) {
                require_rule(place->second.stop == rows.start, "rows arrive one after the other");
                place->second.stop = rows.stop;
            }
        }
        if (update.path_from && (!path_from || *update.path_from < *path_from)) path_from = update.path_from;
        events.insert(events.end(), update.events.begin(), update.events.end());
    }

    void require(const Update& poll) const {
        require_rule(poll.change.has_value() == change, "a poll has a change if there was one");
        if (change) {
            require_rule(poll.change->accepted == accepted && poll.change->redundant == redundant, "polled counts");
            for (const Range range : ranges) require_rule(covers(poll.change->ranges, range), "polled ranges");
            require_rule(poll.change->ranges.size() <= Update::most_ranges, "a poll is bounded");
        }
        require_rule(poll.images == images && poll.path_from == path_from, "polled rows and path");
        std::vector<std::string> first = events;
        first.resize(std::min<std::size_t>(first.size(), 100));
        require_rule(poll.events == first, "polled events");
    }
};

void require_path(const Live& live, const helibore::PathSettings& settings) {
    const std::optional<helibore::Survey> survey = live.survey();
    const std::optional<helibore::Path> path = live.path();
    require_rule(survey.has_value() == path.has_value(), "a path for a survey");
    if (!survey) return;
    const helibore::Path whole(*survey, settings);
    std::vector<double> depth(survey->depth().begin(), survey->depth().end());
    for (std::size_t i = 1; i < survey->depth().size(); ++i)
        depth.push_back(0.5 * (survey->depth()[i - 1] + survey->depth()[i]));
    depth.push_back(path->stop_depth());
    require_rule(same_bits(path->position(depth), whole.position(depth)), "the path is that of the survey");
    require_rule(same_bits(path->tangent(depth), whole.tangent(depth)), "the tangents are those of the survey");
}

void require_image(const Live& live, const std::string& name, const Rows& rows) {
    std::map<double, std::size_t> latest;
    for (std::size_t i = 0; i < rows.depth.size(); ++i) latest.insert_or_assign(rows.depth[i], i);
    std::vector<double> depth, values;
    for (const auto& [at, i] : latest) {
        depth.push_back(at);
        const auto first = rows.values.begin() + static_cast<std::ptrdiff_t>(i * rows.sectors);
        values.insert(values.end(), first, first + static_cast<std::ptrdiff_t>(rows.sectors));
    }
    const helibore::ImageArrays image = live.image(name);
    require_rule(image.depth == depth && same_bits(image.values, values), "an image has the latest row of each depth");
    const helibore::ImageArrays arrived = live.rows(name, {0, static_cast<Index>(rows.depth.size())});
    require_rule(same_bits(arrived.depth, rows.depth) && same_bits(arrived.values, rows.values), "rows as they came");
}

}  // namespace

void fuzz(Input input) {
    WallInput made = wall_input(input);
    helibore::LiveSettings settings{.wall = made.settings};
    settings.path.method = input.one_of({helibore::Method::minimum_curvature, helibore::Method::radius_of_curvature});
    settings.path.extend = input.mostly_of({100.0, 0.0, 30.0});
    std::optional<Live> live;
    if (refused([&] { live.emplace(settings); })) return;
    Hole all;
    std::map<std::string, Rows> images;
    Expected expected;
    double clock = 0.0;
    for (int step = 0; step < 40 && (step == 0 || input.left() > 0); ++step) {
        Update update;
        switch (input.below(4)) {
            case 0: {
                const Hole hole = samples_input(input, made, clock);
                const std::vector<std::uint64_t> before = bits(live->wall());
                if (refused([&] { update = live->append_samples(columns_of(hole, made.timed)); }))
                    require_rule(bits(live->wall()) == before, "refused samples change nothing");
                else
                    add_rows(all, hole);
                break;
            }
            case 1: {
                std::vector<double> depth, inclination, azimuth;
                for (std::size_t n = input.below(5); n > 0; --n) {
                    depth.push_back(
                        input.mostly(30.0 * static_cast<double>(input.below(40)) + input.one_of({0.0, 1e-7})));
                    inclination.push_back(input.mostly(static_cast<double>(input.below(181))));
                    azimuth.push_back(input.mostly(2.0 * static_cast<double>(input.below(200))));
                }
                if (input.one_in(32)) azimuth.push_back(0.0);
                const bool uneven = azimuth.size() != depth.size();
                const bool was_refused = refused([&] { update = live->append_stations(depth, inclination, azimuth); });
                require_rule(was_refused == uneven, "columns of equal length are taken");
                require_rule(update.events.size() <= depth.size(), "one event a station");
                break;
            }
            case 2: {
                const std::string name = input.one_of<const char*>({"GR", "RES", ""});
                Rows rows{{}, {}, input.one_of<std::size_t>({4, 1, 7})};
                for (std::size_t n = input.below(4); n > 0; --n) {
                    rows.depth.push_back(input.mostly(made.top + 0.1 * static_cast<double>(input.below(20))));
                    for (std::size_t s = 0; s < rows.sectors; ++s) rows.values.push_back(input.byte());
                }
                if (input.one_in(32)) rows.values.push_back(1.0);
                if (refused([&] { update = live->append_image(name, rows.depth, rows.values); })) break;
                if (rows.depth.empty()) break;
                Rows& known = images[name];
                known.sectors = rows.values.size() / rows.depth.size();
                known.depth.insert(known.depth.end(), rows.depth.begin(), rows.depth.end());
                known.values.insert(known.values.end(), rows.values.begin(), rows.values.end());
                break;
            }
            default:
                expected.require(live->poll());
                expected = {};
        }
        expected.add(update);
        for (const Range range : update.quads(made.settings.sectors))
            require_rule(range.start >= 0 && range.start < range.stop, "quads of a change");
    }
    expected.require(live->poll());
    require_rule(bits(live->wall()) == bits(plain_wall(made.settings, columns_of(all, made.timed))),
                 "the wall of one batch");
    require_path(*live, settings.path);
    std::vector<std::string> names;
    for (const auto& [name, rows] : images) {
        names.push_back(name);
        require_image(*live, name, rows);
    }
    require_rule(live->images() == names, "the names of the images");
}
