/* render/: shading, secondary rays and frames, against answers known by hand. */
#include "testing.h"

#include "base/memory.h"
#include "render/frame.h"
#include "render/illumination.h"

#include <pthread.h>
#include <string.h>

#define assert_near(a, b, within) assert_true(fabs((double)(a) - (double)(b)) <= (within))

/* A scene with one material of index 0, a black background, and a camera on the z axis looking down. */
static void start_scene(RtScene *scene, RtMaterial material) {
    uint32_t index;
    rt_scene_init(scene);
    assert_ok(rt_scene_add_material(scene, &material, &index, error));
    scene->background = rt_vec3(0, 0, 0);
    scene->camera =
        (RtCamera){.from = {0, 0, 10}, .at = {0, 0, 0}, .up = {0, 1, 0}, .fov = 40, .width = 1, .height = 1};
}

static void add_square(RtScene *scene, float half, float z) {
    RtVec3 corners[4] = {{-half, -half, z}, {half, -half, z}, {half, half, z}, {-half, half, z}};
    assert_ok(rt_scene_add_polygon(scene, 0, corners, 4, error));
}

static RtFrameOptions options_for(RtScene *scene, uint32_t width, uint32_t height, bool corners) {
    assert_ok(rt_scene_sample(scene, width, height, 1, corners, error));
    return (RtFrameOptions){.depth = 5, .threads = 1};
}

static RtFrame trace(const RtScene *scene, const RtFrameOptions *options) {
    RtFrame frame;
    RtAccel *accel;
    assert_ok(rt_accel_open("brute", scene, &accel, error));
    assert_ok(rt_frame_trace(&frame, accel, options, error));
    rt_accel_destroy(accel);
    return frame;
}

/* The surface that a ray towards the only object of `scene` meets. */
static RtSurface surface_of(const RtScene *scene, RtVec3 org, RtVec3 dir, float t) {
    RtRay ray = {.org = org, .dir = dir, .tmax = INFINITY};
    return rt_surface(scene, &ray, (RtHit){t, 0});
}

/* ---- illumination ---- */

static void a_point_is_shaded_by_the_sum_of_all_five_terms(void **state) {
    (void)state;
    /* Looking down on a mirror floor. The light stands at 45 degrees: N.L = sqrt(1/2), and the mirrored light
     * makes 45 degrees with the viewer too, so (R.V)^2 = 1/2. Reflection and transmission see the background.
     */
    RtScene scene;
    start_scene(&scene, (RtMaterial){.color = {0.5f, 1, 0},
                                     .ambient = 0.1f,
                                     .diffuse = 0.4f,
                                     .specular = 0.3f,
                                     .shine = 2,
                                     .reflection = 0.25f,
                                     .transmission = 0.125f,
                                     .ior = 1});
    scene.ambient = rt_vec3(1, 0.5f, 1);
    scene.background = rt_vec3(0, 0, 0.8f);
    add_square(&scene, 1, 0);
    assert_ok(rt_scene_add_light(&scene, rt_vec3(5, 0, 5), rt_vec3(2, 1, 1), error));
    assert_ok(rt_scene_finish(&scene, error));
    RtFrameOptions options = options_for(&scene, 1, 1, false);
    RtFrame frame = trace(&scene, &options);
    double cosine = sqrt(0.5);
    assert_near(frame.color[0].x, 0.1 * 0.5 * 1 + 2 * (0.4 * cosine * 0.5 + 0.3 * 0.5), 1e-5);
    assert_near(frame.color[0].y, 0.1 * 1 * 0.5 + 1 * (0.4 * cosine * 1 + 0.3 * 0.5), 1e-5);
    assert_near(frame.color[0].z, 0.3 * 0.5 + 0.25 * 0.8 + 0.125 * 0.8, 1e-5);
    assert_int_equal(frame.object[0], 0);
    assert_near(frame.depth[0], 10, 1e-5);
    rt_frame_clear(&frame);
    rt_scene_clear(&scene);
}

static void an_object_between_point_and_light_takes_the_light_away(void **state) {
    (void)state;
    RtScene scene;
    start_scene(&scene, (RtMaterial){.color = {1, 1, 1}, .diffuse = 1, .ior = 1});
    add_square(&scene, 1, 0);
    assert_ok(rt_scene_add_sphere(&scene, 0, rt_vec3(2, 0, 2), 0.5f, error));
    assert_ok(rt_scene_add_light(&scene, rt_vec3(4, 0, 4), rt_vec3(1, 1, 1), error));
    assert_ok(rt_scene_finish(&scene, error));
    RtFrameOptions options = options_for(&scene, 1, 1, false);
    RtFrame frame = trace(&scene, &options);
    assert_true(frame.color[0].x == 0);
    rt_frame_clear(&frame);
    /* An object behind the light takes nothing. */
    scene.lights[0].position = rt_vec3(1, 0, 1);
    frame = trace(&scene, &options);
    assert_near(frame.color[0].x, sqrt(0.5), 1e-5);
    rt_frame_clear(&frame);
    rt_scene_clear(&scene);
}

static void shadow_rays_go_to_lights_on_the_viewers_side_alone(void **state) {
    (void)state;
    RtScene scene;
    start_scene(&scene, (RtMaterial){.color = {1, 1, 1}, .diffuse = 1, .ior = 1});
    add_square(&scene, 1, 0);
    assert_ok(rt_scene_add_light(&scene, rt_vec3(0, 0, 5), rt_vec3(1, 1, 1), error));
    assert_ok(rt_scene_add_light(&scene, rt_vec3(0, 0, -5), rt_vec3(1, 1, 1), error));
    assert_ok(rt_scene_add_light(&scene, rt_vec3(5, 0, 0), rt_vec3(1, 1, 1), error));
    assert_ok(rt_scene_finish(&scene, error));
    RtSurface above = surface_of(&scene, rt_vec3(0, 0, 10), rt_vec3(0, 0, -1), 10);
    RtSurface below = surface_of(&scene, rt_vec3(0, 0, -10), rt_vec3(0, 0, 1), 10);
    RtRay ray;
    RtVec3 light;
    assert_true(rt_shadow_ray(&scene, &above, 0, &ray, &light));
    assert_true(ray.kind == RT_RAY_SHADOW && ray.source == 0 && ray.tmax == 1 && ray.org.z > 0);
    assert_true(ray.org.z + ray.dir.z == 5);
    assert_false(rt_shadow_ray(&scene, &above, 1, &ray, &light));
    assert_false(rt_shadow_ray(&scene, &above, 2, &ray, &light)); /* grazing: N.L = 0 */
    assert_false(rt_shadow_ray(&scene, &below, 0, &ray, &light));
    assert_true(rt_shadow_ray(&scene, &below, 1, &ray, &light));
    assert_true(ray.org.z < 0);
    rt_scene_clear(&scene);
}

static void glass(RtScene *scene, float reflection) {
    start_scene(scene, (RtMaterial){.transmission = 0.5f, .reflection = reflection, .ior = 1.5f});
    add_square(scene, 10, 0);
    assert_ok(rt_scene_finish(scene, error));
}

static void a_ray_into_glass_bends_by_snells_law_and_back_out(void **state) {
    (void)state;
    RtScene scene;
    glass(&scene, 0.25f);
    RtRay rays[RT_MAX_SPAWN];
    float factors[RT_MAX_SPAWN];
    /* sin 30 / sin x = 1.5: sin x = 1/3. */
    RtVec3 into = rt_vec3(0.5f, 0, -(float)sqrt(0.75));
    RtSurface surface = surface_of(&scene, rt_scale(into, -4), into, 4);
    assert_int_equal(rt_spawn_rays(&surface, rays, factors), 2);
    assert_int_equal(rays[0].kind, RT_RAY_REFLECTION);
    assert_near(rays[0].dir.x, 0.5, 1e-6);
    assert_near(rays[0].dir.z, sqrt(0.75), 1e-6);
    assert_true(rays[0].org.z > 0 && factors[0] == 0.25f);
    assert_int_equal(rays[1].kind, RT_RAY_TRANSMISSION);
    assert_near(rays[1].dir.x, 1.0 / 3, 1e-6);
    assert_near(rays[1].dir.z, -sqrt(8.0 / 9), 1e-6);
    assert_true(rays[1].org.z < 0 && factors[1] == 0.5f);

    /* The way back, from behind the normal. */
    RtVec3 out = rt_vec3(1.0f / 3, 0, (float)sqrt(8.0 / 9));
    surface = surface_of(&scene, rt_scale(out, -4), out, 4);
    assert_int_equal(rt_spawn_rays(&surface, rays, factors), 2);
    assert_near(rays[1].dir.x, 0.5, 1e-6);
    assert_near(rays[1].dir.z, sqrt(0.75), 1e-6);
    rt_scene_clear(&scene);
}

static void total_internal_reflection_is_one_reflection_ray_with_both_factors(void **state) {
    (void)state;
    /* The critical angle of 1.5 has the sine 2/3. */
    for (int with_mirror = 0; with_mirror < 2; with_mirror++) {
        RtScene scene;
        glass(&scene, with_mirror ? 0.25f : 0);
        RtRay rays[RT_MAX_SPAWN];
        float factors[RT_MAX_SPAWN];
        for (int steep = 0; steep < 2; steep++) {
            float sine = steep ? 0.66f : 0.67f;
            RtVec3 out = rt_vec3(sine, 0, (float)sqrt(1 - (double)sine * (double)sine));
            RtSurface surface = surface_of(&scene, rt_scale(out, -4), out, 4);
            uint32_t count = rt_spawn_rays(&surface, rays, factors);
            if (steep) {
                assert_int_equal(count, 1 + with_mirror);
                continue;
            }
            assert_int_equal(count, 1);
            assert_int_equal(rays[0].kind, RT_RAY_REFLECTION);
            assert_true(factors[0] == (with_mirror ? 0.75f : 0.5f));
            assert_true(rays[0].org.z < 0 && rays[0].dir.z < 0);
        }
        rt_scene_clear(&scene);
    }
}

/* ---- frames ---- */

static void two_mirrors_return_a_ray_as_often_as_the_depth_allows(void **state) {
    (void)state;
    RtScene scene;
    start_scene(&scene, (RtMaterial){.color = {1, 1, 1}, .ambient = 1, .reflection = 0.5f, .ior = 1});
    add_square(&scene, 1000, 0);
    add_square(&scene, 1000, 20);
    assert_ok(rt_scene_finish(&scene, error));
    const uint32_t depths[] = {1, 2, 5, RT_MAX_DEPTH};
    for (size_t i = 0; i < sizeof depths / sizeof depths[0]; i++) {
        RtFrameOptions options = options_for(&scene, 1, 1, false);
        options.depth = depths[i];
        options.counted = true;
        RtFrame frame = trace(&scene, &options);
        assert_int_equal(frame.tallies[RT_RAY_PRIMARY].rays, 1);
        assert_int_equal(frame.tallies[RT_RAY_REFLECTION].rays, depths[i] - 1);
        /* 1 + 1/2 + 1/4 + ... */
        assert_near(frame.color[0].x, 2 - pow(0.5, depths[i] - 1), 1e-5);
        rt_frame_clear(&frame);
    }
    rt_scene_clear(&scene);
}

/* Mirrors, glass and matte, of every shape, over a floor, under two lights. */
static void busy_scene(RtScene *scene) {
    start_scene(scene, rt_default_material());
    RtMaterial others[2] = {
        {.color = {1, 0.5f, 0.2f},
         .diffuse = 0.5f,
         .specular = 0.5f,
         .shine = 9,
         .reflection = 0.5f,
         .ior = 1},
        {.color = {1, 1, 1}, .diffuse = 0.1f, .reflection = 0.1f, .transmission = 0.9f, .ior = 1.5f}};
    uint32_t mirror, clear;
    assert_ok(rt_scene_add_material(scene, &others[0], &mirror, error));
    assert_ok(rt_scene_add_material(scene, &others[1], &clear, error));
    add_square(scene, 6, -1);
    for (int i = 0; i < 5; i++) {
        float x = (float)i - 2;
        assert_ok(rt_scene_add_sphere(scene, mirror, rt_vec3(x, x * x / 4, 0), 0.45f, error));
        assert_ok(rt_scene_add_sphere(scene, clear, rt_vec3(x, -1 + x * x / 4, 1), 0.4f, error));
    }
    for (int i = 0; i < 3; i++) { /* panes over the left half: rays multiply */
        float z = 2 + (float)i;
        RtVec3 pane[4] = {{-6, -6, z}, {0, -6, z}, {0, 6, z}, {-6, 6, z}};
        assert_ok(rt_scene_add_polygon(scene, clear, pane, 4, error));
    }
    RtVec3 corners[3] = {{-2, 2, 0}, {2, 2, 0}, {0, 2.5f, 2}},
           normals[3] = {{0, -1, 1}, {0, -1, 1}, {0, -1, 0}};
    assert_ok(rt_scene_add_triangle(scene, mirror, corners, normals, error));
    assert_ok(rt_scene_add_cone(scene, 0, rt_vec3(-2, -2, -1), 0.5f, rt_vec3(-2, -2, 1), 0.2f, error));
    assert_ok(rt_scene_add_light(scene, rt_vec3(3, 4, 8), rt_vec3(0.6f, 0.6f, 0.6f), error));
    assert_ok(rt_scene_add_light(scene, rt_vec3(-5, 0, 4), rt_vec3(0.5f, 0.4f, 0.4f), error));
    assert_ok(rt_scene_finish(scene, error));
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

static void a_frame_is_the_same_bytes_on_any_number_of_threads_counted_or_timed(void **state) {
    (void)state;
    RtScene scene;
    busy_scene(&scene);
    RtFrameOptions options = options_for(&scene, 70, 41, false);
    options.depth = 7; /* streams above 1024 rays are cut */
    options.counted = true;
    RtFrame one = trace(&scene, &options);
    assert_true(one.tallies[RT_RAY_TRANSMISSION].rays > 2 * one.tallies[RT_RAY_PRIMARY].rays);
    for (int threads = 1; threads <= 3; threads++) {
        for (int counted = 0; counted < 2; counted++) {
            options.threads = threads;
            options.counted = counted == 1;
            RtFrame other = trace(&scene, &options);
            assert_same_frames(&one, &other);
            rt_frame_clear(&other);
        }
    }
    rt_frame_clear(&one);
    rt_scene_clear(&scene);
}

static void what_the_samples_cost_adds_up_to_the_tallies_by_kind(void **state) {
    (void)state;
    RtScene scene;
    busy_scene(&scene);
    RtFrameOptions options = options_for(&scene, 20, 20, false);
    options.counted = true;
    RtFrame frame = trace(&scene, &options);
    RtTally by_sample = {0}, by_kind = {0};
    for (size_t i = 0; i < 400; i++) rt_tally_add(&by_sample, &frame.cost[i]);
    for (int kind = 0; kind < RT_RAY_KIND_COUNT; kind++) rt_tally_add(&by_kind, &frame.tallies[kind]);
    assert_memory_equal(&by_sample, &by_kind, sizeof by_kind);
    /* brute tests every object for every ray, until a shadow ray is blocked */
    const RtTally *primary = &frame.tallies[RT_RAY_PRIMARY];
    assert_int_equal(primary->rays, 400);
    assert_int_equal(primary->object_tests, primary->rays * scene.geometry.object_count);
    rt_frame_clear(&frame);
    rt_scene_clear(&scene);
}

static void corner_sampling_traces_one_more_ray_than_pixels_a_side(void **state) {
    (void)state;
    RtScene scene;
    busy_scene(&scene);
    RtFrameOptions options = options_for(&scene, 32, 16, true);
    options.counted = true;
    options.depth = 1;
    RtFrame frame = trace(&scene, &options);
    assert_int_equal(frame.tallies[RT_RAY_PRIMARY].rays, 33 * 17);
    rt_frame_clear(&frame);
    rt_scene_clear(&scene);
}

/* Counts rays by kind, and the tiles that came. */
typedef struct Seen {
    pthread_mutex_t lock;
    uint64_t rays[RT_RAY_KIND_COUNT];
    uint64_t invalid;
    size_t fail_at_tile; /* SIZE_MAX: never */
} Seen;

static RtStatus see(void *context, size_t tile, const RtRay *rays, size_t count, RtError *error) {
    Seen *seen = context;
    if (tile == seen->fail_at_tile) return rt_fail(error, RT_MISMATCH, "tile %zu", tile);
    pthread_mutex_lock(&seen->lock);
    for (size_t i = 0; i < count; i++) {
        seen->rays[rays[i].kind]++;
        seen->invalid += !rt_ray_is_valid(&rays[i]);
    }
    pthread_mutex_unlock(&seen->lock);
    return RT_OK;
}

static void the_sink_sees_every_ray_that_is_counted(void **state) {
    (void)state;
    RtScene scene;
    busy_scene(&scene);
    Seen seen = {.lock = PTHREAD_MUTEX_INITIALIZER, .fail_at_tile = SIZE_MAX};
    RtFrameOptions options = options_for(&scene, 40, 40, false);
    options.counted = true;
    options.threads = 2;
    options.sink = see;
    options.sink_context = &seen;
    RtFrame frame = trace(&scene, &options);
    for (int kind = 0; kind < RT_RAY_KIND_COUNT; kind++) {
        assert_int_equal(seen.rays[kind], frame.tallies[kind].rays);
    }
    assert_int_equal(seen.invalid, 0);
    assert_true(seen.rays[RT_RAY_SHADOW] > 0 && seen.rays[RT_RAY_REFLECTION] > 0);
    rt_frame_clear(&frame);
    rt_scene_clear(&scene);
}

static void a_sink_that_fails_stops_the_frame_and_leaves_nothing(void **state) {
    (void)state;
    RtScene scene;
    busy_scene(&scene);
    RtAccel *accel;
    assert_ok(rt_accel_open("brute", &scene, &accel, error));
    Seen seen = {.lock = PTHREAD_MUTEX_INITIALIZER, .fail_at_tile = 3};
    RtFrameOptions options = options_for(&scene, 64, 64, false);
    options.sink = see;
    options.sink_context = &seen;
    int64_t live = rt_alloc_live();
    RtFrame frame;
    RtError error;
    assert_int_equal(rt_frame_trace(&frame, accel, &options, &error), RT_MISMATCH);
    assert_string_equal(error.message, "tile 3");
    assert_null(frame.color);
    assert_int_equal(rt_alloc_live(), live);
    rt_accel_destroy(accel);
    rt_scene_clear(&scene);
}

static void a_frame_without_memory_is_a_status_and_leaks_nothing(void **state) {
    (void)state;
    RtScene scene;
    busy_scene(&scene);
    RtAccel *accel;
    assert_ok(rt_accel_open("brute", &scene, &accel, error));
    RtFrameOptions options = options_for(&scene, 4, 4, false);
    options.counted = true;
    int64_t live = rt_alloc_live();
    RtFrame frame;
    RtStatus status = RT_NO_MEMORY;
    uint64_t n = 0;
    while (status != RT_OK) {
        rt_alloc_fail_at(++n);
        status = rt_frame_trace(&frame, accel, &options, NULL);
        rt_alloc_fail_at(0);
        if (status == RT_OK) rt_frame_clear(&frame);
        assert_int_equal(rt_alloc_live(), live);
        assert_true(status == RT_OK || status == RT_NO_MEMORY);
    }
    assert_true(n > 10);
    rt_accel_destroy(accel);
    rt_scene_clear(&scene);
}

/* Counts of a frame that sees one object of size `s`, moved to `away`, under a light beside the camera. */
static RtTally shadow_tally_of_one_object(int shape, float s, float away) {
    RtScene scene;
    start_scene(&scene, (RtMaterial){.color = {1, 1, 1}, .diffuse = 1, .ior = 1});
    RtVec3 to = {away, away, away};
    RtVec3 corners[3] = {{-30 * s, -20 * s, s}, {30 * s, -20 * s, -s}, {0, 40 * s, 0}};
    RtVec3 floor[4] = {
        {-40 * s, -40 * s, 0}, {40 * s, -40 * s, 0}, {40 * s, 40 * s, 0}, {-40 * s, 40 * s, 0}};
    for (int i = 0; i < 3; i++) corners[i] = rt_add(corners[i], to);
    for (int i = 0; i < 4; i++) floor[i] = rt_add(floor[i], to);
    if (shape == 0) assert_ok(rt_scene_add_sphere(&scene, 0, rt_add(rt_vec3(s, s, s), to), 3 * s, error));
    if (shape == 1) assert_ok(rt_scene_add_triangle(&scene, 0, corners, NULL, error));
    if (shape == 2) assert_ok(rt_scene_add_polygon(&scene, 0, corners, 3, error));
    if (shape == 3) assert_ok(rt_scene_add_polygon(&scene, 0, floor, 4, error));
    scene.camera.from = rt_add(rt_vec3(0.1f * s, -20 * s, 5 * s), to);
    scene.camera.at = rt_add(scene.camera.at, to);
    assert_ok(rt_scene_add_light(&scene, rt_add(rt_vec3(0, -25 * s, 5 * s), to), rt_vec3(1, 1, 1), error));
    assert_ok(rt_scene_finish(&scene, error));
    RtFrameOptions options = options_for(&scene, 64, 64, false);
    options.counted = true;
    RtFrame frame = trace(&scene, &options);
    RtTally tally = frame.tallies[RT_RAY_SHADOW];
    rt_frame_clear(&frame);
    rt_scene_clear(&scene);
    return tally;
}

/* Whatever is seen and faces the light is lit, of any size, near zero or far from it. */
static void nothing_shadows_itself(void **state) {
    (void)state;
    for (int scale = -20; scale <= 20; scale += 10) {
        for (int shape = 0; shape < 4; shape++) {
            for (int far = 0; far < 3; far++) {
                float s = ldexpf(1, scale), away = far == 0 ? 0 : far == 1 ? 1e3f * s : 1e5f * s;
                RtTally tally = shadow_tally_of_one_object(shape, s, away);
                assert_true(tally.rays > 400);
                assert_int_equal(tally.hits, 0);
            }
        }
    }
}

/* A floor's box is flat, and box tests take it for thicker than it is; a shadow ray must start above that. */
static void a_shadow_ray_off_a_floor_leaves_the_box_of_the_floor_behind(void **state) {
    (void)state;
    for (int half = 1; half < 100000; half *= 7) {
        RtScene scene;
        float size = (float)half;
        start_scene(&scene, (RtMaterial){.color = {1, 1, 1}, .diffuse = 1, .ior = 1});
        add_square(&scene, size, 0.3f);
        assert_ok(rt_scene_add_light(&scene, rt_vec3(0, 0, 3 * size), rt_vec3(1, 1, 1), error));
        assert_ok(rt_scene_finish(&scene, error));
        for (int i = 0; i < 100; i++) {
            RtVec3 org = {0.019f * size * (float)(i - 50), 0.013f * size * (float)(50 - i), 2};
            RtSurface surface = surface_of(&scene, org, rt_vec3(0, 0, -1), 2 - 0.3f);
            RtRay ray;
            RtVec3 light;
            float enter;
            assert_true(rt_shadow_ray(&scene, &surface, 0, &ray, &light));
            RtPreparedRay prepared = rt_ray_prepare(&ray, &scene.geometry.box);
            assert_false(rt_box_hit(&scene.geometry.boxes[0], &prepared, 1, &enter));
        }
        rt_scene_clear(&scene);
    }
}

/* So does one off a small facet of a larger scene, whose thickness is what a structure tests boxes with. */
static void a_shadow_ray_off_a_facet_leaves_its_box_behind_in_a_larger_scene(void **state) {
    (void)state;
    RtScene scene;
    RtVec3 facet[3] = {{10, 10, 1}, {10.1f, 10, 1}, {10, 10.1f, 1}}, light;
    RtRay ray;
    float enter;
    start_scene(&scene, (RtMaterial){.color = {1, 1, 1}, .diffuse = 1, .ior = 1});
    assert_ok(rt_scene_add_polygon(&scene, 0, facet, 3, error));
    add_square(&scene, 12, 0);
    assert_ok(rt_scene_add_light(&scene, rt_vec3(0, 0, 40), rt_vec3(1, 1, 1), error));
    assert_ok(rt_scene_finish(&scene, error));
    RtSurface surface = surface_of(&scene, rt_vec3(10.02f, 10.03f, 2), rt_vec3(0, 0, -1), 1);
    assert_true(rt_shadow_ray(&scene, &surface, 0, &ray, &light));
    RtPreparedRay prepared = rt_ray_prepare(&ray, &scene.geometry.box);
    assert_false(rt_box_hit(&scene.geometry.boxes[0], &prepared, 1, &enter));
    rt_scene_clear(&scene);
}

static void offsets_stay_fine_far_from_zero(void **state) {
    (void)state;
    RtScene scene;
    start_scene(&scene, (RtMaterial){.color = {1, 1, 1}, .diffuse = 1, .ior = 1});
    assert_ok(rt_scene_add_sphere(&scene, 0, rt_vec3(1e5f, 0, 0), 1, error));
    assert_ok(rt_scene_finish(&scene, error));
    RtSurface surface = surface_of(&scene, rt_vec3(1e5f, 0, 10), rt_vec3(0, 0, -1), 9);
    assert_true(surface.offset > 0.0078 && surface.offset < 0.05); /* an ulp of 1e5 is 0.0078 */
    rt_scene_clear(&scene);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_point_is_shaded_by_the_sum_of_all_five_terms),
        cmocka_unit_test(an_object_between_point_and_light_takes_the_light_away),
        cmocka_unit_test(shadow_rays_go_to_lights_on_the_viewers_side_alone),
        cmocka_unit_test(a_ray_into_glass_bends_by_snells_law_and_back_out),
        cmocka_unit_test(total_internal_reflection_is_one_reflection_ray_with_both_factors),
        cmocka_unit_test(two_mirrors_return_a_ray_as_often_as_the_depth_allows),
        cmocka_unit_test(a_frame_is_the_same_bytes_on_any_number_of_threads_counted_or_timed),
        cmocka_unit_test(what_the_samples_cost_adds_up_to_the_tallies_by_kind),
        cmocka_unit_test(corner_sampling_traces_one_more_ray_than_pixels_a_side),
        cmocka_unit_test(the_sink_sees_every_ray_that_is_counted),
        cmocka_unit_test(a_sink_that_fails_stops_the_frame_and_leaves_nothing),
        cmocka_unit_test(a_frame_without_memory_is_a_status_and_leaks_nothing),
        cmocka_unit_test(nothing_shadows_itself),
        cmocka_unit_test(a_shadow_ray_off_a_floor_leaves_the_box_of_the_floor_behind),
        cmocka_unit_test(a_shadow_ray_off_a_facet_leaves_its_box_behind_in_a_larger_scene),
        cmocka_unit_test(offsets_stay_fine_far_from_zero),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
