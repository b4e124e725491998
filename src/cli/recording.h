/* SPDX-License-Identifier: Apache-2.0 */
/* Options of commands that record rays: which, how many, of what frame. A child parser of argp. */
#ifndef RT_CLI_RECORDING_H
#define RT_CLI_RECORDING_H

#include "experiment/experiment.h"

#include <argp.h>

/* The input of the parser. */
typedef struct RtRecordingOptions {
    RtExperiment *experiment; /* owned: to be filled; its scenes are left to be added */
    RtWorkload like;          /* for all that the scene stands for (rt_experiment_add_scenes) */
    bool one_kind;            /* one kind of rays, primary ones unless another is asked for */
    const char *kinds;        /* as given, or NULL */
    const char *frame;        /* an option that was given and is about recorded rays alone, or NULL */
} RtRecordingOptions;

extern const struct argp rt_recording_argp;

/* Makes its experiment, without scenes, and `like`, with what `bench` measures. RT_NO_MEMORY. */
RtStatus rt_recording_init(RtRecordingOptions *o, RtError *error);
void rt_recording_clear(RtRecordingOptions *o);

/* To be called at ARGP_KEY_END of the parent: the kinds of rays mean something else where rays are of a file.
 */
void rt_recording_finish(const RtRecordingOptions *o, struct argp_state *state);

/* Adds an accelerator as --accel takes it, or for `all` every one; argp_error's exit where it does not fit.
 */
void rt_cli_add_accels(RtExperiment *experiment, const char *text, struct argp_state *state);

#endif
