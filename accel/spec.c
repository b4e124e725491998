/* SPDX-License-Identifier: Apache-2.0 */
/* Specs: "name:key=value,key=value", with '+' between layers and '/' before the accelerator of parts. And
 * names for the fastest of several (RtBestOf), which stand for all combinations of the choices listed there,
 * those of the first parameter varying fastest. */
#include "accel/accel.h"
#include "accel/isa.h"
#include "core/base/clock.h"
#include "core/base/parallel.h"

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

/* The RtBestOf of that name, or NULL. */
static const RtBestOf *find_best(const RtAccelOps *ops, const char *name) {
    for (size_t i = 0; i < ops->best_count; i++) {
        if (strcmp(ops->bests[i].name, name) == 0) return &ops->bests[i];
    }
    return NULL;
}

static RtStatus parse_layer(const char *text, size_t chars, RtSpecLayer *layer, RtError *error) {
    char copy[RT_MAX_SPEC_CHARS], what[RT_MAX_NAME + 16];
    size_t name_chars = strcspn(text, ":+/");
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
    if (params && find_best(layer->ops, params))
        return rt_fail(
            error, RT_BAD_INPUT,
            "'%s:%s' is the fastest of several settings, which measuring chooses: `raytally bench` "
            "and experiments take it",
            copy, params);
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

/* The accelerator of parts, after a '/'. */
static RtStatus parse_part(const char *text, RtSpec *spec, RtError *error) {
    spec->of_parts = true;
    RT_TRY(parse_layer(text, strlen(text), &spec->part, error));
    if (!spec->part.ops->kinds && !spec->part.ops->remote) return RT_OK;
    return rt_fail(error, RT_BAD_INPUT,
                   "'%.80s': %s cannot stand after a '/', where the accelerator of parts is", text,
                   spec->part.ops->name);
}

RtStatus rt_spec_parse(const char *text, RtSpec *spec, RtError *error) {
    const char *rest = text, *end = text + strcspn(text, "/");
    *spec = (RtSpec){0};
    for (;;) {
        size_t chars = layer_length(rest);
        if (rest + chars > end) chars = (size_t)(end - rest);
        if (spec->layer_count == RT_MAX_LAYERS)
            return rt_fail(error, RT_BAD_INPUT, "'%.80s': more than %d accelerators stacked", text,
                           RT_MAX_LAYERS);
        RT_TRY(parse_layer(rest, chars, &spec->layers[spec->layer_count++], error));
        rest += chars;
        if (rest == end) break;
        rest++;
    }
    RT_TRY(check_layers(spec, text, error));
    return *end ? parse_part(end + 1, spec, error) : RT_OK;
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
    const bool asks = spec->of_parts && spec->part.ops->available;
    return asks ? spec->part.ops->available(spec->part.values, error) : RT_OK;
}

static size_t format_layer(const RtSpecLayer *layer, const char *before, char *out, size_t used) {
    if (used >= RT_MAX_SPEC_CHARS) return used;
    snprintf(out + used, RT_MAX_SPEC_CHARS - used, "%s%s%s", before, layer->ops->name,
             layer->ops->param_count ? ":" : "");
    used = strlen(out);
    rt_params_format(layer->ops->params, layer->ops->param_count, layer->values, out + used,
                     RT_MAX_SPEC_CHARS - used);
    return strlen(out);
}

void rt_spec_format(const RtSpec *spec, char *out) {
    size_t used = 0;
    for (uint32_t i = 0; i < spec->layer_count; i++)
        used = format_layer(&spec->layers[i], i > 0 ? "+" : "", out, used);
    if (spec->of_parts) format_layer(&spec->part, "/", out, used);
}

/* ---- building ---- */

/* Builds what answers rays in the parts of a scene; also after a failure, *out holds those that were built.
 */
static RtStatus build_parts(const RtSpec *spec, const RtScene *scene, int threads, RtAccel ***out,
                            RtError *error) {
    const RtSpecLayer *layer = spec->of_parts ? &spec->part : &spec->layers[spec->layer_count - 1];
    if (scene->part_count == 0) return RT_OK;
    RtAccel **parts = *out = rt_alloc(scene->part_count, sizeof(void *));
    if (!parts) return rt_fail_memory(error, "parts", scene->part_count * sizeof(void *));
    for (uint32_t i = 0; i < scene->part_count; i++) {
        const RtScene *part = scene->parts[i];
        const RtBuild what = {part, layer->values, threads, rt_accel_byte_limit(part), parts};
        RT_TRY(rt_accel_build_layer(layer->ops, &what, NULL, &parts[i], error));
    }
    return RT_OK;
}

/* Gives the parts to the base of a stack, whose answers are no better than theirs. */
static void take_parts(RtAccel *base, RtAccel **parts) {
    base->parts = parts;
    for (uint32_t i = 0; i < base->scene->part_count; i++) {
        base->exact &= parts[i]->exact;
        base->absolute |= parts[i]->absolute;
        base->counts &= parts[i]->counts;
    }
}

static RtStatus build_layers(const RtSpec *spec, const RtScene *scene, int threads, RtAccel **out,
                             RtError *error) {
    RtAccel *top = NULL, **parts = NULL;
    double start = rt_wall_seconds();
    *out = NULL;
    RT_TRY(rt_spec_available(spec, error));
    RtStatus status = build_parts(spec, scene, threads, &parts, error);
    for (uint32_t i = spec->layer_count; status == RT_OK && i-- > 0;) {
        const RtBuild what = {scene, spec->layers[i].values, threads, rt_accel_byte_limit(scene), parts};
        status = rt_accel_build_layer(spec->layers[i].ops, &what, top, &top, error);
        if (status != RT_OK) break;
        if (!top->below) take_parts(top, parts);
        top->build_seconds = rt_wall_seconds() - start;
    }
    if (status == RT_OK) {
        *out = top;
    } else if (top) {
        rt_accel_destroy(top);
    } else {
        rt_accel_destroy_parts(parts, scene);
    }
    return status;
}

RtStatus rt_accel_build_here(const RtSpec *spec, const RtScene *scene, int threads, RtAccel **out,
                             RtError *error) {
    const RtStatus status = build_layers(spec, scene, threads, out, error);
    const bool too_large = status == RT_NO_MEMORY && rt_memory_limit_was_reached();
    return too_large && rt_thread_count(threads) > 1 ? build_layers(spec, scene, 1, out, error) : status;
}

/* ---- the best of several ---- */

/* The ':' before a word that is no parameter, as in "octree:best" and "light:best+wide"; NULL if there is
 * none. */
static const char *find_word(const char *text) {
    for (const char *layer = text; *layer;) {
        const size_t length = layer_length(layer), name = strcspn(layer, ":+");
        const size_t word = name < length ? strcspn(layer + name + 1, "=,+") : 0;
        if (name > 0 && word > 0 && name + 1 + word == length) return layer + name;
        layer += length + (layer[length] == '+');
    }
    return NULL;
}

bool rt_best_is(const char *text) {
    return find_word(text) != NULL;
}

/* Writes combination `n` of the choices, "max_leaf_size=4,traversal_order=fixed", to
 * out[0..RT_MAX_SPEC_CHARS); false if there are no more. */
static bool combine(const RtBestOf *best, size_t n, char *out) {
    int used = 0;
    for (const char *key = best->settings; *key;) {
        size_t key_chars = strcspn(key, "=") + 1, all = key_chars + strcspn(key + key_chars, ",");
        size_t choices = 1;
        for (size_t i = key_chars; i < all; i++) choices += key[i] == '|';
        const char *choice = key + key_chars;
        for (size_t k = n % choices; k > 0; k--) choice += strcspn(choice, "|") + 1;
        used += snprintf(out + used, (size_t)(RT_MAX_SPEC_CHARS - used), "%s%.*s%.*s", used ? "," : "",
                         (int)key_chars, key, (int)strcspn(choice, "|,"), choice);
        n /= choices;
        key += all + (key[all] == ',');
    }
    return n == 0;
}

static RtStatus fail_unknown(const RtAccelOps *ops, const char *text, RtError *error) {
    char names[128] = "";
    for (size_t i = 0, used = 0; i < ops->best_count && used < sizeof names; i++)
        used += (size_t)snprintf(names + used, sizeof names - used, "%s%s:%s", i > 0 ? ", " : "", ops->name,
                                 ops->bests[i].name);
    return rt_fail(
        error, RT_BAD_INPUT,
        "'%.80s' is neither a spec, NAME:KEY=VALUE, nor one of the names that stand for the fastest "
        "of several settings%s%s",
        text, *names ? ": " : "", names);
}

RtStatus rt_best_specs(const char *text, char specs[RT_MAX_BEST][RT_MAX_SPEC_CHARS], size_t *count,
                       size_t *all, RtError *error) {
    char name[RT_MAX_NAME], word[RT_MAX_NAME], choice[RT_MAX_SPEC_CHARS], spec[RT_MAX_SPEC_CHARS];
    const RtAccelOps *ops;
    const char *colon = find_word(text), *layer = colon ? colon : text;
    while (layer > text && layer[-1] != '+') layer--;
    snprintf(name, sizeof name, "%.*s", (int)strcspn(layer, ":+"), layer);
    snprintf(word, sizeof word, "%.*s", (int)strcspn(colon ? colon + 1 : "", "+"), colon ? colon + 1 : "");
    RT_TRY(rt_accel_find(name, &ops, error));
    const RtBestOf *best = find_best(ops, word);
    if (!best) return fail_unknown(ops, text, error);
    *count = *all = 0;
    while (*all < RT_MAX_BEST && combine(best, *all, choice)) {
        RtSpec parsed;
        const char *rest = colon + 1 + strlen(word);
        if (snprintf(spec, sizeof spec, "%.*s:%s%s", (int)(colon - text), text, choice, rest) >=
            (int)sizeof spec)
            return rt_fail(error, RT_BAD_INPUT, "'%.80s...': a spec has at most %d characters", text,
                           RT_MAX_SPEC_CHARS - 1);
        RT_TRY(rt_spec_parse(spec, &parsed, error));
        const RtStatus status = rt_spec_available(&parsed, error);
        if (status != RT_OK && status != RT_NOT_AVAILABLE) return status;
        const size_t at = status == RT_OK ? (*count)++ : *all;
        memmove(specs[at + 1], specs[at], (*all - at) * sizeof *specs);
        memcpy(specs[at], spec, sizeof spec);
        ++*all;
    }
    return *count > 0 ? RT_OK
                      : rt_fail(error, RT_NOT_AVAILABLE,
                                "this machine can run none of the settings of '%.80s'", text);
}
