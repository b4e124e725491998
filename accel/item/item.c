/* SPDX-License-Identifier: Apache-2.0 */
/* item: the item buffer of Weghorst, Hooper & Greenberg 1984, an overlay for primary rays.
 *
 * Each sample of the image knows which object its ray meets first, found once by drawing all objects
 * (build.c). A ray through a sample tests that one object, RT_LANES rays at a time where they are triangles;
 * where the sample sees nothing, none.
 *
 * Exact: the object's own hit function says whether and where it is hit, and no other object is hit before.
 * Rays of samples that are undecided, or whose object is missed, and rays that are not bit for bit those of
 * the samples are passed on. */
#include "accel/item/item.h"

static RtStatus available(const RtValue *values, RtError *error) {
    return rt_isa_available(values[RT_ITEM_ISA], error);
}

const RtAccelOps rt_item_ops = {
    .name = "item",
    .summary =
        "overlay: the object that is seen at each sample of the image, found by projecting all objects",
    .paper = "Weghorst, Hooper & Greenberg 1984, Improved Computational Methods for Ray Tracing, TOG 3(1)",
    RT_PARAMS_OF(rt_item_params),
    .kinds = 1u << RT_RAY_PRIMARY,
    .build = rt_item_build,
    .destroy = rt_item_destroy,
    RT_ISA_OPS,
    .describe = rt_item_describe,
    .validate = rt_item_validate,
    .find_cell = rt_item_find_cell,
    .available = available,
};
