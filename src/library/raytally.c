/* SPDX-License-Identifier: Apache-2.0 */
/* Versions, names, and that the plain types of the library are laid out as ours. */
#include "library/library.h"

#include <string.h>

#define SAME_PLACE(Public, Own, member)                                                                      \
    _Static_assert(offsetof(Public, member) == offsetof(Own, member) &&                                      \
                       sizeof((Public){0}.member) == sizeof((Own){0}.member),                                \
                   #Public " is laid out as " #Own)
SAME_PLACE(raytally_ray, RtRay, org);
SAME_PLACE(raytally_ray, RtRay, tmin);
SAME_PLACE(raytally_ray, RtRay, dir);
SAME_PLACE(raytally_ray, RtRay, tmax);
SAME_PLACE(raytally_ray, RtRay, kind);
SAME_PLACE(raytally_ray, RtRay, source);
SAME_PLACE(raytally_hit, RtHit, t);
SAME_PLACE(raytally_hit, RtHit, object);
SAME_PLACE(raytally_error, RtError, status);
SAME_PLACE(raytally_error, RtError, message);
_Static_assert(sizeof(raytally_ray) == sizeof(RtRay) && sizeof(raytally_hit) == sizeof(RtHit) &&
                   sizeof(raytally_error) == sizeof(RtError),
               "arrays of them are laid out alike");

#define SAME_KIND(CONSTANT, name, meaning)                                                                   \
    _Static_assert((int)RAYTALLY_##CONSTANT == (int)RT_RAY_##CONSTANT, #name);
RT_RAY_KINDS(SAME_KIND)
_Static_assert((int)RAYTALLY_RAY_KINDS == (int)RT_RAY_KIND_COUNT, "kinds of rays are the same");
_Static_assert((int)RAYTALLY_COUNTERS_KNOWN == (int)RT_TALLY_COUNTER_COUNT, "counters are the same");
_Static_assert((int)RAYTALLY_COUNTERS_KNOWN <= (int)RAYTALLY_COUNTERS, "there is room for them");
_Static_assert(RAYTALLY_NO_OBJECT == RT_NO_OBJECT, "a miss is the same");
_Static_assert(RAYTALLY_SPEC_CHARS == RT_MAX_SPEC_CHARS, "specs are as long");

#define SAME_STATUS(name) ((int)RAYTALLY_##name == (int)RT_##name)
_Static_assert(SAME_STATUS(OK) && SAME_STATUS(MISMATCH) && SAME_STATUS(BROKEN) && SAME_STATUS(BAD_INPUT) &&
                   SAME_STATUS(NOT_AVAILABLE) && SAME_STATUS(NO_MEMORY) && SAME_STATUS(IO),
               "a status is the same");

int raytally_abi_version(void) {
    return RAYTALLY_ABI_VERSION;
}

const char *raytally_version(void) {
    return RT_VERSION;
}

const char *raytally_counter_name(enum raytally_counter counter) {
    return (unsigned)counter < RT_TALLY_COUNTER_COUNT ? rt_tally_name((size_t)counter) : NULL;
}

const char *raytally_ray_kind_name(enum raytally_ray_kind kind) {
    return (unsigned)kind < RT_RAY_KIND_COUNT ? rt_ray_kind_name((RtRayKind)kind) : NULL;
}

void rt_options_take(void *own, size_t size, const void *given) {
    size_t given_size;
    if (!given) return;
    memcpy(&given_size, given, sizeof given_size);
    memcpy(own, given, given_size < size ? given_size : size);
}

RtStatus rt_threads_check(int threads, RtError *error) {
    if (threads >= 0 && threads <= 1024) return RT_OK;
    return rt_fail(error, RT_BAD_INPUT, "%d threads: expected 1..1024, or 0 for all processors", threads);
}

void rt_counters_add(raytally_counters *sum, const RtTally *part) {
    uint64_t at[RT_TALLY_COUNTER_COUNT];
    memcpy(at, part, sizeof at);
    for (size_t i = 0; i < RT_TALLY_COUNTER_COUNT; i++) sum->at[i] += at[i];
}
