/* SPDX-License-Identifier: Apache-2.0 */
/* CSG trees that need large buffers for crossings: they are allocated before the first ray, and a failure is
 * a status, never a miss. */
#include "csg_testing.h"
#include "item_testing.h"

#include "verify/failure.h"
#include "verify/verify.h"

/* A row of balls, and rays along it. */
enum { BALLS = 200, RAYS = 8 };

typedef struct Row {
    RtScene scene;
    RtRay rays[RAYS];
} Row;

static void clear_row(Row *row) {
    rt_scene_clear(&row->scene);
}

static Row make_balls(void) {
    Row row = {.scene = begin_scene()};
    RtScene *scene = &row.scene;
    OWNED_BUILDER b = {0};
    RtCsgTerm balls = ball(&b, rt_vec3(0, 0, 0), 1, 0);
    for (int i = 1; i < BALLS; i++) balls = join(&b, balls, ball(&b, rt_vec3(3 * (float)i, 0, 0), 1, 0));
    assert_ok(rt_scene_add_csg(scene, &b, balls, true, error));
    assert_ok(rt_scene_add_light(scene, rt_vec3(0, 0, 9), rt_vec3(1, 1, 1), error));
    look(scene, rt_vec3(-50, 0, 0), rt_vec3(0, 0, 0));
    scene->camera.fov = 1;
    scene->camera.width = scene->camera.height = RAYS;
    assert_ok(rt_scene_finish(scene, error));
    assert_int_equal(scene->geometry.csgs[0].most_crossings, 4 * BALLS);
    for (int i = 0; i < RAYS; i++) {
        row.rays[i] = ray_along(rt_vec3(-50, 0, 0.25f * (float)i), along_x);
        row.rays[i].kind = RT_RAY_RANDOM;
    }
    return row;
}

static bool meets(const RtScene *scene, const RtRay *ray, float *t) {
    RtPreparedRay prepared;
    rt_hit_ray(&prepared, &scene->geometry, ray, hit_memory_of_tests());
    return rt_object_hit(&scene->geometry, 0, &prepared, t, NULL);
}

/* ---- room ---- */

RT_TEST(the_room_for_hits_is_had_or_it_is_a_status) {
    OWNED(clear_row) Row row = make_balls();
    RtGeometry empty = {0};
    RtHitMemory *hit_memory = hit_memory_of_tests();
    assert_ok(rt_hit_memory_alloc(&empty, &hit_memory, error));
    assert_null(hit_memory);
    rt_alloc_fail_at(1);
    assert_fails_with(rt_hit_memory_alloc(&row.scene.geometry, &hit_memory, error), RT_NO_MEMORY,
                      "the crossings of a ray");
    assert_null(hit_memory);
    /* So many that it is not known how many. */
    row.scene.geometry.csgs[0].most_crossings = UINT32_MAX;
    assert_fails_with(rt_hit_memory_alloc(&row.scene.geometry, &hit_memory, error), RT_NO_MEMORY,
                      "the crossings of a ray");
    assert_null(hit_memory);
}

/* Runs all four kernels, and computes a normal, while no allocation may succeed. */
static void trace_without_memory(const char *spec, Row *row, const RtHit *expected) {
    OWNED_ACCEL RtAccel *accel = open_available(&row->scene, spec, 0);
    OWNED_QUERY query = {0};
    RtHit hits[2][RAYS];
    bool blocked[2][RAYS];
    RtTally tallies[RT_RAY_KIND_COUNT] = {0};
    if (!accel) return;
    assert_ok(rt_accel_learn(accel, row->rays, expected, RAYS, error));
    assert_ok(rt_query_init(&query, accel, error));
    rt_alloc_fail_at(1);
    for (int counted = 0; counted < 2; counted++) {
        rt_query_begin(&query);
        rt_nearest(&query, row->rays, RAYS, hits[counted], counted ? tallies : NULL);
        rt_occluded(&query, row->rays, RAYS, blocked[counted], counted ? tallies : NULL);
    }
    RtHitMemory *hit_memory = rt_query_hit_memory(&query);
    RtNormals normals = rt_object_normals(&row->scene.geometry, 0, &row->rays[0], expected[0].t, hit_memory);
    assert_null(rt_alloc(1, 1)); /* the first one asked for */
    assert_true(normals.geometric.x == -1);
    for (int i = 0; i < RAYS; i++) {
        for (int counted = 0; counted < 2; counted++) {
            bool same = hits[counted][i].object == expected[i].object && hits[counted][i].t == expected[i].t;
            if (!same) fail_msg("%s: ray %d", spec, i);
            assert_int_equal(blocked[counted][i], expected[i].object != RT_NO_OBJECT);
        }
    }
}

RT_TEST(nothing_is_allocated_while_tracing) {
    OWNED(clear_row) Row row = make_balls();
    RtHit expected[RAYS];
    for (int i = 0; i < RAYS; i++) {
        expected[i] = RT_MISS;
        if (meets(&row.scene, &row.rays[i], &expected[i].t)) expected[i].object = 0;
        assert_int_equal(expected[i].object == 0, i < 4);
    }
    for (size_t i = 0; i < rt_accel_count(); i++) {
        char spec[RT_MAX_SPEC_CHARS];
        assert_true(rt_spread_spec(rt_accel_at(i), 0, spec));
        trace_without_memory(spec, &row, expected);
    }
}

/* ---- every allocation that fails ---- */

/* On failure nothing is left behind. */
typedef RtStatus Work(const Row *row, RtError *error);

/* Every failure is RT_NO_MEMORY until all memory is there; one of them is short of `what`. */
static void assert_every_shortage_is_a_status(Work *work, const Row *row, const char *what) {
    int64_t live = rt_alloc_live();
    bool named = false;
    RtStatus status = RT_NO_MEMORY;
    for (uint64_t n = 1; status != RT_OK && n < 10000; n++) {
        RtError error = {RT_OK, ""};
        rt_alloc_fail_at(n);
        status = work(row, &error);
        rt_alloc_fail_at(0);
        named |= strstr(error.message, what) != NULL;
        assert_true(status == RT_OK || status == RT_NO_MEMORY);
        assert_true(rt_alloc_live() == live);
    }
    assert_int_equal(status, RT_OK);
    assert_true(named);
}

static RtStatus trace_frame(const Row *row, RtError *error) {
    OWNED_ACCEL RtAccel *brute;
    RtFrame frame;
    RtFrameOptions options = {.depth = 1, .threads = 1};
    RT_TRY(rt_accel_open("brute", &row->scene, &brute, error));
    RtStatus status = rt_frame_trace(&frame, brute, &options, error);
    for (size_t i = 0; status == RT_OK && i < (size_t)RAYS * RAYS; i++) assert_int_equal(frame.object[i], 0);
    if (status == RT_OK) rt_frame_clear(&frame);
    return status;
}

static RtStatus build_item(const Row *row, RtError *error) {
    OWNED_ACCEL RtAccel *accel;
    RT_TRY(rt_accel_open("item+brute", &row->scene, &accel, error));
    const RtItemBuffer *buffer = (const RtItemBuffer *)accel;
    for (size_t i = 0; i < rt_item_sample_count(buffer); i++) assert_int_equal(buffer->samples[i], 0);
    return accel->ops->validate(accel, error);
}

static RtStatus ask(const Row *row, RtError *error) {
    RtAnswer answer;
    RtFailure failure = {.spec = "item+grid", .rays = row->rays, .count = RAYS, .stream = RAYS};
    RT_TRY(rt_failure_ask(&failure, &row->scene, &answer, error));
    assert_int_equal(answer.expected.object, 0);
    assert_false(answer.wrong);
    return RT_OK;
}

static RtStatus stack_of_overlays(const Row *row, RtError *error) {
    return try_accel(&row->scene, "cache+light+bvh", error);
}

/* Of answers that are not brute's, by the referee: the one is right, the other wrong. */
static RtStatus judge(const Row *row, RtError *error) {
    const RtJudge by = rt_judge(&row->scene.geometry, &row->rays[0], false);
    const RtHit hit = {49, 0};
    RtVerdict verdict;
    RtSide side;
    RT_TRY(rt_verdict_nearest(by, RT_MISS, hit, &verdict, error));
    assert_int_equal(verdict, RT_MARGINAL);
    RT_TRY(rt_verdict_nearest(by, hit, RT_MISS, &verdict, error));
    assert_int_equal(verdict, RT_WRONG);
    RT_TRY(rt_verdict_side(by, RT_MISS, hit, &side, error));
    assert_int_equal(side, RT_SIDE_GOT);
    RT_TRY(rt_verdict_occluded(by, true, false, &verdict, error));
    assert_int_equal(verdict, RT_WRONG);
    return RT_OK;
}

RT_TEST(no_shortage_of_memory_becomes_a_verdict) {
    OWNED(clear_row) Row row = make_balls();
    assert_every_shortage_is_a_status(judge, &row, "exact arithmetic");
}

RT_TEST(no_shortage_of_memory_becomes_a_miss) {
    static const char crossings[] = "the crossings of a ray";
    OWNED(clear_row) Row row = make_balls();
    assert_every_shortage_is_a_status(trace_frame, &row, crossings);
    assert_every_shortage_is_a_status(build_item, &row, crossings);
    assert_every_shortage_is_a_status(ask, &row, crossings);
    assert_every_shortage_is_a_status(stack_of_overlays, &row, crossings);
}

RT_TESTS(csg_memory, NULL, assert_nothing_is_kept)
