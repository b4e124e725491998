/* SPDX-License-Identifier: Apache-2.0 */
/* Frames: every registered accelerator, at every test value of each parameter, and stacked overlays,
 * render the same frame as brute: the same bits of colour, object and depth in every sample, with timed
 * and counted kernels, on one thread and on three; and the same counts on both. */
#include "accel_testing.h"

#include "render/frame.h"
#include "verify/verify.h"

/* A scene and how it is sampled: between them, all shapes, all kinds of rays, and every way to sample. */
typedef struct Shot {
    const char *name; /* of the test */
    const char *scene;
    uint32_t width, height, samples;
    bool corners;
} Shot;

static const Shot shots[] = {
    {"balls", "balls:size=2", 48, 36, 1, false},
    {"balls at corners", "balls:size=2", 40, 31, 1, true},
    {"balls with 2 x 2 samples", "balls:size=2", 24, 18, 2, false},
    {"tetra", "tetra:size=3", 48, 36, 1, false},
    {"tetra at corners", "tetra:size=3", 1, 70, 1, true},
    {"mixed shapes", "random:n=150,shape=mixed", 48, 36, 1, false},
    {"objects in heaps", "random:n=100,shape=mixed,radius=2", 17, 23, 2, false},
    {"clusters", "random:n=200,shape=triangle,distribution=clustered", 48, 36, 1, false},
    {"one object", "random:n=1,radius=0.2", 31, 17, 1, true},
    {"the gallery", RT_SOURCE_DIR "/scenes/gallery.yaml", 48, 36, 1, false},
    {"the jewel", RT_SOURCE_DIR "/scenes/jewel.nff", 32, 24, 1, true},
};

enum { SHOT_COUNT = sizeof shots / sizeof shots[0] };

/* Overlays over one another, in either order, over structures that they do not lie on in the spread. */
static const char *const stacks[] = {
    "cache+grid",
    "light:cells=16+octree",
    "cache+light:cells=8,full_occlusion=off+clusters:extent=sphere",
    "light+cache+octree",
    "cache+cache+light:cells=1+brute",
    "item+light:cells=16+grid",
    "cache+item+octree",
};

enum { STACK_COUNT = sizeof stacks / sizeof stacks[0] };

static RtFrame trace(const RtAccel *accel, bool counted, int threads) {
    RtFrame frame;
    RtFrameOptions options = {.depth = RT_DEFAULT_DEPTH, .threads = threads, .counted = counted};
    assert_ok(rt_frame_trace(&frame, accel, &options, error));
    return frame;
}

static size_t sample_count(const RtFrame *frame) {
    return (size_t)frame->sampling.columns * frame->sampling.rows;
}

/* Tells the first sample that differs; false if one does. */
static bool same_picture(const RtFrame *a, const RtFrame *b, const char *what) {
    size_t count = sample_count(a);
    assert_int_equal(sample_count(b), count);
    for (size_t i = 0; i < count; i++) {
        const char *differs = memcmp(&a->object[i], &b->object[i], sizeof a->object[i]) ? "object"
                              : memcmp(&a->depth[i], &b->depth[i], sizeof a->depth[i])  ? "depth"
                              : memcmp(&a->color[i], &b->color[i], sizeof a->color[i])  ? "color"
                                                                                        : NULL;
        if (!differs) continue;
        print_error("%s: the %s of sample %zu differs\n", what, differs, i);
        return false;
    }
    return true;
}

static bool same_counts(const RtFrame *a, const RtFrame *b, const char *what) {
    if (memcmp(a->tallies, b->tallies, sizeof a->tallies) == 0 &&
        memcmp(a->cost, b->cost, sample_count(a) * sizeof *a->cost) == 0) {
        return true;
    }
    print_error("%s: the counts differ between 1 and 3 threads\n", what);
    return false;
}

/* Compares the frames of one spec with `expected`; false, and a message, if one differs. */
static bool makes_the_frame(const char *spec, const RtScene *scene, const RtFrame *expected) {
    OWNED_ACCEL RtAccel *accel = open_available(scene, spec, 0);
    if (!accel || !accel->exact) return true;
    OWNED_FRAME timed = trace(accel, false, 3), counted = trace(accel, true, 1);
    OWNED_FRAME threaded = trace(accel, true, 3);
    return same_picture(&timed, expected, spec) && same_picture(&counted, expected, spec) &&
           same_picture(&threaded, expected, spec) && same_counts(&counted, &threaded, spec);
}

static void every_accelerator_makes_the_frame_of_brute(void **state) {
    const Shot *shot = *state;
    char spec[RT_MAX_SPEC_CHARS];
    size_t failures = 0;
    OWNED_SCENE scene = open_scene(shot->scene);
    assert_ok(rt_scene_sample(&scene, shot->width, shot->height, shot->samples, shot->corners, error));
    OWNED_ACCEL RtAccel *brute = open_accel(&scene, "brute");
    OWNED_FRAME expected = trace(brute, false, 1);
    for (size_t i = 0; i < rt_accel_count(); i++) {
        for (size_t n = 0; rt_spread_spec(rt_accel_at(i), n, spec); n++)
            failures += !makes_the_frame(spec, &scene, &expected);
    }
    for (size_t i = 0; i < STACK_COUNT; i++) failures += !makes_the_frame(stacks[i], &scene, &expected);
    assert_int_equal(failures, 0);
}

RT_TEST_GROUP(frames) {
    struct CMUnitTest tests[SHOT_COUNT];
    for (size_t i = 0; i < SHOT_COUNT; i++)
        tests[i] = (struct CMUnitTest){shots[i].name, every_accelerator_makes_the_frame_of_brute, NULL,
                                       assert_nothing_is_kept, (void *)&shots[i]};
    return cmocka_run_group_tests_name("every accelerator makes the frame of brute", tests, NULL, NULL);
}
