/* SPDX-License-Identifier: Apache-2.0 */
/* The scenes and accelerators that `raytally verify` verifies, given or by default. */
#ifndef RT_CLI_VERIFY_CHOICE_H
#define RT_CLI_VERIFY_CHOICE_H

#include "verify/verify.h"

#define RT_VERIFY_MAX_SCENES 256
#define RT_VERIFY_MAX_SPECS  512

#define RT_VERIFY_FAMILIES  "families"  /* as a scene: all families of scenes */
#define RT_VERIFY_TRIANGLES "triangles" /* as a scene: the default ones without other shapes */

typedef struct RtVerifyChoice {
    const char *scenes[RT_VERIFY_MAX_SCENES]; /* given, or in `families` */
    uint32_t scene_count;
    uint32_t scenes_left_out; /* of the default scenes */
    RtVerifySpec specs[RT_VERIFY_MAX_SPECS];
    uint32_t spec_count;
    char families[RT_VERIFY_MAX_SCENES][RT_MAX_SPEC_CHARS];
} RtVerifyChoice;

/* The scenes given[0..count), borrowed; `families` means all families, with `seed`, and `triangles` the
 * default scenes of triangles alone. Without any, the default: scenes that are hard on accelerators, by
 * number of objects; with `quick` only small ones. */
RtStatus rt_verify_choose_scenes(RtVerifyChoice *choice, const char *const *given, uint32_t count,
                                 uint64_t seed, bool quick, RtError *error);

/* The accelerators given[0..count), `all` meaning every one; each also as its trial (rt_trial_spec), and with
 * `spread` at every value worth testing. */
RtStatus rt_verify_choose_specs(RtVerifyChoice *choice, const char *const *given, uint32_t count, bool spread,
                                RtError *error);

#endif
