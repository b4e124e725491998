/* bvh: a binary hierarchy of boxes built from the top by the surface area heuristic in bins.
 *
 * Papers: MacDonald & Booth 1990 (the heuristic), Wald 2007, "On fast Construction of SAH-based Bounding
 * Volume Hierarchies" (the bins); near child first, the far one on a stack with its entry.
 *
 * Layout: one array of 32-byte nodes, the two children of a node side by side; one array of object ids, of
 * which a leaf owns a run. Node 0 is the root. Invariants: a node's box contains the boxes of its objects;
 * every object is in exactly one leaf; no leaf is empty; no leaf is deeper than MAX_DEPTH, which bounds the
 * stack of a traversal. Counting: an extent test per box tested, the root's included; a step per node
 * visited. */
#include "accel/kernel.h"
#include "accel/split.h"
#include "base/memory.h"

#include <assert.h>
#include <string.h>

/* From this depth on nodes are halved by number, so 2^28 objects end above MAX_DEPTH. */
enum { MAX_DEPTH = 64, HALVE_DEPTH = 34 };

enum { PARAM_BINS, PARAM_LEAF, PARAM_TRAVERSAL, PARAM_COUNT };

static const RtParam params[PARAM_COUNT] = {
    [PARAM_BINS] = {.name = "bins",
                    .type = RT_PARAM_INT,
                    .standard = "16",
                    .lo = 2,
                    .hi = RT_MAX_BINS,
                    .meaning = "bins along each axis in which split positions are sought",
                    .source = "Wald 2007",
                    .tries = "2|5|64"},
    [PARAM_LEAF] = {.name = "leaf",
                    .type = RT_PARAM_INT,
                    .standard = "8",
                    .lo = 1,
                    .hi = 1024,
                    .meaning = "most objects a leaf may hold",
                    .source = "measured: no better beyond",
                    .tries = "1|2|64"},
    [PARAM_TRAVERSAL] = {.name = "traversal",
                         .type = RT_PARAM_FLOAT,
                         .standard = "1",
                         .lo = 0,
                         .hi = 1000,
                         .meaning = "cost of visiting an inner node, in object tests",
                         .source = "MacDonald & Booth 1990",
                         .tries = "0|0.1|10"},
};

typedef struct Node {
    RtBox box;
    uint32_t first; /* inner: the left child, the right one follows; leaf: the first of its ids */
    uint32_t count; /* objects of a leaf; 0 for an inner node */
} Node;

typedef struct Bvh {
    RtAccel base;
    Node *nodes;   /* [node_count] */
    uint32_t *ids; /* [object_count], leaf by leaf */
    uint32_t node_count;
    double traversal_cost;
    uint32_t leaf_limit;
} Bvh;

extern const RtAccelOps rt_bvh_ops;

/* ---- build ---- */

typedef struct Builder {
    Bvh *bvh;
    const RtBox *boxes; /* of the objects */
    int bins;
} Builder;

/* How many of ids[0..count) go to the left child, now in front; 0 for a leaf. */
static uint32_t divide(const Builder *b, const Node *node, uint32_t *ids, uint32_t count, int depth) {
    if (count == 1) return 0;
    RtSplit best = {.cost = INFINITY};
    if (depth < HALVE_DEPTH) best = rt_split_find(b->boxes, ids, count, b->bins);
    double area = rt_box_half_area(node->box);
    bool pays = best.cost + b->bvh->traversal_cost * area < area * count;
    if (count <= b->bvh->leaf_limit && !pays) return 0;
    /* Coincident centres, or too deep: halves of equal number, in the order they have. */
    return best.cost < INFINITY ? rt_split_partition(&best, b->boxes, ids, count) : count / 2;
}

/* Makes node `index` from ids[first..first + count). */
static void build_node(Builder *b, uint32_t index, uint32_t first, uint32_t count, int depth) {
    assert(depth < MAX_DEPTH);
    Bvh *bvh = b->bvh;
    Node *node = &bvh->nodes[index];
    node->box = RT_EMPTY_BOX;
    for (uint32_t i = first; i < first + count; i++)
        node->box = rt_box_union(node->box, b->boxes[bvh->ids[i]]);
    uint32_t left = divide(b, node, bvh->ids + first, count, depth);
    if (left == 0) {
        node->first = first;
        node->count = count;
        return;
    }
    node->first = bvh->node_count;
    node->count = 0;
    bvh->node_count += 2;
    build_node(b, node->first, first, left, depth + 1);
    build_node(b, node->first + 1, first + left, count - left, depth + 1);
}

static void destroy(RtAccel *accel) {
    Bvh *bvh = (Bvh *)accel;
    rt_free(bvh->nodes);
    rt_free(bvh->ids);
    rt_free(bvh);
}

static RtStatus build(const RtScene *scene, const RtValue *values, RtAccel **out, RtError *error) {
    const RtGeometry *g = &scene->geometry;
    uint32_t count = g->object_count;
    size_t most_nodes = count > 0 ? 2 * (size_t)count - 1 : 0;
    RtAccel *accel;
    RT_TRY(rt_accel_new(&rt_bvh_ops, scene, sizeof(Bvh), &accel, error));
    Bvh *bvh = (Bvh *)accel;
    bvh->nodes = rt_alloc(most_nodes, sizeof(Node));
    bvh->ids = rt_alloc(count, sizeof(uint32_t));
    bvh->traversal_cost = values[PARAM_TRAVERSAL].f;
    bvh->leaf_limit = (uint32_t)values[PARAM_LEAF].i;
    if (!bvh->nodes || !bvh->ids) {
        destroy(accel);
        return rt_fail_memory(error, "the nodes of a bvh",
                              most_nodes * sizeof(Node) + count * sizeof(uint32_t));
    }
    for (uint32_t i = 0; i < count; i++) bvh->ids[i] = i;
    if (count > 0) {
        Builder builder = {bvh, g->boxes, (int)values[PARAM_BINS].i};
        bvh->node_count = 1;
        build_node(&builder, 0, 0, count, 0);
    }
    *out = accel;
    return RT_OK;
}

/* ---- queries ---- */

typedef struct StackEntry {
    uint32_t node;
    float enter;
} StackEntry;

RT_KERNEL void search(const Bvh *self, void *scratch, const RtPreparedRay *ray, bool any, RtHit *best,
                      RtTally *tally) {
    (void)scratch;
    const RtGeometry *g = &self->base.scene->geometry;
    StackEntry stack[MAX_DEPTH];
    uint32_t stacked = 0, index = 0;
    float enter[2];
    if (self->node_count == 0) return;
    RT_COUNT(tally, extent_tests, 1);
    if (!rt_box_hit(&self->nodes[0].box, ray, ray->tmax, &enter[0])) return;
    for (;;) {
        const Node *node = &self->nodes[index];
        RT_COUNT(tally, steps, 1);
        if (node->count == 0) {
            float limit = rt_limit(ray, best);
            bool left = rt_box_hit(&self->nodes[node->first].box, ray, limit, &enter[0]);
            bool right = rt_box_hit(&self->nodes[node->first + 1].box, ray, limit, &enter[1]);
            RT_COUNT(tally, extent_tests, 2);
            if (left || right) {
                uint32_t near = left && right ? enter[1] < enter[0] : right;
                if (left && right) stack[stacked++] = (StackEntry){node->first + 1 - near, enter[1 - near]};
                index = node->first + near;
                continue;
            }
        }
        RT_COUNT(tally, leaf_steps, 1);
        for (uint32_t i = node->first; i < node->first + node->count; i++) {
            if (rt_test_object(g, self->ids[i], ray, any, best, tally)) return;
        }
        /* The next node that may still hold a nearer hit, or an equal one of lower id. */
        do {
            if (stacked == 0) return;
            stacked--;
        } while (stack[stacked].enter > rt_limit(ray, best));
        index = stack[stacked].node;
    }
}

RT_DEFINE_KERNELS(Bvh, search)

/* ---- describe and validate ---- */

static void walk(const Bvh *bvh, uint32_t index, uint32_t depth,
                 void (*visit)(void *context, const Node *node, uint32_t depth), void *context) {
    const Node *node = &bvh->nodes[index];
    visit(context, node, depth);
    if (node->count > 0) return;
    walk(bvh, node->first, depth + 1, visit, context);
    walk(bvh, node->first + 1, depth + 1, visit, context);
}

typedef struct Survey {
    RtDescription *out;
    double inner, leaves,
        tests; /* visits of nodes and tests of objects expected, times the area of the root */
} Survey;

static void survey_node(void *context, const Node *node, uint32_t depth) {
    Survey *survey = context;
    RtDescription *out = survey->out;
    bool leaf = node->count > 0;
    out->interior += !leaf;
    out->leaves += leaf;
    out->references += node->count;
    if (depth > out->depth) out->depth = depth;
    double area = rt_box_half_area(node->box);
    *(leaf ? &survey->leaves : &survey->inner) += area;
    survey->tests += area * node->count;
}

static void describe(const RtAccel *accel, RtDescription *out) {
    const Bvh *bvh = (const Bvh *)accel;
    *out = (RtDescription){.bytes = bvh->node_count * sizeof(Node) +
                                    accel->scene->geometry.object_count * sizeof(uint32_t),
                           RT_NO_PREDICTION};
    if (bvh->node_count == 0) return;
    Survey survey = {out, 0, 0, 0};
    walk(bvh, 0, 0, survey_node, &survey);
    double area = rt_box_half_area(bvh->nodes[0].box);
    if (!(area > 0)) return;
    out->predicted_tests = survey.tests / area;
    out->predicted_steps = (survey.inner + survey.leaves) / area;
    out->predicted_cost = (survey.tests + bvh->traversal_cost * survey.inner) / area;
}

typedef struct Check {
    const Bvh *bvh;
    RtError *error;
    uint32_t *seen; /* [object_count] how often each object is in a leaf */
} Check;

static RtStatus check_leaf(const Check *check, const Node *leaf, uint32_t index) {
    const RtGeometry *g = &check->bvh->base.scene->geometry;
    for (uint64_t i = leaf->first; i < (uint64_t)leaf->first + leaf->count; i++) {
        if (i >= g->object_count || check->bvh->ids[i] >= g->object_count)
            return rt_fail(check->error, RT_MISMATCH, "bvh: leaf %u holds no object", index);
        uint32_t id = check->bvh->ids[i];
        if (++check->seen[id] > 1)
            return rt_fail(check->error, RT_MISMATCH, "bvh: object %u is in a leaf twice, or in two", id);
        if (rt_box_contains(leaf->box, g->boxes[id])) continue;
        return rt_fail(check->error, RT_MISMATCH, "bvh: leaf %u does not contain its object %u", index, id);
    }
    return RT_OK;
}

/* Ends whatever the nodes hold: children come after their parents, and no leaf is passed twice. */
static RtStatus check_node(const Check *check, uint32_t index, uint32_t depth) {
    const Bvh *bvh = check->bvh;
    const Node *node = &bvh->nodes[index];
    if (depth >= MAX_DEPTH) return rt_fail(check->error, RT_MISMATCH, "bvh: node %u is too deep", index);
    if (node->count > 0) return check_leaf(check, node, index);
    if (node->first <= index || node->first >= bvh->node_count - 1)
        return rt_fail(check->error, RT_MISMATCH, "bvh: node %u has children that are not there", index);
    for (uint32_t child = node->first; child < node->first + 2; child++) {
        if (!rt_box_contains(node->box, bvh->nodes[child].box))
            return rt_fail(check->error, RT_MISMATCH, "bvh: node %u does not contain its child", index);
        RT_TRY(check_node(check, child, depth + 1));
    }
    return RT_OK;
}

static RtStatus validate(const RtAccel *accel, RtError *error) {
    const Bvh *bvh = (const Bvh *)accel;
    uint32_t count = accel->scene->geometry.object_count;
    if (count == 0) return RT_OK;
    Check check = {bvh, error, rt_alloc(count, sizeof(uint32_t))};
    if (!check.seen) return rt_fail_memory(error, "validating a bvh", count * sizeof(uint32_t));
    RtStatus status = check_node(&check, 0, 0);
    for (uint32_t id = 0; status == RT_OK && id < count; id++) {
        if (check.seen[id] == 0) status = rt_fail(error, RT_MISMATCH, "bvh: object %u is in no leaf", id);
    }
    rt_free(check.seen);
    return status;
}

static void show_node(void *context, const Node *node, uint32_t depth) {
    const RtBoxViewer *viewer = context;
    viewer->show(viewer->context, &node->box, depth);
}

static void each_box(const RtAccel *accel, RtBoxViewer viewer) {
    const Bvh *bvh = (const Bvh *)accel;
    if (bvh->node_count > 0) walk(bvh, 0, 0, show_node, &viewer);
}

const RtAccelOps rt_bvh_ops = {
    .name = "bvh",
    .summary = "binary hierarchy of boxes, split from the top by the surface area heuristic in bins",
    .paper = "Wald 2007, On fast Construction of SAH-based Bounding Volume Hierarchies, RT'07",
    .params = params,
    .param_count = PARAM_COUNT,
    .build = build,
    .destroy = destroy,
    RT_KERNEL_OPS,
    .describe = describe,
    .validate = validate,
    .each_box = each_box,
};
