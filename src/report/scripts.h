/* SPDX-License-Identifier: Apache-2.0 */
/* The gnuplot scripts of an experiment: from the folder of its YAML into a result directory, and which of
 * them are run.
 *
 * gnuplot has no sandbox: a script may run any command. So a result directory that somebody else made does
 * not choose what is run: scripts run that raytally ships (experiments/NAME.gp, by their bytes), and those
 * beside an experiment that the user runs. */
#ifndef RT_REPORT_SCRIPTS_H
#define RT_REPORT_SCRIPTS_H

#include "core/base/file.h"
#include "experiment/experiment.h"

/* Which gnuplot scripts are run. */
typedef enum RtScripts {
    RT_SCRIPTS_SHIPPED, /* those that raytally ships */
    RT_SCRIPTS_OWN,     /* also those beside the experiment */
    RT_SCRIPTS_ALL
} RtScripts;

/* Refuses a script that cannot be read. */
RtStatus rt_scripts_find(const RtExperiment *experiment, RtError *error);

/* Refuses, before gnuplot is started, what `allowed` leaves out: a script that the experiment names and that
 * is neither shipped nor, with RT_SCRIPTS_OWN, the one beside the experiment; a plots/style.gp of that kind,
 * which shipped scripts load; and symbolic links in `directory`/plots, which gnuplot would write through.
 * `keep`: scripts that are in `directory`/plots are run as they are; otherwise those beside the experiment
 * take their place. */
RtStatus rt_scripts_check(const RtExperiment *experiment, const char *directory, bool keep, RtScripts allowed,
                          RtError *error);

/* Adds copies of the scripts from where they lie, seen from the experiment's folder, to `directory`/plots,
 * which exists, each under its rt_plot_name; `keep`: but for those that are there, which may have been
 * edited. */
RtStatus rt_scripts_copy(const RtExperiment *experiment, const char *directory, bool keep, RtOutputs *copies,
                         RtError *error);

#endif
