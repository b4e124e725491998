#include "cli/extents_table.h"

#include "base/json.h"

#include <stdio.h>

static const char *const kind_names[RT_EXTENT_KIND_COUNT] = {"box", "sphere", "obb", "slabs"};

static const RtRounds rounds = {.rounds = 20, .least = 1e-3, .seed = 1};

/* ---- measuring ---- */

static void choose(RtExtentsTable *table, bool every_slabs) {
    static const RtExtentKind plain[] = {RT_EXTENT_BOX, RT_EXTENT_SPHERE, RT_EXTENT_OBB};
    for (int i = 0; i < 3; i++) table->choices[table->choice_count++] = (RtExtentChoice){plain[i], 0};
    for (uint32_t slabs = 3; slabs <= RT_MAX_SLABS; slabs++) {
        if (!every_slabs && slabs != 3 && slabs != 7 && slabs != 13) continue;
        table->choices[table->choice_count++] = (RtExtentChoice){RT_EXTENT_SLABS, slabs};
    }
}

static RtStatus measure(RtExtentsTable *table, const RtPopulation *population, RtError *error) {
    RtExtentsOfShape *of = &table->shapes[table->shape_count++];
    of->shape = population->shape;
    of->objects = population->count;
    RT_TRY(rt_tightness_count(population, table->choices, table->choice_count, table->lines, table->seed,
                              of->tightness, error));
    return rt_extent_cost_time(population, table->choices, table->choice_count, of->tightness, &rounds,
                               &of->object, of->cost, error);
}

RtStatus rt_extents_table(RtExtentsTable *table, const RtScene *scene, bool every_slabs, uint64_t lines,
                          uint64_t seed, RtError *error) {
    *table = (RtExtentsTable){.lines = lines, .seed = seed};
    choose(table, every_slabs);
    for (int shape = 0; shape <= RT_SHAPE_COUNT; shape++) {
        RtPopulation population;
        RtStatus status = rt_population_init(&population, &scene->geometry, (RtShape)shape, error);
        bool worthwhile = shape == RT_SHAPE_COUNT ? table->shape_count > 1 : population.count > 0;
        if (status == RT_OK && worthwhile) status = measure(table, &population, error);
        rt_population_clear(&population);
        RT_TRY(status);
    }
    return RT_OK;
}

/* ---- showing ---- */

static const char *name_of(RtShape shape) {
    return shape == RT_SHAPE_COUNT ? "all" : rt_shape_name(shape);
}

/* "median [low, high]" in `unit`s, or why there is none. */
static void print_interval(int width, double median, double low, double high, double unit,
                           const char *unknown) {
    char text[64];
    if (isfinite(median)) {
        snprintf(text, sizeof text, "%.4g [%.4g, %.4g]", median / unit, low / unit, high / unit);
    } else {
        snprintf(text, sizeof text, "%s", unknown);
    }
    printf(" %-*s", width, text);
}

static void print_estimate(int width, const RtEstimate *estimate, double unit) {
    print_interval(width, estimate->median, estimate->low, estimate->high, unit, "-");
}

static void print_shape(const RtExtentsTable *table, const RtExtentsOfShape *of) {
    printf("  %s: %u; object test, ns:", name_of(of->shape), of->objects);
    print_interval(0, of->object.median, of->object.low, of->object.high, 1e-9, "unknown, none was met");
    printf("\n");
    for (size_t c = 0; c < table->choice_count; c++) {
        char kind[32];
        const RtTightness *t = &of->tightness[c];
        snprintf(kind, sizeof kind, "%s", kind_names[table->choices[c].kind]);
        if (table->choices[c].slabs) snprintf(kind, sizeof kind, "%u slabs", table->choices[c].slabs);
        printf("    %-9s", kind);
        print_interval(24, t->ratio, t->low, t->high, 1, "never met");
        print_estimate(24, &of->cost[c].test, 1e-9);
        print_estimate(27, &of->cost[c].line, 1e-6);
        print_estimate(0, &of->cost[c].ratio, 1);
        printf("\n");
    }
}

void rt_extents_table_print(const RtExtentsTable *table) {
    printf("extents, by %llu random lines a shape, with 95 %% intervals; a line costs b B + i I against a "
           "list of all:\n    %-9s %-24s %-24s %-27s %s\n",
           (unsigned long long)table->lines, "kind", "tightness", "test, ns", "line, us", "line, of box");
    for (size_t i = 0; i < table->shape_count; i++) print_shape(table, &table->shapes[i]);
}

static json_t *interval_json(double value, double low, double high) {
    return json_pack("{s:o, s:o, s:o}", "value", rt_json_number(value), "low", rt_json_number(low), "high",
                     rt_json_number(high));
}

static json_t *estimate_json(const RtEstimate *estimate, double unit) {
    return interval_json(estimate->median / unit, estimate->low / unit, estimate->high / unit);
}

static json_t *row_json(const RtExtentsTable *table, const RtExtentsOfShape *of, size_t c) {
    const RtTightness *t = &of->tightness[c];
    const RtExtentChoice *choice = &table->choices[c];
    return json_pack(
        "{s:s, s:I, s:s, s:o, s:I, s:I, s:I, s:o, s:f, s:o, s:o, s:o, s:o}", "shape", name_of(of->shape),
        "objects", (json_int_t)of->objects, "kind", kind_names[choice->kind], "slabs",
        choice->slabs ? json_integer(choice->slabs) : json_null(), "lines", (json_int_t)t->lines,
        "extent_hits", (json_int_t)t->extent_hits, "object_hits", (json_int_t)t->object_hits, "tightness",
        interval_json(t->ratio, t->low, t->high), "met_per_line", t->met, "test_ns",
        estimate_json(&of->cost[c].test, 1e-9), "object_test_ns", estimate_json(&of->object, 1e-9), "line_ns",
        estimate_json(&of->cost[c].line, 1e-9), "line_of_box", estimate_json(&of->cost[c].ratio, 1));
}

json_t *rt_extents_table_json(const RtExtentsTable *table) {
    json_t *rows = json_array();
    for (size_t i = 0; i < table->shape_count; i++) {
        for (size_t c = 0; c < table->choice_count; c++) {
            json_array_append_new(rows, row_json(table, &table->shapes[i], c));
        }
    }
    return json_pack("{s:I, s:I, s:o}", "lines", (json_int_t)table->lines, "seed", (json_int_t)table->seed,
                     "rows", rows);
}
