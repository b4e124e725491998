/* SPDX-License-Identifier: Apache-2.0 */
/* What the measurements were made with: the machine, the compiler, the version. */
#ifndef RT_BENCH_MACHINE_H
#define RT_BENCH_MACHINE_H

#include "bench/results.h"

#include <jansson.h>

/* {"cpu", "clock_mhz" (the highest of the first processor, or what it has just now), "governor", "simd",
 * "processors", "os", "compiler", "flags", "version", "commit", "dirty"}, and by the name of each accelerator
 * that a library does the work of, its version; what cannot be found out is null. NULL where memory is short;
 * the caller owns the reference. */
json_t *rt_machine_json(void);

/* Version, commit and dirty flag in one line: only what was measured by one and the same build may be
 * mixed. */
const char *rt_build_identity(void);

/* This machine. */
RtMachine rt_machine_here(void);

#endif
