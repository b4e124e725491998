/* SPDX-License-Identifier: Apache-2.0 */
/* Whose plugins an experiment uses, and which of them are not those that an earlier result was made with.
 *
 * What is used is an object, {"NAME": {"file", "hash"}, ...}, with a member for each accelerator of a plugin
 * that a candidate of the experiment has a layer of. Other plugins that happen to be loaded are not in it. */
#ifndef RT_EXPERIMENT_PLUGINS_USED_H
#define RT_EXPERIMENT_PLUGINS_USED_H

#include "experiment/experiment.h"

#include <jansson.h>

/* Of the plugins that are loaded; and of those that a manifest names. The caller's; NULL where memory is
 * short. */
json_t *rt_plugins_used(const RtExperiment *experiment);
json_t *rt_plugins_used_then(const RtExperiment *experiment, const json_t *manifest);

/* {"NAME": {"before": {"file", "hash"} or null, "after": ...}, ...}: of both what is not the same, which the
 * hash decides. The caller's; NULL where memory is short. */
json_t *rt_plugins_changed(const json_t *before, const json_t *after);

/* Whether a layer of the candidate is an accelerator that has a member in `object`; the null run is its
 * baseline. */
bool rt_plugins_concern(const json_t *object, const RtExperiment *experiment, uint32_t candidate);

/* A sentence on one member of what rt_plugins_changed gives: "the plugin of 'mine' is another one: FILE
 * (HASH) BEFORE, FILE (HASH) AFTER". */
#define RT_MAX_PLUGIN_CHANGE 640
void rt_plugins_change_format(const char *name, const json_t *change, const char *before, const char *after,
                              char out[RT_MAX_PLUGIN_CHANGE]);

/* Calls `tell` with such a sentence for each accelerator of the experiment whose plugin is not the one that
 * the manifest names. */
void rt_plugins_tell_changes(const RtExperiment *experiment, const json_t *manifest,
                             void (*tell)(void *context, const char *sentence), void *context);

#endif
