/* SPDX-License-Identifier: Apache-2.0 */
/* raytally report: writes the report of a result directory again, or the index of several. */
#include "claims/claims.h"
#include "cli/cli.h"
#include "cli/directory.h"
#include "core/base/words.h"
#include "report/report.h"

#include <stdio.h>

static RtStatus report(const char *directory, RtResults *results, const void *options, RtError *error) {
    (void)options;
    RT_TRY(rt_report_write(results, directory, error));
    rt_claims_print(results, stdout);
    printf("%sReport: %s/report.html\n", results->experiment->claim_count ? "\n" : "", directory);
    return RT_OK;
}

typedef struct Options {
    const char *directory, *folder;
} Options;

static RtStatus write_index(const char *folder, RtError *error) {
    size_t count;
    RT_TRY(rt_index_write(folder, &count, error));
    printf("Index: %s/index.html and index.md, of %zu experiment%s\n", folder, count, rt_plural(count));
    return RT_OK;
}

static void take_index(void *options, const char *text, struct argp_state *state) {
    Options *o = options;
    if (o->folder) argp_error(state, "one FOLDER at a time; '%s' is a second one", text);
    o->folder = text;
}

static void finish(void *options, struct argp_state *state) {
    const Options *o = options;
    if (o->folder && o->directory)
        argp_error(state, "--index FOLDER covers all directories in FOLDER, and takes no DIR");
    if (!o->folder && !o->directory) argp_error(state, RT_DIRECTORY_MISSING);
}

static const RtOption options[] = {
    {"index", 'i', "FOLDER", RT_TO_TAKE(take_index),
     "Write FOLDER/index.html and FOLDER/index.md, which list all result directories in FOLDER, as in "
     "`--index results`"},
    {0}};
const RtSyntax rt_report_syntax = {
    .options = options,
    .plugins = true,
    .arguments = "DIR\n--index FOLDER",
    .argument = RT_ARGUMENT("DIR", directory, NULL),
    .finish = finish,
    .help = "Rewrite DIR/report.html, tables.md and tables.tex from the results in DIR.\n"
            "With --index, write FOLDER/index.html and (for GitHub) FOLDER/index.md, which list all result "
            "directories in FOLDER and its subfolders by the `section` of their experiments."};

RtStatus rt_command_report(int argc, char **argv, RtError *error) {
    Options o = {0};
    rt_cli_parse(&rt_report_syntax, argc, argv, &o);
    if (o.folder) return write_index(o.folder, error);
    return rt_cli_directory_work(o.directory, true, report, &o, error);
}
