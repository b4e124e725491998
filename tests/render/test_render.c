/* SPDX-License-Identifier: Apache-2.0 */
/* render/frame.h: the depth of rays, counts, progress, and failures; the same bytes on any number of
 * threads. */
#include "accel_testing.h"
#include "render_testing.h"

RT_TEST(two_mirrors_return_a_ray_as_often_as_the_depth_allows) {
    OWNED_SCENE scene =
        start_scene((RtMaterial){.color = {1, 1, 1}, .ambient = 1, .reflection = 0.5f, .ior = 1});
    add_square(&scene, 1000, 0);
    add_square(&scene, 1000, 20);
    assert_ok(rt_scene_finish(&scene, error));
    const uint32_t depths[] = {1, 2, 5, RT_MAX_DEPTH};
    for (size_t i = 0; i < sizeof depths / sizeof depths[0]; i++) {
        RtFrameOptions options = options_for(&scene, 1, 1, false);
        options.depth = depths[i];
        options.counted = true;
        OWNED_FRAME frame = trace(&scene, &options);
        assert_int_equal(frame.tallies[RT_RAY_PRIMARY].rays, 1);
        assert_int_equal(frame.tallies[RT_RAY_REFLECTION].rays, depths[i] - 1);
        /* 1 + 1/2 + 1/4 + ... */
        assert_near(frame.color[0].x, 2 - pow(0.5, depths[i] - 1), 1e-5);
    }
}

static void assert_same_frames(const RtFrame *a, const RtFrame *b) {
    size_t samples = (size_t)a->sampling.columns * a->sampling.rows;
    assert_memory_equal(a->color, b->color, samples * sizeof *a->color);
    assert_memory_equal(a->object, b->object, samples * sizeof *a->object);
    assert_memory_equal(a->depth, b->depth, samples * sizeof *a->depth);
    if (!a->cost || !b->cost) return;
    assert_memory_equal(a->cost, b->cost, samples * sizeof *a->cost);
    assert_memory_equal(a->tallies, b->tallies, sizeof a->tallies);
}

RT_TEST(a_frame_is_the_same_bytes_on_any_number_of_threads_counted_or_timed) {
    OWNED_SCENE scene = busy_scene();
    RtFrameOptions options = options_for(&scene, 70, 41, false);
    options.depth = 7; /* streams above 1024 rays are cut */
    options.counted = true;
    OWNED_FRAME one = trace(&scene, &options);
    assert_true(one.tallies[RT_RAY_TRANSMISSION].rays > 2 * one.tallies[RT_RAY_PRIMARY].rays);
    for (int threads = 1; threads <= 3; threads++) {
        for (int counted = 0; counted < 2; counted++) {
            options.threads = threads;
            options.counted = counted == 1;
            OWNED_FRAME other = trace(&scene, &options);
            assert_same_frames(&one, &other);
        }
    }
}

RT_TEST(what_the_samples_cost_adds_up_to_the_tallies_by_kind) {
    OWNED_SCENE scene = busy_scene();
    RtFrameOptions options = options_for(&scene, 20, 20, false);
    options.counted = true;
    OWNED_FRAME frame = trace(&scene, &options);
    RtTally by_sample = {0}, by_kind = {0};
    for (size_t i = 0; i < 400; i++) rt_tally_add(&by_sample, &frame.cost[i]);
    for (int kind = 0; kind < RT_RAY_KIND_COUNT; kind++) rt_tally_add(&by_kind, &frame.tallies[kind]);
    assert_memory_equal(&by_sample, &by_kind, sizeof by_kind);
    /* brute tests every object for every ray, until a shadow ray is blocked */
    const RtTally *primary = &frame.tallies[RT_RAY_PRIMARY];
    assert_int_equal(primary->rays, 400);
    assert_int_equal(primary->object_tests, primary->rays * scene.geometry.object_count);
}

RT_TEST(corner_sampling_traces_one_more_ray_than_pixels_a_side) {
    OWNED_SCENE scene = busy_scene();
    RtFrameOptions options = options_for(&scene, 32, 16, true);
    options.counted = true;
    options.depth = 1;
    OWNED_FRAME frame = trace(&scene, &options);
    assert_int_equal(frame.tallies[RT_RAY_PRIMARY].rays, 33 * 17);
}

RT_TEST(a_frame_keeps_every_ray_that_is_counted) {
    uint64_t invalid = 0, others = 0;
    OWNED_SCENE scene = busy_scene();
    RtFrameOptions options = options_for(&scene, 40, 40, false);
    options.counted = true;
    options.threads = 2;
    options.keep_rays = true;
    OWNED_FRAME frame = trace(&scene, &options);
    for (int kind = 0; kind < RT_RAY_KIND_COUNT; kind++) {
        assert_int_equal(frame.ray_count[kind], frame.tallies[kind].rays);
        for (uint64_t i = 0; i < frame.ray_count[kind]; i++) {
            invalid += !rt_ray_is_valid(&frame.rays[kind][i]);
            others += frame.rays[kind][i].kind != (uint32_t)kind;
        }
    }
    assert_int_equal(invalid + others, 0);
    assert_true(frame.ray_count[RT_RAY_SHADOW] > 0 && frame.ray_count[RT_RAY_REFLECTION] > 0);
}

RT_TEST(a_frame_without_memory_is_a_status_and_leaks_nothing) {
    OWNED_SCENE scene = busy_scene();
    OWNED_ACCEL RtAccel *accel = open_accel(&scene, "brute");
    RtFrameOptions options = options_for(&scene, 4, 4, false);
    options.counted = true;
    options.keep_rays = true;
    RtFrame frame;
    assert_fails_cleanly(rt_frame_trace(&frame, accel, &options, error), rt_frame_clear(&frame));
}

/* ---- the order of tiles: every sample of a frame once, in blocks of neighbours ---- */

static const RtSampling samplings[] = {
    {.columns = 1, .rows = 1},    {.columns = 16, .rows = 16}, {.columns = 50, .rows = 37},
    {.columns = 300, .rows = 17}, {.columns = 5, .rows = 700}, {.columns = 104, .rows = 72},
};

/* Asserts that tile after tile has each sample of the frame once, and gives how many samples come before the
 * first block of 64 that is not one of 8 x 8. */
static uint32_t walk(const RtSampling *s) {
    size_t tiles = rt_tile_count(s), samples = (size_t)s->columns * s->rows;
    OWNED_MEMORY RtSample *tile = rt_alloc(tiles, sizeof(RtSample));
    OWNED_MEMORY bool *seen = rt_alloc(samples, sizeof(bool));
    uint32_t count = 0, whole = UINT32_MAX;
    RtSample first = {0, 0};
    assert_true(tile && seen);
    rt_tiles_in_order(s, tile);
    const size_t each = (size_t)RT_TILE * RT_TILE;
    for (size_t i = 0; i < tiles * each; i++) {
        RtSample at = rt_tile_sample(tile[i / each], (uint32_t)(i % each));
        if (at.column >= s->columns || at.row >= s->rows) continue;
        size_t k = (size_t)at.row * s->columns + at.column;
        assert_false(seen[k]);
        seen[k] = true;
        if (count % RT_TILE_BLOCK == 0) first = at;
        bool inside = first.column % 8 == 0 && first.row % 8 == 0 && at.column - first.column < 8 &&
                      at.row - first.row < 8;
        if (!inside && whole == UINT32_MAX) whole = count - count % RT_TILE_BLOCK;
        count++;
    }
    assert_int_equal(count, samples);
    return whole < count ? whole : count - count % RT_TILE_BLOCK;
}

RT_TEST(every_sample_comes_once_and_whole_blocks_come_first) {
    const uint32_t whole[] = {0, 256, 3 * 2 * 256, 18 * 256, 0, 104 * 72};
    for (size_t i = 0; i < sizeof samplings / sizeof samplings[0]; i++)
        assert_int_equal(walk(&samplings[i]), whole[i]);
}

/* Morton codes: column and row take turns, from the lowest bit on. */
RT_TEST(samples_of_a_tile_follow_the_z_order_curve) {
    const RtSample expected[] = {{32, 48}, {33, 48}, {32, 49}, {33, 49},
                                 {34, 48}, {35, 48}, {34, 49}, {35, 49}};
    for (uint32_t i = 0; i < 8; i++) {
        RtSample at = rt_tile_sample((RtSample){32, 48}, i);
        assert_int_equal(at.column, expected[i].column);
        assert_int_equal(at.row, expected[i].row);
    }
    RtSample last = rt_tile_sample((RtSample){0, 0}, RT_TILE * RT_TILE - 1);
    assert_true(last.column == RT_TILE - 1 && last.row == RT_TILE - 1);
}

RT_TESTS(render, NULL, NULL)
