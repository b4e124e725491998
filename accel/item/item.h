/* SPDX-License-Identifier: Apache-2.0 */
/* The inside of item: its data, shared by the files of this folder.
 *
 * A sample of the image says which object is seen there: its id, RT_NO_OBJECT where the ray of the sample
 * meets nothing, or RT_ITEM_UNDECIDED.
 *
 * Layout: samples row after row from the upper left, as the sources of primary rays count them.
 *
 * Invariant: exactly the ray of a sample that names an object hits no other object before that one, by (t,
 * id), if it hits that one at all; and the ray of a sample that names none hits nothing. That the object is
 * hit need not be known: its hit function is asked. Why this is so whatever the rounding stands in raster.h,
 * for flat objects, and in footprint.c for all others. */
#ifndef RT_ACCEL_ITEM_ITEM_H
#define RT_ACCEL_ITEM_ITEM_H

#include "accel/accel.h"
#include "accel/isa.h"

enum { RT_ITEM_SETTLE, RT_ITEM_ISA, RT_ITEM_PARAM_COUNT };
extern const RtParam rt_item_params[RT_ITEM_PARAM_COUNT];

RT_DECLARE_KERNELS(item);

#define RT_ITEM_UNDECIDED (UINT32_MAX - 1)

typedef struct RtItemPainting RtItemPainting;

/* A vector in double, and a fourth component. */
typedef struct RtItemTerm {
    double at[4];
} RtItemTerm;

/* Samples of the image as homogeneous coordinates: a point q relative to the eye is seen at column x . q / w,
 * row y . q / w, at t = w, with w = depth . q. */
typedef struct RtItemAim {
    RtVec3d x, y, depth;
    double scale[2]; /* samples per unit of slope: along x and y */
    double longest;  /* |dir| of all rays is below this */
    double blur;     /* by how much directions, rounded to float32, are off, as a part of 1 */
} RtItemAim;

typedef struct RtItemBuffer {
    RtIsaAccel isa;
    const RtItemPainting *painting;
    RtView view;
    bool settle;
    uint32_t *samples; /* [rows * columns] */
    /* The dir of a sample's ray is columns[column] + rows[row], rounded to float32; the fourth component is
     * its tmax. */
    RtItemTerm *columns, *rows;
    RtVec3d across, downward; /* q . across and q . downward, over q . forward: position in -1..1 */
    RtItemAim aim;
} RtItemBuffer;

static inline size_t rt_item_sample_count(const RtItemBuffer *buffer) {
    return (size_t)buffer->view.sampling.columns * buffer->view.sampling.rows;
}

/* footprint.c */

/* Where the view is so wide that directions are off by more, everything is seen everywhere. */
#define RT_ITEM_MOST_BLUR 0x1p-10

/* Fills what is for projecting; `view` is there. */
void rt_item_aim(RtItemBuffer *buffer);

/* Samples lo[0]..hi[0] of rows lo[1]..hi[1]; no ray hits the object at a t below `near`. */
typedef struct RtItemFootprint {
    uint32_t lo[2], hi[2];
    float near;
} RtItemFootprint;

/* The samples whose rays may hit an object, from its box; false if there are none. */
bool rt_item_footprint(const RtItemBuffer *buffer, uint32_t id, RtItemFootprint *footprint);

/* build.c */
RtStatus rt_item_build(const RtBuild *what, RtAccel **out, RtError *error);
void rt_item_destroy(RtAccel *accel);

/* stats.c */
bool rt_item_look_up(const RtAccel *accel, const RtRay *ray, RtCellView *cell);
void rt_item_describe(const RtAccel *accel, RtDescription *out);
RtStatus rt_item_validate(const RtAccel *accel, RtError *error);

#endif
