/* SPDX-License-Identifier: Apache-2.0 */
/* The command line: a file per command, or for a few small ones together, and what they share. Only here is
 * anything printed, and only main exits.
 *
 * One table of a command's options says what --help prints and where each value goes: to a struct that the
 * command's file calls Options. */
#ifndef RT_CLI_CLI_H
#define RT_CLI_CLI_H

#include "results/result_directory.h"
#include "run/workload.h"

#include <argp.h>

enum { RT_EXIT_OK = 0, RT_EXIT_CHECK_FAILED = 1, RT_EXIT_BAD_INPUT = 2 };

/* ---- options ---- */

typedef struct RtPixel {
    uint32_t x, y;
    bool given;
} RtPixel;

/* Reads `text`; ends the process by argp_error if it is wrong. */
typedef void RtTakeOption(void *options, const char *text, struct argp_state *state);

/* Where the value of an option goes, and what it may be. */
typedef struct RtOptionValue {
    enum {
        RT_OPTION_FLAG,    /* bool: true */
        RT_OPTION_TEXT,    /* const char *: as given */
        RT_OPTION_LIST,    /* const char *[high], one value after the other; their number is at `count` */
        RT_OPTION_INTEGER, /* an integer type of `size` bytes: low..high */
        RT_OPTION_SECONDS, /* double: a whole number, low..high */
        RT_OPTION_PERCENT, /* double: "1%" is 0.01 */
        RT_OPTION_SET,     /* int, or an enum: `low` */
        RT_OPTION_BYTES,   /* uint64_t: "512M" is 512 * 10^6; at least 1 */
        RT_OPTION_SIZE,    /* uint32_t[2]: WIDTHxHEIGHT */
        RT_OPTION_PIXEL,   /* RtPixel: X,Y */
        RT_OPTION_PATH,    /* const char *: a file name that ends in one of `endings` */
        RT_OPTION_TAKE,    /* as `take` reads it */
        RT_OPTION_GONE     /* none: an option of an earlier version; `instead` says what to do */
    } form;
    size_t offset, size; /* of the field */
    size_t count;        /* offset of the number of values of a list */
    int64_t low, high;
    RtTakeOption *take;
    const char *endings, *instead;
    size_t mark; /* of a const char * that gets the option's name; 0: none does */
    int flags;   /* argp's */
} RtOptionValue;

/* Parts of RT_MARKING. */
#define RT_AT(field)         .offset = offsetof(Options, field)
#define RT_SETS_FLAG(field)  .form = RT_OPTION_FLAG, RT_AT(field)
#define RT_SETS_PIXEL(field) .form = RT_OPTION_PIXEL, RT_AT(field)
#define RT_SETS_INTEGER(field, from, to)                                                                     \
    .form = RT_OPTION_INTEGER, RT_AT(field), .size = sizeof((Options *)0)->field, .low = (from), .high = (to)
#define RT_CALLS(function) .form = RT_OPTION_TAKE, .take = (function)

#define RT_VALUE(...)                                                                                        \
    { __VA_ARGS__ }
/* A value whose option leaves its name in `field`. */
#define RT_MARKING(field, ...) RT_VALUE(.mark = offsetof(Options, field), __VA_ARGS__)

#define RT_TO_FLAG(field)        RT_VALUE(RT_SETS_FLAG(field))
#define RT_TO_HIDDEN_FLAG(field) RT_VALUE(RT_SETS_FLAG(field), .flags = OPTION_HIDDEN)
#define RT_TO_TEXT(field)        RT_VALUE(.form = RT_OPTION_TEXT, RT_AT(field))
#define RT_TO_LIST(array, number)                                                                            \
    RT_VALUE(.form = RT_OPTION_LIST, RT_AT(array), .count = offsetof(Options, number),                       \
             .high = sizeof((Options *)0)->array / sizeof(char *))
#define RT_TO_INTEGER(field, from, to) RT_VALUE(RT_SETS_INTEGER(field, from, to))
#define RT_TO_SECONDS(field, from, to)                                                                       \
    RT_VALUE(.form = RT_OPTION_SECONDS, RT_AT(field), .low = (from), .high = (to))
#define RT_TO_PERCENT(field)    RT_VALUE(.form = RT_OPTION_PERCENT, RT_AT(field))
#define RT_TO_BYTES(field)      RT_VALUE(.form = RT_OPTION_BYTES, RT_AT(field))
#define RT_TO_SET(field, value) RT_VALUE(.form = RT_OPTION_SET, RT_AT(field), .low = (value))
#define RT_TO_SIZE(field)       RT_VALUE(.form = RT_OPTION_SIZE, RT_AT(field))
#define RT_TO_PIXEL(field)      RT_VALUE(RT_SETS_PIXEL(field))
#define RT_TO_PATH(field, ends) RT_VALUE(.form = RT_OPTION_PATH, RT_AT(field), .endings = (ends))
#define RT_TO_TAKE(function)    RT_VALUE(RT_CALLS(function))
/* `text` may be NULL. */
#define RT_TO_TAKE_OPTIONAL(function) RT_VALUE(RT_CALLS(function), .flags = OPTION_ARG_OPTIONAL)

/* An option that is no longer there. */
#define RT_GONE(name, use)                                                                                   \
    { name, 0, NULL, RT_VALUE(.form = RT_OPTION_GONE, .instead = (use), .flags = OPTION_HIDDEN), NULL }

typedef struct RtOption {
    const char *name;    /* NULL: `help` is the title of the options that follow */
    int letter;          /* of the short option, or 0 */
    const char *operand; /* what --help calls the value; NULL: it takes none */
    RtOptionValue value;
    const char *help;
} RtOption;

/* The arguments that are no options. */
typedef struct RtArgument {
    const char *name;    /* SCENE */
    const char *missing; /* what is said if there is none; NULL: there may be none */
    RtOptionValue value; /* of each; if it is a text, there is one at most */
} RtArgument;

#define RT_ARGUMENT(name, field, missing)                                                                    \
    { name, missing, RT_TO_TEXT(field) }
/* Members of the RtSyntax of a command that takes one SCENE. */
#define RT_ONE_SCENE                                                                                         \
    .arguments = "SCENE",                                                                                    \
    .argument =                                                                                              \
        RT_ARGUMENT("SCENE", scene, "a SCENE is missing: a file, or a built-in as `raytally scenes` lists")

typedef struct RtSyntax {
    const RtOption *options;      /* the last has no name and no help; NULL: none */
    const RtOption *shared;       /* options of several commands, or NULL */
    size_t shared_at;             /* offset of their own Options */
    int shared_group;             /* argp's, in --help */
    bool plugins;                 /* it takes --plugin */
    const char *arguments, *help; /* args_doc and doc of argp */
    RtArgument argument;
    void (*finish)(void *options, struct argp_state *state); /* checks all values together; or NULL */
} RtSyntax;

/* Fills `options`, a command's Options. Ends the process if the arguments are wrong, or ask for help. */
void rt_cli_parse(const RtSyntax *syntax, int argc, char **argv, void *options);

/* ---- commands ---- */

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

/* Prints the warnings of the scene's files to stderr. */
void rt_cli_tell_warnings(const RtScene *scene);

/* rt_scene_open, and rt_cli_tell_warnings. */
RtStatus rt_cli_open_scene(const char *spec, RtScene *scene, RtError *error);

/* Prints one JSON document to stdout, indented, and takes the reference. */
void rt_cli_print_json(json_t *document);

/* For parsers of options: the number in `text`, lo..hi; ends the process by argp_error if it is wrong.
 * `state` is argp's. */
int64_t rt_cli_integer(struct argp_state *state, const char *option, const char *text, int64_t lo,
                       int64_t hi);

/* For parsers of several numbers: reads the digits at *text, up to UINT32_MAX, and moves *text past them;
 * false if there are none, or the number is larger. */
bool rt_cli_digits(const char **text, uint32_t *number);

/* For tables of options: limits the memory and the time of this process. */
void rt_cli_take_memory(void *options, const char *text, struct argp_state *state);
void rt_cli_take_strict(void *options, const char *text, struct argp_state *state);
void rt_cli_take_time(void *options, const char *text, struct argp_state *state);

/* ---- options of several commands ---- */

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

/* Says to stderr which overlays of the accelerator pass on every ray, and why. */
void rt_cli_tell_idle(const char *spec, const RtAccel *accel);

/* Whether the build of specs[i] of [0..*count) was refused, and the command goes on with the others: says so,
 * and removes it. */
bool rt_cli_leave_out(RtStatus status, const char **specs, uint32_t *count, uint32_t i, const RtError *why);

#define RT_STRICT_OPTION                                                                                     \
    {                                                                                                        \
        "strict", 0, NULL, RT_TO_TAKE(rt_cli_take_strict),                                                   \
            "What is odd in the file of a scene is an error, not a warning"                                  \
    }
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
    "Threads, 0 for all processors. Default: time builds and rays on one thread, rays by processor time, "   \
    "and count on all. Times on several threads are wall times"

/* A vector as [x, y, z]. */
json_t *rt_cli_vector_json(RtVec3 v);

/* RT_BAD_INPUT if the pixel of --pixel is outside the image. */
RtStatus rt_cli_check_pixel(const RtSampling *sampling, RtPixel pixel, RtError *error);

#define RT_RAY_OPERAND "RAY"
#define RT_RAY_HELP                                                                                          \
    "OX,OY,OZ,DX,DY,DZ, origin and direction, and ,TMIN,TMAX if they are not 0,inf; or FILE.npy:N or "       \
    "FILE.csv:N, row N of rays as --rays-from takes them, the first is 0"

/* The ray of an option with this help; of kind random, as rays from files are. RT_BAD_INPUT if it is none. */
RtStatus rt_cli_ray(const char *text, RtRay *ray, RtError *error);

/* A kind of rays of images: primary, shadow, reflection or transmission. */
RtRayKind rt_cli_image_ray_kind(struct argp_state *state, const char *option, const char *text);

#define RT_CLI_PICTURES ".png, .svg or .pdf" /* the formats of pictures */
#define RT_CLI_ROWS     ".npy or .csv"       /* of rays and hits */

/* For parsers: stores `path` in *slot; ends the process by argp_error if it ends in none of `extensions`, or
 * if *slot is set. */
void rt_cli_set_path(struct argp_state *state, const char *option, const char **slot, const char *path,
                     const char *extensions);

/* ---- commands on result directories: `raytally COMMAND DIR` ---- */

#define RT_DIRECTORY_MISSING "a result DIR is missing, as in results/first-look"

/* What such a command does with the directory once its results are loaded; `options` are the command's. */
typedef RtStatus RtDirectoryWork(const char *directory, RtResults *results, const void *options,
                                 RtError *error);

/* Loads the directory and works on it. A command that writes into the directory locks it. */
RtStatus rt_cli_directory_work(const char *directory, bool writes, RtDirectoryWork *work, const void *options,
                               RtError *error);

/* ---- plugins: --plugin FILE, and $RAYTALLY_PLUGINS ---- */

/* The child parser of commands that take accelerators. */
extern const struct argp rt_plugin_argp;

/* Loads the plugins that the environment and these arguments name, before the arguments are parsed, since
 * they may name accelerators of plugins. */
RtStatus rt_cli_load_plugins(int argc, char *const *argv, RtError *error);

/* Appends " --plugin 'FILE'" for each given plugin to out[0..size), for commands shown to the user. */
void rt_cli_plugin_arguments(char *out, size_t size);

/* Says on stderr which accelerators of the experiment come from other plugins than in the manifest of
 * `directory`, or from none. */
void rt_cli_tell_plugins(const char *directory, const RtExperiment *experiment);

/* ---- progress on stderr, whenever something is finished: one line, redrawn in place, on a terminal; else at
 * most one per minute ---- */

/* The cells that are to be measured, and of them the finished ones. */
typedef struct RtCellCount {
    uint32_t cells, finished;
} RtCellCount;

/* Ignores kinds of rays that a recorded scene does not have, and cells that are left out. */
RtCellCount rt_count_cells(const RtResults *results, const RtWorkloadOptions *options);

typedef struct RtProgress {
    bool terminal, begun;
    RtWorkloadOptions options; /* the measurement */
    double start, shown;       /* wall seconds: at the start, and of the last line */
    double every;              /* seconds between lines, without a terminal */
    RtCellCount count;
    uint32_t before;               /* cells that were finished at the start */
    char title[RT_MAX_LABEL + 32]; /* before what is shown: which of several runs this is; or "" */
    char doing[2 * RT_MAX_LABEL + 64];
} RtProgress;

/* Becomes the observer of the measurement with these options. */
void rt_progress_begin(RtProgress *progress, RtWorkloadOptions *options);

/* Clears the line, if stderr is a terminal; at the end as `progress` has it. */
void rt_progress_clear(void);
void rt_progress_end(const RtProgress *progress);

/* Prints a message on a line of its own. `context` is not used. */
void rt_progress_notice(void *context, const char *message);

/* "3 h 20 min", "5 min", "40 s"; room for RT_MAX_DURATION. */
#define RT_MAX_DURATION 32
void rt_format_duration(double seconds, char out[RT_MAX_DURATION]);

#endif
