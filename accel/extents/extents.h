/* The structure behind `extents`: for its own files and its test, which breaks it on purpose. */
#ifndef RT_ACCEL_EXTENTS_EXTENTS_H
#define RT_ACCEL_EXTENTS_EXTENTS_H

#include "accel/accel.h"

typedef enum RtExtentKind {
    RT_EXTENT_BOX,
    RT_EXTENT_SPHERE,
    RT_EXTENT_OBB,
    RT_EXTENT_SLABS,
    RT_EXTENT_KIND_COUNT
} RtExtentKind;

#define RT_MAX_SLABS 13

/* The box of the points whose offset from `center` has, along each of three orthonormal axes, a length of at
 * most `half`. */
typedef struct RtOrientedBox {
    RtVec3d axes[3], center;
    double half[3];
} RtOrientedBox;

typedef struct RtSlab {
    float lo, hi; /* along the unit normal of the plane set, rounded outward */
} RtSlab;

/* One extent per object, by id. Only the array of the kind in use is there; boxes are the scene's own. */
typedef struct RtExtents {
    RtAccel base;
    RtExtentKind kind;
    uint32_t slabs_each;  /* plane sets, 3..RT_MAX_SLABS */
    RtBall *balls;        /* [objects] */
    RtOrientedBox *boxes; /* [objects] */
    RtSlab *slabs;        /* [objects][slabs_each] */
} RtExtents;

/* Unit normals of the plane sets (Kay & Kajiya 1986): the axes, the diagonals of a cube, those of its faces.
 */
extern const RtVec3d rt_slab_normals[RT_MAX_SLABS];

/* Computes the extent of every object, into whichever array is there. */
void rt_extents_fill(RtExtents *self);

/* RtAccelOps.validate: every extent holds its object, as far as support functions tell. */
RtStatus rt_extents_validate(const RtAccel *accel, RtError *error);

#endif
