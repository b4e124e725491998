/* SPDX-License-Identifier: Apache-2.0 */
/* An experiment: a question, and what is measured to answer it. Every accelerator of the list is counted and
 * timed on every scene, for every kind of ray; experiments/README.md explains the YAML form key by key. */
#ifndef RT_EXPERIMENT_EXPERIMENT_H
#define RT_EXPERIMENT_EXPERIMENT_H

#include "accel/accel.h"
#include "core/base/file.h"
#include "experiment/sweep.h"
#include "measure/statistics.h"
#include "rays/rayset.h"

#include <jansson.h>

#define RT_MAX_LABEL      48
#define RT_MAX_TEXT       4096
#define RT_MAX_WORKLOADS  32
#define RT_MAX_CANDIDATES 256
#define RT_MAX_PLOTS      8
#define RT_MAX_CLAIMS     64
#define RT_MAX_CLAIM      256

/* One scene of an experiment. Labels are unique, without blanks and quotes: names in CSV and plots. */
typedef struct RtWorkload {
    char label[RT_MAX_LABEL];
    char base[RT_MAX_LABEL];      /* what all of one sweep share of their labels; else the label */
    RtSwept swept;                /* of the scene's parameters */
    uint32_t entry;               /* of the list in the YAML: several come of one that sweeps */
    char spec[RT_MAX_SCENE_NAME]; /* as written */
    char path[RT_MAX_PATH];       /* for rt_scene_open: a built-in, or the file seen from the YAML's folder */
    uint32_t width, height;       /* of the frame whose rays are recorded; 0 x 0: the camera's */
    uint32_t depth;               /* levels of the ray tree */
    bool corners;                 /* samples at pixel corners instead of centres */
    bool light_from_outside;      /* shadow rays as in RtFrameOptions */
    bool file;                    /* path names a file, not a built-in */
    bool optional;                /* a missing file is a notice, not an error */
} RtWorkload;

/* One accelerator of an experiment. No two on the same scene have the same label. */
typedef struct RtCandidate {
    char label[RT_MAX_LABEL];
    char base[RT_MAX_LABEL]; /* as of a workload */
    RtSwept swept;
    uint32_t entry;
    char group[RT_MAX_LABEL];     /* the heading it stands under in the table of frames, or "" */
    char spec[RT_MAX_SPEC_CHARS]; /* as written */
    RtSpec parsed;                /* no layers until rt_candidate_parse */
    uint64_t ray_stride;          /* k: measured on each kth ray of a set, so that slow ones finish; >= 1 */
    uint32_t left_out;            /* bit t: it is not measured on workloads[t] */
    bool missing;                 /* this build does not have it: skipped with a notice */
    bool ours;                    /* one of those that are to need less than every published row */
} RtCandidate;

_Static_assert(RT_MAX_WORKLOADS <= 32, "a bit of left_out for every workload");

/* What published tables may have a figure for. Of structures: as in RtDescription. Per ray of all kinds of
 * the experiment together: as in RtTally. Of the rays themselves: how many there are, and how many of them
 * hit; secondary are reflection and transmission. X(name) */
#define RT_PUBLISHED_OF_STRUCTURES(X) X(interior) X(leaves) X(empty_leaves) X(references)
#define RT_PUBLISHED_PER_RAY(X)       X(object_tests) X(steps) X(leaf_steps) X(empty_steps)
#define RT_PUBLISHED_OF_RAYS(X)                                                                              \
    X(primary) X(primary_hit) X(shadow) X(shadow_hit) X(secondary) X(secondary_hit)
#define RT_PUBLISHED_COLUMNS(X) RT_PUBLISHED_OF_STRUCTURES(X) RT_PUBLISHED_PER_RAY(X) RT_PUBLISHED_OF_RAYS(X)

typedef enum RtColumn {
#define RT_COLUMN(name) RT_COLUMN_##name,
    RT_PUBLISHED_COLUMNS(RT_COLUMN)
#undef RT_COLUMN
        RT_COLUMN_COUNT
} RtColumn;

#define RT_MAX_PUBLISHED 4

/* Published figures that the measured ones are compared with (literature/published.h). */
typedef struct RtPublishedSetup {
    char tables[RT_MAX_PUBLISHED][RT_MAX_LABEL]; /* CSV files, seen from the YAML's folder */
    uint32_t table_count;                        /* 0: nothing is compared */
    char reasons[RT_MAX_LABEL];                  /* CSV file, or "" */
    double tolerance[RT_COLUMN_COUNT];           /* in percent; 0: shown, not judged */
} RtPublishedSetup;

/* The table of what a whole frame costs (experiment/frame_table.h). */
typedef struct RtFrameSetup {
    char without[RT_MAX_LABEL]; /* the candidate that has no structure; "": there is no such table */
    char among[RT_MAX_LABEL];   /* how the groups begin whose best is marked */
    char note[RT_MAX_TEXT];     /* what a reader of the table should know, or "" */
} RtFrameSetup;

typedef struct RtExperiment {
    char name[RT_MAX_LABEL];
    char question[RT_MAX_TEXT], prediction[RT_MAX_TEXT];
    char finding[RT_MAX_TEXT];                /* what was learnt, or "" */
    char claims[RT_MAX_CLAIMS][RT_MAX_CLAIM]; /* experiment/claims.h */
    uint32_t claim_count;
    RtWorkload workloads[RT_MAX_WORKLOADS];
    uint32_t workload_count;
    RtCandidate candidates[RT_MAX_CANDIDATES];
    uint32_t candidate_count;
    char again[RT_MAX_LABEL +
               8]; /* label of the null run, the baseline's with " (again)": rt_experiment_check */
    /* Ratios refer to the candidates baseline..baseline + baseline_count - 1, to the fastest of them on the
     * rays of the cell where they are several. None of them is thinned. */
    uint32_t baseline, baseline_count;
    char best[RT_MAX_LABEL]; /* what several stand for, "embree:best"; else "" */
    RtRayKind kinds[RT_RAY_KIND_COUNT];
    uint32_t kind_count;
    uint64_t limit;        /* rays of one kind at most; a larger set is thinned evenly */
    uint64_t coherent_run; /* neighbouring rays that are kept together where a set is thinned */
    uint32_t rounds;       /* 1..RT_MAX_ROUNDS */
    uint32_t milliseconds; /* a short set is repeated within a round until it takes this long; 0: once */
    uint64_t seed;
    double limit_seconds;     /* a cell that would take longer is left out; 0: none is */
    uint64_t limit_megabytes; /* a structure that takes more, also while it is built, is left out; 0: none */
    char plots[RT_MAX_PLOTS]
              [RT_MAX_LABEL]; /* gnuplot scripts seen from the YAML, run in this order in one go */
    uint32_t plot_count;
    RtPublishedSetup published;
    RtFrameSetup frame;
    char rays_from[RT_MAX_PATH]; /* a file of rays (measure/ray_file.h) of the one kind, in place of recorded
                                    ones; or "" */
    bool count_only;             /* nothing is timed */
    bool hardware;      /* what the machine did for rays is counted, where it tells (measure/hardware.h) */
    bool distributions; /* of counts over rays, and of leaves (measure/distribution.h) */
    bool quick;         /* the smaller variant, for a first look */
    char path[RT_MAX_PATH];   /* of the YAML; "" where there is none */
    char folder[RT_MAX_PATH]; /* of the YAML */
    /* While it is loaded: the manifest of the results that it is loaded to read, or NULL. Nobody then asks
     * which accelerators are there (experiment/manifest_experiment.h). */
    const json_t *manifest;
    uint64_t fingerprint; /* of the YAML's bytes, without finding and expect, which change no result */
} RtExperiment;

/* No scenes, no candidates, all ray kinds but occlusion, which is diffuse once more, and the defaults: limit
 * 100000, rays kept singly, 10 rounds, 20 milliseconds. */
void rt_experiment_init(RtExperiment *experiment);

/* Reads the YAML at `path`. Whatever is wrong (unknown keys, specs that do not parse, labels used twice, a
 * baseline that is no candidate) is told with its line. `quick` applies the overrides under `quick:`. */
RtStatus rt_experiment_load(RtExperiment *experiment, const char *path, bool quick, RtError *error);

/* The same of the YAML that results were made from, for those who only read them: accelerators, baseline and
 * what was missing are as their manifest has them, and need not be there. It cannot be run. */
RtStatus rt_experiment_load_from_manifest(RtExperiment *experiment, const char *path, const json_t *manifest,
                                          RtError *error);

/* What rays of a file may be: asked for the nearest hit, or for any. They stand under these names in tables,
 * where recorded ones have theirs. */
RtStatus rt_given_kind_parse(const char *name, RtRayKind *kind, RtError *error);
const char *rt_experiment_kind_name(const RtExperiment *experiment, RtRayKind kind);

/* Whether candidate `c`, which may be the null run (candidate_count), is measured on workload `t`. */
bool rt_candidate_runs(const RtExperiment *experiment, uint32_t c, uint32_t t);

/* The baseline by its label; or, where that is the name of a best of (accel.h: "embree:best"), what it stands
 * for here, appended to the candidates. A label that is none leaves an index that rt_experiment_check
 * refuses. NULL chooses the first that is not of a plugin. */
RtStatus rt_experiment_set_baseline(RtExperiment *experiment, const char *label, RtError *error);

/* Parses the candidate's spec, unless that is done. rt_experiment_check does it for all that this build has.
 */
RtStatus rt_candidate_parse(RtCandidate *candidate, RtError *error);

/* Whether candidate `c` is one of those that ratios refer to. */
bool rt_candidate_is_baseline(const RtExperiment *experiment, uint32_t c);

/* What ratios refer to: the label of the baseline, or "embree:best". */
const char *rt_baseline_label(const RtExperiment *experiment);

/* The candidate of that label on workload `t`; candidate_count + 1 where there is none. `again` is the null
 * run. */
uint32_t rt_candidate_find(const RtExperiment *experiment, const char *label, uint32_t t);

/* The workload of that label; workload_count where there is none. */
uint32_t rt_workload_find(const RtExperiment *experiment, const char *label);

/* Under which name a script is copied into the result directory: without the folders it lies in. No two have
 * the same. */
const char *rt_plot_name(const RtExperiment *experiment, uint32_t plot);

/* Appends one workload like `like` for each scene that `spec` stands for (experiment/sweep.h). Sets spec,
 * path, file, swept, and the label. That is made from the scene where `like` has none: the file's name
 * without folder and extension, or the built-in as it is written, with _ for what a label may not have; else
 * one of several gets ":key=value" behind the label of `like`. A dot or a slash before the first colon makes
 * `spec` a file, seen from `folder`. */
RtStatus rt_experiment_add_scenes(RtExperiment *experiment, const RtWorkload *like, const char *spec,
                                  const char *folder, RtError *error);

/* Appends one candidate like `like` for each accelerator that its spec stands for. A label is made as that of
 * a workload; without one it is the spec. */
RtStatus rt_experiment_add_accels(RtExperiment *experiment, const RtCandidate *like, RtError *error);

/* A parameter that an experiment sweeps, of scenes or of accelerators: those of one name are one. */
#define RT_MAX_SWEPT_KEYS 8
typedef struct RtSweptKey {
    const char *key; /* borrowed */
    bool scene;
    bool number; /* every value is one */
} RtSweptKey;

/* All of them, those of scenes first, in the order in which they are written: how many. */
uint32_t rt_experiment_swept(const RtExperiment *experiment, RtSweptKey keys[RT_MAX_SWEPT_KEYS]);

/* Its value for a cell, where `candidate` may be the null run; NULL where it has none. */
const char *rt_swept_of(const RtExperiment *experiment, const RtSweptKey *key, uint32_t workload,
                        uint32_t candidate);

/* Whether labels may have this character: they name rows of CSV, plots and files of images. */
bool rt_may_label(char c);

/* Whether the parts of an experiment, each in its range, go together, however it came about; marks candidates
 * that this build lacks. *where gets the path of the fault in the YAML ("name", "accelerators[2]"), room for
 * RT_MAX_LABEL. */
RtStatus rt_experiment_check(RtExperiment *experiment, char *where, RtError *error);

#endif
