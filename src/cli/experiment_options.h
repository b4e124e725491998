/* SPDX-License-Identifier: Apache-2.0 */
/* Options of commands that measure a scene as an experiment without a file: which rays, how many, of what
 * frame, by which accelerators. */
#ifndef RT_CLI_EXPERIMENT_OPTIONS_H
#define RT_CLI_EXPERIMENT_OPTIONS_H

#include "cli/cli.h"

typedef struct RtExperimentOptions {
    RtExperiment experiment; /* megabytes; the caller adds its scenes, which are ... */
    RtWorkload like;         /* ... like this one */
    bool one_kind;           /* only one kind of rays, by default primary */
    const char *kinds;       /* as given, or NULL */
    const char *frame;       /* name of the last given option that needs recorded rays, or NULL */
    uint64_t callgrind;      /* rays of a kind at most, of --callgrind; 0: it is not asked for */
} RtExperimentOptions;

extern const RtOption rt_experiment_options[];

/* Sets the defaults of an experiment; no scenes. */
void rt_experiment_options_init(RtExperimentOptions *o);

/* Sets the kinds of rays, which depend on --rays-from. The command's `finish` calls this. */
void rt_experiment_options_finish(RtExperimentOptions *o, struct argp_state *state);

/* For tables of options, of commands whose options begin with RtExperimentOptions: --callgrind[=N]; and
 * --accel, which adds accelerators, every one for `all`. */
void rt_take_callgrind(void *options, const char *text, struct argp_state *state);
void rt_take_accel(void *options, const char *text, struct argp_state *state);

/* Adds one accelerator, or each of a sweep; ends the process by argp_error if there is an error. */
void rt_add_accel(RtExperiment *experiment, const char *text, struct argp_state *state);

#endif
