/* SPDX-License-Identifier: Apache-2.0 */
/* Options of commands that record rays: which, how many, of what frame. */
#ifndef RT_CLI_RECORDING_H
#define RT_CLI_RECORDING_H

#include "cli/options.h"
#include "experiment/experiment.h"

typedef struct RtRecordingOptions {
    RtExperiment *experiment;           /* the one of the process; the caller adds its scenes */
    RtWorkload like;                    /* for rt_experiment_add_scenes */
    uint64_t limit, coherent_run, seed; /* of the experiment */
    bool one_kind;                      /* only one kind of rays, by default primary */
    const char *kinds;                  /* as given, or NULL */
    const char *frame;                  /* name of the last given option that needs recorded rays, or NULL */
} RtRecordingOptions;

extern const RtOption rt_recording_options[];

/* Sets the defaults of an experiment; no scenes. Call it once in a process. */
void rt_recording_init(RtRecordingOptions *o);

/* Fills in the experiment. The command's `finish` calls this: the kinds of rays depend on --rays-from. */
void rt_recording_finish(const RtRecordingOptions *o, struct argp_state *state);

/* For parsers of --callgrind[=N]: the rays of a kind. */
uint64_t rt_cli_callgrind(const char *text, struct argp_state *state);

/* Adds the accelerators of --accel, or every one for `all`; ends the process by argp_error if there is an
 * error. */
void rt_cli_add_accels(RtExperiment *experiment, const char *text, struct argp_state *state);

#endif
