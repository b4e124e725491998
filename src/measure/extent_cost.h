/* SPDX-License-Identifier: Apache-2.0 */
/* What extents cost: the time of a test of each kind, and what the pair of tightness and time makes of a
 * line, T = b B + i I (Weghorst, Hooper & Greenberg 1984). Here the b extents of a population lie in a list
 * without a hierarchy: b is their number, B the time of an extent test, i the number of extents that a random
 * line through the scene meets, and I the time of an object test.
 *
 * B is measured as a list is gone through: a ray and its line prepared once, then a test per extent. I is
 * measured on rays that meet the object's box, for others are not asked about. */
#ifndef RT_MEASURE_EXTENT_COST_H
#define RT_MEASURE_EXTENT_COST_H

#include "measure/rounds.h"
#include "measure/statistics.h"
#include "measure/tightness.h"

typedef struct RtExtentCost {
    RtEstimate test;  /* B, seconds */
    RtEstimate line;  /* T, seconds */
    RtEstimate ratio; /* T over that of the first choice, paired round by round */
} RtExtentCost;

/* Times what rt_tightness_count has counted: tightness[i] and out[i] for each choices[i]. *object is I, all
 * NaN where no ray met a box. The population is not empty. */
RtStatus rt_extent_cost_time(const RtPopulation *population, const RtExtentChoice *choices, size_t count,
                             const RtTightness *tightness, const RtRounds *rounds, RtEstimate *object,
                             RtExtentCost *out, RtError *error);

#endif
