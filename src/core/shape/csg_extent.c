/* SPDX-License-Identifier: Apache-2.0 */
/* Extents of trees: the support function, and a ball. Both run the tree's program on numbers or balls
 * instead of lists of crossings. */
#include "core/shape/csg.h"

#include <assert.h>

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
