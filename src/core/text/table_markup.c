/* SPDX-License-Identifier: Apache-2.0 */
/* Tables as Markdown and LaTeX. */
#include "core/text/table_line.h"

#include <string.h>

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
        bool right = rt_column_is_measured(line->columns[i]);
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
        for (size_t i = 0; i < line->count; i++)
            fputc(rt_column_is_measured(line->columns[i]) ? 'r' : 'l', w->out);
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
