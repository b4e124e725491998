/* SPDX-License-Identifier: Apache-2.0 */
/* The parser of claims: words, read from left to right. */
#include "experiment/claim.h"

#include "core/base/words.h"

#include <inttypes.h>
#include <stdarg.h>
#include <stdio.h>
#include <string.h>

typedef struct Measure {
    const char *name, *unit;
    RtClaimSubject subject;
} Measure;
static const Measure measures[] = {
#define MEASURE(CONSTANT, name, unit, subject) {name, unit, RT_SUBJECT_##subject},
    RT_CLAIM_MEASURES(MEASURE)
#undef MEASURE
};
static const char objects[] = "objects";
enum { MEASURES = sizeof measures / sizeof measures[0], MOST_WORDS = 48 };

const char *rt_claim_measure_unit(RtClaimMeasure measure) {
    return measures[measure].unit;
}

RtClaimSubject rt_claim_subject(RtClaimMeasure measure) {
    return measures[measure].subject;
}

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
    static const char *const examples[] = {
        "exponent of time of bvh in n < 0.5", "crossover of time of octree and grid in n > 1e4",
        "correlation of predicted_cost and time of bvh > 0.9",
        "geometric mean of ratio of time of grid to bvh", "count of ratio of time of grid to bvh < 1"};
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

/* MEASURES if the word is none. */
static uint32_t measure_at(const Reader *r, uint32_t at) {
    uint32_t m = 0;
    while (m < MEASURES && strcmp(r->words[at], measures[m].name) != 0) m++;
    return m;
}

static RtStatus read_measure(Reader *r, RtClaimMeasure *measure) {
    const uint32_t m = measure_at(r, r->at);
    if (m == MEASURES) {
        Choice choice = {0};
        for (uint32_t i = 0; i < MEASURES; i++) offer(&choice, measures[i].name);
        return fail_choice(r, word(r), "a measure", &choice);
    }
    const bool rendered = m == RT_CLAIM_RENDER_TIME || m == RT_CLAIM_QUERY_SHARE;
    const bool timed = rendered || m == RT_CLAIM_TIME || m == RT_CLAIM_BREAK_EVEN || m == RT_CLAIM_FRAME_TIME;
    r->at++;
    *measure = (RtClaimMeasure)m;
    if (timed && r->experiment->count_only) return fail(r, "this experiment times nothing (count_only)");
    if (rendered && !r->experiment->render) return fail(r, "%s needs `render: yes`", measures[m].name);
    return RT_OK;
}

/* Whether an accelerator has that name; or, with `best`, a best-of. */
static bool is_accel(const Reader *r, const char *name, bool best) {
    for (uint32_t c = 0; c < r->experiment->candidate_count; c++) {
        const RtCandidate *candidate = &r->experiment->candidates[c];
        if (rt_candidate_is_called(candidate, name) && (!best || candidate->member_count > 0)) return true;
    }
    return false;
}

static RtStatus read_accel(Reader *r, RtClaimSide *side, bool may_be_all) {
    const RtExperiment *experiment = r->experiment;
    Choice choice = {0};
    for (uint32_t c = 0; c < experiment->candidate_count; c++) offer(&choice, experiment->candidates[c].stem);
    for (uint32_t c = 0; c < experiment->candidate_count; c++)
        offer(&choice, experiment->candidates[c].label);
    if (!is_accel(r, word(r), false) && !(may_be_all && strcmp(word(r), RT_CLAIM_ALL) == 0))
        return fail_choice(r, word(r), "the label of one of the accelerators", &choice);
    if (is_accel(r, word(r), true) && measures[side->measure].subject == RT_SUBJECT_STRUCTURE)
        return fail(r,
                    "'%s' is another setting for each kind of rays, each with its own %s: name one of them",
                    word(r), measures[side->measure].name);
    snprintf(side->accel, RT_MAX_LABEL, "%s", r->words[r->at++]);
    return RT_OK;
}

static bool has_accel(RtClaimMeasure measure) {
    return measures[measure].subject < RT_SUBJECT_SET;
}

/* MEASURE of ACCEL; or a measure that is the same for all. */
static RtStatus read_side(Reader *r, RtClaimSide *side, bool may_be_all) {
    RT_TRY(read_measure(r, &side->measure));
    if (has_accel(side->measure)) {
        RT_TRY(need(r, "of"));
        return read_accel(r, side, may_be_all);
    }
    if (strcmp(word(r), "of") != 0) return RT_OK;
    return fail(r, "%s is the same for all accelerators: leave 'of %s' out, and say 'on SCENE'",
                measures[side->measure].name, r->words[r->at + 1]);
}

/* After the parameter is read, because the second accelerator may sweep that, too. */
static RtStatus check_second(const Reader *r) {
    const RtExperiment *experiment = r->experiment;
    const RtClaim *claim = r->claim;
    bool differs = !claim->apart;
    for (uint32_t t = 0; t < experiment->workload_count; t++) {
        for (uint32_t c = 0; c < experiment->candidate_count; c++) {
            const RtClaimCell cell = {t, c, claim->first.kind};
            RtClaimCell partner = cell;
            const char *accel = claim->apart ? claim->first.accel : claim->second.accel;
            const bool called = !*accel || strcmp(accel, RT_CLAIM_ALL) == 0 ||
                                rt_candidate_is_called(&experiment->candidates[c], accel);
            if (!called || (claim->apart && !rt_claim_side_has(experiment, &claim->first, t, c))) continue;
            const uint32_t count = rt_claim_partner(experiment, claim, &cell, &partner);
            differs |= count > 0 && (partner.workload != t || partner.candidate != c);
            if (count > 1 && claim->apart)
                return fail(r, "the second side of the ratio is %" PRIu32 " cells: say which, as on SCENE",
                            count);
            if (count > 1)
                return fail(r, "'%s' names %" PRIu32 " accelerators: name one of them, as in '%s'",
                            claim->second.accel, count, experiment->candidates[c].label);
        }
    }
    differs |= claim->first.kind != claim->second.kind || claim->first.measure != claim->second.measure;
    return differs ? RT_OK : fail(r, "both sides of the ratio are the same cells");
}

static RtStatus read_scene(Reader *r, RtClaimSide *side) {
    Choice choice = {0};
    bool found = false;
    if (*side->scene) return fail(r, "it names two scenes (`on`)");
    for (uint32_t t = 0; t < r->experiment->workload_count; t++) {
        offer(&choice, r->experiment->workloads[t].stem);
        found |= rt_workload_is_called(&r->experiment->workloads[t], word(r));
    }
    for (uint32_t t = 0; t < r->experiment->workload_count; t++)
        offer(&choice, r->experiment->workloads[t].label);
    if (!found) return fail_choice(r, word(r), "the label of one of the scenes", &choice);
    snprintf(side->scene, RT_MAX_LABEL, "%s", r->words[r->at++]);
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

static RtStatus read_at(Reader *r, RtClaimSide *side) {
    bool largest = take(r, "largest"), smallest = !largest && take(r, "smallest");
    if (side->place_count == RT_MAX_CLAIM_PLACES) return fail(r, "it names too many places (`at`)");
    RtSweptKey *key = &side->places[side->place_count].key;
    char *value = side->places[side->place_count++].value;
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

static RtStatus read_kind(Reader *r, RtClaimSide *side) {
    if (!rt_claim_is_of_rays(r->claim))
        return fail(r, "%s does not depend on the kind of rays", measures[side->measure].name);
    if (!side->each_kind) return fail(r, "it names two kinds of rays (`for`)");
    side->each_kind = false;
    if (take(r, RT_CLAIM_ALL)) return need(r, "rays");
    if (rt_ray_kind_parse(word(r), &side->kind, NULL) != RT_OK ||
        !rt_experiment_has_kind(r->experiment, side->kind))
        return fail(r, "this experiment has no '%s' rays", word(r));
    r->at++;
    return need(r, "rays");
}

static RtStatus read_places(Reader *r, RtClaimSide *side) {
    for (;;) {
        if (take(r, "on"))
            RT_TRY(read_scene(r, side));
        else if (take(r, "for"))
            RT_TRY(read_kind(r, side));
        else if (take(r, "at"))
            RT_TRY(read_at(r, side));
        else
            return RT_OK;
    }
}

static bool names_place(const RtClaimSide *side) {
    return *side->scene || !side->each_kind || side->place_count > 0;
}

/* Whether a cell of the side has a value of the parameter. */
static bool sweeps(const RtExperiment *experiment, const RtClaimSide *side, const RtSweptKey *key) {
    for (uint32_t t = 0; t < experiment->workload_count; t++) {
        for (uint32_t c = 0; c < experiment->candidate_count; c++) {
            const bool of = strcmp(side->accel, RT_CLAIM_ALL) == 0 ||
                            rt_candidate_is_called(&experiment->candidates[c], side->accel);
            if ((of || key->scene) && rt_swept_of(experiment, key, t, c)) return true;
        }
    }
    return false;
}

static const char *value_of(const RtClaimSide *side, const RtSweptKey *key) {
    for (uint32_t p = 0; p < side->place_count; p++) {
        const RtSweptKey *own = &side->places[p].key;
        if (own->scene == key->scene && strcmp(own->key, key->key) == 0) return side->places[p].value;
    }
    return NULL;
}

/* Places of a parameter that only the other side has are not this one's. */
static void drop_places(const RtExperiment *experiment, RtClaimSide *side) {
    uint32_t kept = 0;
    for (uint32_t p = 0; p < side->place_count; p++) {
        if (sweeps(experiment, side, &side->places[p].key)) side->places[kept++] = side->places[p];
    }
    side->place_count = kept;
}

/* What `side` does not name is as in `other`. */
static void inherit_places(const RtExperiment *experiment, const RtClaimSide *other, RtClaimSide *side) {
    if (!*side->scene) memcpy(side->scene, other->scene, sizeof side->scene);
    if (side->each_kind) side->kind = other->kind;
    side->each_kind &= other->each_kind;
    for (uint32_t p = 0; p < other->place_count; p++) {
        const RtClaimPlace *place = &other->places[p];
        if (side->place_count < RT_MAX_CLAIM_PLACES && !value_of(side, &place->key) &&
            sweeps(experiment, side, &place->key))
            side->places[side->place_count++] = *place;
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
    return read_places(r, &r->claim->first);
}

/* [plain] [WORD [less | more]] */
static RtStatus read_format(Reader *r) {
    static const struct {
        const char *name, *of; /* of: the unit of the measure; NULL: any; "": none */
        double scale;
        const char *unit;
    } formats[] = {{"times", "", 1, " times"},
                   {"percent", "", 100, " %"},
                   {"ms", " s", 1e3, " ms"},
                   {"us", " s", 1e6, " us"},
                   {"MB", " bytes", 1e-6, " MB"},
                   {"thousands", NULL, 1e-3, " thousand"},
                   {"millions", NULL, 1e-6, " million"}};
    const RtClaim *claim = r->claim;
    RtClaimFormat *format = &r->claim->format;
    const RtClaimMeasure measure = claim->first.measure;
    const char *unit = claim->form != RT_CLAIM_VALUE ? ""
                       : measure == RT_CLAIM_TIME    ? " s"
                                                     : measures[measure].unit;
    Choice choice = {0};
    uint32_t i = 0, count = sizeof formats / sizeof formats[0];
    format->plain = take(r, "plain");
    if (format->plain && r->at == r->count) return RT_OK;
    for (i = 0; i < count; i++) offer(&choice, formats[i].name);
    offer(&choice, "plain");
    for (i = 0; i < count && !take(r, formats[i].name);) i++;
    if (i == count) return fail_choice(r, word(r), "a format", &choice);
    if (formats[i].of && strcmp(formats[i].of, unit) != 0)
        return fail(r, "'as %s' does not fit %s", formats[i].name,
                    claim->form == RT_CLAIM_VALUE ? measures[measure].name : "this figure");
    *format = (RtClaimFormat){formats[i].scale, 0, formats[i].unit, format->plain};
    const bool less = formats[i].scale == 100 && take(r, "less");
    const bool more = formats[i].scale == 100 && !less && take(r, "more");
    if (less) *format = (RtClaimFormat){-100, 100, " % less", format->plain};
    if (more) *format = (RtClaimFormat){100, -100, " % more", format->plain};
    return RT_OK;
}

static RtStatus read_comparison(Reader *r) {
    static const char *const operators[] = {"<", "<=", ">", ">="};
    uint32_t i = 0;
    r->claim->readout = r->at == r->count || strcmp(word(r), "as") == 0;
    if (take(r, "as")) return read_format(r);
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

/* After "ratio of". Places before "to" are of the first side; else those at the end are of both. */
static RtStatus read_ratio(Reader *r) {
    RtClaim *claim = r->claim;
    RtClaimSide *first = &claim->first, *second = &claim->second;
    RT_TRY(read_side(r, first, true));
    second->measure = first->measure;
    RT_TRY(read_places(r, first));
    RT_TRY(need(r, "to"));
    const uint32_t m = measure_at(r, r->at);
    const bool own =
        m < MEASURES && (!has_accel((RtClaimMeasure)m) || strcmp(r->words[r->at + 1], "of") == 0);
    claim->apart = names_place(first) || !*first->accel;
    RT_TRY(own || !*first->accel ? read_side(r, second, false) : read_accel(r, second, false));
    RT_TRY(read_places(r, second));
    if (!claim->apart && *second->accel) {
        const RtClaimMeasure measure = first->measure;
        char accel[RT_MAX_LABEL];
        memcpy(accel, first->accel, sizeof accel);
        *first = *second;
        first->measure = measure;
        memcpy(first->accel, accel, sizeof accel);
        return check_second(r);
    }
    claim->apart = true;
    inherit_places(r->experiment, second, first);
    drop_places(r->experiment, second);
    inherit_places(r->experiment, first, second);
    return check_second(r);
}

/* After "crossover of". */
static RtStatus read_crossover(Reader *r) {
    RtClaim *claim = r->claim;
    RT_TRY(read_side(r, &claim->first, true));
    claim->second.measure = claim->first.measure;
    RT_TRY(need(r, "and"));
    RT_TRY(read_accel(r, &claim->second, false));
    RT_TRY(need(r, "in"));
    RT_TRY(read_axis(r));
    RT_TRY(check_second(r));
    return read_places(r, &claim->first);
}

static RtStatus read_correlation(Reader *r) {
    RtClaim *claim = r->claim;
    RT_TRY(read_measure(r, &claim->first.measure));
    RT_TRY(need(r, "and"));
    RT_TRY(read_measure(r, &claim->second.measure));
    RT_TRY(need(r, "of"));
    /* Of a structure, if one of the measures is. */
    const RtClaimMeasure first = claim->first.measure;
    if (measures[first].subject != RT_SUBJECT_STRUCTURE) claim->first.measure = claim->second.measure;
    RT_TRY(read_accel(r, &claim->first, true));
    claim->first.measure = first;
    return read_places(r, &claim->first);
}

/* Whether [ACCEL is] fastest or [ACCEL has] least comes next. */
static bool begins_least(const Reader *r) {
    const char *next = r->at < r->count ? r->words[r->at + 1] : "";
    const bool named = is_accel(r, word(r), false) && (strcmp(next, "is") == 0 || strcmp(next, "has") == 0);
    return named || strcmp(word(r), "fastest") == 0 || strcmp(word(r), "least") == 0;
}

/* A claim is the ratio to each other accelerator, at most 1; without ACCEL it is a readout. */
static RtStatus read_least(Reader *r) {
    RtClaim *claim = r->claim;
    RtClaimSide *first = &claim->first;
    const uint32_t accel = r->at;
    claim->form = RT_CLAIM_LEAST;
    claim->readout = !is_accel(r, word(r), false);
    claim->or_equal = true;
    claim->number = 1;
    r->at += claim->readout ? 0 : 1;
    const bool fastest = claim->readout ? take(r, "fastest") : take(r, "is");
    if (!claim->readout) RT_TRY(need(r, fastest ? "fastest" : "has"));
    if (!fastest) RT_TRY(need(r, "least"));
    if (!fastest) RT_TRY(read_measure(r, &first->measure));
    if (fastest && r->experiment->count_only) return fail(r, "this experiment times nothing (count_only)");
    if (!has_accel(first->measure) || first->measure == RT_CLAIM_BREAK_EVEN)
        return fail(r, "%s does not rank accelerators", measures[first->measure].name);
    if (!claim->readout) {
        const uint32_t end = r->at;
        r->at = accel;
        RT_TRY(read_accel(r, first, false));
        r->at = end;
        claim->second = *first;
        RT_TRY(check_second(r)); /* one accelerator on each scene */
    }
    return read_places(r, first);
}

static bool begins_trend(const Reader *r) {
    return strcmp(word(r), "falls") == 0 || strcmp(word(r), "rises") == 0 || strcmp(word(r), "never") == 0;
}

static RtStatus read_quantity(Reader *r) {
    RtClaim *claim = r->claim;
    static const char *const forms[] = {[RT_CLAIM_RATIO] = "ratio",
                                        [RT_CLAIM_EXPONENT] = "exponent",
                                        [RT_CLAIM_CROSSOVER] = "crossover",
                                        [RT_CLAIM_CORRELATION] = "correlation"};
    for (uint32_t form = 0; form <= RT_CLAIM_CORRELATION && claim->form == RT_CLAIM_VALUE; form++) {
        if (forms[form] && take(r, forms[form])) claim->form = (RtClaimForm)form;
    }
    if (claim->form != RT_CLAIM_VALUE) RT_TRY(need(r, "of"));
    if (claim->mean && claim->form > RT_CLAIM_RATIO)
        return fail(r, "a geometric mean is of values or of ratios");
    switch (claim->form) {
    case RT_CLAIM_RATIO: return read_ratio(r);
    case RT_CLAIM_CROSSOVER: return read_crossover(r);
    case RT_CLAIM_CORRELATION: return read_correlation(r);
    default: RT_TRY(read_side(r, &claim->first, true));
    }
    if (claim->form == RT_CLAIM_EXPONENT) {
        RT_TRY(need(r, "in"));
        RT_TRY(read_axis(r));
    }
    return read_places(r, &claim->first);
}

static RtStatus read_claim(Reader *r) {
    RtClaim *claim = r->claim;
    claim->counted = take(r, "count");
    if (claim->counted) RT_TRY(need(r, "of"));
    if (begins_least(r)) {
        RT_TRY(read_least(r));
    } else {
        claim->mean = take(r, "geometric");
        if (claim->mean) RT_TRY(need(r, "mean"));
        if (claim->mean) RT_TRY(need(r, "of"));
        RT_TRY(read_quantity(r));
        if (claim->form == RT_CLAIM_VALUE && !claim->mean && !names_place(&claim->first) && begins_trend(r))
            RT_TRY(read_trend(r));
        else
            RT_TRY(read_comparison(r));
    }
    if (claim->counted && claim->readout)
        return fail(r, "'count of' is followed by a claim, not by a figure");
    claim->readout |= claim->counted;
    return r->at == r->count ? RT_OK : fail(r, "unexpected '%s' at its end", word(r));
}

bool rt_claim_is_of_rays(const RtClaim *claim) {
    const RtClaimSubject first = measures[claim->first.measure].subject,
                         second = measures[claim->second.measure].subject;
    return first == RT_SUBJECT_RAYS || first == RT_SUBJECT_SET ||
           (claim->form == RT_CLAIM_CORRELATION && (second == RT_SUBJECT_RAYS || second == RT_SUBJECT_SET));
}

/* ---- cells ---- */

bool rt_claim_side_has(const RtExperiment *experiment, const RtClaimSide *side, uint32_t t, uint32_t c) {
    for (uint32_t p = 0; p < side->place_count; p++) {
        const char *value = rt_swept_of(experiment, &side->places[p].key, t, c);
        if (!value || !rt_swept_equal(value, side->places[p].value)) return false;
    }
    return !*side->scene || rt_workload_is_called(&experiment->workloads[t], side->scene);
}

/* Whether two specs have the same values of all parameters that both sweep and the second side does not name;
 * of a crossover only of its own. */
static bool agree(const RtClaim *claim, bool scene, const RtSwept *a, const RtSwept *b) {
    const RtClaimSide *side = &claim->second;
    for (uint32_t i = 0; i < a->count; i++) {
        const RtSweptKey key = {.key = a->keys[i], .scene = scene};
        if (!claim->apart && strcmp(key.key, claim->key.key) != 0) continue;
        for (uint32_t k = 0; k < b->count; k++) {
            if (strcmp(a->keys[i], b->keys[k]) == 0 && !value_of(side, &key) &&
                !rt_swept_equal(a->values[i], b->values[k]))
                return false;
        }
    }
    return true;
}

/* Whether `other`, an accelerator of the second side, is its cell for `of`; alike: with the same swept
 * values. */
static bool is_partner(const RtExperiment *experiment, const RtClaim *claim, const RtClaimCell *of,
                       const RtClaimCell *other, bool alike) {
    const RtClaimSide *second = &claim->second;
    const uint32_t t = other->workload, c = other->candidate;
    const RtWorkload *here = &experiment->workloads[of->workload], *there = &experiment->workloads[t];
    const RtCandidate *own = &experiment->candidates[of->candidate], *its = &experiment->candidates[c];
    if (its->excluded >> t & 1) return false;
    if (alike &&
        !(agree(claim, true, &here->swept, &there->swept) && agree(claim, false, &own->swept, &its->swept)))
        return false;
    return !claim->apart || (rt_claim_side_has(experiment, second, t, c) &&
                             (*second->scene || strcmp(here->stem, there->stem) == 0));
}

uint32_t rt_claim_partner(const RtExperiment *experiment, const RtClaim *claim, const RtClaimCell *of,
                          RtClaimCell *cell) {
    const bool crossover = claim->form == RT_CLAIM_CROSSOVER;
    uint32_t found = 0;
    for (int alike = claim->apart || crossover; alike >= 0 && found == 0; alike--) {
        for (uint32_t c = 0; c < experiment->candidate_count; c++) {
            const bool called = rt_candidate_is_called(&experiment->candidates[c], claim->second.accel);
            if (*claim->second.accel ? !called : c != of->candidate) continue;
            const uint32_t from = claim->apart ? 0 : of->workload,
                           end = claim->apart ? experiment->workload_count : from + 1;
            for (uint32_t t = from; t < end; t++) {
                const RtClaimCell other = {t, c, claim->second.each_kind ? of->kind : claim->second.kind};
                if (!is_partner(experiment, claim, of, &other, alike)) continue;
                if (found++ == 0) *cell = other;
            }
        }
    }
    return found;
}

RtStatus rt_claim_parse(const RtExperiment *experiment, const char *text, RtClaim *claim, RtError *error) {
    Reader r = {.experiment = experiment, .claim = claim, .error = error};
    const RtClaimSide everywhere = {.each_kind = true, .kind = RT_ALL_RAYS};
    *claim = (RtClaim){.first = everywhere, .second = everywhere};
    RT_TRY(split(&r, text));
    RT_TRY(read_claim(&r));
    claim->first.each_kind &= rt_claim_is_of_rays(claim);
    if (!claim->apart) claim->second.each_kind = true;
    return RT_OK;
}
