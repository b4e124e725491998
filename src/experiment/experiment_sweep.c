/* SPDX-License-Identifier: Apache-2.0 */
/* Adds scenes and accelerators to an experiment from specs that may be sweeps. */
#include "experiment/experiment.h"

#include <ctype.h>
#include <string.h>

/* ---- labels ---- */

bool rt_may_label(char c) {
    return isgraph((unsigned char)c) && !strchr("\"'`/\\$&<>@^{}", c);
}

/* Appends the swept values to the common label. */
static RtStatus label_one(char label[RT_MAX_LABEL], const char *base, const RtSwept *swept, RtError *error) {
    char whole[RT_MAX_LABEL + RT_MAX_SWEPT * (RT_MAX_NAME + RT_MAX_SWEPT_CHARS + 2)];
    snprintf(whole, sizeof whole, "%s", base);
    rt_swept_name(swept, NULL, whole, sizeof whole);
    if (strlen(whole) >= RT_MAX_LABEL) {
        return rt_fail(error, RT_BAD_INPUT, "'%s' is longer than %d characters: give a short `label`", whole,
                       RT_MAX_LABEL - 1);
    }
    strcpy(label, whole);
    return RT_OK;
}

/* ---- scenes ---- */

/* The file's name without folder and extension, or the built-in's spec. */
static void name_scene(const char *spec, bool file, char label[RT_MAX_LABEL]) {
    const char *slash = file ? strrchr(spec, '/') : NULL, *start = slash ? slash + 1 : spec;
    size_t length = file ? strcspn(start, ".") : strlen(start);
    snprintf(label, RT_MAX_LABEL, "%.*s", (int)length, start);
    for (char *c = label; *c; c++) {
        if (!rt_may_label(*c)) *c = '_';
    }
}

static RtStatus add_scene(RtExperiment *experiment, const RtWorkload *like, const RtSweep *sweep, uint32_t i,
                          const char *folder, RtError *error) {
    char spec[RT_MAX_SPEC_CHARS], base[RT_MAX_SCENE_NAME];
    if (experiment->workload_count == RT_MAX_WORKLOADS) {
        return rt_fail(error, RT_BAD_INPUT, "there are more than %d scenes: sweep fewer values",
                       RT_MAX_WORKLOADS);
    }
    RtWorkload *workload = &experiment->workloads[experiment->workload_count++];
    *workload = *like;
    RT_TRY(rt_sweep_at(sweep, i, spec, &workload->swept, error));
    if (strlen(spec) >= sizeof workload->spec) {
        return rt_fail(error, RT_BAD_INPUT, "%.40s...: a scene has at most %zu characters", spec,
                       sizeof workload->spec - 1);
    }
    strcpy(workload->spec, spec);
    workload->file = strcspn(spec, "./") < strcspn(spec, ":");
    RT_TRY(rt_path_join(workload->file ? folder : "", spec, workload->path, error));
    rt_sweep_base(sweep, base, sizeof base);
    if (*like->label) {
        strcpy(workload->base, like->label);
        return label_one(workload->label, like->label, &workload->swept, error);
    }
    name_scene(base, workload->file, workload->base);
    name_scene(spec, workload->file, workload->label);
    return RT_OK;
}

RtStatus rt_experiment_add_scenes(RtExperiment *experiment, const RtWorkload *like, const char *spec,
                                  const char *folder, RtError *error) {
    RtSweep sweep;
    RT_TRY(rt_sweep_parse(spec, true, NULL, &sweep, error));
    for (uint32_t i = 0; i < sweep.count; i++) RT_TRY(add_scene(experiment, like, &sweep, i, folder, error));
    return RT_OK;
}

/* ---- accelerators ---- */

/* Truncated specs may make equal labels. */
static bool is_taken(const RtExperiment *experiment, const RtCandidate *candidate) {
    const RtCandidate *other = experiment->candidates;
    while (strcmp(other->label, candidate->label) != 0) other++;
    return other != candidate;
}

static RtStatus add_accel(RtExperiment *experiment, const RtCandidate *like, const RtSweep *sweep, uint32_t i,
                          RtError *error) {
    if (experiment->candidate_count == RT_MAX_CANDIDATES) {
        return rt_fail(error, RT_BAD_INPUT, "there are more than %d accelerators: sweep fewer values",
                       RT_MAX_CANDIDATES);
    }
    char spec[RT_MAX_SPEC_CHARS];
    RtCandidate *candidate = &experiment->candidates[experiment->candidate_count++];
    *candidate = *like;
    RT_TRY(rt_sweep_at(sweep, i, spec, &candidate->swept, error));
    strcpy(candidate->spec, spec);
    if (*like->label) {
        strcpy(candidate->base, like->label);
        return label_one(candidate->label, like->label, &candidate->swept, error);
    }
    rt_sweep_base(sweep, candidate->base, RT_MAX_LABEL);
    snprintf(candidate->label, RT_MAX_LABEL, "%.*s", RT_MAX_LABEL - 1, spec);
    if (strlen(spec) >= RT_MAX_LABEL && is_taken(experiment, candidate))
        snprintf(candidate->label, RT_MAX_LABEL, "%.*s...%u", RT_MAX_LABEL - 8, spec,
                 experiment->candidate_count);
    return RT_OK;
}

RtStatus rt_experiment_add_accels(RtExperiment *experiment, const RtCandidate *like, RtError *error) {
    RtSweep sweep;
    RT_TRY(rt_sweep_parse(like->spec, false, experiment->manifest, &sweep, error));
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
    uint32_t c = candidate < experiment->candidate_count ? candidate : experiment->baseline;
    return rt_swept_value(
        key->scene ? &experiment->workloads[workload].swept : &experiment->candidates[c].swept, key->key);
}
