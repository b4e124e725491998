/* SPDX-License-Identifier: Apache-2.0 */
/* Building an octree level by level: the list of a leaf is appended to the array of all lists, that of an
 * inner node is distributed to its eight children, the next level. Memory is counted before it is allocated.
 *
 * Split planes: Glassner 1984 (the centre); Whang et al. 1995, Octree-R (by cost, along each axis on its
 * own).
 *
 * The memory limit: the size of the tree at each depth below a level is estimated by random probes (Knuth
 * 1975, Estimating the efficiency of backtrack programs, Mathematics of Computation 29). A probe walks from a
 * cell of the level down to one child at a time, picked from those that would be divided too, and stands for
 * as many cells as there were to pick from. Its sums are unbiased; their variance is their precision. */
#include "accel/octree/octree.h"

#include "accel/kernel.h"
#include "core/base/memory.h"
#include "core/base/random.h"

#include <string.h>

const RtParam rt_octree_params[RT_OCTREE_PARAM_COUNT] = {RT_OCTREE_PARAMS(RT_PARAM_ENTRY)};

/* A tree under construction. Until it is divided or made a leaf, the list of a node is at `first` of the
 * current level's lists, that of its children at `first` of the next level's. */
typedef struct Builder {
    RtOctree *tree;
    const RtBox *objects; /* their boxes */
    uint64_t limit;       /* bytes */
    uint32_t depth;       /* of the current level */
    uint32_t node_capacity, box_capacity, id_capacity;
    uint32_t *list, *next; /* the lists of the current level and of the next, node after node */
    uint32_t next_count, next_capacity;
} Builder;

/* Of `split=cost`, from the centre of a cell to that of its objects; planes are tried at both ends, too. */
enum { STEPS = 10 };

/* ---- split planes ---- */

/* A plane strictly inside, or the upper one: see octree.h. */
static float inside(double at, float lo, float hi) {
    float split = (float)at;
    return split > lo && split < hi ? split : hi;
}

static float centre(float lo, float hi) {
    return inside(0.5 * (double)lo + 0.5 * (double)hi, lo, hi);
}

/* The mean along an axis of the centres of the objects' boxes, clipped to the cell. */
static double mean_center(const Builder *b, const RtBox *cell, int axis, const uint32_t *ids,
                          uint32_t count) {
    double sum = 0, lo = (double)cell->lo.at[axis], hi = (double)cell->hi.at[axis];
    for (uint32_t i = 0; i < count; i++) {
        RtBox object = rt_octree_grown(b->tree, b->objects[ids[i]]);
        sum += fmax((double)object.lo.at[axis], lo) + fmin((double)object.hi.at[axis], hi);
    }
    return sum / (2.0 * count);
}

/* Octree-R: the plane of the least cost (MacDonald & Booth 1990) among those in ten equal steps from the
 * centre of the cell to that of its objects. */
static float cheapest(const Builder *b, const RtBox *cell, int axis, const uint32_t *ids, uint32_t count) {
    float lo = cell->lo.at[axis], hi = cell->hi.at[axis], best = centre(lo, hi);
    RtVec3d size = rt_subd(rt_widen(cell->hi), rt_widen(cell->lo));
    double across = size.at[(axis + 1) % 3] + size.at[(axis + 2) % 3];
    double face = size.at[(axis + 1) % 3] * size.at[(axis + 2) % 3];
    double from = (double)best, to = mean_center(b, cell, axis, ids, count), least = INFINITY;
    for (int k = 0; k <= STEPS; k++) {
        float split = inside(from + (to - from) * k / STEPS, lo, hi);
        if (split == hi) continue;
        uint32_t below = 0, above = 0; /* objects that are cut are in both, those that touch are not */
        for (uint32_t i = 0; i < count; i++) {
            RtBox object = rt_octree_grown(b->tree, b->objects[ids[i]]);
            below += object.lo.at[axis] < split;
            above += object.hi.at[axis] > split;
        }
        double left = (double)split - (double)lo, right = (double)hi - (double)split;
        double cost = below * (2 * left * across + face) + above * (2 * right * across + face);
        if (!(cost < least)) continue;
        least = cost;
        best = split;
    }
    return best;
}

static RtVec3 choose_split(const Builder *b, const RtBox *cell, const uint32_t *ids, uint32_t count) {
    RtVec3 split;
    for (int a = 0; a < 3; a++)
        split.at[a] = b->tree->split == RT_OCTREE_COST ? cheapest(b, cell, a, ids, count)
                                                       : centre(cell->lo.at[a], cell->hi.at[a]);
    return split;
}

bool rt_octree_divisible(const RtOctree *tree, const RtBox *boxes, const RtBox *cell, const uint32_t *ids,
                         uint32_t count) {
    bool has_plane = false;
    for (int a = 0; a < 3; a++) has_plane |= centre(cell->lo.at[a], cell->hi.at[a]) < cell->hi.at[a];
    if (tree->cut_filled) return has_plane;
    for (uint32_t i = 0; has_plane && i < count; i++) {
        if (!rt_box_contains(rt_octree_grown(tree, boxes[ids[i]]), *cell)) return true;
    }
    return false;
}

/* Whether node `index` of the current level is to be divided. */
static bool divides(const Builder *b, uint32_t index) {
    const RtOctree *tree = b->tree;
    const RtOctreeNode *node = &tree->nodes[index];
    return node->count > tree->max_leaf_size && b->depth < tree->max_depth &&
           rt_octree_divisible(tree, b->objects, &tree->boxes[index], b->list + node->first, node->count);
}

/* ---- dividing ---- */

/* Refuses the tree, which would take at least `bytes`; it would fit with max_depth = `fits`. */
static RtStatus refuse(const Builder *b, double bytes, uint32_t fits, RtError *error) {
    return rt_fail(error, RT_BAD_INPUT,
                   "an octree of max_depth=%u, max_leaf_size=%u would take about %.3g GiB or more, more than "
                   "%.3g GiB: max_depth=%u would fit",
                   b->tree->max_depth, b->tree->max_leaf_size, bytes / 0x1p30, (double)b->limit / 0x1p30,
                   fits);
}

/* Reserves `nodes` more nodes, `ids` more list entries of leaves and `next` more of the next level. */
static RtStatus make_room(Builder *b, uint64_t nodes, uint64_t ids, uint64_t next, RtError *error) {
    RtOctree *tree = b->tree;
    nodes += tree->node_count;
    ids += tree->id_count;
    next += b->next_count;
    uint64_t bytes = nodes * RT_OCTREE_NODE_BYTES + (ids + next) * sizeof(uint32_t);
    if (bytes > b->limit) return refuse(b, (double)bytes, b->depth, error);
    RT_TRY(rt_reserve(&tree->nodes, &b->node_capacity, nodes, sizeof(RtOctreeNode), error));
    RT_TRY(rt_reserve(&tree->boxes, &b->box_capacity, nodes, sizeof(RtBox), error));
    RT_TRY(rt_reserve(&tree->ids, &b->id_capacity, ids, sizeof(uint32_t), error));
    return rt_reserve(&b->next, &b->next_capacity, next, sizeof(uint32_t), error);
}

/* Starts a tree with a single node, `cell`, whose objects are b->list[0..count). */
static RtStatus begin(Builder *b, RtBox cell, uint32_t count, RtError *error) {
    RT_TRY(make_room(b, 1, 0, 0, error));
    b->tree->nodes[0] = (RtOctreeNode){.first = 0, .count = count};
    b->tree->boxes[0] = cell;
    b->tree->node_count = 1;
    return RT_OK;
}

static void next_level(Builder *b) {
    rt_free(b->list);
    b->list = b->next;
    b->next = NULL;
    b->next_count = b->next_capacity = 0;
    b->depth++;
}

static RtStatus make_leaf(Builder *b, uint32_t index, RtError *error) {
    RtOctree *tree = b->tree;
    const RtOctreeNode node = tree->nodes[index];
    RT_TRY(make_room(b, 0, node.count, 0, error));
    tree->nodes[index].first = tree->id_count;
    for (uint32_t i = 0; i < node.count; i++) tree->ids[tree->id_count++] = b->list[node.first + i];
    return RT_OK;
}

/* Divides node `index` of the current level: a count pass and a fill pass distribute its objects to eight new
 * children. */
static RtStatus divide(Builder *b, uint32_t index, RtError *error) {
    RtOctree *tree = b->tree;
    const uint32_t count = tree->nodes[index].count, *ids = b->list + tree->nodes[index].first;
    RtBox cell = tree->boxes[index];
    RtVec3 split = choose_split(b, &cell, ids, count);
    uint32_t length[8] = {0}, end[8];
    uint64_t total = 0;
    for (uint32_t i = 0; i < count; i++) {
        RtBox object = rt_octree_grown(tree, b->objects[ids[i]]);
        uint32_t children = rt_octree_sides(&cell, split, &object);
        for (uint32_t c = 0; c < 8; c++) length[c] += children >> c & 1;
    }
    uint32_t empty = 0; /* leaves */
    for (uint32_t c = 0; c < 8; c++) {
        total += length[c];
        empty |= (uint32_t)(length[c] == 0) << c;
    }
    RT_TRY(make_room(b, 8, 0, total, error));
    RtOctreeNode *node = &tree->nodes[index];
    node->split = split;
    node->first = tree->node_count;
    node->count = RT_OCTREE_INNER | empty;
    for (uint32_t c = 0; c < 8; c++) {
        tree->boxes[tree->node_count] = rt_octree_child_box(cell, split, c);
        tree->nodes[tree->node_count++] =
            (RtOctreeNode){.first = b->next_count, .count = length[c], .parent = index};
        end[c] = b->next_count;
        b->next_count += length[c];
    }
    for (uint32_t i = 0; i < count; i++) {
        RtBox object = rt_octree_grown(tree, b->objects[ids[i]]);
        uint32_t children = rt_octree_sides(&cell, split, &object);
        for (uint32_t c = 0; c < 8; c++) {
            if (children >> c & 1) b->next[end[c]++] = ids[i];
        }
    }
    return RT_OK;
}

/* ---- the memory limit ---- */

/* Probes per level; standard errors by which an estimate must exceed the limit. */
enum { PROBES = 256, CERTAIN = 4 };

/* Smaller parts of the limit need no estimate, so most trees need none. */
#define CHEAP (1.0 / 1024)

/* Sums over the probes of the bytes that the depths down to d add. */
typedef struct Estimate {
    double sum[RT_OCTREE_DEPTH_LIMIT + 1], squares[RT_OCTREE_DEPTH_LIMIT + 1];
} Estimate;

static void add_sample(Estimate *estimate, uint32_t from, uint32_t to, double bytes) {
    for (uint32_t depth = from; depth <= to; depth++) {
        estimate->sum[depth] += bytes;
        estimate->squares[depth] += bytes * bytes;
    }
}

static bool is_long(const Builder *b, uint32_t index) {
    return b->tree->nodes[index].count > b->tree->max_leaf_size;
}

/* Walks down from the root of the probe's tree, which stands for `weight` nodes, to one of the children that
 * would be divided at a time. */
static RtStatus walk_probe(Builder *probe, double weight, RtRandom *random, Estimate *estimate,
                           RtError *error) {
    const RtOctree *tree = probe->tree;
    double bytes = 0;
    uint32_t index = 0, open[8], n;
    do {
        uint32_t count = tree->nodes[index].count, children = tree->node_count;
        RT_TRY(divide(probe, index, error));
        bytes += weight * (8.0 * RT_OCTREE_NODE_BYTES +
                           ((double)probe->next_count - count) * (double)sizeof(uint32_t));
        next_level(probe);
        add_sample(estimate, probe->depth, probe->depth, bytes);
        n = 0;
        for (uint32_t child = children; child < children + 8; child++) {
            if (divides(probe, child)) open[n++] = child;
        }
        weight *= n;
        if (n > 0) index = open[(uint64_t)rt_random_bits(random) * n >> 32];
    } while (n > 0);
    add_sample(estimate, probe->depth + 1, tree->max_depth, bytes);
    return RT_OK;
}

static RtStatus start_probe(Builder *probe, const Builder *b, uint32_t index, RtError *error) {
    const RtOctreeNode node = b->tree->nodes[index];
    probe->depth = b->depth;
    probe->tree->node_count = 0;
    rt_free(probe->list);
    probe->list = rt_alloc(node.count, sizeof(uint32_t));
    if (!probe->list) return rt_fail_memory(error, "a probe", node.count * sizeof(uint32_t));
    memcpy(probe->list, b->list + node.first, node.count * sizeof(uint32_t));
    return begin(probe, b->tree->boxes[index], node.count, error);
}

/* Stratified sampling of the `candidates` nodes with long lists: a probe starts in each of PROBES equal
 * strata. */
static RtStatus probe_level(const Builder *b, Builder *probe, uint32_t from, uint32_t candidates,
                            Estimate *estimate, RtError *error) {
    RtRandom random = rt_random(PROBES, b->depth);
    uint32_t index = from, seen = 0;
    for (uint32_t p = 0; p < PROBES; p++) {
        double at = (p + (double)rt_random_unit(&random)) * candidates / PROBES;
        for (; !is_long(b, index) || seen < (uint32_t)at; index++) seen += is_long(b, index);
        if (!divides(b, index)) continue;
        RT_TRY(start_probe(probe, b, index, error));
        RT_TRY(walk_probe(probe, candidates, &random, estimate, error));
    }
    return RT_OK;
}

/* The estimated bytes of the depths down to `depth`, plus `certain` standard errors. */
static double bound(const Estimate *estimate, uint32_t depth, double certain) {
    double mean = estimate->sum[depth] / PROBES;
    double variance = estimate->squares[depth] / PROBES - mean * mean;
    return mean + certain * sqrt(fmax(variance, 0) / (PROBES - 1));
}

/* Refuses a tree whose current level, nodes [from, to), is about to be divided, if its estimated size exceeds
 * the limit with certainty. */
static RtStatus check_limit(const Builder *b, uint32_t from, uint32_t to, RtError *error) {
    double limit = (double)b->limit;
    uint64_t references = b->tree->id_count;
    uint32_t candidates = 0, max_depth = b->tree->max_depth, fits = b->depth;
    for (uint32_t i = from; i < to; i++) {
        candidates += is_long(b, i);
        references += b->tree->nodes[i].count;
    }
    /* Of the tree that is cut off at this level. */
    const double bytes = (double)(to * RT_OCTREE_NODE_BYTES + references * sizeof(uint32_t));
    if (b->depth == max_depth || candidates < PROBES || bytes < CHEAP * limit) return RT_OK;

    Estimate estimate = {{0}, {0}};
    RtOctree tree = *b->tree;
    tree.nodes = NULL, tree.boxes = NULL, tree.ids = NULL;
    tree.node_count = tree.id_count = 0;
    Builder probe = {.tree = &tree, .objects = b->objects, .limit = UINT64_MAX};
    RtStatus status = probe_level(b, &probe, from, candidates, &estimate, error);
    rt_free(probe.list);
    rt_free(probe.next);
    rt_octree_destroy(&tree.base);
    RT_TRY(status);

    /* A deeper tree is no smaller, and nearer levels are known better. */
    double least = 0;
    for (uint32_t depth = fits + 1; depth <= max_depth; depth++)
        least = fmax(least, bytes + bound(&estimate, depth, -CERTAIN));
    if (least <= limit) return RT_OK;
    while (bytes + bound(&estimate, fits + 1, CERTAIN) <= limit) fits++;
    return refuse(b, bytes + bound(&estimate, max_depth, 0), fits, error);
}

/* ---- levels ---- */

/* Two more than the least depth at which there are as many cells as objects. */
static uint32_t usual_depth(uint32_t objects) {
    uint32_t depth = 2;
    for (uint64_t cells = 1; cells < objects; cells *= 8) depth++;
    return depth;
}

static RtStatus build_levels(Builder *b, RtBox root, uint32_t object_count, RtError *error) {
    RtOctree *tree = b->tree;
    b->list = rt_alloc(object_count, sizeof(uint32_t));
    if (!b->list) return rt_fail_memory(error, "building an octree", object_count * sizeof(uint32_t));
    for (uint32_t i = 0; i < object_count; i++) b->list[i] = i;
    RT_TRY(begin(b, root, object_count, error));
    for (uint32_t from = 0, to = 1; from < to; from = to, to = tree->node_count) {
        RT_TRY(check_limit(b, from, to, error));
        for (uint32_t index = from; index < to; index++)
            RT_TRY(divides(b, index) ? divide(b, index, error) : make_leaf(b, index, error));
        next_level(b);
    }
    return RT_OK;
}

void rt_octree_destroy(RtAccel *accel) {
    RtOctree *tree = (RtOctree *)accel;
    rt_free(tree->nodes);
    rt_free(tree->boxes);
    rt_free(tree->ids);
}

RtStatus rt_octree_build(RtAccel *accel, const RtBuild *what, RtError *error) {
    const RtValue *values = what->values;
    const RtGeometry *g = &what->scene->geometry;
    int64_t depth = values[RT_OCTREE_MAX_DEPTH].i;
    RtOctree *tree = (RtOctree *)accel;
    tree->max_leaf_size = (uint32_t)values[RT_OCTREE_MAX_LEAF_SIZE].i;
    tree->max_depth = depth < 0 ? usual_depth(g->object_count) : (uint32_t)depth;
    tree->split = values[RT_OCTREE_SPLIT].choice;
    tree->traversal = values[RT_OCTREE_TRAVERSAL].choice;
    tree->slack = values[RT_OCTREE_SLACK].f;
    tree->flat = values[RT_OCTREE_FLAT].f;
    tree->cut_filled = values[RT_OCTREE_CUT_FILLED].flag;
    RT_TRY(rt_set_mailbox(accel, values[RT_OCTREE_MAILBOX].flag, error));
    if (g->object_count == 0) return RT_OK;
    RtBox root = g->box;
    for (uint32_t i = 0; i < g->object_count; i++)
        root = rt_box_union(root, rt_octree_grown(tree, g->boxes[i]));
    root = rt_box_widened(root, values[RT_OCTREE_MARGIN].f);
    Builder builder = {.tree = tree, .objects = g->boxes, .limit = what->limit};
    RtStatus status = build_levels(&builder, root, g->object_count, error);
    rt_free(builder.list);
    rt_free(builder.next);
    return status;
}
