/* SPDX-License-Identifier: Apache-2.0 */
#include "core/base/tally.h"

#include <assert.h>

static const struct {
    const char *name, *meaning;
} counters[] = {
#define COUNTER(name, meaning) {#name, meaning},
    RT_TALLY_COUNTERS(COUNTER)};

const char *rt_tally_name(size_t i) {
    assert(i < RT_TALLY_COUNTER_COUNT);
    return counters[i].name;
}

const char *rt_tally_meaning(size_t i) {
    assert(i < RT_TALLY_COUNTER_COUNT);
    return counters[i].meaning;
}

uint64_t rt_tally_get(const RtTally *tally, size_t i) {
    assert(i < RT_TALLY_COUNTER_COUNT);
    return ((const uint64_t *)tally)[i]; /* a tally holds nothing but counters */
}

size_t rt_tally_difference(const RtTally *a, const RtTally *b) {
    size_t i = 0;
    while (i < RT_TALLY_COUNTER_COUNT && rt_tally_get(a, i) == rt_tally_get(b, i)) i++;
    return i;
}

static uint64_t capped(uint64_t count) {
    return count < RT_TALLY_MOST ? count : RT_TALLY_MOST;
}

/* The sum of two capped counts is less than 2^64. */
void rt_tally_add(RtTally *sum, const RtTally *part) {
#define ADD(name, meaning) sum->name = capped(capped(sum->name) + capped(part->name));
    RT_TALLY_COUNTERS(ADD)
}

const char *rt_tally_overflown(const RtTally *tally) {
    for (size_t i = 0; i < RT_TALLY_COUNTER_COUNT; i++) {
        if (rt_tally_get(tally, i) >= RT_TALLY_MOST) return rt_tally_name(i);
    }
    return NULL;
}
