/* SPDX-License-Identifier: Apache-2.0 */
/* MTL, the materials of OBJ. Of each that has an image of its diffuse colour (map_Kd) the image, the name and
 * Kd are read; all else is as in the material that the scene gives the mesh. Materials without an image, and
 * libraries that do not exist, are ignored, as materials of all other formats are. A library or image that
 * cannot be read is left out with a warning: the geometry is known without it. */
#include "core/base/file.h"
#include "core/base/memory.h"
#include "core/scene/mesh.h"

enum { MOST_BYTES = 1 << 26 };

typedef struct Library {
    RtMeshReader *mesh;
    char folder[RT_MAX_PATH];
    RtMaterial material; /* the one being read */
} Library;

/* What failed for want of memory has failed; the rest is a warning. */
static RtStatus excuse(RtMeshReader *r, RtStatus status, const RtError *why) {
    if (status == RT_NO_MEMORY) *r->text.error = *why;
    if (status == RT_OK || status == RT_NO_MEMORY) return status;
    return rt_mesh_warn(r, "an image or library of materials is left out: %.600s", why->message);
}

/* Adds the material that was read, if it has an image. */
static RtStatus end_material(Library *library) {
    RtMeshReader *r = library->mesh;
    RtTexture *texture = &library->material.texture;
    uint32_t index;
    RtError why;
    if (!texture->texels) return RT_OK;
    const RtStatus status = rt_scene_add_material(r->scene, &library->material, &index, &why);
    rt_texels_release(texture->texels);
    *texture = (RtTexture){0};
    r->textured = r->textured || status == RT_OK;
    return excuse(r, status, &why);
}

/* The file is named by all of `text`, or after options by its last word; in Windows with backslashes. */
static RtStatus read_image(Library *library, const char *text) {
    RtTexture *texture = &library->material.texture;
    char name[RT_MAX_PATH], path[RT_MAX_PATH];
    RtError why;
    const char *blank = *text == '-' ? strrchr(text, ' ') : NULL;
    if (blank) RT_TRY(rt_mesh_warn(library->mesh, "options of map_Kd are ignored: %.60s", text));
    snprintf(name, sizeof name, "%s", blank ? blank + 1 : text);
    for (char *at = name; *at; at++) {
        if (*at == '\\') *at = '/';
    }
    rt_texels_release(texture->texels);
    *texture = (RtTexture){0};
    RtStatus status = rt_path_join(library->folder, name, path, &why);
    if (status == RT_OK) status = rt_scene_load_texels(library->mesh->scene, path, &texture->texels, &why);
    if (status == RT_OK) {
        texture->kind = RT_TEXTURE_IMAGE;
        texture->size = 1;
    }
    return excuse(library->mesh, status, &why);
}

/* A line without blanks at its ends. */
static RtStatus read_line(Library *library, const char *line, const RtMaterial *plain) {
    RtMaterial *m = &library->material;
    RtVec3 color;
    if (strncmp(line, "newmtl ", 7) == 0) {
        RT_TRY(end_material(library));
        *m = *plain;
        snprintf(m->name, sizeof m->name, "%s", line + 7);
    } else if (strncmp(line, "map_Kd ", 7) == 0) {
        return read_image(library, line + 7);
    } else if (sscanf(line, "Kd %f %f %f", &color.x, &color.y, &color.z) == 3 && rt_finite(color)) {
        for (int channel = 0; channel < 3; channel++) m->color.at[channel] = rt_maxf(color.at[channel], 0);
    }
    return RT_OK;
}

static RtStatus read_lines(Library *library, char *text, const RtMaterial *plain) {
    char *rest;
    for (char *at = text; *at; at++) {
        if (*at == '\t') *at = ' ';
    }
    for (char *line = strtok_r(text, "\r\n", &rest); line; line = strtok_r(NULL, "\r\n", &rest)) {
        size_t length = strlen(line += strspn(line, " "));
        while (length > 0 && line[length - 1] == ' ') line[--length] = 0;
        RT_TRY(read_line(library, line, plain));
    }
    return end_material(library);
}

RtStatus rt_mesh_read_mtl(RtMeshReader *r, RtWord name, const RtMaterial *plain) {
    Library library = {.mesh = r, .material = *plain};
    char folder[RT_MAX_PATH], file[RT_MAX_PATH], path[RT_MAX_PATH], *text;
    size_t size;
    RtError why;
    snprintf(file, sizeof file, "%.*s", (int)(name.length < RT_MAX_PATH ? name.length : RT_MAX_PATH),
             name.text);
    rt_path_folder(r->text.path, folder);
    RtStatus status = rt_path_join(folder, file, path, &why);
    if (status == RT_OK && (!*file || !rt_file_exists(path))) return RT_OK;
    if (status == RT_OK) status = rt_file_read_text(path, MOST_BYTES, &text, &size, &why);
    if (status != RT_OK) return excuse(r, status, &why);
    rt_path_folder(path, library.folder);
    status = read_lines(&library, text, plain);
    rt_texels_release(library.material.texture.texels);
    rt_free(text);
    return status;
}
