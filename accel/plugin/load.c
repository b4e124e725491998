/* SPDX-License-Identifier: Apache-2.0 */
/* Plugins that are loaded: a library is tried in a process of its own, and its tables are registered. */
#include "accel/plugin.h"
#include "accel/plugin/library.h"
#include "core/base/process.h"

#include "core/base/file.h"
#include "core/base/memory.h"

#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <unistd.h>

enum { MOST_LIBRARIES = 32, MOST_SECONDS = 10 /* to load a library and read its tables */ };

static RtPlugin plugins[MOST_LIBRARIES];
static size_t plugin_count;

size_t rt_plugin_count(void) {
    return plugin_count;
}

const RtPlugin *rt_plugin_at(size_t i) {
    return &plugins[i];
}

/* ---- trying a library ---- */

/* Written by the process that tries it; the plugin may write to all of this. */
typedef struct Answer {
    uint32_t given; /* 0: there is none */
    RtError error;
    size_t bytes;
    char packed[4 << 20]; /* [bytes] the tables, if error.status is RT_OK */
} Answer;

static _Noreturn void answer_as_child(const char *path, Answer *answer) {
    RtTables tables;
    RtError failure = {RT_OK, ""};
    alarm(MOST_SECONDS + 1); /* if raytally has ended */
    RtStatus status = rt_library_open(path, &tables, &failure);
    if (status == RT_OK) status = rt_tables_check(path, &tables, &failure);
    if (status == RT_OK) answer->bytes = rt_tables_pack(&tables, answer->packed, sizeof answer->packed);
    if (status == RT_OK && answer->bytes == 0)
        status = rt_fail(&failure, RT_BAD_INPUT, "%s: the text of its tables takes more than %zu bytes", path,
                         sizeof answer->packed);
    failure.status = status;
    answer->error = failure;
    answer->given = 1;
    _exit(EXIT_SUCCESS);
}

/* Loads the library in a process of its own, which may crash; *answer gets the result. */
static RtStatus try_loading(const char *path, Answer *answer, RtError *error) {
    char what[160];
    RtProcess child;
    RtProcessEnd end;
    RT_TRY(rt_process_fork(&child, -1, error));
    if (child.pid == 0) answer_as_child(path, answer);
    bool ended = rt_process_wait(&child, 1000 * MOST_SECONDS, &end);
    rt_process_end(&child, 0);
    if (ended && answer->given) return RT_OK;
    if (ended)
        rt_process_end_format(end, 0, "", what, sizeof what);
    else
        snprintf(what, sizeof what, "it takes more than %d seconds", MOST_SECONDS);
    return rt_fail(error, RT_BAD_INPUT, "%s: loading it failed: %s", path, what);
}

/* Unpacks the tables and checks them again. Their text stays for as long as the program runs. */
static RtStatus read_answer(const char *path, const Answer *answer, RtTables *tables, RtError *error) {
    RtError failure = answer->error;
    failure.message[sizeof failure.message - 1] = '\0';
    if (failure.status != RT_OK) return rt_fail(error, RT_BAD_INPUT, "%s", failure.message);
    char *packed = rt_alloc_unset(sizeof answer->packed, 1); /* a copy that nobody else can write to */
    if (!packed) return rt_fail_memory(error, "a plugin", sizeof answer->packed);
    memcpy(packed, answer->packed, sizeof answer->packed);
    RtStatus status = rt_tables_unpack(packed, sizeof answer->packed, tables)
                          ? rt_tables_check(path, tables, error)
                          : rt_fail(error, RT_BAD_INPUT, "%s: its tables cannot be read", path);
    if (status == RT_OK) return RT_OK;
    rt_tables_clear(tables);
    rt_free(packed);
    return status;
}

static RtStatus try_tables(const char *path, RtTables *tables, RtError *error) {
    Answer *answer =
        mmap(NULL, sizeof(Answer), PROT_READ | PROT_WRITE, MAP_SHARED | MAP_ANONYMOUS | MAP_NORESERVE, -1, 0);
    if (answer == MAP_FAILED) return rt_fail_memory(error, "the tables of a plugin", sizeof(Answer));
    RtStatus status = try_loading(path, answer, error);
    if (status == RT_OK) status = read_answer(path, answer, tables, error);
    munmap(answer, sizeof(Answer));
    return status;
}

/* ---- registering its tables ---- */

static RtStatus register_tables(RtPlugin *plugin, const RtTables *tables, RtError *error) {
    RtPluginOps *all = rt_alloc(tables->count, sizeof(RtPluginOps)); /* for as long as the program runs */
    if (!all) return rt_fail_memory(error, "a plugin", tables->count * sizeof(RtPluginOps));
    for (uint32_t i = 0; i < tables->count; i++) {
        rt_plugin_ops_init(&all[i], &tables->at[i]);
        all[i].path = plugin->path;
        all[i].fingerprint = plugin->fingerprint;
        all[i].place = i;
        RT_TRY(rt_accel_register(&all[i].ops, error)); /* rt_tables_check has checked its conditions */
        plugin->names[plugin->count++] = all[i].ops.name;
    }
    return RT_OK;
}

/* An absolute path: dlopen searches the system's folders for a name without a slash. */
static RtStatus real_path(const char *path, char *out, RtError *error) {
    char *found = realpath(path, NULL);
    if (!found) return rt_fail(error, RT_BAD_INPUT, "%s: no such plugin: %s", path, strerror(errno));
    snprintf(out, RT_MAX_PATH, "%s", found);
    free(found);
    return RT_OK;
}

RtStatus rt_plugin_load(const char *path, RtError *error) {
    RtTables tables;
    char real[RT_MAX_PATH];
    RT_TRY(real_path(path, real, error));
    for (size_t i = 0; i < plugin_count; i++) {
        if (strcmp(plugins[i].path, real) == 0) return RT_OK;
    }
    if (plugin_count == MOST_LIBRARIES)
        return rt_fail(error, RT_BAD_INPUT, "more than %d plugins", MOST_LIBRARIES);
    RtPlugin *plugin = &plugins[plugin_count];
    *plugin = (RtPlugin){0};
    snprintf(plugin->path, sizeof plugin->path, "%s", real);
    RT_TRY(rt_library_fingerprint(real, &plugin->fingerprint, error));
    RT_TRY(try_tables(real, &tables, error));
    RtStatus status = register_tables(plugin, &tables, error);
    rt_tables_clear(&tables);
    if (status == RT_OK) plugin_count++;
    return status;
}

/* ---- lists of libraries ---- */

typedef struct Folder {
    RtStatus status;
    RtError *error;
} Folder;

static void load_from(void *context, const char *path) {
    Folder *folder = context;
    if (folder->status == RT_OK) folder->status = rt_plugin_load(path, folder->error);
}

/* Copies the first name of a list to path[0..size). Returns the rest of the list, or NULL if the name is too
 * long. */
static const char *take_path(const char *list, char *path, size_t size) {
    size_t length = 0;
    for (; *list && *list != ':' && length < size; list++) {
        if (*list == '\\' && (list[1] == ':' || list[1] == '\\')) list++;
        path[length++] = *list;
    }
    if (length == size) return NULL;
    path[length] = '\0';
    return *list == ':' ? list + 1 : list;
}

RtStatus rt_plugin_load_all(const char *list, RtError *error) {
    char path[RT_MAX_PATH];
    struct stat about;
    while (*list) {
        list = take_path(list, path, sizeof path);
        if (!list) return rt_fail(error, RT_BAD_INPUT, "the path of a plugin is too long");
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
