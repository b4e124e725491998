/* SPDX-License-Identifier: Apache-2.0 */
/* my-accel: an accelerator of raytally, as a plugin. It works, but saves little: every ray visits every
 * object, and with `boxes` on it tests only those objects whose box it hits. Replace the list by your
 * structure: STRUCTURE marks the places to change.
 *
 * <raytally/accel.h> defines the contract; <raytally/box.h> explains why the box test loses no hit. */
#include <raytally/accel.h>
#include <stdio.h>
#include <stdlib.h>

/* STRUCTURE: nodes, cells, lists, or whatever a search needs. It is read-only once built: all threads share
 * it. Data that a search writes, such as a stack, belongs in local variables or in the memory of its query.
 */
typedef struct Structure {
    const raytally_box *boxes; /* [count] of the objects; borrowed */
    uint32_t *ids;             /* [count] the objects in the order in which they are tested */
    uint32_t count;
    int test_boxes; /* the parameter `boxes` */
} Structure;

/* Parameters, as in my-accel:boxes=off. This table drives help, range checks and `verify --spread`; `build`
 * gets the values in the same order. Numbers have a range, and test_values such as "1|4|20". */
enum { BOXES, PARAMS };
static const raytally_param params[PARAMS] = {
    [BOXES] = {.name = "boxes",
               .type = RAYTALLY_FLAG,
               .default_text = "on",
               .meaning = "test an object only if the ray hits its box",
               .source = "a box costs less than most objects"},
};

/* ---- build ---- */

static void destroy(void *self) {
    Structure *s = self;
    free(s->ids);
    free(s);
}

/* STRUCTURE: build it from the boxes of the objects alone. The same boxes must give the same structure, on
 * any number of threads. */
static int build(const raytally_build_input *from, void **self) {
    Structure *s = calloc(1, sizeof *s);
    if (!s) return RAYTALLY_BUILD_NO_MEMORY;
    s->boxes = from->boxes;
    s->count = from->object_count;
    s->test_boxes = from->values[BOXES].flag != 0;
    s->ids = malloc((s->count + 1) * sizeof *s->ids);
    if (!s->ids) {
        destroy(s);
        return RAYTALLY_BUILD_NO_MEMORY;
    }
    for (uint32_t i = 0; i < s->count; i++) s->ids[i] = i;
    *self = s;
    return RAYTALLY_BUILD_OK;
}

/* ---- trace ---- */

/* STRUCTURE: find objects along the ray and test them. raytally_object_hits updates *best and counts the
 * object tests; of several hits at the same t it keeps the object with the lower number. Skip a box only if
 * raytally_box_hit returns 0 for raytally_tmax, the best hit so far. With any = 1, any hit is sufficient.
 *
 * Count other events where they happen, and show those that have a box to `raytally trace`. When rays are
 * timed, `counters` is a constant NULL, and RAYTALLY_COUNT and raytally_show compile to nothing. */
RAYTALLY_INLINE void search(const Structure *s, void *memory, const raytally_prepared *ray, int any,
                            raytally_hit *best, raytally_counters *counters) {
    (void)memory; /* of the query, if the table below has query_bytes */
    float enter;
    for (uint32_t i = 0; i < s->count; i++) {
        const uint32_t *id = &s->ids[i];
        RAYTALLY_COUNT(counters, RAYTALLY_STEPS, 1);
        if (s->test_boxes) {
            RAYTALLY_COUNT(counters, RAYTALLY_EXTENT_TESTS, 1);
            raytally_show(ray, RAYTALLY_EXTENT_TESTS, i, &s->boxes[*id], counters);
            if (!raytally_box_hit(&s->boxes[*id], ray, raytally_tmax(ray, best), &enter)) continue;
        }
        if (raytally_object_hits(ray, id, 1, any, best, counters)) return;
    }
}

/* Defines search_nearest and search_occluded, each with counters and without. */
RAYTALLY_DEFINE_KERNELS(Structure, search)

/* ---- describe, validate ---- */

/* STRUCTURE: its statistics, which are printed and plotted. */
static void describe(const void *self, raytally_description *out) {
    const Structure *s = self;
    out->leaves = s->count > 0;
    out->references = s->count;
    out->bytes = sizeof *s + s->count * sizeof *s->ids;
}

/* STRUCTURE: its invariants, which hold for every scene. `verify` checks them before it traces rays. */
static int validate(const void *self, char *message, size_t size) {
    const Structure *s = self;
    for (uint32_t i = 0; i < s->count; i++) {
        if (s->ids[i] < s->count) continue;
        snprintf(message, size, "place %u of the list has object %u of %u", i, s->ids[i], s->count);
        return 1;
    }
    return 0;
}

/* ---- the table ---- */

static const raytally_accel_ops ops = {
    .abi = RAYTALLY_ACCEL_ABI,
    .size = sizeof ops,
    .name = "my-accel",
    .summary = "every object for every ray, behind its box",
    .paper = "none yet",
    .params = params,
    .param_count = PARAMS,
    .build = build,
    .destroy = destroy,
    .nearest = search_nearest,
    .occluded = search_occluded,
    .describe = describe,
    .validate = validate,
};

RAYTALLY_PLUGIN {
    return index == 0 ? &ops : NULL;
}
