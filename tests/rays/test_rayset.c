/* SPDX-License-Identifier: Apache-2.0 */
/* Ray sets: the same on any number of threads, every ray valid, of its kind and where it should be. */
#include "accel_testing.h"

#include "measure/measure.h"
#include "rays/rayset.h"

#include <malloc.h>

/* A mirror floor with a glass ball and a matte ball over it, and two lights. */
static void make_scene(RtScene *scene) {
    RtMaterial mirror = rt_default_material(), glass = rt_default_material(), matte = rt_default_material();
    mirror.reflection = 0.5f;
    glass.transmission = 0.8f;
    glass.ior = 1.5f;
    uint32_t m, g, d;
    rt_scene_init(scene);
    assert_ok(rt_scene_add_material(scene, &mirror, &m, error));
    assert_ok(rt_scene_add_material(scene, &glass, &g, error));
    assert_ok(rt_scene_add_material(scene, &matte, &d, error));
    const RtVec3 floor[4] = {{-4, -4, 0}, {4, -4, 0}, {4, 4, 0}, {-4, 4, 0}};
    assert_ok(rt_scene_add_polygon(scene, m, floor, 4, error));
    assert_ok(rt_scene_add_sphere(scene, g, rt_vec3(-1, 0, 1), 1, error));
    assert_ok(rt_scene_add_sphere(scene, d, rt_vec3(1.5f, 0, 1), 1, error));
    assert_ok(rt_scene_add_light(scene, rt_vec3(5, -5, 8), rt_vec3(1, 1, 1), error));
    assert_ok(rt_scene_add_light(scene, rt_vec3(-5, -5, 8), rt_vec3(1, 1, 1), error));
    assert_ok(rt_scene_finish(scene, error));
    assert_ok(rt_scene_sample(scene, 50, 37, 1, false, error)); /* not a multiple of the tile */
}

static RtRecording make_recording(int threads) {
    return (RtRecording){.depth = 4, .seed = 7, .random = 10000, .threads = threads};
}

static struct Stage {
    RtScene scene;
    RtAccel *accel;
    RtRaySet sets[RT_RAY_KIND_COUNT];
} stage;

static void clear_sets(RtRaySet *sets) {
    for (int kind = 0; kind < RT_RAY_KIND_COUNT; kind++) rt_rayset_clear(&sets[kind]);
}

static int set_up(void **state) {
    (void)state;
    make_scene(&stage.scene);
    stage.accel = open_accel(&stage.scene, "bvh");
    RtRecording recording = make_recording(1);
    assert_ok(rt_rayset_record(stage.sets, stage.accel, &recording, error));
    return 0;
}

static int tear_down(void **state) {
    (void)state;
    clear_sets(stage.sets);
    rt_accel_destroy(stage.accel);
    rt_scene_clear(&stage.scene);
    return rt_alloc_live() == 0 ? 0 : -1;
}

/* Records again; returns the sets, and asserts which kinds are the same as those of the stage. */
static void record_again(const RtAccel *accel, RtRecording recording, unsigned changed, RtRaySet *sets) {
    assert_ok(rt_rayset_record(sets, accel, &recording, error));
    for (int kind = 0; kind < RT_RAY_KIND_COUNT; kind++) {
        bool same = sets[kind].fingerprint == stage.sets[kind].fingerprint;
        assert_true(same == !(changed >> kind & 1));
    }
}

RT_TEST(every_ray_is_valid_and_of_its_kind) {
    for (int kind = 0; kind < RT_RAY_KIND_COUNT; kind++) {
        const RtRaySet *set = &stage.sets[kind];
        assert_int_equal(set->kind, kind);
        assert_true(set->count > 0);
        for (uint64_t i = 0; i < set->count; i++) {
            assert_true(rt_ray_is_valid(&set->rays[i]));
            assert_int_equal(set->rays[i].kind, kind);
        }
    }
    assert_int_equal(stage.sets[RT_RAY_PRIMARY].count, 50 * 37);
    assert_int_equal(stage.sets[RT_RAY_RANDOM].count, 10000);
}

/* Shadow rays that start within the glass ball, of radius 1 about (-1, 0, 1). */
static uint64_t count_from_within(const RtRaySet *shadows) {
    uint64_t count = 0;
    for (uint64_t i = 0; i < shadows->count; i++) {
        RtVec3d from = rt_subd(rt_widen(shadows->rays[i].org), (RtVec3d){-1, 0, 1});
        count += rt_lengthd(from) < 1;
    }
    return count;
}

RT_TEST(light_from_outside_is_asked_for_outside_of_glass_alone) {
    RtRaySet sets[RT_RAY_KIND_COUNT];
    RtRecording recording = make_recording(1);
    recording.light_from_outside = true;
    record_again(stage.accel, recording, 1U << RT_RAY_SHADOW, sets);
    assert_true(count_from_within(&stage.sets[RT_RAY_SHADOW]) > 0);
    assert_int_equal(count_from_within(&sets[RT_RAY_SHADOW]), 0);
    assert_true(sets[RT_RAY_SHADOW].count != stage.sets[RT_RAY_SHADOW].count);
    clear_sets(sets);
}

RT_TEST(sets_are_the_same_on_any_number_of_threads_and_any_accelerator) {
    for (int threads = 2; threads <= 3; threads++) {
        OWNED_ACCEL RtAccel *other = open_accel(&stage.scene, threads == 2 ? "brute" : "grid");
        RtRaySet sets[RT_RAY_KIND_COUNT];
        record_again(other, make_recording(threads), 0, sets);
        for (int kind = 0; kind < RT_RAY_KIND_COUNT; kind++) {
            const RtRaySet *expected = &stage.sets[kind];
            assert_int_equal(sets[kind].count, expected->count);
            assert_memory_equal(sets[kind].rays, expected->rays, expected->count * sizeof(RtRay));
        }
        clear_sets(sets);
    }
}

/* Without a camera no frame can be traced. */
RT_TEST(a_kind_is_the_same_when_it_is_recorded_alone_and_random_rays_need_no_frame) {
    for (int kind = 0; kind < RT_RAY_KIND_COUNT; kind++) {
        RtRaySet sets[RT_RAY_KIND_COUNT];
        RtRecording recording = make_recording(2);
        RtScene scene = stage.scene;
        RtAccel accel = *stage.accel;
        recording.kinds = 1u << kind;
        if (kind == RT_RAY_RANDOM) scene.camera.up = scene.camera.at = scene.camera.from;
        accel.scene = kind == RT_RAY_RANDOM ? &scene : accel.scene;
        const RtAccel *asked = kind == RT_RAY_RANDOM ? &accel : stage.accel;
        assert_ok(rt_rayset_record(sets, asked, &recording, error));
        assert_int_equal(sets[kind].count, stage.sets[kind].count);
        assert_true(sets[kind].fingerprint == stage.sets[kind].fingerprint);
        clear_sets(sets);
    }
}

RT_TEST(another_seed_changes_bounces_and_random_rays_alone) {
    RtRaySet sets[RT_RAY_KIND_COUNT];
    RtRecording recording = make_recording(0);
    recording.seed++;
    record_again(stage.accel, recording, ~0U << RT_RAY_DIFFUSE, sets);
    clear_sets(sets);
}

RT_TEST(there_is_a_diffuse_ray_for_each_primary_hit_and_it_leaves_the_surface) {
    const RtRaySet *primary = &stage.sets[RT_RAY_PRIMARY], *diffuse = &stage.sets[RT_RAY_DIFFUSE];
    OWNED_QUERY query = open_query(stage.accel);
    uint64_t next = 0, escaped = 0;
    for (uint64_t i = 0; i < primary->count; i++) {
        RtHit hit, bounced;
        rt_nearest(&query, &primary->rays[i], 1, &hit, NULL);
        if (hit.object == RT_NO_OBJECT) continue;
        const RtRay *ray = &diffuse->rays[next++];
        assert_int_equal(ray->source, primary->rays[i].source);
        RtVec3d point = rt_ray_point(&primary->rays[i], hit.t);
        assert_true(rt_lengthd(rt_subd(rt_widen(ray->org), point)) < 1e-3);
        /* The outside of what it left is all around it, so it never meets the same object from near. */
        rt_nearest(&query, ray, 1, &bounced, NULL);
        assert_true(bounced.object != hit.object);
        escaped += bounced.object == RT_NO_OBJECT;
    }
    assert_int_equal(next, diffuse->count);
    assert_true(escaped > 0 && escaped < next);
}

RT_TEST(occlusion_rays_are_the_diffuse_ones) {
    const RtRaySet *diffuse = &stage.sets[RT_RAY_DIFFUSE], *occlusion = &stage.sets[RT_RAY_OCCLUSION];
    assert_int_equal(occlusion->count, diffuse->count);
    for (uint64_t i = 0; i < diffuse->count; i++) {
        RtRay ray = diffuse->rays[i];
        ray.kind = RT_RAY_OCCLUSION;
        assert_memory_equal(&occlusion->rays[i], &ray, sizeof ray);
    }
}

RT_TEST(random_rays_are_chords_between_uniform_points_of_the_sphere) {
    const RtRaySet *set = &stage.sets[RT_RAY_RANDOM];
    const RtBox *box = &stage.scene.geometry.box;
    RtVec3d center = rt_widen(rt_box_center(*box));
    double radius = rt_lengthd(rt_subd(rt_widen(box->hi), center)), height = 0;
    RtVec3d mean[2] = {{0, 0, 0}, {0, 0, 0}};
    for (uint64_t i = 0; i < set->count; i++) {
        for (int end = 0; end < 2; end++) {
            RtVec3d p = rt_subd(rt_ray_point(&set->rays[i], (float)end), center);
            assert_true(fabs(rt_lengthd(p) - radius) < 1e-5 * radius);
            mean[end] = rt_add_scaledd(mean[end], p, 1 / ((double)set->count * radius));
            height += p.z * p.z / (radius * radius * 2 * (double)set->count);
        }
    }
    /* Each coordinate of a uniform unit vector has mean 0 and variance 1/3: four standard errors. */
    for (int a = 0; a < 3; a++) assert_true(fabs(mean[0].at[a]) < 0.024 && fabs(mean[1].at[a]) < 0.024);
    assert_true(fabs(height - 1.0 / 3) < 0.01);
}

RT_TEST(thinning_keeps_every_nth_ray_and_a_limit_holds) {
    const RtRaySet *set = &stage.sets[RT_RAY_PRIMARY]; /* 1850 */
    OWNED(rt_rayset_clear) RtRaySet thin;
    assert_ok(rt_rayset_thin(set, 3, &thin, error));
    assert_int_equal(thin.count, 617);
    assert_memory_equal(&thin.rays[616], &set->rays[1848], sizeof(RtRay));
    assert_true(thin.fingerprint != set->fingerprint);
    rt_rayset_clear(&thin);
    assert_ok(rt_rayset_thin(set, 1, &thin, error));
    assert_true(thin.fingerprint == set->fingerprint);
    rt_rayset_clear(&thin);
    const uint64_t limits[] = {1, 2, 1000, 1849, 1850, 5000};
    for (size_t i = 0; i < sizeof limits / sizeof limits[0]; i++) {
        assert_ok(rt_rayset_limit(set, limits[i], 1, &thin, error));
        assert_true(thin.count > 0 && thin.count <= limits[i]);
        rt_rayset_clear(&thin);
    }
    RtRaySet nothing = {.kind = RT_RAY_SHADOW};
    assert_ok(rt_rayset_limit(&nothing, 10, 1, &thin, error));
    assert_int_equal(thin.count, 0);
}

/* Asserts that `limit` keeps runs of `run` rays, one of every `every` runs, somewhere in its group. */
static void assert_runs(const RtRaySet *set, uint64_t limit, uint64_t asked, uint64_t run, uint64_t stride) {
    OWNED(rt_rayset_clear) RtRaySet kept;
    bool moved = false;
    assert_ok(rt_rayset_limit(set, limit, asked, &kept, error));
    assert_true(kept.count <= limit && kept.count + 2 * run >= set->count / stride);
    for (uint64_t i = 0, from = 0; i < kept.count; i++, from++) {
        while (from < set->count && memcmp(&kept.rays[i], &set->rays[from], sizeof(RtRay)) != 0) from++;
        assert_true(from < set->count);
        assert_int_equal(from % run, i % run);
        assert_int_equal(from / (run * stride), i / run);
        moved |= from % (run * stride) >= run;
    }
    assert_true(moved);
}

RT_TEST(a_limit_keeps_runs_of_neighbours_together_all_over_the_set) {
    const RtRaySet *set = &stage.sets[RT_RAY_PRIMARY]; /* 1850 */
    assert_runs(set, 1100, 16, 16, 2);
    assert_runs(set, 600, 5, 5, 4);
    assert_runs(set, 200, 256, 3, 10); /* 64 runs at least */
}

/* Asserts that each 64 rays from the first of set->rays[0..count) are a block of 8 x 8 samples. */
static void assert_blocks(const RtRaySet *set, uint64_t count, uint32_t columns) {
    for (uint64_t i = 0; i < count; i++) {
        uint32_t first = set->rays[i - i % 64].source, source = set->rays[i].source;
        uint32_t column = first % columns, row = first / columns;
        assert_true(column % 8 == 0 && row % 8 == 0);
        assert_true(source % columns - column < 8 && source / columns - row < 8);
    }
}

/* 50 x 37 samples contain 3 x 2 whole tiles of 256. */
RT_TEST(primary_rays_come_in_blocks_of_neighbours_and_a_limit_keeps_them_whole) {
    RtRaySet sets[RT_RAY_KIND_COUNT], kept;
    RtRecording recording = make_recording(1);
    assert_blocks(&stage.sets[RT_RAY_PRIMARY], 3 * 2 * 256, 50);
    assert_ok(rt_scene_sample(&stage.scene, 200, 200, 1, false, error));
    assert_ok(rt_rayset_record(sets, stage.accel, &recording, error));
    assert_blocks(&sets[RT_RAY_PRIMARY], 200 * 200, 200);
    assert_ok(rt_rayset_limit(&sets[RT_RAY_PRIMARY], 15000, 200, &kept, error));
    assert_true(kept.count % 192 == 0 && kept.count > 12000); /* runs of 192 */
    assert_blocks(&kept, kept.count, 200);
    rt_rayset_clear(&kept);
    clear_sets(sets);
    assert_ok(rt_scene_sample(&stage.scene, 50, 37, 1, false, error));
}

RT_TEST(every_allocation_of_a_recording_may_fail) {
    RtRecording recording = make_recording(1);
    assert_ok(rt_scene_sample(&stage.scene, 20, 20, 1, false, error));
    RtRaySet sets[RT_RAY_KIND_COUNT];
    assert_fails_cleanly(rt_rayset_record(sets, stage.accel, &recording, error), clear_sets(sets));
    assert_ok(rt_scene_sample(&stage.scene, 50, 37, 1, false, error));
}

/* All bytes of rays are hashed: whatever memory held before, the file alone decides. */
RT_TEST(rays_of_a_file_have_the_same_fingerprint_each_time_that_they_are_read) {
    char path[] = "/tmp/raytally-rays-XXXXXX";
    uint64_t fingerprints[2];
    int file = mkstemp(path);
    assert_true(file >= 0 && close(file) == 0);
    RtRaySet few = stage.sets[RT_RAY_PRIMARY], read;
    few.count = 10;
    assert_ok(rt_rays_save(&few, path, error));
    for (int i = 0; i < 2; i++) {
        mallopt(M_PERTURB, i ? 0x55 : 0x2a); /* what memory is filled with */
        assert_ok(rt_rays_load(path, RT_RAY_RANDOM, &read, error));
        mallopt(M_PERTURB, 0);
        assert_int_equal(read.rays[9].source, 0);
        fingerprints[i] = read.fingerprint;
        rt_rayset_clear(&read);
    }
    assert_true(fingerprints[0] == fingerprints[1]);
    assert_int_equal(remove(path), 0);
}

/* There is no room for the usual distance behind it: the camera and the light that every scene gets are put
 * as far off as rays may begin. */
RT_TEST(a_scene_at_the_end_of_coordinates_is_seen_and_lit) {
    OWNED_SCENE_OF(scene, sphere, rt_vec3(0, 0, 0), 0.9f * RT_MAX_COORDINATE);
    assert_int_equal(scene.light_count, 1);
    RtRay ray = {.org = scene.camera.from, .dir = {1, 0, 0}};
    assert_true(rt_ray_is_valid(&ray));
    ray.org = scene.lights[0].position;
    assert_true(rt_ray_is_valid(&ray));
}

RT_TESTS(rayset, set_up, tear_down)
