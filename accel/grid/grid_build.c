/* SPDX-License-Identifier: Apache-2.0 */
/* Building a grid level by level: the planes of its blocks, then the lists by a count pass and a fill pass.
 * The lists of voxels that hold too many objects are dropped once the next level, whose blocks are nested in
 * these voxels, is complete.
 *
 * An object goes into all voxels that its box meets, or with overlap=exact into those of them that its
 * surface comes within `margin` of, found by bisecting the range of voxels that the box meets. Why surfaces
 * suffice: grid.c proves that the walk visits every voxel, on every level, whose three intervals contain the
 * thick ray at the t of a hit; accel/clipping.h, that the voxels of its q are among those and list the
 * object. A range is rejected only if none of its voxels comes near. `slack` adds to both distances, which
 * only lengthens lists. */
#include "accel/grid/grid.h"

#include "accel/kernel.h"
#include "core/base/elementary.h"

#include <assert.h>
#include <string.h>

const RtParam rt_grid_params[RT_GRID_PARAM_COUNT] = {RT_GRID_PARAMS(RT_PARAM_ENTRY)};

/* ---- resolution ---- */

static uint32_t clamp_resolution(double n) {
    return n < 1 ? 1 : n > RT_GRID_MAX_RESOLUTION ? RT_GRID_MAX_RESOLUTION : (uint32_t)n;
}

/* The size of the box relative to its longest side, at least 2^-10: a flat scene has voxels, too. */
static RtVec3d solid_size(const RtBox *box) {
    RtVec3d s = rt_subd(rt_widen(box->hi), rt_widen(box->lo));
    double longest = fmax(s.x, fmax(s.y, s.z));
    if (longest == 0) return rt_vec3d(1, 1, 1);
    for (int a = 0; a < 3; a++) s.at[a] = fmax(s.at[a], longest * 0x1p-10) / longest;
    return s;
}

/* Rounds down, allowing for rounding errors just below an integer. */
static double whole(double x) {
    return floor(x * (1 + 1e-12));
}

static void choose_resolution(const RtBox *box, uint32_t objects, const RtValue *values, uint32_t n[3]) {
    RtVec3d s = solid_size(box);
    double voxels = values[RT_GRID_DENSITY].f * objects;
    switch (values[RT_GRID_RULE].choice) {
    case RT_GRID_CUBIC: {
        double per_side = rt_cube_root(voxels / (s.x * s.y * s.z));
        for (int a = 0; a < 3; a++) n[a] = clamp_resolution(whole(s.at[a] * per_side + 0.5));
        break;
    }
    case RT_GRID_WOO:
        for (int a = 0; a < 3; a++) n[a] = clamp_resolution(whole(s.at[a] * rt_cube_root(voxels)));
        break;
    case RT_GRID_HETEROGENEOUS:
        n[0] = clamp_resolution(whole(rt_cube_root(voxels * s.x * s.x / (s.y * s.z)) + 0.5));
        n[1] = clamp_resolution(whole(sqrt(voxels * s.y / (n[0] * s.z)) + 0.5));
        n[2] = clamp_resolution(whole(voxels / ((double)n[0] * n[1]) + 0.5));
        break;
    case RT_GRID_REGULAR:
        n[0] = n[1] = n[2] = clamp_resolution(ceil(rt_cube_root(voxels) * (1 - 1e-12)));
        break;
    default: assert(false && "no such rule");
    }
}

/* ---- the voxels of an object ---- */

RtBox rt_grid_object_box(const RtGrid *grid, uint32_t id) {
    RtBox box = grid->base.scene->geometry.boxes[id];
    for (int a = 0; a < 3; a++) {
        box.lo.at[a] = rt_float_below((double)box.lo.at[a] - grid->slack);
        box.hi.at[a] = rt_float_above((double)box.hi.at[a] + grid->slack);
    }
    return box;
}

/* A range of voxels, inclusive on each axis. */
typedef struct Range {
    uint32_t from[3], to[3];
} Range;

static RtBox range_box(const RtGridBlock *block, const Range *range) {
    RtBox box;
    for (int a = 0; a < 3; a++) {
        box.lo.at[a] = block->planes[a][range->from[a]];
        box.hi.at[a] = block->planes[a][range->to[a] + 1];
    }
    return box;
}

RtBox rt_grid_voxel_box(const RtGridBlock *block, const uint32_t at[3]) {
    return range_box(block, &(Range){{at[0], at[1], at[2]}, {at[0], at[1], at[2]}});
}

bool rt_grid_surface_meets(const RtGrid *grid, const RtOutline *outline, const RtBox *box) {
    return rt_outline_meets_box(outline, box, grid->slack + grid->served.margin);
}

/* The intervals of planes that a box, which meets the block, overlaps on each axis. An interval contains its
 * lower plane but not its upper one, unless it is the last. */
static Range find_range(const RtGridBlock *block, const RtBox *box) {
    Range range;
    for (int a = 0; a < 3; a++) {
        const float *plane = block->planes[a], lo = box->lo.at[a];
        uint32_t n = block->n[a];
        float width = plane[n] - plane[0];
        float guess = width > 0 ? (lo - plane[0]) / width * (float)n : 0;
        uint32_t i = guess > 0 ? (uint32_t)rt_minf(guess, (float)(n - 1)) : 0;
        while (i > 0 && plane[i] > lo) i--;
        while (i + 1 < n && plane[i + 1] <= lo) i++;
        range.from[a] = i;
        while (i + 1 < n && plane[i + 1] <= box->hi.at[a]) i++;
        range.to[a] = i;
    }
    return range;
}

/* Halves the range along its longest axis; false for a single voxel. */
static bool halve(Range *range, Range *other) {
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

/* Both passes over the lists of a block: adds 1 to slot[v] for every voxel v of an object and, in the fill
 * pass, stores the object at that slot. */
typedef struct Lists {
    const RtGridBlock *block;
    uint32_t *slot, *ids;
} Lists;

static void add_range(const Lists *lists, uint32_t id, const Range *range) {
    uint32_t at[3];
    for (at[2] = range->from[2]; at[2] <= range->to[2]; at[2]++) {
        for (at[1] = range->from[1]; at[1] <= range->to[1]; at[1]++) {
            for (at[0] = range->from[0]; at[0] <= range->to[0]; at[0]++) {
                uint32_t *entry = &lists->slot[rt_grid_voxel_at(lists->block, at)];
                if (lists->ids) lists->ids[*entry] = id;
                ++*entry;
            }
        }
    }
}

/* Each halving pushes one range; 3 axes of 4096 voxels are halved 36 times. */
enum { MAX_RANGES = 40 };

/* Adds an object, which belongs into the block, to the voxels that list it, disjoint ranges. */
static void add_object(const RtGrid *grid, const Lists *lists, uint32_t id) {
    RtBox object = rt_grid_object_box(grid, id);
    Range stack[MAX_RANGES], range = find_range(lists->block, &object);
    uint32_t stacked = 0;
    if (!grid->surfaces) {
        add_range(lists, id, &range);
        return;
    }
    RtOutline outline = rt_object_outline(&grid->base.scene->geometry, id);
    for (;;) {
        RtBox box = range_box(lists->block, &range);
        if (rt_grid_surface_meets(grid, &outline, &box)) {
            if (halve(&range, &stack[stacked])) {
                stacked++;
                continue;
            }
            add_range(lists, id, &range);
        }
        if (stacked == 0) return;
        range = stack[--stacked];
    }
}

/* ---- memory ---- */

/* Upper bound on the intervals of n along an axis that a box touches: planes are rounded. */
static double bound_touched(const RtBox *block, const RtBox *box, int axis, uint32_t n) {
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
        for (int a = 0; a < 3; a++) product *= bound_touched(box, &object, a, n[a]);
        sum += product;
    }
    return sum * sizeof(uint32_t);
}

static void clamp_each(const uint32_t n[3], uint32_t most, uint32_t out[3]) {
    for (int a = 0; a < 3; a++) out[a] = n[a] < most ? n[a] : most;
}

/* Fails if level 0 with all objects ids[0..count) would exceed `limit` bytes by that bound; the message names
 * a resolution that would fit. */
static RtStatus check_limit(const RtGrid *grid, const uint32_t n[3], const uint32_t *ids, uint32_t count,
                            uint64_t limit, RtError *error) {
    double bytes = rt_grid_estimate(grid, &grid->box, n, ids, count), most = (double)limit;
    if (bytes <= most) return RT_OK;
    /* Bisection: `fits` voxels a side fit, or it is 1; `excess` do not. */
    uint32_t fits = 1, excess = 1, smaller[3];
    for (int a = 0; a < 3; a++) excess = n[a] > excess ? n[a] : excess;
    while (fits + 1 < excess) {
        uint32_t middle = (fits + excess) / 2;
        clamp_each(n, middle, smaller);
        if (rt_grid_estimate(grid, &grid->box, smaller, ids, count) <= most)
            fits = middle;
        else
            excess = middle;
    }
    clamp_each(n, fits, smaller);
    return rt_fail(error, RT_BAD_INPUT,
                   "a grid of %ux%ux%u voxels would take up to %.3g GiB, more than %.3g GiB: "
                   "resolution=%ux%ux%u would fit",
                   n[0], n[1], n[2], bytes / 0x1p30, most / 0x1p30, smaller[0], smaller[1], smaller[2]);
}

/* ---- the blocks of a level ---- */

bool rt_grid_find_voxel(RtGridVoxel *voxel) {
    const RtGridLevel *level = voxel->level;
    if (voxel->number >= level->voxel_count) return false;
    while (voxel->block + 1 < level->block_count && level->blocks[voxel->block + 1].voxel <= voxel->number)
        voxel->block++;
    const RtGridBlock *block = &level->blocks[voxel->block];
    const uint32_t within = voxel->number - block->voxel, row = within / block->n[0];
    voxel->at[0] = within % block->n[0];
    voxel->at[1] = row % block->n[1];
    voxel->at[2] = row / block->n[1];
    voxel->box = rt_grid_voxel_box(block, voxel->at);
    return true;
}

static size_t planes_of(const uint32_t n[3]) {
    return (size_t)n[0] + n[1] + n[2] + 3;
}

uint64_t rt_grid_level_bytes(const RtGridLevel *level) {
    size_t entries = (size_t)level->voxel_count + 1 + level->first[level->voxel_count], planes = 0;
    if (level->inner) entries += level->voxel_count;
    for (uint32_t b = 0; b < level->block_count; b++) planes += planes_of(level->blocks[b].n);
    return level->block_count * sizeof(RtGridBlock) + planes * sizeof(float) + entries * sizeof(uint32_t);
}

static RtStatus allocate_blocks(RtGrid *grid, RtGridLevel *level, size_t planes, RtError *error) {
    level->blocks = rt_arena_alloc(&grid->base.memory, level->block_count, sizeof(RtGridBlock));
    level->planes = rt_arena_alloc(&grid->base.memory, planes, sizeof(float));
    return rt_arena_check(&grid->base.memory, "the planes of a grid", error);
}

/* Makes the next block of a level, n voxels along each axis of `box`, whose planes begin at `plane`; returns
 * where they end. */
static float *make_block(RtGridLevel *level, RtGridBlock *block, const RtBox *box, const uint32_t n[3],
                         float *plane) {
    memcpy(block->n, n, sizeof block->n);
    block->voxel = level->voxel_count;
    level->voxel_count += n[0] * n[1] * n[2];
    for (int a = 0; a < 3; a++) {
        double lo = (double)box->lo.at[a], width = (double)box->hi.at[a] - lo;
        block->planes[a] = plane;
        for (uint32_t i = 0; i <= n[a]; i++) plane[i] = (float)(lo + width * i / n[a]);
        plane[n[a]] = box->hi.at[a];
        plane += n[a] + 1;
    }
    return plane;
}

/* Whether dividing a voxel of more than `nest` objects can separate them: some object does not fill it, and
 * float32 has a plane inside it. */
static bool divisible(const RtGrid *grid, const RtBox *box, const uint32_t *ids, uint32_t count,
                      int64_t nest) {
    bool has_plane = false;
    if (count <= nest) return false;
    for (int a = 0; a < 3; a++) has_plane |= nextafterf(box->lo.at[a], INFINITY) < box->hi.at[a];
    for (uint32_t i = 0; has_plane && i < count; i++) {
        if (!rt_box_contains(rt_grid_object_box(grid, ids[i]), *box)) return true;
    }
    return false;
}

/* Cuts the voxels of level `depth - 1` that hold too many objects into blocks of level `depth`, without
 * lists yet. A resolution of one voxel makes no grid. */
static RtStatus cut_level(RtGrid *grid, const RtBuild *what, uint32_t depth, RtError *error) {
    RtGridLevel *from = &grid->levels[depth - 1], *to = &grid->levels[depth];
    double bytes = 0; /* of the levels so far, and estimated for the new one */
    size_t planes = 0;
    uint32_t n[3];
    from->inner = rt_arena_alloc(&grid->base.memory, from->voxel_count, sizeof(uint32_t));
    RT_TRY(rt_arena_check(&grid->base.memory, "nested grids", error));
    for (uint32_t level = 0; level < depth; level++)
        bytes += (double)rt_grid_level_bytes(&grid->levels[level]);
    for (RtGridVoxel voxel = {.level = from}; rt_grid_find_voxel(&voxel); voxel.number++) {
        const uint32_t first = from->first[voxel.number], count = from->first[voxel.number + 1] - first;
        from->inner[voxel.number] = RT_GRID_LEAF;
        if (!divisible(grid, &voxel.box, from->ids + first, count, what->values[RT_GRID_NEST].i)) continue;
        choose_resolution(&voxel.box, count, what->values, n);
        if ((size_t)n[0] * n[1] * n[2] == 1) continue;
        from->inner[voxel.number] = to->block_count++;
        planes += planes_of(n);
        bytes += rt_grid_estimate(grid, &voxel.box, n, from->ids + first, count) +
                 (double)(planes_of(n) * sizeof(float) + sizeof(RtGridBlock));
        if (bytes > (double)what->limit)
            return rt_fail(error, RT_BAD_INPUT,
                           "%u levels of grids may take more than %.3g GiB: depth=%u would fit", depth + 1,
                           (double)what->limit / 0x1p30, depth);
    }
    RT_TRY(allocate_blocks(grid, to, planes, error));
    float *plane = to->planes;
    for (RtGridVoxel voxel = {.level = from}; rt_grid_find_voxel(&voxel); voxel.number++) {
        if (from->inner[voxel.number] == RT_GRID_LEAF) continue;
        choose_resolution(&voxel.box, from->first[voxel.number + 1] - from->first[voxel.number], what->values,
                          n);
        plane = make_block(to, &to->blocks[from->inner[voxel.number]], &voxel.box, n, plane);
    }
    return RT_OK;
}

/* ---- the lists of a level ---- */

/* Distributes the objects of the voxels of `from` to the blocks of `to` that are nested in them. */
static void scatter(const RtGrid *grid, const RtGridLevel *from, const RtGridLevel *to, uint32_t *slot,
                    uint32_t *ids) {
    for (uint32_t v = 0; v < from->voxel_count; v++) {
        if (from->inner[v] == RT_GRID_LEAF) continue;
        const Lists lists = {&to->blocks[from->inner[v]], slot, ids};
        for (uint32_t i = from->first[v]; i < from->first[v + 1]; i++) add_object(grid, &lists, from->ids[i]);
    }
}

static RtStatus make_lists(RtGrid *grid, const RtGridLevel *from, RtGridLevel *to, RtError *error) {
    size_t voxels = to->voxel_count;
    to->first = rt_arena_alloc(&grid->base.memory, voxels + 1, sizeof(uint32_t));
    RT_TRY(rt_arena_check(&grid->base.memory, "the voxels of a grid", error));
    /* Count pass; ends of lists; fill pass, after which first[v] is the end of list v: shift by one. */
    scatter(grid, from, to, to->first, NULL);
    uint32_t sum = 0;
    for (size_t v = 0; v <= voxels; v++) {
        uint32_t length = to->first[v];
        to->first[v] = sum;
        sum += length;
    }
    to->ids = rt_arena_alloc(&grid->base.memory, sum, sizeof(uint32_t));
    RT_TRY(rt_arena_check(&grid->base.memory, "the lists of a grid", error));
    scatter(grid, from, to, to->first, to->ids);
    memmove(to->first + 1, to->first, voxels * sizeof(uint32_t));
    to->first[0] = 0;
    return RT_OK;
}

static RtStatus drop_lists(RtGrid *grid, RtGridLevel *level, RtError *error) {
    uint32_t kept = 0;
    for (uint32_t v = 0; v < level->voxel_count; v++) {
        uint32_t from = level->first[v], count = level->first[v + 1] - from;
        level->first[v] = kept;
        if (level->inner[v] != RT_GRID_LEAF) continue;
        memmove(level->ids + kept, level->ids + from, count * sizeof(uint32_t));
        kept += count;
    }
    level->first[level->voxel_count] = kept;
    RtArena *memory = &grid->base.memory;
    uint32_t *ids = rt_arena_alloc(memory, kept, sizeof(uint32_t));
    RT_TRY(rt_arena_check(memory, "the lists of a grid", error));
    memcpy(ids, level->ids, kept * sizeof(uint32_t));
    rt_arena_free(memory, level->ids);
    level->ids = ids;
    return RT_OK;
}

/* ---- build ---- */

/* Level 0, from a single voxel that holds everything. */
static RtStatus make_root(RtGrid *grid, const RtBuild *what, RtError *error) {
    RtGridLevel *level = &grid->levels[0];
    uint32_t objects = what->scene->geometry.object_count, root = 0, first[2] = {0, objects}, n[3];
    const uint32_t *given = what->values[RT_GRID_RESOLUTION].resolution;
    RT_ARENA(arena);
    uint32_t *ids = rt_arena_alloc(&arena, objects, sizeof(uint32_t));
    RT_TRY(rt_arena_check(&arena, "the objects of a grid", error));
    for (uint32_t id = 0; id < objects; id++) ids[id] = id;
    const RtGridLevel all = {.first = first, .ids = ids, .inner = &root, .voxel_count = 1};
    choose_resolution(&grid->box, objects, what->values, n);
    if (given[0] > 0) memcpy(n, given, sizeof n);
    RT_TRY(check_limit(grid, n, ids, objects, what->limit, error));
    level->block_count = 1;
    RT_TRY(allocate_blocks(grid, level, planes_of(n), error));
    make_block(level, level->blocks, &grid->box, n, level->planes);
    return make_lists(grid, &all, level, error);
}

static RtStatus make_levels(RtGrid *grid, const RtBuild *what, RtError *error) {
    RT_TRY(make_root(grid, what, error));
    for (grid->depth = 1; grid->depth < what->values[RT_GRID_DEPTH].i; grid->depth++) {
        RtGridLevel *from = &grid->levels[grid->depth - 1], *to = from + 1;
        RT_TRY(cut_level(grid, what, grid->depth, error));
        if (to->block_count == 0) {
            rt_arena_free(&grid->base.memory, from->inner);
            from->inner = NULL;
            break;
        }
        RT_TRY(make_lists(grid, from, to, error));
        RT_TRY(drop_lists(grid, from, error));
    }
    return RT_OK;
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
    grid->box = g->box;
    RT_TRY(rt_set_mailbox(accel, values[RT_GRID_MAILBOX].flag, error));
    grid->surfaces = values[RT_GRID_OVERLAP].choice == RT_GRID_EXACT;
    grid->slack = values[RT_GRID_SLACK].f;
    if (g->object_count == 0) return RT_OK;
    grid->box = choose_box(g, values[RT_GRID_FLAT].f, values[RT_GRID_MARGIN].f);
    grid->served = rt_clipped_rays(&g->box, &grid->box);
    return make_levels(grid, what, error);
}
