/* SPDX-License-Identifier: Apache-2.0 */
/* Writing NFF: camera, background, lights, then the objects in order, with an `f` wherever the material
 * changes. */
#include "core/scene/nff.h"

#include <errno.h>
#include <string.h>

/* 9 digits restore every float32. */
static void put(FILE *file, float number) {
    fprintf(file, " %.9g", (double)number);
}

static void put_vector(FILE *file, const char *before, RtVec3 v) {
    fputs(before, file);
    for (int a = 0; a < 3; a++) put(file, v.at[a]);
}

static void save_header(const RtScene *scene, FILE *file) {
    const RtCamera *camera = &scene->camera;
    put_vector(file, "b", scene->background);
    put_vector(file, "\nv\nfrom", camera->from);
    put_vector(file, "\nat", camera->at);
    put_vector(file, "\nup", camera->up);
    fprintf(file, "\nangle");
    put(file, camera->fov);
    fprintf(file, "\nhither");
    put(file, camera->near);
    fprintf(file, "\nresolution %u %u\n", camera->width, camera->height);
    for (uint32_t i = 0; i < scene->light_count; i++) {
        put_vector(file, "l", scene->lights[i].position);
        put_vector(file, "", scene->lights[i].intensity);
        fprintf(file, "\n");
    }
}

static void save_material(const RtMaterial *material, FILE *file) {
    put_vector(file, "f", material->color);
    put(file, material->diffuse);
    put(file, material->reflection);
    put(file, material->shine);
    put(file, material->transmission);
    put(file, material->ior);
    fprintf(file, "\n");
}

static void save_polygon(const RtGeometry *g, uint32_t index, FILE *file) {
    const RtPolygon *polygon = &g->polygons[index];
    fprintf(file, "p %u", polygon->count);
    for (uint32_t i = 0; i < polygon->count; i++)
        put_vector(file, "\n", g->polygon_vertices[polygon->first + i]);
}

static void save_triangle(const RtGeometry *g, uint32_t index, FILE *file) {
    static const RtVertexNormals any = {{{0, 0, 1}, {0, 0, 1}, {0, 0, 1}}};
    const RtTriangle *triangle = &g->triangles[index];
    uint32_t entry = g->triangle_normals ? g->triangle_normals[index] : RT_NO_NORMALS;
    const RtVertexNormals *normals = entry != RT_NO_NORMALS ? &g->vertex_normals[entry] : NULL;
    if (!normals && rt_lengthd(rt_triangle_normal(triangle)) == 0) normals = &any;
    fprintf(file, normals ? "pp 3" : "p 3");
    for (int i = 0; i < 3; i++) {
        put_vector(file, "\n", triangle->v[i]);
        if (normals) put_vector(file, "", normals->n[i]);
    }
}

static void save_object(const RtGeometry *g, RtRef ref, FILE *file) {
    uint32_t index = rt_ref_index(ref);
    switch (rt_ref_shape(ref)) {
    case RT_SHAPE_SPHERE:
        put_vector(file, "s", g->spheres[index].center);
        put(file, g->spheres[index].radius);
        break;
    case RT_SHAPE_CONE:
        put_vector(file, "c", g->cones[index].base);
        put(file, g->cones[index].base_radius);
        put_vector(file, "\n", g->cones[index].apex);
        put(file, g->cones[index].apex_radius);
        break;
    case RT_SHAPE_POLYGON: save_polygon(g, index, file); break;
    case RT_SHAPE_TRIANGLE: save_triangle(g, index, file); break;
    case RT_SHAPE_CSG: /* rejected earlier */
    case RT_SHAPE_COUNT: break;
    }
    fprintf(file, "\n");
}

RtStatus rt_nff_save(const RtScene *scene, FILE *file, RtError *error) {
    if (scene->geometry.csg_count > 0)
        return rt_fail(error, RT_BAD_INPUT, "NFF has no CSG trees, and in this scene there are %u",
                       scene->geometry.csg_count);
    save_header(scene, file);
    for (uint32_t id = 0; id < scene->geometry.object_count; id++) {
        if (id == 0 || scene->material_of[id] != scene->material_of[id - 1])
            save_material(&scene->materials[scene->material_of[id]], file);
        save_object(&scene->geometry, scene->geometry.objects[id], file);
        if (ferror(file)) return rt_fail(error, RT_IO, "NFF could not be written: %s", strerror(errno));
    }
    return RT_OK;
}
