/* SPDX-License-Identifier: Apache-2.0 */
#include "core/scene/load.h"

#include "core/base/file.h"
#include "core/base/words.h"
#include "core/scene/mesh.h"
#include "core/scene/nff.h"
#include "core/scene/yaml.h"

#include <dirent.h>
#include <stdio.h>
#include <string.h>
#include <strings.h>
#include <sys/stat.h>

static RtStatus load_nff(const char *path, RtSceneOpener *open_named, RtScene *scene, RtError *error) {
    (void)open_named;
    return rt_nff_load(path, scene, error);
}

/* The formats of whole scenes; all others are meshes. */
static const struct {
    const char *extension; /* without the dot */
    RtStatus (*load)(const char *path, RtSceneOpener *open_named, RtScene *scene, RtError *error);
    RtStatus (*save)(const RtScene *scene, FILE *file, RtError *error);
} formats[] = {
    {"yaml", rt_yaml_load, rt_yaml_save},
    {"yml", rt_yaml_load, rt_yaml_save},
    {"nff", load_nff, rt_nff_save},
};

enum { FORMAT_COUNT = sizeof formats / sizeof formats[0], MOST_NAMES = FORMAT_COUNT + 8 };

/* The text after the last dot of the last path component, or "". */
static const char *extension_of(const char *path) {
    const char *dot = strrchr(basename(path), '.');
    return dot ? dot + 1 : "";
}

/* Lists the extensions that can be read, or written (rt_mesh_read, rt_mesh_written), in names[0..MOST_NAMES);
 * returns their number. */
static size_t list_formats(const char *(*mesh)(size_t i), const char *names[MOST_NAMES]) {
    size_t count = 0;
    for (int i = 0; i < FORMAT_COUNT; i++) names[count++] = formats[i].extension;
    for (size_t i = 0; mesh(i) && count < MOST_NAMES; i++) names[count++] = mesh(i);
    return count;
}

/* The number of the format of `path` in a list, or `count`. */
static size_t find_format(const char *path, const char *const *names, size_t count) {
    size_t i = 0;
    while (i < count && strcasecmp(names[i], extension_of(path)) != 0) i++;
    return i;
}

static RtStatus fail_extension(const char *path, const char *doing, const char *const *names, size_t count,
                               RtError *error) {
    const char *extension = extension_of(path);
    char list[256] = "";
    for (size_t i = 0; i < count; i++) {
        size_t used = strlen(list);
        snprintf(list + used, sizeof list - used, "%s.%s", i ? " " : "", names[i]);
    }
    const char *near = rt_nearest_name(extension, names, count);
    return rt_fail(error, RT_BAD_INPUT, "%s: no format '.%.40s' can be %s%s%s%s These can: %s", path,
                   extension, doing, near ? ": did you mean '." : "", near ? near : "", near ? "'?" : ".",
                   list);
}

/* Suggests the file with the nearest name in the same folder. */
static RtStatus fail_missing(const char *path, RtError *error) {
    const char *name = basename(path);
    const bool in_folder = name > path;
    char folder[RT_MAX_PATH], best[256] = "";
    snprintf(folder, sizeof folder, "%.*s", in_folder ? (int)(name - path) : 2, in_folder ? path : "./");
    DIR *dir = opendir(folder);
    if (!dir) return rt_fail(error, RT_BAD_INPUT, "%s: there is no such file, nor a folder %s", path, folder);
    for (struct dirent *entry; (entry = readdir(dir));) {
        const char *names[2] = {entry->d_name, best};
        if (entry->d_name[0] == '.') continue;
        const char *near = rt_nearest_name(name, names, best[0] ? 2 : 1);
        if (near && near != best) snprintf(best, sizeof best, "%s", near);
    }
    closedir(dir);
    return rt_fail(error, RT_BAD_INPUT, "%s: there is no such file%s%s%s%s", path,
                   best[0] ? ": did you mean '" : "", best[0] && in_folder ? folder : "", best,
                   best[0] ? "'?" : "");
}

bool rt_scene_is_file(const char *spec) {
    return rt_file_exists(spec) || strchr(spec, '/') || extension_of(spec)[0];
}

RtStatus rt_scene_load(const char *path, RtSceneOpener *open_named, RtScene *scene, RtError *error) {
    *scene = (RtScene){0};
    struct stat found;
    bool exists = stat(path, &found) == 0;
    if (exists && S_ISDIR(found.st_mode))
        return rt_fail(error, RT_BAD_INPUT, "%s is a folder: give the name of a file in it", path);
    const char *names[MOST_NAMES];
    const size_t count = list_formats(rt_mesh_read, names), format = find_format(path, names, count);
    if (format == count) return fail_extension(path, "read", names, count, error);
    if (!exists) return rt_file_is_dead_link(path, error) ? RT_BAD_INPUT : fail_missing(path, error);
    rt_scene_init(scene);
    snprintf(scene->name, sizeof scene->name, "%.*s", (int)sizeof scene->name - 1, path);
    RtStatus status = format < FORMAT_COUNT ? formats[format].load(path, open_named, scene, error)
                                            : rt_mesh_load(path, scene, error);
    if (status == RT_OK && scene->geometry.object_count == 0)
        status = rt_fail_at(error, path, 0, 0, "the scene is empty: it needs at least one object");
    if (status == RT_OK) status = rt_scene_finish(scene, error);
    if (status != RT_OK) rt_scene_clear(scene);
    return status;
}

RtStatus rt_scene_save(const RtScene *scene, const char *path, bool overwrite, RtError *error) {
    const char *names[MOST_NAMES];
    const size_t count = list_formats(rt_mesh_written, names), format = find_format(path, names, count);
    if (format == count) return fail_extension(path, "written", names, count, error);
    if (!overwrite && rt_file_exists(path))
        return rt_fail(error, RT_BAD_INPUT,
                       "%s already exists: remove it, choose another name, or convert with --force", path);
    RtOutput output;
    RT_TRY(rt_output_open(&output, path, error));
    RtStatus status = format < FORMAT_COUNT ? formats[format].save(scene, output.file, error)
                                            : rt_mesh_save(scene, names[format], output.file, error);
    if (status == RT_OK) return rt_output_commit(&output, error);
    rt_output_discard(&output);
    return status;
}
