/* SPDX-License-Identifier: Apache-2.0 */
/* raytally report: the report of a result directory, written again. */
#include "bench/manifest.h"
#include "cli/cli.h"
#include "cli/directory.h"
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

int rt_command_report(int argc, char **argv) {
    return rt_cli_directory(argc, argv, "Write DIR/report.html again, from what is in DIR.", true, report);
}
