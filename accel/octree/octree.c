/* SPDX-License-Identifier: Apache-2.0 */
/* octree: cells divided into eight until each holds few objects; a ray tests the objects of the leaves it
 * meets.
 *
 * Papers: Glassner 1984 (traversal=points: searches every next leaf from the root); Samet 1989 (neighbours:
 * from the nearest common ancestor); Gargantini & Atkinson 1993, Revelles, Ureña & Lastra 2000 (parametric:
 * one descent by the ray's parameters at the planes).
 *
 * Layout and invariants: octree.h. Exactness: no point is computed or moved. By core/base/ray.h a hit has a t
 * at which the thick ray is in the object's box, so in a leaf that lists the object. The ray is in a cell at
 * t unless it has not yet crossed one of its near planes, (plane - org_near) * inv > t, or has crossed one of
 * its far planes, (plane - org_far) * inv < t. (A crossing is NaN for a ray exactly in the moved plane: it is
 * in the cells on both sides.) Leaves may be visited in any order, and may be skipped if they are entered
 * beyond the best t.
 *
 * `parametric` visits the nodes whose thick intervals overlap, nearest first; children inherit the crossings
 * of their parent and add those of its split.
 *
 * `points` and `neighbours` keep the cells that the ray is in: one, two while it crosses a plane, more near
 * edges. They proceed from crossing to crossing: where the ray enters what lies beyond face p of a current
 * cell L, at t, they visit every leaf that lies beyond p and that the ray is in at t. None is missed: let the
 * ray enter Q at t, last through Q's plane p of axis a. Just before p, and where Q and the ray at t meet
 * along the other axes, lies a leaf L. It ends at p (otherwise it would overlap Q), and the ray is in it at
 * t, so L is current, and its crossing of p at t is pending. The lowest ancestor of L that extends beyond p
 * contains points on both sides of p, so it contains Q: there `neighbours` starts. A cell that is found again
 * is still current, so none is visited twice. Rays that need more than MAX_CELLS cells (so far away that
 * float32 hardly distinguishes cells) use `parametric`; rays for which even the scene is not larger than a
 * cell are tested against all objects, in every traversal.
 *
 * Counting: an extent test for the box of the root; a step per node visited, on the way down or up; an empty
 * step per empty leaf. */
#include "accel/octree/octree.h"
#include "accel/kernel.h"

/* A descent pushes at most 7 nodes per depth. */
enum { MAX_STACK = 7 * RT_OCTREE_DEPTH_LIMIT + 8, MAX_CELLS = 64 };

RT_KERNEL float near_crossing(const RtPreparedRay *ray, int axis, float plane) {
    return (plane - ray->org_near[axis]) * ray->inv[axis];
}

RT_KERNEL float far_crossing(const RtPreparedRay *ray, int axis, float plane) {
    return (plane - ray->org_far[axis]) * ray->inv[axis];
}

/* The children on the near side of a split along an axis. */
RT_KERNEL uint32_t near_side(const RtPreparedRay *ray, int axis) {
    return ray->negative[axis] ? rt_octree_upper(axis) : rt_octree_lower(axis);
}

RT_KERNEL void count_leaf(bool empty, RtTally *tally) {
    RT_COUNT(tally, leaf_steps, 1);
    RT_COUNT(tally, empty_steps, empty);
}

/* `again`: a leaf that was visited before and is not visited now. */
RT_COLD static void observe_node(const RtOctree *self, uint32_t index, bool again) {
    const RtOctreeNode *node = &self->nodes[index];
    bool leaf = !rt_octree_is_inner(node) && !again;
    rt_observe(&(RtTraced){.kind = RT_TRACED_STEP,
                           .what = "node",
                           .index = index,
                           .box = &self->boxes[index],
                           .leaf = leaf,
                           .empty = leaf && node->count == 0});
}

RT_KERNEL bool visit_leaf(const RtOctree *self, RtMailbox *mailbox, const RtOctreeNode *leaf,
                          const RtPreparedRay *ray, bool any, RtHit *best, RtTally *tally) {
    count_leaf(leaf->count == 0, tally);
    return rt_test_list(&self->base.scene->geometry, mailbox, self->ids + leaf->first, leaf->count, ray, any,
                        best, tally);
}

/* ---- parametric ---- */

/* The crossings of the planes of an inner node's children, lanes x, y, z. On each axis the ray is in the
 * lower children from low_near to low_far, and in the upper ones from high_near to high_far. */
typedef struct Planes {
    RtFloat4 low_near, high_near, low_far, high_far;
} Planes;

/* A pending node. */
typedef struct Waiting {
    float enter;
    uint32_t node;
    uint16_t depth;
    bool empty; /* an empty leaf, which need not be loaded to count as a step */
} Waiting;

/* The ray in vectors. The fourth lane repeats the third, so it never holds slow denormals. */
typedef struct Line {
    RtFloat4 org_near, org_far, inv;
    RtInt4 sign;
} Line;

RT_KERNEL RtFloat4 three(const void *at) {
    RtFloat4 four = rt_loadu4(at);
    return __builtin_shufflevector(four, four, 0, 1, 2, 2);
}

RT_KERNEL Line line_of(const RtPreparedRay *ray) {
    return (Line){three(ray->org_near), three(ray->org_far), three(ray->inv), (RtInt4)three(&ray->dir) < 0};
}

/* Selects `high` on the axes on which child `octant` is the upper one, otherwise `low`. */
RT_KERNEL RtFloat4 choose(uint32_t octant, RtFloat4 low, RtFloat4 high) {
    static const RtInt4 upper[8] = {{0, 0, 0, 0},   {-1, 0, 0, 0},   {0, -1, 0, 0},   {-1, -1, 0, 0},
                                    {0, 0, -1, -1}, {-1, 0, -1, -1}, {0, -1, -1, -1}, {-1, -1, -1, -1}};
    return rt_select(upper[octant], high, low);
}

/* Splits the interval `near`..`far` of the ray in a node, on each axis, at its split. */
RT_KERNEL Planes cut(const Line *line, const RtVec3 *split, RtFloat4 near, RtFloat4 far) {
    RtFloat4 at = three(split); /* reads one word beyond, which is in the node */
    RtFloat4 first = (at - line->org_near) * line->inv, last = (at - line->org_far) * line->inv;
    return (Planes){rt_select(line->sign, first, near), rt_select(line->sign, near, first),
                    rt_select(line->sign, far, last), rt_select(line->sign, last, far)};
}

/* The entry and exit of the ray for the eight children, by octant: [0] below the split along z, [1] above. */
RT_KERNEL void span_children(Planes p, float tmin, float limit, RtFloat4 enter[2], RtFloat4 leave[2]) {
    RtFloat4 near = __builtin_shufflevector(p.low_near, p.high_near, 0, 4, 1, 5);
    RtFloat4 far = __builtin_shufflevector(p.low_far, p.high_far, 0, 4, 1, 5);
    RtFloat4 from = rt_max(__builtin_shufflevector(near, near, 0, 1, 0, 1), rt_all4(tmin));
    RtFloat4 to = rt_min(__builtin_shufflevector(far, far, 0, 1, 0, 1), rt_all4(limit));
    from = rt_max(__builtin_shufflevector(near, near, 2, 2, 3, 3), from);
    to = rt_min(__builtin_shufflevector(far, far, 2, 2, 3, 3), to);
    enter[0] = rt_max(__builtin_shufflevector(p.low_near, p.low_near, 2, 2, 2, 2), from);
    enter[1] = rt_max(__builtin_shufflevector(p.high_near, p.high_near, 2, 2, 2, 2), from);
    leave[0] = rt_min(__builtin_shufflevector(p.low_far, p.low_far, 2, 2, 2, 2), to);
    leave[1] = rt_min(__builtin_shufflevector(p.high_far, p.high_far, 2, 2, 2, 2), to);
}

/* Pushes the children that the ray meets, the first on top, of those entered at once the last; returns their
 * number. All eight are tested at once. */
RT_KERNEL uint32_t push_children(const Planes *planes, const RtOctreeNode *node, uint32_t depth,
                                 const RtPreparedRay *ray, float limit, Waiting *stack) {
    RtFloat4 enter[2], leave[2];
    span_children(*planes, ray->tmin, limit, enter, leave);
    uint32_t children = rt_le_bits(enter[0], leave[0]) | rt_le_bits(enter[1], leave[1]) << 4;
    float enters[8];
    uint32_t pushed = 0;
    memcpy(enters, enter, sizeof enter);
    for (; children; children &= children - 1) {
        uint32_t octant = (uint32_t)__builtin_ctz(children), i = pushed++;
        for (; i > 0 && stack[i - 1].enter < enters[octant]; i--) stack[i] = stack[i - 1];
        stack[i] =
            (Waiting){enters[octant], node->first + octant, (uint16_t)depth, node->count >> octant & 1};
    }
    return pushed;
}

RT_KERNEL void descend(const RtOctree *self, RtMailbox *mailbox, const RtPreparedRay *ray, bool any,
                       RtHit *best, RtTally *tally) {
    const Line line = line_of(ray);
    Planes visited[RT_OCTREE_DEPTH_LIMIT]; /* by depth */
    Waiting stack[MAX_STACK], at = {.depth = 0};
    uint32_t stacked = 0;
    RtFloat4 near, far;
    float limit = rt_limit(ray, best);
    const RtBox *root = &self->boxes[0];
    for (int a = 0; a < 3; a++) {
        near[a] = near_crossing(ray, a, rt_box_side(root, ray->first[a]));
        far[a] = far_crossing(ray, a, rt_box_side(root, ray->last[a]));
    }
    near[3] = near[2], far[3] = far[2];
    for (;;) {
        const RtOctreeNode *node = &self->nodes[at.node];
        RT_COUNT(tally, steps, 1);
        if (RT_OBSERVED(tally)) observe_node(self, at.node, false);
        if (at.empty) {
            count_leaf(true, tally);
        } else if (rt_octree_is_inner(node)) {
            if (at.node > 0) {
                const Planes *p = &visited[at.depth - 1];
                uint32_t octant = rt_octree_octant(at.node);
                near = choose(octant, p->low_near, p->high_near);
                far = choose(octant, p->low_far, p->high_far);
            }
            Planes *own = &visited[at.depth];
            *own = cut(&line, &node->split, near, far);
            stacked += push_children(own, node, at.depth + 1, ray, limit, stack + stacked);
        } else {
            if (visit_leaf(self, mailbox, node, ray, any, best, tally)) return;
            limit = rt_limit(ray, best);
        }
        do {
            if (stacked == 0) return;
            at = stack[--stacked];
        } while (at.enter > limit);
    }
}

/* ---- points and neighbours ---- */

/* A leaf that the ray is in. */
typedef struct Cell {
    uint32_t node;
    float leave;   /* when the ray has left it */
    float next[3]; /* when the ray enters what lies beyond its far face; INFINITY: never, or done */
} Cell;

/* Crossing.start of a ray that leaves the root. */
#define NOWHERE UINT32_MAX

/* Where to search for leaves next. */
typedef struct Crossing {
    float t, plane;
    int axis;       /* leaves beyond `plane` of this axis; -1: anywhere */
    uint32_t start; /* below this node */
} Crossing;

RT_KERNEL float far_plane(const RtPreparedRay *ray, const RtBox *box, int axis) {
    return (ray->negative[axis] ? box->lo : box->hi).at[axis];
}

RT_KERNEL Cell make_cell(const RtOctree *self, const RtPreparedRay *ray, uint32_t index, float t) {
    Cell cell = {.node = index, .leave = INFINITY};
    bool climbs = self->traversal == RT_OCTREE_NEIGHBOURS; /* it finds out at the root that it leaves */
    for (int a = 0; a < 3; a++)
        cell.leave = rt_minf(far_crossing(ray, a, far_plane(ray, &self->boxes[index], a)), cell.leave);
    for (int a = 0; a < 3; a++) {
        float plane = far_plane(ray, &self->boxes[index], a), next = near_crossing(ray, a, plane);
        bool outward = plane == far_plane(ray, &self->boxes[0], a);
        bool ahead = next >= t && next <= cell.leave && (climbs || !outward);
        cell.next[a] = ahead ? next : INFINITY;
    }
    return cell;
}

/* The children of an inner node that may contain leaves of the crossing, as bits. */
RT_KERNEL uint32_t children_at(const RtPreparedRay *ray, const RtOctreeNode *node, const Crossing *at) {
    uint32_t children = 0xff;
    for (int a = 0; a < 3; a++) {
        float split = node->split.at[a];
        if (a == at->axis) {
            bool beyond = ray->negative[a] ? split >= at->plane : split <= at->plane;
            children &= beyond ? ~near_side(ray, a) : near_side(ray, a);
        } else {
            if (far_crossing(ray, a, split) < at->t) children &= ~near_side(ray, a);
            if (near_crossing(ray, a, split) > at->t) children &= near_side(ray, a);
        }
    }
    return children;
}

RT_KERNEL bool is_current(const Cell *cells, uint32_t count, uint32_t node) {
    for (uint32_t i = 0; i < count; i++) {
        if (cells[i].node == node) return true;
    }
    return false;
}

/* Visits the leaves of a crossing and makes them current. True if the search is over, or if *count is
 * MAX_CELLS + 1. */
RT_KERNEL bool enter_leaves(const RtOctree *self, RtMailbox *mailbox, const Crossing *at, Cell *cells,
                            uint32_t *count, const RtPreparedRay *ray, bool any, RtHit *best,
                            RtTally *tally) {
    uint32_t stack[MAX_STACK], stacked = 0, index = at->start;
    for (;;) {
        const RtOctreeNode *node = &self->nodes[index];
        RT_COUNT(tally, steps, 1);
        if (RT_OBSERVED(tally))
            observe_node(self, index, *count == MAX_CELLS || is_current(cells, *count, index));
        if (rt_octree_is_inner(node)) {
            uint32_t children = children_at(ray, node, at);
            for (; children; children &= children - 1)
                stack[stacked++] = node->first + (uint32_t)__builtin_ctz(children);
        } else if (!is_current(cells, *count, index)) {
            if (*count == MAX_CELLS) {
                ++*count;
                return true;
            }
            cells[(*count)++] = make_cell(self, ray, index, at->t);
            if (visit_leaf(self, mailbox, node, ray, any, best, tally)) return true;
        }
        if (stacked == 0) return false;
        index = stack[--stacked];
    }
}

/* The next crossing out of a current cell, which is then marked as done; its t is INFINITY if there is
 * none. */
RT_KERNEL Crossing next_crossing(const RtOctree *self, const RtPreparedRay *ray, Cell *cells,
                                 uint32_t count) {
    Crossing soonest = {.t = INFINITY};
    uint32_t from = 0;
    for (uint32_t i = 0; i < count; i++) {
        for (int a = 0; a < 3; a++) {
            if (!(cells[i].next[a] < soonest.t)) continue;
            soonest.t = cells[i].next[a];
            soonest.axis = a;
            from = i;
        }
    }
    if (soonest.t == INFINITY) return soonest;
    cells[from].next[soonest.axis] = INFINITY;
    soonest.start = cells[from].node;
    soonest.plane = far_plane(ray, &self->boxes[soonest.start], soonest.axis);
    return soonest;
}

/* Climbs from a leaf to the lowest ancestor that extends beyond the leaf's far face along an axis; NOWHERE if
 * there is none. */
RT_KERNEL uint32_t climb(const RtOctree *self, const RtPreparedRay *ray, uint32_t index, int axis,
                         RtTally *tally) {
    while (index != 0) {
        bool first = near_side(ray, axis) >> rt_octree_octant(index) & 1;
        index = self->nodes[index].parent;
        if (first) return index;
        RT_COUNT(tally, steps, 1);
        if (RT_OBSERVED(tally)) observe_node(self, index, false);
    }
    return NOWHERE;
}

/* False if the ray is in too many cells at once. */
RT_KERNEL bool walk(const RtOctree *self, RtMailbox *mailbox, float enter, const RtPreparedRay *ray, bool any,
                    RtHit *best, RtTally *tally) {
    Cell cells[MAX_CELLS];
    uint32_t count = 0;
    Crossing at = {.t = enter, .axis = -1, .start = 0};
    for (;;) {
        if (at.start != NOWHERE && enter_leaves(self, mailbox, &at, cells, &count, ray, any, best, tally))
            return count <= MAX_CELLS;
        at = next_crossing(self, ray, cells, count);
        if (at.t > rt_limit(ray, best)) return true;
        for (uint32_t i = count; i-- > 0;) {
            if (cells[i].leave < at.t) cells[i] = cells[--count];
        }
        at.start = self->traversal == RT_OCTREE_POINTS ? 0 : climb(self, ray, at.start, at.axis, tally);
    }
}

/* Whether a ray from very far away is likely to be in more leaves than there are objects: its thickness is a
 * good part of the scene. */
RT_KERNEL bool is_in_too_many_leaves(const RtOctree *self, const RtPreparedRay *ray) {
    const RtGeometry *g = &self->base.scene->geometry;
    double side = rt_box_longest_side(self->boxes[0]);
    float thick = 0;
    for (int a = 0; a < 3; a++) thick = rt_maxf(thick, fabsf(ray->org_near[a] - ray->org_far[a]));
    double part = (double)thick < side ? (double)thick / side : 1;
    return part * part * self->node_count > g->object_count;
}

RT_KERNEL void search(const RtOctree *self, void *scratch, const RtPreparedRay *ray, bool any, RtHit *best,
                      RtTally *tally) {
    float enter;
    if (self->node_count == 0) return;
    RT_COUNT(tally, extent_tests, 1);
    bool met = rt_box_hit(&self->boxes[0], ray, ray->tmax, &enter);
    RT_OBSERVE(tally, .kind = RT_TRACED_EXTENT_TEST, .what = "node", .box = &self->boxes[0], .met = met);
    if (!met) return;
    if (is_in_too_many_leaves(self, ray)) {
        rt_test_all(&self->base.scene->geometry, ray, any, best, tally);
        return;
    }
    RtMailbox *mailbox = self->base.scratch_bytes > 0 ? scratch : NULL;
    rt_mailbox_next_ray(mailbox, &self->base.scene->geometry);
    if (self->traversal != RT_OCTREE_PARAMETRIC && walk(self, mailbox, enter, ray, any, best, tally)) return;
    descend(self, mailbox, ray, any, best, tally);
}

RT_DEFINE_KERNELS(RtOctree, search)

/* ---- describing ---- */

/* Parents come before their children, so this ends. */
static uint32_t depth_of(const RtOctree *tree, uint32_t index) {
    uint32_t depth = 0;
    for (; index > 0; index = tree->nodes[index].parent) depth++;
    return depth;
}

/* Expected steps of traversal=neighbours into a leaf and out of it, times twice the half area of the root. A
 * line enters or leaves through a face with the ratio of areas: it walks down from the node that is divided
 * there to the leaf, and up again. Through a face of the root it starts at the root, or leaves once it has
 * climbed there. */
static double seeking_steps(const RtOctree *tree, uint32_t leaf) {
    const RtVec3 size = rt_box_size(tree->boxes[leaf]);
    const double face[3] = {(double)size.y * size.z, (double)size.z * size.x, (double)size.x * size.y};
    bool sought[3][2] = {{false}};
    double steps = 0, open = 2 * (face[0] + face[1] + face[2]);
    double climbed = 1;
    for (uint32_t at = leaf; at > 0; at = tree->nodes[at].parent, climbed++) {
        for (int a = 0; a < 3; a++) {
            bool *side = &sought[a][rt_octree_octant(at) >> a & 1 ? 0 : 1];
            if (*side) continue;
            *side = true;
            steps += 2 * climbed * face[a];
            open -= face[a];
        }
    }
    return steps + (2 * climbed - 1) * open; /* climbed: depth + 1 */
}

/* A line meets a node with the ratio of areas, and then takes the steps that lead there. */
static double steps_to(const RtOctree *tree, uint32_t index) {
    double area = rt_box_half_area(tree->boxes[index]);
    if (tree->traversal == RT_OCTREE_PARAMETRIC) return area;
    if (rt_octree_is_inner(&tree->nodes[index])) return 0;
    return tree->traversal == RT_OCTREE_POINTS ? area * (depth_of(tree, index) + 1)
                                               : seeking_steps(tree, index) / 2;
}

static void each_box(const RtAccel *accel, RtBoxViewer viewer) {
    const RtOctree *tree = (const RtOctree *)accel;
    uint32_t depth = 0, end = 1, next = 1; /* of the level, of the next one */
    for (uint32_t i = 0; i < tree->node_count; i++) {
        const RtOctreeNode *node = &tree->nodes[i];
        bool leaf = !rt_octree_is_inner(node);
        if (i == end) depth++, end = next;
        if (!leaf) next = node->first + 8;
        viewer.show(viewer.context, &(RtBoxView){.box = &tree->boxes[i],
                                                 .depth = depth,
                                                 .leaf = leaf,
                                                 .objects = leaf ? node->count : 0,
                                                 .children = leaf ? 0 : 8});
    }
}

static void describe(const RtAccel *accel, RtDescription *out) {
    const RtOctree *tree = (const RtOctree *)accel;
    RtBoxSums sums = {.out = out};
    *out =
        (RtDescription){.bytes = tree->node_count * RT_OCTREE_NODE_BYTES + tree->id_count * sizeof(uint32_t),
                        RT_NO_PREDICTION};
    if (tree->node_count == 0) return;
    double steps = 0, area = rt_box_half_area(tree->boxes[0]);
    each_box(accel, (RtBoxViewer){rt_box_sums_add, &sums});
    rt_box_sums_predict(&sums, &tree->boxes[0], 0);
    for (uint32_t i = 0; i < tree->node_count; i++) steps += steps_to(tree, i);
    if (area > 0) out->predicted_steps = steps / area;
}

/* ---- validate ---- */

typedef struct Check {
    const RtOctree *tree;
    const RtGeometry *geometry;
    RtError *error;
    uint64_t *listed; /* [object_count] leaves that list each object */
} Check;

#define BROKEN(check, ...) rt_fail((check)->error, RT_MISMATCH, "octree: " __VA_ARGS__)

/* A node other than the root: its parent, its cell, its depth. */
static RtStatus check_place(const Check *check, uint32_t index) {
    const RtOctree *tree = check->tree;
    uint32_t parent = tree->nodes[index].parent;
    const RtOctreeNode *above = &tree->nodes[parent];
    if (parent >= index || !rt_octree_is_inner(above) || above->first != index - rt_octree_octant(index))
        return BROKEN(check, "node %u is not a child of its parent", index);
    RtBox cell = rt_octree_child_box(tree->boxes[parent], above->split, rt_octree_octant(index));
    if (!rt_box_equals(cell, tree->boxes[index]))
        return BROKEN(check, "the cell of node %u is not cut from its parent's", index);
    if (depth_of(tree, index) > tree->max_depth)
        return BROKEN(check, "node %u is deeper than %u", index, tree->max_depth);
    return RT_OK;
}

static RtStatus check_inner(const Check *check, uint32_t index) {
    const RtOctree *tree = check->tree;
    const RtOctreeNode *node = &tree->nodes[index];
    const RtBox *cell = &tree->boxes[index];
    if (node->first <= index || rt_octree_octant(node->first) != 0 || node->first > tree->node_count - 8)
        return BROKEN(check, "the children of node %u lie outside the nodes", index);
    for (int a = 0; a < 3; a++) {
        float split = node->split.at[a];
        if ((split > cell->lo.at[a] && split < cell->hi.at[a]) || split == cell->hi.at[a]) continue;
        return BROKEN(check, "the split of node %u lies outside its cell", index);
    }
    for (uint32_t octant = 0; octant < 8; octant++) {
        const RtOctreeNode *child = &tree->nodes[node->first + octant];
        if (child->parent != index)
            return BROKEN(check, "node %u is not a child of its parent", node->first + octant);
        if ((node->count >> octant & 1) != (child->count == 0))
            return BROKEN(check, "node %u is not as empty as its parent says", node->first + octant);
    }
    return RT_OK;
}

static RtStatus check_list(const Check *check, uint32_t index) {
    const RtOctree *tree = check->tree;
    const RtOctreeNode *leaf = &tree->nodes[index];
    const RtGeometry *g = check->geometry;
    if (leaf->first > tree->id_count || leaf->count > tree->id_count - leaf->first)
        return BROKEN(check, "the list of leaf %u lies outside the lists", index);
    const uint32_t *ids = tree->ids + leaf->first;
    for (uint32_t i = 0; i < leaf->count; i++) {
        if (ids[i] >= g->object_count || (i > 0 && ids[i - 1] >= ids[i]))
            return BROKEN(check, "the list of leaf %u is not ascending ids", index);
        RtBox object = rt_octree_grown(tree, g->boxes[ids[i]]);
        if (rt_box_is_empty(rt_box_common(tree->boxes[index], object)))
            return BROKEN(check, "leaf %u lists object %u, which it does not touch", index, ids[i]);
        check->listed[ids[i]]++;
    }
    if (leaf->count > tree->max_leaf_size && depth_of(tree, index) < tree->max_depth &&
        rt_octree_divisible(tree, g->boxes, &tree->boxes[index], ids, leaf->count))
        return BROKEN(check, "leaf %u holds %u objects and could be divided", index, leaf->count);
    return RT_OK;
}

/* Leaves that must list an object with this box. */
static uint64_t leaves_touched(const RtOctree *tree, uint32_t index, const RtBox *object) {
    const RtOctreeNode *node = &tree->nodes[index];
    if (!rt_octree_is_inner(node)) return 1;
    uint32_t children = rt_octree_sides(&tree->boxes[index], node->split, object);
    uint64_t touched = 0;
    for (uint32_t octant = 0; octant < 8; octant++)
        if (children >> octant & 1) touched += leaves_touched(tree, node->first + octant, object);
    return touched;
}

static RtStatus validate(const RtAccel *accel, RtError *error) {
    const RtOctree *tree = (const RtOctree *)accel;
    const RtGeometry *g = &accel->scene->geometry;
    RT_ARENA(arena);
    if (tree->node_count == 0) return RT_OK;
    const Check check = {tree, g, error, rt_arena_alloc(&arena, g->object_count, sizeof(uint64_t))};
    RT_TRY(rt_arena_check(&arena, "validating an octree", error));
    if (!rt_box_contains(tree->boxes[0], g->box))
        return BROKEN(&check, "its root does not contain the scene");
    for (uint32_t i = 0; i < tree->node_count; i++) {
        if (i > 0) RT_TRY(check_place(&check, i));
        RT_TRY(rt_octree_is_inner(&tree->nodes[i]) ? check_inner(&check, i) : check_list(&check, i));
    }
    for (uint32_t id = 0; id < g->object_count; id++) {
        RtBox object = rt_octree_grown(tree, g->boxes[id]);
        uint64_t touched = leaves_touched(tree, 0, &object);
        if (check.listed[id] == touched) continue;
        return BROKEN(&check, "object %u belongs to %llu leaves, but %llu list it", id,
                      (unsigned long long)touched, (unsigned long long)check.listed[id]);
    }
    return RT_OK;
}

const RtAccelOps rt_octree_ops = {
    .name = "octree",
    .summary = "cells divided into eight until each holds few objects, with three traversals",
    .paper = "Glassner 1984, Space Subdivision for Fast Ray Tracing, CG&A 4(10); Revelles, Ureña & Lastra "
             "2000, An Efficient Parametric Algorithm for Octree Traversal, WSCG",
    RT_PARAMS_OF(rt_octree_params),
    RT_BEST("max_leaf_size=16|8,split=centre|cost"),
    .trial = "octree:max_leaf_size=1", /* a scene of few objects is not divided at the default */
    .bytes = sizeof(RtOctree),
    .build = rt_octree_build,
    .destroy = rt_octree_destroy,
    .kernels = &kernels,
    .describe = describe,
    .validate = validate,
    .each_box = each_box,
    .shows_lists = true,
};
