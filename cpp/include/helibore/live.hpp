// A well while it is drilled, for software that owns its own transport: push samples, survey stations and image rows as
// they come, and draw what changed.
//
//     helibore::Live live({.wall = {.bit_diameter = 0.216, .start_depth = 2500.0}});
//     live.append_samples({depth, toolface, radius, time});         // each call returns what it changed
//     live.append_stations(depth, inclination, azimuth);
//     const helibore::Update news = live.poll();                    // everything since the last poll, in one
//     if (news.change) for (const helibore::Range k : news.change->ranges) ...
//
// The same samples, with their times, give the bits that Python's hb.Live gives, however they were grouped. No
// callback, no clock, and no thread unless the settings ask for more than one: a call does its work and returns. Calls
// may come from any thread; they wait for each other.
// Not here: WITS and what its items mean, passes, the journal's files (wits.hpp and journal.hpp read and seal bytes).
#pragma once

#include <array>
#include <map>
#include <mutex>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "helibore/path.hpp"
#include "helibore/wall.hpp"

namespace helibore {

struct LiveSettings {
    Settings wall;                          // start_depth must be set: vertices keep their numbers
    PathSettings path = {.extend = 100.0};  // of the survey; sensors run ahead of its last station
};

// What one call changed, or all calls since the last poll.
struct Update {
    std::optional<Change> change;         // of the wall; none when no samples came
    std::map<std::string, Range> images;  // of each image that grew, its new rows in order of arrival: Live::rows
    std::optional<double> path_from;      // stations changed below this depth, metres; the path, once it has two
    std::vector<std::string> events;      // stations that were left out, and why: the first hundred of a poll

    // Ranges are sorted and apart, most_ranges at most: beyond that the narrowest gaps between them are closed, so that
    // a host that never polls holds little.
    static constexpr std::size_t most_ranges = 1024;

    // The quads with a vertex that is new or changed. Quad k has the vertices k, k + 1, k + 1 + K and k + K, K =
    // `sectors`; those past the end of the wall are to be cut off by the caller.
    std::vector<Range> quads(int sectors) const;
};

// Rows sorted by depth, of rows at one depth the latest: what cell_values and linear_values take.
struct ImageArrays {
    std::vector<double> depth;   // metres
    std::vector<double> values;  // `sectors` a row
    int sectors = 0;
    std::string unit;
};

class Live {
  public:
    // Throws InputError on bad settings.
    explicit Live(const LiveSettings& settings);

    // As Wall::append. Throws InputError, and has taken none of them then.
    Update append_samples(const SampleColumns& samples);

    // Stations in any order: a late one is sorted in, one at a depth that is there already replaces it. A bad one
    // becomes an event and is left out. Throws InputError on columns of unequal length.
    Update append_stations(std::span<const double> depth, std::span<const double> inclination,
                           std::span<const double> azimuth);

    // Rows of a sector image: a depth each, and as many values for each depth. Throws InputError on a depth that is not
    // finite, or another number of sectors than before.
    Update append_image(const std::string& name, std::span<const double> depth, std::span<const double> values,
                        const std::string& unit = {});

    // Everything that changed since the last poll; after a call that threw std::bad_alloc, look at all.
    Update poll();

    const Wall& wall() const { return wall_; }
    std::optional<Survey> survey() const;  // none while it has fewer than two stations
    std::optional<Path> path() const;
    std::vector<std::string> images() const;           // the names
    ImageArrays image(const std::string& name) const;  // throws InputError for a name that is not there

    // Some rows as they arrived, such as those that Update::images tells. All of them, sorted by depth, of rows at one
    // depth the latest, are image(name). Throws InputError for rows that have not come.
    ImageArrays rows(const std::string& name, Range arrived) const;

  private:
    struct ArrivedRows {
        std::vector<double> depth, values;
        int sectors = 0;
        std::string unit;
    };

    void take_stations(std::span<const double> depth, std::span<const double> inclination,
                       std::span<const double> azimuth, Update& update);
    Update told(Update update);
    const ArrivedRows& arrived(const std::string& name) const;

    mutable std::mutex lock_;
    PathSettings path_settings_;
    Wall wall_;
    std::map<double, std::array<double, 2>> stations_;  // depth: inclination, azimuth
    std::optional<Survey> survey_;
    std::optional<Path> path_;
    std::map<std::string, ArrivedRows> images_;
    Update news_;
};

}  // namespace helibore
