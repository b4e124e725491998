/* SPDX-License-Identifier: Apache-2.0 */
/* Extents of trees: how far they reach in a direction, and a ball about them, by running a tree's program on
 * numbers and balls instead of lists of crossings. */
#include "core/shape/csg.h"

#include <assert.h>

/* Largest dot product of `direction` with a point of the box. */
static double box_support(RtBox box, RtVec3d direction) {
    double sum = 0;
    for (int a = 0; a < 3; a++) {
        sum += (double)(direction.at[a] < 0 ? box.lo : box.hi).at[a] * direction.at[a];
    }
    return sum;
}

/* What a solid or a node has: how far it reaches in a direction, or a ball about it. */
typedef union Extent {
    double support;
    RtBall ball;
} Extent;

typedef struct Rules {
    Extent (*of_solid)(const RtSolidSet *set, uint32_t solid, RtVec3d direction);
    Extent (*combined)(RtCsgOp op, Extent left, Extent right);
} Rules;

static Extent extent_of(const RtCsgForest *forest, const RtCsg *tree, Rules rules, RtVec3d direction) {
    Extent stack[RT_CSG_MAX_LISTS];
    uint32_t depth = 0;
    for (uint32_t i = 0; i < tree->count; i++) {
        RtCsgInstruction instruction = forest->instructions[tree->first + i];
        if (instruction.code == RT_CSG_PUSH) {
            stack[depth++] = rules.of_solid(&forest->set, instruction.operand, direction);
        } else if (instruction.code == RT_CSG_APPLY) {
            Extent top = stack[--depth], lower = stack[depth - 1];
            RtCsgOp op = (RtCsgOp)instruction.operand;
            stack[depth - 1] =
                instruction.reversed ? rules.combined(op, top, lower) : rules.combined(op, lower, top);
        }
    }
    assert(depth == 1);
    return stack[0];
}

/* ---- support ---- */

static Extent solid_support(const RtSolidSet *set, uint32_t solid, RtVec3d direction) {
    return (Extent){.support = rt_solid_support(set, solid, direction)};
}

static Extent combined_support(RtCsgOp op, Extent left, Extent right) {
    if (op == RT_CSG_DIFFERENCE) return left;
    return (left.support <= right.support) == (op == RT_CSG_INTERSECTION) ? left : right;
}

double rt_csg_support(const RtCsgForest *forest, const RtCsg *tree, RtVec3d direction) {
    const Rules rules = {solid_support, combined_support};
    double most = box_support(tree->box, direction),
           least = -box_support(tree->box, rt_scaled(direction, -1));
    return fmax(fmin(extent_of(forest, tree, rules, direction).support, most), least);
}

/* ---- balls ---- */

/* The smallest ball about two, a little too large rather than too small. */
static RtBall united_ball(RtBall a, RtBall b) {
    RtVec3d apart = rt_subd(b.center, a.center);
    double distance = rt_lengthd(apart);
    if (!(distance + b.radius > a.radius)) return a;
    if (!(distance + a.radius > b.radius)) return b;
    double radius = 0.5 * (distance + a.radius + b.radius);
    RtVec3d center = rt_add_scaledd(a.center, apart, (radius - a.radius) / distance);
    return (RtBall){center, radius * (1 + 0x1p-48) + 0x1p-50 * rt_lengthd(center)};
}

static Extent solid_ball(const RtSolidSet *set, uint32_t solid, RtVec3d direction) {
    (void)direction;
    return (Extent){.ball = rt_solid_ball(set, solid)};
}

static Extent combined_ball(RtCsgOp op, Extent left, Extent right) {
    switch (op) {
    case RT_CSG_UNION: return (Extent){.ball = united_ball(left.ball, right.ball)};
    case RT_CSG_INTERSECTION: return left.ball.radius <= right.ball.radius ? left : right;
    case RT_CSG_DIFFERENCE: break;
    }
    return left;
}

static RtBall ball_about_box(RtBox box) {
    RtVec3d lo = rt_widen(box.lo), hi = rt_widen(box.hi);
    RtVec3d center = rt_scaled(rt_addd(lo, hi), 0.5);
    return (RtBall){center, rt_lengthd(rt_subd(hi, center)) * (1 + 0x1p-48)};
}

RtBall rt_csg_ball(const RtCsgForest *forest, const RtCsg *tree) {
    const Rules rules = {solid_ball, combined_ball};
    RtBall ball = extent_of(forest, tree, rules, rt_vec3d(0, 0, 0)).ball;
    RtBall about_box = ball_about_box(tree->box);
    return ball.radius < about_box.radius ? ball : about_box;
}
