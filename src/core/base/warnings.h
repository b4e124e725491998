/* SPDX-License-Identifier: Apache-2.0 */
/* Warnings: what a reader left out of somebody else's file, or guessed, although the geometry that is meant
 * is known. There is one for each kind in a file, with the place of the first and the number of all. */
#ifndef RT_BASE_WARNINGS_H
#define RT_BASE_WARNINGS_H

#include "core/base/status.h"

#include <stdint.h>

typedef struct RtWarning {
    const char *kind; /* the literal it was formatted with */
    uint64_t times;
    char *message; /* "FILE:LINE: what is odd, and what was done", of the first */
} RtWarning;

/* Starts as {0}. */
typedef struct RtWarnings {
    RtWarning *list; /* [count] */
    uint32_t count, capacity;
    uint32_t first; /* of the file being read: who begins with a file sets it to `count` */
} RtWarnings;

/* Adds a warning at a line of a file (0: the whole file). The literal `format` is its kind: after the first
 * of a file, others only count. Fails if memory is short (or rt_warnings_refuse was called). */
RtStatus rt_warn_at(RtWarnings *warnings, const char *file, size_t line, RtError *error, const char *format,
                    ...) __attribute__((format(printf, 5, 6)));

/* From now on a warning is an error, RT_BAD_INPUT: for programs, not for the library. */
void rt_warnings_refuse(void);

/* The message of a warning, and how many more there are like it. Returns `out`. */
enum { RT_WARNING_TEXT = 1100 };
const char *rt_warning_text(const RtWarning *warning, char out[RT_WARNING_TEXT]);

/* Says "warning: ..." of the first 20, and how many more there are. */
void rt_warnings_tell(const RtWarnings *warnings, void (*say)(void *context, const char *text),
                      void *context);

void rt_warnings_clear(RtWarnings *warnings);

#endif
