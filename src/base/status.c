/* SPDX-License-Identifier: Apache-2.0 */
#include "base/status.h"

#include <stdarg.h>
#include <stdio.h>

RtStatus rt_fail(RtError *error, RtStatus status, const char *format, ...) {
    if (error) {
        error->status = status;
        va_list args;
        va_start(args, format);
        vsnprintf(error->message, sizeof error->message, format, args);
        va_end(args);
    }
    return status;
}

RtStatus rt_fail_at(RtError *error, const char *file, size_t line, size_t column, const char *format, ...) {
    if (!error) return RT_BAD_INPUT;
    error->status = RT_BAD_INPUT;
    char *out = error->message;
    size_t room = sizeof error->message;
    int n = line == 0     ? snprintf(out, room, "%s: ", file)
            : column == 0 ? snprintf(out, room, "%s:%zu: ", file, line)
                          : snprintf(out, room, "%s:%zu:%zu: ", file, line, column);
    if (n < 0 || (size_t)n >= room) return RT_BAD_INPUT;
    va_list args;
    va_start(args, format);
    vsnprintf(out + n, room - (size_t)n, format, args);
    va_end(args);
    return RT_BAD_INPUT;
}

RtStatus rt_fail_memory(RtError *error, const char *what, size_t bytes) {
    if (bytes == 0) return rt_fail(error, RT_NO_MEMORY, "out of memory: there is too little for %s", what);
    return rt_fail(error, RT_NO_MEMORY, "out of memory: %zu bytes for %s could not be allocated", bytes,
                   what);
}
