/* SPDX-License-Identifier: Apache-2.0 */
/* Versions, names, and checks that the plain types of the interface have the layout of raytally's own. */
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

/* Each counter has the offset of the tally's member of its name: rt_counters_add copies them. */
#define SAME_COUNTER(CONSTANT, name)                                                                         \
    _Static_assert(RAYTALLY_##CONSTANT * sizeof(uint64_t) == offsetof(RtTally, name), #name);
SAME_COUNTER(RAYS, rays)
SAME_COUNTER(HITS, hits)
SAME_COUNTER(OBJECT_TESTS, object_tests)
SAME_COUNTER(OBJECT_HITS, object_hits)
SAME_COUNTER(EXTENT_TESTS, extent_tests)
SAME_COUNTER(STEPS, steps)
SAME_COUNTER(LEAF_STEPS, leaf_steps)
SAME_COUNTER(EMPTY_STEPS, empty_steps)
SAME_COUNTER(CSG_TESTS, csg_tests)
SAME_COUNTER(REPEATS_AVOIDED, repeats_avoided)
SAME_COUNTER(PASSED_ON, passed_on)
_Static_assert((int)RAYTALLY_COUNTERS_KNOWN == (int)RT_TALLY_COUNTER_COUNT, "none is left out");

/* The room in structs of results is part of the binary interface. */
_Static_assert(RAYTALLY_MAX_RAY_KINDS == 16 && RAYTALLY_COUNTERS == 32 && RAYTALLY_FIGURES == 32 &&
                   sizeof(raytally_verified) == 128 && sizeof(raytally_estimate) == 64 &&
                   sizeof(raytally_time) == 192,
               "the size of results does not change");
_Static_assert((int)RAYTALLY_RAY_KINDS <= (int)RAYTALLY_MAX_RAY_KINDS &&
                   (int)RAYTALLY_COUNTERS_KNOWN <= (int)RAYTALLY_COUNTERS &&
                   (int)RAYTALLY_FIGURES_KNOWN <= (int)RAYTALLY_FIGURES,
               "and is large enough");

/* A member that a later header adds to options must lie beyond their size here, not in padding, which an
 * older program leaves unset. */
#define ENDS_WITH(Options, member)                                                                           \
    _Static_assert(sizeof(Options) == offsetof(Options, member) + sizeof((Options){0}.member),               \
                   #Options " has no padding at its end")
ENDS_WITH(raytally_objects, reserved);
ENDS_WITH(raytally_recording, limit);
/* NOLINTNEXTLINE(bugprone-sizeof-expression): the size of a pointer is meant */
ENDS_WITH(raytally_verifying, given);
ENDS_WITH(raytally_timing, seed);

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

/* More than the options of any version: a larger size was never set. */
enum { MOST_OPTION_BYTES = 4096 };

RtStatus rt_options_take(void *own, size_t size, const void *given, const char *what, RtError *error) {
    size_t given_size;
    if (!given) return RT_OK;
    memcpy(&given_size, given, sizeof given_size);
    if (given_size < sizeof given_size || given_size > MOST_OPTION_BYTES) {
        return rt_fail(error, RT_BAD_INPUT, "%s: its size cannot be %zu bytes: initialise it first", what,
                       given_size);
    }
    for (size_t i = size; i < given_size; i++) {
        if (((const unsigned char *)given)[i] == 0) continue;
        return rt_fail(error, RT_NOT_AVAILABLE,
                       "%s: byte %zu is set, but raytally " RT_VERSION " knows only %zu bytes", what, i,
                       size);
    }
    memcpy(own, given, given_size < size ? given_size : size);
    return RT_OK;
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
