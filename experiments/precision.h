/* Precision: how far off our hit functions are. Rays of several cases are aimed at random objects of one
 * shape, and what rt_object_hit says is held against exact arithmetic (experiments/referee.h): the error of
 * t, and the decisions that differ. docs/precision.md has the table. */
#ifndef RT_EXPERIMENTS_PRECISION_H
#define RT_EXPERIMENTS_PRECISION_H

#include "base/status.h"
#include "shape/geometry.h"

size_t rt_precision_case_count(void);
/* "ordinary", ..., and what it is, in a few words. */
const char *rt_precision_case_name(size_t index);
const char *rt_precision_case_meaning(size_t index);

/* Of the rays that both hit, the errors of t in ulps of float32; of the others what differed, and where. */
typedef struct RtPrecision {
    uint64_t rays, hits;       /* hits: both say so, of the same place */
    double median, most99;     /* of |error|: half, and 99 of 100 hits, are no farther off */
    double most;               /* |error| */
    double off;                /* the farthest that org + t dir was from the surface, in units of border.h */
    uint64_t missed, invented; /* only exact arithmetic, or only the hit function, finds a hit */
    uint64_t elsewhere;        /* both do, at different places of the object */
    double border;             /* the farthest that any of these was from a border, in units of border.h */
} RtPrecision;

/* `rays` rays of a case, aimed at objects of `shape`: the same on any machine. Trees are of spheres, boxes
 * and frusta. */
RtStatus rt_precision_measure(RtShape shape, size_t index, uint64_t rays, RtPrecision *out, RtError *error);

#endif
