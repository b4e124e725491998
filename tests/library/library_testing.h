/* SPDX-License-Identifier: Apache-2.0 */
/* Helpers of the tests of the library. */
#ifndef RT_TESTS_LIBRARY_TESTING_H
#define RT_TESTS_LIBRARY_TESTING_H

#include "testing.h"

#include "library/library.h"

/* As assert_ok, for the library. */
#define assert_fine(expr)                                                                                    \
    do {                                                                                                     \
        raytally_error fine_error = {RAYTALLY_OK, ""};                                                       \
        raytally_error *error = &fine_error;                                                                 \
        if ((expr) != RAYTALLY_OK) fail_msg("%s: %s", #expr, fine_error.message);                            \
    } while (0)

/* As assert_fails_with, for the library. */
#define assert_fails(expr, expected, says)                                                                   \
    do {                                                                                                     \
        raytally_error refusal = {RAYTALLY_OK, ""};                                                          \
        raytally_error *error = &refusal;                                                                    \
        if ((expr) != (expected) || refusal.status != (expected) || !strstr(refusal.message, says))          \
            fail_msg("%s: '%s' is not " #expected " with '%s'", #expr, refusal.message, says);               \
    } while (0)

#define assert_refused(expr, says) assert_fails(expr, RAYTALLY_BAD_INPUT, says)

/* What a test works with; what it opened goes at the end of its scope. */
typedef struct Work {
    raytally_scene *scene;
    raytally_accelerator *accel;
    raytally_rays *rays;
    raytally_tracer *tracer;
} Work;

static inline void clear_work(Work *work) {
    raytally_tracer_free(work->tracer);
    raytally_rays_free(work->rays);
    raytally_accelerator_free(work->accel);
    raytally_scene_free(work->scene);
}

#define OWNED_WORK OWNED(clear_work) Work

/* A triangle at z = 0 and a sphere of radius 1 around (0, 0, -3). */
static inline raytally_objects two_objects(void) {
    static const float vertices[] = {-1, -1, 0, 1, -1, 0, 0, 1, 0}, spheres[] = {0, 0, -3, 1};
    static const uint32_t corners[] = {0, 1, 2};
    raytally_objects objects = RAYTALLY_OBJECTS;
    objects.vertices = vertices;
    objects.vertex_count = 3;
    objects.corners = corners;
    objects.triangle_count = 1;
    objects.spheres = spheres;
    objects.sphere_count = 1;
    return objects;
}

static inline Work open_two_objects(void) {
    raytally_objects objects = two_objects();
    Work work = {0};
    assert_fine(raytally_scene_from_objects(&objects, &work.scene, error));
    return work;
}

#endif
