/* SPDX-License-Identifier: Apache-2.0 */
/* PLY (Greg Turk): a header that declares elements and their properties, then the elements as text or binary.
 * Read are x y z, nx ny nz and, if the material has a texture, s t (or u v) of the element `vertex`, the list
 * vertex_indices of `face`, and that of `tristrips`, in which -1 ends a strip; everything else is skipped,
 * but must be there. Faces that stand before the vertices are read after them. A line of text holds one
 * element.
 *
 * OFF, of Geomview, is the same with another header: the numbers of vertices, polygons and edges. Letters
 * before its keyword say what follows the coordinates of a vertex: N a normal, C a colour, ST texture
 * coordinates. Binary numbers have their high byte first. What follows on a line of text is a colour. The
 * keyword may be missing, and the counts may follow it without a blank. */
#include "core/scene/mesh.h"

#include <stdlib.h>
#include <string.h>

enum { MOST_ELEMENTS = 16, MOST_PROPERTIES = 256 };

typedef enum Type { INT8, UINT8, INT16, UINT16, INT32, UINT32, FLOAT32, FLOAT64, TYPES } Type;

static const struct {
    const char *name, *old_name;
    size_t size;
} types[TYPES] = {{"int8", "char", 1},     {"uint8", "uchar", 1},   {"int16", "short", 2},
                  {"uint16", "ushort", 2}, {"int32", "int", 4},     {"uint32", "uint", 4},
                  {"float32", "float", 4}, {"float64", "double", 8}};

/* What a property is for. */
typedef enum Use { X, Y, Z, NX, NY, NZ, U, V, COORDINATES, INDICES = COORDINATES, OTHER } Use;

typedef struct Property {
    Type type, count_type; /* count_type: of a list, else TYPES */
    Use use;
} Property;

typedef enum Kind { VERTEX, FACE, STRIPS, UNKNOWN, KINDS = UNKNOWN } Kind;

static const char *const kind_names[KINDS] = {"vertex", "face", "tristrips"};

typedef struct Element {
    Kind kind;
    uint64_t count;
    uint32_t first, end; /* its properties */
    uint32_t uses;       /* a bit for each Use */
} Element;

typedef struct File {
    RtMeshReader *mesh;
    bool binary, big_endian;
    bool open;   /* more may stand on a line of text than its element, or less */
    bool starts; /* the next number begins a line of text */
    bool skips;  /* lists of vertices: they stand before the vertices, and are read later */
    uint32_t element_count, property_count;
    Element elements[MOST_ELEMENTS];
    Property properties[MOST_PROPERTIES];
} File;

RtStatus rt_mesh_check_ply(RtMeshReader *r, const RtMeshHead *head) {
    const unsigned char *b = head->bytes;
    if (memcmp(b, "ply", 3) == 0 && (b[3] == '\n' || b[3] == '\r')) return RT_OK;
    r->text.last = 1;
    return rt_mesh_fail(r, "a PLY file begins with a line 'ply', this one does not");
}

static void add_element(File *file, Kind kind, uint64_t count) {
    file->elements[file->element_count++] =
        (Element){.kind = kind, .count = count, .first = file->property_count, .end = file->property_count};
}

/* Adds a property to the last element. */
static void add_property(File *file, Property property) {
    Element *element = &file->elements[file->element_count - 1];
    file->properties[file->property_count++] = property;
    element->uses |= 1U << property.use;
    element->end = file->property_count;
}

/* ---- the header of PLY ---- */

static RtStatus take(File *file, const char *wanted, RtWord *word) {
    return rt_mesh_take(file->mesh, false, wanted, word);
}

static RtStatus read_format(File *file) {
    static const char *const formats[] = {"ascii", "binary_little_endian", "binary_big_endian"};
    RtWord format, version;
    RT_TRY(take(file, "a format", &format));
    RT_TRY(take(file, "version 1.0", &version));
    size_t i = 0;
    while (i < 3 && !rt_scan_is(format, formats[i])) i++;
    if (i == 3)
        return rt_scan_fail(&file->mesh->text, format, "ascii, binary_little_endian or binary_big_endian");
    if (!rt_scan_is(version, "1.0")) return rt_scan_fail(&file->mesh->text, version, "version 1.0");
    file->binary = i > 0;
    file->big_endian = i == 2;
    return RT_OK;
}

static RtStatus read_element(File *file) {
    RtWord name, word;
    int64_t count = 0;
    RT_TRY(take(file, "the name of an element", &name));
    RT_TRY(take(file, "the number of elements", &word));
    RT_TRY(rt_mesh_integer(file->mesh, word, &count));
    if (count < 0) return rt_scan_fail(&file->mesh->text, word, "a count of at least 0");
    if (file->element_count == MOST_ELEMENTS)
        return rt_mesh_fail(file->mesh, "more than %d kinds of elements", MOST_ELEMENTS);
    Kind kind = VERTEX;
    while (kind < KINDS && !rt_scan_is(name, kind_names[kind])) kind++;
    if (kind == UNKNOWN && count > 0)
        RT_TRY(rt_mesh_warn(file->mesh,
                            "elements that are neither vertices, faces nor tristrips are left out: %.*s",
                            (int)(name.length < 40 ? name.length : 40), name.text));
    add_element(file, kind, (uint64_t)count);
    return RT_OK;
}

static RtStatus read_type(File *file, RtWord word, Type *type) {
    for (*type = 0; *type < TYPES; ++*type) {
        if (rt_scan_is(word, types[*type].name) || rt_scan_is(word, types[*type].old_name)) return RT_OK;
    }
    return rt_scan_fail(&file->mesh->text, word,
                        "a type (char uchar short ushort int uint float double, or int8 ... float64)");
}

static Use use_of(const File *file, const Element *element, const Property *property, RtWord name) {
    static const char *const coordinates[U] = {"x", "y", "z", "nx", "ny", "nz"};
    static const char *const of_texture[] = {"s", "t", "u", "v", "texture_u", "texture_v"};
    const bool list = property->count_type != TYPES;
    if ((element->kind == FACE || element->kind == STRIPS) && list &&
        (rt_scan_is(name, "vertex_indices") || rt_scan_is(name, "vertex_index")))
        return INDICES;
    for (Use use = X; use < U && element->kind == VERTEX && !list; use++) {
        if (rt_scan_is(name, coordinates[use])) return use;
    }
    for (int i = 0; i < 6 && file->mesh->textured && element->kind == VERTEX && !list; i++) {
        const Use use = i % 2 ? V : U;
        if (rt_scan_is(name, of_texture[i]) && !(element->uses & 1U << use)) return use;
    }
    return OTHER;
}

static RtStatus read_property(File *file) {
    static const char *const wanted = "a type";
    RtWord word;
    if (file->element_count == 0) return rt_mesh_fail(file->mesh, "a property without an element before it");
    if (file->property_count == MOST_PROPERTIES)
        return rt_mesh_fail(file->mesh, "more than %d properties", MOST_PROPERTIES);
    const Element *element = &file->elements[file->element_count - 1];
    Property property = {.count_type = TYPES};
    RT_TRY(take(file, wanted, &word));
    if (rt_scan_is(word, "list")) {
        RT_TRY(take(file, wanted, &word));
        RT_TRY(read_type(file, word, &property.count_type));
        RT_TRY(take(file, wanted, &word));
    }
    RT_TRY(read_type(file, word, &property.type));
    RT_TRY(take(file, "the name of a property", &word));
    property.use = use_of(file, element, &property, word);
    if (property.use != OTHER && (element->uses & 1U << property.use))
        return rt_mesh_fail(file->mesh, "the element has this property twice");
    add_property(file, property);
    return RT_OK;
}

/* Inside an element it may be a property, without which all others are read wrongly. */
static RtStatus left_out_line(const File *file, RtWord word) {
    char shown[RT_WORD_SHOWN];
    if (file->element_count > 0)
        return rt_scan_fail(&file->mesh->text, word, "property, element, comment, obj_info or end_header");
    return rt_mesh_warn(file->mesh, "a line of the header that is not PLY's is left out: %s",
                        rt_scan_show(word, shown));
}

static RtStatus read_header_line(File *file, RtWord word) {
    if (rt_scan_is(word, "format")) return read_format(file);
    if (rt_scan_is(word, "element")) return read_element(file);
    if (rt_scan_is(word, "property")) return read_property(file);
    if (!rt_scan_is(word, "comment") && !rt_scan_is(word, "obj_info")) RT_TRY(left_out_line(file, word));
    rt_scan_skip_line(&file->mesh->text);
    return RT_OK;
}

/* There are vertices, once, with coordinates; faces and strips have a list of vertices. */
static RtStatus check_elements(const File *file) {
    uint32_t vertices = 0;
    for (uint32_t i = 0; i < file->element_count; i++) {
        const Element *element = &file->elements[i];
        const uint32_t needed = element->kind == VERTEX   ? 1U << X | 1U << Y | 1U << Z
                                : element->kind < UNKNOWN ? 1U << INDICES
                                                          : 0;
        vertices += element->kind == VERTEX;
        if (element->count > 0 && (element->uses & needed) != needed)
            return rt_mesh_fail(file->mesh, "the element '%s' lacks %s", kind_names[element->kind],
                                element->kind == VERTEX ? "a property x, y or z" : "a list vertex_indices");
    }
    return vertices == 1 ? RT_OK
                         : rt_mesh_fail(file->mesh, "there must be one element 'vertex', not %u", vertices);
}

static RtStatus read_header(File *file) {
    RtMeshReader *mesh = file->mesh;
    RtWord word;
    bool has_format = false;
    const bool returns = mesh->text.at[3] == '\r' && mesh->text.at[4] != '\n'; /* CR alone ends lines */
    RT_TRY(rt_mesh_expect(mesh, "ply"));
    for (;;) {
        RT_TRY(rt_mesh_take(mesh, true, "end_header", &word));
        if (rt_scan_is(word, "end_header")) break;
        has_format = has_format || rt_scan_is(word, "format");
        RT_TRY(read_header_line(file, word));
    }
    if (!has_format) return rt_mesh_fail(mesh, "the header has no line 'format'");
    /* Elements begin right behind the line break: a binary one may look like blanks. */
    mesh->text.at += !returns && *mesh->text.at == '\r';
    if (*mesh->text.at != (returns ? '\r' : '\n'))
        return rt_mesh_fail(mesh, "there is no line break behind end_header");
    if (file->binary) mesh->text.at++;
    return check_elements(file);
}

/* ---- the elements ---- */

static double from_bytes(Type type, uint64_t bits) {
    float narrow;
    double wide;
    const uint32_t low = (uint32_t)bits;
    switch (type) {
    case INT8: return (int8_t)bits;
    case INT16: return (int16_t)bits;
    case INT32: return (int32_t)bits;
    case FLOAT32: memcpy(&narrow, &low, sizeof narrow); return (double)narrow;
    case FLOAT64: memcpy(&wide, &bits, sizeof wide); return wide;
    default: return (double)bits;
    }
}

static RtStatus take_binary(File *file, Type type, double *out) {
    RtScanner *text = &file->mesh->text;
    const size_t size = types[type].size;
    uint64_t bits = 0;
    if ((size_t)(text->end - text->at) < size)
        return rt_mesh_fail(file->mesh, "the file ends inside an element");
    for (size_t i = 0; i < size; i++) {
        const size_t byte = file->big_endian ? i : size - 1 - i;
        bits = bits << 8 | (unsigned char)text->at[byte];
    }
    text->at += size;
    *out = from_bytes(type, bits);
    return RT_OK;
}

/* Integers may be written as 255.0. What is neither a coordinate nor an index need not be a number. */
static RtStatus take_text(File *file, Use use, double *out) {
    RtWord word = rt_scan_peek(&file->mesh->text);
    float value = NAN;
    int64_t integer = 0;
    const bool goes_on = file->open && word.length > 0 && file->mesh->text.fresh && !file->starts;
    if (goes_on) RT_TRY(rt_mesh_warn(file->mesh, "a vertex or face goes on in the next line"));
    RT_TRY(rt_mesh_take(file->mesh, file->starts || goes_on, "a number", &word));
    file->starts = false;
    if (use <= Z) return rt_mesh_coordinate(file->mesh, word, out);
    if (use == INDICES && rt_scan_integer(word.text, &integer) == word.text + word.length) {
        *out = (double)integer;
        return RT_OK;
    }
    const bool number = rt_scan_float(word, &value);
    if (!number && use == INDICES) return rt_scan_fail(&file->mesh->text, word, "an integer");
    if (!number && use == OTHER && !file->skips)
        RT_TRY(rt_mesh_warn(file->mesh, "a property that is not used is no finite number"));
    *out = use == INDICES ? strtod(word.text, NULL) : (double)value;
    return RT_OK;
}

static RtStatus take_number(File *file, Type type, Use use, double *out) {
    return file->binary ? take_binary(file, type, out) : take_text(file, use, out);
}

/* Adds the triangle of the last three corners of a strip; every other one is reversed. *length is that of the
 * strip, which -1 ends. */
static RtStatus add_to_strip(RtMeshReader *mesh, double index, RtMeshCorner strip[2], uint32_t *length) {
    if (index < 0) {
        *length = 0;
        return RT_OK;
    }
    RT_TRY(rt_mesh_add_index(mesh, index));
    const RtMeshCorner corner = mesh->corners[--mesh->corner_count];
    for (uint32_t i = 0; *length >= 2 && i < 2; i++) RT_TRY(rt_mesh_add_corner(mesh, strip[i ^ *length % 2]));
    RtStatus status = RT_OK;
    if (*length >= 2) status = rt_mesh_add_corner(mesh, corner);
    if (*length >= 2 && status == RT_OK) status = rt_mesh_add_polygon(mesh);
    strip[0] = strip[1];
    strip[1] = corner;
    ++*length;
    return status;
}

static RtStatus take_list(File *file, const Property *property, Kind kind) {
    RtMeshReader *mesh = file->mesh;
    RtMeshCorner strip[2] = {{0}, {0}};
    uint32_t length = 0;
    double count = 0, value = 0;
    const bool adds = property->use == INDICES && !file->skips;
    RT_TRY(take_number(file, property->count_type, INDICES, &count));
    if (!(count >= 0 && count <= (double)UINT32_MAX && count == floor(count)))
        return rt_mesh_fail(mesh, "a list has %.15g numbers", count);
    for (uint32_t left = (uint32_t)count; left > 0; left--) {
        RT_TRY(take_number(file, property->type, property->use, &value));
        if (adds && kind == STRIPS)
            RT_TRY(add_to_strip(mesh, value, strip, &length));
        else if (adds)
            RT_TRY(rt_mesh_add_index(mesh, value));
    }
    return adds && kind == FACE ? rt_mesh_add_polygon(mesh) : RT_OK;
}

/* Skips what the header does not declare. Behind a list of indices it could be one more. */
static RtStatus end_line(const File *file, const Element *element, RtWord word) {
    if (!file->open && file->properties[element->end - 1].use == INDICES)
        return rt_scan_fail(&file->mesh->text, word,
                            "the end of the line, behind as many indices as it says");
    if (!file->open && !file->skips)
        RT_TRY(
            rt_mesh_warn(file->mesh, "a line has more numbers than the header declares: they are ignored"));
    rt_scan_skip_line(&file->mesh->text);
    return RT_OK;
}

static RtStatus take_element(File *file, const Element *element) {
    double at[COORDINATES] = {0}, other;
    RtWord word;
    file->starts = true;
    for (uint32_t p = element->first; p < element->end; p++) {
        const Property *property = &file->properties[p];
        if (property->count_type != TYPES)
            RT_TRY(take_list(file, property, element->kind));
        else
            RT_TRY(take_number(file, property->type, property->use,
                               property->use == OTHER ? &other : &at[property->use]));
    }
    if (!file->binary && rt_mesh_more(file->mesh, &word)) RT_TRY(end_line(file, element, word));
    if (element->kind != VERTEX) return RT_OK;
    const uint32_t normal = 1U << NX | 1U << NY | 1U << NZ, uv = 1U << U | 1U << V;
    if ((element->uses & normal) == normal)
        RT_TRY(rt_mesh_add_normal(file->mesh, rt_narrow(rt_vec3d(at[NX], at[NY], at[NZ]))));
    if ((element->uses & uv) == uv) RT_TRY(rt_mesh_add_uv(file->mesh, (RtUv){(float)at[U], (float)at[V]}));
    return rt_mesh_add_vertex(file->mesh, rt_vec3d(at[X], at[Y], at[Z]));
}

static RtStatus read_elements(File *file, const Element *element) {
    static const char *const names[] = {"vertices", "faces", "strips", "elements"};
    if (element->first == element->end) return RT_OK; /* they take no space */
    for (uint64_t i = 0; i < element->count; i++) {
        RtScanner *text = &file->mesh->text;
        if (file->binary ? text->at == text->end : rt_scan_peek(text).length == 0)
            return rt_mesh_fail_short(file->mesh, i, element->count, names[element->kind]);
        RT_TRY(take_element(file, element));
    }
    return RT_OK;
}

/* Reads all elements in order, and then those that named vertices before there were any. */
static RtStatus read_all(File *file) {
    RtScanner *text = &file->mesh->text, starts[MOST_ELEMENTS];
    uint32_t vertices = 0;
    while (file->elements[vertices].kind != VERTEX) vertices++;
    if (vertices == 0) file->mesh->given_back = text->at;
    for (uint32_t i = 0; i < file->element_count; i++) {
        starts[i] = *text;
        file->skips = i < vertices && file->elements[i].kind != UNKNOWN;
        RT_TRY(read_elements(file, &file->elements[i]));
    }
    file->skips = false;
    const RtScanner end = *text;
    for (uint32_t i = 0; i < vertices; i++) {
        if (file->elements[i].kind == UNKNOWN) continue;
        *text = starts[i];
        RT_TRY(read_elements(file, &file->elements[i]));
    }
    *text = end;
    return RT_OK;
}

/* Reads what follows the header. */
static RtStatus read_body(File *file) {
    if (file->binary) file->mesh->text.last = 0; /* no lines from here on */
    RT_TRY(read_all(file));
    return file->binary ? rt_mesh_end_binary(file->mesh) : rt_mesh_end(file->mesh);
}

RtStatus rt_mesh_read_ply(RtMeshReader *r) {
    File ply = {.mesh = r};
    RT_TRY(read_header(&ply));
    if (!ply.binary) RT_TRY(rt_mesh_begin_text(r));
    return read_body(&ply);
}

/* ---- OFF ---- */

/* Looks ahead at the second word. */
static bool is_binary_off(RtScanner text) {
    rt_scan_take(&text, rt_scan_peek(&text));
    return rt_scan_is(rt_scan_peek(&text), "BINARY");
}

enum { NORMAL = 1, COLOUR = 2, TEXTURE = 4 };

/* Takes the letters and the keyword at the beginning of the first word, if they are there. */
static RtStatus take_keyword(File *off, unsigned *parts) {
    static const char *const letters[] = {"ST", "C", "N"};
    static const unsigned meanings[] = {TEXTURE, COLOUR, NORMAL};
    RtScanner *text = &off->mesh->text;
    RtWord word = rt_scan_peek(text);
    if (*word.text >= '0' && *word.text <= '9' && word.text[word.length - 1] != 'F') return RT_OK;
    const char *at = word.text;
    for (size_t i = 0; i < 3; i++) {
        if (strncmp(at, letters[i], strlen(letters[i])) != 0) continue;
        *parts |= meanings[i];
        at += strlen(letters[i]);
    }
    if (strncmp(at, "OFF", 3) != 0) return rt_scan_fail(text, word, "OFF, or it with ST, C and N before it");
    word.length = (size_t)(at + 3 - word.text);
    rt_scan_take(text, word);
    while (off->binary && text->at < text->end && *text->at++ != '\n') {
    }
    return RT_OK;
}

/* Nothing is allocated for a count: the file must have the elements. */
static RtStatus take_count(File *off, double *out) {
    RtScanner *text = &off->mesh->text;
    const RtWord word = rt_scan_peek(text);
    int64_t count = 0;
    if (off->binary) return take_binary(off, UINT32, out);
    if (word.length == 0) return rt_scan_fail(text, word, "the numbers of vertices, faces and edges");
    rt_scan_take(text, word);
    RT_TRY(rt_mesh_integer(off->mesh, word, &count));
    if (count < 0) return rt_scan_fail(text, word, "a count of at least 0");
    *out = (double)count;
    return RT_OK;
}

RtStatus rt_mesh_read_off(RtMeshReader *r) {
    File off = {.mesh = r, .binary = is_binary_off(r->text), .big_endian = true, .open = true};
    unsigned parts = 0;
    double counts[3] = {0, 0, 0}; /* vertices, faces, edges */
    if (!off.binary) RT_TRY(rt_mesh_begin_text(r));
    RT_TRY(take_keyword(&off, &parts));
    for (int i = 0; i < 3; i++) RT_TRY(take_count(&off, &counts[i]));
    add_element(&off, VERTEX, (uint64_t)counts[0]);
    for (Use use = X; use <= (parts & NORMAL ? NZ : Z); use++)
        add_property(&off, (Property){FLOAT32, TYPES, use});
    const int others = off.binary ? (parts & COLOUR ? 4 : 0) + (parts & TEXTURE ? 2 : 0) : 0;
    for (int i = 0; i < others; i++) add_property(&off, (Property){FLOAT32, TYPES, OTHER});
    add_element(&off, FACE, (uint64_t)counts[1]);
    add_property(&off, (Property){INT32, INT32, INDICES});
    if (off.binary) add_property(&off, (Property){FLOAT32, INT32, OTHER}); /* its colour */
    return read_body(&off);
}
