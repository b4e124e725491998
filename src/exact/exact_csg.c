/* SPDX-License-Identifier: Apache-2.0 */
/* CSG trees in exact arithmetic. A solid consists of parts: the points at which a polynomial is negative (a
 * quadric, a half-space, a torus), or the inside of a mesh. On a line, the inside of a part alternates at a
 * few roots. Parts are joined to solids, and solids to trees, by one stack machine, which merges the two
 * topmost lists of roots. All lists lie one behind another in one array.
 *
 * For margins (margin.h) solids grow by a distance, or shrink if it is below 0; a subtracted solid does the
 * opposite. The result contains all points within the distance of the solid, or none within it of the
 * outside: planes move, a distance in object space is at most the norm of the inverse transform times as
 * long, and of a mesh every place that rounding may take for its surface is added or removed. */
#include "exact/margin.h"
#include "exact/referee.h"

#include <assert.h>
#include <stdlib.h>

/* The inside along the line: `before` is its value before all roots, and it changes at each. */
typedef struct List {
    bool before;
    uint32_t first, count;
} List;

/* The parts of a solid need two lists on top of the tree's. */
#define MOST_LISTS (RT_CSG_MAX_LISTS + 2)

typedef struct Machine {
    const RtExactLine *line;
    double grow; /* of a solid that is not subtracted */
    List lists[MOST_LISTS];
    uint32_t depth;
    uint32_t capacity;
    RtRoot *roots; /* [capacity] */
} Machine;

/* ---- lists ---- */

/* An empty list. */
static void push(Machine *m, bool before) {
    const List *top = m->depth > 0 ? &m->lists[m->depth - 1] : NULL;
    m->lists[m->depth++] = (List){before, top ? top->first + top->count : 0, 0};
}

/* Appends a root to the topmost list. */
static RtStatus extend(Machine *m, RtRoot root, RtError *error) {
    List *top = &m->lists[m->depth - 1];
    uint32_t end = top->first + top->count;
    RT_TRY(rt_reserve(&m->roots, &m->capacity, (uint64_t)end + 1, sizeof(RtRoot), error));
    m->roots[end] = root;
    top->count++;
    return RT_OK;
}

/* Replaces the two topmost lists by the result of `op`. */
static RtStatus apply(Machine *m, RtCsgOp op, bool reversed, RtError *error) {
    List *low = &m->lists[m->depth - 2], *high = &m->lists[m->depth - 1];
    const List *left = reversed ? high : low, *right = reversed ? low : high;
    uint32_t end = high->first + high->count, count = 0, i = 0, k = 0;
    uint64_t size = (uint64_t)end + left->count + right->count;
    RT_TRY(rt_reserve(&m->roots, &m->capacity, size, sizeof(RtRoot), error));
    bool in_left = left->before, in_right = right->before;
    bool before = rt_csg_joined(op, in_left, in_right), inside = before;
    while (i < left->count || k < right->count) {
        const RtRoot *a = &m->roots[left->first + i], *b = &m->roots[right->first + k];
        int order = i == left->count ? 1 : k == right->count ? -1 : rt_root_compare(a, b);
        if (order <= 0) in_left = !in_left, i++;
        if (order >= 0) in_right = !in_right, k++;
        if (rt_csg_joined(op, in_left, in_right) == inside) continue;
        inside = !inside;
        m->roots[end + count++] = order <= 0 ? *a : *b;
    }
    for (uint32_t n = 0; n < count; n++) m->roots[low->first + n] = m->roots[end + n];
    *low = (List){before, low->first, count};
    m->depth--;
    return RT_OK;
}

/* ---- parts ---- */

/* Where the polynomial is below 0. A root without a change of sign does not count. */
static RtStatus push_negative(Machine *m, RtPolynomial p, RtError *error) {
    RtRoot roots[RT_MAX_DEGREE];
    int count = rt_polynomial_roots(&p, roots);
    /* Before all roots its sign is that of its leading term. */
    push(m, p.degree >= 0 && (rt_exact_sign(p.at[p.degree]) < 0) != (p.degree % 2 == 1));
    for (int i = 0; i < count; i++) {
        if (roots[i].crossed) RT_TRY(extend(m, roots[i], error));
    }
    return RT_OK;
}

/* Where a + b t < 0. */
static RtStatus push_half(Machine *m, RtRational a, RtRational b, RtError *error) {
    return push_negative(m, rt_polynomial(1, (const RtRational[2]){a, b}), error);
}

static RtStatus cut_half(Machine *m, RtRational a, RtRational b, RtError *error) {
    RT_TRY(push_half(m, a, b, error));
    return apply(m, RT_CSG_INTERSECTION, false, error);
}

/* ---- solids ---- */

/* The line in object space, scaled by `unit`, which avoids divisions: the rows of the inverse transform
 * are cross products of columns over the determinant, which is the unit. It is above 0, because flat or
 * inverted solids are rejected (rt_solid_finish). */
typedef struct ObjectLine {
    RtExactVec org, dir;
    RtRational unit;
} ObjectLine;

static ObjectLine to_object_space(const RtSolid *solid, const RtExactLine *line) {
    RtExactVec columns[4];
    for (int i = 0; i < 4; i++) columns[i] = rt_exact_vec(rt_transform_column(&solid->to_world, i));
    RtExactVec from = rt_exact_vec_sub(line->org, columns[3]);
    ObjectLine out;
    for (int i = 0; i < 3; i++) {
        RtExactVec row = rt_exact_cross(columns[(i + 1) % 3], columns[(i + 2) % 3]);
        if (i == 0) out.unit = rt_exact_dot(columns[0], row);
        out.org.at[i] = rt_exact_dot(row, from);
        out.dir.at[i] = rt_exact_dot(row, line->dir);
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

/* The squared distance of org + t dir from the origin in the first `axes` coordinates: c[0] + c[1] t +
 * c[2] t^2. */
static void squared_distance(const ObjectLine *s, int axes, RtRational c[3]) {
    for (int i = 0; i < 3; i++) c[i] = rt_exact_of(0);
    for (int a = 0; a < axes; a++) {
        RtRational cross = rt_exact_mul(s->org.at[a], s->dir.at[a]);
        c[0] = rt_exact_add(c[0], rt_exact_mul(s->org.at[a], s->org.at[a]));
        c[1] = rt_exact_add(c[1], rt_exact_add(cross, cross));
        c[2] = rt_exact_add(c[2], rt_exact_mul(s->dir.at[a], s->dir.at[a]));
    }
}

/* The ball of `radius` about the origin of object space. */
static RtStatus push_ball(Machine *m, const RtSolid *solid, double radius, RtError *error) {
    if (!(radius > 0)) {
        push(m, false);
        return RT_OK;
    }
    ObjectLine s = to_object_space(solid, m->line);
    RtRational c[3], r = rt_exact_mul(rt_exact_of(radius), s.unit);
    squared_distance(&s, 3, c);
    c[0] = rt_exact_sub(c[0], rt_exact_mul(r, r));
    return push_negative(m, rt_polynomial(2, c), error);
}

/* Where x^2 + y^2 < R^2 with R = 1 + (ratio - 1) z, between caps at z = 0 and 1, all moved outward by the
 * growth. Beyond the tip R is negative; there z is outside 0..1, unless the cone shrinks. */
static RtStatus push_cone(Machine *m, const RtSolid *solid, RtError *error) {
    ObjectLine s = to_object_space(solid, m->line);
    double growth = growth_of(m, solid), side = solid->ratio - 1;
    RtRational slope = rt_exact_sub(rt_exact_of(solid->ratio), rt_exact_of(1));
    RtRational wider = rt_exact_of(1 + growth * sqrt(1 + side * side)), z = s.org.at[2], dz = s.dir.at[2];
    RtRational r = rt_exact_add(rt_exact_mul(wider, s.unit), rt_exact_mul(slope, z)), c[3];
    RtRational dr = rt_exact_mul(slope, dz), r_dr = rt_exact_mul(r, dr);
    squared_distance(&s, 2, c);
    c[0] = rt_exact_sub(c[0], rt_exact_mul(r, r));
    c[1] = rt_exact_sub(c[1], rt_exact_add(r_dr, r_dr));
    c[2] = rt_exact_sub(c[2], rt_exact_mul(dr, dr));
    RT_TRY(push_negative(m, rt_polynomial(2, c), error));
    if (growth < 0) RT_TRY(cut_half(m, rt_exact_neg(r), rt_exact_neg(dr), error));
    RtRational grow = rt_exact_mul(rt_exact_of(growth), s.unit), top = rt_exact_add(s.unit, grow);
    RT_TRY(cut_half(m, rt_exact_neg(rt_exact_add(z, grow)), rt_exact_neg(dz), error));
    return cut_half(m, rt_exact_sub(z, top), dz, error);
}

/* Inside where (x^2 + y^2 + z^2 + 1 - ratio^2)^2 < 4 (x^2 + y^2): see shape/solid_round.c. A torus that grows
 * over its own hole is replaced by a ball around it. */
static RtStatus push_torus(Machine *m, const RtSolid *solid, RtError *error) {
    double minor = solid->ratio + growth_of(m, solid);
    if (minor >= 1 || !(minor > 0)) return push_ball(m, solid, minor >= 1 ? 1 + minor : 0, error);
    ObjectLine s = to_object_space(solid, m->line);
    RtRational at[RT_MAX_DEGREE + 1], k[3], w[3], ratio = rt_exact_of(minor);
    squared_distance(&s, 3, k);
    squared_distance(&s, 2, w);
    RtRational square = rt_exact_mul(s.unit, s.unit), four = rt_exact_mul(rt_exact_of(-4), square);
    RtRational rest = rt_exact_sub(rt_exact_of(1), rt_exact_mul(ratio, ratio));
    k[0] = rt_exact_add(k[0], rt_exact_mul(rest, square));
    for (int i = 0; i < 5; i++) {
        at[i] = i < 3 ? rt_exact_mul(four, w[i]) : rt_exact_of(0);
        for (int n = i < 2 ? 0 : i - 2; n <= i && n < 3; n++)
            at[i] = rt_exact_add(at[i], rt_exact_mul(k[n], k[i - n]));
    }
    return push_negative(m, rt_polynomial(4, at), error);
}

static RtStatus push_polyhedron(Machine *m, const RtSolid *solid, const RtPlane *planes, RtError *error) {
    RtRational grow = rt_exact_of(solid->subtracted ? -m->grow : m->grow);
    for (uint32_t i = 0; i < solid->count; i++) {
        RtExactVec normal = rt_exact_vec(planes[i].normal);
        RtRational offset = rt_exact_add(rt_exact_of(planes[i].offset), grow);
        RtRational over = rt_exact_sub(rt_exact_dot(normal, m->line->org), offset);
        RT_TRY((i > 0 ? cut_half : push_half)(m, over, rt_exact_dot(normal, m->line->dir), error));
    }
    return RT_OK;
}

/* ---- meshes ----
 *
 * By the rule of shape/solid_mesh.c without its rounding. Seen along the line, vertices are moved to the
 * origin and sheared along its largest component until the line is the z axis; x and y are left. The line
 * crosses a triangle if the outline winds about it; the sign of the volume spanned by normal and direction
 * says whether it enters or leaves, and the line is inside where it has entered more of the surface than it
 * has left.
 *
 * A line through an edge or a vertex is taken to pass beside it: it is moved by an infinitesimal amount up
 * along x, and by a smaller one down along y. In exact numbers this means: vertices at y = 0 count as
 * above the line, and edges through it as to its left. So every triangle is crossed or not, a closed
 * surface is left as often as it is entered, and a triangle seen edge-on, which the moved line misses, is
 * not crossed: a line in the plane of a face sees the faces beside it. t is that of the unmoved line. */

typedef struct Seen {
    RtRational x, y;
} Seen;

static Seen see(const RtExactLine *line, RtVec3 vertex) {
    int kz = rt_major_axis(rt_narrow(line->wide.dir)), kx = (kz + 1) % 3, ky = (kz + 2) % 3;
    RtExactVec v = rt_exact_vec_sub(rt_exact_vec(rt_widen(vertex)), line->org);
    RtRational z = rt_exact_neg(rt_exact_div(v.at[kz], line->dir.at[kz]));
    v = rt_exact_vec_add_scaled(v, line->dir, z);
    return (Seen){v.at[kx], v.at[ky]};
}

/* Does the edge from `lower` (y < 0) to `upper` (y >= 0) pass to the right of the line? */
static bool right(const Seen *lower, const Seen *upper) {
    RtRational from = rt_exact_mul(lower->x, upper->y), to = rt_exact_mul(upper->x, lower->y);
    return mpq_cmp(from, to) > 0;
}

/* The upward edges to the right of the line minus the downward ones: 1, 0 or -1. */
static int winding(const RtExactLine *line, const RtTriangle *triangle) {
    Seen v[3];
    int number = 0;
    for (int i = 0; i < 3; i++) v[i] = see(line, triangle->v[i]);
    for (int i = 0; i < 3; i++) {
        const Seen *from = &v[i], *to = &v[(i + 1) % 3];
        bool above = rt_exact_sign(from->y) >= 0, next_above = rt_exact_sign(to->y) >= 0;
        if (!above && next_above) number += right(from, to);
        if (above && !next_above) number -= right(to, from);
    }
    return number;
}

/* A crossing with one triangle; `turn` is 1 where the line enters, -1 where it leaves. */
typedef struct Crossing {
    RtRational t;
    int turn;
} Crossing;

/* Relative to vertex 0 of the triangle, whose plane the line crosses. */
static Crossing cross(const RtExactLine *line, const RtTriangle *triangle) {
    RtExactVec v[3];
    for (int i = 0; i < 3; i++) v[i] = rt_exact_vec(rt_widen(triangle->v[i]));
    RtExactVec normal = rt_exact_cross(rt_exact_vec_sub(v[1], v[0]), rt_exact_vec_sub(v[2], v[0]));
    RtRational rate = rt_exact_dot(normal, line->dir);
    RtRational gap = rt_exact_dot(normal, rt_exact_vec_sub(v[0], line->org));
    return (Crossing){rt_exact_div(gap, rate), -rt_exact_sign(rate)};
}

static int compare_crossings(const void *a, const void *b) {
    return mpq_cmp(((const Crossing *)a)->t, ((const Crossing *)b)->t);
}

/* The crossings with the triangles, in ascending order of t: a new array. Those beyond FLT_MAX may be
 * missing. */
static RtStatus collect(const RtExactLine *line, const RtTriangle *triangles, uint32_t count, Crossing **out,
                        uint32_t *found, RtError *error) {
    RtWideRay whole = line->wide;
    uint32_t capacity = 0;
    whole.tmin = -HUGE_VAL;
    whole.tmax = HUGE_VAL;
    for (uint32_t i = 0; i < count; i++) {
        RtBox box = rt_triangle_box(&triangles[i]);
        double soonest;
        if (!rt_line_may_meet(&whole, &box, &soonest)) continue;
        size_t mark = rt_exact_mark();
        int number = winding(line, &triangles[i]);
        rt_exact_rewind(mark);
        if (number == 0) continue;
        const Crossing crossing = cross(line, &triangles[i]);
        RT_TRY(rt_append(out, found, &capacity, &crossing, sizeof crossing, error));
    }
    if (*found > 0) qsort(*out, *found, sizeof **out, compare_crossings);
    return RT_OK;
}

/* One root for each t at which the inside begins or ends. */
static RtStatus push_crossings(Machine *m, const Crossing *crossings, uint32_t count, RtError *error) {
    int64_t depth = 0;
    push(m, false);
    for (uint32_t i = 0, next; i < count; i = next) {
        int64_t before = depth;
        for (next = i; next < count && mpq_equal(crossings[i].t, crossings[next].t); next++)
            depth += crossings[next].turn;
        if ((before > 0) != (depth > 0)) RT_TRY(extend(m, rt_root_of(crossings[i].t), error));
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
    push(m, false);
    RT_TRY(extend(m, rt_root_of(rt_exact_of(lo)), error));
    RT_TRY(extend(m, rt_root_of(rt_exact_of(hi)), error));
    return apply(m, op, false, error);
}

static RtStatus push_mesh(Machine *m, const RtSolid *solid, const RtTriangle *triangles, RtError *error) {
    Crossing *crossings = NULL;
    uint32_t count = 0;
    RtStatus status = collect(m->line, triangles, solid->count, &crossings, &count, error);
    if (status == RT_OK) status = push_crossings(m, crossings, count, error);
    rt_free(crossings);
    RtCsgOp op = (m->grow > 0) != solid->subtracted ? RT_CSG_UNION : RT_CSG_DIFFERENCE;
    for (uint32_t i = 0; m->grow != 0 && i < solid->count && status == RT_OK; i++)
        status = blur(m, &triangles[i], fabs(m->grow), op, error);
    return status;
}

/* ---- trees ---- */

static RtStatus push_solid(Machine *m, const RtSolidSet *set, uint32_t index, RtError *error) {
    const RtSolid *solid = &set->solids[index];
    switch (solid->kind) {
    case RT_SOLID_SPHERE: return push_ball(m, solid, 1 + growth_of(m, solid), error);
    case RT_SOLID_CONE: return push_cone(m, solid, error);
    case RT_SOLID_POLYHEDRON: return push_polyhedron(m, solid, set->planes + solid->first, error);
    case RT_SOLID_MESH: return push_mesh(m, solid, set->triangles + solid->first, error);
    case RT_SOLID_TORUS: return push_torus(m, solid, error);
    case RT_SOLID_KIND_COUNT: break;
    }
    return RT_OK;
}

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

RtExactResult rt_exact_csg_hit(const RtCsgForest *forest, const RtCsg *tree, const RtExactLine *line,
                               RtRoot *t) {
    Machine machine = {.line = line};
    RtError error;
    RtExactResult result = RT_UNDECIDED;
    if (run(&machine, forest, tree, &error) == RT_OK) {
        result = RT_MISSED;
        for (uint32_t i = 0; i < machine.lists[0].count && result == RT_MISSED; i++) {
            *t = machine.roots[i];
            if (rt_exact_counts(line, t)) result = RT_HIT;
        }
    }
    rt_free(machine.roots);
    return result;
}

RtStatus rt_exact_csg_boundaries(const RtCsgForest *forest, const RtCsg *tree, const RtWideRay *line,
                                 double grow, RtArena *owner, double **at, uint32_t *count, RtError *error) {
    size_t mark = rt_exact_mark();
    RtExactLine exact = rt_exact_line(line);
    Machine machine = {.line = &exact, .grow = grow};
    RtStatus status = run(&machine, forest, tree, error);
    *count = machine.lists[0].count;
    *at = rt_arena_alloc(owner, *count, sizeof **at);
    if (status == RT_OK) status = rt_arena_check(owner, "boundaries of a CSG tree", error);
    for (uint32_t i = 0; i < *count && status == RT_OK; i++)
        (*at)[i] = (double)rt_root_value(&machine.roots[i], exact.zero);
    rt_free(machine.roots);
    rt_exact_rewind(mark);
    return status;
}
