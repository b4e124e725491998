/* SPDX-License-Identifier: Apache-2.0 */
/* Hardware counters, by perf_event_open(2): instructions, cycles, cache misses and branch misses of a piece
 * of work, in user mode, on the calling thread and all threads that it starts meanwhile. Machines may lack
 * some, virtual ones often all, and a kernel may forbid them: then there is a reason. If there are more
 * events than counters, they take turns, and counts are scaled to the whole time. */
#ifndef RT_MEASURE_HARDWARE_H
#define RT_MEASURE_HARDWARE_H

#include "core/base/status.h"

#include <stdint.h>

/* X(name, meaning) */
#define RT_HARDWARE_EVENTS(X)                                                                                \
    X(instructions, "instructions retired")                                                                  \
    X(cycles, "cycles of the processor")                                                                     \
    X(cache_misses, "accesses that missed the last cache")                                                   \
    X(branch_misses, "branches that were mispredicted")

#define RT_HARDWARE_ENUM(name, meaning) RT_HARDWARE_##name,
typedef enum RtHardwareName { RT_HARDWARE_EVENTS(RT_HARDWARE_ENUM) RT_HARDWARE_COUNT } RtHardwareName;
#undef RT_HARDWARE_ENUM

/* An event as the kernel knows it: type and config of perf_event_attr. */
typedef struct RtHardwareEvent {
    uint32_t type;
    uint64_t config;
} RtHardwareEvent;

/* The events of these names. Tests use others. */
extern const RtHardwareEvent rt_hardware_events[RT_HARDWARE_COUNT];

typedef struct RtHardware {
    int files[RT_HARDWARE_COUNT]; /* -1: not available */
} RtHardware;

typedef struct RtHardwareCounts {
    double of[RT_HARDWARE_COUNT]; /* scaled; NAN: unknown */
    double running;               /* the least part of the time, 0..1, in which a known event was counted */
} RtHardwareCounts;

/* Opens the available ones of `events`. RT_NOT_AVAILABLE, with the reason, if there are none. Close with
 * rt_hardware_close, also after a failure. */
RtStatus rt_hardware_open(RtHardware *hardware, const RtHardwareEvent events[RT_HARDWARE_COUNT],
                          RtError *error);
void rt_hardware_close(RtHardware *hardware);

/* Counting between start and stop. Threads that were started earlier are not counted. */
typedef struct RtHardwareStart {
    uint64_t read[RT_HARDWARE_COUNT][3]; /* value, nanoseconds enabled, nanoseconds running */
} RtHardwareStart;
RtHardwareStart rt_hardware_start(const RtHardware *hardware);
RtHardwareCounts rt_hardware_stop(const RtHardware *hardware, const RtHardwareStart *start);

/* Scales a value that was counted in `running` of `enabled` nanoseconds to all of them; NAN if `running` is
 * 0. */
double rt_hardware_scale(uint64_t value, uint64_t enabled, uint64_t running);

#endif
