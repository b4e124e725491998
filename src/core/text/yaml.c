/* SPDX-License-Identifier: Apache-2.0 */
/* The tree is built in one loop over the events, with a stack of open nodes. Until a node is closed its
 * size means "everything that follows". So the path of a node can be computed at any time by descending
 * from the root; nothing is stored for messages. */
#include "core/text/yaml.h"

#include "core/base/file.h"
#include "core/base/versions.h"
#include "core/base/words.h"

#include <assert.h>
#include <errno.h>
#include <inttypes.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <yaml.h>

enum { MAX_CHARS = 512 };

/* ---- places ---- */

/* "objects[3].sphere.radius"; for a key, the path of its mapping. */
static void write_path(const RtYaml *yaml, const RtYamlNode *target, char out[MAX_CHARS]) {
    out[0] = '\0';
    for (const RtYamlNode *node = yaml->nodes; node != target;) {
        const RtYamlNode *child = node + 1;
        uint32_t i = 0;
        for (; (uint32_t)(target - child) >= child->size; child += child->size) i++;
        bool mapping = node->kind == RT_YAML_MAPPING;
        if (mapping && i % 2 == 0) return;
        if (mapping)
            rt_append_text(out, MAX_CHARS, "%s%.40s", *out ? "." : "", rt_yaml_text_of(yaml, child - 1));
        else
            rt_append_text(out, MAX_CHARS, "[%u]", i);
        node = child;
    }
}

static RtStatus fail_with(const RtYaml *yaml, const RtYamlNode *node, const char *message) {
    char path[MAX_CHARS];
    write_path(yaml, node, path);
    return rt_fail_at(yaml->error, yaml->path, node->line, node->column, "%s%s%s", path, *path ? ": " : "",
                      message);
}

RtStatus(rt_yaml_fail)(const RtYaml *yaml, const RtYamlNode *node, const char *format, ...) {
    char message[sizeof yaml->error->message];
    va_list arguments;
    va_start(arguments, format);
    /* clang-tidy 14 does not see va_start. NOLINTNEXTLINE(clang-analyzer-valist.Uninitialized) */
    vsnprintf(message, sizeof message, format, arguments);
    va_end(arguments);
    return fail_with(yaml, node, message);
}

const RtYamlNode *rt_yaml_get(const RtYaml *yaml, const RtYamlNode *mapping, const char *key) {
    if (mapping->kind != RT_YAML_MAPPING) return NULL;
    for (const RtYamlNode *k = mapping + 1; k != mapping + mapping->size; k += 1 + k[1].size) {
        if (strcmp(rt_yaml_text_of(yaml, k), key) == 0) return k + 1;
    }
    return NULL;
}

RtStatus rt_yaml_place(const RtYaml *yaml, RtStatus status, const RtYamlNode *mapping, const char *key) {
    if (!yaml->error || status == RT_OK || status == RT_NO_MEMORY) return status;
    const RtYamlNode *node = key ? rt_yaml_get(yaml, mapping, key) : NULL;
    RtError inner = *yaml->error;
    fail_with(yaml, node ? node : mapping, inner.message);
    yaml->error->status = status;
    return status;
}

/* ---- from events to nodes ---- */

typedef struct Builder {
    RtYaml *yaml;
    const char *text; /* all of it */
    yaml_parser_t parser;
    yaml_event_t event;               /* the current one */
    uint32_t open[RT_YAML_MAX_DEPTH]; /* the open lists and mappings */
    uint32_t depth;
} Builder;

/* Fails at byte `offset` of the text. */
static RtStatus fail_at_byte(const Builder *b, size_t offset, const char *message) {
    size_t line = 1, start = 0;
    for (size_t i = 0; i < offset; i++) {
        if (b->text[i] != '\n') continue;
        line++;
        start = i + 1;
    }
    return rt_fail_at(b->yaml->error, b->yaml->path, line, offset - start + 1, "%s", message);
}

static RtStatus next_event(Builder *b) {
    yaml_event_delete(&b->event);
    yaml_parser_t *parser = &b->parser;
    if (yaml_parser_parse(parser, &b->event)) return RT_OK;
    if (parser->error == YAML_MEMORY_ERROR) return rt_fail_memory(b->yaml->error, "parsing YAML", 0);
    const char *problem = parser->problem ? parser->problem : "unknown fault";
    if (parser->error == YAML_READER_ERROR) { /* it reads ahead, so its mark is not the position */
        char message[MAX_CHARS];
        snprintf(message, sizeof message, "this is not text in UTF-8: %s", problem);
        return fail_at_byte(b, parser->problem_offset, message);
    }
    return rt_fail_at(b->yaml->error, b->yaml->path, parser->problem_mark.line + 1,
                      parser->problem_mark.column + 1, "this is not YAML: %s%s%s", problem,
                      parser->context ? " " : "", parser->context ? parser->context : "");
}

/* Adds a node for the current event below the innermost open node. */
static RtStatus add_node(Builder *b, RtYamlKind kind, RtYamlNode **added) {
    RtYaml *yaml = b->yaml;
    yaml_mark_t mark = b->event.start_mark;
    RT_TRY(rt_reserve(&yaml->nodes, &yaml->node_capacity, (uint64_t)yaml->node_count + 1, sizeof *yaml->nodes,
                      yaml->error));
    RtYamlNode *node = *added = &yaml->nodes[yaml->node_count++];
    *node = (RtYamlNode){.size = kind == RT_YAML_SCALAR ? 1 : UINT32_MAX,
                         .line = (uint32_t)mark.line + 1,
                         .column = (uint32_t)(mark.column + 1) & 0x3fffffff,
                         .kind = kind & 3};
    if (b->depth == 0) return RT_OK;
    RtYamlNode *parent = &yaml->nodes[b->open[b->depth - 1]];
    bool key = parent->kind == RT_YAML_MAPPING && parent->count++ % 2 == 0;
    if (parent->kind == RT_YAML_LIST) parent->count++;
    if (kind == RT_YAML_SCALAR) return RT_OK;
    if (key) return rt_yaml_fail(yaml, node, "a key must be a plain word");
    if (parent->kind == RT_YAML_MAPPING) {
        node->line = node[-1].line;
        node->column = node[-1].column;
    }
    return RT_OK;
}

static RtStatus add_scalar(Builder *b) {
    RtYaml *yaml = b->yaml;
    RtYamlNode *node;
    const unsigned char *value = b->event.data.scalar.value;
    size_t length = b->event.data.scalar.length;
    RT_TRY(rt_reserve(&yaml->text, &yaml->text_capacity, (uint64_t)yaml->text_size + length + 1, 1,
                      yaml->error));
    RT_TRY(add_node(b, RT_YAML_SCALAR, &node));
    for (size_t i = 0; i < length; i++) {
        if (value[i] == '\0') return rt_yaml_fail(yaml, node, "the value contains a zero byte: remove it");
        if (value[i] >= ' ' && value[i] != 0x7f) continue;
        return rt_yaml_fail(yaml, node, "the text contains a control character: remove it");
    }
    node->text = yaml->text_size;
    memcpy(yaml->text + node->text, value, length + 1);
    yaml->text_size += (uint32_t)length + 1;
    return RT_OK;
}

static RtStatus open_node(Builder *b, RtYamlKind kind) {
    RtYamlNode *node;
    RT_TRY(add_node(b, kind, &node));
    if (b->depth == RT_YAML_MAX_DEPTH)
        return rt_yaml_fail(b->yaml, node, "lists and mappings are nested more than %d deep here",
                            RT_YAML_MAX_DEPTH);
    b->open[b->depth++] = b->yaml->node_count - 1;
    return RT_OK;
}

static RtStatus add_event(Builder *b) {
    RtYamlNode *node;
    switch (b->event.type) {
    case YAML_SCALAR_EVENT: return add_scalar(b);
    case YAML_SEQUENCE_START_EVENT: return open_node(b, RT_YAML_LIST);
    case YAML_MAPPING_START_EVENT: return open_node(b, RT_YAML_MAPPING);
    case YAML_ALIAS_EVENT:
        RT_TRY(add_node(b, RT_YAML_SCALAR, &node));
        return rt_yaml_fail(b->yaml, node, "aliases (*name) are not supported: write the value out");
    default: /* the end of the innermost open node */
        node = &b->yaml->nodes[b->open[--b->depth]];
        node->size = (uint32_t)(b->yaml->nodes + b->yaml->node_count - node);
        return RT_OK;
    }
}

static RtStatus add_document(Builder *b) {
    RT_TRY(next_event(b)); /* start of stream */
    RT_TRY(next_event(b));
    if (b->event.type == YAML_STREAM_END_EVENT)
        return rt_fail_at(b->yaml->error, b->yaml->path, 1, 0, "the file is empty");
    do {
        RT_TRY(next_event(b));
        RT_TRY(add_event(b));
    } while (b->depth > 0);
    RT_TRY(next_event(b)); /* end of document */
    RT_TRY(next_event(b));
    if (b->event.type == YAML_STREAM_END_EVENT) return RT_OK;
    return rt_fail_at(b->yaml->error, b->yaml->path, b->event.start_mark.line + 1,
                      b->event.start_mark.column + 1, "a second document begins here: a file holds one");
}

/* libyaml compares each %TAG with all earlier ones, so a file of them would take quadratic time. They
 * stand at the beginning of a line, and non-ASCII characters may end lines, too. */
static RtStatus refuse_directives(const Builder *b, size_t length) {
    const char *at = b->text, *end = b->text + length;
    for (; (at = memmem(at, (size_t)(end - at), "%TAG", 4)); at++) {
        if (at > b->text && (unsigned char)at[-1] >= ' ' && (unsigned char)at[-1] < 0x80) continue;
        return fail_at_byte(b, (size_t)(at - b->text), "%TAG is not supported: remove it and the tags");
    }
    return RT_OK;
}

RtStatus rt_yaml_parse(RtYaml *yaml, const char *name, const char *text, size_t length, RtError *error) {
    *yaml = (RtYaml){.path = name, .error = error};
    Builder b = {.yaml = yaml, .text = text};
    if (length > RT_YAML_MAX_BYTES)
        return rt_fail_at(error, name, 0, 0, "the file has %zu bytes: the limit is %d", length,
                          RT_YAML_MAX_BYTES);
    RT_TRY(refuse_directives(&b, length));
    if (!yaml_parser_initialize(&b.parser)) return rt_fail_memory(error, "parsing YAML", 0);
    yaml_parser_set_encoding(&b.parser, YAML_UTF8_ENCODING);
    yaml_parser_set_input_string(&b.parser, (const unsigned char *)text, length);
    RtStatus status = add_document(&b);
    yaml_event_delete(&b.event);
    yaml_parser_delete(&b.parser);
    if (status != RT_OK) rt_yaml_close(yaml);
    return status;
}

RtStatus rt_yaml_open(RtYaml *yaml, const char *path, RtError *error) {
    char *text;
    size_t length;
    RT_TRY(rt_file_read_text(path, RT_YAML_MAX_BYTES, &text, &length, error));
    RtStatus status = rt_yaml_parse(yaml, path, text, length, error);
    rt_free(text);
    return status;
}

void rt_yaml_close(RtYaml *yaml) {
    rt_free(yaml->nodes);
    rt_free(yaml->text);
    *yaml = (RtYaml){0};
}

/* ==== values ==== */

enum { MAX_WORDS = 32 };

/* ---- words ---- */

/* A list of words, split. */
typedef struct Words {
    char text[MAX_CHARS];
    const char *names[MAX_WORDS]; /* without the suffixes ? and | */
    uint32_t count;
    uint32_t required, choice; /* bit i: names[i] had no suffix, or | */
} Words;

static void split(const char *list, Words *words) {
    size_t length = strlen(list);
    assert(length < MAX_CHARS);
    memcpy(words->text, list, length + 1);
    words->count = words->required = words->choice = 0;
    for (char *c = words->text; *c;) {
        assert(words->count < MAX_WORDS);
        uint32_t bit = UINT32_C(1) << words->count;
        words->names[words->count++] = c;
        c += strcspn(c, "?| ");
        if (*c == '|') words->choice |= bit;
        if (*c == ' ' || *c == '\0') words->required |= bit;
        while (*c && strchr("?| ", *c)) *c++ = '\0';
    }
}

static uint32_t find_word(const Words *words, const char *word) {
    uint32_t i = 0;
    while (i < words->count && strcmp(words->names[i], word) != 0) i++;
    return i;
}

/* ---- mappings and lists ---- */

static RtStatus fail_unexpected(const RtYaml *yaml, const RtYamlNode *node, const char *expected) {
    const char *text = node->kind == RT_YAML_SCALAR ? rt_yaml_text_of(yaml, node) : "";
    if (*text) return rt_yaml_fail(yaml, node, "invalid value '%.60s': expected %s", text, expected);
    static const char *const kinds[] = {"nothing", "a list", "a mapping"};
    return rt_yaml_fail(yaml, node, "expected %s, found %s", expected, kinds[node->kind]);
}

static RtStatus fail_unknown(const RtYaml *yaml, const RtYamlNode *key, const Words *words) {
    char list[MAX_CHARS], suggestion[RT_MAX_SUGGESTION];
    rt_join_names(words->names, words->count, list, sizeof list);
    rt_suggest(rt_yaml_text_of(yaml, key), words->names, words->count, suggestion);
    return rt_yaml_fail(yaml, key, "unknown key '%.60s'%s%s%s", rt_yaml_text_of(yaml, key), suggestion,
                        *suggestion ? " The keys are: " : ": the keys are ", list);
}

static RtStatus check_choice(const RtYaml *yaml, const RtYamlNode *node, const Words *words, uint32_t seen) {
    char list[MAX_CHARS];
    const char *names[MAX_WORDS];
    uint32_t count = 0, given = 0;
    for (uint32_t i = 0; i < words->count; i++) {
        if (!(words->choice >> i & 1)) continue;
        names[count++] = words->names[i];
        given += seen >> i & 1;
    }
    if (count == 0 || given == 1) return RT_OK;
    rt_join_names(names, count, list, sizeof list);
    return rt_yaml_fail(yaml, node, "expected exactly one of %s, found %u of them: write one per entry", list,
                        given);
}

RtStatus rt_yaml_keys(const RtYaml *yaml, const RtYamlNode *node, const char *keys) {
    char list[MAX_CHARS], expected[MAX_CHARS + 16];
    Words words;
    split(keys, &words);
    if (node->kind != RT_YAML_MAPPING) {
        rt_join_names(words.names, words.count, list, sizeof list);
        snprintf(expected, sizeof expected, "the keys %s", list);
        return fail_unexpected(yaml, node, expected);
    }
    uint32_t seen = 0;
    for (const RtYamlNode *key = node + 1; key != node + node->size; key += 1 + key[1].size) {
        uint32_t i = find_word(&words, rt_yaml_text_of(yaml, key));
        if (i == words.count) return fail_unknown(yaml, key, &words);
        if (seen >> i & 1) return rt_yaml_fail(yaml, key, "'%s' is given twice: remove one", words.names[i]);
        seen |= UINT32_C(1) << i;
    }
    for (uint32_t i = 0; i < words.count; i++) {
        if (!((words.required & ~seen) >> i & 1)) continue;
        return rt_yaml_fail(yaml, node, "'%s' is missing: add it", words.names[i]);
    }
    return check_choice(yaml, node, &words, seen);
}

static const RtYamlNode *value_of(const RtYaml *yaml, const RtYamlNode *node, const char *key) {
    return key ? rt_yaml_get(yaml, node, key) : node;
}

RtStatus rt_yaml_list(const RtYaml *yaml, const RtYamlNode *node, const char *key, uint32_t least,
                      uint32_t most, const char *what) {
    const RtYamlNode *list = value_of(yaml, node, key);
    if (!list) return RT_OK;
    if (list->kind != RT_YAML_LIST) {
        char expected[MAX_CHARS], number[16] = "";
        if (least == most) snprintf(number, sizeof number, "%u ", least);
        snprintf(expected, sizeof expected, "a list of %s%s", number, what);
        return fail_unexpected(yaml, list, expected);
    }
    if (list->count < least)
        return rt_yaml_fail(yaml, list, "the length of the list is %u: expected at least %u", list->count,
                            least);
    if (list->count <= most) return RT_OK;
    const RtYamlNode *extra = list + 1;
    for (uint32_t i = 0; i < most; i++) extra += extra->size;
    return rt_yaml_fail(yaml, extra, "the list has more than %u entries", most);
}

/* ---- numbers ---- */

/* Stores to whichever of the two is not NULL; a float32 less `offset`. */
static RtStatus read_number(const RtYaml *yaml, const RtYamlNode *node, double offset, float *narrow,
                            double *wide) {
    if (!node) return RT_OK;
    if (node->kind != RT_YAML_SCALAR) return fail_unexpected(yaml, node, "a number, as in 1.5");
    const char *text = rt_yaml_text_of(yaml, node);
    char *end;
    double value = narrow && offset == 0 ? (double)strtof(text, &end) : strtod(text, &end);
    if (narrow) value = (double)(float)(value - offset);
    if (end == text || *end || !isfinite(value))
        return rt_yaml_fail(yaml, node, "invalid value '%.60s': expected a finite number%s, as in 1.5", text,
                            narrow ? " that fits float32" : "");
    if (narrow) *narrow = (float)value;
    if (wide) *wide = value;
    return RT_OK;
}

/* Positions have an offset. */
static RtStatus read_numbers(const RtYaml *yaml, const RtYamlNode *list, uint32_t count,
                             const RtVec3d *offset, float *narrow, double *wide) {
    const char *what = count == 3 ? "numbers, as in [1, 2, 3]" : "numbers";
    uint32_t i = 0;
    RT_TRY(rt_yaml_list(yaml, list, NULL, count, count, what));
    for (const RtYamlNode *n = rt_yaml_first(list); n != rt_yaml_end(list); n += n->size) {
        RT_TRY(read_number(yaml, n, offset ? offset->at[i++ % 3] : 0, narrow, wide));
        if (narrow) narrow++;
        if (wide) wide++;
    }
    return RT_OK;
}

RtStatus rt_yaml_float(const RtYaml *yaml, const RtYamlNode *node, const char *key, float *value) {
    return read_number(yaml, value_of(yaml, node, key), 0, value, NULL);
}

RtStatus rt_yaml_double(const RtYaml *yaml, const RtYamlNode *node, const char *key, double *value) {
    return read_number(yaml, value_of(yaml, node, key), 0, NULL, value);
}

RtStatus rt_yaml_point(const RtYaml *yaml, const RtYamlNode *node, const char *key, RtVec3 *value) {
    return read_numbers(yaml, value_of(yaml, node, key), 3, NULL, value->at, NULL);
}

RtStatus rt_yaml_position(const RtYaml *yaml, const RtYamlNode *node, const char *key, RtVec3 *value) {
    return read_numbers(yaml, value_of(yaml, node, key), 3, &yaml->offset, value->at, NULL);
}

RtStatus rt_yaml_doubles(const RtYaml *yaml, const RtYamlNode *node, const char *key, uint32_t count,
                         double *values) {
    return read_numbers(yaml, value_of(yaml, node, key), count, NULL, NULL, values);
}

RtStatus rt_yaml_rows(const RtYaml *yaml, const RtYamlNode *node, const char *key, uint32_t least,
                      uint32_t width, RtArena *memory, float **rows, uint32_t *count) {
    const RtYamlNode *list = value_of(yaml, node, key);
    *rows = NULL;
    *count = rt_yaml_count(list);
    RT_TRY(rt_yaml_list(yaml, list, NULL, least, UINT32_MAX, "lists of numbers"));
    if (!list) return RT_OK;
    float *row = *rows = rt_arena_alloc(memory, list->count, width * sizeof *row);
    RT_TRY(rt_arena_check(memory, "lists of numbers", yaml->error));
    for (const RtYamlNode *n = rt_yaml_first(list); n != rt_yaml_end(list); n += n->size, row += width)
        RT_TRY(read_numbers(yaml, n, width, &yaml->offset, row, NULL));
    return RT_OK;
}

RtStatus rt_yaml_u64(const RtYaml *yaml, const RtYamlNode *node, const char *key, uint64_t lo, uint64_t hi,
                     uint64_t *value) {
    if (!(node = value_of(yaml, node, key))) return RT_OK;
    if (node->kind != RT_YAML_SCALAR) return fail_unexpected(yaml, node, "a whole number");
    const char *text = rt_yaml_text_of(yaml, node);
    char *end = NULL;
    errno = 0;
    uint64_t given = text[0] >= '0' && text[0] <= '9' ? strtoull(text, &end, 10) : 0;
    bool padded = text[0] == '0' && text[1]; /* ambiguous: octal in YAML 1.1, decimal in 1.2 */
    if (end && !*end && !errno && !padded && given >= lo && given <= hi) {
        *value = given;
        return RT_OK;
    }
    return rt_yaml_fail(yaml, node, "invalid value '%.60s': expected a whole number %llu..%llu", text,
                        (unsigned long long)lo, (unsigned long long)hi);
}

RtStatus rt_yaml_u32(const RtYaml *yaml, const RtYamlNode *node, const char *key, uint32_t lo, uint32_t hi,
                     uint32_t *value) {
    uint64_t given = *value;
    RT_TRY(rt_yaml_u64(yaml, node, key, lo, hi, &given));
    *value = (uint32_t)given;
    return RT_OK;
}

RtStatus rt_yaml_check_format(const RtYaml *yaml) {
    const RtYamlNode *root = yaml->nodes;
    uint64_t format = RT_FILE_FORMAT;
    RT_TRY(rt_yaml_u64(yaml, root, "format", 1, INT64_MAX, &format));
    if (format <= RT_FILE_FORMAT) return RT_OK;
    return rt_yaml_fail(yaml, rt_yaml_get(yaml, root, "format"), RT_FORMAT_UNKNOWN, (int64_t)format,
                        RT_FILE_FORMAT);
}

/* ---- words and texts ---- */

RtStatus rt_yaml_word(const RtYaml *yaml, const RtYamlNode *node, const char *key, const char *list,
                      uint32_t *index) {
    if (!(node = value_of(yaml, node, key))) return RT_OK;
    char expected[MAX_CHARS] = "", suggestion[RT_MAX_SUGGESTION];
    Words words;
    split(list, &words);
    for (uint32_t i = 0; i < words.count; i++)
        rt_append_text(expected, sizeof expected, "%s%s", i ? " or " : "", words.names[i]);
    if (node->kind != RT_YAML_SCALAR) return fail_unexpected(yaml, node, expected);
    *index = find_word(&words, rt_yaml_text_of(yaml, node));
    if (*index < words.count) return RT_OK;
    rt_suggest(rt_yaml_text_of(yaml, node), words.names, words.count, suggestion);
    return rt_yaml_fail(yaml, node, "invalid value '%.60s'%s%s expected %s", rt_yaml_text_of(yaml, node),
                        suggestion, *suggestion ? "" : ":", expected);
}

RtStatus rt_yaml_text(const RtYaml *yaml, const RtYamlNode *node, const char *key, size_t most,
                      const char **text) {
    if (!(node = value_of(yaml, node, key))) return RT_OK;
    if (node->kind != RT_YAML_SCALAR) return fail_unexpected(yaml, node, "text");
    *text = rt_yaml_text_of(yaml, node);
    size_t length = strlen(*text);
    if (length >= 1 && length <= most) return RT_OK;
    return rt_yaml_fail(yaml, node, "the text has %zu characters: expected 1..%zu", length, most);
}

RtStatus rt_yaml_copy(const RtYaml *yaml, const RtYamlNode *node, const char *key, size_t size, char *out) {
    const char *text = NULL;
    RT_TRY(rt_yaml_text(yaml, node, key, size - 1, &text));
    if (text) memcpy(out, text, strlen(text) + 1);
    return RT_OK;
}
