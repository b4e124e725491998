/* shape/: the hit functions, against answers known by hand. */
#include "testing.h"

#include "shape/geometry.h"

static bool hit(const RtGeometry *g, RtRay ray, float *t) {
    RtPreparedRay prepared = rt_ray_prepare(&ray, &g->box);
    return rt_object_hit(g, 0, &prepared, t);
}

static RtRay make_ray(RtVec3 org, RtVec3 dir) {
    return (RtRay){.org = org, .dir = dir, .tmin = 0, .tmax = INFINITY};
}

static void the_lecture_ray_meets_the_unit_sphere_at_9_and_11(void **state) {
    (void)state;
    RtGeometry g = {0};
    assert_ok(rt_geometry_add_sphere(&g, rt_vec3(0, 0, 0), 1, error));
    assert_ok(rt_geometry_finish(&g, error));
    RtRay ray = make_ray(rt_vec3(0, 0, 10), rt_vec3(0, 0, -1));
    float t;
    assert_true(hit(&g, ray, &t));
    assert_true(t == 9.0f);
    ray.tmin = 9.5f;
    assert_true(hit(&g, ray, &t));
    assert_true(t == 11.0f);
    ray.tmin = 11.5f;
    assert_false(hit(&g, ray, &t));
    rt_geometry_clear(&g);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(the_lecture_ray_meets_the_unit_sphere_at_9_and_11),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
