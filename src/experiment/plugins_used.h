/* SPDX-License-Identifier: Apache-2.0 */
/* The plugins that an experiment uses, and how they differ from those of an earlier result.
 *
 * They are an object, {"NAME": {"file", "hash"}, ...}, with a member for each accelerator of a plugin that is
 * a layer of a candidate. Other loaded plugins are not in it. */
#ifndef RT_EXPERIMENT_PLUGINS_USED_H
#define RT_EXPERIMENT_PLUGINS_USED_H

#include "experiment/experiment.h"

#include <jansson.h>

/* From the loaded plugins; and from those that a manifest names. A new reference; NULL if memory is short. */
json_t *rt_plugins_used(const RtExperiment *experiment);
json_t *rt_plugins_used_then(const RtExperiment *experiment, const json_t *manifest);

/* {"NAME": {"before": {"file", "hash"} or null, "after": ...}, ...}: the plugins whose hashes differ. A new
 * reference; NULL if memory is short. */
json_t *rt_plugins_changed(const json_t *before, const json_t *after);

/* The same up to the loaded plugins. */
json_t *rt_plugins_changed_since(const json_t *before, const RtExperiment *experiment);

/* Whether a layer of the candidate (for the null run, of the baseline) is a member of `object`. */
bool rt_plugins_concern(const json_t *object, const RtExperiment *experiment, uint32_t candidate);

/* A sentence for a member of rt_plugins_changed: "the plugin of 'mine' has changed: FILE (HASH) BEFORE, FILE
 * (HASH) AFTER". */
#define RT_MAX_PLUGIN_CHANGE 640
void rt_plugins_change_format(const char *name, const json_t *change, const char *before, const char *after,
                              char out[RT_MAX_PLUGIN_CHANGE]);

#endif
