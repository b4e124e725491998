/* SPDX-License-Identifier: Apache-2.0 */
#include "measure/extents_table.h"

#include "core/base/memory.h"
#include "core/base/random.h"
#include "rays/rayset.h"

/* The objects of one shape, or all of them. */
typedef struct Population {
    const RtGeometry *geometry;
    uint32_t count;
    uint32_t *ids; /* [count] ascending; the arena's */
} Population;

static RtStatus find_population(Population *population, const RtGeometry *geometry, RtShape shape,
                                RtArena *arena, RtError *error) {
    *population = (Population){.geometry = geometry};
    population->ids = rt_arena_alloc(arena, geometry->object_count, sizeof(uint32_t));
    RT_TRY(rt_arena_check(arena, "the objects of a shape", error));
    for (uint32_t id = 0; id < geometry->object_count; id++) {
        if (shape == RT_SHAPE_COUNT || rt_ref_shape(geometry->objects[id]) == shape)
            population->ids[population->count++] = id;
    }
    return RT_OK;
}

/* ---- the extents of one object ---- */

/* A set of one extent, of any kind, and its room. */
typedef struct Fitted {
    RtExtentSet set;
    RtBall ball;
    RtOrientedBox oriented;
    RtSlab slabs[RT_MAX_SLABS];
} Fitted;

static void fit(const RtGeometry *geometry, uint32_t id, RtExtentChoice choice, Fitted *fitted) {
    const RtGroup group = {geometry, &id, 1, geometry->boxes[id]};
    fitted->set =
        (RtExtentSet){choice.kind, 1, choice.slabs, &fitted->ball, &fitted->oriented, fitted->slabs};
    rt_extent_fit(&fitted->set, 0, &group);
}

/* A sphere around object `id` and its extents of every kind, slightly enlarged. */
static RtBall sphere_about_extents(const RtGeometry *geometry, uint32_t id) {
    Fitted fitted;
    fit(geometry, id, (RtExtentChoice){RT_EXTENT_SPHERE, 0}, &fitted);
    fit(geometry, id, (RtExtentChoice){RT_EXTENT_OBB, 0}, &fitted);
    const RtBall *ball = &fitted.ball;
    const RtOrientedBox *box = &fitted.oriented;
    RtVec3d center = rt_widen(rt_box_center(geometry->boxes[id]));
    double of_box = rt_lengthd(rt_subd(rt_widen(geometry->boxes[id].hi), center));
    double of_ball = rt_lengthd(rt_subd(ball->center, center)) + ball->radius;
    double of_oriented = rt_lengthd(rt_subd(box->center, center)) +
                         rt_lengthd(rt_vec3d(box->half[0], box->half[1], box->half[2]));
    return (RtBall){center, fmax(of_box, fmax(of_ball, of_oriented)) * (1 + 0x1p-6)};
}

/* ---- tightness ---- */

typedef struct Survey {
    const Population *population;
    const RtExtentsTable *table;
    RtTightness *out;        /* [table->choice_count] */
    RtBall *spheres;         /* [population->count] */
    Fitted *fitted;          /* [table->choice_count] */
    RtHitMemory *hit_memory; /* of hit functions */
} Survey;

/* A random line through the sphere, as a ray that starts far behind it: extents may extend beyond the box of
 * their object, and must not lie behind the ray. */
static RtRay random_line(const RtBall *sphere, RtRandom *random) {
    RtRay ray = rt_sphere_chord(sphere, random);
    RtVec3d back = rt_scaled(rt_normalized(rt_widen(ray.dir)), -4 * sphere->radius);
    ray.org = rt_narrow(rt_addd(rt_widen(ray.org), back));
    return ray;
}

static void count_lines(const Survey *survey, uint32_t index, uint64_t lines) {
    const RtGeometry *geometry = survey->population->geometry;
    uint32_t id = survey->population->ids[index];
    RtRandom random = rt_random(survey->table->seed, id);
    for (size_t c = 0; c < survey->table->choice_count; c++)
        fit(geometry, id, survey->table->choices[c], &survey->fitted[c]);
    for (uint64_t k = 0; k < lines; k++) {
        RtRay through = random_line(&survey->spheres[index], &random);
        RtPreparedRay ray;
        rt_hit_ray(&ray, geometry, &through, survey->hit_memory);
        RtHit hit = RT_MISS;
        bool met = rt_test_object(geometry, id, &ray, true, &hit, NULL);
        for (size_t c = 0; c < survey->table->choice_count; c++) {
            const RtExtentSet *set = &survey->fitted[c].set;
            RtLine line = rt_line(set, set->kind, geometry, &ray);
            float enter;
            survey->out[c].lines++;
            survey->out[c].object_hits += met;
            survey->out[c].extent_hits +=
                rt_extent_hit(set, set->kind, 0, &geometry->boxes[id], &ray, &line, ray.tmax, &enter);
        }
    }
}

/* Distributes the lines by area, each part rounded up or down without bias. Returns the sum of the squared
 * radii. */
static double deal_lines(const Survey *survey) {
    uint32_t count = survey->population->count;
    double whole = 0, sum = 0;
    for (uint32_t i = 0; i < count; i++) {
        survey->spheres[i] = sphere_about_extents(survey->population->geometry, survey->population->ids[i]);
        whole += survey->spheres[i].radius * survey->spheres[i].radius;
    }
    RtRandom random = rt_random(survey->table->seed, UINT64_MAX);
    double start = (double)rt_random_unit(&random);
    for (uint64_t i = 0, dealt = 0; whole > 0 && i < count; i++) {
        sum += survey->spheres[i].radius * survey->spheres[i].radius;
        uint64_t until = (uint64_t)((double)survey->table->lines * (sum / whole) + start);
        if (until > dealt) count_lines(survey, (uint32_t)i, until - dealt);
        dealt = until;
    }
    return whole;
}

/* The inverse of Wilson's interval of the part of extent hits that hit the object. */
static void estimate_tightness(RtTightness *out) {
    double n = (double)out->extent_hits, k = (double)out->object_hits;
    const double z = 1.959963984540054;
    double middle = (k + z * z / 2) / (n + z * z);
    double half = z / (n + z * z) * sqrt(k * (n - k) / n + z * z / 4);
    out->ratio = k > 0 ? n / k : (double)NAN;
    out->low = n > 0 ? fmax(1, 1 / (middle + half)) : (double)NAN;
    out->high = k > 0 ? 1 / (middle - half) : n > 0 ? (double)INFINITY : (double)NAN;
}

static RtStatus count_population(const Population *population, const RtExtentsTable *table, RtTightness *out,
                                 RtArena *arena, RtError *error) {
    const size_t count = table->choice_count;
    Survey survey = {.population = population,
                     .table = table,
                     .out = out,
                     .spheres = rt_arena_alloc(arena, population->count, sizeof(RtBall)),
                     .fitted = rt_arena_alloc(arena, count, sizeof(Fitted))};
    RT_TRY(rt_arena_check(arena, "the tightness of extents", error));
    RT_TRY(rt_hit_memory_alloc(population->geometry, &survey.hit_memory, error));
    const double whole = deal_lines(&survey);
    const RtBall scene = rt_bounding_sphere(&population->geometry->box);
    const double lines_of_scene = (double)table->lines * (scene.radius * scene.radius / whole);
    for (size_t c = 0; c < count; c++) {
        estimate_tightness(&out[c]);
        out[c].met = whole > 0 ? (double)out[c].extent_hits / lines_of_scene : 0;
    }
    rt_free(survey.hit_memory);
    return RT_OK;
}

/* ---- costs ---- */

/* Objects whose extents are in the list, evenly spread over the population; lines that traverse it; rays for
 * object tests; attempts to draw those. */
enum { SAMPLE = 256, LINES = 64, CHORDS = 512, TRIES = 8192, ROUNDS = 20 };

/* What all runners share. */
typedef struct Bench {
    const RtGeometry *geometry;
    uint32_t count; /* objects sampled */
    uint32_t ids[SAMPLE];
    RtBox boxes[SAMPLE];
    uint32_t met[SAMPLE]; /* extents that the last line hit, which a search would visit next */
    RtRay lines[LINES];   /* through the scene */
    uint32_t chord_count;
    RtRay chords[CHORDS]; /* that meet the box of their object */
    RtPreparedRay prepared[CHORDS];
    uint32_t objects[CHORDS]; /* of each chord */
    RtHitMemory *hit_memory;  /* of hit functions */
} Bench;

/* The extents of one choice. */
typedef struct Extents {
    Bench *bench;
    RtExtentSet set;
} Extents;

RT_KERNEL void test_list(RtExtentKind kind, const Extents *extents) {
    Bench *bench = extents->bench;
    for (uint32_t k = 0; k < LINES; k++) {
        RtPreparedRay ray = rt_ray_prepare(&bench->lines[k], &bench->geometry->box);
        RtLine line = rt_line(&extents->set, kind, bench->geometry, &ray);
        uint32_t met = 0;
        for (uint32_t i = 0; i < bench->count; i++) {
            float enter;
            if (rt_extent_hit(&extents->set, kind, i, &bench->boxes[i], &ray, &line, ray.tmax, &enter)) {
                bench->met[met++] = i;
            }
        }
    }
}

static RtStatus run_extents(void *context, RtError *error) {
    (void)error;
    const Extents *extents = context;
    RT_BY_EXTENT_KIND(extents->set.kind, test_list, extents);
    return RT_OK;
}

static RtStatus run_objects(void *context, RtError *error) {
    (void)error;
    Bench *bench = context;
    uint32_t met = 0;
    for (uint32_t k = 0; k < bench->chord_count; k++) {
        RtHit hit = RT_MISS;
        met += rt_test_object(bench->geometry, bench->objects[k], &bench->prepared[k], true, &hit, NULL);
    }
    bench->met[0] = met;
    return RT_OK;
}

static void fill_bench(Bench *bench, const Population *population, uint64_t seed) {
    const RtGeometry *geometry = population->geometry;
    RtRandom random = rt_random(seed, 1);
    bench->geometry = geometry;
    bench->count = population->count < SAMPLE ? population->count : SAMPLE;
    for (uint32_t i = 0; i < bench->count; i++) {
        uint32_t id = population->ids[(uint64_t)i * population->count / bench->count];
        bench->ids[i] = id;
        bench->boxes[i] = geometry->boxes[id];
    }
    for (uint32_t k = 0; k < TRIES && bench->count > 0 && bench->chord_count < CHORDS; k++) {
        uint32_t id = bench->ids[k % bench->count];
        RtBall sphere = sphere_about_extents(geometry, id);
        RtRay *ray = &bench->chords[bench->chord_count];
        *ray = rt_sphere_chord(&sphere, &random);
        RtPreparedRay prepared = rt_ray_prepare(ray, &geometry->box);
        float enter;
        if (!rt_box_hit(&geometry->boxes[id], &prepared, prepared.tmax, &enter)) continue;
        rt_hit_ray(&bench->prepared[bench->chord_count], geometry, ray, bench->hit_memory);
        bench->objects[bench->chord_count++] = id;
    }
    for (uint32_t k = 0; k < LINES; k++) bench->lines[k] = rt_random_chord(&geometry->box, &random);
}

/* T of one choice in every round, to `out`. */
static void weigh(const double test[ROUNDS], const double object[ROUNDS], double tests, double met,
                  double out[ROUNDS]) {
    for (uint32_t r = 0; r < ROUNDS; r++) out[r] = tests * test[r] + met * object[r];
}

/* `times` of each choice, then of the object test. */
static void conclude(double (*times)[ROUNDS], size_t count, RtExtentsOfShape *of) {
    double first[ROUNDS], own[ROUNDS];
    weigh(times[0], times[count], of->objects, of->tightness[0].met, first);
    for (size_t c = 0; c < count; c++) {
        weigh(times[c], times[count], of->objects, of->tightness[c].met, own);
        of->cost[c] = (RtExtentCost){rt_estimate(times[c], ROUNDS), rt_estimate(own, ROUNDS),
                                     rt_estimate_ratio(own, first, ROUNDS)};
    }
}

static RtStatus fit_all(Extents *extents, RtExtentChoice choice, RtArena *arena, RtError *error) {
    const Bench *bench = extents->bench;
    RT_TRY(rt_extent_set_init(&extents->set, arena, choice.kind, choice.slabs, bench->count, error));
    for (uint32_t i = 0; i < bench->count; i++) {
        const RtGroup group = {bench->geometry, &bench->ids[i], 1, bench->boxes[i]};
        rt_extent_fit(&extents->set, i, &group);
    }
    return RT_OK;
}

/* Times what was counted. The population is not empty. */
static RtStatus time_population(const Population *population, const RtExtentsTable *table,
                                RtExtentsOfShape *of, RtArena *arena, RtError *error) {
    const size_t count = table->choice_count;
    static const RtRounds rounds = {.rounds = ROUNDS, .most = ROUNDS, .least = 1e-3, .seed = 1};
    Bench *bench = rt_arena_alloc(arena, 1, sizeof(Bench));
    Extents *extents = rt_arena_alloc(arena, count, sizeof(Extents));
    RtRunner *runners = rt_arena_alloc(arena, count + 1, sizeof(RtRunner));
    double(*times)[ROUNDS] = rt_arena_alloc(arena, count + 1, sizeof *times);
    RT_TRY(rt_arena_check(arena, "timing extents", error));
    RT_TRY(rt_hit_memory_alloc(population->geometry, &bench->hit_memory, error));
    fill_bench(bench, population, rounds.seed);
    RtStatus status = RT_OK;
    for (size_t c = 0; status == RT_OK && c < count; c++) {
        extents[c].bench = bench;
        status = fit_all(&extents[c], table->choices[c], arena, error);
        runners[c] = (RtRunner){.run = run_extents,
                                .context = &extents[c],
                                .work = (double)bench->count * LINES,
                                .seconds = times[c]};
    }
    const bool any = bench->chord_count > 0;
    uint32_t done;
    runners[count] =
        (RtRunner){.run = run_objects, .context = bench, .work = bench->chord_count, .seconds = times[count]};
    if (status == RT_OK) status = rt_rounds_run(runners, count + any, &rounds, &done, error);
    if (status == RT_OK) conclude(times, count, of);
    of->object = any ? rt_estimate(times[count], ROUNDS) : rt_estimate_exactly((double)NAN);
    rt_free(bench->hit_memory);
    return status;
}

/* ---- the table ---- */

static const char *const kind_names[RT_EXTENT_KIND_COUNT] = {"box", "sphere", "obb", "slabs"};

static void choose(RtExtentsTable *table, bool every_slabs) {
    static const RtExtentChoice plain[] = {{RT_EXTENT_BOX, 0}, {RT_EXTENT_SPHERE, 0}, {RT_EXTENT_OBB, 0}};
    for (int i = 0; i < 3; i++) table->choices[table->choice_count++] = plain[i];
    for (uint32_t slabs = 3; slabs <= RT_MAX_SLABS; slabs++) {
        if (!every_slabs && slabs != 3 && slabs != 7 && slabs != 13) continue;
        table->choices[table->choice_count++] = (RtExtentChoice){RT_EXTENT_SLABS, slabs};
    }
}

RtStatus rt_extents_table(RtExtentsTable *table, const RtScene *scene, bool every_slabs, uint64_t lines,
                          uint64_t seed, RtError *error) {
    *table = (RtExtentsTable){.lines = lines, .seed = seed};
    choose(table, every_slabs);
    for (int shape = 0; shape <= RT_SHAPE_COUNT; shape++) {
        RT_ARENA(arena);
        Population population;
        RT_TRY(find_population(&population, &scene->geometry, (RtShape)shape, &arena, error));
        if (shape == RT_SHAPE_COUNT ? table->shape_count <= 1 : population.count == 0) continue;
        RtExtentsOfShape *of = &table->shapes[table->shape_count++];
        of->shape = (RtShape)shape;
        of->objects = population.count;
        RT_TRY(count_population(&population, table, of->tightness, &arena, error));
        RT_TRY(time_population(&population, table, of, &arena, error));
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
