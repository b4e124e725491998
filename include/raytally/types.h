/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * Plain types shared by raytally, programs that embed it, and plugins: rays, hits and counters. Their layout
 * is part of the binary interface, which docs/interface.md defines, and does not change within a major
 * version. */
#ifndef RAYTALLY_TYPES_H
#define RAYTALLY_TYPES_H

#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

/** The purpose of a ray. Shadow and occlusion rays are any-hit queries; all others find the nearest hit. */
enum raytally_ray_kind {
    RAYTALLY_PRIMARY,           /**< From the eye through a sample of the image. */
    RAYTALLY_SHADOW,            /**< From a surface to a light; any-hit. */
    RAYTALLY_REFLECTION,        /**< Mirrored at a reflective surface. */
    RAYTALLY_TRANSMISSION,      /**< Refracted through a transparent surface. */
    RAYTALLY_DIFFUSE,           /**< From a surface, cosine-distributed about the normal. */
    RAYTALLY_RANDOM,            /**< A random chord of the scene's bounding sphere. */
    RAYTALLY_OCCLUSION,         /**< A diffuse ray; any-hit. */
    RAYTALLY_RAY_KINDS,         /**< The number of kinds. */
    RAYTALLY_MAX_RAY_KINDS = 16 /**< The size of arrays, so that new ones do not change the layout. */
};

/** The points org + t * dir for tmin <= t <= tmax. A valid ray has finite org and dir, no coordinate of org
 * beyond 5e17 in magnitude, a dir that is not zero, and 0 <= tmin <= tmax with tmin finite; tmax may be
 * infinite. dir need not be normalised: t is in units of its length. As t is a float32, a ray reaches no
 * farther than 3.4e38 lengths of its dir: with (0, 0, 1e-38) an object 3.5 away is missed. If every component
 * is 2^-128 or less in magnitude, its reciprocal is no float32 and the ray may miss what it meets. */
typedef struct raytally_ray {
    float org[3];    /**< Origin: x, y, z in the units of the scene. */
    float tmin;      /**< The least t that counts. */
    float dir[3];    /**< Direction, of any length. */
    float tmax;      /**< The largest t that counts; INFINITY for a ray without end. */
    uint32_t kind;   /**< One of ::raytally_ray_kind. */
    uint32_t source; /**< Shadow: index of its light. Primary, diffuse and occlusion: index of the sample
                          in the frame, row * columns + column. Else 0. */
} raytally_ray;

/** The object of a miss. */
#define RAYTALLY_NO_OBJECT UINT32_MAX

/** A nearest hit: the least (t, object), in that order, of all hits. A miss is {INFINITY,
 * RAYTALLY_NO_OBJECT}. */
typedef struct raytally_hit {
    float t;         /**< Position on the ray, in lengths of its dir. */
    uint32_t object; /**< The object's number in the scene, from 0. */
} raytally_hit;

/** Counted events, as indices of raytally_counters.at. Counts are exact, and the same on every machine. */
enum raytally_counter {
    RAYTALLY_RAYS,         /**< Rays traced. */
    RAYTALLY_HITS,         /**< Rays that hit an object. */
    RAYTALLY_OBJECT_TESTS, /**< Exact intersection routines entered; each SIMD lane with an object counts. */
    RAYTALLY_OBJECT_HITS,  /**< Object tests that found the object within [tmin, tmax]. */
    RAYTALLY_EXTENT_TESTS, /**< Tests of bounding volumes; each SIMD lane with a volume counts. */
    RAYTALLY_STEPS,        /**< Nodes, voxels or list entries visited. */
    RAYTALLY_LEAF_STEPS,   /**< Steps that were leaves or voxels, empty ones included. */
    RAYTALLY_EMPTY_STEPS,  /**< Steps into empty leaves and voxels. */
    RAYTALLY_CSG_TESTS,    /**< Leaf solids tested inside CSG trees. */
    RAYTALLY_REPEATS_AVOIDED,   /**< Object tests that a mailbox saved. */
    RAYTALLY_PASSED_ON,         /**< Rays of its own kind that an overlay passed to the accelerator below. */
    RAYTALLY_INSTANCES_ENTERED, /**< Rays moved into a part, after the object test of its instance. */
    RAYTALLY_COUNTERS_KNOWN,    /**< The number of counters. */
    RAYTALLY_COUNTERS = 32      /**< The size of arrays, so that new ones do not change the layout. */
};

/** One value for each counter; values from RAYTALLY_COUNTERS_KNOWN on are 0. */
typedef struct raytally_counters {
    uint64_t at[RAYTALLY_COUNTERS]; /**< By ::raytally_counter. */
} raytally_counters;

#ifdef __cplusplus
}
#endif

#endif
