/* SPDX-License-Identifier: Apache-2.0 */
/* raytally: the list of commands. */
#include "accel/isa.h"
#include "accel/plugin.h"
#include "cli/cli.h"
#include "cli/jobs.h"
#include "core/base/memory.h"
#include "core/base/versions.h"
#include "core/base/words.h"
#include "core/text/json.h"
#include "measure/machine.h"
#include <raytally/accel.h>
#include <raytally/raytally.h>

#include <stdio.h>
#include <string.h>

static const RtCommand commands[] = {
#define COMMAND(id, name, arguments, summary) {name, arguments, summary, rt_command_##id, &rt_##id##_syntax},
    RT_COMMANDS(COMMAND)
#undef COMMAND
};

enum { COMMAND_COUNT = sizeof commands / sizeof commands[0] };

static void print_usage(FILE *to) {
    fprintf(to, "raytally " RT_VERSION ": a testbed for ray-tracing acceleration structures\n\n"
                "Usage: raytally COMMAND [ARGUMENT...]\n\nCommands:\n");
    for (int i = 0; i < COMMAND_COUNT; i++) {
        char usage[32];
        snprintf(usage, sizeof usage, "%s %s", commands[i].name, commands[i].arguments);
        fprintf(to, "  %-21s %s\n", usage, commands[i].summary);
    }
    fprintf(to, "\n`raytally COMMAND --help` or `raytally help COMMAND` explains a command.\nFirst steps:\n"
                "  raytally accels                          list the accelerators\n"
                "  raytally render balls -o balls.png       a picture\n"
                "  raytally bench balls --accel bvh --accel grid   a comparison\n"
                "Exit codes: 0 success, 1 a check failed, 2 bad usage or bad input.\n");
}

/* What is built, what of it runs here, and the numbers of docs/interface.md. */
static void print_version(void) {
    json_auto_t *machine = rt_machine_json();
    char libraries[256] = "";
    rt_machine_libraries(machine, " ", libraries, sizeof libraries);
    printf("raytally " RT_VERSION
           "\ncommit: %s%s\ncompiler: %s\naccelerator libraries:%s\nkernels that run here:",
           rt_json_text(machine, "commit", "unknown"),
           json_is_true(json_object_get(machine, "dirty")) ? ", with changes" : "",
           rt_json_text(machine, "compiler", "unknown"), *libraries ? libraries : " none");
    for (int isa = RT_ISA_PORTABLE; isa <= RT_ISA_AVX512; isa++) {
        if (rt_isa_runs((RtIsa)isa)) printf(" %s", rt_isa_name((RtIsa)isa));
    }
    printf("\ninterface: %d, of plugins: %d\nfile format: %d\ncounts: %d\n", RAYTALLY_ABI_VERSION,
           RAYTALLY_ACCEL_ABI, RT_FILE_FORMAT, RT_COUNTS_VERSION);
}

/* NULL, and a message, if there is none. */
static const RtCommand *find_command(const char *name) {
    const char *names[COMMAND_COUNT];
    for (int i = 0; i < COMMAND_COUNT; i++) {
        names[i] = commands[i].name;
        if (strcmp(names[i], name) == 0) return &commands[i];
    }
    char suggestion[RT_MAX_SUGGESTION];
    rt_suggest(name, names, COMMAND_COUNT, suggestion);
    fprintf(stderr, "raytally: there is no command '%s'%s\n`raytally --help` lists the commands.\n", name,
            suggestion);
    return NULL;
}

/* Prints the message, and returns the exit code. */
static int fail(const RtError *error) {
    if (*error->message) fprintf(stderr, "raytally: %s\n", error->message);
    bool failed = error->status == RT_MISMATCH || error->status == RT_BROKEN;
    return failed ? RT_EXIT_CHECK_FAILED : RT_EXIT_BAD_INPUT;
}

/* argv[0] is the command's name. */
static int run_command(int argc, char **argv) {
    const RtCommand *command = find_command(argv[0]);
    if (!command) return RT_EXIT_BAD_INPUT;
    char title[64];
    snprintf(title, sizeof title, "raytally %s", command->name);
    argv[0] = title;
    RtError error;
    RtStatus status = command->syntax->plugins ? rt_cli_load_plugins(argc, argv, &error) : RT_OK;
    if (status == RT_OK) status = command->run(argc, argv, &error);
    if (status == RT_OK) status = rt_json_check_memory("the results", &error);
    status = rt_memory_unlimit_process(status, &error);
    int code = status == RT_OK ? RT_EXIT_OK : fail(&error);
    if (rt_remote_exit_message()) {
        fprintf(stderr, "raytally: %s\n", rt_remote_exit_message());
        if (code == RT_EXIT_OK) code = RT_EXIT_CHECK_FAILED;
    }
    for (size_t i = 0; rt_remote_notice(i); i++) fprintf(stderr, "raytally: %s\n", rt_remote_notice(i));
    if (fflush(stdout) == 0 && !ferror(stdout)) return code;
    fprintf(stderr, "raytally: writing to standard output failed: is the disk full?\n");
    return RT_EXIT_BAD_INPUT;
}

int main(int argc, char **argv) {
    argp_err_exit_status = RT_EXIT_BAD_INPUT;
    rt_stop_init();
    rt_json_watch_memory();
    /* The system grants more, and ends the process when that is used. */
    rt_memory_limit_process(rt_memory_size());
    if (argc < 2) {
        print_usage(stderr);
        return RT_EXIT_BAD_INPUT;
    }
    const char *name = argv[1];
    bool help = strcmp(name, "--help") == 0 || strcmp(name, "-h") == 0 || strcmp(name, "help") == 0;
    if (help && argc > 2) {
        char option[] = "--help", *asked[] = {argv[2], option, NULL};
        return run_command(2, asked);
    }
    if (help) {
        print_usage(stdout);
        return RT_EXIT_OK;
    }
    if (strcmp(name, "--version") == 0) {
        print_version();
        return RT_EXIT_OK;
    }
    return run_command(argc - 1, argv + 1);
}
