/* SPDX-License-Identifier: Apache-2.0 */
#include "base/table.h"

#include <assert.h>

typedef RtTally Row;

#define GETTER(name, meaning) RT_TABLE_GETTER(name, #name, integer, "", meaning, r->name)
RT_TALLY_COUNTERS(GETTER)

#define COLUMN(name, meaning) RT_TABLE_COLUMN(name, #name, integer, "", meaning, r->name)
const RtTableColumn rt_tally_columns[RT_TALLY_COUNTER_COUNT] = {RT_TALLY_COUNTERS(COLUMN)};

const char *rt_tally_name(size_t i) {
    assert(i < RT_TALLY_COUNTER_COUNT);
    return rt_tally_columns[i].name;
}

const char *rt_tally_meaning(size_t i) {
    assert(i < RT_TALLY_COUNTER_COUNT);
    return rt_tally_columns[i].meaning;
}

uint64_t rt_tally_get(const RtTally *tally, size_t i) {
    assert(i < RT_TALLY_COUNTER_COUNT);
    return rt_tally_columns[i].get(tally, &rt_tally_columns[i]).integer;
}

void rt_tally_add(RtTally *sum, const RtTally *part) {
#define ADD(name, meaning) sum->name += part->name;
    RT_TALLY_COUNTERS(ADD)
#undef ADD
}

json_t *rt_json_tally(const RtTally *tally) {
    return rt_row_json(&(RtColumnGroup){NULL, rt_tally_columns, RT_TALLY_COUNTER_COUNT, NULL}, 1, tally);
}
