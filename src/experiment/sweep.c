/* SPDX-License-Identifier: Apache-2.0 */
/* Labels; and sweeps: one spec of a scene or an accelerator that expands to several, one for each value of a
 * parameter.
 *
 *     grid:density=1|4|16              a list
 *     grid:density=1..9+2              from 1 to 9 in steps of 2
 *     random:n=1e2..1e7*10             from 100 to 10,000,000, each ten times the previous
 *     grid:density=1..16*4,depth=1|2   all combinations; the last parameter changes fastest
 *
 * A list may hold ranges, "0.5|1..16*2", and words, "bvh:build=binned|sweep". For a parameter that is a whole
 * number, values are rounded and duplicates dropped. The characters are unambiguous: no other value has two
 * dots or a bar, and a '+' before a digit never separates accelerators. */
#include "core/base/words.h"
#include "experiment/experiment.h"
#include "scenes/builtin.h"

#include <ctype.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* ---- labels ---- */

bool rt_may_label(char c) {
    return isgraph((unsigned char)c) && !strchr("\"'`/\\$&<>@^{}", c);
}

/* Whether version 1.0, which cut labels, called number `i` of a list so: by the first 47 characters, or, if
 * another had these, by the first 40 and the number. */
static bool was_called(const char *label, uint32_t i, const char *name) {
    enum { CUT = 47, NUMBERED = 40 };
    char *end;
    if (strlen(label) <= CUT) return false;
    if (strlen(name) == CUT && strncmp(label, name, CUT) == 0) return true;
    return strncmp(label, name, NUMBERED) == 0 && strncmp(name + NUMBERED, "...", 3) == 0 &&
           isdigit((unsigned char)name[NUMBERED + 3]) && strtoul(name + NUMBERED + 3, &end, 10) == i + 1 &&
           !*end;
}

uint32_t rt_candidate_find(const RtExperiment *experiment, const char *label, uint32_t t) {
    const uint32_t count = experiment->candidate_count;
    if (strcmp(label, experiment->again) == 0) return count;
    for (uint32_t i = 0; i < 2 * count; i++) {
        const uint32_t c = i < count ? i : i - count;
        const RtCandidate *candidate = &experiment->candidates[c];
        const bool called =
            i < count ? strcmp(candidate->label, label) == 0 : was_called(candidate->label, c, label);
        if (called && !(candidate->excluded >> t & 1)) return c;
    }
    return count + 1;
}

uint32_t rt_workload_find(const RtExperiment *experiment, const char *label) {
    const uint32_t count = experiment->workload_count;
    uint32_t t = 0, cut = 0;
    while (t < count && strcmp(experiment->workloads[t].label, label) != 0) t++;
    while (cut < count && !was_called(experiment->workloads[cut].label, cut, label)) cut++;
    return t < count ? t : cut;
}

bool rt_candidate_is_called(const RtCandidate *candidate, const char *name) {
    return strcmp(candidate->label, name) == 0 || strcmp(candidate->stem, name) == 0;
}

bool rt_workload_is_called(const RtWorkload *workload, const char *name) {
    return strcmp(workload->label, name) == 0 || strcmp(workload->stem, name) == 0;
}

void rt_swept_name(const RtSwept *swept, const char *but, char *out, size_t size) {
    for (uint32_t i = 0; i < swept->count; i++) {
        if (but && strcmp(swept->keys[i], but) == 0) continue;
        rt_append_text(out, size, ":%s=%s", swept->keys[i], swept->values[i]);
    }
}

/* Makes stem and label of one of a sweep: the given label, and that with ":key=value" for what is swept. */
static RtStatus label_sweep(const char *given, const RtSwept *swept, char stem[RT_MAX_LABEL],
                            char label[RT_MAX_LABEL], RtError *error) {
    char whole[RT_MAX_LABEL + RT_MAX_SWEPT * (RT_MAX_NAME + RT_MAX_SWEPT_CHARS + 2)];
    strcpy(stem, given);
    snprintf(whole, sizeof whole, "%s", given);
    rt_swept_name(swept, NULL, whole, sizeof whole);
    if (strlen(whole) >= RT_MAX_LABEL)
        return rt_fail(error, RT_BAD_INPUT, "'%s' is longer than %d characters: give a short `label`", whole,
                       RT_MAX_LABEL - 1);
    strcpy(label, whole);
    return RT_OK;
}

/* Whether characters had to be replaced. */
static bool name_scene(const char *spec, bool file, char label[RT_MAX_LABEL]) {
    const char *start = file ? basename(spec) : spec;
    size_t length = file ? strcspn(start, ".") : strlen(start);
    bool replaced = false;
    snprintf(label, RT_MAX_LABEL, "%.*s", (int)length, start);
    for (char *c = label; *c; c++) {
        if (rt_may_label(*c)) continue;
        *c = '_';
        replaced = true;
    }
    return replaced;
}

/* Makes stem and label of the last workload, from its spec and that without swept parameters: a file's name
 * without folder and extension, or a built-in's spec, with _ for characters that labels may not have. If
 * another scene then has that label, it gets a number. */
static void label_scene(RtExperiment *experiment, RtWorkload *workload, const char *stem, const char *spec) {
    char name[RT_MAX_LABEL];
    name_scene(stem, workload->file, workload->stem);
    const bool replaced = name_scene(spec, workload->file, workload->label);
    strcpy(name, workload->label);
    for (unsigned number = 2;
         replaced && &experiment->workloads[rt_workload_find(experiment, workload->label)] != workload;
         number++) {
        snprintf(workload->label, RT_MAX_LABEL, "%.*s-%u", RT_MAX_LABEL - 8, name, number);
        strcpy(workload->stem, workload->label);
    }
}

/* ---- what was swept ---- */

bool rt_swept_number(const char *value, double *number) {
    char *end;
    *number = strtod(value, &end);
    return (isdigit((unsigned char)*value) || strchr("+-.", *value)) && end != value && !*end &&
           isfinite(*number);
}

bool rt_swept_equal(const char *a, const char *b) {
    double x, y;
    return strcmp(a, b) == 0 || (rt_swept_number(a, &x) && rt_swept_number(b, &y) && x == y);
}

/* Compares how much the quotients differ with how much the steps do. Two values: a factor above four. */
bool rt_swept_logarithmic(const double *values, uint32_t count) {
    double quotient[2] = {INFINITY, 0}, step[2] = {INFINITY, 0};
    if (count < 2 || values[0] <= 0) return false;
    if (count == 2) return values[1] > 4 * values[0];
    for (uint32_t i = 1; i < count; i++) {
        double q = values[i] / values[i - 1], d = values[i] - values[i - 1];
        quotient[0] = fmin(quotient[0], q);
        quotient[1] = fmax(quotient[1], q);
        step[0] = fmin(step[0], d);
        step[1] = fmax(step[1], d);
    }
    return quotient[1] / quotient[0] < step[1] / step[0];
}

/* ---- values ---- */

typedef struct SweptParam {
    char key[RT_MAX_NAME];
    size_t start, length; /* of the value in the text */
    uint32_t count;
    char values[RT_MAX_SWEEP_VALUES][RT_MAX_SWEPT_CHARS];
} SweptParam;

typedef struct Sweep {
    const char *text; /* borrowed */
    uint32_t count;   /* of specs; 1 if nothing is swept */
    uint32_t param_count;
    SweptParam params[RT_MAX_SWEPT];
} Sweep;

static RtStatus add_value(SweptParam *param, const char *text, RtError *error) {
    const size_t length = strlen(text);
    if (length == 0 || length >= RT_MAX_SWEPT_CHARS)
        return rt_fail(error, RT_BAD_INPUT,
                       "'%s' of %s is not a value for a list: values have 1..%d characters", text, param->key,
                       RT_MAX_SWEPT_CHARS - 1);
    for (uint32_t i = 0; i < param->count; i++) {
        if (strcmp(param->values[i], text) == 0) return RT_OK;
    }
    if (param->count == RT_MAX_SWEEP_VALUES)
        return rt_fail(error, RT_BAD_INPUT, "%s takes more than %d values: choose a larger step or factor",
                       param->key, RT_MAX_SWEEP_VALUES);
    strcpy(param->values[param->count++], text);
    return RT_OK;
}

/* The start of the step or factor after the dots, or the end; a '+' after an e belongs to an exponent. */
static const char *find_step(const char *text) {
    while (*text && text[1] != '*' && (text[1] != '+' || tolower((unsigned char)*text) == 'e')) text++;
    return *text ? text + 1 : text;
}

/* `text` is LOW..HIGH+STEP or LOW..HIGH*FACTOR, with the dots at `dots`. Multiplies instead of adding, to
 * avoid accumulated errors; nine digits hide the rest. */
static RtStatus add_range(SweptParam *param, const char *text, const char *dots, bool whole, RtError *error) {
    const char *above = dots + 2, *sign = find_step(above);
    char ends[2][RT_MAX_SPEC_CHARS];
    double low, high, step = 0, value = 0, power = 1;
    const bool factor = *sign == '*';
    snprintf(ends[0], sizeof ends[0], "%.*s", (int)(dots - text), text);
    snprintf(ends[1], sizeof ends[1], "%.*s", (int)(sign - above), above);
    bool fine = rt_swept_number(ends[0], &low) && rt_swept_number(ends[1], &high) && *sign &&
                rt_swept_number(sign + 1, &step) && low < high;
    if (!fine || (factor ? step <= 1 || low <= 0 : step <= 0))
        return rt_fail(
            error, RT_BAD_INPUT,
            "'%s' is not a range: write LOW..HIGH+STEP with a step above 0, or LOW..HIGH*FACTOR with a "
            "factor above 1 and LOW above 0, LOW below HIGH, as in 1..9+2 or 1e2..1e7*10; a list is 1|4|16",
            text);
    for (uint32_t i = 0; i <= RT_MAX_SWEEP_VALUES; i++, power *= step) {
        char number[RT_MAX_SWEPT_CHARS];
        value = factor ? low * power : low + i * step;
        if (value > high + 1e-9 * (high - low)) return RT_OK;
        snprintf(number, sizeof number, "%.9g", whole ? round(value) : value);
        RT_TRY(add_value(param, number, error));
    }
    return rt_fail(error, RT_BAD_INPUT, "'%s' is more than %d values: choose a larger step or factor", text,
                   RT_MAX_SWEEP_VALUES);
}

/* ---- accelerators of results ---- */

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

const char *rt_manifest_member(const json_t *manifest, uint32_t i, size_t member) {
    return json_string_value(json_array_get(json_object_get(entry_at(manifest, i), "best_of"), member));
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

/* ---- the text ---- */

static bool is_whole(const char *owner, const char *key, bool scene, const json_t *manifest) {
    const RtAccelOps *ops = NULL;
    const RtBuiltin *builtin = scene ? rt_builtin_find(owner) : NULL;
    if (!scene && manifest) return rt_manifest_is_whole(manifest, owner, key);
    if (!scene && rt_accel_find(owner, &ops, NULL) != RT_OK) return false;
    const RtParam *params = scene ? (builtin ? builtin->params : NULL) : ops->params;
    size_t count = scene ? (builtin ? builtin->param_count : 0) : ops->param_count;
    for (size_t i = 0; i < count; i++) {
        if (strcmp(params[i].name, key) == 0) return params[i].type == RT_PARAM_INT;
    }
    return false;
}

/* A '+' before a digit or a dot belongs to a step or an exponent, as in spec.c. */
static bool ends_layer(const char *c, bool scene) {
    return *c == '+' && !scene && !isdigit((unsigned char)c[1]) && c[1] != '.';
}

/* Reads the value at `start`, after the '=' of a parameter of `layer`. */
static RtStatus read_param(Sweep *sweep, const char *layer, size_t start, size_t length, bool scene,
                           const json_t *manifest, RtError *error) {
    const char *text = sweep->text;
    char owner[RT_MAX_NAME] = "", value[RT_MAX_SPEC_CHARS];
    size_t key = start - 1, name = strcspn(layer, ":");
    snprintf(value, sizeof value, "%.*s", (int)length, text + start);
    if (!strchr(value, '|') && !strstr(value, "..")) return RT_OK;
    while (key > 0 && text[key - 1] != ',' && text[key - 1] != ':') key--;
    if (sweep->param_count == RT_MAX_SWEPT)
        return rt_fail(error, RT_BAD_INPUT, "'%.80s' sweeps more than %d parameters", text, RT_MAX_SWEPT);
    SweptParam *param = &sweep->params[sweep->param_count];
    param->start = start;
    param->length = length;
    param->count = 0;
    snprintf(param->key, sizeof param->key, "%.*s", (int)(start - 1 - key), text + key);
    for (uint32_t i = 0; i < sweep->param_count; i++) {
        if (strcmp(sweep->params[i].key, param->key) != 0) continue;
        return rt_fail(error, RT_BAD_INPUT, "'%.80s' sweeps %s twice: sweep it in one of the accelerators",
                       text, param->key);
    }
    if (name < sizeof owner) snprintf(owner, sizeof owner, "%.*s", (int)name, layer);
    const bool whole = is_whole(owner, param->key, scene, manifest);
    for (char *rest = value, *part; (part = strsep(&rest, "|"));) {
        const char *dots = strstr(part, "..");
        RT_TRY(dots ? add_range(param, part, dots, whole, error) : add_value(param, part, error));
    }
    sweep->param_count++;
    sweep->count *= param->count; /* at most 2^16 by 2^8 */
    if (sweep->count <= UINT16_MAX) return RT_OK;
    return rt_fail(error, RT_BAD_INPUT, "'%.80s' stands for more than %d: sweep fewer values", text,
                   UINT16_MAX);
}

/* Reads `text`, a spec of a built-in scene (`scene`) or of an accelerator; files are never swept. Does not
 * check the resulting specs. `manifest` says which parameters are whole numbers for accelerators that this
 * build may lack; or NULL. */
static RtStatus parse_sweep(const char *text, bool scene, const json_t *manifest, Sweep *sweep,
                            RtError *error) {
    const char *layer = text;
    sweep->text = text;
    sweep->count = 1;
    sweep->param_count = 0;
    if (scene && !rt_builtin_find(text)) return RT_OK;
    for (const char *c = text; *c; c++) {
        if (ends_layer(c, scene)) layer = c + 1;
        if (*c != '=') continue;
        size_t length = 0;
        while (c[1 + length] && c[1 + length] != ',' && !ends_layer(c + 1 + length, scene)) length++;
        RT_TRY(read_param(sweep, layer, (size_t)(c + 1 - text), length, scene, manifest, error));
    }
    return RT_OK;
}

/* Spec number `i` < count to out[0..RT_MAX_SPEC_CHARS), with its swept values. */
static RtStatus spec_at(const Sweep *sweep, uint32_t i, char *out, RtSwept *swept, RtError *error) {
    uint32_t index[RT_MAX_SWEPT];
    size_t from = 0, used = 0;
    for (uint32_t p = sweep->param_count; p-- > 0; i /= sweep->params[p].count)
        index[p] = i % sweep->params[p].count;
    swept->count = sweep->param_count;
    for (uint32_t p = 0; p < sweep->param_count && used < RT_MAX_SPEC_CHARS; p++) {
        const SweptParam *param = &sweep->params[p];
        strcpy(swept->keys[p], param->key);
        strcpy(swept->values[p], param->values[index[p]]);
        used += (size_t)snprintf(out + used, RT_MAX_SPEC_CHARS - used, "%.*s%s", (int)(param->start - from),
                                 sweep->text + from, swept->values[p]);
        from = param->start + param->length;
    }
    if (used < RT_MAX_SPEC_CHARS)
        used += (size_t)snprintf(out + used, RT_MAX_SPEC_CHARS - used, "%s", sweep->text + from);
    if (used < RT_MAX_SPEC_CHARS) return RT_OK;
    return rt_fail(error, RT_BAD_INPUT, "'%.80s...': a spec has at most %d characters", sweep->text,
                   RT_MAX_SPEC_CHARS - 1);
}

/* The text without the swept parameters, "grid:depth=2" of "grid:density=1..8*2,depth=2", to out[0..size),
 * truncated. */
static void stem_of(const Sweep *sweep, char *out, size_t size) {
    const char *text = sweep->text;
    size_t used = 0, from = 0, end = strlen(text);
    for (uint32_t p = 0; p <= sweep->param_count; p++) {
        const SweptParam *param = &sweep->params[p];
        size_t to = p < sweep->param_count ? param->start - 1 - strlen(param->key) : end;
        for (; from < to && used + 1 < size; from++) out[used++] = text[from];
        if (p == sweep->param_count) break;
        from = param->start + param->length;
        /* Drops the comma after the parameter, or else the separator before it. */
        if (text[from] == ',')
            from++;
        else if (used > 0)
            used--;
    }
    out[used] = '\0';
}

/* ---- scenes ---- */

static RtStatus add_scene(RtExperiment *experiment, const RtWorkload *like, const Sweep *sweep, uint32_t i,
                          const char *folder, RtError *error) {
    char spec[RT_MAX_SPEC_CHARS], stem[RT_MAX_SPEC_CHARS];
    if (experiment->workload_count == RT_MAX_WORKLOADS)
        return rt_fail(error, RT_BAD_INPUT, "there are more than %d scenes: sweep fewer values",
                       RT_MAX_WORKLOADS);
    RtWorkload *workload = &experiment->workloads[experiment->workload_count++];
    *workload = *like;
    RT_TRY(spec_at(sweep, i, spec, &workload->swept, error));
    if (strlen(spec) >= sizeof workload->spec)
        return rt_fail(error, RT_BAD_INPUT, "%.40s...: a scene has at most %zu characters", spec,
                       sizeof workload->spec - 1);
    strcpy(workload->spec, spec);
    workload->file = strcspn(spec, "./") < strcspn(spec, ":");
    RT_TRY(rt_path_join(workload->file ? folder : "", spec, workload->path, error));
    stem_of(sweep, stem, sizeof stem);
    if (*like->label)
        return label_sweep(like->label, &workload->swept, workload->stem, workload->label, error);
    label_scene(experiment, workload, stem, spec);
    return RT_OK;
}

RtStatus rt_experiment_add_scenes(RtExperiment *experiment, const RtWorkload *like, const char *spec,
                                  const char *folder, RtError *error) {
    Sweep sweep;
    RT_TRY(parse_sweep(spec, true, NULL, &sweep, error));
    for (uint32_t i = 0; i < sweep.count; i++) RT_TRY(add_scene(experiment, like, &sweep, i, folder, error));
    return RT_OK;
}

/* ---- accelerators ---- */

static RtStatus add_accel(RtExperiment *experiment, const RtCandidate *like, const Sweep *sweep, uint32_t i,
                          RtError *error) {
    if (experiment->candidate_count == RT_MAX_CANDIDATES)
        return rt_fail(error, RT_BAD_INPUT, "there are more than %d accelerators: sweep fewer values",
                       RT_MAX_CANDIDATES);
    char spec[RT_MAX_SPEC_CHARS];
    RtCandidate *candidate = &experiment->candidates[experiment->candidate_count++];
    *candidate = *like;
    RT_TRY(spec_at(sweep, i, spec, &candidate->swept, error));
    strcpy(candidate->spec, spec);
    if (*like->label)
        return label_sweep(like->label, &candidate->swept, candidate->stem, candidate->label, error);
    stem_of(sweep, candidate->stem, sizeof candidate->stem);
    strcpy(candidate->label, spec);
    return RT_OK;
}

RtStatus rt_experiment_add_accels(RtExperiment *experiment, const RtCandidate *like, RtError *error) {
    Sweep sweep;
    RT_TRY(parse_sweep(like->spec, false, experiment->manifest, &sweep, error));
    for (uint32_t i = 0; i < sweep.count; i++) RT_TRY(add_accel(experiment, like, &sweep, i, error));
    return RT_OK;
}

/* ---- swept parameters ---- */

static uint32_t add_keys(const RtSwept *swept, bool scene, RtSweptKey *keys, uint32_t count) {
    for (uint32_t i = 0; i < swept->count; i++) {
        uint32_t k = 0;
        double number;
        while (k < count && (keys[k].scene != scene || strcmp(keys[k].key, swept->keys[i]) != 0)) k++;
        if (k == RT_MAX_SWEPT_KEYS) continue;
        if (k == count) keys[count++] = (RtSweptKey){swept->keys[i], scene, true};
        keys[k].number &= rt_swept_number(swept->values[i], &number);
    }
    return count;
}

uint32_t rt_experiment_swept(const RtExperiment *experiment, RtSweptKey keys[RT_MAX_SWEPT_KEYS]) {
    uint32_t count = 0;
    for (uint32_t t = 0; t < experiment->workload_count; t++)
        count = add_keys(&experiment->workloads[t].swept, true, keys, count);
    for (uint32_t c = 0; c < experiment->candidate_count; c++)
        count = add_keys(&experiment->candidates[c].swept, false, keys, count);
    return count;
}

const char *rt_swept_of(const RtExperiment *experiment, const RtSweptKey *key, uint32_t workload,
                        uint32_t candidate) {
    const RtSwept *swept = key->scene
                               ? &experiment->workloads[workload].swept
                               : &experiment->candidates[rt_candidate_built(experiment, candidate)].swept;
    for (uint32_t i = 0; i < swept->count; i++) {
        if (strcmp(swept->keys[i], key->key) == 0) return swept->values[i];
    }
    return NULL;
}
