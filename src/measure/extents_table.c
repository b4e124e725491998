/* SPDX-License-Identifier: Apache-2.0 */
#include "measure/extents_table.h"

static const char *const kind_names[RT_EXTENT_KIND_COUNT] = {"box", "sphere", "obb", "slabs"};

static const RtRounds rounds = {.rounds = 20, .most = 20, .least = 1e-3, .seed = 1};

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

/* The current extent; in JSON, shape by shape. */
typedef struct Row {
    const RtExtentsTable *table;
    size_t shape, choice;
} Row;

static const RtExtentsOfShape *of(const Row *r) {
    return &r->table->shapes[r->shape];
}

static const RtTightness *tightness_of(const Row *r) {
    return &of(r)->tightness[r->choice];
}

static const RtExtentCost *cost_of(const Row *r) {
    return &of(r)->cost[r->choice];
}

static const char *shape_name(const RtExtentsOfShape *shape) {
    return shape->shape == RT_SHAPE_COUNT ? "all" : rt_shape_name(shape->shape);
}

static RtField slabs_of(const Row *r) {
    uint32_t slabs = r->table->choices[r->choice].slabs;
    return slabs ? rt_field_integer(slabs) : rt_field_missing();
}

static RtField estimate(const RtEstimate *e, double unit) {
    return rt_field_interval(e->median / unit, e->low / unit, e->high / unit);
}

#define COLUMNS(X)                                                                                           \
    X(shape, "shape", text, "", "shape of the objects, or all", shape_name(of(r)))                           \
    X(objects, "objects", integer, "", "objects of this shape", of(r)->objects)                              \
    X(kind, "kind", text, "", "kind of the extents", kind_names[r->table->choices[r->choice].kind])          \
    X(slabs, "slabs", integer, "", "number of slabs, for that kind", slabs_of(r))                            \
    X(tightness, "tightness", interval, "", "projected area over the object's; null: no object was hit",     \
      rt_field_interval(tightness_of(r)->ratio, tightness_of(r)->low, tightness_of(r)->high))                \
    X(test_ns, "test_ns", interval, "ns", "time of an extent test", estimate(&cost_of(r)->test, 1e-9))       \
    X(line_ns, "line_ns", interval, "ns", "time of a line against a list of all: b B + i I",                 \
      estimate(&cost_of(r)->line, 1e-9))                                                                     \
    X(line_of_box, "line_of_box", interval, "", "line_ns over that of boxes",                                \
      estimate(&cost_of(r)->ratio, 1))                                                                       \
    X(object_test_ns, "object_test_ns", interval, "ns", "time of an object test",                            \
      estimate(&of(r)->object, 1e-9))                                                                        \
    X(lines, "lines", integer, "", "random lines", tightness_of(r)->lines)                                   \
    X(extent_hits, "extent_hits", integer, "", "lines that hit the extent", tightness_of(r)->extent_hits)    \
    X(object_hits, "object_hits", integer, "", "lines that hit the object", tightness_of(r)->object_hits)    \
    X(met_per_line, "met_per_line", real9, "", "extents that a random line through the scene hits",          \
      tightness_of(r)->met)

RT_TABLE_COLUMNS(columns, COLUMNS)

const RtColumnGroup rt_extents_json[1] = {RT_ALL(columns)};
static const RtColumnGroup of_a_shape[] = {RT_FROM_TO(columns, kind, line_of_box)};

static const void *choice_row(void *context, size_t i) {
    Row *r = context;
    r->choice = i;
    return r;
}

static const void *any_row(void *context, size_t i) {
    Row *r = context;
    r->shape = i / r->table->choice_count;
    return choice_row(context, i % r->table->choice_count);
}

void rt_extents_table_print(const RtExtentsTable *table, FILE *out) {
    fprintf(out,
            "extents, by %llu random lines per shape, with 95 %% intervals; a line costs b B + i I against a "
            "list of all\n",
            (unsigned long long)table->lines);
    for (size_t i = 0; i < table->shape_count; i++) {
        Row row = {table, i, 0};
        char buffer[RT_MAX_FIELD];
        RtField object = estimate(&table->shapes[i].object, 1e-9);
        const char *known = rt_field_show(RT_FORM_interval, &object, buffer);
        fprintf(out, "\n%s: %u; object test, ns: %s\n", shape_name(&table->shapes[i]),
                table->shapes[i].objects, *known ? known : "unknown, none was hit");
        rt_table_text(&(RtTable){of_a_shape, 1, table->choice_count, choice_row, .context = &row}, out);
    }
}

json_t *rt_extents_table_json(const RtExtentsTable *table) {
    Row row = {table, 0, 0};
    const RtTable rows = {rt_extents_json, 1, table->shape_count * table->choice_count, any_row,
                          .context = &row};
    return json_pack("{s:I, s:I, s:o}", "lines", (json_int_t)table->lines, "seed", (json_int_t)table->seed,
                     "rows", rt_table_json(&rows));
}
