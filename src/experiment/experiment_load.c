/* SPDX-License-Identifier: Apache-2.0 */
/* Experiments as YAML: each part of RtExperiment from its mapping, over the defaults of rt_experiment_init.
 * Reports invalid values; rt_experiment_check reports inconsistent ones. */
#include "core/base/memory.h"

#include "core/text/json.h"
#include "core/text/yaml.h"
#include "experiment/claim.h"
#include "experiment/experiment.h"
#include "experiment/finding.h"
#include "render/frame.h"

#include <string.h>
#define XXH_STATIC_LINKING_ONLY /* the state of a hash on the stack */
#include <xxhash.h>

/* ---- values ---- */

static RtStatus read_flag(const RtYaml *y, const RtYamlNode *n, const char *key, bool *flag) {
    uint32_t word = *flag ? 0 : 1;
    RT_TRY(rt_yaml_word(y, n, key, "yes no true false", &word));
    *flag = word % 2 == 0;
    return RT_OK;
}

static RtStatus read_size(const RtYaml *y, const RtYamlNode *n, uint32_t *width, uint32_t *height) {
    const char *text = NULL;
    RT_TRY(rt_yaml_text(y, n, "size", RT_MAX_WORD, &text));
    if (!text || rt_image_size_parse(text, width, height)) return RT_OK;
    return rt_yaml_fail(y, rt_yaml_get(y, n, "size"),
                        "invalid value '%s': expected WIDTHxHEIGHT, each 1..%d, as in 512x512", text,
                        RT_MAX_IMAGE_SIDE);
}

/* Keeps the first warning. */
static void warn(const RtYaml *y, const RtYamlNode *n, RtExperiment *experiment, const char *text) {
    RtYaml warned = *y;
    warned.error = &experiment->warning;
    if (!*experiment->warning.message) rt_yaml_fail(&warned, n, "%s", text);
}

/* A list of up to `size` texts; without a list *count stays unchanged. */
static RtStatus read_labels(const RtYaml *y, const RtYamlNode *n, const char *key, uint32_t size,
                            char (*labels)[RT_MAX_WORD], uint32_t *count) {
    const RtYamlNode *list = rt_yaml_get(y, n, key);
    RT_TRY(rt_yaml_list(y, list, NULL, 1, size, key));
    if (list) *count = 0;
    for (const RtYamlNode *e = rt_yaml_first(list); e != rt_yaml_end(list); e += e->size)
        RT_TRY(rt_yaml_copy(y, e, NULL, RT_MAX_WORD, labels[(*count)++]));
    return RT_OK;
}

/* The amount of measuring, which `quick` may override. */
static RtStatus read_scale(const RtYaml *y, const RtYamlNode *n, uint64_t *limit, uint32_t *rounds,
                           uint32_t *builds, uint32_t *milliseconds) {
    RT_TRY(rt_yaml_u64(y, n, "limit", 1, RT_MAX_RAYS_A_KIND, limit));
    RT_TRY(rt_yaml_u32(y, n, "rounds", 1, RT_MAX_ROUNDS, rounds));
    RT_TRY(rt_yaml_u32(y, n, "builds", 1, RT_MAX_ROUNDS, builds));
    return rt_yaml_u32(y, n, "milliseconds", 0, RT_MAX_MILLISECONDS, milliseconds);
}

static RtStatus read_limits(const RtYaml *y, const RtYamlNode *n, RtExperiment *experiment) {
    RT_TRY(rt_yaml_keys(y, n, "seconds? megabytes?"));
    RT_TRY(rt_yaml_double(y, n, "seconds", &experiment->limit_seconds));
    uint64_t megabytes = 0;
    RT_TRY(rt_yaml_u64(y, n, "megabytes", 1, 1000000000, &megabytes));
    experiment->limit_bytes = 1000000 * megabytes;
    if (!rt_yaml_get(y, n, "seconds") || experiment->limit_seconds > 0) return RT_OK;
    return rt_yaml_fail(y, rt_yaml_get(y, n, "seconds"), "invalid value '%g': expected more than 0",
                        experiment->limit_seconds);
}

/* ---- parts ---- */

static RtStatus read_workloads(const RtYaml *y, const RtYamlNode *n, uint32_t entry, RtExperiment *experiment,
                               RtError *error) {
    const char *spec = "";
    RtWorkload like = {.entry = entry, .depth = RT_DEFAULT_DEPTH};
    RT_TRY(rt_yaml_keys(y, n, "scene label? size? corners? light_from_outside? depth? optional?"));
    RT_TRY(rt_yaml_text(y, n, "scene", RT_MAX_SCENE_NAME - 1, &spec));
    RT_TRY(rt_yaml_copy(y, n, "label", RT_MAX_LABEL, like.label));
    RT_TRY(rt_yaml_u32(y, n, "depth", 1, RT_MAX_DEPTH, &like.depth));
    RT_TRY(read_size(y, n, &like.width, &like.height));
    RT_TRY(read_flag(y, n, "corners", &like.corners));
    RT_TRY(read_flag(y, n, "light_from_outside", &like.light_from_outside));
    RT_TRY(read_flag(y, n, "optional", &like.optional));
    RtStatus status = rt_experiment_add_scenes(experiment, &like, spec, experiment->folder, error);
    return rt_yaml_place(y, status, n, "scene");
}

/* Leaves the candidate out on all workloads that its `scenes` do not name; without `scenes`, on none. */
static RtStatus read_scenes(const RtYaml *y, const RtYamlNode *list, const RtExperiment *experiment,
                            RtCandidate *candidate) {
    uint32_t on = 0;
    RT_TRY(rt_yaml_list(y, list, NULL, 1, RT_MAX_WORKLOADS, "labels"));
    for (const RtYamlNode *n = rt_yaml_first(list); n != rt_yaml_end(list); n += n->size) {
        const char *label = "";
        RT_TRY(rt_yaml_text(y, n, NULL, RT_MAX_LABEL - 1, &label));
        bool found = false;
        for (uint32_t t = 0; t < experiment->workload_count; t++) {
            if (!rt_workload_is_called(&experiment->workloads[t], label)) continue;
            on |= UINT32_C(1) << t;
            found = true;
        }
        if (!found) return rt_yaml_fail(y, n, "'%s' is not the label of one of the scenes", label);
    }
    candidate->excluded = list ? ~on : 0;
    return RT_OK;
}

/* The name of a group of accelerators, which plots quote. */
static RtStatus read_group(const RtYaml *y, const RtYamlNode *n, const char *key, char group[RT_MAX_WORD]) {
    RT_TRY(rt_yaml_copy(y, n, key, RT_MAX_WORD, group));
    for (const char *c = group; *c; c++) {
        if (!rt_may_label(*c) && *c != ' ' && *c != '\'')
            return rt_yaml_fail(y, rt_yaml_get(y, n, key),
                                "'%s' has the character '%c', which plots cannot show", group, *c);
    }
    return RT_OK;
}

static RtStatus read_candidates(const RtYaml *y, const RtYamlNode *n, uint32_t entry,
                                RtExperiment *experiment, RtError *error) {
    RtCandidate like = {.entry = entry, .ray_stride = 1};
    RT_TRY(rt_yaml_keys(y, n, "accel best_of? label? group? ray_stride? scenes? optional?"));
    RT_TRY(read_group(y, n, "group", like.group));
    RT_TRY(rt_yaml_copy(y, n, "accel", RT_MAX_SPEC_CHARS, like.spec));
    RT_TRY(rt_yaml_copy(y, n, "best_of", RT_MAX_SPEC_CHARS, like.best_of));
    if (*like.best_of && !rt_best_is(like.spec))
        return rt_yaml_fail(y, rt_yaml_get(y, n, "best_of"),
                            "the best of several settings has a name like grid:best, not '%s'", like.spec);
    RT_TRY(rt_yaml_copy(y, n, "label", RT_MAX_LABEL, like.label));
    RT_TRY(rt_yaml_u64(y, n, "ray_stride", 1, RT_MAX_RAYS_A_KIND, &like.ray_stride));
    RT_TRY(read_scenes(y, rt_yaml_get(y, n, "scenes"), experiment, &like));
    RT_TRY(read_flag(y, n, "optional", &like.optional));
    return rt_yaml_place(y, rt_experiment_add_accels(experiment, &like, error), n, "accel");
}

static RtStatus read_frame(const RtYaml *y, const RtYamlNode *n, RtFrameSetup *frame) {
    RT_TRY(rt_yaml_keys(y, n, "without among note?"));
    RT_TRY(rt_yaml_copy(y, n, "without", RT_MAX_LABEL, frame->without));
    RT_TRY(read_group(y, n, "among", frame->among));
    return rt_yaml_copy(y, n, "note", RT_MAX_TEXT, frame->note);
}

static RtStatus read_rays(const RtYaml *y, const RtYamlNode *list, RtExperiment *experiment, RtError *error) {
    RT_TRY(rt_yaml_list(y, list, NULL, 1, RT_RAY_KIND_COUNT, "kinds of rays"));
    if (list) experiment->kind_count = 0;
    for (const RtYamlNode *n = rt_yaml_first(list); n != rt_yaml_end(list); n += n->size) {
        const char *kind = "";
        RT_TRY(rt_yaml_text(y, n, NULL, RT_MAX_LABEL - 1, &kind));
        RtStatus status = rt_ray_kind_parse(kind, &experiment->kinds[experiment->kind_count++], error);
        RT_TRY(rt_yaml_place(y, status, n, NULL));
    }
    return RT_OK;
}

/* Parsed even without --quick, to find mistakes early. */
static RtStatus read_quick(const RtYaml *y, const RtYamlNode *n, bool quick, RtExperiment *experiment) {
    uint64_t limit = experiment->limit;
    uint32_t rounds = experiment->rounds, builds = experiment->builds;
    uint32_t milliseconds = experiment->milliseconds;
    uint32_t width = 0, height = 0, depth = 0;
    RT_TRY(rt_yaml_keys(y, n, "size? limit? rounds? builds? milliseconds? depth?"));
    RT_TRY(read_scale(y, n, &limit, &rounds, &builds, &milliseconds));
    RT_TRY(read_size(y, n, &width, &height));
    RT_TRY(rt_yaml_u32(y, n, "depth", 1, RT_MAX_DEPTH, &depth));
    if (!quick) return RT_OK;
    experiment->limit = limit;
    experiment->rounds = rounds;
    experiment->builds = builds;
    experiment->milliseconds = milliseconds;
    for (uint32_t i = 0; i < experiment->workload_count; i++) {
        RtWorkload *workload = &experiment->workloads[i];
        if (depth) workload->depth = depth;
        if (!width) continue;
        workload->width = width;
        workload->height = height;
    }
    return RT_OK;
}

/* ---- all of it ---- */

static RtStatus read_lists(const RtYaml *y, const RtYamlNode *n, RtExperiment *experiment, RtError *error) {
    const RtYamlNode *scenes = rt_yaml_get(y, n, "scenes"), *accels = rt_yaml_get(y, n, "accelerators");
    RT_TRY(rt_yaml_list(y, scenes, NULL, 1, RT_MAX_WORKLOADS, "scenes"));
    uint32_t entry = 0;
    for (const RtYamlNode *e = rt_yaml_first(scenes); e != rt_yaml_end(scenes); e += e->size)
        RT_TRY(read_workloads(y, e, entry++, experiment, error));
    RT_TRY(rt_yaml_list(y, accels, NULL, 1, RT_MAX_CANDIDATES, "accelerators"));
    entry = 0;
    for (const RtYamlNode *e = rt_yaml_first(accels); e != rt_yaml_end(accels); e += e->size)
        RT_TRY(read_candidates(y, e, entry++, experiment, error));
    RT_TRY(read_rays(y, rt_yaml_get(y, n, "rays"), experiment, error));
    return read_labels(y, n, "plots", RT_MAX_PLOTS, experiment->plots, &experiment->plot_count);
}

static RtStatus read_claims(const RtYaml *y, const RtYamlNode *list, RtExperiment *experiment,
                            RtError *error) {
    RT_TRY(rt_yaml_list(y, list, NULL, 1, RT_MAX_CLAIMS - experiment->claim_count, "claims"));
    for (const RtYamlNode *n = rt_yaml_first(list); n != rt_yaml_end(list); n += n->size) {
        RtClaim claim;
        char *text = experiment->claims[experiment->claim_count++];
        RT_TRY(rt_yaml_copy(y, n, NULL, RT_MAX_CLAIM, text));
        RT_TRY(rt_yaml_place(y, rt_claim_parse(experiment, text, &claim, error), n, NULL));
    }
    return RT_OK;
}

static RtStatus read_paper_verdict(const RtYaml *y, const RtYamlNode *n, RtPaperVerdict *verdict) {
    const char *text = NULL;
    RT_TRY(rt_yaml_text(y, n, "verdict", RT_MAX_WORD, &text));
    if (!text) return RT_OK;
    for (*verdict = RT_PAPER_CONFIRMED; *verdict < RT_PAPER_VERDICT_COUNT; (*verdict)++) {
        if (strcmp(text, rt_paper_verdict_name(*verdict)) == 0) return RT_OK;
    }
    return rt_yaml_fail(
        y, rt_yaml_get(y, n, "verdict"),
        "invalid value '%s': expected confirmed, in part, not confirmed, true of its machine, "
        "not tested, or no claim; before the run, leave it out",
        text);
}

/* What its parts leave open. */
static void check_paper(const RtYaml *y, const RtYamlNode *n, const RtPaper *paper,
                        RtExperiment *experiment) {
    const bool tested = paper->verdict != RT_PAPER_UNJUDGED && paper->verdict < RT_PAPER_NOT_TESTED;
    const RtYamlNode *verdict = rt_yaml_get(y, n, "verdict");
    if (tested && !rt_paper_is_seen(paper))
        warn(y, verdict, experiment,
             "a paper that was not at hand (page: unseen) has the verdict 'not tested' or 'no claim'");
    if (paper->verdict == RT_PAPER_CONFIRMED && !*paper->modelled)
        warn(y, verdict, experiment,
             "'confirmed' needs `modelled`: how the paper's own configuration is modelled");
    if (tested && paper->claim_count == 0)
        warn(y, verdict, experiment, "this verdict needs `expect`, the claims that it rests on");
}

/* One mapping, or a list of them. */
static RtStatus read_papers(const RtYaml *y, const RtYamlNode *list, RtExperiment *experiment,
                            RtError *error) {
    const bool one = list && list->kind == RT_YAML_MAPPING;
    if (!one) RT_TRY(rt_yaml_list(y, list, NULL, 1, RT_MAX_PAPERS, "mappings with citation, page and quote"));
    const RtYamlNode *end = one ? list + list->size : rt_yaml_end(list);
    for (const RtYamlNode *n = one ? list : rt_yaml_first(list); n != end; n += n->size) {
        RtPaper *paper = &experiment->papers[experiment->paper_count++];
        RT_TRY(rt_yaml_keys(y, n, "citation page quote verdict? modelled? expect?"));
        RT_TRY(rt_yaml_copy(y, n, "citation", RT_MAX_TEXT, paper->citation));
        RT_TRY(rt_yaml_copy(y, n, "page", RT_MAX_WORD, paper->page));
        RT_TRY(rt_yaml_copy(y, n, "quote", RT_MAX_TEXT, paper->quote));
        RT_TRY(rt_yaml_copy(y, n, "modelled", RT_MAX_TEXT, paper->modelled));
        RT_TRY(read_paper_verdict(y, n, &paper->verdict));
        paper->first_claim = experiment->claim_count;
        RT_TRY(read_claims(y, rt_yaml_get(y, n, "expect"), experiment, error));
        paper->claim_count = experiment->claim_count - paper->first_claim;
        check_paper(y, n, paper, experiment);
    }
    return RT_OK;
}

/* After all that its expressions may name. */
static RtStatus read_finding(const RtYaml *y, const RtYamlNode *n, RtExperiment *experiment, RtError *error) {
    RtError why = {RT_OK, ""};
    RT_TRY(rt_yaml_copy(y, n, "finding", RT_MAX_TEXT, experiment->finding));
    RT_TRY(rt_yaml_copy(y, n, "not_shown", RT_MAX_TEXT, experiment->not_shown));
    RT_TRY(rt_yaml_place(y, rt_finding_check(experiment, experiment->finding, error), n, "finding"));
    if (rt_finding_check_bound(experiment->finding, &why) != RT_OK)
        warn(y, rt_yaml_get(y, n, "finding"), experiment, why.message);
    return RT_OK;
}

/* Adds the line to a failure of rt_experiment_check: `where` is "name", or "scenes[3]". */
static RtStatus place(const RtYaml *y, RtStatus status, const char *where) {
    char key[RT_MAX_LABEL];
    unsigned index = 0;
    if (sscanf(where, "%47[a-z][%u]", key, &index) < 2) return rt_yaml_place(y, status, y->nodes, where);
    const RtYamlNode *list = rt_yaml_get(y, y->nodes, key), *n = rt_yaml_first(list);
    if (!list) return rt_yaml_place(y, status, y->nodes, NULL);
    for (; index > 0; index--) n += n->size;
    return rt_yaml_place(y, status, n, NULL);
}

static RtStatus read_experiment(const RtYaml *y, bool quick, RtExperiment *experiment, RtError *error) {
    const RtYamlNode *n = y->nodes;
    RT_TRY(rt_yaml_check_format(y));
    /* `published` is a key of 1.0; now a script compares published figures (experiments/published). */
    RT_TRY(rt_yaml_keys(
        y, n,
        "name section? paper? question prediction scenes accelerators baseline? rays? limit? coherent_run? "
        "rounds? builds? milliseconds? threads? seed? count_only? render? hardware? distributions? "
        "published? frame? quick? plots? expect? finding? not_shown? limits? format?"));
    RT_TRY(rt_yaml_copy(y, n, "name", RT_MAX_WORD, experiment->name));
    RT_TRY(rt_yaml_copy(y, n, "section", RT_MAX_WORD, experiment->section));
    RT_TRY(rt_yaml_copy(y, n, "question", RT_MAX_TEXT, experiment->question));
    RT_TRY(rt_yaml_copy(y, n, "prediction", RT_MAX_TEXT, experiment->prediction));
    RT_TRY(read_scale(y, n, &experiment->limit, &experiment->rounds, &experiment->builds,
                      &experiment->milliseconds));
    if (rt_yaml_get(y, n, "limits")) RT_TRY(read_limits(y, rt_yaml_get(y, n, "limits"), experiment));
    RT_TRY(rt_yaml_u64(y, n, "coherent_run", 1, RT_MAX_RAYS_A_KIND, &experiment->coherent_run));
    RT_TRY(rt_yaml_u64(y, n, "seed", 0, INT64_MAX, &experiment->seed));
    RT_TRY(rt_yaml_u32(y, n, "threads", 0, 1024, &experiment->threads));
    RT_TRY(read_flag(y, n, "count_only", &experiment->count_only));
    RT_TRY(read_flag(y, n, "render", &experiment->render));
    RT_TRY(read_flag(y, n, "distributions", &experiment->distributions));
    if (rt_yaml_get(y, n, "hardware")) /* of version 1.0 */
        warn(y, rt_yaml_get(y, n, "hardware"), experiment,
             "ignored: `perf stat` counts these now (docs/guide/faq.md)");
    RT_TRY(read_lists(y, n, experiment, error));
    const char *baseline = NULL;
    RT_TRY(rt_yaml_text(y, n, "baseline", RT_MAX_LABEL - 1, &baseline));
    rt_experiment_set_baseline(experiment, baseline);
    const RtYamlNode *smaller = rt_yaml_get(y, n, "quick"), *frame = rt_yaml_get(y, n, "frame");
    if (frame) RT_TRY(read_frame(y, frame, &experiment->frame));
    if (smaller) RT_TRY(read_quick(y, smaller, quick, experiment));
    experiment->quick = quick;
    char where[RT_MAX_LABEL] = "";
    RtStatus status = rt_experiment_check(experiment, where, error);
    RT_TRY(place(y, status, where));
    RT_TRY(read_claims(y, rt_yaml_get(y, n, "expect"), experiment, error));
    RT_TRY(read_papers(y, rt_yaml_get(y, n, "paper"), experiment, error));
    return read_finding(y, n, experiment, error);
}

/* ---- the fingerprint ---- */

/* The start of line number `line`. */
static size_t begin_of(const char *text, size_t length, uint32_t line) {
    size_t at = 0;
    for (; line > 1 && at < length; at++) line -= text[at] == '\n';
    return at;
}

/* The keys that affect no result, and may be edited after the run. */
static bool is_editable(const char *key, bool plots) {
    static const char *const keys[] = {"section", "paper", "expect", "finding", "not_shown"};
    for (size_t i = 0; i < sizeof keys / sizeof keys[0]; i++) {
        if (strcmp(key, keys[i]) == 0) return true;
    }
    return plots && strcmp(key, "plots") == 0;
}

/* The hash of the text without the lines of editable keys. They count if they share a line with another.
 * `plots`: whether that is one of them. */
static uint64_t fingerprint_of(const RtYaml *y, const char *text, size_t length, bool plots) {
    XXH3_state_t whole, *state = &whole;
    size_t from = 0;
    XXH3_64bits_reset(state);
    const RtYamlNode *end = rt_yaml_end(y->nodes);
    for (const RtYamlNode *key = rt_yaml_first(y->nodes); key != end;) {
        const RtYamlNode *next = key + key->size;
        next += next->size;
        size_t begin = begin_of(text, length, key->line);
        size_t behind = next == end ? length : begin_of(text, length, next->line);
        bool apart = key->column == 1 && behind > begin;
        if (apart && is_editable(rt_yaml_text_of(y, key), plots)) {
            XXH3_64bits_update(state, text + from, begin - from);
            from = behind;
        }
        key = next;
    }
    XXH3_64bits_update(state, text + from, length - from);
    return XXH3_64bits_digest(state);
}

bool rt_experiment_has_hash(const RtExperiment *experiment, const json_t *hash) {
    bool good;
    const uint64_t value = rt_json_parse_hex(hash, &good);
    return good && (value == experiment->fingerprint || value == experiment->fingerprint_with_plots);
}

RtStatus rt_experiment_load(RtExperiment *experiment, const char *path, bool quick, const json_t *manifest,
                            RtError *error) {
    char *text;
    size_t length;
    RtYaml yaml;
    rt_experiment_init(experiment);
    if (strlen(path) >= RT_MAX_PATH)
        return rt_fail(error, RT_BAD_INPUT, "%.80s...: the path is too long", path);
    strcpy(experiment->path, path);
    rt_path_folder(path, experiment->folder);
    RT_TRY(rt_file_read_text(path, RT_YAML_MAX_BYTES, &text, &length, error));
    RtStatus status = rt_yaml_parse(&yaml, path, text, length, error);
    bool mapping = status == RT_OK && yaml.nodes->kind == RT_YAML_MAPPING;
    if (mapping) experiment->fingerprint = fingerprint_of(&yaml, text, length, true);
    if (mapping) experiment->fingerprint_with_plots = fingerprint_of(&yaml, text, length, false);
    rt_free(text);
    RT_TRY(status);
    experiment->manifest = manifest;
    status = read_experiment(&yaml, quick, experiment, error);
    rt_yaml_close(&yaml);
    experiment->manifest = NULL;
    return status;
}
