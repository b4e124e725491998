/* SPDX-License-Identifier: Apache-2.0 */
/* Trees from the top whose splits may cut objects: each part is a reference of its own.
 *
 * Paper: Stich, Friedrich & Dietrich 2009, "Spatial Splits in Bounding Volume Hierarchies" (HPG). At a node
 * the best split of the references in two groups (by the surface area heuristic, in bins of centres) is held
 * against the best plane that parts their surfaces (slabs.h), wherever the two groups' boxes overlap by more
 * than `alpha` of the root's area. On the plane a reference is cut, or goes to one side whole where that
 * costs less (reference unsplitting). A group that is smaller than such an overlap is not cut, nor what is
 * below it.
 *
 * Invariant. Each point of an object's surface is in the box of one of its references: when a box is cut by a
 * plane both parts keep the plane, and rt_object_part makes a part smaller only where the surface is not. So
 * every point s of the surface is in a leaf's box and in all the boxes above; and a ray thick enough to be,
 * at the t of a hit, in every box that holds the point s near to it (accel/surface.h) meets all of those,
 * each entered at or before t and left at or after it. What else makes pruning exact, core/base/ray.h says.
 *
 * Parts may not exceed a budget of references. A node has a share of what is left of it; it divides it among
 * its children by the sums of their references' areas, which are the tests that a random line is expected to
 * take: there cuts gain most. (Shares by the number of references make trees that are worse than uncut ones
 * where the budget was tight.) What the left child did not use the right one may if they are
 * FEW together; above that it is lost. So the references of a node lie in a row with its share of free places
 * behind them, its nodes have as many places, and subtrees are built by threads that know nothing of each
 * other. The top is built level by level, a group a thread. In the end the gaps between nodes are closed: the
 * tree is that of one thread. */
#include "accel/tree/hierarchy.h"
#include "accel/tree/slabs.h"
#include "accel/tree/subtree.h"
#include "core/base/memory.h"
#include "core/base/parallel.h"
#include "core/shape/overlap.h"

#include <assert.h>
#include <stdlib.h>

typedef struct Builder {
    RtTree *tree; /* with room for all parts there may be */
    const RtGeometry *geometry;
    RtTreeRef *refs; /* [budget] */
    RtSpatial how;
    double least_overlap; /* half area of it at which planes are tried */
    double margin;        /* for rt_object_part */
} Builder;

/* What is to be a subtree: refs[first..first + count), followed by `spare` free places. Its nodes are some of
 * nodes[node..node + 2 * (count + spare) - 1). */
typedef struct Group {
    uint32_t first, count, spare, node;
    int depth;
    bool divided; /* something in it was cut */
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

/* Where a reference that has parts on both sides of the plane goes; the sides are made to say so. */
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

/* Parts the group at the plane: what is left comes first. Gives the number of references on each side. */
static void cut_at(RtTreeRef *refs, const RtSlabGroup *group, const RtCut *plane, uint32_t counts[2]) {
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

/* Splits a group of at least 2 in two, which stand in its places one after the other. False, and nothing is
 * split, where a tree that cuts nothing serves: nothing can be cut, or one leaf is better. */
static bool divide(const Builder *b, Group *group, uint32_t counts[2]) {
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
    RtSlabGroup slabs = {b->geometry, refs, count, group->spare, box, b->margin};
    RtCut plane = {.sides.cost = INFINITY};
    if (area_of(common) > b->least_overlap) plane = rt_slabs_find_plane(&slabs, b->how.bins);
    double least = fmin(sides.cost, plane.sides.cost);
    if (count <= b->how.leaf && area * count <= area * b->how.traversal + least) return false;
    if (!(plane.sides.cost < sides.cost)) return true;
    cut_at(refs, &slabs, &plane, counts);
    group->divided |= counts[0] + counts[1] > count;
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

/* The two sides of a group, each with its share of the free places behind it. */
static void share_out(const Builder *b, const Group *group, const uint32_t counts[2], Group sides[2]) {
    uint32_t total = counts[0] + counts[1], spare = group->count + group->spare - total;
    RtTreeRef *refs = b->refs + group->first;
    double left = sum_of_areas(refs, counts[0]), both = left + sum_of_areas(refs + counts[0], counts[1]);
    uint32_t right = both > 0 ? (uint32_t)(spare * (1 - left / both)) : spare / 2;
    uint32_t room = counts[0] + spare - right;
    memmove(refs + room, refs + counts[0], counts[1] * sizeof(RtTreeRef));
    sides[0] = (Group){group->first, counts[0], spare - right, group->node + 1, group->depth + 1, false};
    sides[1] =
        (Group){group->first + room, counts[1], right, group->node + 2 * room, group->depth + 1, false};
}

/* So many share what is left over; and groups of the top are no smaller. */
enum { FEW = 1 << 12 };

/* The right side gets what `left` nodes did not use of the left one's places. */
static void pass_on(const Builder *b, Group sides[2], uint32_t left) {
    uint32_t unused = sides[0].count + sides[0].spare - (left + 1) / 2;
    RtTreeRef *refs = b->refs + sides[1].first;
    if (unused == 0) return;
    memmove(refs - unused, refs, sides[1].count * sizeof(RtTreeRef));
    sides[1].first -= unused;
    sides[1].spare += unused;
}

/* Builds the subtree of a group from node group->node on, without gaps; gives the number of its nodes. */
static uint32_t build(const Builder *b, Group *group) {
    uint32_t counts[2];
    Group sides[2];
    if (!divide(b, group, counts)) {
        RtTreeRef *refs = b->refs + group->first;
        RtSubtreeBuilder plain = {b->tree, b->how.bins};
        rt_subtree_build(&plain, (RtRefGroup){refs, group->count, group->node, group->depth,
                                              rt_refs_centers(refs, group->count)});
        return 2 * group->count - 1;
    }
    share_out(b, group, counts, sides);
    uint32_t left = build(b, &sides[0]);
    sides[1].node = group->node + 1 + left;
    if (group->count <= FEW) pass_on(b, sides, left);
    uint32_t right = build(b, &sides[1]);
    group->divided |= sides[0].divided || sides[1].divided;
    rt_tree_set_union(b->tree, group->node, group->node + 1, sides[1].node);
    return 1 + left + right;
}

/* ---- on all threads ---- */

enum { SHARES = 16 }; /* the top ends where groups are such a part of what one thread has to do */

/* A run of nodes without gaps: a subtree, or one node of the top. */
typedef struct Run {
    Group group, sides[2];
    bool split;           /* it is of the top */
    uint32_t children[2]; /* of the top: runs */
    uint32_t used, at;    /* nodes, and where they are in the end */
} Run;

typedef struct Top {
    const Builder *b;
    Run *runs; /* [run_count] parents before their children, level by level */
    uint32_t run_count, level, limit;
    uint32_t *todo; /* [todo_count] runs that are subtrees */
    uint32_t todo_count;
    RtTree *into;
} Top;

static RtStatus split_run(void *context, size_t item, int thread, RtError *error) {
    Top *top = context;
    Run *run = &top->runs[top->level + item];
    uint32_t counts[2];
    (void)thread;
    (void)error;
    run->split = run->group.count > top->limit && divide(top->b, &run->group, counts);
    if (run->split) share_out(top->b, &run->group, counts, run->sides);
    return RT_OK;
}

static RtStatus build_run(void *context, size_t item, int thread, RtError *error) {
    Top *top = context;
    Run *run = &top->runs[top->todo[item]];
    (void)thread;
    (void)error;
    run->used = build(top->b, &run->group);
    return RT_OK;
}

static RtStatus move_run(void *context, size_t item, int thread, RtError *error) {
    Top *top = context;
    const Run *run = &top->runs[top->todo[item]];
    uint32_t from = run->group.node;
    (void)thread;
    (void)error;
    for (uint32_t i = 0; i < run->used; i++) {
        RtTreeNode node = top->b->tree->nodes[from + i];
        bool leaf = node.child[0] == RT_TREE_LEAF;
        for (int s = 0; s < 2 && !leaf; s++) node.child[s] = node.child[s] - from + run->at;
        top->into->nodes[run->at + i] = node;
    }
    return RT_OK;
}

static RtStatus make_runs(Top *top, int threads, RtError *error) {
    for (uint32_t end = top->run_count; top->level < end; end = top->run_count) {
        RT_TRY(rt_parallel_for(end - top->level, threads, split_run, top, error));
        for (; top->level < end; top->level++) {
            Run *run = &top->runs[top->level];
            for (int s = 0; s < 2 && run->split; s++) {
                run->children[s] = top->run_count;
                top->runs[top->run_count++] = (Run){.group = run->sides[s]};
            }
            if (!run->split) top->todo[top->todo_count++] = top->level;
        }
    }
    return rt_parallel_for(top->todo_count, threads, build_run, top, error);
}

/* Gives a run and what is below it their places, from `at` on; gives where they end. */
static uint32_t place(Top *top, uint32_t index, uint32_t at) {
    Run *run = &top->runs[index];
    run->at = at;
    if (!run->split) return at + run->used;
    at = place(top, run->children[0], at + 1);
    return place(top, run->children[1], at);
}

/* Closes the gaps between runs. */
static RtStatus close_gaps(Top *top, RtTree *tree, int threads, RtError *error) {
    uint32_t used = place(top, 0, 0);
    bool divided = false;
    for (uint32_t r = 0; r < top->run_count; r++) divided |= top->runs[r].group.divided;
    if (top->run_count > 1) {
        RtTree into;
        RT_TRY(rt_tree_init(&into, (used + 1) / 2, error));
        top->into = &into;
        RtStatus status = rt_parallel_for(top->todo_count, threads, move_run, top, error);
        for (uint32_t r = top->run_count; r-- > 0;) {
            const Run *run = &top->runs[r], *a = &top->runs[run->children[0]],
                      *c = &top->runs[run->children[1]];
            if (run->split) rt_tree_set_union(&into, run->at, a->at, c->at);
        }
        rt_tree_clear(tree);
        *tree = into;
        RT_TRY(status);
    }
    tree->used = tree->capacity = used;
    tree->divided = divided;
    return RT_OK;
}

static RtStatus build_all(Builder *b, RtTree *tree, uint32_t count, uint32_t most, int threads,
                          RtError *error) {
    uint32_t parts = SHARES * (uint32_t)rt_thread_count(threads);
    Top top = {.b = b, .run_count = 1};
    top.limit = parts == SHARES ? most : most / parts > FEW ? most / parts : FEW;
    size_t runs = 1 + (size_t)2 * RT_TREE_MEDIAN_DEPTH * (most / top.limit);
    top.runs = rt_alloc(runs, sizeof(Run));
    top.todo = rt_alloc(runs, sizeof(uint32_t));
    RtStatus status = RT_NO_MEMORY;
    if (top.runs && top.todo) {
        top.runs[0].group = (Group){.count = count, .spare = most - count};
        status = make_runs(&top, threads, error);
        rt_free(b->refs); /* before there are two trees */
        b->refs = NULL;
        if (status == RT_OK) status = close_gaps(&top, tree, threads, error);
    } else {
        rt_fail_memory(error, "the top of a tree with spatial splits", runs * sizeof(Run));
    }
    rt_free(top.runs);
    rt_free(top.todo);
    return status;
}

/* ---- all of it ---- */

/* Bytes per reference at the worst moment: the tree, and what is laid out from it. */
enum { REF_BYTES = 2 * sizeof(RtTreeNode) + 2 * sizeof(RtNode) + sizeof(uint32_t) + 2 * sizeof(bool) };

static RtStatus refuse(const RtSpatial *how, uint32_t count, RtError *error) {
    assert(count > 0);
    double most = (double)how->limit, bytes = count * how->budget * REF_BYTES;
    if (bytes <= most) return RT_OK;
    double fits = floor(most / REF_BYTES / count * 10) / 10;
    if (fits < 1)
        return rt_fail(error, RT_BAD_INPUT,
                       "spatial splits of %u objects would take at least %.3g GiB, more than %.3g GiB: take "
                       "another build",
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
    RT_TRY(refuse(how, count, error));
    uint32_t most = (uint32_t)(count * how->budget);
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
