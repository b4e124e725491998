/* SPDX-License-Identifier: Apache-2.0 */
#include "cli/directory.h"

#include "cli/cli.h"
#include "cli/plugins.h"
#include "core/base/lock.h"
#include "core/base/memory.h"

#include <argp.h>

static error_t parse_option(int key, char *argument, struct argp_state *state) {
    const char **directory = state->input;
    switch (key) {
    case ARGP_KEY_ARG:
        if (*directory) argp_error(state, "one DIR at a time; '%s' is a second one", argument);
        *directory = argument;
        return 0;
    case ARGP_KEY_END:
        if (!*directory) argp_error(state, "a result DIR is missing, as in results/first-look");
        return 0;
    default: return ARGP_ERR_UNKNOWN;
    }
}

static const struct argp_child children[] = {{&rt_plugin_argp, 0, NULL, 0}, {0}};
const struct argp rt_directory_argp = {.parser = parse_option, .args_doc = "DIR", .children = children};

int rt_cli_directory(int argc, char **argv, const char *help, bool writes, RtDirectoryWork *work) {
    const char *directory = NULL;
    struct argp argp = rt_directory_argp;
    argp.doc = help;
    argp_parse(&argp, argc, argv, 0, 0, &directory);
    return rt_cli_directory_work(directory, writes, work);
}

int rt_cli_directory_work(const char *directory, bool writes, RtDirectoryWork *work) {
    RtError error;
    RtLock lock = RT_NO_LOCK;
    RtResults results = {0};
    RtExperiment *experiment = rt_alloc(1, sizeof *experiment);
    RtStatus status = experiment ? RT_OK : rt_fail_memory(&error, "an experiment", sizeof *experiment);
    if (status == RT_OK && writes) status = rt_lock_take(&lock, directory, &error);
    if (status == RT_OK) status = rt_run_load(directory, experiment, &results, &error);
    if (status == RT_OK) status = work(directory, experiment, &results, &error);
    rt_lock_release(&lock);
    rt_results_clear(&results);
    rt_free(experiment);
    return status == RT_OK ? RT_EXIT_OK : rt_cli_fail(&error);
}
