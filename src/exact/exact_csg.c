/* SPDX-License-Identifier: Apache-2.0 */
/* CSG trees in exact arithmetic. A solid consists of parts with one equation each: a quadric, a half-space
 * or a torus. On a line, the inside of a part alternates at a few roots; a mesh has any number of roots
 * (exact_mesh.c). Parts are joined to solids, and solids to trees, by one stack machine, which merges the
 * two topmost lists of roots. All lists lie one behind another in one array.
 *
 * For margins (margin.h) solids grow by a distance, or shrink if it is below 0; a subtracted solid does the
 * opposite. The result contains all points within the distance of the solid, or none within it of the
 * outside: planes move, a distance in object space is at most the norm of the inverse transform times as
 * long, and of a mesh every place that rounding may take for its surface is added or removed. */
#include "exact/exact_hit.h"

#include "core/base/memory.h"
#include "exact/flat_margin.h"

#include <assert.h>

/* The inside along the line: `before` is its value before all roots, and it changes at each. */
typedef struct List {
    bool before;
    uint32_t first, count;
} List;

/* The parts of a solid need two lists on top of the tree's. */
#define MOST_LISTS (RT_CSG_MAX_LISTS + 2)

typedef struct Machine {
    RtExactArena *arena;
    const RtExactLine *line;
    double grow; /* of a solid that is not subtracted */
    List lists[MOST_LISTS];
    uint32_t depth;
    uint32_t capacity;
    RtRoot *roots; /* [capacity] */
} Machine;

/* ---- lists ---- */

/* Appends a root to the topmost list. */
static RtStatus extend(Machine *m, RtRoot root, RtError *error) {
    List *top = &m->lists[m->depth - 1];
    uint32_t end = top->first + top->count;
    RT_TRY(rt_reserve(&m->roots, &m->capacity, (uint64_t)end + 1, sizeof(RtRoot), error));
    m->roots[end] = root;
    top->count++;
    return RT_OK;
}

static RtStatus push(Machine *m, bool before, const RtSurd *roots, int count, RtError *error) {
    const List *top = m->depth > 0 ? &m->lists[m->depth - 1] : NULL;
    m->lists[m->depth++] = (List){before, top ? top->first + top->count : 0, 0};
    for (int i = 0; i < count; i++) RT_TRY(extend(m, rt_root_of_surd(&roots[i]), error));
    return RT_OK;
}

static bool joined(RtCsgOp op, bool left, bool right) {
    switch (op) {
    case RT_CSG_UNION: return left || right;
    case RT_CSG_INTERSECTION: return left && right;
    case RT_CSG_DIFFERENCE: return left && !right;
    }
    return false;
}

/* Replaces the two topmost lists by the result of `op`. */
static RtStatus apply(Machine *m, RtCsgOp op, bool reversed, RtError *error) {
    List *low = &m->lists[m->depth - 2], *high = &m->lists[m->depth - 1];
    const List *left = reversed ? high : low, *right = reversed ? low : high;
    uint32_t end = high->first + high->count, count = 0, i = 0, k = 0;
    uint64_t size = (uint64_t)end + left->count + right->count;
    RT_TRY(rt_reserve(&m->roots, &m->capacity, size, sizeof(RtRoot), error));
    bool in_left = left->before, in_right = right->before;
    bool before = joined(op, in_left, in_right), inside = before;
    while (i < left->count || k < right->count) {
        const RtRoot *a = &m->roots[left->first + i], *b = &m->roots[right->first + k];
        int order = i == left->count ? 1 : k == right->count ? -1 : rt_root_compare(m->arena, a, b);
        if (order <= 0) in_left = !in_left, i++;
        if (order >= 0) in_right = !in_right, k++;
        if (joined(op, in_left, in_right) == inside) continue;
        inside = !inside;
        m->roots[end + count++] = order <= 0 ? *a : *b;
    }
    for (uint32_t n = 0; n < count; n++) m->roots[low->first + n] = m->roots[end + n];
    *low = (List){before, low->first, count};
    m->depth--;
    return RT_OK;
}

/* ---- parts ---- */

/* Where a t^2 + 2 b t + c < 0. A root without a change of sign does not count. */
static RtStatus push_quadric(Machine *m, RtRational a, RtRational half_b, RtRational c, RtError *error) {
    RtSurd roots[2];
    int count = rt_exact_roots(m->arena, a, half_b, c, roots);
    if (rt_exact_sign(a) != 0) return push(m, rt_exact_sign(a) < 0, roots, count == 2 ? 2 : 0, error);
    return push(m, count == 1 ? rt_exact_sign(half_b) > 0 : rt_exact_sign(c) < 0, roots, count, error);
}

/* Where gap - rate t > 0. */
static RtStatus push_half(Machine *m, RtRational gap, RtRational rate, RtError *error) {
    if (rt_exact_sign(rate) == 0) return push(m, rt_exact_sign(gap) > 0, NULL, 0, error);
    RtSurd at = rt_surd_of(m->arena, rt_exact_div(m->arena, gap, rate));
    return push(m, rt_exact_sign(rate) > 0, &at, 1, error);
}

/* ---- solids ---- */

/* The line in object space, scaled by `unit`, which avoids divisions: the rows of the inverse transform
 * are cross products of columns over the determinant, which is the unit. It is above 0, because flat or
 * inverted solids are rejected (rt_solid_finish). */
typedef struct ObjectLine {
    RtExactVec org, dir;
    RtRational unit;
} ObjectLine;

static ObjectLine to_object_space(RtExactArena *arena, const RtSolid *solid, const RtExactLine *line) {
    RtExactVec columns[4];
    for (int i = 0; i < 4; i++) columns[i] = rt_exact_vec(arena, rt_transform_column(&solid->to_world, i));
    RtExactVec from = rt_exact_vec_sub(arena, line->org, columns[3]);
    ObjectLine out;
    for (int i = 0; i < 3; i++) {
        RtExactVec row = rt_exact_cross(arena, columns[(i + 1) % 3], columns[(i + 2) % 3]);
        if (i == 0) out.unit = rt_exact_dot(arena, columns[0], row);
        out.org.at[i] = rt_exact_dot(arena, row, from);
        out.dir.at[i] = rt_exact_dot(arena, row, line->dir);
    }
    assert(rt_exact_sign(out.unit) > 0);
    return out;
}

/* How far a solid grows in its object space, below 0 if it shrinks. */
static double growth_of(const Machine *m, const RtSolid *solid) {
    double norm = 0, grow = solid->subtracted ? -m->grow : m->grow;
    for (int i = 0; i < 3; i++) norm += rt_dotd(solid->inverse[i], solid->inverse[i]);
    return grow * sqrt(norm);
}

static RtStatus push_nothing(Machine *m, RtError *error) {
    return push(m, false, NULL, 0, error);
}

/* The ball of `radius` about the origin of object space. */
static RtStatus push_ball(Machine *m, const RtSolid *solid, double radius, RtError *error) {
    if (!(radius > 0)) return push_nothing(m, error);
    ObjectLine s = to_object_space(m->arena, solid, m->line);
    RtRational r = rt_exact_mul(m->arena, rt_exact_of(m->arena, radius), s.unit);
    RtRational c = rt_exact_sub(m->arena, rt_exact_dot(m->arena, s.org, s.org), rt_exact_mul(m->arena, r, r));
    return push_quadric(m, rt_exact_dot(m->arena, s.dir, s.dir), rt_exact_dot(m->arena, s.org, s.dir), c,
                        error);
}

/* Where z is between 0 and 1, both moved outward by `grow`. */
static RtStatus cut_caps(Machine *m, const ObjectLine *s, RtRational grow, RtError *error) {
    RtExactArena *arena = m->arena;
    RtRational z = s->org.at[2], dz = s->dir.at[2], top = rt_exact_add(arena, s->unit, grow);
    RT_TRY(push_half(m, rt_exact_add(arena, z, grow), rt_exact_neg(arena, dz), error));
    RT_TRY(apply(m, RT_CSG_INTERSECTION, false, error));
    RT_TRY(push_half(m, rt_exact_sub(arena, top, z), dz, error));
    return apply(m, RT_CSG_INTERSECTION, false, error);
}

/* x^2 + y^2 - R^2 with R = 1 + (ratio - 1) z. Beyond the tip R is negative; there z is outside 0..1, unless
 * the cone shrinks. */
static RtStatus push_cone(Machine *m, const RtSolid *solid, RtError *error) {
    RtExactArena *arena = m->arena;
    ObjectLine s = to_object_space(arena, solid, m->line);
    double growth = growth_of(m, solid), side = solid->ratio - 1;
    RtRational slope = rt_exact_sub(arena, rt_exact_of(arena, solid->ratio), rt_exact_of(arena, 1));
    RtRational wider = rt_exact_of(arena, 1 + growth * sqrt(1 + side * side));
    RtExactVec org = s.org, dir = s.dir;
    org.at[2] =
        rt_exact_add(arena, rt_exact_mul(arena, wider, s.unit), rt_exact_mul(arena, slope, org.at[2]));
    dir.at[2] = rt_exact_mul(arena, slope, dir.at[2]);
    RtExactVec mirrored = dir, turned = org;
    mirrored.at[2] = rt_exact_neg(arena, dir.at[2]);
    turned.at[2] = rt_exact_neg(arena, org.at[2]);
    RT_TRY(push_quadric(m, rt_exact_dot(arena, dir, mirrored), rt_exact_dot(arena, org, mirrored),
                        rt_exact_dot(arena, org, turned), error));
    if (growth < 0) {
        RT_TRY(push_half(m, org.at[2], rt_exact_neg(arena, dir.at[2]), error));
        RT_TRY(apply(m, RT_CSG_INTERSECTION, false, error));
    }
    return cut_caps(m, &s, rt_exact_mul(arena, rt_exact_of(arena, growth), s.unit), error);
}

/* The squared distance of org + t dir from the origin in the first `axes` coordinates: c[0] + c[1] t +
 * c[2] t^2. */
static void squared_distance(RtExactArena *arena, const ObjectLine *s, int axes, RtRational c[3]) {
    for (int i = 0; i < 3; i++) c[i] = rt_exact_of(arena, 0);
    for (int a = 0; a < axes; a++) {
        RtRational cross = rt_exact_mul(arena, s->org.at[a], s->dir.at[a]);
        c[0] = rt_exact_add(arena, c[0], rt_exact_mul(arena, s->org.at[a], s->org.at[a]));
        c[1] = rt_exact_add(arena, c[1], rt_exact_add(arena, cross, cross));
        c[2] = rt_exact_add(arena, c[2], rt_exact_mul(arena, s->dir.at[a], s->dir.at[a]));
    }
}

/* Inside where (x^2 + y^2 + z^2 + 1 - ratio^2)^2 < 4 (x^2 + y^2): see shape/solid_torus.c. */
static RtPolynomial torus_polynomial(RtExactArena *arena, double minor, const ObjectLine *s) {
    RtPolynomial p = {.degree = 4};
    RtRational k[3], w[3], one = rt_exact_of(arena, 1), ratio = rt_exact_of(arena, minor);
    squared_distance(arena, s, 3, k);
    squared_distance(arena, s, 2, w);
    RtRational square = rt_exact_mul(arena, s->unit, s->unit);
    RtRational rest = rt_exact_sub(arena, one, rt_exact_mul(arena, ratio, ratio));
    RtRational four = rt_exact_mul(arena, rt_exact_of(arena, -4), square);
    k[0] = rt_exact_add(arena, k[0], rt_exact_mul(arena, rest, square));
    for (int i = 0; i < 5; i++) {
        p.at[i] = i < 3 ? rt_exact_mul(arena, four, w[i]) : rt_exact_of(arena, 0);
        for (int n = i < 2 ? 0 : i - 2; n <= i && n < 3; n++)
            p.at[i] = rt_exact_add(arena, p.at[i], rt_exact_mul(arena, k[n], k[i - n]));
    }
    return p;
}

/* A root without a change of sign does not count. A torus that grows over its own hole is replaced by a ball
 * around it. */
static RtStatus push_torus(Machine *m, const RtSolid *solid, RtError *error) {
    double minor = solid->ratio + growth_of(m, solid);
    if (minor >= 1) return push_ball(m, solid, 1 + minor, error);
    RT_TRY(push_nothing(m, error));
    if (!(minor > 0)) return RT_OK;
    ObjectLine s = to_object_space(m->arena, solid, m->line);
    RtPolynomial p = torus_polynomial(m->arena, minor, &s);
    RtAlgebraic roots[RT_MAX_DEGREE];
    int count = rt_polynomial_roots(m->arena, &p, roots);
    for (int i = 0; i < count; i++) {
        int before = rt_polynomial_sign(m->arena, &p, roots[i].lo);
        if (before == rt_polynomial_sign(m->arena, &p, roots[i].hi)) continue;
        RT_TRY(extend(m, rt_root_of_algebraic(&roots[i]), error));
    }
    return RT_OK;
}

static RtStatus push_polyhedron(Machine *m, const RtSolid *solid, const RtPlane *planes, RtError *error) {
    RtRational grow = rt_exact_of(m->arena, solid->subtracted ? -m->grow : m->grow);
    for (uint32_t i = 0; i < solid->count; i++) {
        RtExactVec normal = rt_exact_vec(m->arena, planes[i].normal);
        RtRational offset = rt_exact_add(m->arena, rt_exact_of(m->arena, planes[i].offset), grow);
        RtRational gap = rt_exact_sub(m->arena, offset, rt_exact_dot(m->arena, normal, m->line->org));
        RT_TRY(push_half(m, gap, rt_exact_dot(m->arena, normal, m->line->dir), error));
        if (i > 0) RT_TRY(apply(m, RT_CSG_INTERSECTION, false, error));
    }
    return RT_OK;
}

/* Where rounding may take the line to cross the triangle, added to the topmost list, or removed. */
static RtStatus blur(Machine *m, const RtTriangle *triangle, double delta, RtCsgOp op, RtError *error) {
    RtUnitLine line = rt_unit_line(&m->line->wide);
    RtBox box = rt_triangle_box(triangle);
    RtFlatMargin flat = rt_flat_margin(&line, triangle->v, 3, &box, delta);
    if (!flat.possible) return RT_OK;
    /* They may be infinite. */
    double lo = fmax(flat.lo / line.length, -DBL_MAX), hi = fmin(flat.hi / line.length, DBL_MAX);
    const RtSurd ends[2] = {rt_surd_of(m->arena, rt_exact_of(m->arena, lo)),
                            rt_surd_of(m->arena, rt_exact_of(m->arena, hi))};
    RT_TRY(push(m, false, ends, 2, error));
    return apply(m, op, false, error);
}

static RtStatus push_mesh(Machine *m, const RtSolidSet *set, uint32_t index, RtError *error) {
    const RtSolid *solid = &set->solids[index];
    RtRational *roots;
    uint32_t count;
    RT_TRY(rt_exact_mesh_roots(m->arena, set, index, m->line, &roots, &count, error));
    RtStatus status = push_nothing(m, error);
    for (uint32_t i = 0; i < count && status == RT_OK; i++)
        status = extend(m, rt_root_of(m->arena, roots[i]), error);
    rt_free(roots);
    RtCsgOp op = (m->grow > 0) != solid->subtracted ? RT_CSG_UNION : RT_CSG_DIFFERENCE;
    for (uint32_t i = 0; m->grow != 0 && i < solid->count && status == RT_OK; i++)
        status = blur(m, &set->triangles[solid->first + i], fabs(m->grow), op, error);
    return status;
}

static RtStatus push_solid(Machine *m, const RtSolidSet *set, uint32_t index, RtError *error) {
    const RtSolid *solid = &set->solids[index];
    switch (solid->kind) {
    case RT_SOLID_SPHERE: return push_ball(m, solid, 1 + growth_of(m, solid), error);
    case RT_SOLID_CONE: return push_cone(m, solid, error);
    case RT_SOLID_POLYHEDRON: return push_polyhedron(m, solid, set->planes + solid->first, error);
    case RT_SOLID_MESH: return push_mesh(m, set, index, error);
    case RT_SOLID_TORUS: return push_torus(m, solid, error);
    case RT_SOLID_KIND_COUNT: break;
    }
    return RT_OK;
}

/* ---- trees ---- */

/* Runs the whole program, without skipping operands. */
static RtStatus run(Machine *m, const RtCsgForest *forest, const RtCsg *tree, RtError *error) {
    const RtCsgInstruction *program = forest->instructions + tree->first;
    for (uint32_t i = 0; i < tree->count; i++) {
        if (program[i].code == RT_CSG_PUSH) RT_TRY(push_solid(m, &forest->set, program[i].operand, error));
        if (program[i].code == RT_CSG_APPLY)
            RT_TRY(apply(m, (RtCsgOp)program[i].operand, program[i].reversed, error));
    }
    return RT_OK;
}

RtExactResult rt_exact_csg_hit(RtExactArena *arena, const RtCsgForest *forest, const RtCsg *tree,
                               const RtExactLine *line, RtRoot *t) {
    Machine machine = {.arena = arena, .line = line};
    RtError error;
    RtExactResult result = RT_UNDECIDED;
    if (run(&machine, forest, tree, &error) == RT_OK) {
        result = RT_MISSED;
        for (uint32_t i = 0; i < machine.lists[0].count && result == RT_MISSED; i++) {
            *t = machine.roots[i];
            if (rt_exact_counts(arena, line, t)) result = RT_HIT;
        }
    }
    rt_free(machine.roots);
    return result;
}

RtStatus rt_exact_csg_boundaries(const RtCsgForest *forest, const RtCsg *tree, const RtWideRay *line,
                                 double grow, double **at, uint32_t *count, RtError *error) {
    RtExactArena *arena = rt_exact_arena_borrow();
    size_t mark = rt_exact_arena_mark(arena);
    RtExactLine exact = rt_exact_line(arena, line);
    Machine machine = {.arena = arena, .line = &exact, .grow = grow};
    RtStatus status = run(&machine, forest, tree, error);
    *count = status == RT_OK ? machine.lists[0].count : 0;
    *at = rt_alloc(*count, sizeof **at);
    if (status == RT_OK && !*at)
        status = rt_fail_memory(error, "boundaries of a CSG tree", *count * sizeof **at);
    if (!*at) *count = 0;
    for (uint32_t i = 0; i < *count; i++)
        (*at)[i] = (double)rt_root_value(arena, &machine.roots[i], exact.zero);
    rt_free(machine.roots);
    rt_exact_arena_return(arena, mark);
    return status;
}
