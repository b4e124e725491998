/* SPDX-License-Identifier: Apache-2.0 */
/* raytally.h: its functions do what the program does, reject what it rejects, and leak nothing. */
#include "library_testing.h"

RT_TEST(counters_and_kinds_of_rays_have_their_names) {
    assert_string_equal(raytally_counter_name(RAYTALLY_RAYS), "rays");
    assert_string_equal(raytally_counter_name(RAYTALLY_PASSED_ON), "passed_on");
    assert_null(raytally_counter_name(RAYTALLY_COUNTERS_KNOWN));
    assert_string_equal(raytally_ray_kind_name(RAYTALLY_OCCLUSION), "occlusion");
    assert_null(raytally_ray_kind_name(RAYTALLY_RAY_KINDS));
    assert_int_equal(raytally_abi_version(), RAYTALLY_ABI_VERSION);
}

/* ---- scenes of arrays ---- */

RT_TEST(rays_hit_the_objects_of_arrays_by_their_numbers) {
    OWNED_WORK on = open_two_objects();
    raytally_hit hits[3];
    bool blocked[3];
    raytally_counters counters[RAYTALLY_RAY_KINDS] = {{{0}}};
    const raytally_ray rays[3] = {{{0, 0, 5}, 0, {0, 0, -1}, INFINITY, RAYTALLY_RANDOM, 0},
                                  {{0, 0, -1}, 0, {0, 0, -0.5f}, INFINITY, RAYTALLY_RANDOM, 0},
                                  {{0, 3, 5}, 0, {0, 0, -1}, INFINITY, RAYTALLY_SHADOW, 0}};
    float low[3], high[3];
    assert_int_equal(raytally_scene_object_count(on.scene), 2);
    raytally_scene_bounds(on.scene, low, high);
    assert_true(low[2] <= -4 && low[2] > -4.1f && high[1] == 1);
    assert_fine(raytally_accelerator_build(on.scene, "bvh", 1, &on.accel, error));
    assert_fine(raytally_tracer_new(on.accel, &on.tracer, error));
    raytally_tracer_begin(on.tracer);
    raytally_nearest(on.tracer, rays, 3, hits, NULL);
    assert_true(hits[0].object == 0 && hits[0].t == 5);
    assert_true(hits[1].object == 1 && hits[1].t == 2);
    assert_true(hits[2].object == RAYTALLY_NO_OBJECT && isinf(hits[2].t));
    raytally_nearest(on.tracer, rays, 3, hits, counters);
    raytally_occluded(on.tracer, rays, 3, blocked, counters);
    assert_true(blocked[0] && blocked[1] && !blocked[2]);
    assert_int_equal(counters[RAYTALLY_RANDOM].at[RAYTALLY_RAYS], 4);
    assert_int_equal(counters[RAYTALLY_RANDOM].at[RAYTALLY_HITS], 4);
    assert_int_equal(counters[RAYTALLY_SHADOW].at[RAYTALLY_RAYS], 2);
    assert_int_equal(counters[RAYTALLY_SHADOW].at[RAYTALLY_HITS], 0);
    assert_fine(raytally_accelerator_check(on.accel, error));
}

RT_TEST(objects_that_are_none_are_refused_by_their_number) {
    const uint32_t beyond[] = {0, 1, 3};
    const float flat[] = {0, 0, 0, 1, 0, 0, 0, 0}, nowhere[] = {-1, -1, 0, 1, NAN, 0, 0, 1, 0};
    raytally_scene *scene;
    int64_t live = rt_alloc_live();
    raytally_objects objects = two_objects();
    objects.corners = beyond;
    assert_refused(raytally_scene_from_objects(&objects, &scene, error),
                   "triangle 0 (the first is 0): corner 2 is vertex 3, and there are 3");
    assert_null(scene);
    objects = two_objects();
    objects.spheres = flat;
    objects.sphere_count = 2;
    assert_refused(raytally_scene_from_objects(&objects, &scene, error), "sphere 1");
    objects = two_objects();
    objects.vertices = nowhere;
    assert_int_equal(raytally_scene_from_objects(&objects, &scene, NULL), RAYTALLY_BAD_INPUT);
    assert_refused(raytally_scene_open("bals", &scene, error), "balls");
    assert_null(scene);
    assert_int_equal(rt_alloc_live(), live);
}

RT_TEST(the_camera_changes_only_while_no_accelerator_stands_over_the_scene) {
    OWNED_WORK on = open_two_objects();
    raytally_camera camera = {{0, 0, 9}, {0, 0, 0}, {0, 1, 0}, 40};
    uint32_t width, height;
    assert_fine(raytally_scene_set_camera(on.scene, &camera, error));
    assert_fine(raytally_scene_set_sampling(on.scene, 30, 20, 2, error));
    raytally_scene_size(on.scene, &width, &height);
    assert_true(width == 30 && height == 20);
    assert_refused(raytally_scene_set_sampling(on.scene, 30, 20, 65, error), "");
    camera.up[1] = 0;
    assert_refused(raytally_scene_set_camera(on.scene, &camera, error), "");
    camera.up[1] = INFINITY;
    assert_refused(raytally_scene_set_camera(on.scene, &camera, error), "");
    camera.up[1] = 1;
    assert_fine(raytally_accelerator_build(on.scene, "item+bvh", 1, &on.accel, error));
    assert_refused(raytally_scene_set_camera(on.scene, &camera, error), "");
    assert_refused(raytally_scene_set_sampling(on.scene, 8, 8, 1, error), "free them first (1)");
    raytally_accelerator_free(on.accel);
    on.accel = NULL;
    assert_fine(raytally_scene_set_sampling(on.scene, 8, 8, 1, error));
}

/* ---- one scene for what follows ---- */

RT_TEST(what_a_reader_left_out_is_a_warning_of_the_scene) {
    static const char path[] = RT_BINARY_DIR "/test_embedding.obj";
    raytally_scene *scene;
    char text[RAYTALLY_WARNING_CHARS];
    FILE *file = fopen(path, "w");
    assert_non_null(file);
    assert_true(fputs("v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\nf 1 2\n", file) >= 0);
    assert_int_equal(fclose(file), 0);
    assert_fine(raytally_scene_open(path, &scene, error));
    assert_true(raytally_scene_warning(scene, 0, text));
    assert_non_null(strstr(text, "test_embedding.obj:5: face 1 (counted from 0) has 2 corners"));
    assert_false(raytally_scene_warning(scene, 1, text));
    assert_string_equal(text, "");
    raytally_scene_free(scene);
}

static struct {
    raytally_scene *scene;
    raytally_accelerator *accels[3]; /* brute, grid, ideal */
    raytally_rays *rays;             /* primary, of 16 x 16 samples */
} balls;

static int open_balls(void **state) {
    static const char *const specs[3] = {"brute", "grid", "ideal"};
    assert_fine(raytally_scene_open("balls:size=1", &balls.scene, error));
    assert_fine(raytally_scene_set_sampling(balls.scene, 16, 16, 1, error));
    for (int i = 0; i < 3; i++)
        assert_fine(raytally_accelerator_build(balls.scene, specs[i], 1, &balls.accels[i], error));
    assert_fine(raytally_rays_record(balls.accels[0], RAYTALLY_PRIMARY, NULL, &balls.rays, error));
    *state = &balls;
    return 0;
}

static int close_balls(void **state) {
    (void)state;
    raytally_rays_free(balls.rays);
    for (int i = 0; i < 3; i++) raytally_accelerator_free(balls.accels[i]);
    raytally_scene_free(balls.scene);
    return 0;
}

RT_TEST(accelerators_are_listed_described_and_refused) {
    char spec[RAYTALLY_SPEC_CHARS];
    raytally_statistics structure;
    raytally_accelerator *none;
    assert_int_equal(raytally_accelerator_count(), rt_accel_count());
    assert_string_equal(raytally_accelerator_name(0), "brute");
    assert_fine(raytally_spec_format("grid:density=4", spec, error));
    assert_non_null(strstr(spec, "density=4,"));
    assert_non_null(strstr(raytally_accelerator_spec(balls.accels[1]), "grid:rule="));
    assert_true(raytally_accelerator_exact(balls.accels[1]));
    raytally_accelerator_describe(balls.accels[1], &structure);
    assert_true(structure.at[RAYTALLY_LEAVES] > 0 && structure.at[RAYTALLY_BYTES] > 0);
    assert_true(structure.at[RAYTALLY_STATISTICS_KNOWN] == 0);
    assert_refused(raytally_spec_format("gird", spec, error), "grid");
    assert_refused(raytally_accelerator_build(balls.scene, "gird", 1, &none, error), "");
    assert_null(none);
    assert_refused(raytally_accelerator_build(balls.scene, "grid", -1, &none, error), "threads");
}

/* ---- rays ---- */

RT_TEST(rays_are_recorded_as_the_program_records_them) {
    RtRaySet sets[RT_RAY_KIND_COUNT], thin;
    RtRecording recording = {.depth = 5, .seed = 1, .random = 128, .threads = 1};
    raytally_record_options how = RAYTALLY_RECORD_DEFAULTS;
    how.limit = 128; /* fewer than there are: neighbours are kept together */
    assert_ok(rt_rayset_record(sets, balls.accels[0]->accel, &recording, error));
    for (int kind = 0; kind < RT_RAY_KIND_COUNT; kind++) {
        raytally_rays *rays;
        assert_fine(raytally_rays_record(balls.accels[1], (enum raytally_ray_kind)kind, &how, &rays, error));
        assert_ok(rt_rayset_limit(&sets[kind], 128, 256, &thin, error));
        assert_int_equal(raytally_rays_count(rays), thin.count);
        assert_int_equal(raytally_rays_fingerprint(rays), thin.fingerprint);
        if (thin.count > 0) assert_int_equal(raytally_rays_data(rays)[0].kind, kind);
        rt_rayset_clear(&thin);
        rt_rayset_clear(&sets[kind]);
        raytally_rays_free(rays);
    }
}

/* A program that was built with a header in which the struct ended sooner. */
RT_TEST(options_that_are_left_out_have_their_defaults) {
    raytally_record_options how = {offsetof(raytally_record_options, threads), 1, -7, 0, 0};
    raytally_rays *rays;
    assert_fine(raytally_rays_record(balls.accels[1], RAYTALLY_PRIMARY, &how, &rays, error));
    assert_int_equal(raytally_rays_fingerprint(rays), raytally_rays_fingerprint(balls.rays));
    raytally_rays_free(rays);
}

RT_TEST(rays_of_ones_own_are_checked) {
    raytally_ray own[2] = {{{0, 0, 0}, 0, {1, 0, 0}, 1, 77, 3}, {{0, 0, 0}, 0, {0, 0, 0}, 1, 0, 0}};
    raytally_rays *rays;
    assert_false(raytally_ray_is_valid(&own[0])); /* there is no such kind */
    assert_fine(raytally_rays_copy(RAYTALLY_SHADOW, own, 1, &rays, error));
    assert_int_equal(raytally_rays_data(rays)[0].kind, RAYTALLY_SHADOW);
    assert_int_equal(raytally_rays_data(rays)[0].source, 3);
    assert_true(raytally_ray_is_valid(raytally_rays_data(rays)));
    raytally_rays_free(rays);
    assert_refused(raytally_rays_copy(RAYTALLY_SHADOW, own, 2, &rays, error),
                   "ray 1 (the first is 0) is not valid: its direction is zero");
    assert_null(rays);
    own[0].org[1] = 6e17f;
    assert_refused(raytally_rays_copy(RAYTALLY_SHADOW, own, 2, &rays, error), "beyond 5e17");
    assert_refused(raytally_rays_copy(RAYTALLY_RAY_KINDS, own, 1, &rays, error), "");
    assert_fine(raytally_rays_copy(RAYTALLY_PRIMARY, NULL, 0, &rays, error));
    assert_int_equal(raytally_rays_count(rays), 0);
    raytally_rays_free(rays);
}

/* ---- verifying ---- */

RT_TEST(every_ray_is_accounted_for_in_a_verification) {
    raytally_verify_options how = RAYTALLY_VERIFY_DEFAULTS;
    raytally_verify_result found;
    how.rays = 500;
    assert_fine(raytally_verify(balls.scene, "grid:density=4", &how, &found, error));
    assert_true(found.rays == 500 && found.equal == 500 && found.wrong + found.occluded_wrong == 0);
    how.given = balls.rays;
    assert_fine(raytally_verify(balls.scene, "octree", &how, &found, error));
    assert_int_equal(found.equal, raytally_rays_count(balls.rays));
    how.given = NULL;
    how.rays = 0;
    assert_refused(raytally_verify(balls.scene, "grid", &how, &found, error), "");
    assert_int_equal(found.rays, 0);
}

/* ---- measuring ---- */

RT_TEST(counts_are_those_of_the_definition) {
    raytally_counters counters;
    uint64_t rays = raytally_rays_count(balls.rays), objects = raytally_scene_object_count(balls.scene);
    assert_fine(raytally_count(balls.accels[0], balls.rays, 2, &counters, error));
    assert_int_equal(counters.at[RAYTALLY_RAYS], rays);
    assert_int_equal(counters.at[RAYTALLY_OBJECT_TESTS], rays * objects);
    uint64_t hits = counters.at[RAYTALLY_HITS];
    assert_true(hits > 0 && hits < rays * objects);
    assert_fine(raytally_count(balls.accels[2], balls.rays, 1, &counters, error));
    assert_int_equal(counters.at[RAYTALLY_OBJECT_TESTS], hits); /* one for each ray that hits */
}

RT_TEST(counts_of_each_ray_sum_up_to_those_of_all) {
    enum { MANY = RAYTALLY_COUNTERS_KNOWN + 2 };
    raytally_counters all;
    const size_t rays = raytally_rays_count(balls.rays);
    uint64_t *counts = rt_alloc(rays * MANY, sizeof *counts);
    for (int accel = 0; accel < 3; accel++) {
        assert_fine(raytally_count(balls.accels[accel], balls.rays, 1, &all, error));
        memset(counts, 0xff, rays * MANY * sizeof *counts);
        assert_fine(raytally_count_each(balls.accels[accel], balls.rays, 2, counts, MANY, error));
        for (size_t c = 0; c < MANY; c++) {
            uint64_t sum = 0;
            for (size_t i = 0; i < rays; i++) sum += counts[i * MANY + c];
            assert_int_equal(sum, all.at[c]);
        }
        for (size_t i = 0; i < rays; i++) assert_int_equal(counts[i * MANY + RAYTALLY_RAYS], 1);
    }
    assert_refused(raytally_count_each(balls.accels[0], balls.rays, -1, counts, MANY, error), "threads");
    rt_free(counts);
}

/* ideal knows rays by their addresses: it must not use what it learned for other rays at the same addresses.
 */
RT_TEST(what_was_taught_for_a_count_is_forgotten) {
    raytally_counters counters[RAYTALLY_RAY_KINDS] = {{{0}}}, taught;
    raytally_tracer *tracer;
    raytally_hit hit;
    assert_fine(raytally_count(balls.accels[2], balls.rays, 1, &taught, error));
    assert_fine(raytally_tracer_new(balls.accels[2], &tracer, error));
    raytally_nearest(tracer, raytally_rays_data(balls.rays), 1, &hit, counters);
    assert_int_equal(counters[RAYTALLY_PRIMARY].at[RAYTALLY_OBJECT_TESTS],
                     raytally_scene_object_count(balls.scene));
    raytally_tracer_free(tracer);
}

/* A counted kernel with wrong answers. */
static void lie(const RtAccel *accel, const RtScratch *scratch, const RtRay *rays, size_t count, RtHit *hits,
                uint32_t *occluders, RtTally *tallies) {
    (void)accel, (void)scratch, (void)occluders;
    for (size_t i = 0; i < count; i++) hits[i] = RT_MISS;
    tallies[rays[0].kind].rays += count;
}

RT_TEST(a_kernel_that_answers_otherwise_when_it_counts_is_a_mismatch) {
    raytally_counters counters;
    RtAccel *accel = balls.accels[0]->accel;
    const RtKernels *honest = accel->kernels;
    RtKernels lying = *honest;
    lying.nearest_counted = lie;
    accel->kernels = &lying;
    assert_fails(raytally_count(balls.accels[0], balls.rays, 1, &counters, error), RAYTALLY_MISMATCH,
                 "differ from the timed one");
    accel->kernels = honest;
}

RT_TEST(counts_that_are_none_are_not_reported) {
    raytally_counters counters;
    uint64_t counts[1];
    balls.accels[1]->accel->counts = false;
    assert_fails(raytally_count(balls.accels[1], balls.rays, 1, &counters, error), RAYTALLY_NOT_AVAILABLE,
                 "grid:rule=");
    assert_fails(raytally_count_each(balls.accels[1], balls.rays, 1, counts, 0, error),
                 RAYTALLY_NOT_AVAILABLE, "does not count");
    balls.accels[1]->accel->counts = true;
}

RT_TEST(accelerators_of_one_scene_are_timed_however_often_it_was_opened) {
    raytally_time_options how = RAYTALLY_TIME_DEFAULTS;
    raytally_time times[2];
    how.least = 0;
    how.rounds = 1;
    for (int other = 0; other < 2; other++) {
        OWNED_WORK on = {0};
        assert_fine(raytally_scene_open(other ? "balls:size=2" : "balls:size=1", &on.scene, error));
        assert_fine(raytally_accelerator_build(on.scene, "grid", 1, &on.accel, error));
        raytally_accelerator *const both[2] = {balls.accels[0], on.accel};
        if (other)
            assert_refused(raytally_time_all(both, 2, balls.rays, &how, times, error), "0 and 1");
        else
            assert_fine(raytally_time_all(both, 2, balls.rays, &how, times, error));
    }
}

RT_TEST(times_are_positive_and_the_first_is_the_measure_of_all) {
    raytally_time_options how = RAYTALLY_TIME_DEFAULTS;
    raytally_time times[3];
    raytally_rays *none;
    how.least = 0.0005;
    how.rounds = 7;
    assert_fine(raytally_time_all(balls.accels, 3, balls.rays, &how, times, error));
    for (int i = 0; i < 3; i++) {
        const raytally_estimate *s = &times[i].seconds;
        assert_true(s->least > 0 && s->least <= s->low && s->low <= s->median && s->median <= s->high);
        assert_true(s->coverage >= 0.95 && times[i].ratio.median > 0);
    }
    assert_true(times[0].ratio.low == 1 && times[0].ratio.high == 1);
    how.rounds = 0;
    assert_refused(raytally_time_all(balls.accels, 3, balls.rays, &how, times, error), "");
    assert_refused(raytally_time_all(balls.accels, 0, balls.rays, NULL, times, error), "");
    assert_fine(raytally_rays_copy(RAYTALLY_PRIMARY, NULL, 0, &none, error));
    assert_refused(raytally_time_all(balls.accels, 1, none, NULL, times, error), "");
    raytally_rays_free(none);
}

RT_TEST(estimates_are_medians_with_the_order_statistics_around_them) {
    const double over[7] = {14, 2, 6, 10, 4, 12, 8}, under[7] = {7, 1, 3, 5, 2, 6, 4};
    raytally_estimate estimate;
    assert_fine(raytally_estimate_median(under, 7, &estimate, error));
    assert_true(estimate.median == 4 && estimate.low == 1 && estimate.high == 7 && estimate.least == 1);
    assert_true(estimate.coverage > 0.984 && estimate.coverage < 0.985); /* 1 - 2 / 2^7 */
    assert_fine(raytally_estimate_ratio(over, under, 7, &estimate, error));
    assert_true(estimate.median == 2 && estimate.low == 2 && estimate.high == 2);
    assert_refused(raytally_estimate_median(under, 0, &estimate, error), "");
    assert_refused(raytally_estimate_ratio(over, under, 1001, &estimate, error), "");
}

/* ---- pictures ---- */

RT_TEST(a_picture_is_the_frame_of_the_program) {
    float rgb[16 * 16][3];
    RtFrame frame;
    RtFrameOptions options = {.depth = RT_DEFAULT_DEPTH, .threads = 1};
    assert_fine(raytally_render(balls.accels[1], 0, 2, NULL, rgb[0], error));
    assert_ok(rt_frame_trace(&frame, balls.accels[0]->accel, &options, error));
    for (uint32_t i = 0; i < 16 * 16; i++) assert_memory_equal(rgb[i], &frame.color[i], sizeof rgb[i]);
    rt_frame_clear(&frame);
    assert_fails(raytally_render(balls.accels[1], 0, 1, "no/such/folder.png", NULL, error), RAYTALLY_IO, "");
    assert_refused(raytally_render(balls.accels[1], 65, 1, NULL, NULL, error), "");
}

/* ---- memory ---- */

/* Every function that allocates, once. */
static raytally_status use_all(raytally_error *error) {
    raytally_objects objects = two_objects();
    raytally_record_options recording = RAYTALLY_RECORD_DEFAULTS;
    raytally_verify_options verifying = RAYTALLY_VERIFY_DEFAULTS;
    raytally_time_options timing = RAYTALLY_TIME_DEFAULTS;
    OWNED_WORK on = {0}, other = {0};
    raytally_verify_result found;
    raytally_counters counters;
    uint64_t counts[4];
    raytally_time times[2];
    recording.threads = verifying.threads = timing.threads = 1;
    verifying.rays = 20;
    timing.rounds = 1;
    timing.least = 0;
    raytally_status status = raytally_scene_from_objects(&objects, &on.scene, error);
    if (status == RAYTALLY_OK) status = raytally_scene_set_sampling(on.scene, 2, 2, 1, error);
    if (status == RAYTALLY_OK) status = raytally_accelerator_build(on.scene, "bvh", 1, &on.accel, error);
    if (status == RAYTALLY_OK) status = raytally_accelerator_build(on.scene, "ideal", 1, &other.accel, error);
    if (status == RAYTALLY_OK)
        status = raytally_rays_record(on.accel, RAYTALLY_PRIMARY, &recording, &on.rays, error);
    if (status == RAYTALLY_OK)
        status = raytally_rays_copy(RAYTALLY_SHADOW, raytally_rays_data(on.rays), 1, &other.rays, error);
    if (status == RAYTALLY_OK) status = raytally_tracer_new(on.accel, &on.tracer, error);
    if (status == RAYTALLY_OK) status = raytally_verify(on.scene, "grid", &verifying, &found, error);
    if (status == RAYTALLY_OK) status = raytally_count(other.accel, on.rays, 1, &counters, error);
    if (status == RAYTALLY_OK) status = raytally_count_each(other.accel, on.rays, 1, counts, 1, error);
    raytally_accelerator *both[2] = {on.accel, other.accel};
    if (status == RAYTALLY_OK) status = raytally_time_all(both, 2, on.rays, &timing, times, error);
    if (status == RAYTALLY_OK) status = raytally_render(on.accel, 1, 1, NULL, NULL, error);
    return status;
}

RT_TEST(every_allocation_may_fail_and_nothing_is_left_behind) {
    raytally_error why;
    raytally_status status = RAYTALLY_NO_MEMORY;
    int64_t live = rt_alloc_live();
    for (uint64_t n = 1; status != RAYTALLY_OK; n++) {
        rt_alloc_fail_at(n);
        status = use_all(&why);
        rt_alloc_fail_at(0);
        if (status != RAYTALLY_OK) assert_int_equal(status, RAYTALLY_NO_MEMORY);
        assert_int_equal(rt_alloc_live(), live);
        assert_true(n < 10000);
    }
}

RT_TESTS(embedding, open_balls, close_balls)
