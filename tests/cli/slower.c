/* SPDX-License-Identifier: Apache-2.0 */
/* Makes of raytally a program that is 2 % slower and else the same (tests/check_compare.sh): of each stream
 * that is timed the last fiftieth of the rays is asked beforehand, too: by its turn the processor has
 * forgotten how its branches went. The linker puts these functions in the place of the real ones. */
#include "accel/accel.h"

enum { PART = 50 };

void __real_rt_nearest(RtQuery *query, const RtRay *rays, size_t count, RtHit *hits, RtTally *tallies);
void __wrap_rt_nearest(RtQuery *query, const RtRay *rays, size_t count, RtHit *hits, RtTally *tallies);
void __real_rt_occluded(RtQuery *query, const RtRay *rays, size_t count, bool *blocked, RtTally *tallies);
void __wrap_rt_occluded(RtQuery *query, const RtRay *rays, size_t count, bool *blocked, RtTally *tallies);

void __wrap_rt_nearest(RtQuery *query, const RtRay *rays, size_t count, RtHit *hits, RtTally *tallies) {
    if (!tallies) __real_rt_nearest(query, rays + count - count / PART, count / PART, hits, NULL);
    __real_rt_nearest(query, rays, count, hits, tallies);
}

void __wrap_rt_occluded(RtQuery *query, const RtRay *rays, size_t count, bool *blocked, RtTally *tallies) {
    if (!tallies) __real_rt_occluded(query, rays + count - count / PART, count / PART, blocked, NULL);
    __real_rt_occluded(query, rays, count, blocked, tallies);
}
