/* SPDX-License-Identifier: Apache-2.0 */
/* The gnuplot scripts of an experiment: those that raytally ships, found in its folder
 * share/raytally/experiments, and those beside the experiment, which are copied into its result directory.
 *
 * gnuplot has no sandbox: a script may run any command. So raytally only runs scripts that it ships, and
 * those beside an experiment that the user runs, but not those of somebody else's result directory. */
#ifndef RT_EXPERIMENT_SCRIPTS_H
#define RT_EXPERIMENT_SCRIPTS_H

#include "experiment/experiment.h"

/* Which gnuplot scripts may run. */
typedef enum RtScripts {
    RT_SCRIPTS_SHIPPED, /* those that raytally ships */
    RT_SCRIPTS_OWN,     /* also those beside the experiment */
    RT_SCRIPTS_ALL      /* also any in the result directory, in place of shipped ones of the same name */
} RtScripts;

/* The folder of the shipped scripts and experiments, beside the program or beside its folder;
 * RT_NOT_AVAILABLE if there is none. */
RtStatus rt_scripts_folder(char folder[RT_MAX_PATH], RtError *error);

/* The shipped script of that name, in that folder or in one of its folders; false if there is none. */
bool rt_scripts_shipped(const char *name, char path[RT_MAX_PATH]);

/* Rejects a script that is neither beside the experiment nor shipped. */
RtStatus rt_scripts_find(const RtExperiment *experiment, RtError *error);

/* Rejects, before gnuplot starts, anything that `allowed` excludes: a script of the experiment that is
 * neither shipped nor, with RT_SCRIPTS_OWN, the one beside the experiment; and symbolic links in
 * `directory`/plots, which gnuplot would write through. `keep`: run the copies in `directory`/plots;
 * otherwise those beside the experiment replace them. */
RtStatus rt_scripts_check(const RtExperiment *experiment, const char *directory, bool keep, RtScripts allowed,
                          RtError *error);

/* Adds copies of the scripts beside the experiment, unless they are shipped, to `directory`/plots, which
 * exists, each under its rt_plot_name. `keep`: without those that exist, which may have been edited. */
RtStatus rt_scripts_copy(const RtExperiment *experiment, const char *directory, bool keep, RtOutputs *copies,
                         RtError *error);

/* The script to draw with, which rt_scripts_check allowed, seen from `directory`: the copy in its plots, or
 * the shipped one. */
void rt_scripts_path(const RtExperiment *experiment, uint32_t plot, const char *directory, RtScripts allowed,
                     char path[RT_MAX_PATH]);

/* Adds to the experiment's plots the scripts in DIR/plots that it does not name, except those that raytally
 * ships or that version 1.0 wrote: a script may be added to results later. */
RtStatus rt_scripts_add_found(RtExperiment *experiment, const char *directory, RtError *error);

#endif
