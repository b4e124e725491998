/* SPDX-License-Identifier: Apache-2.0 */
/* accel/grid: rules of resolution, which voxels contain grids, the published structures, invariants, each
 * broken on purpose, limits, and the gain of nested grids. */
#include "accel_testing.h"

#include "accel/grid/grid.h"
#include "render/frame.h"

static void assert_resolution(const RtScene *scene, const char *spec, uint32_t x, uint32_t y, uint32_t z) {
    OWNED_ACCEL RtGrid *grid = open_valid(scene, spec);
    const RtGridBlock *block = grid->levels[0].blocks;
    if (block->n[0] != x || block->n[1] != y || block->n[2] != z)
        fail_msg("%s gave %ux%ux%u", spec, block->n[0], block->n[1], block->n[2]);
}

/* A box of 8 x 4 x 2 with 64 spheres in it. */
RT_TEST(the_rules_of_resolution_give_what_their_formulas_say) {
    OWNED_SCENE scene = make_lattice(8, 4, 2);
    assert_resolution(&scene, "grid:density=1", 8, 4, 2);
    assert_resolution(&scene, "grid:density=8", 16, 8, 4);
    assert_resolution(&scene, "grid:rule=woo,density=1", 4, 2, 1); /* 4 = cbrt(64) along the longest side */
    assert_resolution(&scene, "grid:rule=woo,density=1000", 40, 20, 10);
    assert_resolution(&scene, "grid:rule=heterogeneous,density=1", 8, 4, 2);
    assert_resolution(&scene, "grid:rule=heterogeneous,density=2.2", 10, 5, 3); /* 140.8 / 50 is 2.8 */
    assert_resolution(&scene, "grid:rule=regular,density=1", 4, 4, 4);
    assert_resolution(&scene, "grid:rule=regular,density=1.01", 5, 5, 5);
    assert_resolution(&scene, "grid:resolution=3x5x7", 3, 5, 7);
    assert_resolution(&scene, "grid:density=0.000001", 1, 1, 1);
}

/* Spheres touch at the planes halfway. A voxel contains its lower planes but not its upper ones: along each
 * axis the lower sphere is in both voxels, the upper one only in its own. */
RT_TEST(a_voxel_holds_its_lower_planes) {
    OWNED_SCENE scene = make_lattice(2, 2, 2);
    OWNED_ACCEL RtGrid *grid = open_valid(&scene, "grid:resolution=2x2x2");
    RtDescription description;
    rt_accel_describe(&grid->base, &description);
    assert_int_equal(description.leaves, 8);
    assert_int_equal(description.empty_leaves, 0);
    assert_int_equal(description.references, 27);
    assert_true(fabs(description.predicted_cost - 27.0 / 4.0) < 1e-6);
}

/* Triangle k of n + 1 begins at x[k]; the last one reaches the corner of the scene, [0, 7]^3. */
static RtScene make_places(const float *x, uint32_t n) {
    RtScene scene = begin_scene();
    for (uint32_t k = 0; k <= n; k++) {
        float y = k < n ? 0 : 7, end = k < n ? rt_minf(x[k] + 0.5f, 7) : 7;
        const RtVec3 v[3] = {rt_vec3(x[k], y, y), rt_vec3(end, y, y), rt_vec3(x[k], y, 0)};
        assert_ok(rt_scene_add_triangle(&scene, 0, v, NULL, error));
    }
    assert_ok(rt_scene_finish(&scene, error));
    return scene;
}

/* Division rounds some places just below a plane to that plane, and others up to it to the plane before. */
RT_TEST(an_object_beside_a_plane_is_listed_on_its_side) {
    enum { N = 1000 };
    const char *spec = "grid:resolution=1000x1x1";
    float x[N + 1], plane[N + 1];
    for (int k = 0; k <= N; k++) x[k] = 7.0f * (float)k / (N + 1);
    RtScene scene = make_places(x, N);
    RtGrid *grid = open_valid(&scene, spec);
    const float slack = (float)grid->slack;
    memcpy(plane, grid->levels[0].blocks->planes[0], sizeof plane);
    rt_accel_destroy(&grid->base);
    rt_scene_clear(&scene);
    for (int ulps = -3; ulps <= 3; ulps++) {
        for (int k = 1; k < N; k++) {
            x[k] = plane[k] + slack;
            x[k] += (float)ulps * (nextafterf(x[k], INFINITY) - x[k]);
        }
        scene = make_places(x, N);
        grid = open_valid(&scene, spec);
        assert_memory_equal(grid->levels[0].blocks->planes[0], plane, sizeof plane);
        rt_accel_destroy(&grid->base);
        rt_scene_clear(&scene);
    }
}

RT_TEST(validate_names_each_invariant_that_is_broken) {
    OWNED_SCENE scene = make_lattice(4, 4, 4);
    OWNED_ACCEL RtGrid *grid = open_valid(&scene, "grid:resolution=8x8x8");
    RtGridLevel *level = &grid->levels[0];
    float *y = level->blocks->planes[1], *z = level->blocks->planes[2];
    const RtAccel *accel = &grid->base;
    assert_broken_by(accel, y[3], 100, "lies behind");
    assert_broken_by(accel, z[0], z[0] + 1e-3f, "planes of axis 2 do not enclose its box");
    assert_broken_by(accel, z[8], z[8] - 1e-3f, "planes of axis 2 do not enclose its box");
    assert_broken_by(accel, grid->box.hi.z, grid->box.hi.z - 1, "does not contain the scene");
    assert_broken_by(accel, level->first[10], 0, "is broken");
    uint32_t *last = &level->ids[level->first[11] - 1];
    assert_broken_by(accel, *last, 63, "which it does not touch");
    assert_broken_by(accel, *last, 64, "not ascending ids");
    assert_ok(rt_accel_validate(accel, error));

    /* The first list without its first object. */
    memmove(level->ids, level->ids + 1, (level->first[512] - 1) * sizeof(uint32_t));
    for (uint32_t v = 1; v <= 512; v++) level->first[v]--;
    assert_broken(accel, "voxels, but");
}

RT_TEST(a_grid_beyond_the_limit_of_memory_is_refused_with_what_would_fit) {
    OWNED_SCENE scene = make_lattice(2, 2, 2);
    RtAccel *accel;
    RtError refusal = {RT_OK, ""};
    int64_t live = rt_alloc_live();
    assert_bad_input(rt_accel_open("grid:resolution=2000x2000x2000", &scene, &accel, error), "would fit");
    assert_int_equal(rt_alloc_live(), live);
    assert_int_equal(rt_accel_open("grid:density=1e6,resolution=4096x4096x4096", &scene, &accel, &refusal),
                     RT_BAD_INPUT);
    assert_int_equal(rt_alloc_live(), live);

    for (int a = 0; a < 3;
         a++) { /* the estimate is an upper bound, and close, whichever axis has most voxels */
        const uint32_t ids[8] = {0, 1, 2, 3, 4, 5, 6, 7}, most[5] = {2, 5, 90, 2, 5}, *n = &most[a];
        char spec[64];
        snprintf(spec, sizeof spec, "grid:resolution=%ux%ux%u", n[0], n[1], n[2]);
        RtGrid *grid = open_valid(&scene, spec);
        RtDescription own;
        rt_accel_describe(&grid->base, &own);
        double bytes = rt_grid_estimate(grid, &grid->box, n, ids, 8);
        double needed = (double)(own.leaves + own.references + 1) * sizeof(uint32_t);
        assert_true(bytes >= needed && bytes <= 1.5 * needed);
        rt_accel_destroy(&grid->base);
    }

    /* The named resolution fits, and one more voxel a side does not. */
    static const char *const specs[] = {"density=1e6", "resolution=500x90x3", "overlap=exact,density=1e5"};
    for (size_t i = 0; i < sizeof specs / sizeof specs[0]; i++) {
        enum { LIMIT = 100000 };
        RtValue values[RT_GRID_PARAM_COUNT];
        uint32_t *n = values[RT_GRID_RESOLUTION].resolution;
        assert_ok(rt_params_parse(rt_grid_params, RT_GRID_PARAM_COUNT, specs[i], "grid", values, error));
        assert_int_equal(build_within("grid", LIMIT, &scene, values, &accel, &refusal), RT_BAD_INPUT);
        const char *remedy = strstr(refusal.message, ": resolution=");
        assert_non_null(remedy);
        assert_int_equal(sscanf(remedy, ": resolution=%ux%ux%u", &n[0], &n[1], &n[2]), 3);
        assert_ok(build_within("grid", LIMIT, &scene, values, &accel, error));
        RtDescription description;
        rt_accel_describe(accel, &description);
        assert_true((description.leaves + description.references + 1) * sizeof(uint32_t) <= LIMIT);
        const uint32_t ids[8] = {0, 1, 2, 3, 4, 5, 6, 7};
        const RtGrid *grid = (const RtGrid *)accel;
        uint64_t exactly = (uint64_t)rt_grid_estimate(grid, &grid->box, n, ids, 8);
        rt_accel_destroy(accel);
        assert_ok(build_within("grid", exactly, &scene, values, &accel, error));
        rt_accel_destroy(accel);
        assert_int_equal(build_within("grid", exactly - 1, &scene, values, &accel, &refusal), RT_BAD_INPUT);
        uint32_t longest = n[0];
        for (int a = 0; a < 3; a++) n[a] += n[a] == longest;
        assert_int_equal(build_within("grid", LIMIT, &scene, values, &accel, &refusal), RT_BAD_INPUT);
    }
}

/* ---- nested grids ---- */

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
        rt_accel_describe(accel, &description);
        assert_true(description.bytes <= limit);
        rt_accel_destroy(accel);
        values[RT_GRID_DEPTH].i = 8;
    }
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

RT_TEST(every_allocation_of_a_build_may_fail) {
    OWNED_SCENE scene = make_lattice(2, 2, 2);
    const char *spec = "grid:resolution=1x1x1,depth=2,density=1,nest=7";
    assert_fails_cleanly(try_accel(&scene, spec, error), (void)0);
}

RT_TEST(a_teapot_in_a_stadium_gains) {
    OWNED_SCENE scene = open_scene("stadium:size=6");
    assert_ok(rt_scene_sample(&scene, 64, 64, 1, false, error));
    double flat = tests_per_ray(&scene, "grid"), nested = tests_per_ray(&scene, "grid:depth=3");
    print_message("tests per ray: %.2f in one grid, %.2f in nested ones\n", flat, nested);
    assert_true(nested < flat / 4);
}

RT_TESTS(grid, NULL, assert_nothing_is_kept)
