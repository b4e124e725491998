/* SPDX-License-Identifier: Apache-2.0 */
/* bvh_copy: the built-in `bvh` as a plugin. `bench --accel bvh_copy --baseline bvh` shows the cost of the
 * plugin interface (docs/guide/own-accelerator.md).
 *
 * The tree is that of accel/bvh with its default parameters: built from the top by the surface area
 * heuristic, in 16 bins along every axis, or at every place between centres if there are no more objects than
 * bins; then, from the bottom up, subtrees of up to 8 objects become leaves if that costs no more. Layout and
 * traversal are those of accel/bvh: nodes of 32 bytes, siblings side by side, both children's boxes tested,
 * the nearer child first.
 *
 * Compiled with REPEATED=33 it is `bvh_late`, which traces every 33rd ray twice while it is timed: 3 %
 * slower, which tests/differences.sh is to find. */
#define _DEFAULT_SOURCE /* madvise */
#include <raytally/accel.h>

#include <math.h>
#include <stdlib.h>
#include <sys/mman.h>

enum { BINS = 16, MAX_LEAF = 8, MEDIAN_DEPTH = 34, MAX_DEPTH = 64 };

#define LEAF UINT32_C(0x80000000)

typedef struct Node {
    raytally_box box;
    uint32_t first; /* inner: the first child; leaf: the first of its ids */
    uint32_t count; /* inner: 2; leaf: LEAF | objects */
} Node;

typedef struct Bvh {
    Node *nodes; /* [node_count] */
    uint32_t *ids;
    uint32_t node_count, id_count;
} Bvh;

/* ---- the tree ---- */

typedef struct Ref {
    raytally_box box;
    uint32_t id;
} Ref;

/* A subtree of n references is a run of 2 n - 1 nodes: its root, the left subtree, the right one. */
typedef struct TreeNode {
    raytally_box box;
    uint32_t left; /* references of the left child; 0: a reference */
    uint32_t id;   /* of a reference */
    int leaf;      /* its references share a leaf */
} TreeNode;

typedef struct Bin {
    raytally_box box;
    uint32_t count;
} Bin;

typedef struct Split {
    double cost;
    int axis;
    float at; /* centres below are left */
} Split;

static const raytally_box empty = {{INFINITY, INFINITY, INFINITY}, {-INFINITY, -INFINITY, -INFINITY}};

static void grow(raytally_box *box, const raytally_box *by) {
    for (int a = 0; a < 3; a++) {
        box->lo[a] = by->lo[a] < box->lo[a] ? by->lo[a] : box->lo[a];
        box->hi[a] = by->hi[a] > box->hi[a] ? by->hi[a] : box->hi[a];
    }
}

static float center(const raytally_box *box, int axis) {
    return 0.5F * box->lo[axis] + 0.5F * box->hi[axis];
}

static double half_area(const raytally_box *box) {
    const double x = (double)box->hi[0] - (double)box->lo[0], y = (double)box->hi[1] - (double)box->lo[1],
                 z = (double)box->hi[2] - (double)box->lo[2];
    return x * y + y * z + z * x;
}

/* Tries the places between bins; the left of bin i ends below `edges[i]`. */
static void try_bins(const Bin *bins, uint32_t size, const float *edges, int axis, uint32_t count,
                     Split *best) {
    double right[BINS];
    raytally_box box = empty;
    uint32_t left = 0;
    for (uint32_t i = size; i-- > 1;) {
        grow(&box, &bins[i].box);
        right[i] = half_area(&box);
    }
    box = empty;
    for (uint32_t i = 1; i < size; i++) {
        grow(&box, &bins[i - 1].box);
        left += bins[i - 1].count;
        if (left == 0 || left == count) continue;
        const double cost = half_area(&box) * left + right[i] * (count - left);
        if (cost < best->cost) *best = (Split){cost, axis, edges[i]};
    }
}

static void try_axis(const Ref *refs, uint32_t count, const raytally_box *centers, int axis, Split *best) {
    Bin bins[BINS];
    float edges[BINS];
    const float lo = centers->lo[axis], hi = centers->hi[axis];
    if (!(lo < hi)) return;
    for (uint32_t i = 0; i < BINS; i++) {
        bins[i] = (Bin){empty, 0};
        edges[i] = lo + (hi - lo) * (float)i / (float)BINS;
    }
    for (uint32_t i = 0; i < count; i++) {
        const float at = center(&refs[i].box, axis);
        uint32_t bin = (uint32_t)((at - lo) / (hi - lo) * (float)BINS);
        bin = bin < BINS ? bin : BINS - 1;
        while (bin > 0 && at < edges[bin]) bin--;
        while (bin < BINS - 1 && at >= edges[bin + 1]) bin++;
        grow(&bins[bin].box, &refs[i].box);
        bins[bin].count++;
    }
    try_bins(bins, BINS, edges, axis, count, best);
}

/* The same with a bin for each centre. */
static void try_centers(const Ref *refs, uint32_t count, int axis, Split *best) {
    Bin bins[BINS];
    float edges[BINS];
    uint32_t size = 0;
    for (uint32_t i = 0; i < count; i++) {
        const float at = center(&refs[i].box, axis);
        uint32_t place = size;
        while (place > 0 && edges[place - 1] >= at) place--;
        if (place == size || edges[place] != at) {
            for (uint32_t j = size++; j > place; j--) {
                bins[j] = bins[j - 1];
                edges[j] = edges[j - 1];
            }
            bins[place] = (Bin){empty, 0};
            edges[place] = at;
        }
        grow(&bins[place].box, &refs[i].box);
        bins[place].count++;
    }
    try_bins(bins, size, edges, axis, count, best);
}

static uint32_t part(Ref *refs, uint32_t count, const Split *split) {
    uint32_t left = 0, right = count;
    while (left < right) {
        const Ref ref = refs[left];
        if (center(&ref.box, split->axis) < split->at) {
            left++;
        } else {
            refs[left] = refs[--right];
            refs[right] = ref;
        }
    }
    return left;
}

/* What a subtree costs to trace. */
typedef struct Weight {
    uint32_t refs, nodes;
    double cost;
} Weight;

static Weight divide(TreeNode *nodes, Ref *refs, uint32_t count, uint32_t depth) {
    TreeNode *root = nodes;
    raytally_box centers = empty;
    Split best = {INFINITY, 0, 0};
    root->box = empty;
    for (uint32_t i = 0; i < count; i++) {
        raytally_box middle;
        for (int a = 0; a < 3; a++) middle.lo[a] = middle.hi[a] = center(&refs[i].box, a);
        grow(&root->box, &refs[i].box);
        grow(&centers, &middle);
    }
    const double area = half_area(&root->box);
    root->id = refs[0].id;
    root->left = 0;
    root->leaf = 1;
    if (count == 1) return (Weight){1, 1, area};
    for (int a = 0; a < 3 && depth < MEDIAN_DEPTH; a++) {
        if (count <= BINS)
            try_centers(refs, count, a, &best);
        else
            try_axis(refs, count, &centers, a, &best);
    }
    root->left = best.cost < INFINITY ? part(refs, count, &best) : count / 2;
    const Weight l = divide(nodes + 1, refs, root->left, depth + 1);
    const Weight r = divide(nodes + 2 * root->left, refs + root->left, count - root->left, depth + 1);
    const Weight inner = {count, 1 + l.nodes + r.nodes, area + l.cost + r.cost};
    const Weight leaf = {count, 1, area * count};
    root->leaf = count <= MAX_LEAF && leaf.cost <= inner.cost;
    return root->leaf ? leaf : inner;
}

/* ---- the layout ---- */

typedef struct Taken {
    uint32_t nodes, ids;
} Taken;

static void append_ids(Bvh *bvh, const TreeNode *tree, Taken *taken) {
    if (tree->left == 0) {
        bvh->ids[taken->ids++] = tree->id;
        return;
    }
    append_ids(bvh, tree + 1, taken);
    append_ids(bvh, tree + 2 * tree->left, taken);
}

static void place(Bvh *bvh, uint32_t index, const TreeNode *tree, Taken *taken) {
    Node *node = &bvh->nodes[index];
    node->box = tree->box;
    if (tree->leaf) {
        node->first = taken->ids;
        append_ids(bvh, tree, taken);
        node->count = LEAF | (taken->ids - node->first);
        return;
    }
    const uint32_t first = taken->nodes;
    node->first = first;
    node->count = 2;
    taken->nodes += 2;
    place(bvh, first, tree + 1, taken);
    place(bvh, first + 1, tree + 2 * tree->left, taken);
}

static void destroy(void *self) {
    Bvh *bvh = (Bvh *)self;
    free(bvh->nodes);
    free(bvh->ids);
    free(bvh);
}

/* As raytally allocates: a large array lies in huge pages if the system has them, so rays miss fewer pages.
 */
static void *allocate(size_t bytes) {
    const size_t huge = (size_t)1 << 21, boundary = bytes >= 2 * huge ? huge : 64;
    const size_t padded = (bytes + boundary - 1) / boundary * boundary;
    void *block = aligned_alloc(boundary, padded);
    if (block && boundary == huge) madvise(block, padded, MADV_HUGEPAGE);
    return block;
}

static int fill(Bvh *bvh, const raytally_build_input *what, Ref *refs, TreeNode *tree) {
    const uint32_t count = what->object_count;
    if (!refs || !tree) return RAYTALLY_BUILD_NO_MEMORY;
    for (uint32_t i = 0; i < count; i++) refs[i] = (Ref){what->boxes[i], i};
    const Weight whole = divide(tree, refs, count, 0);
    bvh->nodes = (Node *)allocate(whole.nodes * sizeof(Node));
    bvh->ids = (uint32_t *)allocate(count * sizeof(uint32_t));
    if (!bvh->nodes || !bvh->ids) return RAYTALLY_BUILD_NO_MEMORY;
    Taken taken = {1, 0};
    place(bvh, 0, tree, &taken);
    bvh->node_count = taken.nodes;
    bvh->id_count = taken.ids;
    return RAYTALLY_BUILD_OK;
}

static int build(const raytally_build_input *what, void **self) {
    const size_t count = what->object_count, nodes = 2 * count;
    if (nodes * sizeof(Node) + count * sizeof(uint32_t) > what->byte_limit) return RAYTALLY_BUILD_NO_MEMORY;
    Bvh *bvh = (Bvh *)calloc(1, sizeof(Bvh));
    if (!bvh) return RAYTALLY_BUILD_NO_MEMORY;
    Ref *refs = (Ref *)malloc(count * sizeof(Ref));
    TreeNode *tree = (TreeNode *)malloc(nodes * sizeof(TreeNode));
    const int built = count == 0 ? RAYTALLY_BUILD_OK : fill(bvh, what, refs, tree);
    free(refs);
    free(tree);
    if (built == RAYTALLY_BUILD_OK)
        *self = bvh;
    else
        destroy(bvh);
    return built;
}

/* ---- queries ---- */

typedef struct Waiting {
    const Node *node;
    float enter;
} Waiting;

RAYTALLY_INLINE void search(const Bvh *bvh, void *memory, const raytally_prepared *ray, int any,
                            raytally_hit *best, raytally_counters *counters) {
    const Node *nodes = bvh->nodes, *node = nodes;
    Waiting stack[MAX_DEPTH], *top = stack;
    float enter[2];
    (void)memory;
    if (bvh->node_count == 0) return;
    RAYTALLY_COUNT(counters, RAYTALLY_EXTENT_TESTS, 1);
    raytally_show(ray, RAYTALLY_EXTENT_TESTS, 0, &nodes[0].box, counters);
    if (!raytally_box_hit(&nodes[0].box, ray, ray->tmax, &enter[0])) return;
    for (;;) {
        RAYTALLY_COUNT(counters, RAYTALLY_STEPS, 1);
        RAYTALLY_COUNT(counters, RAYTALLY_LEAF_STEPS, (node->count & LEAF) != 0);
        raytally_show(ray, RAYTALLY_STEPS, (uint32_t)(node - nodes), &node->box, counters);
        if (!(node->count & LEAF)) {
            const Node *children = nodes + node->first;
            const float limit = raytally_tmax(ray, best);
            const int left = raytally_box_hit(&children[0].box, ray, limit, &enter[0]);
            const int right = raytally_box_hit(&children[1].box, ray, limit, &enter[1]);
            RAYTALLY_COUNT(counters, RAYTALLY_EXTENT_TESTS, 2);
            for (uint32_t i = 0; i < 2; i++)
                raytally_show(ray, RAYTALLY_EXTENT_TESTS, node->first + i, &children[i].box, counters);
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
            if (raytally_object_hits(ray, bvh->ids + node->first, node->count & ~LEAF, any, best, counters))
                return;
        }
        do {
            if (top == stack) return;
            top--;
        } while (top->enter > raytally_tmax(ray, best));
        node = top->node;
    }
}

RAYTALLY_DEFINE_KERNELS(Bvh, search)

/* Of the subtree of a node. */
static uint64_t depth_of(const Bvh *bvh, uint32_t index) {
    const Node *node = &bvh->nodes[index];
    if (node->count & LEAF) return 0;
    const uint64_t left = depth_of(bvh, node->first), right = depth_of(bvh, node->first + 1);
    return 1 + (left > right ? left : right);
}

static void describe(const void *self, raytally_description *out) {
    const Bvh *bvh = (const Bvh *)self;
    if (bvh->node_count == 0) return;
    out->interior = bvh->node_count / 2;
    out->leaves = bvh->node_count - out->interior;
    out->references = bvh->id_count;
    out->depth = depth_of(bvh, 0);
    out->bytes = bvh->node_count * sizeof(Node) + bvh->id_count * sizeof(uint32_t);
}

static void show_below(const Bvh *bvh, uint32_t index, uint32_t depth, raytally_box_visitor *show,
                       void *viewer) {
    const Node *node = &bvh->nodes[index];
    show(viewer, &node->box, depth, (node->count & LEAF) != 0);
    if (node->count & LEAF) return;
    show_below(bvh, node->first, depth + 1, show, viewer);
    show_below(bvh, node->first + 1, depth + 1, show, viewer);
}

static void each_box(const void *self, raytally_box_visitor *show, void *viewer) {
    const Bvh *bvh = (const Bvh *)self;
    if (bvh->node_count > 0) show_below(bvh, 0, 0, show, viewer);
}

#ifdef REPEATED
/* The rays of a query so far. */
static size_t query_bytes(const void *self) {
    (void)self;
    return sizeof(size_t);
}

static void late_nearest(const void *self, void *memory, raytally_query *query, const raytally_ray *rays,
                         size_t count, raytally_hit *hits, raytally_counters *counters) {
    size_t *seen = (size_t *)memory;
    search_nearest(self, memory, query, rays, count, hits, counters);
    for (size_t i = REPEATED - 1 - *seen % REPEATED; !counters && i < count; i += REPEATED)
        search_nearest(self, memory, query, rays + i, 1, hits + i, NULL);
    *seen += count;
}

static void late_occluded(const void *self, void *memory, raytally_query *query, const raytally_ray *rays,
                          size_t count, uint32_t *occluders, raytally_counters *counters) {
    size_t *seen = (size_t *)memory;
    search_occluded(self, memory, query, rays, count, occluders, counters);
    for (size_t i = REPEATED - 1 - *seen % REPEATED; !counters && i < count; i += REPEATED)
        search_occluded(self, memory, query, rays + i, 1, occluders + i, NULL);
    *seen += count;
}
#endif

static const raytally_accel_ops bvh_copy_ops = {
    .abi = RAYTALLY_ACCEL_ABI,
    .size = sizeof(raytally_accel_ops),
#ifdef REPEATED
    .name = "bvh_late",
    .query_bytes = query_bytes,
    .nearest = late_nearest,
    .occluded = late_occluded,
#else
    .name = "bvh_copy",
    .nearest = search_nearest,
    .occluded = search_occluded,
#endif
    .summary = "the built-in bvh once more, to see what a plugin costs",
    .paper = "Wald 2007, On fast Construction of SAH-based Bounding Volume Hierarchies, RT'07",
    .build = build,
    .destroy = destroy,
    .describe = describe,
    .each_box = each_box,
};

RAYTALLY_PLUGIN {
    return index == 0 ? &bvh_copy_ops : NULL;
}
