/* SPDX-License-Identifier: Apache-2.0 */
/* The command line: one file per command, each with its own argp parser (so `raytally COMMAND --help` teaches
 * it), and what they share. Only here is anything printed, and only main exits. */
#ifndef RT_CLI_CLI_H
#define RT_CLI_CLI_H

#include "cli/options.h"
#include "core/base/param.h"
#include "core/base/ray.h"
#include "core/base/status.h"
#include "core/scene/camera.h"

#include <jansson.h>
#include <stdbool.h>
#include <stdint.h>

enum { RT_EXIT_OK = 0, RT_EXIT_CHECK_FAILED = 1, RT_EXIT_BAD_INPUT = 2 };

typedef struct RtCommand {
    const char *name, *arguments, *summary;
    /* argv[0] is "raytally NAME". The exit code depends on the status. An empty message is not printed: the
     * command has said what failed. */
    RtStatus (*run)(int argc, char **argv, RtError *error);
    const RtSyntax *syntax;
} RtCommand;

/* X(identifier, name, arguments, summary) */
#define RT_COMMANDS(X)                                                                                       \
    X(accels, "accels", "[NAME]", "list the accelerators and their parameters")                              \
    X(scenes, "scenes", "[NAME]", "list the built-in scenes and their parameters")                           \
    X(info, "info", "SCENE", "objects, bounds, materials, lights, camera of a scene")                        \
    X(render, "render", "SCENE", "an image of a scene, of its cost, or of structures")                       \
    X(trace, "trace", "SCENE", "a ray's path through an accelerator, or its ray tree")                       \
    X(explore, "explore", "SCENE", "a web page: step a pixel's rays through structures")                     \
    X(verify, "verify", "[SCENE...]", "check that every hit equals brute's")                                 \
    X(bench, "bench", "SCENE", "count and time accelerators on the rays of one scene")                       \
    X(compare, "compare", "BEFORE AFTER", "compare two results, or two alternating programs")                \
    X(rays, "rays", "SCENE", "write rays for NumPy, as bench and verify read them")                          \
    X(run, "run", "EXPERIMENT", "run an experiment: CSV files, plots, report")                               \
    X(merge, "merge", "DIR...", "join the shards of an experiment (run --shard)")                            \
    X(plot, "plot", "DIR", "redraw the plots of a result directory")                                         \
    X(report, "report", "DIR", "rewrite the report of a result directory, or an index")                      \
    X(reproduce, "reproduce", "DIR", "count again, compare with DIR/counts.csv byte for byte")               \
    X(convert, "convert", "IN OUT", "write a scene in another format")                                       \
    X(new_accel, "new-accel", "NAME", "make a folder with a working plugin to start from")
#define RT_COMMAND(id, name, arguments, summary)                                                             \
    RtStatus rt_command_##id(int argc, char **argv, RtError *error);                                         \
    extern const RtSyntax rt_##id##_syntax;
RT_COMMANDS(RT_COMMAND)

/* RT_BAD_INPUT if the file name `name` is not UTF-8, and so cannot be in a JSON document. Call it first:
 * json_pack would only return NULL. */
RtStatus rt_cli_check_json_name(const char *name, RtError *error);

/* Prints one JSON document to stdout, indented, and takes the reference. */
void rt_cli_print_json(json_t *document);

/* A parameter table: two lines per parameter, or an array of objects. */
void rt_cli_print_params(const RtParam *table, size_t count);
json_t *rt_cli_params_json(const RtParam *table, size_t count);

/* For parsers of options: the number in `text`, lo..hi; ends the process by argp_error if it is wrong.
 * `state` is argp's. */
int64_t rt_cli_integer(struct argp_state *state, const char *option, const char *text, int64_t lo,
                       int64_t hi);

/* The same for bytes, "512M": a number and K, M, G or T, powers of 1000, or neither. */
uint64_t rt_cli_bytes(struct argp_state *state, const char *option, const char *text);

/* For parsers of several numbers: reads the digits at *text, up to UINT32_MAX, and moves *text past them;
 * false if there are none, or the number is larger. */
bool rt_cli_digits(const char **text, uint32_t *number);

/* For tables of options: limits the memory and the time of this process. */
void rt_cli_take_memory(void *options, const char *text, struct argp_state *state);
void rt_cli_take_time(void *options, const char *text, struct argp_state *state);

/* Options of several commands. */
#define RT_PATIENCE 60 /* seconds */
#define RT_UNTIL_OPTIONS(until, patience)                                                                    \
    {"until", 0, "P%", RT_TO_PERCENT(until),                                                                 \
     "Add rounds until the intervals of all ratios lie within P % of their medians, up to 1000 rounds or "   \
     "--patience seconds; if that is not enough, a line says how narrow they are"},                          \
    {                                                                                                        \
        "patience", 0, "SECONDS", RT_TO_SECONDS(patience, 1, 86400),                                         \
            "With --until: the longest time for one kind of rays on one scene (60)"                          \
    }
#define RT_MEMORY_OPTION(memory)                                                                             \
    {                                                                                                        \
        "memory", 0, "BYTES", RT_TO_BYTES(memory),                                                           \
            "Memory limit for each accelerator, as in 512M or 4G (powers of 1000): what a built-in one "     \
            "allocates during its build, and what a plugin's process holds at any time. One that exceeds "   \
            "it during its build is refused, which costs only its own rows; a plugin that exceeds it later " \
            "is broken (exit code 1). It does not raise the limit of structures: 4 GiB, or 128 bytes per "   \
            "object"                                                                                         \
    }
#define RT_TIME_OPTION(kept)                                                                                 \
    {                                                                                                        \
        "time", 0, "SECONDS", RT_TO_TAKE(rt_cli_take_time),                                                  \
            "Time limit for the whole command, which then ends with exit code 2" kept                        \
    }
/* Whether the build of one of `count` accelerators was refused and the command goes on with the others; says
 * so. */
bool rt_cli_goes_on(RtStatus status, const char *spec, uint32_t count, const RtError *why);

/* Removes texts[i] of texts[0..*count). */
void rt_cli_remove(const char **texts, uint32_t *count, uint32_t i);

#define RT_LIMIT_OPTIONS                                                                                     \
    {"memory", 0, "BYTES", RT_TO_TAKE(rt_cli_take_memory),                                                   \
     "Memory limit for scenes, structures, rays and images, as in 512M or 4G (powers of 1000); a command "   \
     "that needs more ends with exit code 2"},                                                               \
        RT_TIME_OPTION("")
#define RT_TRUST_OPTION(scripts)                                                                             \
    {                                                                                                        \
        "trust", 0, NULL, RT_TO_SET(scripts, RT_SCRIPTS_ALL),                                                \
            "Also run gnuplot scripts of a result directory that raytally does not ship. A script can run "  \
            "any command: read it first"                                                                     \
    }
#define RT_THREADS_HELP                                                                                      \
    "Threads, 0 for all processors. Default: time on one thread, by processor time, and build and count on " \
    "all. Times on several threads are wall times"

/* Commands that list what there is: all of it, or one by name. */
typedef struct RtListOptions {
    const char *name; /* NULL: all */
    bool json;
} RtListOptions;
extern const RtOption rt_list_options[];
#define RT_LIST_ARGUMENT                                                                                     \
    { "NAME", NULL, RT_VALUE(.form = RT_OPTION_TEXT, .offset = offsetof(RtListOptions, name)) }

/* Prints `list`, an array, under `key` with `json`; else `syntax`, without a name. Takes the reference. */
void rt_list_finish(const RtListOptions *options, const char *key, json_t *list, const char *syntax);

/* A vector as [x, y, z]. */
json_t *rt_cli_vector_json(RtVec3 v);

/* RT_BAD_INPUT if the pixel of --pixel is outside the image. */
RtStatus rt_cli_check_pixel(const RtSampling *sampling, RtPixel pixel, RtError *error);

/* A kind of rays of images: primary, shadow, reflection or transmission. */
RtRayKind rt_cli_image_ray_kind(struct argp_state *state, const char *option, const char *text);

#define RT_CLI_PICTURES ".png, .svg or .pdf" /* the formats of pictures */

/* For parsers: stores `path` in *slot; ends the process by argp_error if it ends in none of `extensions`, or
 * if *slot is set. */
void rt_cli_set_path(struct argp_state *state, const char *option, const char **slot, const char *path,
                     const char *extensions);

/* "WxH" */
void rt_cli_size(struct argp_state *state, const char *text, uint32_t *width, uint32_t *height);

#endif
