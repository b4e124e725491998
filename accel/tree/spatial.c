/* SPDX-License-Identifier: Apache-2.0 */
/* Trees from the top whose splits may cut objects: each part becomes a reference of its own.
 *
 * Paper: Stich, Friedrich & Dietrich 2009, "Spatial Splits in Bounding Volume Hierarchies" (HPG). At a node
 * the best object split (binned SAH) competes with the best spatial split (spatial_bins.h), wherever the
 * boxes of the two sides of the object split overlap by more than `alpha` of the root's area. At the plane a
 * reference is cut, or goes to one side whole where that costs less (reference unsplitting). A group that is
 * smaller than such an overlap is not cut, nor is anything below it.
 *
 * Invariant. Each point of an object's surface is in the box of one of its references: when a plane cuts a
 * box both parts contain the plane, and rt_object_part shrinks a part only where there is no surface. So
 * every point s of the surface is in the box of some leaf and of all its ancestors. At the t of a hit the ray
 * is in every box that contains the point s near to it (accel/clipping.h), so it meets all of these: it
 * enters each at or before t and leaves it at or after t. The rest of the proof is in core/base/ray.h. The
 * parts of a CSG tree together contain its whole box.
 *
 * A budget limits the number of references. A node has a share of the spare references, and divides it among
 * its children by the sum of the areas of their references, which is the expected number of tests: cuts gain
 * most there. (Dividing by the number of references makes trees worse than uncut ones if the budget is
 * tight.) What the left child does not use goes to the right one in groups of at most SMALL references, and
 * is lost in larger ones. So the references of a node lie in one run with its spare slots behind them, its
 * nodes have as many slots, and subtrees are built in parallel. Finally the gaps between nodes are closed:
 * the tree does not depend on the number of threads. */
#include "accel/clipping.h"
#include "accel/tree/hierarchy.h"
#include "accel/tree/spatial_bins.h"
#include "accel/tree/topdown.h"
#include "core/base/memory.h"
#include "core/base/parallel.h"
#include "core/shape/overlap.h"

#include <assert.h>
#include <stdatomic.h>

typedef struct Builder {
    RtTree *tree; /* with room for all references that the budget allows */
    const RtGeometry *geometry;
    RtTreeRef *refs; /* [budget] */
    RtSpatial how;
    double least_overlap; /* half area above which spatial splits are tried */
    double margin;        /* for rt_object_part */
} Builder;

/* The references of a subtree: refs[first..first + count), followed by `spare` free slots. Its nodes are
 * among nodes[node..node + 2 * (count + spare) - 1). */
typedef struct Group {
    uint32_t first, count, spare, node;
    int depth;
    bool was_cut; /* some reference in it was cut */
} Group;

static RtBox4 box_of(const RtTreeRef *refs, uint32_t count) {
    RtBox4 box = rt_box4_empty();
    for (uint32_t i = 0; i < count; i++) box = rt_box4_union(box, rt_box4_load(&refs[i].box));
    return box;
}

static double area_of(RtBox4 box) {
    RtBox b;
    rt_box4_store(&b, box);
    return rt_box_half_area(b);
}

/* ---- cutting ---- */

enum { LEFT = 0, RIGHT = 1, BOTH = 2 };

/* The side of a reference that has parts on both sides of the plane; updates *sides. */
static int choose_side(RtSides *sides, RtBox4 whole, bool may_cut) {
    RtSides left = *sides, right = *sides;
    left.box[0] = rt_box4_union(left.box[0], whole);
    left.count[1]--;
    right.box[1] = rt_box4_union(right.box[1], whole);
    right.count[0]--;
    rt_sides_set_cost(&left);
    rt_sides_set_cost(&right);
    rt_sides_set_cost(sides);
    if (may_cut && sides->cost < left.cost && sides->cost < right.cost) return BOTH;
    *sides = right.cost < left.cost ? right : left;
    return right.cost < left.cost ? RIGHT : LEFT;
}

/* Partitions the group at the plane, left side first; counts[2] are the numbers of references. */
static void cut_at(RtTreeRef *refs, const RtSpatialGroup *group, const RtSpatialSplit *plane,
                   uint32_t counts[2]) {
    RtSides sides = plane->sides;
    uint32_t left = 0, end = group->count, added = 0;
    while (left < end) {
        RtTreeRef ref = refs[left];
        int side = ref.box.lo.at[plane->axis] >= plane->at ? RIGHT : LEFT;
        if (side == LEFT && ref.box.hi.at[plane->axis] > plane->at) {
            RtBox lower, upper;
            bool below = rt_ref_part(group, &ref, plane->axis, -INFINITY, plane->at, &lower);
            bool above = rt_ref_part(group, &ref, plane->axis, plane->at, INFINITY, &upper);
            side = below && above ? choose_side(&sides, rt_box4_load(&ref.box), added < group->spare)
                   : above        ? RIGHT
                                  : LEFT;
            if (side == BOTH) refs[group->count + added++] = (RtTreeRef){upper, ref.id};
            if (side == BOTH || (below && !above)) ref.box = lower;
            if (above && !below) ref.box = upper;
        }
        if (side != RIGHT) {
            refs[left++] = ref;
        } else {
            refs[left] = refs[--end];
            refs[end] = ref;
        }
    }
    counts[0] = left;
    counts[1] = group->count - left + added;
}

/* ---- the tree ---- */

/* Splits a group of at least 2 in two, which follow one another. Returns false, and splits nothing, where a
 * tree without cuts will do: nothing can be cut, or a leaf is cheaper. */
static bool split_group(const Builder *b, Group *group, uint32_t counts[2]) {
    RtTreeRef *refs = b->refs + group->first;
    uint32_t count = group->count;
    RtBox4 centers[2], box;
    if (group->spare == 0 || group->depth >= RT_TREE_MEDIAN_DEPTH) return false;
    box = box_of(refs, count);
    double area = area_of(box);
    if (!(area > b->least_overlap)) return false;
    counts[0] = rt_split_binned(refs, count, b->how.bins, rt_refs_centers(refs, count), centers);
    counts[1] = count - counts[0];
    if (counts[0] == 0) return false;
    RtSides sides = {
        0, {box_of(refs, counts[0]), box_of(refs + counts[0], counts[1])}, {counts[0], counts[1]}};
    rt_sides_set_cost(&sides);
    RtBox4 common = {rt_max(sides.box[0].lo, sides.box[1].lo), rt_min(sides.box[0].hi, sides.box[1].hi)};
    RtSpatialGroup spatial = {b->geometry, refs, count, group->spare, box, b->margin};
    RtSpatialSplit plane = {.sides.cost = INFINITY};
    /* Cutting takes most of the time, so there are never more bins than for small groups. */
    if (area_of(common) > b->least_overlap)
        plane = rt_spatial_bins_split(&spatial, (int)rt_bin_count(b->how.bins, 0));
    double least = fmin(sides.cost, plane.sides.cost);
    if (count <= b->how.leaf && area * count <= area * b->how.traversal + least) return false;
    if (!(plane.sides.cost < sides.cost)) return true;
    cut_at(refs, &spatial, &plane, counts);
    group->was_cut |= counts[0] + counts[1] > count;
    if (counts[0] == 0 || counts[1] == 0) {
        counts[0] = rt_split_median(refs, count);
        counts[1] = count - counts[0];
    }
    return true;
}

static double sum_of_areas(const RtTreeRef *refs, uint32_t count) {
    double sum = 0;
    for (uint32_t i = 0; i < count; i++) sum += rt_box_half_area(refs[i].box);
    return sum;
}

/* The two sides of a split group, each with its share of the spare slots behind it. */
static void make_sides(const Builder *b, const Group *group, const uint32_t counts[2], Group sides[2]) {
    uint32_t total = counts[0] + counts[1], spare = group->count + group->spare - total;
    RtTreeRef *refs = b->refs + group->first;
    double left = sum_of_areas(refs, counts[0]), both = left + sum_of_areas(refs + counts[0], counts[1]);
    uint32_t right = both > 0 ? (uint32_t)(spare * (1 - left / both)) : spare / 2;
    uint32_t right_at = counts[0] + spare - right;
    memmove(refs + right_at, refs + counts[0], counts[1] * sizeof(RtTreeRef));
    sides[0] = (Group){group->first, counts[0], spare - right, group->node + 1, group->depth + 1, false};
    sides[1] = (Group){group->first + right_at,    counts[1],        right,
                       group->node + 2 * right_at, group->depth + 1, false};
}

/* Groups of at most so many references pass unused slots on; groups of the top are larger. */
enum { SMALL = 1 << 12 };

/* Passes on to the right side what the left one, with `left` nodes, did not use. */
static void pass_on(const Builder *b, Group sides[2], uint32_t left) {
    uint32_t unused = sides[0].count + sides[0].spare - (left + 1) / 2;
    RtTreeRef *refs = b->refs + sides[1].first;
    if (unused == 0) return;
    memmove(refs - unused, refs, sides[1].count * sizeof(RtTreeRef));
    sides[1].first -= unused;
    sides[1].spare += unused;
}

/* Builds the subtree of a group from node group->node on, without gaps; returns its number of nodes. */
static uint32_t build(const Builder *b, Group *group) {
    uint32_t counts[2];
    Group sides[2];
    if (!split_group(b, group, counts)) {
        RtTreeRef *refs = b->refs + group->first;
        RtSubtreeBuilder plain = {b->tree, b->how.bins};
        rt_subtree_build(&plain, (RtRefGroup){refs, group->count, group->node, group->depth,
                                              rt_refs_centers(refs, group->count)});
        return 2 * group->count - 1;
    }
    make_sides(b, group, counts, sides);
    uint32_t left = build(b, &sides[0]);
    sides[1].node = group->node + 1 + left;
    if (group->count <= SMALL) pass_on(b, sides, left);
    uint32_t right = build(b, &sides[1]);
    group->was_cut |= sides[0].was_cut || sides[1].was_cut;
    rt_tree_set_union(b->tree, group->node, group->node + 1, sides[1].node);
    return 1 + left + right;
}

/* ---- on all threads ---- */

enum { SHARES = 16 }; /* subtrees are built by one thread below this fraction of a thread's share */

/* Nodes without gaps: a subtree, or one node of the top. */
typedef struct Run {
    Group group;
    uint32_t children; /* of a node of the top: the first of two runs; 0 for a subtree */
    uint32_t used, at; /* number of nodes, and the first of them in the final tree */
} Run;

typedef struct Top {
    const Builder *b;
    Run *runs; /* [run_count] parents before their children */
    _Atomic uint32_t run_count;
    uint32_t limit; /* larger groups belong to the top */
    RtTree into;    /* the tree without gaps */
} Top;

/* Splits a run while it is large, and builds the last left side; the right sides become tasks. */
static RtStatus build_run(void *context, RtTasks *tasks, const void *task, RtError *error) {
    Top *top = context;
    Run *run = &top->runs[*(const uint32_t *)task];
    uint32_t counts[2];
    while (run->group.count > top->limit && split_group(top->b, &run->group, counts)) {
        Group sides[2];
        make_sides(top->b, &run->group, counts, sides);
        uint32_t left = atomic_fetch_add(&top->run_count, 2), right = left + 1;
        for (uint32_t s = 0; s < 2; s++) top->runs[left + s] = (Run){.group = sides[s]};
        run->children = left;
        run->used = 1;
        if (!rt_tasks_add(tasks, &right)) return rt_fail_memory(error, "a subtree", sizeof(Run));
        run = &top->runs[left];
    }
    run->used = build(top->b, &run->group);
    return RT_OK;
}

static void move_run(void *context, size_t item) {
    Top *top = context;
    const Run *run = &top->runs[item];
    uint32_t from = run->group.node;
    for (uint32_t i = 0; i < run->used && run->children == 0; i++) {
        RtTreeNode node = top->b->tree->nodes[from + i];
        bool leaf = node.child[0] == RT_TREE_LEAF;
        for (int s = 0; s < 2 && !leaf; s++) node.child[s] = node.child[s] - from + run->at;
        top->into.nodes[run->at + i] = node;
    }
}

/* Assigns nodes, from `at` on, to a run and those below it; returns the end. */
static uint32_t assign_nodes(Top *top, uint32_t index, uint32_t at) {
    Run *run = &top->runs[index];
    run->at = at;
    at += run->used;
    for (uint32_t s = 0; s < 2 && run->children > 0; s++) at = assign_nodes(top, run->children + s, at);
    return at;
}

/* Copies the runs to a tree without gaps between them. */
static RtStatus close_gaps(Top *top, RtTree *tree, int threads, RtError *error) {
    uint32_t used = assign_nodes(top, 0, 0), runs = top->run_count;
    bool was_cut = false;
    for (uint32_t r = 0; r < runs; r++) was_cut |= top->runs[r].group.was_cut;
    if (runs > 1) {
        RT_TRY(rt_tree_init(&top->into, (used + 1) / 2, error));
        RtStatus status = rt_parallel_each(runs, threads, move_run, top, error);
        for (uint32_t r = runs; r-- > 0 && status == RT_OK;) {
            const Run *run = &top->runs[r], *child = &top->runs[run->children];
            if (run->children > 0) rt_tree_set_union(&top->into, run->at, child[0].at, child[1].at);
        }
        rt_tree_clear(tree);
        *tree = top->into;
        RT_TRY(status);
    }
    tree->used = tree->capacity = used;
    tree->split_refs = was_cut;
    return RT_OK;
}

static RtStatus build_all(Builder *b, RtTree *tree, uint32_t count, uint32_t most, int threads,
                          RtError *error) {
    uint32_t parts = SHARES * (uint32_t)rt_thread_count(threads), root = 0;
    Top top = {.b = b, .run_count = 1};
    top.limit = parts == SHARES ? most : most / parts > SMALL ? most / parts : SMALL;
    size_t runs = 1 + (size_t)2 * RT_TREE_MEDIAN_DEPTH * (most / top.limit);
    top.runs = rt_alloc(runs, sizeof(Run));
    if (!top.runs) return rt_fail_memory(error, "the top of a tree with spatial splits", runs * sizeof(Run));
    top.runs[0].group = (Group){.count = count, .spare = most - count};
    int workers = count > top.limit ? threads : 1;
    RtStatus status = rt_parallel_tasks(&root, 1, sizeof root, workers, build_run, &top, error);
    rt_free(b->refs); /* before there are two trees */
    b->refs = NULL;
    if (status == RT_OK) status = close_gaps(&top, tree, threads, error);
    rt_free(top.runs);
    return status;
}

/* Peak bytes per reference: the tree, and the hierarchy that is laid out from it. */
enum { REF_BYTES = 2 * sizeof(RtTreeNode) + 2 * sizeof(RtNode) + sizeof(uint32_t) + 2 * sizeof(bool) };

static RtStatus check_limit(const RtSpatial *how, uint32_t count, RtError *error) {
    assert(count > 0);
    double most = (double)how->limit, bytes = count * how->budget * REF_BYTES;
    if (bytes <= most) return RT_OK;
    double fits = floor(most / REF_BYTES / count * 10) / 10;
    if (fits < 1)
        return rt_fail(error, RT_BAD_INPUT,
                       "spatial splits of %u objects would take at least %.3g GiB, more than %.3g GiB: "
                       "choose another build",
                       count, (double)count * REF_BYTES / 0x1p30, most / 0x1p30);
    return rt_fail(
        error, RT_BAD_INPUT,
        "spatial splits with up to %g references per object may take %.3g GiB, more than %.3g GiB: "
        "budget=%g would fit",
        how->budget, bytes / 0x1p30, most / 0x1p30, fits);
}

RtStatus rt_tree_spatial(RtTree *tree, const RtGeometry *geometry, const RtSpatial *how, int threads,
                         RtError *error) {
    uint32_t count = geometry->object_count;
    RT_TRY(check_limit(how, count, error));
    bool is_tiny = rt_box_longest_side(geometry->box) < RT_CLIPPED_LEAST_SIDE;
    uint32_t most = is_tiny ? count : (uint32_t)(count * how->budget);
    RT_TRY(rt_tree_init(tree, most, error));
    Builder b = {.tree = tree,
                 .geometry = geometry,
                 .refs = rt_alloc_unset(most, sizeof(RtTreeRef)),
                 .how = *how,
                 .least_overlap = how->alpha * rt_box_half_area(geometry->box),
                 .margin = rt_tree_part_margin(&geometry->box)};
    RtStatus status = RT_NO_MEMORY;
    if (b.refs) {
        for (uint32_t i = 0; i < count; i++) b.refs[i] = (RtTreeRef){geometry->boxes[i], i};
        status = build_all(&b, tree, count, most, threads, error);
    } else {
        rt_fail_memory(error, "references of a tree with spatial splits", most * sizeof(RtTreeRef));
    }
    rt_free(b.refs);
    if (status != RT_OK) rt_tree_clear(tree);
    return status;
}
