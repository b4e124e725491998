/* Which voxels an object goes into: all that its box touches, or (overlap=exact) those of them that its
 * surface comes within `margin` of, found by halving the range of voxels that the box touches.
 *
 * Why surfaces are enough. grid.c proves that the walk visits every voxel whose three intervals the thick ray
 * is in at the t of the hit. Let p be the ray's point there, org + t * dir in real numbers, and q the point
 * of the grid nearest to p. The voxel of q is one of those: on each axis the ray reaches the near plane of
 * q's interval at or before t and the far plane at or after it even without thickness, and the thickness, 16
 * half-ulps of the distance, outweighs the 4 roundings of a crossing; where p lies outside the grid, its last
 * plane is not left before t because rt_box_admit saw to that. So it is enough that q's voxel lists the
 * object, which it does if p is within `margin` of the surface along each axis: q is no farther from any
 * point of the scene's box than p is.
 *
 * Let D be the distance, along the axis where it is largest, from the origin to the farthest point of the
 * scene. A triangle is hit as if its vertices, moved to the origin and sheared in float32, lay up to
 * 8 * 2^-24 D elsewhere (shape/triangle.h; what follows is in double). Polygons and spheres are hit in
 * double: off by less than 2^-44 D. So are cones; but near the apex an error of 2^-50 D^2 in the square of
 * the radius is 2^-25 D. (A sphere's error is divided by its radius, that of which the square is subtracted.)
 * Rounding t moves the point by 2^-24 D, and rt_box_admit by at most 4 * 2^-24 D: the hit itself is inside
 * the thick box, and the crossing it is held to has 4 roundings. In all less than 16 * 2^-24 D.
 *
 * For an origin in `domain`, the scene's box grown by 8 times its longest side, D is at most 9 such sides:
 * `margin` is 4 times what that asks for, plus 2^-40 of the largest coordinate for the test of overlap. Rays
 * from farther away are tested against every object; so are those with a dir so long or short that float32
 * runs out of exponents. A test that halves a range says no only for what none of its voxels comes near.
 *
 * In nested blocks the same holds on every level: the nearest point q of a block, itself in the voxel that
 * the block is nested in, has one of the block's voxels that the walk visits; and a surface that comes near
 * it comes near the voxel around it. With `slack` both boxes and surfaces may be so much farther away, which
 * makes lists longer only. */
#include "accel/grid/grid.h"
#include "shape/overlap.h"

#define DOMAIN_SIDES 8

void rt_grid_choose_margin(RtGrid *grid) {
    const RtBox *scene = &grid->base.scene->geometry.box;
    double farthest = 0, longest = 0;
    for (int a = 0; a < 3; a++) {
        double lo = (double)scene->lo.at[a], hi = (double)scene->hi.at[a];
        farthest = fmax(farthest, fmax(fabs((double)grid->box.lo.at[a]), fabs((double)grid->box.hi.at[a])));
        longest = fmax(longest, hi - lo);
    }
    for (int a = 0; a < 3; a++) {
        grid->domain.lo.at[a] = (float)((double)scene->lo.at[a] - DOMAIN_SIDES * longest);
        grid->domain.hi.at[a] = (float)((double)scene->hi.at[a] + DOMAIN_SIDES * longest);
    }
    grid->margin = 0x1p-18 * (DOMAIN_SIDES + 1) * longest + 0x1p-40 * farthest + 0x1p-80;
}

RtBox rt_grid_object_box(const RtGrid *grid, uint32_t id) {
    RtBox box = grid->base.scene->geometry.boxes[id];
    for (int a = 0; a < 3; a++) {
        box.lo.at[a] = rt_float_below((double)box.lo.at[a] - grid->slack);
        box.hi.at[a] = rt_float_above((double)box.hi.at[a] + grid->slack);
    }
    return box;
}

RtBox rt_grid_range_box(const RtGridBlock *block, const RtGridRange *range) {
    RtBox box;
    for (int a = 0; a < 3; a++) {
        box.lo.at[a] = block->planes[a][range->from[a]];
        box.hi.at[a] = block->planes[a][range->to[a] + 1];
    }
    return box;
}

bool rt_grid_surface_meets(const RtGrid *grid, uint32_t id, const RtBox *box) {
    return rt_object_meets_box(&grid->base.scene->geometry, id, box, grid->slack + grid->margin);
}

/* The intervals of planes on `axis` that [lo, hi], which meets the block, touches: first to last. */
static void touched(const RtGridBlock *block, int axis, float lo, float hi, uint32_t *first, uint32_t *last) {
    const float *plane = block->planes[axis];
    uint32_t n = block->n[axis];
    float width = plane[n] - plane[0];
    float guess = width > 0 ? (lo - plane[0]) / width * (float)n : 0;
    uint32_t i = guess > 0 ? (uint32_t)rt_minf(guess, (float)(n - 1)) : 0;
    while (i > 0 && plane[i] >= lo) i--;
    while (i + 1 < n && plane[i + 1] < lo) i++;
    *first = i;
    while (i + 1 < n && plane[i + 1] <= hi) i++;
    *last = i;
}

RtGridRange rt_grid_touched(const RtGridBlock *block, const RtBox *box) {
    RtGridRange range;
    for (int a = 0; a < 3; a++) {
        touched(block, a, box->lo.at[a], box->hi.at[a], &range.from[a], &range.to[a]);
    }
    return range;
}

/* Halves the range along the axis of most voxels; false for a single voxel. */
static bool halve(RtGridRange *range, RtGridRange *other) {
    int axis = 0;
    for (int a = 1; a < 3; a++) {
        if (range->to[a] - range->from[a] > range->to[axis] - range->from[axis]) axis = a;
    }
    uint32_t middle = (range->from[axis] + range->to[axis]) / 2;
    if (range->from[axis] == range->to[axis]) return false;
    *other = *range;
    range->to[axis] = middle;
    other->from[axis] = middle + 1;
    return true;
}

/* Each halving leaves one range for later; 3 axes of 4096 voxels are halved 36 times. */
enum { MAX_RANGES = 40 };

void rt_grid_place(const RtGrid *grid, const RtGridBlock *block, uint32_t id,
                   void (*take)(void *context, const RtGridRange *range), void *context) {
    RtBox object = rt_grid_object_box(grid, id);
    RtGridRange stack[MAX_RANGES], range = rt_grid_touched(block, &object);
    uint32_t stacked = 0;
    if (!grid->surfaces) {
        take(context, &range);
        return;
    }
    for (;;) {
        RtBox box = rt_grid_range_box(block, &range);
        if (rt_grid_surface_meets(grid, id, &box)) {
            if (halve(&range, &stack[stacked])) {
                stacked++;
                continue;
            }
            take(context, &range);
        }
        if (stacked == 0) return;
        range = stack[--stacked];
    }
}
