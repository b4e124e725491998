#include "verify/verify_table.h"

#include "base/csv.h"
#include "base/file.h"
#include "base/memory.h"

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
    const json_t *sides = json_object_get(row, "exactly_right");
    sum->rows++;
    sum->failed += rt_verify_row_fails(row);
    sum->pairs += number(row, "rays");
    for (int v = 0; v < RT_VERDICT_COUNT; v++) {
        sum->verdicts[v] += number(row, rt_verdict_name((RtVerdict)v));
    }
    sum->occluded_wrong += number(row, "occluded_wrong");
    for (int s = 0; s < RT_SIDE_COUNT; s++) sum->sides[s] += number(sides, rt_side_name((RtSide)s));
}

RtStatus rt_verify_sums(const json_t *rows, RtVerifyGroup group, RtVerifySum **sums, uint32_t *count,
                        RtError *error) {
    uint32_t capacity = 0;
    *sums = NULL;
    *count = 0;
    for (size_t i = 0; i < json_array_size(rows); i++) {
        const json_t *row = json_array_get(rows, i);
        const char *spec = json_string_value(json_object_get(row, "accel"));
        const char *scene = json_string_value(json_object_get(row, "scene"));
        RtVerifySum key = {.exact = group == RT_BY_SCENE || json_is_true(json_object_get(row, "exact"))};
        if (group == RT_BY_ACCEL) put_accel(key.name, spec);
        if (group == RT_BY_SCENE) snprintf(key.name, sizeof key.name, "%s", scene);
        RtVerifySum *sum = sum_of(*sums, *count, &key);
        if (!sum) {
            RT_TRY(rt_reserve(sums, &capacity, (uint64_t)*count + 1, sizeof(RtVerifySum), error));
            sum = &(*sums)[(*count)++];
            *sum = key;
        }
        add(sum, row);
    }
    return RT_OK;
}

RtVerifySum rt_verify_total(const RtVerifySum *sums, uint32_t count) {
    RtVerifySum total = {.exact = true};
    for (uint32_t i = 0; i < count; i++) {
        total.exact &= sums[i].exact;
        total.rows += sums[i].rows;
        total.failed += sums[i].failed;
        total.pairs += sums[i].pairs;
        for (int v = 0; v < RT_VERDICT_COUNT; v++) total.verdicts[v] += sums[i].verdicts[v];
        total.occluded_wrong += sums[i].occluded_wrong;
        for (int s = 0; s < RT_SIDE_COUNT; s++) total.sides[s] += sums[i].sides[s];
    }
    return total;
}

/* ---- CSV ---- */

static void put_field(FILE *out, const json_t *value) {
    if (json_is_integer(value)) fprintf(out, "%" JSON_INTEGER_FORMAT, json_integer_value(value));
    if (json_is_string(value)) rt_csv_put(out, json_string_value(value));
}

/* A column of its own for each side, called exactly_right_NAME, and last the name of the replay file. */
static void write_csv(const json_t *rows, FILE *out) {
    static const char *const columns[] = {"scene", "accel",    "against", "rays",           "equal",
                                          "tie",   "marginal", "wrong",   "occluded_wrong", "problem"};
    enum { COLUMNS = sizeof columns / sizeof columns[0] };
    for (int c = 0; c < COLUMNS; c++) fprintf(out, "%s,", columns[c]);
    for (int s = 0; s < RT_SIDE_COUNT; s++) fprintf(out, "exactly_right_%s,", rt_side_name((RtSide)s));
    fputs("replay\n", out);
    for (size_t i = 0; i < json_array_size(rows); i++) {
        const json_t *row = json_array_get(rows, i);
        for (int c = 0; c < COLUMNS; c++) {
            put_field(out, json_object_get(row, columns[c]));
            fputc(',', out);
        }
        const json_t *sides = json_object_get(row, "exactly_right");
        for (int s = 0; s < RT_SIDE_COUNT; s++) {
            put_field(out, json_object_get(sides, rt_side_name((RtSide)s)));
            fputc(',', out);
        }
        put_field(out, json_object_get(json_object_get(row, "first_wrong"), "replay"));
        fputc('\n', out);
    }
}

/* ---- Markdown ---- */

/* An accelerator that is not exact is marked by a star. */
static void write_sums(const RtVerifySum *sums, uint32_t count, const char *of, FILE *out) {
    fprintf(out,
            "\n| %s | rows | pairs | equal | tie | marginal | wrong | occluded wrong | rows that fail |\n",
            of);
    fputs("| --- | ---: | ---: | ---: | ---: | ---: | ---: | ---: | ---: |\n", out);
    for (uint32_t i = 0; i < count; i++) {
        fprintf(out, "| `%s`%s | %u | %" PRIu64, sums[i].name, sums[i].exact ? "" : " *", sums[i].rows,
                sums[i].pairs);
        for (int v = 0; v < RT_VERDICT_COUNT; v++) fprintf(out, " | %" PRIu64, sums[i].verdicts[v]);
        fprintf(out, " | %" PRIu64 " | %u |\n", sums[i].occluded_wrong, sums[i].failed);
    }
}

static void write_sides(const RtVerifySum *sums, uint32_t count, FILE *out) {
    if (rt_verify_total(sums, count).exact) return;
    fputs(
        "\n## Who is right\n\n"
        "Answers to `nearest` that got the verdict marginal or wrong, by which of the two is right in exact\n"
        "arithmetic: `expected` is that of `brute` alone, `got` that of the accelerator alone.\n\n"
        "| accelerator |",
        out);
    for (int s = 0; s < RT_SIDE_COUNT; s++) fprintf(out, " %s |", rt_side_name((RtSide)s));
    fputs("\n| --- |", out);
    for (int s = 0; s < RT_SIDE_COUNT; s++) fputs(" ---: |", out);
    fputc('\n', out);
    for (uint32_t i = 0; i < count; i++) {
        if (sums[i].exact) continue;
        fprintf(out, "| `%s` |", sums[i].name);
        for (int s = 0; s < RT_SIDE_COUNT; s++) fprintf(out, " %" PRIu64 " |", sums[i].sides[s]);
        fputc('\n', out);
    }
}

typedef struct Sums {
    RtVerifySum *accels, *scenes;
    uint32_t accel_count, scene_count;
} Sums;

static void write_markdown(const Sums *sums, FILE *out) {
    RtVerifySum total = rt_verify_total(sums->accels, sums->accel_count);
    fprintf(out, "# Verification\n\n%" PRIu64 " pairs of a ray and an accelerator, ", total.pairs);
    fputs("each asked `nearest` and `occluded`, timed and counted:\n", out);
    fprintf(out, "%" PRIu64 " answers to `nearest` are wrong, %" PRIu64 " to `occluded`. ",
            total.verdicts[RT_WRONG], total.occluded_wrong);
    fprintf(out, "%u rows, %u of which fail, are in [verify.csv](verify.csv).\n", total.rows, total.failed);
    fputs(
        "What was verified, with which seed and by which build, is in [manifest.json](manifest.json).\n\n"
        "An answer of an exact accelerator is equal to that of `brute`, the same object and bits of t, or\n"
        "wrong. One with a star has arithmetic of its own; its answers to `nearest` are equal, the same\n"
        "object at nearly the same t; a tie, another object that is met there too; marginal, exactly right\n"
        "or explained by rounding; or wrong. A row is a scene and an accelerator with certain parameters;\n"
        "it fails where an answer is wrong or verify.csv names a problem. The first table sums up an\n"
        "accelerator over all its parameters.\n",
        out);
    write_sums(sums->accels, sums->accel_count, "accelerator", out);
    write_sides(sums->accels, sums->accel_count, out);
    fputs("\n## By scene\n", out);
    write_sums(sums->scenes, sums->scene_count, "scene", out);
}

/* ---- files ---- */

static RtStatus open_in(const char *folder, const char *name, RtOutput *output, RtError *error) {
    char path[RT_MAX_PATH];
    RT_TRY(rt_path_join(folder, name, path, error));
    return rt_output_open(output, path, error);
}

static RtStatus write_files(const json_t *rows, const Sums *sums, const char *folder, RtError *error) {
    RtOutput output;
    RT_TRY(open_in(folder, "verify.csv", &output, error));
    write_csv(rows, output.file);
    RT_TRY(rt_output_commit(&output, error));
    RT_TRY(open_in(folder, "verify.md", &output, error));
    write_markdown(sums, output.file);
    return rt_output_commit(&output, error);
}

RtStatus rt_verify_write(const json_t *rows, const char *folder, RtError *error) {
    Sums sums = {0};
    RtStatus status = rt_verify_sums(rows, RT_BY_ACCEL, &sums.accels, &sums.accel_count, error);
    if (status == RT_OK) status = rt_verify_sums(rows, RT_BY_SCENE, &sums.scenes, &sums.scene_count, error);
    if (status == RT_OK) status = write_files(rows, &sums, folder, error);
    rt_free(sums.accels);
    rt_free(sums.scenes);
    return status;
}
