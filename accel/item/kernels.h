/* SPDX-License-Identifier: Apache-2.0 */
/* What item does in vectors, included once for each instruction set (accel/isa.h): placing triangles, drawing
 * facets, and answering primary rays. */
#include "accel/item/draw.h"
#include "accel/item/see.h"

RT_DEFINE_BOTH(nearest, RtHit, see_all)
RT_REFUSE_QUESTION(occluded, uint32_t)
RT_DEFINE_KERNEL_TABLE(0);
const RtItemPainting RT_PAINTING = {place, paint, paint_facet};
