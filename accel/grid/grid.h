/* The inside of grid: its data, shared by the files of this folder.
 *
 * Per axis the planes between voxels, planes[axis][0..n[axis]]; all lists in one array, `ids`, voxel after
 * voxel, x fastest; the list of voxel v is ids[first[v]..first[v + 1]). Invariant: an object is in the list
 * of each voxel whose closed intervals of planes meet its box on all three axes, and of no other; a list is
 * ascending. With overlap=exact an object is only in those of them that its surface meets as well, and rays
 * from outside `domain` are tested against every object. */
#ifndef RT_ACCEL_GRID_GRID_H
#define RT_ACCEL_GRID_GRID_H

#include "accel/accel.h"

enum {
    RT_GRID_RULE,
    RT_GRID_DENSITY,
    RT_GRID_RESOLUTION,
    RT_GRID_MARGIN,
    RT_GRID_MAILBOX,
    RT_GRID_OVERLAP,
    RT_GRID_PARAM_COUNT
};
extern const RtParam rt_grid_params[RT_GRID_PARAM_COUNT];

typedef struct RtGrid {
    RtAccel base;
    RtBox box;
    uint32_t n[3];    /* voxels along each axis; 0 if there is no object */
    float *planes[3]; /* [n[axis] + 1], ascending, parts of one block */
    uint32_t *first;  /* [voxels + 1] */
    uint32_t *ids;    /* [first[voxels]] */
    bool mailbox;
    bool surfaces; /* overlap=exact */
    RtBox domain;  /* origins of the rays that voxels with surfaces serve */
    double margin; /* voxels are grown by so much before surfaces are put into them */
} RtGrid;

extern const RtAccelOps rt_grid_ops;

/* place.c: which voxels an object goes into. */

/* A range of voxels, first to last on each axis. */
typedef struct RtGridRange {
    uint32_t from[3], to[3];
} RtGridRange;

/* Chooses margin and domain from the scene's box. */
void rt_grid_choose_margin(RtGrid *grid);

/* The box of a range, and the range of voxels that a box touches; the box must meet the grid's. */
RtBox rt_grid_range_box(const RtGrid *grid, const RtGridRange *range);
RtGridRange rt_grid_touched(const RtGrid *grid, const RtBox *box);

/* Calls `take` for ranges that together hold each voxel that is to list object `id`, once. */
void rt_grid_place(const RtGrid *grid, uint32_t id, void (*take)(void *context, const RtGridRange *range),
                   void *context);

/* limit.c: fails if voxels and lists would take more than `limit` bytes, with a resolution that would fit.
 * Cheap and careful: it takes objects by their boxes, whatever the overlap. */
RtStatus rt_grid_refuse(const RtGrid *grid, uint64_t limit, RtError *error);

/* build.c; _within refuses above another limit than the usual one, for tests. */
RtStatus rt_grid_build_within(uint64_t limit, const RtScene *scene, const RtValue *values, RtAccel **out,
                              RtError *error);
RtStatus rt_grid_build(const RtScene *scene, const RtValue *values, RtAccel **out, RtError *error);
void rt_grid_destroy(RtAccel *accel);

/* survey.c */
void rt_grid_describe(const RtAccel *accel, RtDescription *out);
RtStatus rt_grid_validate(const RtAccel *accel, RtError *error);
void rt_grid_each_box(const RtAccel *accel, RtBoxViewer viewer);

static inline size_t rt_grid_voxel_count(const RtGrid *grid) {
    return (size_t)grid->n[0] * grid->n[1] * grid->n[2];
}

static inline size_t rt_grid_voxel_at(const RtGrid *grid, const uint32_t at[3]) {
    return ((size_t)at[2] * grid->n[1] + at[1]) * grid->n[0] + at[0];
}

#endif
