/* SPDX-License-Identifier: Apache-2.0 */
/* accel/embree. mode=user is brute bit for bit, by every query, instruction set and quality, in scenes of
 * every family; mode=native agrees with brute except at edges, where a difference is a margin, also in
 * instances. Skipped without Embree. */
#include "crossings_testing.h"
#include "equivalence_testing.h"
#include "instances_testing.h"

#include "verify/failure.h"

#ifdef RT_WITH_EMBREE
#include "accel/embree/embree.h"

/* Whether this processor and this Embree support the spec: Embree 4 has no streams. Any other refusal fails
 * the test. */
static bool embree_has(const char *text) {
    RtSpec spec;
    RtError why = {RT_OK, ""};
    assert_ok(rt_spec_parse(text, &spec, error));
    if (rt_spec_available(&spec, &why) == RT_OK) return true;
    char isa[16] = "?", missing[32];
    const char *at = strstr(text, "isa=");
    if (at) sscanf(at, "isa=%15[^,]", isa);
    snprintf(missing, sizeof missing, "has no %s;", isa);
    bool lacks_streams = strstr(text, "query=stream") && strstr(why.message, "Embree 4 has no streams;");
    if (!lacks_streams && !strstr(why.message, missing)) fail_msg("%s is refused: %s", text, why.message);
    return false;
}

/* ---- mode=user ---- */

/* All rays in one stream, which fills no last packet. */
static void assert_brute(const FamilyBench *bench, const char *spec, bool counted) {
    RtTally tallies[RT_RAY_KIND_COUNT] = {{0}};
    const RtReference *right = &bench->reference;
    OWNED_MEMORY RtHit *hits = rt_alloc(right->count, sizeof *hits);
    OWNED_MEMORY bool *blocked = rt_alloc(right->count, sizeof *blocked);
    OWNED_ACCEL RtAccel *accel = open_valid(&bench->scene, spec);
    OWNED_QUERY query = open_query(accel);
    rt_nearest(&query, right->rays, right->count, hits, counted ? tallies : NULL);
    rt_occluded(&query, right->rays, right->count, blocked, counted ? tallies : NULL);
    for (size_t i = 0; i < right->count; i++) {
        char text[RT_RAY_TEXT];
        const RtHit hit = right->hits[i];
        if (memcmp(&hits[i], &hit, sizeof hit) == 0 && blocked[i] == (hit.object != RT_NO_OBJECT)) continue;
        rt_ray_format(&right->rays[i], text, sizeof text);
        fail_msg("%s on %s: object %u at %a, blocked %d, not %u at %a, by the ray %s", spec,
                 bench->scene.name, hits[i].object, (double)hits[i].t, blocked[i], hit.object, (double)hit.t,
                 text);
    }
}

/* Of 120 combinations each scene tests 24; an instruction set that the machine lacks is refused. Rays of
 * every family: denormal t, ends at hits, any length, from far away. */
RT_TEST(user_mode_is_brute_bit_for_bit_by_every_query_isa_and_quality_in_every_family_of_scenes) {
    static const char *const isas[] = {"sse2", "sse4.2", "avx", "avx2", "avx512"};
    static const char *const qualities[] = {"low", "medium", "high"};
    static const char *const queries[] = {"1", "8", "16", "stream"};
    for (size_t family = 0; family < rt_family_count(); family++) {
        OWNED_BENCH bench;
        set_up_family(&bench, family, 1, 37);
        for (size_t i = family % 5; i < 120; i += 5) {
            char spec[RT_MAX_SPEC_CHARS];
            snprintf(spec, sizeof spec, "embree:mode=user,isa=%s,quality=%s,query=%s,robust=%s",
                     isas[(i / 5 + family) % 5], qualities[i / 5 % 3], queries[i / 15 % 4],
                     i < 60 ? "on" : "off");
            if (embree_has(spec)) assert_brute(&bench, spec, i % 2);
        }
    }
}

static void count_tests(const FamilyBench *bench, const char *spec, RtTally *tally) {
    RtTally tallies[RT_RAY_KIND_COUNT] = {{0}};
    OWNED_ACCEL RtAccel *accel = open_accel(&bench->scene, spec);
    OWNED_QUERY query = open_query(accel);
    for (size_t i = 0; i < bench->reference.count; i++) {
        RtHit hit;
        rt_nearest(&query, &bench->rays[i], 1, &hit, tallies);
    }
    for (size_t kind = 0; kind < RT_RAY_KIND_COUNT; kind++) rt_tally_add(tally, &tallies[kind]);
}

RT_TEST(user_mode_counts_tests_where_it_is_asked_to) {
    OWNED_BENCH bench;
    RtTally brute = {0}, user = {0};
    set_up_family(&bench, scene_family("mixed"), 1, 100);
    count_tests(&bench, "brute", &brute);
    count_tests(&bench, "embree:mode=user", &user);
    assert_int_equal(user.rays, bench.reference.count);
    assert_int_equal(user.hits, brute.hits);
    assert_true(user.object_tests >= user.object_hits && user.object_hits >= user.hits);
    assert_true(user.object_tests < brute.object_tests);
}

static RtScene sphere_at(float x, float radius, float distance) {
    RtScene scene = begin_scene();
    assert_ok(rt_scene_add_sphere(&scene, 0, rt_vec3(x, 0, 0), radius, error));
    scene.camera.from = rt_vec3(x, 0, distance);
    scene.camera.at = rt_vec3(x, 0, 0);
    assert_ok(rt_scene_finish(&scene, error));
    return scene;
}

/* A sphere of radius 1, at 0 and far off: twice the thickness of a ray from 8 away, which is four times the
 * size, and 2^-21 of the largest coordinate. With 15/16 of either this fails. */
RT_TEST(boxes_of_user_geometry_grow_by_their_bound) {
    for (int far = 0; far < 2; far++) {
        const float x = far ? 0x1p16f : 0;
        OWNED_SCENE scene = sphere_at(x, 1, 2);
        OWNED_ACCEL RtEmbree *embree = open_accel(&scene, "embree:mode=user");
        double thick = 0x1p-20 * 8, rounding = 0x1p-21 * ((double)x + 1), least = far ? 31.0 / 32 : 1;
        assert_true((double)embree->growth >= 2 * thick + least * rounding);
        assert_true((double)embree->growth <= 2 * thick + 33.0 / 32 * rounding);
        assert_true((double)embree->max_thickness > 31.0 / 32 * thick);
        assert_true((double)embree->max_thickness <= thick);
    }
}

/* What remains for a scene that is hardly more than a point. */
RT_TEST(boxes_of_user_geometry_grow_even_among_the_least_numbers) {
    OWNED_SCENE scene = sphere_at(0, 0x1p-130f, 0x1p-120f);
    OWNED_ACCEL RtEmbree *embree = open_accel(&scene, "embree:mode=user");
    assert_true((double)embree->growth >= 31.0 / 32 * 0x1p-100);
}

RT_TEST(the_first_error_that_embree_reports_is_told_after_tracing) {
    OWNED_SCENE_OF(scene, sphere, rt_vec3(0, 0, 0), 1);
    OWNED_ACCEL RtAccel *accel = open_accel(&scene, "cache+embree:mode=user");
    RTCScene empty = rtcNewScene(((const RtEmbree *)accel->below)->device->device);
    assert_ok(rt_accel_check(accel, error));
    rtcAttachGeometry(empty, NULL);
    assert_fails_with(rt_accel_check(accel, error), RT_MISMATCH, "invalid argument");
    rtcReleaseScene(empty);
}

/* At 1.5, 2^-20 is 12 units in the last place. */
RT_TEST(searches_go_on_beyond_a_hit_by_their_bound) {
    assert_true((double)rt_embree_limit(1.5f, 1) == 1.5 + 12 * 0x1p-23);
    assert_true((double)rt_embree_limit(0, 1) == (double)FLT_MIN);
}

/* ---- mode=native ---- */

/* At most one of so many is. */
static void assert_hardly_wrong(const RtReference *right, RtAccel *accel, const char *spec, uint64_t many) {
    RtEquivalence result = {0};
    assert_ok(rt_equivalence_check(right, accel, 2, &result, error));
    const uint64_t wrong = result.verdicts[RT_WRONG] + result.occluded_wrong;
    if (wrong > result.rays / many)
        fail_msg("%s on %s: %llu of %llu wrong", spec, right->scene->name, (unsigned long long)wrong,
                 (unsigned long long)result.rays);
}

/* Embree asserts its assumptions, and aborts if one fails. It may be wrong at edges: 2 % of rays of all
 * families, and 0.2 % of ordinary ones. */
RT_TEST(native_mode_takes_every_ray_and_agrees_with_brute_on_every_shape) {
    enum { CHORDS = 500 };
    static const char *const specs[] = {"embree",
                                        "embree:query=8",
                                        "embree:query=16",
                                        "embree:query=stream",
                                        "embree:robust=on",
                                        "embree:query=8,robust=on",
                                        "embree:isa=sse2",
                                        "embree:query=stream,isa=avx",
                                        "embree:quality=high",
                                        "embree:quality=low"};
    static const char *const scenes[] = {"random:n=500,shape=triangle",   "random:n=300,shape=sphere",
                                         "random:n=300,shape=mixed",      "csg-field:n=30",
                                         "family:kind=duplicates,seed=1", "random:n=0"};
    for (size_t i = 0; i < sizeof scenes / sizeof scenes[0]; i++) {
        OWNED_BENCH bench;
        RtReference chords;
        bench.scene = open_scene(scenes[i]);
        set_up_rays(&bench, 5, CHORDS);
        assert_ok(
            rt_reference_init(&chords, bench.brute, bench.rays, CHORDS, 0, error)); /* the first family */
        for (size_t s = 0; s < sizeof specs / sizeof specs[0]; s++) {
            if (!embree_has(specs[s])) continue;
            OWNED_ACCEL RtAccel *accel = open_valid(&bench.scene, specs[s]);
            assert_hardly_wrong(&bench.reference, accel, specs[s], 50);
            assert_hardly_wrong(&chords, accel, specs[s], 500);
        }
        rt_reference_clear(&chords);
    }
}

/* ---- answers that verify found ---- */

static void ask_native(const char *scene_spec, const char *spec, RtRay ray, RtAnswer *answer) {
    OWNED_SCENE scene = open_scene(scene_spec);
    RtFailure failure = {.spec = spec, .rays = &ray, .count = 1, .stream = 1};
    failure.occluded = ray.kind == RT_RAY_OCCLUSION;
    assert_ok(rt_failure_ask(&failure, &scene, answer, error));
}

/* Margins, but for the needle: a fault that tests/verify/faults.tsv lists. */
RT_TEST(an_answer_that_differs_is_wrong_only_where_rounding_is_no_excuse) {
    static const struct {
        const char *scene, *spec;
        RtRay ray;
        bool wrong;
    } rows[] = {
        /* Along faces of boxes of a CSG tree, and off them by a component of 2^-130, which Embree drops. */
        {"family:kind=csg-coincident,seed=1",
         "embree:mode=native",
         {.org = {{-0.125f, -0x1.d991ccp-1f, 0.0625f}},
          .dir = {{-0x1p-130f, 1, -0.0f}},
          .tmax = INFINITY,
          .kind = RT_RAY_RANDOM},
         false},
        /* A needle seen edge on, which Embree without fused operations says is hit outside its box. */
        {"family:kind=slivers,seed=1",
         "embree:isa=sse2",
         {.org = {{-0.709930062f, 0.908542037f, 0.687071741f}},
          .dir = {{2.6491189f, -5.61743689f, 3.32413292f}},
          .tmax = 1,
          .kind = RT_RAY_SHADOW},
         true},
        /* A triangle of 2^39, 2^54 away: the dot product of its corner and its normal, 2^134, is beyond
         * float32. No hit at infinity. */
        {"family:kind=slivers-scaled,seed=16",
         "embree",
         {.org = {{0x1.d29b58p+53f, -0x1.469a9ap+53f, -0x1.cc3184p+51f}},
          .dir = {{-0x1.9b2646p-1f, 0x1.1fcc8cp-1f, 0x1.95666cp-3f}},
          .tmax = INFINITY,
          .kind = RT_RAY_RANDOM},
         false},
        /* A dir so long that every t is 0: which object is nearest float32 cannot tell. */
        {"family:kind=mixed-tiny,seed=1",
         "embree",
         {.org = {{-5.36500289e-10f, 8.30262317e-11f, -2.80551304e-10f}},
          .dir = {{7.46290349e+37f, -2.50058786e+37f, 6.16864084e+37f}},
          .tmax = INFINITY,
          .kind = RT_RAY_RANDOM},
         false},
    };
    for (size_t i = 0; i < sizeof rows / sizeof rows[0]; i++) {
        RtAnswer answer;
        if (!embree_has(rows[i].spec)) continue;
        ask_native(rows[i].scene, rows[i].spec, rows[i].ray, &answer);
        assert_true(answer.expected.object != answer.got.object);
        assert_int_equal(answer.wrong, rows[i].wrong);
        if (i == 2) assert_true(answer.expected.object == 95 && answer.got.object == RT_NO_OBJECT);
    }
}

/* A dir so short that t is beyond float32 where something is hit. */
RT_TEST(what_is_hit_at_infinity_blocks_nothing) {
    RtAnswer answer;
    ask_native("balls:size=2", "embree",
               (RtRay){.org = {{-17.0314159f, -28.8662663f, 5.64897966f}},
                       .dir = {{5.03687372e-38f, 8.50490862e-38f, -1.51539765e-38f}},
                       .tmax = INFINITY,
                       .kind = RT_RAY_OCCLUSION},
               &answer);
    assert_int_equal(answer.expected.object, RT_NO_OBJECT);
    assert_false(answer.blocked);
}

/* ---- instances ---- */

/* A ball, two balls and a triangle, a square and a ball; three instances of the one and two of the other: ids
 * 0, then 1 to 3, 4 to 6, 7 and 8 ... */
static RtScene scene_of_two_parts(void) {
    RtScene scene = begin_scene(), a = begin_scene(), b = begin_scene();
    const RtVec3 triangle[3] = {{{-1, -1, 2}}, {{1, -1, 2.5f}}, {{0, 1, 2}}};
    const RtVec3 square[4] = {{{-1, 0, -1}}, {{1, 0, -1}}, {{1, 0, 1}}, {{-1, 0, 1}}};
    add_ball(&a, 0, 0, 0, 0.75f), add_ball(&a, 1.5f, 0, 0, 0.5f);
    assert_ok(rt_scene_add_triangle(&a, 0, triangle, NULL, error));
    assert_ok(rt_scene_add_polygon(&b, 0, square, 4, error));
    add_ball(&b, 0, 2, 0, 0.5f);
    add_part(&scene, &a), add_part(&scene, &b);
    add_ball(&scene, 0, 0, -4, 1);
    for (uint32_t i = 0; i < 5; i++) {
        RtTransform at = i % 2 ? scaled(1, 2, 0.5) : scaled(2, 2, 2);
        assert_ok(rt_transform_rotate(&at, rt_vec3(1, 2, 3), 40 * i, error));
        assert_ok(rt_transform_translate(&at, rt_vec3(6 * (float)i - 12, (float)i, 0), error));
        place(&scene, &scene, i % 2, at);
    }
    assert_ok(rt_scene_finish(&scene, error));
    return scene;
}

/* From all over a box about the scene to points in it; runs of 16 are of one kind, so packets may be
 * coherent, and their number is that of no whole packets. */
static void fill_chords(RtRay *rays, size_t count) {
    RtRandom random = rt_random(26, 0);
    for (size_t i = 0; i < count; i++) {
        RtVec3 ends[2];
        for (int k = 0; k < 2; k++) {
            for (int a = 0; a < 3; a++)
                ends[k].at[a] = (rt_random_unit(&random) - 0.5f) * (a == 0 ? 36 : k == 0 ? 30 : 8);
        }
        rays[i] = ray_along(ends[0], rt_sub(ends[1], ends[0]));
        rays[i].kind = i / 256 % 2 ? RT_RAY_SHADOW : RT_RAY_RANDOM;
    }
}

RT_TEST(native_instances_hit_the_objects_that_brute_hits) {
    enum { CHORDS = 8 * 1024 + 5, IDS = 1 + 3 * 3 + 2 * 2 };
    static const char *const specs[] = {"embree",
                                        "embree:query=8",
                                        "embree:query=16",
                                        "embree:query=stream",
                                        "embree:robust=on,isa=sse2",
                                        "embree:query=16,quality=high,isa=avx2",
                                        "bvh/embree:query=8",
                                        "wide/embree:query=stream",
                                        "embree:query=8/bvh",
                                        "embree/embree:mode=user",
                                        "embree:isa=avx/embree:isa=sse2"};
    OWNED_SCENE scene = scene_of_two_parts();
    OWNED_MEMORY RtRay *rays = rt_alloc(CHORDS, sizeof *rays);
    OWNED_MEMORY RtHit *hits = rt_alloc(2 * CHORDS, sizeof *hits);
    OWNED_MEMORY bool *blocked = rt_alloc(CHORDS, sizeof *blocked);
    RtHit *right = hits + CHORDS;
    uint32_t found[IDS] = {0};
    fill_chords(rays, CHORDS);
    {
        OWNED_ACCEL RtAccel *brute = open_accel(&scene, "brute");
        OWNED_QUERY query = open_query(brute);
        rt_nearest(&query, rays, CHORDS, right, NULL);
    }
    for (size_t i = 0; i < CHORDS; i++)
        if (right[i].object != RT_NO_OBJECT) found[right[i].object]++;
    for (uint32_t id = 0; id < IDS; id++) assert_true(found[id] > 20);
    for (size_t s = 0; s < sizeof specs / sizeof specs[0]; s++) {
        size_t others = 0;
        if (!embree_has(specs[s])) continue;
        OWNED_ACCEL RtAccel *accel = open_valid(&scene, specs[s]);
        OWNED_QUERY query = open_query(accel);
        assert_false(accel->exact);
        assert_false(accel->counts);
        rt_nearest(&query, rays, CHORDS, hits, NULL);
        rt_occluded(&query, rays, CHORDS, blocked, NULL);
        for (size_t i = 0; i < CHORDS; i++) {
            const bool hit = right[i].object != RT_NO_OBJECT, same = hits[i].object == right[i].object;
            others += !same || blocked[i] != hit;
            if (same && hit && !(fabsf(hits[i].t - right[i].t) <= 1e-4f * right[i].t))
                fail_msg("%s: t %g, not %g", specs[s], (double)hits[i].t, (double)right[i].t);
        }
        if (others > 2) fail_msg("%s: %zu of %d answers differ", specs[s], others, CHORDS);
        assert_ok(rt_accel_check(accel, error));
    }
}

RT_TEST(instances_in_instances_need_user_mode_or_another_accelerator_on_one_level) {
    static const char *const serve[] = {"embree:mode=user", "bvh/embree", "embree/bvh"};
    OWNED_SCENE scene = nested(2), deeper = nested(3);
    const RtRay ray = ray_along(rt_vec3(0.1f, 0, 9), rt_vec3(0, 0, -1));
    OWNED_ACCEL RtAccel *brute = open_accel(&scene, "brute");
    OWNED_QUERY of_brute = open_query(brute);
    RtHit right, hit;
    RtAccel *none = NULL;
    rt_nearest(&of_brute, &ray, 1, &right, NULL);
    assert_bad_input(rt_accel_open("embree", &scene, &none, error), "instances in instances need mode=user");
    assert_bad_input(rt_accel_open("bvh/embree", &deeper, &none, error), "need mode=user");
    assert_null(none);
    for (size_t i = 0; i < sizeof serve / sizeof serve[0]; i++) {
        OWNED_ACCEL RtAccel *accel = open_valid(&scene, serve[i]);
        OWNED_QUERY query = open_query(accel);
        rt_nearest(&query, &ray, 1, &hit, NULL);
        assert_int_equal(hit.object, right.object);
        assert_true(fabsf(hit.t - right.t) < 1e-5f);
    }
}

RT_TEST(a_stack_is_exact_if_its_parts_are) {
    static const struct {
        const char *spec;
        bool exact, absolute;
    } rows[] = {{"bvh/embree", false, true},
                {"bvh/embree:robust=on", false, false},
                {"cache+wide/embree:mode=user", true, false},
                {"embree:mode=user/embree", false, true}};
    OWNED_SCENE scene = one_ball(moved(1, 2, 3));
    for (size_t i = 0; i < sizeof rows / sizeof rows[0]; i++) {
        OWNED_ACCEL RtAccel *accel = open_valid(&scene, rows[i].spec);
        assert_int_equal(accel->exact, rows[i].exact);
        assert_int_equal(accel->absolute, rows[i].absolute);
        assert_false(accel->counts);
    }
}

/* A part of 2^46, placed at a millionth: directions become 2^20 times as long. */
RT_TEST(a_part_whose_instance_overflows_float32_is_refused_in_native_mode) {
    OWNED_SCENE scene = begin_scene();
    RtScene part = begin_scene();
    RtAccel *none = NULL;
    add_ball(&part, 0, 0, 0, 0x1p45f);
    add_part(&scene, &part);
    place(&scene, &scene, 0, scaled(1e-6, 1e-6, 1e-6));
    assert_ok(rt_scene_finish(&scene, error));
    assert_bad_input(rt_accel_open("embree", &scene, &none, error), "overflows float32");
    assert_null(none);
    rt_accel_destroy(open_valid(&scene, "embree:mode=user"));
}

/* Each counts its own part of what their one device has allocated. */
RT_TEST(a_scene_and_its_parts_share_a_device_and_their_bytes_are_counted_once) {
    static const char *const specs[] = {"embree", "embree:mode=user"};
    OWNED_SCENE scene = scene_of_two_parts();
    int64_t live = rt_alloc_live();
    for (int i = 0; i < 2; i++) {
        RtDescription description;
        OWNED_ACCEL RtEmbree *embree = open_valid(&scene, specs[i]);
        rt_accel_describe(&embree->base, &description);
        assert_int_equal(embree->device->users, 3);
        for (int k = 0; k < 2; k++)
            assert_ptr_equal(((const RtEmbree *)embree->parts[k])->device, embree->device);
        assert_int_equal(description.bytes,
                         (uint64_t)embree->device->bytes + (i == 0 ? 3 * sizeof(uint32_t) : 0));
    }
    assert_int_equal(rt_alloc_live(), live);
}

RT_TEST(an_error_in_a_part_is_told_after_tracing) {
    OWNED_SCENE scene = one_ball(moved(1, 2, 3));
    OWNED_ACCEL RtAccel *accel = open_accel(&scene, "cache+bvh/embree");
    assert_ok(rt_accel_check(accel, error));
    ((const RtEmbree *)accel->below->parts[0])->device->code = RTC_ERROR_UNKNOWN;
    assert_fails_with(rt_accel_check(accel, error), RT_MISMATCH, "Embree reports error");
}

/* Rays from all over the scene are within the reach of a part, so they test few of its 64 objects; and a hit
 * in an instance ends the search, so they test few of the 20 behind it. */
RT_TEST(rays_from_afar_test_few_instances_and_few_objects_of_a_part) {
    OWNED_SCENE scene = begin_scene();
    RtScene part = begin_scene();
    for (int i = 0; i < 64; i++) add_ball(&part, (float)i, 0, 0, 0.25f);
    add_part(&scene, &part);
    for (int i = 0; i < 20; i++) place(&scene, &scene, 0, moved(0, 0, 400 * i));
    assert_ok(rt_scene_finish(&scene, error));
    OWNED_ACCEL RtAccel *accel = open_accel(&scene, "embree:mode=user");
    OWNED_QUERY query = open_query(accel);
    RtTally tallies[RT_RAY_KIND_COUNT] = {{0}};
    const RtRay ray = ray_along(rt_vec3(5, 0, 8000), rt_vec3(0, 0, -1));
    RtHit hit;
    rt_nearest(&query, &ray, 1, &hit, tallies);
    assert_int_equal(hit.object, 19 * 64 + 5);
    assert_true(tallies[0].object_tests <= 10);
}

/* ---- both ---- */

RT_TEST(a_scene_that_outgrows_its_structure_is_noticed_in_user_mode) {
    OWNED_SCENE scene = open_scene("random:n=60,shape=mixed");
    OWNED_ACCEL RtAccel *accel = open_valid(&scene, "embree:mode=user");
    scene.geometry.box.hi.y += 1;
    assert_broken(accel, "bounds do not contain");
}

RT_TEST(building_ten_times_leaks_nothing) {
    OWNED_SCENE scene = open_scene("random:n=60,shape=mixed");
    int64_t before = rt_alloc_live();
    for (int i = 0; i < 10; i++) {
        RtDescription description;
        OWNED_ACCEL RtAccel *accel = open_accel(&scene, i % 2 ? "embree" : "embree:mode=user");
        accel->ops->describe(accel, &description);
        assert_true(description.bytes > 1000 && description.bytes < 1000000);
        assert_int_equal(description.references, 60);
    }
    for (uint64_t nth = 1; nth <= 2; nth++) {
        RtAccel *accel;
        rt_alloc_fail_at(nth);
        assert_fails_with(rt_accel_open("embree", &scene, &accel, error), RT_NO_MEMORY, "out of memory");
    }
    rt_alloc_fail_at(0);
    assert_int_equal(rt_alloc_live(), before);
}

/* The count of its memory monitor, and our indices of triangles if there are triangles. */
RT_TEST(its_bytes_are_what_it_has_allocated_and_our_arrays) {
    static const char *const specs[] = {"embree", "embree:mode=user"};
    OWNED_SCENE scene = open_scene("random:n=60,shape=mixed");
    const uint64_t indices = scene.geometry.triangle_count * 3 * sizeof(uint32_t);
    for (int i = 0; i < 2; i++) {
        RtDescription description;
        OWNED_ACCEL RtAccel *accel = open_accel(&scene, specs[i]);
        rt_accel_describe(accel, &description);
        uint64_t counted = (uint64_t)((const RtEmbree *)accel)->device->bytes;
        assert_true(counted > 1000);
        assert_int_equal(description.bytes, counted + (i == 0 ? indices : 0));
    }
}

RT_TEST(the_library_names_a_version_and_an_isa) {
    char text[64];
    const RtAccelOps *ops;
    assert_ok(rt_accel_find("embree", &ops, error));
    assert_true(ops->library(text, sizeof text));
    int major, minor, patch;
    char isa[16];
    assert_int_equal(sscanf(text, "%d.%d.%d %15s", &major, &minor, &patch, isa), 4);
    assert_true(major >= 3);
}

RT_TESTS(embree, NULL, NULL)

#else

RT_TEST_GROUP(embree) {
    printf("skipped: needs Embree\n");
    return RT_TEST_SKIPPED;
}

#endif
