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

/* Traces the scene, which is finished, by brute and by item over brute: the pictures are the same bytes, and
 * no ray is passed on. */
static inline void assert_drawn_right(const RtScene *scene) {
    OWNED_FRAME right = trace("brute", scene, false), frame = trace("item+brute", scene, true);
    size_t samples = (size_t)right.sampling.columns * right.sampling.rows;
    const RtTally *tally = &frame.tallies[RT_RAY_PRIMARY];
    assert_memory_equal(frame.object, right.object, samples * sizeof *frame.object);
    assert_memory_equal(frame.depth, right.depth, samples * sizeof *frame.depth);
    assert_memory_equal(frame.color, right.color, samples * sizeof *frame.color);
    assert_int_equal(tally->steps, tally->rays);
    assert_int_equal(tally->object_tests, tally->hits);
    assert_int_equal(tally->passed_on, 0);
}

/* The same, and clears the scene. */
static inline void check_finished(RtScene *scene) {
    assert_drawn_right(scene);
    rt_scene_clear(scene);
}

static inline void check_scene(RtScene *scene) {
    assert_ok(rt_scene_finish(scene, error));
    check_finished(scene);
}

#endif
