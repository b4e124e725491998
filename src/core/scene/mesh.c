/* SPDX-License-Identifier: Apache-2.0 */
/* Reading and writing meshes. Assimp's scene is a tree of nodes, each with a matrix and indices of meshes;
 * matrices are multiplied on the way down, in double, and every vertex is rounded to float32 once. For
 * writing, one aiScene of one mesh with three vertices per triangle is borrowed by Assimp's exporter. OBJ
 * is written here, because that exporter invents vertex normals. */
#include "core/scene/mesh.h"

#include "core/base/file.h"
#include "core/base/memory.h"

#include <assimp/cexport.h>
#include <assimp/cimport.h>
#include <assimp/postprocess.h>
#include <assimp/scene.h>
#include <stdio.h>
#include <string.h>
#include <strings.h>

typedef struct Reader {
    const char *path;
    const struct aiScene *file;
    RtScene *scene;
    uint32_t material;
    RtError *error;
} Reader;

static RtTransform transform_of(const struct aiMatrix4x4 *m) {
    return (RtTransform){{{(double)m->a1, (double)m->a2, (double)m->a3, (double)m->a4},
                          {(double)m->b1, (double)m->b2, (double)m->b3, (double)m->b4},
                          {(double)m->c1, (double)m->c2, (double)m->c3, (double)m->c4}}};
}

/* True if the transform turns the surface inside out: then the order of vertices is reversed and normals,
 * which transform by cofactors, change sign. */
static bool is_mirror(const RtTransform *t) {
    RtVec3d x = rt_transform_column(t, 0), y = rt_transform_column(t, 1), z = rt_transform_column(t, 2);
    return rt_dotd(rt_crossd(x, y), z) < 0;
}

static RtVec3 vector_at(const struct aiVector3D *vectors, unsigned i) {
    return rt_vec3(vectors[i].x, vectors[i].y, vectors[i].z);
}

/* Assimp triangulates without checking: it reads vertices that do not exist, and aborts at a face without
 * vertices. */
static RtStatus check_faces(const struct aiMesh *mesh, const char *path, RtError *error) {
    for (unsigned face = 0; face < mesh->mNumFaces; face++) {
        const struct aiFace *f = &mesh->mFaces[face];
        if (f->mNumIndices == 0)
            return rt_fail_at(error, path, 0, 0,
                              "face %u of mesh '%.60s' (counted from 0) has no vertices: the file is damaged",
                              face, mesh->mName.data);
        for (unsigned i = 0; i < f->mNumIndices; i++) {
            if (f->mIndices[i] < mesh->mNumVertices) continue;
            return rt_fail_at(error, path, 0, 0,
                              "face %u of mesh '%.60s' names vertex %u of %u: the file is damaged", face,
                              mesh->mName.data, f->mIndices[i], mesh->mNumVertices);
        }
    }
    return RT_OK;
}

static RtStatus check_vertices(const Reader *r, const struct aiMesh *mesh) {
    for (unsigned i = 0; i < mesh->mNumVertices; i++) {
        RtVec3 v = vector_at(mesh->mVertices, i);
        if (rt_finite(v)) continue;
        return rt_fail_at(
            r->error, r->path, 0, 0,
            "vertex %u of mesh '%.60s' (counted from 0) is not finite: (%g, %g, %g); repair the "
            "file",
            i, mesh->mName.data, (double)v.x, (double)v.y, (double)v.z);
    }
    return RT_OK;
}

static RtStatus add_face(const Reader *r, const struct aiMesh *mesh, unsigned face,
                         const RtTransform *transform, bool mirror) {
    RtVec3 vertices[3], normals[3];
    bool has_normals = mesh->mNormals != NULL;
    for (int i = 0; i < 3; i++) {
        unsigned vertex = mesh->mFaces[face].mIndices[mirror ? 2 - i : i];
        vertices[i] = rt_transform_point(transform, vector_at(mesh->mVertices, vertex));
        if (!has_normals) continue;
        RtVec3 normal = vector_at(mesh->mNormals, vertex);
        normals[i] = rt_transform_normal(transform, mirror ? rt_scale(normal, -1) : normal);
        has_normals = rt_finite(normals[i]) && rt_lengthd(rt_widen(normals[i])) > 0;
    }
    RtStatus status =
        rt_scene_add_triangle(r->scene, r->material, vertices, has_normals ? normals : NULL, r->error);
    if (status != RT_BAD_INPUT || !r->error) return status;
    RtError inner = *r->error;
    return rt_fail_at(r->error, r->path, 0, 0, "face %u of mesh '%.60s' (counted from 0): %s", face,
                      mesh->mName.data, inner.message);
}

static RtStatus add_mesh(const Reader *r, const struct aiMesh *mesh, const RtTransform *transform) {
    bool mirror = is_mirror(transform);
    RT_TRY(check_vertices(r, mesh));
    for (unsigned face = 0; face < mesh->mNumFaces; face++) {
        if (mesh->mFaces[face].mNumIndices != 3) continue; /* points and lines */
        RT_TRY(add_face(r, mesh, face, transform, mirror));
    }
    return RT_OK;
}

static RtStatus add_node(const Reader *r, const struct aiNode *node, const RtTransform *above) {
    RtTransform own = transform_of(&node->mTransformation), transform = rt_transform_compose(&own, above);
    for (unsigned i = 0; i < node->mNumMeshes; i++)
        RT_TRY(add_mesh(r, r->file->mMeshes[node->mMeshes[i]], &transform));
    for (unsigned i = 0; i < node->mNumChildren; i++) RT_TRY(add_node(r, node->mChildren[i], &transform));
    return RT_OK;
}

/* PLY and OFF headers declare the number of elements, and Assimp allocates them unchecked. So a header
 * that declares more elements than the file has bytes is rejected. */
static RtStatus check_header(FILE *file, const char *path, RtError *error) {
    fseek(file, 0, SEEK_END);
    long bytes = ftell(file);
    rewind(file);
    char line[256];
    bool ply = false, end = false;
    for (size_t number = 1; !end && fgets(line, sizeof line, file); number++) {
        unsigned long long count = 0;
        if (number == 1) {
            ply = strncmp(line, "ply", 3) == 0;
            end = !ply && strncmp(line, "OFF", 3) != 0;
            continue;
        }
        sscanf(line, ply ? "element %*s %llu" : "%llu", &count);
        if (bytes >= 0 && count > (unsigned long long)bytes)
            return rt_fail_at(error, path, number, 0,
                              "the header declares %llu elements, but the file has only %ld bytes: it is "
                              "truncated or damaged",
                              count, bytes);
        end = !ply || strncmp(line, "end_header", 10) == 0;
    }
    return RT_OK;
}

/* Imports the file with all polygons triangulated; free with aiReleaseImport. */
static RtStatus import(const char *path, const struct aiScene **out, RtError *error) {
    const struct aiScene *file = aiImportFile(path, 0);
    if (!file) return rt_fail_at(error, path, 0, 0, "Assimp cannot read this file: %s", aiGetErrorString());
    for (unsigned i = 0; i < file->mNumMeshes; i++) {
        RtStatus status = check_faces(file->mMeshes[i], path, error);
        if (status == RT_OK) continue;
        aiReleaseImport(file);
        return status;
    }
    *out = aiApplyPostProcessing(file, aiProcess_Triangulate); /* on failure this has freed the file */
    if (*out) return RT_OK;
    return rt_fail_at(error, path, 0, 0, "Assimp cannot split its polygons into triangles");
}

bool rt_mesh_reads(const char *extension) {
    char dotted[16];
    if (strlen(extension) + 2 > sizeof dotted || !extension[0]) return false;
    snprintf(dotted, sizeof dotted, ".%s", extension);
    return aiIsExtensionSupported(dotted);
}

RtStatus rt_mesh_append(RtScene *scene, const char *path, uint32_t material, const RtTransform *transform,
                        RtError *error) {
    FILE *opened;
    RT_TRY(rt_file_open(path, &opened, error));
    RtStatus status = check_header(opened, path, error);
    fclose(opened);
    if (status != RT_OK) return status;
    const struct aiScene *file;
    RT_TRY(import(path, &file, error));
    RtTransform identity = rt_transform_identity();
    Reader reader = {path, file, scene, material, error};
    uint32_t before = scene->geometry.object_count;
    if (file->mRootNode) status = add_node(&reader, file->mRootNode, transform ? transform : &identity);
    if (status == RT_OK && scene->geometry.object_count == before)
        status =
            rt_fail_at(error, path, 0, 0, "there is no triangle in this file: a mesh needs at least one");
    aiReleaseImport(file);
    return status;
}

RtStatus rt_mesh_load(const char *path, RtScene *scene, RtError *error) {
    uint32_t material;
    RtMaterial standard = rt_default_material();
    scene->camera.up = rt_vec3(0, 1, 0);
    RT_TRY(rt_scene_add_material(scene, &standard, &material, error));
    return rt_mesh_append(scene, path, material, NULL, error);
}

/* ---- writing ---- */

/* Assimp's name of each format, the binary variant if there are two; NULL: written here. */
static const struct {
    const char *extension, *format;
} writers[] = {{"obj", NULL}, {"ply", "plyb"}, {"stl", "stlb"}, {"glb", "glb2"}};

enum { WRITER_COUNT = sizeof writers / sizeof writers[0] };

const char *rt_mesh_written(size_t i) {
    return i < WRITER_COUNT ? writers[i].extension : NULL;
}

/* The arrays that the exporter reads. */
typedef struct Arrays {
    struct aiVector3D *vertices, *normals; /* [3 * triangles]; normals may be NULL */
    struct aiFace *faces;                  /* [triangles] */
    unsigned *indices;                     /* [3 * triangles] */
} Arrays;

static void free_arrays(Arrays *arrays) {
    rt_free(arrays->vertices);
    rt_free(arrays->normals);
    rt_free(arrays->faces);
    rt_free(arrays->indices);
}

static struct aiVector3D to_ai(RtVec3 v) {
    return (struct aiVector3D){v.x, v.y, v.z};
}

static void fill_normals(const RtGeometry *g, uint32_t triangle, struct aiVector3D normals[3]) {
    uint32_t entry = g->triangle_normals[triangle];
    RtVec3 geometric = rt_narrow(rt_triangle_normal(&g->triangles[triangle]));
    for (int k = 0; k < 3; k++)
        normals[k] = to_ai(entry == RT_NO_NORMALS ? geometric : g->vertex_normals[entry].n[k]);
}

static RtStatus make_arrays(const RtGeometry *g, Arrays *arrays, RtError *error) {
    size_t count = g->triangle_count, corners = 3 * count;
    bool with_normals = g->vertex_normal_count > 0;
    arrays->vertices = rt_alloc(corners, sizeof *arrays->vertices);
    arrays->faces = rt_alloc(count, sizeof *arrays->faces);
    arrays->indices = rt_alloc(corners, sizeof *arrays->indices);
    if (with_normals) arrays->normals = rt_alloc(corners, sizeof *arrays->normals);
    if (!arrays->vertices || !arrays->faces || !arrays->indices || (with_normals && !arrays->normals))
        return rt_fail_memory(error, "the mesh to be written", corners * sizeof *arrays->vertices);
    for (uint32_t i = 0; i < count; i++) {
        arrays->faces[i] = (struct aiFace){3, arrays->indices + 3 * (size_t)i};
        for (size_t k = 0; k < 3; k++) {
            arrays->vertices[3 * (size_t)i + k] = to_ai(g->triangles[i].v[k]);
            arrays->indices[3 * (size_t)i + k] = 3 * i + (unsigned)k;
        }
        if (with_normals) fill_normals(g, i, arrays->normals + 3 * (size_t)i);
    }
    return RT_OK;
}

static RtStatus export_arrays(const Arrays *arrays, uint32_t triangles, const char *format, FILE *file,
                              RtError *error) {
    struct aiMesh mesh = {.mPrimitiveTypes = aiPrimitiveType_TRIANGLE,
                          .mNumVertices = 3 * triangles,
                          .mVertices = arrays->vertices,
                          .mNormals = arrays->normals,
                          .mNumFaces = triangles,
                          .mFaces = arrays->faces};
    struct aiMesh *meshes[1] = {&mesh};
    struct aiMaterial material = {0};
    struct aiMaterial *materials[1] = {&material};
    unsigned first[1] = {0};
    const struct aiMatrix4x4 identity = {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1};
    struct aiNode root = {.mTransformation = identity, .mNumMeshes = 1, .mMeshes = first};
    struct aiScene scene = {
        .mRootNode = &root, .mNumMeshes = 1, .mMeshes = meshes, .mNumMaterials = 1, .mMaterials = materials};
    const struct aiExportDataBlob *blob = aiExportSceneToBlob(&scene, format, 0);
    if (!blob) return rt_fail(error, RT_IO, "Assimp could not write the scene as %s", format);
    size_t written = fwrite(blob->data, 1, blob->size, file);
    RtStatus status = written == blob->size ? RT_OK : rt_fail(error, RT_IO, "the mesh could not be written");
    aiReleaseExportBlob(blob);
    return status;
}

static RtStatus save_assimp(const RtGeometry *g, const char *format, FILE *file, RtError *error) {
    if (g->triangle_count == 0)
        return rt_fail(error, RT_BAD_INPUT,
                       "this format needs at least one triangle, and the scene has none: "
                       "write .yaml, .nff or .obj");
    if (g->triangle_count > UINT32_MAX / 3)
        return rt_fail(error, RT_BAD_INPUT, "%u triangles are too many for one mesh", g->triangle_count);
    Arrays arrays = {0};
    RtStatus status = make_arrays(g, &arrays, error);
    if (status == RT_OK) status = export_arrays(&arrays, g->triangle_count, format, file, error);
    free_arrays(&arrays);
    return status;
}

static void put_line(FILE *file, const char *word, RtVec3 v) {
    fprintf(file, "%s %.9g %.9g %.9g\n", word, (double)v.x, (double)v.y, (double)v.z);
}

/* Negative indices count from the end: -1 is the latest. */
static void save_obj(const RtGeometry *g, FILE *file) {
    for (uint32_t i = 0; i < g->triangle_count; i++) {
        uint32_t entry = g->triangle_normals ? g->triangle_normals[i] : RT_NO_NORMALS;
        for (int k = 0; k < 3; k++) {
            put_line(file, "v", g->triangles[i].v[k]);
            if (entry != RT_NO_NORMALS) put_line(file, "vn", g->vertex_normals[entry].n[k]);
        }
        fprintf(file, entry != RT_NO_NORMALS ? "f -3//-3 -2//-2 -1//-1\n" : "f -3 -2 -1\n");
    }
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
                       ".%s holds triangles only, but this scene has objects of other shapes "
                       "(%s: %u)%s",
                       extension, rt_shape_name((RtShape)shape), counts[shape],
                       g->csg_count == 0 ? ": write .yaml or .nff" : "");
    }
    return RT_OK;
}

RtStatus rt_mesh_save(const RtScene *scene, const char *extension, FILE *file, RtError *error) {
    int writer = 0;
    while (writer < WRITER_COUNT && strcasecmp(writers[writer].extension, extension) != 0) writer++;
    if (writer == WRITER_COUNT)
        return rt_fail(error, RT_BAD_INPUT, "meshes cannot be written as .%.40s", extension);
    RT_TRY(check_shapes(&scene->geometry, extension, error));
    if (writers[writer].format) return save_assimp(&scene->geometry, writers[writer].format, file, error);
    save_obj(&scene->geometry, file);
    return ferror(file) ? rt_fail(error, RT_IO, "the mesh could not be written") : RT_OK;
}
