/* SPDX-License-Identifier: Apache-2.0 */
/* What the machine did for a ray, as a table. */
#ifndef RT_EXPERIMENT_HARDWARE_TABLE_H
#define RT_EXPERIMENT_HARDWARE_TABLE_H

#include "core/text/table.h"
#include "experiment/results.h"

/* The row at hand. */
typedef struct RtHardwareRow {
    const RtResults *results;
    uint32_t workload, candidate;
    RtRayKind kind;
    const RtCell *cell;
} RtHardwareRow;

/* hardware.csv: a row per cell for which counters were asked for, empty but for the reason where there are
 * none. `row` stays where it is as long as the table, which alone uses it, with its results filled in. */
RtTable rt_hardware_table(RtHardwareRow *row);

/* For a terminal of 80 columns: of each workload that is known; or why there is nothing. */
void rt_print_hardware(const RtResults *results, FILE *out);

#endif
