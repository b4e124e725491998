/* SPDX-License-Identifier: Apache-2.0 */
#include "verify/spread.h"

#include <stdio.h>
#include <string.h>

/* Appends ":text" to a layer that ends at out[used], or ",text" if it already has parameters. Returns the
 * new end. */
static size_t add_text(char *out, size_t used, const char *text, size_t chars, bool first) {
    int added = snprintf(out + used, RT_MAX_SPEC_CHARS - used, "%c%.*s", first ? ':' : ',', (int)chars, text);
    return used + (size_t)added;
}

/* Appends the trial's values except that of `param`, then param=value. */
static void add_values(const RtAccelOps *ops, const RtParam *param, const char *value, char *out) {
    char own[RT_MAX_SPEC_CHARS];
    size_t used = strlen(out), name = strlen(param->name);
    bool first = true;
    const char *each = ops->trial ? strchr(ops->trial, ':') : NULL;
    for (; each; each = strchr(each, ',')) {
        each++;
        if (strncmp(each, param->name, name) == 0 && each[name] == '=') continue;
        used = add_text(out, used, each, strcspn(each, ","), first);
        first = false;
    }
    int chars = snprintf(own, sizeof own, "%s=%s", param->name, value);
    add_text(out, used, own, (size_t)chars, first);
}

/* The `n`th test value over all parameters that is not a default. */
static bool try_value(const RtAccelOps *ops, size_t n, const RtParam **param, char *value, size_t size) {
    for (size_t i = 0; i < ops->param_count; i++) {
        *param = &ops->params[i];
        for (size_t k = 0; rt_param_try(*param, k, value, size); k++) {
            if (strcmp(value, (*param)->default_text) != 0 && n-- == 0) return true;
        }
    }
    return false;
}

bool rt_spread_spec(const RtAccelOps *ops, size_t n, char *out) {
    const RtParam *param;
    char value[RT_MAX_SPEC_CHARS / 2];
    size_t whole = ops->trial ? 2 : 1; /* specs that do not vary a parameter */
    snprintf(out, RT_MAX_SPEC_CHARS, "%s", n == 1 && ops->trial ? ops->trial : ops->name);
    if (n >= whole) {
        if (!try_value(ops, n - whole, &param, value, sizeof value)) return false;
        add_values(ops, param, value, out);
    }
    size_t used = strlen(out);
    if (ops->kinds) snprintf(out + used, RT_MAX_SPEC_CHARS - used, "+%s", rt_accel_default());
    return true;
}

bool rt_trial_spec(const char *spec, char *out) {
    RtSpec parsed;
    RtError error;
    bool any = false;
    size_t used = 0;
    if (strchr(spec, ':') || rt_spec_parse(spec, &parsed, &error) != RT_OK) return false;
    for (uint32_t i = 0; i < parsed.layer_count; i++) {
        const RtAccelOps *ops = parsed.layers[i].ops;
        int added = snprintf(out + used, RT_MAX_SPEC_CHARS - used, "%s%s", i ? "+" : "",
                             ops->trial ? ops->trial : ops->name);
        used += (size_t)added;
        any |= ops->trial != NULL;
    }
    return any;
}
