/* SPDX-License-Identifier: Apache-2.0 */
/* What ends a command early: SIGINT, SIGTERM, SIGHUP, SIGABRT, and --time. Temporary files and child
 * processes go with it, so that nothing half-written is left and nothing runs on.
 *
 * And commands with several jobs, one after the other, each in a process of its own: a fork that returns from
 * main as the command for that job alone would. So each measures as it would alone, and a crash, or a lack of
 * memory, ends one of them and not the others. */
#ifndef RT_CLI_JOBS_H
#define RT_CLI_JOBS_H

#include "core/base/status.h"

#include <stdbool.h>
#include <stdint.h>
#include <stdio.h>

/* From now on these signals, unless they are ignored, and SIGALRM clean up before they end the process. Call
 * it first, and again in a fork, which then cleans up its own files and processes alone and continues
 * nothing. */
void rt_stop_init(void);

/* From now on one that stops this process says how to go on: by `command`; `folder` has what is finished, or
 * is NULL. Both are borrowed. */
void rt_stop_continue(const char *folder, const char *command);

/* --time: sends SIGALRM after so many seconds. */
void rt_stop_after(unsigned seconds);

typedef struct RtJob {
    const char *name; /* set before, for rt_jobs_print; borrowed */
    bool here;        /* in the fork, which does the job */
    int code;         /* its exit code, 2 after a signal */
    int signal;       /* that ended it, or 0 */
    double seconds;   /* wall time */
} RtJob;

/* Forks, and waits for the end of the fork. Call it before anything starts threads. SIGINT, SIGTERM
 * and SIGALRM, unless they are ignored, are passed on to the fork, and end this process after it: exit code
 * 128 + the number; 2 after SIGALRM. If the fork ended before it could say how to continue, or there is none,
 * as between two jobs, this process prints `command`, borrowed. RT_IO if there is no fork to wait for. */
RtStatus rt_job_run(RtJob *job, const char *command, RtError *error);

/* Prints how each of them ended, and how long it took. */
void rt_jobs_print(const RtJob *jobs, uint32_t count, FILE *out);

/* The worst of their exit codes as a status, with the number of those that failed. */
RtStatus rt_jobs_check(const RtJob *jobs, uint32_t count, RtError *error);

#endif
