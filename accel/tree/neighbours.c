/* SPDX-License-Identifier: Apache-2.0 */
/* A search climbs from the slot of the query to the root and searches the other side of each node on the way,
 * the nearer child first. */
#include "accel/tree/neighbours.h"

#include "accel/tree/sah_split.h"
#include "core/base/memory.h"

#define EMPTY_BOUND                                                                                          \
    ((RtNeighbourBound){                                                                                     \
        {-INFINITY, -INFINITY, -INFINITY}, {INFINITY, INFINITY, INFINITY}, {INFINITY, INFINITY, INFINITY}})

static void set_slot(RtNeighbours *self, uint32_t slot, uint32_t cluster) {
    RtNeighbourBound *bound = &self->bounds[self->capacity + slot];
    self->cluster_at[slot] = cluster;
    *bound = EMPTY_BOUND;
    if (cluster == RT_NO_CLUSTER) return;
    const RtBox *box = &self->tree->nodes[cluster].box;
    self->slot_of[cluster] = slot;
    bound->lo = box->lo;
    bound->hi = box->hi;
    for (int a = 0; a < 3; a++)
        bound->size.at[a] = rt_float_below((double)box->hi.at[a] - (double)box->lo.at[a]);
}

static void fit_node(RtNeighbours *self, uint32_t node) {
    const RtNeighbourBound *a = self->bounds + 2 * (size_t)node, *b = a + 1;
    RtNeighbourBound bound = {rt_vec_max(a->lo, b->lo), rt_vec_min(a->hi, b->hi),
                              rt_vec_min(a->size, b->size)};
    self->bounds[node] = bound;
}

/* Fills slots[first..first + size) by medians; count <= size. */
static void fill_slots(RtNeighbours *self, RtTreeRef *refs, uint32_t count, uint32_t first, uint32_t size) {
    if (count == 0) return;
    if (count == 1) {
        set_slot(self, first, refs[0].id);
        return;
    }
    uint32_t left = rt_split_median(refs, count);
    fill_slots(self, refs, left, first, size / 2);
    fill_slots(self, refs + left, count - left, first + size / 2, size / 2);
}

RtStatus rt_neighbours_init(RtNeighbours *self, const RtTree *tree, RtError *error) {
    uint32_t count = tree->used, capacity = 1;
    while (capacity < count) capacity *= 2;
    *self = (RtNeighbours){.tree = tree,
                           .capacity = capacity,
                           .bounds = rt_alloc(2 * (size_t)capacity, sizeof(RtNeighbourBound)),
                           .cluster_at = rt_alloc(capacity, sizeof(uint32_t)),
                           .slot_of = rt_alloc(2 * (size_t)count - 1, sizeof(uint32_t))};
    RtTreeRef *refs = rt_alloc(count, sizeof(RtTreeRef));
    bool enough = self->bounds && self->cluster_at && self->slot_of && refs;
    for (uint32_t slot = 0; enough && slot < capacity; slot++) set_slot(self, slot, RT_NO_CLUSTER);
    for (uint32_t i = 0; enough && i < count; i++) refs[i] = (RtTreeRef){tree->nodes[i].box, i};
    if (enough) fill_slots(self, refs, count, 0, capacity);
    for (uint32_t node = capacity - 1; enough && node > 0; node--) fit_node(self, node);
    rt_free(refs);
    if (enough) return RT_OK;
    rt_neighbours_clear(self);
    return rt_fail_memory(error, "the neighbours of clusters",
                          2 * (size_t)capacity * sizeof(RtNeighbourBound));
}

void rt_neighbours_clear(RtNeighbours *self) {
    rt_free(self->bounds);
    rt_free(self->cluster_at);
    rt_free(self->slot_of);
    *self = (RtNeighbours){.tree = NULL};
}

void rt_neighbours_unite(RtNeighbours *self, uint32_t a, uint32_t b, uint32_t united) {
    uint32_t slots[2] = {self->slot_of[a], self->slot_of[b]};
    set_slot(self, slots[0], united);
    set_slot(self, slots[1], RT_NO_CLUSTER);
    for (int s = 0; s < 2; s++) {
        for (uint32_t node = (self->capacity + slots[s]) / 2; node > 0; node /= 2) fit_node(self, node);
    }
}

/* A lower bound on the distance of the clusters below `node` from one with box `box`. Rounding is monotone,
 * so it also bounds computed distances. */
static double least_distance(const RtNeighbours *self, uint32_t node, const RtBox *box) {
    const RtNeighbourBound *bound = &self->bounds[node];
    double size[3];
    for (int a = 0; a < 3; a++) {
        double least = (double)bound->size.at[a];
        size[a] =
            (double)rt_maxf(box->hi.at[a], bound->hi.at[a]) - (double)rt_minf(box->lo.at[a], bound->lo.at[a]);
        size[a] = size[a] > least ? size[a] : least;
    }
    return size[0] * (size[1] + size[2]) + size[1] * size[2];
}

typedef struct Candidate {
    uint32_t node;
    double least;
} Candidate;

/* Improves *best and *distance by the clusters below `top`, for one with box `box`. */
static void search_below(const RtNeighbours *self, uint32_t top, const RtBox *box, uint32_t *best,
                         double *distance) {
    Candidate stack[34];
    uint32_t stacked = 0;
    stack[stacked++] = (Candidate){top, least_distance(self, top, box)};
    while (stacked > 0) {
        Candidate at = stack[--stacked];
        if (!(at.least < *distance)) continue;
        if (at.node >= self->capacity) {
            *best = self->cluster_at[at.node - self->capacity];
            *distance = rt_box_half_area(rt_box_union(*box, self->tree->nodes[*best].box));
            continue;
        }
        Candidate left = {2 * at.node, least_distance(self, 2 * at.node, box)};
        Candidate right = {2 * at.node + 1, least_distance(self, 2 * at.node + 1, box)};
        bool right_first = right.least < left.least;
        stack[stacked++] = right_first ? left : right;
        stack[stacked++] = right_first ? right : left;
    }
}

uint32_t rt_neighbours_nearest(const RtNeighbours *self, uint32_t cluster, double *distance) {
    const RtBox *box = &self->tree->nodes[cluster].box;
    uint32_t best = RT_NO_CLUSTER;
    *distance = INFINITY;
    for (uint32_t node = self->capacity + self->slot_of[cluster]; node > 1; node /= 2)
        search_below(self, node ^ 1, box, &best, distance);
    return best;
}
