/* What a structure looks like, as JSON: one object, the same wherever it is written. */
#ifndef RT_ACCEL_STRUCTURE_JSON_H
#define RT_ACCEL_STRUCTURE_JSON_H

#include "accel/accel.h"

#include <jansson.h>

/* What `description` says, but for its bytes: a new reference, NULL where memory is short. */
json_t *rt_json_structure(const RtDescription *description);

#endif
