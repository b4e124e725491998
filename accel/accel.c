/* SPDX-License-Identifier: Apache-2.0 */
/* What accelerators share: the test of all objects, and sums over boxes. */
#include "accel/kernel.h"

RT_KERNEL bool test_all(const RtGeometry *geometry, const RtPreparedRay *ray, bool any, RtHit *best,
                        RtTally *tally) {
#define LIST(CONSTANT, name, Type) {geometry->name##_ids, geometry->name##_count},
    const struct {
        const uint32_t *ids;
        uint32_t count;
    } lists[] = {RT_SHAPES(LIST)};
#undef LIST
    for (size_t shape = 0; shape < RT_SHAPE_COUNT; shape++) {
        for (uint32_t i = 0; i < lists[shape].count; i++) {
            if (rt_test_object(geometry, lists[shape].ids[i], ray, any, best, tally)) return true;
        }
    }
    return false;
}

bool rt_test_all_timed(const RtGeometry *geometry, const RtPreparedRay *ray, bool any, RtHit *best) {
    return test_all(geometry, ray, any, best, NULL);
}

bool rt_test_all_counted(const RtGeometry *geometry, const RtPreparedRay *ray, bool any, RtHit *best,
                         RtTally *tally) {
    return test_all(geometry, ray, any, best, tally);
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
