/* SPDX-License-Identifier: Apache-2.0 */
#include "measure/tightness.h"

#include "core/base/memory.h"
#include "core/base/random.h"
#include "rays/rayset.h"

/* ---- populations ---- */

RtStatus rt_population_init(RtPopulation *population, const RtGeometry *geometry, RtShape shape,
                            RtError *error) {
    *population = (RtPopulation){.geometry = geometry, .shape = shape};
    population->ids = rt_alloc(geometry->object_count, sizeof(uint32_t));
    if (!population->ids) {
        return rt_fail_memory(error, "a population", geometry->object_count * sizeof(uint32_t));
    }
    for (uint32_t id = 0; id < geometry->object_count; id++) {
        if (shape == RT_SHAPE_COUNT || rt_ref_shape(geometry->objects[id]) == shape) {
            population->ids[population->count++] = id;
        }
    }
    return RT_OK;
}

void rt_population_clear(RtPopulation *population) {
    rt_free(population->ids);
    *population = (RtPopulation){0};
}

/* ---- the extents of one object ---- */

/* Fitted for one extent of any kind. */
typedef struct Fitted {
    RtBall ball;
    RtOrientedBox oriented;
    RtSlab slabs[RT_MAX_SLABS];
} Fitted;

static RtExtentSet fit(const RtGeometry *geometry, uint32_t id, RtExtentChoice choice, Fitted *fitted) {
    RtExtentSet set = {choice.kind, 1, choice.slabs, &fitted->ball, &fitted->oriented, fitted->slabs};
    const RtGroup group = {geometry, &id, 1, geometry->boxes[id]};
    rt_extent_fit(&set, 0, &group);
    return set;
}

RtBall rt_sphere_about_extents(const RtGeometry *geometry, uint32_t id) {
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

/* ---- counting ---- */

typedef struct Survey {
    const RtPopulation *population;
    const RtExtentChoice *choices;
    size_t count;
    uint64_t seed;
    RtBall *spheres;       /* [population->count] */
    Fitted *fitted;        /* [count] */
    RtExtentSet *sets;     /* [count] */
    RtTightness *out;      /* [count] */
    RtCrossing *crossings; /* of hit functions */
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
    RtRandom random = rt_random(survey->seed, id);
    for (size_t c = 0; c < survey->count; c++) {
        survey->sets[c] = fit(geometry, id, survey->choices[c], &survey->fitted[c]);
    }
    for (uint64_t k = 0; k < lines; k++) {
        RtRay through = random_line(&survey->spheres[index], &random);
        RtPreparedRay ray;
        rt_hit_ray(&ray, geometry, &through, survey->crossings);
        RtHit hit = RT_MISS;
        bool met = rt_test_object(geometry, id, &ray, true, &hit, NULL);
        for (size_t c = 0; c < survey->count; c++) {
            const RtExtentSet *set = &survey->sets[c];
            RtLine line = rt_line(set, set->kind, &geometry->box, &ray);
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
static double deal_lines(const Survey *survey, uint64_t lines) {
    uint32_t count = survey->population->count;
    double whole = 0, sum = 0;
    for (uint32_t i = 0; i < count; i++) {
        survey->spheres[i] =
            rt_sphere_about_extents(survey->population->geometry, survey->population->ids[i]);
        whole += survey->spheres[i].radius * survey->spheres[i].radius;
    }
    RtRandom random = rt_random(survey->seed, UINT64_MAX);
    double start = (double)rt_random_unit(&random);
    for (uint64_t i = 0, dealt = 0; whole > 0 && i < count; i++) {
        sum += survey->spheres[i].radius * survey->spheres[i].radius;
        uint64_t until = (uint64_t)((double)lines * (sum / whole) + start);
        if (until > dealt) count_lines(survey, (uint32_t)i, until - dealt);
        dealt = until;
    }
    return whole;
}

/* The inverse of Wilson's interval of the part of extent hits that hit the object. */
static void estimate(RtTightness *out) {
    double n = (double)out->extent_hits, k = (double)out->object_hits;
    const double z = 1.959963984540054;
    double middle = (k + z * z / 2) / (n + z * z);
    double half = z / (n + z * z) * sqrt(k * (n - k) / n + z * z / 4);
    out->ratio = k > 0 ? n / k : (double)NAN;
    out->low = n > 0 ? fmax(1, 1 / (middle + half)) : (double)NAN;
    out->high = k > 0 ? 1 / (middle - half) : n > 0 ? (double)INFINITY : (double)NAN;
}

RtStatus rt_tightness_count(const RtPopulation *population, const RtExtentChoice *choices, size_t count,
                            uint64_t lines, uint64_t seed, RtTightness *out, RtError *error) {
    Survey survey = {population, choices, count, seed, NULL, NULL, NULL, out, NULL};
    for (size_t c = 0; c < count; c++) out[c] = (RtTightness){0};
    survey.spheres = rt_alloc(population->count, sizeof(RtBall));
    survey.fitted = rt_alloc(count, sizeof(Fitted));
    survey.sets = rt_alloc(count, sizeof(RtExtentSet));
    RtStatus status = rt_crossings_alloc(population->geometry, &survey.crossings, error);
    if (status == RT_OK && survey.spheres && survey.fitted && survey.sets) {
        double whole = deal_lines(&survey, lines);
        RtBall scene = rt_bounding_sphere(&population->geometry->box);
        double lines_of_scene = (double)lines * (scene.radius * scene.radius / whole);
        for (size_t c = 0; c < count; c++) {
            estimate(&out[c]);
            out[c].met = whole > 0 ? (double)out[c].extent_hits / lines_of_scene : 0;
        }
    } else if (status == RT_OK) {
        status = rt_fail_memory(error, "the tightness of extents", population->count * sizeof(RtBall));
    }
    rt_free(survey.spheres);
    rt_free(survey.fitted);
    rt_free(survey.sets);
    rt_free(survey.crossings);
    return status;
}
