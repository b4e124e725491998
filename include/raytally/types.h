/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * Plain types that raytally, programs that embed it and accelerators that it loads have in common: rays, hits
 * and counters. Their layout is part of the binary interface and does not change within a major version. */
#ifndef RAYTALLY_TYPES_H
#define RAYTALLY_TYPES_H

#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

/** What a ray is traced for. Shadow and occlusion rays ask whether anything lies on them, all others what is
 * nearest. */
enum raytally_ray_kind {
    RAYTALLY_PRIMARY,           /**< From the eye through a sample of the image. */
    RAYTALLY_SHADOW,            /**< From a surface to a light; asks for any hit. */
    RAYTALLY_REFLECTION,        /**< Mirrored at a reflective surface. */
    RAYTALLY_TRANSMISSION,      /**< Refracted through a transparent surface. */
    RAYTALLY_DIFFUSE,           /**< From a surface, cosine-distributed about the normal. */
    RAYTALLY_RANDOM,            /**< A random chord of the scene's bounding sphere. */
    RAYTALLY_OCCLUSION,         /**< A diffuse ray that asks for any hit. */
    RAYTALLY_RAY_KINDS,         /**< The number of kinds there are. */
    RAYTALLY_MAX_RAY_KINDS = 16 /**< The number there is room for, so that new ones change no layout. */
};

/** The points org + t * dir for tmin <= t <= tmax. A valid ray has finite org and dir, no coordinate of org
 * beyond 5e17 in magnitude, a dir that is not zero, and 0 <= tmin <= tmax with tmin finite; tmax may be
 * infinite. dir need not have length 1: t is in lengths of dir. */
typedef struct raytally_ray {
    float org[3];    /**< Origin: x, y, z in the units of the scene. */
    float tmin;      /**< The least t that counts. */
    float dir[3];    /**< Direction, of any length. */
    float tmax;      /**< The largest t that counts; INFINITY for a ray without end. */
    uint32_t kind;   /**< One of ::raytally_ray_kind. */
    uint32_t source; /**< Primary: the index of its sample in the frame; shadow: that of its light; else 0. */
} raytally_ray;

/** The object of a miss. */
#define RAYTALLY_NO_OBJECT UINT32_MAX

/** The nearest hit: of all hits the least (t, object), in that order. A miss is {INFINITY,
 * RAYTALLY_NO_OBJECT}. */
typedef struct raytally_hit {
    float t;         /**< Where on the ray, in lengths of its dir. */
    uint32_t object; /**< The object's number in the scene, from 0 on. */
} raytally_hit;

/** Events that are counted, as places in raytally_counters.at. Counts are exact, and the same on every
 * machine. */
enum raytally_counter {
    RAYTALLY_RAYS,            /**< Rays traced. */
    RAYTALLY_HITS,            /**< Rays that hit an object. */
    RAYTALLY_OBJECT_TESTS,    /**< Exact intersection routines entered; a SIMD lane with an object is one. */
    RAYTALLY_OBJECT_HITS,     /**< Object tests that found the object within [tmin, tmax]. */
    RAYTALLY_EXTENT_TESTS,    /**< Tests of bounding volumes; a SIMD lane that holds one counts as one. */
    RAYTALLY_STEPS,           /**< Nodes, voxels or list entries visited. */
    RAYTALLY_LEAF_STEPS,      /**< Steps that were leaves or voxels, the empty ones included. */
    RAYTALLY_EMPTY_STEPS,     /**< Steps that met no object: empty leaves and voxels. */
    RAYTALLY_CSG_TESTS,       /**< Leaf solids tested inside CSG trees. */
    RAYTALLY_REPEATS_AVOIDED, /**< Object tests that a mailbox saved. */
    RAYTALLY_PASSED_ON,       /**< Rays of its own kind that an overlay handed to what lies below it. */
    RAYTALLY_COUNTERS_KNOWN,  /**< The number of counters there are. */
    RAYTALLY_COUNTERS = 32    /**< The number there is room for, so that new ones change no layout. */
};

/** One value for each counter, by ::raytally_counter; those from RAYTALLY_COUNTERS_KNOWN on are 0. */
typedef struct raytally_counters {
    uint64_t at[RAYTALLY_COUNTERS]; /**< By ::raytally_counter. */
} raytally_counters;

#ifdef __cplusplus
}
#endif

#endif
