/* SPDX-License-Identifier: Apache-2.0 */
/* accel/embree. mode=user is brute bit for bit, by every query, instruction set and quality, in scenes of
 * every size; mode=native agrees with brute except at edges, where a difference is a margin. Skipped without
 * Embree. */
#include "accel_testing.h"
#include "random_testing.h"

#include "scenes/random_tree.h"
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

/* ---- scenes and rays ---- */

static void add_triangle(RtScene *scene, RtRandom *random, float size, float edge) {
    RtVec3 corner = rt_random_point(random, size), v[3] = {corner};
    for (int i = 1; i < 3; i++) v[i] = rt_add(corner, rt_random_point(random, edge));
    assert_ok(rt_scene_add_triangle(scene, 0, v, NULL, error));
}

/* A rectangle, in the plane z = const for every other one. */
static void add_polygon(RtScene *scene, RtRandom *random, float size, float edge, bool flat) {
    RtVec3 corner = rt_random_point(random, size);
    RtVec3 a = rt_random_point(random, edge), b = rt_random_point(random, edge);
    if (flat) a.z = b.z = 0;
    RtVec3 v[4] = {corner, rt_add(corner, a), rt_add(rt_add(corner, a), b), rt_add(corner, b)};
    assert_ok(rt_scene_add_polygon(scene, 0, v, 4, error));
}

static void add_csg(RtScene *scene, RtRandom *random, RtVec3 center, float radius) {
    RtTransform move = rt_transform_identity();
    RtTreeRecipe recipe = {1 + rt_random_below(random, 8), false};
    OWNED_BUILDER trees = {0};
    RtCsgTerm root;
    assert_ok(rt_transform_scale(&move, rt_vec3(radius, radius, radius), error));
    assert_ok(rt_transform_translate(&move, center, error));
    assert_ok(rt_random_tree(&trees, random, &recipe, 1, &root, error));
    assert_ok(rt_csg_move(&trees, root, &move, &root, error));
    assert_ok(rt_scene_add_csg(scene, &trees, root, true, error));
}

/* `copies` times the same soup of all shapes: every hit of a second copy is a tie. */
static RtScene make_soup(uint32_t count, uint32_t copies, float size) {
    RtScene scene = begin_scene();
    for (uint32_t copy = 0; copy < copies; copy++) {
        RtRandom random = rt_random(7, 1);
        for (uint32_t i = 0; i < count; i++) {
            float edge = size * 0.2f, radius = size * rt_random_between(&random, 0.01f, 0.1f);
            RtVec3 center = rt_random_point(&random, size);
            switch (i % 5) {
            case 0: assert_ok(rt_scene_add_sphere(&scene, 0, center, radius, error)); break;
            case 1: add_polygon(&scene, &random, size, edge, i % 8 == 1); break;
            case 2: add_triangle(&scene, &random, size, edge); break;
            case 3: {
                RtVec3 apex = rt_add(center, rt_random_point(&random, edge));
                assert_ok(rt_scene_add_cone(&scene, 0, center, radius, apex, radius * 0.5f, error));
                break;
            }
            default: add_csg(&scene, &random, center, radius);
            }
        }
    }
    assert_ok(rt_scene_finish(&scene, error));
    return scene;
}

/* Of four directions one is parallel to an axis and one to a coordinate plane, or nearly. */
static RtVec3 direction(RtRandom *random) {
    RtVec3 d = rt_narrow(rt_random_direction(random));
    uint32_t bits = rt_random_bits(random);
    uint32_t axis = bits % 3, style = bits / 3 % 4;
    for (uint32_t a = 0; a < 3; a++) {
        static const float small[] = {0.0f, -0.0f, 1e-19f, -1e-19f};
        if (style == 0 && a != axis) d.at[a] = small[bits >> 8 & 3];
        if (style == 1 && a == axis) d.at[a] = small[bits >> 8 & 3];
    }
    if (d.x == 0 && d.y == 0 && d.z == 0) d.at[axis] = 1;
    return d;
}

/* Towards a point of the box of an object: a corner, or anything within; so that rays graze boxes. */
static RtVec3 target(const RtScene *scene, RtRandom *random) {
    const RtGeometry *g = &scene->geometry;
    const RtBox *box = &g->boxes[rt_random_below(random, g->object_count)];
    uint32_t bits = rt_random_bits(random);
    RtVec3 p;
    for (int a = 0; a < 3; a++) {
        float between = rt_random_between(random, box->lo.at[a], box->hi.at[a]);
        p.at[a] = bits & 8 ? between : bits >> a & 1 ? box->lo.at[a] : box->hi.at[a];
    }
    return p;
}

typedef struct Rays {
    RtRay *rays;
    size_t count;
} Rays;

static void free_rays(Rays *r) {
    rt_free(r->rays);
}

#define OWNED_RAYS OWNED(free_rays) Rays

/* Rays through a target each, from `distance` scene sizes away at most, with dir of every length and with and
 * without bounds; kinds in runs, so that packets are coherent and not. */
static Rays make_rays(const RtScene *scene, size_t count, float size, float distance) {
    Rays r = {rt_alloc(count, sizeof(RtRay)), count};
    assert_non_null(r.rays);
    RtRandom random = rt_random(11, 0);
    for (size_t i = 0; i < count; i++) {
        static const float lengths[] = {1, 1, 0.01f, 100, 1e-6f, 1e-30f, 1e18f, 1e30f};
        uint32_t bits = rt_random_bits(&random);
        float length = lengths[bits % 8];
        RtVec3 dir = direction(&random);
        float far = rt_random_between(&random, 0, distance) * size, back = far / length;
        RtRay *ray = &r.rays[i];
        *ray = (RtRay){.tmax = INFINITY, .kind = (uint32_t)(i / 100 % RT_RAY_KIND_COUNT)};
        ray->org = rt_sub(target(scene, &random), rt_scale(dir, far));
        ray->dir = rt_scale(dir, length);
        if ((bits >> 4) % 4 == 1) ray->tmin = rt_minf(back * 0.9f, FLT_MAX);
        if ((bits >> 6) % 4 == 1) ray->tmax = back * 1.2f;
        assert_true(rt_ray_is_valid(ray));
    }
    return r;
}

/* ---- answers ---- */

typedef struct Answers {
    RtHit *hits;
    bool *blocked;
    RtTally tallies[RT_RAY_KIND_COUNT]; /* of the nearest hits */
} Answers;

static Answers ask(const RtScene *scene, const char *spec, Rays rays, bool counted) {
    Answers a = {rt_alloc(rays.count, sizeof(RtHit)), rt_alloc(rays.count, sizeof(bool)), {{0}}};
    OWNED_ACCEL RtAccel *accel = open_valid(scene, spec);
    OWNED_QUERY query = open_query(accel);
    rt_nearest(&query, rays.rays, rays.count, a.hits, counted ? a.tallies : NULL);
    RtTally apart[RT_RAY_KIND_COUNT] = {{0}};
    rt_occluded(&query, rays.rays, rays.count, a.blocked, counted ? apart : NULL);
    return a;
}

static void forget(Answers *a) {
    rt_free(a->hits);
    rt_free(a->blocked);
}

#define OWNED_ANSWERS OWNED(forget) Answers

static void assert_same(const Answers *got, const Answers *right, Rays rays, const char *spec) {
    for (size_t i = 0; i < rays.count; i++) {
        RtHit g = got->hits[i], r = right->hits[i];
        if (g.object == r.object && memcmp(&g.t, &r.t, sizeof g.t) == 0 &&
            got->blocked[i] == right->blocked[i]) {
            continue;
        }
        const RtRay *ray = &rays.rays[i];
        fail_msg(
            "%s, ray %zu (%a %a %a) + t (%a %a %a) in %g..%g: object %u at %a, blocked %d; brute says %u "
            "at %a, %d",
            spec, i, (double)ray->org.x, (double)ray->org.y, (double)ray->org.z, (double)ray->dir.x,
            (double)ray->dir.y, (double)ray->dir.z, (double)ray->tmin, (double)ray->tmax, g.object,
            (double)g.t, got->blocked[i], r.object, (double)r.t, right->blocked[i]);
    }
}

/* Tests the specs that are available here. */
static void compare_with_brute(const RtScene *scene, Rays rays, const char *const *specs, size_t count) {
    OWNED_ANSWERS right = ask(scene, "brute", rays, false);
    for (size_t i = 0; i < count; i++) {
        if (!embree_has(specs[i])) continue;
        OWNED_ANSWERS got = ask(scene, specs[i], rays, i % 2 == 1);
        assert_same(&got, &right, rays, specs[i]);
    }
}

/* ---- mode=user ---- */

RT_TEST(user_mode_is_brute_bit_for_bit_by_every_query) {
    static const char *const specs[] = {
        "embree:mode=user,query=1,robust=on",  "embree:mode=user,query=1,robust=off",
        "embree:mode=user,query=8,robust=off", "embree:mode=user,query=8,robust=on",
        "embree:mode=user,query=16,robust=on", "embree:mode=user,query=16,robust=off",
        "embree:mode=user,query=stream",       "embree:mode=user,query=stream,robust=on",
    };
    OWNED_SCENE scene = make_soup(60, 2, 10);
    OWNED_RAYS rays = make_rays(&scene, 100003, 10, 3);
    compare_with_brute(&scene, rays, specs, sizeof specs / sizeof specs[0]);
}

/* An instruction set that the machine lacks is refused; then there is nothing to compare. */
RT_TEST(user_mode_is_brute_by_every_isa_and_quality) {
    static const char *const isas[] = {"sse2", "sse4.2", "avx", "avx2", "avx512"};
    static const char *const qualities[] = {"low", "medium", "high"};
    static const char *const queries[] = {"1", "8", "16", "stream"};
    OWNED_SCENE scene = make_soup(40, 2, 1000);
    OWNED_RAYS rays = make_rays(&scene, 5000, 1000, 20);
    for (size_t i = 0; i < 60; i++) {
        char spec[RT_MAX_SPEC_CHARS];
        snprintf(spec, sizeof spec, "embree:mode=user,isa=%s,quality=%s,query=%s", isas[i % 5],
                 qualities[i / 5 % 3], queries[i / 15]);
        const char *const one[] = {spec};
        compare_with_brute(&scene, rays, one, 1);
    }
}

RT_TEST(user_mode_is_brute_in_scenes_of_every_size_and_from_far_away) {
    static const float sizes[] = {1e-12f, 1e-6f, 1e6f, 1e12f};
    static const char *const specs[] = {"embree:mode=user", "embree:mode=user,query=16"};
    for (size_t i = 0; i < sizeof sizes / sizeof sizes[0]; i++) {
        OWNED_SCENE scene = make_soup(40, 1, sizes[i]);
        OWNED_RAYS rays = make_rays(&scene, 4000, sizes[i], i % 2 ? 3 : 1e5f);
        compare_with_brute(&scene, rays, specs, 2);
    }
}

/* Every hit is traced again with an interval that is only its t, and from its point. */
RT_TEST(user_mode_finds_hits_at_the_very_ends_of_the_interval) {
    static const char *const specs[] = {"embree:mode=user", "embree:mode=user,query=8,robust=on",
                                        "embree:mode=user,query=16", "embree:mode=user,query=stream"};
    OWNED_SCENE scene = make_soup(60, 2, 10);
    OWNED_RAYS rays = make_rays(&scene, 10000, 10, 3);
    OWNED_ANSWERS hit = ask(&scene, "brute", rays, false);
    for (size_t i = 0; i < rays.count; i++) {
        RtRay *ray = &rays.rays[i];
        if (hit.hits[i].object == RT_NO_OBJECT) continue;
        if (i % 2) {
            ray->tmin = ray->tmax = hit.hits[i].t;
        } else {
            ray->org = rt_narrow(rt_ray_point(ray, hit.hits[i].t));
            ray->tmin = ray->tmax = 0;
        }
    }
    compare_with_brute(&scene, rays, specs, sizeof specs / sizeof specs[0]);
}

/* Directions so long that a step between two values of t is as large as an object, or as the scene. */
RT_TEST(user_mode_is_brute_where_t_is_denormal) {
    static const float sizes[] = {1e-9f, 1e-8f, 1e-7f};
    static const char *const specs[] = {"embree:mode=user", "embree:mode=user,query=16"};
    for (size_t i = 0; i < sizeof sizes / sizeof sizes[0]; i++) {
        OWNED_SCENE scene = make_soup(40, 1, sizes[i]);
        OWNED_RAYS rays = make_rays(&scene, 4000, sizes[i], 3);
        for (size_t k = 0; k < rays.count; k++) {
            RtRay *ray = &rays.rays[k];
            RtVec3d dir = rt_widen(ray->dir);
            ray->dir = rt_narrow(rt_scaled(dir, 0x1p126 / fabs(dir.at[rt_major_axis(ray->dir)])));
            ray->tmin = k % 3 ? 0 : 0x1p-149f;
            ray->tmax = INFINITY;
            assert_true(rt_ray_is_valid(ray));
        }
        compare_with_brute(&scene, rays, specs, 2);
    }
}

RT_TEST(user_mode_counts_tests_where_it_is_asked_to) {
    OWNED_SCENE scene = make_soup(60, 1, 10);
    OWNED_RAYS rays = make_rays(&scene, 100 * RT_RAY_KIND_COUNT, 10, 3);
    Answers brute = ask(&scene, "brute", rays, true), user = ask(&scene, "embree:mode=user", rays, true);
    for (size_t kind = 0; kind < RT_RAY_KIND_COUNT; kind++) {
        const RtTally *b = &brute.tallies[kind], *u = &user.tallies[kind];
        assert_int_equal(u->rays, 100);
        assert_int_equal(u->hits, b->hits);
        assert_true(u->object_tests >= u->object_hits && u->object_hits >= u->hits);
        assert_true(u->object_tests < b->object_tests);
    }
    forget(&brute);
    forget(&user);
}

/* A sphere of radius 1, at 0 and far off: twice the thickness of a ray from 8 away, which is four times the
 * size, and 2^-21 of the largest coordinate. With 15/16 of either this fails. */
RT_TEST(boxes_of_user_geometry_grow_by_their_bound) {
    for (int far = 0; far < 2; far++) {
        const float x = far ? 0x1p16f : 0;
        OWNED_SCENE scene = begin_scene();
        assert_ok(rt_scene_add_sphere(&scene, 0, rt_vec3(x, 0, 0), 1, error));
        scene.camera.from = rt_vec3(x, 0, 2);
        scene.camera.at = rt_vec3(x, 0, 0);
        assert_ok(rt_scene_finish(&scene, error));
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
    OWNED_SCENE scene = begin_scene();
    assert_ok(rt_scene_add_sphere(&scene, 0, rt_vec3(0, 0, 0), 0x1p-130f, error));
    scene.camera.from = rt_vec3(0, 0, 0x1p-120f);
    scene.camera.at = rt_vec3(0, 0, 0);
    assert_ok(rt_scene_finish(&scene, error));
    OWNED_ACCEL RtEmbree *embree = open_accel(&scene, "embree:mode=user");
    assert_true((double)embree->growth >= 31.0 / 32 * 0x1p-100);
}

RT_TEST(the_first_error_that_embree_reports_is_told_after_tracing) {
    OWNED_SCENE_OF(scene, sphere, rt_vec3(0, 0, 0), 1);
    OWNED_ACCEL RtAccel *accel = open_accel(&scene, "cache+embree:mode=user");
    RTCScene empty = rtcNewScene(((const RtEmbree *)accel->below)->device.device);
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

static RtScene make_triangles(uint32_t count) {
    RtRandom random = rt_random(7, 2);
    RtScene scene = begin_scene();
    for (uint32_t i = 0; i < count; i++) add_triangle(&scene, &random, 1, 0.3f);
    assert_ok(rt_scene_finish(&scene, error));
    return scene;
}

/* Rays between random points, past edges and corners at ordinary distances; dir short and long. */
static Rays make_plain_rays(size_t count, float size) {
    Rays r = {rt_alloc(count, sizeof(RtRay)), count};
    assert_non_null(r.rays);
    RtRandom random = rt_random(3, 3);
    for (size_t i = 0; i < count; i++) {
        RtVec3 from = rt_narrow(rt_scaled(rt_random_direction(&random), 3 * (double)size));
        RtVec3 to = rt_random_point(&random, size);
        r.rays[i] = (RtRay){.org = from, .dir = rt_sub(to, from), .tmax = INFINITY};
        if (i % 2) r.rays[i].dir = rt_scale(r.rays[i].dir, i % 4 == 1 ? 1e30f : 1e-30f);
    }
    return r;
}

/* Native mode may hit another object at edges; hence 99.9 %. */
RT_TEST(native_mode_agrees_with_brute_on_triangles) {
    static const char *const specs[] = {
        "embree",           "embree:query=8",  "embree:query=16",     "embree:query=stream",
        "embree:robust=on", "embree:isa=sse2", "embree:quality=high", "embree:quality=low",
    };
    OWNED_SCENE scene = make_triangles(500);
    OWNED_RAYS rays = make_plain_rays(20000, 1);
    OWNED_ANSWERS right = ask(&scene, "brute", rays, false);
    for (size_t s = 0; s < sizeof specs / sizeof specs[0]; s++) {
        if (!embree_has(specs[s])) continue;
        OWNED_ANSWERS got = ask(&scene, specs[s], rays, s % 2 == 1);
        size_t agree = 0, hits = 0;
        for (size_t i = 0; i < rays.count; i++) {
            RtHit g = got.hits[i], r = right.hits[i];
            bool same_t = fabsf(g.t - r.t) <= 1e-5f * r.t;
            agree += (g.object == r.object || same_t) && got.blocked[i] == right.blocked[i];
            if (g.object == r.object && r.object != RT_NO_OBJECT) assert_true(same_t);
            hits += r.object != RT_NO_OBJECT;
        }
        assert_true(hits > rays.count / 4);
        if (agree < rays.count / 1000 * 999)
            fail_msg("%s: only %zu of %zu agree", specs[s], agree, rays.count);
    }
}

RT_TEST(native_mode_sees_every_shape) {
    OWNED_SCENE scene = make_soup(80, 1, 10);
    OWNED_RAYS rays = make_plain_rays(20000, 10);
    Answers right = ask(&scene, "brute", rays, false), got = ask(&scene, "embree", rays, false);
    size_t seen[RT_SHAPE_COUNT] = {0}, agreed[RT_SHAPE_COUNT] = {0};
    for (size_t i = 0; i < rays.count; i++) {
        uint32_t object = right.hits[i].object;
        if (object == RT_NO_OBJECT) continue;
        RtShape shape = rt_ref_shape(scene.geometry.objects[object]);
        seen[shape]++;
        agreed[shape] += got.hits[i].object == object;
    }
    for (size_t s = 0; s < RT_SHAPE_COUNT; s++) {
        assert_true(seen[s] > 100);
        if ((double)agreed[s] < 0.999 * (double)seen[s])
            fail_msg("%s: only %zu of %zu agree", rt_shape_name((RtShape)s), agreed[s], seen[s]);
    }
    forget(&right);
    forget(&got);
}

/* Embree asserts its assumptions, and aborts if one fails. */
RT_TEST(native_mode_takes_every_valid_ray) {
    static const char *const specs[] = {"embree",
                                        "embree:query=8",
                                        "embree:query=16",
                                        "embree:query=stream",
                                        "embree:query=8,robust=on",
                                        "embree:query=stream,isa=avx"};
    OWNED_SCENE scene = make_soup(60, 2, 10);
    OWNED_RAYS rays = make_rays(&scene, 50000, 10, 3);
    for (size_t s = 0; s < sizeof specs / sizeof specs[0]; s++) {
        if (!embree_has(specs[s])) continue;
        OWNED_ANSWERS got = ask(&scene, specs[s], rays, false);
        for (size_t i = 0; i < rays.count; i++)
            assert_true(got.hits[i].object == RT_NO_OBJECT ? isinf(got.hits[i].t) : isfinite(got.hits[i].t));
    }
}

/* ---- answers that verify found ---- */

static void ask_native(const char *scene_spec, const char *spec, RtRay ray, RtAnswer *answer) {
    OWNED_SCENE scene = open_scene(scene_spec);
    RtFailure failure = {.rays = &ray, .count = 1, .stream = 1, .occluded = ray.kind == RT_RAY_OCCLUSION};
    assert_ok(rt_failure_ask(&failure, &scene, rt_accel_builder_of_spec(spec), answer, error));
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

/* ---- both ---- */

RT_TEST(an_empty_scene_is_hit_by_nothing) {
    static const char *const specs[] = {"embree", "embree:query=16", "embree:query=stream",
                                        "embree:mode=user", "embree:mode=user,query=8"};
    OWNED_SCENE scene;
    rt_scene_init(&scene);
    assert_ok(rt_scene_finish(&scene, error));
    RtRay ray = {.dir = {1, 0, 0}, .tmax = INFINITY};
    compare_with_brute(&scene, (Rays){&ray, 1}, specs, sizeof specs / sizeof specs[0]);
}

RT_TEST(a_scene_that_outgrows_its_structure_is_noticed_in_user_mode) {
    OWNED_SCENE scene = make_soup(40, 1, 10);
    OWNED_ACCEL RtAccel *accel = open_valid(&scene, "embree:mode=user");
    scene.geometry.box.hi.y += 1;
    assert_broken(accel, "bounds do not contain");
}

RT_TEST(building_ten_times_leaks_nothing) {
    OWNED_SCENE scene = make_soup(60, 1, 10);
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
    OWNED_SCENE scene = make_soup(60, 1, 10);
    assert_int_equal(scene.geometry.triangle_count, 12);
    for (int i = 0; i < 2; i++) {
        RtDescription description;
        OWNED_ACCEL RtAccel *accel = open_accel(&scene, specs[i]);
        rt_accel_describe(accel, &description);
        uint64_t counted = (uint64_t)((const RtEmbree *)accel)->device.bytes;
        assert_true(counted > 1000);
        assert_int_equal(description.bytes, counted + (i == 0 ? 12 * 3 * sizeof(uint32_t) : 0));
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
