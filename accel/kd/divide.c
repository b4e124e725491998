/* SPDX-License-Identifier: Apache-2.0 */
/* Dividing a cell of a kd-tree where that is expected to cost less than testing all its objects; and what the
 * tree takes meanwhile. */
#include "accel/kd/kd.h"

#include "core/base/memory.h"

#include <float.h>
#include <string.h>

/* ---- what it takes ---- */

static uint64_t bytes_of(uint64_t nodes, uint64_t ids) {
    return nodes * sizeof(RtKdNode) + ids * sizeof(uint32_t);
}

/* Of a tree that is cut off at `depth`: the bytes so far, and those in the end if what is still to come is
 * like what there is. */
static uint64_t bytes_down_to(const RtKdLedger *ledger, uint32_t depth, double *estimate) {
    const RtKdLevel *levels = ledger->levels;
    uint64_t nodes = levels[depth].nodes, ids = levels[depth].ids;
    double share = levels[depth].share;
    for (uint32_t d = 0; d < depth; d++) {
        nodes += levels[d].nodes;
        ids += levels[d].leaf_ids;
        share += levels[d].leaf_share;
    }
    *estimate = (double)bytes_of(nodes, ids) / fmax(share, DBL_MIN);
    return bytes_of(nodes, ids);
}

static void enter_cell(RtKdBuilder *b, const RtKdCell *cell, bool leaf) {
    RtKdLedger *ledger = b->ledger;
    RtKdLevel *level = &ledger->levels[cell->depth];
    level->nodes++;
    level->ids += cell->ids.count;
    level->share += cell->share;
    level->leaf_ids += leaf ? cell->ids.count : 0;
    level->leaf_share += leaf ? cell->share : 0;
    ledger->bytes += bytes_of(1, leaf ? cell->ids.count : 0);
    if (ledger->bytes <= ledger->limit) return;
    double estimate;
    bytes_down_to(ledger, b->kd->max_depth, &estimate);
    if (ledger->estimate == 0) ledger->estimate = estimate;
    while (b->kd->max_depth > 0 && (ledger->bytes > ledger->limit || estimate > (double)ledger->limit)) {
        ledger->bytes = bytes_down_to(ledger, --b->kd->max_depth, &estimate);
    }
}

/* ---- nodes ---- */

static RtStatus make_leaf(RtKdBuilder *b, const RtKdCell *cell, RtError *error) {
    RtKd *kd = b->kd;
    uint64_t room = (uint64_t)kd->id_count + cell->ids.count;
    enter_cell(b, cell, true);
    if (b->ledger->estimate > 0) return RT_OK;
    RT_TRY(rt_reserve(&kd->ids, &b->leaf_id_capacity, room, sizeof(uint32_t), error));
    kd->nodes[cell->node] = (RtKdNode){.first = kd->id_count, .link = cell->ids.count << 2 | RT_KD_LEAF};
    if (cell->ids.count > 0)
        memcpy(kd->ids + kd->id_count, b->ids + cell->ids.from, cell->ids.count * sizeof(uint32_t));
    kd->id_count += cell->ids.count;
    return RT_OK;
}

static RtStatus make_inner(RtKdBuilder *b, const RtKdCell *cell, const RtKdSplit *split, uint32_t failures,
                           RtError *error) {
    RtKd *kd = b->kd;
    RtKdCell children[2];
    uint32_t above, child = kd->node_count;
    enter_cell(b, cell, false);
    if (b->ledger->estimate == 0) {
        RT_TRY(rt_reserve(&kd->nodes, &b->node_capacity, (uint64_t)child + 2, sizeof(RtKdNode), error));
        kd->nodes[cell->node] = (RtKdNode){.split = split->plane, .link = child << 2 | split->axis};
        kd->node_count += 2;
    }
    RT_TRY(rt_kd_deal(b, cell, split, children, &above, error));
    double sum = fmax((double)children[0].ids.count + children[1].ids.count, 1);
    for (uint32_t c = 0; c < 2; c++) {
        children[c].node = child + c;
        children[c].failures = failures;
        children[c].share = cell->share * children[c].ids.count / sum;
    }
    b->pending[b->pending_count++] = children[1 - above];
    b->pending[b->pending_count++] = children[above];
    return RT_OK;
}

RtStatus rt_kd_divide(RtKdBuilder *b, const RtKdCell *cell, RtError *error) {
    const RtKd *kd = b->kd;
    if (cell->depth > kd->max_depth) return RT_OK; /* for it has been lowered */
    if (cell->ids.count <= kd->max_leaf_size || cell->depth == kd->max_depth)
        return make_leaf(b, cell, error);
    RtKdSplit split = rt_kd_find_split(b, cell);
    bool saves = split.cost < cell->ids.count * rt_box_half_area(cell->box);
    if (!saves && (split.cost == INFINITY || cell->failures == kd->failures))
        return make_leaf(b, cell, error);
    return make_inner(b, cell, &split, cell->failures + !saves, error);
}

void rt_kd_clear(RtKdBuilder *b) {
    RtKdBuilder cleared = {.kd = b->kd, .ledger = b->ledger};
    for (int a = 0; a < 3; a++) rt_free(b->events[a]);
    for (int c = 0; c < 2; c++) {
        rt_free(b->cut_ids[c]);
        rt_free(b->cut_parts[c]);
    }
    rt_free(b->ids);
    rt_free(b->sides);
    rt_free(b->fresh);
    rt_free(b->spare);
    *b = cleared;
}
