/* SPDX-License-Identifier: Apache-2.0 */
/* An accelerator that records its callers: the rays that it is verified with, and the locale of the thread.
 * It wraps brute. */
#include "library_testing.h"

#include "accel/kernel.h"
#include "verify/verify.h"

#include <langinfo.h>
#include <locale.h>
#include <xxhash.h>

static atomic_uint_fast64_t calls, rays_asked, rays_sum; /* the sum of the hashes of all rays */
static atomic_bool met_comma;
static RtAccelOps witness;
static const RtAccelOps *brute;
static const RtKernels *brute_kernels;

static void look(void) {
    calls++;
    if (*nl_langinfo(RADIXCHAR) != '.') met_comma = true; /* of this thread; localeconv is not for several */
}

static void look_at(const RtRay *rays, size_t count) {
    look();
    rays_asked += count;
    for (size_t i = 0; i < count; i++) rays_sum += XXH3_64bits(&rays[i], sizeof rays[i]);
}

static void trace(const RtAccel *accel, const RtScratch *scratch, const RtRay *rays, size_t count,
                  RtHit *hits, uint32_t *occluders, RtTally *tallies, bool any, bool counted) {
    RtAccel as_brute = *accel;
    (void)any, (void)counted;
    look_at(rays, count);
    as_brute.kernels = brute_kernels;
    rt_trace_stream(&as_brute, scratch, rays, count, hits, occluders, tallies);
}

RT_DEFINE_STREAM_KERNELS(trace, 0)

static RtStatus build(RtAccel *accel, const RtBuild *what, RtError *error) {
    look();
    RT_TRY(brute->build(accel, what, error));
    brute_kernels = accel->kernels;
    accel->kernels = &kernels;
    return RT_OK;
}

static void destroy(RtAccel *accel) {
    (void)accel;
    look();
}

static RtStatus open_query(const RtAccel *accel, void *scratch, RtError *error) {
    (void)accel, (void)scratch, (void)error;
    look();
    return RT_OK;
}

static void close_query(const RtAccel *accel, void *scratch) {
    (void)accel, (void)scratch;
    look();
}

static void begin(const RtAccel *accel, void *scratch) {
    (void)accel, (void)scratch;
    look();
}

static void describe(const RtAccel *accel, RtDescription *out) {
    look();
    brute->describe(accel, out);
}

static RtStatus check(const RtAccel *accel, RtError *error) {
    (void)accel, (void)error;
    look();
    return RT_OK;
}

static int call_witness(void **state) {
    (void)state;
    assert_ok(rt_accel_find(rt_accel_truth(), &brute, error));
    witness = *brute;
    witness.name = "witness";
    witness.build = build;
    witness.destroy = destroy;
    witness.open = open_query;
    witness.close = close_query;
    witness.begin = begin;
    witness.describe = describe;
    witness.check = check;
    assert_ok(rt_accel_register(&witness, error));
    return 0;
}

/* ---- the rays ---- */

static void forget_rays(void) {
    rays_asked = rays_sum = 0;
}

static void on_doing(void *context, const RtVerifyProgress *progress) {
    (void)context, (void)progress;
}

static void on_row(void *context, const json_t *row) {
    (void)context, (void)row;
}

static void on_notice(void *context, const char *message) {
    (void)context;
    fail_msg("%s", message);
}

static void verify_by_program(const char *scene, uint64_t rays, uint64_t seed) {
    static const RtVerifySpec spec = {.spec = "witness", .named = true, .judged = true};
    const RtVerifyObserver observer = {on_doing, on_row, on_notice, NULL};
    const RtVerify work = {
        .scenes = &scene, .scene_count = 1, .specs = &spec, .spec_count = 1, .rays = {rays, seed, 1, NULL}};
    json_t *rows;
    assert_ok(rt_verify_run(&work, &observer, &rows, error));
    json_decref(rows);
}

RT_TEST(the_library_verifies_by_the_rays_of_the_program) {
    static const char name[] = "balls:size=1";
    OWNED_WORK on = {0};
    raytally_verify_options how = RAYTALLY_VERIFY_DEFAULTS;
    raytally_verify_result found;
    uint32_t width, height;
    forget_rays();
    verify_by_program(name, 3000, 7);
    const uint64_t asked = rays_asked, sum = rays_sum;
    assert_true(asked >= 4 * UINT64_C(3000));

    /* However the scene is sampled, and whatever is built over it. */
    assert_fine(raytally_scene_open(name, &on.scene, error));
    assert_fine(raytally_scene_set_sampling(on.scene, 30, 20, 2, error));
    assert_fine(raytally_accelerator_build(on.scene, "item+bvh", 1, &on.accel, error));
    how.rays = 3000;
    how.seed = 7;
    forget_rays();
    assert_fine(raytally_verify(on.scene, "witness", &how, &found, error));
    assert_int_equal(rays_asked, asked);
    assert_int_equal(rays_sum, sum);
    raytally_scene_size(on.scene, &width, &height);
    assert_true(width == 30 && height == 20);

    /* And only with the given rays. */
    assert_fine(raytally_rays_record(on.accel, RAYTALLY_PRIMARY, NULL, &on.rays, error));
    how.given = on.rays;
    assert_fine(raytally_verify(on.scene, "item+bvh", &how, &found, error));
    assert_int_equal(found.equal, raytally_rays_count(on.rays));
    how.seed = 8;
    how.given = NULL;
    forget_rays();
    assert_fine(raytally_verify(on.scene, "witness", &how, &found, error));
    assert_int_equal(rays_asked, asked);
    assert_int_not_equal(rays_sum, sum);
}

/* ---- the locale ---- */

static bool take_locale(const char *name) {
    return setlocale(LC_ALL, name) && *localeconv()->decimal_point == ',';
}

/* A locale with a decimal comma: one that the machine has, or that localedef makes here. */
static int choose_comma(void **state) {
    static const char *const names[] = {"de_DE.UTF-8", "de_DE.utf8", "fr_FR.UTF-8", "fr_FR.utf8"};
    (void)state;
    for (size_t i = 0; i < sizeof names / sizeof names[0]; i++) {
        if (take_locale(names[i])) return 0;
    }
    static const char make[] = "mkdir -p '" RT_TEST_FOLDER "' && localedef -i de_DE -f UTF-8 '" RT_TEST_FOLDER
                               "/de_DE.UTF-8' >/dev/null 2>&1";
    /* NOLINTNEXTLINE(cert-env33-c): nothing in it comes from elsewhere */
    int made = system(make); /* it warns, and says so, where it makes one */
    setenv("LOCPATH", RT_TEST_FOLDER, 1);
    if (!take_locale("de_DE.UTF-8")) print_message("no locale with a decimal comma (localedef: %d)\n", made);
    return 0;
}

static int choose_standard(void **state) {
    (void)state;
    setlocale(LC_ALL, "C");
    unsetenv("LOCPATH");
    return 0;
}

/* After each call the caller has its comma again; during the call there was a point. */
#define assert_point(expr)                                                                                   \
    do {                                                                                                     \
        met_comma = false;                                                                                   \
        expr;                                                                                                \
        if (met_comma) fail_msg("%s works with a decimal comma", #expr);                                     \
        assert_string_equal(localeconv()->decimal_point, ",");                                               \
    } while (0)

/* The first number is a tie of two float32, which strtof decides. */
RT_TEST_WITH(numbers_in_files_have_a_point_in_every_locale, choose_comma, choose_standard) {
    if (*localeconv()->decimal_point != ',') RT_SKIP("a locale with a decimal comma, or locales to make one");
    static const struct {
        const char *path, *text;
    } files[] = {
        {RT_BINARY_DIR "/test_witness.obj", "v -4.5000002384185791015625 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n"},
        {RT_BINARY_DIR "/test_witness.nff", "p 3\n-4.5000002384185791015625 0 0\n1 0 0\n0 1 0\n"},
        {RT_BINARY_DIR "/test_witness.yaml",
         "objects:\n  - polygon: {vertices: [[-4.5000002384185791015625, 0, 0], [1, 0, 0], [0, 1, 0]]}\n"}};
    for (size_t i = 0; i < sizeof files / sizeof files[0]; i++) {
        raytally_scene *scene;
        float low[3], high[3];
        FILE *file = fopen(files[i].path, "w");
        assert_non_null(file);
        assert_true(fputs(files[i].text, file) >= 0);
        assert_int_equal(fclose(file), 0);
        assert_fine(raytally_scene_open(files[i].path, &scene, error));
        raytally_scene_bounds(scene, low, high);
        assert_true(low[0] == -4.5f);
        raytally_scene_free(scene);
    }
}

RT_TEST_WITH(whoever_is_called_works_in_the_locale_of_c, choose_comma, choose_standard) {
    if (*localeconv()->decimal_point != ',') RT_SKIP("a locale with a decimal comma, or locales to make one");
    OWNED_WORK on = {0};
    raytally_statistics structure;
    raytally_counters counters;
    raytally_verify_result found;
    raytally_time time;
    raytally_hit hits[64];
    bool blocked[64];
    raytally_record_options recording = RAYTALLY_RECORD_DEFAULTS;
    raytally_verify_options verifying = RAYTALLY_VERIFY_DEFAULTS;
    raytally_time_options timing = RAYTALLY_TIME_DEFAULTS;
    recording.limit = 64;
    recording.threads = verifying.threads = timing.threads = 3; /* those of ours, too */
    verifying.rays = 2000;
    timing.rounds = 2;
    timing.least = 0;
    assert_fine(raytally_scene_open("random:n=9,shape=mixed", &on.scene, error));
    assert_fine(raytally_scene_set_sampling(on.scene, 16, 16, 1, error));
    calls = 0;
    assert_point(assert_fine(raytally_accelerator_build(on.scene, "witness", 3, &on.accel, error)));
    assert_point(raytally_accelerator_describe(on.accel, &structure));
    assert_point(assert_fine(raytally_rays_record(on.accel, RAYTALLY_PRIMARY, &recording, &on.rays, error)));
    assert_point(assert_fine(raytally_verify(on.scene, "witness", &verifying, &found, error)));
    assert_point(assert_fine(raytally_count(on.accel, on.rays, 3, &counters, error)));
    assert_point(assert_fine(raytally_time_all(&on.accel, 1, on.rays, &timing, &time, error)));
    assert_point(assert_fine(raytally_render(on.accel, 0, 3, NULL, NULL, error)));
    const size_t count = raytally_rays_count(on.rays);
    assert_true(count > 0 && count <= 64);
    assert_point(assert_fine(raytally_tracer_new(on.accel, &on.tracer, error)));
    assert_point(raytally_tracer_begin(on.tracer));
    assert_point(raytally_nearest(on.tracer, raytally_rays_data(on.rays), count, hits, NULL));
    assert_point(raytally_occluded(on.tracer, raytally_rays_data(on.rays), count, blocked, NULL));
    assert_point(assert_fine(raytally_accelerator_check(on.accel, error)));
    assert_point(raytally_tracer_free(on.tracer));
    assert_point(raytally_accelerator_free(on.accel));
    on.tracer = NULL;
    on.accel = NULL;
    assert_true(calls > 100);
}

RT_TEST_WITH(numbers_are_written_and_read_with_a_point, choose_comma, choose_standard) {
    if (*localeconv()->decimal_point != ',') RT_SKIP("a locale with a decimal comma, or locales to make one");
    char text[16], spec[RAYTALLY_SPEC_CHARS];
    OWNED_WORK on = {0};
    raytally_time time;
    raytally_time_options timing = RAYTALLY_TIME_DEFAULTS;
    const raytally_camera camera = {{0, 0, 9}, {0, 0, 0}, {0, 1, 0}, 199.5f};
    assert_fine(raytally_spec_format("grid:density=4.5", spec, error));
    assert_non_null(strstr(spec, "density=4.5,"));
    assert_refused(raytally_spec_format("grid:density=4,5", spec, error), "");
    assert_fine(raytally_scene_open("balls:size=1", &on.scene, error));
    assert_refused(raytally_scene_set_camera(on.scene, &camera, error), "199.5");
    assert_fine(raytally_scene_set_sampling(on.scene, 4, 4, 1, error));
    assert_fine(raytally_accelerator_build(on.scene, "bvh", 1, &on.accel, error));
    assert_fine(raytally_rays_record(on.accel, RAYTALLY_PRIMARY, NULL, &on.rays, error));
    timing.least = 99.5;
    assert_refused(raytally_time_all(&on.accel, 1, on.rays, &timing, &time, error), "99.5 s");
    snprintf(text, sizeof text, "%.1f", 4.5);
    assert_string_equal(text, "4,5"); /* in the locale of the program */
}

RT_TESTS(witness, call_witness, NULL)
