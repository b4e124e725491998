/* SPDX-License-Identifier: Apache-2.0 */
/* Building the accelerator of a spec, in this process or in one of its own, which itself needs spec.c. */
#include "accel/plugin.h"

RtStatus rt_accel_build(const RtSpec *spec, const RtScene *scene, int threads, RtAccel **out,
                        RtError *error) {
    return rt_spec_is_remote(spec) ? rt_remote_build(spec, scene, threads, out, error)
                                   : rt_accel_build_here(spec, scene, threads, out, error);
}

RtStatus rt_accel_open_on(const char *spec, const RtScene *scene, int threads, RtAccel **out,
                          RtError *error) {
    RtSpec parsed;
    *out = NULL;
    RT_TRY(rt_spec_parse(spec, &parsed, error));
    return rt_accel_build(&parsed, scene, threads, out, error);
}

RtStatus rt_accel_open(const char *spec, const RtScene *scene, RtAccel **out, RtError *error) {
    return rt_accel_open_on(spec, scene, 0, out, error);
}
