/* SPDX-License-Identifier: Apache-2.0 */
/* What a structure looks like, as columns and as JSON: one object, the same wherever it is written. */
#ifndef RT_ACCEL_STRUCTURE_JSON_H
#define RT_ACCEL_STRUCTURE_JSON_H

#include "accel/accel.h"
#include "base/table.h"

/* Of an RtDescription: what it says but for its bytes; the predictions, and then the qualities, after
 * RT_SHAPE_COLUMNS. */
#define RT_PLUS_ONE(name, meaning) +1
enum {
    RT_SHAPE_COLUMNS = 5,
    RT_PREDICTION_COLUMNS = 0 RT_PREDICTIONS(RT_PLUS_ONE) RT_QUALITIES(RT_PLUS_ONE),
    RT_STRUCTURE_COLUMNS = RT_SHAPE_COLUMNS + RT_PREDICTION_COLUMNS
};
#undef RT_PLUS_ONE
extern const RtTableColumn rt_structure_columns[RT_STRUCTURE_COLUMNS];

/* These columns of one, and the counters of its build under "build": a new reference, NULL where memory is
 * short. */
json_t *rt_json_structure(const RtDescription *description);

#endif
