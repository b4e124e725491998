/* SPDX-License-Identifier: Apache-2.0 */
/* Shared by tests of solids: lines and their lists of crossings, and models of every kind of solid with
 * membership of points in long double, which shares no code with spans; and the comparison of the two. */
#ifndef RT_TESTS_SOLIDS_TESTING_H
#define RT_TESTS_SOLIDS_TESTING_H

#include "crossings_testing.h"
#include "random_testing.h"
#include "testing.h"

#include <float.h>

/* ---- lines ---- */

static inline void assert_near(double value, double expected, double slack) {
    if (fabs(value - expected) > slack) fail_msg("%.17g is not %.17g", value, expected);
}

enum { MOST = 512 };

typedef struct List {
    RtCrossing at[MOST];
    uint32_t count;
    float near, far;
} List;

/* The crossings as a tree would compute them, with the invariants of every list. */
static inline List cross(const RtSolidSet *set, uint32_t index, const RtRay *ray) {
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

static inline long double most_of(long double a, long double b) {
    return a > b ? a : b;
}

static inline long double in_ball(Point p, double ratio) {
    (void)ratio;
    return sqrtl(p.x * p.x + p.y * p.y + p.z * p.z) - 1;
}

static inline long double in_cone(Point p, double ratio) {
    long double slope = 1 - (long double)ratio;
    long double side = (sqrtl(p.x * p.x + p.y * p.y) - 1 + slope * p.z) / sqrtl(1 + slope * slope);
    return most_of(side, most_of(-p.z, p.z - 1));
}

static inline long double in_torus(Point p, double ratio) {
    long double w = sqrtl(p.x * p.x + p.y * p.y) - 1;
    return sqrtl(w * w + p.z * p.z) - (long double)ratio;
}

static inline long double in_box(Point p, double ratio) {
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

static inline long double in_half_space(Point p, double ratio) {
    (void)ratio;
    return (p.x + 2 * p.y + 2 * p.z - 1) / 3;
}

static inline long double in_wedge(Point p, double ratio) {
    return most_of(in_half_space(p, ratio), (2 * p.x - 2 * p.y - p.z - 3) / 3);
}

/* The cube of in_box without the quarter where x and y are above 0. */
static inline long double in_notched_cube(Point p, double ratio) {
    return most_of(in_box(p, ratio), p.x < p.y ? p.x : p.y);
}

typedef long double (*Membership)(Point p, double ratio);

/* ---- meshes ---- */

/* A prism over a polygon, counter-clockwise in the xy plane, from z = -1 to 1: its top and bottom are cut
 * into the given triangles of its corners. */
static inline uint32_t prism(const float (*corners)[2], uint32_t count, const uint32_t (*top)[3],
                             uint32_t top_count, RtTriangle *out) {
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

static inline uint32_t cube_mesh(RtTriangle out[12]) {
    static const float corners[4][2] = {{-1, -1}, {1, -1}, {1, 1}, {-1, 1}};
    static const uint32_t top[2][3] = {{0, 1, 2}, {0, 2, 3}};
    return prism(corners, 4, top, 2, out);
}

static inline uint32_t notched_cube_mesh(RtTriangle out[20]) {
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
static inline void invert(const RtTransform *place, long double back[3][3]) {
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

static inline long double value_at(const Model *model, const RtRay *ray, long double t) {
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
static inline double stretch_of(const Model *model) {
    double sum = 0;
    for (int a = 0; a < 3; a++) {
        for (int b = 0; b < 3; b++) sum += fabs((double)model->back[a][b]);
    }
    return sum;
}

/* How much of a standard unit value_at may be off: where origins are far and maps uneven. */
static inline double noise_at(const Model *model, const RtRay *ray, double t) {
    double reach = 0;
    for (int a = 0; a < 3; a++)
        reach += fabs((double)ray->org.at[a]) + fabs(t * (double)ray->dir.at[a]) + fabs(model->place.m[a][3]);
    return model->rounding * (reach * stretch_of(model) + 3);
}

enum { MODELS = 12 };

/* One of each kind and more, placed by `place`. */
static inline void add_models(RtSolidSet *set, const RtTransform *place, Model models[MODELS]) {
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

#define OWNED_MODELS(set, models, place)                                                                     \
    OWNED_SOLIDS set = {0};                                                                                  \
    Model models[MODELS];                                                                                    \
    add_models(&(set), place, models)

/* ---- lists against membership ---- */

static inline const char *describe(const Model *model, const RtRay *ray) {
    static char text[512];
    snprintf(text, sizeof text, "%s, from (%a, %a, %a) along (%a, %a, %a)", model->name, (double)ray->org.x,
             (double)ray->org.y, (double)ray->org.z, (double)ray->dir.x, (double)ray->dir.y,
             (double)ray->dir.z);
    return text;
}

/* The length of an ulp of t in standard coordinates, at most. */
static inline double ulp_at(const Model *model, const RtRay *ray, double t) {
    return fabs(t) * 0x1p-23 * rt_lengthd(rt_widen(ray->dir)) * stretch_of(model);
}

/* The list and membership say the same at t, unless the surface is within rounding, or within `slack`. */
static inline void check_at(const Model *model, const RtRay *ray, const List *list, double t, double slack) {
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
static inline List check_line(const Model *model, const RtSolidSet *set, const RtRay *ray) {
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

/* A point in the standard solid, or not far from it. */
static inline RtVec3d random_target(const Model *model, RtRandom *random) {
    RtVec3d p = rt_widen(rt_random_point(random, 1.1f));
    if (model->inside == in_cone) p.z = rt_random_betweend(random, -0.1, 1.1);
    if (model->inside != in_torus) return p;
    double w = sqrt(p.x * p.x + p.y * p.y);
    RtVec3d circle = {{p.x / w, p.y / w, 0}};
    return rt_add_scaledd(circle, rt_widen(rt_random_point(random, 0.8f)), model->ratio);
}

/* A line near `target`, whose origin is `distance` sizes of the solid away. */
static inline RtRay random_ray(const Model *model, RtRandom *random, RtVec3d target, double distance) {
    RtVec3d from = rt_random_direction(random);
    if (rt_random_unit(random) < 0.25f) from.at[rt_random_below(random, 3)] = 0;
    if (rt_random_unit(random) < 0.5f) from = rt_subd(target, random_target(model, random));
    RtVec3d dir = rt_subd(rt_transform_pointd(&model->place, from),
                          rt_transform_pointd(&model->place, rt_vec3d(0, 0, 0)));
    RtVec3 along = rt_narrow(rt_scaled(dir, (double)rt_random_between(random, 0.1f, 10)));
    double steps = distance / (rt_lengthd(rt_widen(along)) / rt_lengthd(dir));
    RtVec3d org = rt_add_scaledd(rt_transform_pointd(&model->place, target), rt_widen(along), -steps);
    return ray_along(rt_narrow(org), along);
}

#endif
