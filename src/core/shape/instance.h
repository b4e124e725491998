/* SPDX-License-Identifier: Apache-2.0 */
/* Instances: parts placed by a matrix (Sutherland 1963 drew them first; Rubin & Whitted 1980 traced rays
 * through them by moving the ray).
 *
 * A part is a finished geometry that any number of instances share. To the geometry that contains it, an
 * instance is one object with a box. A ray that enters it is moved into the part, where t stays what it was,
 * because the direction is not normalised: to_part in double, then rounded to float32 once, at each level.
 *
 * The hit on an instance is the part's nearest hit of the moved ray, clamped to the interval in which the ray
 * is in the instance's own thick box (core/base/ray.h), and a ray that misses that box misses the instance.
 * So structures above prune as for any object, and rounding decides nothing that they do.
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
    RtTransform to_world, to_part;
    const struct RtGeometry *geometry; /* of the part; borrowed */
    uint32_t part;                     /* its index in the scene (core/scene/scene.h) */
    uint32_t first;                    /* id of the part's first object */
} RtInstance;

/* Moves a ray into the part. False if it is not a valid ray there, for coordinates beyond RT_MAX_COORDINATE
 * or a direction that vanishes: such a ray misses the instance. */
static inline bool rt_instance_enter(const RtInstance *instance, const RtRay *ray, RtRay *inside) {
    const RtTransform *m = &instance->to_part;
    *inside = *ray;
    inside->org = rt_transform_point(m, ray->org);
    inside->dir = rt_narrow(rt_transform_vectord(m, rt_widen(ray->dir)));
    return rt_ray_is_valid(inside);
}

#endif
