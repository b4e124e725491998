/* SPDX-License-Identifier: Apache-2.0 */
/* NFF, Eric Haines' Neutral File Format 3.1, the language of the Standard Procedural Databases:
 *
 *   v                          the camera, with from, at, up (x y z each), angle (degrees over the height of
 *                              the image), hither, resolution (x y); the last two are optional
 *   b r g b                    background
 *   l x y z [r g b]            light; without colour, sqrt(L) / (2 L) of white for each of L lights
 *   f r g b Kd Ks shine T ior  material of all that follows
 *   s x y z radius             sphere
 *   c x y z r  x y z r         open cone or cylinder, base and apex
 *                              (negative radii make the inside visible in NFF; here both sides always are,
 *                              so the sign is dropped)
 *   p n  and n lines x y z     polygon, convex or concave; 3 vertices make a triangle
 *   pp n and n lines x y z nx ny nz   patch: n - 2 triangles with vertex normals, a fan around the first
 *                              vertex, from which all others must be visible
 *   # comment                  to the end of the line
 *
 * Ks becomes both `specular` and `reflection` of the material, T `transmission`. NFF has no ambient term;
 * it becomes RT_NFF_AMBIENT. An ior of 0 with T = 0, as in the databases, becomes 1. */
#ifndef RT_SCENE_NFF_H
#define RT_SCENE_NFF_H

#include "core/scene/scene.h"

#include <stdio.h>

#define RT_NFF_AMBIENT 0.05f

/* Longer files are rejected. */
#define RT_NFF_MAX_BYTES ((size_t)1 << 32)

/* The material of an `f` line. `name` is truncated to RT_MAX_NAME - 1 characters. */
RtMaterial rt_nff_material(const char *name, RtVec3 color, float kd, float ks, float shine, float t,
                           float ior);

/* The intensity of each of `count` lights without a colour: sqrt(count) / (2 count) of white. */
RtVec3 rt_nff_light_intensity(uint32_t count);

/* Reads `path` into a scene from rt_scene_init; the caller then finishes it, or clears it after a failure.
 * NFF names no scenes, so there is none to open. Messages have the form "FILE:LINE: what is wrong, what would
 * be right". */
RtStatus rt_nff_load(const char *path, RtSceneOpener *open_named, RtScene *scene, RtError *error);

/* Writes a finished scene, numbers with 9 digits: reading it back restores coordinates and radii bit for
 * bit, in the same order. Ks is the `reflection`. NFF cannot represent names, ambient terms, or a
 * `specular` other than `reflection`, so these are lost; a polygon of 3 vertices becomes a triangle. A
 * triangle without area is written as a patch, since a polygon without area would be rejected. */
RtStatus rt_nff_save(const RtScene *scene, FILE *file, RtError *error);

#endif
