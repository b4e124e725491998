/* SPDX-License-Identifier: Apache-2.0 */
/* What a grid of a given resolution would take, estimated before anything is taken, and which would fit. */
#include "accel/grid/grid.h"

/* How many intervals of n along an axis an object's box touches, or one more: planes are rounded. */
static double count_touched(const RtBox *block, const RtBox *box, int axis, uint32_t n) {
    double lo = (double)block->lo.at[axis], hi = (double)block->hi.at[axis], width = hi - lo;
    if (!(width > 0)) return n;
    double slack = 1e-9 * n + n * 0x1p-23 * fmax(fabs(lo), fabs(hi)) / width;
    double first = floor(((double)box->lo.at[axis] - lo) / width * n - slack);
    double last = floor(((double)box->hi.at[axis] - lo) / width * n + slack);
    return fmin(last, n - 1.0) - fmax(first, 0) + 1;
}

double rt_grid_estimate(const RtGrid *grid, const RtBox *box, const uint32_t n[3], const uint32_t *ids,
                        uint32_t count) {
    double sum = (double)n[0] * n[1] * n[2] + 1;
    for (uint32_t i = 0; i < count; i++) {
        RtBox object = rt_grid_object_box(grid, ids[i]);
        double product = 1;
        for (int a = 0; a < 3; a++) product *= count_touched(box, &object, a, n[a]);
        sum += product;
    }
    return sum * sizeof(uint32_t);
}

static void cut_off(const uint32_t n[3], uint32_t most, uint32_t out[3]) {
    for (int a = 0; a < 3; a++) out[a] = n[a] < most ? n[a] : most;
}

RtStatus rt_grid_refuse(const RtGrid *grid, const uint32_t n[3], const uint32_t *ids, uint32_t count,
                        uint64_t limit, RtError *error) {
    double bytes = rt_grid_estimate(grid, &grid->box, n, ids, count), most = (double)limit;
    if (bytes <= most) return RT_OK;
    /* Bisection: `fits` a side does, or is 1; `excess` does not. */
    uint32_t fits = 1, excess = 1, smaller[3];
    for (int a = 0; a < 3; a++) excess = n[a] > excess ? n[a] : excess;
    while (fits + 1 < excess) {
        uint32_t middle = (fits + excess) / 2;
        cut_off(n, middle, smaller);
        if (rt_grid_estimate(grid, &grid->box, smaller, ids, count) <= most) {
            fits = middle;
        } else {
            excess = middle;
        }
    }
    cut_off(n, fits, smaller);
    return rt_fail(error, RT_BAD_INPUT,
                   "a grid of %ux%ux%u voxels would take up to %.3g GiB, more than %.3g GiB: "
                   "resolution=%ux%ux%u would fit",
                   n[0], n[1], n[2], bytes / 0x1p30, most / 0x1p30, smaller[0], smaller[1], smaller[2]);
}
