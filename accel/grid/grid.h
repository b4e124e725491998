/* SPDX-License-Identifier: Apache-2.0 */
/* The data of grid, shared by the files of this folder.
 *
 * Levels. Level 0 is one block: the box of the grid, divided into voxels by planes. A voxel may be divided
 * again into a block of the next level, nested in it. Per level, all voxels are numbered block after block,
 * within a block x fastest; all lists are in one array, `ids`. The list of voxel v is ids[first[v]..first[v +
 * 1]), empty if a block is nested in it.
 *
 * Invariants. The outermost planes of a nested block are those of its voxel, bit for bit. A voxel without a
 * nested block lists exactly the objects whose boxes, grown by `slack`, overlap its intervals of planes on
 * all three axes, and those of all enclosing voxels; an interval contains its lower plane but not its upper
 * one, unless it is the last of its block. Lists are ascending. With overlap=exact a voxel lists only those
 * of them whose surfaces meet it, too, and rays that these do not serve (accel/clipping.h) are tested against
 * every object. */
#ifndef RT_ACCEL_GRID_GRID_H
#define RT_ACCEL_GRID_GRID_H

#include "accel/accel.h"
#include "accel/clipping.h"
#include "core/shape/overlap.h"

#define RT_GRID_PARAMS(X)                                                                                    \
    X(RT_GRID_RULE, "rule", RT_CHOICE("cubic", "cubic|woo|heterogeneous|regular"),                           \
      "how density determines the resolution: cubic voxels; Woo's, by the longest side; Klimaszewski's; "    \
      "equal along all axes",                                                                                \
      "Cleary & Wyvill 1988; Woo 1992; Klimaszewski & Sederberg 1997; Jevans & Wyvill 1989")                 \
    X(RT_GRID_DENSITY, "density", RT_FLOAT("4", 1e-6, 1e6, "0.001|1|20"),                                    \
      "voxels per object that the rule aims for", "between 1 (too coarse) and 20 of Havran & Sixta 1999")    \
    X(RT_GRID_RESOLUTION, "resolution",                                                                      \
      RT_RESOLUTION("auto", 1, RT_GRID_MAX_RESOLUTION, "1x1x1|2x3x5|64x1x64"),                               \
      "voxels along x, y, z of the outermost grid; auto: by the rule", "this program")                       \
    X(RT_GRID_DEPTH, "depth", RT_INT("1", 1, RT_GRID_MAX_LEVELS, "2"),                                       \
      "levels of grids; above 1, a voxel may contain a grid, by the rule",                                   \
      "1: a uniform grid; nested grids: Jevans & Wyvill 1989")                                               \
    X(RT_GRID_NEST, "nest", RT_INT("8", 1, 1e6, "1|30"),                                                     \
      "depth > 1: a voxel of more objects gets a nested grid",                                               \
      "the only value that reproduces Havran & Sixta 1999")                                                  \
    X(RT_GRID_MARGIN, RT_MARGIN_PARAM("the grid"))                                                           \
    X(RT_GRID_FLAT, "flat", RT_FLOAT("0", 0, 1e9, "0.5"),                                                    \
      "distance by which the grid's box extends beyond flat objects",                                        \
      "0.02 comes nearest to Havran & Sixta 1999")                                                           \
    X(RT_GRID_SLACK, "slack", RT_FLOAT("0", 0, 1e9, "0.1"),                                                  \
      "a voxel also lists objects within this distance, in scene units",                                     \
      "0.01 reproduces the nested grids of Havran & Sixta 1999")                                             \
    X(RT_GRID_MAILBOX, RT_MAILBOX_PARAM)                                                                     \
    X(RT_GRID_OVERLAP, "overlap", RT_CHOICE("box", "box|exact"),                                             \
      "a voxel lists the objects whose boxes, or whose surfaces, overlap it",                                \
      "boxes: Havran & Sixta 1999; exact: Akenine-Möller 2001")

enum { RT_GRID_PARAMS(RT_PARAM_INDEX) RT_GRID_PARAM_COUNT };
extern const RtParam rt_grid_params[RT_GRID_PARAM_COUNT];

/* In the order of the choices of the parameters. */
enum { RT_GRID_CUBIC, RT_GRID_WOO, RT_GRID_HETEROGENEOUS, RT_GRID_REGULAR };
enum { RT_GRID_BOX, RT_GRID_EXACT };

enum { RT_GRID_MAX_LEVELS = 8, RT_GRID_MAX_RESOLUTION = 4096 };

/* A box divided into voxels. */
typedef struct RtGridBlock {
    uint32_t n[3];    /* voxels along each axis */
    uint32_t voxel;   /* number of its first voxel in the level */
    float *planes[3]; /* [n[axis] + 1] ascending, parts of the level's array */
} RtGridBlock;

/* RtGridLevel.inner of a voxel without a nested block. */
#define RT_GRID_LEAF UINT32_MAX

typedef struct RtGridLevel {
    RtGridBlock *blocks; /* [block_count] in the order of the voxels that they are nested in */
    float *planes;       /* of all blocks */
    uint32_t *first;     /* [voxel_count + 1] */
    uint32_t *ids;       /* [first[voxel_count]] */
    uint32_t *inner;     /* [voxel_count] the block nested in a voxel; NULL on the deepest level */
    uint32_t block_count, voxel_count;
} RtGridLevel;

typedef struct RtGrid {
    RtAccel base;
    RtBox box;
    RtGridLevel levels[RT_GRID_MAX_LEVELS];
    uint32_t depth;       /* used levels; 0 for an empty scene */
    bool surfaces;        /* overlap=exact */
    double slack;         /* objects' boxes are grown by this */
    RtClippedRays served; /* rays that lists of surfaces serve */
} RtGrid;

/* The voxel of `block` at given coordinates, by its number in the level. */
static inline size_t rt_grid_voxel_at(const RtGridBlock *block, const uint32_t at[3]) {
    return block->voxel + ((size_t)at[2] * block->n[1] + at[1]) * block->n[0] + at[0];
}

/* The block nested in a voxel, or RT_GRID_LEAF. */
static inline uint32_t rt_grid_inner(const RtGridLevel *level, size_t voxel) {
    return level->inner ? level->inner[voxel] : RT_GRID_LEAF;
}

/* ---- grid_build.c ---- */

RtStatus rt_grid_build(RtAccel *accel, const RtBuild *what, RtError *error);

/* An upper bound on the bytes of the voxels and lists of a block with n voxels along each axis, by the boxes
 * of objects whatever the overlap. */
double rt_grid_estimate(const RtGrid *grid, const RtBox *box, const uint32_t n[3], const uint32_t *ids,
                        uint32_t count);

/* The box of an object, grown by the slack. */
RtBox rt_grid_object_box(const RtGrid *grid, uint32_t id);

/* With overlap=exact: whether a voxel with this box, which the object's box touches, lists the object. */
bool rt_grid_surface_meets(const RtGrid *grid, const RtOutline *outline, const RtBox *box);

/* The box of a voxel of `block`. */
RtBox rt_grid_voxel_box(const RtGridBlock *block, const uint32_t at[3]);

/* Bytes of the arrays of a level. */
uint64_t rt_grid_level_bytes(const RtGridLevel *level);

/* A voxel of a level, by its number. */
typedef struct RtGridVoxel {
    const RtGridLevel *level;
    uint32_t number;
    uint32_t block, at[3]; /* where it is */
    RtBox box;
} RtGridVoxel;

/* Finds where a voxel is, from its number and `block`, which may be any before its own; false if the level
 * has no such voxel. */
bool rt_grid_find_voxel(RtGridVoxel *voxel);

#endif
