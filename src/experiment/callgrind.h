/* SPDX-License-Identifier: Apache-2.0 */
/* Instructions per ray by valgrind's callgrind: exact, for machines without hardware counters.
 *
 * The program runs itself under callgrind in a child process, with the same arguments. The child builds each
 * accelerator and traces a few of the recorded rays twice, on one thread, with the timed kernels. Callgrind
 * counts only within rt_callgrind_pass and writes its counts after each call, so program start and builds are
 * excluded. The first pass includes one-time work such as binding symbols, so the second is reported. The
 * count is the same on every run with the same compiler and libraries.
 *
 * Valgrind has no AVX-512: an accelerator that would use it uses the best instruction set below it. */
#ifndef RT_EXPERIMENT_CALLGRIND_H
#define RT_EXPERIMENT_CALLGRIND_H

#include "core/text/table.h"
#include "experiment/workload.h"

#define RT_CALLGRIND_RAYS   4096     /* of a kind and scene, by default */
#define RT_CALLGRIND_BROKEN "broken" /* file of the folder: {"scene", "accel", "kind", "why"} a line */

/* RT_NOT_AVAILABLE, with a message on how to install it, if there is no valgrind. */
RtStatus rt_callgrind_check(RtError *error);

/* ---- the child ---- */

/* Traces the rays saved in `folder`, and writes to `out` a line of JSON for each cell: {"scene", "accel",
 * "kind", "passes", "spec", "rays"}, or "why" it has no count. Accelerators of plugins are built in this
 * process, which ends if one crashes. */
RtStatus rt_callgrind_serve(const RtExperiment *experiment, const char *folder, FILE *out, RtError *error);

/* ---- the parent ---- */

typedef struct RtInstructions {
    uint32_t workload, candidate;
    RtRayKind kind;
    uint64_t rays, instructions;  /* of all rays */
    char spec[RT_MAX_SPEC_CHARS]; /* as the child built it */
    char why[RT_MAX_WHY];         /* instructions are unknown; else "" */
} RtInstructions;

typedef struct RtCallgrind {
    const RtExperiment *experiment; /* borrowed */
    char folder[RT_MAX_PATH];       /* what parent and child exchange */
    uint64_t most;                  /* rays of a kind and scene at most */
    RtInstructions *cells;          /* [count], owned */
    uint32_t count;
} RtCallgrind;

/* Creates an empty folder. Clear with rt_callgrind_clear, which removes it, also after a failure. */
RtStatus rt_callgrind_init(RtCallgrind *callgrind, const RtExperiment *experiment, uint64_t most,
                           RtError *error);
void rt_callgrind_clear(RtCallgrind *callgrind);

/* Saves rays for the child: those of `set`, on workload number `workload`, thinned in runs of neighbours,
 * with the answers of `accel`, which is exact. */
RtStatus rt_callgrind_save_rays(const RtCallgrind *callgrind, uint32_t workload, const RtRaySet *set,
                                const RtAccel *accel, RtError *error);

/* Saves a list of the accelerators that broke in `results`: the child does not build them. */
RtStatus rt_callgrind_save_broken(const RtCallgrind *callgrind, const RtResults *results, RtError *error);

/* Runs the child: this program with `arguments` (NULL behind the last), which make it serve the folder. */
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
