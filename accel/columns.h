/* SPDX-License-Identifier: Apache-2.0 */
/* Tallies and descriptions of structures as table columns and as JSON: the same wherever they are written. */
#ifndef RT_ACCEL_COLUMNS_H
#define RT_ACCEL_COLUMNS_H

#include "accel/accel.h"
#include "core/base/tally.h"
#include "core/text/table.h"

/* The counters of an RtTally. */
extern const RtTableColumn rt_tally_columns[RT_TALLY_COUNTER_COUNT];

/* Every counter under its name: a new reference, NULL if out of memory. */
json_t *rt_json_tally(const RtTally *tally);

/* The fields of an RtDescription, without its bytes; predictions, then qualities, follow the first
 * RT_SHAPE_COLUMNS. */
#define RT_PLUS_ONE(name, meaning) +1
enum {
    RT_SHAPE_COLUMNS = 5,
    RT_PREDICTION_COLUMNS = 0 RT_PREDICTIONS(RT_PLUS_ONE) RT_QUALITIES(RT_PLUS_ONE),
    RT_STRUCTURE_COLUMNS = RT_SHAPE_COLUMNS + RT_PREDICTION_COLUMNS
};
#undef RT_PLUS_ONE
extern const RtTableColumn rt_structure_columns[RT_STRUCTURE_COLUMNS];

/* These columns of one, and the counters of its build under "build": a new reference, NULL if out of
 * memory. */
json_t *rt_json_structure(const RtDescription *description);

#endif
