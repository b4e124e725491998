/* SPDX-License-Identifier: Apache-2.0 */
/* Each result directory is loaded once, in the order of their names, and written into texts of its own for
 * both pages; the texts are then put together in the order of sections. */
#include "report/index.h"

#include "core/base/memory.h"
#include "core/text/table.h"
#include "report/index_entry.h"
#include "report/page.h"

#include <ctype.h>
#include <stddef.h>
#include <stdlib.h>
#include <string.h>

typedef struct Index {
    const char *folder;
    RtExperiment *experiment; /* for each in turn */
    bool inner;               /* in one of the folder's folders */
    RtIndexEntry *entries;    /* owned */
    uint32_t count, capacity;
    RtStatus status;
    RtError *error;
} Index;

/* ., .. and hidden folders. */
static bool is_hidden(const char *path) {
    return basename(path)[0] == '.';
}

static void add_entry(Index *index, const char *directory) {
    index->status = rt_reserve(&index->entries, &index->capacity, index->count + UINT64_C(1),
                               sizeof(RtIndexEntry), index->error);
    if (index->status != RT_OK) return;
    RtIndexEntry *entry = &index->entries[index->count];
    index->status = rt_index_entry_read(entry, directory, directory + strlen(index->folder) + 1,
                                        index->experiment, index->error);
    entry->number = index->count++;
}

static void visit(void *context, const char *path) {
    Index *index = context;
    if (is_hidden(path) || index->status != RT_OK) return;
    if (rt_index_is_entry(path)) {
        add_entry(index, path);
    } else if (!index->inner) {
        index->inner = true;
        rt_directory_each(path, "", visit, index);
        index->inner = false;
    }
}

/* ---- all of them ---- */

static const char *const sections[] = {"lecture", "papers", "speed", "arena", "verification"};
enum { SECTIONS = sizeof sections / sizeof sections[0] };

/* Those above in this order, then others, then none. */
static int order_of(const char *section) {
    int i = 0;
    while (i < SECTIONS && strcmp(sections[i], section) != 0) i++;
    return i + !*section;
}

static int compare(const void *a, const void *b) {
    const RtIndexEntry *x = a, *y = b;
    const int order = order_of(x->section) - order_of(y->section), names = strcmp(x->section, y->section);
    return order ? order : names ? names : x->number < y->number ? -1 : 1;
}

/* The title of a section: with a capital. */
static void title_of(const char *section, char title[RT_MAX_WORD]) {
    snprintf(title, RT_MAX_WORD, "%s", *section ? section : "others");
    title[0] = (char)toupper((unsigned char)title[0]);
}

static const char *origin_of(const Index *index, uint32_t i, size_t origin) {
    return (const char *)&index->entries[i] + origin;
}

/* Of how many entries `origin` (an offset) has the value of entry i; 0 if it has none, or an earlier entry
 * has it. */
static uint32_t count_first(const Index *index, uint32_t i, size_t origin) {
    const char *value = origin_of(index, i, origin);
    uint32_t count = 0;
    for (uint32_t k = 0; k < index->count; k++) {
        const bool same = *value && strcmp(value, origin_of(index, k, origin)) == 0;
        if (same && k < i) return 0;
        count += same;
    }
    return count;
}

/* "Measured by raytally 0.1.0 (abc); raytally 0.2.0 (def): one, two; ...": the most frequent value of
 * `origin`, then each other one with its entries. */
static void put_origins(const Index *index, size_t origin, const char *before, FILE *out) {
    uint32_t most = 0;
    for (uint32_t i = 0; i < index->count; i++)
        if (count_first(index, i, origin) > count_first(index, most, origin)) most = i;
    if (index->count == 0 || count_first(index, most, origin) == 0) return;
    fprintf(out, "%s%s", before, origin_of(index, most, origin));
    for (uint32_t i = 0; i < index->count; i++) {
        if (i == most || count_first(index, i, origin) == 0) continue;
        fprintf(out, "; %s", origin_of(index, i, origin));
        for (uint32_t k = i, named = 0; k < index->count; k++)
            if (strcmp(origin_of(index, i, origin), origin_of(index, k, origin)) == 0)
                fprintf(out, "%s%s", named++ ? ", " : ": ", index->entries[k].name);
    }
    fputc('.', out);
}

static void put_entries(const Index *index, uint32_t from, uint32_t to, RtIndexPart part, FILE *out) {
    for (uint32_t i = from; i < to; i++) fputs(index->entries[i].parts[part].data, out);
}

static bool has_sentences(const Index *index, uint32_t from, uint32_t to) {
    size_t size = 0;
    for (uint32_t i = from; i < to; i++) size += index->entries[i].parts[RT_INDEX_ROWS].size;
    return size > 0;
}

static void put_section(const Index *index, uint32_t from, uint32_t to, FILE *html, FILE *markdown) {
    char title[RT_MAX_WORD];
    title_of(index->entries[from].section, title);
    rt_html_wrap(html, "<h2>", title, "</h2>\n");
    fputs("## ", markdown);
    rt_index_put_markdown(markdown, title, false);
    fputs("\n\n", markdown);
    if (has_sentences(index, from, to)) {
        fputs(
            "<div class=\"wide\" tabindex=\"0\" role=\"region\" aria-label=\"Sentences of the "
            "literature\"><table>"
            "<thead><tr><th>paper</th><th>page</th><th>sentence</th><th>verdict</th><th>experiment</th></tr>"
            "</thead><tbody>\n",
            html);
        put_entries(index, from, to, RT_INDEX_ROWS, html);
        fputs("</tbody></table></div>\n", html);
        fputs("| paper | page | sentence | verdict | experiment |\n| --- | --- | --- | --- | --- |\n",
              markdown);
        put_entries(index, from, to, RT_INDEX_LINES, markdown);
        fputs("\n", markdown);
    }
    put_entries(index, from, to, RT_INDEX_HTML, html);
    put_entries(index, from, to, RT_INDEX_MARKDOWN, markdown);
}

static RtStatus put_pages(const Index *index, FILE *html, FILE *markdown, RtError *error) {
    RtMemoryFile origins;
    RT_TRY(rt_memory_file_open(&origins, error));
    put_origins(index, offsetof(RtIndexEntry, build), "Measured by ", origins.file);
    fputc(' ', origins.file);
    put_origins(index, offsetof(RtIndexEntry, machine), "On ", origins.file);
    put_origins(index, offsetof(RtIndexEntry, again), " Scenes that changed later were counted again by ",
                origins.file);
    RT_TRY(rt_memory_file_close(&origins, "the index", error));
    rt_page_begin(html, "Experiments", true);
    rt_html_wrap(html, "<p class=\"meta\">", origins.data, "</p>\n");
    fputs("# Experiments\n\n", markdown);
    rt_index_put_markdown(markdown, origins.data, false);
    fputs(
        "\n\nA name links to the files of the experiment; `raytally report DIR` makes a report of them.\n\n",
        markdown);
    rt_free(origins.data);
    for (uint32_t from = 0, to; from < index->count; from = to) {
        to = from + 1;
        while (to < index->count && strcmp(index->entries[from].section, index->entries[to].section) == 0)
            to++;
        put_section(index, from, to, html, markdown);
    }
    rt_page_end(html);
    return RT_OK;
}

static RtStatus write_pages(Index *index, RtError *error) {
    RtOutput html, markdown;
    if (index->count == 0) return rt_fail(error, RT_BAD_INPUT, "%s holds no result directory", index->folder);
    qsort(index->entries, index->count, sizeof(RtIndexEntry), compare);
    RT_TRY(rt_output_open_in(&html, index->folder, "index.html", error));
    RtStatus status = rt_output_open_in(&markdown, index->folder, "index.md", error);
    if (status == RT_OK) status = put_pages(index, html.file, markdown.file, error);
    if (status == RT_OK) status = rt_output_commit(&html, error);
    if (status == RT_OK) status = rt_output_commit(&markdown, error);
    rt_output_discard(&html); /* unless it is committed */
    rt_output_discard(&markdown);
    return status;
}

RtStatus rt_index_write(const char *folder, size_t *count, RtError *error) {
    char plain[RT_MAX_PATH];
    /* Without trailing slashes, for paths relative to it. */
    snprintf(plain, sizeof plain, "%s", *folder ? folder : ".");
    for (size_t size = strlen(plain); size > 1 && plain[size - 1] == '/'; size--) plain[size - 1] = '\0';
    Index index = {.folder = plain, .experiment = rt_alloc(1, sizeof(RtExperiment)), .error = error};
    if (!index.experiment) return rt_fail_memory(error, "an experiment", sizeof(RtExperiment));
    rt_directory_each(plain, "", visit, &index);
    if (index.status == RT_OK) index.status = write_pages(&index, error);
    for (uint32_t i = 0; i < index.count; i++) rt_index_entry_clear(&index.entries[i]);
    rt_free(index.entries);
    rt_free(index.experiment);
    *count = index.count;
    return index.status;
}
