/* SPDX-License-Identifier: Apache-2.0 */
/* Parameter tables: the settings of an accelerator or a built-in scene. One table drives parsing, range
 * checks, `raytally accels` and `scenes`, the CSV columns, the docs, and the values that tests try.
 *
 * Text form: "key=value,key=value"; a key that is left out has its default. */
#ifndef RT_BASE_PARAM_H
#define RT_BASE_PARAM_H

#include "core/base/status.h"

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#define RT_MAX_PARAMS     16
#define RT_MAX_SPEC_CHARS 512
#define RT_MAX_CHOICES    64

typedef enum RtParamType {
    RT_PARAM_INT,       /* lo <= i <= hi */
    RT_PARAM_FLOAT,     /* lo <= f <= hi, finite */
    RT_PARAM_CHOICE,    /* one of `choices`; the value is its index */
    RT_PARAM_FLAG,      /* on | off */
    RT_PARAM_RESOLUTION /* "auto" (0, 0, 0) or cells along x, y, z as in 46x46x3, each lo..hi */
} RtParamType;

typedef struct RtParam {
    const char *name;
    RtParamType type;
    const char *default_text; /* the default, as text */
    double lo, hi;            /* range of a number, inclusive */
    const char *choices;      /* "box|sphere|obb" for RT_PARAM_CHOICE, up to RT_MAX_CHOICES; else NULL */
    const char *test_values;  /* values worth testing, "1|4|20"; NULL for choices and flags: all of them */
    const char *meaning;      /* one line; units where there are any */
    const char *source;       /* where the default comes from */
} RtParam;

/* The type of a parameter, in an entry {name, RT_INT(...), meaning, source} of a table. */
#define RT_INT(default_text, lo, hi, test_values)   RT_PARAM_INT, default_text, lo, hi, NULL, test_values
#define RT_FLOAT(default_text, lo, hi, test_values) RT_PARAM_FLOAT, default_text, lo, hi, NULL, test_values
#define RT_RESOLUTION(default_text, lo, hi, test_values)                                                     \
    RT_PARAM_RESOLUTION, default_text, lo, hi, NULL, test_values
#define RT_CHOICE(default_text, choices) RT_PARAM_CHOICE, default_text, 0, 0, choices, NULL
#define RT_FLAG(default_text)            RT_PARAM_FLAG, default_text, 0, 0, NULL, NULL

/* A list PARAMS(X) of X(INDEX, the entry without its braces) defines both the indices, enum {
 * PARAMS(RT_PARAM_INDEX) }, and the table, {PARAMS(RT_PARAM_ENTRY)}. */
#define RT_PARAM_INDEX(index, ...) index,
#define RT_PARAM_ENTRY(index, ...) [index] = {__VA_ARGS__},

/* Initialises the members `params` and `param_count` of a struct from a table. */
#define RT_PARAMS_OF(table) .params = (table), .param_count = sizeof(table) / sizeof((table)[0])

typedef union RtValue {
    int64_t i;
    double f;
    uint32_t choice;
    bool flag;
    uint32_t resolution[3];
} RtValue;

/* Fills values[0..count), in the order of the table, from `text` (NULL or "": all defaults). `what` names
 * the owner in messages ("accelerator grid"). Rejects unknown and repeated keys and values out of range;
 * the message says what would be right and suggests the nearest known key. */
RtStatus rt_params_parse(const RtParam *table, size_t count, const char *text, const char *what,
                         RtValue *values, RtError *error);

/* Writes every parameter with its value, "key=value,key=value", to out[0..size); "" for an empty table. */
void rt_params_format(const RtParam *table, size_t count, const RtValue *values, char *out, size_t size);

/* One value as text. */
void rt_param_format(const RtParam *param, RtValue value, char *out, size_t size);

/* The range or the choices as text: "1..4096", "box|sphere", "on|off", "auto or NXxNYxNZ, each 1..512". */
void rt_param_range(const RtParam *param, char *out, size_t size);

/* The `n`th test value as text, from `test_values` or all choices; false past the last. */
bool rt_param_try(const RtParam *param, size_t n, char *out, size_t size);

#endif
