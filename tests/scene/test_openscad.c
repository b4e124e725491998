/* SPDX-License-Identifier: Apache-2.0 */
/* The CSG trees of the example scenes against OpenSCAD: the same models, written a second time by hand in its
 * language (tests/openscad/), made into closed meshes by its exact arithmetic (CGAL), and hit through Embree.
 * Nothing is shared with our merging of spans.
 *
 * A mesh with flat facets lies up to `error` inside of what is round. So a ray is compared with a bundle of
 * rays around it, as far away as that: what we hit must lie between the nearest and the farthest that the
 * bundle hits. */
#include "accel_testing.h"
#include "crossings_testing.h"

#include "core/base/random.h"
#include "rays/rayset.h"

enum { RAYS = 20000, BUNDLE = 17 };

typedef struct Model {
    const char *name, *scene;
    uint32_t object;
    double error; /* how far the mesh may be from the model: radius * (1 - cos(180 degrees / facets)), and a
                     half more */
} Model;

static const Model models[] = {
    {"lecture", "scenes/csg-lecture.yaml", 0, 0.004}, {"bracket", "scenes/csg-bracket.yaml", 0, 0.0015},
    {"rook", "scenes/chess.yaml", 65, 0.0015},        {"knight", "scenes/chess.yaml", 66, 0.0015},
    {"bishop", "scenes/chess.yaml", 67, 0.0015},      {"pawn", "scenes/chess.yaml", 73, 0.0015},
};

/* Two unit vectors across `dir`. */
static void frame_of(RtVec3d dir, RtVec3d *u, RtVec3d *v) {
    RtVec3d other = rt_vec3d(0, 0, 0);
    other.at[(rt_major_axis(rt_narrow(dir)) + 1) % 3] = 1;
    *u = rt_normalized(rt_crossd(dir, other));
    *v = rt_normalized(rt_crossd(dir, *u));
}

/* `ray` in the middle, and two rings of eight around it, `radius` and half of it away. */
static void make_bundle(const RtRay *ray, double radius, RtRay bundle[BUNDLE]) {
    static const double ring[8][2] = {{1, 0},  {0.7, 0.7},   {0, 1},  {-0.7, 0.7},
                                      {-1, 0}, {-0.7, -0.7}, {0, -1}, {0.7, -0.7}};
    RtVec3d u, v;
    frame_of(rt_widen(ray->dir), &u, &v);
    bundle[0] = *ray;
    for (int i = 1; i < BUNDLE; i++) {
        double away = i <= 8 ? radius : radius / 2;
        RtVec3d org = rt_add_scaledd(rt_widen(ray->org), u, away * ring[(i - 1) % 8][0]);
        bundle[i] = *ray;
        bundle[i].org = rt_narrow(rt_add_scaledd(org, v, away * ring[(i - 1) % 8][1]));
    }
}

typedef struct Compared {
    uint64_t hits, alike, wrong;
} Compared;

static void compare_ray(const RtScene *scene, const Model *model, RtQuery *mesh, const RtRay *ray,
                        Compared *sum) {
    RtRay bundle[BUNDLE];
    RtHit hits[BUNDLE];
    float t = INFINITY, nearest = INFINITY, farthest = 0;
    make_bundle(ray, model->error, bundle);
    rt_nearest(mesh, bundle, BUNDLE, hits, NULL);
    for (int i = 0; i < BUNDLE; i++) {
        nearest = rt_minf(hits[i].t, nearest);
        farthest = rt_maxf(hits[i].t, farthest);
    }
    RtPreparedRay prepared;
    rt_hit_ray(&prepared, &scene->geometry, ray, hit_memory_of_tests());
    bool hit = rt_object_hit(&scene->geometry, model->object, &prepared, &t, NULL);
    float slack = (float)(model->error / rt_lengthd(rt_widen(ray->dir)));
    sum->hits += hit;
    sum->alike += hit ? fabsf(t - hits[0].t) <= 2 * slack : hits[0].t == INFINITY;
    sum->wrong += hit ? t < nearest - slack || t > farthest + slack : farthest < INFINITY;
}

static void compare(const Model *model) {
    char command[256], path[64];
    snprintf(path, sizeof path, "test_openscad_%s.stl", model->name);
    snprintf(command, sizeof command, "openscad -q -o %s tests/openscad/%s.scad", path, model->name);
    assert_int_equal(system(command), 0);
    OWNED_SCENE scene = open_scene(model->scene), mesh = open_scene(path);
    OWNED_ACCEL RtAccel *accel = open_accel(&mesh, "embree");
    OWNED_QUERY query = open_query(accel);
    Compared sum = {0};
    RtRandom random = rt_random(1, model->object);
    for (int i = 0; i < RAYS; i++) {
        RtRay ray = rt_random_chord(&scene.geometry.boxes[model->object], &random);
        compare_ray(&scene, model, &query, &ray, &sum);
    }
    print_message("%s: %d rays, %llu hits, %llu within twice the error of the mesh, %llu wrong\n",
                  model->name, RAYS, (unsigned long long)sum.hits, (unsigned long long)sum.alike,
                  (unsigned long long)sum.wrong);
    remove(path);
    assert_true(sum.hits > RAYS / 10);
    assert_true(sum.alike > RAYS * 97 / 100);
    assert_int_equal(sum.wrong, 0);
}

RT_TEST(openscad_and_embree_agree_with_our_csg_trees) {
    for (size_t i = 0; i < sizeof models / sizeof models[0]; i++) compare(&models[i]);
}

RT_TEST_GROUP(openscad) {
    if (system("openscad --version >/dev/null 2>&1") != 0) {
        puts("skipped: CSG trees against OpenSCAD's meshes; needs openscad");
        return RT_TEST_SKIPPED;
    }
    RtError error;
    const RtAccelOps *ops;
    if (rt_accel_find("embree", &ops, &error) != RT_OK) {
        puts("skipped: CSG trees against OpenSCAD's meshes; needs Embree");
        return RT_TEST_SKIPPED;
    }
    return RT_RUN_TESTS("openscad", NULL, NULL);
}
