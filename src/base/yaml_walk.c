/* One recursive descent over libyaml's events, led by the schema, so its depth is the schema's whatever the
 * text nests. The path to the current value is a stack of keys and indices, written out only for messages and
 * comparisons. */
#include "base/yaml_walk.h"

#include "base/words.h"

#include <assert.h>
#include <errno.h>
#include <math.h>
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <yaml.h>

typedef struct Step {
    const char *key; /* or NULL: an entry of a list */
    uint32_t index;
} Step;

typedef struct Walk {
    const RtYamlFile *file;
    yaml_parser_t parser;
    yaml_event_t event; /* the current one */
    Step path[RT_YAML_MAX_DEPTH];
    int depth;
    RtError *error;
    const char *target; /* the path looked for, or NULL in a check */
    size_t found;       /* characters of the target matched by the best place so far */
    yaml_mark_t place;  /* that place */
} Walk;

enum { PATH_CHARS = 512, TEXT_CHARS = 60 };

/* ---- paths, places, failures ---- */

static void write_path(const Walk *walk, char *out, size_t room) {
    size_t used = 0;
    out[0] = '\0';
    for (int i = 0; i < walk->depth && used < room; i++) {
        const Step *step = &walk->path[i];
        int n = step->key ? snprintf(out + used, room - used, "%s%s", i ? "." : "", step->key)
                          : snprintf(out + used, room - used, "[%u]", step->index);
        used += (size_t)n;
    }
}

/* Fails at `mark`, about the value at the current path. */
static RtStatus fail(Walk *walk, yaml_mark_t mark, const char *message) {
    char path[PATH_CHARS];
    write_path(walk, path, sizeof path);
    return rt_fail_at(walk->error, walk->file->path, mark.line + 1, mark.column + 1, "%s%s%s", path,
                      path[0] ? ": " : "", message);
}

/* Remembers `mark` if the current path is a longer beginning of the target than any before. */
static void note_place(Walk *walk, yaml_mark_t mark) {
    if (!walk->target) return;
    char path[PATH_CHARS];
    write_path(walk, path, sizeof path);
    size_t length = strlen(path);
    if (length <= walk->found || strncmp(walk->target, path, length) != 0) return;
    char next = walk->target[length];
    if (next != '\0' && next != '.' && next != '[') return;
    walk->found = length;
    walk->place = mark;
}

static RtStatus next_event(Walk *walk) {
    yaml_event_delete(&walk->event);
    yaml_parser_t *parser = &walk->parser;
    if (yaml_parser_parse(parser, &walk->event)) {
        if (walk->event.type != YAML_ALIAS_EVENT) return RT_OK;
        return fail(walk, walk->event.start_mark, "aliases (*name) are not supported: write the value out");
    }
    if (parser->error == YAML_MEMORY_ERROR) return rt_fail_memory(walk->error, "parsing YAML", 0);
    const char *problem = parser->problem ? parser->problem : "unknown fault";
    if (parser->error == YAML_READER_ERROR) { /* has an offset, no mark */
        return rt_fail_at(walk->error, walk->file->path, parser->mark.line + 1, parser->mark.column + 1,
                          "this is not text in UTF-8 (%s, byte %zu)", problem, parser->problem_offset);
    }
    return rt_fail_at(walk->error, walk->file->path, parser->problem_mark.line + 1,
                      parser->problem_mark.column + 1, "this is not YAML: %s%s%s", problem,
                      parser->context ? " " : "", parser->context ? parser->context : "");
}

/* ---- what is expected, what is there ---- */

static void describe_expected(const cyaml_schema_value_t *schema, char *out, size_t room) {
    size_t used = 0;
    switch (schema->type) {
    case CYAML_FLOAT: snprintf(out, room, "a number, as in 1.5"); return;
    case CYAML_UINT: snprintf(out, room, "a whole number of at least 0"); return;
    case CYAML_STRING: snprintf(out, room, "a text"); return;
    case CYAML_SEQUENCE_FIXED:
        snprintf(out, room, "a list of %u %s, as in [1, 2%s]", schema->sequence.max,
                 schema->sequence.entry->type == CYAML_SEQUENCE_FIXED ? "lists" : "numbers",
                 schema->sequence.max > 2 ? ", 3" : "");
        return;
    case CYAML_SEQUENCE: snprintf(out, room, "a list"); return;
    case CYAML_MAPPING:
        used = (size_t)snprintf(out, room, "the keys ");
        for (const cyaml_schema_field_t *f = schema->mapping.fields; f->key && used < room; f++) {
            used += (size_t)snprintf(out + used, room - used, "%s%s", f == schema->mapping.fields ? "" : ", ",
                                     f->key);
        }
        return;
    default: assert(false && "a type that schemas here do not use"); return;
    }
}

static RtStatus fail_unexpected(Walk *walk, const cyaml_schema_value_t *schema) {
    char expected[PATH_CHARS], message[2 * PATH_CHARS], found[TEXT_CHARS + 8];
    describe_expected(schema, expected, sizeof expected);
    const yaml_event_t *event = &walk->event;
    if (event->type == YAML_SCALAR_EVENT && event->data.scalar.length > 0) {
        snprintf(found, sizeof found, "'%.*s'", TEXT_CHARS, (const char *)event->data.scalar.value);
    } else {
        snprintf(found, sizeof found, "%s",
                 event->type == YAML_SCALAR_EVENT           ? "nothing"
                 : event->type == YAML_SEQUENCE_START_EVENT ? "a list"
                                                            : "a mapping");
    }
    snprintf(message, sizeof message, "%s found where %s should be", found, expected);
    return fail(walk, event->start_mark, message);
}

/* ---- values ---- */

/* True if all of `text` is a finite number that float32 (or double, by `size`) can hold. */
static bool is_finite_number(const char *text, size_t size) {
    char *end;
    double value = size == sizeof(float) ? (double)strtof(text, &end) : strtod(text, &end);
    return end != text && *end == '\0' && isfinite(value);
}

static bool is_unsigned(const char *text, size_t size) {
    if (text[0] < '0' || text[0] > '9' || (text[0] == '0' && text[1] != '\0')) return false;
    char *end;
    errno = 0;
    unsigned long long value = strtoull(text, &end, 10);
    return *end == '\0' && errno == 0 && value <= UINT64_MAX >> (64 - 8 * size);
}

static RtStatus check_text(Walk *walk, const cyaml_schema_value_t *schema) {
    const yaml_event_t *event = &walk->event;
    size_t length = event->data.scalar.length;
    char message[PATH_CHARS];
    for (size_t i = 0; i < length; i++) {
        unsigned char c = event->data.scalar.value[i];
        if (c < ' ' || c == 0x7f) {
            return fail(walk, event->start_mark, "the text has a control character in it: leave it out");
        }
    }
    if (length < schema->string.min || length > schema->string.max) {
        snprintf(message, sizeof message, "the text has %zu characters, must have %u..%u", length,
                 schema->string.min, schema->string.max);
        return fail(walk, event->start_mark, message);
    }
    return RT_OK;
}

static RtStatus check_scalar(Walk *walk, const cyaml_schema_value_t *schema) {
    if (walk->event.type != YAML_SCALAR_EVENT) return fail_unexpected(walk, schema);
    const char *text = (const char *)walk->event.data.scalar.value;
    if (strlen(text) != walk->event.data.scalar.length) {
        return fail(walk, walk->event.start_mark, "the value has a zero byte in it: leave it out");
    }
    char message[PATH_CHARS];
    switch (schema->type) {
    case CYAML_STRING: return check_text(walk, schema);
    case CYAML_UINT:
        if (is_unsigned(text, schema->data_size)) return RT_OK;
        snprintf(message, sizeof message, "'%.*s' is not a whole number from 0 to %llu", TEXT_CHARS, text,
                 (unsigned long long)(UINT64_MAX >> (64 - 8 * schema->data_size)));
        return fail(walk, walk->event.start_mark, message);
    case CYAML_FLOAT:
        if (is_finite_number(text, schema->data_size)) return RT_OK;
        snprintf(message, sizeof message, "'%.*s' is not a finite number%s: give one, as in 1.5", TEXT_CHARS,
                 text, schema->data_size == sizeof(float) ? " that fits float32" : "");
        return fail(walk, walk->event.start_mark, message);
    default: assert(false && "a type that schemas here do not use"); return RT_BAD_INPUT;
    }
}

static RtStatus check_value(Walk *walk, const cyaml_schema_value_t *schema);

static RtStatus check_sequence(Walk *walk, const cyaml_schema_value_t *schema) {
    if (walk->event.type != YAML_SEQUENCE_START_EVENT) return fail_unexpected(walk, schema);
    yaml_mark_t start = walk->event.start_mark;
    char message[PATH_CHARS];
    uint32_t count = 0;
    for (;; count++) {
        RT_TRY(next_event(walk));
        if (walk->event.type == YAML_SEQUENCE_END_EVENT) break;
        if (count == schema->sequence.max) {
            snprintf(message, sizeof message, "the list has more than %u entries", schema->sequence.max);
            return fail(walk, walk->event.start_mark, message);
        }
        walk->path[walk->depth++] = (Step){NULL, count};
        note_place(walk, walk->event.start_mark);
        RT_TRY(check_value(walk, schema->sequence.entry));
        walk->depth--;
    }
    if (count >= schema->sequence.min) return RT_OK;
    snprintf(message, sizeof message, "the list has %u entries, must have at least %u", count,
             schema->sequence.min);
    return fail(walk, start, message);
}

/* The index of the current event's key in `fields`; `seen` has a bit for each key that came before. */
static RtStatus check_key(Walk *walk, const cyaml_schema_field_t *fields, uint32_t *seen, uint32_t *index) {
    const yaml_event_t *event = &walk->event;
    char message[PATH_CHARS];
    if (event->type != YAML_SCALAR_EVENT) return fail(walk, event->start_mark, "a key must be a plain word");
    const char *key = (const char *)event->data.scalar.value, *names[RT_YAML_MAX_KEYS];
    uint32_t count = 0;
    for (; fields[count].key; count++) {
        assert(count < RT_YAML_MAX_KEYS);
        names[count] = fields[count].key;
        if (strcmp(fields[count].key, key) != 0) continue;
        *index = count;
        if (!(*seen & 1u << count)) {
            *seen |= 1u << count;
            return RT_OK;
        }
        snprintf(message, sizeof message, "'%s' is given twice: remove one", key);
        return fail(walk, event->start_mark, message);
    }
    char list[PATH_CHARS / 2], suggestion[RT_MAX_SUGGESTION] = "";
    rt_join_names(names, count, list, sizeof list);
    if (strlen(key) < TEXT_CHARS) rt_suggest(key, names, count, suggestion);
    snprintf(message, sizeof message, "unknown key '%.*s'%s%s%s", TEXT_CHARS, key, suggestion,
             *suggestion ? " The keys are: " : ": the keys are ", list);
    return fail(walk, event->start_mark, message);
}

static RtStatus check_mapping(Walk *walk, const cyaml_schema_value_t *schema, yaml_mark_t named_at) {
    if (walk->event.type != YAML_MAPPING_START_EVENT) return fail_unexpected(walk, schema);
    const cyaml_schema_field_t *fields = schema->mapping.fields;
    uint32_t seen = 0;
    for (;;) {
        RT_TRY(next_event(walk));
        if (walk->event.type == YAML_MAPPING_END_EVENT) break;
        uint32_t index = 0;
        yaml_mark_t key_mark = walk->event.start_mark;
        RT_TRY(check_key(walk, fields, &seen, &index));
        RT_TRY(next_event(walk));
        walk->path[walk->depth++] = (Step){fields[index].key, 0};
        bool scalar = walk->event.type == YAML_SCALAR_EVENT;
        note_place(walk, scalar ? walk->event.start_mark : key_mark);
        RT_TRY(fields[index].value.type == CYAML_MAPPING ? check_mapping(walk, &fields[index].value, key_mark)
                                                         : check_value(walk, &fields[index].value));
        walk->depth--;
    }
    for (uint32_t i = 0; fields[i].key; i++) {
        if (seen & 1u << i || fields[i].value.flags & CYAML_FLAG_OPTIONAL) continue;
        char message[PATH_CHARS];
        snprintf(message, sizeof message, "'%s' is missing: add it", fields[i].key);
        return fail(walk, named_at, message);
    }
    return RT_OK;
}

static RtStatus check_value(Walk *walk, const cyaml_schema_value_t *schema) {
    assert(walk->depth < RT_YAML_MAX_DEPTH);
    switch (schema->type) {
    case CYAML_MAPPING: return check_mapping(walk, schema, walk->event.start_mark);
    case CYAML_SEQUENCE:
    case CYAML_SEQUENCE_FIXED: return check_sequence(walk, schema);
    default: return check_scalar(walk, schema);
    }
}

/* ---- the document ---- */

static RtStatus check_document(Walk *walk) {
    RT_TRY(next_event(walk)); /* start of stream */
    RT_TRY(next_event(walk));
    if (walk->event.type == YAML_STREAM_END_EVENT) {
        return rt_fail_at(walk->error, walk->file->path, 1, 0, "the file is empty");
    }
    RT_TRY(next_event(walk));
    RT_TRY(check_value(walk, walk->file->schema));
    RT_TRY(next_event(walk)); /* end of document */
    RT_TRY(next_event(walk));
    if (walk->event.type == YAML_STREAM_END_EVENT) return RT_OK;
    return fail(walk, walk->event.start_mark, "a second document begins here: keep one in a file");
}

static RtStatus run(Walk *walk) {
    if (!yaml_parser_initialize(&walk->parser)) return rt_fail_memory(walk->error, "parsing YAML", 0);
    yaml_parser_set_input_string(&walk->parser, (const unsigned char *)walk->file->text, walk->file->length);
    RtStatus status = check_document(walk);
    yaml_event_delete(&walk->event);
    yaml_parser_delete(&walk->parser);
    return status;
}

RtStatus rt_yaml_check(const RtYamlFile *file, RtError *error) {
    Walk walk = {.file = file, .error = error};
    return run(&walk);
}

void rt_yaml_locate(const RtYamlFile *file, const char *where, size_t *line, size_t *column) {
    Walk walk = {.file = file, .target = where};
    run(&walk);
    *line = walk.place.line + 1;
    *column = walk.place.column + 1;
}
