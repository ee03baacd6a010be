/* The C interface: the wall of a hole for hosts in any language that calls C.

       hb_settings settings;
       int64_t wall = 0;
       settings.size = sizeof settings;
       hb_settings_init(&settings);
       settings.bit_diameter = 0.216;
       if (hb_wall_create(&settings, &wall) || hb_wall_append(wall, n, depth, toolface, radius, NULL, NULL))
           puts(hb_last_error());

   Every function but hb_version, hb_instruction_set and hb_last_error returns a status. A call that fails changes no
   object, and hb_last_error then returns the text of the error. After a failed call the values in the host's arrays
   have no meaning.

   Handles are numbers above 0. A number is never used again, so the use of a closed or wrong handle is an error.
   hb_close closes handles of every kind. Any thread may use any handle; calls on one wall wait for each other.

   Set the member `size` of a struct to its sizeof before a call. Later headers add members at the end of a struct. A
   library takes the shorter structs of older headers: members that they lack have their defaults, and are not written.
   It refuses a struct that is longer than its own, by name and size.

   Arrays belong to the host; the library keeps no pointer to them. They have `n` values each; they may be NULL if n is
   0. Some calls fill arrays whose length the host does not know. Before such a call, set *count to the number of values
   for which your arrays have room; after the call, *count is the number needed. If there is not enough room, the call
   returns HB_BUFFER_TOO_SMALL and fills nothing. So call with 0 and NULL first, or with the room that you have.

   Quantities are metres and degrees. NaN in an output means no value. Vertices, quads and toolfaces are as in wall.hpp
   and surface.hpp. The host's floating-point state (traps, rounding) does not matter and stays as it is. The library
   prints nothing, leaves no thread running, and calls no function of the host except a runner (hb_use_runner). */
#ifndef HELIBORE_H
#define HELIBORE_H

#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

#ifdef _WIN32
#define HB_CALL __cdecl
#else
#define HB_CALL
#endif
#if defined(_WIN32) && defined(HB_BUILD)
#define HB_API __declspec(dllexport)
#elif defined(_WIN32)
#define HB_API __declspec(dllimport)
#elif defined(__GNUC__)
#define HB_API __attribute__((visibility("default")))
#else
#define HB_API
#endif

/* Status of a call. */
#define HB_OK 0
#define HB_INPUT 1            /* bad input: hb_last_error names place, value and rule */
#define HB_NO_MEMORY 2        /* out of memory */
#define HB_INTERNAL 3         /* a bug in helibore */
#define HB_BUFFER_TOO_SMALL 4 /* *count says how much room is needed */

HB_API const char* HB_CALL hb_version(void); /* "0.1.0" */

/* Returns the name of the instruction set that HB_AUTOMATIC chooses: "plain", "avx2" or "avx512". */
HB_API const char* HB_CALL hb_instruction_set(void);

/* Returns the error of this thread's last call that returned a status, for example "toolface[17] = nan: must be
   finite", or "" if that call succeeded. The text is at most 1023 bytes of UTF-8; a longer text is cut. The thread's
   next call overwrites it. */
HB_API const char* HB_CALL hb_last_error(void);

/* Closes a handle of any kind. */
HB_API int32_t HB_CALL hb_close(int64_t handle);

/* Later calls of this thread use `run` to share out their work to the host's threads. If `run` is NULL, they start
   threads of the library again. `run` calls job(context, worker) once for each worker in [0, workers), on any threads,
   and returns when all these calls have returned. A worker needs 64 KB of stack at most; runner.hpp says more.
   `run` may call the library. But a call on the object whose call it serves, in the thread of that call, returns
   HB_INPUT ("this wall: is being appended to or read in this thread"); in another thread the call waits until the
   object is free, so `run` must not wait for it. */
typedef void(HB_CALL* hb_job)(void* context, int32_t worker);
typedef void(HB_CALL* hb_run)(void* host, int32_t workers, hb_job job, void* context);
HB_API int32_t HB_CALL hb_use_runner(hb_run run, void* host);

/* --- settings.hpp and path.hpp explain each setting ------------------------------------------------------------- */

#define HB_INVERSE_DISTANCE 0
#define HB_KRIGING 1
#define HB_NEAR_AND_FAR 2
#define HB_AUTOMATIC 0
#define HB_PLAIN 1
#define HB_AVX2 2
#define HB_AVX512 3

typedef struct hb_settings {
    uint32_t size;
    int32_t sectors;
    double bit_diameter; /* must be set */
    double pitch;
    double start_depth; /* NaN: the depth of the first sample; a live well must have a number here */
    double stop_depth;  /* NaN: the depth of the last sample */
    double start_toolface;
    int64_t window; /* 0: all samples */
    int64_t most_vertices;
    double power;
    double max_distance; /* infinity: no limit */
    double tolerance;
    double angular_scale;
    double kriging_range;
    double nugget;
    int32_t neighbors;
    int32_t max_iterations;
    int32_t estimator;
    int32_t direct;
    int32_t threads;
    int32_t instruction_set;
    int32_t sigma;            /* 1: the wall keeps what hb_wall_sigma needs */
    int32_t covariance_count; /* HB_NEAR_AND_FAR: how many values `covariance` has; else 0 */
    double covariance[12];    /* [3] < 0: a smooth first term; [6] < 0: the second repeats after half a turn */
    int64_t other_turns_count;
    const double* other_turns; /* NULL: none; else read by hb_wall_create alone */
    int64_t robust;            /* 1: samples that differ from all beside them hardly count */
    int64_t stretches_count;
    const double* stretches; /* NULL: none; else read by hb_wall_create alone */
} hb_settings;

#define HB_MINIMUM_CURVATURE 0
#define HB_RADIUS_OF_CURVATURE 1
#define HB_HIGH_SIDE 0
#define HB_NORTH 1
#define HB_PARALLEL_TRANSPORT 2

typedef struct hb_path_settings {
    uint32_t size;
    int32_t method;
    int32_t reference;
    int32_t reserved; /* 0 */
    double head_north;
    double head_east;
    double head_down;
    double extend;
} hb_path_settings;

/* Fills in the defaults. */
HB_API int32_t HB_CALL hb_settings_init(hb_settings* settings);
HB_API int32_t HB_CALL hb_path_settings_init(hb_path_settings* settings);

/* --- wall -------------------------------------------------------------------------------------------------------- */

typedef struct hb_wall_state {
    uint32_t size;
    int32_t reserved;
    int64_t vertices;
    int64_t samples;
    int64_t settled;    /* vertices with a lower number no longer change while the hole only gets deeper */
    double start_depth; /* of vertex 0; NaN while neither the settings nor a sample give it */
} hb_wall_state;

typedef struct hb_change {
    uint32_t size;
    int32_t reserved;
    int64_t ranges;    /* number of ranges of vertices that are new or whose values changed: the room for hb_ranges */
    int64_t settled;   /* as in hb_wall_state */
    int64_t accepted;  /* number of samples taken */
    int64_t redundant; /* number of samples dropped: equal to another in depth, time, toolface and radius */
} hb_change;

/* Creates an empty wall; *wall is its handle. */
HB_API int32_t HB_CALL hb_wall_create(const hb_settings* settings, int64_t* wall);

/* Appends n samples. time may be NULL: either all samples of a wall have a time or none has. change may be NULL. */
HB_API int32_t HB_CALL hb_wall_append(int64_t wall, int64_t n, const double* depth, const double* toolface,
                                      const double* radius, const double* time, hb_change* change);

/* Copies the ranges of vertices that the last append of a wall, or the last poll of a live well, changed: *count pairs
   of start and stop, half-open. */
HB_API int32_t HB_CALL hb_ranges(int64_t wall_or_live, int64_t* count, int64_t* start_stop);

/* Writes the present state of the wall into *state. */
HB_API int32_t HB_CALL hb_wall_get(int64_t wall, hb_wall_state* state);

#define HB_DEPTH 0
#define HB_TOOLFACE 1
#define HB_RADIUS 2
#define HB_NEAREST 3
#define HB_SUPPORT 4
#define HB_ITERATIONS 5
#define HB_PROVISIONAL 6
#define HB_TIME 7 /* only for hb_wall_samples */

/* Copies one column of the vertices [start, stop): stop - start values. */
HB_API int32_t HB_CALL hb_wall_read(int64_t wall, int32_t column, int64_t start, int64_t stop, double* values);

/* Copies one column of all samples kept, in canonical order: HB_DEPTH, HB_TOOLFACE, HB_RADIUS or HB_TIME. */
HB_API int32_t HB_CALL hb_wall_samples(int64_t wall, int32_t column, int64_t* count, double* values);

/* Interpolates at all vertices the values of a channel that was measured with the samples; fills *count values.
   `samples` has one value of the channel for each of the n samples, in the order of hb_wall_samples. */
HB_API int32_t HB_CALL hb_wall_interpolate(int64_t wall, int64_t n, const double* samples, int64_t* count,
                                           double* values);

/* Computes the angular gap of each vertex: degrees between the nearest samples on its two sides that lie within `reach`
   metres of its depth; logs.hpp says more. Fills *count values, one for each vertex. */
HB_API int32_t HB_CALL hb_wall_angular_gaps(int64_t wall, double reach, int64_t* count, double* values);

/* uncertainty.hpp has the formula. */
typedef struct hb_sigma_rule {
    uint32_t size;
    int32_t reserved;
    double noise;
    double between;
    double scatter_power;
    double distance_power;
    double stretch;
    double reach;
} hb_sigma_rule;

/* Computes the standard uncertainty of each radius by a rule; the wall must have been created with `sigma`. Fills
 *count values, one for each vertex. With HB_NEAR_AND_FAR, noise = 1 and between = 0 give that of its covariance. */
HB_API int32_t HB_CALL hb_wall_sigma(int64_t wall, const hb_sigma_rule* rule, int64_t* count, double* values);

/* Estimates the radius at n points from the samples of the wall, by its settings; `window` has no effect. nearest: the
   distance of the nearest sample used. Both are NaN where no sample is within max_distance; either may be NULL. A wall
   with HB_NEAR_AND_FAR is refused. */
HB_API int32_t HB_CALL hb_wall_estimate(int64_t wall, int64_t n, const double* depth, const double* toolface,
                                        double* radius, double* nearest);

/* Computes the logs of each full turn, column after column in the order of logs.hpp: HB_LOG_COLUMNS times *turns
   values. window: the number of turns over which rugosity is measured, odd, 3 or more. */
#define HB_LOG_COLUMNS 18
HB_API int32_t HB_CALL hb_wall_logs(int64_t wall, int64_t window, int64_t* turns, double* values);

/* zones.hpp and logs.hpp (MeasuredRule) explain each member. */
typedef struct hb_zone_criteria {
    uint32_t size;
    int32_t reserved; /* 0 */
    double elongation;
    double washout;
    double key_seat;
    double undergauge;
    double symmetry;
    double opening_level;
    double least_length;
    double join;
    double gap_reach;   /* a vertex is measured only if samples within this reach, in metres, */
    double largest_gap; /* are at most so many degrees apart around it */
} hb_zone_criteria;

/* Fills in the defaults. */
HB_API int32_t HB_CALL hb_zone_criteria_init(hb_zone_criteria* criteria);

/* Finds the zones of a wall: washouts, breakouts, key seats and undergauge hole, in order of depth. Of a tool with few
   arms the shape is that of the wall, which is rounder between the arms than the hole: see hb_wall_arm_zones. kinds: of
   each full turn, -1 none, 0 gauge, 1 washout, 2 breakout, 3 key seat, 4 undergauge; may be NULL. Fills column after
   column: the 20 numbers of a Zone in the order of zones.hpp, a lobe as toolface, opening, height: HB_ZONE_COLUMNS
   times *count values. */
#define HB_ZONE_COLUMNS 20
HB_API int32_t HB_CALL hb_wall_zones(int64_t wall, const hb_zone_criteria* criteria, int64_t* turns, int32_t* kinds,
                                     int64_t* count, double* values);

/* As hb_wall_zones, for a tool with few arms: C1, C2, the least diameter and the axis of each turn are those that the
   arms measured, as by wall_zones of C++ with ArmSamples. n samples of the wall in any order, and the number of the
   arm that measured each; the two ends of a diameter may have one number or two. time may be NULL. */
HB_API int32_t HB_CALL hb_wall_arm_zones(int64_t wall, const hb_zone_criteria* criteria, int64_t n, const double* depth,
                                         const double* toolface, const double* radius, const int64_t* arm,
                                         const double* time, int64_t* turns, int32_t* kinds, int64_t* count,
                                         double* values);

/* Computes the passage of a rigid string of bodies at each full turn, along a path (0: straight down); passage.hpp says
   more. start, stop: metres down the axis from the middle of the string; diameter: outer, metres (0: the clearance is
   the diameter that passes). counts, sigma: one value for each vertex, `vertices` in all; either may be NULL. Fills
   column after column: clearance, low, high, depth, toolface and number of the body of the first contact:
   HB_PASSAGE_COLUMNS times *turns values. */
#define HB_PASSAGE_COLUMNS 6
HB_API int32_t HB_CALL hb_wall_passage(int64_t wall, int64_t path, int64_t bodies, const double* start,
                                       const double* stop, const double* diameter, int64_t vertices,
                                       const double* counts, const double* sigma, int64_t* turns, double* values);

/* Computes the surface between those vertices of [start, stop) that have a radius, along a path (0: straight down).
   vertices: north, east and down of each vertex. vertex_index, which may be NULL: the number of each vertex on the
   helix. quads: for each quad, the rows of its four corners in `vertices`. */
HB_API int32_t HB_CALL hb_wall_surface(int64_t wall, int64_t path, int64_t start, int64_t stop, int64_t* vertex_count,
                                       double* vertices, int64_t* vertex_index, int64_t* quad_count, int64_t* quads);

/* Computes the volume of the vertices [start, stop) between the wall and one or more shells, along a path (0: straight
   down). thickness: of each shell, metres from the wall, rising. vertices: north, east and down of each vertex of the
   wall, then of each shell. hexahedra: for each, the rows of its eight corners in `vertices`. */
HB_API int32_t HB_CALL hb_wall_volume(int64_t wall, int64_t path, int64_t start, int64_t stop, int64_t shells,
                                      const double* thickness, int64_t* vertex_count, double* vertices,
                                      int64_t* hexahedron_count, int64_t* hexahedra);

/* --- path -------------------------------------------------------------------------------------------------------- */

/* Creates the path through n stations: depth in metres, inclination and azimuth in degrees; *path is its handle. */
HB_API int32_t HB_CALL hb_path_create(const hb_path_settings* settings, int64_t n, const double* depth,
                                      const double* inclination, const double* azimuth, int64_t* path);

/* Computes the path at n depths: positions of three numbers, and frames of nine (directions towards toolface 0 and 90,
   tangent). Either array may be NULL. */
HB_API int32_t HB_CALL hb_path_read(int64_t path, int64_t n, const double* depth, double* position, double* frame);

/* --- from the readings of a tool to samples; preparation.hpp says more ------------------------------------------- */

typedef struct hb_preparation {
    uint32_t size;
    int32_t drop_closed;
    double bit_diameter; /* NaN: not known */
    double spikes;
    int32_t drop_saturated;
    int32_t drop_spikes; /* those of tools with few arms, from `spikes` deviations on */
    double turn_spikes;  /* deviations from which samples of other tools are spikes and are dropped; NaN: they stay */
} hb_preparation;

/* Fills in the defaults. */
HB_API int32_t HB_CALL hb_preparation_init(hb_preparation* settings);

/* Prepares the n rows of a log; *prepared is the handle of what comes out. NaN is a missing value. time may be NULL.
   radii: n values of each of the `columns`, column after column; a diameter counts as its half. Each of the `sensors`
   has an offset in metres, a mounting in degrees and the number of its column. */
HB_API int32_t HB_CALL hb_prepare(const hb_preparation* settings, int64_t n, const double* depth,
                                  const double* toolface, const double* time, int32_t columns, const double* radii,
                                  int32_t sensors, const double* offset, const double* mounting, const int32_t* column,
                                  int64_t* prepared);

typedef struct hb_prepared_state {
    uint32_t size;
    int32_t reserved;
    int64_t samples;
    int64_t suspects;    /* number of runs of suspect rows: the room for hb_prepared_suspects */
    int64_t no_depth;    /* number of readings that lack a depth */
    int64_t no_toolface; /* and of the others those that lack a toolface, and so on */
    int64_t no_radius;
    int64_t no_time;
    double repeats; /* share of samples that equal an earlier one */
    int64_t spikes; /* number of samples that were left out as spikes */
} hb_prepared_state;

/* Writes into *state what hb_prepare found. */
HB_API int32_t HB_CALL hb_prepared_get(int64_t prepared, hb_prepared_state* state);

#define HB_SENSOR 8
#define HB_ROW 9

/* Copies one column of the samples: HB_DEPTH, HB_TOOLFACE, HB_RADIUS, HB_TIME, HB_SENSOR or HB_ROW. */
HB_API int32_t HB_CALL hb_prepared_samples(int64_t prepared, int32_t column, int64_t* count, double* values);

#define HB_DISAGREEMENT 0
#define HB_CLOSED 1
#define HB_RAMP 2
#define HB_SATURATED 3
#define HB_STUCK 4
#define HB_BURST 5
#define HB_JUMP 6

/* Copies the *count runs of suspect rows. start_stop: pairs, half-open. column: -1 for all columns; other: of a
   disagreement, else -1. dropped: 1 if the readings did not become samples. Each array may be NULL. */
HB_API int32_t HB_CALL hb_prepared_suspects(int64_t prepared, int64_t* count, int32_t* cause, int32_t* column,
                                            int32_t* other, int64_t* start_stop, int32_t* dropped, double* radius);

/* --- a well while it is drilled ---------------------------------------------------------------------------------- */

typedef struct hb_update {
    uint32_t size;
    int32_t reserved;
    hb_change change; /* all 0 if no samples came; its size need not be set */
    double path_from; /* the path changed below this depth; NaN: nowhere */
    int64_t images;   /* number of images with new rows */
    int64_t events;   /* number of stations that were left out; hb_live_event says why */
} hb_update;

/* Creates a live well; *live is its handle. Samples (time may be NULL), stations and image rows are then appended. */
HB_API int32_t HB_CALL hb_live_create(const hb_settings* settings, const hb_path_settings* path, int64_t* live);
HB_API int32_t HB_CALL hb_live_append_samples(int64_t live, int64_t n, const double* depth, const double* toolface,
                                              const double* radius, const double* time);
HB_API int32_t HB_CALL hb_live_append_stations(int64_t live, int64_t n, const double* depth, const double* inclination,
                                               const double* azimuth);

/* Appends n rows of `sectors` values to the image of this name. name and unit are UTF-8; the image keeps the unit of
   its first rows. */
HB_API int32_t HB_CALL hb_live_append_image(int64_t live, const char* name, const char* unit, int64_t n,
                                            int32_t sectors, const double* depth, const double* values);

/* Writes into *update what changed since the last poll. After this call, hb_ranges copies the changed ranges. */
HB_API int32_t HB_CALL hb_live_poll(int64_t live, hb_update* update);

/* Copies the text of event `index` of the last poll: *count bytes, including the 0 at the end of the text. */
HB_API int32_t HB_CALL hb_live_event(int64_t live, int64_t index, int64_t* count, char* text);

/* Copies all rows of an image, sorted by depth: *rows depths, *rows times *sectors values. Of several rows at one
   depth, only the latest counts. */
HB_API int32_t HB_CALL hb_live_image(int64_t live, const char* name, int32_t* sectors, int64_t* rows, double* depth,
                                     double* values);

/* hb_live_wall opens a handle of the wall, for reading only. hb_live_path opens a handle of the path as it is now.
   These handles stay open when `live` is closed. */
HB_API int32_t HB_CALL hb_live_wall(int64_t live, int64_t* wall);
HB_API int32_t HB_CALL hb_live_path(int64_t live, int64_t* path);

/* --- WITS level 0 ------------------------------------------------------------------------------------------------ */

/* Creates a parser of one stream of WITS frames; *parser is its handle. */
HB_API int32_t HB_CALL hb_wits_create(int64_t* parser);

/* Takes n bytes; n = 0 ends the stream. *items: the number of items in the frames that these bytes complete. *events:
   the number of times that these bytes break a Rule of wits.hpp. Either may be NULL. */
HB_API int32_t HB_CALL hb_wits_feed(int64_t parser, int64_t n, const char* bytes, int64_t* items, int64_t* events);

/* Copies the *count items in the frames that the last hb_wits_feed completed. frame: the number of the item's frame, 0
   for the first frame of the parser. code: record and item as RRII, 108 for item 08 of record 01. value: NaN if its
   text is empty, no number, or a number that means no value, such as -999.25. offset and length: where its text lies in
   all bytes that were fed. Each array may be NULL. */
HB_API int32_t HB_CALL hb_wits_items(int64_t parser, int64_t* count, int64_t* frame, int32_t* code, double* value,
                                     int64_t* offset, int32_t* length);

#ifdef __cplusplus
}
#endif

#endif
