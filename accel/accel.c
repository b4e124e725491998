/* SPDX-License-Identifier: Apache-2.0 */
/* What accelerators share: the struct that each begins with, and sums over boxes. */
#include "accel/accel.h"

#include "core/base/memory.h"

RtStatus rt_accel_new(const RtBuild *what, size_t bytes, RtAccel **out, RtError *error) {
    RtAccel *accel = rt_alloc(1, bytes);
    if (!accel) return rt_fail_memory(error, what->ops->name, bytes);
    *accel = (RtAccel){.ops = what->ops, .scene = what->scene, .exact = true, .counts = true};
    *out = accel;
    return RT_OK;
}

RtStatus rt_accel_built(RtAccel *accel, RtStatus status, RtAccel **out) {
    if (status == RT_OK)
        *out = accel;
    else
        accel->ops->destroy(accel);
    return status;
}

void rt_box_sums_add(void *context, const RtBoxView *view) {
    RtBoxSums *sums = context;
    RtDescription *out = sums->out;
    double area = rt_box_half_area(*view->box);
    if (view->depth > out->depth) out->depth = view->depth;
    if (view->leaf) {
        out->leaves++;
        out->empty_leaves += view->objects == 0;
        out->references += view->objects;
        sums->leaves += area;
        sums->tests += area * view->objects;
    } else {
        out->interior++;
        sums->inner += area;
    }
}

void rt_box_sums_predict(const RtBoxSums *sums, const RtBox *root, double traversal_cost) {
    double area = rt_box_half_area(*root);
    if (!(area > 0)) return;
    sums->out->predicted_tests = sums->tests / area;
    sums->out->predicted_steps = (sums->inner + sums->leaves) / area;
    sums->out->predicted_cost = (sums->tests + traversal_cost * sums->inner) / area;
}
