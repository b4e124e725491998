/* SPDX-License-Identifier: Apache-2.0 */
/* NFF, Eric Haines' Neutral File Format 3.1, the language of the Standard Procedural Databases:
 *
 *   v                          the camera, with from, at, up (x y z each), angle (degrees over the height of
 *                              the image), hither, resolution (x y); the last two may be left out
 *   b r g b                    background
 *   l x y z [r g b]            light; without colour, sqrt(L) / (2 L) of white, L being the number of lights
 *   f r g b Kd Ks shine T ior  material of all that follows
 *   s x y z radius             sphere
 *   c x y z r  x y z r         open cone or cylinder, base and apex
 *                              (negative radii mean in NFF that the inside is visible; both sides always
 *                              are here, so the sign is dropped)
 *   p n  and n lines x y z     polygon, convex or concave; 3 vertices make a triangle
 *   pp n and n lines x y z nx ny nz   patch: n - 2 triangles with vertex normals, a fan about the first
 *                              vertex, from which every other must be in sight
 *   # comment                  to the end of the line
 *
 * Of a material, Ks becomes both `specular` and `reflection`, T `transmission`; NFF knows no ambient term, it
 * becomes RT_NFF_AMBIENT. An ior that is 0 where T is 0 (the databases write that) becomes 1. */
#ifndef RT_SCENE_NFF_H
#define RT_SCENE_NFF_H

#include "core/scene/scene.h"

#include <stdio.h>

#define RT_NFF_AMBIENT 0.05f

/* Longer files are refused. */
#define RT_NFF_MAX_BYTES ((size_t)1 << 32)

/* The material of an `f` line. `name` is cut to RT_MAX_NAME - 1 characters. */
RtMaterial rt_nff_material(const char *name, RtVec3 color, float kd, float ks, float shine, float t,
                           float ior);

/* The intensity of each of `count` lights for which the file gives none: sqrt(count) / (2 count) of white. */
RtVec3 rt_nff_light_intensity(uint32_t count);

/* Reads `path` into a scene that rt_scene_init has made; the caller finishes it, or clears it after a
 * failure. Messages say "FILE:LINE: what is wrong, what would be right". */
RtStatus rt_nff_load(const char *path, RtScene *scene, RtError *error);

/* Writes a finished scene, numbers with 9 digits: read back it has the same coordinates and radii bit for
 * bit, in the same order. Ks is the `reflection`. NFF cannot hold, so these are lost: names, ambient terms, a
 * `specular` other than `reflection`; and a polygon of 3 vertices comes back as a triangle. A triangle
 * without area is written as a patch, since a polygon without area would be refused. */
RtStatus rt_nff_save(const RtScene *scene, FILE *file, RtError *error);

#endif
