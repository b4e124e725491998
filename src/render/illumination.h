/* SPDX-License-Identifier: Apache-2.0 */
/* The standard illumination model at one hit, and the rays that it needs:
 *
 *   I = ka Ia + sum over lights of S_L I_L (kd (N.L) + ks (R.V)^shine) + kt It + kr Ir
 *
 * ka and kd multiply the colour of the material or of its texture, ks, kt and kr are white; S_L is 0 if any
 * object lies between the point and the light, else 1. (Whitted 1980, CACM 23(6), with Phong's highlight.)
 *
 * Normals. Both normals are turned to the side of the surface that the ray came from, decided by the
 * geometric one. N is the shading normal; a direction that it sends to the wrong side of the surface is
 * computed again with the geometric one.
 *
 * Starting off the surface. Secondary rays start at point + side * offset (- side for transmission), tmin 0.
 * With reach = max(|point|, t * |dir|) in max norms, and rt_thickness at the point for the object's own box
 * and for the scene's,
 *
 *   offset = 2^-21 * reach + 2 * own + min(scene, 2^-18 * reach).
 *
 * The first term bounds the rounding of the point and of t (a few 2^-24), and the shift of boxes beyond their
 * thickness (raytally_shift4). The others account for the thickness of box tests: a ray that starts above it
 * leaves the flat box of a floor behind and does not test the floor again. The second term is the object's
 * own thickness, doubled because a hit may lie as much to the side. The third is that of a structure, which
 * is the scene's, limited by the size of the point: in a scene of size 10^6 with details of size 1 it would
 * move a ray through walls.
 *
 * Texture coordinates. A sphere has (longitude / 360, latitude / 180), (1/2, 1/2) where it faces +x, v = 1 at
 * +z. A triangle with coordinates at its vertices interpolates them. Everything else, solids of CSG trees
 * too, is projected along the axis nearest to its geometric normal: (u, v) is the point less the texture's
 * origin without that axis, (x, y), (x, z) or (y, z). So neighbours in a plane share one pattern.
 *
 * Only + - * / sqrt affect rays; pow affects colours only. */
#ifndef RT_RENDER_ILLUMINATION_H
#define RT_RENDER_ILLUMINATION_H

#include "core/scene/scene.h"

/* A hit, prepared for shading. Borrows the scene's material; for a CSG tree that of the solid. */
typedef struct RtSurface {
    const RtMaterial *material;
    RtVec3 color; /* the material's, or its texture's there */
    RtVec3d point;
    RtVec3d arriving; /* unit direction of the ray; the viewer is at -arriving */
    RtVec3d side;     /* unit geometric normal, on the viewer's side */
    RtVec3d normal;   /* unit shading normal N, on the same side */
    double offset;    /* distance at which secondary rays start */
    bool entering;    /* the ray came from outside, against the object's own geometric normal */
} RtSurface;

/* `hit` is a hit of `ray`, not a miss; `hit_memory` is of rt_hit_memory_alloc. */
RtSurface rt_surface(const RtScene *scene, const RtRay *ray, RtHit hit, RtHitMemory *hit_memory);

/* The surface seen from outside: normals on the side of the object's own geometric normal. For programs
 * that light surfaces from outside whichever side a ray comes from, so that objects seen through glass are
 * lit. */
RtSurface rt_surface_outward(const RtSurface *surface);

/* ka Ia */
RtVec3 rt_ambient_light(const RtScene *scene, const RtSurface *surface);

/* False if light `index` does not shine on the viewer's side: N.L <= 0, or the ray would start behind the
 * geometric surface or be invalid. Otherwise returns the shadow ray, which ends at the light at t = 1, and
 * the light that arrives if it is not occluded: I_L (kd (N.L) + ks (R.V)^shine). */
bool rt_shadow_ray(const RtScene *scene, const RtSurface *surface, uint32_t index, RtRay *ray, RtVec3 *light);

/* The diffuse part of that light, I_L kd (N.L). The rest, never less than 0, is the highlight. */
RtVec3 rt_diffuse_light(const RtScene *scene, const RtSurface *surface, uint32_t index);

/* The reflection and transmission rays of the surface, with unit directions, and the factor of the light that
 * each returns. Returns their number, 0..2, the reflection first.
 *
 * If kr > 0 there is a reflection ray. If kt > 0 there is a transmission ray by Snell's law, with the
 * material's ior inside the object and 1 outside. Under total internal reflection it becomes a reflection
 * ray; if there already is one, kt is added to its factor instead, so the same ray is not traced twice. */
#define RT_MAX_SPAWN 2
uint32_t rt_spawn_rays(const RtSurface *surface, RtRay rays[RT_MAX_SPAWN], float factors[RT_MAX_SPAWN]);

#endif
