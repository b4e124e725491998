/* SPDX-License-Identifier: Apache-2.0 */
/* Trees against points. Whether a point is inside follows from the formula and the definition of each
 * solid, in long double and with other arithmetic than that of rays: quadratic and quartic forms,
 * half-spaces, solid angles. Along random rays, points are taken on either side of every hit and midway
 * between hits; the rays must agree with them. RAYTALLY_CSG_RAYS sets the number of rays. */
#include "csg_testing.h"
#include "scene_testing.h"

#include "core/scene/formula.h"

typedef long double Real;

typedef struct Point {
    Real at[3];
} Point;

/* Unsure: so near to a surface that long double cannot decide, or the solid's own numbers are rounded. */
typedef enum Side { OUTSIDE, UNSURE, INSIDE } Side;

#define NEAR 1e-10L

/* From a form that is negative inside. */
static Side side_of(Real form) {
    return form < -NEAR ? INSIDE : form > NEAR ? OUTSIDE : UNSURE;
}

static Side both(Side a, Side b) {
    return a < b ? a : b;
}

/* ---- solids ---- */

static Real determinant(const Real a[3], const Real b[3], const Real c[3]) {
    return a[0] * (b[1] * c[2] - b[2] * c[1]) - a[1] * (b[0] * c[2] - b[2] * c[0]) +
           a[2] * (b[0] * c[1] - b[1] * c[0]);
}

/* By Cramer's rule. */
static Point in_standard_coordinates(const RtTransform *place, Point p) {
    Real columns[3][3], from[3], whole;
    for (int row = 0; row < 3; row++) {
        for (int i = 0; i < 3; i++) columns[i][row] = (Real)place->m[row][i];
        from[row] = p.at[row] - (Real)place->m[row][3];
    }
    whole = determinant(columns[0], columns[1], columns[2]);
    return (Point){{determinant(from, columns[1], columns[2]) / whole,
                    determinant(columns[0], from, columns[2]) / whole,
                    determinant(columns[0], columns[1], from) / whole}};
}

static Side side_of_planes(const RtSolidSet *set, const RtSolid *solid, Point p) {
    Side side = INSIDE;
    for (uint32_t i = 0; i < solid->count; i++) {
        const RtPlane *plane = &set->planes[solid->first + i];
        Real height = -(Real)plane->offset;
        for (int a = 0; a < 3; a++) height += (Real)plane->normal.at[a] * p.at[a];
        side = both(side, side_of(height));
    }
    return side;
}

/* The solid angles of the triangles, seen from the point, add up to 4 pi inside (Van Oosterom & Strackee
 * 1983). */
static Side side_of_mesh(const RtSolidSet *set, const RtSolid *solid, Point p) {
    Real sum = 0;
    for (uint32_t i = 0; i < solid->count; i++) {
        Real v[3][3], length[3], dots = 0;
        for (int k = 0; k < 3; k++) {
            length[k] = 0;
            for (int a = 0; a < 3; a++) {
                v[k][a] = (Real)set->triangles[solid->first + i].v[k].at[a] - p.at[a];
                length[k] += v[k][a] * v[k][a];
            }
            length[k] = sqrtl(length[k]);
        }
        for (int k = 0; k < 3; k++) {
            const Real *a = v[(k + 1) % 3], *b = v[(k + 2) % 3];
            dots += (a[0] * b[0] + a[1] * b[1] + a[2] * b[2]) * length[k];
        }
        Real volume = determinant(v[0], v[1], v[2]), rest = length[0] * length[1] * length[2] + dots;
        if (fabsl(volume) < NEAR && rest < NEAR) return UNSURE; /* in the triangle, or on its edge */
        sum += 2 * atan2l(volume, rest);
    }
    return sum > 6 ? INSIDE : OUTSIDE;
}

static Side side_of_solid(const RtSolidSet *set, uint32_t index, Point p) {
    const RtSolid *solid = &set->solids[index];
    Point q = in_standard_coordinates(&solid->to_world, p);
    Real x = q.at[0], y = q.at[1], z = q.at[2], across = x * x + y * y, ratio = (Real)solid->ratio;
    switch (solid->kind) {
    case RT_SOLID_SPHERE: return side_of(across + z * z - 1);
    case RT_SOLID_CONE: {
        Real radius = 1 + (ratio - 1) * z;
        Side side = both(side_of_planes(set, solid, p), side_of(across - radius * radius));
        return ratio > 0 ? side : both(side, side_of(z - 1)); /* not the other half of a full cone */
    }
    case RT_SOLID_TORUS: {
        Real out = sqrtl(across) - 1;
        return side_of(out * out + z * z - ratio * ratio);
    }
    case RT_SOLID_POLYHEDRON: return side_of_planes(set, solid, p);
    case RT_SOLID_MESH: return side_of_mesh(set, solid, p);
    case RT_SOLID_KIND_COUNT: break;
    }
    return UNSURE;
}

/* ---- trees ---- */

/* The formula of a compiled tree: its solids are the uses of solids in the term, in the order of the text. */
typedef struct Formula {
    const RtCsgBuilder *builder;
    const RtSolidSet *set;
    uint32_t next; /* solid */
} Formula;

static Side side_of_term(Formula *f, RtCsgTerm term, Point p) {
    const RtCsgNode *node = &f->builder->nodes[term];
    if (node->kind == RT_CSG_SOLID) return side_of_solid(f->set, f->next++, p);
    Side left = side_of_term(f, node->left, p);
    if (node->kind == RT_CSG_MOVE) return left;
    Side right = side_of_term(f, node->right, p);
    switch (node->op) {
    case RT_CSG_UNION: return left > right ? left : right;
    case RT_CSG_INTERSECTION: return both(left, right);
    case RT_CSG_DIFFERENCE: break;
    }
    return both(left, (Side)(INSIDE - right));
}

typedef struct Model {
    RtCsgBuilder builder;
    RtCsgForest forest;
    RtCsgTerm root;
    RtCsg tree;
} Model;

static Side side_of_tree(const Model *m, const RtRay *ray, Real t) {
    Formula formula = {&m->builder, &m->forest.set, m->tree.first_solid};
    Point p;
    for (int a = 0; a < 3; a++) p.at[a] = (Real)ray->org.at[a] + t * (Real)ray->dir.at[a];
    return side_of_term(&formula, m->root, p);
}

/* ---- rays ---- */

typedef struct Score {
    uint64_t rays, points, unsure, wrong;
} Score;

static void check_point(const Model *m, const RtRay *ray, Real t, bool inside, Score *score) {
    Side side = side_of_tree(m, ray, t);
    score->points++;
    score->unsure += side == UNSURE;
    if (side == UNSURE || (side == INSIDE) == inside) return;
    if (score->wrong++ > 10) return;
    print_error("org (%.9g, %.9g, %.9g) dir (%.9g, %.9g, %.9g): at t = %.12Lg the point is %s\n",
                (double)ray->org.x, (double)ray->org.y, (double)ray->org.z, (double)ray->dir.x,
                (double)ray->dir.y, (double)ray->dir.z, t, inside ? "outside" : "inside");
}

/* Room for the rounding of t, and of the ray at t near 0. */
static Real beside(const RtRay *ray, float t) {
    Real length = (Real)rt_lengthd(rt_widen(ray->dir));
    return 2 * ((Real)nextafterf(t, INFINITY) - (Real)t) + 1e-8L / length;
}

/* Unit normals point out: against the ray where it enters. */
static void check_normal(const Model *m, const RtRay *ray, float t, bool enters, Score *score) {
    RtVec3d dir = rt_normalized(rt_widen(ray->dir));
    double cosine = rt_dotd(facet_at(&m->forest, &m->tree, ray, t).normal, dir);
    if (fabs(cosine) < 1e-6 || (cosine < 0) == enters) return;
    if (score->wrong++ > 10) return;
    print_error("at t = %.9g the normal is turned round\n", (double)t);
}

static void check_ray(const Model *m, const RtRay *ray, Score *score) {
    Hits hits = hits_of(&m->forest, &m->tree, ray);
    score->rays++;
    Real done = 0; /* up to here points were asked, or cannot be */
    for (uint32_t i = 0; i <= hits.count; i++) {
        bool inside = (hits.count - i) % 2, last = i == hits.count;
        Real next = last ? done + 1 : (Real)hits.t[i] - beside(ray, hits.t[i]);
        if (next > done) {
            check_point(m, ray, done, inside, score);
            check_point(m, ray, (done + next) / 2, inside, score);
            check_point(m, ray, next, inside, score);
        }
        if (last) break;
        check_normal(m, ray, hits.t[i], !inside, score);
        done = fmaxl(done, (Real)hits.t[i] + beside(ray, hits.t[i]));
    }
}

static uint64_t rays_asked(void) {
    const char *asked = getenv("RAYTALLY_CSG_RAYS");
    return asked ? strtoull(asked, NULL, 10) : 100000;
}

static void report(const char *what, const Score *score) {
    printf("%s: %llu rays, %llu points, %llu unsure, %llu wrong\n", what, (unsigned long long)score->rays,
           (unsigned long long)score->points, (unsigned long long)score->unsure,
           (unsigned long long)score->wrong);
    assert_int_equal(score->wrong, 0);
    assert_true(score->unsure < score->points / 50);
}

RT_TEST(rays_are_right_about_points) {
    uint64_t rays = rays_asked();
    RtRandom random = rt_random(21, 0);
    Score score = {0};
    for (uint32_t round = 0; score.rays < rays; round++) {
        Model m = {.root = 0};
        m.root = random_term(&m.builder, &random, round % 8 == 0 ? 1 : 16, round % 2);
        m.tree = compile(&m.forest, &m.builder, m.root);
        for (uint32_t i = 0; i < 250; i++) {
            RtRay ray = tree_ray(&random, i);
            check_ray(&m, &ray, &score);
        }
        rt_csg_forest_clear(&m.forest);
        rt_csg_builder_clear(&m.builder);
    }
    report("random trees", &score);
}

/* ---- the trees of scenes ---- */

typedef struct Copier {
    RtCsgBuilder *builder;
    const RtCsgForest *forest;
} Copier;

static RtStatus copy_solid(void *context, const char *name, RtCsgTerm *term, RtError *error) {
    Copier *c = context;
    uint32_t from = (uint32_t)strtoul(name + 1, NULL, 10), index;
    RT_TRY(rt_solid_add_moved(&c->builder->set, &c->forest->set, from, NULL, &index, error));
    return rt_csg_solid(c->builder, index, 0, term, error);
}

/* Rays through the ball about a tree, as its formula is written. */
static void check_tree(const RtCsgForest *forest, const RtCsg *tree, uint64_t rays, RtRandom *random,
                       Score *score) {
    Model m = {.forest = *forest, .tree = *tree};
    Copier copier = {&m.builder, forest};
    char *formula;
    assert_ok(rt_formula_write(forest, tree, 0, &formula, error));
    assert_ok(rt_formula_read(formula, &m.builder, copy_solid, &copier, &m.root, error));
    for (uint64_t i = 0; i < rays; i++) {
        RtRay ray = rt_sphere_chord(&tree->ball, random);
        check_ray(&m, &ray, score);
    }
    rt_free(formula);
    rt_csg_builder_clear(&m.builder);
}

RT_TEST(rays_are_right_about_the_trees_of_scenes) {
    const char *names[] = {"scenes/csg-lecture.yaml", "scenes/csg-bracket.yaml", "scenes/chess.yaml",
                           "csg-field:n=27"};
    RtRandom random = rt_random(22, 0);
    for (size_t i = 0; i < sizeof names / sizeof *names; i++) {
        OWNED_SCENE scene = open_scene(names[i]);
        Score score = {0};
        const RtGeometry *g = &scene.geometry;
        for (uint32_t k = 0; k < g->csg_count; k++)
            check_tree(&g->forest, &g->csgs[k], rays_asked() / 4 / g->csg_count, &random, &score);
        report(names[i], &score);
    }
}

RT_TESTS(csg_points, NULL, NULL)
