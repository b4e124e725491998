/* SPDX-License-Identifier: Apache-2.0 */
/* Building a grid level by level: the planes of its blocks, then the lists by a count pass and a fill pass.
 * The lists of voxels that hold too many objects are dropped once the next level, whose blocks are nested in
 * these voxels, is complete. */
#include "accel/grid/grid.h"

#include "accel/mailbox.h"
#include "core/base/memory.h"

#include <string.h>

const RtParam rt_grid_params[RT_GRID_PARAM_COUNT] = {RT_GRID_PARAMS(RT_PARAM_ENTRY)};

typedef struct Builder {
    RtGrid *grid;
    const RtValue *values;
    uint64_t limit; /* bytes */
    RtError *error;
} Builder;

/* ---- the blocks of a level ---- */

/* Cutting the voxels of one level into blocks of the next. */
typedef struct Cut {
    const Builder *builder;
    RtGridLevel *from, *to;
    double bytes;  /* of the levels so far, and estimated for the new one */
    size_t planes; /* of the new level's blocks; then those filled so far */
} Cut;

/* Whether dividing a box can separate its objects: some object does not fill it, and float32 has a plane
 * inside it. */
static bool divisible(const RtGrid *grid, const RtBox *box, const uint32_t *ids, uint32_t count) {
    bool has_plane = false;
    for (int a = 0; a < 3; a++) has_plane |= nextafterf(box->lo.at[a], INFINITY) < box->hi.at[a];
    for (uint32_t i = 0; has_plane && i < count; i++) {
        if (!rt_box_contains(rt_grid_object_box(grid, ids[i]), *box)) return true;
    }
    return false;
}

/* Numbers the voxels that are to be cut, and adds up their memory until it exceeds the limit. A resolution of
 * one voxel makes no grid. */
static RtStatus choose_voxel(void *context, const RtGridVoxel *voxel) {
    Cut *cut = context;
    const Builder *builder = cut->builder;
    const uint32_t *ids = cut->from->ids + cut->from->first[voxel->number];
    uint32_t count = cut->from->first[voxel->number + 1] - cut->from->first[voxel->number], n[3];
    cut->from->inner[voxel->number] = RT_GRID_LEAF;
    if (count <= builder->values[RT_GRID_NEST].i) return RT_OK;
    if (!divisible(builder->grid, &voxel->box, ids, count)) return RT_OK;
    rt_grid_choose_resolution(&voxel->box, count, builder->values, n);
    if ((size_t)n[0] * n[1] * n[2] == 1) return RT_OK;
    cut->from->inner[voxel->number] = cut->to->block_count++;
    size_t planes = (size_t)n[0] + n[1] + n[2] + 3;
    cut->planes += planes;
    cut->bytes += rt_grid_estimate(builder->grid, &voxel->box, n, ids, count) +
                  (double)(planes * sizeof(float) + sizeof(RtGridBlock));
    return cut->bytes <= (double)builder->limit ? RT_OK : RT_BAD_INPUT;
}

/* Fills the planes of a block, the next ones of the level. */
static void make_planes(RtGridBlock *block, const RtBox *box, float *plane) {
    for (int a = 0; a < 3; a++) {
        uint32_t n = block->n[a];
        double lo = (double)box->lo.at[a], width = (double)box->hi.at[a] - lo;
        block->planes[a] = plane;
        for (uint32_t i = 0; i <= n; i++) plane[i] = (float)(lo + width * i / n);
        plane[n] = box->hi.at[a];
        plane += n + 1;
    }
}

static RtStatus cut_voxel(void *context, const RtGridVoxel *voxel) {
    Cut *cut = context;
    if (cut->from->inner[voxel->number] == RT_GRID_LEAF) return RT_OK;
    RtGridBlock *block = &cut->to->blocks[cut->from->inner[voxel->number]];
    uint32_t count = cut->from->first[voxel->number + 1] - cut->from->first[voxel->number];
    rt_grid_choose_resolution(&voxel->box, count, cut->builder->values, block->n);
    make_planes(block, &voxel->box, cut->to->planes + cut->planes);
    cut->planes += (size_t)block->n[0] + block->n[1] + block->n[2] + 3;
    block->voxel = cut->to->voxel_count;
    cut->to->voxel_count += block->n[0] * block->n[1] * block->n[2];
    return RT_OK;
}

static RtStatus allocate_blocks(RtGridLevel *level, size_t planes, RtError *error) {
    level->blocks = rt_alloc(level->block_count, sizeof(RtGridBlock));
    level->planes = rt_alloc(planes, sizeof(float));
    if (level->blocks && level->planes) return RT_OK;
    return rt_fail_memory(error, "the planes of a grid",
                          level->block_count * sizeof(RtGridBlock) + planes * sizeof(float));
}

/* Cuts the voxels of level `depth - 1` that hold too many objects into blocks of level `depth`, without
 * lists yet. */
static RtStatus cut_level(const Builder *builder, uint32_t depth) {
    RtGrid *grid = builder->grid;
    Cut cut = {builder, &grid->levels[depth - 1], &grid->levels[depth], 0, 0};
    cut.from->inner = rt_alloc(cut.from->voxel_count, sizeof(uint32_t));
    if (!cut.from->inner)
        return rt_fail_memory(builder->error, "nested grids", cut.from->voxel_count * sizeof(uint32_t));
    for (uint32_t level = 0; level < depth; level++)
        cut.bytes += (double)rt_grid_level_bytes(&grid->levels[level]);
    if (rt_grid_each_voxel(cut.from, choose_voxel, &cut) != RT_OK)
        return rt_fail(builder->error, RT_BAD_INPUT,
                       "%u levels of grids may take more than %.3g GiB: depth=%u would fit", depth + 1,
                       (double)builder->limit / 0x1p30, depth);
    RT_TRY(allocate_blocks(cut.to, cut.planes, builder->error));
    cut.planes = 0;
    return rt_grid_each_voxel(cut.from, cut_voxel, &cut);
}

/* ---- the lists of a level ---- */

/* Both passes over the lists: adds 1 to slot[v] for every voxel v of an object and, in the fill pass, stores
 * the object at that slot. */
typedef struct Lists {
    const RtGridBlock *block;
    uint32_t *slot, *ids;
    uint32_t id;
} Lists;

static void add_range(void *context, const RtGridRange *range) {
    const Lists *lists = context;
    uint32_t at[3];
    for (at[2] = range->from[2]; at[2] <= range->to[2]; at[2]++) {
        for (at[1] = range->from[1]; at[1] <= range->to[1]; at[1]++) {
            for (at[0] = range->from[0]; at[0] <= range->to[0]; at[0]++) {
                uint32_t *entry = &lists->slot[rt_grid_voxel_at(lists->block, at)];
                if (lists->ids) lists->ids[*entry] = lists->id;
                ++*entry;
            }
        }
    }
}

/* Distributes the objects of the voxels of `from` to the blocks of `to` that are nested in them. */
static void scatter(const RtGrid *grid, const RtGridLevel *from, const RtGridLevel *to, uint32_t *slot,
                    uint32_t *ids) {
    for (uint32_t v = 0; v < from->voxel_count; v++) {
        if (from->inner[v] == RT_GRID_LEAF) continue;
        Lists lists = {&to->blocks[from->inner[v]], slot, ids, 0};
        for (uint32_t i = from->first[v]; i < from->first[v + 1]; i++) {
            lists.id = from->ids[i];
            rt_grid_each_range(grid, lists.block, lists.id, add_range, &lists);
        }
    }
}

static RtStatus make_lists(const RtGrid *grid, const RtGridLevel *from, RtGridLevel *to, RtError *error) {
    size_t voxels = to->voxel_count;
    to->first = rt_alloc(voxels + 1, sizeof(uint32_t));
    if (!to->first) return rt_fail_memory(error, "the voxels of a grid", (voxels + 1) * sizeof(uint32_t));
    /* Count pass; ends of lists; fill pass, after which first[v] is the end of list v: shift by one. */
    scatter(grid, from, to, to->first, NULL);
    uint32_t sum = 0;
    for (size_t v = 0; v <= voxels; v++) {
        uint32_t length = to->first[v];
        to->first[v] = sum;
        sum += length;
    }
    to->ids = rt_alloc(sum, sizeof(uint32_t));
    if (!to->ids) return rt_fail_memory(error, "the lists of a grid", sum * sizeof(uint32_t));
    scatter(grid, from, to, to->first, to->ids);
    memmove(to->first + 1, to->first, voxels * sizeof(uint32_t));
    to->first[0] = 0;
    return RT_OK;
}

/* Removes the lists of voxels that have been cut. */
static RtStatus drop_lists(RtGridLevel *level, RtError *error) {
    uint32_t kept = 0;
    for (uint32_t v = 0; v < level->voxel_count; v++) {
        uint32_t from = level->first[v], count = level->first[v + 1] - from;
        level->first[v] = kept;
        if (level->inner[v] != RT_GRID_LEAF) continue;
        memmove(level->ids + kept, level->ids + from, count * sizeof(uint32_t));
        kept += count;
    }
    level->first[level->voxel_count] = kept;
    uint32_t *ids = rt_alloc(kept, sizeof(uint32_t));
    if (!ids) return rt_fail_memory(error, "the lists of a grid", kept * sizeof(uint32_t));
    memcpy(ids, level->ids, kept * sizeof(uint32_t));
    rt_free(level->ids);
    level->ids = ids;
    return RT_OK;
}

/* ---- build ---- */

/* Level 0, from a single voxel that holds everything. */
static RtStatus make_root(const Builder *builder) {
    RtGrid *grid = builder->grid;
    RtGridLevel *level = &grid->levels[0];
    uint32_t objects = (uint32_t)grid->base.scene->geometry.object_count, root = 0, n[3];
    uint32_t first[2] = {0, objects};
    uint32_t *ids = rt_alloc(objects, sizeof(uint32_t));
    if (!ids) return rt_fail_memory(builder->error, "the objects of a grid", objects * sizeof(uint32_t));
    for (uint32_t id = 0; id < objects; id++) ids[id] = id;
    RtGridLevel all = {.first = first, .ids = ids, .inner = &root, .voxel_count = 1};

    const uint32_t *given = builder->values[RT_GRID_RESOLUTION].resolution;
    rt_grid_choose_resolution(&grid->box, objects, builder->values, n);
    if (given[0] > 0) memcpy(n, given, sizeof n);
    RtStatus status = rt_grid_check_limit(grid, n, ids, objects, builder->limit, builder->error);
    level->block_count = 1;
    if (status == RT_OK) status = allocate_blocks(level, (size_t)n[0] + n[1] + n[2] + 3, builder->error);
    if (status == RT_OK) {
        memcpy(level->blocks->n, n, sizeof n);
        make_planes(level->blocks, &grid->box, level->planes);
        level->voxel_count = n[0] * n[1] * n[2];
        status = make_lists(grid, &all, level, builder->error);
    }
    rt_free(ids);
    return status;
}

static RtStatus make_levels(const Builder *builder) {
    RtGrid *grid = builder->grid;
    RT_TRY(make_root(builder));
    grid->depth = 1;
    while (grid->depth < builder->values[RT_GRID_DEPTH].i) {
        RtGridLevel *from = &grid->levels[grid->depth - 1], *to = from + 1;
        RT_TRY(cut_level(builder, grid->depth));
        if (to->block_count == 0) {
            rt_free(from->inner);
            from->inner = NULL;
            break;
        }
        RT_TRY(make_lists(grid, from, to, builder->error));
        RT_TRY(drop_lists(from, builder->error));
        grid->depth++;
    }
    return RT_OK;
}

void rt_grid_destroy(RtAccel *accel) {
    RtGrid *grid = (RtGrid *)accel;
    for (uint32_t i = 0; i < RT_GRID_MAX_LEVELS; i++) {
        RtGridLevel *level = &grid->levels[i];
        rt_free(level->blocks);
        rt_free(level->planes);
        rt_free(level->first);
        rt_free(level->ids);
        rt_free(level->inner);
    }
}

/* The scene's box, extended beyond flat objects by `flat`, and widened by `margin`. */
static RtBox choose_box(const RtGeometry *geometry, double flat, double margin) {
    RtBox box = geometry->box;
    for (uint32_t id = 0; flat > 0 && id < geometry->object_count; id++) {
        RtBox own = geometry->boxes[id];
        for (int a = 0; a < 3; a++) {
            if (own.lo.at[a] < own.hi.at[a]) continue;
            own.lo.at[a] = rt_float_below((double)own.lo.at[a] - flat);
            own.hi.at[a] = rt_float_above((double)own.hi.at[a] + flat);
        }
        box = rt_box_union(box, own);
    }
    return rt_box_widened(box, margin);
}

RtStatus rt_grid_build(RtAccel *accel, const RtBuild *what, RtError *error) {
    const RtGeometry *g = &what->scene->geometry;
    const RtValue *values = what->values;
    RtGrid *grid = (RtGrid *)accel;
    const Builder builder = {grid, values, what->limit, error};
    grid->box = g->box;
    grid->mailbox = values[RT_GRID_MAILBOX].flag;
    if (grid->mailbox) accel->scratch_bytes = rt_mailbox_bytes(g);
    grid->surfaces = values[RT_GRID_OVERLAP].choice == RT_GRID_EXACT;
    grid->slack = values[RT_GRID_SLACK].f;
    if (g->object_count == 0) return RT_OK;
    grid->box = choose_box(g, values[RT_GRID_FLAT].f, values[RT_GRID_MARGIN].f);
    grid->served = rt_clipped_rays(&g->box, &grid->box);
    return make_levels(&builder);
}
