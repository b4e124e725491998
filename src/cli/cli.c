/* SPDX-License-Identifier: Apache-2.0 */
#include "cli/cli.h"

#include "cli/jobs.h"
#include "measure/measure.h"
#include "scenes/open.h"

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

int64_t rt_cli_integer(struct argp_state *state, const char *option, const char *text, int64_t lo,
                       int64_t hi) {
    char *end;
    errno = 0;
    long long value = strtoll(text, &end, 10);
    if (end == text || *end || errno || value < lo || value > hi)
        argp_error(state, "%s: invalid value '%s': expected a whole number %lld..%lld", option, text,
                   (long long)lo, (long long)hi);
    return value;
}

/* "512M": a number and K, M, G or T, powers of 1000, or neither. */
static uint64_t bytes_of(struct argp_state *state, const char *option, const char *text) {
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

bool rt_cli_leave_out(RtStatus status, const char **specs, uint32_t *count, uint32_t i, const RtError *why) {
    if (*count == 1 || !rt_accel_refuses(status)) return false;
    fprintf(stderr, "raytally: %s is refused: %s\n", specs[i], why->message);
    memmove(&specs[i], &specs[i + 1], (--*count - i) * sizeof *specs);
    return true;
}

void rt_cli_tell_idle(const char *spec, const RtAccel *accel) {
    for (; accel; accel = accel->below) {
        if (accel->idle)
            fprintf(stderr, "raytally: %s: %s passes on every ray: %s\n", spec, accel->ops->name,
                    accel->idle);
    }
}

void rt_cli_take_memory(void *options, const char *text, struct argp_state *state) {
    (void)options;
    rt_memory_limit_process(bytes_of(state, "--memory", text));
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

/* Does the name of the file end, after something else, in one of `extensions`, such as ".png, .svg or .pdf"?
 */
static bool has_extension(const char *path, const char *extensions) {
    const char *own = strrchr(path, '.');
    const char *at = own && own != path ? strstr(extensions, own) : NULL;
    return at && strchr(", ", at[strlen(own)]); /* or its end */
}

void rt_cli_set_path(struct argp_state *state, const char *option, const char **slot, const char *path,
                     const char *extensions) {
    if (!has_extension(path, extensions))
        argp_error(state, "%s: invalid value '%s': expected a file name that ends in %s", option, path,
                   extensions);
    if (*slot) argp_error(state, "%s: both '%s' and '%s': give one file", option, *slot, path);
    *slot = path;
}

void rt_cli_take_strict(void *options, const char *text, struct argp_state *state) {
    (void)options, (void)text, (void)state;
    rt_warnings_refuse();
}

void rt_cli_tell_warnings(const RtScene *scene) {
    rt_warnings_tell(&scene->warnings, rt_progress_notice, NULL);
}

RtStatus rt_cli_open_scene(const char *spec, RtScene *scene, RtError *error) {
    RT_TRY(rt_scene_open(spec, scene, error));
    rt_cli_tell_warnings(scene);
    return RT_OK;
}

json_t *rt_cli_vector_json(RtVec3 v) {
    return json_pack("[f, f, f]", (double)v.x, (double)v.y, (double)v.z);
}

/* ---- rays ---- */

/* Reads x[0..8), with commas or spaces between; returns how many there are, 0 if `text` is something else. */
static int read_numbers(const char *text, float x[8]) {
    char *end;
    for (int count = 0; count < 8; text = end + (*end == ',')) {
        x[count++] = strtof(text, &end);
        if (end == text) return 0;
        end += strspn(end, " ");
        if (!*end) return count;
    }
    return 0;
}

static RtStatus row_of_file(const char *text, const char *colon, RtRay *ray, RtError *error) {
    RT_OWNED(RtRaySet, set, rt_rayset_clear);
    char path[RT_MAX_PATH], *end;
    const unsigned long long row = strtoull(colon + 1, &end, 10);
    snprintf(path, sizeof path, "%.*s", (int)(colon - text), text);
    RT_TRY(rt_rays_load(path, RT_RAY_RANDOM, &set, error));
    if (end == colon + 1 || *end || row >= set.count)
        return rt_fail(error, RT_BAD_INPUT, "%s has no row '%s': choose 0..%llu", path, colon + 1,
                       (unsigned long long)set.count - 1);
    *ray = set.rays[row];
    return RT_OK;
}

RtStatus rt_cli_ray(const char *text, RtRay *ray, RtError *error) {
    float x[8] = {[7] = INFINITY};
    const int count = read_numbers(text, x);
    const char *colon = strrchr(text, ':');
    if (count == 0 && colon) return row_of_file(text, colon, ray, error);
    if (count != 6 && count != 8)
        return rt_fail(
            error, RT_BAD_INPUT,
            "--ray: '%s' is no ray: expected OX,OY,OZ,DX,DY,DZ or OX,OY,OZ,DX,DY,DZ,TMIN,TMAX, as in "
            "0,0,5,0,0,-1; or FILE.npy:N or FILE.csv:N",
            text);
    *ray = (RtRay){.org = rt_vec3(x[0], x[1], x[2]),
                   .tmin = x[6],
                   .dir = rt_vec3(x[3], x[4], x[5]),
                   .tmax = x[7],
                   .kind = RT_RAY_RANDOM};
    if (rt_ray_is_valid(ray)) return RT_OK;
    return rt_fail(error, RT_BAD_INPUT, "--ray: '%s' is not a valid ray: %s", text, rt_ray_fault(ray));
}

/* ---- tables of options ---- */

enum { MOST_OPTIONS = 32, FIRST_KEY = 256 };

/* The input of a parser: of a command, or of its shared options. */
typedef struct Parse {
    const RtSyntax *syntax;
    const RtOption *list;
    char *options;
    struct Parse *shared;
} Parse;

/* `name` is that of an option, with its dashes, or of an argument. */
static void take_value(const RtOptionValue *value, const char *name, char *options, const char *text,
                       struct argp_state *state) {
    void *at = options + value->offset;
    const bool whole = value->form == RT_OPTION_INTEGER || value->form == RT_OPTION_SECONDS;
    const int64_t number = whole ? rt_cli_integer(state, name, text, value->low, value->high) : value->low;
    RtPixel *pixel = at;
    uint32_t *count = (uint32_t *)(options + value->count);
    const char *rest = text;
    char *end;
    double percent;
    switch (value->form) {
    case RT_OPTION_FLAG: *(bool *)at = true; return;
    case RT_OPTION_TEXT: *(const char **)at = text; return;
    case RT_OPTION_LIST:
        if (*count == value->high)
            argp_error(state, "%s: '%s' is one too many: %lld at most", name, text, (long long)value->high);
        ((const char **)at)[(*count)++] = text;
        return;
    case RT_OPTION_INTEGER:
        if (value->size == sizeof(uint32_t))
            *(uint32_t *)at = (uint32_t)number;
        else
            *(uint64_t *)at = (uint64_t)number;
        return;
    case RT_OPTION_SECONDS: *(double *)at = (double)number; return;
    case RT_OPTION_PERCENT:
        percent = strtod(text, &end);
        if (end == text || strcmp(end, "%") != 0 || !(percent > 0 && percent <= 100))
            argp_error(state, "%s: invalid value '%s': expected a percentage, as in 1%%", name, text);
        *(double *)at = percent / 100;
        return;
    case RT_OPTION_SET: *(int *)at = (int)number; return;
    case RT_OPTION_BYTES: *(uint64_t *)at = bytes_of(state, name, text); return;
    case RT_OPTION_SIZE:
        if (!rt_image_size_parse(text, (uint32_t *)at, (uint32_t *)at + 1))
            argp_error(state, "%s: invalid value '%s': expected WIDTHxHEIGHT, each 1..%d, as in 640x480",
                       name, text, RT_MAX_IMAGE_SIDE);
        return;
    case RT_OPTION_PIXEL:
        pixel->given = true;
        if (!rt_cli_digits(&rest, &pixel->x) || *rest++ != ',' || !rt_cli_digits(&rest, &pixel->y) || *rest)
            argp_error(state, "%s: invalid value '%s': expected X,Y, as in 256,200", name, text);
        return;
    case RT_OPTION_PATH: rt_cli_set_path(state, name, (const char **)at, text, value->endings); return;
    case RT_OPTION_TAKE: value->take(options, text, state); return;
    case RT_OPTION_GONE: argp_error(state, "%s is no longer there: %s", name, value->instead); return;
    }
}

static void take_option(const RtOption *o, char *options, const char *text, struct argp_state *state) {
    char name[40];
    snprintf(name, sizeof name, "--%s", o->name);
    if (o->value.mark) *(const char **)(options + o->value.mark) = o->name;
    take_value(&o->value, name, options, text, state);
}

static void take_argument(const Parse *parse, const char *text, struct argp_state *state) {
    const RtArgument *argument = &parse->syntax->argument;
    const char *const *slot = (const char *const *)(parse->options + argument->value.offset);
    if (argument->value.form == RT_OPTION_TEXT && *slot)
        argp_error(state, "one %s at a time; '%s' is a second one", argument->name, text);
    take_value(&argument->value, argument->name, parse->options, text, state);
}

/* Whether the table has an entry `i`, given that it has all before. */
static bool is_option(const RtOption *list, int i) {
    return list && (list[i].name || list[i].help);
}

/* argp's key of an entry; 0 for a title. */
static int key_of(const RtOption *list, int i) {
    return !list[i].name ? 0 : list[i].letter ? list[i].letter : FIRST_KEY + i;
}

static error_t take_key(int key, char *text, struct argp_state *state) {
    const Parse *parse = state->input;
    for (int i = 0; is_option(parse->list, i); i++) {
        if (!parse->list[i].name || key != key_of(parse->list, i)) continue;
        take_option(&parse->list[i], parse->options, text, state);
        return 0;
    }
    return ARGP_ERR_UNKNOWN;
}

static error_t parse_key(int key, char *text, struct argp_state *state) {
    const Parse *parse = state->input;
    const RtSyntax *syntax = parse->syntax;
    switch (key) {
    case ARGP_KEY_INIT:
        if (syntax->shared) state->child_inputs[0] = parse->shared;
        return 0;
    case ARGP_KEY_ARG:
        if (!syntax->argument.name) return ARGP_ERR_UNKNOWN;
        take_argument(parse, text, state);
        return 0;
    case ARGP_KEY_END:
        if (state->arg_num == 0 && syntax->argument.missing)
            argp_error(state, "%s", syntax->argument.missing);
        if (syntax->finish) syntax->finish(parse->options, state);
        return 0;
    default: return take_key(key, text, state);
    }
}

/* The table as argp has it; NULL if it is empty, which glibc would leak. */
static struct argp_option *convert(const RtOption *list, struct argp_option out[MOST_OPTIONS + 1]) {
    int count = 0;
    for (; is_option(list, count); count++) {
        const RtOption *o = &list[count];
        assert(count < MOST_OPTIONS);
        out[count] =
            (struct argp_option){o->name, key_of(list, count), o->operand, o->value.flags, o->help, 0};
    }
    out[count] = (struct argp_option){0};
    return count > 0 ? out : NULL;
}

/* The syntax as argp has it, valid until the next call. */
static const struct argp *argp_of(const RtSyntax *syntax) {
    static struct argp_option own[MOST_OPTIONS + 1], shared[MOST_OPTIONS + 1];
    static struct argp_child children[3];
    static struct argp argp, child;
    int count = 0;
    child = (struct argp){.options = convert(syntax->shared, shared), .parser = take_key};
    if (syntax->shared) children[count++] = (struct argp_child){&child, 0, NULL, syntax->shared_group};
    if (syntax->plugins) children[count++] = (struct argp_child){&rt_plugin_argp, 0, NULL, 0};
    children[count] = (struct argp_child){0};
    argp = (struct argp){.options = convert(syntax->options, own),
                         .parser = parse_key,
                         .args_doc = syntax->arguments,
                         .doc = syntax->help,
                         .children = children};
    return &argp;
}

void rt_cli_parse(const RtSyntax *syntax, int argc, char **argv, void *options) {
    Parse shared = {NULL, syntax->shared, (char *)options + syntax->shared_at, NULL};
    Parse parse = {syntax, syntax->options, options, &shared};
    if (argp_parse(argp_of(syntax), argc, argv, 0, 0, &parse) == 0) return;
    fputs("raytally: out of memory: not enough to parse the arguments\n", stderr);
    exit(RT_EXIT_BAD_INPUT);
}
