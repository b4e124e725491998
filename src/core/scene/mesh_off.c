/* SPDX-License-Identifier: Apache-2.0 */
/* OFF, of Geomview: the numbers of vertices, polygons and edges, then each vertex and each polygon, as lines
 * of text or in binary, high byte first. Letters before the keyword say what follows the coordinates of a
 * vertex: N a normal, C a colour, ST texture coordinates; only the normal is used. The keyword may be
 * missing, and the counts may follow it without a blank. */
#include "core/scene/mesh.h"

enum { NORMAL = 1, COLOUR = 2, TEXTURE = 4 };

typedef struct Off {
    RtMeshReader *mesh;
    unsigned parts; /* of a vertex, behind x y z */
    bool binary;
} Off;

/* ---- text ---- */

/* Nothing is allocated for a count: the file must have the elements. */
static RtStatus take_count(RtMeshReader *r, uint64_t *out) {
    const RtWord word = rt_scan_peek(&r->text);
    int64_t count = 0;
    if (word.length == 0) return rt_scan_fail(&r->text, word, "the numbers of vertices, faces and edges");
    rt_scan_take(&r->text, word);
    RT_TRY(rt_mesh_integer(r, word, &count));
    if (count < 0) return rt_scan_fail(&r->text, word, "a count of at least 0");
    *out = (uint64_t)count;
    return RT_OK;
}

static RtStatus read_vertex(const Off *off) {
    RtMeshReader *r = off->mesh;
    RtVec3 vertex, normal;
    RT_TRY(rt_mesh_take_vector(r, true, "the x y z of a vertex", &vertex));
    if (off->parts & NORMAL) {
        RT_TRY(rt_mesh_take_normal(r, &normal));
        RT_TRY(rt_mesh_add_normal(r, normal));
    }
    rt_scan_skip_line(&r->text);
    return rt_mesh_add_vertex(r, vertex);
}

static RtStatus read_face(const Off *off) {
    RtMeshReader *r = off->mesh;
    RtWord word;
    int64_t count = 0, index = 0;
    RT_TRY(rt_mesh_take(r, true, "a number of corners", &word));
    RT_TRY(rt_mesh_integer(r, word, &count));
    for (int64_t i = 0; i < count; i++) {
        RT_TRY(rt_mesh_take(r, false, "the index of a vertex", &word));
        RT_TRY(rt_mesh_integer(r, word, &index));
        RT_TRY(rt_mesh_add_index(r, (double)index));
    }
    rt_scan_skip_line(&r->text);
    return rt_mesh_add_polygon(r);
}

/* ---- binary ---- */

static RtStatus take_words(RtMeshReader *r, uint32_t count, void *out) {
    RtScanner *text = &r->text;
    if ((size_t)(text->end - text->at) / sizeof(uint32_t) < count)
        return rt_mesh_fail(r, "the file ends inside a vertex or face");
    for (uint32_t i = 0; i < count; i++) {
        const uint32_t word = __builtin_bswap32(rt_mesh_u32(text->at));
        memcpy((char *)out + sizeof word * i, &word, sizeof word);
        text->at += sizeof word;
    }
    return RT_OK;
}

static RtStatus read_binary_vertex(const Off *off) {
    RtVec3 parts[2];
    float unused[6];
    RT_TRY(take_words(off->mesh, off->parts & NORMAL ? 6 : 3, parts));
    RT_TRY(take_words(off->mesh, (off->parts & COLOUR ? 4 : 0) + (off->parts & TEXTURE ? 2 : 0), unused));
    if (off->parts & NORMAL) RT_TRY(rt_mesh_add_normal(off->mesh, parts[1]));
    return rt_mesh_add_vertex(off->mesh, parts[0]);
}

static RtStatus read_binary_face(const Off *off) {
    uint32_t count, word;
    RT_TRY(take_words(off->mesh, 1, &count));
    for (; count > 0; count--) {
        RT_TRY(take_words(off->mesh, 1, &word));
        RT_TRY(rt_mesh_add_index(off->mesh, word));
    }
    RT_TRY(take_words(off->mesh, 1, &count)); /* of numbers of its colour */
    for (; count > 0; count--) RT_TRY(take_words(off->mesh, 1, &word));
    return rt_mesh_add_polygon(off->mesh);
}

/* ---- the file ---- */

RtStatus rt_mesh_check_off(RtMeshReader *r, const RtMeshHead *head) {
    return head->bytes[0] || head->size == 0
               ? RT_OK
               : rt_mesh_fail(r, "this is no OFF file: it begins with a byte of 0");
}

/* Takes the letters and the keyword at the beginning of the first word, if they are there. */
static RtStatus take_keyword(Off *off) {
    static const char *const letters[] = {"ST", "C", "N"};
    static const unsigned parts[] = {TEXTURE, COLOUR, NORMAL};
    RtScanner *text = &off->mesh->text;
    RtWord word = rt_scan_peek(text);
    if (*word.text >= '0' && *word.text <= '9' && word.text[word.length - 1] != 'F') return RT_OK;
    const char *at = word.text;
    for (size_t i = 0; i < 3; i++) {
        if (strncmp(at, letters[i], strlen(letters[i])) != 0) continue;
        off->parts |= parts[i];
        at += strlen(letters[i]);
    }
    if (strncmp(at, "OFF", 3) != 0) return rt_scan_fail(text, word, "OFF, or it with ST, C and N before it");
    word.length = (size_t)(at + 3 - word.text);
    rt_scan_take(text, word);
    word = rt_scan_peek(text);
    off->binary = rt_scan_is(word, "BINARY");
    if (!off->binary) return RT_OK;
    rt_scan_take(text, word);
    while (text->at < text->end && *text->at != '\n') text->at++;
    text->at += text->at < text->end;
    text->last = 0;
    return RT_OK;
}

static RtStatus take_counts(const Off *off, uint64_t counts[3]) {
    uint32_t words[3];
    if (off->binary) RT_TRY(take_words(off->mesh, 3, words));
    for (int i = 0; i < 3; i++) {
        if (off->binary)
            counts[i] = words[i];
        else
            RT_TRY(take_count(off->mesh, &counts[i]));
    }
    return RT_OK;
}

RtStatus rt_mesh_read_off(RtMeshReader *r) {
    Off off = {.mesh = r};
    uint64_t counts[3] = {0, 0, 0}; /* vertices, faces, edges */
    RT_TRY(take_keyword(&off));
    r->given_back = r->text.at;
    if (!off.binary) RT_TRY(rt_mesh_begin_text(r));
    RT_TRY(take_counts(&off, counts));
    for (int faces = 0; faces < 2; faces++) {
        for (uint64_t i = 0; i < counts[faces]; i++) {
            if (off.binary ? r->text.at == r->text.end : rt_scan_peek(&r->text).length == 0)
                return rt_mesh_fail_short(r, i, counts[faces], faces ? "faces" : "vertices");
            RT_TRY(off.binary ? faces ? read_binary_face(&off) : read_binary_vertex(&off)
                   : faces ? read_face(&off)
                              : read_vertex(&off));
        }
    }
    return off.binary ? rt_mesh_end_binary(r) : rt_mesh_end(r);
}
