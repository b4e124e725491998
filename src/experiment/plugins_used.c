/* SPDX-License-Identifier: Apache-2.0 */
#include "experiment/plugins_used.h"
#include "core/text/json.h"

#include "measure/machine.h"

#include <string.h>

/* Whether one of the spec's layers, joined by '+' as in accel/spec.c, is called that. */
static bool has_layer(const char *spec, const char *name) {
    const size_t length = strlen(name);
    for (const char *layer = spec;; layer++) {
        if (strncmp(layer, name, length) == 0 && strchr(":+", layer[length])) return true;
        layer = strchr(layer, '+');
        if (!layer) return false;
    }
}

static bool is_used(const RtExperiment *experiment, const char *name) {
    uint32_t c = 0;
    while (c < experiment->candidate_count && !has_layer(experiment->candidates[c].spec, name)) c++;
    return c < experiment->candidate_count;
}

/* From the list under "plugins" of rt_machine_json. */
static json_t *used_of(const RtExperiment *experiment, const json_t *plugins) {
    json_t *used = json_object(), *plugin, *name;
    size_t i, n;
    json_array_foreach((json_t *)plugins, i, plugin) {
        json_array_foreach(json_object_get(plugin, "accelerators"), n, name) {
            if (!json_is_string(name) || !is_used(experiment, json_string_value(name))) continue;
            json_object_set_new(used, json_string_value(name),
                                json_pack("{s:O?, s:O?}", "file", json_object_get(plugin, "file"), "hash",
                                          json_object_get(plugin, "hash")));
        }
    }
    return used;
}

json_t *rt_plugins_used(const RtExperiment *experiment) {
    json_auto_t *plugins = rt_plugins_json();
    return used_of(experiment, plugins);
}

json_t *rt_plugins_used_then(const RtExperiment *experiment, const json_t *manifest) {
    return used_of(experiment, json_object_get(json_object_get(manifest, "machine"), "plugins"));
}

json_t *rt_plugins_changed(const json_t *before, const json_t *after) {
    json_t *changed = json_object(), *plugin;
    const char *name;
    json_object_foreach((json_t *)before, name, plugin) {
        json_t *now = json_object_get(after, name);
        if (json_equal(json_object_get(plugin, "hash"), json_object_get(now, "hash"))) continue;
        json_object_set_new(changed, name, json_pack("{s:O, s:O?}", "before", plugin, "after", now));
    }
    json_object_foreach((json_t *)after, name, plugin) {
        if (json_object_get(before, name)) continue;
        json_object_set_new(changed, name, json_pack("{s:n, s:O}", "before", "after", plugin));
    }
    return changed;
}

json_t *rt_plugins_changed_since(const json_t *before, const RtExperiment *experiment) {
    json_auto_t *now = rt_plugins_used(experiment);
    return rt_plugins_changed(before, now);
}

bool rt_plugins_concern(const json_t *object, const RtExperiment *experiment, uint32_t candidate) {
    const char *name;
    json_t *plugin;
    const uint32_t c = rt_candidate_built(experiment, candidate);
    json_object_foreach((json_t *)object, name, plugin) {
        if (has_layer(experiment->candidates[c].spec, name)) return true;
    }
    return false;
}

/* ---- sentences ---- */

static const char *describe(const json_t *plugin, char out[256]) {
    snprintf(out, 256, "%.200s (%.16s)", rt_json_text(plugin, "file", "unknown"),
             rt_json_text(plugin, "hash", "unknown"));
    return out;
}

void rt_plugins_change_format(const char *name, const json_t *change, const char *before, const char *after,
                              char out[RT_MAX_PLUGIN_CHANGE]) {
    const json_t *then = json_object_get(change, "before"), *now = json_object_get(change, "after");
    char one[256], other[256];
    if (json_is_object(then) && json_is_object(now))
        snprintf(out, RT_MAX_PLUGIN_CHANGE, "the plugin of '%s' has changed: %s %s, %s %s", name,
                 describe(then, one), before, describe(now, other), after);
    else if (json_is_object(then))
        snprintf(out, RT_MAX_PLUGIN_CHANGE, "'%s' belonged to the plugin %s %s, and does not %s", name,
                 describe(then, one), before, after);
    else
        snprintf(out, RT_MAX_PLUGIN_CHANGE, "'%s' belongs to the plugin %s %s, and did not %s", name,
                 describe(now, one), after, before);
}
