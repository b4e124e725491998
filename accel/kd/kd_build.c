/* SPDX-License-Identifier: Apache-2.0 */
/* Building a kd-tree, depth first (kd_divide.c), on one thread or on several.
 *
 * Paper: Wald & Havran 2006, On building fast kd-trees for Ray Tracing, and on doing that in O(N log N).
 *
 * On several threads the top is built as on one, but small cells are deferred with their lists. Each deferred
 * cell is then a task, which defers cells of its own while it is large; so is the root. Finally all nodes are
 * copied into one tree, in the order in which one thread makes them.
 *
 * All subtrees share one limit of memory. Which of them exceeds it depends on threads, but not whether any
 * does: the size of the tree is the same. Where many objects are in several cells, waiting lists may take
 * more than the tree; such a tree is built on one thread, which keeps few of them. */
#include "accel/kd/kd.h"

#include "accel/kernel.h"
#include "core/base/memory.h"
#include "core/base/parallel.h"

#include <string.h>

enum { OVERLAP_BOX, OVERLAP_EXACT };

const RtParam rt_kd_params[RT_KD_PARAM_COUNT] = {RT_KD_PARAMS(RT_PARAM_ENTRY)};

/* ---- the root ---- */

static RtStatus make_axis(void *context, size_t axis, int thread, RtError *error) {
    RtKdBuilder *b = context;
    RtKdCell *root = &b->pending[0];
    const uint32_t count = root->ids.count;
    (void)thread;
    RT_TRY(rt_reserve(&b->events[axis], &b->event_capacity[axis], 4 * (uint64_t)count, sizeof(RtKdEvent),
                      error));
    root->events[axis].count = rt_kd_make_events(b->ids, b->kd->base.scene->geometry.boxes, count, &root->box,
                                                 (int)axis, b->events[axis]);
    return RT_OK;
}

/* The root's lists, with room to partition them. */
static RtStatus make_root(RtKdBuilder *b, uint32_t count, int threads, RtError *error) {
    RT_TRY(rt_reserve(&b->kd->nodes, &b->node_capacity, 1, sizeof(RtKdNode), error));
    b->kd->node_count = 1;
    RT_TRY(rt_reserve(&b->ids, &b->id_capacity, 2 * (uint64_t)count, sizeof(uint32_t), error));
    for (uint32_t i = 0; i < count; i++) b->ids[i] = i;
    b->pending[b->pending_count++] = (RtKdCell){.share = 1, .box = b->kd->box, .ids = {0, count}};
    return rt_parallel_for(3, threads, make_axis, b, error);
}

static RtStatus build_on_one(RtKdBuilder *b, uint32_t objects, RtError *error) {
    const uint32_t asked = b->kd->max_depth;
    b->sides = rt_alloc(objects, 1);
    if (!b->sides) return rt_fail_memory(error, "building a kd-tree", objects);
    RT_TRY(make_root(b, objects, 1, error));
    while (b->pending_count > 0) {
        RtKdCell cell = b->pending[--b->pending_count];
        RT_TRY(rt_kd_divide(b, &cell, error));
    }
    if (b->memory->estimate == 0) return RT_OK;
    return rt_fail(error, RT_BAD_INPUT,
                   "a kd-tree of max_depth=%u would take about %.3g GiB, more than %.3g GiB: max_depth=%u "
                   "would fit",
                   asked, b->memory->estimate / 0x1p30, (double)b->memory->limit / 0x1p30, b->kd->max_depth);
}

/* ---- several threads ---- */

#define NONE UINT32_MAX

/* A deferred cell, and the tree below it, of which it is node 0. */
typedef struct Subtree {
    RtKd kd;
    RtKdMemory memory;
    RtKdBuilder builder;
    struct Subtree **below; /* [count] its own deferred cells */
    uint32_t *of;           /* [kd.node_count] the subtree of a node, or NONE */
    bool *upper;            /* [kd.node_count] the upper child comes first */
    uint32_t count, capacity, of_capacity, upper_capacity;
    uint64_t list_bytes; /* while they wait */
    uint32_t objects;
    uint32_t root, nodes_at, ids_at; /* their places in the whole tree */
} Subtree;

/* When work is shared; and sums over all subtrees. */
typedef struct Sharing {
    uint32_t most; /* objects of a cell that one thread builds */
    RtKdShared memory;
    _Atomic uint64_t bytes, nodes, ids;
    _Atomic uint32_t subtrees;
} Sharing;

/* Bytes of lists per object that do not count: more than a tree has whose cells share few objects. */
enum { USUAL_LISTS = 512 };

/* The whole tree, whose nodes and ids have room for all. */
typedef struct Joined {
    RtKd *kd;
    Subtree **whole; /* [whole_count] subtrees without deferred cells */
    uint32_t whole_count;
} Joined;

static void destroy_subtree(Subtree *s) {
    for (uint32_t i = 0; i < s->count; i++) destroy_subtree(s->below[i]);
    rt_kd_clear(&s->builder);
    rt_free(s->kd.nodes);
    rt_free(s->kd.ids);
    rt_free(s->below);
    rt_free(s->of);
    rt_free(s->upper);
    rt_free(s);
}

static RtStatus make_subtree(const RtKd *kd, uint64_t limit, RtKdShared *shared, uint32_t objects,
                             Subtree **out, RtError *error) {
    Subtree *s = *out = rt_alloc(1, sizeof(Subtree));
    if (!s) return rt_fail_memory(error, "a subtree of a kd-tree", sizeof(Subtree));
    s->kd = *kd;
    s->kd.nodes = NULL;
    s->kd.ids = NULL;
    s->kd.node_count = s->kd.id_count = 0;
    s->memory = (RtKdMemory){.limit = limit, .shared = shared};
    s->builder.kd = &s->kd;
    s->builder.memory = &s->memory;
    s->objects = objects;
    return RT_OK;
}

static RtStatus copy_lists(const RtKdBuilder *from, RtKdCell *cell, RtKdBuilder *to, RtError *error) {
    uint64_t needed = 2 * (uint64_t)cell->ids.count + 1;
    RT_TRY(rt_reserve(&to->ids, &to->id_capacity, needed, sizeof(uint32_t), error));
    if (cell->ids.count > 0) memcpy(to->ids, from->ids + cell->ids.from, cell->ids.count * sizeof(uint32_t));
    for (int a = 0; a < 3; a++) {
        uint32_t count = cell->events[a].count;
        RT_TRY(rt_reserve(&to->events[a], &to->event_capacity[a], 2 * (uint64_t)count + 1, sizeof(RtKdEvent),
                          error));
        if (count > 0)
            memcpy(to->events[a], from->events[a] + cell->events[a].from, count * sizeof(RtKdEvent));
        cell->events[a].from = 0;
    }
    cell->ids.from = 0;
    return RT_OK;
}

/* Moves the lists of the last pending cell: they are at the bottom, and nothing above them is needed. */
static void move_lists(RtKdBuilder *from, RtKdBuilder *to) {
    for (int a = 0; a < 3; a++) {
        to->events[a] = from->events[a];
        to->event_capacity[a] = from->event_capacity[a];
        from->events[a] = NULL;
        from->event_capacity[a] = 0;
    }
    to->ids = from->ids;
    to->id_capacity = from->id_capacity;
    from->ids = NULL;
    from->id_capacity = 0;
}

static RtStatus defer(Subtree *s, RtKdCell cell, RtError *error) {
    Subtree *item;
    RtKdBuilder *b = &s->builder;
    RT_TRY(rt_reserve(&s->below, &s->capacity, (uint64_t)s->count + 1, sizeof(Subtree *), error));
    RT_TRY(make_subtree(&s->kd, s->memory.limit, s->memory.shared, cell.ids.count, &item, error));
    s->of[cell.node] = s->count;
    s->below[s->count++] = item;
    if (b->pending_count == 0)
        move_lists(b, &item->builder);
    else
        RT_TRY(copy_lists(b, &cell, &item->builder, error));
    item->list_bytes = item->builder.id_capacity * sizeof(uint32_t);
    for (int a = 0; a < 3; a++) item->list_bytes += item->builder.event_capacity[a] * sizeof(RtKdEvent);
    rt_kd_hold(item->memory.shared, item->list_bytes);
    cell.node = 0;
    item->builder.pending[item->builder.pending_count++] = cell;
    return RT_OK;
}

/* Large subtrees defer the cells that they are split into. */
static RtStatus build_top(Subtree *s, uint32_t most, RtError *error) {
    RtKdBuilder *b = &s->builder;
    const uint32_t part = s->objects - s->objects / 4;
    while (b->pending_count > 0 && !rt_kd_is_too_large(b->memory)) {
        RtKdCell cell = b->pending[--b->pending_count];
        uint32_t waiting = b->pending_count;
        RT_TRY(rt_reserve(&s->of, &s->of_capacity, s->kd.node_count, sizeof(uint32_t), error));
        RT_TRY(rt_reserve(&s->upper, &s->upper_capacity, s->kd.node_count, sizeof(bool), error));
        s->of[cell.node] = NONE;
        if (cell.ids.count <= (part > most ? part : most)) {
            RT_TRY(defer(s, cell, error));
            continue;
        }
        RT_TRY(rt_kd_divide(b, &cell, error));
        if (b->pending_count > waiting)
            s->upper[cell.node] = b->pending[b->pending_count - 1].node > b->pending[waiting].node;
    }
    return RT_OK;
}

static RtStatus build_subtree(void *context, RtTasks *tasks, const void *task, RtError *error) {
    Sharing *sharing = context;
    Subtree *s = *(Subtree *const *)task;
    RtKdBuilder *b = &s->builder;
    uint32_t objects = s->kd.base.scene->geometry.object_count;
    if (rt_kd_is_too_large(&s->memory)) return RT_OK;
    b->sides = rt_alloc_unset(objects, 1);
    if (!b->sides) return rt_fail_memory(error, "building a kd-tree", objects);
    RT_TRY(rt_reserve(&s->kd.nodes, &b->node_capacity, 1, sizeof(RtKdNode), error));
    s->kd.node_count = 1;
    if (s->objects > sharing->most) RT_TRY(build_top(s, sharing->most, error));
    for (uint32_t i = 0; i < s->count; i++) {
        if (!rt_tasks_add(tasks, &s->below[i]))
            return rt_fail_memory(error, "a subtree of a kd-tree", sizeof(Subtree *));
    }
    while (b->pending_count > 0 && !rt_kd_is_too_large(&s->memory)) {
        RtKdCell cell = b->pending[--b->pending_count];
        RT_TRY(rt_kd_divide(b, &cell, error));
    }
    rt_kd_clear(b);
    if (s->memory.estimate > 0) atomic_store(&sharing->memory.exceeded, true);
    atomic_fetch_sub(&sharing->memory.bytes, s->list_bytes);
    atomic_fetch_add(&sharing->bytes, s->memory.bytes);
    atomic_fetch_add(&sharing->nodes, s->kd.node_count - 1);
    atomic_fetch_add(&sharing->ids, s->kd.id_count);
    atomic_fetch_add(&sharing->subtrees, 1);
    return RT_OK;
}

/* Assigns nodes and ids in the order of a serial build: pairs of nodes, as their parents are visited. */
static void assign(Joined *joined, Subtree *s, uint32_t node, uint32_t at) {
    RtKd *kd = joined->kd;
    if (s->count == 0) {
        s->root = at;
        s->nodes_at = kd->node_count;
        s->ids_at = kd->id_count;
        kd->node_count += s->kd.node_count - 1;
        kd->id_count += s->kd.id_count;
        joined->whole[joined->whole_count++] = s;
        return;
    }
    if (s->of[node] != NONE) {
        assign(joined, s->below[s->of[node]], 0, at);
        return;
    }
    RtKdNode made = s->kd.nodes[node];
    if (rt_kd_is_leaf(&made)) {
        uint32_t length = rt_kd_length(&made);
        if (length > 0) memcpy(kd->ids + kd->id_count, s->kd.ids + made.first, length * sizeof(uint32_t));
        made.first = kd->id_count;
        kd->id_count += length;
        kd->nodes[at] = made;
        return;
    }
    uint32_t child = rt_kd_child(&made), pair = kd->node_count;
    made.link = pair << 2 | rt_kd_axis(&made);
    kd->nodes[at] = made;
    kd->node_count += 2;
    for (uint32_t c = 0; c < 2; c++) {
        uint32_t next = c ^ (uint32_t)s->upper[node];
        assign(joined, s, child + next, pair + next);
    }
}

static void copy_subtree(void *context, size_t index) {
    const Joined *joined = context;
    const Subtree *s = joined->whole[index];
    for (uint32_t i = 0; i < s->kd.node_count; i++) {
        RtKdNode node = s->kd.nodes[i];
        if (rt_kd_is_leaf(&node))
            node.first += s->ids_at;
        else
            node.link = (rt_kd_child(&node) - 1 + s->nodes_at) << 2 | rt_kd_axis(&node);
        joined->kd->nodes[i == 0 ? s->root : s->nodes_at + i - 1] = node;
    }
    if (s->kd.id_count > 0) memcpy(joined->kd->ids + s->ids_at, s->kd.ids, s->kd.id_count * sizeof(uint32_t));
}

static RtStatus join(Subtree *root, const Sharing *sums, RtKd *kd, int threads, RtError *error) {
    RT_ARENA(arena);
    uint32_t node_capacity = 0, id_capacity = 0;
    Joined joined = {kd, rt_arena_alloc(&arena, sums->subtrees, sizeof(Subtree *)), 0};
    RT_TRY(rt_arena_check(&arena, "the subtrees of a kd-tree", error));
    RT_TRY(rt_reserve(&kd->nodes, &node_capacity, sums->nodes + 1, sizeof(RtKdNode), error));
    RT_TRY(rt_reserve(&kd->ids, &id_capacity, sums->ids, sizeof(uint32_t), error));
    kd->node_count = 1;
    assign(&joined, root, 0, 0);
    return rt_parallel_each(joined.whole_count, threads, copy_subtree, &joined, error);
}

/* Builds each cell of at most `most` objects on one thread: node by node the tree that one thread builds. If
 * it may exceed the limit, *fits is false, and nothing is built. */
static RtStatus build_on_several(RtKd *kd, uint32_t objects, uint64_t limit, uint32_t most, int threads,
                                 bool *fits, RtError *error) {
    Sharing sharing = {.most = most, .memory.limit = limit + (uint64_t)USUAL_LISTS * objects};
    Subtree *root;
    RT_TRY(make_subtree(kd, limit, &sharing.memory, objects, &root, error));
    RtStatus status = make_root(&root->builder, objects, threads, error);
    if (status == RT_OK)
        status = rt_parallel_tasks(&root, 1, sizeof(void *), threads, build_subtree, &sharing, error);
    *fits = status == RT_OK && !sharing.memory.exceeded && sharing.bytes <= limit;
    if (*fits) status = join(root, &sharing, kd, threads, error);
    destroy_subtree(root);
    return status;
}

/* A cell is built by one thread if it has at most this fraction of a thread's share; SMALL at least. */
enum { SHARES = 8, SMALL = 1 << 12 };

/* On several threads; if that may exceed the limit, again on one, which finds the max_depth that fits. */
static RtStatus build_tree(RtKd *kd, uint32_t objects, uint64_t limit, int threads, RtError *error) {
    uint32_t shares = SHARES * (uint32_t)rt_thread_count(threads), most = objects / shares;
    bool fits = false;
    if (objects >= RT_KD_OBJECTS)
        return rt_fail(error, RT_BAD_INPUT, "a kd-tree holds fewer than %u objects; this scene has %u",
                       RT_KD_OBJECTS, objects);
    if (shares > SHARES && most >= SMALL)
        RT_TRY(build_on_several(kd, objects, limit, most, threads, &fits, error));
    if (fits) return RT_OK;
    RtKdMemory memory = {.limit = limit};
    RtKdBuilder builder = {.kd = kd, .memory = &memory};
    RtStatus status = build_on_one(&builder, objects, error);
    rt_kd_clear(&builder);
    return status;
}

static uint32_t usual_depth(uint32_t objects) {
    uint32_t log = 0;
    while (UINT64_C(1) << log < objects) log++;
    return 8 + 13 * log / 10;
}

RtStatus rt_kd_build(RtAccel *accel, const RtBuild *what, RtError *error) {
    const RtValue *values = what->values;
    const RtGeometry *g = &what->scene->geometry;
    int64_t depth = values[RT_KD_MAX_DEPTH].i;
    RtKd *kd = (RtKd *)accel;
    kd->traversal_cost = values[RT_KD_TRAVERSAL_COST].f;
    kd->empty_bonus = values[RT_KD_EMPTY_BONUS].f;
    kd->max_leaf_size = (uint32_t)values[RT_KD_MAX_LEAF_SIZE].i;
    kd->max_depth = depth < 0 ? usual_depth(g->object_count) : (uint32_t)depth;
    kd->failures = (uint32_t)values[RT_KD_FAILURES].i;
    RT_TRY(rt_set_mailbox(accel, values[RT_KD_MAILBOX].flag, error));
    kd->surfaces = values[RT_KD_OVERLAP].choice == OVERLAP_EXACT;
    if (g->object_count == 0) return RT_OK;
    kd->box = rt_box_widened(g->box, values[RT_KD_MARGIN].f);
    kd->served = rt_clipped_rays(&g->box, &kd->box);
    return build_tree(kd, g->object_count, what->limit, what->threads, error);
}
