/* SPDX-License-Identifier: Apache-2.0 */
/* Reading the tables of a library of any version, and packing them for another process. */
#include "accel/plugin/library.h"

#include "core/base/file.h"
#include "core/base/memory.h"

#include <dlfcn.h>
#include <inttypes.h>
#include <stdio.h>
#include <string.h>

#define XXH_INLINE_ALL
#include <xxhash.h>

/* The table of the first version; later ones have more members, which are optional. */
enum { LEAST_BYTES = offsetof(raytally_accel_ops, each_box) + sizeof(((raytally_accel_ops *)0)->each_box) };

#define KNOWN_FLAGS                                                                                          \
    ((uint64_t)(RAYTALLY_OWN_HITS | RAYTALLY_NO_COUNTS | RAYTALLY_OVERLAY | RAYTALLY_ABSOLUTE_HITS))

RtStatus rt_library_fingerprint(const char *path, uint64_t *fingerprint, RtError *error) {
    char *data;
    size_t size;
    RT_TRY(rt_file_read(path, (size_t)1 << 30, &data, &size, error));
    *fingerprint = XXH3_64bits(data, size);
    rt_free(data);
    return RT_OK;
}

/* ---- reading its tables ---- */

/* Until its size is known, only members that every version has are read. */
static RtStatus take_table(const char *path, const raytally_accel_ops *theirs, RtTables *tables,
                           RtError *error) {
    if (theirs->abi == 0)
        return rt_fail(error, RT_BAD_INPUT, "%s: `abi` is not set: set it to RAYTALLY_ACCEL_ABI", path);
    if (theirs->abi != RAYTALLY_ACCEL_ABI)
        return rt_fail(error, RT_BAD_INPUT,
                       "%s: it is made for version %u of the plugin interface, and this raytally has "
                       "version %d: compile it against the headers of this raytally",
                       path, theirs->abi, RAYTALLY_ACCEL_ABI);
    if (theirs->size < LEAST_BYTES)
        return rt_fail(error, RT_BAD_INPUT,
                       "%s: its table has %u bytes instead of at least %d: set `size` to "
                       "sizeof(raytally_accel_ops)",
                       path, theirs->size, LEAST_BYTES);
    raytally_accel_ops *table = &tables->at[tables->count];
    *table = (raytally_accel_ops){0};
    memcpy(table, theirs, theirs->size < sizeof *table ? theirs->size : sizeof *table);
#define WANT(member)                                                                                         \
    if (!table->member)                                                                                      \
        return rt_fail(error, RT_BAD_INPUT, "%s: '%s' lacks its `" #member "`", path,                        \
                       table->name ? table->name : "a table");
    WANT(name)
    WANT(summary)
    WANT(paper)
    WANT(build)
    WANT(destroy)
    WANT(nearest)
    WANT(occluded)
#undef WANT
    if (table->flags & ~KNOWN_FLAGS)
        return rt_fail(error, RT_BAD_INPUT,
                       "%s: '%s' sets flags that this raytally does not know (%#" PRIx64
                       "): a later version is needed",
                       path, table->name, table->flags & ~KNOWN_FLAGS);
    if (table->param_count > RAYTALLY_MAX_PARAMS)
        return rt_fail(error, RT_BAD_INPUT, "%s: '%s' has %u parameters; at most %d are allowed", path,
                       table->name, table->param_count, RAYTALLY_MAX_PARAMS);
    if (table->param_count > 0 && !table->params)
        return rt_fail(error, RT_BAD_INPUT, "%s: '%s' lacks its `params`", path, table->name);
    tables->count++;
    return RT_OK;
}

RtStatus rt_library_open(const char *path, RtTables *tables, RtError *error) {
    tables->count = 0;
    void *library = dlopen(path, RTLD_NOW | RTLD_LOCAL);
    if (!library) return rt_fail(error, RT_BAD_INPUT, "it cannot be loaded: %s", dlerror());
    raytally_plugin_function *get_table;
    void *symbol = dlsym(library, "raytally_plugin");
    memcpy(&get_table, &symbol, sizeof get_table);
    if (!get_table)
        return rt_fail(
            error, RT_BAD_INPUT,
            "%s: not a plugin: it has no function `raytally_plugin`; `raytally new-accel` writes an example",
            path);
    const raytally_accel_ops *last = NULL;
    for (const raytally_accel_ops *table; (table = get_table(tables->count)); last = table) {
        if (table == last)
            return rt_fail(error, RT_BAD_INPUT,
                           "%s: it returns the same table for index %u and %u; NULL must end them", path,
                           tables->count - 1, tables->count);
        if (tables->count == RT_MOST_TABLES)
            return rt_fail(error, RT_BAD_INPUT, "%s: more than %d accelerators in one library", path,
                           RT_MOST_TABLES);
        RT_TRY(take_table(path, table, tables, error));
    }
    if (tables->count == 0) return rt_fail(error, RT_BAD_INPUT, "%s: there is no accelerator in it", path);
    return RT_OK;
}

/* Opens the library of a plugin's accelerator, if the file is unchanged, and sets ops->table. */
static RtStatus enter(RtPluginOps *ops, RtError *error) {
    RtTables tables;
    uint64_t fingerprint;
    RT_TRY(rt_library_fingerprint(ops->path, &fingerprint, error));
    if (fingerprint != ops->fingerprint)
        return rt_fail(error, RT_BROKEN, "%s has changed since it was loaded", ops->path);
    RT_TRY(rt_library_open(ops->path, &tables, error));
    const raytally_accel_ops *table = &tables.at[ops->place];
    if (ops->place >= tables.count || strcmp(table->name, ops->ops.name) != 0 ||
        table->param_count != ops->ops.param_count)
        return rt_fail(error, RT_BROKEN, "%s: it has different tables each time it is loaded", ops->path);
    ops->table = *table;
    return RT_OK;
}

RtStatus rt_plugin_enter(const RtSpec *spec, RtError *error) {
    for (uint32_t i = 0; i < spec->layer_count; i++) {
        const RtAccelOps *ops = spec->layers[i].ops;
        if (ops->remote) RT_TRY(enter((RtPluginOps *)ops, error));
    }
    return RT_OK;
}

/* ---- checking the tables ---- */

/* Letters as the header defines them, in any locale. */
static bool is_key(const char *name) {
    static const char characters[] = "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789_";
    size_t length = name ? strspn(name, characters) : 0;
    return length > 0 && length < RT_MAX_NAME && name[length] == '\0';
}

static RtStatus check_value(const char *path, const char *name, const RtParam *param, const char *member,
                            const char *text, RtError *error) {
    char setting[RT_MAX_SPEC_CHARS + RT_MAX_NAME], what[RT_MAX_NAME + 16];
    RtError why;
    RtValue value;
    snprintf(what, sizeof what, "accelerator %s", name);
    snprintf(setting, sizeof setting, "%s=%s", param->name, text);
    if (rt_params_parse(param, 1, setting, what, &value, &why) == RT_OK) return RT_OK;
    return rt_fail(error, RT_BAD_INPUT, "%s: the table of '%s' contradicts itself: %s of '%s': %s", path,
                   name, member, param->name, why.message);
}

/* Its default and its test values are within its range. */
static RtStatus check_values(const char *path, const char *name, const RtParam *param, RtError *error) {
    char text[RT_MAX_SPEC_CHARS];
    RT_TRY(check_value(path, name, param, "`default_text`", param->default_text, error));
    for (size_t n = 0; rt_param_try(param, n, text, sizeof text); n++)
        RT_TRY(check_value(path, name, param, "`test_values`", text, error));
    return RT_OK;
}

/* The number of words joined by '|'; 0 if one of them cannot be in a spec. */
static size_t count_choices(const char *choices) {
    static const char others[] = "+:,=| \t\n";
    size_t count = 1;
    for (const char *word = choices;; word++, count++) {
        size_t length = strcspn(word, others);
        if (length == 0 || length >= RT_MAX_NAME) return 0;
        word += length;
        if (*word == '\0') return count;
        if (*word != '|') return 0;
    }
}

/* The member that is missing or wrong, or NULL. */
static const char *wrong_member(const raytally_param *p) {
    bool number = p->type == RAYTALLY_INT || p->type == RAYTALLY_FLOAT;
    return !is_key(p->name)          ? "a `name` of letters, digits and '_'"
           : p->type > RAYTALLY_FLAG ? "a `type`"
           : !p->default_text        ? "`default_text`, its default"
           : !p->meaning             ? "its `meaning`"
           : !p->source              ? "its `source`"
           : p->type == RAYTALLY_CHOICE && (!p->choices || count_choices(p->choices) == 0)
               ? "`choices`, words joined by '|'"
           : number && !p->test_values   ? "its `test_values`"
           : number && !(p->lo <= p->hi) ? "a range: `lo` is above `hi`"
                                         : NULL;
}

static RtStatus check_params(const char *path, const raytally_accel_ops *table, RtError *error) {
    RtPluginOps ops;
    for (uint32_t i = 0; i < table->param_count; i++) {
        const char *wrong = wrong_member(&table->params[i]);
        if (wrong)
            return rt_fail(error, RT_BAD_INPUT, "%s: parameter number %u of '%s' lacks %s", path, i,
                           table->name, wrong);
        if (table->params[i].type == RAYTALLY_CHOICE &&
            count_choices(table->params[i].choices) > RT_MAX_CHOICES)
            return rt_fail(error, RT_BAD_INPUT,
                           "%s: parameter '%s' of '%s' has %zu choices; at most %d are allowed", path,
                           table->params[i].name, table->name, count_choices(table->params[i].choices),
                           RT_MAX_CHOICES);
        for (uint32_t k = 0; k < i; k++) {
            if (strcmp(table->params[k].name, table->params[i].name) == 0)
                return rt_fail(error, RT_BAD_INPUT, "%s: '%s' has two parameters '%s'", path, table->name,
                               table->params[i].name);
        }
    }
    rt_plugin_ops_init(&ops, table);
    for (uint32_t i = 0; i < table->param_count; i++)
        RT_TRY(check_values(path, table->name, &ops.params[i], error));
    return RT_OK;
}

/* The library that has the accelerator `name`, or "". */
static const char *file_of(const char *name) {
    const RtAccelOps *ops;
    return rt_accel_find(name, &ops, NULL) == RT_OK && ops->remote ? ((const RtPluginOps *)ops)->path : "";
}

static RtStatus check_name(const char *path, const RtTables *tables, uint32_t place, RtError *error) {
    RtError why;
    const char *name = tables->at[place].name;
    if (!name || !tables->at[place].summary || !tables->at[place].paper)
        return rt_fail(error, RT_BAD_INPUT, "%s: a table in it has no name, summary or paper", path);
    if (rt_accel_name_is_free(name, &why) != RT_OK) {
        const char *file = file_of(name);
        return rt_fail(error, RT_BAD_INPUT, "%s: %s%s%s", path, why.message, *file ? "; it belongs to " : "",
                       file);
    }
    for (uint32_t i = 0; i < place; i++) {
        if (strcmp(tables->at[i].name, name) == 0)
            return rt_fail(error, RT_BAD_INPUT, "%s: it has two accelerators '%s': choose another name", path,
                           name);
    }
    return RT_OK;
}

RtStatus rt_tables_check(const char *path, const RtTables *tables, RtError *error) {
    for (uint32_t i = 0; i < tables->count; i++) {
        RT_TRY(check_name(path, tables, i, error));
        RT_TRY(check_params(path, &tables->at[i], error));
    }
    return rt_accel_has_room(tables->count, error);
}

/* ---- tables as bytes ---- */

/* Numbers as in memory; a text as its length, its characters and a 0; NULL has no length.
 * Each function passes its values in one direction, to the bytes or from them. */
#define NO_TEXT UINT32_MAX

typedef struct Cursor {
    char *at, *end; /* the next byte */
    bool reading, good;
} Cursor;

static void pass(Cursor *c, void *value, size_t bytes) {
    c->good = c->good && (size_t)(c->end - c->at) >= bytes;
    if (!c->good) return;
    memcpy(c->reading ? value : c->at, c->reading ? c->at : value, bytes);
    c->at += bytes;
}

/* A text that is read stays in the bytes. */
static void pass_text(Cursor *c, const char **text) {
    size_t written = !c->reading && *text ? strlen(*text) : NO_TEXT;
    uint32_t length = written < NO_TEXT ? (uint32_t)written : NO_TEXT;
    c->good = c->good && (c->reading || !*text || length != NO_TEXT);
    if (c->reading) *text = NULL;
    pass(c, &length, sizeof length);
    c->good = c->good && (length == NO_TEXT || (size_t)(c->end - c->at) > length);
    if (!c->good || length == NO_TEXT) return;
    if (c->reading)
        *text = c->at;
    else
        memcpy(c->at, *text, (size_t)length + 1);
    c->at += (size_t)length + 1;
    c->good = c->at[-1] == '\0';
}

static void pass_param(Cursor *c, raytally_param *p) {
    const char **texts[] = {&p->name,        &p->default_text, &p->choices,
                            &p->test_values, &p->meaning,      &p->source};
    pass(c, &p->type, sizeof p->type);
    pass(c, &p->lo, sizeof p->lo);
    pass(c, &p->hi, sizeof p->hi);
    for (size_t i = 0; i < sizeof texts / sizeof texts[0]; i++) pass_text(c, texts[i]);
}

static void each_box_is_remote(const void *self, raytally_box_visitor *visit, void *context) {
    (void)self, (void)visit, (void)context;
}

static void pass_table(Cursor *c, raytally_accel_ops *table) {
    uint8_t shows = table->each_box != NULL;
    pass_text(c, &table->name);
    pass_text(c, &table->summary);
    pass_text(c, &table->paper);
    pass(c, &shows, sizeof shows);
    pass(c, &table->flags, sizeof table->flags);
    pass(c, &table->param_count, sizeof table->param_count);
    if (c->reading) {
        c->good = c->good && table->param_count <= RAYTALLY_MAX_PARAMS;
        table->each_box = shows ? each_box_is_remote : NULL;
        if (!c->good || table->param_count == 0) return;
        table->params = rt_alloc(table->param_count, sizeof(raytally_param));
        c->good = table->params != NULL;
    }
    for (uint32_t p = 0; p < table->param_count && c->good; p++)
        pass_param(c, (raytally_param *)&table->params[p]);
}

size_t rt_tables_pack(const RtTables *tables, char *out, size_t size) {
    Cursor c = {out, out + size, false, true};
    uint32_t count = tables->count;
    pass(&c, &count, sizeof count);
    for (uint32_t i = 0; i < count; i++) {
        raytally_accel_ops table = tables->at[i];
        pass_table(&c, &table);
    }
    return c.good ? (size_t)(c.at - out) : 0;
}

bool rt_tables_unpack(char *packed, size_t size, RtTables *tables) {
    Cursor c = {packed, packed + size, true, true};
    uint32_t count = 0;
    *tables = (RtTables){0};
    pass(&c, &count, sizeof count);
    c.good = c.good && count <= RT_MOST_TABLES;
    while (c.good && tables->count < count) {
        raytally_accel_ops *table = &tables->at[tables->count++];
        *table = (raytally_accel_ops){.abi = RAYTALLY_ACCEL_ABI, .size = sizeof *table};
        pass_table(&c, table);
    }
    if (!c.good) rt_tables_clear(tables);
    return c.good;
}

void rt_tables_clear(RtTables *tables) {
    for (uint32_t i = 0; i < tables->count; i++) rt_free((void *)tables->at[i].params);
    *tables = (RtTables){0};
}
