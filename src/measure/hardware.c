/* SPDX-License-Identifier: Apache-2.0 */
#include "measure/hardware.h"

#include <errno.h>
#include <linux/perf_event.h>
#include <math.h>
#include <stdio.h>
#include <string.h>
#include <sys/ioctl.h>
#include <sys/syscall.h>
#include <unistd.h>

const RtHardwareEvent rt_hardware_events[RT_HARDWARE_COUNT] = {
    [RT_HARDWARE_instructions] = {PERF_TYPE_HARDWARE, PERF_COUNT_HW_INSTRUCTIONS},
    [RT_HARDWARE_cycles] = {PERF_TYPE_HARDWARE, PERF_COUNT_HW_CPU_CYCLES},
    [RT_HARDWARE_cache_misses] = {PERF_TYPE_HARDWARE, PERF_COUNT_HW_CACHE_MISSES},
    [RT_HARDWARE_branch_misses] = {PERF_TYPE_HARDWARE, PERF_COUNT_HW_BRANCH_MISSES},
};

/* ---- opening ---- */

static int open_event(const RtHardwareEvent *event) {
    struct perf_event_attr attr = {.type = event->type,
                                   .size = sizeof attr,
                                   .config = event->config,
                                   .read_format =
                                       PERF_FORMAT_TOTAL_TIME_ENABLED | PERF_FORMAT_TOTAL_TIME_RUNNING,
                                   .disabled = 1,
                                   .inherit = 1, /* by threads started from now on */
                                   .exclude_kernel = 1,
                                   .exclude_hv = 1};
    return (int)syscall(SYS_perf_event_open, &attr, 0, -1, -1, PERF_FLAG_FD_CLOEXEC);
}

static RtStatus explain(int problem, RtError *error) {
    int paranoid = 0;
    FILE *file = fopen("/proc/sys/kernel/perf_event_paranoid", "r");
    if (file && fscanf(file, "%d", &paranoid) != 1) paranoid = 0;
    if (file) fclose(file);
    switch (problem) {
    case ENOENT:
    case EOPNOTSUPP:
    case ENODEV:
        return rt_fail(error, RT_NOT_AVAILABLE, "this machine has none; virtual machines often have none");
    case EACCES:
    case EPERM:
        return rt_fail(
            error, RT_NOT_AVAILABLE,
            "the kernel does not allow them: kernel.perf_event_paranoid is %d, and must be at most "
            "2 (sysctl); a container may forbid them, too",
            paranoid);
    case ENOSYS: return rt_fail(error, RT_NOT_AVAILABLE, "this kernel has no perf_event_open");
    default: return rt_fail(error, RT_NOT_AVAILABLE, "perf_event_open fails: %s", strerror(problem));
    }
}

RtStatus rt_hardware_open(RtHardware *hardware, const RtHardwareEvent events[RT_HARDWARE_COUNT],
                          RtError *error) {
    int opened = 0, problem = 0;
    for (int i = 0; i < RT_HARDWARE_COUNT; i++) {
        hardware->files[i] = open_event(&events[i]);
        if (hardware->files[i] < 0 && !problem) problem = errno;
        opened += hardware->files[i] >= 0;
    }
    return opened ? RT_OK : explain(problem, error);
}

void rt_hardware_close(RtHardware *hardware) {
    for (int i = 0; i < RT_HARDWARE_COUNT; i++) {
        if (hardware->files[i] >= 0) close(hardware->files[i]);
        hardware->files[i] = -1;
    }
}

/* ---- counting ---- */

/* Counts of threads that have ended are never reset, so differences are taken. */
static RtHardwareStart read_all(const RtHardware *hardware) {
    RtHardwareStart now = {0};
    for (int i = 0; i < RT_HARDWARE_COUNT; i++) {
        if (hardware->files[i] < 0) continue;
        if (read(hardware->files[i], now.read[i], sizeof now.read[i]) != (ssize_t)sizeof now.read[i])
            memset(now.read[i], 0, sizeof now.read[i]);
    }
    return now;
}

static void control_all(const RtHardware *hardware, unsigned long request) {
    for (int i = 0; i < RT_HARDWARE_COUNT; i++) {
        if (hardware->files[i] >= 0) ioctl(hardware->files[i], request, 0);
    }
}

RtHardwareStart rt_hardware_start(const RtHardware *hardware) {
    RtHardwareStart start = read_all(hardware);
    control_all(hardware, PERF_EVENT_IOC_ENABLE);
    return start;
}

double rt_hardware_scale(uint64_t value, uint64_t enabled, uint64_t running) {
    return running ? (double)value * ((double)enabled / (double)running) : (double)NAN;
}

RtHardwareCounts rt_hardware_stop(const RtHardware *hardware, const RtHardwareStart *start) {
    control_all(hardware, PERF_EVENT_IOC_DISABLE);
    const RtHardwareStart end = read_all(hardware);
    RtHardwareCounts counts = {.running = 1};
    for (int i = 0; i < RT_HARDWARE_COUNT; i++) {
        uint64_t part[3];
        for (int k = 0; k < 3; k++) part[k] = end.read[i][k] - start->read[i][k];
        counts.of[i] = hardware->files[i] < 0 ? (double)NAN : rt_hardware_scale(part[0], part[1], part[2]);
        if (!isnan(counts.of[i])) counts.running = fmin(counts.running, (double)part[2] / (double)part[1]);
    }
    return counts;
}
