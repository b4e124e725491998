/* SPDX-License-Identifier: Apache-2.0 */
/* What the explorer replays: for each kth pixel of each kth row, the ray tree, and the path of each ray of it
 * through each accelerator, as the counted kernels report it (render/path.h).
 *
 * All numbers are LEB128 but for floats and the lengths, u32 (explore_bytes.h). An object is written as 0 for
 * none, 1 for one without a name, id + 2 otherwise.
 *
 *   rays:   for each pixel, tile by tile: its number (row * columns + column), its length, and the rays of
 *           its tree (RtTreeRay) in the order in which the frame adds their light, each: kind, level,
 *           1 + parent or 0, source, total + 2 * cut, org[3], dir[3], tmax (floats), object, t, added[3]
 *           (floats), of a shadow ray the diffuse part of that (floats), of a primary ray the number of
 *           candidates, and of each object and t (float)
 *   paths:  of one accelerator: for each pixel its number and length, and for each ray of its tree: object,
 *           t (float), the counters of its tally, the cell (1 + number, length, object, cut; or 0), rows of
 *           the path, rows kept, and of each kept one: event, and t (float) if the form has one
 *   events: of one accelerator: form, index, 1 and a box or 0
 *
 * Candidates are the objects that a primary ray hits, from near to far, if an accelerator looks primary rays
 * up in cells. */
#ifndef RT_REPORT_EXPLORE_RECORD_H
#define RT_REPORT_EXPLORE_RECORD_H

#include "render/path.h"
#include "render/ray_tree.h"
#include "report/explore.h"
#include "report/explore_bytes.h"

#include <jansson.h>

enum { RT_MAX_RECORDED_ROWS = 1000 }; /* of one path; brute's would fill the page */

typedef struct RtEvent {
    uint32_t form, index, boxed;
    RtBox box;
} RtEvent;

typedef struct RtRecordedPaths {
    RtAccel *accel; /* borrowed */
    RtBytes paths;
    RtPathRow *forms; /* what rows have in common: all but index, box and t */
    uint32_t form_count, form_capacity;
    RtEvent *events; /* different ones */
    uint32_t event_count, event_capacity;
    uint32_t *slots; /* [slot_count], a hash table of 1 + index into events; 0: free */
    uint32_t slot_count;
} RtRecordedPaths;

typedef struct RtRecordedPixels {
    uint32_t stride, columns, rows; /* of the recorded pixels */
    uint64_t ray_count, cut_count;  /* rays; paths of which rows were left out */
    RtBytes rays;
    uint32_t count;
    RtRecordedPaths of[RT_MAX_EXPLORED];
} RtRecordedPixels;

/* Records as many pixels as fit; compresses what it recorded. Free with rt_recorded_pixels_clear. */
RtStatus rt_recorded_pixels_make(RtRecordedPixels *recording, RtAccel *const *accels, uint32_t count,
                                 const RtExploreOptions *options, RtError *error);
void rt_recorded_pixels_clear(RtRecordedPixels *recording);

/* The forms of rows, in order: {"name", "of", "met", "hit", "round", "counts": [names of counters]}. NULL if
 * memory is short. */
json_t *rt_recorded_forms(const RtRecordedPaths *paths);

/* The different events. */
void rt_recorded_events(const RtRecordedPaths *paths, RtBytes *out);

#endif
