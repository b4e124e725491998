/* Describing, validating and drawing a grid. */
#include "accel/grid/grid.h"

#include "base/memory.h"
#include "shape/overlap.h"

static RtBox voxel_box(const RtGrid *grid, const uint32_t at[3]) {
    RtGridRange range;
    for (int a = 0; a < 3; a++) range.from[a] = range.to[a] = at[a];
    return rt_grid_range_box(grid, &range);
}

/* Calls visit for every voxel in turn until it returns something else than RT_OK. */
static RtStatus each_voxel(const RtGrid *grid,
                           RtStatus (*visit)(void *context, const RtGrid *grid, const uint32_t at[3]),
                           void *context) {
    uint32_t at[3];
    for (at[2] = 0; at[2] < grid->n[2]; at[2]++) {
        for (at[1] = 0; at[1] < grid->n[1]; at[1]++) {
            for (at[0] = 0; at[0] < grid->n[0]; at[0]++) RT_TRY(visit(context, grid, at));
        }
    }
    return RT_OK;
}

void rt_grid_describe(const RtAccel *accel, RtDescription *out) {
    const RtGrid *grid = (const RtGrid *)accel;
    size_t voxels = rt_grid_voxel_count(grid);
    *out = (RtDescription){RT_NO_PREDICTION};
    if (voxels == 0) return;
    out->leaves = voxels;
    out->references = grid->first[voxels];
    for (size_t v = 0; v < voxels; v++) out->empty_leaves += grid->first[v] == grid->first[v + 1];
    out->depth = 1;
    out->bytes += ((size_t)grid->n[0] + grid->n[1] + grid->n[2] + 3) * sizeof(float) +
                  (voxels + 1 + out->references) * sizeof(uint32_t);
    /* A random line through the box meets a voxel with the ratio of their areas. */
    const uint32_t corner[3] = {0, 0, 0};
    RtBox voxel = voxel_box(grid, corner);
    double ratio = rt_box_half_area(voxel) / rt_box_half_area(grid->box);
    out->predicted_steps = (double)voxels * ratio;
    out->predicted_tests = out->predicted_cost = (double)out->references * ratio;
}

typedef struct Check {
    RtError *error;
    uint64_t *listed; /* [object_count] voxels that list each object */
} Check;

static RtStatus check_voxel(void *context, const RtGrid *grid, const uint32_t at[3]) {
    const Check *check = context;
    const RtGeometry *g = &grid->base.scene->geometry;
    size_t voxel = rt_grid_voxel_at(grid, at);
    RtBox box = voxel_box(grid, at);
    uint32_t from = grid->first[voxel], to = grid->first[voxel + 1];
    if (from > to || to > grid->first[rt_grid_voxel_count(grid)]) {
        return rt_fail(check->error, RT_MISMATCH, "grid: the list of voxel (%u, %u, %u) is broken", at[0],
                       at[1], at[2]);
    }
    for (uint32_t i = from; i < to; i++) {
        uint32_t id = grid->ids[i];
        if (id >= g->object_count || (i > from && grid->ids[i - 1] >= id)) {
            return rt_fail(check->error, RT_MISMATCH,
                           "grid: the list of voxel (%u, %u, %u) is not ascending ids", at[0], at[1], at[2]);
        }
        RtBox common = {rt_vec_max(box.lo, g->boxes[id].lo), rt_vec_min(box.hi, g->boxes[id].hi)};
        bool apart = rt_box_is_empty(common);
        if (grid->surfaces) apart |= !rt_object_meets_box(g, id, &box, grid->margin);
        if (apart) {
            return rt_fail(check->error, RT_MISMATCH,
                           "grid: voxel (%u, %u, %u) lists object %u, which it does not touch", at[0], at[1],
                           at[2], id);
        }
        check->listed[id]++;
    }
    return RT_OK;
}

/* The least voxel on `axis` that touches [lo, hi], and how many do, sought plane by plane. */
static uint32_t count_touched(const RtGrid *grid, int axis, const RtBox *box, uint32_t *first) {
    const float *plane = grid->planes[axis];
    uint32_t count = 0;
    for (uint32_t i = grid->n[axis]; i-- > 0;) {
        if (!(plane[i] <= box->hi.at[axis] && plane[i + 1] >= box->lo.at[axis])) continue;
        *first = i;
        count++;
    }
    return count;
}

/* Voxels that ought to list an object: one by one, where building halves ranges. */
static uint64_t voxels_touched(const RtGrid *grid, uint32_t id) {
    const RtGeometry *g = &grid->base.scene->geometry;
    uint32_t first[3], n[3], at[3];
    uint64_t met = 0;
    for (int a = 0; a < 3; a++) n[a] = count_touched(grid, a, &g->boxes[id], &first[a]);
    if (!grid->surfaces) return (uint64_t)n[0] * n[1] * n[2];
    for (at[2] = first[2]; at[2] < first[2] + n[2]; at[2]++) {
        for (at[1] = first[1]; at[1] < first[1] + n[1]; at[1]++) {
            for (at[0] = first[0]; at[0] < first[0] + n[0]; at[0]++) {
                RtBox box = voxel_box(grid, at);
                met += rt_object_meets_box(g, id, &box, grid->margin);
            }
        }
    }
    return met;
}

RtStatus rt_grid_validate(const RtAccel *accel, RtError *error) {
    const RtGrid *grid = (const RtGrid *)accel;
    const RtGeometry *g = &accel->scene->geometry;
    if (rt_grid_voxel_count(grid) == 0) return RT_OK;
    for (int a = 0; a < 3; a++) {
        for (uint32_t i = 0; i < grid->n[a]; i++) {
            if (grid->planes[a][i] <= grid->planes[a][i + 1]) continue;
            return rt_fail(error, RT_MISMATCH, "grid: plane %u of axis %d lies behind plane %u", i, a, i + 1);
        }
        if (grid->planes[a][0] > grid->box.lo.at[a] || grid->planes[a][grid->n[a]] < grid->box.hi.at[a]) {
            return rt_fail(error, RT_MISMATCH, "grid: the planes of axis %d do not enclose its box", a);
        }
    }
    if (!rt_box_contains(grid->box, g->box)) {
        return rt_fail(error, RT_MISMATCH, "grid: its box does not contain the scene");
    }
    Check check = {error, rt_alloc(g->object_count, sizeof(uint64_t))};
    if (!check.listed) return rt_fail_memory(error, "validating a grid", g->object_count * sizeof(uint64_t));
    RtStatus status = each_voxel(grid, check_voxel, &check);
    for (uint32_t id = 0; status == RT_OK && id < g->object_count; id++) {
        uint64_t touched = voxels_touched(grid, id);
        if (check.listed[id] == touched) continue;
        status = rt_fail(error, RT_MISMATCH, "grid: object %u touches %llu voxels, but %llu list it", id,
                         (unsigned long long)touched, (unsigned long long)check.listed[id]);
    }
    rt_free(check.listed);
    return status;
}

static RtStatus show_voxel(void *context, const RtGrid *grid, const uint32_t at[3]) {
    const RtBoxViewer *viewer = context;
    size_t voxel = rt_grid_voxel_at(grid, at);
    RtBox box = voxel_box(grid, at);
    if (grid->first[voxel] < grid->first[voxel + 1]) viewer->show(viewer->context, &box, 1);
    return RT_OK;
}

void rt_grid_each_box(const RtAccel *accel, RtBoxViewer viewer) {
    const RtGrid *grid = (const RtGrid *)accel;
    if (rt_grid_voxel_count(grid) == 0) return;
    viewer.show(viewer.context, &grid->box, 0);
    each_voxel(grid, show_voxel, &viewer);
}
