/* SPDX-License-Identifier: Apache-2.0 */
/* Writing meshes: one aiScene of one mesh, three vertices a triangle, borrowed by Assimp's exporter, which
 * gives the bytes of the file. OBJ is written here, because that exporter makes up vertex normals. */
#include "core/scene/mesh.h"

#include "core/base/memory.h"

#include <assimp/cexport.h>
#include <assimp/scene.h>
#include <strings.h>

/* Assimp's name of each format, the binary one where there are two; NULL: written here. */
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
    for (int k = 0; k < 3; k++) {
        normals[k] = to_ai(entry == RT_NO_NORMALS ? geometric : g->vertex_normals[entry].n[k]);
    }
}

static RtStatus make_arrays(const RtGeometry *g, Arrays *arrays, RtError *error) {
    size_t count = g->triangle_count, corners = 3 * count;
    bool with_normals = g->vertex_normal_count > 0;
    arrays->vertices = rt_alloc(corners, sizeof *arrays->vertices);
    arrays->faces = rt_alloc(count, sizeof *arrays->faces);
    arrays->indices = rt_alloc(corners, sizeof *arrays->indices);
    if (with_normals) arrays->normals = rt_alloc(corners, sizeof *arrays->normals);
    if (!arrays->vertices || !arrays->faces || !arrays->indices || (with_normals && !arrays->normals)) {
        return rt_fail_memory(error, "the mesh to be written", corners * sizeof *arrays->vertices);
    }
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
    if (g->triangle_count == 0) {
        return rt_fail(error, RT_BAD_INPUT,
                       "this format holds one triangle or more, and the scene has none: "
                       "write .yaml, .nff or .obj");
    }
    if (g->triangle_count > UINT32_MAX / 3) {
        return rt_fail(error, RT_BAD_INPUT, "%u triangles are too many for one mesh", g->triangle_count);
    }
    Arrays arrays = {0};
    RtStatus status = make_arrays(g, &arrays, error);
    if (status == RT_OK) status = export_arrays(&arrays, g->triangle_count, format, file, error);
    free_arrays(&arrays);
    return status;
}

static void put_line(FILE *file, const char *word, RtVec3 v) {
    fprintf(file, "%s %.9g %.9g %.9g\n", word, (double)v.x, (double)v.y, (double)v.z);
}

/* Indices from the end: -1 is the latest. */
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
    if (writer == WRITER_COUNT) {
        return rt_fail(error, RT_BAD_INPUT, "meshes cannot be written as .%.40s", extension);
    }
    RT_TRY(check_shapes(&scene->geometry, extension, error));
    if (writers[writer].format) return save_assimp(&scene->geometry, writers[writer].format, file, error);
    save_obj(&scene->geometry, file);
    return ferror(file) ? rt_fail(error, RT_IO, "the mesh could not be written") : RT_OK;
}
