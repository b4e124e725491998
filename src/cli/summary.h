/* SPDX-License-Identifier: Apache-2.0 */
/* What `run` and `merge` print of results. */
#ifndef RT_CLI_SUMMARY_H
#define RT_CLI_SUMMARY_H

#include "experiment/results.h"

/* What a run ends with: what frames cost (experiment/frame_table.h), or the totals where the experiment has
 * no frames; what the machine did, if that was asked for; limits; claims; null runs; and for frames what
 * helped most. */
void rt_cli_print_summary(const RtResults *results, FILE *out);

#endif
