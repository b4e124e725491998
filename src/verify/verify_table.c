/* SPDX-License-Identifier: Apache-2.0 */
#include "verify/verify_table.h"

#include "core/base/file.h"
#include "core/base/memory.h"
#include "core/base/words.h"
#include "core/text/json.h"

#include <inttypes.h>
#include <string.h>

bool rt_verify_row_fails(const json_t *row) {
    return !json_is_null(json_object_get(row, "first_wrong")) ||
           !json_is_null(json_object_get(row, "problem"));
}

/* ---- sums ---- */

/* The spec without its parameters. */
static void put_accel(char name[RT_MAX_SPEC_CHARS], const char *spec) {
    for (; *spec; spec++) {
        if (*spec == ':') spec += strcspn(spec, "+");
        if (!*spec) break;
        *name++ = *spec;
    }
    *name = '\0';
}

static RtVerifySum *sum_of(RtVerifySum *sums, uint32_t count, const RtVerifySum *key) {
    for (uint32_t i = 0; i < count; i++) {
        if (strcmp(sums[i].name, key->name) == 0 && sums[i].exact == key->exact) return &sums[i];
    }
    return NULL;
}

static uint64_t number(const json_t *object, const char *key) {
    return (uint64_t)json_integer_value(json_object_get(object, key));
}

static void add(RtVerifySum *sum, const json_t *row) {
    const json_t *sides = json_object_get(row, "exactly_right"), *faults = json_object_get(row, "faults");
    sum->rows++;
    sum->failed += rt_verify_row_fails(row);
    sum->refused += !json_is_null(json_object_get(row, "refused"));
    sum->undecided += strncmp(rt_json_text(row, "problem", ""), "undecided", strlen("undecided")) == 0;
    sum->pairs += number(row, "rays");
    if (!json_is_true(json_object_get(row, "exact"))) sum->judged += number(row, "rays");
    if (strcmp(rt_json_text(row, "accel", ""), rt_json_text(row, "against", "")) == 0)
        sum->itself += number(row, "rays");
    if (json_is_null(json_object_get(row, "occluded_wrong"))) sum->recorded += number(row, "rays");
    sum->certain += number(row, "certain");
    sum->must_hit += number(row, "must_hit");
    sum->certain_of += number(row, "certain_of");
    for (int v = 0; v < RT_VERDICT_COUNT; v++) {
        sum->verdicts[v] += number(row, rt_verdict_name((RtVerdict)v));
    }
    sum->occluded_wrong += number(row, "occluded_wrong");
    for (int s = 0; s < RT_SIDE_COUNT; s++) sum->sides[s] += number(sides, rt_side_name((RtSide)s));
    sum->missed += number(row, "missed");
    sum->largest_off = fmax(sum->largest_off, json_number_value(json_object_get(row, "largest_off")));
    for (int f = 0; f < RT_FAULT_COUNT; f++) sum->faults[f] += number(faults, rt_fault_name((RtFault)f));
}

RtStatus rt_verify_sums(const json_t *rows, bool by_scene, RtVerifySum **sums, uint32_t *count,
                        RtError *error) {
    uint32_t capacity = 0;
    *sums = NULL;
    *count = 0;
    for (size_t i = 0; i < json_array_size(rows); i++) {
        const json_t *row = json_array_get(rows, i);
        RtVerifySum key = {.exact = by_scene || json_is_true(json_object_get(row, "exact"))};
        if (by_scene)
            snprintf(key.name, sizeof key.name, "%s", rt_json_text(row, "scene", ""));
        else
            put_accel(key.name, rt_json_text(row, "accel", ""));
        RtVerifySum *sum = sum_of(*sums, *count, &key);
        if (!sum) {
            RT_TRY(rt_append(sums, count, &capacity, &key, sizeof key, error));
            sum = &(*sums)[*count - 1];
        }
        add(sum, row);
    }
    return RT_OK;
}

RtVerifySum rt_verify_total(const json_t *rows) {
    RtVerifySum total = {.exact = true};
    for (size_t i = 0; i < json_array_size(rows); i++) {
        const json_t *row = json_array_get(rows, i);
        total.exact &= json_is_true(json_object_get(row, "exact"));
        add(&total, row);
    }
    return total;
}

/* ---- rows ---- */

static RtField get_member(const void *row, const RtTableColumn *column) {
    const json_t *value = json_object_get(row, column->name);
    if (json_is_integer(value)) return rt_field_integer((uint64_t)json_integer_value(value));
    return rt_field_text(json_string_value(value));
}

static const void *sides_of(const void *row) {
    return json_object_get(row, "exactly_right");
}

static const void *faults_of(const void *row) {
    return json_object_get(row, "faults");
}

static const void *first_wrong_of(const void *row) {
    return json_object_get(row, "first_wrong");
}

#define MEMBER(name, form, meaning)                                                                          \
    { name, name, "", meaning, get_member, RT_FORM_##form, 0 }
static const RtTableColumn members[] = {
    MEMBER("scene", text, "the scene"),
    MEMBER("accel", text, "the accelerator's spec, or the file of hits"),
    MEMBER("against", text, "the reference: brute"),
    MEMBER("rays", integer, "rays traced"),
    MEMBER("equal", integer, "answers to nearest that equal brute's"),
    MEMBER("tie", integer, "answers with another object that is hit at the same point"),
    MEMBER("marginal", integer, "other answers that rounding explains"),
    MEMBER("wrong", integer, "all other answers"),
    MEMBER("occluded_wrong", integer, "rays whose answer to occluded is wrong; empty: a file of hits"),
    MEMBER("problem", text, "a broken structure, or `undecided` and why; empty: none"),
    MEMBER("refused", text,
           "why the accelerator refuses the scene (memory, a limit of its own); the row then has no rays"),
    MEMBER("exact", flag, "whether its answers must equal brute's bit for bit; if not, they get verdicts"),
    MEMBER("missed", integer, "answers to nearest, marginal or wrong: a miss, though the ray exactly hits"),
    MEMBER("largest_off", json, "the largest part of t by which an equal answer or a tie is off"),
};
enum { OF_CSV = 10, AGAINST = 2 };

static const RtTableColumn certain[] = {
    MEMBER("certain", integer,
           "rays that every careful float32 implementation answers alike; empty: the accelerator is exact"),
    MEMBER("must_hit", integer, "rays that must hit something, maybe one of several objects"),
    MEMBER("certain_of", integer, "rays examined for that: all, or a sample"),
};

#define SIDE(CONSTANT, name, meaning)                                                                        \
    {"exactly_right_" #name, #name, "", "if they differ: " meaning, get_member, RT_FORM_integer, 0},
static const RtTableColumn sides[] = {RT_SIDES(SIDE)};

#define FAULT(CONSTANT, name, meaning)                                                                       \
    {"fault_" #name, #name, "", "wrong answers to nearest: " meaning, get_member, RT_FORM_integer, 0},
static const RtTableColumn faults[] = {RT_FAULTS(FAULT)};

static const RtTableColumn first_wrong[] = {
    MEMBER(
        "replay", text,
        "replay file of the first wrong answer, or of a file of hits a scene with the objects near its ray; "
        "empty: it was not kept"),
    MEMBER("objects_left", integer,
           "objects left in the reduced scene; empty: traced again, the answer is right"),
    MEMBER("shrunk", flag,
           "whether the scene was reduced; by default only an accelerator's first failure is"),
    MEMBER("index", integer, "number of the ray"),
    MEMBER("says", text, "the query, the expected and the actual answer, in one line"),
    MEMBER("query", text, "nearest or occluded"),
    MEMBER("kernel", text, "timed or counted; null: a file of hits"),
    MEMBER("stream", integer, "rays per query; null: a file of hits"),
    MEMBER("org", json, "origin of the ray: three numbers as text, which read back to the same bits"),
    MEMBER("dir", json, "its direction, in the same form"),
    MEMBER("tmin", text, "its tmin, as text"),
    MEMBER("tmax", text, "its tmax, as text"),
    MEMBER("expected", json, "the answer of brute: object and t, or true or false"),
    MEMBER("got", json, "the answer of the accelerator"),
};

#define COUNT(array) (sizeof(array) / sizeof *(array))
const RtColumnGroup rt_verify_csv[RT_VERIFY_CSV_GROUPS] = {{NULL, members, OF_CSV, NULL},
                                                           {NULL, sides, COUNT(sides), sides_of},
                                                           {NULL, first_wrong, 1, first_wrong_of},
                                                           {NULL, certain, COUNT(certain), NULL},
                                                           {NULL, faults, COUNT(faults), faults_of}};
const RtColumnGroup rt_verify_json[RT_VERIFY_JSON_GROUPS] = {
    {NULL, members, COUNT(members), NULL},
    {NULL, certain, COUNT(certain), NULL},
    {"exactly_right", sides, COUNT(sides), sides_of},
    {"faults", faults, COUNT(faults), faults_of},
    {"first_wrong", first_wrong, COUNT(first_wrong), first_wrong_of}};
const RtColumnGroup rt_verify_text[RT_VERIFY_TEXT_GROUPS] = {
    {NULL, members, AGAINST, NULL}, {NULL, members + AGAINST + 1, OF_CSV - AGAINST - 2, NULL}};

static const void *member_of(void *rows, size_t i) {
    return json_array_get(rows, i);
}

/* ---- Markdown ---- */

typedef RtVerifySum Row;

/* An accelerator that is not exact is marked by a star. */
#define SUMS(X)                                                                                              \
    X(accel, "accelerator", markup, "", "", rt_field_print("`%s`%s", r->name, r->exact ? "" : " *"))         \
    X(scene, "scene", markup, "", "", rt_field_print("`%s`", r->name))                                       \
    X(rows, "rows", integer, "", "", r->rows)                                                                \
    X(pairs, "comparisons", integer, "", "", r->pairs)                                                       \
    X(equal, "equal", integer, "", "", r->verdicts[RT_EQUAL])                                                \
    X(tie, "tie", integer, "", "", r->verdicts[RT_TIE])                                                      \
    X(marginal, "marginal", integer, "", "", r->verdicts[RT_MARGINAL])                                       \
    X(wrong, "wrong", integer, "", "", r->verdicts[RT_WRONG])                                                \
    X(occluded_wrong, "occluded wrong", integer, "", "", r->occluded_wrong)                                  \
    X(failed, "rows that fail", integer, "", "", r->failed)                                                  \
    X(certain, "certain rays", integer, "", "", r->certain)                                                  \
    X(must_hit, "must hit", integer, "", "", r->must_hit)                                                    \
    X(certain_of, "examined", integer, "", "", r->certain_of)                                                \
    X(inexact, "accelerator", markup, "", "", rt_field_print("`%s`", r->name))
RT_TABLE_COLUMNS(sum_columns, SUMS)

/* The count whose offset in the sum is the key. */
static RtField get_count(const void *row, const RtTableColumn *column) {
    return rt_field_integer(*(const uint64_t *)(const void *)((const char *)row + column->key));
}

#define SUM_OF_SIDE(CONSTANT, name, meaning)                                                                 \
    {#name, #name, "", meaning, get_count, RT_FORM_integer, offsetof(RtVerifySum, sides[RT_SIDE_##CONSTANT])},
static const RtTableColumn sum_sides[] = {RT_SIDES(SUM_OF_SIDE)};

static const RtColumnGroup by_accel[] = {RT_ONE(sum_columns, accel), RT_FROM_TO(sum_columns, rows, failed)};
static const RtColumnGroup by_scene[] = {RT_ONE(sum_columns, scene), RT_FROM_TO(sum_columns, rows, failed)};
#define SUM_OF_FAULT(CONSTANT, name, meaning)                                                                \
    {#name,                                                                                                  \
     #name,                                                                                                  \
     "",                                                                                                     \
     meaning,                                                                                                \
     get_count,                                                                                              \
     RT_FORM_integer,                                                                                        \
     offsetof(RtVerifySum, faults[RT_FAULT_##CONSTANT])},
static const RtTableColumn sum_faults[] = {RT_FAULTS(SUM_OF_FAULT)};

static const RtColumnGroup by_fault[] = {RT_ONE(sum_columns, inexact),
                                         RT_FROM_TO(sum_columns, certain, certain_of), RT_ALL(sum_faults)};
static const RtColumnGroup by_side[] = {RT_ONE(sum_columns, inexact), RT_ALL(sum_sides)};

static const void *sum_at(void *sums, size_t i) {
    return (const RtVerifySum *)sums + i;
}

static const void *inexact_at(void *sums, size_t i) {
    const RtVerifySum *sum = sum_at(sums, i);
    return sum->exact ? NULL : sum;
}

typedef struct Sums {
    RtVerifySum *accels, *scenes;
    uint32_t accel_count, scene_count;
} Sums;

static void write_sums(const RtColumnGroup *groups, int group_count, RtVerifySum *sums, uint32_t count,
                       const void *(*row)(void *, size_t), FILE *out) {
    fputc('\n', out);
    rt_table_markdown(&(RtTable){groups, (size_t)group_count, count, row, .context = sums}, out);
}

static void write_introduction(const RtVerifySum *total, FILE *out) {
    fprintf(out, "# Verification\n\n%" PRIu64 " comparison%s of the answers to `nearest` and `occluded`, ",
            total->pairs, rt_plural(total->pairs));
    fprintf(out, "timed and counted:\n%" PRIu64 " with `brute`, bit for bit (%" PRIu64 " of them",
            total->pairs - total->judged, total->itself);
    fprintf(out, " of `brute` with itself),\nand %" PRIu64 " judged by verdicts.\n", total->judged);
    fprintf(out, "%" PRIu64 " answer%s to `nearest` %s wrong, %" PRIu64 " to `occluded`. ",
            total->verdicts[RT_WRONG], rt_plural(total->verdicts[RT_WRONG]),
            total->verdicts[RT_WRONG] == 1 ? "is" : "are", total->occluded_wrong);
    if (total->recorded > 0)
        fprintf(out, "%" PRIu64 " comparison%s %s with hits of a file, which answer `nearest` alone.\n",
                total->recorded, rt_plural(total->recorded), total->recorded == 1 ? "is" : "are");
    fprintf(out, "%u row%s, %u of which fail, %s in [verify.csv](verify.csv).\n", total->rows,
            rt_plural(total->rows), total->failed, total->rows == 1 ? "is" : "are");
    fputs(
        "What was verified, with which seed and by which build, is in [manifest.json](manifest.json).\n"
        "\n"
        "An answer of an exact accelerator either equals that of `brute` (the same object and the same bits\n"
        "of t) or is wrong. An accelerator with a star has its own arithmetic; an answer of it to `nearest`\n"
        "is equal (the same object, at a t that rounding explains), a tie (another object that is also hit\n"
        "there), marginal (another answer that rounding explains) or wrong. A row is a scene and an\n"
        "accelerator with its parameters; it fails if an answer is wrong or verify.csv names a problem. The\n"
        "first table adds up the rows of an accelerator over all its parameters.\n",
        out);
}

static void write_judged(const Sums *sums, FILE *out) {
    fputs("\n"
          "## Verdicts\n"
          "\n"
          "Rays whose answer is certain, among those examined, and what is wrong with wrong answers to\n"
          "`nearest`:\n",
          out);
    write_sums(by_fault, 3, sums->accels, sums->accel_count, inexact_at, out);
    fputs("\n"
          "Answers to `nearest` with the verdict marginal or wrong, by which side is right in exact "
          "arithmetic:\n"
          "`expected` means only `brute`, `got` only the accelerator.\n",
          out);
    write_sums(by_side, 2, sums->accels, sums->accel_count, inexact_at, out);
}

static void write_markdown(const json_t *rows, const Sums *sums, FILE *out) {
    RtVerifySum total = rt_verify_total(rows);
    write_introduction(&total, out);
    write_sums(by_accel, 2, sums->accels, sums->accel_count, sum_at, out);
    if (!total.exact) write_judged(sums, out);
    fputs("\n## By scene\n", out);
    write_sums(by_scene, 2, sums->scenes, sums->scene_count, sum_at, out);
}

/* ---- files ---- */

static RtStatus write_files(json_t *rows, const Sums *sums, const char *folder, RtError *error) {
    RtOutput output;
    RtTable table = {rt_verify_csv, RT_VERIFY_CSV_GROUPS, json_array_size(rows), member_of, .context = rows};
    RT_TRY(rt_output_open_in(&output, folder, "verify.csv", error));
    rt_table_csv(&table, output.file);
    RT_TRY(rt_output_commit(&output, error));
    RT_TRY(rt_output_open_in(&output, folder, "verify.md", error));
    write_markdown(rows, sums, output.file);
    return rt_output_commit(&output, error);
}

RtStatus rt_verify_write(json_t *rows, const char *folder, RtError *error) {
    Sums sums = {0};
    RtStatus status = rt_verify_sums(rows, false, &sums.accels, &sums.accel_count, error);
    if (status == RT_OK) status = rt_verify_sums(rows, true, &sums.scenes, &sums.scene_count, error);
    if (status == RT_OK) status = write_files(rows, &sums, folder, error);
    rt_free(sums.accels);
    rt_free(sums.scenes);
    return status;
}
