/* SPDX-License-Identifier: Apache-2.0 */
/* Sweeps: one spec of a scene or an accelerator that expands to several, one for each value of a parameter.
 *
 *     grid:density=1|4|16              a list
 *     grid:density=1..9+2              from 1 to 9 in steps of 2
 *     random:n=1e2..1e7*10             from 100 to 10,000,000, each ten times the previous
 *     grid:density=1..16*4,depth=1|2   all combinations; the last parameter changes fastest
 *
 * A list may hold ranges, "0.5|1..16*2", and words, "bvh:build=binned|sweep". For a parameter that is a whole
 * number, values are rounded and duplicates dropped. The characters are unambiguous: no other value has two
 * dots or a bar, and a '+' before a digit never separates accelerators. */
#ifndef RT_EXPERIMENT_SWEEP_H
#define RT_EXPERIMENT_SWEEP_H

#include "accel/accel.h"

#include <jansson.h>

#define RT_MAX_SWEPT        4   /* parameters of one spec */
#define RT_MAX_SWEEP_VALUES 256 /* of one parameter */
#define RT_MAX_SWEPT_CHARS  32  /* of a value */

/* The swept parameters of one spec, and their values. */
typedef struct RtSwept {
    uint32_t count; /* 0: nothing is swept */
    char keys[RT_MAX_SWEPT][RT_MAX_NAME];
    char values[RT_MAX_SWEPT][RT_MAX_SWEPT_CHARS];
} RtSwept;

/* The value of `key`; NULL if it is not swept. */
const char *rt_swept_value(const RtSwept *swept, const char *key);

/* The value as a number; false if it is a word. */
bool rt_swept_number(const char *value, double *number);

/* Whether the increasing values[0..count) are spaced more evenly on a logarithmic than on a linear axis. */
bool rt_swept_logarithmic(const double *values, uint32_t count);

/* Appends ":key=value" for every swept parameter except `but` (or NULL). */
void rt_swept_name(const RtSwept *swept, const char *but, char *out, size_t size);

typedef struct RtSweptParam {
    char key[RT_MAX_NAME];
    size_t start, length; /* of the value in the text */
    uint32_t count;
    char values[RT_MAX_SWEEP_VALUES][RT_MAX_SWEPT_CHARS];
} RtSweptParam;

typedef struct RtSweep {
    const char *text; /* borrowed */
    uint32_t count;   /* of specs; 1 if nothing is swept */
    uint32_t param_count;
    RtSweptParam params[RT_MAX_SWEPT];
} RtSweep;

/* Reads `text`, a spec of a built-in scene (`scene`) or of an accelerator; files are never swept. Rejects
 * values that are neither words nor ranges. Does not check the resulting specs. `manifest` says which
 * parameters are whole numbers for accelerators that this build may lack (experiment/manifest_experiment.h);
 * or NULL. */
RtStatus rt_sweep_parse(const char *text, bool scene, const json_t *manifest, RtSweep *sweep, RtError *error);

/* Spec number `i` < count to out[0..RT_MAX_SPEC_CHARS), with its swept values. Rejects a spec that is too
 * long. */
RtStatus rt_sweep_at(const RtSweep *sweep, uint32_t i, char *out, RtSwept *swept, RtError *error);

/* The text without the swept parameters, "grid:depth=2" of "grid:density=1..8*2,depth=2", to out[0..size),
 * truncated. */
void rt_sweep_base(const RtSweep *sweep, char *out, size_t size);

#endif
