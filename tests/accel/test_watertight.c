/* SPDX-License-Identifier: Apache-2.0 */
/* A closed mesh never leaks: from inside, every ray meets it, also one that is aimed at an edge or a vertex.
 *
 * Bodies: spheres of triangles, a cube, a pot turned from a concave profile (triangles share vertices bit for
 * bit), at several scales and far from the zero of coordinates, and the scene `hall`, a closed room. The rays
 * are traced by `bvh`, which is held against `brute` on a sample. RAYTALLY_LEAK_RAYS=N sets how many there
 * are in all. What Embree's own arithmetic loses of the same rays is printed, where Embree is there. */
#include "accel_testing.h"

#include "core/base/random.h"
#include "scenes/build.h"

enum { RAYS = 400000, CHUNK = 4096, SAMPLE_TESTS = 4000000, LEVELS = 2, SECTORS = 24 };

/* ---- bodies ---- */

/* A scene of triangles, the ball about any point of the segment from..to of radius `around` inside it. */
typedef struct Body {
    RtScene scene;
    double scale, shift;
    RtVec3d from, to;
    double around;
} Body;

static RtVec3d placed(const Body *body, RtVec3d p) {
    RtVec3d q = rt_scaled(p, body->scale);
    return rt_vec3d(q.x + body->shift, q.y + body->shift, q.z - body->shift);
}

/* A point that triangles share has the same bits in all of them, before and after it is rounded. */
static void add_triangle(Body *body, RtVec3d a, RtVec3d b, RtVec3d c) {
    const RtVec3 v[3] = {rt_narrow(placed(body, a)), rt_narrow(placed(body, b)), rt_narrow(placed(body, c))};
    assert_ok(rt_scene_add_triangle(&body->scene, 0, v, NULL, error));
}

static void set_inside(Body *body, RtVec3d from, RtVec3d to, double around) {
    body->from = placed(body, from), body->to = placed(body, to);
    body->around = around * body->scale;
}

static void subdivide(Body *body, const RtVec3d v[3], int levels) {
    if (levels == 0) {
        add_triangle(body, v[0], v[1], v[2]);
        return;
    }
    RtVec3d ab = rt_addd(v[0], v[1]), bc = rt_addd(v[1], v[2]), ca = rt_addd(v[2], v[0]);
    ab = rt_normalized(ab), bc = rt_normalized(bc), ca = rt_normalized(ca);
    subdivide(body, (RtVec3d[]){v[0], ab, ca}, levels - 1);
    subdivide(body, (RtVec3d[]){v[1], bc, ab}, levels - 1);
    subdivide(body, (RtVec3d[]){v[2], ca, bc}, levels - 1);
    subdivide(body, (RtVec3d[]){ab, bc, ca}, levels - 1);
}

/* An icosahedron, every triangle split in four LEVELS times. */
static void make_icosphere(Body *body) {
    static const double g = 1.61803398874989484820; /* the golden ratio */
    const RtVec3d v[12] = {{-1, g, 0},  {1, g, 0},  {-1, -g, 0}, {1, -g, 0}, {0, -1, g},  {0, 1, g},
                           {0, -1, -g}, {0, 1, -g}, {g, 0, -1},  {g, 0, 1},  {-g, 0, -1}, {-g, 0, 1}};
    static const int faces[20][3] = {{0, 11, 5}, {0, 5, 1},  {0, 1, 7},   {0, 7, 10}, {0, 10, 11},
                                     {1, 5, 9},  {5, 11, 4}, {11, 10, 2}, {10, 7, 6}, {7, 1, 8},
                                     {3, 9, 4},  {3, 4, 2},  {3, 2, 6},   {3, 6, 8},  {3, 8, 9},
                                     {4, 9, 5},  {2, 4, 11}, {6, 2, 10},  {8, 6, 7},  {9, 8, 1}};
    for (int f = 0; f < 20; f++) {
        const RtVec3d corners[3] = {rt_normalized(v[faces[f][0]]), rt_normalized(v[faces[f][1]]),
                                    rt_normalized(v[faces[f][2]])};
        subdivide(body, corners, LEVELS);
    }
    set_inside(body, rt_vec3d(0, 0, 0), rt_vec3d(0, 0, 0), 0.9);
}

/* The corners of face `face` of six of the cube from -1 to 1, in turn. */
static void square_of(int face, RtVec3 v[4]) {
    int a = face / 2;
    for (int i = 0; i < 4; i++) {
        v[i].at[a] = face % 2 ? 1 : -1;
        v[i].at[(a + 1) % 3] = i == 0 || i == 3 ? -1 : 1;
        v[i].at[(a + 2) % 3] = i < 2 ? -1 : 1;
    }
}

static void make_cube(Body *body) {
    for (int face = 0; face < 6; face++) {
        RtVec3 v[4];
        square_of(face, v);
        add_triangle(body, rt_widen(v[0]), rt_widen(v[1]), rt_widen(v[2]));
        add_triangle(body, rt_widen(v[0]), rt_widen(v[2]), rt_widen(v[3]));
    }
    set_inside(body, rt_vec3d(0, 0, 0), rt_vec3d(0, 0, 0), 0.9);
}

/* Turned about z from a profile of (radius, height), with a foot, a waist, a lid and a knob. */
static void make_pot(Body *body) {
    static const double profile[][2] = {{0, 0},     {0.9, 0},    {1, 0.1},    {0.7, 0.5},
                                        {1, 1},     {0.5, 1.4},  {0.55, 1.6}, {0.2, 1.55},
                                        {0.1, 1.6}, {0.2, 1.75}, {0.1, 1.85}, {0, 1.85}};
    static const size_t rings = sizeof profile / sizeof *profile;
    for (size_t i = 0; i + 1 < rings; i++) {
        for (uint32_t k = 0; k < SECTORS; k++) {
            RtVec3d v[2][2];
            for (size_t up = 0; up < 2; up++) {
                for (uint32_t next = 0; next < 2; next++) {
                    v[up][next] = rt_scaled(rt_on_circle((k + next) % SECTORS, SECTORS), profile[i + up][0]);
                    v[up][next].z = profile[i + up][1];
                }
            }
            if (i > 0) add_triangle(body, v[0][0], v[0][1], v[1][1]);
            if (i + 2 < rings) add_triangle(body, v[0][0], v[1][1], v[1][0]);
        }
    }
    set_inside(body, rt_vec3d(0, 0, 0.5), rt_vec3d(0, 0, 1), 0.3);
}

static const struct {
    const char *name;
    void (*make)(Body *body); /* NULL: a scene of this name, seen from its camera */
    double scale, shift;
} bodies[] = {
    {"icosphere", make_icosphere, 1, 0},
    {"icosphere, far", make_icosphere, 1, 1000},
    {"icosphere, tiny", make_icosphere, 0x1p-40, 0},
    {"cube", make_cube, 1, 0},
    {"cube, uneven, far", make_cube, 0.3, 100},
    {"cube, huge", make_cube, 0x1p40, 0},
    {"pot", make_pot, 1, 0},
    {"pot, far", make_pot, 0.7, 300},
    {"pot, tiny", make_pot, 1e-6, 0},
    {"hall", NULL, 1, 0},
};
enum { BODIES = sizeof bodies / sizeof *bodies };

static void set_up(Body *body, size_t index) {
    *body = (Body){.scale = bodies[index].scale, .shift = bodies[index].shift};
    if (bodies[index].make) {
        body->scene = begin_scene();
        bodies[index].make(body);
        assert_ok(rt_scene_finish(&body->scene, error));
        return;
    }
    assert_ok(rt_scene_open(bodies[index].name, &body->scene, error));
    assert_int_equal(body->scene.geometry.triangle_count, body->scene.geometry.object_count);
    body->from = rt_widen(body->scene.camera.from);
    body->to = rt_scaled(rt_addd(body->from, rt_widen(body->scene.camera.at)), 0.5);
}

/* ---- rays ---- */

/* A vertex, or a point of an edge as near as float32 has one. */
static RtVec3 target_on_mesh(const RtGeometry *g, RtRandom *random) {
    uint32_t bits = rt_random_bits(random);
    const RtTriangle *triangle = &g->triangles[rt_random_below(random, g->triangle_count)];
    RtVec3 a = triangle->v[bits % 3], b = triangle->v[(bits + 1) % 3];
    if (bits & 0x10000) return a;
    float s = bits & 0x20000 ? 0.5f : rt_random_unit(random);
    return rt_add(rt_scale(a, 1 - s), rt_scale(b, s));
}

/* Every fourth from the same point. */
static void fill_rays(const Body *body, RtRandom *random, RtRay rays[CHUNK]) {
    for (size_t i = 0; i < CHUNK; i++) {
        RtVec3d org = body->from;
        if (i % 4 != 0) {
            RtVec3d along = rt_scaled(rt_subd(body->to, body->from), (double)rt_random_unit(random));
            double away = body->around * (double)rt_random_unit(random);
            org = rt_add_scaledd(rt_addd(org, along), rt_random_direction(random), away);
        }
        rays[i] = (RtRay){.org = rt_narrow(org), .tmax = INFINITY, .kind = RT_RAY_RANDOM};
        do rays[i].dir = rt_sub(target_on_mesh(&body->scene.geometry, random), rays[i].org);
        while (!rt_ray_is_valid(&rays[i]));
    }
}

/* ---- leaks ---- */

/* `bvh` must lose nothing; what the others lose is shown. */
enum { BVH, FAST, ROBUST, TRACERS };
static const char *const specs[TRACERS] = {"bvh", "embree:robust=off", "embree:robust=on"};

typedef struct Leaks {
    RtAccel *accels[TRACERS]; /* NULL where it is not built */
    RtQuery queries[TRACERS];
    uint64_t rays[TRACERS], lost[TRACERS];
} Leaks;

static void open_tracers(Leaks *leaks, const RtScene *scene) {
    for (int i = 0; i < TRACERS; i++) {
        const RtAccelOps *ops;
        leaks->accels[i] = NULL;
        if (i != BVH && rt_accel_find("embree", &ops, NULL) != RT_OK) continue;
        assert_ok(rt_accel_open(specs[i], scene, &leaks->accels[i], error));
        assert_ok(rt_query_init(&leaks->queries[i], leaks->accels[i], error));
    }
}

static void close_tracers(Leaks *leaks) {
    for (int i = 0; i < TRACERS; i++) {
        if (!leaks->accels[i]) continue;
        rt_query_clear(&leaks->queries[i]);
        rt_accel_destroy(leaks->accels[i]);
    }
}

static void fail_at(const char *name, const RtRay *ray) {
    fail_msg("%s leaks: from (%a, %a, %a) along (%a, %a, %a)", name, (double)ray->org.x, (double)ray->org.y,
             (double)ray->org.z, (double)ray->dir.x, (double)ray->dir.y, (double)ray->dir.z);
}

static void trace(Leaks *leaks, const char *name, const RtRay *rays, size_t count) {
    static RtHit hits[CHUNK];
    for (int i = 0; i < TRACERS; i++) {
        if (!leaks->accels[i]) continue;
        rt_nearest(&leaks->queries[i], rays, count, hits, NULL);
        leaks->rays[i] += count;
        for (size_t r = 0; r < count; r++) {
            if (hits[r].object != RT_NO_OBJECT) continue;
            leaks->lost[i]++;
            if (i == BVH) fail_at(name, &rays[r]);
        }
    }
}

/* The same hits by `brute`, for as many rays as take SAMPLE_TESTS object tests. */
static void check_sample(Leaks *leaks, const RtScene *scene, const RtRay rays[CHUNK]) {
    static RtHit ours[CHUNK], right[CHUNK];
    size_t count = SAMPLE_TESTS / scene->geometry.object_count;
    if (count > CHUNK) count = CHUNK;
    OWNED_ACCEL RtAccel *brute = open_accel(scene, "brute");
    OWNED_QUERY query = open_query(brute);
    rt_nearest(&query, rays, count, right, NULL);
    rt_nearest(&leaks->queries[BVH], rays, count, ours, NULL);
    assert_memory_equal(ours, right, count * sizeof(RtHit));
}

RT_TEST(no_ray_at_an_edge_or_vertex_leaks_from_a_closed_mesh) {
    static RtRay rays[CHUNK];
    const char *asked = getenv("RAYTALLY_LEAK_RAYS");
    uint64_t all = asked ? strtoull(asked, NULL, 10) : RAYS;
    Leaks leaks = {0};
    for (size_t b = 0; b < BODIES; b++) {
        Body body;
        RtRandom random = rt_random(11, b);
        uint64_t left = all * (b + 1) / BODIES - all * b / BODIES, before[TRACERS];
        memcpy(before, leaks.lost, sizeof before);
        set_up(&body, b);
        open_tracers(&leaks, &body.scene);
        fill_rays(&body, &random, rays);
        check_sample(&leaks, &body.scene, rays);
        while (left > 0) {
            size_t count = left < CHUNK ? (size_t)left : CHUNK;
            trace(&leaks, bodies[b].name, rays, count);
            left -= count;
            if (left > 0) fill_rays(&body, &random, rays);
        }
        for (int i = 0; i < TRACERS; i++) {
            if (leaks.accels[i])
                printf("%s, %s: %ju lost\n", bodies[b].name, specs[i],
                       (uintmax_t)(leaks.lost[i] - before[i]));
        }
        close_tracers(&leaks);
        rt_scene_clear(&body.scene);
    }
    for (int i = 0; i < TRACERS; i++) {
        if (leaks.rays[i] == 0) continue;
        printf("all, %s: %ju of %ju lost\n", specs[i], (uintmax_t)leaks.lost[i], (uintmax_t)leaks.rays[i]);
    }
    assert_int_equal(leaks.lost[BVH], 0);
    assert_int_equal(leaks.rays[BVH], all);
}

/* ---- cubes of polygons ---- */

static RtGeometry make_cube_of_polygons(void) {
    RtGeometry g = {0};
    for (int face = 0; face < 6; face++) {
        RtVec3 v[4];
        square_of(face, v);
        assert_ok(rt_geometry_add_polygon(&g, v, 4, error));
    }
    assert_ok(rt_geometry_finish(&g, error));
    return g;
}

/* From the centre, towards the middle of every face, edge and corner: the rays that meet them exactly. */
RT_TEST(symmetric_rays_do_not_leak_from_a_cube_of_polygons) {
    OWNED_GEOMETRY g = make_cube_of_polygons();
    for (int code = 0; code < 27; code++) {
        RtVec3 dir = {(float)(code % 3 - 1), (float)(code / 3 % 3 - 1), (float)(code / 9 - 1)};
        RtRay ray = {.dir = dir, .tmin = 0, .tmax = INFINITY};
        if (code == 13) continue;
        RtPreparedRay prepared;
        rt_hit_ray(&prepared, &g, &ray, NULL);
        int hits = 0, faces = abs(code % 3 - 1) + abs(code / 3 % 3 - 1) + abs(code / 9 - 1);
        for (uint32_t id = 0; id < 6; id++) {
            float t;
            bool met = rt_object_hit(&g, id, &prepared, &t, NULL);
            hits += met;
            if (met) assert_true(t == 1.0f);
        }
        assert_int_equal(hits, faces);
    }
}

RT_TESTS(watertight, NULL, NULL)
