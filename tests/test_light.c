/* The light buffer: what it counts, what it passes on, lights in awkward places, and its invariants broken.
 */
#include "accel_testing.h"

#include "accel/light/light.h"
#include "base/memory.h"
#include "base/random.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* A screen, polygon 0, at z = 5 from -4 to 4, and a sphere of radius 1 above its middle, at z = 8; the light
 * at z = 10. */
static void make_screen(RtScene *scene) {
    const RtVec3 square[4] = {{{-4, -4, 5}}, {{4, -4, 5}}, {{4, 4, 5}}, {{-4, 4, 5}}};
    begin_scene(scene);
    assert_ok(rt_scene_add_polygon(scene, 0, square, 4, error));
    assert_ok(rt_scene_add_sphere(scene, 0, rt_vec3(0, 0, 8), 1, error));
    assert_ok(rt_scene_add_sphere(scene, 0, rt_vec3(0, 0, 0), 1, error)); /* in the dark */
    assert_ok(rt_scene_add_light(scene, rt_vec3(0, 0, 10), rt_vec3(1, 1, 1), error));
    assert_ok(rt_scene_finish(scene, error));
}

/* ---- counted by hand ---- */

typedef struct Row {
    const char *spec;
    RtRay ray;
    bool blocked;
    RtTally expected;
} Row;

static void check_tally(size_t row, const RtTally *tally, const RtTally *expected) {
    for (size_t c = 0; c < RT_TALLY_COUNTER_COUNT; c++) {
        uint64_t got = rt_tally_get(tally, c), hand = rt_tally_get(expected, c);
        if (got != hand) fail_msg("row %zu, %s: %d, by hand %d", row, rt_tally_name(c), (int)got, (int)hand);
    }
}

static void check_rows(const RtScene *scene, const Row *rows, size_t count) {
    for (size_t i = 0; i < count; i++) {
        RtAccel *accel;
        RtQuery query;
        RtTally tallies[RT_RAY_KIND_COUNT] = {{0}};
        bool blocked;
        assert_ok(rt_accel_open(rows[i].spec, scene, &accel, error));
        assert_ok(rt_query_init(&query, accel, error));
        rt_occluded(&query, &rows[i].ray, 1, &blocked, tallies);
        if (blocked != rows[i].blocked) fail_msg("row %zu: blocked is %d", i, blocked);
        check_tally(i, &tallies[RT_RAY_SHADOW], &rows[i].expected);
        rt_query_clear(&query);
        rt_accel_destroy(accel);
    }
}

static void it_counts_what_was_counted_by_hand(void **state) {
    (void)state;
    RtScene scene;
    make_screen(&scene);
    RtRay above = shadow_ray(&scene, rt_vec3(0.5f, 0.5f, 6), 0);    /* under the sphere, above the screen */
    RtRay below = shadow_ray(&scene, rt_vec3(0.5f, 0.5f, 3), 0);    /* under both */
    RtRay high = shadow_ray(&scene, rt_vec3(0.5f, 0.5f, 9.02f), 0); /* above both */
    RtRay askew = below, foreign = below, longer = below, away = below;
    askew.dir.x *= 1.5f;
    foreign.source = 1;
    longer.tmax = 2;
    away.org.z = -1000;
    away.dir.z = 1010;
    const Row rows[] = {
        /* One cell a face: the list downwards is sphere 1 (depth 1), polygon 0 (5), sphere 2 (9). */
        {"light:cells=1+brute",
         above,
         true,
         {.rays = 1, .hits = 1, .object_tests = 1, .object_hits = 1, .extent_tests = 1, .steps = 1}},
        {"light:cells=1,extents=off+brute",
         above,
         true,
         {.rays = 1, .hits = 1, .object_tests = 1, .object_hits = 1, .steps = 1}},
        /* No object is less deep than 0.98. */
        {"light:cells=1+brute", high, false, {.rays = 1}},
        /* With 16 cells sphere 1 covers the cell around its middle: it is what hides the depths. */
        {"light:cells=16+brute",
         below,
         true,
         {.rays = 1, .hits = 1, .object_tests = 1, .object_hits = 1, .extent_tests = 1, .steps = 1}},
        /* What is no ray to a light is passed on, where brute tests in order of shape: sphere 1 first. */
        {"light+brute",
         foreign,
         true,
         {.rays = 1, .hits = 1, .object_tests = 1, .object_hits = 1, .passed_on = 1}},
        {"light+brute",
         longer,
         true,
         {.rays = 1, .hits = 1, .object_tests = 1, .object_hits = 1, .passed_on = 1}},
        {"light+brute",
         askew,
         true,
         {.rays = 1, .hits = 1, .object_tests = 1, .object_hits = 1, .passed_on = 1}},
        /* Nor is one from outside the domain. */
        {"light+brute",
         away,
         true,
         {.rays = 1, .hits = 1, .object_tests = 1, .object_hits = 1, .passed_on = 1}},
    };
    check_rows(&scene, rows, sizeof rows / sizeof rows[0]);
    rt_scene_clear(&scene);
}

static const RtLightBuffer *open_buffer(const char *spec, const RtScene *scene, RtAccel **accel) {
    assert_ok(rt_accel_open(spec, scene, accel, error));
    return (const RtLightBuffer *)*accel;
}

/* A cell of the face that looks down, -z, from the first light. */
static size_t cell_at(const RtLightBuffer *buffer, uint32_t column, uint32_t row) {
    return rt_light_face(buffer, 0, 4) + (size_t)row * buffer->n + column;
}

static void full_occlusion_ends_lists_at_what_covers_a_cell(void **state) {
    (void)state;
    RtScene scene;
    RtAccel *on, *off;
    make_screen(&scene);
    const RtLightBuffer *cut = open_buffer("light:cells=16+brute", &scene, &on);
    const RtLightBuffer *whole = open_buffer("light:cells=16,full_occlusion=off+brute", &scene, &off);
    /* The middle of the face is under the sphere, the cell at u = w = 0.6 beside it, over the screen.
     */
    size_t middle = cell_at(cut, 8, 8), beside = cell_at(cut, 12, 12);
    assert_null(whole->covers);
    assert_int_equal(whole->first[middle + 1] - whole->first[middle], 3);
    assert_int_equal(cut->covers[middle].id, 1);
    assert_int_equal(cut->covers[beside].id, 0);
    assert_int_equal(cut->first[middle + 1] - cut->first[middle], 1);
    assert_true(cut->covers[middle].depth >= 3 && cut->covers[middle].depth < 3.01f);
    assert_true(cut->covers[beside].depth >= 5 && cut->covers[beside].depth < 5.01f);
    /* Where the screen ends nothing is covered: its rim is at u = 0.8. */
    for (uint32_t i = 0; i < 16; i++) {
        assert_int_equal(cut->covers[cell_at(cut, i, 15)].id, RT_NO_OBJECT);
    }
    assert_ok(rt_accel_validate(on, error));
    assert_ok(rt_accel_validate(off, error));
    rt_accel_destroy(on);
    rt_accel_destroy(off);
    rt_scene_clear(&scene);
}

static void a_concave_polygon_covers_no_cell_of_its_notch(void **state) {
    (void)state;
    /* A square with a notch down to its middle. */
    const RtVec3 notched[5] = {{{-8, -8, 5}}, {{8, -8, 5}}, {{8, 8, 5}}, {{0, 0, 5}}, {{-8, 8, 5}}};
    RtScene scene;
    RtAccel *accel;
    begin_scene(&scene);
    assert_ok(rt_scene_add_polygon(&scene, 0, notched, 5, error));
    assert_ok(rt_scene_add_light(&scene, rt_vec3(0, 0, 10), rt_vec3(1, 1, 1), error));
    assert_ok(rt_scene_finish(&scene, error));
    const RtLightBuffer *buffer = open_buffer("light:cells=16+brute", &scene, &accel);
    assert_int_equal(buffer->covers[cell_at(buffer, 8, 2)].id, 0);
    assert_int_equal(buffer->covers[cell_at(buffer, 8, 12)].id, RT_NO_OBJECT);
    rt_accel_destroy(accel);
    rt_scene_clear(&scene);
}

/* ---- what a cell remembers ---- */

static void a_cell_remembers_what_blocked_its_last_ray(void **state) {
    (void)state;
    RtScene scene;
    make_screen(&scene);
    /* One cell a face, its list sphere 1 (depth 1), polygon 0 (5), sphere 2 (9). The first ray passes through
     * the box of sphere 1 and misses it, as the second does, which is from above the screen. */
    RtRay under = shadow_ray(&scene, rt_vec3(3.5f, 3.5f, 3), 0);
    RtRay over = shadow_ray(&scene, rt_vec3(3.5f, 3.5f, 6), 0);
    RtRay shaded = shadow_ray(&scene, rt_vec3(0.5f, 0.5f, 6), 0);
    const RtTally from_the_start = {.rays = 1,
                                    .hits = 1,
                                    .object_tests = 2,
                                    .object_hits = 1,
                                    .extent_tests = 3, /* two boxes, and the plane of the polygon */
                                    .steps = 2};
    const struct {
        RtRay ray;
        bool begin;
        RtTally expected;
    } rows[] = {
        {under, false, from_the_start},
        /* The polygon, remembered, comes first; */
        {under,
         false,
         {.rays = 1, .hits = 1, .object_tests = 1, .object_hits = 1, .extent_tests = 2, .steps = 1}},
        /* but not where it is deeper than the origin. What misses changes nothing. */
        {over, false, {.rays = 1, .object_tests = 1, .extent_tests = 1, .steps = 1}},
        {under,
         false,
         {.rays = 1, .hits = 1, .object_tests = 1, .object_hits = 1, .extent_tests = 2, .steps = 1}},
        /* Now sphere 1 is remembered, */
        {shaded,
         false,
         {.rays = 1, .hits = 1, .object_tests = 1, .object_hits = 1, .extent_tests = 1, .steps = 1}},
        /* and tried in vain, once. */
        {under, false, from_the_start},
        /* A new beginning: the polygon is forgotten. */
        {under, true, from_the_start},
    };
    RtAccel *accel;
    RtQuery query;
    assert_ok(rt_accel_open("light:cells=1,full_occlusion=off+brute", &scene, &accel, error));
    assert_ok(rt_query_init(&query, accel, error));
    for (size_t i = 0; i < sizeof rows / sizeof rows[0]; i++) {
        RtTally tallies[RT_RAY_KIND_COUNT] = {{0}};
        bool blocked;
        if (rows[i].begin) rt_query_begin(&query);
        rt_occluded(&query, &rows[i].ray, 1, &blocked, tallies);
        check_tally(i, &tallies[RT_RAY_SHADOW], &rows[i].expected);
    }
    /* Where epochs have been used up, what an old one has left behind is not mistaken for new. */
    RtLightMemory *memory = query.scratch;
    memory[0].epoch = UINT32_MAX;
    memory[1].epoch = 1;
    rt_query_begin(&query);
    for (size_t i = 1; i <= 6; i++) assert_int_not_equal(memory[i].epoch, memory[0].epoch);
    rt_query_clear(&query);
    rt_accel_destroy(accel);
    rt_scene_clear(&scene);
}

/* ---- lights in awkward places ---- */

static RtVec3 random_point(RtRandom *random, float size) {
    RtVec3d d = rt_random_direction(random);
    return rt_narrow(rt_scaled(d, (double)(size * rt_random_unit(random))));
}

static RtVec3 moved(RtVec3 p, float by) {
    return rt_add(p, rt_vec3(by, by, by));
}

/* Some of each shape about (away, away, away), and lights inside a sphere and on it, in the plane of a
 * polygon and at its vertex, on an axis through a centre, close by and far off. */
static void make_awkward(RtScene *scene, float away) {
    RtRandom random = rt_random(5, 0);
    begin_scene(scene);
    for (int i = 0; i < 40; i++) {
        RtVec3 a = moved(random_point(&random, 4), away), b = rt_add(a, random_point(&random, 1));
        RtVec3 triangle[3] = {a, b, rt_add(a, random_point(&random, 2))};
        assert_ok(rt_scene_add_triangle(scene, 0, triangle, NULL, error));
        assert_ok(rt_scene_add_sphere(scene, 0, moved(random_point(&random, 4), away), 0.3f, error));
        if (i % 4 == 0)
            assert_ok(rt_scene_add_cone(scene, 0, a, 0.2f, rt_add(a, rt_vec3(0, 0.5f, 1)), 0.1f, error));
    }
    RtVec3 square[4] = {moved(rt_vec3(-5, -5, -4), away), moved(rt_vec3(5, -5, -4), away),
                        moved(rt_vec3(5, 5, -4), away), moved(rt_vec3(-5, 5, -4), away)};
    assert_ok(rt_scene_add_polygon(scene, 0, square, 4, error));
    assert_ok(rt_scene_add_sphere(scene, 0, moved(rt_vec3(0, 0, 0), away), 1, error));
    const RtVec3 places[] = {{{0.1f, 0, 0}}, {{0, 0, 1}}, {{2, 2, -4}},      {{-5, -5, -4}},
                             {{0, 0, 6}},    {{3, 3, 3}}, {{1e5f, 3, 2e4f}}, {{-9, 9, 9}}};
    for (size_t i = 0; i < sizeof places / sizeof places[0]; i++) {
        assert_ok(rt_scene_add_light(scene, moved(places[i], away), rt_vec3(1, 1, 1), error));
    }
    assert_ok(rt_scene_finish(scene, error));
}

enum { AWKWARD_RAYS = 40000 };

/* Rays from anywhere, from vertices and poles, and from points just off the edges between cells. */
static void make_awkward_rays(const RtScene *scene, RtRay *rays, float away) {
    RtRandom random = rt_random(6, 0);
    for (size_t i = 0; i < AWKWARD_RAYS; i++) {
        uint32_t light = (uint32_t)i % scene->light_count, k = rt_random_bits(&random);
        RtVec3 from = moved(random_point(&random, 6), away);
        if (k % 4 == 0) from = scene->geometry.triangles[k / 4 % 40].v[k / 256 % 3];
        if (k % 4 == 1) {
            RtVec3 to = scene->lights[light].position;
            float depth = 5 * rt_random_unit(&random), u = (float)((int)(k / 4 % 17) - 8) / 8;
            from = rt_add(to, rt_vec3(u * depth, (k & 64 ? u : 0.3f) * depth, k & 128 ? depth : -depth));
        }
        rays[i] = shadow_ray(scene, from, light);
        if (!rt_ray_is_valid(&rays[i])) rays[i] = shadow_ray(scene, moved(rt_vec3(5, 5, 5), away), light);
    }
}

static void lights_in_awkward_places_are_answered_like_brute(void **state) {
    (void)state;
    static RtRay rays[AWKWARD_RAYS];
    static bool expected[AWKWARD_RAYS], got[AWKWARD_RAYS];
    const char *specs[] = {"brute",
                           "light:cells=1+bvh",
                           "light:cells=16+bvh",
                           "light:cells=61,extents=off+bvh",
                           "light:cells=16,full_occlusion=off+bvh",
                           "cache+light+bvh"};
    const float places[] = {0, 1000};
    for (size_t p = 0; p < 2; p++) {
        RtScene scene;
        make_awkward(&scene, places[p]);
        make_awkward_rays(&scene, rays, places[p]);
        for (size_t i = 0; i < sizeof specs / sizeof specs[0]; i++) {
            RtAccel *accel;
            RtQuery query;
            RtTally tallies[RT_RAY_KIND_COUNT] = {{0}};
            assert_ok(rt_accel_open(specs[i], &scene, &accel, error));
            assert_ok(rt_accel_validate(accel, error));
            assert_ok(rt_query_init(&query, accel, error));
            rt_occluded(&query, rays, AWKWARD_RAYS, i ? got : expected, tallies);
            for (size_t k = 0; i && k < AWKWARD_RAYS; k++) {
                if (got[k] != expected[k]) fail_msg("%s at %g: ray %zu", specs[i], (double)places[p], k);
            }
            assert_int_equal(tallies[RT_RAY_SHADOW].rays, AWKWARD_RAYS);
            assert_true(tallies[RT_RAY_SHADOW].passed_on < AWKWARD_RAYS / 2 || strstr(specs[i], "cache"));
            rt_query_clear(&query);
            rt_accel_destroy(accel);
        }
        rt_scene_clear(&scene);
    }
}

/* Asks `spec` about the rays; fails where brute says otherwise. Gives what was counted. */
static RtTally check_like_brute(const char *spec, const RtScene *scene, const RtRay *rays, size_t count) {
    RtTally tallies[RT_RAY_KIND_COUNT] = {{0}}, of_brute[RT_RAY_KIND_COUNT] = {{0}};
    const char *specs[2] = {"brute", spec};
    bool *blocked[2];
    for (int i = 0; i < 2; i++) {
        RtAccel *accel;
        RtQuery query;
        blocked[i] = rt_alloc(count, sizeof(bool));
        assert_non_null(blocked[i]);
        assert_ok(rt_accel_open(specs[i], scene, &accel, error));
        assert_ok(rt_accel_validate(accel, error));
        assert_ok(rt_query_init(&query, accel, error));
        rt_occluded(&query, rays, count, blocked[i], i ? tallies : of_brute);
        rt_query_clear(&query);
        rt_accel_destroy(accel);
    }
    for (size_t k = 0; k < count; k++) {
        if (blocked[0][k] != blocked[1][k]) fail_msg("%s: ray %zu", spec, k);
    }
    rt_free(blocked[0]);
    rt_free(blocked[1]);
    return tallies[RT_RAY_SHADOW];
}

/* A triangle 1 below the light, its edges just inside borders of the 8 x 8 cells and one corner that its
 * diagonal passes; specks 2000 off widen the domain. A vertex is seen from 1000 off with an error of 2^-24 of
 * that, which is 2^-14 of the distance to the light: rays that miss by less are said to hit, from the cells
 * beside. */
static void rounding_far_off_is_within_the_margin(void **state) {
    (void)state;
    enum { COUNT = 100000 };
    static RtRay rays[COUNT];
    const RtVec3 light = {{0.1f, 0.2f, 0.3f}};
    const float in = 0x1p-18f, a = 0.25f - in, b = -0.25f + 3 * in;
    const RtVec3 corners[3] = {{{a, b, -1}}, {{b, a, -1}}, {{a, a, -1}}};
    RtScene scene;
    begin_scene(&scene);
    RtVec3 triangle[3] = {rt_add(light, corners[0]), rt_add(light, corners[1]), rt_add(light, corners[2])};
    assert_ok(rt_scene_add_triangle(&scene, 0, triangle, NULL, error));
    for (int i = -1; i <= 1; i += 2) {
        assert_ok(rt_scene_add_sphere(&scene, 0, moved(rt_vec3(0, 0, 0), 2000.0f * (float)i), 1, error));
    }
    assert_ok(rt_scene_add_light(&scene, light, rt_vec3(1, 1, 1), error));
    assert_ok(rt_scene_finish(&scene, error));
    RtRandom random = rt_random(7, 0);
    for (size_t i = 0; i < COUNT; i++) {
        double depth = 500 + 1000 * (double)rt_random_unit(&random), at[2];
        for (int k = 0; k < 2; k++) {
            double off = 0x1p-15 * ((double)rt_random_unit(&random) - 0.5);
            at[k] = 0.25 * ((double)(rt_random_bits(&random) % 3) - 1) + off;
        }
        if (i % 2) at[i / 2 % 2] = 0.5 * (double)rt_random_unit(&random) - 0.25; /* along a border */
        RtVec3d from = rt_vec3d(at[0] * depth, at[1] * depth, -depth);
        rays[i] = shadow_ray(&scene, rt_add(light, rt_narrow(from)), 0);
    }
    check_like_brute("light:cells=8,extents=off+brute", &scene, rays, COUNT);
    check_like_brute("light:cells=8+brute", &scene, rays, COUNT);
    rt_scene_clear(&scene);
}

/* What a sphere over half of a cell does not hide is seen, without asking below. */
static void a_partial_occluder_hides_nothing_beside_it(void **state) {
    (void)state;
    enum { COUNT = 20000 };
    static RtRay rays[COUNT];
    const char *specs[] = {"light:cells=1+brute", "light:cells=3+brute", "light:cells=16+brute",
                           "light:cells=61,cache=off+brute"};
    RtScene scene;
    begin_scene(&scene);
    assert_ok(rt_scene_add_sphere(&scene, 0, rt_vec3(0.3f, 0.2f, 8), 1, error));
    assert_ok(rt_scene_add_cone(&scene, 0, rt_vec3(-2, -2, 6), 0.5f, rt_vec3(2, -2, 6), 0.5f, error));
    assert_ok(rt_scene_add_sphere(&scene, 0, rt_vec3(0, 0, -8), 8, error));
    assert_ok(rt_scene_add_light(&scene, rt_vec3(0, 0, 10), rt_vec3(1, 1, 1), error));
    assert_ok(rt_scene_finish(&scene, error));
    RtRandom random = rt_random(8, 0);
    for (size_t i = 0; i < COUNT; i++) {
        rays[i] = shadow_ray(&scene, rt_add(random_point(&random, 4), rt_vec3(0, 0, 4)), 0);
    }
    for (size_t i = 0; i < sizeof specs / sizeof specs[0]; i++) {
        RtTally tally = check_like_brute(specs[i], &scene, rays, COUNT);
        assert_int_equal(tally.passed_on, 0);
        assert_in_range(tally.hits, COUNT / 20, COUNT - COUNT / 20);
    }
    rt_scene_clear(&scene);
}

/* Directions exactly along edges and corners of cells and of the cube, to three lights and to none. */
static void directions_along_edges_and_corners_are_answered_like_brute(void **state) {
    (void)state;
    enum { SIDE = 9, COUNT = 3 * SIDE * SIDE * SIDE };
    static RtRay rays[COUNT];
    const RtVec3 places[3] = {{{0, 0, 0}}, {{4, 4, 4}}, {{-1, 2, 0.5f}}};
    for (int lights = 3; lights >= 0; lights -= 3) {
        RtScene scene;
        begin_scene(&scene);
        for (int i = 0; i < 27; i++) {
            RtVec3 at = rt_vec3((float)(i % 3 * 2 - 2), (float)(i / 3 % 3 * 2 - 2), (float)(i / 9 * 2 - 2));
            assert_ok(rt_scene_add_sphere(&scene, 0, at, 0.25f + 0.125f * (float)(i % 2), error));
        }
        assert_ok(rt_scene_add_sphere(&scene, 0, rt_vec3(0, 0, 3.75f), 0.25f, error));
        const RtVec3 square[4] = {{{-4, -4, -4}}, {{4, -4, -4}}, {{4, 4, -4}}, {{-4, 4, -4}}};
        assert_ok(rt_scene_add_polygon(&scene, 0, square, 4, error));
        for (int i = 0; i < lights; i++) {
            assert_ok(rt_scene_add_light(&scene, places[i], rt_vec3(1, 1, 1), error));
        }
        assert_ok(rt_scene_finish(&scene, error));
        size_t count = 0;
        for (int i = 0; i < COUNT; i++) {
            int k = i / 3;
            RtVec3 to = places[i % 3], from = rt_vec3((float)(k % SIDE - 4), (float)(k / SIDE % SIDE - 4),
                                                      (float)(k / SIDE / SIDE - 4));
            RtRay ray = {.org = from, .dir = rt_sub(to, from), .tmax = 1, .kind = RT_RAY_SHADOW};
            ray.source = (uint32_t)i % 3;
            if (rt_ray_is_valid(&ray)) rays[count++] = ray;
        }
        RtTally tally = check_like_brute("light:cells=1+brute", &scene, rays, count);
        assert_true(lights ? tally.passed_on == 0 : tally.passed_on == count);
        check_like_brute("light:cells=4+brute", &scene, rays, count);
        check_like_brute("light:cells=8,extents=off,cache=off+brute", &scene, rays, count);
        check_like_brute("light:cells=9+brute", &scene, rays, count);
        rt_scene_clear(&scene);
    }
}

/* A ray that leaves a triangle on the light's side tests neither it nor those in its plane. */
static void a_receiver_that_faces_the_light_is_not_tested(void **state) {
    (void)state;
    const RtVec3 corners[4] = {{{-1, -1, -1}}, {{1, -1, 1}}, {{1, 1, 1}}, {{-1, 1, -1}}};
    RtScene scene;
    begin_scene(&scene);
    for (int i = 1; i < 3; i++) {
        const RtVec3 half[3] = {corners[0], corners[i], corners[i + 1]};
        assert_ok(rt_scene_add_triangle(&scene, 0, half, NULL, error));
    }
    assert_ok(rt_scene_add_light(&scene, rt_vec3(1, 2, 3), rt_vec3(1, 1, 1), error));
    assert_ok(rt_scene_finish(&scene, error));
    RtRay off = shadow_ray(&scene, rt_vec3(-0x1p-17f, 0, 0x1p-17f), 0),
          on = shadow_ray(&scene, rt_vec3(0, 0, 0), 0);
    RtTally tally = check_like_brute("light:full_occlusion=off+brute", &scene, &off, 1);
    assert_int_equal(tally.steps, 2);
    assert_int_equal(tally.extent_tests, 4);
    assert_int_equal(tally.object_tests, 0);
    tally = check_like_brute("light:full_occlusion=off+brute", &scene, &on, 1);
    assert_int_equal(tally.object_hits, 1);
    rt_scene_clear(&scene);
}

/* ---- limits and invariants ---- */

static unsigned number_that_fits(const RtError *error) {
    const char *cells = strstr(error->message, ": cells=");
    assert_non_null(cells);
    return (unsigned)strtoul(cells + strlen(": cells="), NULL, 10);
}

static void too_many_cells_are_refused_with_a_number_that_fits(void **state) {
    (void)state;
    RtScene scene;
    RtAccel *accel;
    RtError error = {RT_OK, ""};
    make_awkward(&scene, 0);
    assert_int_equal(rt_accel_open("light:cells=4096+bvh", &scene, &accel, &error), RT_BAD_INPUT);
    /* 8 lights x 6 faces x 20 bytes a cell in 4 GiB, without any list: 2115. What a cell remembers counts. */
    unsigned fits = number_that_fits(&error);
    assert_in_range(fits, 1000, 2115);
    assert_int_equal(rt_accel_open("light:cells=4096,cache=off+bvh", &scene, &accel, &error), RT_BAD_INPUT);
    assert_in_range(number_that_fits(&error), fits + 1, 2730);
    rt_scene_clear(&scene);
}

static void each_broken_invariant_is_named(void **state) {
    (void)state;
    RtScene scene;
    RtAccel *accel;
    make_awkward(&scene, 0);
    assert_ok(rt_accel_open("light:cells=8+brute", &scene, &accel, error));
    RtLightBuffer *buffer = (RtLightBuffer *)accel;
    assert_ok(rt_accel_validate(accel, error));

    size_t cell = 0;
    while (buffer->first[cell + 1] - buffer->first[cell] < 2) cell++;
    RtLightEntry *list = &buffer->entries[buffer->first[cell]], kept = list[0];
    list[0] = list[1];
    list[1] = kept;
    assert_broken(accel, "lacks object");
    list[1] = list[0];
    list[0] = kept;
    list[0].depth += 1;
    assert_broken(accel, "lacks object");
    list[0] = kept;

    buffer->first[cell + 1] -= 1;
    assert_broken(accel, "lacks object");
    buffer->first[cell + 1] += 1;
    uint32_t end = buffer->first[cell + 1];
    buffer->first[cell + 1] = 0;
    buffer->first[cell] = 1;
    assert_broken(accel, "ends before it begins");
    buffer->first[cell + 1] = end;
    buffer->first[cell] = (uint32_t)(list - buffer->entries);

    size_t covered = 0;
    while (buffer->covers[covered].id == RT_NO_OBJECT) covered++;
    RtLightCover cover = buffer->covers[covered];
    buffer->covers[covered].depth /= 2;
    assert_broken(accel, "is not covered");
    buffer->covers[covered].id ^= 1;
    assert_broken(accel, "is not covered");
    buffer->covers[covered] = cover;

    assert_true(buffer->near_first[1] > 0); /* the first light is inside a sphere */
    buffer->near[0] ^= 1;
    assert_broken(accel, "near list");
    buffer->near[0] ^= 1;
    buffer->near_first[1] += 1; /* one more for the first light, one fewer for the second */
    assert_broken(accel, "near list of light 0");
    buffer->near_first[1] -= 2;
    assert_broken(accel, "near list of light 0");
    buffer->near_first[1] += 1;
    assert_ok(rt_accel_validate(accel, error));
    rt_accel_destroy(accel);
    rt_scene_clear(&scene);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(it_counts_what_was_counted_by_hand),
        cmocka_unit_test(full_occlusion_ends_lists_at_what_covers_a_cell),
        cmocka_unit_test(a_concave_polygon_covers_no_cell_of_its_notch),
        cmocka_unit_test(a_cell_remembers_what_blocked_its_last_ray),
        cmocka_unit_test(lights_in_awkward_places_are_answered_like_brute),
        cmocka_unit_test(rounding_far_off_is_within_the_margin),
        cmocka_unit_test(a_partial_occluder_hides_nothing_beside_it),
        cmocka_unit_test(directions_along_edges_and_corners_are_answered_like_brute),
        cmocka_unit_test(a_receiver_that_faces_the_light_is_not_tested),
        cmocka_unit_test(too_many_cells_are_refused_with_a_number_that_fits),
        cmocka_unit_test(each_broken_invariant_is_named),
    };
    return cmocka_run_group_tests(tests, NULL, assert_nothing_is_kept);
}
