/* SPDX-License-Identifier: Apache-2.0 */
/* Building the subtrees of a kd-tree on all threads. The top is built as on one thread, but small cells are
 * deferred with their lists. Each deferred cell is then a task, which defers cells of its own while it is
 * large. Finally all nodes are copied into one tree, in the order in which one thread makes them.
 *
 * All subtrees share one limit of memory. Which of them exceeds it depends on threads, but not whether any
 * does: the size of the tree is the same. Where many objects are in several cells, waiting lists may take
 * more than the tree; such a tree is built on one thread, which keeps few of them. */
#include "accel/kd/kd.h"

#include "core/base/memory.h"
#include "core/base/parallel.h"

#include <assert.h>
#include <string.h>

typedef struct Subtree Subtree;

/* The deferred cells of a tree. */
typedef struct Subtrees {
    Subtree **items; /* [count] */
    uint32_t *of;    /* [node_count of the tree above] the subtree of a node, or NONE */
    bool *upper;     /* [the same] the upper child comes first */
    uint32_t count, capacity, of_capacity, upper_capacity;
} Subtrees;

#define NONE UINT32_MAX

/* A deferred cell, and the tree below it, of which it is node 0. */
struct Subtree {
    RtKd kd;
    RtKdMemory memory;
    RtKdBuilder builder;
    Subtrees below;
    uint64_t list_bytes; /* while they wait */
    uint32_t objects;
    uint32_t root, nodes_at, ids_at; /* their places in the whole tree */
};

/* When work is shared. */
typedef struct Sharing {
    uint32_t most; /* objects of a cell that one thread builds */
    RtKdShared memory;
} Sharing;

/* Bytes of lists per object that do not count: more than a tree has whose cells share few objects. */
enum { USUAL_LISTS = 512 };

/* The whole tree. */
typedef struct Joined {
    RtKdNode *nodes;
    uint32_t *ids;
    Subtree **whole; /* [whole_count] subtrees without deferred cells */
    uint32_t node_count, id_count, whole_count;
} Joined;

/* ---- the top ---- */

static RtStatus copy_lists(const RtKdBuilder *from, RtKdCell *cell, RtKdBuilder *to, RtError *error) {
    uint64_t needed = 2 * (uint64_t)cell->ids.count + 1;
    RT_TRY(rt_reserve(&to->ids, &to->id_capacity, needed, sizeof(uint32_t), error));
    if (cell->ids.count > 0) memcpy(to->ids, from->ids + cell->ids.from, cell->ids.count * sizeof(uint32_t));
    RT_TRY(rt_reserve(&to->spare, &to->spare_capacity, needed, sizeof(RtKdEvent), error));
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

static uint64_t bytes_of_lists(const RtKdBuilder *b) {
    const uint64_t events = (uint64_t)b->event_capacity[0] + b->event_capacity[1] + b->event_capacity[2];
    return b->id_capacity * sizeof(uint32_t) + (events + b->spare_capacity) * sizeof(RtKdEvent);
}

static RtStatus defer(Subtrees *s, RtKdBuilder *b, RtKdCell cell, RtError *error) {
    RT_TRY(rt_reserve(&s->items, &s->capacity, (uint64_t)s->count + 1, sizeof(Subtree *), error));
    Subtree *item = s->items[s->count] = rt_alloc(1, sizeof(Subtree));
    if (!item) return rt_fail_memory(error, "a subtree of a kd-tree", sizeof(Subtree));
    s->of[cell.node] = s->count++;
    item->kd = *b->kd;
    item->kd.nodes = NULL;
    item->kd.ids = NULL;
    item->kd.node_count = item->kd.id_count = 0;
    item->memory = (RtKdMemory){.limit = b->memory->limit, .shared = b->memory->shared};
    item->builder.kd = &item->kd;
    item->builder.memory = &item->memory;
    item->objects = cell.ids.count;
    if (b->pending_count == 0)
        move_lists(b, &item->builder);
    else
        RT_TRY(copy_lists(b, &cell, &item->builder, error));
    item->list_bytes = bytes_of_lists(&item->builder);
    rt_kd_hold(item->memory.shared, item->list_bytes);
    cell.node = 0;
    item->builder.pending[item->builder.pending_count++] = cell;
    return RT_OK;
}

/* Defers the cells of at most `most` objects. */
static RtStatus build_top(Subtrees *s, RtKdBuilder *b, uint32_t most, RtError *error) {
    while (b->pending_count > 0 && !rt_kd_is_too_large(b->memory)) {
        RtKdCell cell = b->pending[--b->pending_count];
        uint32_t waiting = b->pending_count;
        RT_TRY(rt_reserve(&s->of, &s->of_capacity, b->kd->node_count, sizeof(uint32_t), error));
        RT_TRY(rt_reserve(&s->upper, &s->upper_capacity, b->kd->node_count, sizeof(bool), error));
        s->of[cell.node] = NONE;
        if (cell.ids.count <= most) {
            RT_TRY(defer(s, b, cell, error));
            continue;
        }
        RT_TRY(rt_kd_divide(b, &cell, error));
        if (b->pending_count > waiting)
            s->upper[cell.node] = b->pending[b->pending_count - 1].node > b->pending[waiting].node;
    }
    return RT_OK;
}

/* ---- the subtrees ---- */

/* Large subtrees defer the cells that they are split into, as tasks of their own. */
static uint32_t most_deferred(const Sharing *sharing, uint32_t objects) {
    uint32_t part = objects - objects / 4;
    return part > sharing->most ? part : sharing->most;
}

static RtStatus add_tasks(RtTasks *tasks, const Subtrees *s, RtError *error) {
    for (uint32_t i = 0; i < s->count; i++) {
        if (!rt_tasks_add(tasks, &s->items[i]))
            return rt_fail_memory(error, "a subtree of a kd-tree", sizeof(Subtree *));
    }
    return RT_OK;
}

static RtStatus build_subtree(void *context, RtTasks *tasks, const void *task, RtError *error) {
    const Sharing *sharing = context;
    Subtree *item = *(Subtree *const *)task;
    RtKdBuilder *b = &item->builder;
    uint32_t objects = item->kd.base.scene->geometry.object_count;
    if (rt_kd_is_too_large(&item->memory)) return RT_OK;
    b->sides = rt_alloc_unset(objects, 1);
    if (!b->sides) return rt_fail_memory(error, "building a kd-tree", objects);
    RT_TRY(rt_reserve(&item->kd.nodes, &b->node_capacity, 1, sizeof(RtKdNode), error));
    item->kd.node_count = 1;
    if (item->objects > sharing->most) {
        RT_TRY(build_top(&item->below, b, most_deferred(sharing, item->objects), error));
        RT_TRY(add_tasks(tasks, &item->below, error));
    }
    while (b->pending_count > 0 && !rt_kd_is_too_large(&item->memory)) {
        RtKdCell cell = b->pending[--b->pending_count];
        RT_TRY(rt_kd_divide(b, &cell, error));
    }
    rt_kd_clear(b);
    atomic_fetch_sub(&item->memory.shared->bytes, item->list_bytes);
    return RT_OK;
}

/* The whole tree, before it is joined. */
typedef struct Sums {
    uint64_t bytes, nodes, ids;
    uint32_t subtrees;
    bool fit; /* each of its parts */
} Sums;

static void add_up(const Subtrees *s, Sums *sums) {
    sums->subtrees += s->count;
    for (uint32_t i = 0; i < s->count; i++) {
        const Subtree *item = s->items[i];
        sums->bytes += item->memory.bytes;
        sums->nodes += item->kd.node_count - 1;
        sums->ids += item->kd.id_count;
        sums->fit &= item->memory.estimate == 0;
        add_up(&item->below, sums);
    }
}

/* ---- one tree ---- */

static void assign(Joined *joined, const Subtrees *s, const RtKd *top, uint32_t node, uint32_t at);

static void assign_subtree(Joined *joined, Subtree *item, uint32_t at) {
    if (item->below.count > 0) {
        assign(joined, &item->below, &item->kd, 0, at);
        return;
    }
    item->root = at;
    item->nodes_at = joined->node_count;
    item->ids_at = joined->id_count;
    joined->node_count += item->kd.node_count - 1;
    joined->id_count += item->kd.id_count;
    joined->whole[joined->whole_count++] = item;
}

/* Assigns nodes and ids in the order of a serial build: pairs of nodes, as their parents are visited. */
static void assign(Joined *joined, const Subtrees *s, const RtKd *top, uint32_t node, uint32_t at) {
    assert(s->of && s->upper);
    if (s->of[node] != NONE) {
        assign_subtree(joined, s->items[s->of[node]], at);
        return;
    }
    RtKdNode made = top->nodes[node];
    if (rt_kd_is_leaf(&made)) {
        uint32_t length = rt_kd_length(&made);
        if (length > 0)
            memcpy(joined->ids + joined->id_count, top->ids + made.first, length * sizeof(uint32_t));
        made.first = joined->id_count;
        joined->id_count += length;
        joined->nodes[at] = made;
        return;
    }
    uint32_t child = rt_kd_child(&made), pair = joined->node_count;
    made.link = pair << 2 | rt_kd_axis(&made);
    joined->nodes[at] = made;
    joined->node_count += 2;
    for (uint32_t c = 0; c < 2; c++) {
        uint32_t next = c ^ (uint32_t)s->upper[node];
        assign(joined, s, top, child + next, pair + next);
    }
}

static void copy_subtree(void *context, size_t index) {
    const Joined *joined = context;
    const Subtree *item = joined->whole[index];
    for (uint32_t i = 0; i < item->kd.node_count; i++) {
        RtKdNode node = item->kd.nodes[i];
        if (rt_kd_is_leaf(&node))
            node.first += item->ids_at;
        else
            node.link = (rt_kd_child(&node) - 1 + item->nodes_at) << 2 | rt_kd_axis(&node);
        joined->nodes[i == 0 ? item->root : item->nodes_at + i - 1] = node;
    }
    if (item->kd.id_count > 0)
        memcpy(joined->ids + item->ids_at, item->kd.ids, item->kd.id_count * sizeof(uint32_t));
}

static RtStatus join(const Subtrees *s, const Sums *sums, RtKd *kd, int threads, RtError *error) {
    const size_t nodes = (size_t)sums->nodes, ids = (size_t)sums->ids;
    if (sums->nodes > UINT32_MAX || sums->ids > UINT32_MAX)
        return rt_fail(error, RT_BAD_INPUT, "a kd-tree holds no more than %u nodes and entries of lists",
                       UINT32_MAX);
    Joined joined = {.nodes = rt_alloc_unset(nodes, sizeof(RtKdNode)),
                     .ids = rt_alloc_unset(ids, sizeof(uint32_t)),
                     .whole = rt_alloc(sums->subtrees, sizeof(Subtree *)),
                     .node_count = 1};
    RtStatus status = RT_OK;
    if (joined.nodes && joined.ids && joined.whole) {
        assign(&joined, s, kd, 0, 0);
        status = rt_parallel_each(joined.whole_count, threads, copy_subtree, &joined, error);
    } else {
        status = rt_fail_memory(error, "the nodes of a kd-tree",
                                nodes * sizeof(RtKdNode) + ids * sizeof(uint32_t));
    }
    rt_free(joined.whole);
    rt_free(status == RT_OK ? kd->nodes : joined.nodes);
    rt_free(status == RT_OK ? kd->ids : joined.ids);
    if (status != RT_OK) return status;
    kd->nodes = joined.nodes;
    kd->ids = joined.ids;
    kd->node_count = joined.node_count;
    kd->id_count = joined.id_count;
    return RT_OK;
}

static void clear(Subtrees *s) {
    for (uint32_t i = 0; i < s->count; i++) {
        clear(&s->items[i]->below);
        rt_kd_clear(&s->items[i]->builder);
        rt_free(s->items[i]->kd.nodes);
        rt_free(s->items[i]->kd.ids);
        rt_free(s->items[i]);
    }
    rt_free(s->items);
    rt_free(s->of);
    rt_free(s->upper);
}

RtStatus rt_kd_build_subtrees(RtKdBuilder *b, uint32_t most, int threads, bool *fits, RtError *error) {
    uint32_t objects = b->kd->base.scene->geometry.object_count;
    Sharing sharing = {.most = most, .memory.limit = b->memory->limit + (uint64_t)USUAL_LISTS * objects};
    Subtrees s = {.items = NULL};
    b->memory->shared = &sharing.memory;
    RtStatus status = build_top(&s, b, most_deferred(&sharing, objects), error);
    rt_kd_clear(b); /* the lists of the top are no longer needed */
    if (status == RT_OK)
        status =
            rt_parallel_tasks(s.items, s.count, sizeof(Subtree *), threads, build_subtree, &sharing, error);
    Sums sums = {b->memory->bytes, b->kd->node_count, b->kd->id_count, 0, !rt_kd_is_too_large(b->memory)};
    if (status == RT_OK) add_up(&s, &sums);
    *fits = status == RT_OK && sums.fit && sums.bytes <= b->memory->limit;
    if (*fits) status = join(&s, &sums, b->kd, threads, error);
    clear(&s);
    return status;
}
