/* SPDX-License-Identifier: Apache-2.0 */
/* Plugins that cannot be loaded, one for each KIND that this is compiled with. */
#include "nothing.h"

#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <unistd.h>

enum {
    SYMBOL,      /* exports another name instead of raytally_plugin */
    EMPTY,       /* has no table */
    ABI,         /* is of another version */
    SIZE,        /* has a table of another size */
    NAME,        /* has a name that is impossible in a spec */
    TAKEN,       /* has the name of an existing accelerator */
    TWICE,       /* has two tables of one name */
    FUNCTION,    /* lacks a function */
    PARAMETERS,  /* claims a parameter, but has no table of them */
    DEFAULT,     /* has a default out of its range */
    CONSTRUCTOR, /* crashes while it is loaded */
    ENTRY,       /* crashes when its tables are read */
    FOREVER,     /* never finishes loading, and ignores SIGALRM */
    CHOICES,     /* has a parameter with too many choices */
    MANY,        /* has too many tables */
    FLAGS        /* sets a flag that does not exist */
};

#define TEN(x) x "0|" x "1|" x "2|" x "3|" x "4|" x "5|" x "6|" x "7|" x "8|" x "9|"
static const raytally_param choices[] = {
    {.name = "mode",
     .type = RAYTALLY_CHOICE,
     .default_text = "last",
     .choices = TEN("a") TEN("b") TEN("c") TEN("d") TEN("e") TEN("f") TEN("g") "last",
     .meaning = "what it does",
     .source = "nowhere"}};

static const raytally_param params[] = {{.name = "depth",
                                         .type = RAYTALLY_INT,
                                         .default_text = "12",
                                         .lo = 1,
                                         .hi = 10,
                                         .test_values = "1|10",
                                         .meaning = "levels",
                                         .source = "nowhere"}};

/* Correct, and first in every library; it must not be registered either. */
static const raytally_accel_ops first = {
    .abi = RAYTALLY_ACCEL_ABI,
    .size = sizeof first,
    .name = "unloadable-first",
    .summary = "is in order",
    .paper = "none",
    .build = build,
    .destroy = destroy,
    .nearest = search_nearest,
    .occluded = search_occluded,
};

static const raytally_accel_ops ops = {
    .abi = RAYTALLY_ACCEL_ABI + (KIND == ABI),
    .size = KIND == SIZE ? 8 : sizeof ops,
    .name = KIND == TAKEN  ? "grid"
            : KIND == NAME ? "un loadable"
                           : "unloadable",
    .summary = "cannot be loaded",
    .paper = "none",
    .params = KIND == DEFAULT   ? params
              : KIND == CHOICES ? choices
                                : NULL,
    .param_count = KIND == PARAMETERS || KIND == DEFAULT || KIND == CHOICES,
    .build = build,
    .destroy = destroy,
    .nearest = KIND == FUNCTION ? NULL : search_nearest,
    .occluded = search_occluded,
    .flags = KIND == FLAGS ? RAYTALLY_OWN_HITS | UINT64_C(1) << 63 : 0,
};

static const raytally_accel_ops *one_of_many(uint32_t index) {
    enum { TABLES = 60 };
    static raytally_accel_ops tables[TABLES];
    static char names[TABLES][16];
    if (index >= TABLES) return NULL;
    snprintf(names[index], sizeof names[index], "many-%u", index);
    tables[index] = first;
    tables[index].name = names[index];
    return &tables[index];
}

RAYTALLY_PLUGIN {
    if (KIND == ENTRY) abort();
    if (KIND == EMPTY) return NULL;
    if (KIND == MANY) return one_of_many(index);
    static raytally_accel_ops again;
    again = ops;
    return index == 0 ? &first : index == 1 ? &ops : index == 2 && KIND == TWICE ? &again : NULL;
}

__attribute__((constructor)) static void before_anything(void) {
    if (KIND == CONSTRUCTOR) abort();
    if (KIND != FOREVER) return;
    signal(SIGALRM, SIG_IGN);
    for (;;) pause();
}
