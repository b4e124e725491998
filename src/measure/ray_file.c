/* SPDX-License-Identifier: Apache-2.0 */
/* A file begins with magic bytes, a version, and the length of the header, which is a Python dictionary as
 * text (NumPy Enhancement Proposal 1); then the numbers follow as they lie in memory. Input is not trusted:
 * the version must be 1.0, 2.0 or 3.0, the dictionary must have exactly the three keys of the format, and the
 * file must be as long as it says. */
#include "measure/measure.h"

#include "core/base/file.h"
#include "core/base/memory.h"
#include "core/base/words.h"

#include <assert.h>
#include <inttypes.h>
#include <jansson.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

/* The files are little-endian, like the memory of all machines that this program supports. */
_Static_assert(__BYTE_ORDER__ == __ORDER_LITTLE_ENDIAN__, "arrays are written as they lie in memory");
_Static_assert(offsetof(RtRay, org) == 0 && offsetof(RtRay, tmin) == 3 * sizeof(float) &&
                   offsetof(RtRay, dir) == 4 * sizeof(float) && offsetof(RtRay, tmax) == 7 * sizeof(float),
               "a ray begins with its row");

enum {
    BLOCK = 1024, /* rows read at a time */
    MAGIC_BYTES = 6,
    MOST_HEADER = 4096, /* bytes of text; an array of numbers needs about a hundred */
    MOST_ROW = 4096,    /* bytes of a hit with other fields */
    MULTIPLE = 64       /* alignment of the numbers */
};
static const char MAGIC[MAGIC_BYTES + 1] = "\x93NUMPY";

/* ---- reading headers ---- */

/* The text of the header. */
static RtStatus read_header(FILE *file, const char *path, char text[MOST_HEADER + 1], RtError *error) {
    unsigned char start[MAGIC_BYTES + 2], size[4] = {0};
    if (fread(start, 1, sizeof start, file) != sizeof start || memcmp(start, MAGIC, MAGIC_BYTES) != 0)
        return rt_fail(error, RT_BAD_INPUT, "%s: this is not a NumPy array: write it with numpy.save", path);
    const unsigned major = start[MAGIC_BYTES], minor = start[MAGIC_BYTES + 1];
    if (major < 1 || major > 3 || minor != 0)
        return rt_fail(error, RT_BAD_INPUT, "%s: unknown format version %u.%u: expected 1.0, 2.0 or 3.0",
                       path, major, minor);
    const size_t bytes = major == 1 ? 2 : 4;
    const bool sized = fread(size, 1, bytes, file) == bytes;
    const uint32_t length =
        size[0] | (uint32_t)size[1] << 8 | (uint32_t)size[2] << 16 | (uint32_t)size[3] << 24;
    if (length > MOST_HEADER)
        return rt_fail(error, RT_BAD_INPUT, "%s: a header of %" PRIu32 " bytes: at most %d are read", path,
                       length, MOST_HEADER);
    if (!sized || fread(text, 1, length, file) != length)
        return rt_fail(error, RT_BAD_INPUT, "%s: the file ends within its header", path);
    text[length] = '\0';
    if (strlen(text) == length) return RT_OK;
    return rt_fail(error, RT_BAD_INPUT, "%s: the header contains a zero byte", path);
}

/* {'descr': '<f4', 'fortran_order': False, 'shape': (7, 8), } as JSON: with double quotes, brackets and small
 * letters, without commas at the end. */
static json_t *parse(const char *text) {
    static const char python[] = "'()TF", as_json[] = "\"[]tf";
    char json[MOST_HEADER + 1];
    size_t length = 0;
    for (const char *c = text; *c; c++) {
        const char next = c[1 + strspn(c + 1, " \t\r\n")];
        if (*c == ',' && (next == ')' || next == ']' || next == '}')) continue;
        const char *change = strchr(python, *c);
        json[length] = *c;
        if (change) json[length] = as_json[change - python];
        length++;
    }
    return json_loadb(json, length, JSON_REJECT_DUPLICATES, NULL);
}

/* An array in C order. */
typedef struct Layout {
    uint64_t rows;
    size_t bytes; /* of a row */
    /* Of rows of hits: where t is, and an integer of 4 or 8 bytes; 0 bytes: there is none. */
    size_t t, object, object_bytes;
} Layout;

/* The layout of rows, from the type and the other dimensions of an array; false if they are others. */
typedef bool TakeRows(const json_t *descr, const json_t *shape, Layout *layout);

static bool is_type(const json_t *descr, const char *type) {
    return json_is_string(descr) && strcmp(json_string_value(descr), type) == 0;
}

/* float32 of shape (N, RT_RAY_COLUMNS) */
static bool take_ray_rows(const json_t *descr, const json_t *shape, Layout *layout) {
    layout->bytes = RT_RAY_COLUMNS * sizeof(float);
    return is_type(descr, "<f4") && json_array_size(shape) == 2 &&
           json_integer_value(json_array_get(shape, 1)) == RT_RAY_COLUMNS;
}

/* float32 of shape (N,) or (N, 1); or (N,) of fields among which are t and object. */
static bool take_hit_rows(const json_t *descr, const json_t *shape, Layout *layout) {
    const size_t dimensions = json_array_size(shape);
    const json_t *field;
    size_t i;
    bool t = false;
    layout->bytes = sizeof(float);
    if (is_type(descr, "<f4"))
        return dimensions == 1 || (dimensions == 2 && json_integer_value(json_array_get(shape, 1)) == 1);
    layout->bytes = 0;
    json_array_foreach(descr, i, field) {
        const char *name = json_string_value(json_array_get(field, 0));
        const char *type = json_string_value(json_array_get(field, 1));
        const size_t bytes = type && type[0] && strchr("biufV", type[1]) ? strtoul(type + 2, NULL, 10) : 0;
        if (!name || bytes == 0 || bytes > MOST_ROW || json_array_size(field) != 2) return false;
        if (strcmp(name, "t") == 0) {
            layout->t = layout->bytes;
            t = strcmp(type, "<f4") == 0;
        } else if (strcmp(name, "object") == 0) {
            const bool integer = strncmp(type, "<i", 2) == 0 || strncmp(type, "<u", 2) == 0;
            if (!integer || (bytes != sizeof(uint32_t) && bytes != sizeof(uint64_t))) return false;
            layout->object = layout->bytes;
            layout->object_bytes = bytes;
        }
        layout->bytes += bytes;
    }
    return t && layout->object_bytes > 0 && layout->bytes <= MOST_ROW && dimensions == 1;
}

static RtStatus check_header(const json_t *header, const char *text, const char *path, TakeRows *take,
                             const char *expected, Layout *layout, RtError *error) {
    const json_t *descr = json_object_get(header, "descr"), *shape = json_object_get(header, "shape");
    const json_t *order = json_object_get(header, "fortran_order");
    const json_int_t count = json_integer_value(json_array_get(shape, 0));
    if (!descr || !json_is_array(shape) || !json_is_boolean(order) || json_object_size(header) != 3 ||
        count < 0)
        return rt_fail(error, RT_BAD_INPUT,
                       "%s: the header is not {'descr': ..., 'fortran_order': ..., 'shape': ...}: %.80s",
                       path, text);
    if (json_is_true(order))
        return rt_fail(error, RT_BAD_INPUT,
                       "%s: the array is column-major: expected row-major, as from numpy.ascontiguousarray",
                       path);
    if (!take(descr, shape, layout))
        return rt_fail(error, RT_BAD_INPUT, "%s: expected %s; this is %.*s", path, expected,
                       (int)strcspn(text, "\n"), text);
    layout->rows = (uint64_t)count;
    if (layout->rows <= RT_MAX_RAYS_A_KIND) return RT_OK;
    return rt_fail(error, RT_BAD_INPUT, "%s: %" PRIu64 " rows: at most %" PRIu64 " are read", path,
                   layout->rows, (uint64_t)RT_MAX_RAYS_A_KIND);
}

/* The file stays open at the first row. `expected` says what `take` takes. */
static RtStatus read_layout(FILE *file, const char *path, TakeRows *take, const char *expected,
                            Layout *layout, RtError *error) {
    char text[MOST_HEADER + 1];
    struct stat info;
    *layout = (Layout){0};
    RT_TRY(read_header(file, path, text, error));
    json_t *header = parse(text);
    RtStatus status = check_header(header, text, path, take, expected, layout, error);
    json_decref(header);
    RT_TRY(status);
    const long start = ftell(file);
    if (start < 0 || fstat(fileno(file), &info) != 0)
        return rt_fail(error, RT_IO, "%s: its length is unknown", path);
    const uint64_t wanted = layout->rows * layout->bytes, there = (uint64_t)info.st_size - (uint64_t)start;
    if (wanted == there) return RT_OK;
    return rt_fail(error, RT_BAD_INPUT,
                   "%s: %" PRIu64 " rows of %zu bytes are %" PRIu64 " bytes, but %" PRIu64
                   " follow the header: was the file cut off?",
                   path, layout->rows, layout->bytes, wanted, there);
}

/* ---- writing headers ---- */

/* Version 1.0, padded to a multiple of 64 bytes. `descr` is the type as Python writes it, with its quotes or
 * brackets; columns 0 means one dimension. A failed write is reported when the file is closed. */
static void begin(FILE *out, const char *descr, uint64_t rows, uint32_t columns) {
    char text[512], shape[64];
    snprintf(shape, sizeof shape, columns ? "(%" PRIu64 ", %" PRIu32 ")" : "(%" PRIu64 ",)", rows, columns);
    int length =
        snprintf(text, sizeof text, "{'descr': %s, 'fortran_order': False, 'shape': %s, }", descr, shape);
    assert(length > 0 && (size_t)length < sizeof text);
    /* Magic, version, two bytes of length, the text, padding, a newline. */
    int before = MAGIC_BYTES + 4, all = (before + length + 1 + MULTIPLE - 1) / MULTIPLE * MULTIPLE;
    int header = all - before;
    fwrite(MAGIC, 1, MAGIC_BYTES, out);
    const unsigned char rest[4] = {1, 0, (unsigned char)(header & 255), (unsigned char)(header >> 8)};
    fwrite(rest, 1, sizeof rest, out);
    fprintf(out, "%-*s\n", header - 1, text);
}

/* ---- rays ---- */

RtStatus rt_rays_save(const RtRaySet *set, const char *path, RtError *error) {
    RtOutput output;
    RT_TRY(rt_output_open(&output, path, error));
    begin(output.file, "'<f4'", set->count, RT_RAY_COLUMNS);
    for (uint64_t i = 0; i < set->count; i++) {
        fwrite(&set->rays[i], sizeof(float), RT_RAY_COLUMNS, output.file);
    }
    return rt_output_commit(&output, error);
}

const char *rt_ray_fault(const RtRay *ray) {
    float size = rt_maxf(rt_maxf(fabsf(ray->org.x), fabsf(ray->org.y)), fabsf(ray->org.z));
    if (!rt_finite(ray->org) || size > RT_MAX_COORDINATE) return "its origin is not finite, or beyond 5e17";
    if (!rt_finite(ray->dir)) return "its direction is not finite";
    if (ray->dir.x == 0 && ray->dir.y == 0 && ray->dir.z == 0) return "its direction is zero";
    if (!(ray->tmin >= 0) || !isfinite(ray->tmin)) return "its tmin is negative or not finite";
    return "its tmax is less than its tmin, or not a number";
}

static RtStatus read_rays(FILE *file, const char *path, RtRaySet *set, RtError *error) {
    float rows[BLOCK][RT_RAY_COLUMNS];
    for (uint64_t first = 0; first < set->count; first += BLOCK) {
        uint64_t count = set->count - first < BLOCK ? set->count - first : BLOCK;
        if (fread(rows, sizeof rows[0], count, file) != count)
            return rt_fail(error, RT_IO, "%s: reading failed before the last row", path);
        for (uint64_t i = 0; i < count; i++) {
            RtRay *ray = &set->rays[first + i];
            *ray = (RtRay){.kind = set->kind};
            memcpy(ray, rows[i], sizeof rows[i]);
            if (rt_ray_is_valid(ray)) continue;
            return rt_fail(error, RT_BAD_INPUT,
                           "%s: row %" PRIu64
                           " (the first is 0) is not a valid ray: %s. It has origin %.9g %.9g %.9g, tmin "
                           "%.9g, direction %.9g %.9g %.9g, tmax %.9g",
                           path, first + i, rt_ray_fault(ray), (double)rows[i][0], (double)rows[i][1],
                           (double)rows[i][2], (double)rows[i][3], (double)rows[i][4], (double)rows[i][5],
                           (double)rows[i][6], (double)rows[i][7]);
        }
    }
    return RT_OK;
}

RtStatus rt_rays_load(const char *path, RtRayKind kind, RtRaySet *set, RtError *error) {
    FILE *file;
    Layout layout;
    *set = (RtRaySet){.kind = kind};
    RT_TRY(rt_file_open(path, &file, error));
    RtStatus status =
        read_layout(file, path, take_ray_rows, "float32 of the shape (N, 8), as from array.astype('float32')",
                    &layout, error);
    if (status == RT_OK && layout.rows == 0)
        status = rt_fail(error, RT_BAD_INPUT, "%s: it contains no rays", path);
    if (status == RT_OK) status = rt_rayset_init(set, kind, layout.rows, error);
    if (status == RT_OK) status = read_rays(file, path, set, error);
    fclose(file);
    if (status == RT_OK)
        rt_rayset_seal(set);
    else
        rt_rayset_clear(set);
    return status;
}

/* ---- answers and counts ---- */

/* The hit of a row: no object, or all bits of it set, is a miss or a t alone. */
static RtStatus take_hit(const char *path, uint64_t row, const char *bytes, const Layout *layout,
                         uint32_t objects, RtHit *hit, RtError *error) {
    int64_t object = -1;
    *hit = (RtHit){.object = RT_UNNAMED_OBJECT};
    memcpy(&hit->t, bytes + layout->t, sizeof hit->t);
    memcpy(&object, bytes + layout->object, layout->object_bytes);
    if (layout->object_bytes == sizeof(int32_t)) object = (int32_t)object;
    if (layout->object_bytes > 0 ? object == -1 : hit->t == INFINITY) *hit = RT_MISS;
    if (layout->object_bytes == 0 && !(hit->t >= 0))
        return rt_fail(error, RT_BAD_INPUT,
                       "%s: row %" PRIu64 " (the first is 0): t is %g: a miss is written as infinity", path,
                       row, (double)hit->t);
    if (hit->object == RT_NO_OBJECT || layout->object_bytes == 0) return RT_OK;
    hit->object = (uint32_t)object;
    if (object >= 0 && object < (int64_t)objects) return RT_OK;
    return rt_fail(error, RT_BAD_INPUT,
                   "%s: row %" PRIu64 " (the first is 0): there is no object %" PRId64
                   ": the scene has %" PRIu32 ", from 0 on; a miss is object -1",
                   path, row, object, objects);
}

static RtStatus read_hits(FILE *file, const char *path, const Layout *layout, uint32_t objects, RtHit *hits,
                          RtError *error) {
    char row[MOST_ROW];
    for (uint64_t i = 0; i < layout->rows; i++) {
        if (fread(row, layout->bytes, 1, file) != 1)
            return rt_fail(error, RT_IO, "%s: reading failed before the last row", path);
        RT_TRY(take_hit(path, i, row, layout, objects, &hits[i], error));
    }
    return RT_OK;
}

RtStatus rt_hits_load(const char *path, uint64_t rays, uint32_t objects, RtHit **hits, RtError *error) {
    FILE *file;
    Layout layout;
    *hits = NULL;
    RT_TRY(rt_file_open(path, &file, error));
    RtStatus status = read_layout(
        file, path, take_hit_rows,
        "float32 of the shape (N,), the t of each hit, or (N,) of fields 't' (float32) and 'object' "
        "(int32, uint32, int64 or uint64), as in numpy.dtype([('t', '<f4'), ('object', '<i8')])",
        &layout, error);
    if (status == RT_OK && layout.rows != rays)
        status = rt_fail(error, RT_BAD_INPUT, "%s: %" PRIu64 " hit%s for %" PRIu64 " ray%s", path,
                         layout.rows, rt_plural(layout.rows), rays, rt_plural(rays));
    if (status == RT_OK && !(*hits = rt_alloc(rays, sizeof(RtHit))))
        status = rt_fail_memory(error, "hits", rays * sizeof(RtHit));
    if (status == RT_OK) status = read_hits(file, path, &layout, objects, *hits, error);
    fclose(file);
    if (status == RT_OK) return RT_OK;
    rt_free(*hits);
    *hits = NULL;
    return status;
}

void rt_hits_put(const RtRows *rows, FILE *out) {
    begin(out, rows->blocked ? "'|b1'" : "[('t', '<f4'), ('object', '<i8')]", rows->count, 0);
    if (rows->blocked) fwrite(rows->blocked, sizeof(bool), rows->count, out);
    for (uint64_t i = 0; rows->hits && i < rows->count; i++) {
        int64_t object = rows->hits[i].object == RT_NO_OBJECT ? -1 : (int64_t)rows->hits[i].object;
        fwrite(&rows->hits[i].t, sizeof(float), 1, out);
        fwrite(&object, sizeof object, 1, out);
    }
}

void rt_counts_put(const RtRows *rows, FILE *out) {
#define FIELD(name, meaning) "('" #name "', '<u8'), "
    begin(out, "[" RT_TALLY_COUNTERS(FIELD) "]", rows->count, 0);
    fwrite(rows->tallies, sizeof(RtTally), rows->count, out);
#undef FIELD
}
