/* SPDX-License-Identifier: Apache-2.0 */
/* Claims: statements about the results that an experiment expects to hold, and figures that it asks for. They
 * stand in the lists `expect` and in the braces of a finding (experiment/finding.h).
 *
 *     CLAIM    = QUANTITY [PLACE] OP NUMBER                   OP: <  <=  >  >=
 *              | QUANTITY [PLACE] [as FORMAT]                 a readout
 *              | SIDE TREND with PARAM [PLACE]                TREND: falls, rises, never falls, never rises
 *              | ACCEL is fastest [PLACE]                     of all accelerators of the experiment
 *              | ACCEL has least MEASURE [PLACE]
 *              | fastest [PLACE] | least MEASURE [PLACE]      a readout: which one
 *              | count of CLAIM                               a readout: in how many of its cells it holds
 *     QUANTITY = SIDE
 *              | ratio of SIDE [PLACE] to [MEASURE of] ACCEL
 *              | exponent of SIDE in PARAM
 *              | crossover of SIDE and ACCEL in PARAM
 *              | correlation of MEASURE and MEASURE of ACCEL
 *              | geometric mean of QUANTITY                   over the cells of each kind of rays
 *     SIDE     = MEASURE of ACCEL, or a MEASURE of rays or scenes alone
 *     PLACE    = any of: on SCENE, for KIND rays, for all rays,
 *                at largest PARAM, at smallest PARAM, at PARAM=VALUE
 *     FORMAT   = [plain] [times | percent [less | more] | ms | us | MB | thousands | millions]
 *     MEASURE  = time; object_tests, extent_tests, steps, csg_tests (each per ray); build_time, bytes,
 *                predicted_cost, interior, leaves, empty_leaves, references, depth; break_even (rays);
 *                frame_time (s, the whole sets of all kinds); render_time (s), query_share (`render`); of the
 *                rays of a scene: rays (of the whole set), share (of them in all rays), hits (the part that
 *                hits); of a scene: objects
 *
 * ACCEL and SCENE are labels, or the common part of the labels of a sweep. ACCEL may be `all`, every
 * accelerator of the list except the second, if there is one; or the name of a baseline of several
 * settings ("embree:best"): the setting that is the fastest on each kind of rays. PARAM is a swept parameter:
 * n, or scene.n or accel.n if both have it; or, except in "at", `objects`, the number of objects of the
 * scene, however scenes are named. A claim covers every cell that it does not exclude, and holds if it holds
 * for all of them. Without "for" that is each kind of rays by itself that a scene has, and the verdict says
 * where kinds differ; "for all rays" is their sum: the mean cost of a ray, each kind weighted by the size of
 * its set. "at" excludes cells without the parameter. "falls" means from each value of the parameter to the
 * next larger one.
 *
 * The second side of a ratio or a crossover is one accelerator; in a crossover it may sweep PARAM, too. A
 * ratio with a place before "to" compares cells in different places: what one side does not name is as in the
 * other, a swept parameter has the same value. */
#ifndef RT_EXPERIMENT_CLAIM_H
#define RT_EXPERIMENT_CLAIM_H

#include "experiment/experiment.h"

/* What a measure belongs to. */
typedef enum RtClaimSubject {
    RT_SUBJECT_RAYS,      /* an accelerator's queries of one kind of rays */
    RT_SUBJECT_FRAME,     /* those of all kinds */
    RT_SUBJECT_STRUCTURE, /* an accelerator */
    RT_SUBJECT_SET,       /* a set of rays, whatever the accelerator */
    RT_SUBJECT_SCENE
} RtClaimSubject;

/* X(CONSTANT, name, unit of a figure, subject). */
#define RT_CLAIM_MEASURES(X)                                                                                 \
    X(TIME, "time", " ns", RAYS)                                                                             \
    X(OBJECT_TESTS, "object_tests", "", RAYS)                                                                \
    X(EXTENT_TESTS, "extent_tests", "", RAYS)                                                                \
    X(STEPS, "steps", "", RAYS)                                                                              \
    X(CSG_TESTS, "csg_tests", "", RAYS)                                                                      \
    X(FRAME_TIME, "frame_time", " s", FRAME)                                                                 \
    X(BUILD_TIME, "build_time", " s", STRUCTURE)                                                             \
    X(BYTES, "bytes", " bytes", STRUCTURE)                                                                   \
    X(PREDICTED_COST, "predicted_cost", "", STRUCTURE)                                                       \
    X(INTERIOR, "interior", "", STRUCTURE)                                                                   \
    X(LEAVES, "leaves", "", STRUCTURE)                                                                       \
    X(EMPTY_LEAVES, "empty_leaves", "", STRUCTURE)                                                           \
    X(REFERENCES, "references", "", STRUCTURE)                                                               \
    X(DEPTH, "depth", "", STRUCTURE)                                                                         \
    X(BREAK_EVEN, "break_even", " rays", STRUCTURE)                                                          \
    X(RENDER_TIME, "render_time", " s", STRUCTURE)                                                           \
    X(QUERY_SHARE, "query_share", "", STRUCTURE)                                                             \
    X(RAY_COUNT, "rays", "", SET)                                                                            \
    X(SHARE, "share", "", SET)                                                                               \
    X(HITS, "hits", "", SET)                                                                                 \
    X(OBJECTS, "objects", "", SCENE)

typedef enum RtClaimMeasure {
#define RT_CLAIM_MEASURE(CONSTANT, name, unit, subject) RT_CLAIM_##CONSTANT,
    RT_CLAIM_MEASURES(RT_CLAIM_MEASURE)
#undef RT_CLAIM_MEASURE
} RtClaimMeasure;

const char *rt_claim_measure_unit(RtClaimMeasure measure);
RtClaimSubject rt_claim_subject(RtClaimMeasure measure);

/* From RT_CLAIM_EXPONENT on a figure is of a line of several cells. */
typedef enum RtClaimForm {
    RT_CLAIM_VALUE,
    RT_CLAIM_RATIO,
    RT_CLAIM_LEAST, /* the ratio to each other accelerator, at most 1 */
    RT_CLAIM_EXPONENT,
    RT_CLAIM_CROSSOVER,
    RT_CLAIM_CORRELATION,
    RT_CLAIM_TREND
} RtClaimForm;

#define RT_CLAIM_ALL "all" /* as ACCEL */

#define RT_MAX_CLAIM_PLACES 4

#define RT_CLAIM_RAYS 1000 /* fewer rays decide nothing */

/* A value "at" which cells are. */
typedef struct RtClaimPlace {
    RtSweptKey key;
    char value[RT_MAX_SWEPT_CHARS];
} RtClaimPlace;

/* A measure of an accelerator, and the cells in which it is meant. */
typedef struct RtClaimSide {
    RtClaimMeasure measure;
    char accel[RT_MAX_LABEL]; /* "" for a measure without one, and for `fastest` and `least` as readouts */
    char scene[RT_MAX_LABEL]; /* "" for all */
    bool each_kind;           /* for each kind of rays by itself */
    RtRayKind kind;           /* else; or RT_ALL_RAYS */
    uint32_t place_count;
    RtClaimPlace places[RT_MAX_CLAIM_PLACES];
} RtClaimSide;

/* How a readout is written: scale * value + offset, of the value in SI units. */
typedef struct RtClaimFormat {
    double scale, offset; /* scale 0: as it is, in the measure's unit */
    const char *unit;     /* static */
    bool plain;           /* without its interval */
} RtClaimFormat;

/* A parsed claim. */
typedef struct RtClaim {
    RtClaimForm form;
    bool mean;    /* the geometric mean of the form's figures */
    bool counted; /* in how many cells it holds */
    /* Of a ratio `second` is the denominator, of a crossover the other curve, of a correlation the second
     * measure, else a copy of `first`. */
    RtClaimSide first, second;
    bool apart;             /* a ratio of cells in different places: those of `second` are its own */
    RtSweptKey key;         /* of an exponent, a crossover or a trend; key.key NULL: none */
    bool by_objects;        /* key is the number of objects of the scene */
    bool rises, strictly;   /* of a trend */
    bool readout;           /* without OP and NUMBER */
    bool greater, or_equal; /* of all others */
    double number;
    RtClaimFormat format;
} RtClaim;

/* Parses `text`, or says what is wrong. The claim borrows from the experiment. */
RtStatus rt_claim_parse(const RtExperiment *experiment, const char *text, RtClaim *claim, RtError *error);

/* Whether the claim has a second side with cells of its own: a ratio or a crossover. */
static inline bool rt_claim_has_two_sides(const RtClaim *claim) {
    return claim->form == RT_CLAIM_RATIO || claim->form == RT_CLAIM_CROSSOVER;
}

/* Whether the claim, or one of a correlation's measures, is of a kind of rays. */
bool rt_claim_is_of_rays(const RtClaim *claim);

/* Whether candidate `c` on workload `t` is where the side is: on its scene, with all values of its "at". */
bool rt_claim_side_has(const RtExperiment *experiment, const RtClaimSide *side, uint32_t t, uint32_t c);

/* A cell: what is measured of a candidate on a workload. */
typedef struct RtClaimCell {
    uint32_t workload, candidate;
    RtRayKind kind; /* or RT_ALL_RAYS */
} RtClaimCell;

/* Finds the second side's cell for a cell of the first. Returns how many there could be, missing accelerators
 * included; *cell gets the first of them. */
uint32_t rt_claim_partner(const RtExperiment *experiment, const RtClaim *claim, const RtClaimCell *of,
                          RtClaimCell *cell);

#endif
