/* SPDX-License-Identifier: Apache-2.0 */
/* Programs and libraries built with other headers: structs of options have the size that they state, and
 * structs of results have room for new members. */
#include "library_testing.h"

#include <raytally/accel.h>

/* Structs of options as a later header may define them. */
#define LATER(Options)                                                                                       \
    struct {                                                                                                 \
        Options known;                                                                                       \
        uint32_t more[2];                                                                                    \
    }

RT_TEST(options_of_a_later_header_are_taken_as_far_as_they_say_nothing_new) {
    LATER(raytally_objects) objects = {two_objects(), {0}};
    LATER(raytally_record_options) recording = {RAYTALLY_RECORD_DEFAULTS, {0}};
    LATER(raytally_verify_options) verifying = {RAYTALLY_VERIFY_DEFAULTS, {0}};
    LATER(raytally_time_options) timing = {RAYTALLY_TIME_DEFAULTS, {0}};
    Work none;
    OWNED_WORK on = {0};
    raytally_verify_result found;
    raytally_time time;
    objects.known.size = sizeof objects;
    recording.known.size = sizeof recording;
    verifying.known.size = sizeof verifying;
    timing.known.size = sizeof timing;
    verifying.known.rays = 20;
    timing.known.rounds = 1;
    timing.known.least = 0;
    assert_fine(raytally_scene_from_objects(&objects.known, &on.scene, error));
    assert_fine(raytally_scene_set_sampling(on.scene, 4, 4, 1, error));
    assert_fine(raytally_accelerator_build(on.scene, "bvh", 1, &on.accel, error));
    assert_fine(raytally_rays_record(on.accel, RAYTALLY_PRIMARY, &recording.known, &on.rays, error));
    assert_fine(raytally_verify(on.scene, "grid", &verifying.known, &found, error));
    assert_fine(raytally_time_all(&on.accel, 1, on.rays, &timing.known, &time, error));

    objects.more[1] = recording.more[0] = verifying.more[0] = timing.more[1] = 1;
    assert_fails(raytally_scene_from_objects(&objects.known, &none.scene, error), RAYTALLY_NOT_AVAILABLE,
                 "raytally_objects: byte 60 is set, but raytally " RT_VERSION " knows only");
    assert_null(none.scene);
    assert_fails(raytally_rays_record(on.accel, RAYTALLY_PRIMARY, &recording.known, &none.rays, error),
                 RAYTALLY_NOT_AVAILABLE, "raytally_record_options");
    assert_null(none.rays);
    assert_fails(raytally_verify(on.scene, "grid", &verifying.known, &found, error), RAYTALLY_NOT_AVAILABLE,
                 "raytally_verify_options");
    assert_fails(raytally_time_all(&on.accel, 1, on.rays, &timing.known, &time, error),
                 RAYTALLY_NOT_AVAILABLE, "raytally_time_options");
}

/* The next member takes the place of `reserved`. */
RT_TEST(what_is_reserved_in_options_is_zero) {
    raytally_objects objects = two_objects();
    raytally_scene *scene;
    objects.reserved = 1;
    assert_fails(raytally_scene_from_objects(&objects, &scene, error), RAYTALLY_NOT_AVAILABLE, "");
    assert_null(scene);
}

RT_TEST(options_that_nobody_initialised_are_refused) {
    static const size_t sizes[] = {0, 3, 5000, SIZE_MAX};
    raytally_objects objects = two_objects();
    raytally_scene *scene;
    for (size_t i = 0; i < sizeof sizes / sizeof sizes[0]; i++) {
        objects.size = sizes[i];
        assert_refused(raytally_scene_from_objects(&objects, &scene, error), "initialise it");
    }
}

/* Room for new members of results is 0, whatever was there before. */
static void assert_silent(const void *room, size_t bytes) {
    for (size_t i = 0; i < bytes; i++) assert_int_equal(((const unsigned char *)room)[i], 0);
}

RT_TEST(there_is_room_for_what_later_libraries_tell) {
    const double values[2] = {1, 2};
    raytally_verify_options how = RAYTALLY_VERIFY_DEFAULTS;
    OWNED_WORK on = open_two_objects();
    raytally_hit hit;
    raytally_verify_result found;
    raytally_estimate estimate;
    raytally_time time;
    raytally_statistics structure;
    raytally_counters counters[RAYTALLY_MAX_RAY_KINDS] = {{{0}}};
    const raytally_time_options timing = {sizeof timing, 1, 0, 1, 1};
    how.rays = 20;
    memset(&found, 0xff, sizeof found);
    memset(&estimate, 0xff, sizeof estimate);
    memset(&time, 0xff, sizeof time);
    memset(&structure, 0xff, sizeof structure);
    assert_fine(raytally_scene_set_sampling(on.scene, 4, 4, 1, error));
    assert_fine(raytally_accelerator_build(on.scene, "bvh", 1, &on.accel, error));
    assert_fine(raytally_rays_record(on.accel, RAYTALLY_PRIMARY, NULL, &on.rays, error));
    assert_fine(raytally_verify(on.scene, "grid", &how, &found, error));
    assert_silent(found.reserved, sizeof found.reserved);
    assert_fine(raytally_estimate_median(values, 2, &estimate, error));
    assert_silent(estimate.reserved, sizeof estimate.reserved);
    assert_fine(raytally_time_all(&on.accel, 1, on.rays, &timing, &time, error));
    assert_silent(time.reserved, sizeof time.reserved);
    assert_silent(time.ratio.reserved, sizeof time.ratio.reserved);
    raytally_accelerator_describe(on.accel, &structure);
    assert_silent(&structure.at[RAYTALLY_STATISTICS_KNOWN],
                  sizeof structure - RAYTALLY_STATISTICS_KNOWN * sizeof structure.at[0]);
    assert_fine(raytally_tracer_new(on.accel, &on.tracer, error));
    raytally_nearest(on.tracer, raytally_rays_data(on.rays), 1, &hit, counters);
    assert_int_equal(counters[RAYTALLY_PRIMARY].at[RAYTALLY_RAYS], 1);
    assert_silent(&counters[RAYTALLY_RAY_KINDS],
                  (RAYTALLY_MAX_RAY_KINDS - RAYTALLY_RAY_KINDS) * sizeof counters[0]);
}

RT_TESTS(versions, NULL, NULL)
