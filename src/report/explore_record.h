/* SPDX-License-Identifier: Apache-2.0 */
/* What the explorer shows: for each kth pixel of each kth row, the ray tree, and the path of each ray of it
 * through each accelerator, as the counted kernels report it (render/path.h); and in 3-D objects as spheres
 * and triangles, the boxes of structures, and the cells around lights.
 *
 * All numbers are LEB128 but for floats and the lengths, u32, little-endian. An object is written as 0 for
 * none, 1 for one without a name, id + 2 otherwise.
 *
 *   rays:    for each pixel, tile by tile, after the given ray, if there is one, as pixel rows * columns: its
 *            number (row * columns + column), its length, and the rays of
 *            its tree (RtTreeRay) in the order in which the frame adds their light, each: kind, level,
 *            1 + parent or 0, source, total + 2 * cut, org[3], dir[3], tmax (floats), object, t, added[3]
 *            (floats), of a shadow ray the diffuse part of that (floats), of a primary ray the number of
 *            candidates, and of each object and t (float)
 *   paths:   of one accelerator: for each pixel its number and length, and for each ray of its tree: object,
 *            t (float), the counters of its tally, the cell (1 + number, length, object, cut; or 0), rows of
 *            the path, rows kept, and of each kept one: event, and t (float) if the form has one
 *   events:  of one accelerator: form, index (rt_path_row_index), 1 and a box, in world space, or 0
 *   objects: spheres; of each center[3], radius, material; triangles likewise with 9 floats; of CSG trees
 *            their boxes, lo[3], hi[3], material
 *   boxes:   lo[3], hi[3] (floats), depth, 0 for an inner node, 1 + length of its list for a leaf
 *   cells:   of each light the six sides of a cube, -x, +x, -y, ..., of RT_CELL_MAP x RT_CELL_MAP directions:
 *            1 + number of the cell or 0, and length of its list. On a side of axis a, columns go along axis
 *            a + 1, rows along a + 2 (mod 3)
 *
 * Candidates are the objects that a primary ray hits, from near to far, if an accelerator looks primary rays
 * up in cells. */
#ifndef RT_REPORT_EXPLORE_RECORD_H
#define RT_REPORT_EXPLORE_RECORD_H

#include "core/base/box.h"
#include "render/path.h"
#include "render/ray_tree.h"
#include "report/explore.h"

#include <jansson.h>

/* ---- bytes ---- */

/* A growing array of bytes that goes into a page: compressed, in base64. Zero is empty. After a failure
 * nothing more is appended, and `status` is not RT_OK. */
typedef struct RtBytes {
    uint8_t *data;
    uint32_t count, capacity;
    RtStatus status;
} RtBytes;

void rt_bytes_clear(RtBytes *bytes);

void rt_bytes_put(RtBytes *bytes, const void *data, size_t size);
/* LEB128: seven bits a byte, the lowest first; all but the last byte have the highest bit set. */
void rt_bytes_put_number(RtBytes *bytes, uint64_t value);

/* Replaces the contents by the same compressed (zlib's format); *bytes stays as it is on failure. */
RtStatus rt_bytes_compress(RtBytes *bytes, RtError *error);

/* Writes compressed contents as a <script> element of id "part-NAME", a data URL. */
void rt_bytes_embed(const RtBytes *bytes, const char *name, FILE *out);

/* ---- ray trees and paths ---- */

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

/* The forms of rows, in order: {"name", "of", "level", "met", "hit", "round", "counts": [names of counters]}.
 * NULL if memory is short. */
json_t *rt_recorded_forms(const RtRecordedPaths *paths);

/* The different events. */
void rt_recorded_events(const RtRecordedPaths *paths, RtBytes *out);

/* ---- scenes and structures ---- */

enum { RT_MAX_SHOWN_OBJECTS = 100000, RT_MAX_SHOWN_BOXES = 50000, RT_CELL_MAP = 40 };

/* Appends every kth object, so that RT_MAX_SHOWN_OBJECTS are enough; returns k. */
uint32_t rt_explore_objects(const RtScene *scene, RtBytes *out);

/* The boxes of a structure that are shown: the levels above `level` in full, every kth box of that level, and
 * none below. */
typedef struct RtShownBoxes {
    const RtAccel *layer; /* the topmost that has boxes; NULL if none has */
    uint32_t shown, all;
    uint32_t level, every; /* UINT32_MAX if all are shown */
} RtShownBoxes;

/* Appends at most RT_MAX_SHOWN_BOXES. */
RtShownBoxes rt_explore_boxes(const RtAccel *accel, RtBytes *out);

/* Appends the cells around lights; nothing if no layer looks shadow rays up in cells. */
void rt_explore_cells(const RtAccel *accel, RtBytes *out);

#endif
