/* SPDX-License-Identifier: Apache-2.0 */
/* Instances: parts placed by a matrix (Sutherland 1963 drew them first; Rubin & Whitted 1980 traced rays
 * through them by moving the ray).
 *
 * A part is a finished geometry that any number of instances share. To the geometry that contains it, an
 * instance is one object with a box. A ray that enters it is moved into the part, where t stays what it was,
 * because the direction is not normalised: in double, then rounded to float32 once, at each level.
 *
 * The hit on an instance is the part's nearest hit of the moved ray, clamped to the interval in which the ray
 * is in the instance's own thick box (core/base/ray.h), and a ray that misses that box misses the instance.
 * So structures above prune as for any object, and rounding decides nothing that they do.
 *
 * How far clamping moves a hit. The part's hit is in the thick box of an object there, whose planes are moved
 * by s'_b along axis b, by 2^-20 of the distance of the farthest plane and 2^-23 |org_b| (core/base/ray.h).
 * Moving the ray rounds by 2^-24 of |org_b| and of t |dir_b|: by at most s'_b / 2. So outside, where the
 * planes of the box are moved by s_a, the hit is beyond the box's own plane by at most the sum over b of 3/2
 * |m_ab| s'_b. With 3/16 of each s for the rounding of crossings, t is moved to the plane across axis a by
 *
 *     at most (sum over b of 7/4 |m_ab| s'_b - 3/4 s_a) / |dir_a|,   not at all if that is not above 0.
 *
 * Ids. The instances of a geometry come after its other objects. Hits name objects by their place in the
 * flattened order: a geometry's other objects, then those of its instances, one instance after the other. So
 * a plain object has the same id at its level, and that of an object in an instance is the instance's `first`
 * plus its id in the part. */
#ifndef RT_SHAPE_INSTANCE_H
#define RT_SHAPE_INSTANCE_H

#include "core/base/ray.h"
#include "core/base/transform.h"

struct RtGeometry;

enum { RT_MAX_NESTING = 16 }; /* levels of instances in instances */

typedef struct RtInstance {
    RtTransform to_world;
    double columns[4][4]; /* of the inverse: images of the axes and of the origin; the last row is 0 */
    const struct RtGeometry *geometry; /* of the part; borrowed */
    uint32_t part;                     /* its index in the scene (core/scene/scene.h) */
    uint32_t first;                    /* id of the part's first object */
} RtInstance;

/* m p, or with `at` the moved point m p + at, each lane in this order, rounded to float32. */
static inline RtFloat4 rt_instance_move(const double columns[4][4], RtFloat4 p, bool at) {
    RtDouble4 c[4];
    memcpy(c, columns, sizeof c);
    RtDouble4 sum = c[0] * (double)p[0] + c[1] * (double)p[1] + c[2] * (double)p[2];
    if (at) sum += c[3];
    return rt_round4(sum);
}

/* Moves a ray into the part. False if it is not a valid ray there, for coordinates beyond RT_MAX_COORDINATE
 * or a direction that vanishes: such a ray misses the instance. `inside` may be `ray`. */
static inline bool rt_instance_enter(const RtInstance *instance, const RtRay *ray, RtRay *inside) {
    const RtFloat4 org = rt_instance_move(instance->columns, rt_loadu4(ray->org.at), true);
    const RtFloat4 dir = rt_instance_move(instance->columns, rt_loadu4(ray->dir.at), false);
    const RtFloat4 first = {org[0], org[1], org[2], ray->tmin}, last = {dir[0], dir[1], dir[2], ray->tmax};
    memcpy(&inside->org, &first, sizeof first); /* whole vectors, which are read as such */
    memcpy(&inside->dir, &last, sizeof last);
    inside->kind = ray->kind;
    inside->source = ray->source;
    const uint32_t good = rt_bits((rt_abs(org) <= RT_MAX_COORDINATE) & (rt_abs(dir) <= FLT_MAX)),
                   some = rt_bits(dir != 0);
    return (good & 7) == 7 && (some & 7);
}

#endif
