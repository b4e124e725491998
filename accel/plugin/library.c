/* SPDX-License-Identifier: Apache-2.0 */
/* The libraries of plugins: reading the tables in them, of any version, and registering what they describe.
 *
 * No code of a library ever runs in raytally's own process: effects of its constructors (the locale,
 * rounding, signal handlers, a crash) stay in other processes. One process tries the library and copies its
 * tables, their numbers and texts, into shared memory; raytally trusts them as little as any other input.
 * Each process that builds an accelerator opens the library for itself. */
#include "accel/plugin/channel.h"
#include "core/base/file.h"
#include "core/base/memory.h"
#include "core/base/process.h"

#include <dlfcn.h>
#include <errno.h>
#include <inttypes.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/mman.h>
#include <unistd.h>

#define XXH_INLINE_ALL
#include <xxhash.h>

/* The table of the first version; later ones have more members, which are optional. */
enum { LEAST_BYTES = offsetof(raytally_accel_ops, each_box) + sizeof(((raytally_accel_ops *)0)->each_box) };

#define KNOWN_FLAGS                                                                                          \
    ((uint64_t)(RAYTALLY_OWN_HITS | RAYTALLY_NO_COUNTS | RAYTALLY_OVERLAY | RAYTALLY_ABSOLUTE_HITS))

enum {
    MOST_LIBRARIES = 32,
    MOST_TABLES = sizeof(((RtPlugin *)0)->names) / sizeof(char *),
    MOST_SECONDS = 10 /* to load a library and read its tables */
};

/* The tables of a library, converted to this version: members that theirs lack are NULL. */
typedef struct Tables {
    uint32_t count;
    raytally_accel_ops at[MOST_TABLES];
} Tables;

static RtPlugin plugins[MOST_LIBRARIES];
static size_t plugin_count;

size_t rt_plugin_count(void) {
    return plugin_count;
}

const RtPlugin *rt_plugin_at(size_t i) {
    return &plugins[i];
}

static RtStatus hash_library(const char *path, uint64_t *fingerprint, RtError *error) {
    char *data;
    size_t size;
    RT_TRY(rt_file_read(path, (size_t)1 << 30, &data, &size, error));
    *fingerprint = XXH3_64bits(data, size);
    rt_free(data);
    return RT_OK;
}

/* ---- reading its tables ---- */

/* Until its size is known, only members that every version has are read. */
static RtStatus take_table(const char *path, const raytally_accel_ops *theirs, Tables *tables,
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

/* Loads the library into this process, for as long as that lives. RT_BAD_INPUT if it is not a plugin, or one
 * of another version. */
static RtStatus open_library(const char *path, Tables *tables, RtError *error) {
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
        if (tables->count == MOST_TABLES)
            return rt_fail(error, RT_BAD_INPUT, "%s: more than %d accelerators in one library", path,
                           MOST_TABLES);
        RT_TRY(take_table(path, table, tables, error));
    }
    if (tables->count == 0) return rt_fail(error, RT_BAD_INPUT, "%s: there is no accelerator in it", path);
    return RT_OK;
}

/* Opens the library of a plugin's accelerator, if the file is unchanged, and sets ops->table. */
static RtStatus enter(RtPluginOps *ops, RtError *error) {
    Tables tables;
    uint64_t fingerprint;
    RT_TRY(hash_library(ops->path, &fingerprint, error));
    if (fingerprint != ops->fingerprint)
        return rt_fail(error, RT_BROKEN, "%s has changed since it was loaded", ops->path);
    RT_TRY(open_library(ops->path, &tables, error));
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

/* Its default and its test values are within its range. */
static RtStatus check_values(const char *path, const char *name, const RtParam *param, RtError *error) {
    char text[RT_MAX_SPEC_CHARS], setting[RT_MAX_SPEC_CHARS + RT_MAX_NAME], what[RT_MAX_NAME + 16];
    RtError why;
    RtValue value;
    snprintf(what, sizeof what, "accelerator %s", name);
    snprintf(text, sizeof text, "%s", param->default_text);
    for (size_t n = 0; n == 0 || rt_param_try(param, n - 1, text, sizeof text); n++) {
        snprintf(setting, sizeof setting, "%s=%s", param->name, text);
        if (rt_params_parse(param, 1, setting, what, &value, &why) == RT_OK) continue;
        return rt_fail(error, RT_BAD_INPUT, "%s: the table of '%s' contradicts itself: %s of '%s': %s", path,
                       name, n == 0 ? "`default_text`" : "`test_values`", param->name, why.message);
    }
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

static RtStatus check_name(const char *path, const Tables *tables, uint32_t place, RtError *error) {
    RtError why;
    const char *name = tables->at[place].name;
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

/* Checks that the tables are complete and consistent, and that their names are free. */
static RtStatus check_tables(const char *path, const Tables *tables, RtError *error) {
    for (uint32_t i = 0; i < tables->count; i++) {
        RT_TRY(check_name(path, tables, i, error));
        RT_TRY(check_params(path, &tables->at[i], error));
    }
    return rt_accel_has_room(tables->count, error);
}

/* ---- trying a library ---- */

/* Written by the process that tries it; the plugin may write to all of this. */
typedef struct Trial {
    uint32_t complete; /* 1: the process has written what follows; 0: it has not */
    RtError error;
    Tables tables;        /* if error.status is RT_OK */
    size_t used;          /* more than `memory` has: it is too small */
    char memory[4 << 20]; /* the texts and parameters of the tables */
} Trial;

/* Calls `visit` with the parameters of a table and then with each text, which may be NULL. */
enum { A_TEXT = 0 /* as `bytes` */ };
typedef bool Visit(void *context, const char **at, size_t bytes);

static bool visit_table(raytally_accel_ops *table, Visit *visit, void *context) {
    const char **texts[] = {&table->name, &table->summary, &table->paper};
    const char *params = table->param_count > 0 ? (const char *)table->params : NULL;
    bool good = table->param_count <= RAYTALLY_MAX_PARAMS &&
                visit(context, &params, table->param_count * sizeof(raytally_param));
    table->params = (const raytally_param *)params;
    for (size_t i = 0; i < sizeof texts / sizeof texts[0] && good; i++)
        good = *texts[i] && visit(context, texts[i], A_TEXT);
    for (uint32_t p = 0; p < table->param_count && good; p++) {
        raytally_param *param = (raytally_param *)&table->params[p];
        const char **own[] = {&param->name,        &param->default_text, &param->choices,
                              &param->test_values, &param->meaning,      &param->source};
        for (size_t i = 0; i < sizeof own / sizeof own[0] && good; i++) good = visit(context, own[i], A_TEXT);
    }
    return good;
}

/* Copies it to the memory of the trial. */
static bool keep(void *context, const char **at, size_t bytes) {
    Trial *trial = context;
    char *to = trial->memory + trial->used;
    if (!*at) return true;
    if (bytes == A_TEXT) bytes = strlen(*at) + 1;
    trial->used += (bytes + 7) / 8 * 8;
    if (trial->used > sizeof trial->memory) return false;
    memcpy(to, *at, bytes);
    *at = to;
    return true;
}

static _Noreturn void try_as_child(const char *path, Trial *trial) {
    RtError failure = {RT_OK, ""};
    alarm(MOST_SECONDS + 1); /* if raytally has ended */
    RtStatus status = open_library(path, &trial->tables, &failure);
    for (uint32_t i = 0; i < trial->tables.count && status == RT_OK; i++) {
        if (!visit_table(&trial->tables.at[i], keep, trial))
            status = rt_fail(&failure, RT_BAD_INPUT, "%s: the text of its tables takes more than %zu bytes",
                             path, sizeof trial->memory);
    }
    failure.status = status;
    trial->error = failure;
    trial->complete = 1;
    _exit(EXIT_SUCCESS);
}

/* Loads the library in a process of its own, which may crash; *trial gets the result. */
static RtStatus try_loading(const char *path, Trial *trial, RtError *error) {
    char what[160];
    RtProcess child;
    RtProcessEnd end;
    RT_TRY(rt_process_fork(&child, -1, error));
    if (child.pid == 0) try_as_child(path, trial);
    bool ended = rt_process_wait(&child, 1000 * MOST_SECONDS, &end);
    rt_process_end(&child, 0);
    if (ended && trial->complete) return RT_OK;
    if (ended)
        rt_process_end_format(end, 0, "", what, sizeof what);
    else
        snprintf(what, sizeof what, "it takes more than %d seconds", MOST_SECONDS);
    return rt_fail(error, RT_BAD_INPUT, "%s: loading it failed: %s", path, what);
}

static bool is_kept(void *context, const char **at, size_t bytes) {
    const Trial *trial = context;
    const size_t offset = (size_t)((uintptr_t)*at - (uintptr_t)trial->memory);
    return *at ? offset < sizeof trial->memory && bytes <= sizeof trial->memory - offset && offset % 8 == 0
               : bytes == A_TEXT;
}

/* Checks what the process has written, now that it has ended. */
static RtStatus check_trial(const char *path, Trial *trial, RtError *error) {
    trial->error.message[sizeof trial->error.message - 1] = '\0';
    trial->memory[sizeof trial->memory - 1] = '\0';
    if (trial->error.status != RT_OK) return rt_fail(error, RT_BAD_INPUT, "%s", trial->error.message);
    bool good = trial->tables.count <= MOST_TABLES;
    for (uint32_t i = 0; good && i < trial->tables.count; i++)
        good = visit_table(&trial->tables.at[i], is_kept, trial);
    return good ? check_tables(path, &trial->tables, error)
                : rt_fail(error, RT_BAD_INPUT, "%s: its tables cannot be read", path);
}

/* ---- registering its tables ---- */

static RtStatus register_tables(RtPlugin *plugin, const Tables *tables, RtError *error) {
    RtPluginOps *all = rt_alloc(tables->count, sizeof(RtPluginOps)); /* for as long as the program runs */
    if (!all) return rt_fail_memory(error, "a plugin", tables->count * sizeof(RtPluginOps));
    for (uint32_t i = 0; i < tables->count; i++) {
        rt_plugin_ops_init(&all[i], &tables->at[i]);
        all[i].path = plugin->path;
        all[i].fingerprint = plugin->fingerprint;
        all[i].place = i;
        RT_TRY(rt_accel_register(&all[i].ops, error)); /* check_tables has checked its conditions */
        plugin->names[plugin->count++] = all[i].ops.name;
    }
    return RT_OK;
}

/* The tables stay for as long as the program runs; the processes of plugins cannot write to them. */
static RtStatus try_and_register(RtPlugin *plugin, RtError *error) {
    Trial *trial =
        mmap(NULL, sizeof(Trial), PROT_READ | PROT_WRITE, MAP_SHARED | MAP_ANONYMOUS | MAP_NORESERVE, -1, 0);
    if (trial == MAP_FAILED) return rt_fail_memory(error, "the tables of a plugin", sizeof(Trial));
    RtStatus status = try_loading(plugin->path, trial, error);
    if (status == RT_OK) status = check_trial(plugin->path, trial, error);
    if (status == RT_OK) status = register_tables(plugin, &trial->tables, error);
    if (status == RT_OK)
        mprotect(trial, sizeof(Trial), PROT_READ);
    else
        munmap(trial, sizeof(Trial));
    return status;
}

/* By an absolute path: dlopen searches the system's folders for a name without a slash. */
RtStatus rt_plugin_load(const char *path, RtError *error) {
    char *real = realpath(path, NULL);
    if (!real) return rt_fail(error, RT_BAD_INPUT, "%s: no such plugin: %s", path, strerror(errno));
    RtPlugin plugin = {.count = 0};
    snprintf(plugin.path, sizeof plugin.path, "%s", real);
    free(real);
    for (size_t i = 0; i < plugin_count; i++) {
        if (strcmp(plugins[i].path, plugin.path) == 0) return RT_OK;
    }
    if (plugin_count == MOST_LIBRARIES)
        return rt_fail(error, RT_BAD_INPUT, "more than %d plugins", MOST_LIBRARIES);
    RT_TRY(hash_library(plugin.path, &plugin.fingerprint, error));
    plugins[plugin_count] = plugin;
    RT_TRY(try_and_register(&plugins[plugin_count], error));
    plugin_count++;
    return RT_OK;
}
