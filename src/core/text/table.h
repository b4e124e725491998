/* SPDX-License-Identifier: Apache-2.0 */
/* Tables: results, described once and written in every format: CSV, text for a terminal, Markdown, LaTeX
 * and JSON.
 *
 * A column has a name, a meaning, a unit, the format of its fields, and a getter that computes a field from a
 * row. Columns come in groups; a table is some groups over some rows. A row is whatever the getters take,
 * usually a cursor of the caller that is set to one item after another. An unknown field is empty in CSV and
 * Markdown, null in JSON, - elsewhere.
 *
 * A macro lists the columns, so that each stands on a line with its value, an expression of `r`, the row. The
 * file defines the type Row:
 *
 *     typedef RtThing Row;
 *     #define COLUMNS(X) X(bytes, "bytes", integer, "bytes", "memory it takes", r->bytes)
 *     RT_TABLE_COLUMNS(columns, COLUMNS)
 *
 * defines the array `columns`; rt_field lists the types of values. */
#ifndef RT_TEXT_TABLE_H
#define RT_TEXT_TABLE_H

#include <jansson.h>
#include <math.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>

/* X(form, name in docs, printf format of a real number): how fields are written. Numbers are
 * right-aligned. `end` is one end of a ratio's interval: six digits, or as many as show that it is not 1;
 * `interval` is rt_format_interval, or rt_format_rough of a number without one. `figure` takes about four
 * characters; `amount`, too, except that less than 0.001 is <0.001. `markup` is text with Markdown's `code`
 * and **bold**; `json` cannot be a table cell. */
#define RT_FORMS(X)                                                                                          \
    X(text, "text", NULL)                                                                                    \
    X(markup, "text", NULL)                                                                                  \
    X(flag, "yes or no", NULL)                                                                               \
    X(hash, "16 hexadecimal digits", NULL)                                                                   \
    X(json, "JSON", NULL)                                                                                    \
    X(interval, "interval: value, low, high", NULL)                                                          \
    X(integer, "integer", "%.9g")                                                                            \
    X(real4, "real", "%.4g")                                                                                 \
    X(real6, "real", "%.6g")                                                                                 \
    X(real9, "real", "%.9g")                                                                                 \
    X(end, "real", NULL)                                                                                     \
    X(percent, "real", "%.2f")                                                                               \
    X(figure, "real", NULL)                                                                                  \
    X(amount, "real", NULL)

typedef enum RtForm {
#define RT_FORM_ENUM(form, says, format) RT_FORM_##form,
    RT_FORMS(RT_FORM_ENUM)
#undef RT_FORM_ENUM
} RtForm;

/* "text", "integer", ... */
const char *rt_form_name(RtForm form);

/* ---- fields ---- */

#define RT_MAX_FIELD 160 /* bytes of a printed text */

typedef struct RtField {
    enum {
        RT_FIELD_MISSING,
        RT_FIELD_TEXT,
        RT_FIELD_FLAG,
        RT_FIELD_INTEGER,
        RT_FIELD_REAL,
        RT_FIELD_INTERVAL
    } is;
    const char *text; /* borrowed; NULL: it is in `buffer` */
    uint64_t integer; /* flags, too */
    double real, low, high;
    const char *note; /* borrowed; a tooltip in pages; or NULL */
    bool bold;        /* in Markdown and LaTeX */
    char buffer[RT_MAX_FIELD];
} RtField;

static inline RtField rt_field_missing(void) {
    return (RtField){.is = RT_FIELD_MISSING};
}

/* NULL: missing. */
static inline RtField rt_field_text(const char *text) {
    return (RtField){.is = text ? RT_FIELD_TEXT : RT_FIELD_MISSING, .text = text};
}

static inline RtField rt_field_flag(bool flag) {
    return (RtField){.is = RT_FIELD_FLAG, .integer = flag};
}

static inline RtField rt_field_integer(uint64_t integer) {
    return (RtField){.is = RT_FIELD_INTEGER, .integer = integer};
}

/* NAN and infinities: missing. */
static inline RtField rt_field_real(double real) {
    return (RtField){.is = isfinite(real) ? RT_FIELD_REAL : RT_FIELD_MISSING, .real = real};
}

static inline RtField rt_field_interval(double value, double low, double high) {
    return (RtField){.is = RT_FIELD_INTERVAL, .real = value, .low = low, .high = high};
}

static inline RtField rt_field_same(RtField field) {
    return field;
}

/* A printed text, truncated if it does not fit. */
__attribute__((format(printf, 1, 2))) RtField rt_field_print(const char *format, ...);

/* The field of a value, of any of these types. */
#define rt_field(value)                                                                                      \
    _Generic((value), RtField                                                                                \
             : rt_field_same, char *                                                                         \
             : rt_field_text, const char *                                                                   \
             : rt_field_text, bool                                                                           \
             : rt_field_flag, uint32_t                                                                    \
             : rt_field_integer, uint64_t                                                                    \
             : rt_field_integer, double                                                                      \
             : rt_field_real)(value)

/* A field as text; "" if it is missing. In `buffer` or the field. */
const char *rt_field_show(RtForm form, const RtField *field, char buffer[RT_MAX_FIELD]);

/* A number in about four characters: 0, 0.0034, 1.24, 12.4, 124, 69666; "-" for NAN. Needs 16 bytes. */
void rt_format_figure(double value, char *out);

/* A number with its interval: "1.23 [1.17, 1.31]", "1.2e5 [0.9e5, 1.6e5]"; without it if an end is NAN. It
 * has no more digits than the interval supports, except to show that the interval does not contain 1. Ends
 * may be INFINITY: "inf". */
void rt_format_interval(double value, double low, double high, char out[RT_MAX_FIELD]);

/* A number whose error is unknown, in two digits: 0.35, 12, 350, 1.2e5. */
void rt_format_rough(double value, char out[32]);

/* ---- columns ---- */

typedef struct RtTableColumn RtTableColumn;
struct RtTableColumn {
    const char *id;      /* in CSV */
    const char *name;    /* everywhere else */
    const char *unit;    /* or "" */
    const char *meaning; /* one line */
    RtField (*get)(const void *row, const RtTableColumn *column);
    RtForm form;
    int key; /* the getter's own */
};

/* LIST(X) lists X(id, name, form, unit, meaning, value); ids are unique within a file. */
#define RT_TABLE_GETTER(id, name, form, unit, meaning, value)                                                \
    static RtField get_##id(const void *row, const RtTableColumn *column) {                                  \
        const Row *r = row;                                                                                  \
        (void)r, (void)column;                                                                               \
        return rt_field(value);                                                                              \
    }
#define RT_TABLE_COLUMN(id, name, form, unit, meaning, value)                                                \
    {#id, name, unit, meaning, get_##id, RT_FORM_##form, 0},
#define RT_TABLE_PLACE(id, name, form, unit, meaning, value) AT_##id,
#define RT_TABLE_COLUMNS(array, LIST)                                                                        \
    LIST(RT_TABLE_GETTER)                                                                                    \
    enum { LIST(RT_TABLE_PLACE) };                                                                           \
    static const RtTableColumn array[] = {LIST(RT_TABLE_COLUMN)};

/* Adjacent columns over one kind of row. In JSON a named group is an object of its own, and a group named
 * "GROUP.NAME" is a member of the object GROUP before it. */
typedef struct RtColumnGroup {
    const char *name; /* or NULL */
    const RtTableColumn *columns;
    size_t count;
    const void *(*of)(const void *row); /* maps the table's row to the group's; NULL: the same row. If it
                                         * returns NULL, all fields are missing */
} RtColumnGroup;

/* All columns of an array; a range of columns; one column. */
#define RT_ALL(array)                                                                                        \
    { NULL, array, sizeof(array) / sizeof *(array), NULL }
#define RT_FROM_TO(array, first, last)                                                                       \
    { NULL, &(array)[AT_##first], AT_##last - AT_##first + 1, NULL }
#define RT_ONE(array, id) RT_FROM_TO(array, id, id)

/* ---- tables ---- */

#define RT_MAX_TABLE_COLUMNS 80

/* How a row compares with the others: the best row is marked, and so are rows whose intervals overlap with
 * its interval. */
typedef enum RtStanding { RT_STANDING_BEHIND, RT_STANDING_LEVEL, RT_STANDING_BEST } RtStanding;

typedef struct RtTable {
    const RtColumnGroup *groups;
    size_t group_count;
    size_t row_count;
    const void *(*row)(void *context, size_t i); /* NULL: skip this row; the next call may reuse the row */
    void *context;
    /* Text: prints lines above each row, and with the row NULL above the header; or NULL. */
    void (*above)(void *context, const void *row, FILE *out);
    RtStanding (*standing)(const void *row); /* pages; NULL: no marks */
    const char *caption;                     /* LaTeX, pages; or NULL */
    bool wide;                               /* LaTeX: as wide as both columns of an article */
} RtTable;

/* Initialises the first two members of a table from an array of groups. */
#define RT_GROUPS(array) .groups = array, .group_count = sizeof(array) / sizeof *(array)

void rt_table_csv(const RtTable *table, FILE *out);

/* A table that is wider than the page (rt_page_width) is printed in parts, with a blank line between them:
 * each has the first column, and as many of the others as fit. */
void rt_table_text(const RtTable *table, FILE *out);
void rt_table_markdown(const RtTable *table, FILE *out);

/* A table environment for the package booktabs. */
void rt_table_tex(const RtTable *table, FILE *out);

/* An array of objects, and a single one: new references, NULL if memory is short. */
json_t *rt_table_json(const RtTable *table);
json_t *rt_row_json(const RtColumnGroup *groups, size_t count, const void *row);

/* A table for the script of a page: {"title": the caption, "columns": [{"id", "name", "meaning", "number"}],
 * "rows": [{"standing": "" or "level" or "best", "fields"}]}. A field is its text; that of a number
 * or with a note is [text, number or null, note]. A new reference; NULL or incomplete if memory is short. */
json_t *rt_table_page(const RtTable *table);

/* Text output line by line, for rows that arrive one by one: column widths for the header and all rows so
 * far, and one row (NULL: the header). */
void rt_table_widths(const RtTable *table, int widths[RT_MAX_TABLE_COLUMNS]);
void rt_table_line(const RtTable *table, int *widths, const void *row, FILE *out);

#endif
