/* SPDX-License-Identifier: Apache-2.0 */
/* raytally report: the report of a result directory, written again; the page over all of them. */
#include "cli/cli.h"
#include "cli/directory.h"
#include "cli/plugins.h"
#include "core/base/words.h"
#include "experiment/manifest.h"
#include "report/index.h"
#include "report/report.h"

#include <stdio.h>

static RtStatus report(const char *directory, const RtExperiment *experiment, RtResults *results,
                       RtError *error) {
    json_t *manifest;
    RtPublished published;
    RT_TRY(rt_manifest_read(directory, &manifest, error));
    RtStatus status = rt_published_load(&published, experiment, error);
    if (status == RT_OK) {
        rt_published_compare(&published, results);
        status = rt_report_write(results, &published, manifest, directory, error);
    }
    rt_published_clear(&published);
    json_decref(manifest);
    if (status == RT_OK) printf("Report: %s/report.html\n", directory);
    return status;
}

static const char help[] =
    "Write DIR/report.html again, from what is in DIR, and tables.md and tables.tex beside it.\n"
    "--index: FOLDER/index.html, a page over all result directories in FOLDER and in folders of it.";

static error_t parse_option(int key, char *argument, struct argp_state *state) {
    const char **folder = state->input;
    switch (key) {
    case 'i':
        if (*folder) argp_error(state, "one FOLDER at a time; '%s' is a second one", argument);
        *folder = argument;
        return 0;
    case ARGP_KEY_END:
        if (*folder && state->arg_num > 0)
            argp_error(state, "--index is about all of FOLDER, and takes no DIR");
        return 0;
    case ARGP_KEY_ARG: return 0; /* for rt_cli_directory */
    default: return ARGP_ERR_UNKNOWN;
    }
}

static int write_index(const char *folder) {
    RtError error;
    size_t count;
    if (rt_index_write(folder, &count, &error) != RT_OK) return rt_cli_fail(&error);
    printf("Index: %s/index.html, of %zu experiment%s\n", folder, count, rt_plural(count));
    return RT_EXIT_OK;
}

static const struct argp_option options[] = {
    {"index", 'i', "FOLDER", 0,
     "Write FOLDER/index.html over all result directories in it, as in `--index results`", 0},
    {0}};
static const struct argp_child children[] = {{&rt_plugin_argp, 0, NULL, 0}, {0}};
const struct argp rt_report_argp = {.options = options,
                                    .parser = parse_option,
                                    .args_doc = "DIR\n--index FOLDER",
                                    .doc = help,
                                    .children = children};

int rt_command_report(int argc, char **argv) {
    const char *folder = NULL;
    argp_parse(&rt_report_argp, argc, argv, 0, 0, &folder);
    return folder ? write_index(folder) : rt_cli_directory(argc, argv, help, true, report);
}
