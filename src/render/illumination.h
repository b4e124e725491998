/* The standard illumination model at one hit, and the rays that it asks for:
 *
 *   I = ka Ia + sum over lights of S_L I_L (kd (N.L) + ks (R.V)^shine) + kt It + kr Ir
 *
 * ka and kd act on the colour of the material, ks, kt and kr are white; S_L is 0 where any object lies
 * between the point and the light, else 1. (Whitted 1980, CACM 23(6), with Phong's highlight.)
 *
 * Normals. Both normals are turned to the side of the surface that the ray came from, which the geometric one
 * decides. N is the shading normal; directions that it sends to the wrong side of the surface are computed
 * again with the geometric one.
 *
 * Starting off the surface. Secondary rays start at point + side * offset (- side for what passes through),
 * tmin 0, with
 *
 *   offset = max(2^-18 * max(|point|, t * |dir|), 2^-20 * farthest corner of the object's box),  in max
 * norms:
 *
 * the first bounds the rounding of the point itself (a few 2^-24 of its coordinates and of the distance the
 * ray came), the second that of the object's hit function for a ray that starts next to it (rt_thickness).
 *
 * Only + - * / sqrt lead to rays; pow is in colours alone. */
#ifndef RT_RENDER_ILLUMINATION_H
#define RT_RENDER_ILLUMINATION_H

#include "scene/scene.h"

/* A hit, made ready for shading. Borrows the scene's material. */
typedef struct RtSurface {
    const RtMaterial *material;
    RtVec3d point;
    RtVec3d arriving; /* unit direction of the ray; the viewer is at -arriving */
    RtVec3d side;     /* unit geometric normal, on the viewer's side */
    RtVec3d normal;   /* unit shading normal N, on the same side */
    double offset;    /* distance at which secondary rays start */
    bool entering;    /* the ray came from outside: against the object's own geometric normal */
} RtSurface;

/* `hit` is a hit of `ray`, not a miss. */
RtSurface rt_surface(const RtScene *scene, const RtRay *ray, RtHit hit);

/* ka Ia */
RtVec3 rt_ambient_light(const RtScene *scene, const RtSurface *surface);

/* False where light `index` does not shine on the viewer's side: N.L <= 0, or the geometric normal says so
 * (the ray would start behind the surface), or the ray would not be valid. Else the shadow ray, which ends at
 * the light at t = 1, and the light that arrives if nothing is in its way: I_L (kd (N.L) + ks (R.V)^shine).
 */
bool rt_shadow_ray(const RtScene *scene, const RtSurface *surface, uint32_t index, RtRay *ray, RtVec3 *light);

/* The reflection and transmission rays of the surface, with unit directions, and the factor of the light that
 * each brings back. Gives their number, 0..2, the reflection first.
 *
 * Where kr > 0 there is a reflection ray. Where kt > 0 there is a transmission ray by Snell's law, the inside
 * of the object having the material's ior and the outside 1; under total internal reflection it becomes a
 * reflection ray, and where there is one already, adds kt to that one's factor: the same ray is not traced
 * twice. */
#define RT_MAX_SPAWN 2
uint32_t rt_spawn_rays(const RtSurface *surface, RtRay rays[RT_MAX_SPAWN], float factors[RT_MAX_SPAWN]);

#endif
