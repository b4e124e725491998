/* SPDX-License-Identifier: Apache-2.0 */
/* All pictures, drawn to a file (canvas.h): heatmaps, the cost of each pixel as a colour; accelerators, the
 * boxes of a structure over the scene or in a section through it, and overlays that look rays up in cells
 * (RtAccelOps.find_cell), the item buffer as an image of object ids, a light buffer as an unfolded cube map
 * of list lengths; a ray's path through an accelerator; a pixel's ray tree. */
#ifndef RT_PICTURE_PICTURES_H
#define RT_PICTURE_PICTURES_H

#include "render/path.h"
#include "render/ray_tree.h"

/* ---- heatmaps ---- */

typedef enum RtHeatmapScale { RT_HEATMAP_AUTO, RT_HEATMAP_LINEAR, RT_HEATMAP_LOG } RtHeatmapScale;

typedef struct RtHeatmapOptions {
    size_t counter;       /* as in rt_tally_get */
    RtHeatmapScale scale; /* AUTO: logarithmic if the mean is below an eighth of the maximum */
    double most;          /* value of the brightest colour and above; 0: the maximum */
    bool difference;      /* with two panels: a third shows the first minus the second */
    const char *rays;     /* the kind of rays counted, for the legend; NULL: all */
} RtHeatmapOptions;

/* A counted frame and its label. All frames of a heatmap have one size. */
typedef struct RtHeatmapPanel {
    const RtFrame *frame;
    const char *label;
} RtHeatmapPanel;

#define RT_MAX_PANELS 8

/* Draws 1..RT_MAX_PANELS panels side by side to `file` (canvas.h): each pixel's mean of the counter over
 * its ray trees, in the colours of rt_color_scale, linear from 0 to the maximum or by log(1 + value). All
 * panels share one scale, drawn as a bar below with the counter's name; each panel shows its mean and
 * maximum. A difference has its own linear scale: red where the first panel costs more, blue where the
 * second does. A single panel needs no label; an image narrower than its legend is padded. */
RtStatus rt_heatmap_draw(const char *file, const RtHeatmapPanel *panels, uint32_t count,
                         const RtHeatmapOptions *options, RtError *error);

/* ---- structures ---- */

/* Which boxes to draw. */
typedef struct RtStructureOptions {
    uint32_t first_level, last_level; /* depths below the root */
    bool leaves;                      /* only leaves */
    bool slice;                       /* only boxes cut by the plane where `axis` is `at` */
    int axis;
    double at;
} RtStructureOptions;

#define RT_ALL_LEVELS ((RtStructureOptions){.last_level = UINT32_MAX})

/* Finds the layer of `accel` named `name`, or if that is NULL the topmost layer that can be drawn by its
 * boxes or cells. RT_BAD_INPUT if no layer has that name, RT_NOT_AVAILABLE if it
 * cannot be drawn. rt_structure_available checks the same for a spec, before anything is built. */
RtStatus rt_structure_layer(const RtAccel *accel, const char *name, const RtAccel **layer, RtError *error);
RtStatus rt_structure_available(const RtSpec *spec, const char *name, RtError *error);

/* Draws the boxes of `layer` (each_box), or the outlines of other extents, to `file` (canvas.h), over a
 * pale image of its scene, `frame`, on white, with a legend below. Edges behind visible surfaces are faint.
 * Lines show the level: dark and thick at the first, lighter (rt_color_scale) and thinner below; if all boxes
 * are on one level, they show size on a logarithmic scale.
 *
 * With `slice` it draws a section along the axis instead, of the region that the camera aims at: boxes cut by
 * the plane are outlined, leaves that list objects also filled; objects are grey.
 *
 * RT_BAD_INPUT if no box is left to draw. */
RtStatus rt_structure_draw(const char *file, const RtAccel *layer, const RtFrame *frame,
                           const RtStructureOptions *options, RtError *error);

/* Draws an overlay to `file` (canvas.h).
 *
 * For primary rays: each pixel has the colour of the object in its middle sample, white for none. A legend
 * counts the samples of each kind.
 *
 * For shadow rays: the cells around light `light` on the six faces of an unfolded cube, coloured by the
 * lengths of their lists on a logarithmic scale. Directions without objects are grey; a truncated list has
 * red dots. `marked` is a ray to this light, or NULL: its cell is outlined and circled, and the
 * legend shows its number and list length.
 *
 * RT_BAD_INPUT if there is no such light, RT_NOT_AVAILABLE if the light has no cells. */
RtStatus rt_buffer_draw(const char *file, const RtAccel *layer, uint32_t light, const RtRay *marked,
                        RtError *error);

/* ---- rays ---- */

/* Draws the path to `file` (canvas.h), with `title` and `spec` above. */
RtStatus rt_path_draw(const RtPath *path, const RtScene *scene, const char *title, const char *spec,
                      const char *file, RtError *error);

/* Draws the tree, with `title` above: the rays in a section of the scene, and a row for each. */
RtStatus rt_ray_tree_draw(const RtRayTree *tree, const RtScene *scene, const char *title, const char *file,
                          RtError *error);

#endif
