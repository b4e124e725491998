/* SPDX-License-Identifier: Apache-2.0 */
/* Each result directory is loaded once, in the order of their names, and becomes an entry for both pages; the
 * entries are then put together in the order of sections. */
#include "report/report.h"

#include "core/base/memory.h"
#include "core/base/words.h"
#include "core/text/json.h"
#include "measure/machine.h"
#include "report/page.h"
#include "results/result_directory.h"
#include "results/result_tables.h"

#include <ctype.h>
#include <inttypes.h>
#include <stddef.h>
#include <stdlib.h>
#include <string.h>

enum { MAX_ORIGIN = 256, MAX_ANSWER = 1200 };

/* A result directory, of an experiment or a verification. */
typedef struct Entry {
    char name[RT_MAX_LABEL];   /* of the directory: one experiment may have several, of different systems */
    char section[RT_MAX_WORD]; /* or "" */
    char question[RT_MAX_TEXT], answer[MAX_ANSWER]; /* of the finding the first sentence */
    char not_shown[RT_MAX_TEXT];
    char build[MAX_ORIGIN], machine[MAX_ORIGIN];
    char again[MAX_ORIGIN]; /* the build that counted some scenes again, or "" */
    char plot[RT_MAX_PATH]; /* seen from the index, or "" */
    bool has_report;
    uint32_t number;
} Entry;

typedef struct Index {
    const char *folder;
    RtExperiment *experiment; /* for each in turn */
    bool inner;               /* in one of the folder's folders */
    Entry *entries;           /* owned */
    uint32_t count, capacity;
    json_t *papers, *verdicts; /* of all; {name: claims} */
    RtStatus status;
    RtError *error;
} Index;

/* ---- text ---- */

/* Plain text as Markdown in a cell of a table; `code` stays. */
static void put_markdown(FILE *out, const char *text) {
    bool code = false;
    for (const char *c = text; *c; c++) {
        if (*c == '`') code = !code && strchr(c + 1, '`');
        const bool entity = c[0] == '&' && (c[1] == '#' || isalpha((unsigned char)c[1]));
        if (*c == '|' || (!code && (entity || strchr("\\*[]<", *c)))) fputc('\\', out);
        fputc(*c, out);
    }
}

/* The length of the first sentence: to a full stop before a blank and a capital. */
static int first_sentence(const char *text) {
    size_t i = 0;
    while (text[i] && !(strchr(".!?", text[i]) && text[i + 1] == ' ' && isupper((unsigned char)text[i + 2])))
        i++;
    return (int)(i + (text[i] != '\0'));
}

/* ---- a directory ---- */

static bool is_verification(const char *directory) {
    return rt_file_exists_in(directory, rt_result_files[RT_FILE_VERIFY_CSV]);
}

static bool is_entry(const char *directory) {
    return rt_file_exists_in(directory, RT_MANIFEST) &&
           (is_verification(directory) || rt_file_exists_in(directory, rt_result_files[RT_FILE_EXPERIMENT]));
}

static void note_origin(Entry *entry, const json_t *manifest) {
    const json_t *machine = json_object_get(manifest, "machine");
    snprintf(entry->build, MAX_ORIGIN, "raytally %s (%s%s), %s", rt_json_text(machine, "version", "unknown"),
             rt_json_text(machine, "commit", "unknown"),
             json_is_true(json_object_get(machine, "dirty")) ? ", with changes" : "",
             rt_json_text(machine, "compiler", "unknown"));
    rt_machine_libraries(machine, ", ", entry->build, MAX_ORIGIN);
    snprintf(entry->machine, MAX_ORIGIN, "%s", rt_json_text(machine, "cpu", "an unknown machine"));
    const json_t *again = json_object_get(manifest, "recounted");
    if (again)
        snprintf(entry->again, MAX_ORIGIN, "raytally %s (%s)", rt_json_text(again, "version", "unknown"),
                 rt_json_text(again, "commit", "unknown"));
}

static void take_first(void *context, const char *path) {
    char *first = context;
    if (!*first) snprintf(first, RT_MAX_PATH, "plots/%s", basename(path));
}

/* The main plot: that of frames, or the first. */
static void find_plot(Entry *entry, const char *directory, const char *place) {
    char folder[RT_MAX_PATH], name[RT_MAX_PATH] = "";
    if (rt_file_exists_in(directory, RT_FRAME_PLOT)) strcpy(name, RT_FRAME_PLOT);
    if (rt_path_join(directory, "plots", folder, NULL) == RT_OK)
        rt_directory_each(folder, ".svg", take_first, name);
    if (!*name || rt_path_join(place, name, entry->plot, NULL) != RT_OK) *entry->plot = '\0';
}

static RtStatus read_answer(const RtResults *results, const char *directory, Entry *entry, RtError *error) {
    RtFinding finding;
    RT_TRY(rt_finding_fill(results, directory, &finding, error));
    char *text = rt_finding_text(&finding);
    const char *answer = text && *text ? text : "No finding yet.";
    snprintf(entry->answer, MAX_ANSWER, "%.*s", first_sentence(answer), answer);
    strcpy(entry->not_shown, results->experiment->not_shown);
    rt_free(text);
    rt_finding_clear(&finding);
    return RT_OK;
}

static RtStatus read_experiment(Index *index, Entry *entry, const char *directory, RtError *error) {
    RtExperiment *experiment = index->experiment;
    RtResults results;
    json_t *manifest = NULL;
    RtStatus status = rt_results_load(directory, experiment, &results, error);
    if (status == RT_OK) status = rt_manifest_read(directory, &manifest, error);
    if (status == RT_OK) {
        strcpy(entry->section, experiment->section);
        note_origin(entry, manifest);
        strcpy(entry->question, experiment->question);
        status = read_answer(&results, directory, entry, error);
        json_object_set_new(index->verdicts, entry->name, rt_page_claims(&results));
        json_t *papers = rt_page_papers(&results);
        json_array_extend(index->papers, papers);
        json_decref(papers);
    }
    json_decref(manifest);
    rt_results_clear(&results);
    return status;
}

/* The sum of a column of verify.csv, whose fields may be quoted. */
static uint64_t sum_of(const char *csv, const char *name) {
    uint64_t sum = 0;
    uint32_t column = 0, wanted = UINT32_MAX;
    bool header = true;
    for (const char *at = csv, *end; *at; at = end + (*end != '\0')) {
        bool quoted = false;
        for (end = at; *end && (quoted || !strchr(",\n", *end)); end++) quoted ^= *end == '"';
        if (header && strncmp(at, name, (size_t)(end - at)) == 0 && name[end - at] == '\0') wanted = column;
        if (!header && column == wanted) sum += strtoull(at, NULL, 10);
        column = *end == ',' ? column + 1 : 0;
        header &= *end != '\n';
    }
    return sum;
}

static RtStatus read_verification(Entry *entry, const char *directory, RtError *error) {
    enum { MOST_BYTES = 1 << 24 };
    char path[RT_MAX_PATH], *csv;
    size_t size;
    uint32_t rows = 0;
    json_t *manifest;
    RT_TRY(rt_path_join(directory, rt_result_files[RT_FILE_VERIFY_CSV], path, error));
    RT_TRY(rt_manifest_read(directory, &manifest, error));
    RtStatus status = rt_file_read_text(path, MOST_BYTES, &csv, &size, error);
    if (status == RT_OK) {
        for (const char *c = strchr(csv, '\n'); c && c[1]; c = strchr(c + 1, '\n')) rows++;
        strcpy(entry->section, "verification");
        note_origin(entry, manifest);
        snprintf(entry->answer, MAX_ANSWER,
                 "%" PRIu64 " comparisons in %" PRIu32 " row%s: %" PRIu64
                 " answers to nearest are wrong, %" PRIu64 " to occluded.",
                 sum_of(csv, "rays"), rows, rt_plural(rows), sum_of(csv, "wrong"),
                 sum_of(csv, "occluded_wrong"));
        rt_free(csv);
    }
    json_decref(manifest);
    return status;
}

/* A directory that cannot be read has the reason as its answer. */
static void add_entry(Index *index, const char *directory) {
    const char *place = directory + strlen(index->folder) + 1;
    RtError why = {RT_OK, ""};
    index->status = rt_reserve(&index->entries, &index->capacity, index->count + UINT64_C(1), sizeof(Entry),
                               index->error);
    if (index->status != RT_OK) return;
    Entry *entry = &index->entries[index->count];
    *entry = (Entry){.number = index->count++};
    snprintf(entry->name, sizeof entry->name, "%s", place);
    if ((is_verification(directory) ? read_verification(entry, directory, &why)
                                    : read_experiment(index, entry, directory, &why)) != RT_OK)
        snprintf(entry->answer, MAX_ANSWER, "Cannot be read: %s", why.message);
    find_plot(entry, directory, place);
    entry->has_report = rt_file_exists_in(directory, "report.html");
}

static void visit(void *context, const char *path) {
    Index *index = context;
    if (basename(path)[0] == '.' || index->status != RT_OK) return; /* ., .. and hidden folders */
    if (is_entry(path)) {
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
    const Entry *x = a, *y = b;
    const int order = order_of(x->section) - order_of(y->section), names = strcmp(x->section, y->section);
    return order ? order : names ? names : x->number < y->number ? -1 : 1;
}

/* "Measured by raytally 0.1.0 (abc); raytally 0.2.0 (def): one, two; ...": the most frequent value of
 * `origin` (an offset in Entry), then each other one with its entries. */
static void put_origins(const Index *index, size_t origin, const char *before, FILE *out) {
    json_t *origins = json_object(), *names, *name; /* {value: [names]}, in the order of the first entries */
    const char *value, *most = NULL;
    size_t k;
    for (uint32_t i = 0; i < index->count; i++) {
        value = (const char *)&index->entries[i] + origin;
        if (*value && !json_object_get(origins, value)) json_object_set_new(origins, value, json_array());
        json_array_append_new(json_object_get(origins, value), json_string(index->entries[i].name));
    }
    json_object_foreach(origins, value, names) {
        if (!most || json_array_size(names) > json_array_size(json_object_get(origins, most))) most = value;
    }
    if (most) fprintf(out, "%s%s", before, most);
    json_object_foreach(origins, value, names) {
        if (value == most) continue;
        fprintf(out, "; %s", value);
        json_array_foreach(names, k, name) fprintf(out, "%s%s", k ? ", " : ": ", json_string_value(name));
    }
    if (most) fputc('.', out);
    json_decref(origins);
}

/* ---- pages ---- */

static void put_card(const Entry *entry, FILE *out) {
    char path[RT_MAX_PATH];
    rt_html_wrap(out, "<section class=\"card entry\" id=\"", entry->name, "\">");
    if (*entry->plot) {
        fputs("<a class=\"thumb\" href=\"", out);
        rt_page_path(out, entry->plot);
        rt_html_wrap(out, "\"><img loading=\"lazy\" alt=\"Plot of ", entry->name, "\" src=\"");
        rt_page_path(out, entry->plot);
        fputs("\"></a>\n", out);
    }
    fputs("<div><h3>", out);
    if (entry->has_report && rt_path_join(entry->name, "report.html", path, NULL) == RT_OK)
        rt_page_link(out, path, entry->name);
    else
        rt_html_put(out, entry->name);
    rt_html_wrap(out, "</h3>\n<p>", entry->question, "</p>\n<p><strong>");
    rt_html_wrap(out, "", entry->answer, "</strong></p>\n");
    if (*entry->not_shown)
        rt_html_wrap(out, "<p class=\"meta\">It does not show: ", entry->not_shown, "</p>\n");
    fputs("</div></section>\n", out);
}

static void put_row(const Entry *entry, FILE *out) {
    char question[RT_MAX_TEXT];
    fputs("| [", out);
    put_markdown(out, entry->name);
    fputs("](", out);
    rt_page_path(out, entry->name);
    fputs(") | ", out);
    snprintf(question, sizeof question, "%.*s", first_sentence(entry->question), entry->question);
    put_markdown(out, question);
    fputs(" | ", out);
    put_markdown(out, entry->answer);
    if (*entry->not_shown) {
        fputs(" Not shown: ", out);
        put_markdown(out, entry->not_shown);
    }
    fputs(" |\n", out);
}

static RtStatus put_pages(const Index *index, FILE *html, FILE *markdown, RtError *error) {
    RtMemoryFile origins;
    RT_TRY(rt_memory_file_open(&origins, error));
    put_origins(index, offsetof(Entry, build), "Measured by ", origins.file);
    fputc(' ', origins.file);
    put_origins(index, offsetof(Entry, machine), "On ", origins.file);
    put_origins(index, offsetof(Entry, again), " Scenes that changed later were counted again by ",
                origins.file);
    RT_TRY(rt_memory_file_close(&origins, "the index", error));
    rt_page_begin(html, "Experiments", true);
    rt_html_wrap(html, "<p class=\"meta\">", origins.data, "</p>\n");
    fputs("# Experiments\n\n", markdown);
    put_markdown(markdown, origins.data);
    fputs("\n\nA name links to the files of the experiment, of which experiment.yaml has prediction and "
          "finding; "
          "`raytally report DIR` makes a report of them.\n",
          markdown);
    rt_free(origins.data);
    for (uint32_t i = 0; i < index->count; i++) {
        const Entry *entry = &index->entries[i];
        if (i == 0 || strcmp(entry[-1].section, entry->section) != 0) {
            char title[RT_MAX_WORD];
            snprintf(title, sizeof title, "%s", *entry->section ? entry->section : "others");
            title[0] = (char)toupper((unsigned char)title[0]);
            rt_html_wrap(html, "<h2>", title, "</h2>\n");
            fputs("\n## ", markdown);
            put_markdown(markdown, title);
            fputs("\n\n| experiment | question | answer |\n| --- | --- | --- |\n", markdown);
        }
        put_card(entry, html);
        put_row(entry, markdown);
    }
    return rt_page_end(json_pack("{s:O, s:O}", "papers", index->papers, "verdicts", index->verdicts), html,
                       error);
}

static RtStatus write_pages(Index *index, RtError *error) {
    RtOutput html, markdown;
    if (index->count == 0) return rt_fail(error, RT_BAD_INPUT, "%s holds no result directory", index->folder);
    qsort(index->entries, index->count, sizeof(Entry), compare);
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
    RT_ARENA(arena);
    Index index = {.folder = plain,
                   .experiment = rt_arena_alloc(&arena, 1, sizeof(RtExperiment)),
                   .papers = json_array(),
                   .verdicts = json_object(),
                   .error = error};
    RT_TRY(rt_arena_check(&arena, "an experiment", error));
    rt_directory_each(plain, "", visit, &index);
    if (index.status == RT_OK) index.status = write_pages(&index, error);
    json_decref(index.papers);
    json_decref(index.verdicts);
    rt_free(index.entries);
    *count = index.count;
    return index.status;
}
