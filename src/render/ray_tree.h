/* SPDX-License-Identifier: Apache-2.0 */
/* The ray tree of one sample (Whitted 1980): the primary ray, and at each hit a shadow ray for every light
 * that shines on that side, a reflection ray and a transmission ray, down to a depth. A frame of the same
 * depth traced it, so the colour is that of the frame, bit for bit. */
#ifndef RT_RENDER_RAY_TREE_H
#define RT_RENDER_RAY_TREE_H

#include "render/frame.h"

/* The five terms of the standard illumination model (illumination.h): X(CONSTANT, name) */
#define RT_TERMS(X)                                                                                          \
    X(AMBIENT, ambient)                                                                                      \
    X(DIFFUSE, diffuse)                                                                                      \
    X(SPECULAR, specular)                                                                                    \
    X(REFLECTED, reflected)                                                                                  \
    X(TRANSMITTED, transmitted)

typedef enum RtTerm {
#define RT_TERM_ENUM(CONSTANT, name) RT_TERM_##CONSTANT,
    RT_TERMS(RT_TERM_ENUM)
#undef RT_TERM_ENUM
        RT_TERM_COUNT
} RtTerm;

/* "ambient", ... */
const char *rt_term_name(RtTerm term);

/* A ray of the tree. All colours are linear rgb, and shares of the sample's colour: `factor` is in them. */
typedef struct RtTreeRay {
    RtRay ray;       /* of a shadow ray, ray.source is the light */
    uint32_t number; /* 1, 2, ..., depth first */
    uint32_t level;  /* 1 for the primary ray; a shadow ray has the level of the ray that it starts from */
    uint32_t parent; /* index of that ray; RT_NO_RAY for the primary ray */
    uint32_t child, next; /* first ray that starts at the hit, next ray of the same parent; RT_NO_RAY */
    float factor;         /* product of kr and kt on the way from the eye; under total internal reflection a
                           * reflection ray has kr + kt */
    RtHit hit;            /* of a shadow ray the nearest occluder: object RT_UNNAMED_OBJECT and t INFINITY if
                           * the accelerator finds it only by `occluded` */
    RtSurface surface;    /* what was hit; zeroed for misses and shadow rays */
    bool total;           /* a reflection ray, by total internal reflection */
    bool cut;             /* the surface reflects or transmits, but the depth is reached */
    RtVec3 added;         /* what the ray itself adds: ambient light, the background, or a light's */
    RtVec3d terms[RT_TERM_COUNT]; /* of the light that comes from the hit; of a shadow ray diffuse and
                                   * specular, which are `added` together; zero for a miss */
    RtVec3d light;                /* in all: the sum of the terms, or the background */
} RtTreeRay;

/* Owned; free with rt_ray_tree_clear. The surfaces borrow materials of the scene. */
typedef struct RtRayTree {
    RtVec3 color;    /* of the sample: the sum of `added` in the order of `rays` */
    uint32_t depth;  /* levels that were allowed */
    uint32_t levels; /* levels that there are */
    uint32_t count, capacity;
    RtTreeRay *rays; /* level by level in the order of the frame, the primary ray first, parents before their
                      * children; empty if the sample has no valid ray */
} RtRayTree;

/* Traces samples[0..count) of one tile (rt_tile_of) of the frame's grid, to `depth` levels, 1..RT_MAX_DEPTH.
 * The order of a sample's rays depends on those of its tile, so a tile is traced as a whole, once for all
 * samples. After a failure all trees are empty. */
RtStatus rt_ray_trees_trace(RtRayTree *trees, const RtAccel *accel, const RtSample *samples, uint32_t count,
                            uint32_t depth, RtError *error);

/* The tree of a valid ray that is given in place of a sample's: it counts as primary, and its `source` is no
 * sample's. The tree is empty after a failure. */
RtStatus rt_ray_tree_trace_given(RtRayTree *tree, const RtAccel *accel, const RtRay *given, uint32_t depth,
                                 RtError *error);

/* The ray after `index`, depth first: its first child, or the next of a parent; RT_NO_RAY at the end. The
 * primary ray is the first. */
uint32_t rt_ray_tree_next(const RtRayTree *tree, uint32_t index);

/* "primary", "shadow to light 0", "reflection", "transmission", "total internal reflection" */
#define RT_TREE_RAY_TEXT 32
void rt_tree_ray_name(const RtTreeRay *ray, char name[RT_TREE_RAY_TEXT]);

/* "object 5, sphere, glass", "nothing: background", "object 3, cone: in shadow", ... */
#define RT_TREE_HIT_TEXT 128
void rt_tree_ray_hit(const RtTreeRay *ray, const RtScene *scene, char out[RT_TREE_HIT_TEXT]);

void rt_ray_tree_clear(RtRayTree *tree);

#endif
