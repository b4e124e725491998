/* SPDX-License-Identifier: Apache-2.0 */
/* What raytally bench prints and writes. */
#ifndef RT_CLI_BENCH_OUTPUT_H
#define RT_CLI_BENCH_OUTPUT_H

#include "experiment/callgrind.h"

typedef struct RtBenchOutput {
    const char *csv; /* a file for a row per cell, or NULL */
    bool json;       /* one document in the place of tables */
    bool count_only;
} RtBenchOutput;

/* `callgrind` has no cells where instructions were not asked for. */
RtStatus rt_bench_report(const RtResults *results, const RtCallgrind *callgrind, const RtBenchOutput *how,
                         RtError *error);

#endif
