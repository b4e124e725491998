/* SPDX-License-Identifier: Apache-2.0 */
#include "experiment/experiment.h"

#include "core/base/words.h"

#include <inttypes.h>
#include <string.h>
#include <strings.h>

void rt_experiment_init(RtExperiment *experiment) {
    memset(experiment, 0, sizeof *experiment);
    experiment->limit = 100000;
    experiment->coherent_run = RT_COHERENT_RUN;
    experiment->rounds = 10;
    experiment->builds = 20;
    experiment->milliseconds = 20;
    experiment->seed = 1;
    experiment->threads = 1;
    for (uint32_t k = 0; k < RT_RAY_KIND_COUNT; k++) {
        if (k != RT_RAY_OCCLUSION) experiment->kinds[experiment->kind_count++] = (RtRayKind)k;
    }
}

/* ---- rays of a file ---- */

/* Nothing is known about the origin of such rays: they count as random. */
static const struct {
    const char *name;
    RtRayKind kind;
} given[] = {{"nearest", RT_RAY_RANDOM}, {"occlusion", RT_RAY_OCCLUSION}};

RtStatus rt_given_kind_parse(const char *name, RtRayKind *kind, RtError *error) {
    for (int i = 0; i < 2; i++) {
        *kind = given[i].kind;
        if (strcmp(given[i].name, name) == 0) return RT_OK;
    }
    return rt_fail(
        error, RT_BAD_INPUT,
        "rays of a file are traced for the nearest hit (nearest) or any hit (occlusion), not '%.40s'", name);
}

const char *rt_experiment_kind_name(const RtExperiment *experiment, RtRayKind kind) {
    for (int i = 0; i < 2 && *experiment->rays_from; i++) {
        if (given[i].kind == kind) return given[i].name;
    }
    return rt_ray_kind_name(kind);
}

bool rt_experiment_has_kind(const RtExperiment *experiment, RtRayKind kind) {
    for (uint32_t k = 0; k < experiment->kind_count; k++) {
        if (experiment->kinds[k] == kind) return true;
    }
    return false;
}

/* ---- papers ---- */

const char *rt_paper_verdict_name(RtPaperVerdict verdict) {
    static const char *const names[] = {[RT_PAPER_UNJUDGED] = "not judged",
                                        [RT_PAPER_CONFIRMED] = "confirmed",
                                        [RT_PAPER_IN_PART] = "in part",
                                        [RT_PAPER_NOT_CONFIRMED] = "not confirmed",
                                        [RT_PAPER_TRUE_OF_ITS_MACHINE] = "true of its machine",
                                        [RT_PAPER_NOT_TESTED] = "not tested",
                                        [RT_PAPER_NO_CLAIM] = "no claim"};
    return names[verdict];
}

bool rt_paper_is_seen(const RtPaper *paper) {
    return strcmp(paper->page, "unseen") != 0;
}

/* ---- the best of several ---- */

/* "embree-16-high-avx512" of "embree:query=16,quality=high,isa=avx512": short, and without commas, which
 * gnuplot does not accept. */
static void label_setting(const char *spec, char label[RT_MAX_LABEL]) {
    size_t used = 0;
    for (const char *c = spec; *c && used + 1 < RT_MAX_LABEL; c++) {
        label[used] = *c;
        if (*c == ':' || *c == ',') {
            label[used] = '-';
            c += strcspn(c, "=");
        }
        used++;
    }
    label[used] = '\0';
}

static bool is_best_of(const RtCandidate *candidate) {
    return *candidate->best_of || rt_best_is(candidate->spec);
}

static RtStatus add_candidate(RtExperiment *experiment, const RtCandidate *candidate, RtError *error) {
    if (experiment->candidate_count == RT_MAX_CANDIDATES)
        return rt_fail(error, RT_BAD_INPUT, "there are more than %d accelerators: choose from fewer settings",
                       RT_MAX_CANDIDATES);
    experiment->candidates[experiment->candidate_count++] = *candidate;
    return RT_OK;
}

/* Whether two specs have the same effective parameters. */
static bool same_spec(const char *a, const char *b) {
    char whole[2][RT_MAX_SPEC_CHARS];
    const char *const texts[] = {a, b};
    for (int i = 0; i < 2; i++) {
        RtSpec spec;
        if (rt_spec_parse(texts[i], &spec, NULL) != RT_OK) return false;
        rt_spec_format(&spec, whole[i]);
    }
    return strcmp(whole[0], whole[1]) == 0;
}

/* The settings of a best-of, those of its own list or of the accelerator's. */
static RtStatus list_settings(RtExperiment *experiment, const RtCandidate *best,
                              char specs[RT_MAX_BEST][RT_MAX_SPEC_CHARS], size_t *count, RtError *error) {
    size_t here;
    if (!*best->best_of) return rt_best_specs(best->spec, specs, &here, count, error);
    RtCandidate like = {.ray_stride = 1};
    const uint32_t before = experiment->candidate_count;
    memcpy(like.spec, best->best_of, sizeof like.spec);
    const RtStatus status = rt_experiment_add_accels(experiment, &like, error);
    *count = experiment->candidate_count - before;
    experiment->candidate_count = before;
    RT_TRY(status);
    if (*count > RT_MAX_OWN_BEST)
        return rt_fail(error, RT_BAD_INPUT, "'%s' chooses from %zu settings: at most %d, which are tried",
                       best->label, *count, RT_MAX_OWN_BEST);
    for (size_t i = 0; i < *count; i++)
        memcpy(specs[i], experiment->candidates[before + i].spec, sizeof *specs);
    return RT_OK;
}

/* A setting that is a candidate already on the same scenes and rays is not measured twice. */
static RtStatus add_members(RtExperiment *experiment, uint32_t b, RtError *error) {
    char specs[RT_MAX_BEST][RT_MAX_SPEC_CHARS];
    size_t count = 0;
    RT_TRY(list_settings(experiment, &experiment->candidates[b], specs, &count, error));
    for (size_t i = 0; i < count; i++) {
        RtCandidate *best = &experiment->candidates[b];
        uint32_t c = 0;
        for (; c < experiment->candidate_count; c++) {
            const RtCandidate *other = &experiment->candidates[c];
            if (other->excluded == best->excluded && other->ray_stride == best->ray_stride &&
                same_spec(other->spec, specs[i]))
                break;
        }
        best->members[best->member_count++] = (uint16_t)c;
        if (c < experiment->candidate_count) continue;
        RtCandidate member = {.entry = best->entry,
                              .ray_stride = best->ray_stride,
                              .excluded = best->excluded,
                              .optional = true,
                              .tried = true};
        memcpy(member.spec, specs[i], sizeof member.spec);
        label_setting(specs[i], member.label);
        memcpy(member.stem, member.label, sizeof member.stem);
        RT_TRY(add_candidate(experiment, &member, error));
    }
    return RT_OK;
}

/* Finds the members of a best-of of the results by their labels in the manifest. */
static void find_members(RtExperiment *experiment, uint32_t b) {
    RtCandidate *best = &experiment->candidates[b];
    const char *label;
    for (size_t i = 0; i < RT_MAX_BEST && (label = rt_manifest_member(experiment->manifest, b, i)); i++) {
        for (uint32_t c = 0; c < experiment->candidate_count; c++) {
            if (c == b || strcmp(experiment->candidates[c].label, label) != 0) continue;
            best->members[best->member_count++] = (uint16_t)c;
            if (experiment->candidates[c].tried) experiment->candidates[c].excluded = best->excluded;
            break;
        }
    }
}

/* The accelerators after those of the YAML in the manifest of results. */
static void append_from_manifest(RtExperiment *experiment) {
    RtCandidate candidate = {.ray_stride = 1, .optional = true};
    while (rt_manifest_candidate(experiment->manifest, experiment->candidate_count, &candidate)) {
        memcpy(candidate.stem, candidate.label, sizeof candidate.stem);
        candidate.tried = !rt_best_is(candidate.spec);
        if (add_candidate(experiment, &candidate, NULL) != RT_OK) return;
    }
}

void rt_experiment_set_baseline(RtExperiment *experiment, const char *label) {
    uint32_t c = 0, listed = experiment->candidate_count;
    append_from_manifest(experiment);
    if (!label) label = json_string_value(json_object_get(experiment->manifest, "baseline"));
    if (!label) { /* the first that is not a plugin's: without a working baseline nothing could be compared */
        while (c < listed && rt_spec_text_is_remote(experiment->candidates[c].spec)) c++;
        experiment->baseline = c < listed ? c : 0;
        return;
    }
    while (c < experiment->candidate_count && strcmp(experiment->candidates[c].label, label) != 0) c++;
    experiment->baseline = c;
    if (c < experiment->candidate_count || !rt_best_is(label)) return;
    RtCandidate best = {.entry = UINT32_MAX, .ray_stride = 1};
    snprintf(best.label, sizeof best.label, "%s", label);
    memcpy(best.stem, best.label, sizeof best.stem);
    memcpy(best.spec, best.label, sizeof best.spec);
    /* Manifests of version 1.0 had the members alone. */
    for (c = listed; c < experiment->candidate_count && best.member_count < RT_MAX_BEST; c++)
        best.members[best.member_count++] = (uint16_t)c;
    add_candidate(experiment, &best, NULL);
}

bool rt_candidate_is_member(const RtExperiment *experiment, uint32_t best, uint32_t c) {
    const RtCandidate *candidate = best < experiment->candidate_count ? &experiment->candidates[best] : NULL;
    for (uint32_t i = 0; candidate && i < candidate->member_count; i++) {
        if (candidate->members[i] == c) return true;
    }
    return false;
}

bool rt_candidate_is_baseline(const RtExperiment *experiment, uint32_t c) {
    return c == experiment->baseline || rt_candidate_is_member(experiment, experiment->baseline, c);
}

uint32_t rt_candidate_built(const RtExperiment *experiment, uint32_t c) {
    if (c < experiment->candidate_count) return c;
    const RtCandidate *baseline = &experiment->candidates[experiment->baseline];
    for (uint32_t i = 0; i < baseline->member_count; i++) {
        if (!experiment->candidates[baseline->members[i]].missing) return baseline->members[i];
    }
    return experiment->baseline;
}

const char *rt_baseline_label(const RtExperiment *experiment) {
    return experiment->candidates[experiment->baseline].label;
}

/* ---- labels ---- */

bool rt_candidate_runs(const RtExperiment *experiment, uint32_t c, uint32_t t) {
    if (c == experiment->candidate_count) return true;
    return !experiment->candidates[c].missing && !(experiment->candidates[c].excluded >> t & 1);
}

const char *rt_plot_name(const RtExperiment *experiment, uint32_t plot) {
    return basename(experiment->plots[plot]);
}

/* ---- checks ---- */

/* Names the files of workload `i`. Names that are equal but for case are numbered. */
static void label_files(RtExperiment *experiment, uint32_t i) {
    char name[RT_MAX_FILE_NAME], *file = experiment->workloads[i].file_name;
    bool taken = true;
    rt_file_name(experiment->workloads[i].label, name, sizeof name);
    for (uint32_t number = 1; taken; number++) {
        snprintf(file, sizeof experiment->workloads[i].file_name, number > 1 ? "%s-%" PRIu32 : "%s", name,
                 number);
        taken = false;
        for (uint32_t t = 0; t < i; t++) taken |= strcasecmp(file, experiment->workloads[t].file_name) == 0;
    }
}

static void shorten_labels(RtExperiment *experiment) {
    const char *labels[RT_MAX_CANDIDATES];
    const uint32_t count = experiment->candidate_count;
    for (uint32_t c = 0; c < count; c++) labels[c] = experiment->candidates[c].label;
    for (uint32_t c = 0; c < count; c++)
        rt_shorten_name(labels, count, c, RT_SHOWN_WIDTH, experiment->candidates[c].shown, RT_MAX_LABEL);
    for (uint32_t t = 0; t < experiment->workload_count; t++) labels[t] = experiment->workloads[t].label;
    for (uint32_t t = 0; t < experiment->workload_count; t++)
        rt_shorten_name(labels, experiment->workload_count, t, RT_SHOWN_WIDTH, experiment->workloads[t].shown,
                        RT_MAX_LABEL);
}

/* Labels of accelerators name no files, and may have a '/', as specs do. */
static RtStatus check_label(const char *label, bool of_accel, RtError *error) {
    for (const char *c = label; *c; c++) {
        if (rt_may_label(*c) || (of_accel && *c == '/')) continue;
        return rt_fail(
            error, RT_BAD_INPUT,
            "'%s' cannot name a row, a plot or a folder: use a name or `label` without blanks, quotes, "
            "letters outside ASCII, and / \\ $ & < > @ ^ { }",
            label);
    }
    return RT_OK;
}

static RtStatus fail_twice(const char *label, RtError *error) {
    return rt_fail(
        error, RT_BAD_INPUT,
        "the label '%s' is used twice: leave one out, or, in an experiment, give one of them another `label`",
        label);
}

/* Whether a spec begins with an accelerator that neither we nor a loaded plugin have. */
static bool is_unknown(const char *spec) {
    const RtAccelOps *ops;
    char name[RT_MAX_NAME];
    snprintf(name, sizeof name, "%.*s", (int)strcspn(spec, ":+"), spec);
    return rt_accel_find(name, &ops, NULL) != RT_OK;
}

/* Marks a candidate that this build or machine lacks; for loaded results, that those that made them lacked.
 */
static RtStatus check_spec(RtExperiment *experiment, uint32_t i, RtError *error) {
    RtCandidate *candidate = &experiment->candidates[i];
    RtError why = {RT_OK, ""};
    candidate->missing = experiment->manifest && rt_manifest_is_missing(experiment->manifest, i);
    if (experiment->manifest || is_best_of(candidate)) return RT_OK;
    if (rt_spec_parse(candidate->spec, &candidate->parsed, &why) == RT_OK) {
        candidate->missing =
            candidate->optional && rt_spec_available(&candidate->parsed, NULL) == RT_NOT_AVAILABLE;
        return RT_OK;
    }
    candidate->missing =
        why.status == RT_NOT_AVAILABLE || (candidate->optional && is_unknown(candidate->spec));
    return candidate->missing ? RT_OK : rt_fail(error, why.status, "%s", why.message);
}

static RtStatus check_candidate(RtExperiment *experiment, uint32_t i, RtError *error) {
    RtCandidate *candidate = &experiment->candidates[i];
    RT_TRY(check_spec(experiment, i, error));
    const uint32_t all = (uint32_t)((UINT64_C(1) << experiment->workload_count) - 1);
    for (uint32_t k = 0; k < i; k++) {
        const RtCandidate *other = &experiment->candidates[k];
        bool meet = ~(candidate->excluded | other->excluded) & all;
        if (meet && strcmp(candidate->label, other->label) == 0) return fail_twice(candidate->label, error);
    }
    return check_label(candidate->label, true, error);
}

/* A best-of is missing if all its members are. */
static void mark_missing(RtExperiment *experiment) {
    for (uint32_t c = 0; c < experiment->candidate_count; c++) {
        RtCandidate *best = &experiment->candidates[c];
        best->missing |= best->member_count > 0;
        for (uint32_t i = 0; i < best->member_count; i++)
            best->missing &= experiment->candidates[best->members[i]].missing;
    }
}

static RtStatus check_baseline(const RtExperiment *experiment, RtError *error) {
    if (experiment->baseline >= experiment->candidate_count)
        return rt_fail(error, RT_BAD_INPUT, "this is not the label of one of the accelerators");
    const RtCandidate *baseline = &experiment->candidates[experiment->baseline];
    if (baseline->missing)
        return rt_fail(error, RT_NOT_AVAILABLE, "the baseline '%s' is not in this build: choose another",
                       baseline->label);
    if (baseline->ray_stride == 1 && !baseline->excluded) return RT_OK;
    return rt_fail(error, RT_BAD_INPUT,
                   "the baseline '%s' must be measured on every ray of every scene: choose another, or "
                   "remove its `ray_stride` and `scenes`",
                   baseline->label);
}

/* All scripts are copied into one folder (experiment/scripts.h). */
static RtStatus check_plot(const RtExperiment *experiment, uint32_t i, RtError *error) {
    const char *name = rt_plot_name(experiment, i);
    if (!*name || strcmp(name, ".") == 0 || strcmp(name, "..") == 0)
        return rt_fail(error, RT_BAD_INPUT, "'%s' does not name a gnuplot script", experiment->plots[i]);
    bool taken = false;
    for (uint32_t k = 0; k < i; k++) taken |= strcmp(name, rt_plot_name(experiment, k)) == 0;
    if (!taken) return RT_OK;
    return rt_fail(
        error, RT_BAD_INPUT,
        "the result directory already has a plots/%s: rename the script, even if it is in another folder",
        name);
}

/* Tables have a column for each. */
static RtStatus check_swept(const RtExperiment *experiment, const RtSwept *swept, RtError *error) {
    RtSweptKey keys[RT_MAX_SWEPT_KEYS];
    uint32_t count = rt_experiment_swept(experiment, keys);
    for (uint32_t i = 0; i < swept->count; i++) {
        uint32_t k = 0;
        RT_TRY(check_label(swept->keys[i], false, error));
        RT_TRY(check_label(swept->values[i], false, error));
        while (k < count && strcmp(keys[k].key, swept->keys[i]) != 0) k++;
        if (k < count) continue;
        return rt_fail(error, RT_BAD_INPUT, "'%s' is one too many: at most %d parameters are swept",
                       swept->keys[i], RT_MAX_SWEPT_KEYS);
    }
    return RT_OK;
}

static RtStatus check_frame(const RtExperiment *experiment, RtError *error) {
    const RtFrameSetup *frame = &experiment->frame;
    bool grouped = false;
    if (!*frame->without) return RT_OK;
    for (uint32_t t = 0; t < experiment->workload_count; t++) {
        if (rt_candidate_find(experiment, frame->without, t) < experiment->candidate_count) continue;
        return rt_fail(error, RT_BAD_INPUT, "without: '%s' is not the label of an accelerator on %s",
                       frame->without, experiment->workloads[t].label);
    }
    for (uint32_t c = 0; c < experiment->candidate_count; c++)
        grouped |= strcmp(experiment->candidates[c].group, frame->among) == 0;
    if (!grouped)
        return rt_fail(error, RT_BAD_INPUT, "among: '%s' is not the group of an accelerator", frame->among);
    for (int k = 0; k < RT_RAY_KIND_COUNT; k++) {
        const RtRayKind kind = (RtRayKind)k;
        if (!rt_ray_kind_is_of_frame(kind) || rt_experiment_has_kind(experiment, kind)) continue;
        return rt_fail(error, RT_BAD_INPUT, "a frame also has %s rays: add that kind under `rays`",
                       rt_ray_kind_name(kind));
    }
    return RT_OK;
}

/* Names the place of candidate `c` in the YAML. */
static void place_candidate(const RtExperiment *experiment, uint32_t c, char *where) {
    const uint32_t entry = experiment->candidates[c].entry;
    snprintf(where, RT_MAX_LABEL, entry == UINT32_MAX ? "baseline" : "accelerators[%u]", entry);
}

static RtStatus expand(RtExperiment *experiment, char *where, RtError *error) {
    for (uint32_t c = 0, count = experiment->candidate_count; c < count; c++) {
        if (!is_best_of(&experiment->candidates[c]) || experiment->candidates[c].member_count > 0) continue;
        place_candidate(experiment, c, where);
        if (experiment->manifest) {
            find_members(experiment, c);
            continue;
        }
        const RtStatus status = add_members(experiment, c, error);
        const bool unknown = status == RT_NOT_AVAILABLE || is_unknown(experiment->candidates[c].spec);
        experiment->candidates[c].missing = status != RT_OK && experiment->candidates[c].optional && unknown;
        if (!experiment->candidates[c].missing) RT_TRY(status);
    }
    return RT_OK;
}

RtStatus rt_experiment_check(RtExperiment *experiment, char *where, RtError *error) {
    RT_TRY(expand(experiment, where, error));
    for (uint32_t i = 0; i < experiment->workload_count; i++) {
        snprintf(where, RT_MAX_LABEL, "scenes[%u]", experiment->workloads[i].entry);
        const RtWorkload *workload = &experiment->workloads[i];
        if (rt_workload_find(experiment, workload->label) < i) return fail_twice(workload->label, error);
        label_files(experiment, i);
        RT_TRY(check_label(workload->label, false, error));
        RT_TRY(check_swept(experiment, &workload->swept, error));
    }
    for (uint32_t i = 0; i < experiment->candidate_count; i++) {
        place_candidate(experiment, i, where);
        RT_TRY(check_candidate(experiment, i, error));
        RT_TRY(check_swept(experiment, &experiment->candidates[i].swept, error));
    }
    for (uint32_t i = 0; i < experiment->kind_count; i++) {
        snprintf(where, RT_MAX_LABEL, "rays[%u]", i);
        for (uint32_t k = 0; k < i; k++) {
            if (experiment->kinds[k] != experiment->kinds[i]) continue;
            return rt_fail(error, RT_BAD_INPUT, "%s rays are given twice",
                           rt_ray_kind_name(experiment->kinds[i]));
        }
    }
    mark_missing(experiment);
    strcpy(where, "baseline");
    RT_TRY(check_baseline(experiment, error));
    snprintf(experiment->again, sizeof experiment->again, "%s (again)",
             experiment->candidates[rt_candidate_built(experiment, experiment->candidate_count)].label);
    shorten_labels(experiment);
    strcpy(where, "frame");
    RT_TRY(check_frame(experiment, error));
    for (uint32_t i = 0; i < experiment->plot_count; i++) {
        snprintf(where, RT_MAX_LABEL, "plots[%u]", i);
        RT_TRY(check_plot(experiment, i, error));
    }
    strcpy(where, "render");
    if (experiment->render && experiment->count_only)
        return rt_fail(error, RT_BAD_INPUT,
                       "rendering is timed, and `count_only` times nothing: leave one out");
    strcpy(where, "name");
    if (*experiment->name == '.')
        return rt_fail(error, RT_BAD_INPUT,
                       "'%s' cannot name a result directory: begin it with another letter", experiment->name);
    return check_label(experiment->name, false, error);
}

/* ---- the cells that a run measures ---- */

static bool has_scene(const RtPart *part, const RtExperiment *experiment, uint32_t workload) {
    return !part->scene || rt_workload_is_called(&experiment->workloads[workload], part->scene);
}

static bool has_kind(const RtPart *part, RtRayKind kind) {
    return kind == RT_ALL_RAYS || !part->kind || strcmp(part->kind, rt_ray_kind_name(kind)) == 0;
}

bool rt_selection_has(const RtSelection *only, const RtExperiment *experiment, uint32_t workload,
                      uint32_t candidate, RtRayKind kind) {
    bool found = only->part_count == 0;
    if (only->shards && workload % only->shards != only->shard - 1) return false;
    for (uint32_t i = 0; i < only->part_count && !found; i++) {
        const RtPart *part = &only->parts[i];
        bool accel = candidate == experiment->candidate_count || !part->accel ||
                     rt_candidate_is_baseline(experiment, candidate);
        for (uint32_t c = 0; c < experiment->candidate_count && !accel; c++)
            accel = rt_candidate_is_called(&experiment->candidates[c], part->accel) &&
                    (c == candidate || rt_candidate_is_member(experiment, c, candidate));
        found = accel && has_scene(part, experiment, workload) && has_kind(part, kind);
    }
    return found;
}

static RtStatus check_part(const RtPart *part, const RtExperiment *e, RtError *error) {
    bool scene = !part->scene, accel = !part->accel, kind = !part->kind;
    for (uint32_t t = 0; t < e->workload_count; t++) scene |= has_scene(part, e, t);
    for (uint32_t c = 0; c < e->candidate_count; c++)
        accel |= part->accel && rt_candidate_is_called(&e->candidates[c], part->accel);
    for (uint32_t k = 0; k < e->kind_count; k++) kind |= has_kind(part, e->kinds[k]);
    if (scene && accel && kind) return RT_OK;
    return rt_fail(error, RT_BAD_INPUT, "--only: '%s' is not the label of one of the %s",
                   !scene   ? part->scene
                   : !accel ? part->accel
                            : part->kind,
                   !scene   ? "scenes"
                   : !accel ? "accelerators"
                            : "kinds of rays");
}

RtStatus rt_selection_check(const RtSelection *only, const RtExperiment *e, RtError *error) {
    for (uint32_t i = 0; i < only->part_count; i++) RT_TRY(check_part(&only->parts[i], e, error));
    return RT_OK;
}
