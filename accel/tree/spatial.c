/* SPDX-License-Identifier: Apache-2.0 */
/* Trees from the top whose splits may cut objects: each part is a reference of its own.
 *
 * Paper: Stich, Friedrich & Dietrich 2009, "Spatial Splits in Bounding Volume Hierarchies" (HPG). At a node
 * the best split of the references in two groups (by the surface area heuristic, in bins of centres) is held
 * against the best plane that parts their surfaces (in bins of space, references chopped into them), wherever
 * the two groups' boxes overlap by more than `alpha` of the root's area. On the plane a reference is cut, or
 * goes to one side whole where that costs less (reference unsplitting).
 *
 * Invariant. Each point of an object's surface is in the box of one of its references: when a box is cut by a
 * plane both parts keep the plane, and rt_object_part makes a part smaller only where the surface is not. So
 * every point s of the surface is in a leaf's box and in all the boxes above; and a ray thick enough to be,
 * at the t of a hit, in every box that holds the point s near to it (accel/surface.h) meets all of those,
 * each entered at or before t and left at or after it. What else makes pruning exact, base/ray.h says.
 *
 * Parts may not exceed a budget of references. A node has a share of what is left of it; it divides it among
 * its children by their number of references, and what the left one did not use the right one may. The
 * references of a node lie in a row with its share of free places behind them. */
#include "accel/tree/hierarchy.h"
#include "accel/tree/split.h"
#include "base/memory.h"
#include "shape/overlap.h"

#include <assert.h>

typedef struct Builder {
    RtTree *tree;
    const RtGeometry *geometry;
    RtTreeRef *refs; /* [budget] */
    RtSpatial how;
    double least_overlap; /* half area of it at which planes are tried */
    double margin;        /* for rt_object_part */
} Builder;

/* References of a node: refs[first..first + count), followed by `spare` free places. */
typedef struct Group {
    uint32_t first, count, spare;
} Group;

/* A split in two, and what it costs by the surface area heuristic. */
typedef struct Sides {
    double cost;
    RtBox box[2];
    uint32_t count[2];
} Sides;

static double cost_of(const Sides *sides) {
    return rt_box_half_area(sides->box[0]) * sides->count[0] +
           rt_box_half_area(sides->box[1]) * sides->count[1];
}

static RtBox box_of(const RtTreeRef *refs, uint32_t count) {
    RtBox box = RT_EMPTY_BOX;
    for (uint32_t i = 0; i < count; i++) box = rt_box_union(box, refs[i].box);
    return box;
}

/* To *part what of a reference is from `lo` to `hi` along `axis`; false where nothing is. */
static bool take_part(const Builder *b, const RtTreeRef *ref, int axis, float lo, float hi, RtBox *part) {
    RtBox box = ref->box;
    box.lo.at[axis] = rt_maxf(lo, box.lo.at[axis]);
    box.hi.at[axis] = rt_minf(hi, box.hi.at[axis]);
    return rt_object_part(b->geometry, ref->id, &box, b->margin, part);
}

/* ---- the best plane ---- */

typedef struct Bin {
    RtBox box;              /* about the parts that are in it */
    uint32_t begin, finish; /* references whose first part, and whose last, is in it */
} Bin;

/* One axis of bins: bin i lies between planes i and i + 1. */
typedef struct Bins {
    int axis, count;
    float plane[RT_MAX_BINS + 1]; /* ascending */
    Bin bin[RT_MAX_BINS];
} Bins;

typedef struct Plane {
    Sides sides;
    int axis;
    float at;
} Plane;

static int bin_of(const Bins *bins, float x) {
    float lo = bins->plane[0], width = bins->plane[bins->count] - lo;
    int i = (int)((x - lo) / width * (float)bins->count);
    i = i < 0 ? 0 : i >= bins->count ? bins->count - 1 : i;
    while (i > 0 && x < bins->plane[i]) i--;
    while (i + 1 < bins->count && x >= bins->plane[i + 1]) i++;
    return i;
}

static void add_to_bins(const Builder *b, const RtTreeRef *ref, Bins *bins) {
    int axis = bins->axis, first = bin_of(bins, ref->box.lo.at[axis]), last = first;
    while (last + 1 < bins->count && bins->plane[last + 1] < ref->box.hi.at[axis]) last++;
    int begin = first, finish = first;
    for (int i = last; i >= first; i--) {
        RtBox part = ref->box;
        if (last > first && !take_part(b, ref, axis, bins->plane[i], bins->plane[i + 1], &part)) continue;
        bins->bin[i].box = rt_box_union(bins->bin[i].box, part);
        begin = i;
        finish = i > finish ? i : finish;
    }
    bins->bin[begin].begin++;
    bins->bin[finish].finish++;
}

/* Improves `best` by the best plane between bins that takes no more than the spare places. */
static void try_planes(const Bins *bins, const Group *group, Plane *best) {
    RtBox right[RT_MAX_BINS], box = RT_EMPTY_BOX;
    uint32_t left_count = 0, right_count = group->count;
    for (int i = bins->count - 1; i > 0; i--) right[i] = box = rt_box_union(box, bins->bin[i].box);
    box = RT_EMPTY_BOX;
    for (int i = 1; i < bins->count; i++) {
        box = rt_box_union(box, bins->bin[i - 1].box);
        left_count += bins->bin[i - 1].begin;
        right_count -= bins->bin[i - 1].finish;
        Sides sides = {0, {box, right[i]}, {left_count, right_count}};
        sides.cost = cost_of(&sides);
        bool fits = left_count + right_count - group->count <= group->spare;
        if (left_count == 0 || right_count == 0 || !fits || !(sides.cost < best->sides.cost)) continue;
        *best = (Plane){sides, bins->axis, bins->plane[i]};
    }
}

static Plane find_plane(const Builder *b, const Group *group, const RtBox *box) {
    Plane best = {.sides.cost = INFINITY};
    for (int axis = 0; axis < 3; axis++) {
        double lo = (double)box->lo.at[axis], width = (double)box->hi.at[axis] - lo;
        Bins bins;
        if (!((float)(lo + width / b->how.bins) > box->lo.at[axis])) continue;
        bins.axis = axis;
        bins.count = b->how.bins;
        for (int i = 0; i <= bins.count; i++) bins.plane[i] = (float)(lo + width * i / bins.count);
        for (int i = 0; i < bins.count; i++) bins.bin[i] = (Bin){RT_EMPTY_BOX, 0, 0};
        for (uint32_t i = 0; i < group->count; i++) add_to_bins(b, &b->refs[group->first + i], &bins);
        try_planes(&bins, group, &best);
    }
    return best;
}

/* ---- cutting ---- */

enum { LEFT = 0, RIGHT = 1, BOTH = 2 };

/* Where a reference that has parts on both sides of the plane goes; the sides are made to say so. */
static int choose_side(Sides *sides, const RtBox *whole, bool may_cut) {
    Sides left = *sides, right = *sides;
    left.box[0] = rt_box_union(left.box[0], *whole);
    left.count[1]--;
    right.box[1] = rt_box_union(right.box[1], *whole);
    right.count[0]--;
    left.cost = cost_of(&left);
    right.cost = cost_of(&right);
    sides->cost = cost_of(sides);
    if (may_cut && sides->cost < left.cost && sides->cost < right.cost) return BOTH;
    *sides = right.cost < left.cost ? right : left;
    return right.cost < left.cost ? RIGHT : LEFT;
}

/* Parts the group at the plane: what is left comes first. Gives the number of references on each side. */
static void cut_at(const Builder *b, const Group *group, const Plane *plane, uint32_t counts[2]) {
    RtTreeRef *refs = b->refs + group->first;
    Sides sides = plane->sides;
    uint32_t left = 0, end = group->count, added = 0;
    while (left < end) {
        RtTreeRef ref = refs[left];
        int side = ref.box.lo.at[plane->axis] >= plane->at ? RIGHT : LEFT;
        if (side == LEFT && ref.box.hi.at[plane->axis] > plane->at) {
            RtBox lower, upper;
            bool below = take_part(b, &ref, plane->axis, -INFINITY, plane->at, &lower);
            bool above = take_part(b, &ref, plane->axis, plane->at, INFINITY, &upper);
            side = below && above ? choose_side(&sides, &ref.box, added < group->spare)
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

/* Splits a group of at least 2 in two, which stand in its places one after the other. Where it would better
 * be one leaf it is cut no more. Gives whether it may be. */
static bool divide(const Builder *b, const Group *group, int depth, uint32_t counts[2]) {
    RtTreeRef *refs = b->refs + group->first;
    uint32_t count = group->count, left = 0;
    RtBox4 centers[2];
    if (depth < RT_TREE_MEDIAN_DEPTH)
        left = rt_split_binned(refs, count, b->how.bins, rt_refs_centers(refs, count), centers);
    bool halved = left == 0;
    if (halved) left = rt_split_median(refs, count);
    counts[0] = left;
    counts[1] = count - left;
    if (group->spare == 0 || halved) return false;
    Sides sides = {0, {box_of(refs, left), box_of(refs + left, count - left)}, {left, count - left}};
    sides.cost = cost_of(&sides);
    RtBox box = rt_box_union(sides.box[0], sides.box[1]);
    Plane plane = {.sides.cost = INFINITY};
    if (rt_box_half_area(rt_box_common(sides.box[0], sides.box[1])) > b->least_overlap)
        plane = find_plane(b, group, &box);
    double area = rt_box_half_area(box), least = fmin(sides.cost, plane.sides.cost);
    if (count <= b->how.leaf && area * count <= area * b->how.traversal + least) return false;
    if (plane.sides.cost < sides.cost) {
        b->tree->divided = true;
        cut_at(b, group, &plane, counts);
        if (counts[0] == 0 || counts[1] == 0) {
            counts[0] = rt_split_median(refs, count);
            counts[1] = count - counts[0];
        }
    }
    return true;
}

/* Gives the node of a group, and to *unused what it left of its share. The right side goes first, which has
 * the free places behind it. */
static uint32_t build_node(const Builder *b, Group group, int depth, uint32_t *unused) {
    uint32_t node = rt_tree_take(b->tree), counts[2];
    const RtTreeRef *ref = &b->refs[group.first];
    *unused = group.spare;
    if (group.count == 1) {
        rt_tree_set_leaf(b->tree, node, ref->box, ref->id);
        return node;
    }
    if (!divide(b, &group, depth, counts)) group.spare = 0;
    uint32_t total = counts[0] + counts[1], added = total - group.count, left_over;
    uint32_t spare = group.spare - added, kept = *unused - added - spare;
    Group right = {group.first + counts[0], counts[1], (uint32_t)((uint64_t)spare * counts[1] / total)};
    Group left = {group.first, counts[0], spare - right.spare};
    uint32_t b_node = build_node(b, right, depth + 1, &left_over);
    left.spare += left_over;
    uint32_t a_node = build_node(b, left, depth + 1, &left_over);
    *unused = kept + left_over;
    rt_tree_set_union(b->tree, node, a_node, b_node);
    return node;
}

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

RtStatus rt_tree_spatial(RtTree *tree, const RtGeometry *geometry, const RtSpatial *how, RtError *error) {
    uint32_t count = geometry->object_count, unused;
    RT_TRY(refuse(how, count, error));
    uint32_t most = (uint32_t)(count * how->budget);
    RT_TRY(rt_tree_init(tree, most, error));
    Builder b = {tree, geometry, rt_alloc(most, sizeof(RtTreeRef)),
                 *how, 0,        rt_tree_part_margin(&geometry->box)};
    if (!b.refs) {
        rt_tree_clear(tree);
        return rt_fail_memory(error, "references of a tree with spatial splits", most * sizeof(RtTreeRef));
    }
    for (uint32_t i = 0; i < count; i++) b.refs[i] = (RtTreeRef){geometry->boxes[i], i};
    b.least_overlap = how->alpha * rt_box_half_area(geometry->box);
    tree->root = build_node(&b, (Group){0, count, most - count}, 0, &unused);
    rt_free(b.refs);
    return RT_OK;
}
