/* SPDX-License-Identifier: Apache-2.0 */
#include "core/base/warnings.h"

#include "core/base/memory.h"

#include <inttypes.h>
#include <stdarg.h>
#include <stdatomic.h>
#include <stdio.h>
#include <string.h>

static atomic_bool refused;

void rt_warnings_refuse(void) {
    atomic_store(&refused, true);
}

RtStatus rt_warn_at(RtWarnings *warnings, const char *file, size_t line, RtError *error, const char *format,
                    ...) {
    char words[400];
    RtError placed;
    RtWarning made = {.kind = format, .times = 1};
    for (uint32_t i = warnings->first; i < warnings->count; i++) {
        if (warnings->list[i].kind != format) continue;
        warnings->list[i].times++;
        return RT_OK;
    }
    va_list arguments;
    va_start(arguments, format);
    vsnprintf(words, sizeof words, format, arguments);
    va_end(arguments);
    if (atomic_load(&refused)) return rt_fail_at(error, file, line, 0, "%s", words);
    rt_fail_at(&placed, file, line, 0, "%s", words);
    const size_t size = strlen(placed.message) + 1;
    made.message = rt_alloc_unset(size, 1);
    if (!made.message) return rt_fail_memory(error, "a warning", size);
    memcpy(made.message, placed.message, size);
    const RtStatus status =
        rt_append(&warnings->list, &warnings->count, &warnings->capacity, &made, sizeof made, error);
    if (status != RT_OK) rt_free(made.message);
    return status;
}

const char *rt_warning_text(const RtWarning *warning, char out[RT_WARNING_TEXT]) {
    if (warning->times == 1)
        snprintf(out, RT_WARNING_TEXT, "%s", warning->message);
    else
        snprintf(out, RT_WARNING_TEXT, "%s (and %" PRIu64 " more like it)", warning->message,
                 warning->times - 1);
    return out;
}

void rt_warnings_tell(const RtWarnings *warnings, void (*say)(void *context, const char *text),
                      void *context) {
    enum { MOST = 20 };
    char text[RT_WARNING_TEXT], line[RT_WARNING_TEXT + 16];
    for (uint32_t i = 0; i < warnings->count && i < MOST; i++) {
        snprintf(line, sizeof line, "warning: %s", rt_warning_text(&warnings->list[i], text));
        say(context, line);
    }
    if (warnings->count <= MOST) return;
    snprintf(line, sizeof line, "warning: and %" PRIu32 " more", warnings->count - MOST);
    say(context, line);
}

void rt_warnings_clear(RtWarnings *warnings) {
    for (uint32_t i = 0; i < warnings->count; i++) rt_free(warnings->list[i].message);
    rt_free(warnings->list);
    *warnings = (RtWarnings){0};
}
