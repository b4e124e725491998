/* raytally: the list of commands, and what they share. */
#include "cli/cli.h"

#include <argp.h>
#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/param.h"
#include "scene/camera.h"

static const RtCommand commands[] = {
    {"accels", "[NAME]", "list the accelerators, their parameters, defaults, ranges and papers",
     rt_command_accels},
    {"scenes", "", "list the built-in scenes and their parameters", rt_command_scenes},
    {"info", "SCENE", "objects by shape, bounds, materials, lights, camera of a scene", rt_command_info},
    {"render", "SCENE", "an image of a scene, heatmaps of its cost, a picture of the structure",
     rt_command_render},
    {"verify", "[SCENE...]", "check that accelerators answer every ray like brute", rt_command_verify},
    {"bench", "SCENE", "count and time accelerators on the rays of one scene", rt_command_bench},
    {"run", "EXPERIMENT", "run an experiment: CSV files, plots, report", rt_command_run},
    {"plot", "DIR", "draw the plots of a result directory again", rt_command_plot},
    {"report", "DIR", "write the report of a result directory again", rt_command_report},
    {"reproduce", "DIR", "count again, and compare with DIR/counts.csv byte for byte", rt_command_reproduce},
    {"convert", "IN OUT", "write a scene in another format", rt_command_convert},
};

enum { COMMAND_COUNT = sizeof commands / sizeof commands[0] };

static void print_usage(FILE *to) {
    fprintf(to, "raytally " RT_VERSION ": a testbed for ray-tracing acceleration structures\n\n"
                "Usage: raytally COMMAND [ARGUMENT...]\n\nCommands:\n");
    for (int i = 0; i < COMMAND_COUNT; i++) {
        fprintf(to, "  %-9s %-14s %s\n", commands[i].name, commands[i].arguments, commands[i].summary);
    }
    fprintf(to, "\n`raytally COMMAND --help` explains a command. To begin with:\n"
                "  raytally accels                          what there is to compare\n"
                "  raytally render balls -o balls.png       a picture\n"
                "  raytally bench balls --accel bvh --accel grid   a comparison\n"
                "Exit codes: 0 fine, 1 a check failed, 2 bad usage or bad input.\n");
}

static int run_unknown(const char *name) {
    const char *names[COMMAND_COUNT];
    for (int i = 0; i < COMMAND_COUNT; i++) names[i] = commands[i].name;
    const char *near = rt_nearest_name(name, names, COMMAND_COUNT);
    fprintf(stderr, "raytally: there is no command '%s'", name);
    if (near) fprintf(stderr, ": did you mean '%s'?", near);
    fprintf(stderr, "\n`raytally --help` lists the commands.\n");
    return RT_EXIT_BAD_INPUT;
}

int main(int argc, char **argv) {
    argp_err_exit_status = RT_EXIT_BAD_INPUT;
    if (argc < 2) {
        print_usage(stderr);
        return RT_EXIT_BAD_INPUT;
    }
    const char *name = argv[1];
    if (strcmp(name, "--help") == 0 || strcmp(name, "-h") == 0 || strcmp(name, "help") == 0) {
        print_usage(stdout);
        return RT_EXIT_OK;
    }
    if (strcmp(name, "--version") == 0) {
        puts("raytally " RT_VERSION);
        return RT_EXIT_OK;
    }
    for (int i = 0; i < COMMAND_COUNT; i++) {
        if (strcmp(commands[i].name, name) != 0) continue;
        char title[64];
        snprintf(title, sizeof title, "raytally %s", name);
        argv[1] = title;
        return commands[i].run(argc - 1, argv + 1);
    }
    return run_unknown(name);
}

/* ---- shared by the commands ---- */

int rt_cli_fail(const RtError *error) {
    fprintf(stderr, "raytally: %s\n", error->message);
    return error->status == RT_MISMATCH ? RT_EXIT_CHECK_FAILED : RT_EXIT_BAD_INPUT;
}

void rt_cli_print_json(json_t *document) {
    json_dumpf(document, stdout, JSON_INDENT(2) | JSON_REAL_PRECISION(9));
    putchar('\n');
    json_decref(document);
}

int64_t rt_cli_integer(struct argp_state *state, const char *option, const char *text, int64_t lo,
                       int64_t hi) {
    char *end;
    errno = 0;
    long long value = strtoll(text, &end, 10);
    if (end == text || *end || errno || value < lo || value > hi) {
        argp_error(state, "%s: '%s' will not do: it must be a whole number %lld..%lld", option, text,
                   (long long)lo, (long long)hi);
    }
    return value;
}

void rt_cli_size(struct argp_state *state, const char *text, uint32_t *width, uint32_t *height) {
    if (rt_image_size_parse(text, width, height)) return;
    argp_error(state, "--size: '%s' will not do: it must be WIDTHxHEIGHT, each 1..%d, as in 640x480", text,
               RT_MAX_IMAGE_SIDE);
}
