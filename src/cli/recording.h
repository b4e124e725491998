/* SPDX-License-Identifier: Apache-2.0 */
/* Options of commands that record rays: which, how many, of what frame. */
#ifndef RT_CLI_RECORDING_H
#define RT_CLI_RECORDING_H

#include "cli/cli.h"
#include "experiment/experiment.h"

typedef struct RtRecordingOptions {
    RtExperiment *experiment;           /* the one of the process; the caller adds its scenes */
    RtWorkload like;                    /* for rt_experiment_add_scenes */
    uint64_t limit, coherent_run, seed; /* of the experiment */
    bool one_kind;                      /* only one kind of rays, by default primary */
    const char *kinds;                  /* as given, or NULL */
    const char *frame;                  /* name of the last given option that needs recorded rays, or NULL */
    uint64_t callgrind;                 /* rays of a kind at most, of --callgrind; 0: it is not asked for */
} RtRecordingOptions;

extern const RtOption rt_recording_options[];

/* Sets the defaults of an experiment; no scenes. Call it once in a process. */
void rt_recording_init(RtRecordingOptions *o);

/* Fills in the experiment. The command's `finish` calls this: the kinds of rays depend on --rays-from. */
void rt_recording_finish(const RtRecordingOptions *o, struct argp_state *state);

/* For tables of options, of commands whose options begin with RtRecordingOptions: --callgrind[=N]; and
 * --accel, which adds accelerators, every one for `all`. */
void rt_recording_take_callgrind(void *options, const char *text, struct argp_state *state);
void rt_recording_take_accel(void *options, const char *text, struct argp_state *state);

/* Adds one accelerator, or each of a sweep; ends the process by argp_error if there is an error. */
void rt_recording_add_accel(RtExperiment *experiment, const char *text, struct argp_state *state);

#endif
