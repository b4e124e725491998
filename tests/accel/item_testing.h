/* SPDX-License-Identifier: Apache-2.0 */
/* What tests of the item buffer share: views, and frames of the nearest hits by brute and by item. */
#ifndef RT_TESTS_ITEM_TESTING_H
#define RT_TESTS_ITEM_TESTING_H

#include "accel_testing.h"

#include "accel/item/item.h"
#include "render/frame.h"

static inline RtScene begin_view(void) {
    RtScene scene = begin_scene();
    scene.camera.width = 48;
    scene.camera.height = 36;
    return scene;
}

/* From `from` towards `at`. */
static inline void look(RtScene *scene, RtVec3 from, RtVec3 at) {
    scene->camera.from = from;
    scene->camera.at = at;
}

static inline RtFrame trace(const char *spec, const RtScene *scene, bool counted) {
    RtFrame frame;
    RtFrameOptions options = {.depth = 1, .threads = 2, .counted = counted};
    OWNED_ACCEL RtAccel *accel = open_valid(scene, spec);
    assert_ok(rt_frame_trace(&frame, accel, &options, error));
    return frame;
}

/* Traces the scene by brute and by item over brute, settled and not; the pictures must be the same bytes.
 * Gives the share of rays that item answers when it settles. */
static inline double decided_share(const RtScene *scene) {
    static const char *const specs[] = {"item:settle=off+brute", "item+brute"};
    OWNED_FRAME right = trace("brute", scene, false);
    size_t samples = (size_t)right.sampling.columns * right.sampling.rows;
    double share = 0;
    for (int i = 0; i < 2; i++) {
        OWNED_FRAME frame = trace(specs[i], scene, true);
        const RtTally *tally = &frame.tallies[RT_RAY_PRIMARY];
        assert_memory_equal(frame.object, right.object, samples * sizeof *frame.object);
        assert_memory_equal(frame.depth, right.depth, samples * sizeof *frame.depth);
        assert_memory_equal(frame.color, right.color, samples * sizeof *frame.color);
        assert_int_equal(tally->steps, tally->rays);
        share = 1 - (double)tally->passed_on / (double)tally->rays;
    }
    return share;
}

/* At least `least` of the rays of the scene, which is finished, are to be decided; clears it. */
static inline void check_finished(RtScene *scene, double least) {
    double share = decided_share(scene);
    if (!(share >= least)) fail_msg("%.2f %% of the rays are decided", 100 * share);
    rt_scene_clear(scene);
}

static inline void check_scene(RtScene *scene, double least) {
    assert_ok(rt_scene_finish(scene, error));
    check_finished(scene, least);
}

#endif
