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
    for (uint32_t i = warnings->count; i > 0; i--) {
        RtWarning *known = &warnings->list[i - 1];
        if (known->kind != format || strncmp(known->message, file, strlen(file)) != 0) continue;
        known->times++;
        return RT_OK;
    }
    va_list arguments;
    va_start(arguments, format);
    vsnprintf(words, sizeof words, format, arguments);
    va_end(arguments);
    if (atomic_load(&refused)) return rt_fail_at(error, file, line, 0, "%s", words);
    rt_fail_at(&placed, file, line, 0, "%s", words);
    snprintf(made.message, sizeof made.message, "%.*s", (int)sizeof made.message - 1, placed.message);
    return rt_append(&warnings->list, &warnings->count, &warnings->capacity, &made, sizeof made, error);
}

RtStatus rt_warnings_append(RtWarnings *to, const RtWarnings *from, RtError *error) {
    for (uint32_t i = 0; i < from->count; i++)
        RT_TRY(rt_append(&to->list, &to->count, &to->capacity, &from->list[i], sizeof *from->list, error));
    return RT_OK;
}

const char *rt_warning_text(const RtWarning *warning, char out[RT_WARNING_TEXT]) {
    if (warning->times == 1)
        snprintf(out, RT_WARNING_TEXT, "%s", warning->message);
    else
        snprintf(out, RT_WARNING_TEXT, "%s (and %" PRIu64 " more like it)", warning->message,
                 warning->times - 1);
    return out;
}

void rt_warnings_clear(RtWarnings *warnings) {
    rt_free(warnings->list);
    *warnings = (RtWarnings){0};
}
