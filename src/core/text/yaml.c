/* SPDX-License-Identifier: Apache-2.0 */
/* The tree is built in one loop over the events, with a stack of open nodes. Until a node is closed its
 * size means "everything that follows". So the path of a node can be computed at any time by descending
 * from the root; nothing is stored for messages. */
#include "core/text/yaml.h"

#include "core/base/file.h"
#include "core/base/memory.h"
#include "core/base/words.h"

#include <stdarg.h>
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
    if (b->depth == RT_YAML_MAX_DEPTH) {
        return rt_yaml_fail(b->yaml, node, "lists and mappings are nested more than %d deep here",
                            RT_YAML_MAX_DEPTH);
    }
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
    if (b->event.type == YAML_STREAM_END_EVENT) {
        return rt_fail_at(b->yaml->error, b->yaml->path, 1, 0, "the file is empty");
    }
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
    if (length > RT_YAML_MAX_BYTES) {
        return rt_fail_at(error, name, 0, 0, "the file has %zu bytes: the limit is %d", length,
                          RT_YAML_MAX_BYTES);
    }
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
