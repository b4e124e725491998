/* SPDX-License-Identifier: Apache-2.0 */
#include "results/claims_changed.h"

#include <string.h>

json_t *rt_claims_json(const RtExperiment *experiment) {
    json_t *list = json_array();
    for (uint32_t i = 0; i < experiment->claim_count; i++)
        json_array_append_new(list, json_string(experiment->claims[i]));
    return list;
}

/* A claim that cannot be parsed any more, because what it names is gone, is none. */
static bool is_readout(const RtExperiment *experiment, const char *text) {
    RtClaim claim;
    return rt_claim_parse(experiment, text, &claim, NULL) == RT_OK && claim.readout;
}

bool rt_claim_is_later(const RtResults *results, uint32_t i) {
    const char *claim = results->experiment->claims[i];
    const json_t *first;
    size_t k;
    if (!results->first_claims || is_readout(results->experiment, claim)) return false;
    json_array_foreach(results->first_claims, k, first) {
        const char *text = json_string_value(first);
        if (text && strcmp(text, claim) == 0) return false;
    }
    return true;
}

uint32_t rt_claims_dropped(const RtResults *results, void (*visit)(void *context, const char *claim),
                           void *context) {
    const RtExperiment *experiment = results->experiment;
    uint32_t dropped = 0;
    for (size_t k = 0; k < json_array_size(results->first_claims); k++) {
        const char *text = json_string_value(json_array_get(results->first_claims, k));
        uint32_t i = 0;
        while (text && i < experiment->claim_count && strcmp(experiment->claims[i], text) != 0) i++;
        if (!text || i < experiment->claim_count || is_readout(experiment, text)) continue;
        if (visit) visit(context, text);
        dropped++;
    }
    return dropped;
}

bool rt_claims_are_changed(const RtResults *results) {
    bool any = rt_claims_dropped(results, NULL, NULL) > 0;
    for (uint32_t i = 0; i < results->experiment->claim_count; i++) any |= rt_claim_is_later(results, i);
    return any;
}
