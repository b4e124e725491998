/* SPDX-License-Identifier: Apache-2.0 */
/* Meshes in exact arithmetic, by the rule of shape/solid_mesh.c without its rounding. Seen along the line,
 * vertices are moved to the origin and sheared along its largest component until the line is the z axis; x
 * and y are left. The line crosses a triangle if the outline winds about it; the sign of the volume spanned
 * by normal and direction says whether it enters or leaves, and the line is inside where it has entered more
 * of the surface than it has left.
 *
 * A line through an edge or a vertex is taken to pass beside it: it is moved by an infinitesimal amount up
 * along x, and by a smaller one down along y. In exact numbers this means: vertices at y = 0 count as
 * above the line, and edges through it as to its left. So every triangle is crossed or not, a closed
 * surface is left as often as it is entered, and a triangle seen edge-on, which the moved line misses, is
 * not crossed: a line in the plane of a face sees the faces beside it. t is that of the unmoved line. */
#include "exact/exact_hit.h"

#include "core/base/memory.h"

/* A crossing with one triangle; `turn` is 1 where the line enters, -1 where it leaves. */
typedef struct Crossing {
    RtRational t;
    int turn;
} Crossing;

/* In ascending order of t. */
typedef struct List {
    uint32_t count, capacity;
    Crossing *at;
} List;

/* ---- one triangle ---- */

typedef struct Seen {
    RtRational x, y;
} Seen;

static Seen see(RtExactArena *arena, const RtExactLine *line, RtVec3 vertex) {
    int kz = rt_major_axis(rt_narrow(line->wide.dir)), kx = (kz + 1) % 3, ky = (kz + 2) % 3;
    RtExactVec v = rt_exact_vec_sub(arena, rt_exact_vec(arena, rt_widen(vertex)), line->org);
    RtRational z = rt_exact_neg(arena, rt_exact_div(arena, v.at[kz], line->dir.at[kz]));
    v = rt_exact_vec_add_scaled(arena, v, line->dir, z);
    return (Seen){v.at[kx], v.at[ky]};
}

/* Does the edge from `lower` (y < 0) to `upper` (y >= 0) pass to the right of the line? */
static bool right(RtExactArena *arena, const Seen *lower, const Seen *upper) {
    RtRational from = rt_exact_mul(arena, lower->x, upper->y), to = rt_exact_mul(arena, upper->x, lower->y);
    return mpq_cmp(from, to) > 0;
}

/* The upward edges to the right of the line minus the downward ones: 1, 0 or -1. */
static int winding(RtExactArena *arena, const RtExactLine *line, const RtTriangle *triangle) {
    Seen v[3];
    int number = 0;
    for (int i = 0; i < 3; i++) v[i] = see(arena, line, triangle->v[i]);
    for (int i = 0; i < 3; i++) {
        const Seen *from = &v[i], *to = &v[(i + 1) % 3];
        bool above = rt_exact_sign(from->y) >= 0, next_above = rt_exact_sign(to->y) >= 0;
        if (!above && next_above) number += right(arena, from, to);
        if (above && !next_above) number -= right(arena, to, from);
    }
    return number;
}

static RtStatus insert(List *list, Crossing crossing, RtError *error) {
    RT_TRY(rt_reserve(&list->at, &list->capacity, (uint64_t)list->count + 1, sizeof(Crossing), error));
    uint32_t i = list->count++;
    for (; i > 0 && mpq_cmp(list->at[i - 1].t, crossing.t) > 0; i--) list->at[i] = list->at[i - 1];
    list->at[i] = crossing;
    return RT_OK;
}

/* Relative to vertex 0 of the triangle, whose plane the line crosses. */
static RtStatus cross(RtExactArena *arena, const RtExactLine *line, const RtTriangle *triangle, List *list,
                      RtError *error) {
    RtExactVec v[3];
    for (int i = 0; i < 3; i++) v[i] = rt_exact_vec(arena, rt_widen(triangle->v[i]));
    RtExactVec normal =
        rt_exact_cross(arena, rt_exact_vec_sub(arena, v[1], v[0]), rt_exact_vec_sub(arena, v[2], v[0]));
    RtRational rate = rt_exact_dot(arena, normal, line->dir);
    RtRational gap = rt_exact_dot(arena, normal, rt_exact_vec_sub(arena, v[0], line->org));
    return insert(list, (Crossing){rt_exact_div(arena, gap, rate), -rt_exact_sign(rate)}, error);
}

/* ---- all triangles ---- */

static RtStatus collect(RtExactArena *arena, const RtSolidSet *set, const RtSolid *solid,
                        const RtExactLine *line, List *list, RtError *error) {
    RtWideRay whole = line->wide;
    whole.tmin = -HUGE_VAL;
    whole.tmax = HUGE_VAL;
    for (uint32_t i = 0; i < solid->count; i++) {
        const RtTriangle *triangle = &set->triangles[solid->first + i];
        RtBox box = rt_triangle_box(triangle);
        double soonest;
        if (!rt_line_may_meet(&whole, &box, &soonest)) continue;
        size_t mark = rt_exact_arena_mark(arena);
        int number = winding(arena, line, triangle);
        rt_exact_arena_rewind(arena, mark);
        if (number != 0) RT_TRY(cross(arena, line, triangle, list, error));
    }
    return RT_OK;
}

/* Keeps one crossing of each t at which the inside begins or ends. */
static void thin_out(List *list) {
    uint32_t count = 0;
    int64_t depth = 0;
    for (uint32_t i = 0, next; i < list->count; i = next) {
        int64_t before = depth;
        for (next = i; next < list->count && mpq_equal(list->at[i].t, list->at[next].t); next++)
            depth += list->at[next].turn;
        if ((before > 0) != (depth > 0)) list->at[count++] = list->at[i];
    }
    list->count = count;
}

RtStatus rt_exact_mesh_roots(RtExactArena *arena, const RtSolidSet *set, uint32_t index,
                             const RtExactLine *line, RtRational **roots, uint32_t *count, RtError *error) {
    List list = {0};
    *roots = NULL;
    RtStatus status = collect(arena, set, &set->solids[index], line, &list, error);
    if (status == RT_OK) {
        thin_out(&list);
        *roots = rt_alloc(list.count, sizeof(RtRational));
        if (!*roots) status = rt_fail_memory(error, "the roots of a mesh", list.count * sizeof(RtRational));
    }
    *count = status == RT_OK ? list.count : 0;
    for (uint32_t i = 0; i < *count; i++) (*roots)[i] = list.at[i].t;
    rt_free(list.at);
    return status;
}
