/* SPDX-License-Identifier: Apache-2.0 */
/* The manifest of a result: what was run, and with what. */
#ifndef RT_EXPERIMENT_MANIFEST_H
#define RT_EXPERIMENT_MANIFEST_H

#include "experiment/workload.h"

#include <jansson.h>

/* Writes `directory`/manifest.json, dated now. */
RtStatus rt_manifest_write(const RtResults *results, const RtWorkloadOptions *options, const char *directory,
                           RtError *error);

/* Reads it back; the caller owns the reference. */
RtStatus rt_manifest_read(const char *directory, json_t **manifest, RtError *error);

/* Loads the experiment that the manifest of `directory` is of, quick if that was, from the file that it
 * names, seen from here; its scenes are found from where it lies. RT_MISMATCH where it has changed since. */
RtStatus rt_manifest_experiment(const char *directory, RtExperiment *experiment, RtError *error);

#endif
