/* SPDX-License-Identifier: Apache-2.0 */
/* Measures the precision of the hit functions: rays of several cases are aimed at random objects of one kind,
 * and rt_object_hit is compared with exact arithmetic (exact/referee.h): the error of t, and the decisions
 * that differ. docs/precision.md has the table. */
#ifndef RT_TESTS_EXACT_PRECISION_H
#define RT_TESTS_EXACT_PRECISION_H

#include "core/base/status.h"
#include "core/shape/geometry.h"

/* X(CONSTANT, name): the shapes in their order (core/shape/geometry.h), and trees of one kind of solid. */
#define RT_SUBJECTS(X)                                                                                       \
    X(SPHERE, sphere)                                                                                        \
    X(POLYGON, polygon)                                                                                      \
    X(TRIANGLE, triangle)                                                                                    \
    X(CONE, cone)                                                                                            \
    X(CSG, csg)                                                                                              \
    X(MESH, mesh)                                                                                            \
    X(TORUS, torus)

/* Trees are of spheres, boxes and frusta. Those of a mesh are an octahedron, turned, about half of them with
 * a dent, without a frustum; those of a torus are one without a frustum. */
typedef enum RtSubject {
#define RT_SUBJECT_ENUM(CONSTANT, name) RT_SUBJECT_##CONSTANT,
    RT_SUBJECTS(RT_SUBJECT_ENUM)
#undef RT_SUBJECT_ENUM
        RT_SUBJECT_COUNT
} RtSubject;

/* "sphere", ... */
const char *rt_subject_name(RtSubject subject);

size_t rt_precision_case_count(void);
/* "ordinary", ..., and what it is, in a few words. */
const char *rt_precision_case_name(size_t index);
const char *rt_precision_case_meaning(size_t index);

/* For rays that both hit, the errors of t in ulps of float32; for the others, what differed and where. */
typedef struct RtPrecision {
    uint64_t rays, hits;       /* hits: both say so, of the same place */
    double median, most99;     /* of |error|: half, and 99 of 100 hits, are no farther off */
    double most;               /* |error| */
    double off;                /* the farthest that org + t dir was from the surface, in units of border.h */
    double excess;             /* the most that |error| |dir| exceeds 0.501 ulp, in units of border.h */
    uint64_t missed, invented; /* only exact arithmetic, or only the hit function, finds a hit */
    uint64_t elsewhere;        /* both do, at different places of the object */
    double border;             /* the farthest that any of these was from a border, in units of border.h */
} RtPrecision;

/* `rays` rays of a case, aimed at such objects: the same on any machine. */
RtStatus rt_precision_measure(RtSubject subject, size_t index, uint64_t rays, RtPrecision *out,
                              RtError *error);

#endif
