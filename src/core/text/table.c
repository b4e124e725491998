/* SPDX-License-Identifier: Apache-2.0 */
#include "core/text/table.h"

#include "core/base/words.h"
#include "core/text/json.h"

#include <assert.h>
#include <inttypes.h>
#include <math.h>
#include <stdarg.h>
#include <stdlib.h>
#include <string.h>

static const struct {
    const char *says, *format;
} forms[] = {
#define ROW(form, says, format) {says, format},
    RT_FORMS(ROW)
#undef ROW
};

const char *rt_form_name(RtForm form) {
    return forms[form].says;
}

/* Whether the fields are numbers, which are right-aligned. */
static bool is_number(const RtTableColumn *column) {
    return column->form >= RT_FORM_integer;
}

/* The same, or numbers with intervals. */
static bool is_measured(const RtTableColumn *column) {
    return is_number(column) || column->form == RT_FORM_interval;
}

/* ---- fields ---- */

RtField rt_field_print(const char *format, ...) {
    RtField field = {.is = RT_FIELD_TEXT};
    va_list args;
    va_start(args, format);
    /* clang-tidy 14 does not see va_start. NOLINTNEXTLINE(clang-analyzer-valist.Uninitialized) */
    vsnprintf(field.buffer, sizeof field.buffer, format, args);
    va_end(args);
    return field;
}

/* The exponent of a number above 0 in scientific notation. */
static int magnitude(double size) {
    char text[32];
    snprintf(text, sizeof text, "%.17e", size);
    return (int)strtol(strchr(text, 'e') + 1, NULL, 10);
}

static double ten_to_the(int place) {
    char text[16];
    snprintf(text, sizeof text, "1e%d", place);
    return strtod(text, NULL);
}

/* The decimal place of the last digit of a figure of this size: -2 if it has two decimals. */
static int figure_place(double size) {
    return size >= 99.95 ? 0 : size >= 9.995 ? -1 : size >= 0.9995 ? -2 : size >= 0.0995 ? -3 : -4;
}

void rt_format_figure(double value, char *out) {
    const double size = fabs(value);
    if (isnan(value) || value == 0)
        strcpy(out, value == 0 ? "0" : "-");
    else if (size < 0.00095 || size >= 1e7)
        snprintf(out, 16, "%.1e", value);
    else
        snprintf(out, 16, "%.*f", -figure_place(size), value);
}

/* The power of ten that a number of this size, above 0, is printed in units of. */
static int power_of(double size) {
    return size >= 99999.5 || size < 0.00095 ? magnitude(size) : 0;
}

/* Rounded to the decimal place `place`, in units of 10^power. */
static void put_rounded(double value, int place, int power, char out[32]) {
    const double unit = ten_to_the(place);
    if (place > power) value = unit * rint(value / unit);
    const int decimals = place < power ? power - place : 0;
    if (value == 0 || isinf(value))
        strcpy(out, value == 0 ? "0" : value > 0 ? "inf" : "-inf");
    else
        snprintf(out, 32, power ? "%.*fe%d" : "%.*f", decimals, value / ten_to_the(power), power);
}

void rt_format_rough(double value, char out[32]) {
    const double size = fabs(value);
    if (size > 0 && isfinite(size))
        put_rounded(value, magnitude(size) - 1, power_of(size), out);
    else
        rt_format_figure(value, out);
}

/* Does the text read as 1? */
static bool reads_as_1(const char *text) {
    return strtod(text, NULL) == 1;
}

static void show_end(double value, char buffer[RT_MAX_FIELD]) {
    for (int digits = 6; digits <= 17; digits++) {
        snprintf(buffer, RT_MAX_FIELD, "%.*g", digits, value);
        if (value == 1 || !reads_as_1(buffer)) break;
    }
}

/* The last decimal place that an interval supports, of numbers of about `size`: that of half its width, at
 * most three digits or those of a figure, and at least one digit of each number. */
static int supported_place(double size, double half, double low) {
    const int power = power_of(size), most = power ? power - 2 : figure_place(size);
    if (!(half > 0)) return most;
    int place = magnitude(fmin(half, size));
    if (low > 0 && magnitude(low) < place) place = magnitude(low);
    return place > most ? place : most;
}

void rt_format_interval(double value, double low, double high, char out[RT_MAX_FIELD]) {
    char texts[3][32];
    const bool any = isfinite(value) && value != 0, holds_1 = low <= 1 && 1 <= high;
    const double end = isfinite(high) && high != 0 ? high : isfinite(low) ? low : 0;
    const double size = fabs(any ? value : end);
    const double half = isfinite(high - low) ? 0.5 * (high - low) : any ? value - low : 0.1 * size;
    const int power = size > 0 ? power_of(size) : 0;
    int place = size > 0 ? supported_place(size, half, low) : 0;
    const char *nearer = texts[low > 1 ? 1 : 2];
    do {
        put_rounded(value, place, power, texts[0]);
        put_rounded(low, place, power, texts[1]);
        put_rounded(high, place, power, texts[2]);
    } while (!holds_1 && reads_as_1(nearer) && place-- > -17);
    snprintf(out, RT_MAX_FIELD, isnan(low) || isnan(high) ? "%s" : "%s [%s, %s]", texts[0], texts[1],
             texts[2]);
}

static void show_real(RtForm form, double value, char buffer[RT_MAX_FIELD]) {
    if (form == RT_FORM_end)
        show_end(value, buffer);
    else if (forms[form].format)
        snprintf(buffer, RT_MAX_FIELD, forms[form].format, value);
    else if (form == RT_FORM_amount && value > 0 && value < 0.00095)
        strcpy(buffer, "<0.001");
    else
        (form == RT_FORM_interval ? rt_format_rough : rt_format_figure)(value, buffer);
}

const char *rt_field_show(RtForm form, const RtField *field, char buffer[RT_MAX_FIELD]) {
    buffer[0] = '\0';
    switch (field->is) {
    case RT_FIELD_MISSING: break;
    case RT_FIELD_TEXT: return field->text ? field->text : field->buffer;
    case RT_FIELD_FLAG: return field->integer ? "yes" : "no";
    case RT_FIELD_INTEGER:
        snprintf(buffer, RT_MAX_FIELD, form == RT_FORM_hash ? "%016" PRIx64 : "%" PRIu64, field->integer);
        break;
    case RT_FIELD_REAL: show_real(form, field->real, buffer); break;
    case RT_FIELD_INTERVAL:
        if (isfinite(field->real)) rt_format_interval(field->real, field->low, field->high, buffer);
        break;
    }
    return buffer;
}

/* One end of a ratio's interval; if it is not 1, nine digits do not show it as 1. */
static json_t *ratio_end(double value) {
    if (value > 1 && value < 1 + 1e-8) value = 1 + 1e-8;
    if (value < 1 && value > 1 - 1e-9) value = 1 - 1e-9;
    return rt_json_number(value);
}

static json_t *field_json(RtForm form, const RtField *field) {
    char buffer[RT_MAX_FIELD];
    switch (field->is) {
    case RT_FIELD_FLAG: return json_boolean(field->integer);
    case RT_FIELD_INTEGER:
        if (form != RT_FORM_hash) return json_integer((json_int_t)field->integer);
        break;
    case RT_FIELD_REAL: return form == RT_FORM_end ? ratio_end(field->real) : json_real(field->real);
    case RT_FIELD_INTERVAL:
        return json_pack("{s:o, s:o, s:o}", "value", rt_json_number(field->real), "low",
                         rt_json_number(field->low), "high", rt_json_number(field->high));
    case RT_FIELD_MISSING: return json_null();
    case RT_FIELD_TEXT: break;
    }
    return json_string(rt_field_show(form, field, buffer));
}

/* ---- rows ---- */

/* The fields of a row, in the order of the columns. */
typedef struct Line {
    size_t count;
    const RtTableColumn *columns[RT_MAX_TABLE_COLUMNS];
    RtField fields[RT_MAX_TABLE_COLUMNS];
} Line;

typedef struct Writer Writer;
struct Writer {
    const RtTable *table;
    void (*put)(Writer *writer, const Line *line, const void *row); /* `row` NULL: the header */
    FILE *out;
    int *widths;  /* of text */
    json_t *page; /* of rt_table_page */
};

static RtField field_of(const RtColumnGroup *group, size_t i, const void *row) {
    if (row && group->of) row = group->of(row);
    return row ? group->columns[i].get(row, &group->columns[i]) : rt_field_missing();
}

/* Without a row, only the columns. */
static void take(Line *line, const RtTable *table, const void *row) {
    line->count = 0;
    for (size_t g = 0; g < table->group_count; g++) {
        const RtColumnGroup *group = &table->groups[g];
        for (size_t i = 0; i < group->count; i++) {
            assert(line->count < RT_MAX_TABLE_COLUMNS);
            line->columns[line->count] = &group->columns[i];
            line->fields[line->count++] = field_of(group, i, row);
        }
    }
}

/* Field `i` as text; in `buffer` or the line. */
static const char *line_show(const Line *line, size_t i, char buffer[RT_MAX_FIELD]) {
    return rt_field_show(line->columns[i]->form, &line->fields[i], buffer);
}

static void write_row(Writer *w, const void *row) {
    Line line;
    take(&line, w->table, row);
    w->put(w, &line, row);
}

/* Writes the header and then each row. */
static void walk(Writer w) {
    write_row(&w, NULL);
    for (size_t i = 0; i < w.table->row_count; i++) {
        const void *row = w.table->row(w.table->context, i);
        if (row) write_row(&w, row);
    }
}

/* ---- CSV ---- */

/* Quoted if necessary (RFC 4180): a line that begins with # would be a comment; a carriage return before a
 * line break belongs to that. */
static void put_csv_field(FILE *out, const char *field) {
    if (!strpbrk(field, ",\"\r\n") && *field != '#') {
        fputs(field, out);
        return;
    }
    fputc('"', out);
    for (; *field; field++) fprintf(out, *field == '"' ? "\"\"" : "%c", *field);
    fputc('"', out);
}

static void put_csv(Writer *w, const Line *line, const void *row) {
    char buffer[RT_MAX_FIELD];
    for (size_t i = 0; i < line->count; i++) {
        if (i) fputc(',', w->out);
        put_csv_field(w->out, row ? line_show(line, i, buffer) : line->columns[i]->id);
    }
    fputc('\n', w->out);
}

void rt_table_csv(const RtTable *table, FILE *out) {
    walk((Writer){.table = table, .put = put_csv, .out = out});
}

/* ---- text ---- */

static const char *show_text(const Line *line, size_t i, const void *row, char buffer[RT_MAX_FIELD]) {
    const char *text = row ? line_show(line, i, buffer) : line->columns[i]->name;
    return *text ? text : "-";
}

static void widen(Writer *w, const Line *line, const void *row) {
    char buffer[RT_MAX_FIELD];
    for (size_t i = 0; i < line->count; i++) {
        int width = (int)strlen(show_text(line, i, row, buffer));
        if (width > w->widths[i]) w->widths[i] = width;
    }
}

enum { HIDDEN = -1, GAP = 2 }; /* the width of a column of another part; between columns */

static void put_text(Writer *w, const Line *line, const void *row) {
    char buffer[RT_MAX_FIELD];
    size_t last_shown = line->count - 1;
    if (w->table->above) w->table->above(w->table->context, row, w->out);
    while (last_shown > 0 && w->widths[last_shown] == HIDDEN) last_shown--;
    for (size_t i = 0; i < line->count; i++) {
        if (w->widths[i] == HIDDEN) continue;
        bool last = i == last_shown, left = !is_number(line->columns[i]);
        int width = left && last ? 0 : w->widths[i];
        fprintf(w->out, left ? "%-*s%s" : "%*s%s", width, show_text(line, i, row, buffer),
                last ? "\n" : "  ");
    }
}

void rt_table_widths(const RtTable *table, int widths[RT_MAX_TABLE_COLUMNS]) {
    memset(widths, 0, RT_MAX_TABLE_COLUMNS * sizeof *widths);
    walk((Writer){.table = table, .put = widen, .widths = widths});
}

void rt_table_line(const RtTable *table, int *widths, const void *row, FILE *out) {
    write_row(&(Writer){.table = table, .put = put_text, .out = out, .widths = widths}, row);
}

/* Sets part[] to the widths of the part that begins with column *next, 0 at first. Moves *next; false after
 * the last part. */
static bool next_part(const RtTable *table, const int widths[RT_MAX_TABLE_COLUMNS], int page, size_t *next,
                      int part[RT_MAX_TABLE_COLUMNS]) {
    size_t count = 0;
    for (size_t g = 0; g < table->group_count; g++) count += table->groups[g].count;
    size_t end = *next > 0 ? *next : 1;
    int left = page - widths[0];
    if (*next == count) return false;
    for (bool first = true; end < count && (first || widths[end] + GAP <= left); first = false)
        left -= widths[end++] + GAP;
    for (size_t i = 0; i < RT_MAX_TABLE_COLUMNS; i++)
        part[i] = i == 0 || (i >= *next && i < end) ? widths[i] : HIDDEN;
    *next = end;
    return true;
}

void rt_table_text(const RtTable *table, FILE *out) {
    int widths[RT_MAX_TABLE_COLUMNS], part[RT_MAX_TABLE_COLUMNS];
    rt_table_widths(table, widths);
    size_t next = 0;
    for (const char *before = ""; next_part(table, widths, rt_page_width(out), &next, part); before = "\n") {
        fputs(before, out);
        walk((Writer){.table = table, .put = put_text, .out = out, .widths = part});
    }
}

/* ---- Markdown ---- */

static void put_markdown(Writer *w, const Line *line, const void *row) {
    char buffer[RT_MAX_FIELD];
    fputc('|', w->out);
    for (size_t i = 0; i < line->count; i++) {
        const char *text = row ? line_show(line, i, buffer) : line->columns[i]->name;
        const char *mark = row && line->fields[i].bold ? "**" : "";
        if (*text) fprintf(w->out, " %s", mark);
        for (const char *c = text; *c; c++) fprintf(w->out, *c == '|' ? "\\|" : "%c", *c);
        fprintf(w->out, "%s |", *text ? mark : "");
    }
    fputs(row ? "\n" : "\n|", w->out);
    for (size_t i = 0; !row && i < line->count; i++) {
        bool right = is_measured(line->columns[i]);
        fprintf(w->out, " ---%s |%s", right ? ":" : "", i + 1 < line->count ? "" : "\n");
    }
}

void rt_table_markdown(const RtTable *table, FILE *out) {
    walk((Writer){.table = table, .put = put_markdown, .out = out});
}

/* ---- LaTeX ---- */

static void put_tex_text(const char *text, FILE *out) {
    static const char named[] = "\\~^<>|";
    static const char *const names[] = {"backslash", "asciitilde", "asciicircum", "less", "greater", "bar"};
    for (; *text; text++) {
        const char *at = strchr(named, *text);
        if (at)
            fprintf(out, "\\text%s{}", names[at - named]);
        else
            fprintf(out, strchr("&%$#_{}", *text) ? "\\%c" : "%c", *text);
    }
}

static void put_tex(Writer *w, const Line *line, const void *row) {
    char buffer[RT_MAX_FIELD];
    if (!row) {
        fputs("\\begin{tabular}{@{}", w->out);
        for (size_t i = 0; i < line->count; i++) fputc(is_measured(line->columns[i]) ? 'r' : 'l', w->out);
        fputs("@{}}\n\\toprule\n", w->out);
    }
    for (size_t i = 0; i < line->count; i++) {
        const char *text = row ? line_show(line, i, buffer) : line->columns[i]->name;
        const bool bold = row && line->fields[i].bold;
        fputs(i ? " & " : "", w->out);
        fputs(bold ? "\\textbf{" : "", w->out);
        if (*text)
            put_tex_text(text, w->out);
        else
            fputs("--", w->out);
        fputs(bold ? "}" : "", w->out);
    }
    fputs(row ? " \\\\\n" : " \\\\\n\\midrule\n", w->out);
}

void rt_table_tex(const RtTable *table, FILE *out) {
    const char *star = table->wide ? "*" : "";
    fprintf(out, "\\begin{table%s}\n\\footnotesize\\centering\\setlength{\\tabcolsep}{3pt}\n", star);
    if (table->caption) {
        fputs("\\caption{", out);
        put_tex_text(table->caption, out);
        fputs("}\\smallskip\n", out);
    }
    walk((Writer){.table = table, .put = put_tex, .out = out});
    fprintf(out, "\\bottomrule\n\\end{tabular}\n\\end{table%s}\n", star);
}

/* ---- JSON ---- */

/* False if memory is short. */
static bool put_members(const RtColumnGroup *group, const void *row, json_t *object) {
    for (size_t i = 0; i < group->count; i++) {
        RtField field = field_of(group, i, row);
        json_t *value = field_json(group->columns[i].form, &field);
        if (json_object_set_new(object, group->columns[i].name, value) != 0) return false;
    }
    return true;
}

static bool put_group(const RtColumnGroup *group, const void *row, json_t *object) {
    const char *name = group->name, *dot = name ? strchr(name, '.') : NULL;
    if (!name) return put_members(group, row, object);
    json_t *into = dot ? json_object_getn(object, name, (size_t)(dot - name)) : object;
    if (dot) name = dot + 1;
    if (json_is_null(into)) return true; /* so are its members */
    if (group->of && !group->of(row)) return json_object_set_new(into, name, json_null()) == 0;
    json_t *members = json_object();
    if (json_object_set(into, name, members) != 0) return json_decref(members), false;
    json_decref(members);
    return put_members(group, row, members);
}

json_t *rt_row_json(const RtColumnGroup *groups, size_t count, const void *row) {
    json_t *object = json_object();
    bool whole = object != NULL;
    for (size_t g = 0; whole && g < count; g++) whole = put_group(&groups[g], row, object);
    if (whole) return object;
    json_decref(object);
    return NULL;
}

json_t *rt_table_json(const RtTable *table) {
    json_t *rows = json_array();
    for (size_t i = 0; i < table->row_count; i++) {
        const void *row = table->row(table->context, i);
        if (!row || json_array_append_new(rows, rt_row_json(table->groups, table->group_count, row)) == 0)
            continue;
        json_decref(rows);
        return NULL;
    }
    return rows;
}

/* ---- JSON for pages ---- */

static json_t *page_field(const RtTableColumn *column, const RtField *field) {
    char buffer[RT_MAX_FIELD];
    const char *text = rt_field_show(column->form, field, buffer);
    json_t *value = json_null();
    if (!is_measured(column) && !field->note) return json_string(text);
    if (field->is == RT_FIELD_INTEGER) value = json_integer((json_int_t)field->integer);
    if (field->is >= RT_FIELD_REAL) value = rt_json_number(field->real);
    return json_pack("[s, o, s*]", text, value, field->note);
}

/* A context: the object of the table. */
static void put_page(Writer *w, const Line *line, const void *row) {
    static const char *const standings[] = {"", "level", "best"};
    json_t *list = json_array();
    for (size_t i = 0; i < line->count; i++) {
        const RtTableColumn *column = line->columns[i];
        json_array_append_new(list,
                              row ? page_field(column, &line->fields[i])
                                  : json_pack("{s:s, s:s, s:s, s:b}", "id", column->id, "name", column->name,
                                              "meaning", column->meaning, "number", is_measured(column)));
    }
    if (!row) {
        json_object_set_new(w->page, "columns", list);
        return;
    }
    const RtStanding standing = w->table->standing ? w->table->standing(row) : RT_STANDING_BEHIND;
    json_array_append_new(json_object_get(w->page, "rows"),
                          json_pack("{s:s, s:o}", "standing", standings[standing], "fields", list));
}

json_t *rt_table_page(const RtTable *table) {
    json_t *page = json_pack("{s:s, s:[]}", "title", table->caption ? table->caption : "", "rows");
    if (page) walk((Writer){.table = table, .put = put_page, .page = page});
    return page;
}
