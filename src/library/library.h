/* SPDX-License-Identifier: Apache-2.0 */
/* What the files of the library share: the types that raytally.h leaves opaque. Its plain types have the
 * layout of raytally's own, so pointers to them are cast and nothing is copied. */
#ifndef RT_LIBRARY_LIBRARY_H
#define RT_LIBRARY_LIBRARY_H

#include "rays/rayset.h"

#include <locale.h>
#include <raytally/raytally.h>
#include <stdatomic.h>

struct raytally_scene {
    RtScene scene;
    atomic_uint accelerators; /* built over it */
};

struct raytally_accelerator {
    RtAccel *accel;
    raytally_scene *scene; /* borrowed; it counts its accelerators */
    char spec[RT_MAX_SPEC_CHARS];
};

struct raytally_tracer {
    RtQuery query;
};

struct raytally_rays {
    RtRaySet set;
};

static inline RtError *rt_error_of(raytally_error *error) {
    return (RtError *)error;
}

/* Until the end of the block this thread reads and writes numbers by the rules of the locale "C", whatever
 * locale the program has chosen. (The system owns that locale: it is not freed.) Every function that may read
 * a number or write a message needs it; tracing too (7 ns), because a plugin may break there. */
#define RT_C_LOCALE                                                                                          \
    __attribute__((cleanup(rt_locale_leave), unused)) locale_t locale_before =                               \
        uselocale(newlocale(LC_ALL_MASK, "C", (locale_t)0))

static inline void rt_locale_leave(const locale_t *before) {
    uselocale(*before);
}

/* Reads options: `own` holds the defaults of the `size` bytes known here; `given`, a struct of the name
 * `what`, begins with its size, which differs with the version of the header, or is NULL. RT_NOT_AVAILABLE if
 * it sets anything beyond the known bytes, RT_BAD_INPUT if the size is impossible. */
RtStatus rt_options_take(void *own, size_t size, const void *given, const char *what, RtError *error);

/* Refuses a number of threads outside 0..1024. */
RtStatus rt_threads_check(int threads, RtError *error);

/* sum += part */
void rt_counters_add(raytally_counters *sum, const RtTally *part);

#endif
