/* SPDX-License-Identifier: Apache-2.0 */
/* Building a kd-tree, depth first (kd_divide.c), on one thread or on several (kd_subtrees.c).
 *
 * Paper: Wald & Havran 2006, On building fast kd-trees for Ray Tracing, and on doing that in O(N log N). */
#include "accel/kd/kd.h"

#include "accel/mailbox.h"
#include "core/base/memory.h"
#include "core/base/parallel.h"

enum { OVERLAP_BOX, OVERLAP_EXACT };

const RtParam rt_kd_params[RT_KD_PARAM_COUNT] = {RT_KD_PARAMS(RT_PARAM_ENTRY)};

/* ---- the root ---- */

static uint32_t usual_depth(uint32_t objects) {
    uint32_t log = 0;
    while (UINT64_C(1) << log < objects) log++;
    return 8 + 13 * log / 10;
}

typedef struct Root {
    RtKdBuilder *builder;
    const RtGeometry *geometry;
    RtKdCell cell;
} Root;

/* The events of an axis, with room to partition them. */
static RtStatus make_axis(void *context, size_t axis, int thread, RtError *error) {
    Root *root = context;
    RtKdBuilder *b = root->builder;
    const RtGeometry *g = root->geometry;
    uint64_t needed = 4 * (uint64_t)g->object_count;
    (void)thread;
    RT_TRY(rt_reserve(&b->events[axis], &b->event_capacity[axis], needed, sizeof(RtKdEvent), error));
    RtKdEvent *spare = rt_alloc_unset(2 * (size_t)g->object_count, sizeof(RtKdEvent));
    if (!spare)
        return rt_fail_memory(error, "sorting events", 2 * (size_t)g->object_count * sizeof(RtKdEvent));
    root->cell.events[axis].count = rt_kd_make_events(b->ids, g->boxes, g->object_count, &root->cell.box,
                                                      (int)axis, b->events[axis], spare);
    rt_free(spare);
    return RT_OK;
}

/* The root's lists, with room to partition them. */
static RtStatus make_root(RtKdBuilder *b, const RtGeometry *g, int threads, RtError *error) {
    Root root = {b, g, {.share = 1, .box = b->kd->box, .ids = {0, g->object_count}}};
    uint64_t needed = 2 * (uint64_t)g->object_count;
    RT_TRY(rt_reserve(&b->kd->nodes, &b->node_capacity, 1, sizeof(RtKdNode), error));
    b->kd->node_count = 1;
    RT_TRY(rt_reserve(&b->ids, &b->id_capacity, needed, sizeof(uint32_t), error));
    for (uint32_t i = 0; i < g->object_count; i++) b->ids[i] = i;
    RT_TRY(rt_reserve(&b->spare, &b->spare_capacity, needed, sizeof(RtKdEvent), error));
    RT_TRY(rt_parallel_for(3, threads, make_axis, &root, error));
    b->pending[b->pending_count++] = root.cell;
    return RT_OK;
}

static RtStatus build_on_one(RtKdBuilder *b, RtError *error) {
    uint32_t asked = b->kd->max_depth;
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

/* A cell is built by one thread if it has at most this fraction of a thread's share; SMALL at least. */
enum { SHARES = 8, SMALL = 1 << 12 };

/* On several threads; if that may exceed the limit, again on one, which finds the max_depth that fits. */
static RtStatus build_tree(RtKd *kd, const RtGeometry *g, uint64_t limit, int threads, RtError *error) {
    uint32_t shares = SHARES * (uint32_t)rt_thread_count(threads), most = g->object_count / shares;
    bool several = shares > SHARES && most >= SMALL, fits = false;
    RtKd empty = *kd;
    RtStatus status = RT_OK;
    if (g->object_count >= RT_KD_OBJECTS)
        return rt_fail(error, RT_BAD_INPUT, "a kd-tree holds fewer than %u objects; this scene has %u",
                       RT_KD_OBJECTS, g->object_count);
    for (; status == RT_OK && !fits; several = false) {
        RtKdMemory memory = {.limit = limit};
        RtKdBuilder builder = {.kd = kd, .memory = &memory, .sides = rt_alloc(g->object_count, 1)};
        rt_free(kd->nodes);
        rt_free(kd->ids);
        *kd = empty;
        fits = !several;
        status = builder.sides ? make_root(&builder, g, several ? threads : 1, error)
                               : rt_fail_memory(error, "building a kd-tree", g->object_count);
        if (status == RT_OK)
            status = several ? rt_kd_build_subtrees(&builder, most, threads, &fits, error)
                             : build_on_one(&builder, error);
        rt_kd_clear(&builder);
    }
    return status;
}

void rt_kd_destroy(RtAccel *accel) {
    RtKd *kd = (RtKd *)accel;
    rt_free(kd->nodes);
    rt_free(kd->ids);
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
    kd->mailbox = values[RT_KD_MAILBOX].flag;
    if (kd->mailbox) accel->scratch_bytes = rt_mailbox_bytes(g);
    kd->surfaces = values[RT_KD_OVERLAP].choice == OVERLAP_EXACT;
    if (g->object_count == 0) return RT_OK;
    kd->box = rt_box_widened(g->box, values[RT_KD_MARGIN].f);
    kd->served = rt_clipped_rays(&g->box, &kd->box);
    return build_tree(kd, g, what->limit, what->threads, error);
}
