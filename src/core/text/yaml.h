/* SPDX-License-Identifier: Apache-2.0 */
/* YAML, read into a tree of nodes, and what its nodes say. Scenes and experiments are read by this alone.
 *
 * libyaml's events become nodes in the order of the text, 16 bytes each (libyaml's own documents take over
 * ten times as much, and grow with the square of their anchors). Every node knows its line and column, so
 * every complaint begins with its place and path: "FILE:LINE:COLUMN: objects[3].sphere.radius: ".
 *
 * Getters take a mapping, a key, and a place for the value. Where the key is not there they do nothing, so
 * that what was in the place is the default; what must be there is said once a mapping, by rt_yaml_keys.
 * Without a key (NULL) they take the node itself, an entry of a list. All complaints go to yaml->error. */
#ifndef RT_TEXT_YAML_H
#define RT_TEXT_YAML_H

#include "core/base/status.h"
#include "core/base/vec.h"

#include <stdint.h>

#define RT_YAML_MAX_BYTES 1000000000 /* of one file */
#define RT_YAML_MAX_DEPTH 32         /* of lists and mappings in one another */

typedef enum RtYamlKind { RT_YAML_SCALAR, RT_YAML_LIST, RT_YAML_MAPPING } RtYamlKind;

typedef struct RtYamlNode {
    uint32_t size; /* nodes of what is below, and this one: node + size is the next one beside it */
    union {
        uint32_t text;  /* of a scalar: where it begins in RtYaml.text */
        uint32_t count; /* of a list or mapping: nodes directly below it; keys and values are two */
    };
    uint32_t line;        /* from 1: its own, but of a list or mapping behind a key that of the key */
    uint32_t column : 30; /* from 1, of the same */
    uint32_t kind : 2;    /* an RtYamlKind */
} RtYamlNode;

typedef struct RtYaml {
    const char *path;  /* borrowed: for messages */
    RtError *error;    /* borrowed; may be NULL */
    RtYamlNode *nodes; /* owned, [node_count]; the first is the whole document, below which are all others */
    uint32_t node_count, node_capacity;
    char *text; /* owned, [text_size]: scalars in UTF-8 without control characters, each ended by a 0 */
    uint32_t text_size, text_capacity;
} RtYaml;

/* ---- reading ---- */

/* Reads text[0..length) of UTF-8, no longer needed afterwards; `name` stands for it in messages. Refuses what
 * is not YAML, empty or more than RT_YAML_MAX_BYTES long, more than one document, more than RT_YAML_MAX_DEPTH
 * levels, aliases (*name), %TAG directives, keys that are no words, and control characters. Takes time and
 * memory in proportion to `length`, whatever the text. On failure nothing is owned. */
RtStatus rt_yaml_parse(RtYaml *yaml, const char *name, const char *text, size_t length, RtError *error);

/* The same of the regular file at `path`. */
RtStatus rt_yaml_open(RtYaml *yaml, const char *path, RtError *error);

void rt_yaml_close(RtYaml *yaml);

/* ---- mappings and lists ---- */

/* Holds a mapping against the words of `keys`, in which "name" must be there, "name?" may be, and of all
 * "name|" exactly one is. Other keys are refused, with the one that was probably meant, and keys that come
 * twice. At most 32 words of together 511 characters. */
RtStatus rt_yaml_keys(const RtYaml *yaml, const RtYamlNode *node, const char *keys);

/* The value of `key` in a mapping; NULL if there is none. */
const RtYamlNode *rt_yaml_get(const RtYaml *yaml, const RtYamlNode *mapping, const char *key);

/* Refuses what is no list of least..most entries; `what` it has is for the message: "numbers". */
RtStatus rt_yaml_list(const RtYaml *yaml, const RtYamlNode *node, const char *key, uint32_t least,
                      uint32_t most, const char *what);

/* The text of a scalar, ended by a 0. */
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

/* Finite numbers, one or a list of 3 or `count`. Those of float32 must fit it. */
RtStatus rt_yaml_float(const RtYaml *yaml, const RtYamlNode *node, const char *key, float *value);
RtStatus rt_yaml_double(const RtYaml *yaml, const RtYamlNode *node, const char *key, double *value);
RtStatus rt_yaml_point(const RtYaml *yaml, const RtYamlNode *node, const char *key, RtVec3 *value);
RtStatus rt_yaml_doubles(const RtYaml *yaml, const RtYamlNode *node, const char *key, uint32_t count,
                         double *values);

/* A list of at least `least` lists of `width` numbers each, one after the other in *rows, which after success
 * is the caller's (rt_free). *rows is NULL where the key is not there. */
RtStatus rt_yaml_rows(const RtYaml *yaml, const RtYamlNode *node, const char *key, uint32_t least,
                      uint32_t width, float **rows, uint32_t *count);

/* A whole number lo..hi, in decimal digits without a sign. */
RtStatus rt_yaml_u32(const RtYaml *yaml, const RtYamlNode *node, const char *key, uint32_t lo, uint32_t hi,
                     uint32_t *value);
RtStatus rt_yaml_u64(const RtYaml *yaml, const RtYamlNode *node, const char *key, uint64_t lo, uint64_t hi,
                     uint64_t *value);

/* One of the words of `list`, "off on"; gives its index. */
RtStatus rt_yaml_word(const RtYaml *yaml, const RtYamlNode *node, const char *key, const char *list,
                      uint32_t *index);

/* A text of 1..most bytes, which lives as long as `yaml`; or its copy in out[0..room), with a 0 at its end.
 */
RtStatus rt_yaml_text(const RtYaml *yaml, const RtYamlNode *node, const char *key, size_t most,
                      const char **text);
RtStatus rt_yaml_copy(const RtYaml *yaml, const RtYamlNode *node, const char *key, size_t room, char *out);

/* ---- what is wrong with a value ---- */

/* Fails with a message that is led by the place and the path of the node. */
RtStatus rt_yaml_fail(const RtYaml *yaml, const RtYamlNode *node, const char *format, ...)
    __attribute__((format(printf, 3, 4)));

/* Puts place and path of `key` in `mapping` (of the mapping itself if there is none, or `key` is NULL) before
 * the message of yaml->error, and gives `status` back. RT_OK and RT_NO_MEMORY stay as they are. */
RtStatus rt_yaml_place(const RtYaml *yaml, RtStatus status, const RtYamlNode *mapping, const char *key);

/* For clang's analyzer, as in status.h. */
#ifdef __clang_analyzer__
#define rt_yaml_fail(yaml, node, ...) (rt_yaml_fail(yaml, node, __VA_ARGS__), RT_BAD_INPUT)
#endif

#endif
