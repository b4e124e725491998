/* SPDX-License-Identifier: Apache-2.0 */
/* Rays and trees: the stack machine that runs a tree's program (csg.h). Its lists lie one after another in
 * one array of crossings, the ray's scratch memory. Two lists are merged to behind them, and the result is
 * moved down to where they began. */
#include "core/shape/csg.h"

#include "core/base/observe.h"

#include <assert.h>
#include <string.h>

#define INLINE static inline __attribute__((always_inline))

typedef struct Machine {
    RtCrossing *crossings;
    uint32_t capacity;
    uint32_t depth;                        /* lists on the stack */
    uint32_t starts[RT_CSG_MAX_LISTS + 1]; /* list i: crossings [starts[i], starts[i + 1]) */
} Machine;

/* For assertions: do `more` crossings fit behind all lists? */
__attribute__((unused)) static inline bool has_room(const Machine *m, uint32_t more) {
    return (uint64_t)m->starts[m->depth] + more <= m->capacity;
}

static inline void push(Machine *m, uint32_t count) {
    assert(m->depth < RT_CSG_MAX_LISTS);
    m->starts[m->depth + 1] = m->starts[m->depth] + count;
    m->depth++;
}

/* ---- operations ---- */

/* The merging rule of csg.h, place by place. A NaN cannot stall the loop. */
static uint32_t merge(RtCsgOp op, const RtCrossing *left, const RtCrossing *left_end, const RtCrossing *right,
                      const RtCrossing *right_end, RtCrossing *out) {
    bool in_left = false, in_right = false, inside = false;
    uint32_t count = 0;
    while (left < left_end || right < right_end) {
        bool leftmost = right == right_end || (left < left_end && left->t <= right->t);
        float t = leftmost ? left->t : right->t;
        const RtCrossing *from_left = left, *from_right = right;
        while (left < left_end && !(left->t > t)) left++;
        while (right < right_end && !(right->t > t)) right++;
        bool left_turns = (left - from_left) % 2, right_turns = (right - from_right) % 2;
        in_left ^= left_turns;
        in_right ^= right_turns;
        bool now = rt_csg_joined(op, in_left, in_right);
        if (now == inside) continue;
        inside = now;
        out[count++] = left_turns && in_left == inside ? *from_left : *from_right;
    }
    return count;
}

static void apply(Machine *m, RtCsgOp op, bool reversed) {
    assert(m->depth > 1);
    uint32_t lower = m->starts[m->depth - 2], top = m->starts[m->depth - 1], end = m->starts[m->depth];
    bool left_empty = reversed ? top == end : lower == top;
    bool right_empty = reversed ? lower == top : top == end;
    m->depth--;
    if (left_empty || right_empty) {
        bool stays = op == RT_CSG_UNION || (op == RT_CSG_DIFFERENCE && right_empty);
        m->starts[m->depth] = stays ? end : lower;
        return;
    }
    m->starts[m->depth] = end;
    assert(has_room(m, end - lower));
    const RtCrossing *begin = m->crossings + lower, *middle = m->crossings + top;
    RtCrossing *behind = m->crossings + end;
    uint32_t count = reversed ? merge(op, middle, behind, begin, middle, behind)
                              : merge(op, begin, middle, middle, behind, behind);
    memmove(m->crossings + lower, behind, count * sizeof(RtCrossing));
    m->starts[m->depth] = lower + count;
}

/* ---- running a program ---- */

/* Reports the list on top of the stack as the result of the operation that ends before instruction `end`.
 * Operations are numbered in the order of their ends. */
static RT_COLD void show_result(const Machine *m, const RtCsgInstruction *program, uint32_t end) {
    static const char *const names[] = {"union", "intersection", "difference"};
    const uint32_t start = m->starts[m->depth - 1];
    RtTraced event = {.kind = RT_TRACED_CSG_RESULT,
                      .what = names[program[end - 1].operand],
                      .crossings = m->crossings + start,
                      .crossing_count = m->starts[m->depth] - start,
                      .in_tree = true};
    for (uint32_t i = 0; i + 1 < end; i++) event.index += program[i].code == RT_CSG_APPLY;
    rt_observe(&event);
}

INLINE void push_solid(Machine *m, const RtSolidSet *set, uint32_t index, const RtSolidRay *ray,
                       RtTally *tally) {
    float near = -INFINITY, far = INFINITY;
    RT_COUNT(tally, extent_tests, 1);
    rt_box_cut(&set->solids[index].box, &ray->thick, &near, &far);
    bool met = near <= far && near <= ray->thick.tmax && far >= ray->thick.tmin;
    RT_OBSERVE(tally, .kind = RT_TRACED_EXTENT_TEST, .what = "solid", .index = index,
               .box = &set->solids[index].box, .met = met, .in_tree = true);
    if (!met) {
        push(m, 0);
        return;
    }
    assert(has_room(m, rt_solid_most_crossings(&set->solids[index])));
    RT_COUNT(tally, csg_tests, 1);
    RtCrossing *list = m->crossings + m->starts[m->depth];
    push(m, rt_solid_crossings(set, index, ray, near, far, list));
    RT_OBSERVE(tally, .kind = RT_TRACED_CSG_TEST, .what = "solid", .index = index, .crossings = list,
               .crossing_count = m->starts[m->depth] - m->starts[m->depth - 1], .in_tree = true);
}

/* Runs the program; it leaves one list on the stack. */
INLINE void run(Machine *m, const RtCsgForest *forest, const RtCsg *tree, const RtSolidRay *ray,
                RtTally *tally) {
    const RtCsgInstruction *program = forest->instructions + tree->first;
    float enter;
    assert(ray->thick.crossings);
    m->crossings = ((RtHitMemory *)ray->thick.crossings)->crossings;
    m->capacity = tree->most_crossings;
    m->depth = 0;
    m->starts[0] = m->starts[1] = 0; /* also the result of a program without instructions */
    for (uint32_t i = 0; i < tree->count; i++) {
        RtCsgInstruction instruction = program[i];
        switch ((RtCsgOpcode)instruction.code) {
        case RT_CSG_TEST:
            RT_COUNT(tally, extent_tests, 1);
            const RtBox *box = &forest->boxes[instruction.operand];
            bool met = rt_box_hit(box, &ray->thick, ray->thick.tmax, &enter);
            RT_OBSERVE(tally, .kind = RT_TRACED_EXTENT_TEST, .what = "solids", .index = instruction.operand,
                       .box = box, .met = met, .in_tree = true);
            if (met) break;
            push(m, 0);
            i = instruction.to - 1;
            if (RT_OBSERVED(tally)) show_result(m, program, i + 1);
            break;
        case RT_CSG_PUSH: push_solid(m, &forest->set, instruction.operand, ray, tally); break;
        case RT_CSG_SKIP_IF_EMPTY:
            assert(m->depth > 0);
            if (m->starts[m->depth - 1] < m->starts[m->depth]) break;
            i = instruction.to - 1;
            if (RT_OBSERVED(tally)) show_result(m, program, i + 1);
            break;
        case RT_CSG_APPLY:
            apply(m, (RtCsgOp)instruction.operand, instruction.reversed);
            if (RT_OBSERVED(tally)) show_result(m, program, i + 1);
            break;
        }
    }
}

static inline RtSolidRay solid_ray(const RtCsg *tree, const RtPreparedRay *ray) {
    RtSolidRay solid = {rt_widen(rt_vec3_load(ray->org)), rt_widen(rt_vec3_load(ray->dir)), *ray};
    rt_ray_thicken(&solid.thick, &tree->reach);
    return solid;
}

/* Can rt_box_admit accept any t? The box of an empty tree is a point. */
static inline bool comes_near(const RtCsg *tree, const RtPreparedRay *ray) {
    float near, far;
    rt_box_own_span(&tree->box, ray, &near, &far);
    return near <= far && near <= ray->tmax && far >= ray->tmin && tree->box.lo.x < tree->box.hi.x;
}

INLINE bool search(const RtCsgForest *forest, const RtCsg *tree, const RtPreparedRay *ray, float *t,
                   RtTally *tally) {
    if (!comes_near(tree, ray)) return false;
    RtSolidRay solid = solid_ray(tree, ray);
    Machine m;
    run(&m, forest, tree, &solid, tally);
    bool found = false;
    for (uint32_t i = 0; i < m.starts[1] && !found; i++) {
        *t = m.crossings[i].t + 0.0f; /* two faces may be met at -0 and at 0 */
        found = *t >= ray->tmin && *t <= ray->tmax && rt_box_admit(&tree->box, ray, t);
    }
    return found;
}

bool rt_csg_hit(const RtCsgForest *forest, const RtCsg *tree, const RtPreparedRay *ray, float *t,
                RtTally *tally) {
    return tally ? search(forest, tree, ray, t, tally) : search(forest, tree, ray, t, NULL);
}

/* ---- facets ---- */

RtCsgFacet rt_csg_facet(const RtCsgForest *forest, const RtCsg *tree, const RtPreparedRay *ray, float t) {
    RtSolidRay solid = solid_ray(tree, ray);
    Machine m;
    run(&m, forest, tree, &solid, NULL);
    const RtCrossing *best = NULL;
    float least = INFINITY;
    for (uint32_t i = 0; i < m.starts[1]; i++) {
        float at = m.crossings[i].t; /* as rt_csg_hit computes it */
        (void)rt_box_admit(&tree->box, ray, &at);
        if (!(fabsf(at - t) < least)) continue;
        least = fabsf(at - t);
        best = &m.crossings[i];
    }
    if (!best) return (RtCsgFacet){{0, 0, 0}, tree->first_solid};
    RtVec3d point = rt_add_scaledd(solid.org, solid.dir, (double)best->t);
    RtVec3d normal = rt_solid_normal(&forest->set, best->solid, best->face, point);
    bool inward = forest->set.solids[best->solid].subtracted;
    return (RtCsgFacet){inward ? rt_scaled(normal, -1) : normal, best->solid};
}

/* ---- extents: the program runs on numbers or balls instead of lists of crossings ---- */

/* The largest dot product of `direction` with a point of the box. */
static double box_support(RtBox box, RtVec3d direction) {
    double sum = 0;
    for (int a = 0; a < 3; a++)
        sum += (double)(direction.at[a] < 0 ? box.lo : box.hi).at[a] * direction.at[a];
    return sum;
}

/* The smallest ball around two, rounded up. */
static RtBall united_ball(RtBall a, RtBall b) {
    RtVec3d apart = rt_subd(b.center, a.center);
    double distance = rt_lengthd(apart);
    if (!(distance + b.radius > a.radius)) return a;
    if (!(distance + a.radius > b.radius)) return b;
    double radius = 0.5 * (distance + a.radius + b.radius);
    RtVec3d center = rt_add_scaledd(a.center, apart, (radius - a.radius) / distance);
    return (RtBall){center, radius * (1 + 0x1p-48) + 0x1p-50 * rt_lengthd(center)};
}

/* The extent of a solid or a node: its support in a direction, or a ball. */
typedef union Extent {
    double support;
    RtBall ball;
} Extent;

static Extent combined(RtCsgOp op, Extent left, Extent right, bool balls) {
    if (op == RT_CSG_DIFFERENCE) return left;
    if (op == RT_CSG_UNION && balls) return (Extent){.ball = united_ball(left.ball, right.ball)};
    bool left_is_less = balls ? left.ball.radius <= right.ball.radius : left.support <= right.support;
    return left_is_less == (op == RT_CSG_INTERSECTION) ? left : right;
}

static Extent extent_of(const RtCsgForest *forest, const RtCsg *tree, bool balls, RtVec3d direction) {
    Extent stack[RT_CSG_MAX_LISTS];
    uint32_t depth = 0;
    for (uint32_t i = 0; i < tree->count; i++) {
        RtCsgInstruction instruction = forest->instructions[tree->first + i];
        if (instruction.code == RT_CSG_PUSH) {
            Extent *top = &stack[depth++];
            if (balls)
                top->ball = rt_solid_ball(&forest->set, instruction.operand);
            else
                top->support = rt_solid_support(&forest->set, instruction.operand, direction);
        } else if (instruction.code == RT_CSG_APPLY) {
            Extent top = stack[--depth], lower = stack[depth - 1];
            stack[depth - 1] = combined((RtCsgOp)instruction.operand, instruction.reversed ? top : lower,
                                        instruction.reversed ? lower : top, balls);
        }
    }
    assert(depth == 1);
    return stack[0];
}

double rt_csg_support(const RtCsgForest *forest, const RtCsg *tree, RtVec3d direction) {
    double most = box_support(tree->box, direction),
           least = -box_support(tree->box, rt_scaled(direction, -1));
    return fmax(fmin(extent_of(forest, tree, false, direction).support, most), least);
}

static RtBall ball_about_box(RtBox box) {
    RtVec3d lo = rt_widen(box.lo), hi = rt_widen(box.hi);
    RtVec3d center = rt_scaled(rt_addd(lo, hi), 0.5);
    return (RtBall){center, rt_lengthd(rt_subd(hi, center)) * (1 + 0x1p-48)};
}

RtBall rt_csg_ball(const RtCsgForest *forest, const RtCsg *tree) {
    RtBall ball = extent_of(forest, tree, true, rt_vec3d(0, 0, 0)).ball;
    RtBall about_box = ball_about_box(tree->box);
    return ball.radius < about_box.radius ? ball : about_box;
}
