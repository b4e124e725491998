/* SPDX-License-Identifier: Apache-2.0 */
/* Trees in exact arithmetic: tori, their tangents and ties; meshes, lines through vertices and edges and in
 * faces, and that all lines through a point agree whether it is inside; and every ray at the trees of the
 * families is decided as by our hit functions, except within rounding of a decision boundary. */
#include "csg_testing.h"
#include "equivalence_testing.h"
#include "solids_testing.h"

#include "exact/border.h"
#include "exact/referee.h"

/* ---- rings ---- */

/* Circles of radius 4 in planes across z, tubes of radius 1: both are exact. */
static RtCsgTerm ring_at(RtCsgBuilder *b, float x) {
    uint32_t solid;
    assert_ok(rt_solid_add_ring(&b->set, rt_vec3(x, 0, 0), rt_vec3(0, 0, 1), 4, 1, &solid, error));
    return term_of(b, solid);
}

/* 0: a ring; 1: the ring to its right that touches it from within; 2: the ring without the ball that fills
 * it at x = 4; 3: a ball in the ring; 4: the first ring without itself. */
static void make_rings(RtGeometry *g, RtCsgBuilder *b) {
    RtCsgTerm ring = ring_at(b, 0), other = ring_at(b, 8), filling = ball(b, rt_vec3(4, 0, 0), 1, 0);
    add_tree(g, b, ring);
    add_tree(g, b, other);
    add_tree(g, b, cut(b, ring, filling));
    add_tree(g, b, filling);
    add_tree(g, b, cut(b, ring, ring));
    assert_ok(rt_geometry_finish(g, error));
}

/* All places of `id` along the line, which are numbers of float32, to t[0..most). */
static int places(const RtGeometry *g, uint32_t id, RtRay ray, long double *t, int most) {
    int count = 0;
    RtWideRay line = rt_wide_ray(&ray);
    while (count < most && rt_referee_hit(g, id, &line, &t[count]) == RT_HIT) {
        /* the referee's error; on x86 rounding to 64 bits hides it */
        const float at = (float)t[count];
        assert_true(fabsl(t[count] - (long double)at) <= 0x1p-60L * fabsl(t[count]));
        t[count++] = (long double)at;
        line.tmin = (double)nextafterf(at, INFINITY);
    }
    return count;
}

static void assert_places(const RtGeometry *g, uint32_t id, RtRay ray, int count,
                          const long double *expected) {
    long double t[8];
    assert_int_equal(places(g, id, ray, t, 8), count);
    for (int i = 0; i < count; i++) assert_true(t[i] == expected[i]);
}

RT_TEST(a_ring_is_met_at_four_places_and_touched_at_none) {
    OWNED_GEOMETRY g = {0};
    OWNED_BUILDER b = {0};
    make_rings(&g, &b);
    RtVec3 x = rt_vec3(1, 0, 0), y = rt_vec3(0, 1, 0);
    assert_places(&g, 0, ray_along(rt_vec3(-9, 0, 0), x), 4, (long double[]){4, 6, 12, 14});
    assert_places(&g, 0, ray_along(rt_vec3(0, 0, 9), rt_vec3(0, 0, -1)), 0, NULL);
    /* along the circle on which it lies on a plane, through two of its points; from outside; at the outer
     * equator; and an ulp farther in */
    assert_places(&g, 0, ray_along(rt_vec3(-9, 0, 1), x), 0, NULL);
    assert_places(&g, 0, ray_along(rt_vec3(4, -9, 1), y), 0, NULL);
    assert_places(&g, 0, ray_along(rt_vec3(5, -9, 0), y), 0, NULL);
    RtWideRay near = {rt_vec3d(5 - 0x1p-50, -9, 0), rt_widen(y), 0, HUGE_VAL};
    long double t;
    assert_int_equal(rt_referee_hit(&g, 0, &near, &t), RT_HIT);
    assert_true(t < 9 && t > 8.9999L);
    /* 3-4-5: touches the hole from within the tube, where there is no wall; an ulp farther in are two */
    assert_places(&g, 0, ray_along(rt_vec3(3, -9, 0), y), 2, (long double[]){5, 13});
    near = (RtWideRay){rt_vec3d(3 - 0x1p-50, -9, 0), rt_widen(y), 6, HUGE_VAL};
    assert_int_equal(rt_referee_hit(&g, 0, &near, &t), RT_HIT);
    assert_true(t < 9 && t > 8.9999L);
}

/* At height 1/2 the tubes are met at 4 -+ sqrt(3/4), which is no number of theirs: those of two rings, by
 * different polynomials, and the ball's, a surd. */
RT_TEST(equal_places_of_rings_and_balls_are_a_tie) {
    OWNED_GEOMETRY g = {0};
    OWNED_BUILDER b = {0};
    make_rings(&g, &b);
    RtRay ray = ray_along(rt_vec3(0, 0, 0.5f), rt_vec3(1, 0, 0));
    for (uint32_t other = 1; other <= 3; other += 2) {
        int order = 99;
        long double apart;
        assert_int_equal(rt_referee_order(&g, 0, other, &ray, &order, &apart), RT_HIT);
        assert_true(order == 0 && apart == 0);
    }
    RtExactAnswer ruling = rt_referee_nearest(&g, &ray);
    assert_true(ruling.object == 0 && ruling.tied == 3);
    assert_true(fabsl(ruling.t - (4 - sqrtl(0.75L))) <= 0x1p-60L);
    RtWideRay line = rt_wide_ray(&ray);
    long double t;
    for (uint32_t empty = 2; empty <= 4; empty += 2)
        assert_int_equal(rt_referee_hit(&g, empty, &line, &t), RT_MISSED);
    ray.org.z = 0.25f;
    ray.org.y = 0x1p-40f; /* beside the plane through both centres: a little of the ring is left */
    line = rt_wide_ray(&ray);
    assert_int_equal(rt_referee_hit(&g, 2, &line, &t), RT_HIT);
    long double off, ulps = 0, full;
    assert_int_equal(rt_referee_hit(&g, 0, &line, &full), RT_HIT);
    assert_int_equal(error_of_t(&g, 0, &ray, (float)full, &off, &ulps), RT_HIT);
    assert_true(fabsl(ulps) <= 0.5L && ulps != 0);
}

/* ---- by membership of points ---- */

/* Tori placed and stretched at random: before its first place the line is outside, behind it inside, by a
 * function of points that knows no polynomial. */
RT_TEST(a_line_is_outside_of_a_torus_up_to_the_first_place_and_inside_behind_it) {
    RtRandom random = rt_random(41, 0);
    int hits = 0;
    for (int i = 0; i < 400; i++) {
        RtTransform place = rt_transform_identity();
        RtVec3 size = rt_random_point(&random, 1);
        for (int a = 0; a < 3; a++) size.at[a] = 0.5f + fabsf(size.at[a]);
        assert_ok(rt_transform_scale(&place, size, error));
        assert_ok(rt_transform_rotate(&place, rt_random_point(&random, 1), 77, error));
        assert_ok(rt_transform_translate(&place, rt_random_point(&random, 5), error));
        Model model = {.name = "torus", .inside = in_torus, .place = place};
        model.ratio = rt_random_betweend(&random, 0.01, 0.99);
        invert(&place, model.back);
        OWNED_GEOMETRY g = {0};
        OWNED_BUILDER b = {0};
        assert_ok(rt_solid_add_torus(&b.set, model.ratio, &place, &model.index, error));
        add_tree(&g, &b, term_of(&b, model.index));
        assert_ok(rt_geometry_finish(&g, error));
        RtVec3d target = random_target(&model, &random);
        RtRay ray = random_ray(&model, &random, target, 9);
        RtWideRay line = rt_wide_ray(&ray);
        long double t = HUGE_VALL, sooner = HUGE_VALL;
        bool hit = rt_referee_hit(&g, 0, &line, &t) == RT_HIT;
        hits += hit;
        for (int k = 0; k < 200; k++) {
            long double at = (hit ? t : 20 / (long double)rt_lengthd(line.dir)) * (1 - 0x1p-40L) * k / 199;
            sooner = fminl(sooner, value_at(&model, &ray, at));
        }
        if (sooner < -0x1p-36L) fail_msg("torus %d: %Lg inside before %Lg", i, -sooner, t);
        if (hit && fabsl(value_at(&model, &ray, t)) > 0x1p-50L) fail_msg("torus %d: not met at %Lg", i, t);
    }
    assert_true(hits > 100);
}

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
    uint32_t solid;
    assert_ok(rt_solid_add_mesh(&b->set, triangles, count, NULL, &solid, error));
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
    RT_ARENA(memory);
    double *at;
    uint32_t count;
    RtWideRay wide = rt_wide_ray(ray);
    assert_ok(rt_exact_csg_boundaries(forest, tree, &wide, 0, &memory, &at, &count, error));
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

/* ---- all trees ---- */

static bool is_of_trees(size_t family) {
    return strncmp(rt_family_name(family), "csg", 3) == 0;
}

/* Whether dir is so long that t, wherever the ray is at the scene, lies below the least normal number of
 * float32: then it has few digits or none. */
static bool has_few_digits(const RtGeometry *g, const RtWideRay *line) {
    return farthest_plane(g->box, line) < FLT_MIN * rt_lengthd(line->dir);
}

/* Asks about the object that is exactly the nearest, and about all that our hit function finds. Where
 * [tmin, tmax] is one number the exact t, which has more digits, is not in it; nor may it be where float32
 * has few. */
static void judge(const RtGeometry *g, const RtRay *ray, int *hits) {
    RtExactAnswer ruling = rt_referee_nearest(g, ray);
    assert_int_not_equal(ruling.result, RT_UNDECIDED);
    *hits += ruling.result == RT_HIT;
    RtWideRay line = rt_wide_ray(ray);
    if (ray->tmin == ray->tmax || has_few_digits(g, &line)) return;
    for (uint32_t id = 0; id < g->object_count; id++) {
        Decision ours = decision_of(g, id, ray, hit_memory_of_tests());
        if (!ours.hit && id != ruling.object) continue;
        if (check_decision(g, id, &line, ours) == RT_HIT) continue;
        double border = border_distance(g, id, ray, ours);
        if (border > 2) fail_msg("object %u, %g units from a border", id, border);
    }
}

RT_TEST(no_ray_at_the_families_of_trees_is_undecided_and_differences_are_at_borders) {
    enum { EACH = 16 };
    int hits = 0, rays = 0;
    for (size_t family = 0; family < rt_family_count(); family++) {
        for (uint64_t seed = 1; seed <= 3 && is_of_trees(family); seed++) {
            OWNED_SCENE scene = open_family(family, seed);
            OWNED_ACCEL RtAccel *brute = open_accel(&scene, "brute");
            OWNED_QUERY query = open_query(brute);
            for (size_t aim = 0; aim < rt_ray_family_count(); aim++, rays += EACH) {
                RtRay some[EACH];
                rt_ray_family_fill(aim, &query, seed, 0, EACH, some);
                for (int i = 0; i < EACH; i++) judge(&scene.geometry, &some[i], &hits);
            }
        }
    }
    assert_true(hits > rays / 6); /* rays of past-hits are meant to miss */
}

RT_TEST(a_tree_is_undecided_where_memory_is_short_and_only_there) {
    RtGeometry g[2] = {{0}, {0}};
    OWNED_BUILDER b = {0};
    RtTriangle triangles[12];
    uint32_t mesh;
    make_rings(&g[0], &b);
    assert_ok(rt_solid_add_mesh(&b.set, triangles, cube_mesh(triangles), NULL, &mesh, error));
    add_tree(&g[1], &b, term_of(&b, mesh));
    assert_ok(rt_geometry_finish(&g[1], error));
    RtRay ray = ray_along(rt_vec3(0, 0, 0.5f), rt_vec3(1, 0, 0));
    int64_t before = rt_alloc_live();
    for (int i = 0; i < 2; i++) {
        RtExactResult finding = RT_UNDECIDED;
        int short_of = 0;
        for (uint64_t n = 1; finding == RT_UNDECIDED; n++, short_of++) {
            rt_alloc_fail_at(n);
            finding = rt_referee_nearest(&g[i], &ray).result;
            rt_alloc_fail_at(0);
            assert_int_equal(rt_alloc_live(), before);
        }
        assert_true(short_of > 1 && finding == RT_HIT);
    }
    for (int i = 0; i < 2; i++) rt_geometry_clear(&g[i]);
}

RT_TESTS(exact_trees, NULL, NULL)
