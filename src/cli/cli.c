/* SPDX-License-Identifier: Apache-2.0 */
#include "cli/cli.h"

#include "accel/accel.h"
#include "cli/stop.h"
#include "core/base/memory.h"
#include "core/text/json.h"

#include <assert.h>
#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

RtStatus rt_cli_check_json_name(const char *name, RtError *error) {
    json_t *text = json_string_nocheck(name), *checked = json_string(name);
    bool good = checked || !text; /* without either, memory is short, which others report */
    json_decref(text);
    json_decref(checked);
    if (good) return RT_OK;
    return rt_fail(error, RT_BAD_INPUT, "the name '%s' is not UTF-8, which JSON requires: rename the file",
                   name);
}

void rt_cli_print_json(json_t *document) {
    const bool whole = rt_json_check_memory("", NULL) == RT_OK; /* else main says so */
    assert(document || !whole);
    if (whole) {
        json_dumpf(document, stdout, JSON_INDENT(2) | JSON_REAL_PRECISION(9));
        putchar('\n');
    }
    json_decref(document);
}

void rt_cli_print_params(const RtParam *table, size_t count) {
    for (size_t i = 0; i < count; i++) {
        char range[RT_MAX_SPEC_CHARS];
        rt_param_range(&table[i], range, sizeof range);
        printf("  %-12s %s\n  %-12s   default %s (%s); %s\n", table[i].name, table[i].meaning, "",
               table[i].default_text, table[i].source, range);
    }
}

json_t *rt_cli_params_json(const RtParam *table, size_t count) {
    json_t *params = json_array();
    for (size_t i = 0; i < count; i++) {
        char range[RT_MAX_SPEC_CHARS];
        rt_param_range(&table[i], range, sizeof range);
        json_array_append_new(params, json_pack("{s:s, s:s, s:s, s:s, s:s}", "name", table[i].name, "default",
                                                table[i].default_text, "range", range, "meaning",
                                                table[i].meaning, "source", table[i].source));
    }
    return params;
}

int64_t rt_cli_integer(struct argp_state *state, const char *option, const char *text, int64_t lo,
                       int64_t hi) {
    char *end;
    errno = 0;
    long long value = strtoll(text, &end, 10);
    if (end == text || *end || errno || value < lo || value > hi) {
        argp_error(state, "%s: invalid value '%s': expected a whole number %lld..%lld", option, text,
                   (long long)lo, (long long)hi);
    }
    return value;
}

uint64_t rt_cli_bytes(struct argp_state *state, const char *option, const char *text) {
    static const char units[] = "KMGT";
    char *end;
    double bytes = strtod(text, &end);
    const char *unit = *end && end != text ? strchr(units, *end) : NULL;
    for (const char *u = units; unit && u <= unit; u++) bytes *= 1000;
    if (end == text || end[unit != NULL] || !(bytes >= 1 && bytes <= 1e18))
        argp_error(state, "%s: invalid value '%s': expected a number of bytes, as in 512M or 4G", option,
                   text);
    return (uint64_t)bytes;
}

bool rt_cli_goes_on(RtStatus status, const char *spec, uint32_t count, const RtError *why) {
    if (count == 1 || !rt_accel_refuses(status)) return false;
    fprintf(stderr, "raytally: %s is refused: %s\n", spec, why->message);
    return true;
}

void rt_cli_remove(const char **texts, uint32_t *count, uint32_t i) {
    memmove(&texts[i], &texts[i + 1], (--*count - i) * sizeof *texts);
}

void rt_cli_take_memory(void *options, const char *text, struct argp_state *state) {
    (void)options;
    rt_memory_limit_process(rt_cli_bytes(state, "--memory", text));
}

void rt_cli_take_time(void *options, const char *text, struct argp_state *state) {
    (void)options;
    rt_stop_after((unsigned)rt_cli_integer(state, "--time", text, 1, 10000000));
}

bool rt_cli_digits(const char **text, uint32_t *number) {
    char *end;
    if (**text < '0' || **text > '9') return false; /* strtoull accepts blanks and signs */
    errno = 0;
    unsigned long long value = strtoull(*text, &end, 10);
    if (errno || value > UINT32_MAX) return false;
    *text = end;
    *number = (uint32_t)value;
    return true;
}

void rt_cli_size(struct argp_state *state, const char *text, uint32_t *width, uint32_t *height) {
    if (rt_image_size_parse(text, width, height)) return;
    argp_error(state, "--size: invalid value '%s': expected WIDTHxHEIGHT, each 1..%d, as in 640x480", text,
               RT_MAX_IMAGE_SIDE);
}

RtStatus rt_cli_check_pixel(const RtSampling *sampling, RtPixel pixel, RtError *error) {
    if (pixel.x < sampling->width && pixel.y < sampling->height) return RT_OK;
    return rt_fail(error, RT_BAD_INPUT, "--pixel %u,%u is outside the image of %u x %u: choose 0..%u,0..%u",
                   pixel.x, pixel.y, sampling->width, sampling->height, sampling->width - 1,
                   sampling->height - 1);
}

RtRayKind rt_cli_image_ray_kind(struct argp_state *state, const char *option, const char *text) {
    RtError error;
    RtRayKind kind;
    if (rt_ray_kind_parse(text, &kind, &error) == RT_OK && kind <= RT_RAY_TRANSMISSION) return kind;
    argp_error(state, "%s: invalid value '%s': expected primary, shadow, reflection or transmission", option,
               text);
    return RT_RAY_PRIMARY;
}

/* From the last dot of a name that has something before it, or "". */
static const char *extension_of(const char *path) {
    const char *dot = strrchr(path, '.');
    return dot && dot != path ? dot : "";
}

/* Does the file name end in one of `extensions`, such as ".png, .svg or .pdf"? */
static bool has_extension(const char *path, const char *extensions) {
    const char *own = extension_of(path), *at = strstr(extensions, own);
    return *own && at && strchr(", ", at[strlen(own)]); /* or its end */
}

void rt_cli_set_path(struct argp_state *state, const char *option, const char **slot, const char *path,
                     const char *extensions) {
    if (!has_extension(path, extensions))
        argp_error(state, "%s: invalid value '%s': expected a file name that ends in %s", option, path,
                   extensions);
    if (*slot) argp_error(state, "%s: both '%s' and '%s': give one file", option, *slot, path);
    *slot = path;
}

#define Options RtListOptions
const RtOption rt_list_options[] = {{"json", 'j', NULL, RT_TO_FLAG(json), "One JSON document on stdout"},
                                    {0}};
#undef Options

void rt_list_finish(const RtListOptions *options, const char *key, json_t *list, const char *syntax) {
    if (options->json)
        rt_cli_print_json(json_pack("{s:O}", key, list));
    else if (!options->name)
        puts(syntax);
    json_decref(list);
}

json_t *rt_cli_vector_json(RtVec3 v) {
    return json_pack("[f, f, f]", (double)v.x, (double)v.y, (double)v.z);
}
