/* SPDX-License-Identifier: Apache-2.0 */
#include "results/events.h"

#include <stdarg.h>
#include <stdio.h>

bool rt_event_is_broken(const RtResults *results, const RtEvent *event) {
    if (event->what == RT_EVENT_NO_BUILD)
        return rt_build_at(results, event->workload, event->candidate)->broken;
    return event->what == RT_EVENT_NO_CELL &&
           rt_cell_at(results, event->workload, event->candidate, event->kind)->broken;
}

void rt_notify(const RtRunObserver *observer, const char *format, ...) {
    char message[RT_MAX_PATH + 1024];
    va_list args;
    if (!observer->notice) return;
    va_start(args, format);
    /* clang-tidy 14 does not see va_start. NOLINTNEXTLINE(clang-analyzer-valist.Uninitialized) */
    vsnprintf(message, sizeof message, format, args);
    va_end(args);
    observer->notice(observer->context, message);
}
