/* SPDX-License-Identifier: Apache-2.0 */
/* Instructions per ray where the processor's counters tell nothing: by valgrind's callgrind, exactly.
 *
 * The program runs itself in a child process under callgrind, with the same arguments: it builds each
 * accelerator and asks it a few of the recorded rays twice, on one thread, by the same timed kernels. Only
 * what happens within rt_callgrind_pass is collected, and written anew after each call, so that neither start
 * nor builds are in it; the first pass also does what is done once, as binding symbols, so the second is what
 * counts: the difference between asking twice and asking once. It is the same on every run, but for another
 * compiler or library.
 *
 * valgrind knows no AVX-512: where an accelerator would take it, it takes the best that there is below. */
#ifndef RT_EXPERIMENT_CALLGRIND_H
#define RT_EXPERIMENT_CALLGRIND_H

#include "core/text/table.h"
#include "experiment/workload.h"

#define RT_CALLGRIND_RAYS   4096     /* of a kind and scene, as a rule */
#define RT_CALLGRIND_BROKEN "broken" /* file of the folder: {"scene", "accel", "kind", "why"} a line */

/* RT_NOT_AVAILABLE, and how to get it, where there is no valgrind. */
RtStatus rt_callgrind_check(RtError *error);

/* ---- the child ---- */

/* Asks the rays that were left in `folder`, and says on `out`, a line of JSON for each cell, what was asked
 * of whom: {"scene", "accel", "kind", "passes", "spec", "rays"}, or "why" there is no count. Accelerators of
 * plugins are built in this very process, which ends where one crashes. */
RtStatus rt_callgrind_serve(const RtExperiment *experiment, const char *folder, FILE *out, RtError *error);

/* ---- who starts it ---- */

typedef struct RtInstructions {
    uint32_t workload, candidate;
    RtRayKind kind;
    uint64_t rays, instructions;  /* of all rays */
    char spec[RT_MAX_SPEC_CHARS]; /* as it was built there */
    char why[RT_MAX_WHY];         /* it could not be; else "" */
} RtInstructions;

typedef struct RtCallgrind {
    const RtExperiment *experiment; /* borrowed */
    char folder[RT_MAX_PATH];       /* of what the child gets and leaves */
    uint64_t most;                  /* rays of a kind and scene at most */
    RtInstructions *cells;          /* [count], owned */
    uint32_t count;
} RtCallgrind;

/* Makes a folder that nothing is in. Clear with rt_callgrind_clear, which removes it, also after a failure.
 */
RtStatus rt_callgrind_init(RtCallgrind *callgrind, const RtExperiment *experiment, uint64_t most,
                           RtError *error);
void rt_callgrind_clear(RtCallgrind *callgrind);

/* Leaves rays for the child: of `set`, on workload number `workload`, thinned in runs of neighbours, with the
 * answers of `accel`, which is exact. */
RtStatus rt_callgrind_leave_rays(const RtCallgrind *callgrind, uint32_t workload, const RtRaySet *set,
                                 const RtAccel *accel, RtError *error);

/* Leaves word of the accelerators that broke in `results`: the child does not ask them. */
RtStatus rt_callgrind_leave_out_broken(const RtCallgrind *callgrind, const RtResults *results,
                                       RtError *error);

/* Runs the child: this program with `arguments` (NULL behind the last), which have it serve the folder. */
RtStatus rt_callgrind_run(RtCallgrind *callgrind, char *const *arguments, RtError *error);

/* ---- as tables ---- */

/* The row at hand. */
typedef struct RtInstructionsRow {
    const RtCallgrind *callgrind;
    const RtInstructions *cell;
} RtInstructionsRow;

/* "instructions" of bench --json; `row` as of other tables. */
RtTable rt_instructions_table(RtInstructionsRow *row);

/* For a terminal of 80 columns. */
void rt_print_instructions(const RtCallgrind *callgrind, FILE *out);

#endif
