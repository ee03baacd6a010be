// A well while it is drilled, for software with its own transport: push samples, survey stations and image rows as they
// arrive, and draw what changed.
//
//     helibore::Live live({.wall = {.bit_diameter = 0.216, .start_depth = 2500.0}});
//     live.append_samples({depth, toolface, radius, time});       // each call returns what it changed
//     live.append_stations(depth, inclination, azimuth);
//     const helibore::Update update = live.poll();                // everything since the last poll
//     if (update.change) for (const helibore::Range k : update.change->ranges) ...
//
// The same samples, with their times, give the same bits as Python's hb.Live, however the samples are grouped. The
// class calls no callback, reads no clock, and starts threads only if Settings::threads is above 1. Any thread may
// call; calls at the same time wait for each other. This class reads no WITS, knows no passes and writes no journal
// files (see wits.hpp and journal.hpp).
#pragma once

#include <map>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "helibore/path.hpp"
#include "helibore/wall.hpp"

namespace helibore {

struct LiveSettings {
    Settings wall;                          // start_depth must be set, so that vertices keep their numbers
    PathSettings path = {.extend = 100.0};  // metres; the sensors are deeper than the last station
};

// What one call changed, or what all calls since the last poll changed.
struct Update {
    std::optional<Change> change;         // of the wall; none if no samples came
    std::map<std::string, Range> images;  // new rows of each image, in order of arrival; see Live::rows
    std::optional<double> path_from;      // metres; stations and path changed below this depth
    std::vector<std::string> events;      // stations that were left out, and why; at most 100 per poll

    // The largest number of ranges in an update. If there are more, the narrowest gaps between them are closed, so that
    // a host that never polls uses little memory.
    static constexpr std::size_t most_ranges = 1024;

    // Returns the ranges of quads with a new or changed vertex. Quad k has the vertices k, k + 1, k + 1 + K and k + K,
    // K = `sectors`. The caller cuts off quads beyond the end of the wall.
    std::vector<Range> quads(int sectors) const;
};

// Rows of an image, in the form that cell_values and linear_values take.
struct ImageArrays {
    std::vector<double> depth;   // metres
    std::vector<double> values;  // `sectors` values for each row
    int sectors = 0;
    std::string unit;
};

class Live {
  public:
    // Throws InputError on bad settings.
    explicit Live(const LiveSettings& settings);
    ~Live();
    // A well that was moved from may only be destroyed or assigned to.
    Live(Live&&) noexcept;
    Live& operator=(Live&&) noexcept;

    // Like Wall::append. If this function or one of the next two throws, it has changed nothing.
    Update append_samples(const SampleColumns& samples);

    // Takes stations in any order. A station replaces an earlier one at the same depth. A station that breaks a rule is
    // left out and reported as an event. Throws InputError on columns of unequal length.
    Update append_stations(std::span<const double> depth, std::span<const double> inclination,
                           std::span<const double> azimuth);

    // Appends rows of a sector image: one depth for each row, and the same number of values for each depth. The image
    // keeps the unit of its first rows. Throws InputError on a depth that is not finite or not within 1e7 m of 0, if
    // the number of values is not a multiple of the number of depths, or if the number of sectors differs from that of
    // earlier rows.
    Update append_image(const std::string& name, std::span<const double> depth, std::span<const double> values,
                        const std::string& unit = {});

    // Returns everything that changed since the last poll. If memory ran out, the ranges may contain more vertices than
    // changed, and events may be missing.
    Update poll();

    const Wall& wall() const;
    std::optional<Survey> survey() const;     // none until there are two stations
    std::optional<Path> path() const;         // none until there are two stations
    std::vector<std::string> images() const;  // the names of the images
    // Returns all rows of an image, sorted by depth; of several rows at one depth, only the latest. Throws InputError
    // for an unknown name.
    ImageArrays image(const std::string& name) const;

    // Returns the rows [start, stop) of an image in order of arrival; Update::images holds such ranges. Throws
    // InputError for rows that have not arrived.
    ImageArrays rows(const std::string& name, Range arrived) const;

  private:
    struct State;
    std::unique_ptr<State> state_;
};

}  // namespace helibore
