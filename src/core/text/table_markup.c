/* SPDX-License-Identifier: Apache-2.0 */
/* Tables as Markdown, LaTeX and HTML. */
#include "core/text/table_line.h"

#include <inttypes.h>
#include <string.h>

/* Numbers, also with intervals. */
static bool is_sortable(const RtTableColumn *column) {
    return rt_column_is_number(column) || column->form == RT_FORM_interval;
}

/* ---- Markdown ---- */

static void put_markdown(RtTableWriter *w, const RtTableLine *line, const void *row) {
    char buffer[RT_MAX_FIELD];
    fputc('|', w->out);
    for (size_t i = 0; i < line->count; i++) {
        const char *text = row ? rt_line_show(line, i, buffer) : line->columns[i]->name;
        const char *mark = row && line->fields[i].bold ? "**" : "";
        if (*text) fprintf(w->out, " %s", mark);
        for (const char *c = text; *c; c++) fprintf(w->out, *c == '|' ? "\\|" : "%c", *c);
        fprintf(w->out, "%s |", *text ? mark : "");
    }
    fputs(row ? "\n" : "\n|", w->out);
    for (size_t i = 0; !row && i < line->count; i++) {
        bool right = is_sortable(line->columns[i]) && !w->table->ragged;
        fprintf(w->out, " ---%s |%s", right ? ":" : "", i + 1 < line->count ? "" : "\n");
    }
}

void rt_table_markdown(const RtTable *table, FILE *out) {
    rt_table_walk((RtTableWriter){.table = table, .put = put_markdown, .out = out});
}

/* ---- LaTeX ---- */

static void put_tex_text(const char *text, FILE *out) {
    for (; *text; text++) {
        switch (*text) {
        case '\\': fputs("\\textbackslash{}", out); break;
        case '~': fputs("\\textasciitilde{}", out); break;
        case '^': fputs("\\textasciicircum{}", out); break;
        case '<': fputs("\\textless{}", out); break;
        case '>': fputs("\\textgreater{}", out); break;
        case '|': fputs("\\textbar{}", out); break;
        case '&':
        case '%':
        case '$':
        case '#':
        case '_':
        case '{':
        case '}': fprintf(out, "\\%c", *text); break;
        default: fputc(*text, out);
        }
    }
}

static void put_tex(RtTableWriter *w, const RtTableLine *line, const void *row) {
    char buffer[RT_MAX_FIELD];
    if (!row) {
        fputs("\\begin{tabular}{@{}", w->out);
        for (size_t i = 0; i < line->count; i++) fputc(is_sortable(line->columns[i]) ? 'r' : 'l', w->out);
        fputs("@{}}\n\\toprule\n", w->out);
    }
    for (size_t i = 0; i < line->count; i++) {
        const char *text = row ? rt_line_show(line, i, buffer) : line->columns[i]->name;
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
    rt_table_walk((RtTableWriter){.table = table, .put = put_tex, .out = out});
    fprintf(out, "\\bottomrule\n\\end{tabular}\n\\end{table%s}\n", star);
}

/* ---- HTML ---- */

static void put_character(FILE *out, char c) {
    switch (c) {
    case '<': fputs("&lt;", out); break;
    case '>': fputs("&gt;", out); break;
    case '&': fputs("&amp;", out); break;
    case '"': fputs("&quot;", out); break;
    default: fputc(c, out);
    }
}

void rt_html_put(FILE *out, const char *text) {
    for (; text && *text; text++) put_character(out, *text);
}

void rt_html_wrap(FILE *out, const char *before, const char *text, const char *after) {
    fputs(before, out);
    rt_html_put(out, text);
    fputs(after, out);
}

void rt_html_markup(FILE *out, const char *text) {
    bool code = false, bold = false;
    for (; *text; text++) {
        if (*text == '`' && (code || strchr(text + 1, '`'))) {
            fputs((code = !code) ? "<code>" : "</code>", out);
        } else if (text[0] == '*' && text[1] == '*' && (bold || strstr(text + 2, "**"))) {
            fputs((bold = !bold) ? "<b>" : "</b>", out);
            text++;
        } else {
            put_character(out, *text);
        }
    }
}

/* ` NAME="TEXT"` */
static void put_attribute(FILE *out, const char *name, const char *text) {
    fprintf(out, " %s=\"", name);
    rt_html_wrap(out, "", text, "\"");
}

static void put_header(const RtTableColumn *column, FILE *out) {
    fputs(is_sortable(column) ? "<th scope=\"col\" class=\"number\"" : "<th scope=\"col\"", out);
    put_attribute(out, "data-id", column->id);
    put_attribute(out, "title", column->meaning);
    rt_html_wrap(out, ">", column->name, "</th>");
}

static void put_field(const RtTableColumn *column, const RtField *field, FILE *out) {
    char buffer[RT_MAX_FIELD], value[32] = "";
    const char *text = rt_field_show(column->form, field, buffer);
    fputs(field->missed ? "<td class=\"missed\"" : "<td", out);
    if (field->is == RT_FIELD_INTEGER) snprintf(value, sizeof value, "%" PRIu64, field->integer);
    if (field->is >= RT_FIELD_REAL && *text) snprintf(value, sizeof value, "%.9g", field->real);
    if (is_sortable(column)) put_attribute(out, "data-value", value);
    if (field->note) put_attribute(out, "title", field->note);
    fputc('>', out);
    (column->form == RT_FORM_markup ? rt_html_markup : rt_html_put)(out, *text ? text : "-");
}

/* Visible without colour, and to screen readers. */
static const char *const standings[] = {
    [RT_STANDING_BEHIND] = "",
    [RT_STANDING_LEVEL] = " <span class=\"mark\" title=\"overlaps with the best\">&asymp;&#8239;best</span>",
    [RT_STANDING_BEST] = " <span class=\"mark\">&#9733;&#8239;best</span>"};

static void put_html(RtTableWriter *w, const RtTableLine *line, const void *row) {
    const char *color = row && w->table->color ? w->table->color(row) : NULL;
    const RtStanding standing = row && w->table->standing ? w->table->standing(row) : RT_STANDING_BEHIND;
    fputs(row ? "<tr" : "<thead><tr", w->out);
    if (standing != RT_STANDING_BEHIND) fputs(" class=\"best\"", w->out);
    if (color) fprintf(w->out, " style=\"--dot:%s\"", color);
    fputc('>', w->out);
    for (size_t i = 0; i < line->count; i++) {
        if (!row) {
            put_header(line->columns[i], w->out);
            continue;
        }
        put_field(line->columns[i], &line->fields[i], w->out);
        fprintf(w->out, "%s</td>", i == 0 ? standings[standing] : "");
    }
    fputs(row ? "</tr>\n" : "</tr></thead><tbody>\n", w->out);
}

/* The box scrolls if the table is wider; so it can be reached by keyboard and has a name. */
void rt_table_html(const RtTable *table, FILE *out) {
    fputs("<div class=\"wide\" tabindex=\"0\" role=\"region\"", out);
    put_attribute(out, "aria-label", table->caption ? table->caption : "table");
    fputs("><table>", out);
    if (table->caption) rt_html_wrap(out, "<caption>", table->caption, "</caption>");
    rt_table_walk((RtTableWriter){.table = table, .put = put_html, .out = out});
    fputs("</tbody></table></div>\n", out);
}
