/* SPDX-License-Identifier: Apache-2.0 */
/* A lock on a directory that one process at a time writes into. It is the kernel's lock on the directory
 * itself: it leaves no file behind and ends with its process, however that ends. */
#ifndef RT_BASE_LOCK_H
#define RT_BASE_LOCK_H

#include "core/base/status.h"

#include <stdbool.h>

/* RT_NO_LOCK holds nothing and may be released. */
typedef struct RtLock {
    int descriptor; /* of the directory, or -1 */
} RtLock;

#define RT_NO_LOCK ((RtLock){-1})

static inline bool rt_lock_is_held(const RtLock *lock) {
    return lock->descriptor >= 0;
}

/* Locks the directory at `path`, or fails if another process holds the lock for a second. Succeeds without a
 * lock if there is no such directory or its file system has no locks. */
RtStatus rt_lock_take(RtLock *lock, const char *path, RtError *error);

void rt_lock_release(RtLock *lock);

#endif
