/* SPDX-License-Identifier: Apache-2.0 */
#include "report/report.h"

#include "literature/published_tables.h"
#include "report/plot.h"

static RtStatus check(const RtExperiment *experiment, RtError *error) {
    RtPublished published;
    RtStatus status = rt_published_load(&published, experiment, error);
    rt_published_clear(&published);
    return status;
}

static RtStatus write_parts(const RtResults *results, const RtPublished *published, const char *directory,
                            const RtRunObserver *observer, RtError *error) {
    RT_TRY(rt_published_files_write(published, directory, error));
    /* The report is written even if drawing failed. */
    RtError drawing = {RT_OK, ""};
    RtStatus drawn = rt_plots_draw(results, directory, false, &drawing);
    RT_TRY(rt_report_write(results, published, directory, error));
    RtStatus checked = rt_published_check(published, error);
    if (drawn == RT_OK) return checked;
    if (drawn == RT_NOT_AVAILABLE || checked != RT_OK) {
        rt_notify(observer, "%s", drawing.message);
        return checked;
    }
    if (error) *error = drawing;
    return drawn;
}

static RtStatus write_all(const RtResults *results, const char *directory, const RtRunObserver *observer,
                          RtError *error) {
    RtPublished published;
    RtStatus status = rt_published_load(&published, results->experiment, error);
    if (status == RT_OK) {
        rt_published_compare(&published, results);
        status = write_parts(results, &published, directory, observer, error);
    }
    rt_published_clear(&published);
    return status;
}

const RtRunReport rt_run_report = {check, write_all};
