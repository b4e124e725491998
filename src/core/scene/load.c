/* SPDX-License-Identifier: Apache-2.0 */
#include "core/scene/load.h"

#include "core/base/file.h"
#include "core/base/words.h"
#include "core/scene/mesh.h"
#include "core/scene/nff.h"

#include <dirent.h>
#include <float.h>
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

/* Warns if most objects are small beside the coordinates, because these are far from the origin. */
static RtStatus warn_far(RtScene *scene, const char *path, RtError *error) {
    enum { FAR = 10, SMALL = 10000 };
    const RtGeometry *g = &scene->geometry;
    const double largest = rt_box_largest_coordinate(g->box);
    uint32_t small = 0;
    if (largest < FAR * rt_box_longest_side(g->box)) return RT_OK;
    for (uint32_t i = 0; i < g->object_count; i++)
        small += rt_box_longest_side(g->boxes[i]) * SMALL < largest;
    if (small <= g->object_count / 2) return RT_OK;
    scene->warnings.first = scene->warnings.count;
    return rt_warn_at(&scene->warnings, path, 0, error,
                      "%u of %u objects are smaller than 10^-4 of their coordinates, of up to %.9g, where "
                      "float32 has steps of %g: `raytally convert --recentre` moves the scene before it is "
                      "rounded",
                      small, g->object_count, largest, largest - (double)nextafterf((float)largest, 0));
}

static RtStatus load(const char *path, RtSceneOpener *open_named, RtVec3d offset, bool warns, RtScene *scene,
                     RtError *error) {
    *scene = (RtScene){0};
    struct stat found;
    bool exists = stat(path, &found) == 0;
    if (exists && S_ISDIR(found.st_mode))
        return rt_fail(error, RT_BAD_INPUT, "%s is a folder: give the name of a file in it", path);
    size_t format;
    RT_TRY(rt_find_format(path, read_extension, "read", &format, error));
    if (!exists) return rt_file_is_dead_link(path, error) ? RT_BAD_INPUT : fail_missing(path, error);
    rt_scene_init(scene);
    scene->offset = offset;
    snprintf(scene->name, sizeof scene->name, "%.*s", (int)sizeof scene->name - 1, path);
    RtStatus status = format < FORMAT_COUNT ? formats[format].load(path, open_named, scene, error)
                                            : rt_mesh_load(path, scene, error);
    if (status == RT_OK && scene->geometry.object_count == 0)
        status = rt_fail_at(error, path, 0, 0, "the scene is empty: it needs at least one object");
    if (status == RT_OK) status = rt_scene_finish(scene, error);
    if (status == RT_OK && warns) status = warn_far(scene, path, error);
    if (status != RT_OK) rt_scene_clear(scene);
    return status;
}

/* The centre, in steps of an eighth to a quarter of the longest side. */
static RtVec3d find_center(RtBox box) {
    int exponent;
    RtVec3d center = rt_widen(rt_box_center(box));
    frexp(fmax(rt_box_longest_side(box), FLT_MIN), &exponent);
    const double step = ldexp(1, exponent - 3);
    for (int a = 0; a < 3; a++) center.at[a] = step * rint(center.at[a] / step) + 0.0; /* no -0 */
    return center;
}

RtStatus rt_scene_load(const char *path, RtSceneOpener *open_named, RtVec3d *offset, RtScene *scene,
                       RtError *error) {
    RtVec3d none = {{0, 0, 0}};
    if (offset && isnan(offset->x)) {
        const RtStatus status = load(path, open_named, none, false, scene, error);
        if (status == RT_BAD_INPUT && error) { /* perhaps rounding bends a polygon there */
            const RtError why = *error;
            return rt_fail(error, status, "%.900s (read to find its centre: or give --recentre=X,Y,Z)",
                           why.message);
        }
        RT_TRY(status);
        *offset = find_center(scene->geometry.box);
        rt_scene_clear(scene);
    }
    return load(path, open_named, offset ? *offset : none, true, scene, error);
}

static bool keeps_instances(size_t format) {
    return format < FORMAT_COUNT && formats[format].save == rt_yaml_save;
}

bool rt_scene_keeps_instances(const char *path) {
    size_t format;
    return rt_find_format(path, written_extension, "written", &format, NULL) == RT_OK &&
           keeps_instances(format);
}

/* The format has no instances: they are written as copies. */
static RtStatus save_flat(const RtScene *scene, const char *path, RtError *error) {
    RtScene flat;
    RT_TRY(rt_scene_flatten(scene, &flat, error));
    const RtStatus status = rt_scene_save(&flat, path, error);
    rt_scene_clear(&flat);
    return status;
}

RtStatus rt_scene_save(const RtScene *scene, const char *path, RtError *error) {
    size_t format;
    RT_TRY(rt_find_format(path, written_extension, "written", &format, error));
    if (scene->geometry.instance_count > 0 && !keeps_instances(format)) return save_flat(scene, path, error);
    RtOutput output;
    RT_TRY(rt_output_open(&output, path, error));
    RtStatus status = format < FORMAT_COUNT ? formats[format].save(scene, output.file, error)
                                            : rt_mesh_save(scene, format - FORMAT_COUNT, output.file, error);
    if (status == RT_OK) return rt_output_commit(&output, error);
    rt_output_discard(&output);
    return status;
}
