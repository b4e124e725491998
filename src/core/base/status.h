/* SPDX-License-Identifier: Apache-2.0 */
/* Errors: a status to branch on and a message to read. Nothing below the command line prints or exits; a
 * function that can fail returns RtStatus and fills the caller's RtError. */
#ifndef RT_BASE_STATUS_H
#define RT_BASE_STATUS_H

#include <stddef.h>

typedef enum RtStatus {
    RT_OK = 0,
    RT_MISMATCH,      /* a check failed: answers or counts differ (exit code 1) */
    RT_BROKEN,        /* a plugin's accelerator crashed, hung or broke the protocol (exit code 1) */
    RT_BAD_INPUT,     /* a file, a spec or an argument is wrong (exit code 2) */
    RT_NOT_AVAILABLE, /* this build or machine does not have it (exit code 2) */
    RT_NO_MEMORY,     /* an allocation failed (exit code 2) */
    RT_IO             /* reading or writing failed (exit code 2) */
} RtStatus;

/* `message` is a complete sentence or two: where the problem is, what is wrong, and what would be right. */
typedef struct RtError {
    RtStatus status;
    char message[1024];
} RtError;

/* Records `status` with a printf-style message and returns `status`. `error` may be NULL. */
RtStatus rt_fail(RtError *error, RtStatus status, const char *format, ...)
    __attribute__((format(printf, 3, 4)));

/* The same with a position in a file: "FILE:LINE:COLUMN: message"; a line or column of 0 is left out. */
RtStatus rt_fail_at(RtError *error, const char *file, size_t line, size_t column, const char *format, ...)
    __attribute__((format(printf, 5, 6)));

/* Records that `bytes` (0: unknown) could not be allocated for `what`, and returns RT_NO_MEMORY. */
RtStatus rt_fail_memory(RtError *error, const char *what, size_t bytes);

/* Returns from the calling function with the status of `expr` unless it is RT_OK. */
#define RT_TRY(expr)                                                                                         \
    do {                                                                                                     \
        RtStatus rt_try_status = (expr);                                                                     \
        if (rt_try_status != RT_OK) return rt_try_status;                                                    \
    } while (0)

/* For clang's analyzer, which sees one file at a time: these never return RT_OK. */
#ifdef __clang_analyzer__
#define rt_fail(error, status, ...)        (rt_fail(error, status, __VA_ARGS__), status)
#define rt_fail_at(error, file, ...)       (rt_fail_at(error, file, __VA_ARGS__), RT_BAD_INPUT)
#define rt_fail_memory(error, what, bytes) (rt_fail_memory(error, what, bytes), RT_NO_MEMORY)
#endif

#endif
