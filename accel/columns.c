/* SPDX-License-Identifier: Apache-2.0 */
/* Each list of columns is an X-macro: a row of it becomes a getter and an RtTableColumn. */
#include "accel/columns.h"

/* ---- tallies ---- */

static RtField get_counter(const void *row, const RtTableColumn *column) {
    return rt_field_integer(rt_tally_get(row, (size_t)column->key));
}

#define COUNTER(name, meaning)                                                                               \
    {#name, #name, "", meaning, get_counter, RT_FORM_integer, offsetof(RtTally, name) / sizeof(uint64_t)},
const RtTableColumn rt_tally_columns[RT_TALLY_COUNTER_COUNT] = {RT_TALLY_COUNTERS(COUNTER)};

json_t *rt_json_tally(const RtTally *tally) {
    return rt_row_json(&(RtColumnGroup){NULL, rt_tally_columns, RT_TALLY_COUNTER_COUNT, NULL}, 1, tally);
}

/* ---- structures ---- */

typedef RtDescription Row;

#define STRUCTURE(X)                                                                                         \
    X(interior, "interior", integer, "", "inner nodes", r->interior)                                         \
    X(leaves, "leaves", integer, "", "leaves, or voxels", r->leaves)                                         \
    X(empty_leaves, "empty_leaves", integer, "", "leaves or voxels without an object", r->empty_leaves)      \
    X(references, "references", integer, "", "entries in all lists of objects", r->references)               \
    X(structure_depth, "depth", integer, "", "depth of the deepest leaf, the root being 0", r->depth)

#define GETTER(name, meaning) RT_TABLE_GETTER(name, #name, real9, "", meaning, r->name)
STRUCTURE(RT_TABLE_GETTER)
RT_PREDICTIONS(GETTER)
RT_QUALITIES(GETTER)

#define COLUMN(name, meaning) RT_TABLE_COLUMN(name, #name, real9, "", meaning, r->name)
const RtTableColumn rt_structure_columns[RT_STRUCTURE_COLUMNS] = {
    STRUCTURE(RT_TABLE_COLUMN) RT_PREDICTIONS(COLUMN) RT_QUALITIES(COLUMN)};

static const void *build_of(const void *row) {
    return &((const Row *)row)->build;
}

json_t *rt_json_structure(const RtDescription *description) {
    static const RtColumnGroup groups[] = {{NULL, rt_structure_columns, RT_STRUCTURE_COLUMNS, NULL},
                                           {"build", rt_tally_columns, RT_TALLY_COUNTER_COUNT, build_of}};
    return rt_row_json(groups, 2, description);
}
