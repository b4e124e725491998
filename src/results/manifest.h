/* SPDX-License-Identifier: Apache-2.0 */
/* The manifest of a result: the experiment, and the machine and build that ran it. */
#ifndef RT_RESULTS_MANIFEST_H
#define RT_RESULTS_MANIFEST_H

#include "results/results.h"

#include <jansson.h>

/* Writes `directory`/manifest.json, dated now. `counting`, `timing`: threads; 0 = all processors. */
RtStatus rt_manifest_write(const RtResults *results, int counting, int timing, const char *directory,
                           RtError *error);

/* Sets the claims in the manifest of a finished run: `claims`, with which it began, and `claims_changed`,
 * those of now, if they are others. */
RtStatus rt_manifest_set_claims(const RtResults *results, const char *directory, RtError *error);

/* Reads it back; the caller owns the reference. */
RtStatus rt_manifest_read(const char *directory, json_t **manifest, RtError *error);

/* Loads the experiment of the manifest in `directory`, in the same variant, from the file that it names,
 * relative to the current folder. If there is none, and the directory may have been sent elsewhere, from the
 * copy in it. Scenes are relative to the file that is loaded. RT_MISMATCH if it has changed. */
RtStatus rt_manifest_experiment(const char *directory, bool elsewhere, RtExperiment *experiment,
                                RtError *error);

#endif
