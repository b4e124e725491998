/* SPDX-License-Identifier: Apache-2.0 */
/* Finding, trying and loading plugins. */
#include "accel/plugin.h"
#include "accel/plugin/host.h"
#include "accel/plugin/process.h"

#include "base/file.h"
#include "base/memory.h"

#include <dlfcn.h>
#include <errno.h>
#include <fcntl.h>
#include <fenv.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#define XXH_INLINE_ALL
#include <xxhash.h>

enum { MOST_LIBRARIES = 32, MOST_TABLES = sizeof(((RtPlugin *)0)->names) / sizeof(char *) };

static RtPlugin plugins[MOST_LIBRARIES];
static size_t plugin_count;

size_t rt_plugin_count(void) {
    return plugin_count;
}

const RtPlugin *rt_plugin_at(size_t i) {
    return &plugins[i];
}

/* ---- is it one? ---- */

/* What a library has, in tables of this version: what theirs lack is NULL. */
typedef struct Tables {
    uint32_t count;
    raytally_accel_ops at[MOST_TABLES];
} Tables;

/* What the table of the first version has; later ones have more, which is optional. */
enum { LEAST_BYTES = offsetof(raytally_accel_ops, each_box) + sizeof(((raytally_accel_ops *)0)->each_box) };
_Static_assert(sizeof(raytally_accel_ops) == LEAST_BYTES, "nothing behind the last member");

/* As the headers say, whatever the locale takes for a letter. */
static bool is_key(const char *name) {
    static const char characters[] = "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789_";
    size_t length = name ? strspn(name, characters) : 0;
    return length > 0 && length < RT_MAX_NAME && name[length] == '\0';
}

/* Its default and what it names for testing are within its range. */
static RtStatus check_param(const char *path, const char *name, const RtParam *param, RtError *error) {
    char text[RT_MAX_SPEC_CHARS], what[RT_MAX_NAME + 16];
    RtError why;
    RtValue value;
    snprintf(what, sizeof what, "accelerator %s", name);
    for (size_t n = 0; n == 0 || rt_param_try(param, n - 1, text, sizeof text); n++) {
        char setting[RT_MAX_SPEC_CHARS + RT_MAX_NAME];
        snprintf(setting, sizeof setting, "%s=%s", param->name, n == 0 ? param->standard : text);
        if (rt_params_parse(param, 1, setting, what, &value, &why) == RT_OK) continue;
        return rt_fail(error, RT_BAD_INPUT, "%s: the table of '%s' does not fit itself: %s", path, name,
                       why.message);
    }
    return RT_OK;
}

static RtStatus check_params(const char *path, const raytally_accel_ops *table, RtError *error) {
    RtPluginOps ops;
    if (table->param_count > RAYTALLY_MAX_PARAMS || (table->param_count > 0 && !table->params))
        return rt_fail(error, RT_BAD_INPUT, "%s: '%s' has %u parameters; %d is the most", path, table->name,
                       table->param_count, RAYTALLY_MAX_PARAMS);
    for (uint32_t i = 0; i < table->param_count; i++) {
        const raytally_param *p = &table->params[i];
        bool number = p->type == RAYTALLY_INT || p->type == RAYTALLY_FLOAT;
        if (!is_key(p->name) || p->type > RAYTALLY_FLAG || !p->standard || !p->meaning || !p->source ||
            (p->type == RAYTALLY_CHOICE && !p->choices) || (number && (!p->test_values || !(p->lo <= p->hi))))
            return rt_fail(error, RT_BAD_INPUT,
                           "%s: parameter number %u of '%s' lacks its name, type, default, range, choices, "
                           "test values, meaning or source",
                           path, i, table->name);
    }
    rt_plugin_ops_init(&ops, table);
    for (uint32_t i = 0; i < table->param_count; i++)
        RT_TRY(check_param(path, table->name, &ops.params[i], error));
    return RT_OK;
}

static RtStatus check_name(const char *path, const Tables *tables, const char *name, RtError *error) {
    RtError why;
    if (!name) return rt_fail(error, RT_BAD_INPUT, "%s: a table in it has no name", path);
    if (rt_accel_name_is_free(name, &why) != RT_OK)
        return rt_fail(error, RT_BAD_INPUT, "%s: %s", path, why.message);
    for (uint32_t i = 0; i < tables->count; i++) {
        if (strcmp(tables->at[i].name, name) == 0)
            return rt_fail(error, RT_BAD_INPUT, "%s: it has two accelerators '%s': choose another name", path,
                           name);
    }
    return RT_OK;
}

/* Nothing of the table is read but what every version has before its size is known. */
static RtStatus take_table(const char *path, const raytally_accel_ops *theirs, Tables *tables,
                           RtError *error) {
    raytally_accel_ops *table = &tables->at[tables->count];
    if (tables->count == MOST_TABLES)
        return rt_fail(error, RT_BAD_INPUT, "%s: more than %d accelerators in one library", path,
                       MOST_TABLES);
    if (theirs->abi != RAYTALLY_ACCEL_ABI)
        return rt_fail(error, RT_BAD_INPUT,
                       "%s: it is made for version %u of the interface of plugins, and this raytally has "
                       "version %d: compile it against the headers of this one",
                       path, theirs->abi, RAYTALLY_ACCEL_ABI);
    if (theirs->size < LEAST_BYTES)
        return rt_fail(error, RT_BAD_INPUT,
                       "%s: its table has %u bytes where %d are the least: set `size` to "
                       "sizeof(raytally_accel_ops)",
                       path, theirs->size, LEAST_BYTES);
    *table = (raytally_accel_ops){0};
    memcpy(table, theirs, theirs->size < sizeof *table ? theirs->size : sizeof *table);
    RT_TRY(check_name(path, tables, table->name, error));
    if (!table->summary || !table->paper || !table->build || !table->destroy || !table->nearest ||
        !table->occluded)
        return rt_fail(error, RT_BAD_INPUT,
                       "%s: '%s' lacks its summary, paper, build, destroy, nearest or occluded", path,
                       table->name);
    RT_TRY(check_params(path, table, error));
    tables->count++;
    return RT_OK;
}

/* ---- loading ---- */

/* How the processor rounds, and whether it takes small numbers for 0, is not for a library to change: what is
 * linked with -ffast-math does when it is loaded. */
static void *open_library(const char *path) {
    fenv_t before;
    fegetenv(&before);
    void *library = dlopen(path, RTLD_NOW | RTLD_LOCAL);
    fesetenv(&before);
    return library;
}

static const raytally_accel_ops *ask_for_table(raytally_plugin_function *give, uint32_t index) {
    fenv_t before;
    fegetenv(&before);
    const raytally_accel_ops *table = give(index);
    fesetenv(&before);
    return table;
}

/* All that there is to refuse is refused here, where nothing is registered yet. */
static RtStatus find_tables(const char *path, Tables *tables, RtError *error) {
    void *library = open_library(path);
    if (!library) return rt_fail(error, RT_BAD_INPUT, "it cannot be loaded: %s", dlerror());
    raytally_plugin_function *give;
    void *symbol = dlsym(library, "raytally_plugin");
    memcpy(&give, &symbol, sizeof give);
    if (!give) {
        return rt_fail(error, RT_BAD_INPUT,
                       "%s: it is no plugin, for it has no function `raytally_plugin`; `raytally new-accel` "
                       "writes one that has",
                       path);
    }
    tables->count = 0;
    for (const raytally_accel_ops *table; (table = ask_for_table(give, tables->count));)
        RT_TRY(take_table(path, table, tables, error));
    if (tables->count == 0) return rt_fail(error, RT_BAD_INPUT, "%s: there is no accelerator in it", path);
    return rt_accel_has_room(tables->count, error);
}

enum { MOST_SECONDS = 10 }; /* that a library may take to be loaded and asked for its tables */

static _Noreturn void answer_trial(const char *path, int answer) {
    Tables tables;
    RtError said = {RT_BROKEN, ""};
    alarm(MOST_SECONDS + 1); /* where nobody waits any more */
    dup2(STDERR_FILENO, STDOUT_FILENO);
    said.status = find_tables(path, &tables, &said);
    _exit(write(answer, &said, sizeof said) == sizeof said ? EXIT_SUCCESS : EXIT_FAILURE);
}

/* Loads it in a process of its own, where it may crash as it likes; *error gets what that has to say. */
static RtStatus try_tables(const char *path, RtError *error) {
    char what[160];
    int answer[2];
    RtProcess trial;
    RtProcessEnd end;
    RtError said;
    if (pipe2(answer, O_CLOEXEC | O_NONBLOCK) != 0)
        return rt_fail(error, RT_IO, "a pipe: %s", strerror(errno));
    RtStatus started = rt_process_start(&trial, error);
    if (started == RT_OK && trial.pid == 0) answer_trial(path, answer[1]);
    bool ended = started == RT_OK && rt_process_wait(&trial, 1000 * MOST_SECONDS, &end);
    bool answered = ended && read(answer[0], &said, sizeof said) == sizeof said;
    close(answer[0]);
    close(answer[1]);
    RT_TRY(started);
    rt_process_end(&trial, 0);
    if (answered) {
        said.message[sizeof said.message - 1] = '\0';
        return said.status == RT_OK ? RT_OK : rt_fail(error, said.status, "%s", said.message);
    }
    if (ended) {
        rt_process_end_format(end, 0, "", what, sizeof what);
    } else {
        snprintf(what, sizeof what, "it takes more than %d seconds", MOST_SECONDS);
    }
    return rt_fail(error, RT_BAD_INPUT, "%s: it does not survive being loaded: %s", path, what);
}

static RtStatus fingerprint_file(const char *path, uint64_t *fingerprint, RtError *error) {
    char *data;
    size_t size;
    RT_TRY(rt_file_read(path, (size_t)1 << 30, &data, &size, error));
    *fingerprint = XXH3_64bits(data, size);
    rt_free(data);
    return RT_OK;
}

/* For as long as the program runs, as the library stays. */
typedef struct Registered {
    RtPluginOps ops;
    raytally_accel_ops table;
} Registered;

static RtStatus register_tables(RtPlugin *plugin, const Tables *tables, RtError *error) {
    Registered *all = rt_alloc(tables->count, sizeof(Registered));
    if (!all) return rt_fail_memory(error, "a plugin", tables->count * sizeof(Registered));
    for (uint32_t i = 0; i < tables->count; i++) {
        all[i].table = tables->at[i];
        rt_plugin_ops_init(&all[i].ops, &all[i].table);
        RT_TRY(rt_accel_register(&all[i].ops.ops, error)); /* find_tables asked for what it asks */
        plugin->names[plugin->count++] = all[i].ops.ops.name;
    }
    return RT_OK;
}

/* dlopen takes a name without a slash for one in the system's folders. */
static RtStatus real_path(const char *path, char *out, RtError *error) {
    char *found = realpath(path, NULL);
    if (!found) return rt_fail(error, RT_BAD_INPUT, "%s: no plugin there: %s", path, strerror(errno));
    snprintf(out, RT_MAX_PATH, "%s", found);
    free(found);
    return RT_OK;
}

RtStatus rt_plugin_load(const char *path, RtError *error) {
    Tables tables;
    char real[RT_MAX_PATH];
    RtPlugin *plugin = &plugins[plugin_count];
    RT_TRY(real_path(path, real, error));
    for (size_t i = 0; i < plugin_count; i++) {
        if (strcmp(plugins[i].path, real) == 0) return RT_OK;
    }
    if (plugin_count == MOST_LIBRARIES)
        return rt_fail(error, RT_BAD_INPUT, "more than %d plugins", MOST_LIBRARIES);
    *plugin = (RtPlugin){0};
    snprintf(plugin->path, sizeof plugin->path, "%s", real);
    RT_TRY(fingerprint_file(real, &plugin->fingerprint, error));
    RT_TRY(try_tables(real, error));
    RT_TRY(find_tables(real, &tables, error));
    RT_TRY(register_tables(plugin, &tables, error));
    plugin_count++;
    return RT_OK;
}

/* ---- many ---- */

typedef struct Folder {
    RtStatus status;
    RtError *error;
} Folder;

static void load_from(void *context, const char *path) {
    Folder *folder = context;
    if (folder->status == RT_OK) folder->status = rt_plugin_load(path, folder->error);
}

/* The first name of a list to path[0..room); gives what is left of the list, or NULL where it is too long. */
static const char *take_path(const char *list, char *path, size_t room) {
    size_t length = 0;
    for (; *list && *list != ':' && length < room; list++) {
        if (*list == '\\' && (list[1] == ':' || list[1] == '\\')) list++;
        path[length++] = *list;
    }
    if (length == room) return NULL;
    path[length] = '\0';
    return *list == ':' ? list + 1 : list;
}

RtStatus rt_plugin_load_all(const char *list, RtError *error) {
    char path[RT_MAX_PATH];
    struct stat about;
    while (*list) {
        list = take_path(list, path, sizeof path);
        if (!list) return rt_fail(error, RT_BAD_INPUT, "a path of a plugin is too long");
        Folder folder = {RT_OK, error};
        if (*path && stat(path, &about) == 0 && S_ISDIR(about.st_mode)) {
            rt_directory_each(path, ".so", load_from, &folder);
            RT_TRY(folder.status);
        } else if (*path) {
            RT_TRY(rt_plugin_load(path, error));
        }
    }
    return RT_OK;
}
