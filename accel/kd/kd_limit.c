/* SPDX-License-Identifier: Apache-2.0 */
/* The memory that a kd-tree takes, estimated while it is built, and the depth at which it would fit. */
#include "accel/kd/kd.h"

#include <float.h>

static uint64_t bytes_of(uint64_t nodes, uint64_t ids) {
    return nodes * sizeof(RtKdNode) + ids * sizeof(uint32_t);
}

/* The bytes so far of the tree cut off at `depth`; *estimate extrapolates them to the whole tree. */
static uint64_t bytes_down_to(const RtKdMemory *memory, uint32_t depth, double *estimate) {
    const RtKdLevel *levels = memory->levels;
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

void rt_kd_count_cell(RtKdBuilder *b, const RtKdCell *cell, bool leaf) {
    RtKdMemory *memory = b->memory;
    RtKdLevel *level = &memory->levels[cell->depth];
    level->nodes++;
    level->ids += cell->ids.count;
    level->share += cell->share;
    level->leaf_ids += leaf ? cell->ids.count : 0;
    level->leaf_share += leaf ? cell->share : 0;
    memory->bytes += bytes_of(1, leaf ? cell->ids.count : 0);
    if (memory->bytes <= memory->limit) return;
    double estimate;
    bytes_down_to(memory, b->kd->max_depth, &estimate);
    if (memory->estimate == 0) memory->estimate = estimate;
    while (b->kd->max_depth > 0 && (memory->bytes > memory->limit || estimate > (double)memory->limit))
        memory->bytes = bytes_down_to(memory, --b->kd->max_depth, &estimate);
}
