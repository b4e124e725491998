/* From a binary tree of clusters to the nodes that are traced: which clusters become leaves, which are opened
 * into their parent. */
#include "accel/clusters/clusters.h"

#include "base/memory.h"

typedef struct Layout {
    RtClusters *self;
    const RtClusterTree *tree;
    bool *leaf; /* [tree->used] by cluster */
    uint32_t id_count;
} Layout;

RtGroup rt_cluster_group(const RtClusters *self, uint32_t index) {
    const RtClusterNode *first = &self->nodes[index], *last = first;
    while (!rt_cluster_is_leaf(first)) first = &self->nodes[first->first];
    while (!rt_cluster_is_leaf(last)) last = &self->nodes[last->first + rt_cluster_fanout(last) - 1];
    return (RtGroup){&self->base.scene->geometry, self->ids + first->first,
                     last->first + rt_cluster_fanout(last) - first->first, self->nodes[index].box};
}

/* What a subtree holds, and what it costs to trace: area times object tests and visits of inner nodes. */
typedef struct Weight {
    uint32_t objects;
    double cost;
} Weight;

/* A cluster of few enough objects becomes a leaf where that costs no more. */
static Weight weigh(Layout *layout, uint32_t index) {
    const RtClusterTree *tree = layout->tree;
    const RtCluster *cluster = &tree->clusters[index];
    double area = rt_box_half_area(cluster->box);
    layout->leaf[index] = true;
    if (rt_cluster_is_object(tree, index)) return (Weight){1, area};
    Weight left = weigh(layout, cluster->child[0]), right = weigh(layout, cluster->child[1]);
    Weight inner = {left.objects + right.objects, area + left.cost + right.cost};
    Weight leaf = {inner.objects, area * inner.objects};
    if (leaf.objects <= layout->self->leaf_limit && leaf.cost <= inner.cost) return leaf;
    layout->leaf[index] = false;
    return inner;
}

/* The children of a wide node: the largest that is no leaf is opened in its place, until there are `width`.
 */
static uint32_t open_children(const Layout *layout, uint32_t index, uint32_t *children) {
    const RtCluster *clusters = layout->tree->clusters;
    uint32_t count = 2;
    for (int s = 0; s < 2; s++) children[s] = clusters[index].child[s];
    while (count < layout->self->width) {
        uint32_t best = count;
        double most = -1;
        for (uint32_t i = 0; i < count; i++) {
            double area = rt_box_half_area(clusters[children[i]].box);
            if (layout->leaf[children[i]] || !(area > most)) continue;
            most = area;
            best = i;
        }
        if (best == count) break;
        const uint32_t *opened = clusters[children[best]].child;
        children[best] = opened[0];
        children[count++] = opened[1];
    }
    return count;
}

static void append_ids(Layout *layout, uint32_t index) {
    if (rt_cluster_is_object(layout->tree, index)) {
        layout->self->ids[layout->id_count++] = index;
        return;
    }
    for (int s = 0; s < 2; s++) append_ids(layout, layout->tree->clusters[index].child[s]);
}

static void lay_out(Layout *layout, uint32_t node_index, uint32_t cluster) {
    RtClusters *self = layout->self;
    RtClusterNode *node = &self->nodes[node_index];
    node->box = layout->tree->clusters[cluster].box;
    if (layout->leaf[cluster]) {
        node->first = layout->id_count;
        append_ids(layout, cluster);
        node->count = RT_CLUSTER_LEAF | (layout->id_count - node->first);
        return;
    }
    uint32_t children[RT_CLUSTER_MAX_WIDTH];
    node->count = open_children(layout, cluster, children);
    node->first = self->node_count;
    self->node_count += node->count;
    for (uint32_t i = 0; i < node->count; i++) lay_out(layout, node->first + i, children[i]);
}

RtStatus rt_clusters_layout(RtClusters *self, const RtClusterTree *tree, RtError *error) {
    Layout layout = {self, tree, rt_alloc(tree->used, sizeof(bool)), 0};
    if (!layout.leaf) return rt_fail_memory(error, "the leaves of clusters", tree->used * sizeof(bool));
    weigh(&layout, tree->root);
    self->node_count = 1;
    lay_out(&layout, 0, tree->root);
    rt_free(layout.leaf);
    return RT_OK;
}

/* ---- looking at it ---- */

typedef struct Survey {
    const RtClusters *self;
    RtDescription *out;
    double inner, leaves,
        tests; /* visits of nodes and tests of objects expected, times the area of the root */
} Survey;

static void survey_node(Survey *survey, uint32_t index, uint32_t depth) {
    const RtClusterNode *node = &survey->self->nodes[index];
    RtDescription *out = survey->out;
    uint32_t fanout = rt_cluster_fanout(node);
    bool leaf = rt_cluster_is_leaf(node);
    out->interior += !leaf;
    out->leaves += leaf;
    out->references += leaf ? fanout : 0;
    if (depth > out->depth) out->depth = depth;
    double area = rt_box_half_area(node->box);
    *(leaf ? &survey->leaves : &survey->inner) += area;
    survey->tests += leaf ? area * fanout : 0;
    for (uint32_t i = 0; i < fanout && !leaf; i++) survey_node(survey, node->first + i, depth + 1);
}

/* The predictions are those of boxes, whatever the kind of extent; a visit of an inner node costs as much as
 * one object test. */
void rt_clusters_describe(const RtAccel *accel, RtDescription *out) {
    const RtClusters *self = (const RtClusters *)accel;
    *out = (RtDescription){.bytes = self->node_count * sizeof(RtClusterNode) +
                                    accel->scene->geometry.object_count * sizeof(uint32_t) +
                                    rt_extent_set_bytes(&self->set),
                           RT_NO_PREDICTION};
    if (self->node_count == 0) return;
    Survey survey = {self, out, 0, 0, 0};
    survey_node(&survey, 0, 0);
    double area = rt_box_half_area(self->nodes[0].box);
    if (!(area > 0)) return;
    out->predicted_tests = survey.tests / area;
    out->predicted_steps = (survey.inner + survey.leaves) / area;
    out->predicted_cost = (survey.tests + survey.inner) / area;
}

/* ---- checking ---- */

typedef struct Check {
    const RtClusters *self;
    RtError *error;
    uint32_t *seen;   /* [objects] how often each is in a leaf */
    uint32_t reached; /* nodes */
    uint32_t ended;   /* where the ids of the leaves so far end */
} Check;

static RtStatus check_leaf(Check *check, uint32_t index) {
    const RtClusters *self = check->self;
    const RtClusterNode *node = &self->nodes[index];
    const RtGeometry *geometry = &self->base.scene->geometry;
    for (uint32_t i = node->first; i < node->first + rt_cluster_fanout(node); i++) {
        if (i >= geometry->object_count || self->ids[i] >= geometry->object_count)
            return rt_fail(check->error, RT_MISMATCH, "clusters: leaf %u holds no object", index);
        check->seen[self->ids[i]]++;
        if (rt_box_contains(node->box, geometry->boxes[self->ids[i]])) continue;
        return rt_fail(check->error, RT_MISMATCH, "clusters: leaf %u does not contain its object %u", index,
                       self->ids[i]);
    }
    if (node->first != check->ended)
        return rt_fail(check->error, RT_MISMATCH, "clusters: the ids of leaf %u begin at %u, not at %u",
                       index, node->first, check->ended);
    check->ended += rt_cluster_fanout(node);
    return RT_OK;
}

static RtStatus check_node(Check *check, uint32_t index, uint32_t depth) {
    const RtClusters *self = check->self;
    const RtClusterNode *node = &self->nodes[index];
    uint32_t fanout = rt_cluster_fanout(node), first = node->first;
    bool leaf = rt_cluster_is_leaf(node);
    if (depth > RT_CLUSTER_MAX_DEPTH)
        return rt_fail(check->error, RT_MISMATCH, "clusters: node %u is too deep", index);
    if (++check->reached > self->node_count)
        return rt_fail(check->error, RT_MISMATCH, "clusters: node %u has two parents", index);
    uint32_t least = leaf ? 1 : 2, most = leaf ? self->leaf_limit : self->width;
    if (fanout < least || fanout > most)
        return rt_fail(check->error, RT_MISMATCH, "clusters: node %u has %u %s, not %u to %u", index, fanout,
                       leaf ? "objects" : "children", least, most);
    if (leaf) return check_leaf(check, index);
    if (first <= index || (uint64_t)first + fanout > self->node_count)
        return rt_fail(check->error, RT_MISMATCH, "clusters: node %u has children that are not there", index);
    for (uint32_t child = first; child < first + fanout; child++) {
        RT_TRY(check_node(check, child, depth + 1));
        if (rt_box_contains(node->box, self->nodes[child].box)) continue;
        return rt_fail(check->error, RT_MISMATCH, "clusters: node %u does not contain its child %u", index,
                       child);
    }
    return RT_OK;
}

static RtStatus check_all(Check *check) {
    const RtClusters *self = check->self;
    uint32_t count = self->base.scene->geometry.object_count;
    RT_TRY(check_node(check, 0, 0));
    for (uint32_t id = 0; id < count; id++) {
        if (check->seen[id] == 1) continue;
        return rt_fail(check->error, RT_MISMATCH, "clusters: object %u is in %u leaves, not in one", id,
                       check->seen[id]);
    }
    if (check->reached < self->node_count)
        return rt_fail(check->error, RT_MISMATCH, "clusters: %u of %u nodes are in the tree", check->reached,
                       self->node_count);
    for (uint32_t index = 0; index < self->node_count; index++) {
        RtGroup group = rt_cluster_group(self, index);
        RT_TRY(rt_extent_check(&self->set, index, &group, "clusters", check->error));
    }
    return RT_OK;
}

RtStatus rt_clusters_validate(const RtAccel *accel, RtError *error) {
    const RtClusters *self = (const RtClusters *)accel;
    uint32_t count = accel->scene->geometry.object_count;
    if (count == 0) return RT_OK;
    Check check = {self, error, rt_alloc(count, sizeof(uint32_t)), 0, 0};
    if (!check.seen) return rt_fail_memory(error, "validating clusters", count * sizeof(uint32_t));
    RtStatus status = check_all(&check);
    rt_free(check.seen);
    return status;
}
