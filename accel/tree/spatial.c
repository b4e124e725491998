/* SPDX-License-Identifier: Apache-2.0 */
/* Trees from the top whose splits may cut objects: each part becomes a reference of its own.
 *
 * Paper: Stich, Friedrich & Dietrich 2009, "Spatial Splits in Bounding Volume Hierarchies" (HPG). At a node
 * the best object split (binned SAH) competes with the best spatial split, wherever the boxes of the two
 * sides of the object split overlap by more than `alpha` of the root's area. References are chopped into
 * equal spatial bins along each axis to find it; the parts serve to compare planes only. At the plane a
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
#include "accel/tree/topdown.h"
#include "core/base/memory.h"
#include "core/base/parallel.h"
#include "core/shape/overlap.h"

#include <stdatomic.h>
#include <stdio.h>

/* The two sides of a split, and its cost. */
typedef struct Sides {
    double cost;
    RtBox4 box[2];
    uint32_t count[2];
} Sides;

static inline void set_cost(Sides *sides) {
    RtDouble2 areas = rt_box4_half_areas(sides->box[0], sides->box[1]);
    sides->cost = areas[0] * sides->count[0] + areas[1] * sides->count[1];
}

typedef struct SpatialSplit {
    Sides sides; /* cost INFINITY: no plane */
    int axis;
    float at;
} SpatialSplit;

/* The references of a subtree: refs[first..first + count), followed by `spare` free slots. Its nodes are
 * among nodes[node..node + 2 * (count + spare) - 1). */
typedef struct Group {
    uint32_t first, count, spare, node;
    int depth;
    bool was_cut; /* some reference in it was cut */
} Group;

/* Nodes without gaps: a subtree, or one node of the top. */
typedef struct Run {
    Group group;
    uint32_t children; /* of a node of the top: the first of two runs; 0 for a subtree */
    uint32_t used;     /* number of nodes */
} Run;

typedef struct Builder {
    RtTree *tree; /* with room for all references that the budget allows */
    const RtGeometry *geometry;
    RtTreeRef *refs; /* [budget] */
    const RtTreeOptions *options;
    double least_overlap; /* half area above which spatial splits are tried */
    double margin;        /* for rt_object_part */
    Run *runs;            /* [run_count] parents before their children */
    _Atomic uint32_t run_count;
    uint32_t limit; /* larger groups belong to the top */
} Builder;

/* ---- spatial bins ---- */

typedef struct Bin {
    RtBox4 box;             /* of the parts in it */
    uint32_t begin, finish; /* references whose first part, or whose last, is in it */
} Bin;

/* Bin i lies between planes i and i + 1. A bin is guessed by one multiplication, then corrected by
 * comparisons with the planes, so rounding puts no part on the wrong side. */
typedef struct Bins {
    int count;
    RtFloat4 lo, scale, last; /* bin of x, approximately: (x - lo) * scale, at most `last` */
    bool divides[3];          /* false: the planes of the axis coincide */
    float plane[3][RT_MAX_BINS + 1];
    Bin bins[3][RT_MAX_BINS];
} Bins;

/* Clips a reference to `lo`..`hi` along `axis`: *part contains all of its surface there, or all of the
 * box of a CSG tree or an instance (accel/clipping.h). False if there is none. */
static bool ref_part(const Builder *b, const RtTreeRef *ref, int axis, float lo, float hi, RtBox *part) {
    RtBox box = ref->box;
    box.lo.at[axis] = rt_maxf(lo, box.lo.at[axis]);
    box.hi.at[axis] = rt_minf(hi, box.hi.at[axis]);
    *part = box;
    const RtShape shape = rt_ref_shape(b->geometry->objects[ref->id]);
    if (shape == RT_SHAPE_CSG || shape == RT_SHAPE_INSTANCE) return !rt_box_is_empty(box);
    return rt_object_part(b->geometry, ref->id, &box, b->margin, part);
}

static void init(Bins *self, int count, RtBox4 box) {
    self->count = count;
    self->lo = box.lo;
    self->scale = rt_all4(0);
    self->last = rt_all4((float)(count - 1));
    for (int axis = 0; axis < 3; axis++) {
        double lo = (double)box.lo[axis], width = (double)box.hi[axis] - lo;
        self->divides[axis] = (float)(lo + width / count) > box.lo[axis];
        if (!self->divides[axis]) continue;
        self->scale[axis] = (float)(count / width);
        for (int i = 0; i <= count; i++) self->plane[axis][i] = (float)(lo + width * i / count);
        for (int i = 0; i < count; i++) self->bins[axis][i] = (Bin){rt_box4_empty(), 0, 0};
    }
    self->lo[3] = 0;
}

static RtInt4 bins_of(const Bins *self, RtFloat4 point) {
    RtFloat4 at = rt_max((point - self->lo) * self->scale, rt_all4(0));
    return rt_to_ints4(rt_min(at, self->last));
}

/* A part that begins on a plane is in the bin above; one that ends there, in the bin below. */
static int first_bin(const Bins *self, int axis, int guess, float x) {
    const float *plane = self->plane[axis];
    while (guess > 0 && x < plane[guess]) guess--;
    while (guess + 1 < self->count && x >= plane[guess + 1]) guess++;
    return guess;
}

static int last_bin(const Bins *self, int axis, int guess, float x, int first) {
    const float *plane = self->plane[axis];
    while (guess > first && x <= plane[guess]) guess--;
    while (guess + 1 < self->count && x > plane[guess + 1]) guess++;
    return guess > first ? guess : first;
}

/* ---- chopping ---- */

static bool is_empty(RtBox4 box) {
    return (rt_le_bits(box.lo, box.hi) & 7) != 7;
}

/* -INFINITY, which add_gated lets a point through, in the lanes where `held` is true; INFINITY elsewhere. */
static RtFloat4 gate_of(RtInt4 held) {
    return rt_select(held, rt_all4(-INFINITY), rt_all4(INFINITY));
}

/* Adds a point, or nothing if the gate is INFINITY: branchless. */
static RtBox4 add_gated(RtBox4 box, RtFloat4 point, float gate) {
    RtFloat4 off = rt_all4(gate);
    return (RtBox4){rt_min(box.lo, rt_max(point, off)), rt_max(box.hi, rt_min(point, -off))};
}

/* Sets parts[first..last] to the box of the part of a triangle in each bin: its corners there, and where its
 * edges meet the planes. These are unpredictable, so the loop is branchless. */
static void chop_triangle(const Bins *self, int axis, const RtTriangle *triangle, int first, int last,
                          RtBox4 *parts) {
    const float *plane = self->plane[axis];
    RtFloat4 corner[3], along[3];
    for (int k = 0; k < 3; k++)
        corner[k] = (RtFloat4){triangle->v[k].x, triangle->v[k].y, triangle->v[k].z, 0};
    for (int k = 0; k < 3; k++) along[k] = corner[(k + 1) % 3] - corner[k];
    /* Lane k: edge k. */
    RtFloat4 from = {triangle->v[0].at[axis], triangle->v[1].at[axis], triangle->v[2].at[axis], 0};
    RtFloat4 to = __builtin_shufflevector(from, from, 1, 2, 0, 3);
    RtFloat4 low = rt_min(from, to), high = rt_max(from, to), inverse = rt_all4(1) / (to - from);
    RtBox4 below = rt_box4_empty(); /* what meets the lower plane of the bin */
    RtFloat4 lower = rt_all4(-INFINITY);
    for (int i = first; i <= last; i++) {
        RtFloat4 upper = rt_all4(i < last ? plane[i + 1] : INFINITY);
        RtFloat4 here = gate_of((from >= lower) & (from < upper)), at = (upper - from) * inverse;
        RtFloat4 meets = gate_of((low < upper) & (upper <= high));
        RtBox4 above = rt_box4_empty();
        for (int k = 0; k < 3; k++) below = add_gated(below, corner[k], here[k]);
        for (int k = 0; k < 3 && i < last; k++)
            above = add_gated(above, corner[k] + along[k] * rt_all4(at[k]), meets[k]);
        parts[i] = rt_box4_union(below, above);
        below = above;
        lower = upper;
    }
}

static void chop_other(const Bins *self, const Builder *b, const RtTreeRef *ref, int axis, int first,
                       int last, RtBox4 *parts) {
    for (int i = first; i <= last; i++) {
        RtBox part;
        bool any = ref_part(b, ref, axis, self->plane[axis][i], self->plane[axis][i + 1], &part);
        parts[i] = any ? rt_box4_load(&part) : rt_box4_empty();
    }
}

static void chop(Bins *self, const Builder *b, const RtTreeRef *ref, int axis, int first, int last) {
    RtBox4 parts[RT_MAX_BINS], box = rt_box4_load(&ref->box);
    RtRef object = b->geometry->objects[ref->id];
    Bin *bins = self->bins[axis];
    int begin = last, finish = first;
    if (rt_ref_shape(object) == RT_SHAPE_TRIANGLE)
        chop_triangle(self, axis, &b->geometry->triangles[rt_ref_index(object)], first, last, parts);
    else
        chop_other(self, b, ref, axis, first, last, parts);
    for (int i = first; i <= last; i++) {
        RtBox4 part = {rt_max(parts[i].lo, box.lo), rt_min(parts[i].hi, box.hi)};
        if (is_empty(part)) continue;
        bins[i].box = rt_box4_union(bins[i].box, part);
        begin = i < begin ? i : begin;
        finish = i;
    }
    /* No part at all, by rounding: count it in the last bin. */
    if (finish < begin) finish = begin;
    bins[begin].begin++;
    bins[finish].finish++;
}

static void fill(Bins *self, const Builder *b, const Group *group) {
    for (uint32_t i = 0; i < group->count; i++) {
        const RtTreeRef *ref = &b->refs[group->first + i];
        RtBox4 box = rt_box4_load(&ref->box);
        RtInt4 from = bins_of(self, box.lo), to = bins_of(self, box.hi);
        for (int axis = 0; axis < 3; axis++) {
            if (!self->divides[axis]) continue;
            int first = first_bin(self, axis, from[axis], ref->box.lo.at[axis]);
            int last = last_bin(self, axis, to[axis], ref->box.hi.at[axis], first);
            if (first < last) {
                chop(self, b, ref, axis, first, last);
                continue;
            }
            Bin *bin = &self->bins[axis][first];
            bin->box = rt_box4_union(bin->box, box);
            bin->begin++;
            bin->finish++;
        }
    }
}

/* ---- the best plane ---- */

static void try_planes(const Bins *self, int axis, const Group *group, SpatialSplit *best) {
    const Bin *bins = self->bins[axis];
    RtBox4 right[RT_MAX_BINS], box = rt_box4_empty();
    uint32_t left_count = 0, right_count = group->count;
    for (int i = self->count - 1; i > 0; i--) right[i] = box = rt_box4_union(box, bins[i].box);
    box = rt_box4_empty();
    for (int i = 1; i < self->count; i++) {
        box = rt_box4_union(box, bins[i - 1].box);
        left_count += bins[i - 1].begin;
        right_count -= bins[i - 1].finish;
        if (left_count == 0 || right_count == 0) continue;
        if (left_count + right_count - group->count > group->spare) continue;
        Sides sides = {0, {box, right[i]}, {left_count, right_count}};
        set_cost(&sides);
        if (sides.cost < best->sides.cost) *best = (SpatialSplit){sides, axis, self->plane[axis][i]};
    }
}

/* The cheapest plane between `count` bins, 2..RT_MAX_BINS, along any axis. Ties go to the lower axis, then to
 * the lower plane. */
static SpatialSplit find_plane(const Builder *b, const Group *group, RtBox4 box, int count) {
    SpatialSplit best = {.sides.cost = INFINITY};
    Bins bins;
    init(&bins, count, box);
    fill(&bins, b, group);
    for (int axis = 0; axis < 3; axis++) {
        if (bins.divides[axis]) try_planes(&bins, axis, group, &best);
    }
    return best;
}

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
static int choose_side(Sides *sides, RtBox4 whole, bool may_cut) {
    Sides left = *sides, right = *sides;
    left.box[0] = rt_box4_union(left.box[0], whole);
    left.count[1]--;
    right.box[1] = rt_box4_union(right.box[1], whole);
    right.count[0]--;
    set_cost(&left);
    set_cost(&right);
    set_cost(sides);
    if (may_cut && sides->cost < left.cost && sides->cost < right.cost) return BOTH;
    *sides = right.cost < left.cost ? right : left;
    return right.cost < left.cost ? RIGHT : LEFT;
}

/* Partitions the group at the plane, left side first; counts[2] are the numbers of references. */
static void cut_at(const Builder *b, const Group *group, const SpatialSplit *plane, uint32_t counts[2]) {
    Sides sides = plane->sides;
    RtTreeRef *refs = b->refs + group->first;
    uint32_t left = 0, end = group->count, added = 0;
    while (left < end) {
        RtTreeRef ref = refs[left];
        int side = ref.box.lo.at[plane->axis] >= plane->at ? RIGHT : LEFT;
        if (side == LEFT && ref.box.hi.at[plane->axis] > plane->at) {
            RtBox lower, upper;
            bool below = ref_part(b, &ref, plane->axis, -INFINITY, plane->at, &lower);
            bool above = ref_part(b, &ref, plane->axis, plane->at, INFINITY, &upper);
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
    counts[0] = rt_split_binned(refs, count, b->options->spatial.bins, rt_refs_centers(refs, count), centers);
    counts[1] = count - counts[0];
    if (counts[0] == 0) return false;
    Sides sides = {0, {box_of(refs, counts[0]), box_of(refs + counts[0], counts[1])}, {counts[0], counts[1]}};
    set_cost(&sides);
    RtBox4 common = {rt_max(sides.box[0].lo, sides.box[1].lo), rt_min(sides.box[0].hi, sides.box[1].hi)};
    SpatialSplit plane = {.sides.cost = INFINITY};
    /* Cutting takes most of the time, so there are never more bins than for small groups. */
    if (area_of(common) > b->least_overlap)
        plane = find_plane(b, group, box, (int)rt_bin_count(b->options->spatial.bins, 0));
    double least = fmin(sides.cost, plane.sides.cost);
    if (count <= b->options->spatial.max_leaf_size &&
        area * count <= area * b->options->spatial.traversal + least)
        return false;
    if (!(plane.sides.cost < sides.cost)) return true;
    cut_at(b, group, &plane, counts);
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
        RtSubtreeBuilder plain = {b->tree, b->options->spatial.bins};
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

/* Splits a run while it is large, and builds the last left side; the right sides become tasks. */
static RtStatus build_run(void *context, RtTasks *tasks, const void *task, RtError *error) {
    Builder *b = context;
    Run *run = &b->runs[*(const uint32_t *)task];
    uint32_t counts[2];
    while (run->group.count > b->limit && split_group(b, &run->group, counts)) {
        Group sides[2];
        make_sides(b, &run->group, counts, sides);
        uint32_t left = atomic_fetch_add(&b->run_count, 2), right = left + 1;
        for (uint32_t s = 0; s < 2; s++) b->runs[left + s] = (Run){.group = sides[s]};
        run->children = left;
        if (!rt_tasks_add(tasks, &right)) return rt_fail_memory(error, "a subtree", sizeof(Run));
        run = &b->runs[left];
    }
    run->used = build(b, &run->group);
    return RT_OK;
}

/* Moves the nodes of a run, and of those below it, to `at`, not behind where they are; returns where they
 * end. */
static uint32_t close_gaps(Builder *b, const Run *run, uint32_t at) {
    RtTreeNode *nodes = b->tree->nodes;
    const uint32_t from = run->group.node;
    b->tree->split_refs |= run->group.was_cut;
    if (run->children > 0) {
        const Run *child = &b->runs[run->children];
        const uint32_t second = close_gaps(b, &child[0], at + 1), end = close_gaps(b, &child[1], second);
        rt_tree_set_union(b->tree, at, at + 1, second);
        return end;
    }
    for (uint32_t i = 0; i < run->used && from > at; i++) {
        RtTreeNode node = nodes[from + i];
        bool leaf = node.child[0] == RT_TREE_LEAF;
        for (int s = 0; s < 2 && !leaf; s++) node.child[s] -= from - at;
        nodes[at + i] = node;
    }
    return at + run->used;
}

/* Peak bytes per reference: the tree, and the hierarchy that is laid out from it. */
enum { REF_BYTES = 2 * sizeof(RtTreeNode) + 2 * sizeof(RtNode) + sizeof(uint32_t) + 2 * sizeof(bool) };

static RtStatus check_limit(double budget, uint64_t limit, uint32_t count, RtError *error) {
    double most = (double)limit, bytes = count * budget * REF_BYTES;
    if (bytes <= most) return RT_OK;
    double fits = floor(most / REF_BYTES / count * 10) / 10;
    char remedy[64] = "choose another build";
    if (fits >= 1) snprintf(remedy, sizeof remedy, "budget=%g would fit", fits);
    return rt_fail(
        error, RT_BAD_INPUT,
        "spatial splits with up to %g references for each of %u objects may take %.3g GiB, more than "
        "%.3g GiB: %s",
        budget, count, bytes / 0x1p30, most / 0x1p30, remedy);
}

RtStatus rt_tree_spatial(RtTree *tree, const RtGeometry *geometry, const RtTreeOptions *options, int threads,
                         RtError *error) {
    const uint32_t count = geometry->object_count, root = 0;
    const uint32_t parts = SHARES * (uint32_t)rt_thread_count(threads);
    RT_TRY(check_limit(options->spatial.budget, options->spatial.limit, count, error));
    bool is_tiny = rt_box_longest_side(geometry->box) < RT_CLIPPED_LEAST_SIDE;
    uint32_t most = is_tiny ? count : (uint32_t)(count * options->spatial.budget);
    RT_ARENA(arena);
    RT_TRY(rt_tree_init(tree, most, error));
    Builder b = {.tree = tree,
                 .geometry = geometry,
                 .refs = rt_arena_alloc_unset(&arena, most, sizeof(RtTreeRef)),
                 .options = options,
                 .least_overlap = options->spatial.alpha * rt_box_half_area(geometry->box),
                 .margin = rt_tree_part_margin(&geometry->box),
                 .run_count = 1};
    b.limit = parts == SHARES ? most : most / parts > SMALL ? most / parts : SMALL;
    b.runs = rt_arena_alloc(&arena, 1 + (size_t)2 * RT_TREE_MEDIAN_DEPTH * (most / b.limit), sizeof(Run));
    RT_TRY(rt_arena_check(&arena, "a tree with spatial splits", error));
    for (uint32_t i = 0; i < count; i++) b.refs[i] = (RtTreeRef){geometry->boxes[i], i};
    b.runs[0].group = (Group){.count = count, .spare = most - count};
    RT_TRY(rt_parallel_tasks(&root, 1, sizeof root, count > b.limit ? threads : 1, build_run, &b, error));
    tree->used = close_gaps(&b, &b.runs[0], 0);
    rt_arena_free(&arena, b.refs); /* before there are two trees */
    rt_trim(&tree->nodes, tree->used, &tree->capacity, sizeof(RtTreeNode));
    tree->capacity = tree->used;
    return RT_OK;
}
