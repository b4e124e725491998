/* The item buffer: how much it decides, that it is never wrong where geometry is awkward, what it passes on,
 * and its invariants broken. */
#include "accel_testing.h"

#include "accel/item/item.h"
#include "base/memory.h"
#include "base/random.h"
#include "render/frame.h"
#include "scene/load.h"
#include "scenes/builtin.h"

#include <math.h>
#include <string.h>

/* ---- frames of the nearest hits ---- */

static void begin_view(RtScene *scene) {
    begin_scene(scene);
    scene->camera.width = 48;
    scene->camera.height = 36;
}

/* From `from` towards `at`. */
static void look(RtScene *scene, RtVec3 from, RtVec3 at) {
    scene->camera.from = from;
    scene->camera.at = at;
}

static RtFrame trace(const char *spec, const RtScene *scene, bool counted) {
    RtAccel *accel;
    RtFrame frame;
    RtFrameOptions options = {.depth = 1, .threads = 2, .counted = counted};
    assert_ok(rt_accel_open(spec, scene, &accel, error));
    assert_ok(rt_accel_validate(accel, error));
    assert_ok(rt_frame_trace(&frame, accel, &options, error));
    rt_accel_destroy(accel);
    return frame;
}

/* Traces the scene by brute and by item over brute, settled and not; the pictures must be the same bytes.
 * Gives the share of rays that item answers when it settles. */
static double decided_share(const RtScene *scene) {
    static const char *const specs[] = {"item:settle=off+brute", "item+brute"};
    RtFrame right = trace("brute", scene, false);
    size_t samples = (size_t)right.sampling.columns * right.sampling.rows;
    double share = 0;
    for (int i = 0; i < 2; i++) {
        RtFrame frame = trace(specs[i], scene, true);
        const RtTally *tally = &frame.tallies[RT_RAY_PRIMARY];
        assert_memory_equal(frame.object, right.object, samples * sizeof *frame.object);
        assert_memory_equal(frame.depth, right.depth, samples * sizeof *frame.depth);
        assert_memory_equal(frame.color, right.color, samples * sizeof *frame.color);
        assert_int_equal(tally->steps, tally->rays);
        share = 1 - (double)tally->passed_on / (double)tally->rays;
        rt_frame_clear(&frame);
    }
    rt_frame_clear(&right);
    return share;
}

/* At least `least` of the rays of the scene, which is finished, are to be decided; clears it. */
static void check_finished(RtScene *scene, double least) {
    double share = decided_share(scene);
    if (!(share >= least)) fail_msg("%.2f %% of the rays are decided", 100 * share);
    rt_scene_clear(scene);
}

static void check_scene(RtScene *scene, double least) {
    assert_ok(rt_scene_finish(scene, error));
    check_finished(scene, least);
}

static void check_decided(const RtScene *scene, const char *name, const char *how) {
    RtAccel *accel;
    RtFrame frame;
    RtFrameOptions options = {.depth = 1, .counted = true};
    assert_ok(rt_accel_open("item+bvh", scene, &accel, error));
    assert_ok(rt_frame_trace(&frame, accel, &options, error));
    const RtTally *tally = &frame.tallies[RT_RAY_PRIMARY];
    double share = 1 - (double)tally->passed_on / (double)tally->rays;
    if (!(share >= 0.97)) fail_msg("%s %s: %.2f %% are decided", name, how, 100 * share);
    rt_frame_clear(&frame);
    rt_accel_destroy(accel);
}

static void nearly_all_primary_rays_of_every_builtin_scene_are_decided(void **state) {
    (void)state;
    for (size_t i = 0; i < rt_builtin_count(); i++) {
        RtScene scene;
        const char *name = rt_builtin_at(i)->name;
        assert_ok(rt_scene_open(name, &scene, error));
        check_decided(&scene, name, "at pixel centres");
        assert_ok(rt_scene_sample(&scene, 0, 0, 1, true, error));
        check_decided(&scene, name, "at pixel corners");
        rt_scene_clear(&scene);
    }
}

static void a_decided_ray_makes_at_most_one_object_test(void **state) {
    (void)state;
    RtScene scene;
    RtAccel *accel;
    RtQuery query;
    RtView view;
    assert_ok(rt_scene_open("random:n=300,shape=mixed", &scene, error));
    assert_ok(rt_scene_sample(&scene, 64, 48, 1, false, error));
    assert_ok(rt_view_init(&view, &scene.camera, scene.sampling, error));
    assert_ok(rt_accel_open("item+bvh", &scene, &accel, error));
    assert_ok(rt_query_init(&query, accel, error));
    uint32_t nothing = 0, seen = 0;
    for (uint32_t i = 0; i < 64 * 48; i++) {
        RtTally tallies[RT_RAY_KIND_COUNT] = {{0}};
        const RtTally *tally = &tallies[RT_RAY_PRIMARY];
        RtRay ray = rt_view_ray(&view, i % 64, i / 64);
        RtHit hit;
        rt_nearest(&query, &ray, 1, &hit, tallies);
        if (tally->passed_on) continue;
        assert_int_equal(tally->object_tests, hit.object != RT_NO_OBJECT);
        assert_int_equal(tally->extent_tests, 0);
        nothing += hit.object == RT_NO_OBJECT;
        seen += hit.object != RT_NO_OBJECT;
    }
    assert_true(nothing > 100 && seen > 100);
    rt_query_clear(&query);
    rt_accel_destroy(accel);
    rt_scene_clear(&scene);
}

static void every_way_to_sample_an_image_is_answered_like_brute(void **state) {
    (void)state;
    const struct {
        uint32_t width, height, samples;
        bool corners;
    } ways[] = {{1, 1, 1, false},  {1, 1, 1, true},    {1, 40, 2, false},
                {40, 1, 3, false}, {17, 23, 4, false}, {33, 20, 1, true}};
    RtScene scene;
    assert_ok(rt_scene_open("random:n=100,shape=mixed", &scene, error));
    for (size_t i = 0; i < sizeof ways / sizeof ways[0]; i++) {
        assert_ok(
            rt_scene_sample(&scene, ways[i].width, ways[i].height, ways[i].samples, ways[i].corners, error));
        assert_true(decided_share(&scene) >= 0.97);
    }
    rt_scene_clear(&scene);
}

/* ---- awkward geometry ---- */

static void polygons_through_the_plane_of_the_eye_are_drawn_right(void **state) {
    (void)state;
    const RtVec3 floor[4] = {{{-50, -50, 0}}, {{50, -50, 0}}, {{50, 50, 0}}, {{-50, 50, 0}}};
    const RtVec3 wall[3] = {{{2, -30, -1}}, {{2, 30, -1}}, {{2, 5, 9}}};
    RtScene scene;
    begin_view(&scene);
    look(&scene, rt_vec3(0, 0, 1.5f), rt_vec3(0.2f, 4, 1));
    scene.camera.fov = 100;
    assert_ok(rt_scene_add_polygon(&scene, 0, floor, 4, error));
    assert_ok(rt_scene_add_triangle(&scene, 0, wall, NULL, error));
    assert_ok(rt_scene_add_sphere(&scene, 0, rt_vec3(0, -3, 1), 1, error)); /* behind */
    assert_ok(rt_scene_add_sphere(&scene, 0, rt_vec3(1, 5, 0.5f), 1, error));
    check_scene(&scene, 0.97);
}

static void objects_all_around_the_eye_are_drawn_right(void **state) {
    (void)state;
    RtRandom random = rt_random(11, 0);
    for (int k = 0; k < 24; k++) {
        RtScene scene;
        begin_view(&scene);
        scene.camera.fov = k % 3 == 0 ? 170 : k % 3 == 1 ? 60 : 179.9999f;
        scene.camera.hither = k % 4 == 0 ? 0.25f : 0;
        scene.camera.up = rt_vec3(0.1f, 0.3f, 1);
        RtVec3 eye = rt_narrow(rt_scaled(rt_random_direction(&random), k % 6 == 5 ? 1000 : 0.5));
        look(&scene, eye, rt_narrow(rt_addd(rt_widen(eye), rt_random_direction(&random))));
        for (int i = 0; i < 60; i++) {
            RtVec3 p[4];
            for (int j = 0; j < 4; j++) {
                p[j] =
                    rt_narrow(rt_addd(rt_widen(eye), rt_scaled(rt_random_direction(&random), 0.1 * (i + 1))));
            }
            if (i % 3 == 0) assert_ok(rt_scene_add_triangle(&scene, 0, p, NULL, error));
            if (i % 3 == 1) assert_ok(rt_scene_add_sphere(&scene, 0, p[0], 0.02f * (float)(i + 1), error));
            if (i % 6 == 2) assert_ok(rt_scene_add_cone(&scene, 0, p[0], 0.1f, p[1], 0.3f, error));
            if (i % 6 == 5) assert_ok(rt_scene_add_polygon(&scene, 0, p, 3, error));
        }
        check_scene(&scene, 0.97);
    }
}

static void an_eye_inside_a_sphere_sees_its_inside(void **state) {
    (void)state;
    RtScene scene;
    begin_view(&scene);
    look(&scene, rt_vec3(0.5f, 0, 0), rt_vec3(-1, 0.25f, 0.5f));
    assert_ok(rt_scene_add_sphere(&scene, 0, rt_vec3(0, 0, 0), 2, error));
    assert_ok(rt_scene_add_sphere(&scene, 0, rt_vec3(-1, 0, 0), 0.5f, error));
    check_scene(&scene, 1);
}

static void an_eye_in_the_plane_of_a_polygon_or_at_its_corner_is_no_trouble(void **state) {
    (void)state;
    const RtVec3 square[4] = {{{-1, -1, 0}}, {{1, -1, 0}}, {{1, 1, 0}}, {{-1, 1, 0}}};
    const RtVec3 eyes[] = {{{0, -4, 0}}, {{0, 0, 0}}, {{-1, -1, 0}}, {{0, -4, 1e-6f}}, {{0, 0, 1e-5f}}};
    for (size_t i = 0; i < sizeof eyes / sizeof eyes[0]; i++) {
        RtScene scene;
        begin_view(&scene);
        look(&scene, eyes[i], rt_vec3(0.125f, 0.25f, i == 4 ? -0.5f : 0));
        assert_ok(rt_scene_add_polygon(&scene, 0, square, 4, error));
        assert_ok(rt_scene_add_triangle(&scene, 0, square, NULL, error));
        assert_ok(rt_scene_add_sphere(&scene, 0, rt_vec3(0, 0, -1), 0.75f, error));
        check_scene(&scene, 0.97);
    }
}

/* A floor seen so flat that where it is hit is known to a tenth, with a ball in doubt from within on: what is
 * undecided is no nearer than it says, for the floor, no longer named, is one of the others. */
static void an_undecided_sample_says_from_where_on_all_objects_are(void **state) {
    (void)state;
    const RtVec3 floor[4] = {{{-50, -50, 0}}, {{50, -50, 0}}, {{50, 50, 0}}, {{-50, 50, 0}}};
    RtScene scene;
    begin_view(&scene);
    look(&scene, rt_vec3(0, 0, 0x1p-10f), rt_vec3(0, 8, 0x1p-10f));
    scene.camera.fov = 0.1f;
    assert_ok(rt_scene_add_polygon(&scene, 0, floor, 4, error));
    assert_ok(rt_scene_add_sphere(&scene, 0, rt_vec3(0, 10.4f, 0), 2, error));
    check_scene(&scene, 0.97);
}

/* 5 x 5 samples of a picture 2 wide at distance 1: one every 0.4, the middle one on the axis. */
static void an_object_smaller_than_a_sample_is_seen_on_one_and_not_between(void **state) {
    (void)state;
    for (int on = 0; on < 2; on++) {
        RtScene scene;
        float x = on ? 0 : 0.2f;
        const RtVec3 triangle[3] = {{{x - 1e-4f, 1, -1e-4f}}, {{x + 1e-4f, 1, -1e-4f}}, {{x, 1, 1e-4f}}};
        begin_view(&scene);
        scene.camera.width = scene.camera.height = 5;
        scene.camera.fov = 90;
        look(&scene, rt_vec3(0, 0, 0), rt_vec3(0, 1, 0));
        assert_ok(rt_scene_add_triangle(&scene, 0, triangle, NULL, error));
        assert_ok(rt_scene_add_sphere(&scene, 0, rt_vec3(-0.8f + x, 2, 0), 1e-4f, error));
        assert_ok(rt_scene_finish(&scene, error));
        RtFrame frame = trace("item+brute", &scene, true);
        assert_int_equal(frame.tallies[RT_RAY_PRIMARY].passed_on, 0);
        assert_int_equal(frame.tallies[RT_RAY_PRIMARY].hits, on ? 2 : 0);
        assert_int_equal(frame.object[12], on ? 0 : RT_NO_OBJECT);
        assert_int_equal(frame.object[11], on ? 1 : RT_NO_OBJECT);
        rt_frame_clear(&frame);
        check_finished(&scene, 1);
    }
}

/* The same square several times, last ids in front by 0 to 4 ulps of its depth. */
static void coincident_and_nearly_coplanar_polygons_are_told_apart(void **state) {
    (void)state;
    for (int ulps = 0; ulps <= 4; ulps++) {
        RtScene scene;
        begin_view(&scene);
        look(&scene, rt_vec3(0.3f, -7, 0.2f), rt_vec3(0, 0, 0));
        float y = 1;
        for (int i = 0; i < 4; i++) {
            const RtVec3 square[4] = {{{-1, y, -1}}, {{1, y, -1}}, {{1, y, 1}}, {{-1, y, 1}}};
            if (i % 2) assert_ok(rt_scene_add_triangle(&scene, 0, square, NULL, error));
            assert_ok(rt_scene_add_polygon(&scene, 0, square, 4, error));
            for (int k = 0; k < ulps; k++) y = nextafterf(y, 0);
        }
        check_scene(&scene, 1);
    }
}

static void touching_and_coincident_spheres_are_told_apart(void **state) {
    (void)state;
    RtScene scene;
    begin_view(&scene);
    look(&scene, rt_vec3(0, -8, 0), rt_vec3(0, 0, 0));
    for (int i = 0; i < 3; i++) {
        assert_ok(rt_scene_add_sphere(&scene, 0, rt_vec3(1, (float)i, 0), 1, error));
        assert_ok(rt_scene_add_sphere(&scene, 0, rt_vec3(-1, 0, 0), 1, error));
        assert_ok(rt_scene_add_sphere(&scene, 0, rt_vec3(1, (float)i - 0.5f, 0), 0.5f, error));
    }
    check_scene(&scene, 1);
}

static void the_hither_plane_hides_what_is_before_it(void **state) {
    (void)state;
    const RtVec3 pane[4] = {{{-3, 1, -3}}, {{3, 1, -3}}, {{3, 1, 3}}, {{-3, 1, 3}}};
    const float planes[] = {0.5f, 0x1.fffffep-1f, 1, 0x1.000002p+0f, 4.25f, 5, 100};
    for (size_t i = 0; i < sizeof planes / sizeof planes[0]; i++) {
        RtScene scene;
        begin_view(&scene);
        look(&scene, rt_vec3(0, 0, 0), rt_vec3(0, 1, 0));
        scene.camera.hither = planes[i];
        assert_ok(rt_scene_add_polygon(&scene, 0, pane, 4, error));
        assert_ok(rt_scene_add_sphere(&scene, 0, rt_vec3(0, 5, 0), 1, error)); /* cut open at 4.25 */
        check_scene(&scene, 0.97);
    }
}

/* A pentagram turns left at every corner; a notch turns right at one. */
static void concave_polygons_are_not_taken_for_convex_ones(void **state) {
    (void)state;
    const RtVec3 notched[5] = {{{-2, 0, -2}}, {{2, 0, -2}}, {{2, 0, 2}}, {{0, 0, -1}}, {{-2, 0, 2}}};
    RtVec3 star[5];
    for (int i = 0; i < 5; i++) {
        double angle = 2 * i * 2 * 3.14159265358979 / 5;
        star[i] = rt_vec3((float)cos(angle), -1, (float)sin(angle));
    }
    for (int side = -1; side <= 1; side += 2) {
        RtScene scene;
        begin_view(&scene);
        look(&scene, rt_vec3(0.5f, 6 * (float)side, 0.25f), rt_vec3(0, 0, 0));
        assert_ok(rt_scene_add_polygon(&scene, 0, notched, 5, error));
        assert_ok(rt_scene_add_polygon(&scene, 0, star, 5, error));
        check_scene(&scene, 1);
    }
}

/* A triangle that reaches far to both sides, with an upper edge a little below the rays of one row: its hit
 * function rounds as befits its size, and says of some of these rays that they hit. */
static void what_is_hit_by_rounding_alone_is_drawn_as_hit(void **state) {
    (void)state;
    RtRandom random = rt_random(17, 0);
    uint32_t beyond = 0;
    for (uint32_t row = 0; row < 36; row++) {
        RtScene scene;
        RtView view;
        begin_view(&scene);
        look(&scene, rt_vec3(0, 0, 0), rt_vec3(0, 1, 0));
        scene.camera.fov = 150;
        assert_ok(rt_sampling_init(&scene.sampling, 48, 36, 1, false, error));
        assert_ok(rt_view_init(&view, &scene.camera, scene.sampling, error));
        float z = rt_view_ray(&view, 0, row).dir.z - 2e-4f, far = 3e4f * (1 + rt_random_unit(&random));
        const RtVec3 triangle[3] = {{{-far, 1, z}}, {{far, 1, z}}, {{0, 1, z - 100}}};
        assert_ok(rt_scene_add_triangle(&scene, 0, triangle, NULL, error));
        assert_ok(rt_scene_finish(&scene, error));
        RtFrame frame = trace("brute", &scene, false);
        for (uint32_t i = row * 48; i < (row + 1) * 48; i++) beyond += frame.object[i] == 0;
        rt_frame_clear(&frame);
        check_finished(&scene, 1);
    }
    assert_true(beyond > 20);
}

static void scenes_far_off_tiny_or_huge_are_drawn_right(void **state) {
    (void)state;
    const float sizes[] = {1e-30f, 1e-3f, 1, 1e15f}, places[] = {0, 0, 1e4f, 0};
    for (int k = 0; k < 4; k++) {
        RtScene scene;
        RtRandom random = rt_random(3, (uint64_t)k);
        begin_view(&scene);
        for (int i = 0; i < 80; i++) {
            RtVec3 p[3];
            for (int j = 0; j < 3; j++) {
                p[j] = rt_narrow(rt_scaled(rt_random_direction(&random), (double)sizes[k]));
                p[j] = rt_add(p[j], rt_vec3(places[k], places[k], places[k]));
            }
            if (i % 2)
                assert_ok(rt_scene_add_triangle(&scene, 0, p, NULL, error));
            else
                assert_ok(rt_scene_add_sphere(&scene, 0, p[0], sizes[k] / 8, error));
        }
        check_scene(&scene, 0.97);
    }
}

static void a_scene_without_objects_is_nothing_everywhere(void **state) {
    (void)state;
    RtScene scene;
    RtDescription d;
    RtAccel *accel;
    begin_view(&scene);
    assert_ok(rt_scene_finish(&scene, error));
    assert_ok(rt_accel_open("item+brute", &scene, &accel, error));
    rt_accel_describe(accel, &d);
    assert_int_equal(d.leaves, 48 * 36);
    assert_int_equal(d.empty_leaves, 48 * 36);
    assert_int_equal(d.references, 0);
    rt_accel_destroy(accel);
    check_finished(&scene, 1);
}

/* ---- what is passed on ---- */

static void rays_that_are_not_of_a_sample_are_passed_on(void **state) {
    (void)state;
    RtScene scene;
    RtAccel *accel;
    RtQuery query;
    RtView view;
    begin_view(&scene);
    assert_ok(rt_scene_add_sphere(&scene, 0, rt_vec3(0, 0, 0), 1, error));
    assert_ok(rt_scene_finish(&scene, error));
    assert_ok(rt_view_init(&view, &scene.camera, scene.sampling, error));
    assert_ok(rt_accel_open("item+brute", &scene, &accel, error));
    assert_ok(rt_query_init(&query, accel, error));
    enum { RAYS = 9 };
    RtRay own = rt_view_ray(&view, 24, 18), rays[RAYS];
    for (int i = 0; i < RAYS; i++) rays[i] = own;
    rays[1].source++;
    rays[2].source = 48 * 36;
    rays[3].source = UINT32_MAX;
    rays[4].org.x = nextafterf(rays[4].org.x, 0);
    rays[5].dir.y = nextafterf(rays[5].dir.y, 0);
    rays[6].tmax = 1e6f;
    rays[7].tmin = 1e-6f;
    rays[8].kind = RT_RAY_REFLECTION; /* none of its business */
    for (int i = 0; i < RAYS; i++) {
        RtTally tallies[RT_RAY_KIND_COUNT] = {{0}};
        RtHit hit;
        bool blocked;
        rt_nearest(&query, &rays[i], 1, &hit, tallies);
        assert_int_equal(hit.object, 0);
        assert_int_equal(tallies[rays[i].kind].passed_on, i > 0 && i < 8);
        assert_int_equal(tallies[rays[i].kind].rays, 1);
        /* Whether anything is in the way is not what samples are for. */
        rt_occluded(&query, &rays[i], 1, &blocked, tallies);
        assert_true(blocked);
        assert_int_equal(tallies[rays[i].kind].passed_on, i > 0 && i < 8);
        assert_int_equal(tallies[rays[i].kind].rays, 2);
    }
    /* In one stream, runs of other kinds among them. */
    RtTally tallies[RT_RAY_KIND_COUNT] = {{0}};
    RtHit hits[RAYS];
    rt_nearest(&query, rays, RAYS, hits, tallies);
    assert_int_equal(tallies[RT_RAY_PRIMARY].passed_on, 7);
    assert_int_equal(tallies[RT_RAY_PRIMARY].rays, 8);
    assert_int_equal(tallies[RT_RAY_REFLECTION].rays, 1);
    rt_query_clear(&query);
    rt_accel_destroy(accel);
    rt_scene_clear(&scene);
}

static void a_frame_of_another_sampling_is_passed_on_whole_and_right(void **state) {
    (void)state;
    RtScene scene;
    RtAccel *accel;
    RtFrame frame;
    RtFrameOptions options = {.depth = 1, .threads = 1, .counted = true};
    begin_view(&scene);
    assert_ok(rt_scene_add_sphere(&scene, 0, rt_vec3(0, 0, 0), 1, error));
    assert_ok(rt_scene_finish(&scene, error));
    assert_ok(rt_accel_open("item+brute", &scene, &accel, error));
    assert_ok(rt_scene_sample(&scene, 31, 19, 1, false, error));
    RtFrame right = trace("brute", &scene, false);
    assert_ok(rt_frame_trace(&frame, accel, &options, error));
    assert_int_equal(frame.tallies[RT_RAY_PRIMARY].passed_on, 31 * 19);
    assert_memory_equal(frame.depth, right.depth, sizeof(float) * 31 * 19);
    rt_frame_clear(&frame);
    rt_frame_clear(&right);
    rt_accel_destroy(accel);
    rt_scene_clear(&scene);
}

/* ---- limits, and invariants broken ---- */

static void too_many_samples_are_refused_with_a_number_that_fits(void **state) {
    (void)state;
    const struct {
        uint32_t width, height, samples;
        const char *says;
    } sizes[] = {{32768, 32768, 1, "an image of 146"},
                 {32768, 32768, 64, "an image of"},
                 {2048, 2048, 64, "7 samples a side"}};
    RtScene scene;
    begin_view(&scene);
    assert_ok(rt_scene_finish(&scene, error));
    for (size_t i = 0; i < sizeof sizes / sizeof sizes[0]; i++) {
        RtAccel *accel;
        assert_ok(rt_scene_sample(&scene, sizes[i].width, sizes[i].height, sizes[i].samples, false, error));
        RtError error = {RT_OK, ""};
        assert_int_equal(rt_accel_open("item+brute", &scene, &accel, &error), RT_BAD_INPUT);
        if (!strstr(error.message, sizes[i].says)) fail_msg("%s", error.message);
    }
    rt_scene_clear(&scene);
}

static void each_broken_invariant_is_named(void **state) {
    (void)state;
    RtScene scene;
    RtAccel *accel;
    begin_view(&scene);
    look(&scene, rt_vec3(0, -8, 0), rt_vec3(0, 0, 0));
    assert_ok(rt_scene_add_sphere(&scene, 0, rt_vec3(0, 4, 0), 1, error));
    assert_ok(rt_scene_add_sphere(&scene, 0, rt_vec3(0, 0, 0), 1, error));
    assert_ok(rt_scene_finish(&scene, error));
    assert_ok(rt_accel_open("item+brute", &scene, &accel, error));
    assert_ok(rt_accel_validate(accel, error));
    RtItemSample *middle = &((RtItemBuffer *)accel)->samples[18 * 48 + 24], kept = *middle;
    assert_int_equal(kept.id, 1);
    assert_true(kept.other > 10 && kept.other < 12); /* the far sphere begins at 11 */
    middle->other = INFINITY;
    assert_broken(accel, "meets object 0");
    *middle = (RtItemSample){0, kept.other};
    assert_broken(accel, "meets object 1");
    *middle = (RtItemSample){RT_NO_OBJECT, INFINITY};
    assert_broken(accel, "meets object");
    *middle = (RtItemSample){RT_NO_OBJECT, kept.other};
    assert_broken(accel, "names object");
    *middle = (RtItemSample){2, kept.other};
    assert_broken(accel, "names object 2");
    *middle = kept;
    assert_ok(rt_accel_validate(accel, error));
    rt_accel_destroy(accel);
    rt_scene_clear(&scene);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(nearly_all_primary_rays_of_every_builtin_scene_are_decided),
        cmocka_unit_test(a_decided_ray_makes_at_most_one_object_test),
        cmocka_unit_test(every_way_to_sample_an_image_is_answered_like_brute),
        cmocka_unit_test(polygons_through_the_plane_of_the_eye_are_drawn_right),
        cmocka_unit_test(objects_all_around_the_eye_are_drawn_right),
        cmocka_unit_test(an_eye_inside_a_sphere_sees_its_inside),
        cmocka_unit_test(an_eye_in_the_plane_of_a_polygon_or_at_its_corner_is_no_trouble),
        cmocka_unit_test(an_undecided_sample_says_from_where_on_all_objects_are),
        cmocka_unit_test(an_object_smaller_than_a_sample_is_seen_on_one_and_not_between),
        cmocka_unit_test(coincident_and_nearly_coplanar_polygons_are_told_apart),
        cmocka_unit_test(touching_and_coincident_spheres_are_told_apart),
        cmocka_unit_test(the_hither_plane_hides_what_is_before_it),
        cmocka_unit_test(concave_polygons_are_not_taken_for_convex_ones),
        cmocka_unit_test(what_is_hit_by_rounding_alone_is_drawn_as_hit),
        cmocka_unit_test(scenes_far_off_tiny_or_huge_are_drawn_right),
        cmocka_unit_test(a_scene_without_objects_is_nothing_everywhere),
        cmocka_unit_test(rays_that_are_not_of_a_sample_are_passed_on),
        cmocka_unit_test(a_frame_of_another_sampling_is_passed_on_whole_and_right),
        cmocka_unit_test(too_many_samples_are_refused_with_a_number_that_fits),
        cmocka_unit_test(each_broken_invariant_is_named),
    };
    return cmocka_run_group_tests(tests, NULL, assert_nothing_is_kept);
}
