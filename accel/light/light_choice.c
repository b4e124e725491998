/* SPDX-License-Identifier: Apache-2.0 */
/* Whether lists pay. Probes are shadow rays from points that the camera sees. The buffer serves only if they
 * cost less with lists than in the layer below.
 *
 * A cost is a weighted sum of counts, so the choice is the same on every machine. It is made only over
 * structures whose counts are (RtAccel.counts). */
#include "accel/light/light.h"

#include "core/base/memory.h"

/* Nanoseconds, fitted to times of light+wide and wide on 16 scenes: a step of a hierarchy, and of a list; an
 * object test; the lookup of a ray's cell; cache misses, for each doubling of a structure beyond 4 MB; and
 * the bytes of an object in the structure below. */
static const double STEP = 4.3, ENTRY = 7, TEST = 3, LOOKUP = 10;
static const double MISSES = 10, CACHE_BYTES = 4e6, BYTES_BELOW = 70;

/* Lists are made if rays cost at least so much below, and kept if in them rays cost less by this factor. */
static const double WORTH_TRYING = 30, MARGIN = 1.15;

enum { EDGE = 32, PROBES = EDGE * EDGE, FEW_PROBES = 64 };

/* Where rays are slow fewer are traced: those of some 4 million steps and tests. */
enum { MOST_WORK = 1 << 22 };

struct RtLightProbes {
    RtRay rays[PROBES];
    uint32_t count;
    double cost_below; /* of a ray, ns; 0 if there are few probes */
};

/* A step of wide tests eight extents; a structure that tests one by one takes a step for each eight. */
static double steps_of(const RtTally *tally) {
    return fmax((double)tally->steps, (double)tally->extent_tests / 8);
}

static bool is_too_much(const RtTally *tally) {
    return steps_of(tally) + (double)tally->object_tests > MOST_WORK;
}

/* A ray from a hit to the light; false if the surface is turned away from it. */
static bool make_probe(const RtScene *scene, const RtRay *ray, RtHit hit, uint32_t light,
                       RtCrossing *crossings, RtRay *probe) {
    RtVec3d point = rt_ray_point(ray, hit.t), dir = rt_widen(ray->dir);
    RtVec3d side = rt_object_normals(&scene->geometry, hit.object, ray, hit.t, crossings).geometric;
    if (rt_dotd(side, dir) > 0) side = rt_scaled(side, -1);
    double reach = (double)hit.t * sqrt(rt_dotd(dir, dir)) + sqrt(rt_dotd(point, point));
    *probe = (RtRay){.org = rt_narrow(rt_add_scaledd(point, side, 0x1p-18 * reach)),
                     .tmax = 1,
                     .kind = RT_RAY_SHADOW,
                     .source = light};
    probe->dir = rt_sub(scene->lights[light].position, probe->org);
    return rt_dotd(side, rt_widen(probe->dir)) > 0 && rt_ray_is_valid(probe);
}

/* From every so many rows and columns of the image, in an order in which each part is a sample of the whole,
 * to one light after the other. */
static RtStatus find_probes(RtLightBuffer *buffer, RtLightProbes *p, RtError *error) {
    const RtScene *scene = buffer->isa.base.scene;
    const RtCamera *camera = &scene->camera;
    RtTally tallies[RT_RAY_KIND_COUNT] = {{0}};
    RtSampling sampling;
    RtView view;
    RtQuery query;
    RT_TRY(rt_sampling_init(&sampling, camera->width, camera->height, 1, false, error));
    RT_TRY(rt_view_init(&view, camera, sampling, error));
    RT_TRY(rt_query_init(&query, buffer->isa.base.below, error));
    for (uint32_t i = 0; i < PROBES && !is_too_much(&tallies[RT_RAY_PRIMARY]); i++) {
        uint32_t at = i * 397 % PROBES, column = at % EDGE, row = at / EDGE;
        RtRay ray = rt_view_ray(&view, column * camera->width / EDGE, row * camera->height / EDGE);
        RtHit hit;
        rt_nearest(&query, &ray, 1, &hit, tallies);
        p->count += hit.object != RT_NO_OBJECT && make_probe(scene, &ray, hit, i % scene->light_count,
                                                             rt_query_crossings(&query), &p->rays[p->count]);
    }
    rt_query_clear(&query);
    rt_tally_add(&buffer->isa.base.build_tally, &tallies[RT_RAY_PRIMARY]);
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

/* The mean cost of probes in a structure of so many bytes, whose steps cost `step`. */
static RtStatus cost(RtLightBuffer *buffer, const RtLightProbes *p, const RtAccel *accel, double step,
                     double bytes, double *ns, RtError *error) {
    enum { CHUNK = 64 };
    RtTally tallies[RT_RAY_KIND_COUNT] = {{0}};
    const RtTally *tally = &tallies[RT_RAY_SHADOW];
    RtQuery query;
    uint32_t count = 0;
    RT_TRY(rt_query_init(&query, accel, error));
    for (uint32_t n; count < p->count && !is_too_much(tally); count += n) {
        bool blocked[CHUNK];
        n = p->count - count < CHUNK ? p->count - count : CHUNK;
        rt_occluded(&query, p->rays + count, n, blocked, tallies);
    }
    rt_query_clear(&query);
    rt_tally_add(&buffer->isa.base.build_tally, tally);
    *ns = (step * steps_of(tally) + TEST * (double)tally->object_tests) / count + cost_of_misses(bytes);
    return RT_OK;
}

RtStatus rt_light_make_probes(RtLightBuffer *buffer, RtLightProbes **out, RtError *error) {
    const RtAccel *accel = &buffer->isa.base;
    RtLightProbes *p = *out = rt_alloc(1, sizeof *p);
    if (!p) return rt_fail_memory(error, "the probes of a light buffer", sizeof *p);
    if (accel->scene->light_count > 0) RT_TRY(find_probes(buffer, p, error));
    if (p->count < FEW_PROBES) return RT_OK;
    return cost(buffer, p, accel->below, STEP, BYTES_BELOW * accel->scene->geometry.object_count,
                &p->cost_below, error);
}

bool rt_light_may_pay(const RtLightProbes *p) {
    return p->cost_below > WORTH_TRYING;
}

RtStatus rt_light_pays(RtLightBuffer *buffer, RtLightProbes *p, bool *pays, RtError *error) {
    double ns;
    RT_TRY(cost(buffer, p, &buffer->isa.base, ENTRY, (double)rt_light_bytes(buffer), &ns, error));
    *pays = MARGIN * (LOOKUP + ns) <= p->cost_below;
    return RT_OK;
}
