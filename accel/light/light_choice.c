/* SPDX-License-Identifier: Apache-2.0 */
/* Which lights pay. Probes are shadow rays from points that the camera sees, or, if it sees few, that random
 * rays hit. A light has lists only if its probes cost less with them than without.
 *
 * A cost is a weighted sum of counts, so the choice is the same on every machine. It is made only over
 * structures whose counts are (RtAccel.counts); over others a light serves scenes of many objects. */
#include "accel/light/light.h"

#include "core/base/memory.h"
#include "core/base/random.h"

/* Nanoseconds, fitted to times of light+wide and wide on 33 scenes: a step of a hierarchy, or a list entry;
 * an object test; the lookup of a ray's cell; cache misses, for each doubling of a structure beyond 4 MB; and
 * the bytes of an object in the structure below. */
static const double STEP = 4.3, TEST = 3, LOOKUP = 10, MISSES = 10, CACHE_BYTES = 4e6, BYTES_BELOW = 70;

/* Lists are made for lights whose rays cost at least so much below, and kept if in them rays cost less by
 * this factor. */
static const double WORTH_TRYING = 30, MARGIN = 1.2;

enum { EDGE = 32, PROBES = EDGE * EDGE, CHUNK = 64, FEW_PROBES = 64, FEW_OBJECTS = 12000 };

/* Where rays are slow fewer are traced: those of some 4 million steps and tests. */
enum { MOST_WORK = 1 << 22 };

typedef struct Probe {
    RtVec3 org;
    RtVec3d side; /* normal, towards the ray that hit */
} Probe;

struct RtLightProbes {
    const RtScene *scene;
    RtRay rays[PROBES];
    Probe probes[PROBES];
    uint32_t count;
    RtTally last;        /* of the last call of trace */
    RtTally *build;      /* of all calls: the build_tally */
    double cost_below[]; /* [lights] of a ray, in the layer below, ns */
};

/* ---- tracing ---- */

/* A step of wide tests eight extents; a structure that tests one by one takes a step for each eight. */
static double steps_of(const RtTally *tally) {
    return fmax((double)tally->steps, (double)tally->extent_tests / 8);
}

/* Traces the first `count` rays, all of one kind, or fewer; writes the answers to `hits`, unless it is NULL:
 * then they are shadow rays. */
static RtStatus trace(RtLightProbes *p, const RtAccel *accel, uint32_t count, RtHit *hits, RtError *error) {
    RtQuery query;
    RtTally *tally = &p->last;
    *tally = (RtTally){0};
    RT_TRY(rt_query_init(&query, accel, error));
    for (uint32_t i = 0; i < count && steps_of(tally) + (double)tally->object_tests < MOST_WORK; i += CHUNK) {
        uint32_t n = count - i < CHUNK ? count - i : CHUNK;
        RtTally tallies[RT_RAY_KIND_COUNT] = {{0}};
        bool blocked[CHUNK];
        if (hits)
            rt_nearest(&query, p->rays + i, n, hits + i, tallies);
        else
            rt_occluded(&query, p->rays + i, n, blocked, tallies);
        rt_tally_add(tally, &tallies[p->rays[i].kind]);
    }
    rt_query_clear(&query);
    rt_tally_add(p->build, tally);
    return RT_OK;
}

/* ---- probes ---- */

/* Every so many rows and columns of the image, in an order in which each part is a sample of the whole. */
static RtStatus look(RtLightProbes *p, RtError *error) {
    const RtCamera *camera = &p->scene->camera;
    RtSampling sampling;
    RtView view;
    RT_TRY(rt_sampling_init(&sampling, camera->width, camera->height, 1, false, error));
    RT_TRY(rt_view_init(&view, camera, sampling, error));
    for (uint32_t i = 0; i < PROBES; i++) {
        uint32_t at = i * 397 % PROBES, column = at % EDGE, row = at / EDGE;
        p->rays[i] = rt_view_ray(&view, column * camera->width / EDGE, row * camera->height / EDGE);
    }
    return RT_OK;
}

static RtVec3 random_point(const RtBox *box, RtRandom *random) {
    RtVec3 point;
    for (int a = 0; a < 3; a++) point.at[a] = rt_random_between(random, box->lo.at[a], box->hi.at[a]);
    return point;
}

static void look_around(RtLightProbes *p) {
    const RtBox *box = &p->scene->geometry.box;
    RtRandom random = rt_random(1, 0);
    for (uint32_t i = 0; i < PROBES; i++) {
        RtVec3 org = random_point(box, &random);
        RtRay ray = {.org = org, .tmax = INFINITY, .kind = RT_RAY_RANDOM};
        ray.dir = rt_sub(random_point(box, &random), org);
        p->rays[i] = rt_ray_is_valid(&ray) ? ray : p->rays[0];
    }
}

static Probe probe_at(const RtGeometry *g, const RtRay *ray, RtHit hit, RtCrossing *crossings) {
    RtVec3d point = rt_ray_point(ray, hit.t), dir = rt_widen(ray->dir);
    RtVec3d normal = rt_object_normals(g, hit.object, ray, hit.t, crossings).geometric;
    RtVec3d side = rt_scaled(normal, rt_dotd(normal, dir) < 0 ? 1 : -1);
    double reach = (double)hit.t * sqrt(rt_dotd(dir, dir)) + sqrt(rt_dotd(point, point));
    return (Probe){rt_narrow(rt_add_scaledd(point, side, 0x1p-18 * reach)), side};
}

static RtStatus find_surfaces(RtLightProbes *p, const RtAccel *below, RtError *error) {
    RtHit hits[PROBES];
    RtCrossing *crossings;
    for (uint32_t i = 0; i < PROBES; i++) hits[i] = RT_MISS;
    RT_TRY(trace(p, below, PROBES, hits, error));
    RT_TRY(rt_crossings_alloc(&p->scene->geometry, &crossings, error));
    p->count = 0;
    for (uint32_t i = 0; i < PROBES; i++) {
        if (hits[i].object == RT_NO_OBJECT) continue;
        p->probes[p->count++] = probe_at(&p->scene->geometry, &p->rays[i], hits[i], crossings);
    }
    rt_free(crossings);
    return RT_OK;
}

/* The cost of a ray's cache misses in a structure of so many bytes. */
static double cost_of_misses(double bytes) {
    double ns = 0;
    while (bytes > CACHE_BYTES) {
        ns += MISSES * fmin(bytes / CACHE_BYTES - 1, 1);
        bytes /= 2;
    }
    return ns;
}

/* The mean cost of shadow rays from the probes that face the light, in a structure of so many bytes; 0 if
 * none does. */
static RtStatus cost(RtLightProbes *p, const RtAccel *accel, uint32_t light, double bytes, double *ns,
                     RtError *error) {
    const RtVec3 position = p->scene->lights[light].position;
    uint32_t count = 0;
    for (uint32_t i = 0; i < p->count; i++) {
        const Probe *probe = &p->probes[i];
        RtRay ray = {
            .org = probe->org, .dir = rt_sub(position, probe->org), .tmax = 1, .kind = RT_RAY_SHADOW};
        ray.source = light;
        if (rt_dotd(probe->side, rt_widen(ray.dir)) > 0 && rt_ray_is_valid(&ray)) p->rays[count++] = ray;
    }
    RT_TRY(trace(p, accel, count, NULL, error));
    const double rays = (double)p->last.rays;
    *ns = rays > 0 ? (STEP * steps_of(&p->last) + TEST * (double)p->last.object_tests) / rays +
                         cost_of_misses(bytes)
                   : 0;
    return RT_OK;
}

/* ---- the choice ---- */

RtStatus rt_light_choose(RtLightBuffer *buffer, RtLightProbes **out, RtError *error) {
    const RtAccel *below = buffer->isa.base.below;
    const RtScene *scene = buffer->isa.base.scene;
    *out = NULL;
    bool all = buffer->cells > 0 || (!below->counts && scene->geometry.object_count >= FEW_OBJECTS);
    for (uint32_t i = 0; i < scene->light_count; i++) buffer->cubes[i].serves = all;
    if (all || !below->counts || scene->geometry.object_count == 0) return RT_OK;
    size_t bytes = sizeof(RtLightProbes) + scene->light_count * sizeof(double);
    RtLightProbes *p = *out = rt_alloc(1, bytes);
    if (!p) return rt_fail_memory(error, "the probes of a light buffer", bytes);
    p->scene = scene;
    p->build = &buffer->isa.base.build_tally;
    RT_TRY(look(p, error));
    RT_TRY(find_surfaces(p, below, error));
    if (p->count < FEW_PROBES) {
        look_around(p);
        RT_TRY(find_surfaces(p, below, error));
    }
    for (uint32_t i = 0; i < scene->light_count; i++) {
        RT_TRY(cost(p, below, i, BYTES_BELOW * scene->geometry.object_count, &p->cost_below[i], error));
        buffer->cubes[i].serves = p->cost_below[i] > WORTH_TRYING;
    }
    return RT_OK;
}

RtStatus rt_light_choose_again(RtLightBuffer *buffer, RtLightProbes *p, RtError *error) {
    double bytes = 0;
    if (!p) return RT_OK;
    for (uint32_t i = 0; i < p->scene->light_count; i++) bytes += (double)rt_light_bytes(&buffer->cubes[i]);
    for (uint32_t i = 0; i < p->scene->light_count; i++) {
        double ns;
        RtLightCube *cube = &buffer->cubes[i];
        if (!cube->serves) continue;
        RT_TRY(cost(p, &buffer->isa.base, i, bytes, &ns, error));
        if (MARGIN * (LOOKUP + ns) > p->cost_below[i]) rt_light_drop(cube);
    }
    return RT_OK;
}
