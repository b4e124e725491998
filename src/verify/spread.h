/* SPDX-License-Identifier: Apache-2.0 */
/* The spread of an accelerator: its defaults, then each parameter at each test value, one at a
 * time. Verification and the conformance tests use it. */
#ifndef RT_VERIFY_SPREAD_H
#define RT_VERIFY_SPREAD_H

#include "accel/accel.h"

/* Writes the `n`th spec of the spread, "name" or "name:key=value", to out[0..RT_MAX_SPEC_CHARS); false past
 * the last. Default values are skipped. An overlay lies over the default accelerator. After the defaults
 * comes the trial (RtAccelOps.trial), if there is one; the others include its values, too. */
bool rt_spread_spec(const RtAccelOps *ops, size_t n, char *out);

/* The trial of a valid spec without parameters ("light+wide"), with that of each layer that has one, to
 * out[0..RT_MAX_SPEC_CHARS); false if there is none. */
bool rt_trial_spec(const char *spec, char *out);

#endif
