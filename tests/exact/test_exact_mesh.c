/* SPDX-License-Identifier: Apache-2.0 */
/* Meshes in exact arithmetic: lines through vertices and edges and in faces, meshes that overlap
 * themselves, and that all lines through a point agree whether it is inside. */
#include "csg_testing.h"
#include "solids_testing.h"

#include "exact/referee.h"

/* ---- meshes of boxes ---- */

enum { BOXES = 6 };

/* The box from lo to hi; turned inside out, if wanted. */
static uint32_t put_box(RtVec3 lo, RtVec3 hi, bool turned, RtTriangle *out) {
    uint32_t count = cube_mesh(out);
    for (uint32_t i = 0; i < count; i++) {
        for (int k = 0; k < 3; k++) {
            RtVec3 *v = &out[i].v[k];
            for (int a = 0; a < 3; a++) v->at[a] = v->at[a] < 0 ? lo.at[a] : hi.at[a];
        }
        RtVec3 last = out[i].v[2];
        if (turned) out[i].v[2] = out[i].v[1], out[i].v[1] = last;
    }
    return count;
}

static RtCsgTerm add_mesh(RtCsgBuilder *b, const RtTriangle *triangles, uint32_t count) {
    RtTransform still = rt_transform_identity();
    uint32_t solid;
    assert_ok(rt_solid_add_mesh(&b->set, triangles, count, &still, &solid, error));
    return term_of(b, solid);
}

/* The tree of a mesh alone, the first solid of `forest`. */
static RtCsg tree_of_mesh(RtCsgForest *forest, const RtTriangle *triangles, uint32_t count) {
    OWNED_BUILDER b = {0};
    return compile(forest, &b, add_mesh(&b, triangles, count));
}

/* A large box and others at halves, some of them inside out, in one mesh: they overlap, touch, share faces
 * and dig holes, and where two are dug out of one the depth is below 0. */
static RtCsg tree_of_boxes(RtCsgForest *forest, RtRandom *random) {
    RtTriangle triangles[12 * BOXES];
    uint32_t count = put_box(rt_vec3(-3, -3, -3), rt_vec3(3, 3, 3), false, triangles);
    for (int i = 1; i < BOXES; i++) {
        RtVec3 lo, hi;
        for (int a = 0; a < 3; a++) {
            lo.at[a] = 0.5f * (float)(rt_random_below(random, 8)) - 4;
            hi.at[a] = lo.at[a] + 0.5f * (float)(1 + rt_random_below(random, 6));
        }
        count += put_box(lo, hi, i % 2, triangles + count);
    }
    return tree_of_mesh(forest, triangles, count);
}

/* Powers of two or 0, and a point at halves: all that the hit function computes about boxes is exact. */
static RtRay lattice_ray(RtRandom *random) {
    static const float steps[7] = {-2, -1, -0.5f, 0, 0.5f, 1, 2};
    RtRay ray = {.tmax = INFINITY, .kind = RT_RAY_RANDOM};
    for (int a = 0; a < 3; a++) {
        ray.org.at[a] = 0.5f * (float)(rt_random_below(random, 17)) - 4;
        ray.dir.at[a] = steps[rt_random_below(random, 7)];
    }
    if (ray.dir.x == 0 && ray.dir.y == 0 && ray.dir.z == 0) ray.dir.x = 1;
    return ray;
}

/* Writes the places, which are doubles here, to out[0..MOST); returns their number. */
static uint32_t places_of(const RtCsgForest *forest, const RtCsg *tree, const RtRay *ray, double *out) {
    OWNED_MEMORY double *at;
    uint32_t count;
    RtWideRay wide = rt_wide_ray(ray);
    assert_ok(rt_exact_csg_boundaries(forest, tree, &wide, 0, &at, &count, error));
    assert_true(count <= MOST && count % 2 == 0);
    for (uint32_t i = 0; i < count; i++) out[i] = at[i];
    return count;
}

RT_TEST(lines_at_vertices_edges_and_faces_are_decided_like_the_hit_function) {
    RtRandom random = rt_random(21, 0);
    int found = 0;
    for (int mesh = 0; mesh < 40; mesh++) {
        OWNED_FOREST forest = {0};
        RtCsg tree = tree_of_boxes(&forest, &random);
        for (int i = 0; i < 200; i++) {
            RtRay ray = lattice_ray(&random);
            double exact[MOST];
            List list = cross(&forest.set, 0, &ray);
            uint32_t count = places_of(&forest, &tree, &ray, exact);
            if (count != list.count)
                fail_msg("mesh %d, ray %d: %u places, not %u", mesh, i, count, list.count);
            for (uint32_t k = 0; k < count; k++) assert_true(exact[k] == (double)list.at[k].t);
            found += (int)count;
        }
    }
    assert_true(found > 10000);
}

/* ---- the side on which it passes ---- */

/* Along z, x is kx and y is ky: up along x, down along y. So faces at the lower x and at the upper y are
 * passed inside, the others outside. */
RT_TEST(a_line_in_a_face_passes_beside_it_up_along_x_and_down_along_y) {
    const struct {
        float x, y;
        bool inside;
    } lines[] = {{-1, 0, true},   {1, 0, false}, {0, -1, false}, {0, 1, true},
                 {-1, -1, false}, {-1, 1, true}, {1, -1, false}, {1, 1, false}};
    OWNED_FOREST forest = {0};
    RtTriangle triangles[12];
    RtCsg tree = tree_of_mesh(&forest, triangles, cube_mesh(triangles));
    for (size_t i = 0; i < sizeof lines / sizeof lines[0]; i++) {
        for (int sign = -1; sign <= 1; sign += 2) {
            double exact[MOST];
            float z = (float)sign;
            RtRay ray = ray_along(rt_vec3(lines[i].x, lines[i].y, -10 * z), rt_vec3(0, 0, z));
            uint32_t count = places_of(&forest, &tree, &ray, exact);
            if (count != (lines[i].inside ? 2 : 0)) fail_msg("line %zu: %u places", i, count);
            if (count == 2) assert_true(exact[0] == 9 && exact[1] == 11);
        }
    }
}

/* ---- depth ---- */

/* 0..4 and 2..6 in one mesh, 1..3 dug out of it: full at 0..1, 2..6. The whole once more dug out at 5..7. */
RT_TEST(a_mesh_that_overlaps_itself_is_inside_where_more_is_entered_than_left) {
    static const struct {
        float lo, hi;
        bool turned;
    } slabs[] = {{0, 4, false}, {2, 6, false}, {1, 3, true}, {5, 7, true}};
    OWNED_FOREST forest = {0};
    RtTriangle triangles[48];
    uint32_t count = 0;
    for (int i = 0; i < 4; i++)
        count += put_box(rt_vec3(slabs[i].lo, -1, -1), rt_vec3(slabs[i].hi, 1, 1), slabs[i].turned,
                         triangles + count);
    RtCsg tree = tree_of_mesh(&forest, triangles, count);
    RtRay ray = ray_along(rt_vec3(-1, 0.25f, 0.5f), rt_vec3(1, 0, 0));
    static const double expected[4] = {1, 2, 3, 6};
    double exact[MOST];
    assert_int_equal(places_of(&forest, &tree, &ray, exact), 4);
    for (int i = 0; i < 4; i++) assert_true(exact[i] == expected[i]);
}

/* ---- inside or not ---- */

/* Is the origin inside, by the number of places behind it? */
static bool starts_inside(const RtCsgForest *forest, const RtCsg *tree, const RtRay *ray) {
    double exact[MOST];
    uint32_t count = places_of(forest, tree, ray, exact), before = 0;
    while (before < count && exact[before] < 0) before++;
    return before % 2;
}

/* Points at odd multiples of 1/16 are on no face. Lines through them and points at halves meet vertices and
 * edges all the time; their t are no dyadic numbers. */
RT_TEST(all_lines_through_a_point_agree_whether_it_is_inside) {
    RtRandom random = rt_random(22, 0);
    int inside = 0, points = 0;
    for (int mesh = 0; mesh < 30; mesh++) {
        OWNED_FOREST forest = {0};
        RtCsg tree = tree_of_boxes(&forest, &random);
        for (int i = 0; i < 40; i++, points++) {
            RtRay ray = {.tmax = INFINITY, .kind = RT_RAY_RANDOM};
            int ayes = 0;
            for (int a = 0; a < 3; a++)
                ray.org.at[a] = 0.0625f * (float)(2 * (rt_random_below(&random, 64)) + 1) - 4;
            for (int k = 0; k < 5; k++) {
                for (int a = 0; a < 3; a++) {
                    float target = 0.5f * (float)(rt_random_below(&random, 17)) - 4;
                    ray.dir.at[a] = target - ray.org.at[a];
                }
                ayes += starts_inside(&forest, &tree, &ray);
            }
            if (ayes != 0 && ayes != 5) fail_msg("mesh %d, point %d: %d of 5 lines", mesh, i, ayes);
            inside += ayes == 5;
        }
    }
    assert_true(inside > points / 5 && inside < points);
}

/* ---- in trees ---- */

/* A cube as a mesh without the same cube as a box is nothing, and the other way round; lines through edges
 * and vertices included. A ball in the cube, taken away, is met behind the mesh's front. */
RT_TEST(a_cube_without_the_mesh_of_a_cube_is_empty) {
    OWNED_GEOMETRY g = {0};
    OWNED_BUILDER b = {0};
    RtTriangle triangles[12];
    uint32_t solid;
    RtCsgTerm mesh = add_mesh(&b, triangles, cube_mesh(triangles));
    RtCsgTerm same = box(&b, rt_vec3(-1, -1, -1), rt_vec3(1, 1, 1), 0);
    assert_ok(rt_solid_add_ellipsoid(&b.set, rt_vec3(0, 0, 0), rt_vec3(2, 2, 0.5f), &solid, error));
    add_tree(&g, &b, cut(&b, mesh, same));
    add_tree(&g, &b, cut(&b, same, mesh));
    add_tree(&g, &b, cut(&b, mesh, term_of(&b, solid)));
    assert_ok(rt_geometry_finish(&g, error));
    RtRandom random = rt_random(23, 0);
    for (int i = 0; i < 1000; i++) {
        RtWideRay line = {.org = rt_widen(rt_scale(rt_random_point(&random, 1), 4)), .tmax = HUGE_VAL};
        RtVec3 target = rt_random_point(&random, 1);
        for (int a = 0; a < 3; a++) {
            if (i % 4 > a) target.at[a] = target.at[a] < 0 ? -1 : 1;
        }
        line.dir = rt_widen(rt_sub(target, rt_narrow(line.org)));
        long double t;
        for (uint32_t id = 0; id < 2; id++) assert_int_equal(rt_referee_hit(&g, id, &line, &t), RT_MISSED);
    }
    long double t;
    RtWideRay down = {rt_vec3d(0, 0, 10), rt_vec3d(0, 0, -1), 9.25, HUGE_VAL};
    assert_int_equal(rt_referee_hit(&g, 2, &down, &t), RT_HIT);
    assert_true(t == 9.5L);
}

RT_TESTS(exact_mesh, NULL, NULL)
