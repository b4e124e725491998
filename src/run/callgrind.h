/* SPDX-License-Identifier: Apache-2.0 */
/* Instructions per ray by valgrind's callgrind: exact, and the same on every machine.
 *
 * A program, usually this one, runs as a worker (worker.h) under callgrind, with the same arguments. It
 * builds each accelerator and traces a few of the recorded rays twice, on one thread, with the timed kernels.
 * Callgrind counts only within rt_callgrind_pass and writes its counts after each call, so program start and
 * builds are excluded. The first pass includes one-time work such as binding symbols, so the second is
 * reported. The count is the same on every run with the same compiler and libraries.
 *
 * Valgrind has no AVX-512: an accelerator that would use it uses the best instruction set below it. */
#ifndef RT_RUN_CALLGRIND_H
#define RT_RUN_CALLGRIND_H

#include "run/workload.h"

#define RT_CALLGRIND_RAYS 4096 /* of a kind and scene, by default */

/* RT_NOT_AVAILABLE, with a message on how to install it, if there is no valgrind. */
RtStatus rt_callgrind_check(RtError *error);

typedef struct RtInstructions {
    uint32_t workload, candidate;
    RtRayKind kind;
    uint64_t rays, instructions;  /* of all rays */
    char spec[RT_MAX_SPEC_CHARS]; /* as the worker built it */
    char why[RT_MAX_WHY];         /* instructions are unknown; else "" */
} RtInstructions;

typedef struct RtCallgrind {
    const RtExperiment *experiment; /* borrowed */
    char folder[RT_MAX_PATH];       /* rays for the worker, and its results */
    uint64_t most;                  /* rays of a kind and scene at most */
    RtInstructions *cells;          /* [count], owned */
    uint32_t count;
} RtCallgrind;

/* Creates an empty folder. Clear with rt_callgrind_clear, which removes it, also after a failure. */
RtStatus rt_callgrind_init(RtCallgrind *callgrind, const RtExperiment *experiment, uint64_t most,
                           RtError *error);
void rt_callgrind_clear(RtCallgrind *callgrind);

/* For RtWorkloadOptions.rays, with an RtCallgrind as context: saves rays for the worker, thinned in runs of
 * neighbours, with their answers. */
RtStatus rt_callgrind_save_rays(void *context, uint32_t workload, const RtRaySet *set, const RtAccel *exact,
                                RtError *error);

/* Runs the worker with the arguments of `bench` (NULL behind the last), and counts each cell that has rays;
 * earlier counts are dropped. `program` is the path of another raytally; NULL: this one. An accelerator that
 * broke in `results` has no count, nor has a plugin that crashes under valgrind. */
RtStatus rt_callgrind_run(RtCallgrind *callgrind, const char *program, const RtResults *results,
                          char *const *arguments, RtError *error);

/* ---- as tables ---- */

/* The current row. */
typedef struct RtInstructionsRow {
    const RtCallgrind *callgrind;
    const RtInstructions *cell;
} RtInstructionsRow;

/* "instructions" of bench --json; `row` as of other tables. */
RtTable rt_instructions_table(RtInstructionsRow *row);

/* For a terminal of 80 columns. */
void rt_print_instructions(const RtCallgrind *callgrind, FILE *out);

#endif
