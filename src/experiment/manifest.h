/* SPDX-License-Identifier: Apache-2.0 */
/* The manifest of a result: the experiment, and the machine and build that ran it. */
#ifndef RT_EXPERIMENT_MANIFEST_H
#define RT_EXPERIMENT_MANIFEST_H

#include "experiment/workload.h"

#include <jansson.h>

/* Writes `directory`/manifest.json, dated now. */
RtStatus rt_manifest_write(const RtResults *results, const RtWorkloadOptions *options, const char *directory,
                           RtError *error);

/* Reads it back; the caller owns the reference. */
RtStatus rt_manifest_read(const char *directory, json_t **manifest, RtError *error);

/* Loads the experiment of the manifest in `directory`, in the same variant, from the file that it names,
 * relative to the current folder, or from the copy in `directory` where there is none; its scenes are
 * relative to that file. RT_MISMATCH if the file has changed.
 */
RtStatus rt_manifest_experiment(const char *directory, RtExperiment *experiment, RtError *error);

#endif
