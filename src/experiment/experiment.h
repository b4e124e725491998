/* SPDX-License-Identifier: Apache-2.0 */
/* An experiment: a question, and the measurements to answer it. Every accelerator of the list is counted and
 * timed on every scene, for every kind of ray. experiments/README.md explains each key of the YAML. */
#ifndef RT_EXPERIMENT_EXPERIMENT_H
#define RT_EXPERIMENT_EXPERIMENT_H

#include "accel/accel.h"
#include "core/base/file.h"
#include "measure/statistics.h"
#include "rays/rayset.h"

#include <jansson.h>

#define RT_MAX_LABEL      RT_MAX_SPEC_CHARS /* of a scene or an accelerator: whole, as long as its spec */
#define RT_SHOWN_WIDTH    47                /* of a label on a screen */
#define RT_MAX_WORD       48                /* names that people choose: of an experiment, a group, a file */
#define RT_MAX_TEXT       4096
#define RT_MAX_FILE_NAME  128 /* bytes of a label in the name of a file */
#define RT_MAX_WORKLOADS  32
#define RT_MAX_CANDIDATES 256
#define RT_MAX_PLOTS      8
#define RT_MAX_CLAIMS     128
#define RT_MAX_CLAIM      256
#define RT_MAX_PAPERS     16
#define RT_MAX_OWN_BEST   8 /* settings of a best-of that an experiment lists itself */

#define RT_ALL_RAYS RT_RAY_KIND_COUNT /* stands for all ray kinds of an experiment together */

#define RT_MAX_MILLISECONDS 60000 /* of a round of one cell */

/* ---- sweeps (sweep.c) ---- */

#define RT_MAX_SWEPT        4   /* parameters of one spec */
#define RT_MAX_SWEEP_VALUES 256 /* of one parameter */
#define RT_MAX_SWEPT_CHARS  32  /* of a value */

/* The swept parameters of one spec, and their values. */
typedef struct RtSwept {
    uint32_t count; /* 0: nothing is swept */
    char keys[RT_MAX_SWEPT][RT_MAX_NAME];
    char values[RT_MAX_SWEPT][RT_MAX_SWEPT_CHARS];
} RtSwept;

/* The value as a number; false if it is a word. */
bool rt_swept_number(const char *value, double *number);

/* Whether two values are the same text or, as 1e5 and 100000, the same number. */
bool rt_swept_equal(const char *a, const char *b);

/* Whether the increasing values[0..count) are spaced more evenly on a logarithmic than on a linear axis. */
bool rt_swept_logarithmic(const double *values, uint32_t count);

/* Appends ":key=value" for every swept parameter except `but` (or NULL). */
void rt_swept_name(const RtSwept *swept, const char *but, char *out, size_t size);

/* ---- an experiment ---- */

/* One scene of an experiment. Labels are unique, without blanks and quotes: names in CSV and plots. */
typedef struct RtWorkload {
    char label[RT_MAX_LABEL];
    char shown[RT_MAX_LABEL]; /* the label on a screen: a long one without what all have in common, mostly of
                                 RT_SHOWN_WIDTH characters at most (rt_shorten_name): rt_experiment_check */
    char file_name[RT_MAX_FILE_NAME + 8]; /* the label as a part of file names (rt_file_name); unique, also
                                     without regard to case: rt_experiment_check */
    char stem[RT_MAX_LABEL];              /* the common part of the labels of one sweep; else the label */
    RtSwept swept;                        /* of the scene's parameters */
    uint32_t entry;                       /* of the list in the YAML; a sweep makes several workloads */
    char spec[RT_MAX_SCENE_NAME];         /* as written */
    char path[RT_MAX_PATH];  /* for rt_scene_open: a built-in, or the file relative to the YAML's folder */
    uint32_t width, height;  /* of the frame whose rays are recorded; 0 x 0: the camera's */
    uint32_t depth;          /* levels of the ray tree */
    bool corners;            /* samples at pixel corners instead of centres */
    bool light_from_outside; /* shadow rays as in RtFrameOptions */
    bool file;               /* path names a file, not a built-in */
    bool optional;           /* a missing file is a notice, not an error */
} RtWorkload;

/* One accelerator of an experiment. No two on the same scene have the same label. */
typedef struct RtCandidate {
    char label[RT_MAX_LABEL];
    char shown[RT_MAX_LABEL], stem[RT_MAX_LABEL]; /* as of a workload */
    RtSwept swept;
    uint32_t entry;
    char group[RT_MAX_WORD];      /* its heading in the table of frames, or "" */
    char spec[RT_MAX_SPEC_CHARS]; /* as written */
    RtSpec parsed;                /* by rt_experiment_check, if this build has it */
    /* A best-of has members instead, the settings among which a run chooses for each scene and kind of rays:
     * those of RtBestOf, or of the sweep `best_of`. It has no cells of its own (rt_results_candidate). The
     * first member is the default. */
    char best_of[RT_MAX_SPEC_CHARS];
    uint16_t members[RT_MAX_BEST];
    uint32_t member_count; /* 0: it is measured itself */
    bool tried;            /* only a member, not listed: tables to read leave it out */
    uint64_t ray_stride;   /* k: measured on every kth ray of a set, for slow accelerators; >= 1 */
    uint32_t excluded;     /* bit t: it is not measured on workloads[t] */
    bool optional;         /* if a plugin that is not loaded has it, or the machine cannot run it, it is
                              missing, no error */
    bool missing;          /* this build or machine lacks it: skipped with a notice */
} RtCandidate;

_Static_assert(RT_MAX_WORKLOADS <= 32, "a bit of excluded for every workload");

/* The table of the costs of a whole frame (results/result_tables.h). */
typedef struct RtFrameSetup {
    char without[RT_MAX_LABEL]; /* the candidate without a structure; "": no such table */
    char among[RT_MAX_WORD];    /* the group whose fastest is marked */
    char note[RT_MAX_TEXT];     /* a note for readers of the table, or "" */
} RtFrameSetup;

typedef enum RtPaperVerdict {
    RT_PAPER_UNJUDGED, /* none is given yet */
    RT_PAPER_CONFIRMED,
    RT_PAPER_IN_PART,
    RT_PAPER_NOT_CONFIRMED,
    RT_PAPER_TRUE_OF_ITS_MACHINE,
    RT_PAPER_NOT_TESTED,
    RT_PAPER_NO_CLAIM, /* the sentence states nothing that can be tested */
    RT_PAPER_VERDICT_COUNT
} RtPaperVerdict;

/* A sentence of the literature that an experiment tests. */
typedef struct RtPaper {
    char citation[RT_MAX_TEXT];
    char page[RT_MAX_WORD];  /* or "unseen": the paper was not at hand, and `quote` states its claim in other
                                 words (rt_paper_is_seen) */
    char quote[RT_MAX_TEXT]; /* word for word, without quotation marks */
    RtPaperVerdict verdict;
    char modelled[RT_MAX_TEXT];        /* how the paper's configuration is modelled, or "" */
    uint32_t first_claim, claim_count; /* in RtExperiment.claims: what the verdict rests on */
} RtPaper;

typedef struct RtExperiment {
    char name[RT_MAX_WORD];
    char section[RT_MAX_WORD]; /* its heading in an index, or "" */
    RtPaper papers[RT_MAX_PAPERS];
    uint32_t paper_count;
    char question[RT_MAX_TEXT], prediction[RT_MAX_TEXT];
    char finding[RT_MAX_TEXT];                /* the conclusion (experiment/finding.h), or "" */
    char not_shown[RT_MAX_TEXT];              /* what it does not show, or "" */
    char claims[RT_MAX_CLAIMS][RT_MAX_CLAIM]; /* experiment/claim.h; those of papers come last */
    uint32_t claim_count;
    RtWorkload workloads[RT_MAX_WORKLOADS];
    uint32_t workload_count;
    RtCandidate candidates[RT_MAX_CANDIDATES];
    uint32_t candidate_count;
    char again[RT_MAX_LABEL +
               8];     /* label of the null run, the baseline's with " (again)": rt_experiment_check */
    uint32_t baseline; /* the candidate that ratios refer to; may be a best-of */
    RtRayKind kinds[RT_RAY_KIND_COUNT];
    uint32_t kind_count;
    uint64_t limit;        /* rays of one kind at most; a larger set is thinned evenly */
    uint64_t coherent_run; /* a set is thinned in runs of so many neighbouring rays */
    uint32_t rounds;       /* 1..RT_MAX_ROUNDS */
    uint32_t builds;       /* of each structure at most, after a warm-up: 1..RT_MAX_ROUNDS */
    uint32_t milliseconds; /* a short set is repeated within a round until it takes this long; 0: once */
    uint32_t threads;      /* for timed builds and rays; 0: all processors */
    uint64_t seed;
    double limit_seconds; /* longer cells are left out; 0: no limit */
    uint64_t limit_bytes; /* larger structures, also while built, are left out; 0: no limit */
    char plots[RT_MAX_PLOTS]
              [RT_MAX_WORD]; /* gnuplot scripts relative to the YAML, run in this order in one process */
    uint32_t plot_count;
    RtFrameSetup frame;
    char rays_from[RT_MAX_PATH]; /* a file of rays (measure/ray_file.c) of the one kind, in place of recorded
                                    ones; or "" */
    bool count_only;             /* nothing is timed */
    bool render;                 /* frames are rendered, too */
    bool distributions;          /* of counts over rays, and of leaves (measure/statistics.h) */
    bool quick;                  /* the smaller variant, for a first look */
    char path[RT_MAX_PATH];      /* of the YAML, or "" */
    RtError warning;             /* about the YAML, for the user; or "" */
    char folder[RT_MAX_PATH];    /* of the YAML */
    /* Only while loading: the manifest of the results to read, or NULL. It replaces the registry of
     * accelerators. */
    const json_t *manifest;
    uint64_t fingerprint; /* of the YAML's bytes without the keys that affect no result: section, paper,
                             expect, finding, not_shown, plots */
    uint64_t fingerprint_with_plots; /* that of version 1.0 */
} RtExperiment;

/* No scenes, no candidates, all ray kinds except occlusion (it repeats diffuse), and the defaults: limit
 * 100000, coherent runs of RT_COHERENT_RUN, 10 rounds, 20 builds, 20 milliseconds, 1 thread. */
void rt_experiment_init(RtExperiment *experiment);

/* Reads the YAML at `path`. Reports any error (unknown keys, invalid specs, duplicate labels, a baseline that
 * is no candidate) with its line. `quick` applies the overrides under `quick:`.
 *
 * With a manifest, else NULL, it is the YAML of existing results, to read them only: accelerators, baseline
 * and missing ones are those of the manifest; this build may lack them. The experiment cannot be run. */
RtStatus rt_experiment_load(RtExperiment *experiment, const char *path, bool quick, const json_t *manifest,
                            RtError *error);

/* Whether `hash`, in a journal or a manifest, is that of this version of the experiment. */
bool rt_experiment_has_hash(const RtExperiment *experiment, const json_t *hash);

/* Rays of a file ask for the nearest hit or for any hit; tables show these names instead of kinds. */
RtStatus rt_given_kind_parse(const char *name, RtRayKind *kind, RtError *error);
const char *rt_experiment_kind_name(const RtExperiment *experiment, RtRayKind kind);

/* "confirmed", "in part", "not confirmed", "true of its machine", "not tested", "no claim"; "not judged"
 * before the run. */
const char *rt_paper_verdict_name(RtPaperVerdict verdict);

/* Whether the paper was at hand, so that `quote` is word for word. */
bool rt_paper_is_seen(const RtPaper *paper);

/* Whether rays of that kind are asked for. */
bool rt_experiment_has_kind(const RtExperiment *experiment, RtRayKind kind);

/* Whether candidate `c`, which may be the null run (candidate_count), is measured on workload `t`; of a
 * best-of, whether any member is. */
bool rt_candidate_runs(const RtExperiment *experiment, uint32_t c, uint32_t t);

/* Sets the baseline by its label. The name of a best-of (accel.h: "embree:best") is appended to the
 * candidates if it is not one of them. An unknown label sets an index that rt_experiment_check rejects. NULL
 * chooses the first candidate that is not a plugin's. */
void rt_experiment_set_baseline(RtExperiment *experiment, const char *label);

/* Whether candidate `c` is a member of the best-of `best`. */
bool rt_candidate_is_member(const RtExperiment *experiment, uint32_t best, uint32_t c);

/* Whether candidate `c` is the baseline, or a member of it. */
bool rt_candidate_is_baseline(const RtExperiment *experiment, uint32_t c);

/* The candidate whose spec is built for `c`: itself; for the null run (candidate_count) the baseline, or the
 * first of its members that this machine has. */
uint32_t rt_candidate_built(const RtExperiment *experiment, uint32_t c);

const char *rt_baseline_label(const RtExperiment *experiment);

/* The candidate with that label on workload `t`; candidate_count for `again`, the null run; candidate_count +
 * 1 if there is none. */
uint32_t rt_candidate_find(const RtExperiment *experiment, const char *label, uint32_t t);

/* The workload with that label; workload_count if there is none. Both also take the labels that version 1.0
 * cut to 47 characters. */
uint32_t rt_workload_find(const RtExperiment *experiment, const char *label);

/* Whether `name` is its label, or its stem, which all of a sweep have. */
bool rt_candidate_is_called(const RtCandidate *candidate, const char *name);
bool rt_workload_is_called(const RtWorkload *workload, const char *name);

/* The name of a script in the result directory: without its folders. Names are unique. */
const char *rt_plot_name(const RtExperiment *experiment, uint32_t plot);

/* Appends one workload like `like` for each scene of the sweep `spec` (sweep.c). Sets spec, path,
 * file, swept, and the label: that of `like`, with ":key=value" in a sweep; without one, the file's name
 * without folder and extension, or the built-in's spec, with _ for characters that labels may not have. A dot
 * or a slash before the first colon makes `spec` a file, relative to `folder`. */
RtStatus rt_experiment_add_scenes(RtExperiment *experiment, const RtWorkload *like, const char *spec,
                                  const char *folder, RtError *error);

/* Appends one candidate like `like` for each accelerator of its sweep. The label is made as for a workload;
 * without one it is the spec. */
RtStatus rt_experiment_add_accels(RtExperiment *experiment, const RtCandidate *like, RtError *error);

/* A swept parameter of scenes or of accelerators; parameters with the same name are one. */
#define RT_MAX_SWEPT_KEYS 8
typedef struct RtSweptKey {
    const char *key; /* borrowed */
    bool scene;
    bool number; /* all values are numbers */
} RtSweptKey;

/* Returns the number of swept parameters; those of scenes come first, in the order of the YAML. */
uint32_t rt_experiment_swept(const RtExperiment *experiment, RtSweptKey keys[RT_MAX_SWEPT_KEYS]);

/* Its value for a cell, or NULL; `candidate` may be the null run. */
const char *rt_swept_of(const RtExperiment *experiment, const RtSweptKey *key, uint32_t workload,
                        uint32_t candidate);

/* Whether labels may have this character: they name CSV rows, plots and image files. */
bool rt_may_label(char c);

/* Appends the members of each best-of that are not candidates yet; checks that the parts of an experiment,
 * each in its range, are consistent; marks candidates that this build lacks. *where, RT_MAX_LABEL characters,
 * gets the path of the fault in the YAML ("name", "accelerators[2]").
 */
RtStatus rt_experiment_check(RtExperiment *experiment, char *where, RtError *error);

/* ---- the cells that a run measures: those of --only and --shard ---- */

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

/* ---- accelerators of results ----
 *
 * As the manifest of results lists them, for commands that only read these: this build may lack them, or have
 * others (a plugin that is not loaded or has changed; a library's settings on another machine). */

/* Copies spec and label of accelerator number `i` to *candidate; false if there is none. */
bool rt_manifest_candidate(const json_t *manifest, uint32_t i, RtCandidate *candidate);

/* The label of a member of the best-of that is accelerator number `i`; NULL if there are no more. */
const char *rt_manifest_member(const json_t *manifest, uint32_t i, size_t member);

/* Whether the build that ran it lacked accelerator number `i`. */
bool rt_manifest_is_missing(const json_t *manifest, uint32_t i);

/* Whether parameter `key` of the accelerator `owner` has only whole numbers in the manifest. */
bool rt_manifest_is_whole(const json_t *manifest, const char *owner, const char *key);

#endif
