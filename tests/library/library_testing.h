/* SPDX-License-Identifier: Apache-2.0 */
/* Helpers of the tests of the library. */
#ifndef RT_TESTS_LIBRARY_TESTING_H
#define RT_TESTS_LIBRARY_TESTING_H

#include "testing.h"

#include "library/library.h"

#include <string.h>

/* As assert_ok, for the library. */
#define assert_fine(expr)                                                                                    \
    do {                                                                                                     \
        raytally_error fine_error = {RAYTALLY_OK, ""};                                                       \
        raytally_error *error = &fine_error;                                                                 \
        if ((expr) != RAYTALLY_OK) fail_msg("%s: %s", #expr, fine_error.message);                            \
    } while (0)

#define assert_says(why, text)                                                                               \
    do {                                                                                                     \
        if (!strstr((why).message, text)) fail_msg("'%s' does not say '%s'", (why).message, text);           \
    } while (0)

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

#endif
