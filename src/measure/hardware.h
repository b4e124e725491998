/* SPDX-License-Identifier: Apache-2.0 */
/* Counters of the processor, by perf_event_open(2): what a piece of work took in instructions, cycles, cache
 * misses and branch misses, in the program itself, not in the kernel, on the calling thread and on all that
 * it starts meanwhile. Few machines have more than some; virtual ones often have none, and a kernel may
 * forbid them: then there is a reason. More events than the processor has counters for take turns, and what
 * is read is scaled to the whole of the time. */
#ifndef RT_MEASURE_HARDWARE_H
#define RT_MEASURE_HARDWARE_H

#include "core/base/status.h"

#include <stddef.h>
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

/* Those of the names above. Tests count others in their place. */
extern const RtHardwareEvent rt_hardware_events[RT_HARDWARE_COUNT];

const char *rt_hardware_name(size_t i);

typedef struct RtHardware {
    int files[RT_HARDWARE_COUNT]; /* -1: this one cannot be had */
} RtHardware;

/* What was counted between start and stop. */
typedef struct RtHardwareCounts {
    double of[RT_HARDWARE_COUNT]; /* scaled; NAN: not known */
    double running; /* the least part of the time, 0..1, that any event that is known was counted */
} RtHardwareCounts;

/* Opens what can be had of `events`. RT_NOT_AVAILABLE, with the reason, where that is nothing. Close with
 * rt_hardware_close, also after a failure. */
RtStatus rt_hardware_open(RtHardware *hardware, const RtHardwareEvent events[RT_HARDWARE_COUNT],
                          RtError *error);
void rt_hardware_close(RtHardware *hardware);

/* What is started is stopped. Threads that were started before are not counted. */
typedef struct RtHardwareStart {
    uint64_t read[RT_HARDWARE_COUNT][3]; /* value, nanoseconds enabled, of them running */
} RtHardwareStart;
RtHardwareStart rt_hardware_start(const RtHardware *hardware);
RtHardwareCounts rt_hardware_stop(const RtHardware *hardware, const RtHardwareStart *start);

/* A value that was counted in `running` of `enabled` nanoseconds, for all of them; NAN where that is in none.
 */
double rt_hardware_scale(uint64_t value, uint64_t enabled, uint64_t running);

#endif
