/* SPDX-License-Identifier: Apache-2.0 */
/* Waiting for a word in memory that processes share to change. Unlike a semaphore, a word that somebody else
 * overwrites is only a number nobody waits for: the C library aborts on a semaphore that it cannot read. */
#ifndef RT_ACCEL_PLUGIN_FUTEX_H
#define RT_ACCEL_PLUGIN_FUTEX_H

#include <errno.h>
#include <limits.h>
#include <linux/futex.h>
#include <stdatomic.h>
#include <stdbool.h>
#include <stddef.h>
#include <sys/syscall.h>
#include <time.h>
#include <unistd.h>

/* Sleeps while *word is `value`, for `most` at most (NULL: without end). Whether the word may be another now:
 * false when the time is over, or a signal came. */
static inline bool rt_futex_wait(atomic_uint *word, unsigned value, const struct timespec *most) {
    return syscall(SYS_futex, word, FUTEX_WAIT, value, most, NULL, 0) == 0 || errno == EAGAIN;
}

/* Sets *word and wakes those that wait for it. What was written before is seen by whoever sees the value. */
static inline void rt_futex_set(atomic_uint *word, unsigned value) {
    atomic_store_explicit(word, value, memory_order_release);
    syscall(SYS_futex, word, FUTEX_WAKE, INT_MAX, NULL, NULL, 0);
}

#endif
