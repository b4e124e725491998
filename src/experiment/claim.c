/* SPDX-License-Identifier: Apache-2.0 */
/* The parser of claims: words, read from left to right. */
#include "experiment/claim.h"

#include "core/base/words.h"

#include <inttypes.h>
#include <stdarg.h>
#include <stdio.h>
#include <string.h>

static const char *const measures[] = {
#define NAME(CONSTANT, name, unit) name,
    RT_CLAIM_MEASURES(NAME)
#undef NAME
};
static const char objects[] = "objects";
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

/* A claim that begins with the same word. */
static const char *example(const Reader *r) {
    static const char *const examples[] = {"exponent of time of bvh in n < 0.5",
                                           "crossover of time of octree and grid in n > 1e4",
                                           "correlation of predicted_cost and time of bvh > 0.9"};
    size_t i = sizeof examples / sizeof examples[0];
    while (--i > 0 && (r->count == 0 || strncmp(examples[i], r->words[0], strcspn(examples[i], " ")) != 0))
        continue;
    return examples[i];
}

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
        "bvh on balls > 5' or '%s' (experiments/README.md)",
        what, example(r));
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

/* Names to choose from, each once. */
typedef struct Choice {
    uint32_t count;
    const char *names[2 * RT_MAX_CANDIDATES + RT_MAX_SWEPT_KEYS + MEASURES];
} Choice;

static void offer(Choice *choice, const char *name) {
    uint32_t i = 0;
    while (i < choice->count && strcmp(choice->names[i], name) != 0) i++;
    if (i == choice->count) choice->names[choice->count++] = name;
}

/* "'WORD' is not WHAT: did you mean 'NAME'? choose one of ..." */
static RtStatus fail_choice(const Reader *r, const char *wrong, const char *what, const Choice *choice) {
    enum { MOST_SHOWN = 24 };
    char suggestion[RT_MAX_SUGGESTION], list[256];
    const uint32_t shown = choice->count < MOST_SHOWN ? choice->count : MOST_SHOWN;
    rt_suggest(wrong, choice->names, choice->count, suggestion);
    rt_join_names(choice->names, shown, list, sizeof list);
    return fail(r, "'%.*s' is not %s%s choose one of %s%s", RT_MAX_LABEL, wrong, what,
                *suggestion ? suggestion : ":", list, shown < choice->count ? ", ..." : "");
}

static RtStatus read_measure(Reader *r, RtClaimMeasure *measure) {
    Choice choice = {0};
    for (uint32_t m = 0; m < MEASURES; m++) {
        offer(&choice, measures[m]);
        if (!take(r, measures[m])) continue;
        *measure = (RtClaimMeasure)m;
        const bool rendered = m == RT_CLAIM_RENDER_TIME || m == RT_CLAIM_QUERY_SHARE;
        const bool timed = rendered || m == RT_CLAIM_TIME || m == RT_CLAIM_BREAK_EVEN;
        if (timed && r->experiment->count_only) return fail(r, "this experiment times nothing (count_only)");
        if (rendered && !r->experiment->render) return fail(r, "%s needs `render: yes`", measures[m]);
        return RT_OK;
    }
    return fail_choice(r, word(r), "a measure", &choice);
}

static RtStatus read_accel(Reader *r, char accel[RT_MAX_LABEL], bool may_be_all) {
    const RtExperiment *experiment = r->experiment;
    Choice choice = {0};
    bool found = may_be_all && strcmp(word(r), RT_CLAIM_ALL) == 0, best = false;
    for (uint32_t c = 0; c < experiment->candidate_count; c++) {
        offer(&choice, experiment->candidates[c].stem);
        const bool called = rt_candidate_is_called(&experiment->candidates[c], word(r));
        found |= called;
        best |= called && experiment->candidates[c].member_count > 0;
    }
    for (uint32_t c = 0; c < experiment->candidate_count; c++)
        offer(&choice, experiment->candidates[c].label);
    if (!found) return fail_choice(r, word(r), "the label of one of the accelerators", &choice);
    const RtClaimMeasure of_structure =
        r->claim->first >= RT_CLAIM_BUILD_TIME ? r->claim->first : r->claim->measure;
    if (best && of_structure >= RT_CLAIM_BUILD_TIME)
        return fail(r,
                    "'%s' is another setting for each kind of rays, each with its own %s: name one of them",
                    word(r), measures[of_structure]);
    snprintf(accel, RT_MAX_LABEL, "%s", r->words[r->at++]);
    return RT_OK;
}

/* After the parameter is read, because the other accelerator may sweep that, too. */
static RtStatus check_other(const Reader *r) {
    const RtExperiment *experiment = r->experiment;
    for (uint32_t t = 0; t < experiment->workload_count; t++) {
        for (uint32_t c = 0; c < experiment->candidate_count; c++) {
            if (!rt_candidate_is_called(&experiment->candidates[c], r->claim->other)) continue;
            uint32_t count = 0; /* that the other could be as well */
            for (uint32_t i = 0; i < experiment->candidate_count; i++)
                count += !(experiment->candidates[i].excluded >> t & 1) &&
                         rt_claim_is_other(experiment, r->claim, t, c, i);
            if (count <= 1) continue;
            return fail(r, "'%s' names %" PRIu32 " accelerators: name one of them, as in '%s'",
                        r->claim->other, count, experiment->candidates[c].label);
        }
    }
    return RT_OK;
}

static RtStatus read_scene(Reader *r) {
    Choice choice = {0};
    bool found = false;
    if (*r->claim->scene) return fail(r, "it names two scenes (`on`)");
    for (uint32_t t = 0; t < r->experiment->workload_count; t++) {
        offer(&choice, r->experiment->workloads[t].stem);
        found |= rt_workload_is_called(&r->experiment->workloads[t], word(r));
    }
    for (uint32_t t = 0; t < r->experiment->workload_count; t++)
        offer(&choice, r->experiment->workloads[t].label);
    if (!found) return fail_choice(r, word(r), "the label of one of the scenes", &choice);
    snprintf(r->claim->scene, RT_MAX_LABEL, "%s", r->words[r->at++]);
    return RT_OK;
}

/* name[0..length) is "n", "scene.n" or "accel.n"; `choice` has what else it could have been. */
static RtStatus find_key(const Reader *r, const char *name, size_t length, Choice *choice, RtSweptKey *key) {
    RtSweptKey keys[RT_MAX_SWEPT_KEYS];
    uint32_t count = rt_experiment_swept(r->experiment, keys), found = 0;
    char wrong[RT_MAX_LABEL];
    for (uint32_t k = 0; k < count; k++) {
        offer(choice, keys[k].key);
        char full[RT_MAX_NAME + 8];
        snprintf(full, sizeof full, "%s.%s", keys[k].scene ? "scene" : "accel", keys[k].key);
        bool is = strlen(full) == length && strncmp(full, name, length) == 0;
        is |= strlen(keys[k].key) == length && strncmp(keys[k].key, name, length) == 0;
        if (!is) continue;
        *key = keys[k];
        found++;
    }
    snprintf(wrong, sizeof wrong, "%.*s", (int)length, name);
    if (found == 0 && choice->count == 0)
        return fail(r, "'%s' is not a swept parameter: none is swept", wrong);
    if (found == 0) return fail_choice(r, wrong, "a swept parameter", choice);
    if (found == 1) return RT_OK;
    return fail(r, "scenes and accelerators both sweep '%.*s': write scene.%.*s or accel.%.*s", (int)length,
                name, (int)length, name, (int)length, name);
}

static RtStatus read_axis(Reader *r) {
    Choice choice = {1, {objects}};
    r->claim->by_objects = take(r, objects);
    if (r->claim->by_objects) {
        r->claim->key = (RtSweptKey){objects, .scene = true, .number = true};
        return RT_OK;
    }
    RT_TRY(find_key(r, word(r), strlen(word(r)), &choice, &r->claim->key));
    if (!r->claim->key.number) return fail(r, "the values of '%s' are not numbers", word(r));
    r->at++;
    return RT_OK;
}

/* ---- places ---- */

static RtStatus read_at(Reader *r) {
    RtClaim *claim = r->claim;
    bool largest = take(r, "largest"), smallest = !largest && take(r, "smallest");
    if (claim->place_count == RT_MAX_CLAIM_PLACES) return fail(r, "it names too many places (`at`)");
    RtSweptKey *key = &claim->places[claim->place_count].key;
    char *value = claim->places[claim->place_count++].value;
    size_t length = strcspn(word(r), "=");
    const char *given = word(r) + length;
    Choice parameters = {0}, values = {0};
    RT_TRY(find_key(r, word(r), length, &parameters, key));
    if ((largest || smallest) != (*given == '\0')) {
        return fail(r, "write 'at largest PARAM', 'at smallest PARAM' or 'at PARAM=VALUE', not 'at %s%s'",
                    largest    ? "largest "
                    : smallest ? "smallest "
                               : "",
                    word(r));
    }
    if ((largest || smallest) && !key->number) return fail(r, "the values of '%s' are not numbers", word(r));
    for (uint32_t t = 0; t < r->experiment->workload_count; t++) {
        for (uint32_t c = 0; c < r->experiment->candidate_count; c++) {
            const char *text = rt_swept_of(r->experiment, key, t, c);
            if (text) offer(&values, text);
        }
    }
    bool found = false;
    double best = 0, number;
    if (!largest && !smallest) snprintf(value, RT_MAX_SWEPT_CHARS, "%s", given + 1);
    for (uint32_t i = 0; i < values.count; i++) {
        if ((largest || smallest) && rt_swept_number(values.names[i], &number) &&
            (!*value || (largest ? number > best : number < best))) {
            best = number;
            strcpy(value, values.names[i]);
        }
        found |= rt_swept_equal(values.names[i], value);
    }
    char what[RT_MAX_LABEL];
    snprintf(what, sizeof what, "a value of %s", key->key);
    if (!found) return fail_choice(r, value, what, &values);
    r->at++;
    return RT_OK;
}

static RtStatus read_kind(Reader *r) {
    RtClaim *claim = r->claim;
    if (!rt_claim_is_of_rays(claim))
        return fail(r, "%s does not depend on the kind of rays", measures[claim->measure]);
    if (!claim->each_kind) return fail(r, "it names two kinds of rays (`for`)");
    claim->each_kind = false;
    if (take(r, RT_CLAIM_ALL)) return need(r, "rays");
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
    r->claim->readout = r->at == r->count;
    if (r->claim->readout) return RT_OK;
    while (i < 4 && !take(r, operators[i])) i++;
    if (i == 4)
        return fail(r, "found '%s', expected `falls with`, `rises with` or one of < <= > >=", word(r));
    r->claim->greater = i >= 2;
    r->claim->or_equal = i % 2 == 1;
    if (!rt_swept_number(word(r), &r->claim->number)) return fail(r, "'%s' is not a number", word(r));
    r->at++;
    return RT_OK;
}

static RtStatus read_claim(Reader *r) {
    static const char *const forms[] = {[RT_CLAIM_RATIO] = "ratio",
                                        [RT_CLAIM_EXPONENT] = "exponent",
                                        [RT_CLAIM_CROSSOVER] = "crossover",
                                        [RT_CLAIM_CORRELATION] = "correlation"};
    RtClaim *claim = r->claim; /* a value begins with its measure */
    for (uint32_t form = RT_CLAIM_RATIO; form <= RT_CLAIM_CORRELATION && claim->form == RT_CLAIM_VALUE;
         form++) {
        if (take(r, forms[form])) claim->form = (RtClaimForm)form;
    }
    if (claim->form != RT_CLAIM_VALUE) RT_TRY(need(r, "of"));
    const bool ratio = claim->form == RT_CLAIM_RATIO, crossover = claim->form == RT_CLAIM_CROSSOVER;
    RT_TRY(read_measure(r, &claim->measure));
    claim->first = claim->measure;
    if (claim->form == RT_CLAIM_CORRELATION) {
        RT_TRY(need(r, "and"));
        RT_TRY(read_measure(r, &claim->measure));
    }
    RT_TRY(need(r, "of"));
    RT_TRY(read_accel(r, claim->accel, true));
    if (ratio || crossover) {
        RT_TRY(need(r, ratio ? "to" : "and"));
        RT_TRY(read_accel(r, claim->other, false));
    }
    if (crossover || claim->form == RT_CLAIM_EXPONENT) {
        RT_TRY(need(r, "in"));
        RT_TRY(read_axis(r));
    }
    if (*claim->other) RT_TRY(check_other(r));
    bool trend =
        strcmp(word(r), "falls") == 0 || strcmp(word(r), "rises") == 0 || strcmp(word(r), "never") == 0;
    if (claim->form == RT_CLAIM_VALUE && trend) return read_trend(r);
    return read_comparison(r);
}

bool rt_claim_is_of_rays(const RtClaim *claim) {
    return claim->measure < RT_CLAIM_BUILD_TIME || claim->first < RT_CLAIM_BUILD_TIME;
}

bool rt_claim_is_other(const RtExperiment *experiment, const RtClaim *claim, uint32_t t, uint32_t c,
                       uint32_t other) {
    const bool swept = claim->key.key && !claim->key.scene;
    if (!rt_candidate_is_called(&experiment->candidates[other], claim->other)) return false;
    const char *own = swept ? rt_swept_of(experiment, &claim->key, t, c) : NULL;
    const char *its = own ? rt_swept_of(experiment, &claim->key, t, other) : NULL;
    return !its || rt_swept_equal(its, own);
}

RtStatus rt_claim_parse(const RtExperiment *experiment, const char *text, RtClaim *claim, RtError *error) {
    Reader r = {.experiment = experiment, .claim = claim, .error = error};
    *claim = (RtClaim){.each_kind = true, .kind = RT_ALL_RAYS};
    RT_TRY(split(&r, text));
    RT_TRY(read_claim(&r));
    claim->each_kind &= rt_claim_is_of_rays(claim);
    return r.at == r.count ? RT_OK : fail(&r, "unexpected '%s' at its end", word(&r));
}
