/* SPDX-License-Identifier: Apache-2.0 */
#include "core/scene/mesh.h"

#include "core/base/file.h"
#include "core/base/memory.h"
#include "core/scene/mesh_reader.h"

#include <string.h>
#include <strings.h>

typedef struct Format {
    const char *extension;
    bool text;
    RtStatus (*check)(const RtMeshHead *head, RtError *error); /* or NULL */
    RtStatus (*read)(RtMeshReader *r);
} Format;

static const Format formats[] = {
    {"obj", true, NULL, rt_mesh_read_obj},
    {"ply", false, rt_mesh_check_ply, rt_mesh_read_ply},
    {"stl", false, rt_mesh_check_stl, rt_mesh_read_stl},
    {"off", true, NULL, rt_mesh_read_off},
    {"gltf", true, NULL, rt_mesh_read_gltf},
    {"glb", false, rt_mesh_check_glb, rt_mesh_read_glb},
};

enum { FORMAT_COUNT = sizeof formats / sizeof formats[0] };

const char *rt_mesh_read(size_t i) {
    return i < FORMAT_COUNT ? formats[i].extension : NULL;
}

static const Format *find_format(const char *path) {
    const char *dot = strrchr(basename(path), '.');
    for (int i = 0; dot && i < FORMAT_COUNT; i++) {
        if (strcasecmp(formats[i].extension, dot + 1) == 0) return &formats[i];
    }
    return NULL;
}

static RtStatus check_head(const Format *format, const char *path, RtError *error) {
    FILE *file;
    RtMeshHead head = {.path = path};
    if (!format->check) return RT_OK;
    RT_TRY(rt_file_open(path, &file, error));
    const size_t got = fread(head.bytes, 1, RT_MESH_HEAD, file);
    const long size = fseek(file, 0, SEEK_END) == 0 ? ftell(file) : -1;
    fclose(file);
    head.size = size < 0 ? got : (uint64_t)size;
    return format->check(&head, error);
}

static RtStatus read_mesh(const Format *format, RtMeshReader *r) {
    const uint32_t before = r->scene->geometry.object_count;
    RT_TRY(format->read(r));
    if (r->scene->geometry.object_count > before) return RT_OK;
    return rt_fail_at(r->text.error, r->text.path, 0, 0,
                      "there is no triangle in this file: a mesh needs at least one");
}

RtStatus rt_mesh_append(RtScene *scene, const char *path, uint32_t material, const RtTransform *transform,
                        RtError *error) {
    const Format *format = find_format(path);
    RtError own;
    char *data;
    size_t size;
    if (!format)
        return rt_fail(error, RT_BAD_INPUT,
                       "%s: the name of a mesh ends in .obj, .ply, .stl, .off, .gltf or .glb", path);
    RT_TRY(check_head(format, path, error));
    RT_TRY((format->text ? rt_file_read_text : rt_file_read)(path, RT_MESH_MAX_BYTES, &data, &size, error));
    RtMeshReader reader = {.text = {.path = path,
                                    .at = data,
                                    .end = data + size,
                                    .line = 1,
                                    .fresh = true,
                                    .error = error ? error : &own},
                           .scene = scene,
                           .material = material,
                           .transform = transform ? *transform : rt_transform_identity()};
    RtStatus status = read_mesh(format, &reader);
    rt_free(reader.vertices);
    rt_free(reader.normals);
    rt_free(reader.corners);
    rt_free(data);
    return status;
}

RtStatus rt_mesh_load(const char *path, RtScene *scene, RtError *error) {
    uint32_t material;
    RtMaterial standard = rt_default_material();
    scene->camera.up = rt_vec3(0, 1, 0);
    RT_TRY(rt_scene_add_material(scene, &standard, &material, error));
    return rt_mesh_append(scene, path, material, NULL, error);
}
