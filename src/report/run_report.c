/* SPDX-License-Identifier: Apache-2.0 */
#include "report/report.h"

#include "report/plot.h"

RtStatus rt_run_report(const RtResults *results, const char *directory, RtScripts scripts,
                       const RtRunObserver *observer, RtError *error) {
    /* The report is written even if drawing failed. */
    RtError drawing = {RT_OK, ""};
    const RtStatus drawn = rt_plots_draw(results, directory, scripts, false, &drawing);
    RT_TRY(rt_report_write(results, directory, error));
    if (drawn == RT_NOT_AVAILABLE) rt_notify(observer, "%s", drawing.message);
    if (drawn == RT_OK || drawn == RT_NOT_AVAILABLE) return RT_OK;
    if (error) *error = drawing;
    return drawn;
}
