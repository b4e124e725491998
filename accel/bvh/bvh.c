/* SPDX-License-Identifier: Apache-2.0 */
/* bvh: a binary hierarchy of boxes, built in one of several ways.
 *
 * Papers: MacDonald & Booth 1990 (the surface area heuristic), Wald 2007, "On fast Construction of SAH-based
 * Bounding Volume Hierarchies", and those in accel/tree/tree.h. A tree of references is built first, then
 * laid out, which decides what shares a leaf (accel/tree/hierarchy.h has the layout and its invariants). One
 * traversal serves all builds: the near child first, the far one on a stack with its entry; RT_TREE_MAX_DEPTH
 * bounds the stack. With split references an object may be in several leaves; a mailbox avoids repeated
 * tests.
 *
 * Counting: an extent test per box tested, including the root's; a step per node visited. */
#include "accel/bvh/bvh.h"
#include "accel/clipping.h"

#define PARAMS(X)                                                                                            \
    X(PARAM_BUILD, "build", RT_CHOICE("binned", RT_TREE_METHODS),                                            \
      "binned SAH; SAH at every centre; splits of the Morton order; nearest neighbours in Morton order; "    \
      "binned SAH with spatial splits",                                                                      \
      "Wald 2007")                                                                                           \
    X(PARAM_BINS, "bins", RT_INT("16", 2, RT_MAX_BINS, "2|5|64"),                                            \
      "build=binned, spatial: SAH bins along each axis; for fewer than 1024 objects, 16 at most",            \
      "Wald 2007")                                                                                           \
    X(PARAM_BITS, "bits", RT_INT("21", 1, RT_MAX_MORTON_BITS, "1|10"),                                       \
      "build=lbvh, ploc: bits of a Morton code along each axis", "the most that fit in 64 bits")             \
    X(PARAM_RADIUS, "radius", RT_INT("25", 1, 1024, "1|100"),                                                \
      "build=ploc: neighbours searched on either side", "Meister & Bittner 2018")                            \
    X(PARAM_ALPHA, "alpha", RT_FLOAT("1e-05", 0, 1, "0|0.01"),                                               \
      "build=spatial: spatial splits are tried where the sides overlap by more than this part of the "       \
      "root's area",                                                                                         \
      "Stich et al. 2009")                                                                                   \
    X(PARAM_BUDGET, "budget", RT_FLOAT("2", 1, 16, "1|1.1|16"),                                              \
      "build=spatial: maximum average number of references per object", "this program")                      \
    X(PARAM_MAILBOX, "mailbox", RT_FLAG("on"), "build=spatial: test an object at most once per ray",         \
      "Kirk & Arvo 1991")                                                                                    \
    X(PARAM_MAX_LEAF_SIZE, "max_leaf_size", RT_INT("8", 1, 1024, "1|2|64"),                                  \
      "maximum number of objects in a leaf", "measured: larger is no better")                                \
    X(PARAM_TRAVERSAL_COST, "traversal_cost", RT_FLOAT("1", 0, 1000, "0|0.1|10"),                            \
      "cost of visiting an inner node, in object tests", "MacDonald & Booth 1990")                           \
    X(PARAM_REINSERTION, "reinsertion", RT_INT("0", 0, 1000, "1|3"),                                         \
      "maximum number of rounds in which subtrees move to cheaper places", "0: the tree as built")

enum { PARAMS(RT_PARAM_INDEX) };
static const RtParam params[] = {PARAMS(RT_PARAM_ENTRY)};

/* ---- build ---- */

static RtStatus build(RtAccel *accel, const RtBuild *what, RtError *error) {
    const RtGeometry *geometry = &what->scene->geometry;
    const RtValue *values = what->values;
    RtBvh *self = (RtBvh *)accel;
    self->hierarchy = (RtHierarchy){.width = 2,
                                    .max_leaf_size = (uint32_t)values[PARAM_MAX_LEAF_SIZE].i,
                                    .traversal_cost = values[PARAM_TRAVERSAL_COST].f};
    const RtTreeOptions options = {.method = (RtTreeMethod)values[PARAM_BUILD].choice,
                                   .bits = (uint32_t)values[PARAM_BITS].i,
                                   .radius = (uint32_t)values[PARAM_RADIUS].i,
                                   .spatial = {.bins = (int)values[PARAM_BINS].i,
                                               .alpha = values[PARAM_ALPHA].f,
                                               .budget = values[PARAM_BUDGET].f,
                                               .max_leaf_size = self->hierarchy.max_leaf_size,
                                               .traversal = self->hierarchy.traversal_cost,
                                               .limit = what->limit},
                                   .reinsertion = (uint32_t)values[PARAM_REINSERTION].i,
                                   .batch = 1};
    RT_TRY(rt_hierarchy_build(&self->hierarchy, &accel->memory, geometry, &options, what->threads, error));
    if (!self->hierarchy.split_refs) return RT_OK;
    return rt_set_mailbox(accel, values[PARAM_MAILBOX].flag, error);
}

/* ---- queries ---- */

typedef struct Waiting {
    const RtNode *node;
    float enter;
} Waiting;

RT_COLD static void observe_children(const RtNode *nodes, uint32_t first, bool left, bool right) {
    for (uint32_t i = first; i < first + 2; i++)
        rt_observe(&(RtTraced){.kind = RT_TRACED_EXTENT_TEST,
                               .what = "node",
                               .index = i,
                               .box = &nodes[i].box,
                               .met = i == first ? left : right});
}

RT_KERNEL void walk(const RtBvh *self, RtMailbox *mailbox, const RtPreparedRay *ray, bool any, RtHit *best,
                    RtTally *tally) {
    const RtGeometry *g = &self->base.scene->geometry;
    const RtNode *nodes = self->hierarchy.nodes, *node = nodes;
    const uint32_t *ids = self->hierarchy.ids;
    Waiting stack[RT_TREE_MAX_DEPTH]; /* at most one entry per level */
    Waiting *top = stack;
    float enter[2];
    if (self->hierarchy.node_count == 0) return;
    RT_COUNT(tally, extent_tests, 1);
    bool met = rt_box_hit(&nodes[0].box, ray, ray->tmax, &enter[0]);
    RT_OBSERVE(tally, .kind = RT_TRACED_EXTENT_TEST, .what = "node", .box = &nodes[0].box, .met = met);
    if (!met) return;
    for (;;) {
        RT_COUNT(tally, steps, 1);
        RT_OBSERVE(tally, .kind = RT_TRACED_STEP, .what = "node", .index = (uint32_t)(node - nodes),
                   .box = &node->box, .leaf = rt_node_is_leaf(node));
        if (!rt_node_is_leaf(node)) {
            const RtNode *children = nodes + node->first;
            float limit = rt_limit(ray, best);
            bool left = rt_box_hit(&children[0].box, ray, limit, &enter[0]);
            bool right = rt_box_hit(&children[1].box, ray, limit, &enter[1]);
            RT_COUNT(tally, extent_tests, 2);
            if (RT_OBSERVED(tally)) observe_children(nodes, node->first, left, right);
            /* Branches, not a computed index: they are predicted, so the next boxes are loaded before the
             * tests are done. At least a third faster. */
            if (left && (!right || enter[0] <= enter[1])) {
                if (right) *top++ = (Waiting){&children[1], enter[1]};
                node = &children[0];
                continue;
            }
            if (right) {
                if (left) *top++ = (Waiting){&children[0], enter[0]};
                node = &children[1];
                continue;
            }
        } else {
            RT_COUNT(tally, leaf_steps, 1);
            if (rt_test_list(g, mailbox, ids + node->first, rt_node_fanout(node), ray, any, best, tally))
                return;
        }
        /* The next node that may contain a nearer hit, or an equal one of lower id. */
        do {
            if (top == stack) return;
            top--;
        } while (top->enter > rt_limit(ray, best));
        node = top->node;
    }
}

/* With split references a ray meets the leaf that contains the surface near the hit; if hits are not near
 * surfaces, it is tested against all objects (accel/clipping.h, accel/tree/spatial.c). */
RT_KERNEL void search(const RtBvh *self, void *scratch, const RtPreparedRay *ray, bool any, RtHit *best,
                      RtTally *tally) {
    const RtGeometry *g = &self->base.scene->geometry;
    if (!self->hierarchy.split_refs) {
        walk(self, NULL, ray, any, best, tally);
    } else if (rt_dir_is_ordinary(ray->dir[ray->kz])) {
        RtMailbox *mailbox = self->base.scratch_bytes > 0 ? scratch : NULL;
        rt_mailbox_next_ray(mailbox, g);
        walk(self, mailbox, ray, any, best, tally);
    } else {
        rt_test_all(g, ray, any, best, tally);
    }
}

RT_DEFINE_KERNELS(RtBvh, search)

/* ---- looking at it ---- */

static void describe(const RtAccel *accel, RtDescription *out) {
    rt_hierarchy_describe(&((const RtBvh *)accel)->hierarchy, &accel->scene->geometry, out);
}

static RtStatus validate(const RtAccel *accel, RtError *error) {
    return rt_hierarchy_validate(&((const RtBvh *)accel)->hierarchy, &accel->scene->geometry, "bvh", error);
}

static void each_box(const RtAccel *accel, RtBoxViewer viewer) {
    rt_hierarchy_each_box(&((const RtBvh *)accel)->hierarchy, NULL, viewer);
}

const RtAccelOps rt_bvh_ops = {
    .name = "bvh",
    .summary = "binary hierarchy of boxes, built by the surface area heuristic or along the Morton curve",
    .paper = "Wald 2007, On fast Construction of SAH-based Bounding Volume Hierarchies, RT'07",
    RT_PARAMS_OF(params),
    RT_BEST("build=binned|spatial,traversal_cost=1|0.5"),
    .bytes = sizeof(RtBvh),
    .build = build,
    .kernels = &kernels,
    .describe = describe,
    .validate = validate,
    .each_box = each_box,
    .shows_lists = true,
};
