/* SPDX-License-Identifier: Apache-2.0 */
/* Programs and libraries that were built with other headers: structs of options are as long as they say, and
 * what is told has room for more. */
#include "library_testing.h"

#include <raytally/accel.h>

/* A plugin writes all of its own header's, into what our header has. */
_Static_assert(sizeof(raytally_description) == 128, "the room for descriptions does not change");

/* What a later header may make of each struct of options. */
#define LATER(Options)                                                                                       \
    struct {                                                                                                 \
        Options known;                                                                                       \
        uint32_t more[2];                                                                                    \
    }

RT_TEST(options_of_a_later_header_are_taken_as_far_as_they_say_nothing_new) {
    LATER(raytally_objects) objects = {two_objects(), {0}};
    LATER(raytally_recording) recording = {RAYTALLY_RECORDING, {0}};
    LATER(raytally_verifying) verifying = {RAYTALLY_VERIFYING, {0}};
    LATER(raytally_timing) timing = {RAYTALLY_TIMING, {0}};
    raytally_scene *scene, *none;
    raytally_accelerator *accel;
    raytally_rays *rays, *no_rays;
    raytally_verified found;
    raytally_time time;
    raytally_error why;
    objects.known.size = sizeof objects;
    recording.known.size = sizeof recording;
    verifying.known.size = sizeof verifying;
    timing.known.size = sizeof timing;
    verifying.known.rays = 20;
    timing.known.rounds = 1;
    timing.known.least = 0;
    assert_fine(raytally_scene_make(&objects.known, &scene, error));
    assert_fine(raytally_scene_sample(scene, 4, 4, 1, error));
    assert_fine(raytally_accelerator_build(scene, "bvh", 1, &accel, error));
    assert_fine(raytally_rays_record(accel, RAYTALLY_PRIMARY, &recording.known, &rays, error));
    assert_fine(raytally_verify(scene, "grid", &verifying.known, &found, error));
    assert_fine(raytally_time_all(&accel, 1, rays, &timing.known, &time, error));

    objects.more[1] = recording.more[0] = verifying.more[0] = timing.more[1] = 1;
    assert_int_equal(raytally_scene_make(&objects.known, &none, &why), RAYTALLY_NOT_AVAILABLE);
    assert_null(none);
    assert_says(why, "raytally_objects: byte 60 is set, but raytally " RT_VERSION " knows only");
    assert_int_equal(raytally_rays_record(accel, RAYTALLY_PRIMARY, &recording.known, &no_rays, &why),
                     RAYTALLY_NOT_AVAILABLE);
    assert_null(no_rays);
    assert_says(why, "raytally_recording");
    assert_int_equal(raytally_verify(scene, "grid", &verifying.known, &found, &why), RAYTALLY_NOT_AVAILABLE);
    assert_says(why, "raytally_verifying");
    assert_int_equal(raytally_time_all(&accel, 1, rays, &timing.known, &time, &why), RAYTALLY_NOT_AVAILABLE);
    assert_says(why, "raytally_timing");
    raytally_rays_free(rays);
    raytally_accelerator_free(accel);
    raytally_scene_free(scene);
}

/* The next member takes the place of `reserved`. */
RT_TEST(what_is_reserved_in_options_is_zero) {
    raytally_objects objects = two_objects();
    raytally_scene *scene;
    raytally_error why;
    objects.reserved = 1;
    assert_int_equal(raytally_scene_make(&objects, &scene, &why), RAYTALLY_NOT_AVAILABLE);
    assert_null(scene);
}

RT_TEST(options_that_nobody_initialised_are_refused) {
    static const size_t sizes[] = {0, 3, 5000, SIZE_MAX};
    raytally_objects objects = two_objects();
    raytally_scene *scene;
    raytally_error why;
    for (size_t i = 0; i < sizeof sizes / sizeof sizes[0]; i++) {
        objects.size = sizes[i];
        assert_int_equal(raytally_scene_make(&objects, &scene, &why), RAYTALLY_BAD_INPUT);
        assert_says(why, "initialise it");
    }
}

/* A struct that is told: all that a later library may say in it is 0 now, whatever lay there. */
static void assert_silent(const void *room, size_t bytes) {
    for (size_t i = 0; i < bytes; i++) assert_int_equal(((const unsigned char *)room)[i], 0);
}

RT_TEST(there_is_room_for_what_later_libraries_tell) {
    const double values[2] = {1, 2};
    raytally_objects objects = two_objects();
    raytally_verifying how = RAYTALLY_VERIFYING;
    raytally_scene *scene;
    raytally_accelerator *accel;
    raytally_rays *rays;
    raytally_tracer *tracer;
    raytally_hit hit;
    raytally_verified found;
    raytally_estimate estimate;
    raytally_time time;
    raytally_structure structure;
    raytally_counters counters[RAYTALLY_MAX_RAY_KINDS] = {{{0}}};
    const raytally_timing timing = {sizeof timing, 1, 0, 1, 1};
    how.rays = 20;
    memset(&found, 0xff, sizeof found);
    memset(&estimate, 0xff, sizeof estimate);
    memset(&time, 0xff, sizeof time);
    memset(&structure, 0xff, sizeof structure);
    assert_fine(raytally_scene_make(&objects, &scene, error));
    assert_fine(raytally_scene_sample(scene, 4, 4, 1, error));
    assert_fine(raytally_accelerator_build(scene, "bvh", 1, &accel, error));
    assert_fine(raytally_rays_record(accel, RAYTALLY_PRIMARY, NULL, &rays, error));
    assert_fine(raytally_verify(scene, "grid", &how, &found, error));
    assert_silent(found.reserved, sizeof found.reserved);
    assert_fine(raytally_estimate_median(values, 2, &estimate, error));
    assert_silent(estimate.reserved, sizeof estimate.reserved);
    assert_fine(raytally_time_all(&accel, 1, rays, &timing, &time, error));
    assert_silent(time.reserved, sizeof time.reserved);
    assert_silent(time.ratio.reserved, sizeof time.ratio.reserved);
    raytally_accelerator_describe(accel, &structure);
    assert_silent(&structure.at[RAYTALLY_FIGURES_KNOWN],
                  sizeof structure - RAYTALLY_FIGURES_KNOWN * sizeof structure.at[0]);
    assert_fine(raytally_tracer_new(accel, &tracer, error));
    raytally_nearest(tracer, raytally_rays_data(rays), 1, &hit, counters);
    assert_int_equal(counters[RAYTALLY_PRIMARY].at[RAYTALLY_RAYS], 1);
    assert_silent(&counters[RAYTALLY_RAY_KINDS],
                  (RAYTALLY_MAX_RAY_KINDS - RAYTALLY_RAY_KINDS) * sizeof counters[0]);
    raytally_tracer_free(tracer);
    raytally_rays_free(rays);
    raytally_accelerator_free(accel);
    raytally_scene_free(scene);
}

RT_TESTS(versions, NULL, NULL)
