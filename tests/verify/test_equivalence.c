/* SPDX-License-Identifier: Apache-2.0 */
/* Equivalence and verdicts: wrong answers are found, in either kernel and in any stream; margins and ties
 * are distinguished from errors. */
#include "equivalence_testing.h"

#include "accel/kernel.h"
#include "measure/measure.h"
#include "render/frame.h"
#include "verify/failure.h"
#include "verify/verify_rays.h"

/* ---- an accelerator that lies ---- */

typedef enum Lie { NO_LIE, T_IN_TIMED, ID_IN_COUNTED, BLOCKED_IN_STREAMS_OF_64, LOST_LAST_RAY } Lie;

typedef struct Liar {
    RtAccel base;
    RtQuery truth; /* asked with the scratch memory of whoever asks the liar */
    Lie lie;
} Liar;

enum { RAYS = 5000, LAST = RAYS - 1 };
static RtRay asked_rays[RAYS];
RT_KERNEL void lie(const RtAccel *accel, const RtScratch *scratch, const RtRay *asked, size_t count,
                   RtHit *hits, uint32_t *occluders, RtTally *tallies, bool any, bool counted) {
    (void)tallies;
    const Liar *liar = (const Liar *)accel;
    const RtAccel *truth = liar->truth.accel;
    rt_trace_stream(truth, scratch, asked, count, hits, occluders, NULL);
    if (any) {
        if (liar->lie == BLOCKED_IN_STREAMS_OF_64 && !counted && count == 64)
            occluders[63] = occluders[63] == RT_NO_OBJECT ? 0 : RT_NO_OBJECT;
        return;
    }
    for (size_t i = 0; i < count; i++) {
        if (liar->lie == T_IN_TIMED && !counted && &asked[i] == &asked_rays[1234])
            hits[i].t = nextafterf(hits[i].t, 0);
        if (liar->lie == LOST_LAST_RAY && !counted && &asked[i] == &asked_rays[LAST]) hits[i] = RT_MISS;
        if (liar->lie == ID_IN_COUNTED && counted && &asked[i] == &asked_rays[77]) hits[i].object ^= 1;
    }
}

RT_DEFINE_STREAM_KERNELS(lie, 0)

static const RtAccelOps liar_ops = {.name = "liar", .bytes = sizeof(Liar), .kernels = &kernels};

typedef struct Stage {
    RtScene scene;
    RtAccel *brute;
    RtReference reference;
    Liar liar;
} Stage;

static int set_up(void **state) {
    static Stage stage;
    stage.scene = open_family(scene_family("uniform"), 3);
    assert_ok(rt_accel_open("brute", &stage.scene, &stage.brute, error));
    assert_ok(rt_query_init(&stage.liar.truth, stage.brute, error));
    rt_ray_family_fill(0, &stage.liar.truth, 3, 0, RAYS, asked_rays);
    /* The rays that are lied about hit something. */
    const size_t needed[] = {77, 1234, LAST};
    for (size_t i = 0; i < 3; i++) {
        RtHit hit = RT_MISS;
        for (uint64_t k = RAYS + 100 * i; hit.object == RT_NO_OBJECT; k++) {
            rt_ray_family_fill(0, &stage.liar.truth, 3, k, 1, &asked_rays[needed[i]]);
            rt_nearest(&stage.liar.truth, &asked_rays[needed[i]], 1, &hit, NULL);
        }
    }
    assert_ok(rt_reference_init(&stage.reference, stage.brute, asked_rays, RAYS, 0, error));
    stage.liar.base = *stage.brute;
    stage.liar.base.ops = &liar_ops;
    stage.liar.base.kernels = &kernels;
    *state = &stage;
    return 0;
}

static int tear_down(void **state) {
    Stage *stage = *state;
    rt_query_clear(&stage->liar.truth);
    rt_reference_clear(&stage->reference);
    rt_accel_destroy(stage->brute);
    rt_scene_clear(&stage->scene);
    return rt_alloc_live() == 0 ? 0 : -1;
}

static RtEquivalence check(Stage *stage, Lie lie) {
    RtEquivalence one, many;
    stage->liar.lie = lie;
    assert_ok(rt_equivalence_check(&stage->reference, &stage->liar.base, 1, &one, error));
    assert_ok(rt_equivalence_check(&stage->reference, &stage->liar.base, 3, &many, error));
    assert_int_equal(one.rays, RAYS);
    assert_memory_equal(one.verdicts, many.verdicts, sizeof one.verdicts);
    assert_int_equal(one.occluded_wrong, many.occluded_wrong);
    assert_int_equal(one.first_wrong.index, many.first_wrong.index);
    return one;
}

RT_TEST(the_truth_is_equal_throughout) {
    RtEquivalence e = check(*state, NO_LIE);
    assert_int_equal(e.verdicts[RT_EQUAL], RAYS);
    assert_int_equal(e.occluded_wrong, 0);
    assert_false(e.any_wrong);
}

RT_TEST(one_ulp_of_t_another_object_and_a_lie_in_streams_of_one_length_are_found_where_they_are) {
    RtEquivalence e = check(*state, T_IN_TIMED);
    assert_int_equal(e.verdicts[RT_WRONG], 1);
    assert_int_equal(e.first_wrong.index, 1234);
    assert_false(e.first_wrong.counted || e.first_wrong.occluded);
    assert_true(e.first_wrong.got.t < e.first_wrong.expected.t);
    e = check(*state, ID_IN_COUNTED);
    assert_int_equal(e.verdicts[RT_WRONG], 1);
    assert_int_equal(e.first_wrong.index, 77);
    assert_true(e.first_wrong.counted);
    e = check(*state, BLOCKED_IN_STREAMS_OF_64);
    assert_int_equal(e.verdicts[RT_WRONG], 0);
    assert_true(e.occluded_wrong > 0 && e.any_wrong && e.first_wrong.occluded);
    assert_int_equal(e.first_wrong.stream, 64);
}

RT_TEST(the_last_ray_counts_too) {
    RtEquivalence e = check(*state, LOST_LAST_RAY);
    assert_int_equal(e.verdicts[RT_WRONG], 1);
    assert_int_equal(e.first_wrong.index, LAST);
    char text[512];
    rt_wrong_answer_format(&e.first_wrong, text, sizeof text);
    assert_non_null(strstr(text, "got no hit"));
    json_auto_t *row = rt_equivalence_json(&e, "s", "a", "brute");
    assert_int_equal(json_integer_value(json_object_get(row, "wrong")), 1);
    json_t *wrong = json_object_get(row, "first_wrong");
    const char *x = json_string_value(json_array_get(json_object_get(wrong, "org"), 0));
    assert_true(strtof(x, NULL) == asked_rays[LAST].org.x);
}

RT_TEST(an_accelerator_that_is_not_exact_is_judged_by_verdicts) {
    Stage *stage = *state;
    stage->liar.base.exact = false;
    RtEquivalence e = check(stage, T_IN_TIMED);
    assert_int_equal(e.verdicts[RT_EQUAL], RAYS);
    e = check(stage, LOST_LAST_RAY);
    assert_int_equal(e.verdicts[RT_WRONG], 1);
    stage->liar.base.exact = true;
}

/* ---- recorded answers ---- */

/* The reference's own answers, by name, or by t alone. */
static void record(const Stage *stage, RtHit *hits, bool named) {
    memcpy(hits, stage->reference.hits, RAYS * sizeof *hits);
    for (size_t i = 0; i < RAYS && !named; i++)
        if (hits[i].object != RT_NO_OBJECT) hits[i].object = RT_UNNAMED_OBJECT;
}

static RtEquivalence judge(const Stage *stage, const RtHit *hits) {
    RtEquivalence one, many;
    memset(stage->reference.differs, 0, RAYS * sizeof(bool));
    assert_ok(rt_equivalence_judge(&stage->reference, hits, 1, &one, error));
    assert_ok(rt_equivalence_judge(&stage->reference, hits, 3, &many, error));
    assert_int_equal(one.rays, RAYS);
    assert_memory_equal(one.verdicts, many.verdicts, sizeof one.verdicts);
    assert_memory_equal(one.faults, many.faults, sizeof one.faults);
    assert_int_equal(one.first_wrong.index, many.first_wrong.index);
    uint64_t wrong = 0;
    for (size_t i = 0; i < RAYS; i++) wrong += stage->reference.differs[i];
    assert_int_equal(wrong, one.verdicts[RT_WRONG]);
    return one;
}

RT_TEST(recorded_answers_are_equal_if_rounding_explains_them_with_or_without_an_object) {
    static RtHit hits[RAYS];
    for (int named = 0; named < 2; named++) {
        record(*state, hits, named);
        assert_int_equal(judge(*state, hits).verdicts[RT_EQUAL], RAYS);
        hits[LAST].t = nextafterf(hits[LAST].t, INFINITY);
        const RtEquivalence e = judge(*state, hits);
        assert_int_equal(e.verdicts[RT_EQUAL], RAYS);
        assert_true(0x1p-25 < e.largest_off && e.largest_off <= 0x1p-23);
    }
}

RT_TEST(recorded_answers_that_are_wrong_are_found_with_their_faults) {
    static RtHit hits[RAYS];
    const Stage *stage = *state;
    size_t miss = 0;
    while (stage->reference.hits[miss].object != RT_NO_OBJECT) miss++;
    for (int named = 0; named < 2; named++) {
        record(stage, hits, named);
        hits[77] = RT_MISS;
        hits[1234].t *= 0.9f;
        hits[miss] = (RtHit){1e6f, named ? 0 : RT_UNNAMED_OBJECT};
        const RtEquivalence e = judge(stage, hits);
        assert_int_equal(e.verdicts[RT_WRONG], 3);
        assert_int_equal(e.verdicts[RT_EQUAL], RAYS - 3);
        assert_int_equal(e.faults[RT_FAULT_LOST], 1);
        assert_int_equal(e.faults[RT_FAULT_DISPLACED], 1);
        assert_int_equal(e.faults[RT_FAULT_BESIDE], 1);
        assert_int_equal(e.sides[RT_SIDE_EXPECTED], 3);
        assert_int_equal(e.missed, 1);
        assert_int_equal(e.first_wrong.index, miss < 77 ? miss : 77);
        assert_true(stage->reference.differs[77] && stage->reference.differs[1234]);
    }
}

/* A t alone is that of any object that is there. */
RT_TEST(a_recorded_t_behind_the_nearest_object_is_wrong_without_a_name_too) {
    static RtHit hits[RAYS];
    const Stage *stage = *state;
    size_t checked = 0;
    OWNED_QUERY query = open_query(stage->brute);
    record(stage, hits, false);
    for (size_t i = 0; i < RAYS; i++) {
        RtHit behind;
        RtRay ray = asked_rays[i];
        if (hits[i].object == RT_NO_OBJECT) continue;
        ray.tmin = hits[i].t * 1.01f + 0.01f;
        rt_nearest(&query, &ray, 1, &behind, NULL);
        if (behind.object == RT_NO_OBJECT || behind.object == stage->reference.hits[i].object) continue;
        hits[i].t = behind.t;
        checked++;
    }
    const RtEquivalence e = judge(stage, hits);
    assert_true(checked > 50);
    assert_in_range(e.faults[RT_FAULT_BEHIND], checked * 9 / 10, checked);
    assert_in_range(e.verdicts[RT_EQUAL] + e.faults[RT_FAULT_BEHIND], RAYS * 99 / 100, RAYS);
}

RT_TEST(the_objects_near_a_wrong_ray_answer_it_like_the_whole_scene) {
    const char *path = RT_BINARY_DIR "/test_near.yaml";
    const Stage *stage = *state;
    const size_t indices[] = {77, 1234, LAST};
    for (size_t i = 0; i < 3; i++) {
        const RtHit expected = stage->reference.hits[indices[i]];
        const uint32_t other = expected.object ^ 1;
        const RtWrongAnswer wrong = {.ray = asked_rays[indices[i]], .expected = expected, .got = {1, other}};
        uint32_t count;
        RtHit hit;
        assert_ok(rt_near_save(&stage->scene, &wrong, path, &count, error));
        OWNED_SCENE scene = open_scene(path);
        OWNED_ACCEL RtAccel *brute = open_accel(&scene, "brute");
        OWNED_QUERY query = open_query(brute);
        rt_nearest(&query, &wrong.ray, 1, &hit, NULL);
        assert_memory_equal(&hit.t, &expected.t, sizeof hit.t);
        assert_int_equal(scene.geometry.object_count, count);
        assert_in_range(count, 2, stage->scene.geometry.object_count / 2);
    }
    unlink(path);
}

/* ---- what goes wrong beneath the kernels ---- */

static RtStatus check_of_liar(const RtAccel *accel, RtError *error) {
    (void)accel;
    return rt_fail(error, RT_NO_MEMORY, "went wrong while tracing");
}

#define assert_went_wrong(expr) assert_fails_at(expr, RT_NO_MEMORY, "went wrong while tracing", "")

RT_TEST(what_goes_wrong_while_tracing_is_a_status_of_all_who_trace) {
    Stage *stage = *state;
    static RtAccelOps unlucky; /* answers like brute, and then says that this was luck */
    unlucky = *stage->brute->ops;
    unlucky.name = "unlucky";
    unlucky.check = check_of_liar;
    assert_ok(rt_accel_register(&unlucky, error));
    OWNED_ACCEL RtAccel *accel = open_accel(&stage->scene, "unlucky");
    RtEquivalence equivalence;
    RtReference reference;
    RtAnswer reply;
    RtFrame frame;
    RtCount count;
    static RtHit hits[RAYS];
    static RtRay more[64];
    const RtRaySet set = {.kind = RT_RAY_RANDOM, .count = RAYS, .rays = asked_rays};
    const RtFailure question = {.spec = "unlucky", .rays = asked_rays, .count = 1, .stream = 1};
    const RtVerifyRays wanted = {.count = 64, .seed = 1, .threads = 1};
    const RtFrameOptions options = {.depth = 1, .threads = 1};
    double seconds, wall;
    RtTimed timed = {.accel = accel, .set = &set, .seconds = &seconds, .wall = &wall};
    const RtTiming timing = {.rounds = {.rounds = 1, .most = 1}, .threads = 1};
    uint32_t done;
    assert_went_wrong(rt_equivalence_check(&stage->reference, accel, 1, &equivalence, error));
    assert_went_wrong(rt_reference_init(&reference, accel, asked_rays, RAYS, 1, error));
    assert_went_wrong(rt_failure_ask(&question, &stage->scene, &reply, error));
    assert_went_wrong(rt_frame_trace(&frame, accel, &options, error));
    assert_went_wrong(rt_measure_answers(accel, &set, 1, hits, error));
    assert_went_wrong(rt_measure_count(accel, &set, stage->reference.hits, 1, &count, error));
    assert_went_wrong(rt_measure_time(&timed, 1, &timing, &done, error));
    assert_went_wrong(rt_verify_rays(&wanted, accel, more, error));
}

/* ---- verdicts ---- */

/* 0, 1: coincident unit spheres about the origin; 2, 3: the halves of the square |x|, |y| <= 1 at z = -5, cut
 * along x = y; 4: a wall at z = -9. */
static void make_geometry(RtGeometry *g) {
    *g = (RtGeometry){0};
    const RtVec3 a[3] = {{-1, -1, -5}, {1, -1, -5}, {1, 1, -5}},
                 b[3] = {{-1, -1, -5}, {1, 1, -5}, {-1, 1, -5}};
    const RtVec3 wall[4] = {{-9, -9, -9}, {9, -9, -9}, {9, 9, -9}, {-9, 9, -9}};
    assert_ok(rt_geometry_add_sphere(g, rt_vec3(0, 0, 0), 1, error));
    assert_ok(rt_geometry_add_sphere(g, rt_vec3(0, 0, 0), 1, error));
    assert_ok(rt_geometry_add_triangle(g, a, NULL, error));
    assert_ok(rt_geometry_add_triangle(g, b, NULL, error));
    assert_ok(rt_geometry_add_polygon(g, wall, 4, error));
    assert_ok(rt_geometry_finish(g, error));
}

static RtRay down_from(float x, float y, float z) {
    return (RtRay){.org = {{x, y, z}}, .dir = {{0, 0, -1}}, .tmax = INFINITY, .kind = RT_RAY_RANDOM};
}

typedef struct Case {
    const char *what;
    RtRay ray;
    RtHit expected, answer;
    RtVerdict verdict;
} Case;

RT_TEST(verdicts_tell_ties_and_margins_from_errors) {
    OWNED_GEOMETRY g;
    make_geometry(&g);
    RtRay center = down_from(0, 0, 3), above_edge = down_from(0.5f, 0.5f, -2), inner = down_from(0.5f, 0, -2);
    RtRay tangent = down_from(1, 0, 3), beside = down_from(1.5f, 0, 3), far = down_from(20, 0, 3);
    RtRay from_surface = down_from(0, 0, 1);
    const Case cases[] = {
        {"the same", center, {2, 0}, {2, 0}, RT_EQUAL},
        {"an ulp beside", center, {2, 0}, {2.0000002f, 0}, RT_EQUAL},
        {"a hundredth beside", center, {2, 0}, {2.01f, 0}, RT_WRONG},
        {"the coincident sphere", center, {2, 0}, {2, 1}, RT_TIE},
        {"its far side", center, {2, 0}, {4, 0}, RT_WRONG},
        {"what lies behind it", center, {2, 0}, {8, 2}, RT_WRONG},
        {"nothing, where there is much", center, {2, 0}, RT_MISS, RT_WRONG},
        {"no such object", center, {2, 0}, {2, 99}, RT_WRONG},
        {"t is not a number", center, {2, 0}, {NAN, 0}, RT_WRONG},
        {"a touched sphere, passed by", tangent, {3, 0}, {8, 2}, RT_MARGINAL},
        {"a touched sphere, passed by to the wall", tangent, {3, 0}, {12, 4}, RT_MARGINAL},
        {"the other triangle of an edge", above_edge, {3, 2}, {3, 3}, RT_TIE},
        {"through the edge, to the wall", above_edge, {3, 2}, {7, 4}, RT_MARGINAL},
        {"through a triangle, to the wall", inner, {3, 2}, {7, 4}, RT_WRONG},
        {"a sphere clear of the ray", beside, {12, 4}, {3, 0}, RT_WRONG},
        {"nothing, twice", far, RT_MISS, RT_MISS, RT_EQUAL},
        {"a hit from nowhere", far, RT_MISS, {12, 4}, RT_WRONG},
        {"from the surface: its t = 0, not seen", from_surface, {0, 0}, {2, 0}, RT_MARGINAL},
        {"from the surface: a hit within", from_surface, {0, 0}, {1, 0}, RT_WRONG},
    };
    size_t wrong = 0;
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        const Case *c = &cases[i];
        RtVerdict got;
        assert_ok(rt_verdict_nearest(rt_judge(&g, &c->ray, false), c->expected, c->answer, &got, error));
        if (got == c->verdict) continue;
        print_error("%s: %s instead of %s\n", c->what, rt_verdict_name(got), rt_verdict_name(c->verdict));
        wrong++;
    }
    assert_int_equal(wrong, 0);
}

static void assert_occluded(const RtGeometry *g, const RtRay *ray, bool expected, bool answer,
                            RtVerdict verdict) {
    RtVerdict got;
    assert_ok(rt_verdict_occluded(rt_judge(g, ray, false), expected, answer, &got, error));
    assert_int_equal(got, verdict);
}

RT_TEST(occlusion_is_marginal_only_where_a_hit_is) {
    OWNED_GEOMETRY g;
    make_geometry(&g);
    RtRay up = down_from(0.5f, 0, -2), ends_before = up, ends_at = up;
    ends_before.tmax = 2.9f;
    ends_at.tmax = 3;
    assert_occluded(&g, &up, true, true, RT_EQUAL);
    assert_occluded(&g, &up, true, false, RT_WRONG);
    assert_occluded(&g, &ends_before, false, true, RT_WRONG);
    assert_occluded(&g, &ends_at, true, false, RT_MARGINAL);
}

RT_TESTS(equivalence, set_up, tear_down)
