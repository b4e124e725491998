/* SPDX-License-Identifier: Apache-2.0 */
/* The cost of a whole frame by accelerator, compared with the frame without a structure: the answer of an
 * experiment that has `frame` (RtFrameSetup).
 *
 * A frame's rays are its primary, shadow, reflection and transmission rays: measurements on a part of them
 * are scaled up (rt_results_total). If one kind was not measured, the frame's cost is unknown. The gain of an
 * overlay is relative to the accelerator below it, if that is measured too; the gain of any other accelerator
 * is relative to no structure. */
#ifndef RT_RESULTS_FRAME_TABLE_H
#define RT_RESULTS_FRAME_TABLE_H

#include "core/text/table.h"
#include "results/results.h"

#define RT_FRAME_PLOT "plots/frame.svg" /* drawn by a script of the experiment */

typedef enum RtFramePart {
    RT_FRAME_ALL,
    RT_FRAME_PRIMARY,
    RT_FRAME_SHADOW,
    RT_FRAME_SECONDARY, /* reflection and transmission */
    RT_FRAME_PARTS
} RtFramePart;

/* Over all rays of a part of the frame; NAN if unknown, or if the part has no rays. */
typedef struct RtFrameCost {
    double rays;
    double object_tests;
    double seconds, low, high; /* median, and the sums of the ends of the kinds' intervals */
} RtFrameCost;

/* The row at hand. */
typedef struct RtFrameRow {
    const RtResults *results;
    bool one;          /* a table to read, of one workload; else frame.csv, of all */
    uint32_t workload; /* of the row; given if `one` */
    uint32_t candidate;
    char shown[2 + RT_MAX_SHOWN]; /* its mark and its label, for a screen */
    const char *group;            /* printed rows: that of the last heading */
    RtFrameCost cost[RT_FRAME_PARTS], without[RT_FRAME_PARTS];
    double gain, tests_gain; /* in time, and in object tests */
    uint32_t winner; /* the fastest of the group, without overlays; of the fewest object tests if nothing was
                        timed; candidate_count: none */
} RtFrameRow;

/* `row` belongs to the table and must outlive it. The caller fills in its results, `one`, and then its
 * workload. The winner is marked as the best. */
RtTable rt_frame_table(RtFrameRow *row);

/* Which accelerator of the group is the fastest on a workload, by how much, and how the others and the
 * overlays compare; those whose intervals overlap are level: sentences, for rt_free(). "" if
 * unknown, NULL if memory is short. */
char *rt_frame_sentence(const RtResults *results, uint32_t workload);

/* The size of a workload's frame, its rays by kind, and how many were measured: "a frame of 256x256: 65536
 * primary, ... rays; of 326921 rays, 152585 measured". */
#define RT_MAX_FRAME_TEXT 1024
void rt_frame_title(const RtResults *results, uint32_t workload, char out[RT_MAX_FRAME_TEXT]);

/* Explains the columns of the tables to read, `mark` beside the fastest, and "level". */
void rt_frame_legend(const RtExperiment *experiment, const char *mark, char out[RT_MAX_FRAME_TEXT]);

/* Prints the tables of all known workloads. */
void rt_print_frames(const RtResults *results, FILE *out);

#endif
