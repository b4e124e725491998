/* An experiment: a question, and what is measured to answer it. Every accelerator of the list is counted and
 * timed on every scene, for every kind of ray; experiments/README.md explains the YAML form key by key. */
#ifndef RT_EXPERIMENTS_EXPERIMENT_H
#define RT_EXPERIMENTS_EXPERIMENT_H

#include "accel/accel.h"
#include "base/file.h"
#include "experiments/statistics.h"

#define RT_MAX_LABEL       48
#define RT_MAX_TEXT        4096
#define RT_MAX_TRIALS      32
#define RT_MAX_CONTENDERS  128
#define RT_MAX_PLOTS       8
#define RT_MAX_RAYS_A_KIND UINT64_C(100000000)

/* One scene of an experiment. Labels are unique, without blanks and quotes: names in CSV and plots. */
typedef struct RtTrial {
    char label[RT_MAX_LABEL];
    char spec[RT_MAX_SCENE_NAME]; /* as written */
    char path[RT_MAX_PATH];       /* for rt_scene_open: a built-in, or the file seen from the YAML's folder */
    uint32_t width, height;       /* of the frame whose rays are recorded; 0 x 0: the camera's */
    uint32_t depth;               /* levels of the ray tree */
    bool corners;                 /* samples at pixel corners instead of centres */
    bool file;                    /* path names a file, not a built-in */
    bool optional;                /* a missing file is a notice, not an error */
} RtTrial;

/* One accelerator of an experiment. */
typedef struct RtContender {
    char label[RT_MAX_LABEL];
    char spec[RT_MAX_SPEC_CHARS]; /* as written */
    uint64_t every; /* measured on every `every`th ray of a set, so that slow ones finish; >= 1 */
    bool missing;   /* this build does not have it: skipped with a notice */
} RtContender;

typedef struct RtExperiment {
    char name[RT_MAX_LABEL];
    char question[RT_MAX_TEXT], prediction[RT_MAX_TEXT];
    RtTrial trials[RT_MAX_TRIALS];
    uint32_t trial_count;
    RtContender contenders[RT_MAX_CONTENDERS];
    uint32_t contender_count;
    uint32_t baseline; /* index of the contender that ratios refer to; it is not thinned */
    RtRayKind kinds[RT_RAY_KIND_COUNT];
    uint32_t kind_count;
    uint64_t limit;        /* rays of one kind at most; a larger set is thinned evenly */
    uint64_t together;     /* neighbouring rays that are kept together where a set is thinned */
    uint32_t rounds;       /* 1..RT_MAX_ROUNDS */
    uint32_t milliseconds; /* a short set is repeated within a round until it takes this long */
    uint64_t seed;
    char plots[RT_MAX_PLOTS][RT_MAX_LABEL]; /* gnuplot scripts beside the YAML, run in this order in one go */
    uint32_t plot_count;
    bool quick;               /* the smaller variant, for a first look */
    char path[RT_MAX_PATH];   /* of the YAML; "" where there is none */
    char folder[RT_MAX_PATH]; /* of the YAML */
    uint64_t fingerprint;     /* of the YAML's bytes */
} RtExperiment;

/* No scenes, no contenders, all ray kinds, and the defaults: limit 100000, rays kept singly, 10 rounds, 20
 * milliseconds. */
void rt_experiment_init(RtExperiment *experiment);

/* Reads the YAML at `path`. Whatever is wrong (unknown keys, specs that do not parse, labels used twice, a
 * baseline that is no contender) is told with its line. `quick` applies the overrides under `quick:`. */
RtStatus rt_experiment_load(RtExperiment *experiment, const char *path, bool quick, RtError *error);

/* Sets spec, path, file and a label made from them: the file's name without folder and extension, or the
 * built-in as it is written. A dot or a slash before the first colon makes `spec` a file, seen from `folder`.
 */
RtStatus rt_trial_set_scene(RtTrial *trial, const char *spec, const char *folder, RtError *error);

/* What every experiment must satisfy however it came about; marks contenders that this build lacks. *where
 * gets the path of the fault in the YAML ("accelerators[2].accel"), room for RT_MAX_LABEL. */
RtStatus rt_experiment_check(RtExperiment *experiment, char *where, RtError *error);

#endif
