/* SPDX-License-Identifier: Apache-2.0 */
/* accel/grid: invariants, each broken on purpose, rules of resolution, and limits. */
#include "accel_testing.h"

#include "accel/grid/grid.h"

static void assert_resolution(const RtScene *scene, const char *spec, uint32_t x, uint32_t y, uint32_t z) {
    OWNED_ACCEL RtGrid *grid = open_valid(scene, spec);
    const RtGridBlock *block = grid->levels[0].blocks;
    if (block->n[0] != x || block->n[1] != y || block->n[2] != z)
        fail_msg("%s gave %ux%ux%u", spec, block->n[0], block->n[1], block->n[2]);
    assert_ok(rt_grid_validate(&grid->base, error));
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
    rt_grid_describe(&grid->base, &description);
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
    assert_ok(rt_grid_validate(accel, error));

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
        rt_grid_describe(&grid->base, &own);
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
        rt_grid_describe(accel, &description);
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

RT_TEST(without_memory_for_voxels_it_says_how_much_they_take) {
    OWNED_SCENE scene = make_lattice(2, 2, 2);
    RtError failure = {RT_OK, ""};
    for (uint64_t n = 1; !strstr(failure.message, "the voxels of a grid"); n++) {
        RtAccel *accel;
        rt_alloc_fail_at(n);
        RtStatus status = rt_accel_open("grid:resolution=2x2x2", &scene, &accel, &failure);
        rt_alloc_fail_at(0);
        assert_int_equal(status, RT_NO_MEMORY);
    }
    assert_non_null(strstr(failure.message, ": 36 bytes for")); /* eight voxels, and the end */
}

RT_TESTS(grid, NULL, NULL)
