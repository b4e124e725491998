/* Building an octree, level by level: a leaf's list goes to the array of all lists, an inner node's is dealt
 * to the lists of its eight children, the next level. What a node's children would take is counted before it
 * is taken.
 *
 * Split planes: Glassner 1984 (the centre); Whang et al. 1995, Octree-R (by cost, each axis on its own). */
#include "accel/octree/octree.h"

#include "base/memory.h"

/* From the centre of a cell to where its objects are; planes are tried at both ends and between. */
enum { STEPS = 10 };

const RtParam rt_octree_params[RT_OCTREE_PARAM_COUNT] = {
    [RT_OCTREE_MAX_OBJECTS] = {.name = "max_objects",
                               .type = RT_PARAM_INT,
                               .standard = "1",
                               .lo = 1,
                               .hi = 1e6,
                               .meaning = "a cell with at most so many objects is not divided",
                               .source = "Havran 1999, RTN 12(2)",
                               .tries = "2|1000000"},
    [RT_OCTREE_MAX_DEPTH] = {.name = "max_depth",
                             .type = RT_PARAM_INT,
                             .standard = "-1",
                             .lo = -1,
                             .hi = RT_OCTREE_DEPTH_LIMIT,
                             .meaning =
                                 "depth at which cells are divided no more, the root's being 0; -1: two "
                                 "more than gives a cell per object",
                             .source = "the best depths of Havran 1999: 5 to 7 for 8000 objects",
                             .tries = "0|4|6"},
    [RT_OCTREE_SPLIT] = {.name = "split",
                         .type = RT_PARAM_CHOICE,
                         .standard = "centre",
                         .choices = "centre|cost",
                         .meaning =
                             "where a cell is cut: its centre, or the cheapest of eleven planes per axis",
                         .source = "Glassner 1984"},
    [RT_OCTREE_MARGIN] = {.name = "margin",
                          .type = RT_PARAM_FLOAT,
                          .standard = "0",
                          .lo = 0,
                          .hi = 1,
                          .meaning = "how much wider than the scene's box the root is, as a part of it",
                          .source = "the published scene boxes are a little wider than tight",
                          .tries = "0.01|1"},
    [RT_OCTREE_SLACK] =
        {.name = "slack",
         .type = RT_PARAM_FLOAT,
         .standard = "0",
         .lo = 0,
         .hi = 1e6,
         .meaning = "how far from a cell an object may be and still be listed there, in units of the scene",
         .source = "0 is enough; Havran 1999 lists more (README)",
         .tries = "0.01|100"},
    [RT_OCTREE_FLAT] =
        {.name = "flat",
         .type = RT_PARAM_FLOAT,
         .standard = "0",
         .lo = 0,
         .hi = 1e6,
         .meaning = "how far objects that are flat along an axis reach to both sides, in units of the scene",
         .source = "0 is enough; Havran 1999 thickens them (README)",
         .tries = "0.01"},
    [RT_OCTREE_CUT_FILLED] = {.name = "cut_filled",
                              .type = RT_PARAM_FLAG,
                              .standard = "off",
                              .meaning = "divide cells, too, that every one of their objects' boxes fills",
                              .source = "off: it separates nothing; Havran 1999 does"},
    [RT_OCTREE_MAILBOX] = {.name = "mailbox",
                           .type = RT_PARAM_FLAG,
                           .standard = "on",
                           .meaning = "do not test an object twice for one ray",
                           .source = "Kirk & Arvo 1991"},
    [RT_OCTREE_TRAVERSAL] = {.name = "traversal",
                             .type = RT_PARAM_CHOICE,
                             .standard = "parametric",
                             .choices = "points|neighbours|parametric",
                             .meaning =
                                 "next leaf: sought from the root, from an ancestor, or left on a stack",
                             .source = "Havran 1999: fewest steps"},
};

/* ---- split planes ---- */

/* A plane strictly inside, or the upper one: see octree.h. */
static float inside(double at, float lo, float hi) {
    float split = (float)at;
    return split > lo && split < hi ? split : hi;
}

static float centre(float lo, float hi) {
    return inside(0.5 * (double)lo + 0.5 * (double)hi, lo, hi);
}

/* Where objects are along an axis: the mean of the centres of what the cell holds of their boxes. */
static double mean_center(const RtOctreeBuilder *b, const RtBox *cell, int axis, const uint32_t *ids,
                          uint32_t count) {
    double sum = 0, lo = (double)cell->lo.at[axis], hi = (double)cell->hi.at[axis];
    for (uint32_t i = 0; i < count; i++) {
        RtBox object = rt_octree_grown(b->tree, b->objects[ids[i]]);
        sum += fmax((double)object.lo.at[axis], lo) + fmin((double)object.hi.at[axis], hi);
    }
    return sum / (2.0 * count);
}

/* Octree-R: of the planes in ten equal steps from the centre to where the objects are, the one of the least
 * cost (MacDonald & Booth 1990). */
static float cheapest(const RtOctreeBuilder *b, const RtBox *cell, int axis, const uint32_t *ids,
                      uint32_t count) {
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

static RtVec3 choose_split(const RtOctreeBuilder *b, const RtBox *cell, const uint32_t *ids, uint32_t count) {
    RtVec3 split;
    for (int a = 0; a < 3; a++) {
        split.at[a] = b->tree->split == RT_OCTREE_COST ? cheapest(b, cell, a, ids, count)
                                                       : centre(cell->lo.at[a], cell->hi.at[a]);
    }
    return split;
}

bool rt_octree_divisible(const RtOctree *tree, const RtBox *boxes, const RtBox *cell, const uint32_t *ids,
                         uint32_t count) {
    bool room = false;
    for (int a = 0; a < 3; a++) room |= centre(cell->lo.at[a], cell->hi.at[a]) < cell->hi.at[a];
    if (tree->cut_filled) return room;
    for (uint32_t i = 0; room && i < count; i++) {
        if (!rt_box_contains(rt_octree_grown(tree, boxes[ids[i]]), *cell)) return true;
    }
    return false;
}

bool rt_octree_divides(const RtOctreeBuilder *b, const RtBox *cell, const uint32_t *ids, uint32_t count) {
    return count > b->tree->max_objects && b->depth < b->tree->max_depth &&
           rt_octree_divisible(b->tree, b->objects, cell, ids, count);
}

/* ---- levels ---- */

/* Makes room for `nodes` more nodes, `ids` more entries of leaves and `next` more of the next level. */
static RtStatus make_room(RtOctreeBuilder *b, uint64_t nodes, uint64_t ids, uint64_t next, RtError *error) {
    RtOctree *tree = b->tree;
    nodes += tree->node_count;
    ids += tree->id_count;
    next += b->next_count;
    uint64_t bytes = nodes * RT_OCTREE_NODE_BYTES + (ids + next) * sizeof(uint32_t);
    if (bytes > b->limit) return rt_octree_refuse(b, (double)bytes, b->depth, error);
    RT_TRY(rt_reserve(&tree->nodes, &b->node_capacity, nodes, sizeof(RtOctreeNode), error));
    RT_TRY(rt_reserve(&tree->boxes, &b->box_capacity, nodes, sizeof(RtBox), error));
    RT_TRY(rt_reserve(&tree->ids, &b->id_capacity, ids, sizeof(uint32_t), error));
    return rt_reserve(&b->next, &b->next_capacity, next, sizeof(uint32_t), error);
}

/* Two more than the least depth at which there are as many cells as objects. */
static uint32_t usual_depth(uint32_t objects) {
    uint32_t depth = 2;
    for (uint64_t cells = 1; cells < objects; cells *= 8) depth++;
    return depth;
}

static RtStatus make_leaf(RtOctreeBuilder *b, uint32_t index, const uint32_t *ids, uint32_t count,
                          RtError *error) {
    RtOctree *tree = b->tree;
    RT_TRY(make_room(b, 0, count, 0, error));
    tree->nodes[index].first = tree->id_count;
    for (uint32_t i = 0; i < count; i++) tree->ids[tree->id_count++] = ids[i];
    return RT_OK;
}

/* A count pass, room, a fill pass. */
RtStatus rt_octree_divide(RtOctreeBuilder *b, uint32_t index, const uint32_t *ids, uint32_t count,
                          RtError *error) {
    RtOctree *tree = b->tree;
    RtBox cell = tree->boxes[index];
    RtVec3 split = choose_split(b, &cell, ids, count);
    uint32_t length[8] = {0}, end[8];
    uint64_t total = 0;
    for (uint32_t i = 0; i < count; i++) {
        RtBox object = rt_octree_grown(tree, b->objects[ids[i]]);
        uint32_t children = rt_octree_sides(&cell, split, &object);
        for (uint32_t c = 0; c < 8; c++) length[c] += children >> c & 1;
    }
    for (uint32_t c = 0; c < 8; c++) total += length[c];
    RT_TRY(make_room(b, 8, 0, total, error));
    RtOctreeNode *node = &tree->nodes[index];
    node->split = split;
    node->first = tree->node_count;
    node->count = RT_OCTREE_INNER;
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

static RtStatus build_level(RtOctreeBuilder *b, uint32_t from, uint32_t to, RtError *error) {
    RtOctree *tree = b->tree;
    for (uint32_t index = from; index < to; index++) {
        uint32_t count = tree->nodes[index].count;
        const uint32_t *ids = b->list + tree->nodes[index].first;
        if (rt_octree_divides(b, &tree->boxes[index], ids, count)) {
            RT_TRY(rt_octree_divide(b, index, ids, count, error));
        } else {
            RT_TRY(make_leaf(b, index, ids, count, error));
        }
    }
    return RT_OK;
}

RtStatus rt_octree_plant(RtOctreeBuilder *b, RtBox cell, uint32_t count, RtError *error) {
    RT_TRY(make_room(b, 1, 0, 0, error));
    b->tree->nodes[0] = (RtOctreeNode){.first = 0, .count = count};
    b->tree->boxes[0] = cell;
    b->tree->node_count = 1;
    return RT_OK;
}

void rt_octree_descend(RtOctreeBuilder *b) {
    rt_free(b->list);
    b->list = b->next;
    b->next = NULL;
    b->next_count = b->next_capacity = 0;
    b->depth++;
}

static RtStatus build_levels(RtOctreeBuilder *b, RtBox root, uint32_t object_count, RtError *error) {
    RtOctree *tree = b->tree;
    b->list = rt_alloc(object_count, sizeof(uint32_t));
    if (!b->list) {
        return rt_fail_memory(error, "building an octree", object_count * sizeof(uint32_t));
    }
    for (uint32_t i = 0; i < object_count; i++) b->list[i] = i;
    RT_TRY(rt_octree_plant(b, root, object_count, error));
    for (uint32_t from = 0, to = 1; from < to; from = to, to = tree->node_count) {
        RT_TRY(rt_octree_foresee(b, from, to, error));
        RT_TRY(build_level(b, from, to, error));
        rt_octree_descend(b);
    }
    return RT_OK;
}

void rt_octree_uproot(RtOctreeBuilder *b) {
    rt_free(b->list);
    rt_free(b->next);
    rt_free(b->tree->nodes);
    rt_free(b->tree->boxes);
    rt_free(b->tree->ids);
}

void rt_octree_destroy(RtAccel *accel) {
    RtOctree *tree = (RtOctree *)accel;
    rt_free(tree->nodes);
    rt_free(tree->boxes);
    rt_free(tree->ids);
    rt_free(tree);
}

RtStatus rt_octree_build_within(uint64_t limit, const RtScene *scene, const RtValue *values, RtAccel **out,
                                RtError *error) {
    const RtGeometry *g = &scene->geometry;
    int64_t depth = values[RT_OCTREE_MAX_DEPTH].i;
    RtAccel *accel;
    RT_TRY(rt_accel_new(&rt_octree_ops, scene, sizeof(RtOctree), &accel, error));
    RtOctree *tree = (RtOctree *)accel;
    tree->max_objects = (uint32_t)values[RT_OCTREE_MAX_OBJECTS].i;
    tree->max_depth = depth < 0 ? usual_depth(g->object_count) : (uint32_t)depth;
    tree->split = values[RT_OCTREE_SPLIT].choice;
    tree->traversal = values[RT_OCTREE_TRAVERSAL].choice;
    tree->slack = values[RT_OCTREE_SLACK].f;
    tree->flat = values[RT_OCTREE_FLAT].f;
    tree->cut_filled = values[RT_OCTREE_CUT_FILLED].flag;
    tree->mailbox = values[RT_OCTREE_MAILBOX].flag;
    RtOctreeBuilder builder = {.tree = tree, .objects = g->boxes, .limit = limit};
    RtStatus status = RT_OK;
    if (g->object_count > 0) {
        RtBox root = g->box;
        for (uint32_t i = 0; i < g->object_count; i++) {
            root = rt_box_union(root, rt_octree_grown(tree, g->boxes[i]));
        }
        root = rt_box_widened(root, values[RT_OCTREE_MARGIN].f);
        status = build_levels(&builder, root, g->object_count, error);
    }
    rt_free(builder.list);
    rt_free(builder.next);
    if (status != RT_OK) {
        rt_octree_destroy(accel);
        return status;
    }
    *out = accel;
    return RT_OK;
}

RtStatus rt_octree_build(const RtBuild *what, RtAccel **out, RtError *error) {
    return rt_octree_build_within(RT_ACCEL_MAX_BYTES, what->scene, what->values, out, error);
}
