/* SPDX-License-Identifier: Apache-2.0 */
#include "cli/cli.h"

#include "accel/plugin.h"
#include "core/base/words.h"
#include "experiment/plugins_used.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

#define VARIABLE "RAYTALLY_PLUGINS"

enum { OPT_PLUGIN = 0x10000 };

static const struct argp_option options[] = {
    {"plugin", OPT_PLUGIN, "FILE.so", 0,
     "Load your own accelerators; may be repeated. $" VARIABLE
     " names more files and folders, joined by ':' (in a name, '\\:'). Each plugin runs in its own process; "
     "raytally stops it after $RAYTALLY_PLUGIN_SECONDS (60) without progress",
     100},
    {0}};

/* The files given by --plugin. */
enum { MOST_GIVEN = 32 };
static const char *given[MOST_GIVEN];
static size_t given_count;

/* rt_cli_load_plugins has loaded it already. */
static error_t parse_option(int key, char *argument, struct argp_state *state) {
    RtError error;
    if (key != OPT_PLUGIN) return ARGP_ERR_UNKNOWN;
    if (given_count < MOST_GIVEN) given[given_count++] = argument;
    if (rt_plugin_load(argument, &error) != RT_OK) argp_error(state, "--plugin: %s", error.message);
    return 0;
}

const struct argp rt_plugin_argp = {.options = options, .parser = parse_option};

/* ---- the variable: files and folders joined by ':'; within a name '\:', and '\\' may be written, too ----
 */

/* After the first error nothing more is loaded. */
static void load_from(void *context, const char *path) {
    RtError *error = context;
    if (error->status == RT_OK) rt_plugin_load(path, error);
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

/* A folder stands for all its files that end in .so, in order of their names. */
static RtStatus load_list(const char *list, RtError *error) {
    char path[RT_MAX_PATH];
    struct stat about;
    while (*list) {
        list = take_path(list, path, sizeof path);
        if (!list) return rt_fail(error, RT_BAD_INPUT, "the path of a plugin is too long");
        error->status = RT_OK;
        if (*path && stat(path, &about) == 0 && S_ISDIR(about.st_mode)) {
            if (rt_directory_each(path, ".so", load_from, error) == 0) /* of sources, perhaps */
                fprintf(stderr,
                        "raytally: $" VARIABLE
                        ": there is no *.so in %s: name the folder that the plugin was "
                        "built in, as in %s/build\n",
                        path, path);
            RT_TRY(error->status);
        } else if (*path) {
            RT_TRY(rt_plugin_load(path, error));
        }
    }
    return RT_OK;
}

RtStatus rt_cli_load_plugins(int argc, char *const *argv, RtError *error) {
    static const char option[] = "--plugin";
    const size_t length = sizeof option - 1;
    const char *list = getenv(VARIABLE);
    rt_accel_plugin_hint = "--plugin FILE.so";
    if (list) RT_TRY(load_list(list, error));
    for (int i = 1; i < argc; i++) {
        if (strcmp(argv[i], "--") == 0) break;
        if (strncmp(argv[i], option, length) != 0) continue;
        if (argv[i][length] == '=') RT_TRY(rt_plugin_load(argv[i] + length + 1, error));
        if (argv[i][length] == '\0' && i + 1 < argc) RT_TRY(rt_plugin_load(argv[++i], error));
    }
    return RT_OK;
}

void rt_cli_plugin_arguments(char *out, size_t size) {
    for (size_t i = 0; i < given_count; i++) {
        rt_append_text(out, size, " --plugin");
        rt_append_argument(out, size, given[i]);
    }
}

void rt_cli_tell_plugins(const char *directory, const RtExperiment *experiment) {
    json_auto_t *manifest = NULL;
    json_t *change;
    const char *name;
    if (rt_manifest_read(directory, &manifest, NULL) != RT_OK) return;
    json_auto_t *then = rt_plugins_used_then(experiment, manifest);
    json_auto_t *changed = rt_plugins_changed_since(then, experiment);
    json_object_foreach(changed, name, change) {
        char sentence[RT_MAX_PLUGIN_CHANGE];
        rt_plugins_change_format(name, change, "then", "now", sentence);
        fprintf(stderr, "raytally: %s%smanifest.json: %s\n", directory, *directory ? "/" : "", sentence);
    }
}
