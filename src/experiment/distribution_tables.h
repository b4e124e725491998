/* SPDX-License-Identifier: Apache-2.0 */
/* Distributions as tables: as exact as counts.csv, and of the same accelerators. */
#ifndef RT_EXPERIMENT_DISTRIBUTION_TABLES_H
#define RT_EXPERIMENT_DISTRIBUTION_TABLES_H

#include "core/text/table.h"
#include "experiment/results.h"

typedef enum RtDistributionTable {
    RT_DISTRIBUTIONS, /* distributions.csv: a row per cell and quantity over rays, and per structure and
                         quantity over leaves: percentiles */
    RT_HISTOGRAMS     /* histograms.csv: a row for each bin of these with a value in it */
} RtDistributionTable;

/* The row at hand. */
typedef struct RtDistributionRow {
    const RtResults *results;
    RtDistributionTable which;
    uint32_t workload, candidate;
    size_t quantity; /* rt_quantity_name */
    RtRayKind kind;  /* where that is one over rays */
    uint32_t bin;    /* of RT_HISTOGRAMS */
    const RtDistribution *distribution;
} RtDistributionRow;

/* `row` stays where it is as long as the table, which alone uses it, with its results filled in. */
RtTable rt_distribution_table(RtDistributionTable which, RtDistributionRow *row);

/* For a terminal of 80 columns: of each workload that is known, a row per cell, and then per structure. */
void rt_print_distributions(const RtResults *results, FILE *out);

#endif
