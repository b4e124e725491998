/* SPDX-License-Identifier: Apache-2.0 */
/* Shared by tests of scenes that are moved: texts of scenes in two places, and what rays hit. */
#ifndef RT_TESTS_RECENTRE_TESTING_H
#define RT_TESTS_RECENTRE_TESTING_H

#include "crossings_testing.h"
#include "scene_testing.h"

/* As from a map: easting, northing, height. */
static const RtVec3d far_away = {{500000.123, 5400000.456, 100.789}}, nowhere = {{0, 0, 0}};

/* Writes `text` to the file with `by` added to each position, which stands as <1 2 3>. */
static inline void write_moved(const char *path, const char *text, RtVec3d by, const char *separator) {
    FILE *out = fopen(path, "w");
    assert_non_null(out);
    for (; *text; text++) {
        double p[3];
        int used = 0;
        if (*text != '<' || sscanf(text, "<%lf %lf %lf>%n", &p[0], &p[1], &p[2], &used) != 3 || used == 0) {
            fputc(*text, out);
            continue;
        }
        for (int a = 0; a < 3; a++) fprintf(out, "%s%.6f", a ? separator : "", p[a] + by.at[a]);
        text += used - 1;
    }
    assert_int_equal(fclose(out), 0);
}

/* The object that a ray hits first, and where. */
static inline uint32_t first_hit(const RtScene *scene, const RtRay *ray, float *t) {
    RtRay rest = *ray;
    RtPreparedRay prepared;
    uint32_t first = RT_NO_OBJECT;
    for (uint32_t id = 0; id < scene->geometry.object_count; id++) {
        rt_hit_ray(&prepared, &scene->geometry, &rest, hit_memory_of_tests());
        if (!rt_object_hit(&scene->geometry, id, &prepared, t, NULL)) continue;
        if (first != RT_NO_OBJECT && *t == rest.tmax) continue; /* the lower id wins a tie */
        rest.tmax = *t;
        first = id;
    }
    *t = rest.tmax;
    return first;
}

#endif
