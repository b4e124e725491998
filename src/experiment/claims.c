/* SPDX-License-Identifier: Apache-2.0 */
/* The parser of claims: words, read from left to right. */
#include "experiment/claims.h"

#include "core/base/words.h"

#include <stdarg.h>
#include <stdio.h>
#include <string.h>

static const char *const measures[] = {"time",  "object_tests", "extent_tests",
                                       "steps", "build_time",   "bytes"};
enum { MEASURES = sizeof measures / sizeof measures[0], MOST_WORDS = 32 };

typedef struct Reader {
    const RtExperiment *experiment;
    RtClaim *claim;
    RtError *error;
    char text[RT_MAX_CLAIM];
    const char *words[MOST_WORDS + 1]; /* "" after the last */
    uint32_t at, count;
} Reader;

/* ---- words ---- */

__attribute__((format(printf, 2, 3))) static RtStatus fail(const Reader *r, const char *format, ...) {
    char what[512];
    va_list args;
    va_start(args, format);
    /* clang-tidy 14 does not see va_start. NOLINTNEXTLINE(clang-analyzer-valist.Uninitialized) */
    vsnprintf(what, sizeof what, format, args);
    va_end(args);
    return rt_fail(
        r->error, RT_BAD_INPUT,
        "%s; claims are written as in 'object_tests of grid falls with density', 'ratio of time of grid to "
        "bvh on balls > 5' or 'exponent of time of bvh in n < 0.5' (experiments/README.md)",
        what);
}

static RtStatus split(Reader *r, const char *text) {
    if (strlen(text) >= sizeof r->text) return fail(r, "it has more than %d characters", RT_MAX_CLAIM - 1);
    strcpy(r->text, text);
    for (char *word = strtok(r->text, " "); word; word = strtok(NULL, " ")) {
        if (r->count == MOST_WORDS) return fail(r, "it has more than %d words", MOST_WORDS);
        r->words[r->count++] = word;
    }
    r->words[r->count] = "";
    return RT_OK;
}

static const char *word(const Reader *r) {
    return r->words[r->at];
}

static bool take(Reader *r, const char *expected) {
    bool is = strcmp(word(r), expected) == 0;
    r->at += is;
    return is;
}

static RtStatus need(Reader *r, const char *expected) {
    if (take(r, expected)) return RT_OK;
    return fail(r, "found '%s', expected '%s'", *word(r) ? word(r) : "nothing", expected);
}

/* ---- names ---- */

static RtStatus read_measure(Reader *r) {
    char suggestion[RT_MAX_SUGGESTION], list[128];
    for (uint32_t m = 0; m < MEASURES; m++) {
        if (!take(r, measures[m])) continue;
        r->claim->measure = (RtClaimMeasure)m;
        if (m != RT_CLAIM_TIME || !r->experiment->count_only) return RT_OK;
        return fail(r, "this experiment times nothing (count_only)");
    }
    rt_suggest(word(r), measures, MEASURES, suggestion);
    rt_join_names(measures, MEASURES, list, sizeof list);
    return fail(r, "'%s' is not a measure%s choose one of %s", word(r), *suggestion ? suggestion : ":", list);
}

/* The number of candidates with that label or stem; *last is one of them. */
static uint32_t count_accels(const RtExperiment *experiment, const char *name, uint32_t *last) {
    uint32_t count = 0;
    for (uint32_t c = 0; c < experiment->candidate_count; c++) {
        if (!rt_candidate_is_called(&experiment->candidates[c], name)) continue;
        *last = c;
        count++;
    }
    return count;
}

static RtStatus read_accel(Reader *r) {
    uint32_t last;
    if (count_accels(r->experiment, word(r), &last) == 0) {
        return fail(r, "'%s' is not the label of one of the accelerators", word(r));
    }
    snprintf(r->claim->accel, RT_MAX_LABEL, "%s", r->words[r->at++]);
    return RT_OK;
}

static RtStatus read_other(Reader *r) {
    uint32_t count = count_accels(r->experiment, word(r), &r->claim->other);
    if (count == 0) return fail(r, "'%s' is not the label of one of the accelerators", word(r));
    if (count > 1) {
        return fail(r, "'%s' names %u accelerators: name one of them, as in '%s'", word(r), count,
                    r->experiment->candidates[r->claim->other].label);
    }
    r->at++;
    return RT_OK;
}

static RtStatus read_scene(Reader *r) {
    bool found = false;
    for (uint32_t t = 0; t < r->experiment->workload_count; t++)
        found |= rt_workload_is_called(&r->experiment->workloads[t], word(r));
    if (!found) return fail(r, "'%s' is not the label of one of the scenes", word(r));
    snprintf(r->claim->scene, RT_MAX_LABEL, "%s", r->words[r->at++]);
    return RT_OK;
}

/* name[0..length) is "n", "scene.n" or "accel.n". */
static RtStatus find_key(const Reader *r, const char *name, size_t length, RtSweptKey *key) {
    RtSweptKey keys[RT_MAX_SWEPT_KEYS];
    uint32_t count = rt_experiment_swept(r->experiment, keys), found = 0;
    for (uint32_t k = 0; k < count; k++) {
        char full[RT_MAX_NAME + 8];
        snprintf(full, sizeof full, "%s.%s", keys[k].scene ? "scene" : "accel", keys[k].key);
        bool is = strlen(full) == length && strncmp(full, name, length) == 0;
        is |= strlen(keys[k].key) == length && strncmp(keys[k].key, name, length) == 0;
        if (!is) continue;
        *key = keys[k];
        found++;
    }
    if (found == 0) return fail(r, "'%.*s' is not a swept parameter", (int)length, name);
    if (found == 1) return RT_OK;
    return fail(r, "scenes and accelerators both sweep '%.*s': write scene.%.*s or accel.%.*s", (int)length,
                name, (int)length, name, (int)length, name);
}

static RtStatus read_axis(Reader *r) {
    RT_TRY(find_key(r, word(r), strlen(word(r)), &r->claim->key));
    if (!r->claim->key.number) return fail(r, "the values of '%s' are not numbers", word(r));
    r->at++;
    return RT_OK;
}

/* ---- places ---- */

static void extreme(const RtExperiment *experiment, const RtSweptKey *key, bool largest, char *value) {
    double best = 0;
    for (uint32_t t = 0; t < experiment->workload_count; t++) {
        for (uint32_t c = 0; c < experiment->candidate_count; c++) {
            const char *text = rt_swept_of(experiment, key, t, c);
            double number;
            if (!text || !rt_swept_number(text, &number)) continue;
            if (*value && (largest ? number <= best : number >= best)) continue;
            best = number;
            strcpy(value, text);
        }
    }
}

static RtStatus read_at(Reader *r) {
    RtClaim *claim = r->claim;
    bool largest = take(r, "largest"), smallest = !largest && take(r, "smallest");
    if (claim->place_count == RT_MAX_CLAIM_PLACES) return fail(r, "it names too many places (`at`)");
    RtSweptKey *key = &claim->places[claim->place_count].key;
    char *value = claim->places[claim->place_count++].value;
    size_t length = strcspn(word(r), "=");
    const char *given = word(r) + length;
    RT_TRY(find_key(r, word(r), length, key));
    if ((largest || smallest) != (*given == '\0')) {
        return fail(r, "write 'at largest PARAM', 'at smallest PARAM' or 'at PARAM=VALUE', not 'at %s%s'",
                    largest    ? "largest "
                    : smallest ? "smallest "
                               : "",
                    word(r));
    }
    if ((largest || smallest) && !key->number) return fail(r, "the values of '%s' are not numbers", word(r));
    if (largest || smallest)
        extreme(r->experiment, key, largest, value);
    else
        snprintf(value, RT_MAX_SWEPT_CHARS, "%s", given + 1);
    bool found = false;
    for (uint32_t t = 0; t < r->experiment->workload_count; t++) {
        for (uint32_t c = 0; c < r->experiment->candidate_count; c++) {
            const char *text = rt_swept_of(r->experiment, key, t, c);
            found |= text && strcmp(text, value) == 0;
        }
    }
    if (!found) return fail(r, "'%s' is not a value of '%.*s'", value, (int)length, word(r));
    r->at++;
    return RT_OK;
}

static RtStatus read_kind(Reader *r) {
    RtClaim *claim = r->claim;
    if (claim->measure >= RT_CLAIM_BUILD_TIME)
        return fail(r, "%s does not depend on the kind of rays", measures[claim->measure]);
    if (rt_ray_kind_parse(word(r), &claim->kind, NULL) != RT_OK ||
        !rt_experiment_has_kind(r->experiment, claim->kind))
        return fail(r, "this experiment has no '%s' rays", word(r));
    r->at++;
    return need(r, "rays");
}

static RtStatus read_places(Reader *r) {
    for (;;) {
        if (take(r, "on"))
            RT_TRY(read_scene(r));
        else if (take(r, "for"))
            RT_TRY(read_kind(r));
        else if (take(r, "at"))
            RT_TRY(read_at(r));
        else
            return RT_OK;
    }
}

/* ---- claims ---- */

static RtStatus read_trend(Reader *r) {
    bool never = take(r, "never"), falls = take(r, "falls"), rises = !falls && take(r, "rises");
    if (!falls && !rises) return fail(r, "found '%s', expected 'falls' or 'rises'", word(r));
    r->claim->form = RT_CLAIM_TREND;
    r->claim->strictly = !never;
    r->claim->rises = never ? falls : rises;
    RT_TRY(need(r, "with"));
    RT_TRY(read_axis(r));
    return read_places(r);
}

static RtStatus read_comparison(Reader *r) {
    static const char *const operators[] = {"<", "<=", ">", ">="};
    uint32_t i = 0;
    RT_TRY(read_places(r));
    while (i < 4 && !take(r, operators[i])) i++;
    if (i == 4) {
        return fail(r, "found '%s', expected one of < <= > >=", *word(r) ? word(r) : "nothing");
    }
    r->claim->greater = i >= 2;
    r->claim->or_equal = i % 2 == 1;
    if (!rt_swept_number(word(r), &r->claim->number)) return fail(r, "'%s' is not a number", word(r));
    r->at++;
    return RT_OK;
}

static RtStatus read_claim(Reader *r) {
    RtClaim *claim = r->claim;
    bool ratio = take(r, "ratio"), exponent = !ratio && take(r, "exponent");
    if (ratio || exponent) RT_TRY(need(r, "of"));
    RT_TRY(read_measure(r));
    RT_TRY(need(r, "of"));
    RT_TRY(read_accel(r));
    claim->form = ratio ? RT_CLAIM_RATIO : exponent ? RT_CLAIM_EXPONENT : RT_CLAIM_VALUE;
    if (ratio) RT_TRY(need(r, "to"));
    if (ratio) RT_TRY(read_other(r));
    if (exponent) RT_TRY(need(r, "in"));
    if (exponent) RT_TRY(read_axis(r));
    bool trend =
        strcmp(word(r), "falls") == 0 || strcmp(word(r), "rises") == 0 || strcmp(word(r), "never") == 0;
    if (claim->form == RT_CLAIM_VALUE && trend) return read_trend(r);
    return read_comparison(r);
}

RtStatus rt_claim_parse(const RtExperiment *experiment, const char *text, RtClaim *claim, RtError *error) {
    Reader r = {.experiment = experiment, .claim = claim, .error = error};
    *claim = (RtClaim){.kind = RT_ALL_RAYS};
    RT_TRY(split(&r, text));
    RT_TRY(read_claim(&r));
    return r.at == r.count ? RT_OK : fail(&r, "unexpected '%s' at its end", word(&r));
}
