/* SPDX-License-Identifier: Apache-2.0 */
/* The explorer: one self-contained page that shows a scene, the structures of accelerators in 3-D, the ray
 * tree of each recorded pixel, and the path of each ray of it through each accelerator, to be stepped
 * through. Everything was recorded before (explore_record.h); the page traces nothing. Its script is
 * explore/main.js, bundled with three.js when the program is built (cmake/bundle.cmake). */
#ifndef RT_REPORT_EXPLORE_H
#define RT_REPORT_EXPLORE_H

#include "accel/accel.h"

enum { RT_MAX_EXPLORED = 4 }; /* accelerators of a page */

typedef struct RtExploreOptions {
    uint32_t depth; /* levels of ray trees, 1..RT_MAX_DEPTH */
    const RtRay
        *given;     /* NULL, or a valid ray to show first, whose tree is recorded beside those of pixels */
    uint32_t bytes; /* of the recorded paths on the page, about: pixels are left out until they fit */
} RtExploreOptions;

/* An accelerator as it was given, and with all its parameters. */
typedef struct RtExploredSpec {
    const char *text, *parameters;
} RtExploredSpec;

/* RT_OK, or RT_NOT_AVAILABLE and why: the program was built without the script. */
RtStatus rt_explore_available(RtError *error);

/* Writes the page to `path`. accels[0..count) are built over one scene, which has one sample a pixel;
 * specs[0..count) name them, and `name` the scene. *stride becomes k, where each kth pixel of
 * each kth row was recorded. */
RtStatus rt_explore_write(const char *path, const char *name, RtAccel *const *accels,
                          const RtExploredSpec *specs, uint32_t count, const RtExploreOptions *options,
                          uint32_t *stride, RtError *error);

#endif
