/* SPDX-License-Identifier: Apache-2.0 */
#include "core/base/lock.h"

#include <errno.h>
#include <fcntl.h>
#include <string.h>
#include <sys/file.h>
#include <time.h>
#include <unistd.h>

/* The lock of a killed process outlives it for a moment, in a child that has not started its program yet. */
enum { MOST_TRIES = 100 };

RtStatus rt_lock_take(RtLock *lock, const char *path, RtError *error) {
    *lock = RT_NO_LOCK;
    int descriptor = open(path, O_RDONLY | O_DIRECTORY | O_CLOEXEC), failed = 0;
    if (descriptor < 0 && (errno == ENOENT || errno == ENOTDIR)) return RT_OK;
    if (descriptor < 0) return rt_fail(error, RT_IO, "%s: cannot be opened: %s", path, strerror(errno));
    for (int tries = 0; tries < MOST_TRIES; tries++) {
        failed = flock(descriptor, LOCK_EX | LOCK_NB) == 0 ? 0 : errno;
        if (failed != EWOULDBLOCK) break;
        nanosleep(&(struct timespec){.tv_nsec = 10000000}, NULL);
    }
    if (failed == 0) lock->descriptor = descriptor;
    if (failed != 0) close(descriptor);
    if (failed != EWOULDBLOCK) return RT_OK;
    return rt_fail(error, RT_BAD_INPUT,
                   "%s: another process is writing into this directory: wait until it has ended", path);
}

void rt_lock_release(RtLock *lock) {
    if (rt_lock_is_held(lock)) close(lock->descriptor);
    *lock = RT_NO_LOCK;
}
