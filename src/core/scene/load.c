/* SPDX-License-Identifier: Apache-2.0 */
#include "core/scene/load.h"

#include "core/base/file.h"
#include "core/base/words.h"
#include "core/scene/mesh.h"
#include "core/scene/nff.h"

#include <dirent.h>
#include <stdio.h>
#include <string.h>
#include <sys/stat.h>

/* The formats of whole scenes; those of meshes follow. */
static const struct {
    const char *extension; /* without the dot */
    RtStatus (*load)(const char *path, RtSceneOpener *open_named, RtScene *scene, RtError *error);
    RtStatus (*save)(const RtScene *scene, FILE *file, RtError *error);
} formats[] = {
    {"yaml", rt_yaml_load, rt_yaml_save},
    {"yml", rt_yaml_load, rt_yaml_save},
    {"nff", rt_nff_load, rt_nff_save},
};

enum { FORMAT_COUNT = sizeof formats / sizeof formats[0] };

static const char *read_extension(size_t i) {
    return i < FORMAT_COUNT ? formats[i].extension : rt_mesh_extension(i - FORMAT_COUNT);
}

static const char *written_extension(size_t i) {
    return i < FORMAT_COUNT + RT_MESH_WRITTEN ? read_extension(i) : NULL;
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
    return rt_file_exists(spec) || strchr(spec, '/') || strchr(spec, '.');
}

RtStatus rt_scene_load(const char *path, RtSceneOpener *open_named, RtScene *scene, RtError *error) {
    *scene = (RtScene){0};
    struct stat found;
    bool exists = stat(path, &found) == 0;
    if (exists && S_ISDIR(found.st_mode))
        return rt_fail(error, RT_BAD_INPUT, "%s is a folder: give the name of a file in it", path);
    size_t format;
    RT_TRY(rt_find_format(path, read_extension, "read", &format, error));
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
    size_t format;
    RT_TRY(rt_find_format(path, written_extension, "written", &format, error));
    if (!overwrite && rt_file_exists(path))
        return rt_fail(error, RT_BAD_INPUT,
                       "%s already exists: remove it, choose another name, or convert with --force", path);
    RtOutput output;
    RT_TRY(rt_output_open(&output, path, error));
    RtStatus status = format < FORMAT_COUNT ? formats[format].save(scene, output.file, error)
                                            : rt_mesh_save(scene, format - FORMAT_COUNT, output.file, error);
    if (status == RT_OK) return rt_output_commit(&output, error);
    rt_output_discard(&output);
    return status;
}
