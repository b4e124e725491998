/* SPDX-License-Identifier: Apache-2.0 */
/* Distributions as tables: as exact as counts.csv, for the same accelerators. */
#ifndef RT_RESULTS_DISTRIBUTION_TABLES_H
#define RT_RESULTS_DISTRIBUTION_TABLES_H

#include "core/text/table.h"
#include "results/results.h"

typedef enum RtDistributionTable {
    RT_DISTRIBUTIONS, /* distributions.csv: a row per cell and quantity over rays, and per structure and
                         quantity over leaves: percentiles */
    RT_HISTOGRAMS     /* histograms.csv: a row for each bin that is not empty */
} RtDistributionTable;

/* The row at hand. */
typedef struct RtDistributionRow {
    const RtResults *results;
    RtDistributionTable which;
    uint32_t workload, candidate;
    size_t quantity; /* rt_quantity_name */
    RtRayKind kind;  /* if `quantity` is over rays */
    uint32_t bin;    /* of RT_HISTOGRAMS */
    const RtDistribution *distribution;
} RtDistributionRow;

/* `row` belongs to the table and must outlive it. The caller fills in its results. */
RtTable rt_distribution_table(RtDistributionTable which, RtDistributionRow *row);

/* Prints, in 80 columns, a row per cell and then a row per structure of each known workload. */
void rt_print_distributions(const RtResults *results, FILE *out);

#endif
