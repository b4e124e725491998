/* SPDX-License-Identifier: Apache-2.0 */
/* Reading values from the nodes of a YAML tree, and the messages about wrong ones. */
#include "core/base/memory.h"
#include "core/base/versions.h"
#include "core/base/words.h"
#include "core/text/yaml.h"

#include <assert.h>
#include <errno.h>
#include <inttypes.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { MAX_WORDS = 32, MAX_CHARS = 512 };

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
    if (list->count < least) {
        return rt_yaml_fail(yaml, list, "the length of the list is %u: expected at least %u", list->count,
                            least);
    }
    if (list->count <= most) return RT_OK;
    const RtYamlNode *extra = list + 1;
    for (uint32_t i = 0; i < most; i++) extra += extra->size;
    return rt_yaml_fail(yaml, extra, "the list has more than %u entries", most);
}

/* ---- numbers ---- */

/* Stores to whichever of the two is not NULL. */
static RtStatus read_number(const RtYaml *yaml, const RtYamlNode *node, float *narrow, double *wide) {
    if (!node) return RT_OK;
    if (node->kind != RT_YAML_SCALAR) return fail_unexpected(yaml, node, "a number, as in 1.5");
    const char *text = rt_yaml_text_of(yaml, node);
    char *end;
    double value = narrow ? (double)strtof(text, &end) : strtod(text, &end);
    if (end == text || *end || !isfinite(value)) {
        return rt_yaml_fail(yaml, node, "invalid value '%.60s': expected a finite number%s, as in 1.5", text,
                            narrow ? " that fits float32" : "");
    }
    if (narrow) *narrow = (float)value;
    if (wide) *wide = value;
    return RT_OK;
}

static RtStatus read_numbers(const RtYaml *yaml, const RtYamlNode *list, uint32_t count, float *narrow,
                             double *wide) {
    const char *what = count == 3 ? "numbers, as in [1, 2, 3]" : "numbers";
    RT_TRY(rt_yaml_list(yaml, list, NULL, count, count, what));
    for (const RtYamlNode *n = rt_yaml_first(list); n != rt_yaml_end(list); n += n->size) {
        RT_TRY(read_number(yaml, n, narrow, wide));
        if (narrow) narrow++;
        if (wide) wide++;
    }
    return RT_OK;
}

RtStatus rt_yaml_float(const RtYaml *yaml, const RtYamlNode *node, const char *key, float *value) {
    return read_number(yaml, value_of(yaml, node, key), value, NULL);
}

RtStatus rt_yaml_double(const RtYaml *yaml, const RtYamlNode *node, const char *key, double *value) {
    return read_number(yaml, value_of(yaml, node, key), NULL, value);
}

RtStatus rt_yaml_point(const RtYaml *yaml, const RtYamlNode *node, const char *key, RtVec3 *value) {
    return read_numbers(yaml, value_of(yaml, node, key), 3, value->at, NULL);
}

RtStatus rt_yaml_doubles(const RtYaml *yaml, const RtYamlNode *node, const char *key, uint32_t count,
                         double *values) {
    return read_numbers(yaml, value_of(yaml, node, key), count, NULL, values);
}

RtStatus rt_yaml_rows(const RtYaml *yaml, const RtYamlNode *node, const char *key, uint32_t least,
                      uint32_t width, float **rows, uint32_t *count) {
    const RtYamlNode *list = value_of(yaml, node, key);
    *rows = NULL;
    *count = 0;
    RT_TRY(rt_yaml_list(yaml, list, NULL, least, UINT32_MAX, "lists of numbers"));
    if (!list) return RT_OK;
    float *all = rt_alloc(list->count, width * sizeof *all), *row = all;
    if (!all)
        return rt_fail_memory(yaml->error, "lists of numbers", (size_t)list->count * width * sizeof *all);
    for (const RtYamlNode *n = rt_yaml_first(list); n != rt_yaml_end(list); n += n->size, row += width) {
        RtStatus status = read_numbers(yaml, n, width, row, NULL);
        if (status == RT_OK) continue;
        rt_free(all);
        return status;
    }
    *rows = all;
    *count = list->count;
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
