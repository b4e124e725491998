/* SPDX-License-Identifier: Apache-2.0 */
#include "measure/distribution.h"

#include "core/base/memory.h"

#include <assert.h>
#include <string.h>

const char *rt_quantity_name(size_t i) {
#define NAME(name, meaning) #name,
    static const char *const names[] = {RT_RAY_QUANTITIES(NAME) RT_LEAF_QUANTITIES(NAME)};
#undef NAME
    assert(i < RT_QUANTITY_COUNT);
    return names[i];
}

/* ---- bins ---- */

enum { PLAIN = 16, AN_OCTAVE = 8, PLAIN_BITS = 4, OCTAVE_BITS = 3 };

uint32_t rt_histogram_bin(uint64_t value) {
    assert(value <= UINT32_MAX);
    if (value < PLAIN) return (uint32_t)value;
    uint32_t bits = 63 - (uint32_t)__builtin_clzll(value);
    uint32_t eighth = (uint32_t)(value >> (bits - OCTAVE_BITS)) - AN_OCTAVE;
    return PLAIN + (bits - PLAIN_BITS) * AN_OCTAVE + eighth;
}

uint64_t rt_histogram_low(uint32_t bin) {
    if (bin < PLAIN) return bin;
    uint32_t octave = (bin - PLAIN) / AN_OCTAVE, eighth = (bin - PLAIN) % AN_OCTAVE;
    return (uint64_t)(AN_OCTAVE + eighth) << (octave + PLAIN_BITS - OCTAVE_BITS);
}

/* ---- values ---- */

RtStatus rt_occurrences_add(RtOccurrences *occurrences, uint64_t value, RtError *error) {
    const uint64_t most = UINT64_C(1) << 27; /* a gigabyte of numbers */
    if (value >= most)
        return rt_fail(error, RT_BROKEN, "a count of %llu for one ray is too large for a distribution",
                       (unsigned long long)value);
    if (value >= occurrences->end) {
        uint32_t end = (uint32_t)value + 1;
        RT_TRY(rt_reserve(&occurrences->of, &occurrences->capacity, end, sizeof(uint64_t), error));
        memset(occurrences->of + occurrences->end, 0, (end - occurrences->end) * sizeof(uint64_t));
        occurrences->end = end;
    }
    occurrences->of[value]++;
    return RT_OK;
}

void rt_occurrences_clear(RtOccurrences *occurrences) {
    rt_free(occurrences->of);
    *occurrences = (RtOccurrences){0};
}

/* The value of rank ceil(thousandths / 1000 * count). */
static uint64_t percentile(const RtOccurrences *occurrences, uint64_t count, uint64_t thousandths) {
    uint64_t rank = count / 1000 * thousandths + (count % 1000 * thousandths + 999) / 1000, seen = 0;
    uint32_t value = 0;
    while (value + 1 < occurrences->end && (seen += occurrences->of[value]) < rank) value++;
    return value;
}

RtDistribution rt_distribution_of(const RtOccurrences *occurrences) {
    RtDistribution d = {0};
    for (uint32_t value = 0; value < occurrences->end; value++) {
        uint64_t often = occurrences->of[value];
        d.count += often;
        d.sum += often * value;
        d.bins[rt_histogram_bin(value)] += often;
    }
    if (d.count == 0) return d;
    d.median = percentile(occurrences, d.count, 500);
    d.p90 = percentile(occurrences, d.count, 900);
    d.p99 = percentile(occurrences, d.count, 990);
    d.p999 = percentile(occurrences, d.count, 999);
    d.most = occurrences->end - 1;
    return d;
}

/* ---- JSON ---- */

#define FIGURES(X) X(count) X(sum) X(median) X(p90) X(p99) X(p999) X(most)

static json_t *one_json(const RtDistribution *d) {
    json_t *object = json_object(), *bins = json_array();
#define PUT(name) json_object_set_new(object, #name, json_integer((json_int_t)d->name));
    FIGURES(PUT)
#undef PUT
    for (uint32_t b = 0; b < RT_HISTOGRAM_BINS; b++) {
        if (d->bins[b])
            json_array_append_new(bins, json_pack("[I, I]", (json_int_t)b, (json_int_t)d->bins[b]));
    }
    json_object_set_new(object, "bins", bins);
    return object;
}

static bool take_one(RtDistribution *d, const json_t *object) {
    const json_t *bins = json_object_get(object, "bins");
    *d = (RtDistribution){0};
#define TAKE(name) d->name = (uint64_t)json_integer_value(json_object_get(object, #name));
    FIGURES(TAKE)
#undef TAKE
    for (size_t i = 0; i < json_array_size(bins); i++) {
        const json_t *pair = json_array_get(bins, i);
        json_int_t bin = json_integer_value(json_array_get(pair, 0));
        if (bin < 0 || bin >= RT_HISTOGRAM_BINS) return false;
        d->bins[bin] = (uint64_t)json_integer_value(json_array_get(pair, 1));
    }
    return bins != NULL;
}

json_t *rt_distributions_json(const RtDistribution *distributions, size_t first, size_t count) {
    json_t *object = json_object();
    for (size_t i = 0; i < count; i++)
        json_object_set_new(object, rt_quantity_name(first + i), one_json(&distributions[i]));
    return object;
}

bool rt_distributions_take(RtDistribution *distributions, size_t first, size_t count, const json_t *object) {
    bool all = true;
    for (size_t i = 0; i < count; i++)
        all &= take_one(&distributions[i], json_object_get(object, rt_quantity_name(first + i)));
    return all;
}
