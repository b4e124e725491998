/* SPDX-License-Identifier: Apache-2.0 */
/* A process in which code runs that raytally does not trust, and how it ended.
 *
 * raytally may be a library in a program that ignores SIGCHLD or waits for every child that it has. What is
 * known of a process is then lost, and its number may be another's. So it is held by a descriptor (pidfd,
 * Linux 5.4): that says when the process has ended, whoever waited for it, and is never another's. */
#ifndef RT_ACCEL_PLUGIN_PROCESS_H
#define RT_ACCEL_PLUGIN_PROCESS_H

#include "core/base/status.h"

#include <stdbool.h>
#include <stddef.h>
#include <sys/types.h>

/* All zero: none. */
typedef struct RtProcess {
    pid_t pid;      /* of the child; 0 in the child itself, and where there is none any more */
    int descriptor; /* -1 where the kernel has none: then it goes by its number */
} RtProcess;

/* What is known of an end. */
typedef struct RtProcessEnd {
    int signal; /* that ended it, or 0 */
    int code;   /* that it exited with; -1: somebody else waited for it */
} RtProcessEnd;

/* Forks: *process is the child, or, in the child, has pid 0. What the child starts in its turn does not
 * outlive it. The child has no file of raytally's open but stderr, which is its stdout, too, and the
 * descriptor `keep` (-1: none), which becomes RT_PROCESS_KEPT; it cannot send raytally signals. RT_IO where
 * there can be no process. */
enum { RT_PROCESS_KEPT = 3 };
RtStatus rt_process_start(RtProcess *process, int keep, RtError *error);

/* Sends it a signal, if it still is. */
void rt_process_signal(const RtProcess *process, int number);

/* Waits until it has ended, but no longer than so many milliseconds: false if it has not. After that there is
 * no process any more. */
bool rt_process_wait(RtProcess *process, int milliseconds, RtProcessEnd *end);

/* The same, and kills it where it has not ended by then. Nothing where there is none. */
void rt_process_end(RtProcess *process, int milliseconds);

/* What it was to out[0..room): "it crashed (Segmentation fault)". A signal that the process could still name
 * itself, or 0, goes before what is known of its end; `detail` stands behind the name of a signal. */
void rt_process_end_format(RtProcessEnd end, int said, const char *detail, char *out, size_t room);

#endif
