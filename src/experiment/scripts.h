/* SPDX-License-Identifier: Apache-2.0 */
/* The gnuplot scripts of an experiment: copied from the folder of its YAML into a result directory, and run
 * if they are trusted.
 *
 * gnuplot has no sandbox: a script may run any command. So raytally only runs scripts that it ships
 * (experiments/NAME.gp, compared by their bytes), and those beside an experiment that the user runs, but not
 * those of somebody else's result directory. */
#ifndef RT_EXPERIMENT_SCRIPTS_H
#define RT_EXPERIMENT_SCRIPTS_H

#include "core/base/file.h"
#include "experiment/experiment.h"

/* Which gnuplot scripts may run. */
typedef enum RtScripts {
    RT_SCRIPTS_SHIPPED, /* those that raytally ships */
    RT_SCRIPTS_OWN,     /* also those beside the experiment */
    RT_SCRIPTS_ALL
} RtScripts;

/* Rejects a script that cannot be read. */
RtStatus rt_scripts_find(const RtExperiment *experiment, RtError *error);

/* Rejects, before gnuplot starts, anything that `allowed` excludes: a script of the experiment that is
 * neither shipped nor, with RT_SCRIPTS_OWN, the one beside the experiment; such a plots/style.gp, which
 * shipped scripts load; and symbolic links in `directory`/plots, which gnuplot would write through. `keep`:
 * run the scripts in `directory`/plots; otherwise those beside the experiment replace them. */
RtStatus rt_scripts_check(const RtExperiment *experiment, const char *directory, bool keep, RtScripts allowed,
                          RtError *error);

/* Adds copies of the scripts, relative to the experiment's folder, to `directory`/plots, which exists, each
 * under its rt_plot_name. `keep`: without those that exist, which may have been edited. */
RtStatus rt_scripts_copy(const RtExperiment *experiment, const char *directory, bool keep, RtOutputs *copies,
                         RtError *error);

/* Adds to the experiment's plots the scripts in DIR/plots that it does not name, except those that raytally
 * writes: a script may be added to results later. */
RtStatus rt_scripts_add_found(RtExperiment *experiment, const char *directory, RtError *error);

#endif
