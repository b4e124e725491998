/* SPDX-License-Identifier: Apache-2.0 */
/* The command line: one file per command, each with its own argp parser (so `raytally COMMAND --help` teaches
 * it), and what they share. Only here is anything printed, and only main exits. */
#ifndef RT_CLI_CLI_H
#define RT_CLI_CLI_H

#include "core/base/param.h"
#include "core/base/ray.h"
#include "core/base/status.h"
#include "core/scene/camera.h"

#include <argp.h>
#include <jansson.h>
#include <stdbool.h>
#include <stdint.h>

enum { RT_EXIT_OK = 0, RT_EXIT_CHECK_FAILED = 1, RT_EXIT_BAD_INPUT = 2 };

typedef struct RtCommand {
    const char *name, *arguments, *summary;
    int (*run)(int argc, char **argv); /* argv[0] is "raytally NAME"; returns the exit code */
    const struct argp *argp;           /* its options; NULL: it has none but --help */
} RtCommand;

int rt_command_accels(int argc, char **argv);
int rt_command_scenes(int argc, char **argv);
int rt_command_info(int argc, char **argv);
int rt_command_render(int argc, char **argv);
int rt_command_trace(int argc, char **argv);
int rt_command_verify(int argc, char **argv);
int rt_command_bench(int argc, char **argv);
int rt_command_rays(int argc, char **argv);
int rt_command_compare(int argc, char **argv);
int rt_command_run(int argc, char **argv);
int rt_command_merge(int argc, char **argv);
int rt_command_plot(int argc, char **argv);
int rt_command_report(int argc, char **argv);
int rt_command_reproduce(int argc, char **argv);
int rt_command_convert(int argc, char **argv);
int rt_command_new_accel(int argc, char **argv);

extern const struct argp rt_accels_argp;
extern const struct argp rt_scenes_argp;
extern const struct argp rt_info_argp;
extern const struct argp rt_render_argp;
extern const struct argp rt_trace_argp;
extern const struct argp rt_verify_argp;
extern const struct argp rt_bench_argp;
extern const struct argp rt_rays_argp;
extern const struct argp rt_compare_argp;
extern const struct argp rt_plot_argp;
extern const struct argp rt_report_argp;
extern const struct argp rt_run_argp;
extern const struct argp rt_merge_argp;
extern const struct argp rt_convert_argp;
extern const struct argp rt_new_accel_argp;

/* Of the command that completes all others, whose table main has: its parser, whose input is a const char *,
 * the shell; and what it prints, a script for bash. */
extern const struct argp rt_completion_argp;
void rt_completion_print(const RtCommand *commands, int count);

/* Prints "raytally: MESSAGE" to stderr and gives the exit code that belongs to the status. */
int rt_cli_fail(const RtError *error);

/* RT_BAD_INPUT, and why, where `name`, of a file, cannot be in a JSON document since it is not UTF-8; to be
 * asked before there is one, for json_pack would only give NULL. */
RtStatus rt_cli_check_json_name(const char *name, RtError *error);

/* Prints one JSON document to stdout, indented, and takes the reference. */
void rt_cli_print_json(json_t *document);

/* A parameter table: two lines a parameter, or an array of objects. */
void rt_cli_print_params(const RtParam *table, size_t count);
json_t *rt_cli_params_json(const RtParam *table, size_t count);

/* For parsers of options: the number in `text`, lo..hi, or argp_error's exit with what would be right.
 * `state` is argp's. */
int64_t rt_cli_integer(struct argp_state *state, const char *option, const char *text, int64_t lo,
                       int64_t hi);

/* For parsers of what has several numbers: reads the digits at *text, up to UINT32_MAX, and goes on to what
 * follows them; false where there are none, or the number is larger. */
bool rt_cli_digits(const char **text, uint32_t *number);

/* A share such as "1%", more than 0 and at most 100 of a hundred, as a part: 0.01. */
double rt_cli_percent(struct argp_state *state, const char *option, const char *text);

/* Of the commands that time: rounds go on until intervals are narrow. */
#define RT_PATIENCE 60 /* seconds */
#define RT_UNTIL_OPTIONS(until, patience)                                                                    \
    {"until",                                                                                                \
     until,                                                                                                  \
     "P%",                                                                                                   \
     0,                                                                                                      \
     "Go on with rounds until the intervals of all ratios lie within P % of their medians, for 1000 rounds " \
     "or --patience seconds at most; where that was not enough a line says how narrow they are",             \
     0},                                                                                                     \
    {                                                                                                        \
        "patience", patience, "SECONDS", 0,                                                                  \
            "With --until: at most so long for a kind of rays on a scene (60)", 0                            \
    }

/* Of the commands that run gnuplot. */
#define RT_TRUST_OPTION(key)                                                                                 \
    {                                                                                                        \
        "trust", key, 0, 0,                                                                                  \
            "Also run gnuplot scripts from a result directory that raytally does not ship: they may run "    \
            "any "                                                                                           \
            "command, so read them first",                                                                   \
            0                                                                                                \
    }

/* Of the commands that list what there is: all of it, or one by name. The parser's input is an RtListOptions.
 */
typedef struct RtListOptions {
    const char *name; /* NULL: all */
    bool json;
} RtListOptions;

extern const struct argp_option rt_list_options[];
int rt_list_parse(int key, char *argument, struct argp_state *state);

/* "X,Y", of --pixel; RT_BAD_INPUT, once the image is known, if the pixel is not in it. */
void rt_cli_pixel(struct argp_state *state, const char *text, uint32_t *x, uint32_t *y);
RtStatus rt_cli_check_pixel(const RtSampling *sampling, uint32_t x, uint32_t y, RtError *error);

/* The name of a kind of rays that an image is made of: primary, shadow, reflection or transmission. */
RtRayKind rt_cli_image_ray_kind(struct argp_state *state, const char *option, const char *text);

#define RT_CLI_PICTURES ".png, .svg or .pdf" /* what pictures are drawn in */

/* Does the file name end in one of `extensions`, such as ".png, .svg or .pdf"? */
bool rt_cli_has_extension(const char *path, const char *extensions);

/* For parsers: stores `path` in *slot; exits by argp_error if it ends in none of `extensions`, or *slot is
 * taken. */
void rt_cli_set_path(struct argp_state *state, const char *option, const char **slot, const char *path,
                     const char *extensions);

/* "WxH" */
void rt_cli_size(struct argp_state *state, const char *text, uint32_t *width, uint32_t *height);

#endif
