/* SPDX-License-Identifier: Apache-2.0 */
/* What the files of the library share: the types that raytally.h keeps to itself, and the way between its
 * plain types and ours, which are laid out alike and so are never copied. */
#ifndef RT_LIBRARY_LIBRARY_H
#define RT_LIBRARY_LIBRARY_H

#include "rays/rayset.h"

#include <locale.h>
#include <raytally/raytally.h>
#include <stdatomic.h>

struct raytally_scene {
    RtScene scene;
    atomic_uint accelerators; /* that stand over it */
};

struct raytally_accelerator {
    RtAccel *accel;
    raytally_scene *scene; /* borrowed, to be told when this one is gone */
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

/* From here to rt_locale_leave this thread reads and writes numbers by the rules of "C", whatever locale the
 * program that embeds us has chosen. (That locale is one that the system has: it is not to be freed.) All
 * that may write a message or read a number does so, and tracing too, for a plugin may break at it: 7 ns. */
static inline locale_t rt_locale_enter(void) {
    return uselocale(newlocale(LC_ALL_MASK, "C", (locale_t)0));
}

static inline void rt_locale_leave(locale_t before) {
    uselocale(before);
}

/* Takes what a caller says of options: `own` holds the defaults of the `size` bytes that are known here;
 * `given`, a struct of the name `what`, begins with its size, which an older or a newer header may have made
 * another one, or is NULL. RT_NOT_AVAILABLE where anything is set behind what is known, RT_BAD_INPUT where
 * the size is none. */
RtStatus rt_options_take(void *own, size_t size, const void *given, const char *what, RtError *error);

/* Refuses a number of threads outside 0..1024. */
RtStatus rt_threads_check(int threads, RtError *error);

/* sum += part */
void rt_counters_add(raytally_counters *sum, const RtTally *part);

#endif
