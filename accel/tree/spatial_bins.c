/* SPDX-License-Identifier: Apache-2.0 */
/* A bin is guessed by one multiplication, then corrected by comparisons with the planes, so rounding puts no
 * part on the wrong side. */
#include "accel/tree/spatial_bins.h"

#include "core/shape/overlap.h"

typedef struct Bin {
    RtBox4 box;             /* of the parts in it */
    uint32_t begin, finish; /* references whose first part, or whose last, is in it */
} Bin;

/* Bin i lies between planes i and i + 1. */
typedef struct Bins {
    int count;
    RtFloat4 lo, scale, last; /* bin of x, approximately: (x - lo) * scale, at most `last` */
    bool divides[3];          /* false: the planes of the axis coincide */
    float plane[3][RT_MAX_BINS + 1];
    Bin bins[3][RT_MAX_BINS];
} Bins;

bool rt_ref_part(const RtSpatialGroup *group, const RtTreeRef *ref, int axis, float lo, float hi,
                 RtBox *part) {
    RtBox box = ref->box;
    box.lo.at[axis] = rt_maxf(lo, box.lo.at[axis]);
    box.hi.at[axis] = rt_minf(hi, box.hi.at[axis]);
    *part = box;
    if (rt_ref_shape(group->geometry->objects[ref->id]) == RT_SHAPE_CSG) return !rt_box_is_empty(box);
    return rt_object_part(group->geometry, ref->id, &box, group->margin, part);
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

static void chop_other(const Bins *self, const RtSpatialGroup *group, const RtTreeRef *ref, int axis,
                       int first, int last, RtBox4 *parts) {
    for (int i = first; i <= last; i++) {
        RtBox part;
        bool any = rt_ref_part(group, ref, axis, self->plane[axis][i], self->plane[axis][i + 1], &part);
        parts[i] = any ? rt_box4_load(&part) : rt_box4_empty();
    }
}

static void chop(Bins *self, const RtSpatialGroup *group, const RtTreeRef *ref, int axis, int first,
                 int last) {
    RtBox4 parts[RT_MAX_BINS], box = rt_box4_load(&ref->box);
    RtRef object = group->geometry->objects[ref->id];
    Bin *bins = self->bins[axis];
    int begin = last, finish = first;
    if (rt_ref_shape(object) == RT_SHAPE_TRIANGLE)
        chop_triangle(self, axis, &group->geometry->triangles[rt_ref_index(object)], first, last, parts);
    else
        chop_other(self, group, ref, axis, first, last, parts);
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

static void fill(Bins *self, const RtSpatialGroup *group) {
    for (uint32_t i = 0; i < group->count; i++) {
        const RtTreeRef *ref = &group->refs[i];
        RtBox4 box = rt_box4_load(&ref->box);
        RtInt4 from = bins_of(self, box.lo), to = bins_of(self, box.hi);
        for (int axis = 0; axis < 3; axis++) {
            if (!self->divides[axis]) continue;
            int first = first_bin(self, axis, from[axis], ref->box.lo.at[axis]);
            int last = last_bin(self, axis, to[axis], ref->box.hi.at[axis], first);
            if (first < last) {
                chop(self, group, ref, axis, first, last);
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

static void try_planes(const Bins *self, int axis, const RtSpatialGroup *group, RtSpatialSplit *best) {
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
        RtSides sides = {0, {box, right[i]}, {left_count, right_count}};
        rt_sides_set_cost(&sides);
        if (sides.cost < best->sides.cost) *best = (RtSpatialSplit){sides, axis, self->plane[axis][i]};
    }
}

RtSpatialSplit rt_spatial_bins_split(const RtSpatialGroup *group, int count) {
    RtSpatialSplit best = {.sides.cost = INFINITY};
    Bins bins;
    init(&bins, count, group->box);
    fill(&bins, group);
    for (int axis = 0; axis < 3; axis++) {
        if (bins.divides[axis]) try_planes(&bins, axis, group, &best);
    }
    return best;
}
