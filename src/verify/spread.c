/* SPDX-License-Identifier: Apache-2.0 */
#include "verify/spread.h"

#include <stdio.h>
#include <string.h>

bool rt_spread_spec(const RtAccelOps *ops, size_t n, char *out) {
    char below[RT_MAX_NAME + 1] = "";
    if (ops->kinds) snprintf(below, sizeof below, "+%s", rt_accel_default());
    snprintf(out, RT_MAX_SPEC_CHARS, "%s%s", ops->name, below);
    if (n == 0) return true;
    for (size_t i = 0; i < ops->param_count; i++) {
        const RtParam *param = &ops->params[i];
        char value[RT_MAX_SPEC_CHARS / 2];
        for (size_t k = 0; rt_param_try(param, k, value, sizeof value); k++) {
            if (strcmp(value, param->standard) == 0) continue;
            if (--n > 0) continue;
            snprintf(out, RT_MAX_SPEC_CHARS, "%s:%s=%s%s", ops->name, param->name, value, below);
            return true;
        }
    }
    return false;
}
