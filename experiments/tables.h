/* Results as tables: the two CSV files of a result directory, and one for the eye. */
#ifndef RT_EXPERIMENTS_TABLES_H
#define RT_EXPERIMENTS_TABLES_H

#include "experiments/results.h"

#include <stdio.h>

/* counts.csv: a row per cell of an accelerator whose counts are the same on every machine, with every
 * effective parameter, all counters, and the figures of the structure. Byte-identical wherever it is made. */
void rt_counts_csv(const RtResults *results, FILE *out);

/* times.csv: a row per timed cell, null runs included: times a ray in nanoseconds with their intervals,
 * ratios, build seconds, bytes; and tests and steps as counted here, which for an accelerator that is not in
 * counts.csv may be others elsewhere. */
void rt_times_csv(const RtResults *results, FILE *out);

/* A row per scene, accelerator and ray kind; or per scene and accelerator, all kinds together. */
void rt_print_cells(const RtResults *results, FILE *out);
void rt_print_totals(const RtResults *results, FILE *out);

/* "12 of 12 null runs straddle 1.", and what to think of it otherwise; and where rounds are too few, what
 * their intervals are worth. "" where none was timed. */
#define RT_MAX_SENTENCE 384
void rt_null_sentence(const RtResults *results, char out[RT_MAX_SENTENCE]);

/* What the intervals cover at least: "95 %", or less where rounds are too few. */
#define RT_MAX_INTERVAL_TITLE 16
void rt_interval_title(const RtExperiment *experiment, char out[RT_MAX_INTERVAL_TITLE]);

/* A figure in about four characters: 0, 0.0034, 1.24, 12.4, 124, 69666; "-" for NAN. Room for 16. An amount
 * below 0.001 is "<0.001" where a figure is 1.2e-04. */
void rt_format_figure(double value, char *out);
void rt_format_amount(double value, char *out);

/* A ratio and its interval as figures, or in as many digits as it takes to see that the interval does not
 * hold 1. */
typedef struct RtRatioText {
    char median[32], low[32], high[32];
} RtRatioText;
void rt_format_ratio(const RtEstimate *ratio, RtRatioText *out);

#endif
