/* SPDX-License-Identifier: Apache-2.0 */
#include "core/scene/mesh.h"

#include "core/base/file.h"
#include "core/base/memory.h"
#include "core/base/words.h"

typedef struct Format {
    const char *extension;
    RtStatus (*check)(RtMeshReader *r, const RtMeshHead *head); /* or NULL */
    RtStatus (*read)(RtMeshReader *r);
    void (*write)(const RtGeometry *geometry, FILE *file); /* of the first RT_MESH_WRITTEN */
    uint32_t most;                                         /* triangles that can be written */
    bool text;                                             /* begins as text */
} Format;

static const Format formats[] = {
    {"obj", NULL, rt_mesh_read_obj, rt_mesh_write_obj, UINT32_MAX, true},
    {"ply", rt_mesh_check_ply, rt_mesh_read_ply, rt_mesh_write_ply, UINT32_MAX / 3, false},
    {"stl", rt_mesh_check_stl, rt_mesh_read_stl, rt_mesh_write_stl, UINT32_MAX, false},
    {"glb", rt_mesh_check_glb, rt_mesh_read_glb, rt_mesh_write_glb, UINT32_MAX / (3 * sizeof(RtTriangle)),
     false},
    {"gltf", NULL, rt_mesh_read_gltf, NULL, 0, true},
    {"off", NULL, rt_mesh_read_off, NULL, 0, true},
};

const char *rt_mesh_extension(size_t i) {
    return i < sizeof formats / sizeof formats[0] ? formats[i].extension : NULL;
}

/* What is no mesh at all, but often has the name of one. */
static RtStatus check_contents(RtMeshReader *r, const RtMeshHead *head, bool text) {
    static const char *const pointers[] = {"version https://git-lfs", "/annex/objects/"};
    const bool wide = memcmp(head->bytes, "\xFF\xFE", 2) == 0 || memcmp(head->bytes, "\xFE\xFF", 2) == 0;
    for (size_t i = 0; i < 2; i++) {
        if (memcmp(head->bytes, pointers[i], strlen(pointers[i])) == 0)
            return rt_mesh_fail(r, "this is a pointer to the mesh, which was not fetched: `git %s` does",
                                i == 0 ? "lfs pull" : "annex get");
    }
    if (wide) return rt_mesh_fail(r, "this is text in UTF-16: save it as UTF-8");
    if (!text || head->size == 0 || head->bytes[0]) return RT_OK;
    const char *start = (const char *)head->bytes;
    return rt_file_fail_zero(r->text.path, start, start, r->text.error);
}

static RtStatus check_head(const Format *format, RtMeshReader *r) {
    FILE *file;
    RtMeshHead head = {.size = 0};
    RT_TRY(rt_file_open(r->text.path, &file, r->text.error));
    const size_t got = fread(head.bytes, 1, RT_MESH_HEAD, file);
    const long size = fseek(file, 0, SEEK_END) == 0 ? ftell(file) : -1;
    fclose(file);
    head.size = size < 0 ? got : (uint64_t)size;
    RT_TRY(check_contents(r, &head, format->text));
    return format->check ? format->check(r, &head) : RT_OK;
}

/* With what was found instead, and the first warning, which may say why. */
static RtStatus fail_empty(const RtMeshReader *r) {
    const RtWarnings *warnings = &r->scene->warnings;
    const bool warned = warnings->count > warnings->first;
    return rt_mesh_fail(
        r, "there is no triangle in this file (%u vertices, %u faces): a mesh needs at least one%s%.400s",
        r->vertex_count, r->face_count, warned ? "; " : "",
        warned ? warnings->list[warnings->first].message : "");
}

RtStatus rt_mesh_append(RtScene *scene, const char *path, uint32_t material, const RtTransform *transform,
                        bool whole, RtError *error) {
    RtError own;
    char *data;
    size_t size, number;
    RT_TRY(rt_find_format(path, rt_mesh_extension, "read as a mesh", &number, error));
    const Format *format = &formats[number];
    RtMeshReader r = {.text = {.path = path, .error = error ? error : &own},
                      .scene = scene,
                      .material = material,
                      .whole = whole,
                      .transform = transform ? *transform : rt_transform_identity()};
    for (int a = 0; a < 3; a++) r.transform.m[a][3] -= scene->offset.at[a];
    r.textured = scene->materials[material].texture.kind != RT_TEXTURE_NONE;
    r.moves = rt_lengthd(rt_transform_column(&r.transform, 3)) > 0;
    scene->warnings.first = scene->warnings.count;
    RT_TRY(check_head(format, &r));
    RT_TRY(rt_file_read(path, RT_MESH_MAX_BYTES, &data, &size, error));
    rt_scan_begin(&r.text, data, size);
    const uint32_t before = scene->geometry.object_count;
    RtStatus status = format->read(&r);
    r.text.last = 0;
    if (status == RT_OK && scene->geometry.object_count == before) status = fail_empty(&r);
    rt_free(r.vertices);
    rt_free(r.normals);
    rt_free(r.uvs);
    rt_free(r.corners);
    rt_free(data);
    return status;
}

RtStatus rt_mesh_load(const char *path, RtScene *scene, RtError *error) {
    uint32_t material;
    RtMaterial standard = rt_default_material();
    scene->camera.up = rt_vec3(0, 1, 0);
    RT_TRY(rt_scene_add_material(scene, &standard, &material, error));
    return rt_mesh_append(scene, path, material, NULL, true, error);
}

static RtStatus check_shapes(const RtGeometry *g, const char *extension, RtError *error) {
    const uint32_t counts[RT_SHAPE_COUNT] = {
#define COUNT(CONSTANT, name, Type) g->name##_count,
        RT_SHAPES(COUNT)
#undef COUNT
    };
    for (int shape = 0; shape < RT_SHAPE_COUNT; shape++) {
        if (shape == RT_SHAPE_TRIANGLE || counts[shape] == 0) continue;
        return rt_fail(error, RT_BAD_INPUT,
                       ".%s holds triangles only, but this scene has objects of other shapes (%s: %u)%s",
                       extension, rt_shape_name((RtShape)shape), counts[shape],
                       g->csg_count == 0 ? ": write .yaml or .nff" : "");
    }
    return RT_OK;
}

RtStatus rt_mesh_save(const RtScene *scene, size_t i, FILE *file, RtError *error) {
    const RtGeometry *g = &scene->geometry;
    const Format *format = &formats[i];
    RT_TRY(check_shapes(g, format->extension, error));
    if (g->triangle_count == 0)
        return rt_fail(error, RT_BAD_INPUT,
                       "a mesh needs at least one triangle, and the scene has none: write .yaml or .nff");
    if (g->triangle_count > format->most)
        return rt_fail(error, RT_BAD_INPUT, "%u triangles are too many for .%s, which holds %u at most",
                       g->triangle_count, format->extension, format->most);
    format->write(g, file);
    return ferror(file) ? rt_fail(error, RT_IO, "the mesh could not be written") : RT_OK;
}
