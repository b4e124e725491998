/* SPDX-License-Identifier: Apache-2.0 */
/* The kernels of item, compiled once for each instruction set (accel/isa.h): placing triangles, drawing
 * facets, and answering primary rays. */
#include "accel/item/item_answer.h"
#include "accel/item/item_draw.h"

RT_DEFINE_BOTH(nearest, RtHit, answer_all)
RT_DEFINE_HANDED_DOWN(occluded, uint32_t)
RT_DEFINE_KERNEL_TABLE(item, 0);
const RtItemRaster RT_OF_ISA(item_raster) = {place, draw, draw_facet};
