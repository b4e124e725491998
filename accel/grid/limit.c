/* What a grid of a given resolution would take, estimated before anything is taken, and which would fit. */
#include "accel/grid/grid.h"

/* How many intervals of n along an axis an object's box touches, or one more: planes are rounded. */
static double count_touched(const RtBox *grid, const RtBox *box, int axis, uint32_t n) {
    double lo = (double)grid->lo.at[axis], hi = (double)grid->hi.at[axis], width = hi - lo;
    if (!(width > 0)) return n;
    double slack = 1e-9 * n + n * 0x1p-23 * fmax(fabs(lo), fabs(hi)) / width;
    double first = floor(((double)box->lo.at[axis] - lo) / width * n - slack);
    double last = floor(((double)box->hi.at[axis] - lo) / width * n + slack);
    return fmin(last, n - 1.0) - fmax(first, 0) + 1;
}

/* Of voxels and lists; no less than it will be. */
static double estimate(const RtGrid *grid, const uint32_t n[3]) {
    const RtGeometry *g = &grid->base.scene->geometry;
    double sum = (double)n[0] * n[1] * n[2] + 1;
    for (uint32_t id = 0; id < g->object_count; id++) {
        double product = 1;
        for (int a = 0; a < 3; a++) product *= count_touched(&grid->box, &g->boxes[id], a, n[a]);
        sum += product;
    }
    return sum * sizeof(uint32_t);
}

static void cut_off(const uint32_t n[3], uint32_t most, uint32_t out[3]) {
    for (int a = 0; a < 3; a++) out[a] = n[a] < most ? n[a] : most;
}

RtStatus rt_grid_refuse(const RtGrid *grid, uint64_t limit, RtError *error) {
    double bytes = estimate(grid, grid->n), most = (double)limit;
    if (bytes <= most) return RT_OK;
    /* Bisection: `fits` a side does, or is 1; `excess` does not. */
    uint32_t fits = 1, excess = 1, n[3];
    for (int a = 0; a < 3; a++) excess = grid->n[a] > excess ? grid->n[a] : excess;
    while (fits + 1 < excess) {
        uint32_t middle = (fits + excess) / 2;
        cut_off(grid->n, middle, n);
        if (estimate(grid, n) <= most) {
            fits = middle;
        } else {
            excess = middle;
        }
    }
    cut_off(grid->n, fits, n);
    return rt_fail(error, RT_BAD_INPUT,
                   "a grid of %ux%ux%u voxels would take up to %.3g GiB, more than %.3g GiB: "
                   "resolution=%ux%ux%u would fit",
                   grid->n[0], grid->n[1], grid->n[2], bytes / 0x1p30, most / 0x1p30, n[0], n[1], n[2]);
}
