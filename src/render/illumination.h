/* SPDX-License-Identifier: Apache-2.0 */
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
 * tmin 0. With reach = max(|point|, t * |dir|), in max norms, and rt_thickness at the point of the object's
 * own box and of the scene's,
 *
 *   offset = 2^-21 * reach + 2 * own + min(scene, 2^-18 * reach).
 *
 * The first bounds the rounding of the point and of t (a few 2^-24), and what boxes move besides their
 * thickness (rt_shift4). The others are by how much box tests take boxes for thicker than they are: a ray
 * that starts above that leaves the box of a floor, which is flat, behind and does not ask for the floor
 * again. The second is the object's own, twice, for a hit may lie as much to the side; the third is that of a
 * structure, which is the scene's, but only as far as the point's own size allows: in a scene of 10^6 with
 * details of 1 it would take a ray through walls.
 *
 * Only + - * / sqrt lead to rays; pow is in colours alone. */
#ifndef RT_RENDER_ILLUMINATION_H
#define RT_RENDER_ILLUMINATION_H

#include "core/scene/scene.h"

/* A hit, made ready for shading. Borrows the scene's material, that of the solid for a CSG tree. */
typedef struct RtSurface {
    const RtMaterial *material;
    RtVec3d point;
    RtVec3d arriving; /* unit direction of the ray; the viewer is at -arriving */
    RtVec3d side;     /* unit geometric normal, on the viewer's side */
    RtVec3d normal;   /* unit shading normal N, on the same side */
    double offset;    /* distance at which secondary rays start */
    bool entering;    /* the ray came from outside: against the object's own geometric normal */
} RtSurface;

/* `hit` is a hit of `ray`, not a miss; `room` is of rt_hit_room. */
RtSurface rt_surface(const RtScene *scene, const RtRay *ray, RtHit hit, RtCrossing *room);

/* The surface as it is from outside: normals on the side of the object's own geometric normal. For programs
 * that ask for light there whatever side a ray comes from, so that what is seen within glass is lit from
 * without. */
RtSurface rt_surface_outward(const RtSurface *surface);

/* ka Ia */
RtVec3 rt_ambient_light(const RtScene *scene, const RtSurface *surface);

/* False where light `index` does not shine on the viewer's side: N.L <= 0, or the geometric normal says so
 * (the ray would start behind the surface), or the ray would not be valid. Else the shadow ray, which ends at
 * the light at t = 1, and the light that arrives if nothing is in its way: I_L (kd (N.L) + ks
 * (R.V)^shine). */
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
