/* SPDX-License-Identifier: Apache-2.0 */
/* scenes/: what the built-in scenes contain, and their parts. test_builtin.c has specs and memory. */
#include "accel_testing.h"

#include "scenes/builtin.h"

/* ---- counts ---- */

/* Of the databases, as published. */
RT_TEST(built_in_scenes_have_the_objects_that_they_say) {
    static const ShapeCounts rows[] = {
        {"balls", 7381, 1, 0, 0},
        {"balls:size=1", 10, 1, 0, 0},
        {"balls:size=2", 91, 1, 0, 0},
        {"balls:size=5", 66430, 1, 0, 0},
        {"lattice", 2197, 0, 0, 6084},
        {"lattice:size=1", 8, 0, 0, 12},
        {"lattice:size=20", 9261, 0, 0, 26460},
        {"gears", 0, 9345, 0, 0},
        {"gears:size=1", 0, 147, 0, 0},
        {"jacks", 438, 0, 0, 219},
        {"jacks:size=2", 54, 0, 0, 27},
        {"jacks:size=1", 6, 0, 0, 3},
        {"rings", 4200, 1, 0, 4200},
        {"rings:size=1", 30, 1, 0, 30},
        {"shells", 5761, 0, 0, 0},
        {"shells:size=1", 361, 0, 0, 0},
        {"mount", 4, 0, 8192, 0},
        {"mount:size=1", 4, 0, 8, 0},
        {"mount:size=9", 4, 0, 524288, 0},
        {"tetra", 0, 0, 4096, 0},
        {"tetra:size=2", 0, 0, 16, 0},
        {"tetra:size=1", 0, 0, 4, 0},
        {"tetra:size=9", 0, 0, 262144, 0},
        {"tree", 4095, 1, 0, 4095},
        {"tree:size=3", 15, 1, 0, 15},
        {"tree:size=1", 3, 1, 0, 3},
        {"tree:size=14", 32767, 1, 0, 32767},
        {"random:n=7", 7, 0, 0, 0},
        {"random:n=1", 1, 0, 0, 0},
        {"random:n=8,shape=triangle", 0, 0, 8, 0},
        {"random:n=500,shape=mixed,seed=7", 125, 125, 125, 125},
        {"random:n=0", 0, 0, 0, 0},
        {"teapot", 0, 144, 9120, 0},
        {"teapot:size=6", 0, 36, 2256, 0},
        {"teapot:size=1", 0, 1, 56, 0},
        {"stadium", 48, 6621, 9120, 13},
        {"stadium:size=1,ratio=50", 48, 6621, 56, 13},
        {"hall", 0, 0, 283194, 0},
        {"hall:size=1", 0, 0, 69302, 0},
        {"city", 3726, 37812, 0, 8350},
        {"city:size=1", 39, 686, 0, 112},
    };
    assert_shape_counts(rows, sizeof rows / sizeof rows[0]);
}

/* ---- surfaces ---- */

/* From one point to another, as bits: equal points have equal bits here, -0 made 0. */
typedef struct Edge {
    RtVec3 from, to;
} Edge;

static int compare_edges(const void *a, const void *b) {
    return memcmp(a, b, sizeof(Edge));
}

static RtVec3 without_negative_zero(RtVec3 p) {
    return rt_vec3(p.x + 0.0f, p.y + 0.0f, p.z + 0.0f);
}

static RtVec3d area_of(const RtVec3 v[3]) {
    return rt_area_vector(rt_widen(v[0]), rt_widen(v[1]), rt_widen(v[2]));
}

/* How many edges of triangles first..end-1 no other triangle has the other way round. */
static uint32_t open_edges(const RtGeometry *g, uint32_t first, uint32_t end) {
    uint32_t count = 3 * (end - first), open = 0;
    Edge *edges = malloc(count * sizeof *edges);
    assert_non_null(edges);
    for (uint32_t i = 0; i < count; i++) {
        const RtTriangle *t = &g->triangles[first + i / 3];
        edges[i] = (Edge){without_negative_zero(t->v[i % 3]), without_negative_zero(t->v[(i + 1) % 3])};
    }
    qsort(edges, count, sizeof *edges, compare_edges);
    for (uint32_t i = 0; i < count; i++) {
        const Edge reverse = {edges[i].to, edges[i].from};
        open += bsearch(&reverse, edges, count, sizeof *edges, compare_edges) == NULL;
    }
    free(edges);
    return open;
}

static void normals_point_where_the_triangles_do(const RtGeometry *g) {
    for (uint32_t i = 0; i < g->triangle_count; i++) {
        if (g->triangle_normals[i] == RT_NO_NORMALS) continue;
        const RtVec3 *v = g->triangles[i].v, *n = g->vertex_normals[g->triangle_normals[i]].n;
        RtVec3d normal = area_of(v);
        assert_true(rt_lengthd(normal) > 0);
        for (int k = 0; k < 3; k++) assert_true(rt_dotd(normal, rt_widen(n[k])) > 0);
    }
}

/* Lid and body end in a circle of 4 n edges, the handle at both ends in 2 n, and so does the spout. */
RT_TEST(a_teapot_is_open_at_its_rims_alone) {
    for (uint32_t n = 2; n <= 12; n += 5) {
        char spec[32];
        snprintf(spec, sizeof spec, "teapot:size=%u", n);
        OWNED_SCENE scene = open_scene(spec);
        assert_int_equal(open_edges(&scene.geometry, 0, scene.geometry.triangle_count), 16 * n);
    }
}

RT_TEST(a_teapot_stands_on_its_board_and_its_normals_point_out) {
    OWNED_SCENE scene = open_scene("teapot");
    RtBox box = scene.geometry.box;
    assert_true(box.lo.x == -4 && box.lo.y == -4 && box.lo.z == 0);
    assert_true(box.hi.x == 4 && box.hi.y == 4 && box.hi.z == 3.15f);
    normals_point_where_the_triangles_do(&scene.geometry);
}

RT_TEST(a_stadium_is_ratio_times_as_long_as_its_teapot) {
    const double ratios[] = {50, 1000, 1e6};
    for (size_t i = 0; i < sizeof ratios / sizeof ratios[0]; i++) {
        char spec[64];
        snprintf(spec, sizeof spec, "stadium:size=4,ratio=%g", ratios[i]);
        OWNED_SCENE scene = open_scene(spec);
        const RtGeometry *g = &scene.geometry;
        RtBox teapot = RT_EMPTY_BOX, tiers = RT_EMPTY_BOX;
        for (uint32_t k = 0; k < g->triangle_count; k++)
            teapot = rt_box_union(teapot, g->boxes[g->triangle_ids[k]]);
        for (uint32_t k = 1; k < g->polygon_count; k++) { /* polygon 0 is the ground */
            tiers = rt_box_union(tiers, g->boxes[g->polygon_ids[k]]);
        }
        RtVec3 small = rt_box_size(teapot), large = rt_box_size(tiers);
        double ratio = (double)large.x / (double)rt_maxf(small.x, small.y);
        assert_true(ratio > 0.9 * ratios[i] && ratio < 1.0 * ratios[i]);
    }
}

/* The corners of a square of `side` pixels: (side + 1)^2 primary rays. */
static uint64_t count_misses(RtScene *scene, uint32_t side) {
    RtView view;
    assert_ok(rt_scene_sample(scene, side, side, 1, true, error));
    assert_ok(rt_view_init(&view, &scene->camera, scene->sampling, error));
    OWNED_ACCEL RtAccel *accel = open_accel(scene, "bvh");
    OWNED_QUERY query = open_query(accel);
    uint64_t misses = 0;
    for (uint32_t row = 0; row <= side; row++) {
        for (uint32_t column = 0; column <= side; column++) {
            RtRay ray = rt_view_ray(&view, column, row);
            RtHit hit;
            rt_nearest(&query, &ray, 1, &hit, NULL);
            misses += hit.object == RT_NO_OBJECT;
        }
    }
    return misses;
}

/* The room itself is the first of its triangles: 39 columns, 2 * 12 - 2 a column. */
RT_TEST(a_hall_is_closed_so_that_every_primary_ray_hits) {
    OWNED_SCENE scene = open_scene("hall");
    assert_int_equal(open_edges(&scene.geometry, 0, 39 * 22), 0);
    assert_int_equal(count_misses(&scene, 512), 0);
    RtVec3 eye = scene.camera.from;
    for (int a = 0; a < 3; a++)
        assert_true(eye.at[a] > scene.geometry.box.lo.at[a] && eye.at[a] < scene.geometry.box.hi.at[a]);
    assert_int_equal(scene.light_count, 4);
    rt_scene_clear(&scene);
    scene = open_scene("hall:size=1");
    assert_int_equal(count_misses(&scene, 512), 0);
}

/* Recorded with gcc 12 and clang 14 on x86-64. Objects, materials, lights and camera of the databases, from
 * balls to tree, were compared with the files that their package writes: equal to the 6 digits printed there,
 * give or take the rounding to float32. For gears and rings, of which no file was at hand, a second program
 * that makes them stood in, with the sines and cosines of the C library. */
RT_TEST(built_in_scenes_are_the_same_bit_for_bit_everywhere) {
    const struct {
        const char *spec;
        uint64_t fingerprint;
    } cases[] = {
        {"balls", UINT64_C(0x1db06add3464340d)},        {"gears", UINT64_C(0xf44626c4e6ca9d9a)},
        {"jacks", UINT64_C(0x30e83370c80a1ed7)},        {"lattice", UINT64_C(0x07c34e8eb81fcf16)},
        {"mount", UINT64_C(0xc3516ce7bc37f16c)},        {"rings", UINT64_C(0x10d6daac1483b6f8)},
        {"shells", UINT64_C(0xbafd1453e69cba5c)},       {"tetra", UINT64_C(0x61342d04c926aed6)},
        {"tree", UINT64_C(0x3fb1416a97e4e361)},         {"random", UINT64_C(0x2dda89d366b3124c)},
        {"csg-field", UINT64_C(0x3d43b9145c7bcf29)},    {"teapot", UINT64_C(0xc1b558451260f684)},
        {"stadium", UINT64_C(0x7dc374975cc60f30)},      {"hall", UINT64_C(0x56abc2c79b8cbfee)},
        {"forest:n=100", UINT64_C(0xa05cd20f7f937b8b)}, {"city", UINT64_C(0xf33a5ba9ddfe6869)},
    };
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        OWNED_SCENE scene = open_scene(cases[i].spec);
        if (rt_scene_fingerprint(&scene) != cases[i].fingerprint) fail_msg("%s changed", cases[i].spec);
    }
}

static void assert_same(const char *one, const char *other, bool same) {
    OWNED_SCENE a = open_scene(one), b = open_scene(other);
    assert_true((rt_scene_fingerprint(&a) == rt_scene_fingerprint(&b)) == same);
}

RT_TEST(random_scenes_depend_on_the_seed_alone) {
    assert_same("random:n=500,shape=mixed,seed=7", "random:n=500,shape=mixed,seed=7", true);
    assert_same("random:n=500,shape=mixed,seed=7", "random:n=500,shape=mixed,seed=8", false);
    assert_same("forest:n=20,seed=7", "forest:n=20,seed=7", true);
    assert_same("forest:n=20,seed=7", "forest:n=20,seed=8", false);
    assert_same("city:size=2,seed=7", "city:size=2,seed=7", true);
    assert_same("city:size=2,seed=7", "city:size=2,seed=8", false);
    assert_same("city:size=2,instances=on,seed=7", "city:size=2,instances=on,seed=8", false);
    assert_same("forest:n=2,instances=on,parts=2", "forest:n=2,instances=on,parts=3", false);
    assert_same("forest:n=2", "forest:n=2,parts=3", true);
}

/* Trees of two kinds: 1036 triangles, or 986. */
RT_TEST(a_forest_grows_from_a_thousand_triangles_to_any_number) {
    for (uint32_t n = 1; n <= 1000; n *= 10) {
        char spec[32];
        snprintf(spec, sizeof spec, "forest:n=%u", n);
        OWNED_SCENE scene = open_scene(spec);
        uint32_t edge = (uint32_t)ceil(sqrt(n)) + 6, ground = 2 * (2 * edge) * (2 * edge);
        uint32_t trees = scene.geometry.triangle_count - ground;
        assert_true(trees >= 986 * n && trees <= 1036 * n && (trees - 986 * n) % 50 == 0);
        for (uint32_t i = 0; i < scene.geometry.triangle_count; i++) {
            assert_true(rt_lengthd(area_of(scene.geometry.triangles[i].v)) > 0);
        }
    }
}

static int compare_floats(const void *a, const void *b) {
    float x = *(const float *)a, y = *(const float *)b;
    return (x > y) - (x < y);
}

/* The number of polygons that are flat along `axis`, and how many have `others` in their plane. */
static void count_in_planes(const RtGeometry *g, int axis, uint32_t others, uint32_t *flat, uint32_t *share) {
    float *planes = malloc(g->polygon_count * sizeof *planes);
    assert_non_null(planes);
    uint32_t count = 0;
    for (uint32_t i = 0; i < g->polygon_count; i++) {
        const RtBox *box = &g->boxes[g->polygon_ids[i]];
        if (box->lo.at[axis] == box->hi.at[axis]) planes[count++] = box->lo.at[axis];
    }
    qsort(planes, count, sizeof *planes, compare_floats);
    for (uint32_t i = 0, end; i < count; i = end) {
        for (end = i; end < count && planes[end] == planes[i];) end++;
        if (end - i > others) *share += end - i;
    }
    *flat += count;
    free(planes);
}

RT_TEST(three_of_four_faces_of_a_city_share_their_plane_with_more_than_ten_others) {
    OWNED_SCENE scene = open_scene("city");
    uint32_t flat = 0, share = 0;
    for (int axis = 0; axis < 3; axis++) count_in_planes(&scene.geometry, axis, 10, &flat, &share);
    assert_true(flat > scene.geometry.polygon_count * 9 / 10);
    assert_true(share > flat * 3 / 4);
}

/* ---- forms ---- */

RT_TEST(points_on_the_circle_are_exact_where_they_can_be) {
    for (uint32_t n = 1; n <= 512; n++) {
        for (uint32_t i = 0; i <= n; i++) {
            RtVec3d p = rt_on_circle(i, n);
            double angle = 6.283185307179586477 * i / n;
            assert_true(fabs(p.x - cos(angle)) < 2e-15 && fabs(p.y - sin(angle)) < 2e-15);
        }
    }
    for (uint32_t i = 0; i < 4; i++) {
        RtVec3d p = rt_on_circle(i, 4);
        assert_true(fabs(p.x) + fabs(p.y) == 1 && p.x == (i == 0) - (i == 2) && p.y == (i == 1) - (i == 3));
    }
}

RT_TEST(a_box_faces_outwards) {
    OWNED_SCENE scene = begin_scene();
    RtSceneBuilder b = {.scene = &scene};
    for (int quarters = 0; quarters < 4; quarters++) {
        rt_build_origin(&b, rt_vec3d(10 * quarters, 0, 0), quarters);
        rt_build_box(&b, rt_vec3d(-1, -1, -1), rt_vec3d(1, 1, 1), RT_SIDES_ALL);
    }
    assert_int_equal(scene.geometry.triangle_count, 48);
    for (uint32_t i = 0; i < 48; i++) {
        const RtVec3 *v = scene.geometry.triangles[i].v;
        RtVec3d normal = area_of(v), center = rt_vec3d(10 * (i / 12), 0, 0);
        assert_true(rt_lengthd(normal) == 4 && rt_dotd(normal, rt_subd(rt_widen(v[0]), center)) == 4);
    }
    assert_int_equal(open_edges(&scene.geometry, 0, 12), 0);
    rt_free(b.points);
}

RT_TEST(a_lathe_with_ends_on_the_axis_is_closed_and_faces_outwards) {
    static const RtVec3d profile[] = {{0, 0, 0}, {2, 0, 0.4}, {1, 0, 2}, {0, 0, 3}};
    OWNED_SCENE scene = begin_scene();
    RtSceneBuilder b = {.scene = &scene};
    const RtLathe lathe = {.center = {5, 6, 7}, .profile = profile, .count = 4, .steps = 9, .sides = 7};
    rt_build_lathe(&b, &lathe);
    assert_int_equal(b.status, RT_OK);
    assert_int_equal(scene.geometry.triangle_count, 7 * (2 * 9 - 2));
    assert_int_equal(b.count, scene.geometry.triangle_count);
    assert_int_equal(open_edges(&scene.geometry, 0, scene.geometry.triangle_count), 0);
    normals_point_where_the_triangles_do(&scene.geometry);
    assert_ok(rt_scene_finish(&scene, error));
    assert_true(scene.geometry.box.lo.z == 7 && scene.geometry.box.hi.z == 10);
    rt_free(b.points);
}

RT_TESTS(places, NULL, NULL)
