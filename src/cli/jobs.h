/* SPDX-License-Identifier: Apache-2.0 */
/* A command with several jobs, one after the other, each in a process of its own: a fork that returns from
 * main as the command for that job alone would. So each measures as it would alone, and a crash, or a lack of
 * memory, ends one of them and not the others. */
#ifndef RT_CLI_JOBS_H
#define RT_CLI_JOBS_H

#include "core/base/status.h"

#include <stdbool.h>
#include <stdint.h>
#include <stdio.h>

typedef struct RtJob {
    const char *name; /* set before, for rt_jobs_print; borrowed */
    bool here;        /* in the fork, which does the job */
    int code;         /* its exit code, 2 after a signal */
    int signal;       /* that ended it, or 0 */
    double seconds;   /* wall time */
} RtJob;

/* Forks, and waits for the end of the fork. Call it before anything starts threads. The signals of
 * rt_stop_signals are passed on to the fork, and end this process after it, with rt_stop_code. If the fork
 * ended before it could say how to continue, or there is none, as between two jobs, this process prints
 * `go_on`, borrowed. RT_IO if there is no fork to wait for. */
RtStatus rt_job_run(RtJob *job, const char *go_on, RtError *error);

/* Prints how each of them ended, and how long it took. */
void rt_jobs_print(const RtJob *jobs, uint32_t count, FILE *out);

/* The worst of their exit codes as a status, with the number of those that failed. */
RtStatus rt_jobs_check(const RtJob *jobs, uint32_t count, RtError *error);

#endif
