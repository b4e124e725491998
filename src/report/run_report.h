/* SPDX-License-Identifier: Apache-2.0 */
/* What a finished run leaves besides its measurements: comparisons with published figures, plots, the report.
 */
#ifndef RT_REPORT_RUN_REPORT_H
#define RT_REPORT_RUN_REPORT_H

#include "experiment/result_directory.h"

/* Without gnuplot there is a notice, and a report without plots. RT_MISMATCH, with everything written, if
 * gnuplot fails, or if rt_published_check fails. */
extern const RtRunReport rt_run_report;

#endif
