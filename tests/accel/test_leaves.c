/* SPDX-License-Identifier: Apache-2.0 */
/* The leaves that structures show are those that they describe. */
#include "accel_testing.h"

#include "verify/spread.h"

typedef struct Sums {
    uint64_t leaves, empty, references, depth;
} Sums;

static void add_leaf(void *context, const RtBoxView *view) {
    Sums *sums = context;
    if (!view->leaf) return;
    sums->leaves++;
    sums->empty += view->objects == 0;
    sums->references += view->objects;
    if (view->depth > sums->depth) sums->depth = view->depth;
}

static void check_leaves(const char *spec, const RtScene *scene) {
    OWNED_ACCEL RtAccel *accel = open_available(scene, spec, 1);
    RtDescription d;
    Sums sums = {0};
    if (!accel) return; /* an instruction set */
    rt_accel_describe(accel, &d);
    accel->ops->each_box(accel, (RtBoxViewer){add_leaf, &sums});
    if (sums.leaves != d.leaves || sums.empty != d.empty_leaves || sums.references != d.references ||
        sums.depth != d.depth) {
        fail_msg("%s: %d leaves, %d empty, %d references, depth %d, not %d, %d, %d, %d", spec,
                 (int)sums.leaves, (int)sums.empty, (int)sums.references, (int)sums.depth, (int)d.leaves,
                 (int)d.empty_leaves, (int)d.references, (int)d.depth);
    }
}

RT_TEST(the_leaves_shown_are_those_described_at_every_setting) {
    const char *const scenes[] = {"balls:size=1", "random:n=1", "random:n=100"};
    uint32_t shown = 0;
    for (size_t s = 0; s < 3; s++) {
        OWNED_SCENE scene = open_scene(scenes[s]);
        for (size_t i = 0; i < rt_accel_count(); i++) {
            char spec[RT_MAX_SPEC_CHARS];
            if (!rt_accel_at(i)->shows_lists) continue;
            shown++;
            for (size_t n = 0; rt_spread_spec(rt_accel_at(i), n, spec); n++) check_leaves(spec, &scene);
        }
    }
    assert_true(shown >= 3 * 6); /* bvh, clusters, grid, kd, octree, wide, and newer ones */
}

RT_TEST(a_structure_without_objects_shows_what_it_describes) {
    OWNED_SCENE scene = begin_scene();
    assert_ok(rt_scene_finish(&scene, error));
    for (size_t i = 0; i < rt_accel_count(); i++) {
        if (rt_accel_at(i)->shows_lists) check_leaves(rt_accel_at(i)->name, &scene);
    }
}

RT_TESTS(leaves, NULL, assert_nothing_is_kept)
