/* SPDX-License-Identifier: Apache-2.0 */
#include "accel/tree/slabs.h"

#include "core/shape/overlap.h"

typedef struct Slab {
    RtBox4 box;             /* about the parts that are in it */
    uint32_t begin, finish; /* references whose first part, and whose last, is in it */
} Slab;

/* Slab i lies between planes i and i + 1. */
typedef struct Slabs {
    int count;
    RtFloat4 lo, scale, last; /* slab of x, nearly: (x - lo) * scale, at most `last` */
    bool divides[3];          /* else the planes of the axis coincide */
    float plane[3][RT_MAX_BINS + 1];
    Slab slabs[3][RT_MAX_BINS];
} Slabs;

bool rt_ref_part(const RtSlabGroup *group, const RtTreeRef *ref, int axis, float lo, float hi, RtBox *part) {
    RtBox box = ref->box;
    box.lo.at[axis] = rt_maxf(lo, box.lo.at[axis]);
    box.hi.at[axis] = rt_minf(hi, box.hi.at[axis]);
    return rt_object_part(group->geometry, ref->id, &box, group->margin, part);
}

static void init(Slabs *self, int count, RtBox4 box) {
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
        for (int i = 0; i < count; i++) self->slabs[axis][i] = (Slab){rt_box4_empty(), 0, 0};
    }
    self->lo[3] = 0;
}

static RtInt4 slabs_of(const Slabs *self, RtFloat4 point) {
    RtFloat4 at = rt_max((point - self->lo) * self->scale, rt_all4(0));
    return rt_to_ints4(rt_min(at, self->last));
}

/* What begins on a plane is in the slab above, what ends there is in that below. */
static int first_slab(const Slabs *self, int axis, int guess, float x) {
    const float *plane = self->plane[axis];
    while (guess > 0 && x < plane[guess]) guess--;
    while (guess + 1 < self->count && x >= plane[guess + 1]) guess++;
    return guess;
}

static int last_slab(const Slabs *self, int axis, int guess, float x, int first) {
    const float *plane = self->plane[axis];
    while (guess > first && x <= plane[guess]) guess--;
    while (guess + 1 < self->count && x > plane[guess + 1]) guess++;
    return guess > first ? guess : first;
}

/* ---- chopping ---- */

static bool is_empty(RtBox4 box) {
    return (rt_le_bits(box.lo, box.hi) & 7) != 7;
}

/* -INFINITY in the lanes where `held` is true, which lets a point through below, INFINITY elsewhere. */
static RtFloat4 gate_of(RtInt4 held) {
    return rt_select(held, rt_all4(-INFINITY), rt_all4(INFINITY));
}

/* Adds a point, or nothing where the gate is INFINITY, without a branch. */
static RtBox4 add_gated(RtBox4 box, RtFloat4 point, float gate) {
    RtFloat4 off = rt_all4(gate);
    return (RtBox4){rt_min(box.lo, rt_max(point, off)), rt_max(box.hi, rt_min(point, -off))};
}

/* To parts[first..last] what of a triangle is in each slab: its corners there, and where its edges meet the
 * planes. Which those are is as good as random: no branch hangs on it. */
static void chop_triangle(const Slabs *self, int axis, const RtTriangle *triangle, int first, int last,
                          RtBox4 *parts) {
    const float *plane = self->plane[axis];
    RtFloat4 corner[3], along[3];
    for (int k = 0; k < 3; k++)
        corner[k] = (RtFloat4){triangle->v[k].x, triangle->v[k].y, triangle->v[k].z, 0};
    for (int k = 0; k < 3; k++) along[k] = corner[(k + 1) % 3] - corner[k];
    /* Of edge k in lane k. */
    RtFloat4 from = {triangle->v[0].at[axis], triangle->v[1].at[axis], triangle->v[2].at[axis], 0};
    RtFloat4 to = __builtin_shufflevector(from, from, 1, 2, 0, 3);
    RtFloat4 low = rt_min(from, to), high = rt_max(from, to), inverse = rt_all4(1) / (to - from);
    RtBox4 below = rt_box4_empty(); /* what meets the plane below the slab */
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

static void chop_other(const Slabs *self, const RtSlabGroup *group, const RtTreeRef *ref, int axis, int first,
                       int last, RtBox4 *parts) {
    for (int i = first; i <= last; i++) {
        RtBox part;
        bool any = rt_ref_part(group, ref, axis, self->plane[axis][i], self->plane[axis][i + 1], &part);
        parts[i] = any ? rt_box4_load(&part) : rt_box4_empty();
    }
}

static void chop(Slabs *self, const RtSlabGroup *group, const RtTreeRef *ref, int axis, int first, int last) {
    RtBox4 parts[RT_MAX_BINS], box = rt_box4_load(&ref->box);
    RtRef object = group->geometry->objects[ref->id];
    Slab *slabs = self->slabs[axis];
    int begin = last, finish = first;
    if (rt_ref_shape(object) == RT_SHAPE_TRIANGLE)
        chop_triangle(self, axis, &group->geometry->triangles[rt_ref_index(object)], first, last, parts);
    else
        chop_other(self, group, ref, axis, first, last, parts);
    for (int i = first; i <= last; i++) {
        RtBox4 part = {rt_max(parts[i].lo, box.lo), rt_min(parts[i].hi, box.hi)};
        if (is_empty(part)) continue;
        slabs[i].box = rt_box4_union(slabs[i].box, part);
        begin = i < begin ? i : begin;
        finish = i;
    }
    /* Of nothing at all, by rounding, it is as if all were in the last slab. */
    if (finish < begin) finish = begin;
    slabs[begin].begin++;
    slabs[finish].finish++;
}

static void add(Slabs *self, const RtSlabGroup *group) {
    for (uint32_t i = 0; i < group->count; i++) {
        const RtTreeRef *ref = &group->refs[i];
        RtBox4 box = rt_box4_load(&ref->box);
        RtInt4 from = slabs_of(self, box.lo), to = slabs_of(self, box.hi);
        for (int axis = 0; axis < 3; axis++) {
            if (!self->divides[axis]) continue;
            int first = first_slab(self, axis, from[axis], ref->box.lo.at[axis]);
            int last = last_slab(self, axis, to[axis], ref->box.hi.at[axis], first);
            if (first < last) {
                chop(self, group, ref, axis, first, last);
                continue;
            }
            Slab *slab = &self->slabs[axis][first];
            slab->box = rt_box4_union(slab->box, box);
            slab->begin++;
            slab->finish++;
        }
    }
}

/* ---- the best plane ---- */

static void try_planes(const Slabs *self, int axis, const RtSlabGroup *group, RtCut *best) {
    const Slab *slabs = self->slabs[axis];
    RtBox4 right[RT_MAX_BINS], box = rt_box4_empty();
    uint32_t left_count = 0, right_count = group->count;
    for (int i = self->count - 1; i > 0; i--) right[i] = box = rt_box4_union(box, slabs[i].box);
    box = rt_box4_empty();
    for (int i = 1; i < self->count; i++) {
        box = rt_box4_union(box, slabs[i - 1].box);
        left_count += slabs[i - 1].begin;
        right_count -= slabs[i - 1].finish;
        if (left_count == 0 || right_count == 0) continue;
        if (left_count + right_count - group->count > group->spare) continue;
        RtSides sides = {0, {box, right[i]}, {left_count, right_count}};
        rt_sides_set_cost(&sides);
        if (sides.cost < best->sides.cost) *best = (RtCut){sides, axis, self->plane[axis][i]};
    }
}

RtCut rt_slabs_find_plane(const RtSlabGroup *group, int count) {
    RtCut best = {.sides.cost = INFINITY};
    Slabs slabs;
    init(&slabs, count, group->box);
    add(&slabs, group);
    for (int axis = 0; axis < 3; axis++) {
        if (slabs.divides[axis]) try_planes(&slabs, axis, group, &best);
    }
    return best;
}
