/* SPDX-License-Identifier: Apache-2.0 */
/* Tallies and descriptions of structures as table columns and as JSON. */
#ifndef RT_ACCEL_COLUMNS_H
#define RT_ACCEL_COLUMNS_H

#include "accel/accel.h"
#include "core/base/tally.h"
#include "core/text/table.h"

/* The counters of an RtTally. */
extern const RtTableColumn rt_tally_columns[RT_TALLY_COUNTER_COUNT];

/* All counters by name. Returns a new reference, or NULL if out of memory. */
json_t *rt_json_tally(const RtTally *tally);

/* The fields of an RtDescription except its bytes: RT_STRUCTURE_COUNTS, then predictions, then qualities. */
#define RT_PLUS_ONE(name, meaning) +1
enum {
    RT_STRUCTURE_COUNTS = 5,
    RT_PREDICTION_COLUMNS = 0 RT_PREDICTIONS(RT_PLUS_ONE) RT_QUALITIES(RT_PLUS_ONE),
    RT_STRUCTURE_COLUMNS = RT_STRUCTURE_COUNTS + RT_PREDICTION_COLUMNS
};
#undef RT_PLUS_ONE
extern const RtTableColumn rt_structure_columns[RT_STRUCTURE_COLUMNS];

/* These columns, and the counters of the build under "build". Returns a new reference, or NULL if out of
 * memory. */
json_t *rt_json_structure(const RtDescription *description);

#endif
