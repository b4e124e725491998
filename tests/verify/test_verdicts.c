/* SPDX-License-Identifier: Apache-2.0 */
/* Verdicts from both sides: careful arithmetic is never wrong, and what passes a border by four times delta
 * is always wrong. Scenes are large, small, flat, and far from the origin of coordinates. */
#include "csg_testing.h"
#include "equivalence_testing.h"

#include "random_testing.h"
#include "verify/verdict_testing.h"

#include "accel/kernel.h"

#include <inttypes.h>

/* ---- scenes ---- */

typedef struct Place {
    const char *name;
    float scale, offset, flat; /* z is multiplied by `flat` */
} Place;

static const Place places[] = {{"ordinary", 1, 0, 1}, {"offset 1e3", 1, 1e3f, 1}, {"offset 1e6", 16, 1e6f, 1},
                               {"flat", 1, 0, 1e-4f}, {"tiny", 1e-6f, 0, 1},      {"huge", 1e6f, 0, 1}};
enum { PLACES = sizeof places / sizeof places[0] };

static RtVec3 place(const Place *p, RtVec3 v) {
    return rt_vec3(v.x * p->scale + p->offset, v.y * p->scale + p->offset,
                   v.z * p->scale * p->flat + p->offset);
}

static void add_triangles(RtGeometry *g, const Place *p, RtRandom *random, int count, float size) {
    for (int i = 0; i < count; i++) {
        RtVec3 center = rt_random_point(random, 1), v[3];
        for (int k = 0; k < 3; k++) v[k] = place(p, rt_add(center, rt_random_point(random, size)));
        assert_ok(rt_geometry_add_triangle(g, v, NULL, error));
    }
}

static RtRay ray_to(RtVec3 org, RtVec3d to) {
    RtVec3d dir = rt_subd(to, rt_widen(org));
    return (RtRay){.org = org, .dir = rt_narrow(dir), .tmax = INFINITY, .kind = RT_RAY_RANDOM};
}

static bool is_ray(const RtRay *ray) {
    return ray->dir.x != 0 || ray->dir.y != 0 || ray->dir.z != 0;
}

/* ---- careful float32 triangle tests ---- */

static float sum_of_products(bool fused, float x, float y, float z, float w) {
    return fused ? fmaf(x, y, z * w) : x * y + z * w;
}

static float dot(bool fused, RtVec3 x, RtVec3 y) {
    float two = sum_of_products(fused, x.x, y.x, x.y, y.y);
    return fused ? fmaf(x.z, y.z, two) : two + x.z * y.z;
}

static RtVec3 cross(bool fused, RtVec3 x, RtVec3 y) {
    return rt_vec3(sum_of_products(fused, x.y, y.z, -x.z, y.y), sum_of_products(fused, x.z, y.x, -x.x, y.z),
                   sum_of_products(fused, x.x, y.y, -x.y, y.x));
}

/* Is the plane seen so nearly edge on that float32 cannot tell where it is met? A careful test then rejects.
 */
static bool is_edge_on(const RtVec3 from[3], RtVec3 dir, float determinant) {
    float far = 0, side = 0;
    for (int i = 0; i < 3; i++) {
        RtVec3 edge = rt_sub(from[(i + 1) % 3], from[i]);
        far = fmaxf(far, sqrtf(rt_dot(from[i], from[i])));
        side = fmaxf(side, sqrtf(rt_dot(edge, edge)));
    }
    return !(fabsf(determinant) > 0x1p-19f * far * side * sqrtf(rt_dot(dir, dir)));
}

typedef bool TriangleTest(bool fused, const RtVec3 from[3], RtVec3 dir, float *t);

/* Möller & Trumbore 1997. */
static bool moeller_trumbore(bool fused, const RtVec3 from[3], RtVec3 dir, float *t) {
    RtVec3 one = rt_sub(from[1], from[0]), two = rt_sub(from[2], from[0]), org = rt_scale(from[0], -1);
    RtVec3 p = cross(fused, dir, two), q = cross(fused, org, one);
    float determinant = dot(fused, one, p);
    if (is_edge_on(from, dir, determinant)) return false;
    float u = dot(fused, org, p) / determinant, v = dot(fused, dir, q) / determinant;
    *t = dot(fused, two, q) / determinant;
    return u >= 0 && v >= 0 && u + v <= 1;
}

/* Woop, Benthin & Wald 2013. */
static bool woop(bool fused, const RtVec3 from[3], RtVec3 dir, float *t) {
    int kz = rt_major_axis(dir), kx = (kz + 1) % 3, ky = (kz + 2) % 3;
    float sx = dir.at[kx] / dir.at[kz], sy = dir.at[ky] / dir.at[kz], sz = 1 / dir.at[kz], x[3], y[3],
          edge[3];
    for (int i = 0; i < 3; i++) {
        x[i] = sum_of_products(fused, -sx, from[i].at[kz], from[i].at[kx], 1);
        y[i] = sum_of_products(fused, -sy, from[i].at[kz], from[i].at[ky], 1);
    }
    for (int i = 0; i < 3; i++) {
        int b = (i + 1) % 3, c = (i + 2) % 3;
        edge[i] = sum_of_products(fused, x[c], y[b], -y[c], x[b]);
    }
    float least = fminf(edge[0], fminf(edge[1], edge[2])), most = fmaxf(edge[0], fmaxf(edge[1], edge[2]));
    float determinant = edge[0] + edge[1] + edge[2];
    if (least < 0 && most > 0) return false;
    if (is_edge_on(from, dir, determinant * dir.at[kz])) return false;
    float at = sum_of_products(fused, edge[0], from[0].at[kz], edge[1], from[1].at[kz]);
    *t = sum_of_products(fused, edge[2], from[2].at[kz], at, 1) * sz / determinant;
    return true;
}

/* Edge functions by Plücker coordinates, t from the plane. */
static bool pluecker(bool fused, const RtVec3 from[3], RtVec3 dir, float *t) {
    float edge[3];
    for (int i = 0; i < 3; i++) {
        RtVec3 x = from[i], y = from[(i + 1) % 3];
        edge[i] = dot(fused, cross(fused, rt_sub(y, x), rt_add(x, y)), dir);
    }
    float least = fminf(edge[0], fminf(edge[1], edge[2])), most = fmaxf(edge[0], fmaxf(edge[1], edge[2]));
    RtVec3 normal = cross(fused, rt_sub(from[1], from[0]), rt_sub(from[2], from[0]));
    float determinant = dot(fused, normal, dir);
    if ((least < 0 && most > 0) || is_edge_on(from, dir, determinant)) return false;
    *t = dot(fused, normal, from[0]) / determinant;
    return true;
}

/* The nearest hit, by all triangles. */
static RtHit answer_in_float(const RtGeometry *g, TriangleTest *test, bool fused, const RtRay *ray) {
    RtHit best = RT_MISS;
    for (uint32_t id = 0; id < g->object_count; id++) {
        const RtTriangle *triangle = &g->triangles[id];
        RtVec3 from[3];
        float t;
        for (int i = 0; i < 3; i++) from[i] = rt_sub(triangle->v[i], ray->org);
        if (test(fused, from, ray->dir, &t) && t >= ray->tmin && t <= ray->tmax && t < best.t)
            best = (RtHit){t, id};
    }
    return best;
}

/* Towards triangles, mostly near their edges, some from a surface. */
static RtRay hard_ray(const RtGeometry *g, const Place *p, RtRandom *random) {
    RtRay ray;
    do {
        const RtTriangle *to = &g->triangles[rt_random_below(random, g->triangle_count)];
        const RtTriangle *at = &g->triangles[rt_random_below(random, g->triangle_count)];
        double u = rt_random_betweend(random, 0, 1),
               v = rt_random_below(random, 3) == 0 ? rt_random_betweend(random, 0, 1 - u) : 0;
        RtVec3d a = rt_widen(to->v[0]), b = rt_widen(to->v[1]), c = rt_widen(to->v[2]);
        RtVec3d aim = rt_add_scaledd(rt_add_scaledd(a, rt_subd(b, a), u), rt_subd(c, a), v);
        RtVec3 org = rt_random_below(random, 4) == 0 ? at->v[0] : place(p, rt_random_point(random, 3));
        ray = ray_to(org, aim);
    } while (!is_ray(&ray));
    return ray;
}

RT_TEST(float32_triangle_tests_that_subtract_the_origin_first_have_nothing_wrong) {
    static TriangleTest *const tests[] = {moeller_trumbore, woop, pluecker};
    uint64_t wrong = 0, certain = 0, rays = 0;
    for (size_t k = 0; k < PLACES; k++) {
        RtRandom random = rt_random(11, k);
        OWNED_GEOMETRY g = {0};
        add_triangles(&g, &places[k], &random, 25, 0.3f);
        add_triangles(&g, &places[k], &random, 25, 1);
        assert_ok(rt_geometry_finish(&g, error));
        for (int i = 0; i < 6000; i++) {
            RtRay ray = hard_ray(&g, &places[k], &random);
            if (i % 10 == 0 && places[k].scale == 1)
                ray.dir = rt_scale(ray.dir, ldexpf(1, (int)rt_random_below(&random, 120) - 60));
            if (!is_ray(&ray)) continue;
            const bool fused = i % 2 == 1;
            bool is_certain, must_hit;
            assert_ok(rt_verdict_certain(rt_judge(&g, &ray, false), &is_certain, &must_hit, error));
            certain += is_certain;
            rays++;
            for (int f = 0; f < 3; f++) {
                RtHit answer = answer_in_float(&g, tests[f], fused, &ray);
                if (verdict_by_margins(&g, &ray, answer) != RT_WRONG) continue;
                RtFault fault;
                assert_ok(rt_verdict_fault(rt_judge(&g, &ray, false), answer, &fault, error));
                if (wrong++ < 5)
                    print_error("%s, test %d, ray %d: %s, object %u at %g\n", places[k].name, f, i,
                                rt_fault_name(fault), answer.object, (double)answer.t);
            }
        }
    }
    assert_int_equal(wrong, 0);
    assert_true(certain > rays / 10);
}

/* ---- exact answers to displaced rays ---- */

static void add_one_of_each_shape(RtGeometry *g, const Place *p, RtRandom *random) {
    add_triangles(g, p, random, 4, 1);
    RtVec3 polygon[5];
    for (int i = 0; i < 5; i++) {
        float angle = 1.2566f * (float)i;
        polygon[i] = place(p, rt_vec3(cosf(angle) - 2, sinf(angle), 0.25f));
    }
    assert_ok(rt_geometry_add_polygon(g, polygon, 5, error));
    assert_ok(rt_geometry_add_sphere(g, place(p, rt_random_point(random, 1)), p->scale * 0.75f, error));
    assert_ok(rt_geometry_add_cone(g, place(p, rt_vec3(1, 1, -1)), p->scale * 0.5f,
                                   place(p, rt_vec3(1, 2, 1)), p->scale * 0.125f, error));
    OWNED_BUILDER builder = {0};
    uint32_t solid;
    RtVec3 lo = place(p, rt_vec3(-1, -1, -1)), hi = place(p, rt_vec3(0.5f, 0.5f, 0.5f));
    RtVec3 radii = rt_vec3(p->scale, p->scale, p->scale * 0.5f);
    assert_ok(rt_solid_add_ellipsoid(&builder.set, hi, radii, &solid, error));
    add_tree(g, &builder, cut(&builder, box(&builder, lo, hi, 0), term_of(&builder, solid)));
    assert_ok(rt_geometry_finish(g, error));
}

/* The nearest object, each displaced by `part` of its delta in a direction of its own. */
static RtHit displaced_answer(const RtGeometry *g, const RtRay *ray, double part, RtRandom *random) {
    const RtMarginRay prepared = rt_margin_ray(g, ray, false);
    long double best = HUGE_VALL;
    RtHit answer = RT_MISS;
    for (uint32_t id = 0; id < g->object_count; id++) {
        RtWideRay line = rt_wide_ray(ray);
        long double t;
        RtVec3d by = rt_random_direction(random);
        if (rt_random_below(random, 3) == 0) by = prepared.line.dir; /* along the ray */
        line.org = rt_add_scaledd(line.org, by, part * rt_margin_delta(&prepared, g, id));
        if (rt_referee_hit(g, id, &line, &t) != RT_HIT || t >= best) continue;
        best = t;
        answer = (RtHit){(float)t, id};
    }
    return answer;
}

RT_TEST(exact_answers_to_objects_displaced_by_less_than_delta_are_not_wrong) {
    uint64_t wrong = 0, others = 0;
    for (size_t k = 0; k < PLACES; k++) {
        if (places[k].flat != 1) continue; /* its solids would be too flat */
        RtRandom random = rt_random(12, k);
        OWNED_GEOMETRY g = {0};
        add_one_of_each_shape(&g, &places[k], &random);
        for (int i = 0; i < 1500; i++) {
            uint32_t id;
            RtVec3d aim = rt_widen(place(&places[k], rt_random_point(&random, 1)));
            if (i % 3 > 0) aim = rt_widen(g.triangles[i % 4].v[i % 3]);
            RtRay ray = ray_to(place(&places[k], rt_random_point(&random, 4)), aim);
            RtExactAnswer exact = rt_referee_nearest(&g, &ray);
            RtHit expected = exact.result == RT_HIT ? (RtHit){(float)exact.t, exact.object} : RT_MISS;
            RtHit answer = displaced_answer(&g, &ray, 0.9, &random);
            id = answer.object;
            others += id != expected.object;
            if (verdict_of(&g, &ray, expected, answer) != RT_WRONG) continue;
            if (wrong++ < 5)
                print_error("%s, ray %d: object %u at %g, exactly %u at %Lg\n", places[k].name, i, id,
                            (double)answer.t, exact.object, exact.t);
        }
    }
    assert_int_equal(wrong, 0);
    assert_true(others > 100);
}

/* ---- answers across a border ---- */

typedef struct Border {
    RtRay inside, outside; /* pass the border at four times delta */
    RtHit hit;             /* of the outer one, as if the object reached so far */
} Border;

/* Past the middle of an edge of a triangle. */
static Border edge_border(const RtGeometry *g, const RtTriangle *triangle, RtVec3 org, RtRandom *random) {
    RtVec3d a = rt_widen(triangle->v[0]), b = rt_widen(triangle->v[1]), c = rt_widen(triangle->v[2]);
    RtVec3d normal = rt_normalized(rt_area_vector(a, b, c));
    RtVec3d edge = rt_add_scaledd(a, rt_subd(b, a), rt_random_betweend(random, 0.3, 0.7));
    RtVec3d out = rt_normalized(rt_crossd(rt_subd(b, a), normal));
    RtRay ray = ray_to(org, edge);
    const RtMarginRay prepared = rt_margin_ray(g, &ray, false);
    double by = 4 * rt_margin_delta(&prepared, g, 0) / fabs(rt_dotd(normal, prepared.line.dir));
    return (Border){ray_to(org, rt_add_scaledd(edge, out, -by)), ray_to(org, rt_add_scaledd(edge, out, by)),
                    (RtHit){1, 0}};
}

/* Past the silhouette of a sphere. */
static Border sphere_border(const RtGeometry *g, const RtSphere *sphere, RtVec3 org, RtRandom *random) {
    RtVec3d center = rt_widen(sphere->center), to = rt_subd(center, rt_widen(org));
    RtVec3d out = rt_normalized(rt_crossd(to, rt_random_direction(random)));
    double distance = rt_lengthd(to), radius = (double)sphere->radius;
    RtRay ray = ray_to(org, center);
    const RtMarginRay prepared = rt_margin_ray(g, &ray, false);
    double delta = 4 * rt_margin_delta(&prepared, g, 0);
    /* Aimed beside the centre at r / cos, the line passes it at r. */
    double in = (radius - delta) / sqrt(1 - (radius - delta) * (radius - delta) / (distance * distance));
    double far = (radius + delta) / sqrt(1 - (radius + delta) * (radius + delta) / (distance * distance));
    return (Border){ray_to(org, rt_add_scaledd(center, out, in)),
                    ray_to(org, rt_add_scaledd(center, out, far)), (RtHit){1, 0}};
}

static void assert_borders_are_kept(const Place *p, bool round) {
    RtRandom random = rt_random(13, (uint64_t)(p - places));
    for (int i = 0; i < 400; i++) {
        OWNED_GEOMETRY g = {0};
        /* Nearly equilateral: needles have wider margins. */
        const RtVec3 v[3] = {place(p, rt_vec3(0, 0, 0)), place(p, rt_vec3(1, 0, 0.125f)),
                             place(p, rt_vec3(0.5f, 0.875f, 0))};
        RtVec3 org = place(p, rt_vec3((float)rt_random_betweend(&random, -2, 3),
                                      (float)rt_random_betweend(&random, -2, 3), 2.5f));
        if (round)
            assert_ok(rt_geometry_add_sphere(&g, v[0], p->scale, error));
        else
            assert_ok(rt_geometry_add_triangle(&g, v, NULL, error));
        assert_ok(rt_geometry_finish(&g, error));
        Border border = round ? sphere_border(&g, &g.spheres[0], org, &random)
                              : edge_border(&g, &g.triangles[0], org, &random);
        RtExactAnswer in = rt_referee_nearest(&g, &border.inside),
                      out = rt_referee_nearest(&g, &border.outside);
        assert_int_equal(in.result, RT_HIT);
        assert_int_equal(out.result, RT_MISSED);
        RtHit right = {(float)in.t, 0};
        if (verdict_of(&g, &border.inside, right, RT_MISS) != RT_WRONG)
            fail_msg("%s: a miss inside, try %d", p->name, i);
        if (verdict_of(&g, &border.outside, RT_MISS, border.hit) != RT_WRONG)
            fail_msg("%s: a hit outside, try %d", p->name, i);
        /* Across in t: from a hit well inside. */
        RtVec3d middle = rt_scaled(rt_addd(rt_addd(rt_widen(v[0]), rt_widen(v[1])), rt_widen(v[2])), 1.0 / 3);
        RtRay ray = ray_to(org, round ? rt_widen(v[0]) : middle);
        const RtMarginRay prepared = rt_margin_ray(&g, &ray, false);
        RtExactAnswer at = rt_referee_nearest(&g, &ray);
        RtVec3d normal = rt_normalized(rt_area_vector(rt_widen(v[0]), rt_widen(v[1]), rt_widen(v[2])));
        double cosine = round ? 1 : fabs(rt_dotd(normal, prepared.line.dir));
        double by = 4 * rt_margin_delta(&prepared, &g, 0) / cosine / prepared.line.length;
        right.t = (float)at.t;
        assert_int_equal(verdict_of(&g, &ray, right, right), RT_EQUAL);
        assert_int_equal(verdict_of(&g, &ray, right, (RtHit){(float)((double)at.t + by), 0}), RT_WRONG);
        assert_int_equal(verdict_of(&g, &ray, right, (RtHit){(float)((double)at.t - by), 0}), RT_WRONG);
    }
}

RT_TEST(answers_across_a_border_at_four_times_delta_are_wrong) {
    for (size_t k = 0; k < PLACES; k++) {
        if (places[k].flat != 1) continue;
        assert_borders_are_kept(&places[k], false);
        assert_borders_are_kept(&places[k], true);
    }
}

/* ---- accelerators that lie ---- */

/* Brute force over the first `known` objects. */
typedef struct Ignorant {
    RtAccel base;
    uint32_t known;
} Ignorant;

static void search_known(const Ignorant *self, void *scratch, const RtPreparedRay *ray, bool any, RtHit *best,
                         RtTally *tally) {
    (void)scratch;
    for (uint32_t id = 0; id < self->known; id++) {
        if (rt_test_object(&self->base.scene->geometry, id, ray, any, best, tally)) return;
    }
}

RT_DEFINE_KERNELS(Ignorant, search_known)

static const RtAccelOps ignorant_ops = {.name = "ignorant", .bytes = sizeof(Ignorant), .kernels = &kernels};

static RtEquivalence check_ignorant(const FamilyBench *bench, uint32_t known, bool absolute,
                                    RtCertain *certain) {
    RtEquivalence result;
    Ignorant liar = {.base = *bench->brute, .known = known};
    liar.base.ops = &ignorant_ops;
    liar.base.kernels = &kernels;
    liar.base.exact = false;
    liar.base.absolute = absolute;
    assert_ok(rt_equivalence_check(&bench->reference, &liar.base, 1, &result, error));
    assert_ok(rt_reference_certain(&bench->reference, absolute, 1, certain, error));
    return result;
}

/* `rays` of each family, at these objects, which are finished here. */
static void set_up_geometry(FamilyBench *bench, RtGeometry *geometry, uint64_t seed, size_t rays) {
    assert_ok(rt_geometry_finish(geometry, error));
    bench->scene = open_scene("random:n=1,shape=triangle");
    rt_geometry_clear(&bench->scene.geometry);
    bench->scene.geometry = *geometry;
    bench->scene.name[0] = '\0';
    set_up_rays(bench, seed, rays);
}

RT_TEST(a_library_that_never_hits_is_wrong_however_far_from_the_origin) {
    OWNED_BENCH bench;
    const RtVec3 v[3] = {{{1e6f, 0, 0}}, {{1000001, 0, 0}}, {{1e6f, 1, 0}}};
    RtGeometry g = {0};
    RtCertain certain;
    assert_ok(rt_geometry_add_triangle(&g, v, NULL, error));
    set_up_geometry(&bench, &g, 1, 300);
    RtEquivalence result = check_ignorant(&bench, 0, false, &certain);
    assert_true(result.verdicts[RT_WRONG] > 100 && result.occluded_wrong > 100);
    assert_true(result.faults[RT_FAULT_LOST] == result.verdicts[RT_WRONG]);
    assert_true(rt_certain_suffices(&certain, bench.reference.count, false));
    /* In absolute coordinates float32 cannot see a triangle of size 1 there. */
    result = check_ignorant(&bench, 0, true, &certain);
    assert_int_equal(result.verdicts[RT_WRONG], 0);
    assert_false(rt_certain_suffices(&certain, bench.reference.count, false));
    result = check_ignorant(&bench, 1, false, &certain);
    assert_int_equal(result.verdicts[RT_EQUAL], result.rays);
}

RT_TEST(small_objects_that_a_library_drops_above_a_large_floor_are_missed) {
    OWNED_BENCH bench;
    const RtVec3 a[3] = {{{-1e5f, -2, -1e5f}}, {{1e5f, -2, -1e5f}}, {{1e5f, -2, 1e5f}}};
    const RtVec3 b[3] = {{{-1e5f, -2, -1e5f}}, {{1e5f, -2, 1e5f}}, {{-1e5f, -2, 1e5f}}};
    RtGeometry g = {0};
    RtRandom random = rt_random(14, 0);
    RtCertain certain;
    assert_ok(rt_geometry_add_triangle(&g, a, NULL, error));
    assert_ok(rt_geometry_add_triangle(&g, b, NULL, error));
    add_triangles(&g, &places[0], &random, 400, 0.25f);
    set_up_geometry(&bench, &g, 2, 200);
    RtEquivalence result = check_ignorant(&bench, 2, false, &certain);
    uint64_t small = 0;
    for (size_t i = 0; i < bench.reference.count; i++) {
        uint32_t object = bench.reference.hits[i].object;
        small += object != RT_NO_OBJECT && object >= 2;
    }
    print_message("%" PRIu64 " of %" PRIu64 " rays at small objects are wrong\n", result.verdicts[RT_WRONG],
                  small);
    assert_true(result.verdicts[RT_WRONG] > small / 3);
}

RT_TEST(a_huge_floor_behind_a_small_object_is_neither_a_tie_nor_equal) {
    for (float size = 1e4f; size < 1e8f; size *= 10) {
        OWNED_GEOMETRY g = {0};
        const RtVec3 floor[3] = {{{-size, -size, 0}}, {{size, -size, 0}}, {{0, size, 0}}};
        assert_ok(rt_geometry_add_triangle(&g, floor, NULL, error));
        assert_ok(rt_geometry_add_sphere(&g, rt_vec3(0, 0, 0.06f), 0.05f, error));
        assert_ok(rt_geometry_finish(&g, error));
        const RtRay ray = {.org = {{0, 0, 5}}, .dir = {{0, 0, -1}}, .tmax = INFINITY};
        assert_int_equal(verdict_of(&g, &ray, (RtHit){4.89f, 1}, (RtHit){5, 0}), RT_WRONG);
        /* Even if brute names the floor, from below the sphere's top. */
        assert_int_equal(verdict_of(&g, &ray, (RtHit){4.8f, 0}, (RtHit){5, 0}), RT_WRONG);
    }
}

RT_TEST(a_t_far_from_the_triangle_is_wrong) {
    const RtVec3 v[3] = {{{249.364905f, -84.8612486f, 125.024149f}},
                         {{240.195641f, -82.487118f, 130.617727f}},
                         {{241.128702f, -82.0216236f, 129.983131f}}};
    const RtRay ray = {.org = {{513.545654f, 199.720825f, -68.7771759f}},
                       .dir = {{-0.6109671f, -0.652893543f, 0.44771564f}},
                       .tmax = INFINITY};
    RtFault fault;
    OWNED_OBJECT(g, triangle, v, NULL);
    assert_int_equal(verdict_of(&g, &ray, RT_MISS, (RtHit){1140.2f, 0}), RT_WRONG);
    assert_ok(rt_verdict_fault(rt_judge(&g, &ray, false), (RtHit){1140.2f, 0}, &fault, error));
    assert_int_equal(fault, RT_FAULT_EDGE_ON);
    assert_int_equal(verdict_of(&g, &ray, RT_MISS, (RtHit){434, 0}), RT_MARGINAL);
}

/* ---- our own answers ---- */

RT_TEST(brute_contradicts_no_certain_answer_and_the_certain_answer_is_exact) {
    uint64_t rays = 0, certain_rays = 0;
    for (size_t f = 0; f < rt_family_count(); f++) {
        OWNED_BENCH bench;
        set_up_family(&bench, f, 3, RT_SHARE(40, 12));
        const RtGeometry *g = &bench.scene.geometry;
        for (size_t i = 0; i < bench.reference.count; i++) {
            const RtRay *ray = &bench.reference.rays[i];
            RtHit hit = bench.reference.hits[i];
            bool certain, must_hit;
            if (verdict_by_margins(g, ray, hit) == RT_WRONG)
                fail_msg("%s, ray %zu: object %u at %g", bench.scene.name, i, hit.object, (double)hit.t);
            assert_ok(rt_verdict_certain(rt_judge(g, ray, false), &certain, &must_hit, error));
            rays++;
            if (!certain) continue;
            certain_rays++;
            RtExactAnswer exact = rt_referee_nearest(g, ray);
            if (exact.object != hit.object || must_hit != (exact.result == RT_HIT))
                fail_msg("%s, ray %zu: certain, but exactly %u", bench.scene.name, i, exact.object);
        }
    }
    print_message("%" PRIu64 " of %" PRIu64 " rays are certain\n", certain_rays, rays);
    assert_true(certain_rays > rays / 3);
}

RT_TESTS(verdicts, NULL, NULL)
