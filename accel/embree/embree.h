/* SPDX-License-Identifier: Apache-2.0 */
/* What the files of `embree` share: the accelerator's struct, the state of a query, and Embree's device.
 *
 * Each shape with objects is one Embree geometry, whose geometry id is the RtShape and whose primitive ids
 * are the indices of that shape's array; `slots` leads back to object ids.
 *
 * Why user mode is exact. There Embree only proposes candidates, and our hit functions decide; so it must
 * propose every object that brute would find. Brute finds an object on a ray where the thick ray meets its
 * own box (core/base/ray.h). Embree knows no thick rays, so the boxes it gets are thick instead: grown by
 *
 *     growth = 2^-19 R + 2^-21 M,     R = reach, the farthest that a box may be from an origin,
 *                                     M = the largest coordinate of the scene,
 *
 * twice the thickness of any ray whose origin is within reach, and the other half covers the rounding of
 * Embree's box test (at most 2^-22 R + 2^-23 (M + R) in the place of a plane, robust or not, with or without
 * fused multiply-add) and of ours. A ray from farther away is answered by testing every object, and so is one
 * with dir so long that the rounding of a denormal t moves its hit by more than growth / 4. Embree takes
 * |dir| < 1e-18 for 1e-18, so directions are brought to ordinary lengths by a power of two. A search keeps
 * its own best hit and gives Embree a tfar that lies above it by 2^-20, so that ties and near ties are
 * proposed too, whatever Embree does at t = tfar. */
#ifndef RT_ACCEL_EMBREE_H
#define RT_ACCEL_EMBREE_H

#include "accel/accel.h"
#include "accel/embree/api.h"

/* ---- the device ---- */

/* One Embree device, and what it reports. */
typedef struct RtEmbreeDevice {
    RTCDevice device;
    _Atomic int64_t bytes; /* allocated and not freed */
    _Atomic int code;      /* RTCError: the first one, on whatever thread */
    char message[256];     /* of that one; to be read where no thread builds or traces */
} RtEmbreeDevice;

/* The choices of the parameter `isa`, in order, "default" first. */
#define RT_EMBREE_ISAS "default|sse2|sse4.2|avx|avx2|avx512"

/* RT_OK, or RT_NOT_AVAILABLE where the processor lacks instruction set number `isa` of RT_EMBREE_ISAS. */
RtStatus rt_embree_isa_check(uint32_t isa, RtError *error);

/* Opens a device that uses instruction set number `isa` of RT_EMBREE_ISAS, which the processor has, and
 * builds on `threads` threads (0 = all processors). `device` must stay where it is until it is closed. */
RtStatus rt_embree_device_open(RtEmbreeDevice *device, uint32_t isa, int threads, RtError *error);

/* RT_OK, or the first error that the device reported, while building or tracing. */
RtStatus rt_embree_device_check(const RtEmbreeDevice *device, RtError *error);
void rt_embree_device_close(RtEmbreeDevice *device); /* a zeroed one is allowed */

/* RtAccelOps.library: the version at run time and the instruction set that isa=default stands for on this
 * machine. */
bool rt_embree_library(char *out, size_t room);

/* ---- the accelerator ---- */

typedef struct RtEmbree RtEmbree;

/* One geometry of Embree's: the user pointer that its callbacks get. */
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
    RtEmbreeDevice device;
    RTCScene scene;
    bool user; /* else native */
    RtEmbreeQueryKind query;
    RtEmbreeSlot slots[RT_SHAPE_COUNT];
    uint32_t *indices;   /* [3 * triangle_count] 0, 1, 2, ...; NULL in user mode */
    float growth;        /* of the boxes of user geometry */
    float max_thickness; /* of a ray from within reach */
};

/* ---- queries ---- */

/* Rays handed over at once as single rays or packets: 32 to 128 were slower, by up to a tenth. */
#define RT_EMBREE_PACKET_RAYS 16
#define RT_EMBREE_STREAM_RAYS 256 /* the same as a stream */

/* One ray of user mode: ours, and what was found on it. */
typedef struct RtEmbreeSearch {
    RtPreparedRay ray;
    double shrink; /* Embree's t is t * shrink, a power of two */
    RtHit best;
    RtTally *tally; /* NULL in the timed kernels */
} RtEmbreeSearch;

/* Embree's context of one call, extended by what the callbacks need. Those of user mode are reached through
 * it, so that one structure serves the timed and the counted kernels. */
typedef struct RtEmbreeTrace {
    RtEmbreeContext context; /* first: callbacks get a pointer to it */
    RTCIntersectFunctionN intersect;
    RTCOccludedFunctionN occluded;
    RtEmbreeSearch *searches; /* by ray id */
    RtCrossing *room;         /* of hit functions */
} RtEmbreeTrace;

/* tfar for Embree where only hits up to t matter: a little above it. */
static inline float rt_embree_limit(float t, double shrink) {
    return (float)((double)t * shrink * (1 + 0x1p-20)) + FLT_MIN;
}

/* Callbacks of user geometry: the box of a primitive, grown; candidates of user mode, by way of the context;
 * and those of native mode, with no more of ours than the room of hit functions. */
void rt_embree_bounds(const struct RTCBoundsFunctionArguments *arguments);
void rt_embree_user_intersect(const struct RTCIntersectFunctionNArguments *arguments);
void rt_embree_user_occluded(const struct RTCOccludedFunctionNArguments *arguments);
void rt_embree_native_intersect(const struct RTCIntersectFunctionNArguments *arguments);
void rt_embree_native_occluded(const struct RTCOccludedFunctionNArguments *arguments);

/* A context for rays that are handed over together. */
void rt_embree_trace_init(RtEmbreeTrace *trace, bool coherent, bool counted, RtEmbreeSearch *searches,
                          RtCrossing *room);

/* What native mode answers (native.c). */
void rt_embree_native_nearest(const RtEmbree *self, const RtScratch *scratch, const RtRay *rays, size_t count,
                              RtHit *hits);
void rt_embree_native_occlusion(const RtEmbree *self, const RtScratch *scratch, const RtRay *rays,
                                size_t count, uint32_t *occluders);

/* The kernels of the table of operations, and their scratch memory. */
RtNearestKernel rt_embree_nearest_timed;
RtOccludedKernel rt_embree_occluded_timed;
RtNearestCounted rt_embree_nearest_counted;
RtOccludedCounted rt_embree_occluded_counted;
size_t rt_embree_scratch_bytes(const RtAccel *accel);

#endif
