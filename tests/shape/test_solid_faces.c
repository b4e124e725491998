/* SPDX-License-Identifier: Apache-2.0 */
/* core/shape/solid.h: meshes, hulls and coincident planes: faces that several solids or triangles share. */
#include "solids_testing.h"

/* ---- what different solids have in common ---- */

static void assert_same_places(const List *a, const List *b, const RtRay *ray) {
    bool same = a->count == b->count;
    for (uint32_t i = 0; same && i < a->count; i++) same = a->at[i].t == b->at[i].t;
    if (same) return;
    fail_msg("%u and %u crossings, the first at %.9g and %.9g, from (%g, %g, %g) along (%g, %g, %g)",
             a->count, b->count, (double)a->at[0].t, (double)b->at[0].t, (double)ray->org.x,
             (double)ray->org.y, (double)ray->org.z, (double)ray->dir.x, (double)ray->dir.y,
             (double)ray->dir.z);
}

static RtVec3 lattice(uint32_t number, int side) {
    int n = (int)number;
    return rt_vec3((float)(n % side - side / 2), (float)(n / side % side - side / 2),
                   (float)(n / side / side - side / 2));
}

/* The cube of 4 units, each face in 4 x 4 x 2 triangles. */
static uint32_t fine_cube_mesh(RtTriangle out[192]) {
    uint32_t n = 0;
    for (int a = 0; a < 3; a++) {
        for (int cell = 0; cell < 32; cell++) {
            float side = cell < 16 ? -2 : 2, u = (float)(cell % 4 - 2), v = (float)(cell / 4 % 4 - 2);
            const float square[4][2] = {{u, v}, {u + 1, v}, {u + 1, v + 1}, {u, v + 1}};
            RtVec3 corners[4];
            for (int k = 0; k < 4; k++) {
                const float *at = square[side > 0 ? k : 3 - k];
                corners[k].at[a] = side, corners[k].at[(a + 1) % 3] = at[0],
                corners[k].at[(a + 2) % 3] = at[1];
            }
            out[n++] = (RtTriangle){{corners[0], corners[1], corners[2]}};
            out[n++] = (RtTriangle){{corners[0], corners[2], corners[3]}};
        }
    }
    return n;
}

/* Lines from all points of a lattice to others, through edges and corners of the mesh, along its faces and
 * edges. A mesh may take a line in the plane of a face for inside, where a box does not. */
RT_TEST(a_cube_of_triangles_is_a_box_even_at_edges_and_corners) {
    OWNED_SOLIDS set = {0};
    uint32_t box, mesh;
    RtTriangle triangles[192];
    uint32_t count = fine_cube_mesh(triangles);
    assert_ok(rt_solid_add_box(&set, rt_vec3(-2, -2, -2), rt_vec3(2, 2, 2), &box, error));
    assert_ok(rt_solid_add_mesh(&set, triangles, count, NULL, &mesh, error));
    for (uint32_t from = 0; from < 7 * 7 * 7; from++) {
        for (uint32_t along = 0; along < 5 * 5 * 5; along++) {
            if (along == 62) continue; /* nowhere */
            RtRay ray = ray_along(lattice(from, 7), lattice(along, 5));
            List of_box = cross(&set, box, &ray), of_mesh = cross(&set, mesh, &ray);
            bool in_face = false;
            for (int a = 0; a < 3; a++) in_face |= ray.dir.at[a] == 0 && fabsf(ray.org.at[a]) == 2;
            if (!in_face) assert_same_places(&of_box, &of_mesh, &ray);
            if (in_face) assert_int_equal(of_box.count, 0);
        }
    }
}

/* Two cubes of triangles as one mesh, the second of `size` and moved along x and y; of a size below 0 it is
 * turned inside out. */
typedef struct Pair {
    float size, by;
} Pair;

static Pair pair;

static long double in_pair(Point p, double ratio) {
    long double by = (long double)pair.by, size = fabsl((long double)pair.size), first = in_box(p, ratio);
    long double second = size * in_box((Point){(p.x - by) / size, (p.y - by) / size, p.z / size}, ratio);
    return pair.size < 0 ? most_of(first, -second) : first < second ? first : second;
}

static uint32_t pair_mesh(RtTriangle out[24]) {
    uint32_t half = cube_mesh(out), count = half + cube_mesh(out + half);
    for (uint32_t i = half; i < count; i++) {
        for (int v = 0; v < 3; v++)
            out[i].v[v] = rt_add(rt_scale(out[i].v[v], pair.size), rt_vec3(pair.by, pair.by, 0));
    }
    return count;
}

/* One twice; overlapping; touching along an edge, where each directed edge is there twice; apart; a cavity;
 * and what is inside out on its own encloses nothing. */
RT_TEST(a_mesh_may_overlap_and_touch_itself_and_be_hollow) {
    static const Pair pairs[] = {{1, 0}, {1, 1}, {1, 2}, {1, 3}, {-0.5f, 0}, {-0.5f, 3}};
    RtTransform place = rt_transform_identity();
    for (size_t i = 0; i < sizeof pairs / sizeof *pairs; i++) {
        OWNED_SOLIDS set = {0};
        RtTriangle triangles[24];
        pair = pairs[i];
        Model model = {.name = "a pair of cubes", .inside = in_pair, .place = place, .rounding = 0x1p-50};
        invert(&place, model.back);
        assert_ok(rt_solid_add_mesh(&set, triangles, pair_mesh(triangles), &place, &model.index, error));
        for (uint32_t from = 0; from < 5 * 5 * 5; from++) {
            for (uint32_t along = 0; along < 5 * 5 * 5; along++) {
                if (along == 62) continue;
                RtRay ray = ray_along(lattice(from, 5), lattice(along, 5));
                check_line(&model, &set, &ray);
            }
        }
    }
}

/* As near to them as float32 allows, which is in them for some. */
RT_TEST(lines_along_edges_and_faces_of_a_turned_mesh_keep_to_it) {
    RtRandom random = rt_random(9, 0);
    for (int round = 0; round < 50; round++) {
        RtTransform place = rt_transform_identity();
        assert_ok(rt_transform_rotate(&place, rt_vec3(1, 2, 3), round * 10, error));
        OWNED_MODELS(set, models, &place);
        const Model *cube = &models[MODELS - 2];
        const RtTriangle *triangles = set.triangles + set.solids[cube->index].first;
        for (uint32_t i = 0; i < 12; i++) {
            for (int k = 0; k < 9; k++) {
                RtVec3 a = triangles[i].v[k % 3], b = triangles[i].v[(k + 1) % 3],
                       c = triangles[i].v[(k + 2) % 3];
                RtVec3 dir = rt_add(rt_sub(b, a), rt_scale(rt_sub(c, a), (float)(k / 3) / 4));
                float back = rt_random_between(&random, 0, 3);
                RtRay ray = ray_along(rt_add(a, rt_scale(dir, -back)), dir);
                List list = check_line(cube, &set, &ray);
                for (uint32_t n = 0; n < list.count; n++)
                    assert_true(fabsl(value_at(cube, &ray, (long double)list.at[n].t)) < 1e-5L);
            }
        }
    }
}

/* A vertex in the middle of an edge that the triangle on the other side does not have, and a triangle without
 * area that closes the mesh there. Lines go through that edge. */
RT_TEST(a_triangle_without_area_does_no_harm) {
    RtRandom random = rt_random(10, 0);
    for (int round = 0; round < 100; round++) {
        RtTriangle triangles[14];
        RtTransform place = rt_transform_identity();
        if (round % 2) assert_ok(rt_transform_rotate(&place, rt_vec3(3, 2, 1), round, error));
        uint32_t count = cube_mesh(triangles), split = (uint32_t)round % count;
        RtVec3 p = triangles[split].v[0], q = triangles[split].v[1], r = triangles[split].v[2];
        float part = rt_random_unit(&random);
        RtVec3 middle = rt_add(p, rt_scale(rt_sub(q, p), part));
        triangles[split] = (RtTriangle){{p, middle, r}};
        triangles[count++] = (RtTriangle){{middle, q, r}};
        triangles[count++] = (RtTriangle){{p, q, middle}};
        OWNED_SOLIDS set = {0};
        Model model = {
            .name = "a cube with a flat triangle", .inside = in_box, .place = place, .rounding = 0x1p-22};
        invert(&place, model.back);
        assert_ok(rt_solid_add_mesh(&set, triangles, count, &place, &model.index, error));
        for (int i = 0; i < 300; i++) {
            RtVec3 at = rt_add(p, rt_scale(rt_sub(q, p), rt_random_unit(&random)));
            RtRay ray = random_ray(&model, &random, rt_widen(at), i % 3 ? 3 : 0);
            if (i % 4 == 0) ray.dir = rt_transform_point(&place, rt_sub(p, q));
            check_line(&model, &set, &ray);
        }
    }
}

/* A box, the caps of a cylinder and a half-space, turned and moved alike; then not turned. */
RT_TEST(faces_in_one_plane_are_met_at_the_same_bits) {
    RtRandom random = rt_random(3, 0);
    for (int round = 0; round < 40; round++) {
        RtTransform move = rt_transform_identity();
        float size = rt_random_between(&random, 0.1f, 30);
        assert_ok(rt_transform_scale(&move, rt_vec3(size, size, size), error));
        if (round % 2) assert_ok(rt_transform_rotate(&move, rt_vec3(1, 2, 3), 36 * round, error));
        assert_ok(rt_transform_translate(&move, rt_random_point(&random, 1000), error));
        OWNED_SOLIDS set = {0};
        uint32_t at[5];
        assert_ok(rt_solid_add_box(&set, rt_vec3(-9, -9, 0.1f), rt_vec3(9, 9, 0.7f), &at[0], error));
        assert_ok(rt_solid_add_box(&set, rt_vec3(-9, -9, 0.7f), rt_vec3(9, 9, 1.5f), &at[1], error));
        assert_ok(rt_solid_add_frustum(&set, rt_vec3(0, 0, 0.1f), 9, rt_vec3(0, 0, 0.7f), 9, &at[2], error));
        assert_ok(rt_solid_add_frustum(&set, rt_vec3(0, 0, 0.7f), 9, rt_vec3(0, 0, 0.1f), 5, &at[3], error));
        assert_ok(rt_solid_add_half_space(&set, rt_vec3(3, 2, 0.7f), rt_vec3(0, 0, 1), &at[4], error));
        for (int i = 0; i < 5; i++) assert_ok(rt_solid_add_moved(&set, &set, at[i], &move, &at[i], error));
        for (int i = 0; i < 100; i++) {
            RtVec3d aim = rt_transform_pointd(&move, rt_widen(rt_random_point(&random, 1)));
            RtVec3d dir = rt_random_direction(&random), up = {{move.m[0][2], move.m[1][2], move.m[2][2]}};
            if (fabs(rt_dotd(dir, up)) < 0.5 * rt_lengthd(up)) continue; /* too flat to go through caps */
            RtRay ray = ray_along(rt_narrow(rt_add_scaledd(aim, dir, -2 * (double)size)), rt_narrow(dir));
            List box = cross(&set, at[0], &ray), next = cross(&set, at[1], &ray),
                 cylinder = cross(&set, at[2], &ray);
            List frustum = cross(&set, at[3], &ray), half = cross(&set, at[4], &ray);
            bool upward = rt_dotd(dir, up) > 0;
            assert_int_equal(box.count, 2);
            assert_int_equal(next.count, 2);
            assert_true(box.at[upward].t == next.at[!upward].t);
            assert_true(box.at[upward].t == half.at[upward].t);
            assert_same_places(&box, &cylinder, &ray);
            assert_same_places(&box, &frustum, &ray);
        }
    }
}

/* Their offsets are float32, so that a sum and what it rounds to are one plane. */
RT_TEST(faces_along_an_axis_are_where_float32_has_them) {
    OWNED_SOLIDS set = {0};
    uint32_t moved, standing;
    RtTransform move = rt_transform_identity();
    assert_ok(rt_transform_scale(&move, rt_vec3(3, 0.1f, 0.7f), error));
    assert_ok(rt_transform_translate(&move, rt_vec3(0.1f, 0.3f, 1e-9f), error));
    RtVec3 lo = rt_vec3(-1, -1, -1), hi = rt_vec3(1, 1, 1);
    assert_ok(rt_solid_add_box(&set, lo, hi, &moved, error));
    assert_ok(rt_solid_add_moved(&set, &set, moved, &move, &moved, error));
    lo = rt_transform_point(&move, lo), hi = rt_transform_point(&move, hi);
    assert_ok(rt_solid_add_box(&set, lo, hi, &standing, error));
    const RtPlane *a = set.planes + set.solids[moved].first, *b = set.planes + set.solids[standing].first;
    for (int i = 0; i < 6; i++) {
        assert_true(a[i].offset == b[i].offset);
        assert_near(rt_lengthd(rt_subd(a[i].normal, b[i].normal)), 0, 0);
    }
    RtBox own = {lo, hi};
    assert_memory_equal(&set.solids[moved].box, &own, sizeof own);
}

/* Ends that float32 moves by as much as the cone is high. What extents are made from has to move, too: a ray
 * that met the cone between its caps once missed the ball about it. */
RT_TEST(a_cone_ends_where_float32_has_its_caps) {
    const RtTransform place = {
        {{0.0039, 0, 0, 100000.987}, {0, -0.0039, 0, 99999.1225}, {0, 0, -0.0039, 99999.87427}}};
    RtVec3d up = {{0, 0, 1}};
    for (int ratio = 0; ratio < 2; ratio++) {
        OWNED_SOLIDS set = {0};
        uint32_t standing, moved;
        RtTransform none = rt_transform_identity();
        assert_ok(rt_solid_add_cone(&set, 0.75 * ratio, &none, &moved, error));
        assert_ok(rt_solid_add_moved(&set, &set, moved, &place, &moved, error));
        assert_ok(rt_solid_add_cone(&set, 0.75 * ratio, &place, &standing, error));
        const uint32_t both[2] = {standing, moved};
        for (int i = 0; i < 2; i++) {
            const RtSolid *solid = &set.solids[both[i]];
            assert_true(solid->to_world.m[2][3] == (double)99999.87427f);
            double apex = ratio ? (double)(float)(99999.87427 - 0.0039) : 99999.87427 - 0.0039;
            assert_true(solid->to_world.m[2][3] + solid->to_world.m[2][2] == apex);
            assert_true(rt_solid_support(&set, both[i], up) == (double)99999.87427f);
            assert_true(rt_solid_support(&set, both[i], rt_scaled(up, -1)) == -apex);
        }
    }
}

RT_TEST(what_rounding_makes_flat_is_refused) {
    OWNED_SOLIDS set = {0};
    uint32_t box, cone, mesh, index;
    RtTransform far = rt_transform_identity(), none = far;
    const RtVec3 v[4] = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
    const RtTriangle faces[4] = {
        {{v[0], v[2], v[1]}}, {{v[0], v[1], v[3]}}, {{v[0], v[3], v[2]}}, {{v[1], v[2], v[3]}}};
    assert_ok(rt_transform_translate(&far, rt_vec3(0, 0, 0x1p30f), error));
    assert_ok(rt_solid_add_box(&set, v[0], rt_vec3(1, 1, 1), &box, error));
    assert_ok(rt_solid_add_cone(&set, 0.5, &none, &cone, error));
    assert_ok(rt_solid_add_mesh(&set, faces, 4, &none, &mesh, error));
    const uint32_t solids[3] = {box, cone, mesh}, planes = set.plane_count, triangles = set.triangle_count;
    const char *const says[3] = {"enclose nothing", "flat", "volume"};
    for (int i = 0; i < 3; i++)
        assert_bad_input(rt_solid_add_moved(&set, &set, solids[i], &far, &index, error), says[i]);
    assert_int_equal(set.solid_count, 3);
    assert_int_equal(set.plane_count, planes);
    assert_int_equal(set.triangle_count, triangles);
}

/* ---- hulls ---- */

RT_TEST(the_hull_of_the_corners_of_a_box_is_the_box) {
    RtRandom random = rt_random(4, 0);
    OWNED_SOLIDS set = {0};
    RtVec3 lo = rt_vec3(-0.7f, 2.1f, 100.3f), hi = rt_vec3(0.1f, 2.5f, 101);
    RtVec3 points[12], *corners = points + 1;
    points[0] = rt_vec3(0, lo.y, lo.z); /* between the first two corners */
    for (uint32_t i = 0; i < 8; i++)
        corners[i] = rt_vec3((i & 1 ? hi : lo).x, (i & 2 ? hi : lo).y, (i & 4 ? hi : lo).z);
    corners[8] = corners[3];
    corners[9] = rt_vec3(0, 2.3f, 100.5f); /* inside */
    corners[10] = rt_vec3(0, 2.3f, NAN);   /* behind the last */
    uint32_t box, hull;
    assert_ok(rt_solid_add_box(&set, lo, hi, &box, error));
    assert_ok(rt_solid_add_hull(&set, points, 11, &hull, error));
    assert_int_equal(set.solids[hull].count, 6);
    RtBox own = {lo, hi};
    assert_memory_equal(&set.solids[hull].box, &own, sizeof own);
    for (int i = 0; i < 1000; i++) {
        RtRay ray = ray_along(rt_random_point(&random, 2), rt_vec3(0, 0, 0));
        ray.dir = rt_sub(corners[i % 10], ray.org);
        List a = cross(&set, box, &ray), b = cross(&set, hull, &ray);
        assert_same_places(&a, &b, &ray);
    }
}

/* Its corners are rounded by 2^-15 of its size, so that no four of a face lie in a plane. */
RT_TEST(the_hull_of_a_turned_cube_has_six_faces_far_off_along_any_axis) {
    for (int axis = 0; axis < 3; axis++) {
        OWNED_SOLIDS set = {0};
        RtTransform place = rt_transform_identity();
        RtVec3 corners[8], far = rt_vec3(0, 0, 0);
        uint32_t hull;
        far.at[axis] = 1000;
        assert_ok(rt_transform_rotate(&place, rt_vec3(1, 2, 3), 40, error));
        assert_ok(rt_transform_translate(&place, far, error));
        for (uint32_t i = 0; i < 8; i++)
            corners[i] = rt_transform_point(&place, rt_vec3(i & 1 ? 1 : -1, i & 2 ? 1 : -1, i & 4 ? 1 : -1));
        assert_ok(rt_solid_add_hull(&set, corners, 8, &hull, error));
        assert_int_equal(set.solids[hull].count, 6);
    }
}

/* The planes of three points with all others on one side: the definition, not the search. */
static bool is_inside_hull(const RtVec3 *points, uint32_t count, Point p, long double close) {
    long double most = -1;
    for (uint32_t i = 0; i < count * count * count; i++) {
        const RtVec3 *v[3] = {&points[i % count], &points[i / count % count], &points[i / count / count]};
        long double ab[3], ac[3], n[3], below = 0, above = 0, at = 0, length = 0;
        for (int a = 0; a < 3; a++) {
            ab[a] = (long double)v[1]->at[a] - (long double)v[0]->at[a];
            ac[a] = (long double)v[2]->at[a] - (long double)v[0]->at[a];
        }
        for (int a = 0; a < 3; a++) {
            int b = (a + 1) % 3, c = (a + 2) % 3;
            n[a] = ab[b] * ac[c] - ab[c] * ac[b];
            length += n[a] * n[a];
        }
        if (length < 1e-12L) continue;
        length = sqrtl(length);
        for (uint32_t k = 0; k < count; k++) {
            long double height = 0;
            for (int a = 0; a < 3; a++)
                height += n[a] * ((long double)points[k].at[a] - (long double)v[0]->at[a]) / length;
            below = height < below ? height : below, above = height > above ? height : above;
        }
        if (above > close) continue;
        const long double q[3] = {p.x, p.y, p.z};
        for (int a = 0; a < 3; a++) at += n[a] * (q[a] - (long double)v[0]->at[a]) / length;
        most = most_of(most, at);
    }
    return most < 0;
}

RT_TEST(hulls_of_random_points_hold_what_is_between_them) {
    RtRandom random = rt_random(5, 0);
    for (int round = 0; round < 30; round++) {
        OWNED_SOLIDS set = {0};
        RtVec3 points[12];
        uint32_t count = 4 + (uint32_t)round % 9, hull;
        for (uint32_t i = 0; i < count; i++) points[i] = rt_random_point(&random, 10);
        assert_ok(rt_solid_add_hull(&set, points, count, &hull, error));
        RtBox box = RT_EMPTY_BOX;
        for (uint32_t i = 0; i < count; i++) box = rt_box_add_point(box, points[i]);
        assert_true(rt_box_contains(set.solids[hull].box, box));
        assert_true(rt_box_contains(rt_box_widened(box, 1e-5), set.solids[hull].box));
        for (int i = 0; i < 40; i++) {
            RtVec3 dir = rt_narrow(rt_random_direction(&random));
            RtRay ray = ray_along(rt_random_point(&random, 10), dir);
            List list = cross(&set, hull, &ray);
            bool inside = list.count == 2 && list.at[0].t < 0 && list.at[1].t > 0;
            Point p = {(long double)ray.org.x, (long double)ray.org.y, (long double)ray.org.z};
            assert_true(inside == is_inside_hull(points, count, p, 1e-5L));
        }
    }
}

RT_TESTS(solid_faces, NULL, NULL)
