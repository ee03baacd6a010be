// From the readings of a tool to samples, and rows of numbers in text: the steps agree with each other, with slow ones,
// and with themselves on the same rows in another order or to another scale.
#include "helibore/preparation.hpp"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <numeric>
#include <set>

#include "helibore/number_rows.hpp"
#include "input.hpp"

using namespace helibore;

namespace {

constexpr double missing = std::numeric_limits<double>::quiet_NaN();

// A log of a tool with arms or sectors, or with one sensor that turns.
struct Log {
    std::vector<double> depth, toolface, time;
    std::vector<std::vector<double>> radii;
    std::vector<ToolSensor> sensors;

    explicit Log(Input& input) {
        const int arms = input.one_of({1, 1, 2, 3, 4, 6, 12});
        const bool diameters = arms % 2 == 0 && input.one_in(4), hostile = input.one_in(8);
        const int columns = diameters ? arms / 2 : arms;
        for (int arm = 0; arm < arms; ++arm)
            sensors.push_back({.offset = input.one_of({0.0, 0.0, 1.5}) * (arm % 2),
                               .mounting = 360.0 * arm / arms * input.one_of({1, 1, 1, 0}),
                               .column = arm % columns});
        const std::size_t rows = input.below(600);
        const double step = input.one_of({0.01, 0.1, 0.5, 1e-4, 0.0, -0.05}),
                     turning = input.one_of({40, 0, 7, 170, 1});
        const double noise = input.one_of({0.0, 5e-4, 2e-3});
        Uniform uniform(input.below(65536));
        for (std::size_t i = 0; i < rows; ++i) {
            depth.push_back(1000.0 + step * static_cast<double>(i));
            toolface.push_back(std::floor(360.0 * 64 * uniform()) / 64);
            if (uniform() < 0.9) toolface.back() = std::fmod(turning * static_cast<double>(i), 360.0);
            time.push_back(static_cast<double>(i));
        }
        radii.resize(static_cast<std::size_t>(columns));
        for (std::vector<double>& radius : radii)
            for (std::size_t i = 0; i < rows; ++i) radius.push_back(0.108 + noise * (uniform() - 0.5));
        for (std::size_t n = rows > 0 ? input.below(12) : 0; n > 0; --n) {  // spikes, closed and stuck arms, gaps
            std::vector<double>& radius = radii[input.below(radii.size())];
            const auto first = static_cast<std::ptrdiff_t>(input.below(rows));
            const auto some = static_cast<std::ptrdiff_t>(
                std::min<std::size_t>(input.below(150), rows - static_cast<std::size_t>(first)));
            std::fill_n(radius.begin() + first, some,
                        hostile ? input.hostile() : input.one_of({0.09, 0.14, 0.108, missing}));
        }
        for (std::size_t n = hostile && rows > 0 ? input.below(4) : 0; n > 0; --n)
            (input.one_in(2) ? depth : toolface)[input.below(rows)] = input.hostile();
        if (hostile && input.one_in(8)) sensors.back().column = input.one_of({-1, 99});
    }

    ToolRows rows(bool timed) const {
        ToolRows found{.depth = depth, .toolface = toolface, .radii = {}, .time = std::nullopt};
        found.radii.assign(radii.begin(), radii.end());
        if (timed) found.time = time;
        return found;
    }
};

void require_rising(const std::vector<Index>& rows, std::size_t count) {
    for (std::size_t i = 0; i < rows.size(); ++i)
        require_rule(rows[i] >= 0 && rows[i] < static_cast<Index>(count) && (i == 0 || rows[i - 1] < rows[i]),
                     "spikes are samples, in rising order");
}

// `prepare` takes the steps one after the other.
void check_preparation(Input& input) {
    Log log(input);
    PreparationSettings settings;
    if (input.one_in(2)) settings.bit_diameter = input.mostly_of({0.216, 0.311});
    settings.drop_closed = !input.one_in(4);
    settings.drop_saturated = !input.one_in(4);
    settings.drop_spikes = input.one_in(2);
    if (input.one_in(4)) settings.turn_spikes = std::nullopt;
    const bool timed = input.one_in(3);
    const ToolRows rows = log.rows(timed);
    Prepared found;
    if (refused([&] { found = prepare(rows, log.sensors, settings); })) return;
    const auto count = static_cast<Index>(log.depth.size());
    for (const SuspectRows& suspect : found.suspects) {
        require_rule(suspect.rows.start >= 0 && suspect.rows.start < suspect.rows.stop && suspect.rows.stop <= count,
                     "suspect rows are rows");
        require_rule(suspect.column >= -1 && suspect.column < static_cast<Index>(log.radii.size()),
                     "a column of radii");
        if (!suspect.dropped) continue;
        for (std::size_t c = 0; c < log.radii.size(); ++c)
            if (suspect.column < 0 || suspect.column == static_cast<Index>(c))
                std::fill(log.radii[c].begin() + suspect.rows.start, log.radii[c].begin() + suspect.rows.stop, missing);
    }
    const ToolSamples kept = observe_by_depth(log.rows(timed), log.sensors), &samples = found.samples;
    require_rule(kept.radius.size() == samples.radius.size() + static_cast<std::size_t>(found.spikes),
                 "what is not dropped and no spike is a sample");
    std::size_t at = 0;
    for (std::size_t i = 0; i < samples.radius.size(); ++i, ++at) {
        while (at < kept.row.size() && (kept.row[at] != samples.row[i] || kept.sensor[at] != samples.sensor[i])) ++at;
        require_rule(at < kept.row.size() && bits_of(kept.radius[at]) == bits_of(samples.radius[i]) &&
                         bits_of(kept.depth[at]) == bits_of(samples.depth[i]) &&
                         bits_of(kept.toolface[at]) == bits_of(samples.toolface[i]),
                     "samples keep their order and their values");
        require_rule(samples.toolface[i] >= 0.0 && samples.toolface[i] < 360.0, "toolface in [0, 360)");
    }
    require_rule(found.repeats >= 0.0 && found.repeats <= 1.0, "a share of repeats");
    require_rule(samples.time.size() == (timed ? samples.radius.size() : 0), "times where rows have times");
}

// The order of samples within the call, and a scale of radii that is a power of two, change no spike.
void check_spikes(Input& input) {
    Uniform uniform(input.below(65536));
    const std::size_t turns = input.below(40), most = 1 + input.below(30);
    const double noise = input.one_of({0.0, 1.0 / 4096, 1.0 / 512}), pitch = input.one_of({0.01, 0.2, 0.7});
    std::vector<double> depth, toolface, radius;
    std::vector<std::int64_t> turn;
    for (std::size_t t = 0; t < turns; ++t)
        for (std::size_t n = static_cast<std::size_t>(uniform() * static_cast<double>(most + 1)); n > 0; --n) {
            depth.push_back(pitch * (static_cast<double>(t) + uniform()));
            toolface.push_back(360.0 * uniform());
            radius.push_back(0.108 + noise * uniform() + (uniform() < 0.05 ? 0.03 * uniform() : 0.0));
            if (uniform() < 0.02) radius.back() = missing;
            turn.push_back(static_cast<std::int64_t>(t));
        }
    const std::size_t count = radius.size();
    const double threshold = input.mostly_of({6.0, 3.0}), floor = 0.0005;
    const bool along = !input.one_in(4);
    const auto depths = [&](const std::vector<double>& of) {
        return along ? std::optional(std::span<const double>(of)) : std::nullopt;
    };
    SpikedSamples found;
    if (refused([&] { found = find_spikes(toolface, radius, turn, depths(depth), threshold, floor); })) return;
    require_rising(found.samples, count);
    std::vector<double> doubled = radius;
    for (double& value : doubled) value *= 2.0;
    const auto scaled = find_spikes(toolface, doubled, turn, depths(depth), threshold, 2.0 * floor);
    require_rule(scaled.samples == found.samples && scaled.unjudged == found.unjudged, "spikes to a scale of two");

    std::vector<std::size_t> order(count);
    std::iota(order.begin(), order.end(), std::size_t{0});
    for (std::size_t i = count; i > 1; --i)
        std::swap(order[i - 1], order[static_cast<std::size_t>(uniform() * static_cast<double>(i))]);
    const auto in_order = [&](const auto& column) {
        auto of = column;
        for (std::size_t i = 0; i < count; ++i) of[i] = column[order[i]];
        return of;
    };
    const std::vector<double> mixed_depth = in_order(depth);
    const auto mixed =
        find_spikes(in_order(toolface), in_order(radius), in_order(turn), depths(mixed_depth), threshold, floor);
    std::vector<Index> back;
    for (const Index i : mixed.samples) back.push_back(static_cast<Index>(order[static_cast<std::size_t>(i)]));
    std::sort(back.begin(), back.end());
    require_rule(back == found.samples && mixed.unjudged == found.unjudged, "spikes of samples in another order");
}

// Turns, passes and repeats.
void check_rows(Input& input) {
    Uniform uniform(input.below(65536));
    const std::size_t count = input.below(300);
    const double turning = 720.0 * input.share() - 360.0, wander = input.one_of({0.0, 30.0, 400.0});
    std::vector<double> toolface, wound, depth, opposite, radius;
    std::vector<Index> row;
    for (std::size_t i = 0; i < count; ++i) {  // multiples of 1/64 degree: whole turns more change no bit
        const double angle = turning * static_cast<double>(i) + wander * uniform();
        toolface.push_back(std::floor(64.0 * (angle - 360.0 * std::floor(angle / 360.0))) / 64.0);
        wound.push_back(toolface.back() + 360.0 * std::floor(9.0 * uniform() - 4.0));
        depth.push_back((i > 0 ? depth.back() : 500.0) + (uniform() - 0.3) / 8.0);
        opposite.push_back(-depth.back());
        radius.push_back(0.1 + std::floor(3.0 * uniform()));
        row.push_back(static_cast<Index>(i));
    }
    if (input.one_in(16) && count > 0) row.back() = static_cast<Index>(count);
    std::optional<std::vector<Index>> turns;
    if (!refused([&] { turns = turns_by_rotation(toolface, row, depth); })) {
        require_rule(!turns || turns->size() == count, "a turn for each sample");
        require_rule(turns == turns_by_rotation(wound, row, depth), "whole turns more change no turn");
    }
    const double reversal = input.mostly_of({0.05, 0.5});
    std::vector<std::int64_t> passes;
    if (refused([&] { passes = number_passes(depth, reversal); })) return;
    for (std::size_t i = 0; i < count; ++i) {
        const std::int64_t before = i == 0 ? 0 : passes[i - 1];
        require_rule(passes[i] == before || (i > 0 && passes[i] == before + 1), "passes follow each other");
    }
    require_rule(passes == number_passes(opposite, reversal), "passes of the opposite depths");

    for (std::size_t i = 0; i < count; ++i)
        depth[i] = std::floor(depth[i]), toolface[i] = std::floor(toolface[i] / 90.0);
    std::set<std::vector<double>> different;
    for (std::size_t i = 0; i < count; ++i) different.insert({depth[i], toolface[i], radius[i]});
    const double repeats = share_of_repeats(depth, toolface, radius, static_cast<Index>(count));
    const double expected = count == 0 ? 0.0 : 1.0 - static_cast<double>(different.size()) / static_cast<double>(count);
    require_rule(repeats == expected, "the share of rows that equal an earlier one");
}

// The rows of a text, token by token; nothing if one breaks the grammar. Column by column.
std::vector<double> slow_rows(std::string_view text, std::size_t columns, bool comments) {
    std::vector<std::vector<double>> rows;
    while (!text.empty()) {
        const std::size_t end = std::min(text.find('\n'), text.size());
        std::string_view line = text.substr(0, end);
        text.remove_prefix(std::min(end + 1, text.size()));
        std::vector<double> row;
        for (;;) {
            line.remove_prefix(std::min(line.find_first_not_of(" \t"), line.size()));
            if (line.empty() || (row.empty() && comments && line[0] == '#')) break;
            std::string_view token = line.substr(0, line.find_first_of(" \t"));
            line.remove_prefix(token.size());
            if (token[0] == '+') {
                token.remove_prefix(1);
                if (token.empty() || token[0] == '-' || token[0] == '+') return {};
            }
            double value = 0.0;
            const auto [stop, error] = std::from_chars(token.data(), token.data() + token.size(), value);
            if (error != std::errc() || stop != token.data() + token.size() || !(std::abs(value) < 0x1p53)) return {};
            row.push_back(value);
        }
        if (row.empty()) continue;
        if (row.size() != columns) return {};
        rows.push_back(row);
    }
    std::vector<double> found;
    for (std::size_t c = 0; c < columns; ++c)
        for (const std::vector<double>& row : rows) found.push_back(row[c]);
    return found;
}

void check_text(Input& input) {
    const std::size_t columns = input.below(4);
    const bool comments = input.one_in(2);
    std::string text;
    while (input.left() > 0) {
        static const std::string words[] = {" ",
                                            " ",
                                            "\t",
                                            "\n",
                                            "\n",
                                            "#",
                                            "\r",
                                            "1",
                                            "-2.5",
                                            "1013.25",
                                            "+0.125",
                                            "-0",
                                            ".5",
                                            "5.",
                                            "1e5",
                                            "1e-7",
                                            "1E400",
                                            "1e-400",
                                            "9007199254740993",
                                            "123456789012345.6",
                                            "0.1234567890123456789",
                                            "nan",
                                            "inf",
                                            "-",
                                            "+",
                                            "+-1",
                                            ".",
                                            "0x10"};
        const std::size_t word = input.below(std::size(words) + 1);
        if (word < std::size(words))
            text += words[word];
        else
            text += static_cast<char>(input.byte());
        if (input.one_in(3)) text += ' ';
    }
    require_rule(same_bits(read_number_rows(text, columns, comments),
                           columns == 0 ? std::vector<double>{} : slow_rows(text, columns, comments)),
                 "the rows that a slow reader finds");
}

}  // namespace

void fuzz(Input input) {
    switch (input.below(4)) {
        case 0:
            return check_preparation(input);
        case 1:
            return check_spikes(input);
        case 2:
            return check_rows(input);
        default:
            return check_text(input);
    }
}
