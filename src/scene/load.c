#include "scene/load.h"

#include "base/file.h"
#include "base/param.h"
#include "scene/nff.h"
#include "scenes/builtin.h"

#include <dirent.h>
#include <stdio.h>
#include <string.h>
#include <strings.h>
#include <sys/stat.h>

/* Formats with a reader of our own. */
typedef struct Format {
    const char *extension; /* without the dot */
    RtStatus (*load)(const char *path, RtScene *scene, RtError *error);
    RtStatus (*save)(const RtScene *scene, FILE *file, RtError *error);
} Format;

static const Format formats[] = {
    {"nff", rt_nff_load, rt_nff_save},
};

enum { FORMAT_COUNT = sizeof formats / sizeof formats[0] };

/* What follows the last dot of the last part of a path; "" if there is none. */
static const char *extension_of(const char *path) {
    const char *slash = strrchr(path, '/'), *dot = strrchr(path, '.');
    return dot && (!slash || dot > slash) ? dot + 1 : "";
}

static const Format *find_format(const char *extension) {
    for (int i = 0; i < FORMAT_COUNT; i++) {
        if (strcasecmp(formats[i].extension, extension) == 0) return &formats[i];
    }
    return NULL;
}

static RtStatus fail_extension(const char *path, RtError *error) {
    const char *names[FORMAT_COUNT];
    char list[256] = "";
    for (size_t i = 0; i < FORMAT_COUNT; i++) {
        names[i] = formats[i].extension;
        size_t used = strlen(list);
        snprintf(list + used, sizeof list - used, "%s.%s", i ? ", " : "", names[i]);
    }
    const char *extension = extension_of(path);
    const char *near = rt_nearest_name(extension, names, FORMAT_COUNT);
    return rt_fail(error, RT_BAD_INPUT, "%s: there is no scene format '.%.40s'%s%s%s Scenes are %s", path,
                   extension, near ? ": did you mean '." : "", near ? near : "", near ? "'?" : ".", list);
}

/* Names the file of the same folder whose name is nearest. */
static RtStatus fail_missing(const char *path, RtError *error) {
    const char *slash = strrchr(path, '/'), *name = slash ? slash + 1 : path;
    char folder[RT_MAX_PATH], best[256] = "";
    snprintf(folder, sizeof folder, "%.*s", slash ? (int)(slash - path + 1) : 2, slash ? path : "./");
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
                   best[0] ? ": did you mean '" : "", best[0] && slash ? folder : "", best,
                   best[0] ? "'?" : "");
}

static RtStatus load_file(const char *path, const Format *format, RtScene *scene, RtError *error) {
    rt_scene_init(scene);
    snprintf(scene->name, sizeof scene->name, "%.*s", (int)sizeof scene->name - 1, path);
    RtStatus status = format->load(path, scene, error);
    if (status == RT_OK && scene->geometry.object_count == 0) {
        status = rt_fail_at(error, path, 0, 0, "the scene is empty: it needs at least one object");
    }
    if (status == RT_OK) status = rt_scene_finish(scene, error);
    if (status != RT_OK) rt_scene_clear(scene);
    return status;
}

RtStatus rt_scene_open(const char *spec, RtScene *scene, RtError *error) {
    *scene = (RtScene){0};
    if (rt_builtin_find(spec)) return rt_builtin_open(spec, scene, error);
    struct stat found;
    bool exists = stat(spec, &found) == 0;
    if (exists && S_ISDIR(found.st_mode)) {
        return rt_fail(error, RT_BAD_INPUT, "%s is a folder: give the name of a file in it", spec);
    }
    const Format *format = find_format(extension_of(spec));
    if (format) return exists ? load_file(spec, format, scene, error) : fail_missing(spec, error);
    if (exists || strchr(spec, '/') || extension_of(spec)[0]) return fail_extension(spec, error);
    return rt_builtin_open(spec, scene, error); /* which says that there is none of that name */
}

RtStatus rt_scene_save(const RtScene *scene, const char *path, bool overwrite, RtError *error) {
    const Format *format = find_format(extension_of(path));
    if (!format) return fail_extension(path, error);
    if (!overwrite && rt_file_exists(path)) {
        return rt_fail(error, RT_BAD_INPUT, "%s exists already: remove it, or choose another name", path);
    }
    RtOutput output;
    RT_TRY(rt_output_open(&output, path, error));
    RtStatus status = format->save(scene, output.file, error);
    if (status == RT_OK) return rt_output_commit(&output, error);
    rt_output_discard(&output);
    return status;
}
