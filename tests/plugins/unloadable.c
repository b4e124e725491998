/* SPDX-License-Identifier: Apache-2.0 */
/* Plugins that cannot be loaded, one for each KIND that this is compiled with. */
#include <raytally/accel.h>

#include <stdlib.h>

enum {
    SYMBOL,      /* exports something else: raytally_plugin is defined to be another name */
    EMPTY,       /* has no table */
    ABI,         /* is of another version */
    SIZE,        /* has a table of another size */
    NAME,        /* has a name that no spec can have */
    TAKEN,       /* has the name of an accelerator that there is */
    TWICE,       /* has two tables of one name */
    FUNCTION,    /* lacks a function */
    PARAMETERS,  /* says that there is a parameter, and has no table of them */
    STANDARD,    /* has a default out of its range */
    CONSTRUCTOR, /* crashes before it is asked anything */
    ENTRY        /* crashes when it is asked for its tables */
};

static int build(const raytally_build *from, void **self) {
    (void)from;
    *self = NULL;
    return RAYTALLY_BUILT;
}

static void destroy(void *self) {
    (void)self;
}

RAYTALLY_INLINE void search(const int *self, void *memory, const raytally_prepared *ray, int any,
                            raytally_hit *best, raytally_counters *counters) {
    (void)self, (void)memory, (void)ray, (void)any, (void)best, (void)counters;
}
RAYTALLY_DEFINE_KERNELS(int, search)

static const raytally_param params[] = {{.name = "depth",
                                         .type = RAYTALLY_INT,
                                         .standard = "12",
                                         .lo = 1,
                                         .hi = 10,
                                         .test_values = "1|10",
                                         .meaning = "levels",
                                         .source = "nowhere"}};

static const raytally_accel_ops ops = {
    .abi = RAYTALLY_ACCEL_ABI + (KIND == ABI),
    .size = KIND == SIZE ? 8 : sizeof ops,
    .name = KIND == TAKEN  ? "grid"
            : KIND == NAME ? "un loadable"
                           : "unloadable",
    .summary = "cannot be loaded",
    .paper = "none",
    .params = KIND == STANDARD ? params : NULL,
    .param_count = KIND == PARAMETERS || KIND == STANDARD,
    .build = build,
    .destroy = destroy,
    .nearest = KIND == FUNCTION ? NULL : search_nearest,
    .occluded = search_occluded,
};

RAYTALLY_PLUGIN {
    if (KIND == ENTRY) abort();
    const uint32_t tables = KIND == EMPTY ? 0 : KIND == TWICE ? 2 : 1;
    return index < tables ? &ops : NULL;
}

__attribute__((constructor)) static void before_anything(void) {
    if (KIND == CONSTRUCTOR) abort();
}
