/* SPDX-License-Identifier: Apache-2.0 */
/* Claims: statements about the results that an experiment expects to hold, and figures that it asks for
 * (`expect`).
 *
 *     CLAIM    = QUANTITY [PLACE] OP NUMBER                   OP: <  <=  >  >=
 *              | QUANTITY [PLACE]                             a readout
 *              | MEASURE of ACCEL TREND with PARAM [PLACE]    TREND: falls, rises, never falls, never rises
 *     QUANTITY = MEASURE of ACCEL
 *              | ratio of MEASURE of ACCEL to ACCEL
 *              | exponent of MEASURE of ACCEL in PARAM
 *              | crossover of MEASURE of ACCEL and ACCEL in PARAM
 *              | correlation of MEASURE and MEASURE of ACCEL
 *     PLACE    = any of: on SCENE, for KIND rays, for all rays,
 *                at largest PARAM, at smallest PARAM, at PARAM=VALUE
 *     MEASURE  = time; object_tests, extent_tests, steps, csg_tests (each per ray); build_time, bytes,
 *                predicted_cost, break_even (rays); render_time (s), query_share (`render`)
 *
 * ACCEL and SCENE are labels, or the common part of the labels of a sweep. ACCEL may be `all`, every
 * accelerator of the list, in a crossover every one but the second; or the name of a baseline of several
 * settings ("embree:best"): the setting that is the fastest on each kind of rays. PARAM is a swept parameter:
 * n, or scene.n or accel.n if both have it; or, except in "at", `objects`, the number of objects of the
 * scene, however scenes are named. A claim covers every cell that it does not exclude, and holds if it holds
 * for all of them. Without "for" that is each kind of rays by itself that a scene has, and the verdict says
 * where kinds differ; "for all rays" is their sum: the mean cost of a ray, each kind weighted by the size of
 * its set. "at" excludes cells without the parameter. The second ACCEL of a ratio or a crossover is one
 * accelerator; in a crossover it may sweep PARAM, too. "falls" means from each value of the parameter to the
 * next larger one.
 */
#ifndef RT_EXPERIMENT_CLAIM_H
#define RT_EXPERIMENT_CLAIM_H

#include "experiment/experiment.h"

/* X(CONSTANT, name, unit of a figure); from BUILD_TIME on of structures, so not of a kind of rays. */
#define RT_CLAIM_MEASURES(X)                                                                                 \
    X(TIME, "time", " ns")                                                                                   \
    X(OBJECT_TESTS, "object_tests", "")                                                                      \
    X(EXTENT_TESTS, "extent_tests", "")                                                                      \
    X(STEPS, "steps", "")                                                                                    \
    X(CSG_TESTS, "csg_tests", "")                                                                            \
    X(BUILD_TIME, "build_time", " s")                                                                        \
    X(BYTES, "bytes", " bytes")                                                                              \
    X(PREDICTED_COST, "predicted_cost", "")                                                                  \
    X(BREAK_EVEN, "break_even", " rays")                                                                     \
    X(RENDER_TIME, "render_time", " s")                                                                      \
    X(QUERY_SHARE, "query_share", "")

typedef enum RtClaimMeasure {
#define RT_CLAIM_MEASURE(CONSTANT, name, unit) RT_CLAIM_##CONSTANT,
    RT_CLAIM_MEASURES(RT_CLAIM_MEASURE)
#undef RT_CLAIM_MEASURE
} RtClaimMeasure;

typedef enum RtClaimForm {
    RT_CLAIM_VALUE,
    RT_CLAIM_RATIO,
    RT_CLAIM_EXPONENT,
    RT_CLAIM_CROSSOVER,
    RT_CLAIM_CORRELATION,
    RT_CLAIM_TREND
} RtClaimForm;

#define RT_CLAIM_ALL "all" /* as ACCEL */

#define RT_MAX_CLAIM_PLACES 4

#define RT_CLAIM_RAYS 1000 /* fewer rays decide nothing */

/* A parsed claim. */
typedef struct RtClaim {
    RtClaimForm form;
    RtClaimMeasure measure, first;                 /* first: of a correlation's two; else the same */
    char accel[RT_MAX_LABEL], scene[RT_MAX_LABEL]; /* scene: "" for all */
    char other[RT_MAX_LABEL]; /* of a ratio, the denominator; of a crossover, the second; else "" */
    RtSweptKey key;           /* of an exponent, a crossover or a trend; key.key NULL: none */
    bool by_objects;          /* key is the number of objects of the scene */
    bool each_kind;           /* judged for each kind of rays by itself */
    RtRayKind kind;           /* else; or RT_ALL_RAYS */
    uint32_t place_count;
    struct {
        RtSweptKey key;
        char value[RT_MAX_SWEPT_CHARS];
    } places[RT_MAX_CLAIM_PLACES];
    bool rises, strictly;   /* of a trend */
    bool readout;           /* without OP and NUMBER */
    bool greater, or_equal; /* of all others */
    double number;
} RtClaim;

/* Parses `text`, or says what is wrong. The claim borrows from the experiment. */
RtStatus rt_claim_parse(const RtExperiment *experiment, const char *text, RtClaim *claim, RtError *error);

/* Whether the claim, or one of a correlation's measures, is of a kind of rays. */
bool rt_claim_is_of_rays(const RtClaim *claim);

/* Whether candidate `other` is the second accelerator of the claim for the cells of candidate `c` on workload
 * `t`: of several that sweep the claim's parameter, too, the one with the same value. */
bool rt_claim_is_other(const RtExperiment *experiment, const RtClaim *claim, uint32_t t, uint32_t c,
                       uint32_t other);

#endif
