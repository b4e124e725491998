/* SPDX-License-Identifier: Apache-2.0 */
#include "core/base/lock.h"

#include <errno.h>
#include <fcntl.h>
#include <signal.h>
#include <stdio.h>
#include <string.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <sys/sysmacros.h>
#include <time.h>
#include <unistd.h>

/* The process that holds the lock, from /proc/locks; 0 if unknown. */
static int find_holder(int descriptor) {
    char line[256];
    struct stat info;
    int holder = 0;
    FILE *locks = fopen("/proc/locks", "r");
    if (!locks) return 0;
    while (fstat(descriptor, &info) == 0 && holder == 0 && fgets(line, sizeof line, locks)) {
        unsigned major_number, minor_number;
        unsigned long long inode;
        int process;
        if (sscanf(line, "%*d: FLOCK %*s %*s %d %x:%x:%llu", &process, &major_number, &minor_number,
                   &inode) == 4 &&
            inode == info.st_ino && major_number == major(info.st_dev) &&
            minor_number == minor(info.st_dev)) {
            holder = process;
        }
    }
    fclose(locks);
    return holder;
}

static RtStatus fail_held(const char *path, int holder, RtError *error) {
    char who[48] = "another process";
    if (holder > 0) snprintf(who, sizeof who, "process %d", holder);
    return rt_fail(error, RT_BAD_INPUT, "%s: %s is writing into this directory: wait until it has ended",
                   path, who);
}

/* The lock of a killed process outlives it for a moment, in a child that has not started its program yet. */
enum { MOST_TRIES = 100 };

static bool is_alive(int process) {
    return process > 0 && (kill(process, 0) == 0 || errno != ESRCH);
}

RtStatus rt_lock_take(RtLock *lock, const char *path, RtError *error) {
    *lock = RT_NO_LOCK;
    int descriptor = open(path, O_RDONLY | O_DIRECTORY | O_CLOEXEC);
    if (descriptor < 0 && (errno == ENOENT || errno == ENOTDIR)) return RT_OK;
    if (descriptor < 0) return rt_fail(error, RT_IO, "%s: cannot be opened: %s", path, strerror(errno));
    RtStatus status = RT_OK;
    for (int tries = 0; flock(descriptor, LOCK_EX | LOCK_NB) != 0; tries++) {
        const bool held = errno == EWOULDBLOCK;
        const int holder = held ? find_holder(descriptor) : 0;
        if (held && tries < MOST_TRIES && !is_alive(holder)) {
            nanosleep(&(struct timespec){.tv_nsec = 10000000}, NULL);
            continue;
        }
        if (held) status = fail_held(path, holder, error);
        close(descriptor);
        return status;
    }
    lock->descriptor = descriptor;
    return RT_OK;
}

void rt_lock_release(RtLock *lock) {
    if (rt_lock_is_held(lock)) close(lock->descriptor);
    *lock = RT_NO_LOCK;
}
