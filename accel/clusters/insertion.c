/* Clusters by insertion (Goldsmith & Salmon 1987): objects come one by one, and each is united with whatever
 * cluster makes the sum of all areas grow least. The best place is found by branch and bound: all that lies
 * below a cluster costs at least what its ancestors grow by, and the area of the object itself.
 *
 * The result depends on the order of insertion, so several permutations can be tried and the cheapest tree
 * kept. The search goes no deeper than the depth that trees may have in the end, which bounds the cost of an
 * insertion where objects come in an unlucky order. */
#include "accel/clusters/tree.h"

#include "base/memory.h"
#include "base/random.h"

typedef struct Insertion {
    RtClusterTree *tree;
    uint32_t *parent; /* [2 * count - 1] */
    uint32_t *order;  /* [count] permutation of the objects */
} Insertion;

typedef struct Place {
    uint32_t cluster, depth;
    double inherited; /* by how much the areas of its ancestors grow */
} Place;

static double area_with(const RtClusterTree *tree, uint32_t cluster, const RtBox *box) {
    return rt_box_half_area(rt_box_union(tree->clusters[cluster].box, *box));
}

/* The cluster beside which an object with box `box` costs least. */
static uint32_t find_sibling(const RtClusterTree *tree, const RtBox *box) {
    Place stack[RT_CLUSTER_MAX_DEPTH + 2];
    uint32_t stacked = 0, sibling = tree->root;
    double own = rt_box_half_area(*box), best = INFINITY;
    stack[stacked++] = (Place){tree->root, 0, 0};
    while (stacked > 0) {
        Place place = stack[--stacked];
        if (!(place.inherited + own < best)) continue;
        const RtCluster *cluster = &tree->clusters[place.cluster];
        double area = area_with(tree, place.cluster, box);
        if (place.inherited + area < best) {
            best = place.inherited + area;
            sibling = place.cluster;
        }
        if (rt_cluster_is_object(tree, place.cluster) || place.depth == RT_CLUSTER_MAX_DEPTH) continue;
        double inherited = place.inherited + area - rt_box_half_area(cluster->box);
        bool second = area_with(tree, cluster->child[1], box) < area_with(tree, cluster->child[0], box);
        stack[stacked++] = (Place){cluster->child[!second], place.depth + 1, inherited};
        stack[stacked++] = (Place){cluster->child[second], place.depth + 1, inherited};
    }
    return sibling;
}

static void insert(Insertion *insertion, uint32_t object) {
    RtClusterTree *tree = insertion->tree;
    uint32_t *parent = insertion->parent, root = tree->root;
    const RtBox *box = &tree->clusters[object].box;
    uint32_t sibling = find_sibling(tree, box), above = parent[sibling];
    uint32_t united = rt_cluster_unite(tree, sibling, object);
    parent[united] = above;
    parent[sibling] = parent[object] = united;
    if (sibling == root) return;
    tree->root = root;
    uint32_t *child = tree->clusters[above].child;
    child[child[1] == sibling] = united;
    for (uint32_t at = above;; at = parent[at]) {
        tree->clusters[at].box = rt_box_union(tree->clusters[at].box, *box);
        if (at == root) return;
    }
}

static void shuffle(uint32_t *order, uint32_t count, uint64_t seed, uint32_t stream) {
    RtRandom random = rt_random(seed, stream);
    for (uint32_t i = count; i > 1; i--) {
        uint32_t j = (uint32_t)((uint64_t)rt_random_bits(&random) * i >> 32), kept = order[i - 1];
        order[i - 1] = order[j];
        order[j] = kept;
    }
}

static void build_once(Insertion *insertion, const RtInsertionOrder *order, uint32_t attempt) {
    RtClusterTree *tree = insertion->tree;
    for (uint32_t i = 0; i < tree->count; i++) insertion->order[i] = i;
    if (order->random || attempt > 0) shuffle(insertion->order, tree->count, order->seed, attempt);
    tree->used = tree->count;
    tree->root = insertion->order[0];
    for (uint32_t i = 1; i < tree->count; i++) insert(insertion, insertion->order[i]);
}

/* Tries all orders in `tree` and in `spare`, the better of which is kept aside. */
static void build_all(RtClusterTree *tree, RtClusterTree *spare, Insertion *insertion,
                      const RtInsertionOrder *order) {
    insertion->tree = tree;
    build_once(insertion, order, 0);
    double best = rt_cluster_tree_cost(tree);
    for (uint32_t attempt = 1; attempt < order->tries; attempt++) {
        insertion->tree = spare;
        build_once(insertion, order, attempt);
        double cost = rt_cluster_tree_cost(spare);
        if (!(cost < best)) continue;
        RtClusterTree kept = *tree;
        *tree = *spare;
        *spare = kept;
        best = cost;
    }
}

RtStatus rt_cluster_insertion(RtClusterTree *tree, const RtInsertionOrder *order, RtError *error) {
    size_t most = 2 * (size_t)tree->count - 1;
    RtClusterTree spare = {.count = tree->count, .used = tree->count};
    Insertion insertion = {NULL, rt_alloc(most, sizeof(uint32_t)), rt_alloc(tree->count, sizeof(uint32_t))};
    bool several = order->tries > 1;
    if (several) spare.clusters = rt_alloc(most, sizeof(RtCluster));
    RtStatus status = RT_OK;
    if (insertion.parent && insertion.order && (spare.clusters || !several)) {
        for (uint32_t i = 0; several && i < tree->count; i++) spare.clusters[i] = tree->clusters[i];
        build_all(tree, &spare, &insertion, order);
    } else {
        status = rt_fail_memory(error, "clusters by insertion", most * (sizeof(RtCluster) + 8));
    }
    rt_free(insertion.parent);
    rt_free(insertion.order);
    rt_cluster_tree_clear(&spare);
    return status;
}
