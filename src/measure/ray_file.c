/* SPDX-License-Identifier: Apache-2.0 */
/* A file of an array begins with magic bytes, a version, and the length of the header, which is a Python
 * dictionary as text (NumPy Enhancement Proposal 1); then the numbers follow as they lie in memory. Input is
 * not trusted: the version must be 1.0, 2.0 or 3.0, the dictionary must have exactly the three keys of the
 * format, and the file must be as long as it says. A text, .csv, has a line that names its columns, then a
 * line per row, which becomes the bytes that it would be in an array. */
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
    MAGIC_BYTES = 6,
    MOST_HEADER = 4096, /* bytes of text; an array of numbers needs about a hundred */
    MOST_ROW = 4096,    /* bytes of a hit with other fields, or of a line of text */
    MOST_COLUMNS = 64,  /* of a text */
    MULTIPLE = 64       /* alignment of the numbers */
};
static const char MAGIC[MAGIC_BYTES + 1] = "\x93NUMPY", BYTE_ORDER_MARK[] = "\xEF\xBB\xBF";

/* ---- reading headers ---- */

/* The text of the header. */
static RtStatus read_header(FILE *file, const char *path, char text[MOST_HEADER + 1], RtError *error) {
    unsigned char start[MAGIC_BYTES + 2], size[4] = {0};
    if (fread(start, 1, sizeof start, file) != sizeof start || memcmp(start, MAGIC, MAGIC_BYTES) != 0)
        return rt_fail(error, RT_BAD_INPUT,
                       "%s: this is not a NumPy array: write it with numpy.save, or text to a .csv", path);
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

/* A file of rows, and in it: an array in C order, or a text with the extension .csv. */
typedef struct Source Source;

typedef struct Form {
    /* Sets the layout of rows from the type and the other dimensions of an array; false: not of this form. */
    bool (*take)(const json_t *descr, const json_t *shape, Source *source);
    const char *array;                 /* what it takes */
    const char *names[RT_RAY_COLUMNS]; /* [count] of columns of a text, in the order of its own files */
    int count;
    uint32_t needed; /* bits 1 << index */
} Form;

struct Source {
    FILE *file;
    const char *path;
    const Form *form;
    uint64_t rows;
    size_t bytes; /* of a row */
    /* Of rows of hits: where t is, and an integer of 4 or 8 bytes; 0 bytes: there is none. */
    size_t t, object, object_bytes;
    bool text;
    int columns[MOST_COLUMNS], column_count; /* of a text: indices into form->names, -1 for others */
};

static RtStatus fail_to_read(const Source *s, RtError *error) {
    return rt_fail(error, RT_IO, "%s: reading failed before the last row", s->path);
}

static bool is_type(const json_t *descr, const char *type) {
    return json_is_string(descr) && strcmp(json_string_value(descr), type) == 0;
}

static bool take_rays(const json_t *descr, const json_t *shape, Source *s) {
    s->bytes = RT_RAY_COLUMNS * sizeof(float);
    return is_type(descr, "<f4") && json_array_size(shape) == 2 &&
           json_integer_value(json_array_get(shape, 1)) == RT_RAY_COLUMNS;
}

static bool take_hits(const json_t *descr, const json_t *shape, Source *s) {
    const size_t dimensions = json_array_size(shape);
    const json_t *field;
    size_t i;
    bool t = false;
    s->bytes = sizeof(float);
    if (is_type(descr, "<f4"))
        return dimensions == 1 || (dimensions == 2 && json_integer_value(json_array_get(shape, 1)) == 1);
    s->bytes = 0;
    json_array_foreach(descr, i, field) {
        const char *name = json_string_value(json_array_get(field, 0));
        const char *type = json_string_value(json_array_get(field, 1));
        const bool sized = type && strlen(type) > 2 && strchr("biufV", type[1]);
        const size_t bytes = sized ? strtoul(type + 2, NULL, 10) : 0;
        if (!name || bytes == 0 || bytes > MOST_ROW || json_array_size(field) != 2) return false;
        if (strcmp(name, "t") == 0) {
            s->t = s->bytes;
            t = strcmp(type, "<f4") == 0;
        } else if (strcmp(name, "object") == 0) {
            const bool integer = strncmp(type, "<i", 2) == 0 || strncmp(type, "<u", 2) == 0;
            if (!integer || (bytes != sizeof(uint32_t) && bytes != sizeof(uint64_t))) return false;
            s->object = s->bytes;
            s->object_bytes = bytes;
        }
        s->bytes += bytes;
    }
    return t && s->object_bytes > 0 && s->bytes <= MOST_ROW && dimensions == 1;
}

static const Form rays_form = {.take = take_rays,
                               .array = "float32 of the shape (N, 8), as from array.astype('float32')",
                               .names = {"ox", "oy", "oz", "tmin", "dx", "dy", "dz", "tmax"},
                               .count = RT_RAY_COLUMNS,
                               .needed = 0x77};
enum { T, OBJECT };
static const Form hits_form = {
    .take = take_hits,
    .array =
        "float32 of the shape (N,), the t of each hit, or (N,) of fields 't' (float32) and 'object' (int32, "
        "uint32, int64 or uint64), as in numpy.dtype([('t', '<f4'), ('object', '<i8')])",
    .names = {[T] = "t", [OBJECT] = "object"},
    .count = 2,
    .needed = 1 << T};

static RtStatus check_header(const json_t *header, const char *text, Source *s, RtError *error) {
    const json_t *descr = json_object_get(header, "descr"), *shape = json_object_get(header, "shape");
    const json_t *order = json_object_get(header, "fortran_order");
    const json_int_t count = json_integer_value(json_array_get(shape, 0));
    if (!descr || !json_is_array(shape) || !json_is_boolean(order) || json_object_size(header) != 3 ||
        count < 0)
        return rt_fail(error, RT_BAD_INPUT,
                       "%s: the header is not {'descr': ..., 'fortran_order': ..., 'shape': ...}: %.80s",
                       s->path, text);
    if (json_is_true(order))
        return rt_fail(error, RT_BAD_INPUT,
                       "%s: the array is column-major: expected row-major, as from numpy.ascontiguousarray",
                       s->path);
    s->rows = (uint64_t)count;
    if (s->form->take(descr, shape, s)) return RT_OK;
    return rt_fail(error, RT_BAD_INPUT, "%s: expected %s; this is %.*s", s->path, s->form->array,
                   (int)strcspn(text, "}") + 1, text);
}

static RtStatus open_array(Source *s, RtError *error) {
    char text[MOST_HEADER + 1];
    struct stat info;
    RT_TRY(read_header(s->file, s->path, text, error));
    json_t *header = parse(text);
    RtStatus status = check_header(header, text, s, error);
    json_decref(header);
    RT_TRY(status);
    const long start = ftell(s->file);
    if (start < 0 || fstat(fileno(s->file), &info) != 0)
        return rt_fail(error, RT_IO, "%s: its length is unknown", s->path);
    const uint64_t there = (uint64_t)info.st_size - (uint64_t)start;
    if (s->rows > RT_MAX_RAYS_A_KIND || s->rows * s->bytes == there) return RT_OK;
    return rt_fail(error, RT_BAD_INPUT,
                   "%s: %" PRIu64 " rows of %zu bytes are %" PRIu64 " bytes, but %" PRIu64
                   " follow the header: was the file cut off?",
                   s->path, s->rows, s->bytes, s->rows * s->bytes, there);
}

/* ---- text: a line of names, then a line per row ---- */

/* The next line that is not empty, without its end; false if there is none. */
static bool read_line(FILE *file, char line[MOST_ROW]) {
    do {
        if (!fgets(line, MOST_ROW, file)) return false;
        line[strcspn(line, "\r\n")] = '\0';
    } while (!*line);
    return true;
}

static RtStatus open_text(Source *s, RtError *error) {
    char line[MOST_ROW] = "", *rest = line;
    uint32_t found = 0;
    read_line(s->file, line);
    if (strncmp(line, BYTE_ORDER_MARK, 3) == 0) rest += 3;
    for (char *word; s->column_count < MOST_COLUMNS && (word = strsep(&rest, ",")); s->column_count++) {
        int k = s->form->count - 1;
        word += strspn(word, " ");
        word[strcspn(word, " ")] = '\0';
        while (k >= 0 && strcmp(word, s->form->names[k]) != 0) k--;
        s->columns[s->column_count] = k;
        if (k < 0) continue;
        if (found >> k & 1)
            return rt_fail(error, RT_BAD_INPUT, "%s: the first line names '%s' twice", s->path,
                           s->form->names[k]);
        found |= 1u << k;
    }
    if ((found & s->form->needed) != s->form->needed)
        return rt_fail(error, RT_BAD_INPUT,
                       "%s: the first line names the columns: expected %s among at most %d", s->path,
                       s->form == &rays_form ? "ox,oy,oz,tmin,dx,dy,dz,tmax, with or without tmin and tmax,"
                                             : "t,object or t",
                       MOST_COLUMNS);
    const long start = ftell(s->file);
    while (read_line(s->file, line)) s->rows++;
    if (start < 0 || ferror(s->file) || fseek(s->file, start, SEEK_SET) != 0) return fail_to_read(s, error);
    s->object = sizeof(int64_t);
    if (s->form == &hits_form && found >> OBJECT & 1) s->object_bytes = sizeof(int64_t);
    return RT_OK;
}

/* As in an array: floats one after the other; `object` of 8 bytes behind the first two. */
static RtStatus read_words(Source *s, uint64_t row, char *bytes, RtError *error) {
    static const float defaults[RT_RAY_COLUMNS] = {[7] = INFINITY};
    char line[MOST_ROW] = "", *rest = line, *word, *end;
    int column = 0;
    memcpy(bytes, defaults, sizeof defaults);
    if (!read_line(s->file, line)) return fail_to_read(s, error);
    for (; (word = strsep(&rest, ",")) && column < s->column_count; column++) {
        const int k = s->columns[column];
        const bool integer = s->form == &hits_form && k == OBJECT;
        if (k < 0) continue;
        const float number = strtof(word, &end);
        const int64_t object = integer ? strtoll(word, &end, 10) : 0;
        if (end == word || *end)
            return rt_fail(error, RT_BAD_INPUT, "%s: row %" PRIu64 " (the first is 0): %s is '%s': no %s",
                           s->path, row, s->form->names[k], word, integer ? "integer" : "number");
        if (integer)
            memcpy(bytes + s->object, &object, sizeof object);
        else
            memcpy(bytes + (size_t)k * sizeof number, &number, sizeof number);
    }
    if (!word && column == s->column_count) return RT_OK;
    return rt_fail(error, RT_BAD_INPUT,
                   "%s: row %" PRIu64 " (the first is 0) has not the %d columns of the first line", s->path,
                   row, s->column_count);
}

/* ---- rows ---- */

/* Call close_rows also after a failure. */
static RtStatus open_rows(Source *s, const char *path, const Form *form, RtError *error) {
    *s = (Source){.path = path, .form = form, .text = rt_ends_in(path, ".csv")};
    RT_TRY(rt_file_open(path, &s->file, error));
    RT_TRY((s->text ? open_text : open_array)(s, error));
    if (s->rows <= RT_MAX_RAYS_A_KIND) return RT_OK;
    return rt_fail(error, RT_BAD_INPUT, "%s: %" PRIu64 " rows: at most %" PRIu64 " are read", path, s->rows,
                   (uint64_t)RT_MAX_RAYS_A_KIND);
}

static void close_rows(Source *s) {
    if (s->file) fclose(s->file);
}

static RtStatus read_row(Source *s, uint64_t row, char bytes[MOST_ROW], RtError *error) {
    if (s->text) return read_words(s, row, bytes, error);
    if (fread(bytes, s->bytes, 1, s->file) == 1) return RT_OK;
    return fail_to_read(s, error);
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
    const bool text = rt_ends_in(path, ".csv");
    RtOutput output;
    RT_TRY(rt_output_open(&output, path, error));
    if (!text) begin(output.file, "'<f4'", set->count, RT_RAY_COLUMNS);
    for (int k = 0; text && k < RT_RAY_COLUMNS; k++)
        fprintf(output.file, "%s%c", rays_form.names[k], k < RT_RAY_COLUMNS - 1 ? ',' : '\n');
    for (uint64_t i = 0; i < set->count; i++) {
        float row[RT_RAY_COLUMNS];
        memcpy(row, &set->rays[i], sizeof row);
        if (!text) fwrite(row, sizeof row, 1, output.file);
        for (int k = 0; text && k < RT_RAY_COLUMNS; k++)
            fprintf(output.file, "%.9g%c", (double)row[k], k < RT_RAY_COLUMNS - 1 ? ',' : '\n');
    }
    return rt_output_commit(&output, error);
}

const char *rt_ray_fault(const RtRay *ray) {
    float size = rt_maxf(rt_maxf(fabsf(ray->org.x), fabsf(ray->org.y)), fabsf(ray->org.z));
    if (!rt_finite(ray->org) || size > RT_MAX_COORDINATE) return "its origin is not finite, or beyond 5e17";
    if (!rt_finite(ray->dir)) return "its direction is not finite as float32";
    if (ray->dir.x == 0 && ray->dir.y == 0 && ray->dir.z == 0) return "its direction is zero as float32";
    if (!(ray->tmin >= 0) || !isfinite(ray->tmin)) return "its tmin is negative or not finite";
    return "its tmax is less than its tmin, or not a number";
}

static RtStatus read_rays(Source *source, RtRaySet *set, RtError *error) {
    char bytes[MOST_ROW];
    for (uint64_t i = 0; i < set->count; i++) {
        RtRay *ray = &set->rays[i];
        char says[RT_RAY_TEXT];
        RT_TRY(read_row(source, i, bytes, error));
        *ray = (RtRay){.kind = set->kind};
        memcpy(ray, bytes, RT_RAY_COLUMNS * sizeof(float));
        if (rt_ray_is_valid(ray)) continue;
        rt_ray_format(ray, says, sizeof says);
        return rt_fail(error, RT_BAD_INPUT, "%s: row %" PRIu64 " (the first is 0) is not a valid ray: %s: %s",
                       source->path, i, rt_ray_fault(ray), says);
    }
    return RT_OK;
}

RtStatus rt_rays_load(const char *path, RtRayKind kind, RtRaySet *set, RtError *error) {
    RT_OWNED(Source, source, close_rows);
    *set = (RtRaySet){.kind = kind};
    RT_TRY(open_rows(&source, path, &rays_form, error));
    if (source.rows == 0) return rt_fail(error, RT_BAD_INPUT, "%s: it contains no rays", path);
    RT_TRY(rt_rayset_init(set, kind, source.rows, error));
    const RtStatus status = read_rays(&source, set, error);
    if (status == RT_OK)
        rt_rayset_seal(set);
    else
        rt_rayset_clear(set);
    return status;
}

/* ---- hits ---- */

/* The hit of a row: no object, or all bits of it set, is a miss or a t alone. */
static RtStatus take_hit(const Source *s, uint64_t row, const char *bytes, uint32_t objects, RtHit *hit,
                         RtError *error) {
    int64_t object = -1;
    *hit = (RtHit){.object = RT_UNNAMED_OBJECT};
    memcpy(&hit->t, bytes + s->t, sizeof hit->t);
    memcpy(&object, bytes + s->object, s->object_bytes);
    if (s->object_bytes == sizeof(int32_t)) object = (int32_t)object;
    if (s->object_bytes > 0 ? object == -1 : hit->t == INFINITY) *hit = RT_MISS;
    if (s->object_bytes == 0 && !(hit->t >= 0))
        return rt_fail(error, RT_BAD_INPUT,
                       "%s: row %" PRIu64 " (the first is 0): t is %g: a miss is written as infinity",
                       s->path, row, (double)hit->t);
    if (hit->object == RT_NO_OBJECT || s->object_bytes == 0) return RT_OK;
    hit->object = (uint32_t)object;
    if (object >= 0 && object < (int64_t)objects) return RT_OK;
    return rt_fail(error, RT_BAD_INPUT,
                   "%s: row %" PRIu64 " (the first is 0): there is no object %" PRId64
                   ": the scene has %" PRIu32 ", from 0 on; a miss is object -1",
                   s->path, row, object, objects);
}

RtStatus rt_hits_load(const char *path, uint64_t rays, uint32_t objects, RtHit **hits, RtError *error) {
    RT_OWNED(Source, source, close_rows);
    char bytes[MOST_ROW];
    RtStatus status = RT_OK;
    *hits = NULL;
    RT_TRY(open_rows(&source, path, &hits_form, error));
    if (source.rows != rays)
        return rt_fail(error, RT_BAD_INPUT, "%s: %" PRIu64 " hit%s for %" PRIu64 " ray%s", path, source.rows,
                       rt_plural(source.rows), rays, rt_plural(rays));
    *hits = rt_alloc(rays, sizeof(RtHit));
    if (!*hits) return rt_fail_memory(error, "hits", rays * sizeof(RtHit));
    for (uint64_t i = 0; i < rays && status == RT_OK; i++) {
        status = read_row(&source, i, bytes, error);
        if (status == RT_OK) status = take_hit(&source, i, bytes, objects, &(*hits)[i], error);
    }
    if (status == RT_OK) return RT_OK;
    rt_free(*hits);
    *hits = NULL;
    return status;
}

void rt_hits_put(const RtRows *rows, const char *path, FILE *out) {
    const bool text = rt_ends_in(path, ".csv");
    if (text)
        fputs(rows->blocked ? "blocked\n" : "t,object\n", out);
    else
        begin(out, rows->blocked ? "'|b1'" : "[('t', '<f4'), ('object', '<i8')]", rows->count, 0);
    for (uint64_t i = 0; rows->blocked && i < rows->count; i++) {
        if (text)
            fprintf(out, "%d\n", rows->blocked[i]);
        else
            fwrite(&rows->blocked[i], sizeof(bool), 1, out);
    }
    for (uint64_t i = 0; rows->hits && i < rows->count; i++) {
        int64_t object = rows->hits[i].object == RT_NO_OBJECT ? -1 : (int64_t)rows->hits[i].object;
        if (text) {
            fprintf(out, "%.9g,%" PRId64 "\n", (double)rows->hits[i].t, object);
            continue;
        }
        fwrite(&rows->hits[i].t, sizeof(float), 1, out);
        fwrite(&object, sizeof object, 1, out);
    }
}
