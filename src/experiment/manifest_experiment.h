/* SPDX-License-Identifier: Apache-2.0 */
/* The accelerators of an experiment as the manifest of its results lists them, for commands that only read
 * results: this build may lack them, or have others (a plugin that is not loaded or has changed; a library's
 * settings on another machine). */
#ifndef RT_EXPERIMENT_MANIFEST_EXPERIMENT_H
#define RT_EXPERIMENT_MANIFEST_EXPERIMENT_H

#include "experiment/experiment.h"

#include <jansson.h>

/* Copies spec and label of accelerator number `i` to *candidate; false if there is none. */
bool rt_manifest_candidate(const json_t *manifest, uint32_t i, RtCandidate *candidate);

/* Whether the build that ran it lacked accelerator number `i`. */
bool rt_manifest_is_missing(const json_t *manifest, uint32_t i);

/* Whether parameter `key` of the accelerator `owner` has only whole numbers in the manifest. */
bool rt_manifest_is_whole(const json_t *manifest, const char *owner, const char *key);

#endif
