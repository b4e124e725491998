/* SPDX-License-Identifier: Apache-2.0 */
/* bih: a bounding interval hierarchy, as a plugin; a worked example of implementing a structure from its
 * paper.
 *
 * Paper: Waechter & Keller 2006, "Instant Ray Tracing: The Bounding Interval Hierarchy", Eurographics
 * Symposium on Rendering. Like a bounding volume hierarchy it partitions objects, so each is listed once and
 * the memory is known in advance; like a kd-tree it stores planes, so a node takes 12 bytes and a step two
 * crossings.
 *
 * Layout. Nodes are in one array, the root first; the two children of a node are adjacent and follow it. An
 * inner node has an axis and two planes perpendicular to it: its left child ends at clip[0], its right child
 * begins at clip[1]. Between the planes there may be empty space, or the children may overlap. A leaf owns a
 * run of `ids`.
 *
 * Invariant. The cell of the root is the box of the scene; the cell of a child is its parent's cell, cut off
 * at its plane. The boxes of all objects below a node lie in its cell; in a left child they end at or below
 * clip[0], in a right child they begin at or above clip[1]. Every object is in one leaf; the leaves own the
 * ids from left to right. No leaf is empty, or deeper than MAX_DEPTH, which bounds the stack of the
 * traversal.
 *
 * Why it is exact. By box.h, a box that contains the box of an object may be skipped only if raytally_box_hit
 * returns 0, or if the ray enters it beyond the best hit. Cells are such boxes. A traversal carries the
 * interval of t in which the thick ray is in the current cell: from the last crossing of planes where it
 * enters to the first crossing where it leaves. Along its direction, the ray crosses one plane of a node at
 * the end of the near child (leave) and the other one at the beginning of the far child (enter). Both
 * crossings are computed by the operations of raytally_box_hit, and maximum and minimum do not depend on the
 * order. So the interval of a node is, bit for bit, what raytally_box_hit finds for its cell, and a child is
 * skipped if that returned 0. With one origin for both kinds of planes, as in the paper, hits at the faces of
 * cells would be lost.
 *
 * Counting: a step is a visited node; an extent test is the test of the root's box, or of the interval of a
 * child. */
#include <raytally/accel.h>

#include <math.h>
#include <stdio.h>
#include <stdlib.h>

enum {
    PLANE_DEPTH = 32, /* deeper groups are halved by number, so that ... */
    MAX_DEPTH = 64,   /* ... no leaf is deeper than this, even for 2^32 objects */
    LEAF = 3          /* the axis of a leaf */
};

/* The node numbers of more objects would not fit into a link. */
#define MAX_OBJECTS (UINT32_C(1) << 29)

typedef struct Node {
    uint32_t link; /* inner: 4 * its left child + its axis; leaf: 4 * the first of its ids + LEAF */
    union {
        float clip[2];  /* inner: the end of the left child, the beginning of the right one */
        uint32_t count; /* leaf: the length of its list */
    } at;
} Node;

typedef struct Bih {
    Node *nodes;   /* [node_count]; none if there are no objects */
    uint32_t *ids; /* [id_count] leaf by leaf */
    uint32_t node_count, id_count;
    raytally_box box;          /* the cell of the root */
    const raytally_box *boxes; /* [id_count] boxes of the objects. Borrowed */
} Bih;

enum { PARAM_MAX_LEAF_SIZE, PARAM_SPLIT, PARAMS };

static const raytally_param params[PARAMS] = {
    {"max_leaf_size", RAYTALLY_INT, "4", 1, 1024, NULL, "1|2|1024", "most objects a leaf may hold",
     "measured"},
    {"split", RAYTALLY_CHOICE, "global", 0, 0, "global|local", NULL,
     "a plane halves a cell of a grid over the whole scene, or the space between the centres at hand",
     "Waechter & Keller 2006"},
};

/* ---- build ---- */

typedef struct Builder {
    Bih *bih;
    uint32_t max_leaf_size;
    int local;
} Builder;

/* ids[first..first + count), and their cell of the grid. */
typedef struct Group {
    uint32_t first, count, depth;
    raytally_box cell;
} Group;

/* Halved before the addition, so that the sum is finite. */
static float center(const raytally_box *box, int axis) {
    return 0.5F * box->lo[axis] + 0.5F * box->hi[axis];
}

static raytally_box box_of_centers(const Bih *bih, const Group *group) {
    raytally_box box = {{INFINITY, INFINITY, INFINITY}, {-INFINITY, -INFINITY, -INFINITY}};
    for (uint32_t i = group->first; i < group->first + group->count; i++) {
        for (int a = 0; a < 3; a++) {
            const float at = center(&bih->boxes[bih->ids[i]], a);
            if (at < box.lo[a]) box.lo[a] = at;
            if (at > box.hi[a]) box.hi[a] = at;
        }
    }
    return box;
}

/* The paper's heuristic: planes halve the longest side of a cell. If all objects are on one side, nothing is
 * stored, and the search continues in that half of the cell. Returns 0 if no plane separates the centres. */
static int find_plane(const raytally_box *centers, raytally_box *cell, int *axis, float *plane) {
    for (;;) {
        int longest = 0;
        for (int a = 1; a < 3; a++) {
            if (cell->hi[a] - cell->lo[a] > cell->hi[longest] - cell->lo[longest]) longest = a;
        }
        const float middle = center(cell, longest);
        if (!(cell->lo[longest] < middle && middle < cell->hi[longest])) return 0;
        if (centers->hi[longest] < middle) {
            cell->hi[longest] = middle;
        } else if (centers->lo[longest] >= middle) {
            cell->lo[longest] = middle;
        } else {
            *axis = longest;
            *plane = middle;
            return 1;
        }
    }
}

/* As in quicksort. Returns the number of objects left of the plane. */
static uint32_t part(const Bih *bih, const Group *group, int axis, float plane) {
    uint32_t *ids = bih->ids + group->first, left = 0, right = group->count;
    while (left < right) {
        const uint32_t id = ids[left];
        if (center(&bih->boxes[id], axis) < plane) {
            left++;
        } else {
            ids[left] = ids[--right];
            ids[right] = id;
        }
    }
    return left;
}

/* Computes the sides of a group; returns the axis. */
static int split(const Builder *b, const Group *group, Group sides[2]) {
    int axis = 0;
    float plane = 0;
    raytally_box centers = box_of_centers(b->bih, group), cell = b->local ? centers : group->cell;
    uint32_t left = group->count / 2;
    const int found = group->depth < PLANE_DEPTH && find_plane(&centers, &cell, &axis, &plane);
    if (found) left = part(b->bih, group, axis, plane);
    sides[0] = (Group){group->first, left, group->depth + 1, cell};
    sides[1] = (Group){group->first + left, group->count - left, group->depth + 1, cell};
    if (found) sides[0].cell.hi[axis] = sides[1].cell.lo[axis] = plane;
    return axis;
}

static void divide(const Builder *b, uint32_t index, Group group) {
    Bih *bih = b->bih;
    Node *node = &bih->nodes[index];
    Group sides[2];
    if (group.count <= b->max_leaf_size) {
        node->link = 4 * group.first + LEAF;
        node->at.count = group.count;
        return;
    }
    const uint32_t axis = (uint32_t)split(b, &group, sides), child = bih->node_count;
    float end = -INFINITY, begin = INFINITY;
    for (uint32_t i = 0; i < group.count; i++) {
        const raytally_box *box = &bih->boxes[bih->ids[group.first + i]];
        if (i < sides[0].count)
            end = box->hi[axis] > end ? box->hi[axis] : end;
        else
            begin = box->lo[axis] < begin ? box->lo[axis] : begin;
    }
    bih->node_count += 2;
    node->link = 4 * child + axis;
    node->at.clip[0] = end;
    node->at.clip[1] = begin;
    for (uint32_t s = 0; s < 2; s++) divide(b, child + s, sides[s]);
}

static void destroy(void *self) {
    Bih *bih = (Bih *)self;
    free(bih->nodes);
    free(bih->ids);
    free(bih);
}

static int fill(Bih *bih, const raytally_build_input *what) {
    const uint32_t count = what->object_count;
    const size_t most = 2 * (size_t)count - 1; /* one for each object, and one for each split */
    bih->nodes = (Node *)malloc(most * sizeof(Node));
    bih->ids = (uint32_t *)malloc(count * sizeof(uint32_t));
    if (!bih->nodes || !bih->ids) return RAYTALLY_BUILD_NO_MEMORY;
    for (uint32_t i = 0; i < count; i++) bih->ids[i] = i;
    bih->id_count = count;
    bih->node_count = 1;
    const Builder builder = {bih, (uint32_t)what->values[PARAM_MAX_LEAF_SIZE].integer,
                             what->values[PARAM_SPLIT].choice == 1};
    divide(&builder, 0, (Group){0, count, 0, what->box});
    Node *fitting = (Node *)realloc(bih->nodes, bih->node_count * sizeof(Node));
    if (fitting) bih->nodes = fitting;
    return RAYTALLY_BUILD_OK;
}

static int build(const raytally_build_input *what, void **self) {
    const uint64_t count = what->object_count;
    if (count > MAX_OBJECTS) {
        snprintf(what->message, what->message_room, "a bih holds %u objects at most", (unsigned)MAX_OBJECTS);
        return RAYTALLY_BUILD_REFUSED;
    }
    if (2 * count * sizeof(Node) + count * sizeof(uint32_t) > what->byte_limit)
        return RAYTALLY_BUILD_NO_MEMORY;
    Bih *bih = (Bih *)calloc(1, sizeof(Bih));
    if (!bih) return RAYTALLY_BUILD_NO_MEMORY;
    bih->box = what->box;
    bih->boxes = what->boxes;
    const int built = count == 0 ? RAYTALLY_BUILD_OK : fill(bih, what);
    if (built == RAYTALLY_BUILD_OK)
        *self = bih;
    else
        destroy(bih);
    return built;
}

/* ---- queries ---- */

/* A node, with the interval of t in which the thick ray is in its cell. */
typedef struct Span {
    uint32_t node;
    float enter, leave;
} Span;

/* Clips a span at the plane where a cell begins, or at the one where it ends. A NaN, of a ray within the
 * moved plane, is ignored, as by raytally_box_hit. */
RAYTALLY_INLINE void begin_at(Span *span, const raytally_prepared *ray, uint32_t axis, float plane) {
    const float enter = (plane - ray->org_near[axis]) * ray->inv[axis];
    span->enter = enter > span->enter ? enter : span->enter;
}

RAYTALLY_INLINE void end_at(Span *span, const raytally_prepared *ray, uint32_t axis, float plane) {
    const float leave = (plane - ray->org_far[axis]) * ray->inv[axis];
    span->leave = leave < span->leave ? leave : span->leave;
}

RAYTALLY_INLINE void search(const Bih *bih, void *memory, const raytally_prepared *ray, int any,
                            raytally_hit *best, raytally_counters *counters) {
    Span stack[MAX_DEPTH]; /* one pending child for every inner node above */
    Span span = {0, ray->tmin, ray->tmax};
    uint32_t stacked = 0;
    (void)memory;
    if (bih->node_count == 0) return;
    RAYTALLY_COUNT(counters, RAYTALLY_EXTENT_TESTS, 1);
    for (uint32_t a = 0; a < 3; a++) {
        begin_at(&span, ray, a, raytally_box_side(&bih->box, ray->first[a]));
        end_at(&span, ray, a, raytally_box_side(&bih->box, ray->last[a]));
    }
    if (!(span.enter <= span.leave)) return;
    for (;;) {
        const Node *node = &bih->nodes[span.node];
        const uint32_t axis = node->link & 3, first = node->link >> 2;
        RAYTALLY_COUNT(counters, RAYTALLY_STEPS, 1);
        if (axis != LEAF) {
            const uint32_t near_side = ray->negative[axis], far_side = 1 - near_side;
            Span near_child = {first + near_side, span.enter, span.leave};
            Span far_child = {first + far_side, span.enter, span.leave};
            end_at(&near_child, ray, axis, node->at.clip[near_side]);
            begin_at(&far_child, ray, axis, node->at.clip[far_side]);
            RAYTALLY_COUNT(counters, RAYTALLY_EXTENT_TESTS, 2);
            const int meets_near = near_child.enter <= near_child.leave;
            const int meets_far = far_child.enter <= far_child.leave;
            if (meets_near && meets_far) stack[stacked++] = far_child;
            if (meets_near || meets_far) {
                span = meets_near ? near_child : far_child;
                continue;
            }
        } else {
            RAYTALLY_COUNT(counters, RAYTALLY_LEAF_STEPS, 1);
            if (raytally_object_hits(ray, bih->ids + first, node->at.count, any, best, counters)) return;
        }
        /* A cell entered at the t of the best hit may hold an object with the same t and a lower number. */
        const float limit = raytally_tmax(ray, best);
        do {
            if (stacked == 0) return;
            span = stack[--stacked];
        } while (span.enter > limit);
        if (limit < span.leave) span.leave = limit;
    }
}

RAYTALLY_DEFINE_KERNELS(Bih, search)

/* ---- describe and validate ---- */

/* A node and its cell. */
typedef struct Place {
    uint32_t node, depth;
    raytally_box cell;
} Place;

static int is_leaf(const Node *node) {
    return (node->link & 3) == LEAF;
}

static Place child_of(const Bih *bih, const Place *parent, uint32_t side) {
    const Node *node = &bih->nodes[parent->node];
    Place child = {(node->link >> 2) + side, parent->depth + 1, parent->cell};
    (side == 0 ? child.cell.hi : child.cell.lo)[node->link & 3] = node->at.clip[side];
    return child;
}

static double half_area(const raytally_box *box) {
    const double x = (double)box->hi[0] - (double)box->lo[0], y = (double)box->hi[1] - (double)box->lo[1],
                 z = (double)box->hi[2] - (double)box->lo[2];
    return x * y + y * z + z * x;
}

static void describe_below(const Bih *bih, Place place, raytally_description *out) {
    const Node *node = &bih->nodes[place.node];
    const double share = half_area(&place.cell) / half_area(&bih->box); /* of random lines that hit it */
    out->predicted_steps += share;
    if (is_leaf(node)) {
        out->leaves++;
        if (place.depth > out->depth) out->depth = place.depth;
        out->predicted_tests += share * node->at.count;
        return;
    }
    out->interior++;
    for (uint32_t s = 0; s < 2; s++) describe_below(bih, child_of(bih, &place, s), out);
}

static void describe(const void *self, raytally_description *out) {
    const Bih *bih = (const Bih *)self;
    if (bih->node_count == 0) return;
    out->references = bih->id_count;
    out->bytes = bih->node_count * sizeof(Node) + bih->id_count * sizeof(uint32_t);
    out->predicted_steps = out->predicted_tests = 0;
    describe_below(bih, (Place){0, 0, bih->box}, out);
}

static void show_below(const Bih *bih, Place place, raytally_box_visitor *show, void *viewer) {
    const int leaf = is_leaf(&bih->nodes[place.node]);
    show(viewer, &place.cell, place.depth, leaf);
    for (uint32_t s = 0; s < 2 && !leaf; s++) show_below(bih, child_of(bih, &place, s), show, viewer);
}

static void each_box(const void *self, raytally_box_visitor *show, void *viewer) {
    const Bih *bih = (const Bih *)self;
    if (bih->node_count > 0) show_below(bih, (Place){0, 0, bih->box}, show, viewer);
}

typedef struct Check {
    const Bih *bih;
    uint8_t *seen;          /* [id_count] by object */
    uint32_t nodes, listed; /* so far */
} Check;

static int holds(const raytally_box *cell, const raytally_box *box) {
    int inside = 1;
    for (int a = 0; a < 3; a++) inside = inside && cell->lo[a] <= box->lo[a] && box->hi[a] <= cell->hi[a];
    return inside;
}

/* Returns what is wrong, or NULL. */
static const char *check_leaf(Check *check, const Place *place, const Node *node) {
    const Bih *bih = check->bih;
    if (node->at.count == 0) return "a leaf is empty";
    if (node->link >> 2 != check->listed || node->at.count > bih->id_count - check->listed)
        return "the list of a leaf does not follow that of the leaf before";
    for (uint32_t i = 0; i < node->at.count; i++) {
        const uint32_t id = bih->ids[check->listed++];
        if (id >= bih->id_count || check->seen[id]++) return "an object is listed twice";
        if (!holds(&place->cell, &bih->boxes[id])) return "an object lies outside the cell of its leaf";
    }
    return NULL;
}

static const char *check_below(Check *check, Place place) {
    const Node *node = &check->bih->nodes[place.node];
    const uint32_t child = node->link >> 2;
    const char *broken = NULL;
    check->nodes++;
    if (is_leaf(node)) return check_leaf(check, &place, node);
    if (place.depth >= MAX_DEPTH) return "a leaf is too deep";
    if (child <= place.node || child >= check->bih->node_count - 1)
        return "a child does not come after its parent";
    for (uint32_t s = 0; s < 2 && !broken; s++) broken = check_below(check, child_of(check->bih, &place, s));
    return broken;
}

static int validate(const void *self, char *message, size_t size) {
    const Bih *bih = (const Bih *)self;
    if (bih->node_count == 0) return 0;
    Check check = {bih, (uint8_t *)calloc(bih->id_count, 1), 0, 0};
    const char *broken = "there is not enough memory to look at every object";
    if (check.seen) broken = check_below(&check, (Place){0, 0, bih->box});
    if (!broken && check.listed < bih->id_count) broken = "an object is in no leaf";
    if (!broken && check.nodes < bih->node_count) broken = "a node has no parent";
    free(check.seen);
    if (broken) snprintf(message, size, "%s", broken);
    return broken != NULL;
}

static const raytally_accel_ops bih_ops = {
    .abi = RAYTALLY_ACCEL_ABI,
    .size = sizeof(raytally_accel_ops),
    .name = "bih",
    .summary = "bounding intervals: objects parted in two, each half cut off by one plane",
    .paper = "Waechter & Keller 2006, Instant Ray Tracing: The Bounding Interval Hierarchy, EGSR",
    .params = params,
    .param_count = PARAMS,
    .build = build,
    .destroy = destroy,
    .nearest = search_nearest,
    .occluded = search_occluded,
    .describe = describe,
    .validate = validate,
    .each_box = each_box,
};

RAYTALLY_PLUGIN {
    return index == 0 ? &bih_ops : NULL;
}
