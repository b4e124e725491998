/* SPDX-License-Identifier: Apache-2.0 */
/* Unusual plugins that must load: one for each KIND that this is compiled with. They find no hits. */
#include "nothing.h"

#include <fenv.h>
#include <locale.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <unistd.h>

enum {
    FLUSHING, /* flushes denormals to 0, as libraries linked with -ffast-math do */
    LONGER,   /* has a table of a later version of the interface, with more members */
    INVASIVE  /* changes global state of the process that loads it, and crashes when that ends */
};

static void flush_to_zero(void) {
#if defined(__x86_64__)
    __builtin_ia32_ldmxcsr(__builtin_ia32_stmxcsr() | 0x8040);
#elif defined(__aarch64__) && !defined(__clang__)
    __builtin_aarch64_set_fpcr(__builtin_aarch64_get_fpcr() | 1U << 24);
#endif
}

__attribute__((constructor)) static void when_loaded(void) {
    if (KIND == FLUSHING) flush_to_zero();
    if (KIND != INVASIVE) return;
    fesetround(FE_UPWARD);
    setlocale(LC_ALL, "");
    signal(SIGCHLD, SIG_IGN);
    if (chdir("/") == 0) puts("{ odd-INVASIVE is here");
}

__attribute__((destructor)) static void when_unloaded(void) {
    if (KIND == INVASIVE) abort();
}

typedef struct LongerOps {
    raytally_accel_ops ops;
    const char *more[8];
} LongerOps;

static const LongerOps longer = {
    .ops = {.abi = RAYTALLY_ACCEL_ABI,
            .size = KIND == LONGER ? sizeof longer : sizeof longer.ops,
            .name = KIND == LONGER     ? "longer"
                    : KIND == INVASIVE ? "invasive"
                                       : "flushing",
            .summary = "finds nothing",
            .paper = "none",
            .build = build,
            .destroy = destroy,
            .nearest = search_nearest,
            .occluded = search_occluded},
    .more = {"what", "nobody", "knows"},
};

RAYTALLY_PLUGIN {
    if (KIND == FLUSHING) flush_to_zero();
    return index == 0 ? &longer.ops : NULL;
}
