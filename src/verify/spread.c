/* SPDX-License-Identifier: Apache-2.0 */
#include "verify/spread.h"

#include "core/base/words.h"

#include <stdio.h>
#include <string.h>

/* Appends the trial's values except that of `param`, then param=value. */
static void add_values(const RtAccelOps *ops, const RtParam *param, const char *value, char *out) {
    const size_t name = strlen(param->name);
    char separator = ':';
    const char *each = ops->trial ? strchr(ops->trial, ':') : NULL;
    for (; each; each = strchr(each, ',')) {
        each++;
        if (strncmp(each, param->name, name) == 0 && each[name] == '=') continue;
        rt_append_text(out, RT_MAX_SPEC_CHARS, "%c%.*s", separator, (int)strcspn(each, ","), each);
        separator = ',';
    }
    rt_append_text(out, RT_MAX_SPEC_CHARS, "%c%s=%s", separator, param->name, value);
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
    if (ops->kinds) rt_append_text(out, RT_MAX_SPEC_CHARS, "+%s", rt_accel_default());
    return true;
}

bool rt_trial_spec(const char *spec, char *out) {
    RtSpec parsed;
    RtError error;
    bool any = false;
    out[0] = '\0';
    if (strchr(spec, ':') || rt_spec_parse(spec, &parsed, &error) != RT_OK) return false;
    for (uint32_t i = 0; i < parsed.layer_count; i++) {
        const RtAccelOps *ops = parsed.layers[i].ops;
        rt_append_text(out, RT_MAX_SPEC_CHARS, "%s%s", i ? "+" : "", ops->trial ? ops->trial : ops->name);
        any |= ops->trial != NULL;
    }
    return any;
}
