/* SPDX-License-Identifier: Apache-2.0 */
/* YAML, read into a tree of nodes, and getters for its values. Scenes and experiments use no other reader.
 *
 * libyaml's events become nodes of 16 bytes, in the order of the text. (libyaml's own documents take over ten
 * times as much memory, and time quadratic in their anchors.) Every node knows its line and column, so every
 * message begins with a position and a path: "FILE:LINE:COLUMN: objects[3].sphere.radius: ".
 *
 * Getters take a mapping, a key, and the address of a value. If the key is missing they do nothing, so the
 * value keeps its default; rt_yaml_keys checks required keys once per mapping. With a NULL key they read
 * the node itself, an entry of a list. Messages go to yaml->error. */
#ifndef RT_TEXT_YAML_H
#define RT_TEXT_YAML_H

#include "core/base/memory.h"
#include "core/base/vec.h"

#include <stdint.h>

#define RT_YAML_MAX_BYTES 1000000000 /* of one file */
#define RT_YAML_MAX_DEPTH 32         /* of nested lists and mappings */

typedef enum RtYamlKind { RT_YAML_SCALAR, RT_YAML_LIST, RT_YAML_MAPPING } RtYamlKind;

typedef struct RtYamlNode {
    uint32_t size; /* nodes of this subtree: node + size is the next sibling */
    union {
        uint32_t text;  /* of a scalar: its offset in RtYaml.text */
        uint32_t count; /* of a list or mapping: its children; a key and its value are two */
    };
    uint32_t line;        /* from 1; that of the key for a list or mapping after a key */
    uint32_t column : 30; /* from 1, likewise */
    uint32_t kind : 2;    /* an RtYamlKind */
} RtYamlNode;

typedef struct RtYaml {
    const char *path;  /* borrowed: for messages */
    RtError *error;    /* borrowed; may be NULL */
    RtVec3d offset;    /* subtracted from positions, in double, before they are rounded to float32 */
    RtYamlNode *nodes; /* owned, [node_count]; the first is the root */
    uint32_t node_count, node_capacity;
    char *text; /* owned, [text_size]: null-terminated scalars in UTF-8 without control characters */
    uint32_t text_size, text_capacity;
} RtYaml;

/* ---- reading ---- */

/* Parses text[0..length) of UTF-8, which need not outlive the call; `name` stands for it in messages.
 * Rejects invalid YAML, empty text, more than RT_YAML_MAX_BYTES, more than one document, more than
 * RT_YAML_MAX_DEPTH levels, aliases (*name), %TAG directives, keys that are not words, and control
 * characters. Time and memory are linear in `length` for any text. On failure nothing is owned. */
RtStatus rt_yaml_parse(RtYaml *yaml, const char *name, const char *text, size_t length, RtError *error);

/* The same for a regular file. */
RtStatus rt_yaml_open(RtYaml *yaml, const char *path, RtError *error);

void rt_yaml_close(RtYaml *yaml);

/* ---- mappings and lists ---- */

/* Checks the keys of a mapping against `keys`: "name" is required, "name?" optional, and exactly one of
 * all "name|" is required. Rejects unknown keys, with the nearest known one, and repeated keys. `keys` has
 * at most 32 words and 511 characters. */
RtStatus rt_yaml_keys(const RtYaml *yaml, const RtYamlNode *node, const char *keys);

/* Rejects a file whose key `format` is not a format that this version reads. Without the key it is of
 * format 1. Call it before rt_yaml_keys, which would reject the keys of later formats. */
RtStatus rt_yaml_check_format(const RtYaml *yaml);

/* The value of `key` in a mapping; NULL if there is none. */
const RtYamlNode *rt_yaml_get(const RtYaml *yaml, const RtYamlNode *mapping, const char *key);

/* Rejects anything but a list of least..most entries; `what` describes the entries in messages: "numbers". */
RtStatus rt_yaml_list(const RtYaml *yaml, const RtYamlNode *node, const char *key, uint32_t least,
                      uint32_t most, const char *what);

/* The null-terminated text of a scalar. */
static inline const char *rt_yaml_text_of(const RtYaml *yaml, const RtYamlNode *node) {
    return yaml->text + node->text;
}

/* The entries of a list: for (n = rt_yaml_first(list); n != rt_yaml_end(list); n += n->size). NULL has none.
 */
static inline const RtYamlNode *rt_yaml_first(const RtYamlNode *list) {
    return list ? list + 1 : NULL;
}

static inline const RtYamlNode *rt_yaml_end(const RtYamlNode *list) {
    return list ? list + list->size : NULL;
}

static inline uint32_t rt_yaml_count(const RtYamlNode *list) {
    return list ? list->count : 0;
}

/* ---- values ---- */

/* Finite numbers: one, or a list of 3 or `count`. float32 values must be in range. */
RtStatus rt_yaml_float(const RtYaml *yaml, const RtYamlNode *node, const char *key, float *value);
RtStatus rt_yaml_double(const RtYaml *yaml, const RtYamlNode *node, const char *key, double *value);
RtStatus rt_yaml_point(const RtYaml *yaml, const RtYamlNode *node, const char *key, RtVec3 *value);
RtStatus rt_yaml_doubles(const RtYaml *yaml, const RtYamlNode *node, const char *key, uint32_t count,
                         double *values);

/* A position: a point less the offset. */
RtStatus rt_yaml_position(const RtYaml *yaml, const RtYamlNode *node, const char *key, RtVec3 *value);

/* A list of at least `least` lists of `width` / 3 positions each, consecutively in *rows, a block of
 * `memory`; NULL if the key is missing. */
RtStatus rt_yaml_rows(const RtYaml *yaml, const RtYamlNode *node, const char *key, uint32_t least,
                      uint32_t width, RtArena *memory, float **rows, uint32_t *count);

/* An integer lo..hi in decimal digits without a sign. */
RtStatus rt_yaml_u32(const RtYaml *yaml, const RtYamlNode *node, const char *key, uint32_t lo, uint32_t hi,
                     uint32_t *value);
RtStatus rt_yaml_u64(const RtYaml *yaml, const RtYamlNode *node, const char *key, uint64_t lo, uint64_t hi,
                     uint64_t *value);

/* One of the words of `list` ("off on"); returns its index. */
RtStatus rt_yaml_word(const RtYaml *yaml, const RtYamlNode *node, const char *key, const char *list,
                      uint32_t *index);

/* A text of 1..most bytes that lives as long as `yaml`, or its null-terminated copy in out[0..size). */
RtStatus rt_yaml_text(const RtYaml *yaml, const RtYamlNode *node, const char *key, size_t most,
                      const char **text);
RtStatus rt_yaml_copy(const RtYaml *yaml, const RtYamlNode *node, const char *key, size_t size, char *out);

/* ---- messages ---- */

/* Fails with a message that begins with the position and the path of the node. */
RtStatus rt_yaml_fail(const RtYaml *yaml, const RtYamlNode *node, const char *format, ...)
    __attribute__((format(printf, 3, 4)));

/* Prefixes the message of yaml->error with the position and path of `key` in `mapping` (of the mapping
 * itself if the key is NULL or missing), and returns `status`. RT_OK and RT_NO_MEMORY change nothing. */
RtStatus rt_yaml_place(const RtYaml *yaml, RtStatus status, const RtYamlNode *mapping, const char *key);

/* For clang's analyzer, as in status.h. */
#ifdef __clang_analyzer__
#define rt_yaml_fail(yaml, node, ...) (rt_yaml_fail(yaml, node, __VA_ARGS__), RT_BAD_INPUT)
#endif

#endif
