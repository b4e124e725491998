/* SPDX-License-Identifier: Apache-2.0 */
/* shadow-cache: an overlay, as a plugin. Haines & Greenberg 1986: the same object shadows most neighbouring
 * points, so the last occluder of each light is tested first. If it occludes this ray too, one object test
 * answers it; otherwise the accelerator below does, and its occluder is kept.
 *
 * Only the first `lights` lights have an entry. The entry depends on earlier rays, so `begin` forgets it;
 * answers do not, because any occluder is a right answer. */
#include <raytally/accel.h>

#include <stdlib.h>

enum { PARAM_LIGHTS, PARAMS };

static const raytally_param params[PARAMS] = {
    {"lights", RAYTALLY_INT, "16", 1, 4096, NULL, "1|2|4096", "lights that have an entry, the first ones",
     "more than most scenes have"},
};

typedef struct Cache {
    uint32_t lights;
} Cache;

static int build(const raytally_build_input *what, void **self) {
    Cache *cache = (Cache *)malloc(sizeof *cache);
    if (!cache) return RAYTALLY_BUILD_NO_MEMORY;
    cache->lights = (uint32_t)what->values[PARAM_LIGHTS].integer;
    *self = cache;
    return RAYTALLY_BUILD_OK;
}

/* The memory of a query: the last occluder of each light, or RAYTALLY_NO_OBJECT. */
static size_t query_bytes(const void *self) {
    return ((const Cache *)self)->lights * sizeof(uint32_t);
}

static void begin(const void *self, void *memory) {
    for (uint32_t i = 0; i < ((const Cache *)self)->lights; i++) ((uint32_t *)memory)[i] = RAYTALLY_NO_OBJECT;
}

static uint32_t find_occluder(uint32_t *last, raytally_query *query, const raytally_ray *ray,
                              raytally_counters *counters) {
    uint32_t occluder;
    if (*last != RAYTALLY_NO_OBJECT) {
        raytally_prepared prepared;
        raytally_hit hit = {__builtin_inff(), RAYTALLY_NO_OBJECT};
        RAYTALLY_COUNT(counters, RAYTALLY_STEPS, 1);
        raytally_prepare(query, ray, &prepared);
        if (raytally_object_hits(&prepared, last, 1, 1, &hit, counters)) return *last;
    }
    RAYTALLY_COUNT(counters, RAYTALLY_PASSED_ON, 1);
    raytally_occluded_below(query, ray, 1, &occluder);
    if (occluder != RAYTALLY_NO_OBJECT && occluder != RAYTALLY_UNNAMED_OBJECT) *last = occluder;
    return occluder;
}

/* Other rays are passed on in streams, as long as possible. */
static void occluded(const void *self, void *memory, raytally_query *query, const raytally_ray *rays,
                     size_t count, uint32_t *occluders, raytally_counters *counters) {
    const uint32_t lights = ((const Cache *)self)->lights;
    size_t first = 0; /* of the rays that are not answered yet */
    for (size_t i = 0; i < count; i++) {
        if (rays[i].kind != RAYTALLY_SHADOW || rays[i].source >= lights) continue;
        raytally_occluded_below(query, rays + first, i - first, occluders + first);
        occluders[i] = find_occluder((uint32_t *)memory + rays[i].source, query, &rays[i],
                                     counters ? &counters[RAYTALLY_SHADOW] : NULL);
        first = i + 1;
    }
    raytally_occluded_below(query, rays + first, count - first, occluders + first);
}

static void nearest(const void *self, void *memory, raytally_query *query, const raytally_ray *rays,
                    size_t count, raytally_hit *hits, raytally_counters *counters) {
    (void)self, (void)memory, (void)counters;
    raytally_nearest_below(query, rays, count, hits);
}

static const raytally_accel_ops ops = {
    .abi = RAYTALLY_ACCEL_ABI,
    .size = sizeof ops,
    .name = "shadow-cache",
    .summary = "overlay: the last occluder of each light is tested first",
    .paper = "Haines & Greenberg 1986, The Light Buffer: A Shadow-Testing Accelerator, CG&A 6(9)",
    .params = params,
    .param_count = PARAMS,
    .build = build,
    .destroy = free,
    .nearest = nearest,
    .occluded = occluded,
    .query_bytes = query_bytes,
    .begin = begin,
    .flags = RAYTALLY_OVERLAY,
};

RAYTALLY_PLUGIN {
    return index == 0 ? &ops : NULL;
}
