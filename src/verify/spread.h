/* SPDX-License-Identifier: Apache-2.0 */
/* The spread of an accelerator: its defaults, and then each parameter at each value worth testing, one at a
 * time. What verification and the conformance tests go through. */
#ifndef RT_VERIFY_SPREAD_H
#define RT_VERIFY_SPREAD_H

#include "accel/accel.h"

/* Writes the `n`th spec of the spread, "name" or "name:key=value", to out[0..RT_MAX_SPEC_CHARS); false when
 * there are no more. Values that are the default are left out. An overlay lies over the default accelerator.
 * Behind the defaults stands the trial (RtAccelOps.trial), if there is one, whose values the others have
 * too. */
bool rt_spread_spec(const RtAccelOps *ops, size_t n, char *out);

/* The trial of a valid spec of which no parameter is given, "light+wide", each layer that has one by its own,
 * to out[0..RT_MAX_SPEC_CHARS); false where there is none. */
bool rt_trial_spec(const char *spec, char *out);

#endif
