#include "base/tally.h"

#include <assert.h>

static const struct {
    const char *name, *meaning;
} counters[RT_TALLY_COUNTER_COUNT] = {
#define ROW(name, meaning) {#name, meaning},
    RT_TALLY_COUNTERS(ROW)
#undef ROW
};

const char *rt_tally_name(size_t i) {
    assert(i < RT_TALLY_COUNTER_COUNT);
    return counters[i].name;
}

const char *rt_tally_meaning(size_t i) {
    assert(i < RT_TALLY_COUNTER_COUNT);
    return counters[i].meaning;
}

uint64_t rt_tally_get(const RtTally *tally, size_t i) {
    const uint64_t values[RT_TALLY_COUNTER_COUNT] = {
#define VALUE(name, meaning) tally->name,
        RT_TALLY_COUNTERS(VALUE)
#undef VALUE
    };
    assert(i < RT_TALLY_COUNTER_COUNT);
    return values[i];
}

void rt_tally_add(RtTally *sum, const RtTally *part) {
#define ADD(name, meaning) sum->name += part->name;
    RT_TALLY_COUNTERS(ADD)
#undef ADD
}
