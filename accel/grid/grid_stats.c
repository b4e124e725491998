/* SPDX-License-Identifier: Apache-2.0 */
/* Describing, validating and drawing a grid. */
#include "accel/grid/grid.h"

#include "core/base/memory.h"

RtStatus rt_grid_each_voxel(const RtGridLevel *level,
                            RtStatus (*visit)(void *context, const RtGridVoxel *voxel), void *context) {
    RtGridVoxel voxel = {.level = level};
    for (uint32_t b = 0; b < level->block_count; b++) {
        const RtGridBlock *block = &level->blocks[b];
        uint32_t *at = voxel.at;
        for (at[2] = 0; at[2] < block->n[2]; at[2]++) {
            for (at[1] = 0; at[1] < block->n[1]; at[1]++) {
                for (at[0] = 0; at[0] < block->n[0]; at[0]++) {
                    const RtGridRange range = {{at[0], at[1], at[2]}, {at[0], at[1], at[2]}};
                    voxel.number = rt_grid_voxel_at(block, at);
                    voxel.box = rt_grid_range_box(block, &range);
                    RT_TRY(visit(context, &voxel));
                }
            }
        }
    }
    return RT_OK;
}

RtBox rt_grid_voxel_box(const RtGridLevel *level, uint32_t voxel) {
    const RtGridBlock *block = &level->blocks[level->block_count - 1];
    while (block->voxel > voxel) block--;
    uint32_t within = voxel - block->voxel, x = within % block->n[0], y = within / block->n[0] % block->n[1];
    uint32_t z = within / block->n[0] / block->n[1];
    return rt_grid_range_box(block, &(RtGridRange){{x, y, z}, {x, y, z}});
}

static size_t plane_count(const RtGridLevel *level) {
    size_t planes = 0;
    for (uint32_t b = 0; b < level->block_count; b++) {
        const RtGridBlock *block = &level->blocks[b];
        planes += (size_t)block->n[0] + block->n[1] + block->n[2] + 3;
    }
    return planes;
}

uint64_t rt_grid_level_bytes(const RtGridLevel *level) {
    size_t entries = (size_t)level->voxel_count + 1 + level->first[level->voxel_count];
    if (level->inner) entries += level->voxel_count;
    return level->block_count * sizeof(RtGridBlock) + plane_count(level) * sizeof(float) +
           entries * sizeof(uint32_t);
}

/* A random line through the box of the grid meets a voxel with the ratio of their areas; the voxels of a
 * block are equal. A voxel with a nested grid counts as the step of that grid. */
static void predict(const RtGrid *grid, const RtGridLevel *level, RtDescription *out) {
    double whole = rt_box_half_area(grid->box);
    for (uint32_t b = 0; b < level->block_count; b++) {
        const RtGridBlock *block = &level->blocks[b];
        const RtGridRange corner = {{0, 0, 0}, {0, 0, 0}};
        size_t voxels = (size_t)block->n[0] * block->n[1] * block->n[2];
        uint32_t references = level->first[block->voxel + voxels] - level->first[block->voxel];
        double ratio = rt_box_half_area(rt_grid_range_box(block, &corner)) / whole;
        out->predicted_steps += (double)voxels * ratio;
        out->predicted_tests += (double)references * ratio;
    }
    out->predicted_cost = out->predicted_tests;
}

void rt_grid_describe(const RtAccel *accel, RtDescription *out) {
    const RtGrid *grid = (const RtGrid *)accel;
    if (grid->depth == 0) {
        *out = (RtDescription){RT_NO_PREDICTION};
        return;
    }
    *out = (RtDescription){.depth = grid->depth, RT_NO_QUALITY};
    for (uint32_t i = 0; i < grid->depth; i++) {
        const RtGridLevel *level = &grid->levels[i];
        for (uint32_t v = 0; v < level->voxel_count; v++) {
            if (rt_grid_inner(level, v) != RT_GRID_LEAF) continue;
            out->leaves++;
            out->empty_leaves += level->first[v] == level->first[v + 1];
        }
        if (grid->depth > 1) out->interior += level->block_count;
        out->references += level->first[level->voxel_count];
        out->bytes += rt_grid_level_bytes(level);
        predict(grid, level, out);
    }
    if (grid->depth > 1) out->predicted_steps += 1; /* the outermost grid */
    out->bytes -= sizeof(RtGridBlock);              /* the outermost, which is one per accelerator */
}

/* ---- validate ---- */

typedef struct Check {
    const RtGrid *grid;
    uint64_t *listed;    /* [object_count] voxels that list each object */
    RtOutline *outlines; /* [object_count] */
    uint32_t nested;     /* blocks nested in the voxels so far */
    RtError *error;
} Check;

/* Fails with the name of a voxel and `words`. */
static RtStatus fail_voxel(const Check *check, const RtGridVoxel *voxel, const char *words) {
    return rt_fail(check->error, RT_MISMATCH, "grid: voxel (%u, %u, %u) of level %d %s", voxel->at[0],
                   voxel->at[1], voxel->at[2], (int)(voxel->level - check->grid->levels), words);
}

/* A voxel with a nested block, which must be the next one and have the same box. */
static RtStatus check_nested(Check *check, const RtGridVoxel *voxel, uint32_t inner) {
    const RtGridLevel *next = voxel->level + 1;
    if (inner != check->nested++ || inner >= next->block_count)
        return fail_voxel(check, voxel, "does not hold the next grid of its level");
    const RtGridBlock *block = &next->blocks[inner];
    for (int a = 0; a < 3; a++) {
        if (block->planes[a][0] == voxel->box.lo.at[a] &&
            block->planes[a][block->n[a]] == voxel->box.hi.at[a])
            continue;
        return fail_voxel(check, voxel, "is not filled by the grid that is nested in it");
    }
    return RT_OK;
}

static RtStatus check_voxel(void *context, const RtGridVoxel *voxel) {
    Check *check = context;
    const RtGrid *grid = check->grid;
    const RtGridLevel *level = voxel->level;
    uint32_t from = level->first[voxel->number], to = level->first[voxel->number + 1];
    uint32_t inner = rt_grid_inner(level, voxel->number);
    if (from > to || to > level->first[level->voxel_count] || (from < to && inner != RT_GRID_LEAF))
        return fail_voxel(check, voxel, "has a list that is broken");
    if (inner != RT_GRID_LEAF) return check_nested(check, voxel, inner);
    for (uint32_t i = from; i < to; i++) {
        uint32_t id = level->ids[i];
        if (id >= grid->base.scene->geometry.object_count || (i > from && level->ids[i - 1] >= id))
            return fail_voxel(check, voxel, "has a list that is not ascending ids");
        RtBox object = rt_grid_object_box(grid, id);
        bool apart = rt_box_is_empty(rt_box_common(voxel->box, object));
        if (grid->surfaces) apart |= !rt_grid_surface_meets(grid, &check->outlines[id], &voxel->box);
        if (apart) return fail_voxel(check, voxel, "lists an object which it does not touch");
        check->listed[id]++;
    }
    return RT_OK;
}

/* Planes ascend, voxels are numbered without gaps, and each block of the next level is in some voxel. */
static RtStatus check_level(Check *check, const RtGridLevel *level) {
    uint32_t voxels = 0;
    for (uint32_t b = 0; b < level->block_count; b++) {
        const RtGridBlock *block = &level->blocks[b];
        if (block->voxel != voxels)
            return rt_fail(check->error, RT_MISMATCH, "grid: the voxels of grid %u are misnumbered", b);
        voxels += block->n[0] * block->n[1] * block->n[2];
        for (int a = 0; a < 3; a++) {
            for (uint32_t i = 0; i < block->n[a]; i++) {
                if (block->planes[a][i] <= block->planes[a][i + 1]) continue;
                return rt_fail(check->error, RT_MISMATCH, "grid: plane %u of axis %d lies behind plane %u", i,
                               a, i + 1);
            }
        }
    }
    check->nested = 0;
    RT_TRY(rt_grid_each_voxel(level, check_voxel, check));
    bool last = level + 1 == check->grid->levels + check->grid->depth;
    if (last || check->nested == level[1].block_count) return RT_OK;
    return rt_fail(check->error, RT_MISMATCH, "grid: a nested grid is in no voxel");
}

/* The first voxel on `axis` that touches [lo, hi], and their number, by a linear search. */
static uint32_t count_touched(const RtGridBlock *block, int axis, const RtBox *box, uint32_t *first) {
    const float *plane = block->planes[axis];
    uint32_t count = 0;
    for (uint32_t i = block->n[axis]; i-- > 0;) {
        bool last = i + 1 == block->n[axis];
        if (plane[i] > box->hi.at[axis] || (plane[i + 1] <= box->lo.at[axis] && !last)) continue;
        *first = i;
        count++;
    }
    return count;
}

/* Voxels of a block, and of blocks nested in it, that must list an object, found one by one, not by bisecting
 * ranges as in the build. */
static uint64_t voxels_touched(const Check *check, const RtGridLevel *level, uint32_t index, uint32_t id) {
    const RtGrid *grid = check->grid;
    const RtGridBlock *block = &level->blocks[index];
    RtBox object = rt_grid_object_box(grid, id);
    uint32_t first[3], n[3], at[3];
    uint64_t met = 0;
    for (int a = 0; a < 3; a++) n[a] = count_touched(block, a, &object, &first[a]);
    for (at[2] = first[2]; at[2] < first[2] + n[2]; at[2]++) {
        for (at[1] = first[1]; at[1] < first[1] + n[1]; at[1]++) {
            for (at[0] = first[0]; at[0] < first[0] + n[0]; at[0]++) {
                const RtGridRange range = {{at[0], at[1], at[2]}, {at[0], at[1], at[2]}};
                RtBox box = rt_grid_range_box(block, &range);
                uint32_t inner = rt_grid_inner(level, rt_grid_voxel_at(block, at));
                if (grid->surfaces && !rt_grid_surface_meets(grid, &check->outlines[id], &box)) continue;
                met += inner == RT_GRID_LEAF ? 1 : voxels_touched(check, level + 1, inner, id);
            }
        }
    }
    return met;
}

/* Checks each level, and the voxels of each object. */
static RtStatus check_lists(Check *check) {
    const RtGrid *grid = check->grid;
    const RtGeometry *g = &grid->base.scene->geometry;
    RtStatus status = RT_OK;
    for (uint32_t id = 0; id < g->object_count; id++) check->outlines[id] = rt_object_outline(g, id);
    for (uint32_t i = 0; status == RT_OK && i < grid->depth; i++)
        status = check_level(check, &grid->levels[i]);
    for (uint32_t id = 0; status == RT_OK && id < g->object_count; id++) {
        uint64_t touched = voxels_touched(check, &grid->levels[0], 0, id);
        if (check->listed[id] == touched) continue;
        status = rt_fail(check->error, RT_MISMATCH, "grid: object %u touches %llu voxels, but %llu list it",
                         id, (unsigned long long)touched, (unsigned long long)check->listed[id]);
    }
    return status;
}

RtStatus rt_grid_validate(const RtAccel *accel, RtError *error) {
    const RtGrid *grid = (const RtGrid *)accel;
    const RtGeometry *g = &accel->scene->geometry;
    if (grid->depth == 0) return RT_OK;
    const RtGridBlock *root = grid->levels[0].blocks;
    for (int a = 0; a < 3; a++) {
        if (root->planes[a][0] <= grid->box.lo.at[a] && root->planes[a][root->n[a]] >= grid->box.hi.at[a])
            continue;
        return rt_fail(error, RT_MISMATCH, "grid: the planes of axis %d do not enclose its box", a);
    }
    if (!rt_box_contains(grid->box, g->box))
        return rt_fail(error, RT_MISMATCH, "grid: its box does not contain the scene");
    size_t n = g->object_count;
    Check check = {grid, rt_alloc(n, sizeof(uint64_t)), rt_alloc(n, sizeof(RtOutline)), 0, error};
    RtStatus status =
        check.listed && check.outlines
            ? check_lists(&check)
            : rt_fail_memory(error, "validating a grid", n * (sizeof(uint64_t) + sizeof(RtOutline)));
    rt_free(check.listed);
    rt_free(check.outlines);
    return status;
}

/* ---- boxes ---- */

typedef struct Show {
    RtBoxViewer viewer;
    uint32_t depth;
} Show;

static RtStatus show_voxel(void *context, const RtGridVoxel *voxel) {
    const Show *show = context;
    const uint32_t *first = &voxel->level->first[voxel->number];
    show->viewer.show(show->viewer.context,
                      &(RtBoxView){.box = &voxel->box,
                                   .depth = show->depth,
                                   .leaf = rt_grid_inner(voxel->level, voxel->number) == RT_GRID_LEAF,
                                   .objects = first[1] - first[0]});
    return RT_OK;
}

/* Voxels of the outermost grid have depth 1. */
void rt_grid_each_box(const RtAccel *accel, RtBoxViewer viewer) {
    const RtGrid *grid = (const RtGrid *)accel;
    if (grid->depth == 0) return;
    viewer.show(viewer.context, &(RtBoxView){.box = &grid->box});
    for (uint32_t i = 0; i < grid->depth; i++) {
        Show show = {viewer, i + 1};
        rt_grid_each_voxel(&grid->levels[i], show_voxel, &show);
    }
}
