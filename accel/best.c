/* SPDX-License-Identifier: Apache-2.0 */
/* RtBestOf: a name in the table of an accelerator, and the specs that it stands for: all combinations of the
 * choices listed there, those of the first parameter varying fastest. */
#include "accel/accel.h"

#include <stdio.h>
#include <string.h>

bool rt_best_is(const char *text) {
    const char *colon = strchr(text, ':');
    return colon && colon > text && colon[1] && !strpbrk(text, "=,+");
}

/* Writes the spec of combination `n` to out[0..RT_MAX_SPEC_CHARS); false if there are no more. */
static bool combine(const RtAccelOps *ops, const RtBestOf *best, size_t n, char *out) {
    int used = snprintf(out, RT_MAX_SPEC_CHARS, "%s", ops->name);
    for (const char *key = best->settings; *key;) {
        size_t key_chars = strcspn(key, "=") + 1, all = key_chars + strcspn(key + key_chars, ",");
        size_t choices = 1;
        for (size_t i = key_chars; i < all; i++) choices += key[i] == '|';
        const char *choice = key + key_chars;
        for (size_t k = n % choices; k > 0; k--) choice += strcspn(choice, "|") + 1;
        used += snprintf(out + used, (size_t)(RT_MAX_SPEC_CHARS - used), "%c%.*s%.*s",
                         key == best->settings ? ':' : ',', (int)key_chars, key, (int)strcspn(choice, "|,"),
                         choice);
        n /= choices;
        key += all + (key[all] == ',');
    }
    return n == 0;
}

static RtStatus fail_unknown(const RtAccelOps *ops, const char *text, RtError *error) {
    char names[128] = "";
    for (size_t i = 0, used = 0; i < ops->best_count && used < sizeof names; i++)
        used += (size_t)snprintf(names + used, sizeof names - used, "%s%s:%s", i > 0 ? ", " : "", ops->name,
                                 ops->bests[i].name);
    return rt_fail(
        error, RT_BAD_INPUT,
        "'%.80s' is neither a spec, NAME:KEY=VALUE, nor one of the names that stand for the fastest "
        "of several settings%s%s",
        text, *names ? ": " : "", names);
}

RtStatus rt_best_specs(const char *text, char specs[RT_MAX_BEST][RT_MAX_SPEC_CHARS], size_t *count,
                       size_t *all, RtError *error) {
    char name[RT_MAX_NAME];
    const RtAccelOps *ops;
    snprintf(name, sizeof name, "%.*s", (int)strcspn(text, ":"), text);
    RT_TRY(rt_accel_find(name, &ops, error));
    const RtBestOf *best = rt_best_is(text) ? rt_best_find(ops, strchr(text, ':') + 1) : NULL;
    if (!best) return fail_unknown(ops, text, error);
    bool available[RT_MAX_BEST];
    char spec_of[RT_MAX_BEST][RT_MAX_SPEC_CHARS];
    size_t known = 0;
    for (; known < RT_MAX_BEST && combine(ops, best, known, spec_of[known]); known++) {
        RtSpec spec;
        RT_TRY(rt_spec_parse(spec_of[known], &spec, error));
        const RtStatus status = rt_spec_available(&spec, error);
        available[known] = status == RT_OK;
        if (status != RT_OK && status != RT_NOT_AVAILABLE) return status;
    }
    *count = *all = 0;
    for (int here = 1; here >= 0; here--) {
        for (size_t n = 0; n < known; n++) {
            if (available[n] == here) memcpy(specs[(*all)++], spec_of[n], RT_MAX_SPEC_CHARS);
        }
        if (here) *count = *all;
    }
    return *count > 0 ? RT_OK
                      : rt_fail(error, RT_NOT_AVAILABLE,
                                "this machine can run none of the settings of '%.80s'", text);
}
