/* SPDX-License-Identifier: Apache-2.0 */
/* PLY (Greg Turk): a header that declares elements and their properties, then the elements as text or binary.
 * Read are x y z and nx ny nz of the element `vertex`, the list vertex_indices of `face`, and that of
 * `tristrips`, in which -1 ends a strip; everything else is skipped, but must be there. Faces that stand
 * before the vertices are read after them. A line of text holds one element. */
#include "core/scene/mesh.h"

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
typedef enum Use { X, Y, Z, NX, NY, NZ, COORDINATES, INDICES = COORDINATES, OTHER } Use;

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

typedef struct Ply {
    RtMeshReader *mesh;
    bool binary, big_endian;
    bool starts; /* the next number begins a line of text */
    bool skips;  /* lists of vertices: they stand before the vertices, and are read later */
    uint32_t element_count, property_count;
    Element elements[MOST_ELEMENTS];
    Property properties[MOST_PROPERTIES];
} Ply;

RtStatus rt_mesh_check_ply(RtMeshReader *r, const RtMeshHead *head) {
    const unsigned char *b = head->bytes;
    if (memcmp(b, "ply", 3) == 0 && (b[3] == '\n' || b[3] == '\r')) return RT_OK;
    r->text.last = 1;
    return rt_mesh_fail(r, "a PLY file begins with a line 'ply', this one does not");
}

/* ---- the header ---- */

static RtStatus take(Ply *ply, const char *wanted, RtWord *word) {
    return rt_mesh_take(ply->mesh, false, wanted, word);
}

static RtStatus read_format(Ply *ply) {
    static const char *const formats[] = {"ascii", "binary_little_endian", "binary_big_endian"};
    RtWord format, version;
    RT_TRY(take(ply, "a format", &format));
    RT_TRY(take(ply, "version 1.0", &version));
    size_t i = 0;
    while (i < 3 && !rt_scan_is(format, formats[i])) i++;
    if (i == 3)
        return rt_scan_fail(&ply->mesh->text, format, "ascii, binary_little_endian or binary_big_endian");
    if (!rt_scan_is(version, "1.0")) return rt_scan_fail(&ply->mesh->text, version, "version 1.0");
    ply->binary = i > 0;
    ply->big_endian = i == 2;
    return RT_OK;
}

static RtStatus read_element(Ply *ply) {
    RtWord name, word;
    int64_t count = 0;
    RT_TRY(take(ply, "the name of an element", &name));
    RT_TRY(take(ply, "the number of elements", &word));
    RT_TRY(rt_mesh_integer(ply->mesh, word, &count));
    if (count < 0) return rt_scan_fail(&ply->mesh->text, word, "a count of at least 0");
    if (ply->element_count == MOST_ELEMENTS)
        return rt_mesh_fail(ply->mesh, "more than %d kinds of elements", MOST_ELEMENTS);
    Element *element = &ply->elements[ply->element_count++];
    *element = (Element){.count = (uint64_t)count, .first = ply->property_count, .end = ply->property_count};
    while (element->kind < KINDS && !rt_scan_is(name, kind_names[element->kind])) element->kind++;
    return RT_OK;
}

static RtStatus read_type(Ply *ply, RtWord word, Type *type) {
    for (*type = 0; *type < TYPES; ++*type) {
        if (rt_scan_is(word, types[*type].name) || rt_scan_is(word, types[*type].old_name)) return RT_OK;
    }
    return rt_scan_fail(&ply->mesh->text, word,
                        "a type (char uchar short ushort int uint float double, or int8 ... float64)");
}

static Use use_of(const Element *element, const Property *property, RtWord name) {
    static const char *const coordinates[COORDINATES] = {"x", "y", "z", "nx", "ny", "nz"};
    const bool list = property->count_type != TYPES;
    if ((element->kind == FACE || element->kind == STRIPS) && list &&
        (rt_scan_is(name, "vertex_indices") || rt_scan_is(name, "vertex_index")))
        return INDICES;
    for (Use use = X; use < COORDINATES && element->kind == VERTEX && !list; use++) {
        if (rt_scan_is(name, coordinates[use])) return use;
    }
    return OTHER;
}

static RtStatus read_property(Ply *ply) {
    static const char *const wanted = "a type";
    RtWord word;
    if (ply->element_count == 0) return rt_mesh_fail(ply->mesh, "a property without an element before it");
    if (ply->property_count == MOST_PROPERTIES)
        return rt_mesh_fail(ply->mesh, "more than %d properties", MOST_PROPERTIES);
    Element *element = &ply->elements[ply->element_count - 1];
    Property *property = &ply->properties[ply->property_count++];
    *property = (Property){.count_type = TYPES};
    RT_TRY(take(ply, wanted, &word));
    if (rt_scan_is(word, "list")) {
        RT_TRY(take(ply, wanted, &word));
        RT_TRY(read_type(ply, word, &property->count_type));
        RT_TRY(take(ply, wanted, &word));
    }
    RT_TRY(read_type(ply, word, &property->type));
    RT_TRY(take(ply, "the name of a property", &word));
    property->use = use_of(element, property, word);
    if (property->use != OTHER && (element->uses & 1U << property->use))
        return rt_mesh_fail(ply->mesh, "the element has this property twice");
    element->uses |= 1U << property->use;
    element->end = ply->property_count;
    return RT_OK;
}

static RtStatus read_header_line(Ply *ply, RtWord word) {
    if (rt_scan_is(word, "format")) return read_format(ply);
    if (rt_scan_is(word, "element")) return read_element(ply);
    if (rt_scan_is(word, "property")) return read_property(ply);
    if (!rt_scan_is(word, "comment") && !rt_scan_is(word, "obj_info"))
        return rt_scan_fail(&ply->mesh->text, word,
                            "format, element, property, comment, obj_info or end_header");
    rt_scan_skip_line(&ply->mesh->text);
    return RT_OK;
}

/* There are vertices, once, with coordinates; faces and strips have a list of vertices. */
static RtStatus check_elements(const Ply *ply) {
    uint32_t vertices = 0;
    for (uint32_t i = 0; i < ply->element_count; i++) {
        const Element *element = &ply->elements[i];
        const uint32_t needed = element->kind == VERTEX   ? 1U << X | 1U << Y | 1U << Z
                                : element->kind < UNKNOWN ? 1U << INDICES
                                                          : 0;
        vertices += element->kind == VERTEX;
        if (element->count > 0 && (element->uses & needed) != needed)
            return rt_mesh_fail(ply->mesh, "the element '%s' lacks %s", kind_names[element->kind],
                                element->kind == VERTEX ? "a property x, y or z" : "a list vertex_indices");
    }
    return vertices == 1 ? RT_OK
                         : rt_mesh_fail(ply->mesh, "there must be one element 'vertex', not %u", vertices);
}

static RtStatus read_header(Ply *ply) {
    RtMeshReader *mesh = ply->mesh;
    RtWord word;
    bool has_format = false;
    RT_TRY(rt_mesh_expect(mesh, "ply"));
    for (;;) {
        RT_TRY(rt_mesh_take(mesh, true, "end_header", &word));
        if (rt_scan_is(word, "end_header")) break;
        has_format = has_format || rt_scan_is(word, "format");
        RT_TRY(read_header_line(ply, word));
    }
    if (!has_format) return rt_mesh_fail(mesh, "the header has no line 'format'");
    /* Elements begin right behind the line break: a binary one may look like blanks. */
    mesh->text.at += *mesh->text.at == '\r' && mesh->text.at[1] == '\n';
    if (*mesh->text.at != '\n' && (ply->binary || *mesh->text.at != '\r'))
        return rt_mesh_fail(mesh, "there is no line break behind end_header");
    if (ply->binary) mesh->text.at++;
    return check_elements(ply);
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

static RtStatus take_binary(Ply *ply, Type type, double *out) {
    RtScanner *text = &ply->mesh->text;
    const size_t size = types[type].size;
    uint64_t bits = 0;
    if ((size_t)(text->end - text->at) < size)
        return rt_mesh_fail(ply->mesh, "the file ends inside an element");
    for (size_t i = 0; i < size; i++) {
        const size_t byte = ply->big_endian ? i : size - 1 - i;
        bits = bits << 8 | (unsigned char)text->at[byte];
    }
    text->at += size;
    *out = from_bytes(type, bits);
    return RT_OK;
}

/* Integers may be written as 255.0. What is neither a coordinate nor an index need not be a number. */
static RtStatus take_text(Ply *ply, Type type, Use use, double *out) {
    RtWord word;
    float value = NAN;
    RT_TRY(rt_mesh_take(ply->mesh, ply->starts, "a number", &word));
    ply->starts = false;
    if (use != INDICES && use > Z) {
        if (!rt_scan_float(word, &value))
            RT_TRY(rt_mesh_warn(ply->mesh, "a property that is not used, or a normal, is no finite number"));
    } else if (use != INDICES || type == FLOAT32 || type == FLOAT64 || memchr(word.text, '.', word.length)) {
        RT_TRY(rt_mesh_float(ply->mesh, word, &value));
    } else {
        int64_t integer = 0;
        RT_TRY(rt_mesh_integer(ply->mesh, word, &integer));
        *out = (double)integer;
        return RT_OK;
    }
    *out = (double)value;
    return RT_OK;
}

static RtStatus take_number(Ply *ply, Type type, Use use, double *out) {
    return ply->binary ? take_binary(ply, type, out) : take_text(ply, type, use, out);
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

static RtStatus take_list(Ply *ply, const Property *property, Kind kind) {
    RtMeshReader *mesh = ply->mesh;
    RtMeshCorner strip[2] = {{0, 0}, {0, 0}};
    uint32_t length = 0;
    double count = 0, value = 0;
    const bool adds = property->use == INDICES && !ply->skips;
    RT_TRY(take_number(ply, property->count_type, INDICES, &count));
    if (!(count >= 0 && count <= (double)UINT32_MAX && count == floor(count)))
        return rt_mesh_fail(mesh, "a list has %.15g numbers", count);
    for (uint32_t left = (uint32_t)count; left > 0; left--) {
        RT_TRY(take_number(ply, property->type, property->use, &value));
        if (adds && kind == STRIPS)
            RT_TRY(add_to_strip(mesh, value, strip, &length));
        else if (adds)
            RT_TRY(rt_mesh_add_index(mesh, value));
    }
    return adds && kind == FACE ? rt_mesh_add_polygon(mesh) : RT_OK;
}

static RtStatus take_element(Ply *ply, const Element *element) {
    double at[COORDINATES] = {0}, other;
    ply->starts = true;
    for (uint32_t p = element->first; p < element->end; p++) {
        const Property *property = &ply->properties[p];
        if (property->count_type != TYPES)
            RT_TRY(take_list(ply, property, element->kind));
        else
            RT_TRY(take_number(ply, property->type, property->use,
                               property->use == OTHER ? &other : &at[property->use]));
    }
    if (element->kind != VERTEX) return RT_OK;
    const uint32_t normal = 1U << NX | 1U << NY | 1U << NZ;
    if ((element->uses & normal) == normal)
        RT_TRY(rt_mesh_add_normal(ply->mesh, rt_narrow(rt_vec3d(at[NX], at[NY], at[NZ]))));
    return rt_mesh_add_vertex(ply->mesh, rt_narrow(rt_vec3d(at[X], at[Y], at[Z])));
}

static RtStatus read_elements(Ply *ply, const Element *element) {
    static const char *const names[] = {"vertices", "faces", "strips", "elements"};
    if (element->first == element->end) return RT_OK; /* they take no space */
    for (uint64_t i = 0; i < element->count; i++) {
        RtScanner *text = &ply->mesh->text;
        if (ply->binary ? text->at == text->end : rt_scan_peek(text).length == 0)
            return rt_mesh_fail_short(ply->mesh, i, element->count, names[element->kind]);
        RT_TRY(take_element(ply, element));
    }
    return RT_OK;
}

/* Reads all elements in order, and then those that named vertices before there were any. */
static RtStatus read_all(Ply *ply) {
    RtScanner *text = &ply->mesh->text, starts[MOST_ELEMENTS];
    uint32_t vertices = 0;
    while (ply->elements[vertices].kind != VERTEX) vertices++;
    if (vertices == 0) ply->mesh->given_back = text->at;
    for (uint32_t i = 0; i < ply->element_count; i++) {
        starts[i] = *text;
        ply->skips = i < vertices;
        RT_TRY(read_elements(ply, &ply->elements[i]));
    }
    ply->skips = false;
    const RtScanner end = *text;
    for (uint32_t i = 0; i < vertices; i++) {
        if (ply->elements[i].kind == UNKNOWN) continue;
        *text = starts[i];
        RT_TRY(read_elements(ply, &ply->elements[i]));
    }
    *text = end;
    return RT_OK;
}

RtStatus rt_mesh_read_ply(RtMeshReader *r) {
    Ply ply = {.mesh = r};
    RT_TRY(read_header(&ply));
    if (ply.binary)
        r->text.last = 0; /* no lines from here on */
    else
        RT_TRY(rt_mesh_begin_text(r));
    RT_TRY(read_all(&ply));
    return ply.binary ? rt_mesh_end_binary(r) : rt_mesh_end(r);
}
