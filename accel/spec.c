/* SPDX-License-Identifier: Apache-2.0 */
/* Specs: "name:key=value,key=value", with '+' between layers. */
#include "accel/accel.h"
#include "accel/isa.h"

#include <stdio.h>
#include <string.h>

/* The length of the first layer of `text`, which ends at a '+' that is not part of an exponent, as in
 * 1e+06. */
static size_t layer_length(const char *text) {
    size_t length = strcspn(text, "+");
    while (text[length] == '+' && text[length + 1] >= '0' && text[length + 1] <= '9')
        length += 1 + strcspn(text + length + 1, "+");
    return length;
}

static RtStatus parse_layer(const char *text, size_t chars, RtSpecLayer *layer, RtError *error) {
    char copy[RT_MAX_SPEC_CHARS], what[RT_MAX_NAME + 16];
    size_t name_chars = strcspn(text, ":+");
    if (name_chars == 0 || name_chars >= RT_MAX_NAME || chars >= sizeof copy)
        return rt_fail(
            error, RT_BAD_INPUT,
            "'%.80s' is not the spec of an accelerator: write NAME[:KEY=VALUE,...], overlays before it as "
            "in OVERLAY+NAME",
            text);
    memcpy(copy, text, chars);
    copy[chars] = '\0';
    char *params = strchr(copy, ':');
    if (params) *params++ = '\0';
    RT_TRY(rt_accel_find(copy, &layer->ops, error));
    if (params && rt_best_find(layer->ops, params))
        return rt_fail(error, RT_BAD_INPUT,
                       "'%s:%s' is the fastest of several settings: it can only be a baseline, as in "
                       "`raytally bench --baseline %s:%s`",
                       copy, params, copy, params);
    snprintf(what, sizeof what, "accelerator %s", layer->ops->name);
    return rt_params_parse(layer->ops->params, layer->ops->param_count, params, what, layer->values, error);
}

/* Checks that there are overlays above one base. */
static RtStatus check_layers(const RtSpec *spec, const char *text, RtError *error) {
    for (uint32_t i = 0; i + 1 < spec->layer_count; i++) {
        const char *name = spec->layers[i].ops->name;
        if (spec->layers[i].ops->kinds) continue;
        return rt_fail(error, RT_BAD_INPUT,
                       "'%.80s': %s is not an overlay, so it cannot stand before a '+'; `raytally accels` "
                       "shows which are",
                       text, name);
    }
    const RtAccelOps *last = spec->layers[spec->layer_count - 1].ops;
    if (!last->kinds) return RT_OK;
    return rt_fail(error, RT_BAD_INPUT,
                   "'%.80s': %s is an overlay and needs an accelerator below it: write %.80s+%s", text,
                   last->name, text, rt_accel_default());
}

RtStatus rt_spec_parse(const char *text, RtSpec *spec, RtError *error) {
    const char *rest = text;
    spec->layer_count = 0;
    for (;;) {
        size_t chars = layer_length(rest);
        if (spec->layer_count == RT_MAX_LAYERS)
            return rt_fail(error, RT_BAD_INPUT, "'%.80s': more than %d accelerators stacked", text,
                           RT_MAX_LAYERS);
        RT_TRY(parse_layer(rest, chars, &spec->layers[spec->layer_count++], error));
        if (rest[chars] == '\0') return check_layers(spec, text, error);
        rest += chars + 1;
    }
}

bool rt_spec_is_remote(const RtSpec *spec) {
    for (uint32_t i = 0; i < spec->layer_count; i++) {
        if (spec->layers[i].ops->remote) return true;
    }
    return false;
}

bool rt_spec_text_is_remote(const char *text) {
    RtSpec spec;
    return rt_spec_parse(text, &spec, NULL) == RT_OK && rt_spec_is_remote(&spec);
}

RtStatus rt_spec_available(const RtSpec *spec, RtError *error) {
    RT_TRY(rt_isa_best_available(error));
    for (uint32_t i = 0; i < spec->layer_count; i++) {
        const RtSpecLayer *layer = &spec->layers[i];
        if (layer->ops->available) RT_TRY(layer->ops->available(layer->values, error));
    }
    return RT_OK;
}

void rt_spec_format(const RtSpec *spec, char *out) {
    size_t used = 0;
    for (uint32_t i = 0; i < spec->layer_count && used < RT_MAX_SPEC_CHARS; i++) {
        const RtSpecLayer *layer = &spec->layers[i];
        snprintf(out + used, RT_MAX_SPEC_CHARS - used, "%s%s%s", i > 0 ? "+" : "", layer->ops->name,
                 layer->ops->param_count ? ":" : "");
        used = strlen(out);
        rt_params_format(layer->ops->params, layer->ops->param_count, layer->values, out + used,
                         RT_MAX_SPEC_CHARS - used);
        used = strlen(out);
    }
}
