/* SPDX-License-Identifier: Apache-2.0 */
/* Subtrees of a kd-tree on all threads. The top is built as on one thread, but a cell of few enough objects
 * is set aside, with a copy of its lists, where it comes up; then each such cell is built on its own; then
 * all is written into one tree in the order in which one thread would have made it. */
#include "accel/kd/kd.h"

#include "base/memory.h"
#include "base/parallel.h"

#include <string.h>

/* A cell that was set aside, and the tree below it, of which it is node 0. */
typedef struct Subtree {
    RtKd kd;
    RtKdLedger ledger;
    RtKdBuilder builder;
    uint32_t node;                   /* of the top */
    uint32_t root, nodes_at, ids_at; /* where its root, its other nodes and its ids go */
} Subtree;

typedef struct Subtrees {
    Subtree **items; /* [count] */
    uint32_t *of;    /* [top->node_count] the subtree of a node of the top, or NONE */
    bool *upper;     /* [top->node_count] the upper child comes first */
    RtKdNode *nodes; /* of the whole tree */
    uint32_t *ids;
    uint32_t count, capacity, of_capacity, upper_capacity, node_count, id_count;
} Subtrees;

#define NONE UINT32_MAX

/* ---- the top ---- */

static RtStatus copy_lists(const RtKdBuilder *from, RtKdCell *cell, RtKdBuilder *to, RtError *error) {
    uint64_t room = 2 * (uint64_t)cell->ids.count + 1;
    RT_TRY(rt_reserve(&to->ids, &to->id_capacity, room, sizeof(uint32_t), error));
    if (cell->ids.count > 0) memcpy(to->ids, from->ids + cell->ids.from, cell->ids.count * sizeof(uint32_t));
    RT_TRY(rt_reserve(&to->spare, &to->spare_capacity, room, sizeof(RtKdEvent), error));
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

static RtStatus set_aside(Subtrees *s, const RtKdBuilder *b, RtKdCell cell, int threads, RtError *error) {
    RT_TRY(rt_reserve(&s->items, &s->capacity, (uint64_t)s->count + 1, sizeof(Subtree *), error));
    Subtree *item = s->items[s->count] = rt_alloc(1, sizeof(Subtree));
    if (!item) return rt_fail_memory(error, "a subtree of a kd-tree", sizeof(Subtree));
    s->of[cell.node] = s->count++;
    item->kd = *b->kd;
    item->kd.nodes = NULL;
    item->kd.ids = NULL;
    item->kd.node_count = item->kd.id_count = 0;
    item->ledger.limit = b->ledger->limit / (uint64_t)rt_thread_count(threads);
    item->builder.kd = &item->kd;
    item->builder.ledger = &item->ledger;
    item->node = cell.node;
    RT_TRY(copy_lists(b, &cell, &item->builder, error));
    cell.node = 0;
    item->builder.pending[item->builder.pending_count++] = cell;
    return RT_OK;
}

static RtStatus build_top(Subtrees *s, RtKdBuilder *b, uint32_t most, int threads, RtError *error) {
    while (b->pending_count > 0 && b->ledger->estimate == 0) {
        RtKdCell cell = b->pending[--b->pending_count];
        uint32_t waiting = b->pending_count;
        RT_TRY(rt_reserve(&s->of, &s->of_capacity, b->kd->node_count, sizeof(uint32_t), error));
        RT_TRY(rt_reserve(&s->upper, &s->upper_capacity, b->kd->node_count, sizeof(bool), error));
        s->of[cell.node] = NONE;
        if (cell.ids.count <= most) {
            RT_TRY(set_aside(s, b, cell, threads, error));
            continue;
        }
        RT_TRY(rt_kd_divide(b, &cell, error));
        if (b->pending_count > waiting)
            s->upper[cell.node] = b->pending[b->pending_count - 1].node > b->pending[waiting].node;
    }
    return RT_OK;
}

/* ---- the subtrees ---- */

static RtStatus build_subtree(void *context, size_t index, int thread, RtError *error) {
    const Subtrees *s = context;
    Subtree *item = s->items[index];
    RtKdBuilder *b = &item->builder;
    uint32_t objects = item->kd.base.scene->geometry.object_count;
    (void)thread;
    b->sides = rt_alloc_unset(objects, 1);
    if (!b->sides) return rt_fail_memory(error, "building a kd-tree", objects);
    RT_TRY(rt_reserve(&item->kd.nodes, &b->node_capacity, 1, sizeof(RtKdNode), error));
    item->kd.node_count = 1;
    while (b->pending_count > 0 && item->ledger.estimate == 0) {
        RtKdCell cell = b->pending[--b->pending_count];
        RT_TRY(rt_kd_divide(b, &cell, error));
    }
    rt_kd_clear(b);
    return RT_OK;
}

static bool all_fits(const Subtrees *s, const RtKdBuilder *b) {
    uint64_t bytes = b->ledger->bytes;
    bool fits = b->ledger->estimate == 0;
    for (uint32_t i = 0; i < s->count; i++) {
        bytes += s->items[i]->ledger.bytes;
        fits &= s->items[i]->ledger.estimate == 0;
    }
    return fits && bytes <= b->ledger->limit;
}

/* ---- one tree ---- */

/* Where all goes: nodes are taken by pairs as their parents come up. */
static void place(Subtrees *s, const RtKd *top, uint32_t node, uint32_t at) {
    if (s->of[node] != NONE) {
        Subtree *item = s->items[s->of[node]];
        item->root = at;
        item->nodes_at = s->node_count;
        item->ids_at = s->id_count;
        s->node_count += item->kd.node_count - 1;
        s->id_count += item->kd.id_count;
        return;
    }
    RtKdNode made = top->nodes[node];
    if (rt_kd_is_leaf(&made)) {
        uint32_t length = rt_kd_length(&made);
        if (length > 0) memcpy(s->ids + s->id_count, top->ids + made.first, length * sizeof(uint32_t));
        made.first = s->id_count;
        s->id_count += length;
        s->nodes[at] = made;
        return;
    }
    uint32_t child = rt_kd_child(&made), pair = s->node_count;
    made.link = pair << 2 | rt_kd_axis(&made);
    s->nodes[at] = made;
    s->node_count += 2;
    for (uint32_t c = 0; c < 2; c++) {
        uint32_t next = c ^ (uint32_t)s->upper[node];
        place(s, top, child + next, pair + next);
    }
}

static RtStatus copy_subtree(void *context, size_t index, int thread, RtError *error) {
    const Subtrees *s = context;
    const Subtree *item = s->items[index];
    (void)thread;
    (void)error;
    for (uint32_t i = 0; i < item->kd.node_count; i++) {
        RtKdNode node = item->kd.nodes[i];
        if (rt_kd_is_leaf(&node))
            node.first += item->ids_at;
        else
            node.link = (rt_kd_child(&node) - 1 + item->nodes_at) << 2 | rt_kd_axis(&node);
        s->nodes[i == 0 ? item->root : item->nodes_at + i - 1] = node;
    }
    if (item->kd.id_count > 0)
        memcpy(s->ids + item->ids_at, item->kd.ids, item->kd.id_count * sizeof(uint32_t));
    return RT_OK;
}

static RtStatus join(Subtrees *s, RtKd *kd, int threads, RtError *error) {
    uint64_t nodes = kd->node_count, ids = kd->id_count;
    for (uint32_t i = 0; i < s->count; i++) {
        nodes += s->items[i]->kd.node_count - 1;
        ids += s->items[i]->kd.id_count;
    }
    if (nodes > UINT32_MAX || ids > UINT32_MAX)
        return rt_fail(error, RT_BAD_INPUT, "a kd-tree holds no more than %u nodes and entries of lists",
                       UINT32_MAX);
    s->nodes = rt_alloc_unset((size_t)nodes, sizeof(RtKdNode));
    s->ids = rt_alloc_unset((size_t)ids, sizeof(uint32_t));
    if (!s->nodes || !s->ids)
        return rt_fail_memory(error, "the nodes of a kd-tree",
                              (size_t)nodes * sizeof(RtKdNode) + (size_t)ids * sizeof(uint32_t));
    s->node_count = 1;
    place(s, kd, 0, 0);
    RT_TRY(rt_parallel_for(s->count, threads, copy_subtree, s, error));
    rt_free(kd->nodes);
    rt_free(kd->ids);
    kd->nodes = s->nodes;
    kd->ids = s->ids;
    kd->node_count = s->node_count;
    kd->id_count = s->id_count;
    s->nodes = NULL;
    s->ids = NULL;
    return RT_OK;
}

static void clear(Subtrees *s) {
    for (uint32_t i = 0; i < s->count; i++) {
        rt_kd_clear(&s->items[i]->builder);
        rt_free(s->items[i]->kd.nodes);
        rt_free(s->items[i]->kd.ids);
        rt_free(s->items[i]);
    }
    rt_free(s->items);
    rt_free(s->of);
    rt_free(s->upper);
    rt_free(s->nodes);
    rt_free(s->ids);
}

RtStatus rt_kd_build_subtrees(RtKdBuilder *b, uint32_t most, int threads, bool *fits, RtError *error) {
    Subtrees s = {.items = NULL};
    RtStatus status = build_top(&s, b, most, threads, error);
    rt_kd_clear(b); /* the lists of the top are dealt */
    if (status == RT_OK) status = rt_parallel_for(s.count, threads, build_subtree, &s, error);
    *fits = status == RT_OK && all_fits(&s, b);
    if (*fits) status = join(&s, b->kd, threads, error);
    clear(&s);
    return status;
}
