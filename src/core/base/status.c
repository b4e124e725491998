/* SPDX-License-Identifier: Apache-2.0 */
#include "core/base/status.h"

#include <stdarg.h>
#include <stdbool.h>
#include <stdio.h>

/* Bytes of the UTF-8 character at `s`; 0 if it is invalid (overlong, a surrogate, above U+10FFFF). */
static size_t character(const unsigned char *s) {
    if (s[0] < 0x80) return 1;
    size_t bytes = s[0] >= 0xF5 ? 0 : s[0] >= 0xF0 ? 4 : s[0] >= 0xE0 ? 3 : s[0] >= 0xC2 ? 2 : 0;
    for (size_t i = 1; i < bytes; i++) {
        if ((s[i] & 0xC0) != 0x80) return 0;
    }
    bool overlong = (s[0] == 0xE0 && s[1] < 0xA0) || (s[0] == 0xF0 && s[1] < 0x90);
    bool none = (s[0] == 0xED && s[1] > 0x9F) || (s[0] == 0xF4 && s[1] > 0x8F);
    return overlong || none ? 0 : bytes;
}

/* Messages quote files and plugins and go to terminals and JSON: bytes that are not UTF-8 (in a name, or
 * where the end was cut off) and terminal control characters become question marks. */
static void clean(char *message) {
    for (unsigned char *s = (unsigned char *)message; *s;) {
        size_t bytes = character(s);
        bool command = (*s < ' ' && *s != '\n' && *s != '\t') || *s == 0x7F;
        if (bytes == 0 || command) *s = '?';
        s += bytes == 0 ? 1 : bytes;
    }
}

RtStatus rt_fail(RtError *error, RtStatus status, const char *format, ...) {
    if (error) {
        error->status = status;
        va_list args;
        va_start(args, format);
        vsnprintf(error->message, sizeof error->message, format, args);
        va_end(args);
        clean(error->message);
    }
    return status;
}

RtStatus rt_fail_at(RtError *error, const char *file, size_t line, size_t column, const char *format, ...) {
    if (!error) return RT_BAD_INPUT;
    error->status = RT_BAD_INPUT;
    char *out = error->message;
    size_t size = sizeof error->message;
    int n = line == 0     ? snprintf(out, size, "%s: ", file)
            : column == 0 ? snprintf(out, size, "%s:%zu: ", file, line)
                          : snprintf(out, size, "%s:%zu:%zu: ", file, line, column);
    if (n < 0 || (size_t)n >= size) return RT_BAD_INPUT;
    va_list args;
    va_start(args, format);
    vsnprintf(out + n, size - (size_t)n, format, args);
    va_end(args);
    clean(out);
    return RT_BAD_INPUT;
}

RtStatus rt_fail_memory(RtError *error, const char *what, size_t bytes) {
    if (bytes == 0) return rt_fail(error, RT_NO_MEMORY, "out of memory: not enough for %s", what);
    return rt_fail(error, RT_NO_MEMORY, "out of memory: %zu bytes for %s could not be allocated", bytes,
                   what);
}
