/* SPDX-License-Identifier: Apache-2.0 */
/* Workers: programs that are timed against one another. Each has done all that is not to be timed (scene,
 * rays, builds, counts) and waits to be told what to run, so that runs of two programs may alternate however
 * short they are.
 *
 * They talk in lines. The worker says who it is, {"worker": 1, "build": ...}; then for each workload and kind
 * of rays in the order of the experiment what there is to time, {"scene", "kind", "rays", "hash", "cells":
 * [{"accel", "spec", "counts"}]}, and waits. "time C N": it runs cell number C of them N times, and answers
 * with the seconds a ray. "pin P": it stays on the processor number P of those that it may run on, until
 * "next", which leads to the next kind of rays. Last comes {"done": true}. The end of its input ends it. */
#ifndef RT_EXPERIMENT_WORKER_H
#define RT_EXPERIMENT_WORKER_H

#include "experiment/workload.h"

#include <jansson.h>
#include <stdio.h>
#include <sys/types.h>

/* ---- the worker ---- */

/* Serves requests from `in` on `out`, until all is over or the input ends. */
RtStatus rt_worker_serve(const RtExperiment *experiment, const RtWorkloadOptions *options, FILE *in,
                         FILE *out, RtError *error);

/* ---- who has it work ---- */

typedef struct RtWorker {
    const char *program; /* borrowed */
    pid_t pid;           /* 0: none was started */
    FILE *to, *from;
} RtWorker;

/* Starts `program` with these arguments (NULL behind the last), and takes its first line: *build gets who it
 * is, as a new reference. End it with rt_worker_end, also after a failure. */
RtStatus rt_worker_start(RtWorker *worker, const char *program, char *const *arguments, json_t **build,
                         RtError *error);

/* What there is to time next, a new reference; {"done": true} at the end. */
RtStatus rt_worker_next(RtWorker *worker, json_t **section, RtError *error);

RtStatus rt_worker_pin(RtWorker *worker, uint32_t processor, RtError *error);

/* Seconds a ray, of `repeats` runs of cell number `cell` of the section. */
RtStatus rt_worker_time(RtWorker *worker, uint32_t cell, uint32_t repeats, double *seconds, RtError *error);

/* On to what is next. */
RtStatus rt_worker_go_on(RtWorker *worker, RtError *error);

/* Closes its input, and waits for its end. */
void rt_worker_end(RtWorker *worker);

#endif
