/* SPDX-License-Identifier: Apache-2.0 */
/* What each accelerator costs for a whole frame, beside what the frame costs without a structure: the answer
 * to an experiment that has `frame` (RtFrameSetup).
 *
 * A frame's rays are its primary, shadow, reflection and transmission rays. Each kind counts with all rays of
 * its set; an accelerator that is measured on each kth ray is scaled up. Where one kind was not measured, the
 * frame is not known. An overlay is compared with the accelerator below it, where that is measured too, and
 * every other accelerator with none: that factor is the accelerator's gain. */
#ifndef RT_EXPERIMENT_FRAME_TABLE_H
#define RT_EXPERIMENT_FRAME_TABLE_H

#include "core/text/table.h"
#include "experiment/results.h"

#define RT_FRAME_PLOT "plots/frame.svg" /* where a script of the experiment draws it */

typedef enum RtFramePart {
    RT_FRAME_ALL,
    RT_FRAME_PRIMARY,
    RT_FRAME_SHADOW,
    RT_FRAME_SECONDARY, /* reflection and transmission */
    RT_FRAME_PARTS
} RtFramePart;

/* Of all rays of a part of the frame; NAN where it is not known, or the part has no rays. */
typedef struct RtFrameCost {
    uint64_t rays;
    double object_tests;
    double seconds, low, high; /* median, and the sums of the ends of the kinds' intervals */
} RtFrameCost;

/* The row at hand. */
typedef struct RtFrameRow {
    const RtResults *results;
    bool one;          /* of one workload, for the eye; else frame.csv, of all */
    uint32_t workload; /* where `one`: the one that is shown */
    uint32_t candidate;
    RtFrameCost cost[RT_FRAME_PARTS], without[RT_FRAME_PARTS];
    double gain, tests_gain; /* in time, and in object tests */
    uint32_t winner;         /* of the compared candidates that with the largest gain, in object tests where
                                nothing was timed; candidate_count: none */
} RtFrameRow;

/* `row` stays where it is as long as the table, which alone uses it, with its results, `one`, and then its
 * workload, filled in. The best of its standings is the winner. */
RtTable rt_frame_table(RtFrameRow *row);

/* Which of the compared accelerators helped most on a workload, how much, and how the others follow: one or
 * more sentences; "" where that is not known. */
#define RT_MAX_FRAME_SENTENCE 1024
void rt_frame_sentence(const RtResults *results, uint32_t workload, char out[RT_MAX_FRAME_SENTENCE]);

/* The size of a workload's frame, and its rays by kind: "a frame of 256x256: 65536 primary, ... rays". */
void rt_frame_title(const RtResults *results, uint32_t workload, char out[RT_MAX_FRAME_SENTENCE]);

/* What the columns of the tables for the eye mean. */
void rt_frame_legend(const RtExperiment *experiment, char out[RT_MAX_FRAME_SENTENCE]);

/* For a terminal of 80 columns: the tables of all workloads that are known. */
void rt_print_frames(const RtResults *results, FILE *out);

#endif
