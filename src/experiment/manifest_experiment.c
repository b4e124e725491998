/* SPDX-License-Identifier: Apache-2.0 */
#include "experiment/manifest_experiment.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static const json_t *entry_at(const json_t *manifest, size_t i) {
    return json_array_get(json_object_get(manifest, "accelerators"), i);
}

/* Version 1.0 wrote the label as "label", and the spec as "accel". */
static const char *spec_of(const json_t *entry) {
    const json_t *spec = json_object_get(entry, "spec");
    return json_string_value(spec ? spec : json_object_get(entry, "accel"));
}

bool rt_manifest_candidate(const json_t *manifest, uint32_t i, RtCandidate *candidate) {
    const json_t *entry = entry_at(manifest, i), *old = json_object_get(entry, "label");
    const char *spec = spec_of(entry);
    const char *label = json_string_value(old ? old : json_object_get(entry, "accel"));
    if (!spec || !label) return false;
    snprintf(candidate->spec, sizeof candidate->spec, "%s", spec);
    snprintf(candidate->label, sizeof candidate->label, "%s", label);
    return true;
}

bool rt_manifest_is_missing(const json_t *manifest, uint32_t i) {
    return json_is_true(json_object_get(entry_at(manifest, i), "missing"));
}

/* In one layer, NAME:KEY=VALUE,KEY=VALUE. */
static bool is_whole_in(const char *layer, const char *owner, const char *key) {
    size_t name = strcspn(layer, ":+"), length = strlen(key);
    if (name != strlen(owner) || strncmp(layer, owner, name) != 0) return true;
    for (const char *c = layer + name; *c == ':' || *c == ','; c += 1 + strcspn(c + 1, ",")) {
        char value[RT_MAX_SWEPT_CHARS];
        char *end;
        if (strncmp(c + 1, key, length) != 0 || c[1 + length] != '=') continue;
        snprintf(value, sizeof value, "%.*s", (int)strcspn(c + 2 + length, ",+"), c + 2 + length);
        double number = strtod(value, &end);
        if (end == value || *end || number != round(number)) return false;
    }
    return true;
}

bool rt_manifest_is_whole(const json_t *manifest, const char *owner, const char *key) {
    const json_t *list = json_object_get(manifest, "accelerators");
    for (size_t i = 0; i < json_array_size(list); i++) {
        const char *layer = spec_of(json_array_get(list, i));
        for (; layer; layer = strchr(layer, '+') ? strchr(layer, '+') + 1 : NULL) {
            if (!is_whole_in(layer, owner, key)) return false;
        }
    }
    return true;
}
