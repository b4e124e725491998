/* SPDX-License-Identifier: Apache-2.0 */
/* A remote accelerator (accel/plugin.h) whose process is forged: its answers are bytes of a test, which stand
 * for a plugin that overwrites the memory that it shares with raytally. The executable is linked with
 * --wrap for the five functions below; they are the real ones while nothing is forged. */
#ifndef RT_TESTS_FORGED_TESTING_H
#define RT_TESTS_FORGED_TESTING_H

#include "accel/plugin.h"
#include "accel/plugin/channel.h"
#include "core/base/process.h"

#include <string.h>
#include <unistd.h>

/* Each answer is a ForgedAnswer and then the `length` bytes that replace those of the channel from `offset`
 * on, which counts from its `status`: what raytally asked, or an earlier answer. After the last answer, and
 * after a cut one, the process has ended. */
#define FORGED_MESSAGE (offsetof(Channel, message) - offsetof(Channel, status))
typedef struct ForgedAnswer {
    uint16_t offset, length;
} ForgedAnswer;

static struct Forged {
    bool on;
    const uint8_t *bytes;
    size_t left;
} forged;

static inline bool take_forged(void *to, size_t size) {
    if (forged.left < size) return false;
    memcpy(to, forged.bytes, size);
    forged.bytes += size;
    forged.left -= size;
    return true;
}

/* The accelerator, built by the first answer. `scene` must outlive it. */
static inline RtStatus open_forged(const RtScene *scene, const void *bytes, size_t size, RtAccel **out,
                                   RtError *error) {
    static const RtAccelOps ops = {.name = "forged", .summary = "", .paper = "", .remote = true};
    const RtSpec spec = {.layer_count = 1, .layers = {{.ops = &ops}}};
    forged = (struct Forged){true, bytes, size};
    const RtStatus status = rt_remote_build(&spec, scene, 1, out, error);
    if (status != RT_OK) forged = (struct Forged){0};
    return status;
}

static inline void close_forged(RtAccel *accel) {
    rt_accel_destroy(accel);
    forged = (struct Forged){0};
}

__typeof__(rt_process_fork) __real_rt_process_fork, __wrap_rt_process_fork;
__typeof__(rt_process_signal) __real_rt_process_signal, __wrap_rt_process_signal;
__typeof__(rt_process_wait) __real_rt_process_wait, __wrap_rt_process_wait;
__typeof__(rt_futex_wait) __real_rt_futex_wait, __wrap_rt_futex_wait;
__typeof__(rt_futex_set) __real_rt_futex_set, __wrap_rt_futex_set;

/* This process stands for the other one, since its use of memory will be looked up. */
RtStatus __wrap_rt_process_fork(RtProcess *process, int keep, RtError *error) {
    if (!forged.on) return __real_rt_process_fork(process, keep, error);
    *process = (RtProcess){.pid = getpid(), .descriptor = -1};
    return RT_OK;
}

void __wrap_rt_process_signal(const RtProcess *process, int number) {
    if (!forged.on) __real_rt_process_signal(process, number);
}

bool __wrap_rt_process_wait(RtProcess *process, int milliseconds, RtProcessEnd *end) {
    if (!forged.on) return __real_rt_process_wait(process, milliseconds, end);
    *process = (RtProcess){0};
    *end = (RtProcessEnd){0};
    return true;
}

void __wrap_rt_futex_wait(atomic_uint *word, unsigned value, int milliseconds) {
    if (!forged.on) __real_rt_futex_wait(word, value, milliseconds);
}

/* Answers the request that this is. */
void __wrap_rt_futex_set(atomic_uint *word, unsigned value) {
    Channel *channel = (Channel *)word;
    ForgedAnswer answer;
    if (!forged.on)
        __real_rt_futex_set(word, value);
    else
        channel->asked = value;
    if (forged.on && take_forged(&answer, sizeof answer) &&
        take_forged((char *)&channel->status + answer.offset, answer.length))
        channel->answered = value;
}

#endif
