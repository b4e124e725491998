/* SPDX-License-Identifier: Apache-2.0 */
/* A scene: objects in flat arrays (RtGeometry), a material per object, lights, a camera. It owns its
 * memory; a zeroed struct is the empty scene. Readers and generators fill it through the functions below
 * and call rt_scene_finish once. From then on it is read only and threads may share it; only its sampling
 * may still change, while no accelerator is built over it. */
#ifndef RT_SCENE_SCENE_H
#define RT_SCENE_SCENE_H

#include "core/base/warnings.h"
#include "core/scene/camera.h"
#include "core/scene/texture.h"
#include "core/shape/geometry.h"

#define RT_MAX_NAME       64
#define RT_MAX_SCENE_NAME 256

/* The coefficients of the standard illumination model:
 *   I = ka Ia + sum over lights of S (kd (N.L) + ks (R.V)^shine) + kt It + kr Ir
 * ka and kd act on `color`, or the texture's; ks, kt and kr are white. */
typedef struct RtMaterial {
    char name[RT_MAX_NAME];
    RtVec3 color;       /* linear rgb, usually 0..1 */
    float ambient;      /* ka >= 0 */
    float diffuse;      /* kd >= 0 */
    float specular;     /* ks >= 0 */
    float shine;        /* exponent >= 0 */
    float reflection;   /* kr in 0..1; above 0 spawns a reflection ray at every hit */
    float transmission; /* kt in 0..1; above 0 spawns a transmission ray, or its total internal reflection */
    float ior;          /* index of refraction, > 0, of the inside (behind the normal) relative to the
                         * outside */
    RtTexture texture;  /* a zeroed struct: none */
} RtMaterial;

/* A point light. */
typedef struct RtLight {
    RtVec3 position;
    RtVec3 intensity; /* linear rgb */
} RtLight;

/* Texture coordinates. */
typedef struct RtUv {
    float u, v;
} RtUv;

/* Those of the vertices of a triangle. */
typedef struct RtTriangleTexture {
    uint32_t triangle; /* its index in geometry.triangles */
    RtUv at[3];
} RtTriangleTexture;

typedef struct RtScene RtScene;

struct RtScene {
    char name[RT_MAX_SCENE_NAME];
    RtGeometry geometry;
    uint32_t material_of_capacity;
    uint32_t *material_of; /* [geometry.object_count] index into materials; a tree's solids have their own; of
                            * an instance: RT_OWN_MATERIALS, or the one that its part is painted with */
    uint32_t material_count, material_capacity;
    RtMaterial *materials;
    uint32_t triangle_texture_count, triangle_texture_capacity;
    RtTriangleTexture *triangle_textures; /* [triangle_texture_count] ascending by triangle */
    uint32_t light_count, light_capacity;
    RtLight *lights;
    RtVec3 ambient;    /* Ia */
    RtVec3 background; /* colour of a ray that hits nothing */
    RtCamera camera;
    RtSampling sampling; /* of the camera's image: defines the primary rays */
    RtWarnings warnings; /* about the files it was read from */
    RtVec3d offset;      /* readers subtract it from each position, in double, before they round to float32 */
    uint32_t part_count, part_capacity;
    RtScene **parts; /* [part_count] owned, finished: objects that instances place, whose materials are those
                      * of this scene; none in parts */
};

#define RT_OWN_MATERIALS UINT32_MAX

/* Opens the scene named `spec` and finishes it; on failure *scene is empty. */
typedef RtStatus RtSceneOpener(const char *spec, RtScene *scene, RtError *error);

/* Sets the default ambient light, background and camera. */
void rt_scene_init(RtScene *scene);

/* Matte grey: ka .1, kd .9. */
RtMaterial rt_default_material(void);

/* Appends a material, as one more user of its texels, and returns its index; rejects values out of range. */
RtStatus rt_scene_add_material(RtScene *scene, const RtMaterial *material, uint32_t *index, RtError *error);

/* The same, or returns that of a material that is equal, name included. */
RtStatus rt_scene_share_material(RtScene *scene, const RtMaterial *material, uint32_t *index, RtError *error);

/* Gets the texels of the image at `path`: a material's of the scene, or those of the file (rt_texels_load).
 * The caller is one of their users. */
RtStatus rt_scene_load_texels(const RtScene *scene, const char *path, RtTexels **texels, RtError *error);

RtStatus rt_scene_add_light(RtScene *scene, RtVec3 position, RtVec3 intensity, RtError *error);

/* Add objects, each with a material. They reject what rt_geometry_add_... rejects. */
RtStatus rt_scene_add_sphere(RtScene *scene, uint32_t material, RtVec3 center, float radius, RtError *error);
RtStatus rt_scene_add_polygon(RtScene *scene, uint32_t material, const RtVec3 *vertices, uint32_t count,
                              RtError *error);
RtStatus rt_scene_add_triangle(RtScene *scene, uint32_t material, const RtVec3 vertices[3],
                               const RtVec3 *normals, RtError *error);
RtStatus rt_scene_add_cone(RtScene *scene, uint32_t material, RtVec3 base, float base_radius, RtVec3 apex,
                           float apex_radius, RtError *error);

/* Sets the texture coordinates of the triangle added last, if its material has a texture and they are finite.
 */
RtStatus rt_scene_set_triangle_texture(RtScene *scene, const RtUv at[3], RtError *error);

/* The texture coordinates of triangle `index` of the geometry; NULL if it has none. */
const RtTriangleTexture *rt_scene_triangle_texture(const RtScene *scene, uint32_t index);

/* Adds the tree below `root`; the materials of its solids are indices of this scene. The object has the
 * material of its first solid. */
RtStatus rt_scene_add_csg(RtScene *scene, const RtCsgBuilder *builder, RtCsgTerm root, bool extents,
                          RtError *error);
/* Sets the material of all solids of the tree added last. */
void rt_scene_paint_csg(RtScene *scene, uint32_t material);

/* Finishes `part`, a scene without parts of its own, and moves it into *scene, as the next of its parts, and
 * its materials into those of the scene, which share equal ones. `part` is empty afterwards, also after a
 * failure. */
RtStatus rt_scene_add_part(RtScene *scene, RtScene *part, RtError *error);

/* Adds an instance of parts[part] of the scene `of` to `to`, which is that scene or will be one of its later
 * parts (rt_geometry_add_instance). `material`: of `to`, or RT_OWN_MATERIALS. */
RtStatus rt_scene_add_instance(RtScene *to, const RtScene *of, uint32_t part, const RtTransform *to_world,
                               uint32_t material, RtError *error);

/* Where the object with an id is: in the scene itself, or in a part. */
typedef struct RtPlace {
    const RtScene *scene;
    uint32_t object;            /* its id there */
    const RtMaterial *material; /* that it is painted with, instead of its own; NULL: none */
    RtTransform to_world;       /* if it is in a part */
    RtRay ray;                  /* moved there */
} RtPlace;
void rt_scene_place(const RtScene *scene, uint32_t id, const RtRay *ray, RtPlace *place);

/* Creates a finished scene without instances, with a copy of each object in the order of ids, so that hits
 * name the same ones. Copies are moved in double and rounded to float32. */
RtStatus rt_scene_flatten(const RtScene *from, RtScene *to, RtError *error);

/* Computes the boxes. If no camera was given (from = at), places one that sees the whole scene; if there
 * is no light, places one beside the camera. The sampling becomes one sample at each pixel's centre. */
RtStatus rt_scene_finish(RtScene *scene, RtError *error);

/* Changes the sampling of the camera's image; a width or height of 0 is the camera's own. Rejects what
 * rt_sampling_init rejects. */
RtStatus rt_scene_sample(RtScene *scene, uint32_t width, uint32_t height, uint32_t samples, bool corners,
                         RtError *error);

/* Appends the objects of `from` in order, moved by `transform` (NULL: in place), with their materials; a
 * material that `to` already has, name included, is shared. Lights and camera are not copied. Spheres and
 * cones are rejected under a transform that scales unevenly; CSG trees accept any. The origins of textures do
 * not move. After a failure `to` may contain some of the objects. */
RtStatus rt_scene_append(RtScene *to, const RtScene *from, const RtTransform *transform, RtError *error);

/* Creates the finished scene *to from the objects ids[0..count) of the finished scene `from`, in that
 * order, with its lights, camera and sampling, without textures, so that it can be saved without their files.
 * The caller owns it. Its hits are those of `from`, bit for bit. */
RtStatus rt_scene_subset(const RtScene *from, const uint32_t *ids, uint32_t count, RtScene *to,
                         RtError *error);

/* A hash of everything that can change an answer or a picture (geometry, materials, texels, lights,
 * camera; not the sampling). It allocates nothing, so it cannot fail. */
uint64_t rt_scene_fingerprint(const RtScene *scene);

/* Bytes of memory that the scene holds. */
uint64_t rt_scene_bytes(const RtScene *scene);

/* Frees everything and leaves the empty scene. */
void rt_scene_clear(RtScene *scene);

#endif
