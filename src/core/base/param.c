/* SPDX-License-Identifier: Apache-2.0 */
#include "core/base/param.h"

#include "core/base/words.h"

#include <assert.h>
#include <errno.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* The `n`th piece of "a|b|c": its start and length, or NULL. */
static const char *piece(const char *list, size_t n, size_t *length) {
    while (list) {
        *length = strcspn(list, "|");
        if (n-- == 0) return list;
        list = list[*length] ? list + *length + 1 : NULL;
    }
    return NULL;
}

/* ---- values to text ---- */

void rt_param_format(const RtParam *param, RtValue value, char *out, size_t size) {
    size_t length = 0;
    switch (param->type) {
    case RT_PARAM_INT: snprintf(out, size, "%lld", (long long)value.i); break;
    case RT_PARAM_FLOAT: snprintf(out, size, "%.9g", value.f); break;
    case RT_PARAM_FLAG: snprintf(out, size, "%s", value.flag ? "on" : "off"); break;
    case RT_PARAM_CHOICE: {
        const char *choice = piece(param->choices, value.choice, &length);
        snprintf(out, size, "%.*s", (int)length, choice);
        break;
    }
    case RT_PARAM_RESOLUTION:
        if (value.resolution[0] == 0)
            snprintf(out, size, "auto");
        else
            snprintf(out, size, "%ux%ux%u", value.resolution[0], value.resolution[1], value.resolution[2]);
        break;
    }
}

void rt_params_format(const RtParam *table, size_t count, const RtValue *values, char *out, size_t size) {
    out[0] = '\0';
    for (size_t i = 0; i < count; i++) {
        char value[RT_MAX_SPEC_CHARS];
        rt_param_format(&table[i], values[i], value, sizeof value);
        rt_append_text(out, size, "%s%s=%s", i ? "," : "", table[i].name, value);
    }
}

void rt_param_range(const RtParam *param, char *out, size_t size) {
    switch (param->type) {
    case RT_PARAM_INT:
    case RT_PARAM_FLOAT: snprintf(out, size, "%.9g..%.9g", param->lo, param->hi); break;
    case RT_PARAM_FLAG: snprintf(out, size, "on|off"); break;
    case RT_PARAM_CHOICE: snprintf(out, size, "%s", param->choices); break;
    case RT_PARAM_RESOLUTION:
        snprintf(out, size, "auto or NXxNYxNZ, each %.9g..%.9g", param->lo, param->hi);
        break;
    }
}

bool rt_param_try(const RtParam *param, size_t n, char *out, size_t size) {
    const char *all = param->type == RT_PARAM_FLAG ? "on|off" : param->choices;
    const char *list = param->test_values ? param->test_values : all;
    size_t length;
    const char *text = piece(list, n, &length);
    if (text) snprintf(out, size, "%.*s", (int)length, text);
    return text != NULL;
}

/* ---- text to values ---- */

/* The whole of `text` must be one finite number. */
static bool parse_number(const char *text, double *out) {
    char *end;
    *out = strtod(text, &end);
    return end != text && *end == '\0' && isfinite(*out);
}

/* Digits are read exactly; other notations, such as 1e6, as far as int64_t holds them, whatever the range
 * of the parameter. */
static bool parse_whole(const RtParam *param, const char *text, int64_t *out) {
    char *end;
    double number;
    errno = 0;
    *out = strtoll(text, &end, 10);
    if (errno) return false;
    if (end == text || *end) {
        if (!parse_number(text, &number) || number != floor(number)) return false;
        if (!(number >= -0x1p63 && number < 0x1p63)) return false;
        *out = (int64_t)number;
    }
    return (double)*out >= param->lo && (double)*out <= param->hi;
}

static bool parse_resolution(const RtParam *param, const char *text, RtValue *out) {
    *out = (RtValue){.resolution = {0, 0, 0}};
    if (strcmp(text, "auto") == 0) return true;
    for (int a = 0; a < 3; a++) {
        char *end;
        errno = 0;
        unsigned long n = strtoul(text, &end, 10);
        bool digit = *text >= '0' && *text <= '9';
        if (!digit || errno || n > UINT32_MAX) return false;
        if ((double)n < param->lo || (double)n > param->hi) return false;
        if (*end != (a < 2 ? 'x' : '\0')) return false;
        out->resolution[a] = (uint32_t)n;
        text = end + 1;
    }
    return true;
}

static bool parse_value(const RtParam *param, const char *text, RtValue *out) {
    double number;
    switch (param->type) {
    case RT_PARAM_INT: *out = (RtValue){.i = 0}; return parse_whole(param, text, &out->i);
    case RT_PARAM_FLOAT:
        if (!parse_number(text, &number)) return false;
        *out = (RtValue){.f = number};
        return number >= param->lo && number <= param->hi;
    case RT_PARAM_FLAG:
        *out = (RtValue){.flag = strcmp(text, "on") == 0};
        return out->flag || strcmp(text, "off") == 0;
    case RT_PARAM_CHOICE: {
        size_t length;
        const char *choice;
        for (uint32_t i = 0; (choice = piece(param->choices, i, &length)); i++) {
            if (strlen(text) != length || strncmp(text, choice, length) != 0) continue;
            *out = (RtValue){.choice = i};
            return true;
        }
        return false;
    }
    case RT_PARAM_RESOLUTION: return parse_resolution(param, text, out);
    }
    return false;
}

static RtStatus fail_unknown(const RtParam *table, size_t count, const char *key, const char *what,
                             RtError *error) {
    if (count == 0) return rt_fail(error, RT_BAD_INPUT, "%s has no parameters, so it has no '%s'", what, key);
    const char *names[RT_MAX_PARAMS];
    char list[512], suggestion[RT_MAX_SUGGESTION];
    for (size_t i = 0; i < count; i++) names[i] = table[i].name;
    rt_join_names(names, count, list, sizeof list);
    rt_suggest(key, names, count, suggestion);
    return rt_fail(error, RT_BAD_INPUT, "%s has no parameter '%s'%s%s it has: %s", what, key, suggestion,
                   *suggestion ? "" : ";", list);
}

/* ": did you mean 'CHOICE'?" if one of the choices is near. */
static void suggest_choice(const RtParam *param, const char *text, char suggestion[RT_MAX_SUGGESTION]) {
    char choices[RT_MAX_SPEC_CHARS], *rest = choices;
    const char *names[RT_MAX_CHOICES];
    size_t count = 0;
    *suggestion = '\0';
    if (param->type != RT_PARAM_CHOICE) return;
    snprintf(choices, sizeof choices, "%s", param->choices);
    for (char *name; count < RT_MAX_CHOICES && (name = strsep(&rest, "|"));) names[count++] = name;
    rt_suggest(text, names, count, suggestion);
}

/* One "key=value" of the text. */
static RtStatus parse_setting(const RtParam *table, size_t count, char *setting, const char *what,
                              bool *given, RtValue *values, RtError *error) {
    char *equals = strchr(setting, '=');
    if (!equals) return rt_fail(error, RT_BAD_INPUT, "%s: '%s' is not of the form key=value", what, setting);
    *equals = '\0';
    const char *key = setting, *text = equals + 1;
    for (size_t i = 0; i < count; i++) {
        if (strcmp(table[i].name, key) != 0) continue;
        if (given[i]) return rt_fail(error, RT_BAD_INPUT, "%s: '%s' is given twice", what, key);
        given[i] = true;
        if (parse_value(&table[i], text, &values[i])) return RT_OK;
        char range[RT_MAX_SPEC_CHARS], suggestion[RT_MAX_SUGGESTION];
        rt_param_range(&table[i], range, sizeof range);
        suggest_choice(&table[i], text, suggestion);
        return rt_fail(error, RT_BAD_INPUT, "%s: invalid value '%s=%s'%s%s expected %s%s (%s; default %s)",
                       what, key, text, suggestion, *suggestion ? "" : ":",
                       table[i].type == RT_PARAM_INT ? "a whole number " : "", range, table[i].meaning,
                       table[i].default_text);
    }
    return fail_unknown(table, count, key, what, error);
}

RtStatus rt_params_parse(const RtParam *table, size_t count, const char *text, const char *what,
                         RtValue *values, RtError *error) {
    assert(count <= RT_MAX_PARAMS);
    bool given[RT_MAX_PARAMS] = {false};
    for (size_t i = 0; i < count; i++) {
        if (!parse_value(&table[i], table[i].default_text, &values[i]))
            return rt_fail(error, RT_BAD_INPUT, "%s: the default '%s=%s' is outside its own range", what,
                           table[i].name, table[i].default_text);
    }
    if (!text || !*text) return RT_OK;
    char copy[RT_MAX_SPEC_CHARS];
    if (strlen(text) >= sizeof copy)
        return rt_fail(error, RT_BAD_INPUT, "%s: the parameters are longer than %zu characters", what,
                       sizeof copy - 1);
    strcpy(copy, text);
    for (char *setting = copy, *next; setting; setting = next) {
        next = strchr(setting, ',');
        if (next) *next++ = '\0';
        RT_TRY(parse_setting(table, count, setting, what, given, values, error));
    }
    return RT_OK;
}
