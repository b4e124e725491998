/* SPDX-License-Identifier: Apache-2.0 */
#include "experiment/labels.h"

#include "core/base/words.h"

#include <ctype.h>
#include <inttypes.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>

bool rt_may_label(char c) {
    return isgraph((unsigned char)c) && !strchr("\"'`/\\$&<>@^{}", c);
}

/* ---- making ---- */

void rt_swept_name(const RtSwept *swept, const char *but, char *out, size_t size) {
    for (uint32_t i = 0; i < swept->count; i++) {
        if (but && strcmp(swept->keys[i], but) == 0) continue;
        rt_append_text(out, size, ":%s=%s", swept->keys[i], swept->values[i]);
    }
}

RtStatus rt_label_sweep(const char *given, const RtSwept *swept, char stem[RT_MAX_LABEL],
                        char label[RT_MAX_LABEL], RtError *error) {
    char whole[RT_MAX_LABEL + RT_MAX_SWEPT * (RT_MAX_NAME + RT_MAX_SWEPT_CHARS + 2)];
    strcpy(stem, given);
    snprintf(whole, sizeof whole, "%s", given);
    rt_swept_name(swept, NULL, whole, sizeof whole);
    if (strlen(whole) >= RT_MAX_LABEL) {
        return rt_fail(error, RT_BAD_INPUT, "'%s' is longer than %d characters: give a short `label`", whole,
                       RT_MAX_LABEL - 1);
    }
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

void rt_label_scene(RtExperiment *experiment, RtWorkload *workload, const char *stem, const char *spec) {
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

void rt_label_files(RtExperiment *experiment, uint32_t i) {
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

void rt_labels_shorten(RtExperiment *experiment) {
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

/* ---- finding ---- */

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
