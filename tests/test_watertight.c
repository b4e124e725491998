/* A closed mesh never leaks: from inside, every ray meets it, also one that is aimed at an edge or a vertex.
 */
#include "testing.h"

#include "base/random.h"
#include "shape/geometry.h"

#include <stdlib.h>

enum { RAYS = 100000, LEVELS = 2, MAX_TRIANGLES = 320 };

typedef struct Mesh {
    RtGeometry geometry;
    uint32_t count;
    RtTriangle triangles[MAX_TRIANGLES];
} Mesh;

/* Onto the sphere of `radius` about (shift, shift, -shift); a shared point is rounded alike for all. */
static RtVec3 on_sphere(RtVec3d p, double radius, double shift) {
    RtVec3d q = rt_scaled(rt_normalized(p), radius);
    return rt_narrow(rt_vec3d(q.x + shift, q.y + shift, q.z - shift));
}

static void subdivide(Mesh *mesh, const RtVec3d v[3], int levels, double radius, double shift) {
    if (levels == 0) {
        RtTriangle *triangle = &mesh->triangles[mesh->count++];
        for (int i = 0; i < 3; i++) triangle->v[i] = on_sphere(v[i], radius, shift);
        assert_ok(rt_geometry_add_triangle(&mesh->geometry, triangle->v, NULL, error));
        return;
    }
    RtVec3d ab = rt_addd(v[0], v[1]), bc = rt_addd(v[1], v[2]), ca = rt_addd(v[2], v[0]);
    ab = rt_normalized(ab), bc = rt_normalized(bc), ca = rt_normalized(ca);
    subdivide(mesh, (RtVec3d[]){v[0], ab, ca}, levels - 1, radius, shift);
    subdivide(mesh, (RtVec3d[]){v[1], bc, ab}, levels - 1, radius, shift);
    subdivide(mesh, (RtVec3d[]){v[2], ca, bc}, levels - 1, radius, shift);
    subdivide(mesh, (RtVec3d[]){ab, bc, ca}, levels - 1, radius, shift);
}

/* An icosahedron, every triangle split in four LEVELS times. */
static void make_icosphere(Mesh *mesh, double radius, double shift) {
    static const double g = 1.61803398874989484820; /* the golden ratio */
    const RtVec3d v[12] = {{-1, g, 0},  {1, g, 0},  {-1, -g, 0}, {1, -g, 0}, {0, -1, g},  {0, 1, g},
                           {0, -1, -g}, {0, 1, -g}, {g, 0, -1},  {g, 0, 1},  {-g, 0, -1}, {-g, 0, 1}};
    static const int faces[20][3] = {{0, 11, 5}, {0, 5, 1},  {0, 1, 7},   {0, 7, 10}, {0, 10, 11},
                                     {1, 5, 9},  {5, 11, 4}, {11, 10, 2}, {10, 7, 6}, {7, 1, 8},
                                     {3, 9, 4},  {3, 4, 2},  {3, 2, 6},   {3, 6, 8},  {3, 8, 9},
                                     {4, 9, 5},  {2, 4, 11}, {6, 2, 10},  {8, 6, 7},  {9, 8, 1}};
    *mesh = (Mesh){.count = 0};
    for (int f = 0; f < 20; f++) {
        const RtVec3d corners[3] = {rt_normalized(v[faces[f][0]]), rt_normalized(v[faces[f][1]]),
                                    rt_normalized(v[faces[f][2]])};
        subdivide(mesh, corners, LEVELS, radius, shift);
    }
    assert_int_equal(mesh->count, MAX_TRIANGLES);
    assert_ok(rt_geometry_finish(&mesh->geometry, error));
}

static uint32_t count_hits(const Mesh *mesh, const RtRay *ray) {
    RtPreparedRay prepared = rt_ray_prepare(ray, &mesh->geometry.box);
    uint32_t hits = 0;
    for (uint32_t id = 0; id < mesh->count; id++) {
        float t;
        hits += rt_object_hit(&mesh->geometry, id, &prepared, &t, NULL);
    }
    return hits;
}

/* A vertex, or a point of an edge as near as float32 has one. */
static RtVec3 target_on_mesh(const Mesh *mesh, RtRandom *random) {
    uint32_t bits = rt_random_bits(random);
    const RtTriangle *triangle = &mesh->triangles[rt_random_bits(random) % mesh->count];
    RtVec3 a = triangle->v[bits % 3], b = triangle->v[(bits + 1) % 3];
    if (bits & 0x10000) return a;
    float s = bits & 0x20000 ? 0.5f : rt_random_unit(random);
    return rt_add(rt_scale(a, 1 - s), rt_scale(b, s));
}

static void check_mesh(double radius, double shift) {
    static Mesh mesh;
    RtRandom random = rt_random(11, (uint64_t)shift);
    make_icosphere(&mesh, radius, shift);
    for (int i = 0; i < RAYS; i++) {
        RtVec3d inside =
            rt_scaled(rt_random_direction(&random), 0.9 * radius * (double)rt_random_unit(&random));
        RtVec3d center = {shift, shift, -shift};
        RtRay ray = {
            .org = rt_narrow(i % 4 == 0 ? center : rt_addd(center, inside)), .tmin = 0, .tmax = INFINITY};
        ray.dir = rt_sub(target_on_mesh(&mesh, &random), ray.org);
        if (count_hits(&mesh, &ray) > 0) continue;
        fail_msg("ray %d leaks: from (%a, %a, %a) along (%a, %a, %a)", i, (double)ray.org.x,
                 (double)ray.org.y, (double)ray.org.z, (double)ray.dir.x, (double)ray.dir.y,
                 (double)ray.dir.z);
    }
    rt_geometry_clear(&mesh.geometry);
}

static void no_ray_at_an_edge_or_vertex_leaks_from_a_closed_mesh(void **state) {
    (void)state;
    check_mesh(1, 0);
}

static void none_leaks_far_from_the_zero_of_coordinates(void **state) {
    (void)state;
    check_mesh(1, 1000);
}

static void none_leaks_from_a_mesh_of_2_to_the_minus_40(void **state) {
    (void)state;
    check_mesh(0x1p-40, 0);
}

/* ---- cubes of polygons ---- */

static RtGeometry make_cube_of_polygons(void) {
    RtGeometry g = {0};
    for (int a = 0; a < 3; a++) {
        for (float side = -1; side <= 1; side += 2) {
            RtVec3 v[4];
            for (int i = 0; i < 4; i++) {
                v[i].at[a] = side;
                v[i].at[(a + 1) % 3] = i == 0 || i == 3 ? -1 : 1;
                v[i].at[(a + 2) % 3] = i < 2 ? -1 : 1;
            }
            assert_ok(rt_geometry_add_polygon(&g, v, 4, error));
        }
    }
    assert_ok(rt_geometry_finish(&g, error));
    return g;
}

/* From the centre, towards the middle of every face, edge and corner: the rays that meet them exactly. */
static void symmetric_rays_do_not_leak_from_a_cube_of_polygons(void **state) {
    (void)state;
    RtGeometry g = make_cube_of_polygons();
    for (int code = 0; code < 27; code++) {
        RtVec3 dir = {(float)(code % 3 - 1), (float)(code / 3 % 3 - 1), (float)(code / 9 - 1)};
        RtRay ray = {.dir = dir, .tmin = 0, .tmax = INFINITY};
        if (code == 13) continue;
        RtPreparedRay prepared = rt_ray_prepare(&ray, &g.box);
        int hits = 0, faces = abs(code % 3 - 1) + abs(code / 3 % 3 - 1) + abs(code / 9 - 1);
        for (uint32_t id = 0; id < 6; id++) {
            float t;
            bool met = rt_object_hit(&g, id, &prepared, &t, NULL);
            hits += met;
            if (met) assert_true(t == 1.0f);
        }
        assert_int_equal(hits, faces);
    }
    rt_geometry_clear(&g);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(no_ray_at_an_edge_or_vertex_leaks_from_a_closed_mesh),
        cmocka_unit_test(none_leaks_far_from_the_zero_of_coordinates),
        cmocka_unit_test(none_leaks_from_a_mesh_of_2_to_the_minus_40),
        cmocka_unit_test(symmetric_rays_do_not_leak_from_a_cube_of_polygons),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
