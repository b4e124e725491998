/* SPDX-License-Identifier: Apache-2.0 */
/* Workers: a raytally that another one starts. `compare --with` times two of them in turns
 * (compare_programs.c); `bench --callgrind` counts the instructions of one that runs under valgrind
 * (callgrind.c). A worker gets the arguments of the command, so it has the same experiment.
 *
 * Requests are lines of text, answers are lines of JSON. The end of its input ends a worker.
 *
 * `compare --worker` prepares everything that is not timed. It introduces itself: {"worker": 1, "build":
 * ...}. For each workload and kind of rays, in the order of the experiment, it lists its cells: {"scene",
 * "kind", "rays", "hash", "cells": [{"accel", "spec", "counts", "exact"}]}. Then "time C N" runs cell number
 * C of them N times; the answer is the seconds per ray. "pin P" keeps it on processor number P of those it
 * may use, until "next", which goes on to the next kind of rays. The last line is {"done": true}. Older
 * programs speak this protocol, too: it changes only with the number of "worker".
 *
 * `bench --worker` builds only the accelerators that requests name. "count T KIND ACCEL FILE" traces the rays
 * in FILE, a few times in rt_callgrind_pass, with the accelerator of that label on workload number T. FILE
 * holds the rays and then their hits, as in memory. The answer is {"passes", "spec", "rays"}, or {"passes",
 * "why"} if it failed; {} if this process has no such accelerator. Accelerators of plugins are built in the
 * worker's own process, which ends if one crashes. */
#ifndef RT_RUN_WORKER_H
#define RT_RUN_WORKER_H

#include "core/base/process.h"
#include "run/workload.h"

/* ---- the program that starts it ---- */

typedef struct RtWorker {
    const char *program; /* path of the program; NULL: it is searched for in $PATH */
    const char *log;     /* the file of its messages; NULL: stderr */
    const char *failure; /* with a log, what it means if the worker ends: the message of RT_NOT_AVAILABLE */
    RtProcess process;
    RtProcessEnd end; /* after a failure how it ended, if it has */
    FILE *to, *from;
} RtWorker;

/* Runs `command` (NULL behind the last word) followed by `arguments`. */
RtStatus rt_worker_start(RtWorker *worker, const char *const *command, char *const *arguments,
                         RtError *error);

/* Takes the next line, a new reference. If there is none, the failure says how the worker ended. */
RtStatus rt_worker_take(RtWorker *worker, json_t **line, RtError *error);

/* Sends a request, as of printf; then takes the answer, unless `answer` is NULL. */
__attribute__((format(printf, 4, 5))) RtStatus rt_worker_ask(RtWorker *worker, json_t **answer,
                                                             RtError *error, const char *request, ...);

/* Ends it, and zeroes *worker. */
void rt_worker_end(RtWorker *worker);

/* ---- the worker ---- */

/* Answers requests from stdin on stdout until everything is done or the input ends. `times` says how to time;
 * NULL: it counts. Everything else that is printed goes to stderr. */
RtStatus rt_worker_serve(const RtExperiment *experiment, const RtWorkloadOptions *times, RtError *error);

#endif
