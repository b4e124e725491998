/* SPDX-License-Identifier: Apache-2.0 */
/* The data of `embree`: the accelerator's struct, the state of a query, and Embree's device.
 *
 * Each shape that has objects is one Embree geometry. The geometry id is the RtShape; primitive ids are
 * indices in that shape's array; `slots` maps them to object ids.
 *
 * In native mode over native parts on the same device, instance i is an Embree geometry of its own, with id
 * RT_SHAPE_INSTANCE + i. Otherwise instances are one user geometry, whose callback asks the accelerators of
 * parts. In native mode the primitive id of a hit there is the object's.
 *
 * Why user mode is exact. Embree only proposes candidates, and our hit functions decide; so Embree must
 * propose every object that brute finds. Brute finds an object on a ray where the thick ray meets its box
 * (core/base/ray.h). Embree has no thick rays, so its boxes are enlarged instead, by
 *
 *     growth = 2^-19 R + 2^-21 M,     R = reach, the largest distance of a box from an origin,
 *                                     M = the largest coordinate of the scene,
 *
 * twice the thickness of any ray whose origin is within reach. The other half covers the rounding of Embree's
 * box test (at most 2^-22 R + 2^-23 (M + R) in the position of a plane, robust or not, with or without fused
 * multiply-add) and ours. Rays from farther away are tested against every object, and so are rays whose dir
 * is so long that rounding a denormal t moves the hit by more than growth / 4. Embree replaces |dir| < 1e-18
 * by 1e-18, so directions are scaled to ordinary lengths by a power of two. A search keeps its own best hit
 * and gives Embree a tfar that is larger by 2^-20, so ties and near ties are proposed, too, whatever Embree
 * does at t = tfar. An instance is entered only within its own thick box, and t is clamped to that, so all
 * this holds for instances as well. */
#ifndef RT_ACCEL_EMBREE_H
#define RT_ACCEL_EMBREE_H

#include "accel/isa.h"

/* RT_WITH_EMBREE is the major version. Embree 4 no longer has streams of single rays. */
#if RT_WITH_EMBREE >= 4
#include <embree4/rtcore.h>
#define RT_EMBREE_STREAMS 0
#else
#include <embree3/rtcore.h>
#define RT_EMBREE_STREAMS 1
#endif

/* One Embree device, and what it reports. A scene and its parts share it. */
typedef struct RtEmbreeDevice {
    RTCDevice device;
    uint32_t isa;          /* choice of the parameter */
    uint32_t users;        /* accelerators */
    _Atomic int64_t bytes; /* allocated and not freed */
    _Atomic int code;      /* RTCError: the first one, on whatever thread */
    char message[256];     /* of that error; read only while no thread builds or traces */
} RtEmbreeDevice;

typedef struct RtEmbree RtEmbree;

/* One Embree geometry: the user pointer of its callbacks. */
typedef struct RtEmbreeSlot {
    const RtEmbree *self;
    const uint32_t *ids; /* object id of each primitive; the scene's */
    uint32_t first;      /* ids[0] */
    bool consecutive;    /* ids[i] = first + i */
} RtEmbreeSlot;

typedef enum RtEmbreeQueryKind {
    RT_EMBREE_ONE,
    RT_EMBREE_EIGHT,
    RT_EMBREE_SIXTEEN,
    RT_EMBREE_STREAM
} RtEmbreeQueryKind;

struct RtEmbree {
    RtAccel base;
    RtEmbreeDevice *device;
    RTCScene scene;
    RtAccel **parts; /* borrowed (RtBuild) */
    int64_t bytes;   /* that the device has allocated for the scene */
    bool user;       /* else native */
    RtEmbreeQueryKind query;
    RtEmbreeSlot slots[RT_SHAPE_COUNT];
    uint32_t *indices;   /* [3 * triangle_count] 0, 1, 2, ...; NULL in user mode */
    float growth;        /* of the boxes of user geometry */
    float max_thickness; /* of a ray from within reach */
};

/* The largest components of an ordinary direction; others are scaled by a power of two, which scales t by the
 * inverse power and changes no bit of its mantissa. */
#define RT_EMBREE_SHORT 0x1p-16f
#define RT_EMBREE_LONG  0x1p16f

/* The tfar for hits up to t, where Embree's t is t * shrink: slightly larger. */
static inline float rt_embree_limit(float t, double shrink) {
    return (float)((double)t * shrink * (1 + 0x1p-20)) + FLT_MIN;
}

/* ---- embree.c ---- */

extern const RtKernels *const rt_embree_kernels; /* the same for all instruction sets */

/* Callbacks of user geometry, which get a primitive and a packet of rays. */
void rt_embree_intersect(const struct RTCIntersectFunctionNArguments *arguments);
void rt_embree_occluded(const struct RTCOccludedFunctionNArguments *arguments);

#endif
