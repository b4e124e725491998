/* SPDX-License-Identifier: Apache-2.0 */
/* Textures: the colour of a material as a function of texture coordinates (u, v): a checker, or an image.
 * (Catmull 1974; Blinn & Newell 1976, CACM 19(10).) A value in the material; only the texels of an image, a
 * PNG file, are shared, by all materials that name the file. They are read only, and every thread may use
 * them.
 *
 * An image covers 0 <= u, v < 1, its lower row at v = 0, and repeats outside. A point has the colour of the
 * texel that it lies in (nearest neighbour): it can be checked by hand, and samples per pixel smooth it. */
#ifndef RT_SCENE_TEXTURE_H
#define RT_SCENE_TEXTURE_H

#include "core/base/file.h"
#include "core/base/vec.h"

#include <stdatomic.h>

/* Of an image. */
typedef struct RtTexels {
    atomic_uint users; /* materials and others that hold it */
    uint32_t width, height;
    uint8_t *rgb;           /* [height][width][3] sRGB, from the upper left */
    float linear[256];      /* the linear value of each byte of sRGB */
    char path[RT_MAX_PATH]; /* absolute */
} RtTexels;

/* Reads a PNG file of at most 256 MiB and 2^26 pixels, of any kind; what is transparent is on black. *out
 * has one user, the caller. Rejects other files and damaged ones. */
RtStatus rt_texels_load(const char *path, RtTexels **out, RtError *error);

/* One user more; NULL is allowed. */
void rt_texels_share(RtTexels *texels);

/* One user less; the last frees it. NULL is allowed. */
void rt_texels_release(RtTexels *texels);

typedef enum RtTextureKind { RT_TEXTURE_NONE, RT_TEXTURE_CHECKER, RT_TEXTURE_IMAGE } RtTextureKind;

typedef struct RtTexture {
    RtTexels *texels; /* of an image; else NULL */
    uint32_t kind;    /* an RtTextureKind */
    float size;       /* > 0: side of a square of the checker, or of the image, in units of (u, v) */
    RtVec3 color;     /* of every other square of a checker, linear */
    RtVec3 origin;    /* where projected coordinates are (0, 0) */
} RtTexture;

/* The colour at (u, v), finite numbers, of a material with `color`: of a checker, that in square (0, 0), and
 * in the squares beside it the texture's; of an image, the texel times `color`. */
RtVec3 rt_texture_color(const RtTexture *texture, RtVec3 color, double u, double v);

#endif
