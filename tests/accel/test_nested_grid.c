/* SPDX-License-Identifier: Apache-2.0 */
/* accel/grid with depth > 1: which voxels contain grids, the published structures, invariants of nested
 * grids, each broken on purpose, their limits, and their gain. */
#include "accel_testing.h"

#include "accel/grid/grid.h"
#include "render/frame.h"

static void assert_structure(const RtScene *scene, const char *spec, uint64_t interior, uint64_t leaves,
                             uint64_t empty, uint64_t references) {
    RtDescription d = describe_spec(scene, spec);
    if (d.interior == interior && d.leaves == leaves && d.empty_leaves == empty && d.references == references)
        return;
    fail_msg("%s: %llu interior, %llu leaves, %llu empty, %llu references", spec,
             (unsigned long long)d.interior, (unsigned long long)d.leaves, (unsigned long long)d.empty_leaves,
             (unsigned long long)d.references);
}

/* 2 x 2 x 2 spheres that touch each other: of those that touch a plane only the lower ones are on both
 * sides. */
RT_TEST(a_voxel_with_more_objects_than_nest_holds_a_grid) {
    OWNED_SCENE scene = make_lattice(2, 2, 2);
    assert_structure(&scene, "grid:resolution=1x1x1,depth=2,density=1,nest=8", 0, 1, 0, 8);
    assert_structure(&scene, "grid:resolution=1x1x1,depth=2,density=1,nest=7", 2, 8, 0, 27);
    /* The half that the plane between belongs to becomes 2 x 2 x 2, for its 4 spheres and the 4 that touch
     * it. */
    assert_structure(&scene, "grid:resolution=2x1x1,depth=2,density=1,nest=7,rule=regular", 2, 9, 0, 31);
}

RT_TEST(nesting_ends_at_the_depth_given_or_with_the_voxels_that_hold_too_many) {
    OWNED_SCENE scene = open_scene("random:n=300,distribution=clustered");
    for (uint32_t depth = 1; depth <= 4; depth++) {
        char spec[RT_MAX_SPEC_CHARS];
        snprintf(spec, sizeof spec, "grid:density=0.05,nest=2,depth=%u", depth);
        assert_int_equal(describe_spec(&scene, spec).depth, depth);
    }
    assert_int_equal(describe_spec(&scene, "grid:nest=300,depth=4").depth, 1);
}

/* 40 objects with the same box. */
RT_TEST(nothing_is_nested_where_every_object_fills_the_voxel) {
    OWNED_SCENE scene = make_row(40, 0);
    assert_structure(&scene, "grid:resolution=2x2x2,depth=8,nest=1", 0, 8, 0, 320);
}

RT_TEST(slack_and_flat_reach_as_far_as_they_say) {
    OWNED_SCENE scene = make_lattice(2, 1, 1); /* boxes -0.5..0.5 and 0.5..1.5 */
    assert_structure(&scene, "grid:resolution=4x1x1,slack=0.49", 0, 4, 0, 6);
    assert_structure(&scene, "grid:resolution=4x1x1,slack=0.51", 0, 4, 0, 8);
    OWNED_SCENE balls = open_scene("balls:size=1"); /* on a floor at z = -0.5 */
    OWNED_ACCEL RtGrid *grid = open_valid(&balls, "grid:flat=0.25");
    assert_true(grid->box.lo.z == -0.75f && grid->box.hi.z == balls.geometry.box.hi.z);
    assert_true(grid->box.lo.x == balls.geometry.box.lo.x);
}

RT_TEST(exact_overlap_lists_fewer_objects_on_every_level) {
    OWNED_SCENE scene = open_scene("tetra:size=4");
    RtDescription box = describe_spec(&scene, "grid:depth=3,density=1,nest=2");
    RtDescription exact = describe_spec(&scene, "grid:depth=3,density=1,nest=2,overlap=exact");
    assert_int_equal(box.depth, 3);
    assert_int_equal(exact.depth, 3);
    assert_true(exact.references < box.references / 2);
}

/* Havran & Sixta 1999, RTN 12(1), "Recursive Grid"; see docs/accelerators/grid.md for the other scenes. */
RT_TEST(structures_of_tetra_and_lattice_are_the_published_ones) {
#define AS_PUBLISHED ",density=1,nest=8,margin=0.001,flat=0.02,slack=0.01"
    OWNED_SCENE tetra = open_scene("tetra"), lattice = open_scene("lattice");
    assert_structure(&tetra, "grid:depth=2,rule=heterogeneous" AS_PUBLISHED, 1057, 31768, 14220, 117056);
    assert_structure(&tetra, "grid:depth=3,rule=heterogeneous" AS_PUBLISHED, 1565, 40404, 14220, 218944);
    assert_structure(&tetra, "grid:depth=2,rule=regular" AS_PUBLISHED, 1057, 41024, 16160, 181488);
    assert_structure(&tetra, "grid:depth=3,rule=regular" AS_PUBLISHED, 3105, 94272, 21036, 477408);
    assert_structure(&lattice, "grid:depth=2,rule=regular" AS_PUBLISHED, 513, 22573, 0, 79525);
    assert_structure(&lattice, "grid:depth=3,rule=regular" AS_PUBLISHED, 513, 22573, 0, 79525);
}

RT_TEST(validate_names_each_invariant_of_nested_grids_that_is_broken) {
    OWNED_SCENE scene = make_lattice(4, 4, 4);
    OWNED_ACCEL RtGrid *grid = open_valid(&scene, "grid:resolution=2x2x2,depth=2,density=1,nest=7");
    RtGridLevel *outer = &grid->levels[0], *inner = &grid->levels[1];
    RtGridBlock *last = &inner->blocks[7];
    assert_int_equal(inner->block_count, 8);

    const RtAccel *accel = &grid->base;
    uint32_t *nested = outer->inner, *object = &inner->ids[inner->first[last->voxel]];
    uint32_t *end = &inner->first[inner->voxel_count];
    assert_broken_by(accel, nested[3], 4, "voxel (1, 1, 0) of level 0 does not hold the next grid");
    assert_broken_by(accel, nested[3], RT_GRID_LEAF, "does not hold the next grid");
    assert_broken_by(accel, nested[7], RT_GRID_LEAF, "is in no voxel");
    float *y = last->planes[1], *z = last->planes[2];
    assert_broken_by(accel, z[0], nextafterf(z[0], 0), "voxel (1, 1, 1) of level 0 is not filled");
    assert_broken_by(accel, y[1], 100, "lies behind");
    assert_broken_by(accel, last->voxel, last->voxel + 1, "misnumbered");
    assert_broken_by(accel, outer->first[8], 1, "voxel (1, 1, 1) of level 0 has a list that is broken");
    assert_broken_by(accel, *object, 0, "of level 1 lists an object which it does not touch");
    assert_broken_by(accel, *object, 64, "of level 1 has a list that is not ascending ids");
    assert_broken_by(accel, *end, *end - 1, "voxels, but"); /* the last list without its last object */
    assert_ok(rt_accel_validate(accel, error));
}

RT_TEST(nested_grids_beyond_the_limit_of_memory_are_refused_with_the_depth_that_fits) {
    OWNED_SCENE scene = open_scene("random:n=300,distribution=clustered");
    RtValue values[RT_GRID_PARAM_COUNT];
    RtAccel *accel;
    RtError refusal = {RT_OK, ""};
    assert_ok(rt_params_parse(rt_grid_params, RT_GRID_PARAM_COUNT, "depth=8,nest=1", "grid", values, error));
    int64_t live = rt_alloc_live();
    for (uint64_t limit = 100000; limit <= 10000000; limit *= 10) {
        assert_int_equal(build_within("grid", limit, &scene, values, &accel, &refusal), RT_BAD_INPUT);
        assert_int_equal(rt_alloc_live(), live);
        const char *remedy = strstr(refusal.message, ": depth=");
        uint32_t depth;
        assert_non_null(remedy);
        assert_int_equal(sscanf(remedy, ": depth=%u would fit", &depth), 1);
        assert_in_range(depth, 1, 7);
        values[RT_GRID_DEPTH].i = depth;
        assert_ok(build_within("grid", limit, &scene, values, &accel, error));
        RtDescription description;
        rt_grid_describe(accel, &description);
        assert_true(description.bytes <= limit);
        rt_accel_destroy(accel);
        values[RT_GRID_DEPTH].i = 8;
    }
}

static void count_box(void *context, const RtBoxView *view) {
    uint32_t *boxes = context;
    if (view->leaf) assert_true(view->depth > 0);
    assert_false(rt_box_is_empty(*view->box));
    assert_in_range(view->depth, 0, 2);
    boxes[view->depth]++;
}

RT_TEST(boxes_of_nested_grids_are_shown_a_level_deeper) {
    OWNED_SCENE scene = make_lattice(4, 4, 4);
    OWNED_ACCEL RtGrid *grid = open_valid(&scene, "grid:resolution=2x2x2,depth=2,density=1");
    uint32_t boxes[3] = {0};
    rt_grid_each_box(&grid->base, (RtBoxViewer){count_box, boxes});
    assert_int_equal(boxes[0], 1);
    assert_int_equal(boxes[1], 8);
    assert_int_equal(boxes[2], grid->levels[1].voxel_count);
}

static double tests_per_ray(const RtScene *scene, const char *spec) {
    const RtFrameOptions options = {.depth = 2, .counted = true};
    RtTally sum = {0};
    OWNED_FRAME frame;
    RtGrid *grid = open_valid(scene, spec);
    assert_ok(rt_frame_trace(&frame, &grid->base, &options, error));
    for (int kind = 0; kind < RT_RAY_KIND_COUNT; kind++) rt_tally_add(&sum, &frame.tallies[kind]);
    rt_accel_destroy(&grid->base);
    return (double)sum.object_tests / (double)sum.rays;
}

RT_TEST(a_teapot_in_a_stadium_gains) {
    OWNED_SCENE scene = open_scene("stadium:size=6");
    assert_ok(rt_scene_sample(&scene, 64, 64, 1, false, error));
    double flat = tests_per_ray(&scene, "grid"), nested = tests_per_ray(&scene, "grid:depth=3");
    print_message("tests per ray: %.2f in one grid, %.2f in nested ones\n", flat, nested);
    assert_true(nested < flat / 4);
}

RT_TESTS(nested_grid, NULL, assert_nothing_is_kept)
