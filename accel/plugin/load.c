/* SPDX-License-Identifier: Apache-2.0 */
/* Finding, trying and loading plugins. */
#include "accel/plugin.h"
#include "accel/plugin/host.h"

#include "base/file.h"
#include "base/memory.h"

#include <ctype.h>
#include <dlfcn.h>
#include <errno.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <sys/wait.h>
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

static bool is_name(const char *name, size_t most) {
    size_t length = name ? strlen(name) : 0;
    for (size_t i = 0; i < length; i++) {
        if (!isalnum((unsigned char)name[i]) && name[i] != '_' && (name[i] != '-' || i == 0)) return false;
    }
    return length > 0 && length < most;
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
    if (table->param_count > RAYTALLY_MAX_PARAMS || (table->param_count > 0 && !table->params))
        return rt_fail(error, RT_BAD_INPUT, "%s: '%s' has %u parameters; %d is the most", path, table->name,
                       table->param_count, RAYTALLY_MAX_PARAMS);
    for (uint32_t i = 0; i < table->param_count; i++) {
        const raytally_param *p = &table->params[i];
        bool number = p->type == RAYTALLY_INT || p->type == RAYTALLY_FLOAT;
        if (!is_name(p->name, RT_MAX_NAME) || p->type > RAYTALLY_FLAG || !p->standard || !p->meaning ||
            !p->source || (p->type == RAYTALLY_CHOICE && !p->choices) ||
            (number && (!p->test_values || !(p->lo <= p->hi))))
            return rt_fail(error, RT_BAD_INPUT,
                           "%s: parameter number %u of '%s' lacks its name, type, default, range, choices, "
                           "test values, meaning or source",
                           path, i, table->name);
    }
    return RT_OK;
}

static RtStatus check_table(const char *path, const raytally_accel_ops *table, RtError *error) {
    if (table->abi != RAYTALLY_ACCEL_ABI)
        return rt_fail(error, RT_BAD_INPUT,
                       "%s: it is made for version %u of the interface of plugins, and this raytally has "
                       "version %d: compile it against the headers of this one",
                       path, table->abi, RAYTALLY_ACCEL_ABI);
    if (table->size != sizeof *table)
        return rt_fail(error, RT_BAD_INPUT,
                       "%s: its table has %u bytes where %zu are right: set `size` to "
                       "sizeof(raytally_accel_ops)",
                       path, table->size, sizeof *table);
    if (!is_name(table->name, RT_MAX_NAME))
        return rt_fail(error, RT_BAD_INPUT,
                       "%s: the name of an accelerator is up to %d letters, digits, '_' and '-'", path,
                       RT_MAX_NAME - 1);
    if (!table->summary || !table->paper || !table->build || !table->destroy || !table->nearest ||
        !table->occluded)
        return rt_fail(error, RT_BAD_INPUT,
                       "%s: '%s' lacks its summary, paper, build, destroy, nearest or occluded", path,
                       table->name);
    return check_params(path, table, error);
}

/* ---- loading ---- */

static RtStatus find_tables(const char *path, const raytally_accel_ops **tables, uint32_t *count,
                            RtError *error) {
    void *library = dlopen(path, RTLD_NOW | RTLD_LOCAL);
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
    for (*count = 0; (tables[*count] = give(*count)); ++*count) {
        if (*count + 1 == MOST_TABLES + 1)
            return rt_fail(error, RT_BAD_INPUT, "%s: more than %d accelerators in one library", path,
                           MOST_TABLES);
        RT_TRY(check_table(path, tables[*count], error));
    }
    if (*count > 0) return RT_OK;
    return rt_fail(error, RT_BAD_INPUT, "%s: there is no accelerator in it", path);
}

/* Loads it in a process of its own, where it may crash as it likes; *error gets what that has to say. */
static RtStatus try_tables(const char *path, RtError *error) {
    int answer[2], status = 0;
    RtError said = {RT_BROKEN, ""};
    if (pipe(answer) != 0) return rt_fail(error, RT_IO, "a pipe: %s", strerror(errno));
    fflush(NULL);
    pid_t child = fork();
    if (child == 0) {
        const raytally_accel_ops *tables[MOST_TABLES + 1];
        uint32_t count;
        alarm(10); /* seconds that its constructors may take */
        dup2(STDERR_FILENO, STDOUT_FILENO);
        said.status = find_tables(path, tables, &count, &said);
        _exit(write(answer[1], &said, sizeof said) == sizeof said ? 0 : 1);
    }
    close(answer[1]);
    bool answered = child > 0 && read(answer[0], &said, sizeof said) == sizeof said;
    close(answer[0]);
    if (child > 0) waitpid(child, &status, 0);
    if (child < 0) return rt_fail(error, RT_IO, "a process for a plugin: %s", strerror(errno));
    if (answered) {
        *error = said;
        return said.status;
    }
    int number = WIFSIGNALED(status) ? WTERMSIG(status) : 0;
    return rt_fail(error, RT_BAD_INPUT, "%s: it does not survive being loaded (%s)", path,
                   number == SIGALRM ? "it takes more than 10 seconds"
                   : number          ? sigdescr_np(number)
                                     : "it ends its process");
}

static RtStatus fingerprint_file(const char *path, uint64_t *fingerprint, RtError *error) {
    char *data;
    size_t size;
    RT_TRY(rt_file_read(path, (size_t)1 << 30, &data, &size, error));
    *fingerprint = XXH3_64bits(data, size);
    rt_free(data);
    return RT_OK;
}

static RtStatus register_tables(RtPlugin *plugin, const raytally_accel_ops *const *tables, RtError *error) {
    for (uint32_t i = 0; i < plugin->count; i++) {
        RtError why;
        if (rt_accel_name_is_free(tables[i]->name, &why) == RT_OK) continue;
        return rt_fail(error, RT_BAD_INPUT, "%s: %s", plugin->path, why.message);
    }
    for (uint32_t i = 0; i < plugin->count; i++) {
        RtPluginOps *ops = rt_alloc(1, sizeof(RtPluginOps)); /* for as long as the program runs */
        if (!ops) return rt_fail_memory(error, "a plugin", sizeof(RtPluginOps));
        rt_plugin_ops_init(ops, tables[i]);
        for (uint32_t p = 0; p < tables[i]->param_count; p++)
            RT_TRY(check_param(plugin->path, tables[i]->name, &ops->params[p], error));
        RT_TRY(rt_accel_register(&ops->ops, error));
        plugin->names[i] = ops->ops.name;
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
    const raytally_accel_ops *tables[MOST_TABLES + 1];
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
    RT_TRY(find_tables(real, tables, &plugin->count, error));
    RT_TRY(register_tables(plugin, tables, error));
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

RtStatus rt_plugin_load_all(const char *list, RtError *error) {
    char path[RT_MAX_PATH];
    struct stat about;
    for (size_t length; *list; list += length + (list[length] == ':')) {
        length = strcspn(list, ":");
        if (length == 0) continue;
        if (length >= sizeof path) return rt_fail(error, RT_BAD_INPUT, "a path of a plugin is too long");
        memcpy(path, list, length);
        path[length] = '\0';
        Folder folder = {RT_OK, error};
        if (stat(path, &about) == 0 && S_ISDIR(about.st_mode)) {
            rt_directory_each(path, ".so", load_from, &folder);
            RT_TRY(folder.status);
        } else {
            RT_TRY(rt_plugin_load(path, error));
        }
    }
    return RT_OK;
}
