/* SPDX-License-Identifier: Apache-2.0 */
/* The cells of an experiment that a run measures: those of --only and --shard. */
#ifndef RT_EXPERIMENT_SELECTION_H
#define RT_EXPERIMENT_SELECTION_H

#include "experiment/experiment.h"

/* A part of an experiment: a scene, an accelerator, a kind of rays, each by its label, or the common part of
 * the labels of a sweep; NULL for all. */
typedef struct RtPart {
    const char *scene, *accel, *kind;
} RtPart;

/* What is measured: the cells of any of the parts, and the baseline's beside them. */
enum { RT_MAX_PARTS = 32 };
typedef struct RtSelection {
    RtPart parts[RT_MAX_PARTS];
    uint32_t part_count;    /* 0: all cells */
    uint32_t shard, shards; /* the scenes of one of several machines, 1..shards; 0: all */
} RtSelection;

/* Whether the cell is measured; with RT_ALL_RAYS, whether any of the candidate's is. The baseline and the
 * null run (candidate_count) belong to every part. */
bool rt_selection_has(const RtSelection *only, const RtExperiment *experiment, uint32_t workload,
                      uint32_t candidate, RtRayKind kind);

/* Whether any cell of the workload is measured. */
static inline bool rt_selection_has_scene(const RtSelection *only, const RtExperiment *experiment,
                                          uint32_t workload) {
    return rt_selection_has(only, experiment, workload, experiment->candidate_count, RT_ALL_RAYS);
}

/* RT_BAD_INPUT if a label is none of the experiment's. The message begins with "--only". */
RtStatus rt_selection_check(const RtSelection *only, const RtExperiment *experiment, RtError *error);

#endif
