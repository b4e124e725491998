/* SPDX-License-Identifier: Apache-2.0 */
/* Shared by tests of scenes: opening a scene, its objects by shape, and failing allocations. */
#ifndef RT_TESTS_SCENE_TESTING_H
#define RT_TESTS_SCENE_TESTING_H

#include "testing.h"

#include "core/base/memory.h"
#include "scenes/open.h"

static inline RtScene open_scene(const char *spec) {
    RtScene scene;
    assert_ok(rt_scene_open(spec, &scene, error));
    return scene;
}

typedef struct ShapeCounts {
    const char *spec;
    uint32_t spheres, polygons, triangles, cones;
} ShapeCounts;

/* Each scene has as many objects of each shape as its row says. */
static inline void assert_shape_counts(const ShapeCounts *rows, size_t count) {
    for (size_t i = 0; i < count; i++) {
        OWNED_SCENE scene = open_scene(rows[i].spec);
        assert_int_equal(scene.geometry.sphere_count, rows[i].spheres);
        assert_int_equal(scene.geometry.polygon_count, rows[i].polygons);
        assert_int_equal(scene.geometry.triangle_count, rows[i].triangles);
        assert_int_equal(scene.geometry.cone_count, rows[i].cones);
    }
}

static inline void assert_failed_allocations_are_reported(const char *spec) {
    RtScene scene;
    assert_fails_cleanly(rt_scene_open(spec, &scene, error), rt_scene_clear(&scene));
}

#endif
