/* shape/solid.h: spans of every kind of solid against membership of points in long double, which shares no
 * code with them; lines that touch, graze or run along; planes that coincide; extents; refusals. */
#include "testing.h"

#include "base/memory.h"
#include "base/random.h"
#include "shape/solid.h"

#include <float.h>
#include <math.h>
#include <stdio.h>
#include <string.h>

/* ---- lines ---- */

static void assert_near(double value, double expected, double slack) {
    if (fabs(value - expected) > slack) fail_msg("%.17g is not %.17g", value, expected);
}

enum { MOST = 512 };

typedef struct List {
    RtCrossing at[MOST];
    uint32_t count;
    float near, far;
} List;

static RtRay make_ray(RtVec3 org, RtVec3 dir) {
    return (RtRay){.org = org, .dir = dir, .tmin = 0, .tmax = INFINITY};
}

/* What a tree would ask, and what every list keeps. */
static List cross(const RtSolidSet *set, uint32_t index, const RtRay *ray) {
    const RtSolid *solid = &set->solids[index];
    RtSolidRay r = {rt_widen(ray->org), rt_widen(ray->dir), rt_ray_prepare(ray, &solid->box)};
    List list = {.count = 0, .near = -INFINITY, .far = INFINITY};
    assert_true(rt_solid_most_crossings(solid) <= MOST);
    assert_int_equal(rt_solid_most_crossings(solid) % 2, 0);
    rt_box_cut(&solid->box, &r.thick, &list.near, &list.far);
    if (!(list.near <= list.far)) return list;
    list.count = rt_solid_crossings(set, index, &r, list.near, list.far, list.at);
    assert_true(list.count <= rt_solid_most_crossings(solid));
    assert_int_equal(list.count % 2, 0);
    for (uint32_t i = 0; i < list.count; i++) {
        assert_int_equal(list.at[i].solid, index);
        assert_true(list.at[i].t >= list.near && list.at[i].t <= list.far);
        assert_true(i == 0 || list.at[i - 1].t < list.at[i].t);
    }
    return list;
}

/* ---- membership of points, in long double: below 0 inside, about a distance ---- */

typedef struct Point {
    long double x, y, z;
} Point;

static long double most_of(long double a, long double b) {
    return a > b ? a : b;
}

static long double in_ball(Point p, double ratio) {
    (void)ratio;
    return sqrtl(p.x * p.x + p.y * p.y + p.z * p.z) - 1;
}

static long double in_cone(Point p, double ratio) {
    long double slope = 1 - (long double)ratio;
    long double side = (sqrtl(p.x * p.x + p.y * p.y) - 1 + slope * p.z) / sqrtl(1 + slope * slope);
    return most_of(side, most_of(-p.z, p.z - 1));
}

static long double in_torus(Point p, double ratio) {
    long double w = sqrtl(p.x * p.x + p.y * p.y) - 1;
    return sqrtl(w * w + p.z * p.z) - (long double)ratio;
}

static long double in_box(Point p, double ratio) {
    (void)ratio;
    return most_of(most_of(fabsl(p.x), fabsl(p.y)), fabsl(p.z)) - 1;
}

static const RtPlane box_planes[6] = {
    {{{-2, 0, 0}}, 2}, {{{2, 0, 0}}, 2},  {{{0, -1, 0}}, 1},
    {{{0, 3, 0}}, 3},  {{{0, 0, -1}}, 1}, {{{0, 0, 1}}, 1},
};

/* Without an end: the second also with an edge. */
static const RtPlane half_space_planes[1] = {{{{1, 2, 2}}, 1}};
static const RtPlane wedge_planes[2] = {{{{1, 2, 2}}, 1}, {{{2, -2, -1}}, 3}};

static long double in_half_space(Point p, double ratio) {
    (void)ratio;
    return (p.x + 2 * p.y + 2 * p.z - 1) / 3;
}

static long double in_wedge(Point p, double ratio) {
    return most_of(in_half_space(p, ratio), (2 * p.x - 2 * p.y - p.z - 3) / 3);
}

/* The cube of in_box without the quarter where x and y are above 0. */
static long double in_notched_cube(Point p, double ratio) {
    return most_of(in_box(p, ratio), p.x < p.y ? p.x : p.y);
}

typedef long double (*Membership)(Point p, double ratio);

/* ---- meshes ---- */

/* A prism over a polygon, counter-clockwise in the xy plane, from z = -1 to 1: its top and bottom are cut
 * into the given triangles of its corners. */
static uint32_t prism(const float (*corners)[2], uint32_t count, const uint32_t (*top)[3], uint32_t top_count,
                      RtTriangle *out) {
    uint32_t n = 0;
    for (uint32_t i = 0; i < top_count; i++) {
        for (int k = 0; k < 3; k++) {
            const float *up = corners[top[i][k]], *down = corners[top[i][2 - k]];
            out[n].v[k] = rt_vec3(up[0], up[1], 1);
            out[n + 1].v[k] = rt_vec3(down[0], down[1], -1);
        }
        n += 2;
    }
    for (uint32_t i = 0; i < count; i++) {
        const float *a = corners[i], *b = corners[(i + 1) % count];
        RtVec3 a0 = rt_vec3(a[0], a[1], -1), b0 = rt_vec3(b[0], b[1], -1);
        RtVec3 a1 = rt_vec3(a[0], a[1], 1), b1 = rt_vec3(b[0], b[1], 1);
        out[n++] = (RtTriangle){{a0, b0, b1}};
        out[n++] = (RtTriangle){{a0, b1, a1}};
    }
    return n;
}

static uint32_t cube_mesh(RtTriangle out[12]) {
    static const float corners[4][2] = {{-1, -1}, {1, -1}, {1, 1}, {-1, 1}};
    static const uint32_t top[2][3] = {{0, 1, 2}, {0, 2, 3}};
    return prism(corners, 4, top, 2, out);
}

static uint32_t notched_cube_mesh(RtTriangle out[20]) {
    static const float corners[6][2] = {{-1, -1}, {1, -1}, {1, 0}, {0, 0}, {0, 1}, {-1, 1}};
    static const uint32_t top[4][3] = {{0, 1, 2}, {0, 2, 3}, {0, 3, 4}, {0, 4, 5}};
    return prism(corners, 6, top, 4, out);
}

/* ---- models: solids with their membership ---- */

typedef struct Model {
    const char *name;
    Membership inside;
    double ratio;
    RtTransform place;
    long double back[3][3]; /* inverse of the linear part of place */
    double rounding;        /* of the solid's own numbers */
    uint32_t index;
} Model;

/* Cramer's rule. */
static void invert(const RtTransform *place, long double back[3][3]) {
    for (int i = 0; i < 3; i++) {
        for (int j = 0; j < 3; j++) {
            int r = (j + 1) % 3, s = (j + 2) % 3, c = (i + 1) % 3, d = (i + 2) % 3;
            back[i][j] = (long double)place->m[r][c] * (long double)place->m[s][d] -
                         (long double)place->m[r][d] * (long double)place->m[s][c];
        }
    }
    long double volume = 0;
    for (int i = 0; i < 3; i++) volume += back[0][i] * (long double)place->m[i][0];
    for (int i = 0; i < 3; i++) {
        for (int j = 0; j < 3; j++) back[i][j] /= volume;
    }
}

static long double value_at(const Model *model, const RtRay *ray, long double t) {
    long double from[3], p[3];
    for (int a = 0; a < 3; a++) {
        from[a] =
            (long double)ray->org.at[a] + t * (long double)ray->dir.at[a] - (long double)model->place.m[a][3];
    }
    for (int a = 0; a < 3; a++) {
        p[a] = model->back[a][0] * from[0] + model->back[a][1] * from[1] + model->back[a][2] * from[2];
    }
    return model->inside((Point){p[0], p[1], p[2]}, model->ratio);
}

/* At most how much longer a vector is in standard coordinates. */
static double stretch_of(const Model *model) {
    double sum = 0;
    for (int a = 0; a < 3; a++) {
        for (int b = 0; b < 3; b++) sum += fabs((double)model->back[a][b]);
    }
    return sum;
}

/* How much of a standard unit value_at may be off: where origins are far and maps uneven. */
static double noise_at(const Model *model, const RtRay *ray, double t) {
    double reach = 0;
    for (int a = 0; a < 3; a++)
        reach += fabs((double)ray->org.at[a]) + fabs(t * (double)ray->dir.at[a]) + fabs(model->place.m[a][3]);
    return model->rounding * (reach * stretch_of(model) + 3);
}

enum { MODELS = 12 };

/* One of each kind and more, placed by `place`. */
static void add_models(RtSolidSet *set, const RtTransform *place, Model models[MODELS]) {
    RtTriangle cube[12], notched[20];
    uint32_t cube_count = cube_mesh(cube), notched_count = notched_cube_mesh(notched);
    const Model made[MODELS] = {
        {.name = "sphere", .inside = in_ball},
        {.name = "cylinder", .inside = in_cone, .ratio = 1},
        {.name = "frustum", .inside = in_cone, .ratio = 0.25},
        {.name = "full cone", .inside = in_cone, .ratio = 0},
        {.name = "torus", .inside = in_torus, .ratio = 0.4},
        {.name = "fat torus", .inside = in_torus, .ratio = 0.99},
        {.name = "thin torus", .inside = in_torus, .ratio = 1e-4},
        {.name = "box", .inside = in_box},
        {.name = "half-space", .inside = in_half_space},
        {.name = "wedge", .inside = in_wedge},
        {.name = "cube of triangles", .inside = in_box, .rounding = 0x1p-22},
        {.name = "notched cube of triangles", .inside = in_notched_cube, .rounding = 0x1p-22},
    };
    for (int i = 0; i < MODELS; i++) {
        Model *m = &models[i];
        *m = made[i];
        m->place = *place;
        if (m->rounding == 0) m->rounding = 0x1p-50;
        invert(place, m->back);
        switch (i) {
        case 0: assert_ok(rt_solid_add_sphere(set, place, &m->index, error)); break;
        case 7: assert_ok(rt_solid_add_polyhedron(set, box_planes, 6, place, &m->index, error)); break;
        case 8: assert_ok(rt_solid_add_polyhedron(set, half_space_planes, 1, place, &m->index, error)); break;
        case 9: assert_ok(rt_solid_add_polyhedron(set, wedge_planes, 2, place, &m->index, error)); break;
        case 10: assert_ok(rt_solid_add_mesh(set, cube, cube_count, place, &m->index, error)); break;
        case 11: assert_ok(rt_solid_add_mesh(set, notched, notched_count, place, &m->index, error)); break;
        default:
            if (m->inside == in_cone) assert_ok(rt_solid_add_cone(set, m->ratio, place, &m->index, error));
            if (m->inside == in_torus) assert_ok(rt_solid_add_torus(set, m->ratio, place, &m->index, error));
        }
    }
}

/* ---- lists against membership ---- */

static const char *describe(const Model *model, const RtRay *ray) {
    static char text[512];
    snprintf(text, sizeof text, "%s, from (%a, %a, %a) along (%a, %a, %a)", model->name, (double)ray->org.x,
             (double)ray->org.y, (double)ray->org.z, (double)ray->dir.x, (double)ray->dir.y,
             (double)ray->dir.z);
    return text;
}

/* The length of an ulp of t in standard coordinates, at most. */
static double ulp_at(const Model *model, const RtRay *ray, double t) {
    return fabs(t) * 0x1p-23 * rt_lengthd(rt_widen(ray->dir)) * stretch_of(model);
}

/* The list and membership say the same at t, unless the surface is within rounding, or within `slack`. */
static void check_at(const Model *model, const RtRay *ray, const List *list, double t, double slack) {
    uint32_t before = 0;
    while (before < list->count && (double)list->at[before].t < t) before++;
    long double value = value_at(model, ray, (long double)t);
    if (fabsl(value) <= (long double)(noise_at(model, ray, t) + slack)) return;
    if ((before % 2 == 1) == (value < 0)) return;
    fail_msg("%s: at t = %.17g the solid's function is %.3Lg, but the point is %s of %u crossings",
             describe(model, ray), t, value, before % 2 ? "inside" : "outside", list->count);
}

/* Each crossing is within an ulp of the true one, unless ulps are too long for the solid; between two, before
 * and after all there is no other that is not within an ulp of them. */
static List check_line(const Model *model, const RtSolidSet *set, const RtRay *ray) {
    List list = cross(set, model->index, ray);
    double last = -INFINITY, thinness = model->inside == in_torus ? model->ratio : 1;
    for (uint32_t i = 0; i < list.count; i++) {
        double t = (double)list.at[i].t, next = i + 1 < list.count ? (double)list.at[i + 1].t : INFINITY;
        double ulp = ulp_at(model, ray, t), slack = ulp < 0.01 * thinness ? 0 : ulp;
        double below = (double)nextafterf(list.at[i].t, -INFINITY);
        double above = (double)nextafterf(list.at[i].t, INFINITY);
        if (isfinite(t) && below > last) check_at(model, ray, &list, below, slack);
        if (isfinite(t) && above < next) check_at(model, ray, &list, above, slack);
        if (isfinite(t + last)) check_at(model, ray, &list, last + (t - last) / 2, ulp);
        last = t;
    }
    return list;
}

static RtVec3d to_world(const RtTransform *place, RtVec3d p) {
    RtVec3d moved;
    for (int a = 0; a < 3; a++) {
        const double *m = place->m[a];
        moved.at[a] = m[0] * p.x + m[1] * p.y + m[2] * p.z + m[3];
    }
    return moved;
}

/* A point in the standard solid, or not far from it. */
static RtVec3d random_target(const Model *model, RtRandom *random) {
    RtVec3d p = rt_widen(rt_random_point(random, 1.1f));
    if (model->inside == in_cone) p.z = rt_random_betweend(random, -0.1, 1.1);
    if (model->inside != in_torus) return p;
    double w = sqrt(p.x * p.x + p.y * p.y);
    RtVec3d circle = {{p.x / w, p.y / w, 0}};
    return rt_add_scaledd(circle, rt_widen(rt_random_point(random, 0.8f)), model->ratio);
}

/* A line near `target`, whose origin is `distance` sizes of the solid away. */
static RtRay random_ray(const Model *model, RtRandom *random, RtVec3d target, double distance) {
    RtVec3d from = rt_random_direction(random);
    if (rt_random_unit(random) < 0.25f) from.at[rt_random_bits(random) % 3] = 0;
    if (rt_random_unit(random) < 0.5f) from = rt_subd(target, random_target(model, random));
    RtVec3d dir = rt_subd(to_world(&model->place, from), to_world(&model->place, rt_vec3d(0, 0, 0)));
    RtVec3 along = rt_narrow(rt_scaled(dir, (double)rt_random_between(random, 0.1f, 10)));
    double steps = distance / (rt_lengthd(rt_widen(along)) / rt_lengthd(dir));
    RtVec3d org = rt_add_scaledd(to_world(&model->place, target), rt_widen(along), -steps);
    return make_ray(rt_narrow(org), along);
}

static uint32_t check_random_lines(const RtSolidSet *set, const Model *model, RtRandom *random,
                                   double distance, uint32_t rays) {
    uint32_t met = 0;
    for (uint32_t i = 0; i < rays; i++) {
        RtRay ray = random_ray(model, random, random_target(model, random), distance);
        List list = check_line(model, set, &ray);
        met += list.count > 0;
        double length = rt_lengthd(rt_widen(ray.dir));
        for (int k = 0; k < 4; k++) {
            double t = rt_random_betweend(random, distance - 2, distance + 2) / length;
            check_at(model, &ray, &list, t, ulp_at(model, &ray, t));
        }
    }
    return met;
}

static void random_lines_are_inside_where_their_points_are(void **state) {
    (void)state;
    static const double distances[] = {0, 2, 1e3, 1e5, 1e7};
    RtRandom random = rt_random(1, 0);
    RtTransform place = rt_transform_identity();
    RtSolidSet set = {0};
    Model models[MODELS];
    add_models(&set, &place, models);
    for (int i = 0; i < MODELS; i++) {
        for (size_t d = 0; d < sizeof distances / sizeof *distances; d++) {
            uint32_t met = check_random_lines(&set, &models[i], &random, distances[d], 2000);
            bool seen =
                models[i].ratio != 1e-4 || distances[d] < 1e4; /* where ulps are not wider than the tube */
            if (seen && met < 20)
                fail_msg("only %u lines met the %s from %g", met, models[i].name, distances[d]);
        }
    }
    rt_solid_set_clear(&set);
}

static void so_they_are_where_solids_are_turned_stretched_and_moved(void **state) {
    (void)state;
    RtRandom random = rt_random(2, 0);
    for (int round = 0; round < 60; round++) {
        RtTransform place = rt_transform_identity();
        float size = powf(10, (float)(round % 21 - 10));
        RtVec3 factors = rt_vec3(size, size, size);
        for (int a = 0; a < 3 && round % 2; a++) factors.at[a] *= rt_random_between(&random, 0.1f, 1);
        assert_ok(rt_transform_scale(&place, factors, error));
        assert_ok(rt_transform_rotate(&place, rt_narrow(rt_random_direction(&random)),
                                      360 * (double)rt_random_unit(&random), error));
        assert_ok(rt_transform_translate(&place, rt_random_point(&random, 3 * size), error));
        RtSolidSet set = {0};
        Model models[MODELS];
        add_models(&set, &place, models);
        for (int i = 0; i < MODELS; i++) check_random_lines(&set, &models[i], &random, 5, 100);
        rt_solid_set_clear(&set);
    }
}

/* ---- accuracy ---- */

/* The place within an ulp of t where membership changes, by halving. */
static long double true_place(const Model *model, const RtRay *ray, float t) {
    long double lo = (long double)nextafterf(t, -INFINITY), hi = (long double)nextafterf(t, INFINITY);
    bool inside = value_at(model, ray, lo) < 0;
    if ((value_at(model, ray, hi) < 0) == inside) return NAN;
    for (int i = 0; i < 60; i++) {
        long double middle = lo / 2 + hi / 2;
        *((value_at(model, ray, middle) < 0) == inside ? &lo : &hi) = middle;
    }
    return lo / 2 + hi / 2;
}

/* All but one in ten thousand: the error in double is so small that it seldom shows. */
static void check_accuracy(const RtSolidSet *set, const Model *model, RtRandom *random) {
    uint32_t asked = 0, second_best = 0;
    for (int k = 0; k < 5000; k++) {
        RtRay ray = random_ray(model, random, random_target(model, random), 4);
        List list = cross(set, model->index, &ray);
        for (uint32_t c = 0; c < list.count; c++) {
            if (isinf(list.at[c].t)) continue;
            asked++;
            second_best += (float)true_place(model, &ray, list.at[c].t) != list.at[c].t;
        }
    }
    if (asked < 4000 || second_best * 10000 > asked)
        fail_msg("%s: %u of %u crossings are not the nearest", model->name, second_best, asked);
}

static void crossings_are_the_float32_nearest_to_the_truth(void **state) {
    (void)state;
    RtRandom random = rt_random(8, 0);
    for (int turned = 0; turned < 2; turned++) {
        RtTransform place = rt_transform_identity();
        if (turned) assert_ok(rt_transform_rotate(&place, rt_vec3(1, 2, 3), 30, error));
        RtSolidSet set = {0};
        Model models[MODELS];
        add_models(&set, &place, models);
        for (int i = 0; i < MODELS; i++) {
            bool rounded = models[i].rounding > 0x1p-50; /* its vertices, when turned */
            if (!turned || !rounded) check_accuracy(&set, &models[i], &random);
        }
        rt_solid_set_clear(&set);
    }
}

/* ---- by hand ---- */

/* A line, in words, and where it crosses the solid: t of the crossings, ended by NAN. */
typedef struct Case {
    const char *what;
    RtVec3 org, dir;
    float t[5];
} Case;

static void check_cases(const RtSolidSet *set, uint32_t index, const Case *cases, size_t count) {
    for (size_t i = 0; i < count; i++) {
        RtRay ray = make_ray(cases[i].org, cases[i].dir);
        List list = cross(set, index, &ray);
        uint32_t expected = 0;
        while (!isnan(cases[i].t[expected])) expected++;
        bool same = list.count == expected;
        for (uint32_t k = 0; same && k < expected; k++) same = list.at[k].t == cases[i].t[k];
        if (same) continue;
        fail_msg("%s %s: %u crossings, the first at %.9g", rt_solid_kind_name(set->solids[index].kind),
                 cases[i].what, list.count, list.count ? (double)list.at[0].t : NAN);
    }
}

#define CHECK(set, index, cases) check_cases(set, index, cases, sizeof cases / sizeof *(cases))

static void a_box_has_no_skin(void **state) {
    (void)state;
    static const Case cases[] = {
        {"straight through", {{5, 0, 0}}, {{-2, 0, 0}}, {2, 3, NAN}},
        {"from the inside", {{0, 0, 0}}, {{0, 0, 1}}, {-1, 1, NAN}},
        {"behind the origin", {{5, 0, 0}}, {{1, 0, 0}}, {-6, -4, NAN}},
        {"from a face inward", {{1, 0, 0}}, {{-1, 0, 0}}, {0, 2, NAN}},
        {"from edge to edge", {{2, 2, 0}}, {{-1, -1, 0}}, {1, 3, NAN}},
        {"from corner to corner", {{2, 2, 2}}, {{-1, -1, -1}}, {1, 3, NAN}},
        {"in the plane of a face", {{5, 1, 0}}, {{-1, 0, 0}}, {NAN}},
        {"in the plane of the face opposite", {{5, -1, 0}}, {{-1, 0, 0}}, {NAN}},
        {"in the plane of a face, from there", {{0, 1, 0}}, {{-1, 0, 1}}, {NAN}},
        {"along an edge", {{5, 1, 1}}, {{-1, 0, 0}}, {NAN}},
        {"touching an edge", {{2, 0, 0}}, {{-1, 1, 0}}, {NAN}},
        {"touching a corner", {{2, 0, 1}}, {{-1, 1, 0}}, {NAN}},
        {"beside it", {{5, 1.5f, 0}}, {{-1, 0, 0}}, {NAN}},
    };
    RtSolidSet set = {0};
    uint32_t box;
    assert_ok(rt_solid_add_box(&set, rt_vec3(-1, -1, -1), rt_vec3(1, 1, 1), &box, error));
    CHECK(&set, box, cases);
    rt_solid_set_clear(&set);
}

static void a_half_space_has_no_end(void **state) {
    (void)state;
    static const Case cases[] = {
        {"into it", {{0, 0, 5}}, {{1, 0, -2}}, {2, INFINITY, NAN}},
        {"out of it", {{0, 0, 0}}, {{0, 0, 2}}, {-INFINITY, 0.5f, NAN}},
        {"along it, inside", {{0, 0, 0}}, {{1, 0, 0}}, {-INFINITY, INFINITY, NAN}},
        {"along it, outside", {{0, 0, 2}}, {{1, 0, 0}}, {NAN}},
        {"in its plane", {{0, 0, 1}}, {{1, 0, 0}}, {NAN}},
    };
    RtSolidSet set = {0};
    uint32_t half;
    assert_ok(rt_solid_add_half_space(&set, rt_vec3(7, 8, 1), rt_vec3(0, 0, 3), &half, error));
    CHECK(&set, half, cases);
    rt_solid_set_clear(&set);
}

static void a_sphere_that_is_touched_is_not_crossed(void **state) {
    (void)state;
    static const Case cases[] = {
        {"through its centre", {{1, 2, 10}}, {{0, 0, -1}}, {5, 9, NAN}},
        {"from the centre", {{1, 2, 3}}, {{0, 0, 4}}, {-0.5f, 0.5f, NAN}},
        {"from its surface", {{1, 2, 5}}, {{0, 0, -1}}, {0, 4, NAN}},
        {"touched", {{3, 2, 10}}, {{0, 0, -1}}, {NAN}},
        {"missed", {{3.5f, 2, 10}}, {{0, 0, -1}}, {NAN}},
    };
    RtSolidSet set = {0};
    uint32_t sphere;
    assert_ok(rt_solid_add_ellipsoid(&set, rt_vec3(1, 2, 3), rt_vec3(2, 2, 2), &sphere, error));
    CHECK(&set, sphere, cases);
    rt_solid_set_clear(&set);
}

/* Apex at (0, 0, 4), base of radius 2 at z = 0. */
static void a_full_cone_ends_in_its_apex(void **state) {
    (void)state;
    static const Case cases[] = {
        {"along the axis", {{0, 0, 10}}, {{0, 0, -1}}, {6, 10, NAN}},
        {"along the axis, upward", {{0, 0, -1}}, {{0, 0, 1}}, {1, 5, NAN}},
        {"parallel to the axis", {{1, 0, 10}}, {{0, 0, -1}}, {8, 10, NAN}},
        {"across", {{-5, 0, 2}}, {{1, 0, 0}}, {4, 6, NAN}},
        {"across, above the apex", {{-5, 0, 5}}, {{1, 0, 0}}, {NAN}},
        {"across, at the apex", {{-5, 0, 4}}, {{1, 0, 0}}, {NAN}},
        {"through the apex, aslant and outside", {{-4, 0, 2}}, {{2, 0, 1}}, {NAN}},
        {"through the apex, steep", {{-1, 0, 8}}, {{0.25f, 0, -1}}, {4, 8, NAN}},
        {"along its side", {{0, 0, 4}}, {{0.5f, 0, -1}}, {NAN}},
        {"parallel to its side, inside", {{-1, 0, 4}}, {{0.5f, 0, -1}}, {1, 4, NAN}},
        {"parallel to its side, outside", {{1, 0, 4}}, {{0.5f, 0, -1}}, {NAN}},
        {"in the plane of its base", {{-5, 0, 0}}, {{1, 0, 0}}, {NAN}},
        {"touching the rim of its base", {{-2, -5, 0}}, {{0, 1, 0}}, {NAN}},
    };
    RtSolidSet set = {0};
    uint32_t up, down;
    assert_ok(rt_solid_add_frustum(&set, rt_vec3(0, 0, 0), 2, rt_vec3(0, 0, 4), 0, &up, error));
    assert_ok(rt_solid_add_frustum(&set, rt_vec3(0, 0, 4), 0, rt_vec3(0, 0, 0), 2, &down, error));
    CHECK(&set, up, cases);
    CHECK(&set, down, cases);
    rt_solid_set_clear(&set);
}

static void a_cylinder_is_entered_by_cap_or_side(void **state) {
    (void)state;
    static const Case cases[] = {
        {"along the axis", {{-3, 0, 0}}, {{1, 0, 0}}, {3, 7, NAN}},
        {"parallel to the axis", {{-3, 1, 1}}, {{2, 0, 0}}, {1.5f, 3.5f, NAN}},
        {"across", {{2, -5, 0}}, {{0, 1, 0}}, {3, 7, NAN}},
        {"cap to side", {{-2, 0, 0}}, {{1, 0.5f, 0}}, {2, 4, NAN}},
        {"along its side", {{-3, 2, 0}}, {{1, 0, 0}}, {NAN}},
        {"in the plane of a cap", {{4, -5, 0}}, {{0, 1, 0}}, {NAN}},
        {"touching its side", {{-1, 2, -3}}, {{1, 0, 1}}, {NAN}},
        {"outside, parallel to the axis", {{-3, 3, 1}}, {{1, 0, 0}}, {NAN}},
    };
    RtSolidSet set = {0};
    uint32_t cylinder;
    assert_ok(rt_solid_add_frustum(&set, rt_vec3(0, 0, 0), 2, rt_vec3(4, 0, 0), 2, &cylinder, error));
    CHECK(&set, cylinder, cases);
    RtRay ray = make_ray(rt_vec3(-2, 0, 0), rt_vec3(1, 0.5f, 0));
    List list = cross(&set, cylinder, &ray);
    assert_int_equal(list.at[0].face, 1);
    assert_int_equal(list.at[1].face, 0);
    rt_solid_set_clear(&set);
}

/* Circle of radius 2 in the plane z = 1, tube of radius 1. */
static void a_torus_has_a_hole(void **state) {
    (void)state;
    static const Case cases[] = {
        {"across both sides", {{-5, 0, 1}}, {{1, 0, 0}}, {2, 4, 6, 8, NAN}},
        {"through the hole", {{0, 0, 5}}, {{0, 0, -1}}, {NAN}},
        {"through the hole, aslant", {{0, 0, 1}}, {{1, 0, 8}}, {NAN}},
        {"through the tube", {{0, 2, 5}}, {{0, 0, -2}}, {1.5f, 2.5f, NAN}},
        {"from inside the tube", {{2, 0, 1}}, {{0, 0, 1}}, {-1, 1, NAN}},
        {"touched from outside", {{3, -4, 1}}, {{0, 1, 0}}, {NAN}},
        {"touched on top", {{-5, 0, 2}}, {{1, 0, 0}}, {NAN}},
        {"touched on top, from below", {{2, 0, -2}}, {{0, 0, 1}}, {2, 4, NAN}},
        {"touched at the hole", {{0, 1, 5}}, {{0, 0, -1}}, {NAN}},
        {"missed", {{-5, 0, 2.5f}}, {{1, 0, 0}}, {NAN}},
    };
    RtSolidSet set = {0};
    uint32_t torus;
    assert_ok(rt_solid_add_ring(&set, rt_vec3(0, 0, 1), rt_vec3(0, 0, 7), 2, 1, &torus, error));
    CHECK(&set, torus, cases);

    /* In the tube, touching the hole's rim on the way: two spans that touch are one. */
    RtRay ray = make_ray(rt_vec3(1, -8, 1), rt_vec3(0, 1, 0));
    List list = cross(&set, torus, &ray);
    assert_int_equal(list.count, 2);
    assert_float_equal(list.at[0].t, 8 - sqrtf(8), 1e-6f);
    assert_float_equal(list.at[1].t, 8 + sqrtf(8), 1e-6f);
    rt_solid_set_clear(&set);
}

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
static void a_cube_of_triangles_is_a_box_even_at_edges_and_corners(void **state) {
    (void)state;
    RtSolidSet set = {0};
    uint32_t box, mesh;
    RtTriangle triangles[192];
    RtTransform place = rt_transform_identity();
    uint32_t count = fine_cube_mesh(triangles);
    assert_ok(rt_solid_add_box(&set, rt_vec3(-2, -2, -2), rt_vec3(2, 2, 2), &box, error));
    assert_ok(rt_solid_add_mesh(&set, triangles, count, &place, &mesh, error));
    for (uint32_t from = 0; from < 7 * 7 * 7; from++) {
        for (uint32_t along = 0; along < 5 * 5 * 5; along++) {
            if (along == 62) continue; /* nowhere */
            RtRay ray = make_ray(lattice(from, 7), lattice(along, 5));
            List of_box = cross(&set, box, &ray), of_mesh = cross(&set, mesh, &ray);
            bool in_face = false;
            for (int a = 0; a < 3; a++) in_face |= ray.dir.at[a] == 0 && fabsf(ray.org.at[a]) == 2;
            if (!in_face) assert_same_places(&of_box, &of_mesh, &ray);
            if (in_face) assert_int_equal(of_box.count, 0);
        }
    }
    rt_solid_set_clear(&set);
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
static void a_mesh_may_overlap_and_touch_itself_and_be_hollow(void **state) {
    (void)state;
    static const Pair pairs[] = {{1, 0}, {1, 1}, {1, 2}, {1, 3}, {-0.5f, 0}, {-0.5f, 3}};
    RtTransform place = rt_transform_identity();
    for (size_t i = 0; i < sizeof pairs / sizeof *pairs; i++) {
        RtSolidSet set = {0};
        RtTriangle triangles[24];
        pair = pairs[i];
        Model model = {.name = "a pair of cubes", .inside = in_pair, .place = place, .rounding = 0x1p-50};
        invert(&place, model.back);
        assert_ok(rt_solid_add_mesh(&set, triangles, pair_mesh(triangles), &place, &model.index, error));
        for (uint32_t from = 0; from < 5 * 5 * 5; from++) {
            for (uint32_t along = 0; along < 5 * 5 * 5; along++) {
                if (along == 62) continue;
                RtRay ray = make_ray(lattice(from, 5), lattice(along, 5));
                check_line(&model, &set, &ray);
            }
        }
        rt_solid_set_clear(&set);
    }
}

/* As near to them as float32 allows, which is in them for some. */
static void lines_along_edges_and_faces_of_a_turned_mesh_keep_to_it(void **state) {
    (void)state;
    RtRandom random = rt_random(9, 0);
    for (int round = 0; round < 50; round++) {
        RtTransform place = rt_transform_identity();
        assert_ok(rt_transform_rotate(&place, rt_vec3(1, 2, 3), round * 10, error));
        RtSolidSet set = {0};
        Model models[MODELS];
        add_models(&set, &place, models);
        const Model *cube = &models[MODELS - 2];
        const RtTriangle *triangles = set.triangles + set.solids[cube->index].first;
        for (uint32_t i = 0; i < 12; i++) {
            for (int k = 0; k < 9; k++) {
                RtVec3 a = triangles[i].v[k % 3], b = triangles[i].v[(k + 1) % 3],
                       c = triangles[i].v[(k + 2) % 3];
                RtVec3 dir = rt_add(rt_sub(b, a), rt_scale(rt_sub(c, a), (float)(k / 3) / 4));
                float back = rt_random_between(&random, 0, 3);
                RtRay ray = make_ray(rt_add(a, rt_scale(dir, -back)), dir);
                List list = check_line(cube, &set, &ray);
                for (uint32_t n = 0; n < list.count; n++)
                    assert_true(fabsl(value_at(cube, &ray, (long double)list.at[n].t)) < 1e-5L);
            }
        }
        rt_solid_set_clear(&set);
    }
}

/* A vertex in the middle of an edge that the triangle on the other side does not have, and a triangle without
 * area that closes the mesh there. Lines go through that edge. */
static void a_triangle_without_area_does_no_harm(void **state) {
    (void)state;
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
        RtSolidSet set = {0};
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
        rt_solid_set_clear(&set);
    }
}

/* A box, the caps of a cylinder and a half-space, turned and moved alike; then not turned. */
static void faces_in_one_plane_are_met_at_the_same_bits(void **state) {
    (void)state;
    RtRandom random = rt_random(3, 0);
    for (int round = 0; round < 40; round++) {
        RtTransform move = rt_transform_identity();
        float size = rt_random_between(&random, 0.1f, 30);
        assert_ok(rt_transform_scale(&move, rt_vec3(size, size, size), error));
        if (round % 2) assert_ok(rt_transform_rotate(&move, rt_vec3(1, 2, 3), 36 * round, error));
        assert_ok(rt_transform_translate(&move, rt_random_point(&random, 1000), error));
        RtSolidSet set = {0};
        uint32_t at[5];
        assert_ok(rt_solid_add_box(&set, rt_vec3(-9, -9, 0.1f), rt_vec3(9, 9, 0.7f), &at[0], error));
        assert_ok(rt_solid_add_box(&set, rt_vec3(-9, -9, 0.7f), rt_vec3(9, 9, 1.5f), &at[1], error));
        assert_ok(rt_solid_add_frustum(&set, rt_vec3(0, 0, 0.1f), 9, rt_vec3(0, 0, 0.7f), 9, &at[2], error));
        assert_ok(rt_solid_add_frustum(&set, rt_vec3(0, 0, 0.7f), 9, rt_vec3(0, 0, 0.1f), 5, &at[3], error));
        assert_ok(rt_solid_add_half_space(&set, rt_vec3(3, 2, 0.7f), rt_vec3(0, 0, 1), &at[4], error));
        for (int i = 0; i < 5; i++) assert_ok(rt_solid_add_moved(&set, &set, at[i], &move, &at[i], error));
        for (int i = 0; i < 100; i++) {
            RtVec3d aim = to_world(&move, rt_widen(rt_random_point(&random, 1)));
            RtVec3d dir = rt_random_direction(&random), up = {{move.m[0][2], move.m[1][2], move.m[2][2]}};
            if (fabs(rt_dotd(dir, up)) < 0.5 * rt_lengthd(up)) continue; /* too flat to go through caps */
            RtRay ray = make_ray(rt_narrow(rt_add_scaledd(aim, dir, -2 * (double)size)), rt_narrow(dir));
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
        rt_solid_set_clear(&set);
    }
}
/* Their offsets are float32, so that a sum and what it rounds to are one plane. */
static void faces_along_an_axis_are_where_float32_has_them(void **state) {
    (void)state;
    RtSolidSet set = {0};
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
    rt_solid_set_clear(&set);
}

/* ---- hulls ---- */

static void the_hull_of_the_corners_of_a_box_is_the_box(void **state) {
    (void)state;
    RtRandom random = rt_random(4, 0);
    RtSolidSet set = {0};
    RtVec3 lo = rt_vec3(-0.7f, 2.1f, 100.3f), hi = rt_vec3(0.1f, 2.5f, 101), corners[10];
    for (uint32_t i = 0; i < 8; i++)
        corners[i] = rt_vec3((i & 1 ? hi : lo).x, (i & 2 ? hi : lo).y, (i & 4 ? hi : lo).z);
    corners[8] = corners[3];
    corners[9] = rt_vec3(0, 2.3f, 100.5f); /* inside */
    uint32_t box, hull;
    assert_ok(rt_solid_add_box(&set, lo, hi, &box, error));
    assert_ok(rt_solid_add_hull(&set, corners, 10, &hull, error));
    assert_int_equal(set.solids[hull].count, 6);
    RtBox own = {lo, hi};
    assert_memory_equal(&set.solids[hull].box, &own, sizeof own);
    for (int i = 0; i < 1000; i++) {
        RtRay ray = make_ray(rt_random_point(&random, 2), rt_vec3(0, 0, 0));
        ray.dir = rt_sub(corners[i % 10], ray.org);
        List a = cross(&set, box, &ray), b = cross(&set, hull, &ray);
        assert_same_places(&a, &b, &ray);
    }
    rt_solid_set_clear(&set);
}

/* Of the plane of each three points with all others on one side: a definition, not the search. */
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

static void hulls_of_random_points_hold_what_is_between_them(void **state) {
    (void)state;
    RtRandom random = rt_random(5, 0);
    for (int round = 0; round < 30; round++) {
        RtSolidSet set = {0};
        RtVec3 points[12];
        uint32_t count = 4 + (uint32_t)round % 9, hull;
        for (uint32_t i = 0; i < count; i++) points[i] = rt_random_point(&random, 10);
        assert_ok(rt_solid_add_hull(&set, points, count, &hull, error));
        RtBox box = RT_EMPTY_BOX;
        for (uint32_t i = 0; i < count; i++) box = rt_box_add_point(box, points[i]);
        assert_true(rt_box_contains(set.solids[hull].box, box));
        assert_true(rt_box_contains(rt_box_widened(box, 1e-5), set.solids[hull].box));
        for (int i = 0; i < 40; i++) {
            RtRay ray = make_ray(rt_random_point(&random, 10), rt_narrow(rt_random_direction(&random)));
            List list = cross(&set, hull, &ray);
            bool inside = list.count == 2 && list.at[0].t < 0 && list.at[1].t > 0;
            Point p = {(long double)ray.org.x, (long double)ray.org.y, (long double)ray.org.z};
            assert_true(inside == is_inside_hull(points, count, p, 1e-5L));
        }
        rt_solid_set_clear(&set);
    }
}

/* ---- extents ---- */

static void check_extents(const RtSolidSet *set, const Model *model, RtRandom *random) {
    const RtSolid *solid = &set->solids[model->index];
    RtBall ball = rt_solid_ball(set, model->index);
    RtVec3d up = rt_random_direction(random);
    double support = rt_solid_support(set, model->index, up), most = -INFINITY;
    for (int i = 0; i < 400; i++) {
        RtRay ray = random_ray(model, random, random_target(model, random), 3);
        List list = cross(set, model->index, &ray);
        for (uint32_t k = 0; k < list.count; k++) {
            if (isinf(list.at[k].t)) continue;
            RtVec3d p = rt_ray_point(&ray, list.at[k].t);
            double noise = 1e-6 * rt_lengthd(rt_widen(rt_vec3((float)p.x, (float)p.y, (float)p.z))) +
                           2 * ulp_at(model, &ray, (double)list.at[k].t) / stretch_of(model);
            most = fmax(most, rt_dotd(p, up));
            assert_true(rt_dotd(p, up) <= support + noise);
            assert_true(rt_lengthd(rt_subd(p, ball.center)) <= ball.radius + noise);
            for (int a = 0; a < 3; a++) {
                assert_true(p.at[a] >= (double)solid->box.lo.at[a] - noise);
                assert_true(p.at[a] <= (double)solid->box.hi.at[a] + noise);
            }
        }
    }
    double size = 0;
    for (int a = 0; a < 3; a++) size += fabs(model->place.m[a][0]) + fabs(model->place.m[a][1]);
    if (isfinite(support)) assert_true(most > support - 0.5 * size);
}

static void extents_hold_every_crossing(void **state) {
    (void)state;
    RtRandom random = rt_random(6, 0);
    for (int round = 0; round < 30; round++) {
        RtTransform place = rt_transform_identity();
        RtVec3 factors = rt_vec3(2, rt_random_between(&random, 0.5f, 3), rt_random_between(&random, 0.5f, 3));
        assert_ok(rt_transform_scale(&place, factors, error));
        assert_ok(rt_transform_rotate(&place, rt_narrow(rt_random_direction(&random)), 77, error));
        assert_ok(rt_transform_translate(&place, rt_random_point(&random, 10), error));
        RtSolidSet set = {0};
        Model models[MODELS];
        add_models(&set, &place, models);
        for (int i = 0; i < MODELS; i++) check_extents(&set, &models[i], &random);
        rt_solid_set_clear(&set);
    }
}

static void extents_are_tight_where_they_can_be_known(void **state) {
    (void)state;
    RtSolidSet set = {0};
    uint32_t at;
    RtVec3d aslant = {{3, 0, 4}};
    assert_ok(rt_solid_add_ellipsoid(&set, rt_vec3(1, 2, 3), rt_vec3(2, 2, 2), &at, error));
    assert_near(rt_solid_ball(&set, at).radius, 2, 1e-8);
    assert_near(rt_solid_support(&set, at, aslant), 15 + 10, 1e-12);
    assert_ok(rt_solid_add_ellipsoid(&set, rt_vec3(1, 2, 3), rt_vec3(1, 4, 2), &at, error));
    assert_near(rt_solid_ball(&set, at).radius, 4, 1e-8);
    assert_ok(rt_solid_add_frustum(&set, rt_vec3(0, 0, 0), 3, rt_vec3(0, 0, 8), 3, &at, error));
    assert_near(rt_solid_ball(&set, at).radius, 5, 1e-8);
    assert_near(rt_solid_ball(&set, at).center.z, 4, 1e-8);
    assert_near(rt_solid_support(&set, at, aslant), 9 + 32, 1e-12);
    assert_ok(rt_solid_add_frustum(&set, rt_vec3(0, 0, 0), 9, rt_vec3(0, 0, 1), 3, &at, error));
    assert_near(rt_solid_ball(&set, at).radius, 9, 1e-7);
    assert_ok(rt_solid_add_ring(&set, rt_vec3(0, 0, 0), rt_vec3(0, 1, 0), 3, 1, &at, error));
    assert_near(rt_solid_ball(&set, at).radius, 4, 1e-8);
    assert_near(rt_solid_support(&set, at, rt_vec3d(0, 1, 0)), 1, 1e-12);
    assert_near(rt_solid_support(&set, at, aslant), 20, 1e-12);
    assert_ok(rt_solid_add_box(&set, rt_vec3(-1, -2, -2), rt_vec3(1, 2, 2), &at, error));
    assert_near(rt_solid_ball(&set, at).radius, 3, 1e-8);
    assert_near(rt_solid_support(&set, at, aslant), 11, 1e-8);
    rt_solid_set_clear(&set);
}

static void what_has_no_end_has_extents_without_end(void **state) {
    (void)state;
    RtSolidSet set = {0};
    uint32_t half, oblique, slab, wedge;
    RtTransform here = rt_transform_identity();
    RtPlane slab_planes[2] = {{{{0, 1, 0}}, 3}, {{{0, -1, 0}}, -2}},
            wedge_planes_too[2] = {{{{1, 0, 0}}, 3}, {{{0, 1, 0}}, 5}};
    assert_ok(rt_solid_add_half_space(&set, rt_vec3(0, 0, 7), rt_vec3(0, 0, 1), &half, error));
    assert_ok(rt_solid_add_half_space(&set, rt_vec3(0, 0, 7), rt_vec3(1, 1, 1), &oblique, error));
    assert_ok(rt_solid_add_polyhedron(&set, slab_planes, 2, &here, &slab, error));
    assert_ok(rt_solid_add_polyhedron(&set, wedge_planes_too, 2, &here, &wedge, error));
    const float none = INFINITY;
    const RtBox boxes[4] = {{{{-none, -none, -none}}, {{none, none, 7}}},
                            {{{-none, -none, -none}}, {{none, none, none}}},
                            {{{-none, 2, -none}}, {{none, 3, none}}},
                            {{{-none, -none, -none}}, {{3, 5, none}}}};
    for (uint32_t i = 0; i < 4; i++) {
        assert_memory_equal(&set.solids[i].box, &boxes[i], sizeof(RtBox));
        assert_true(isinf(rt_solid_ball(&set, i).radius));
    }
    assert_near(rt_solid_support(&set, oblique, rt_vec3d(2, 2, 2)), 14, 1e-9);
    assert_true(isinf(rt_solid_support(&set, oblique, rt_vec3d(-1, -1, -1))));
    assert_near(rt_solid_support(&set, wedge, rt_vec3d(1, 2, 0)), 13, 1e-9);
    assert_true(isinf(rt_solid_support(&set, wedge, rt_vec3d(1, 2, 0.1))));
    rt_solid_set_clear(&set);
}

/* ---- normals ---- */

/* Along the way on which membership grows fastest. */
static void normals_point_out(void **state) {
    (void)state;
    RtRandom random = rt_random(7, 0);
    RtTransform place = rt_transform_identity();
    assert_ok(rt_transform_scale(&place, rt_vec3(1, 2, 3), error));
    assert_ok(rt_transform_rotate(&place, rt_vec3(1, 2, 3), 50, error));
    assert_ok(rt_transform_translate(&place, rt_vec3(5, 6, 7), error));
    RtSolidSet set = {0};
    Model models[MODELS];
    add_models(&set, &place, models);
    for (int i = 0; i < MODELS; i++) {
        if (models[i].ratio == 1e-4) continue; /* as thin as the steps below are long */
        uint32_t wrong = 0, asked = 0;
        for (int k = 0; k < 500; k++) {
            RtRay ray = random_ray(&models[i], &random, random_target(&models[i], &random), 3);
            List list = cross(&set, models[i].index, &ray);
            for (uint32_t c = 0; c < list.count; c++) {
                if (isinf(list.at[c].t)) continue;
                RtVec3d p = rt_ray_point(&ray, list.at[c].t), gradient;
                RtVec3d n = rt_solid_normal(&set, models[i].index, list.at[c].face, p);
                assert_near(rt_lengthd(n), 1, 1e-12);
                for (int a = 0; a < 3; a++) {
                    RtRay probe = make_ray(rt_narrow(p), rt_vec3(a == 0, a == 1, a == 2));
                    gradient.at[a] =
                        (double)(value_at(&models[i], &probe, 1e-3L) - value_at(&models[i], &probe, -1e-3L));
                }
                asked++;
                wrong += rt_dotd(rt_normalized(gradient), n) < 0.999; /* so it is at an edge */
            }
        }
        if (wrong * 50 > asked || asked == 0) fail_msg("%s: %u of %u normals", models[i].name, wrong, asked);
    }
    rt_solid_set_clear(&set);
}

/* ---- refusals ---- */

static void expect(RtStatus status, const RtError *error, const char *words) {
    assert_int_equal(status, RT_BAD_INPUT);
    if (!strstr(error->message, words)) fail_msg("'%s' does not say '%s'", error->message, words);
}

static void bad_solids_are_refused_and_leave_nothing(void **state) {
    (void)state;
    RtSolidSet set = {0};
    RtError e;
    uint32_t at;
    RtTransform here = rt_transform_identity(), flat = here, endless = here, far = here;
    flat.m[2][2] = 0;
    endless.m[0][3] = INFINITY;
    far.m[0][3] = 1e18;
    RtPlane planes[3] = {{{{1, 0, 0}}, 0}, {{{-1, 0, 0}}, -1}, {{{0, 0, 0}}, 1}};
    RtVec3 zero = {{0, 0, 0}}, one = {{1, 1, 1}},
           corners[5] = {{{0, 0, 0}}, {{1, 0, 0}}, {{0, 1, 0}}, {{1, 1, 0}}, {{3, 1, 0}}};
    RtTriangle triangles[12];
    uint32_t count = cube_mesh(triangles);

    expect(rt_solid_add_sphere(&set, &flat, &at, &e), &e, "flat");
    expect(rt_solid_add_sphere(&set, &endless, &at, &e), &e, "finite");
    expect(rt_solid_add_sphere(&set, &far, &at, &e), &e, "scale it down");
    expect(rt_solid_add_cone(&set, 1.5, &here, &at, &e), &e, "from 0 to 1");
    expect(rt_solid_add_torus(&set, 1, &here, &at, &e), &e, "below 1");
    expect(rt_solid_add_torus(&set, (double)NAN, &here, &at, &e), &e, "below 1");
    expect(rt_solid_add_polyhedron(&set, planes, 0, &here, &at, &e), &e, "from 1 to");
    expect(rt_solid_add_polyhedron(&set, planes, 2, &here, &at, &e), &e, "no inside");
    expect(rt_solid_add_polyhedron(&set, planes, 3, &here, &at, &e), &e, "plane 2");
    planes[1].offset = 0;
    expect(rt_solid_add_polyhedron(&set, planes, 2, &here, &at, &e), &e, "no inside");
    RtPlane sheet[2] = {{{{1, 2, 2}}, 3}, {{{-1, -2, -2}}, -3 + 1e-13}};
    expect(rt_solid_add_polyhedron(&set, sheet, 2, &here, &at, &e), &e, "no inside");
    expect(rt_solid_add_box(&set, one, zero, &at, &e), &e, "lo < hi");
    expect(rt_solid_add_half_space(&set, one, zero, &at, &e), &e, "normal not 0");
    expect(rt_solid_add_ellipsoid(&set, one, zero, &at, &e), &e, "above 0");
    expect(rt_solid_add_frustum(&set, zero, 0, one, 0, &at, &e), &e, "above 0");
    expect(rt_solid_add_frustum(&set, one, 1, one, 1, &at, &e), &e, "same point");
    expect(rt_solid_add_ring(&set, zero, one, 1, 1, &at, &e), &e, "minor < major");
    expect(rt_solid_add_ring(&set, zero, zero, 2, 1, &at, &e), &e, "length 0");
    expect(rt_solid_add_hull(&set, corners, 3, &at, &e), &e, "from 4 to");
    expect(rt_solid_add_hull(&set, corners, 5, &at, &e), &e, "one plane");
    expect(rt_solid_add_mesh(&set, triangles, 3, &here, &at, &e), &e, "4 triangles");
    expect(rt_solid_add_mesh(&set, triangles, count - 1, &here, &at, &e), &e, "not closed");
    for (uint32_t i = 0; i < count; i++) {
        RtVec3 kept = triangles[i].v[1];
        triangles[i].v[1] = triangles[i].v[2], triangles[i].v[2] = kept;
        if (i == 0) expect(rt_solid_add_mesh(&set, triangles, count, &here, &at, &e), &e, "not closed");
    }
    expect(rt_solid_add_mesh(&set, triangles, count, &here, &at, &e), &e, "inside out");
    triangles[3].v[0].y = NAN;
    expect(rt_solid_add_mesh(&set, triangles, count, &here, &at, &e), &e, "triangle 3");
    assert_int_equal(set.solid_count + set.plane_count + set.triangle_count, 0);
    rt_solid_set_clear(&set);
}

static RtStatus add_one_of_each(RtSolidSet *set, uint32_t i, uint32_t *at, RtError *error) {
    RtTransform here = rt_transform_identity();
    RtTriangle triangles[12];
    static const RtVec3 corners[4] = {{{0, 0, 0}}, {{1, 0, 0}}, {{0, 1, 0}}, {{0, 0, 1}}};
    switch (i) {
    case 0: return rt_solid_add_sphere(set, &here, at, error);
    case 1: return rt_solid_add_cone(set, 0.5, &here, at, error);
    case 2: return rt_solid_add_torus(set, 0.5, &here, at, error);
    case 3: return rt_solid_add_hull(set, corners, 4, at, error);
    case 4: return rt_solid_add_mesh(set, triangles, cube_mesh(triangles), &here, at, error);
    default: return rt_solid_add_moved(set, set, i - 5, &here, at, error);
    }
}

static void without_memory_nothing_is_added(void **state) {
    (void)state;
    int64_t before = rt_alloc_live();
    RtSolidSet set = {0};
    RtError e;
    for (uint32_t i = 0; i < 10; i++) {
        for (uint64_t n = 1;; n++) {
            RtSolidSet kept = set;
            uint32_t at;
            rt_alloc_fail_at(n);
            RtStatus status = add_one_of_each(&set, i, &at, &e);
            rt_alloc_fail_at(0);
            if (status == RT_OK) break;
            assert_int_equal(status, RT_NO_MEMORY);
            assert_int_equal(set.solid_count, kept.solid_count);
            assert_int_equal(set.plane_count, kept.plane_count);
            assert_int_equal(set.triangle_count, kept.triangle_count);
        }
        assert_int_equal(set.solid_count, i + 1);
    }
    assert_true(rt_solid_set_bytes(&set) > 10 * sizeof(RtSolid));
    rt_solid_set_clear(&set);
    assert_int_equal(rt_alloc_live(), before);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(random_lines_are_inside_where_their_points_are),
        cmocka_unit_test(so_they_are_where_solids_are_turned_stretched_and_moved),
        cmocka_unit_test(crossings_are_the_float32_nearest_to_the_truth),
        cmocka_unit_test(a_box_has_no_skin),
        cmocka_unit_test(a_half_space_has_no_end),
        cmocka_unit_test(a_sphere_that_is_touched_is_not_crossed),
        cmocka_unit_test(a_full_cone_ends_in_its_apex),
        cmocka_unit_test(a_cylinder_is_entered_by_cap_or_side),
        cmocka_unit_test(a_torus_has_a_hole),
        cmocka_unit_test(a_cube_of_triangles_is_a_box_even_at_edges_and_corners),
        cmocka_unit_test(a_mesh_may_overlap_and_touch_itself_and_be_hollow),
        cmocka_unit_test(lines_along_edges_and_faces_of_a_turned_mesh_keep_to_it),
        cmocka_unit_test(a_triangle_without_area_does_no_harm),
        cmocka_unit_test(faces_in_one_plane_are_met_at_the_same_bits),
        cmocka_unit_test(faces_along_an_axis_are_where_float32_has_them),
        cmocka_unit_test(the_hull_of_the_corners_of_a_box_is_the_box),
        cmocka_unit_test(hulls_of_random_points_hold_what_is_between_them),
        cmocka_unit_test(extents_hold_every_crossing),
        cmocka_unit_test(extents_are_tight_where_they_can_be_known),
        cmocka_unit_test(what_has_no_end_has_extents_without_end),
        cmocka_unit_test(normals_point_out),
        cmocka_unit_test(bad_solids_are_refused_and_leave_nothing),
        cmocka_unit_test(without_memory_nothing_is_added),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
